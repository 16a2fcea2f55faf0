/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_SURVEY_H
#define CLI_SURVEY_H

#include "cli/cli.h"
#include "mechanics/independence.h"

/*
 * How far parameters move the frequencies of one configuration: exact derivatives of the first
 * vibration modes. At repeated modes no single one has a derivative; there, directional values
 * are given (eigenvalues of Y^T (dK - lambda dM) Y over the cluster), ascending.
 */
typedef struct mt_survey {
    const mt_subject *s;
    int c;
    mt_arena mem;
    mt_lowest_way way; /* NONE: by all modes */
    int bodies;        /* else */
    int n;             /* parameters */
    int *parameter;    /* [n] */
    double *value;     /* [n] in this configuration */
    bool *overridden;  /* [n] by the configuration: no influence there */
    int modes;         /* vibration modes looked at */
    int unstable;      /* of the configuration */
    int *position;     /* [modes] */
    double *hz;        /* [modes] */
    bool *repeated;    /* [modes] */
    int room;          /* leading dimension of per_unit */
    /* room x n: Hz per unit of the parameter; NaN where it has no derivative */
    double *per_unit;
    mt_independence *independence; /* [n] why not */
} mt_survey;

/* `parameters`: "A,B", or NULL for all that are not made of others. v zeroed before;
 * mt_survey_free in any case. */
mt_status mt_survey_take(const mt_subject *s, int c, const char *parameters, int modes,
                         mt_survey *v, mt_err *err);
void mt_survey_free(mt_survey *v);
/* Hz for one per cent more of parameter k, mode i. */
double mt_survey_per_percent(const mt_survey *v, int i, int k);
/* True where 1 % more of parameter k is what people are told. Of a coordinate at or below 0 it
 * means nothing: they are told of 1 mm more. */
bool mt_survey_has_percent(const mt_survey *v, int k);
/* That [Hz], rounding as 0. */
double mt_survey_shown(const mt_survey *v, int i, int k);

#endif
