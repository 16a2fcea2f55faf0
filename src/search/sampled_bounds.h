/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_SAMPLED_BOUNDS_H
#define SEARCH_SAMPLED_BOUNDS_H

#include "problem/workspace.h"

/*
 * Mode placements at sampled geometries. Modes cannot be enclosed over variables that shape the
 * geometry, but with these fixed they can over the others (prove/enclosure.h). At each sample
 * of the former, the placements that the others allow, with the limits, are proven, each with a
 * design. This finds placements that are feasible only in a narrow range of the other
 * variables, which samples over all variables miss. Nothing is known between the samples.
 */
typedef struct mt_sampled_bounds {
    /* samples of the geometry; 0: no variable shapes it, or enclosures are not possible for
     * another reason */
    int n;
    int n_settled; /* samples at which every unlisted placement is proven infeasible */
    int n_found;
    int *found; /* [n_found x n_bands] */
    double *at; /* [n_found x n] design t with that placement */
} mt_sampled_bounds;

/* Search w's subproblem with its proof_work at most. Results in mem. Fails: MT_E_MEMORY,
 * MT_E_INTERNAL, numerical failures of LAPACK. */
mt_status mt_sampled_bounds_search(mt_workspace *w, mt_arena *mem, mt_sampled_bounds *out,
                                   mt_err *err);

#endif
