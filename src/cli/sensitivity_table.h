/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_SENSITIVITY_TABLE_H
#define CLI_SENSITIVITY_TABLE_H

#include "cli/cli.h"
#include "mechanics/independence.h"

/*
 * The sensitivities of the frequencies of one configuration to parameters: exact derivatives of
 * the first vibration modes. A single repeated mode has no derivative; directional values are
 * given instead (eigenvalues of Y^T (dK - lambda dM) Y over the cluster), ascending.
 */
typedef struct mt_sensitivity_table {
    const mt_loaded_model *s;
    int c;
    mt_arena mem;
    mt_lowest_method way; /* NONE: by all modes */
    int bodies;           /* else */
    int n;                /* parameters */
    int *parameter;       /* [n] */
    double *value;        /* [n] in this configuration */
    bool *overridden;     /* [n] overridden by the configuration: no influence */
    int modes;            /* number of vibration modes */
    int unstable;         /* unstable modes of the configuration */
    int *position;        /* [modes] */
    double *hz;           /* [modes] */
    bool *repeated;       /* [modes] */
    int room;             /* leading dimension of per_unit */
    /* room x n: Hz per unit of the parameter; NaN where it has no derivative */
    double *per_unit;
    mt_independence *independence; /* [n] reason for no derivative */
} mt_sensitivity_table;

/* Compute the table. `parameters`: "A,B", or NULL for all that are not expressions of others. v
 * zeroed before; mt_sensitivity_table_free in any case. */
mt_status mt_sensitivity_table_take(const mt_loaded_model *s, int c, const char *parameters,
                                    int modes, mt_sensitivity_table *v, mt_err *err);
void mt_sensitivity_table_free(mt_sensitivity_table *v);
/* Change in Hz of mode i for one per cent more of parameter k. */
double mt_sensitivity_table_per_percent(const mt_sensitivity_table *v, int i, int k);
/* True where the change for 1 % more of parameter k is shown. For a coordinate at or below 0 it
 * is that for 1 mm more. */
bool mt_sensitivity_table_has_percent(const mt_sensitivity_table *v, int k);
/* The shown change [Hz], with rounding as 0. */
double mt_sensitivity_table_shown(const mt_sensitivity_table *v, int i, int k);

#endif
