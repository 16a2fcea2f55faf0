/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/page.h"

#include <string.h>

#include "base/base.h"
#include "report/pack.h"
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
    mt_text_add_n(out, mt_page_heads[kind].text, mt_page_heads[kind].length);
    mt_text_add(out, "<title>");
    mt_html_escape(title, out);
    mt_text_add(out, "</title>\n</head>\n<body>\n<main>\n<h1>");
    mt_html_escape(title, out);
    mt_text_add(out, "</h1>\n");
}

/* JSON in which nothing can end the element: a "<" stands only in strings, where it may be
 * written as its number. White space is left out: nobody reads it here, and it is a third of a
 * large
 * result, and what is said twice stands once (pack.h). */
static void add_json(const char *json, mt_text *out)
{
    bool in_string = false;
    while (*json != '\0') {
        const size_t plain = strcspn(json, in_string ? "<\\\"" : "< \n\"");
        mt_text_add_n(out, json, plain);
        json += plain;
        if (*json == '<') {
            mt_text_add(out, "\\u003c");
        } else if (*json == '"') {
            mt_text_add(out, "\"");
            in_string = !in_string;
        } else if (*json == '\\' && json[1] != '\0') { /* and what it escapes */
            mt_text_add_n(out, json, 2);
            json++;
        }
        json += *json == '\0' ? 0 : 1;
    }
}

static void add_data(const char *json, mt_text *out)
{
    mt_text plain = {.s = NULL};
    add_json(json, &plain);
    out->failed = out->failed || plain.failed;
    if (plain.s != NULL && !plain.failed) {
        mt_pack_json(plain.s, out);
    }
    mt_text_free(&plain);
}

void mt_page_end(int n, const mt_page_data *data, mt_text *out)
{
    mt_text_add(out, "</main>\n");
    for (int i = 0; i < n; i++) {
        if (data[i].json != NULL) {
            mt_text_addf(out, "<script type=\"application/json\" id=\"%s\">", data[i].id);
            add_data(data[i].json, out);
            mt_text_add(out, "</script>\n");
        }
    }
    mt_text_add(out, "</body>\n</html>\n");
}
