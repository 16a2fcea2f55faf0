/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_RESPONSE_H
#define CLI_RESPONSE_H

#include "cli/cli.h"
#include "report/table.h"
#include "response/response.h"

/* The response of one configuration, ready to be written. */
typedef struct mt_response_view {
    const char *configuration;
    const mt_subject *s;
    const mt_response *r;
    const mt_curve *curve;
    mt_curve_options opt; /* as it was traced */
    bool direct;
    const mt_pole_sum *sums; /* [pairs] of --poles; NULL: not asked for, or there are none */
    const char *no_sums;     /* why there are none; NULL */
    int n;                   /* of --sensitivity */
    const int *parameter;    /* [n] */
    const double *value;     /* [n] */
    const double *percent;   /* n_extremes x n: of |H|, for one per cent more */
} mt_response_view;

void mt_response_print(const mt_response_view *v, mt_text *out);
void mt_response_json(const mt_response_view *v, mt_json_writer *w);
mt_table mt_response_csv_table(void);
void mt_response_csv_rows(const mt_response_view *v, mt_table *t);

#endif
