/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_MODE_PLACEMENTS_ESTIMATES_H
#define SEARCH_MODE_PLACEMENTS_ESTIMATES_H

#include "search/proof.h"

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

/* Finds slopes by differences, in mem. Cost: n + 1 eigensolves of each configuration. Fails:
 * MT_E_MEMORY, as LAPACK. */
mt_status mt_mode_placement_estimates_make(const mt_subproblem *c, const mt_proof *proof,
                                           mt_arena *mem, mt_mode_placement_estimates *out,
                                           mt_err *err);
/* 1/2 c^2, c the estimated change of placement below[n_bands]. */
double mt_mode_placement_estimate(const mt_mode_placement_estimates *e, const int *below);

#endif
