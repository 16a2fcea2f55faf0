/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_PAGE_H
#define REPORT_PAGE_H

#include "base/sha256.h"
#include "base/text.h"

/*
 * A page that stands alone: style, data and one script inside, nothing loaded from elsewhere. A
 * strict Content-Security-Policy names style and script by their SHA-256, so that nothing else
 * can run, whatever names and texts a file brings. Memory running out shows in out->failed.
 */

typedef enum mt_page_kind {
    MT_PAGE_PLAIN, /* no script */
    MT_PAGE_REPORT,
    MT_PAGE_REPORT_SCENE, /* one that shows the mechanism, too */
    MT_PAGE_SHOW,
    MT_PAGE_KINDS
} mt_page_kind;

/* A block of data: JSON that the script reads from the element of this id. */
typedef struct mt_page_data {
    const char *id;
    const char *json; /* NULL: no such block */
} mt_page_data;

/* A page up to its heading; and its data and its end. */
void mt_page_begin(mt_page_kind kind, const char *title, mt_text *out);
void mt_page_end(int n, const mt_page_data *data, mt_text *out);

/* mt_sha256 of a text, sooner where it is a page: the build has done it for the beginning. */
void mt_page_sha256(const char *page, size_t length, char out[MT_SHA256_TEXT]);

#endif
