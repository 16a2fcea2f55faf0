/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_ROWS_H
#define PROBLEM_ROWS_H

#include <stdbool.h>

#include "base/arena.h"
#include "nlp/nlp.h"

/*
 * The rows of a subproblem: one entry for each residual, equality and inequality of its search
 * problem (nlp/nlp.h), in their order, with what the row requires of which value. They are laid
 * out in one pass (mt_subproblem_lay_out), kind by kind, and evaluated by one operation of each
 * kind (mt_row_ops). Other code asks the entries and does not compute indices.
 */
struct mt_subproblem;
struct mt_workspace;
struct mt_cut;
struct mt_problem_tolerance_box;

/* X(id, name): the kinds in the order of their rows; the operations of each are
 * mt_rows_<name>. */
#define MT_ROW_KIND_LIST(X)                                                                 \
    X(GOAL, goals)          /* residuals, target or limits of a requirement */              \
    X(BAND, bands)          /* a mode beside a band, by the mode placement */               \
    X(VIBRATION, vibration) /* a part of a goal in the objective "vibration" */             \
    X(POSITION, positions)  /* a limit at a further position of a drive */                  \
    X(CORNER, corners) /* a limit or band at a corner of the tolerances; where it is the  \
                               worst corner it replaces the row of the design itself */ \
    X(ORDER, order)    /* a mode beyond a limited one */                                    \
    X(HELD, held)      /* an earlier objective */
#define MT_ROW_KIND_ENUM(id, name) MT_ROW_##id,
typedef enum mt_row_kind { MT_ROW_KIND_LIST(MT_ROW_KIND_ENUM) MT_ROW_KINDS } mt_row_kind;
#undef MT_ROW_KIND_ENUM

/* What a row requires of a value: MT_AT_LEAST and MT_AT_MOST are rows of `in` or `next`,
 * MT_EQUAL of `eq` or `res`. */
typedef enum mt_row_sense { MT_AT_LEAST, MT_AT_MOST, MT_EQUAL } mt_row_sense;

typedef struct mt_row {
    mt_row_kind kind;
    mt_row_sense sense;
    int requirement; /* index in the subproblem; -1: of a band, of an objective */
    int part;        /* of a requirement with several values, from 0 */
    int avoidance;   /* index in the subproblem; -1: not of a band */
    int band;        /* of its list */
    int view;        /* configuration or position; -1: an expression, an objective */
    int mode;        /* vibration index; 0: by name, or no mode */
    int corner;      /* of the tolerances; -1: the design itself */
    int objective;   /* index of the stage that is held; -1: none */
    int implied_by;  /* the row of `in` from which this row of `next` follows; -1: none */
    double limit;    /* in the unit of the value; a held value is in its stage */
    double tolerance;
} mt_row;

typedef struct mt_row_block {
    int n;
    int room;
    mt_row *rows; /* [n] */
    double *tol;  /* [n] their tolerances, as the search problem reads them */
} mt_row_block;

typedef struct mt_row_span {
    int first;
    int n;
} mt_row_span;

typedef struct mt_row_table {
    mt_row_block res; /* tolerances are not used */
    mt_row_block eq;
    mt_row_block in;
    mt_row_block next;
    int *next_of; /* [next.n] implied_by, as the search problem reads it */
    /* [n_requirements] rows of a requirement in the block of its role (problem.h) */
    mt_row_span *of;
    mt_row_span of_kind[MT_ROW_KINDS]; /* rows of a kind in `in`, as laid out */
} mt_row_table;

/* What rows are laid out for. */
typedef struct mt_row_layout {
    struct mt_subproblem *c;
    const int *below; /* mode placement; NULL: none */
    int n_cuts;
    const struct mt_cut *cuts;
    /* corners for the same bounds, of another mode placement; NULL: none */
    const struct mt_problem_tolerance_box *known;
    mt_arena *mem;
} mt_row_layout;

/* The operations of a kind, in one file each. */
typedef struct mt_row_ops {
    /* Appends the rows of the kind. NULL: they are appended otherwise. */
    mt_status (*lay_out)(const mt_row_layout *l, mt_err *err);
    /* Fills their values and, with_gradient, slopes, after the configurations and corners have
     * been solved. NULL: another kind's operation does. */
    mt_status (*eval)(struct mt_workspace *w, bool with_gradient, mt_nlp_values *out,
                      mt_err *err);
} mt_row_ops;
#define MT_ROW_OPS(id, name) extern const mt_row_ops mt_rows_##name;
MT_ROW_KIND_LIST(MT_ROW_OPS)
#undef MT_ROW_OPS

/* 1 for MT_AT_LEAST, -1 for MT_AT_MOST: the sign of the value in the row. */
static inline double mt_row_sign(const mt_row *row)
{
    return row->sense == MT_AT_MOST ? -1.0 : 1.0;
}

#endif
