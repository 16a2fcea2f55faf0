/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_TOLERANCE_H
#define PROBLEM_TOLERANCE_H

#include "problem/avoidance.h"
#include "result/result.h"

/*
 * Variables with a tolerance. The true value x' of each is anywhere within |x' - x| <=
 * tolerance |x|, and the goals must hold for all of these.
 *
 * In the search a goal is evaluated at corners x_i (1 -+ tolerance_i), one row of the problem
 * for each corner that may be the worst, so that every row is smooth. The corners are chosen
 * for the bounds of all variables, widened by the tolerances, from enclosures of the
 * derivatives of all coefficients (mt_enclosure_effects; intervals for limits on expressions):
 *     a variable that is shown to stiffen (to soften) everywhere
 *         is at its soft end for "at least" and for modes above a band, at its stiff end for
 *         "at most" and modes below one;
 *     one for which neither is shown
 *         (it enters stiffness and mass, or the sign of its slope depends on the others, or
 *         gravity loads the mechanism) is at either end, in all combinations while these are
 *         few, and the nominal design is evaluated as well.
 * Without variables of the second kind the worst corners are known at every design: two, exact.
 * Otherwise they are samples. Where the search can continue from a design that violates one
 * (some variable has no catalogue), it begins with those that slopes at the original design
 * give for each mode and side (tolerance.c): 2^k analyses become one or two; or, without a
 * budget, with none of them (search/search_tolerances.c). The design at which a search ends is
 * then evaluated over its own tolerances (mt_tolerance_ranges): more signs are proven there,
 * and for the others the worst point is searched. A point worse than the corners is added to
 * them, and the search continues (tolerance_cut.h). Reported ranges are computed again in the
 * same way.
 *
 * The misfit and the objectives, except the clearance, are those of the nominal design. A
 * target (or "equals") is met by the nominal design; with its own "tolerance_percent" it is a
 * range that must hold over the tolerances.
 */
/* A row MT_AT_LEAST is about the lowest value, a row MT_AT_MOST about the highest. */
typedef enum mt_tolerance_side {
    MT_LOWEST = MT_AT_LEAST,
    MT_HIGHEST = MT_AT_MOST,
    MT_TOLERANCE_SIDES
} mt_tolerance_side;

typedef struct mt_tolerance_corner {
    double *factor; /* [n] inputs at the corner / inputs of the design */
    /* candidate for the lowest, the highest frequencies (value of the expression) */
    bool may[MT_TOLERANCE_SIDES];
} mt_tolerance_corner;

/* Corners of a configuration, or of a limit. n = 0: tolerances have no effect. exact: one
 * corner for each side, which is the worst. */
typedef struct mt_tolerance_corners {
    bool exact;
    int n;
    mt_tolerance_corner *corners;
} mt_tolerance_corners;

/* Range of a value over the tolerances of one design: value[MT_LOWEST] <= value <=
 * value[MT_HIGHEST], NaN where it does not exist somewhere; at[side]: [n] inputs where it is
 * reached. */
typedef struct mt_tolerance_range {
    bool proven; /* else sampled */
    double value[MT_TOLERANCE_SIDES];
    double *at[MT_TOLERANCE_SIDES];
} mt_tolerance_range;

/* Corners of a subproblem. */
typedef struct mt_problem_tolerance_box {
    mt_tolerance_corners *views;  /* [n_views of the subproblem] */
    mt_tolerance_corners *limits; /* [n_requirements] */
    double *lower;                /* [n] bounds, widened by the tolerances */
    double *upper;
    /* sampled corners are left out of the views: designs are verified after the search */
    bool sampled_later;
} mt_problem_tolerance_box;

/* Ranges of all values. */
typedef struct mt_ranges {
    int n_views;  /* of the problem */
    int n_limits; /* n_requirements */
    int *n;       /* [n_views] */
    /* [n_views] frequencies [n] of the vibration modes of each configuration that is used */
    mt_tolerance_range **hz;
    mt_tolerance_range *number; /* [n_limits] values of limits on expressions */
    long solutions;             /* modal solutions used */
} mt_ranges;

/* Work of a workspace. */
typedef struct mt_tolerance_work {
    double *x;               /* [n] work */
    double *slope;           /* [n] work */
    double *value;           /* [program.count] work */
    double *grad;            /* program.count rows of n: work */
    const mt_ranges *ranges; /* of the design being described; NULL: not known */
} mt_tolerance_work;

