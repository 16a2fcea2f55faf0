/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_PAGE_H
#define REPORT_PAGE_H

#include "base/sha256.h"
#include "base/text.h"

/*
 * A self-contained page: style, data and one script, nothing loaded from elsewhere. A strict
 * Content-Security-Policy lists style and script by their SHA-256, so that no other script
 * runs, whatever names and texts a file contains. out->failed remembers a shortage of memory.
 */

typedef enum mt_page_kind {
    MT_PAGE_PLAIN, /* no script */
    MT_PAGE_REPORT,
    MT_PAGE_REPORT_SCENE, /* a report with drawings of the mechanism */
    MT_PAGE_SHOW,
    MT_PAGE_KINDS
} mt_page_kind;

/* A block of data: JSON that the script reads from the element of this id. */
typedef struct mt_page_data {
    const char *id;
    const char *json; /* NULL: the block is left out */
} mt_page_data;

/* mt_page_begin writes a page up to its heading, mt_page_end its data and its end. */
void mt_page_begin(mt_page_kind kind, const char *title, mt_text *out);
void mt_page_end(int n, const mt_page_data *data, mt_text *out);

/* mt_sha256 of a text, faster for a page, for whose beginning the build has computed the
 * state. */
void mt_page_sha256(const char *page, size_t length, char out[MT_SHA256_TEXT]);

#endif
