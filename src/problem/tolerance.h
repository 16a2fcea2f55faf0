/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_TOLERANCE_H
#define PROBLEM_TOLERANCE_H

#include "problem/goal_avoid.h"
#include "result/result.h"

/*
 * Variables with a tolerance. Each of them may turn out anywhere within |x' - x| <= tolerance
 * |x|, and the goals have to hold all the same.
 *
 * In the search a goal is judged at corners x_i (1 -+ tolerance_i), one row of the problem for
 * each corner that may be the worst, so that every row is smooth. Which corners these are is
 * decided over the bounds of ALL variables, widened by the tolerances, by enclosures of the
 * derivatives of all coefficients (mt_enclosure_effects; intervals for limits of expressions):
 *     a variable that is shown to stiffen
 *         (to soften) everywhere stands at its soft end for "at least" and for modes above a
 *         band, at its stiff end for "at most" and modes below one;
 *     one for which neither is shown
 *         (it enters stiffness and mass, or the sign of its slope depends on the others, or
 *         gravity loads the mechanism) stands at either end, in all
 *     combinations while there are few of them, and the design itself is judged as well.
 * Without any of the second kind the corners are the worst there is, at every design: two of
 * them, exact. Otherwise they are samples, and where the search can go on from a design that
 * misses one (some variable is no catalogue), it begins with those that slopes at the original
 * design name for each mode and side (tolerance_first.c): 2^k analyses become one or two. Then
 * a design that the search ends with is judged over its own tolerances (mt_tolerance_ranges):
 * there more signs are proven, and where they are not, the worst is searched within. A point
 * that is worse than the corners becomes one more of them, and the search goes on from there
 * (tolerance_cut.h).
 *
 * What is reported of a design is found anew in the same way.
 *
 * The misfit and the objectives are those of the design itself, but the clearance. A target (or
 * "equals") is met by the design itself; with a "tolerance_percent" of its own it is a range,
 * in which the design stays everywhere over the tolerances.
 */
typedef enum mt_tolerance_side { MT_LOWEST, MT_HIGHEST, MT_TOLERANCE_SIDES } mt_tolerance_side;

typedef struct mt_tolerance_corner {
    double *factor; /* [n] inputs of the corner are factor times the design's */
    /* may be where frequencies (the expression) are lowest, highest */
    bool may[MT_TOLERANCE_SIDES];
} mt_tolerance_corner;

/* Of a view, or of a limit. n = 0: the tolerances do not matter. exact: one corner for each
 * side, and it is the worst. */
typedef struct mt_tolerance_corners {
    bool exact;
    int n;
    mt_tolerance_corner *corners;
} mt_tolerance_corners;

/* A row of `in` that is judged at a corner. */
typedef struct mt_tolerance_row {
    int row;
    int requirement; /* -1: of a band */
    mt_avoidance_row at;
    mt_tolerance_side side;
    int corner;
    double tolerance;
} mt_tolerance_row;

/* What a number does over the tolerances of one design: value[MT_LOWEST] <= it <=
 * value[MT_HIGHEST], NaN where it has none somewhere; at[side]: [n] where that is. */
typedef struct mt_tolerance_range {
    bool proven; /* false: sampled */
    double value[MT_TOLERANCE_SIDES];
    double *at[MT_TOLERANCE_SIDES];
} mt_tolerance_range;

/* Corners and their rows, of a case. */
typedef struct mt_problem_tolerance_box {
    mt_tolerance_corners *views;  /* [n_views of the case] */
    mt_tolerance_corners *limits; /* [n_requirements] */
    int n_rows;
    mt_tolerance_row *rows;
    double *lower; /* [n] bounds, widened by the tolerances */
    double *upper;
} mt_problem_tolerance_box;

/* The same of all numbers. */
typedef struct mt_ranges {
    int n_views;             /* of the problem */
    int n_limits;            /* n_requirements */
    int *n;                  /* [n_views] */
    mt_tolerance_range **hz; /* [n_views] of its vibration modes, [n]; of a view that matters */
    mt_tolerance_range *number; /* [n_limits] of limits on expressions */
    long solutions;             /* modal, that were taken */
} mt_ranges;

/* Of a workspace. */
typedef struct mt_tolerance_work {
    double *x;               /* [n] work */
    double *slope;           /* [n] work */
    double *value;           /* [program.count] work */
    double *grad;            /* program.count rows of n: work */
    const mt_ranges *ranges; /* of the design that is described; NULL: not known */
} mt_tolerance_work;

/*
 * tolerance_first.c: of a view whose signs[n] do not decide the corners, those that slopes name
 * as the worst, for each mode m that a goal limits and each side,
 *     x_i (1 -+ tolerance_i)   by the sign of dlambda_m/dx_i   where the sign is not known,
 * at the design within the bounds that is nearest to the original one. Each once. out->n = 0:
 * none has slopes there. Cost: one analysis. Fails: MT_E_MEMORY, MT_E_INTERNAL.
 */
mt_status mt_tolerance_first(const mt_subproblem *c, int view, const int *signs, mt_arena *mem,
                             mt_tolerance_corners *out, mt_err *err);
/* Factor of input i where it is low (side -1), high (1) or does not matter (0). */
double mt_tolerance_factor(const mt_subproblem *c, int i, int side);
/* What raising a variable does. */
enum { MT_FALLS = -1, MT_NOTHING, MT_RISES, MT_UNKNOWN };
/* c->robust (NULL where no variable has a tolerance), in mem: adds rows to `in` behind those of
 * the bands. known: corners over the same bounds, of another assignment; NULL: none. Fails:
 * MT_E_INPUT where a goal cannot
 * be judged over tolerances, saying why; MT_E_MEMORY, numerical failures. */
