/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_SARIF_H
#define CLI_SARIF_H

#include "modetune/read.h"

#include "io/write_json.h"

/*
 * Problems of files as SARIF 2.1.0, which code hosts show at the lines of a review and editors
 * in their lists. One log, one run:
 *     mt_sarif_begin(&w);
 *     mt_sarif_put(&w, &problem); ...
 *     mt_sarif_end(&w, code, left_out);
 */
typedef struct mt_file_problem {
    mt_severity severity;
    bool unread;      /* the file itself could not be read */
    const char *file; /* as given; relative ones become relative URIs */
    int line;         /* 0: no place; shown at the first line, which hosts require */
    int column;       /* of code points */
    const char *pointer;
    const char *message;
} mt_file_problem;

void mt_sarif_begin(mt_json_writer *w);
void mt_sarif_put(mt_json_writer *w, const mt_file_problem *problem);
/* code: exit status of the program; left_out: number of problems left out. */
void mt_sarif_end(mt_json_writer *w, int code, int left_out);

#endif
