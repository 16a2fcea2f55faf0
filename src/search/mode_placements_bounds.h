/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_MODE_PLACEMENTS_BOUNDS_H
#define SEARCH_MODE_PLACEMENTS_BOUNDS_H

#include "search/mode_placements.h"

/*
 * The least change that a gap assignment takes. Of the coordinates of a design whose total
 * change is at most c,
 *
 *     u_i = sqrt(w_i) (t_i - t_i(original)),   sum u_i^2 <= c^2,
 *
 * one at most is beyond c / sqrt(2): it lies in one of n boxes, in which one coordinate goes to
 * c and the others to that. Over a box every mode has a least and a greatest frequency
 * (prove/box.h; with K and M sums of positive terms, |ln lambda - ln lambda0| <= max |ln k/k0|
 * + max |ln m/m0|). An assignment that none of the boxes allows takes more than c. Changes grow
 * in levels; the level of an assignment is the first at which a box allows it.
 */
typedef struct mt_mode_placement_bounds {
    const mt_subproblem *c;
    int n_levels;  /* the last one's boxes are all of the bounds */
    double *least; /* [n_levels + 1] 1/2 c^2 of the level before: no design of it has less */
    int n_boxes;   /* n, or one with c in all coordinates */
    int most;      /* modes of any configuration */
    int *any;      /* [n_boxes] level at which limits of frequencies can be met, each alone */
    /* [n_boxes x n_bands x (most + 1)] of each band (its first one, of those that are tied);
     * n_levels: proven impossible */
    int *level;
} mt_mode_placement_bounds;

/* *known is false where there are none: no enclosures, another first objective, or so many
 * modes that they would cost more than `work`. In mem. Fails: MT_E_MEMORY, as LAPACK does. */
mt_status mt_mode_placement_bounds_make(const mt_subproblem *c, const mt_proof *proof,
                                        double work, mt_arena *mem,
                                        mt_mode_placement_bounds *out, bool *known,
                                        mt_err *err);
/*
 * The assignments that are not proven impossible, the least first (out->least: no design with
 * it has less of the first objective), at most `most`: whole levels. *rest: no other has less;
 * HUGE_VAL: all others are impossible. Assignments that break the order of bands, or between
 * positions of a drive, are none. Without designs to start from. In mem. Fails: MT_E_MEMORY.
 */
mt_status mt_mode_placement_bounds_list(const mt_mode_placement_bounds *b, int most,
                                        mt_arena *mem, mt_mode_placement_candidates *out,
                                        double *rest, mt_err *err);
/* Candidates in that order; `at` and n_proven are kept up. out->least of each. */
mt_status mt_mode_placement_bounds_sort(const mt_mode_placement_bounds *b,
                                        mt_mode_placement_candidates *c, mt_arena *mem,
                                        mt_err *err);

#endif
