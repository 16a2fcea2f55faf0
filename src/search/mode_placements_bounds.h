/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_MODE_PLACEMENTS_BOUNDS_H
#define SEARCH_MODE_PLACEMENTS_BOUNDS_H

#include "search/mode_placements.h"

/*
 * Estimates of the change that mode placements take, of first order at the original: an order
 * to search in, and no bound. f_j: frequencies of all configurations one after the other.
 */
typedef struct mt_mode_placement_estimates {
    const mt_subproblem *c;
    const mt_proof *proof;
    int n_modes;
    double *ln_f;     /* [n_modes] at the original, brought within the bounds; NaN: not known */
    double *gradient; /* [n_modes x n] of ln f_j in u_i = sqrt(w_i) (t_i - t_i(original)) */
    /* work */
    double *u;     /* [n] */
    double *least; /* [n_modes] what a placement asks of ln f_j */
    double *most;
    double *multiplier; /* [2 n_modes] */
} mt_mode_placement_estimates;

/*
 * Lower bounds of the total change that a mode placement needs. Of the coordinates of a design
 * whose total change is at most c,
 *
 *     u_i = sqrt(w_i) (t_i - t_i(original)),   sum u_i^2 <= c^2,
 *
 * at most one exceeds c / sqrt(2): the design lies in one of n boxes, in each of which one
 * coordinate extends to c and the others to c / sqrt(2). Over a box every mode has a least and
 * a greatest frequency (prove/box.h; with K and M sums of positive terms, |ln lambda - ln
 * lambda0| <= max |ln k/k0| + max |ln m/m0|). A placement that no box allows needs more than c.
 * c grows in levels; the level of a placement is the first at which a box allows it.
 */
typedef struct mt_mode_placement_bounds {
    const mt_subproblem *c;
    int n_levels; /* boxes of the last level cover all bounds */
    /* [n_levels + 1] 1/2 c^2 of the level before: lower bound for its placements */
    double *least;
    int n_boxes; /* n, or one with c in all coordinates */
    int most;    /* largest number of modes of a configuration */
    /* [n_boxes] first level at which each frequency limit, taken alone, can be met */
    int *any;
    /* [n_boxes x n_bands x (most + 1)] first level for each band (the first of tied ones) and
     * number of modes below it; n_levels: proven infeasible */
    int *level;
    mt_mode_placement_estimates estimates;
} mt_mode_placement_bounds;

/* Computes the bounds, in mem. *known false: not available (no enclosures, another first
 * objective, or so many modes that they would cost more than `work`). Fails: MT_E_MEMORY, as
 * LAPACK. */
mt_status mt_mode_placement_bounds_make(const mt_subproblem *c, const mt_proof *proof,
                                        double work, mt_arena *mem,
                                        mt_mode_placement_bounds *out, bool *known,
                                        mt_err *err);
/*
 * Placements that are not proven infeasible, by ascending lower bound out->least of the first
 * objective, at most `most`, in whole levels. *rest: lower bound of all others; HUGE_VAL: all
 * others are infeasible. Placements that violate the order of bands, or differ between
 * positions of a drive, are excluded. No starts are given. In mem. Fails: MT_E_MEMORY.
 */
mt_status mt_mode_placement_bounds_list(const mt_mode_placement_bounds *b, int most,
                                        mt_arena *mem, mt_mode_placement_candidates *out,
                                        double *rest, mt_err *err);
/* Sort candidates by that bound, which becomes c->least, equal ones by c->estimate; `at` and
 * n_proven follow. */
mt_status mt_mode_placement_bounds_sort(const mt_mode_placement_bounds *b,
                                        mt_mode_placement_candidates *c, mt_arena *mem,
                                        mt_err *err);

#endif
