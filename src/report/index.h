/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_INDEX_H
#define REPORT_INDEX_H

#include "report/table.h"

/* One of several studies that were run together. */
typedef struct mt_index_study {
    const char *path;    /* as it was asked for */
    const char *file;    /* without folder */
    const char *folder;  /* of its result, beside the index */
    const char *state;   /* "answered" | "not answered" | "not run" */
    const char *name;    /* from here on NULL and NaN where it is not answered */
    const char *status;  /* of the result */
    const char *grade;   /* of the best design; NULL: there is none */
    double change;       /* of it, the size of the redesign */
    const char *sha256;  /* of result.json */
    bool has_report;     /* report.html stands beside it */
    const char *message; /* why it was not answered; NULL: it was */
    int exit_status;     /* what running it alone would have ended with; -1: not run */
    double seconds;      /* of the solution */
} mt_index_study;

/* study, status, grade, change, time. */
mt_table mt_report_index(const mt_index_study *studies, int n);
/* One page with a line for each study and links to their reports. It has no times: the same
 * answers make the same page. */
void mt_report_index_html(const mt_index_study *studies, int n, mt_text *out);

#endif
