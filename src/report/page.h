/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_PAGE_H
#define REPORT_PAGE_H

#include "base/sha256.h"
#include "base/text.h"
#include "report/table.h"
#include "result/result.h"

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

/*
 * Compact JSON that stores repeated parts once: [keys, shared, value], where in value and in
 * shared
 *     {"#": i}            is shared[i],
 *     {"~": [k, a, ...]}  is the object with the names keys[k] and the values a, ...
 * (src/report/page/base.js reads it). Numbers are not rounded. The packing depends on the
 * structure of the document only, not on its texts. json: valid, no deeper than a reader
 * allows; spaces and line feeds between its tokens, a third of a large result, are left out.
 * "<", which could end the element of the page that holds the document, is escaped. A document
 * with a member "#" or "~" is kept otherwise as it is, in [[], [], value]. out->failed
 * remembers a shortage of memory.
 */
void mt_dedupe_json(const char *json, mt_text *out);

/* The study as a question in one sentence: "Which values of k and m hold installed mode 1 at 18
 * Hz, with the least total change?" out->failed remembers a shortage of memory. */
void mt_report_question(const mt_result *result, mt_text *out);

/* The title block of a page: study, author, revision, date, model with its digest, the study's
 * question and the model's assumptions. out->failed remembers a shortage of memory. */
void mt_report_title(const mt_result *result, mt_text *out);

/* The abstract of a page: the status, then in a few lines the changes of the best design, how
 * it meets the goals, what is proven, and alternatives. out->failed remembers a shortage of
 * memory. */
void mt_report_abstract(const mt_result *result, mt_text *out);

/* One of several studies run together. */
typedef struct mt_index_study {
    const char *path;    /* path as given */
    const char *file;    /* without folder */
    const char *folder;  /* folder of its result, next to the index */
    const char *state;   /* "answered" | "not answered" | "not run" */
    const char *name;    /* this and the following are NULL and NaN where not answered */
    const char *status;  /* of the result */
    const char *grade;   /* of the best design; NULL: there is none */
    double change;       /* total change of the best design */
    const char *sha256;  /* of result.json */
    bool has_report;     /* report.html exists in the folder */
    const char *message; /* reason of not answering; NULL: answered */
    int exit_status;     /* exit status of running it alone; -1: not run */
    double seconds;      /* of the solution */
} mt_index_study;

/* study, status, grade, change, time. */
mt_table mt_report_index(const mt_index_study *studies, int n);
/* One page with a line per study and links to their reports. It has no times: the same answers
 * give the same page. */
void mt_report_index_html(const mt_index_study *studies, int n, mt_text *out);

/* A result as one self-contained HTML page: sentences and tables, and figures that its script
 * draws from `json`, the same result as in a file, and from `scene`, its mechanism (NULL:
 * none). out->failed remembers a shortage of memory. */
void mt_report_html(const mt_result *result, const char *json, const char *scene, mt_text *out);
/* The part without script and data: sentences and tables, and the places of the figures. */
void mt_report_html_told(const mt_result *result, mt_text *out);

#endif