/* Effect of raising a variable. */
enum { MT_FALLS = -1, MT_NOTHING, MT_RISES, MT_UNKNOWN };
/* Makes w->tolerance_box; NULL where no variable has a tolerance. */
mt_status mt_tolerance_work_init(mt_workspace *w, mt_err *err);
/* Half the width of variable i's tolerance, relative to its value. */
double mt_tolerance_of_variable(const mt_problem *p, int i);
/* True where a target (or "equals") is a range over the tolerances. For use before rows are
 * numbered; afterwards see requirement->role. */
bool mt_tolerance_is_range(const mt_problem *p, const mt_requirement *d);
/* Solves the modes at all corners of the design w->x. No effect without
 * tolerances, as the functions below. */
mt_status mt_tolerance_solve(mt_workspace *w, bool with_gradient, mt_err *err);
/* The corners of a configuration; of view -1: of the limit that this requirement is. */
const mt_tolerance_corners *mt_tolerance_corners_of(const mt_subproblem *c, int view,
                                                    int requirement);
/* The next row of `in` from `from` on that is evaluated at a corner; -1: none. */
int mt_tolerance_next_row(const mt_subproblem *c, int from);
/* True where a row at a corner is one of samples. Configurations of cuts along a drive are
 * evaluated at their corners only. */
bool mt_tolerance_row_is_sampled(const mt_subproblem *c, const mt_row *row);
/* True where a limit of the subproblem is evaluated at sampled corners, or will be. */
bool mt_tolerance_is_sampled(const mt_subproblem *c);
/* mt_avoidance_find_modes after the configuration has been solved, over the tolerances where
 * there are any: the value that the objective "clearance" maximises. */
double mt_avoidance_margin(const mt_workspace *w, const mt_avoidance *c);
/* The least over all avoidance goals; infinite without bands, NaN where a configuration is
 * unstable. */
double mt_avoidances_margin(const mt_workspace *w);
/*
 * tolerance_range.c: ranges of the vibration modes of each configuration that goals or bands
 * use, and of the expressions of all limits, over the tolerances of the design w->x, by new
 * analyses; after the configurations have been solved there. Proven where enclosures over these
 * tolerances show every sign; else sampled: corners, interior points, and for the first modes
 * (those that goals name, that bands reach, and at least four) descent from the best of these,
 * to full accuracy where they are limited. In mem. Cost: two analyses where proven, else some
 * hundreds.
 */
mt_status mt_tolerance_ranges(mt_workspace *w, mt_arena *mem, mt_ranges *out, mt_err *err);
/* The same with descent only for values that rows of w's subproblem limit; other ranges come
 * from corners and interior points. leave: [n_views of the problem] configurations to omit;
 * NULL: none. */
mt_status mt_tolerance_ranges_of_rows(mt_workspace *w, const bool *leave, mt_arena *mem,
                                      mt_ranges *out, mt_err *err);
/* Range of vibration mode `mode` of a configuration; NULL: not computed. r may be NULL, as
 * below. */
const mt_tolerance_range *mt_ranges_hz(const mt_ranges *r, int view, int mode);
/* Ranges of the design that is described with w; NULL: not known. */
const mt_ranges *mt_tolerance_known(const mt_workspace *w);
/* True where all ranges are proven. */
bool mt_ranges_proven(const mt_ranges *r);

/* Accuracy of the descent to an extreme after the samples. */
typedef enum mt_tolerance_descent {
    MT_DESCENT_NONE,
    MT_DESCENT_COARSE,
    MT_DESCENT_FINE
} mt_tolerance_descent;

/* tolerance_range.c: the least and greatest of m values over a box, by sampling. */
typedef struct mt_tolerance_probe {
    int n;            /* inputs */
    const double *lo; /* [n] */
    const double *hi;
    int m;
    int n_descend; /* values that are also searched by descent: the first n_descend */
    /* [n_descend][side] accuracy of the descent; NULL: MT_DESCENT_FINE */
    const mt_tolerance_descent (*descents)[MT_TOLERANCE_SIDES];
    void *context;
    /* value[m] at x (with_gradient: slope may be called next). Failures other than memory and
     * internal ones mean that the values do not exist there. */
    mt_status (*eval)(void *context, const double *x, bool with_gradient, double *value,
                      mt_err *err);
    mt_status (*slope)(void *context, int k, double *slope, mt_err *err);
} mt_tolerance_probe;
/* out[m], including `at`; not proven. */
mt_status mt_tolerance_sample(const mt_tolerance_probe *q, mt_arena *mem,
                              mt_tolerance_range *out, mt_err *err);
mt_status mt_tolerance_range_init(int n, mt_arena *mem, mt_tolerance_range *out, mt_err *err);

#endif
