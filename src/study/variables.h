/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_VARIABLES_H
#define STUDY_VARIABLES_H

#include "io/members.h"
#include "model/model.h"

/* Rows of which one is taken: the n variables that share them, neighbours in the study, are
 * set together. */
typedef struct mt_catalogue_rows {
    const char *catalogue; /* its name */
    int n;
    int n_rows;
    const double *value;      /* [n_rows x n] in ascending order, by the first column first */
    const int *number;        /* [n_rows] in the catalogue, from 1 */
    const char *const *names; /* [n_rows]; NULL: they have none */
} mt_catalogue_rows;

typedef struct mt_variable {
    mt_name parameter_name;
    int parameter;
    double lower; /* continuous: both bounds are required, lower < upper */
    double upper;
    int n_catalogue;   /* > 0: discrete */
    double *catalogue; /* ascending after finish; of rows the different values of the column */
    mt_name catalogue_name;  /* as read: takes rows of it, until finish */
    mt_name_list columns;    /* as read: its columns, and the parameters that these set */
    mt_name_list parameters; /* as many; by_order: columns in the order of the catalogue */
    bool by_order;
    const mt_catalogue_rows *rows; /* by finish; NULL: its values stand alone */
    int column;                    /* of rows */
    double weight;                 /* weight of its change in the total change; default 1 */
    /* scale of its change, (new - original)/scale; NaN: ln(new/original), or range */
    double scale;
    double range; /* scale of its change where the change has no logarithm; by finish */
    double tolerance_percent; /* of a search over tolerances; NaN: none */
    double original;          /* the model's value; by finish */
    const mt_unit *shown;     /* unit in which its numbers are shown; NULL: SI; by finish */
    mt_addr addr;
} mt_variable;

/* Values of a catalogue, and of one that a rule gives instead of a list. */
enum { MT_MAX_CATALOGUE = 10000 };
/* Parameters that one row sets. */
enum { MT_MAX_ROW_VARIABLES = 64 };

/* Preferred numbers of IEC 60063. */
#define MT_SERIES_LIST(X) \
    X(3)                  \
    X(6)                  \
    X(12)                 \
    X(24)                 \
    X(48)                 \
    X(96)                 \
    X(192)

#define MT_SERIES_ENUM(n) MT_SERIES_E##n,
enum { MT_SERIES_LIST(MT_SERIES_ENUM) MT_SERIES_COUNT };
#undef MT_SERIES_ENUM
/* "E3" ... "E192" */
extern const char *const mt_series_names[MT_SERIES_COUNT];

/**
 * The values of an E series from lower to upper, both included, ascending. Bounds that miss a
 * value by rounding (1e-12, relative) include it.
 * @param[in]  which     position in mt_series_names
 * @param[out] values up to `most` of them, each the double nearest to the decimal number; NULL:
 *   only counted
 * Returns their number, MT_MAX_CATALOGUE + 1 where there are more than MT_MAX_CATALOGUE; 0
 * where lower is not above 0 or a bound is not finite.
 */
int mt_catalogue_series(int which, double lower, double upper, int most, double *values);
/**
 * The values lower, lower + step, ... up to upper, which is included where a step hits it
 * within 1e-9 of a step. Returns as mt_catalogue_series; 0 where step is not above 0.
 */
int mt_catalogue_steps(double step, double lower, double upper, int most, double *values);

extern const mt_key_table mt_study_variable_keys;
extern const mt_key_table mt_study_catalogue_keys;

struct mt_study_check;
void mt_study_check_variables(struct mt_study_check *c);
/* Note variables that every configuration of the goals overrides; after the goals. */
void mt_study_check_overrides(struct mt_study_check *c);

#endif
