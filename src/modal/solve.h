/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_SOLVE_H
#define MODAL_SOLVE_H

#include "base/interrupt.h"
#include "modal/mass.h"
#include "modal/modes.h"

/* Optional exact-rank form of K: K = B^T diag(c) B + G with c >= 0, rows x n (column-major, ld
 * rows). With it the lowest modes keep their relative accuracy however far the stiffnesses c
 * lie apart; without G, rigid-body modes are found as the null space of B, whatever c is. G is
 * the part that is no sum of squares, as the geometric stiffness of loads: accuracy is then
 * that of G, but no stiffness c costs any of it (loaded.c). Ignored where M is singular. */
typedef struct mt_stiffness_factor {
    int rows;
    const double *b; /* rows x n */
    const double *c; /* [rows], >= 0 */
    /* rows x n: bounds of the entries' errors, for rows that are small differences of large
     * terms; NULL: roundings of the entries themselves */
    const double *noise;
    const double *g;         /* n x n symmetric, lower read; NULL: none */
    mt_interrupt *interrupt; /* NULL, or asked between the steps: then MT_E_INTERRUPTED */
} mt_stiffness_factor;

/*
 * The plain path leaves an error of about eps s on every eigenvalue. Results are promised to a
 * relative 1e-9 or better; at this accuracy the lowest mode still has two digits to spare for
 * the moderate factors in that "about". The factor path costs about three times as much.
 */
#define MT_MODAL_ACCURACY 1e-11

/* A part of the spectrum: the `first` lowest vibration modes and all those up to `up_to`; 0
 * and 0: all. With them all of the cluster in which the last of them stands, and whatever is no
 * vibration with an index: rigid-body, unstable and undecided modes. */
typedef struct mt_modal_part {
    int first;
    double up_to; /* [rad^2/s^2] */
} mt_modal_part;

/*
 * Vectors of a part cost less than those of all from this order on, where the part is so small:
 * medians of one core with 8 vectors, dsyevd against dsytrd + dsterf + dstein + dormtr [us]:
 * n = 11: 5.7, 10.9; 24: 28, 26; 48: 103, 73; 100: 416, 237; 300: 4546, 2138.
 */
enum { MT_MODAL_PART_ORDER = 32, MT_MODAL_PART = 3 };

typedef struct mt_modal_options {
    int n_rigid;          /* -1: decide here; else the number of rigid-body modes */
    mt_modal_part modes;  /* what is asked for; frequencies alone cost the same for all */
    bool vectors;         /* compute y */
    mt_modal_part shapes; /* of those: whose; and of all whose sign is in doubt */
    double accuracy; /* > 0, with a factor: use it whenever eps * s / lambda_lowest_flexible
                           exceeds this, or signs and ranks are in doubt */
    bool judged;     /* mt_modal_judge follows, to which shapes are enough: their errors,
                        error_i / gap, enter the quotients with their square */
    bool check;      /* compute residual and orthogonality (with vectors) */
} mt_modal_options;
/* n_rigid -1, all modes, vectors and check on, accuracy 0. */
mt_modal_options mt_modal_options_default(void);

/* Compute the modes. opt NULL: default; factor may be NULL. Results live in mem, scratch is
 * given back; repeated calls with mem rewound do not touch the heap. O(n^3), about 11 us for
 * n = 11 with vectors.
 * Method: Cholesky, mt_eig_sym (dsterf and dstein for a few of many modes); dgejsv for the
 * factor.
 * On failure, memory taken from mem is the caller's to rewind. Fails: MT_E_MASSLESS
 * (out->massless); MT_E_DOMAIN; MT_E_NO_CONVERGENCE; MT_E_MEMORY. */
mt_status mt_modal_solve(const double *k, const mt_mass_factor *mass,
                         const mt_stiffness_factor *factor, const mt_modal_options *opt,
                         mt_arena *mem, mt_modes *out, mt_err *err);

#endif
