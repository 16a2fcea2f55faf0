/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_RESPONSE_H
#define CLI_RESPONSE_H

#include "cli/cli.h"
#include "report/table.h"
#include "response/response.h"
#include "vibration/profile_response.h"

/* The response of one configuration with all that its output needs. */
typedef struct mt_response_view {
    const char *configuration;
    const mt_loaded_model *s;
    const mt_response *r;
    const mt_curve *curve;
    mt_curve_options opt; /* options of the tracing */
    bool direct;
    const mt_pole_sum *sums;     /* [pairs] of --poles; NULL: not requested, or not available */
    const char *no_sums;         /* reason for no sums; NULL */
    const mt_profiled *profiled; /* --vibration; NULL */
    int n;                       /* of --sensitivity */
    const int *parameter;        /* [n] */
    const double *value;         /* [n] */
    /* n_extremes x n: change of |H| in per cent, for one per cent more */
    const double *percent;
} mt_response_view;

void mt_response_print(const mt_response_view *v, mt_text *out);
void mt_response_json(const mt_response_view *v, mt_json_writer *w);
/* psd: with the columns of --vibration. */
mt_table mt_response_csv_table(bool psd);
void mt_response_csv_rows(const mt_response_view *v, mt_table *t);
const mt_port *mt_response_input_of(const mt_response_view *v, int pair);
const mt_port *mt_response_output_of(const mt_response_view *v, int pair);

/* The output of --vibration (response_vibration.c). */
/* Print the vibration of each output under the profile, with its notes. */
void mt_response_vibration_print(const mt_response_view *v, mt_text *out);
/* Members "profile", and "vibration", "psd_unit", "psd" of a response. */
void mt_response_vibration_json(const mt_response_view *v, mt_json_writer *w);
void mt_response_vibration_json_pair(const mt_response_view *v, int pair, mt_json_writer *w);
/* The columns, and the cells for one frequency of the curve. */
void mt_response_vibration_columns(mt_table *t);
void mt_response_vibration_cells(const mt_response_view *v, int pair, int point, mt_table *t);

#endif
