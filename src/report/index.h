/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_INDEX_H
#define REPORT_INDEX_H

#include "report/table.h"

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

#endif
