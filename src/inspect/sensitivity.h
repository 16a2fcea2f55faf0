/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef INSPECT_SENSITIVITY_H
#define INSPECT_SENSITIVITY_H

#include "analysis/analysis.h"
#include "inspect/loaded_model.h"
#include "io/write_json.h"

/* How far parameters move the frequencies of one configuration: what `sensitivity` tells, as
 * records. */

/* Modes, where no number is given. */
enum { MT_SENSITIVITY_MODES = 6 };

typedef struct mt_sensitivity_question {
    const char *parameters; /* "A,B"; NULL: all that are not expressions of others */
    int modes;
} mt_sensitivity_question;

/* Fails where a parameter is not there: MT_E_USAGE; MT_E_MEMORY. */
mt_status mt_sensitivity_question_admit(mt_loaded_model *s, const mt_sensitivity_question *q,
                                        mt_err *err);

/*
 * The sensitivities of the frequencies of one configuration to parameters: exact derivatives of
 * the first vibration modes. A single repeated mode has no derivative; directional values are
 * given instead (eigenvalues of Y^T (dK - lambda dM) Y over the cluster), ascending.
 */
typedef struct mt_sensitivity_view {
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
} mt_sensitivity_view;

/* Answer for configuration c. v zeroed before; mt_sensitivity_view_free in any case; s must
 * outlive v. Fails: as an analysis of the configuration; MT_E_INPUT (no parameters). */
mt_status mt_sensitivity_view_take(const mt_loaded_model *s, int c,
                                   const mt_sensitivity_question *question,
                                   mt_sensitivity_view *v, mt_err *err);
void mt_sensitivity_view_free(mt_sensitivity_view *v);

/* What one parameter does to one mode. */
typedef struct mt_slope_row {
    const char *parameter;
    const char *unit;
    double value;
    double hz_per_percent;
    double hz_per_unit;
} mt_slope_row;

extern const mt_record mt_slope_record;
mt_slope_row mt_slope_row_of(const mt_sensitivity_view *v, int i, int k);

/* A mode, with what all parameters do to it. */
typedef struct mt_sensitive_mode_row {
    int index;
    double hz;
    bool repeated;
    mt_slope_row *slopes;
    int n;
} mt_sensitive_mode_row;

extern const mt_record mt_sensitive_mode_record;
/* Without slopes. */
mt_sensitive_mode_row mt_sensitive_mode_row_of(const mt_sensitivity_view *v, int i);

/* A parameter by which no frequency has a derivative. */
typedef struct mt_no_derivative_row {
    const char *parameter;
    const char *reason;
    mt_joints_row joints;
} mt_no_derivative_row;

/* A configuration, answered. */
typedef struct mt_sensitivity_row {
    const char *configuration;
    mt_lowest_method method;
    mt_sensitive_mode_row *modes;
    int n_modes;
    mt_no_derivative_row *without;
    int n_without;
} mt_sensitivity_row;

extern const mt_record mt_sensitivity_record;
/* Write all of it as JSON. Fails: MT_E_MEMORY. */
mt_status mt_sensitivity_put(mt_sensitivity_view *v, mt_json_writer *w, mt_err *err);

/* True where parameter k has no derivative: why, says v->independence. */
bool mt_sensitivity_has_none(const mt_sensitivity_view *v, int k);

#endif
