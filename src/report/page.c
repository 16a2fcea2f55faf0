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

/* A text that grows by single characters: a piece of it is added at once. */
typedef struct pieces {
    char piece[4096];
    size_t n;
    mt_text *out;
} pieces;

static void flush(pieces *p)
{
    mt_text_add_n(p->out, p->piece, p->n);
    p->n = 0;
}

static inline void put(pieces *p, char c)
{
    if (p->n == sizeof p->piece) {
        flush(p);
    }
    p->piece[p->n++] = c;
}

/* JSON in which nothing can end the element: a "<" stands only in strings, where it may be
 * written as its number. White space is left out: nobody reads it here, and it is a third of a
 * large result, and what is said twice stands once (pack.h). */
static void add_json(const char *json, mt_text *out)
{
    pieces p;
    p.n = 0;
    p.out = out;
    bool in_string = false;
    for (; *json != '\0'; json++) {
        if (*json == '<') {
            for (const char *escape = "\\u003c"; *escape != '\0'; escape++) {
                put(&p, *escape);
            }
        } else if (in_string || (*json != ' ' && *json != '\n')) {
            put(&p, *json);
            in_string = in_string != (*json == '"');
            if (*json == '\\' && json[1] != '\0') { /* and what it escapes */
                put(&p, *++json);
            }
        }
    }
    flush(&p);
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
