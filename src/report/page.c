/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/page.h"

#include <stdlib.h>
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
    mt_text_add_n(out, mt_page_heads[kind].text, mt_page_heads[kind].length);
    mt_text_add(out, "<title>");
    mt_html_escape(title, out);
    mt_text_add(out, "</title>\n</head>\n<body>\n<main>\n<h1>");
    mt_html_escape(title, out);
    mt_text_add(out, "</h1>\n");
}

/* "<" in JSON, where it stands in strings only. */
static const char LESS[] = "\\u003c";

/* Size of the JSON with every "<" escaped as a number. */
static size_t room_of(const char *json)
{
    size_t n = 1;
    for (const char *at = json; (at = strchr(at, '<')) != NULL; at++) {
        n += sizeof LESS - 2;
    }
    return n + strlen(json);
}

/* Copy a string including its end, or up to the end of the text. */
static const char *copy_string(const char *json, char **to)
{
    char *out = *to;
    *out++ = *json++;
    while (*json != '"' && *json != '\0') {
        if (*json == '<') {
            memcpy(out, LESS, sizeof LESS - 1);
            out += sizeof LESS - 1;
            json++;
            continue;
        }
        if (*json == '\\' && json[1] != '\0') { /* and what it escapes */
            *out++ = *json++;
        }
        *out++ = *json++;
    }
    if (*json == '"') {
        *out++ = *json++;
    }
    *to = out;
    return json;
}

/* Copy JSON into `out` so that it cannot end its element. White space, a third of a large
 * result, is left out, and repeated parts are stored once (dedupe_json.h). */
static void copy_json(const char *json, char *out)
{
    while (*json != '\0') {
        while (*json != '"' && *json != '\0') { /* between strings */
            *out = *json++;
            out += *out != ' ' && *out != '\n' ? 1 : 0;
        }
        if (*json == '"') {
            json = copy_string(json, &out);
        }
    }
    *out = '\0';
}

static void add_data(const char *json, mt_text *out)
{
    char *const plain = malloc(room_of(json));
    out->failed = out->failed || plain == NULL;
    if (plain != NULL) {
        copy_json(json, plain);
        mt_dedupe_json(plain, out);
    }
    free(plain);
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