mt_status mt_tolerance_init(mt_subproblem *c, const mt_problem_tolerance_box *known,
                            mt_arena *mem, mt_err *err);
/* w->robust; stays NULL where no variable has a tolerance. */
mt_status mt_tolerance_work_init(mt_workspace *w, mt_err *err);
/* Half the width of variable i's tolerance, as a part of its value. */
double mt_tolerance_of_variable(const mt_problem *p, int i);
/* True where a requirement for a target (or "equals") is one for a range over the tolerances.
 * Asked before its rows are numbered; then requirement->ranged. */
bool mt_tolerance_is_range(const mt_problem *p, const mt_requirement *d);
/* tolerance_eval.c: modes of all corners of the design at w->x. Nothing where there are no
 * tolerances, likewise below. */
mt_status mt_tolerance_solve(mt_workspace *w, bool with_gradient, mt_err *err);
/* Fill the rows of all corners. After mt_tolerance_solve and the rows of the design itself,
 * some of which they replace. */
mt_status mt_tolerance_rows(mt_workspace *w, bool with_gradient, mt_nlp_values *out,
                            mt_err *err);
/* The row of `in` that stands on top of the design's own ones; NULL where it is none of
 * these. */
const mt_tolerance_row *mt_tolerance_corner_row(const mt_subproblem *c, int row);
/* True where row i of `in` is judged at a corner (in place of the design itself, or on top). */
bool mt_tolerance_at_corner(const mt_subproblem *c, int i);
/* The limit [Hz] that a row sets a frequency, of a band without the clearance; NaN: it is one
 * on an expression. */
double mt_tolerance_limit_hz(const mt_subproblem *c, const mt_tolerance_row *row);
/* What a row limits: view (-1: of an expression) and mode. */
int mt_tolerance_row_configuration(const mt_subproblem *c, const mt_tolerance_row *row);
int mt_tolerance_row_mode(const mt_subproblem *c, const mt_tolerance_row *row);
/* Room of the row where the number that it limits is `value`: relative, a logarithm of
 * frequencies; negative: it falls short. Without the clearance. */
double mt_tolerance_row_margin(const mt_subproblem *c, const mt_tolerance_row *row,
                               double value);
/* mt_avoidance_margin over all corners, or over the ranges where they are known: modes are
 * paired by their index. */
double mt_tolerance_margin(const mt_workspace *w, const mt_avoidance *c);
/*
 * tolerance_range.c: what the vibration modes of each view that goals or bands look at, and the
 * expressions of all limits, do over the tolerances of the design at w->x, from fresh analyses;
 * after the views have been solved there. Proven where enclosures over these tolerances show
 * every sign; else sampled: corners, points within, and for the first modes (those that goals
 * name, that bands reach, and four at least) descent from the best of them, closely where they
 * are limited. In mem. Cost: two analyses where proven, else some hundreds.
 */
mt_status mt_tolerance_ranges(mt_workspace *w, mt_arena *mem, mt_ranges *out, mt_err *err);
/* The same, where only what the rows of w's case limit is searched by descent: what it may be
 * beside that is as corners and points within have it. leave: [n_views of the problem] views of
 * which nothing is wanted; NULL: none. */
mt_status mt_tolerance_ranges_of_rows(mt_workspace *w, const bool *leave, mt_arena *mem,
                                      mt_ranges *out, mt_err *err);
/* Of vibration mode `mode` of a view; NULL: not computed. r may be NULL, as below. */
const mt_tolerance_range *mt_ranges_hz(const mt_ranges *r, int view, int mode);
/* Of the design that is described with w. */
const mt_ranges *mt_tolerance_known(const mt_workspace *w);
/* Whether all ranges are proven. */
bool mt_ranges_proven(const mt_ranges *r);

/* How closely an extreme is searched for behind the samples. */
typedef enum mt_tolerance_descent {
    MT_DESCENT_NONE,
    MT_DESCENT_COARSE,
    MT_DESCENT_FINE
} mt_tolerance_descent;

/* tolerance_sample.c: the least and greatest of m numbers over a box, sampled. */
typedef struct mt_tolerance_probe {
    int n;            /* inputs */
    const double *lo; /* [n] */
    const double *hi;
    int m;
    int n_descend; /* of the first so many of them by descent too, */
    /* [n_descend][side] as far as this says; NULL: MT_DESCENT_FINE */
    const mt_tolerance_descent (*descents)[MT_TOLERANCE_SIDES];
    void *context;
    /* value[m] at x (slopes may be asked for next where with_gradient). Failures but memory and
     * internal ones mean that the numbers do not exist there. */
    mt_status (*eval)(void *context, const double *x, bool with_gradient, double *value,
                      mt_err *err);
    mt_status (*slope)(void *context, int k, double *slope, mt_err *err);
} mt_tolerance_probe;
/* out[m], `at` filled. Nothing is proven. */
mt_status mt_tolerance_sample(const mt_tolerance_probe *q, mt_arena *mem,
                              mt_tolerance_range *out, mt_err *err);
mt_status mt_tolerance_range_init(int n, mt_arena *mem, mt_tolerance_range *out, mt_err *err);

#endif
