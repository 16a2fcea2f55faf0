/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/page.h"

#include <string.h>

#include "base/base.h"
#include "report/dedupe_json.h"
#include "report/page_heads.h"
#include "report/table.h"

/* A page that begins like this one; NULL. */
static const mt_page_head *head_of(const char *page, size_t length)
{
    for (int i = 0; i < MT_PAGE_KINDS; i++) {
        const mt_page_head *const head = &mt_page_heads[i];
        if (length >= head->length && memcmp(page, head->text, head->length) == 0) {
            return head;
        }
    }
    return NULL;
}

void mt_page_sha256(const char *page, size_t length, char out[MT_SHA256_TEXT])
{
    const mt_page_head *const head = head_of(page, length);
    if (head == NULL) {
        mt_sha256(page, length, out);
    } else {
        mt_sha256_end(&head->start, page, length, out);
    }
}

void mt_page_begin(mt_page_kind kind, const char *title, mt_text *out)
{
    enum { OFTEN_ENOUGH = 256 * 1024 }; /* for what follows: the head is not copied again */
    mt_text_reserve(out, mt_page_heads[kind].length + OFTEN_ENOUGH);
    mt_text_add_n(out, mt_page_heads[kind].text, mt_page_heads[kind].length);
    mt_text_add(out, "<title>");
    mt_html_escape(title, out);
    mt_text_add(out, "</title>\n</head>\n<body>\n<main>\n<h1>");
    mt_html_escape(title, out);
    mt_text_add(out, "</h1>\n");
}

void mt_page_end(int n, const mt_page_data *data, mt_text *out)
{
    mt_text_add(out, "</main>\n");
    for (int i = 0; i < n; i++) {
        if (data[i].json != NULL) {
            mt_text_addf(out, "<script type=\"application/json\" id=\"%s\">", data[i].id);
            mt_dedupe_json(data[i].json, out);
            mt_text_add(out, "</script>\n");
        }
    }
    mt_text_add(out, "</body>\n</html>\n");
}
