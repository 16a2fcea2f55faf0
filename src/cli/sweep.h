/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_SWEEP_H
#define CLI_SWEEP_H

#include "cli/cli.h"
#include "mechanics/sweep.h"
#include "report/table.h"

/* The drive and the positions of --drive and --hold. */
typedef struct mt_sweep_request {
    mt_system_drive drive;
    int n;
    double *positions; /* [n] rad or m from the reference position */
} mt_sweep_request;

/* The sweep of one configuration with all that its output needs. */
typedef struct mt_sweep_view {
    const char *configuration;
    const mt_sweep_request *request;
    const mt_system *sys;
    mt_sweep sweep;
    int modes;      /* frequencies per point; 0: not requested */
    double *hz;     /* modes x n points; NaN: no such mode */
    int *rigid;     /* [n] rigid-body modes */
    int *unstable;  /* [n] */
    int *undecided; /* [n] */
} mt_sweep_view;

void mt_sweep_print(const mt_sweep_view *v, mt_text *out);
void mt_sweep_json(const mt_sweep_view *v, mt_json_writer *w);
/* Columns, then rows of all points; two configurations with the same joints have the same
 * columns. */
void mt_sweep_csv_columns(const mt_sweep_view *v, mt_table *t);
void mt_sweep_csv_rows(const mt_sweep_view *v, mt_table *t);

#endif
