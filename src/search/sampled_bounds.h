/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_SAMPLED_BOUNDS_H
#define SEARCH_SAMPLED_BOUNDS_H

#include "problem/workspace.h"

/*
 * Where variables shape the geometry, nothing encloses modes over them; where these are held,
 * the others can be enclosed (prove/enclosure.h). A slice holds them at a sample: which gap
 * assignments the others can have there, with the limits, is proven, and each comes with a
 * design. Kinds of design that are narrow in the other variables are found so that samples of
 * all of them miss; between slices nothing is known.
 */
typedef struct mt_sampled_bounds {
    int n;         /* so many samples of the geometry; 0: no variable shapes it, or all is in
                    * the way of an enclosure besides */
    int n_settled; /* of them: all assignments that are not listed are proven infeasible */
    int n_found;
    int *found; /* [n_found x n_bands] */
    double *at; /* [n_found x n] coordinates t of a design that has it */
} mt_sampled_bounds;

/* Of w's case, with its proof_work at most. Results in mem. Fails: MT_E_MEMORY, MT_E_INTERNAL,
 * numerical failures of LAPACK. */
mt_status mt_sampled_bounds_search(mt_workspace *w, mt_arena *mem, mt_sampled_bounds *out,
                                   mt_err *err);

#endif
