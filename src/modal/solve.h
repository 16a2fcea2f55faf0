/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_SOLVE_H
#define MODAL_SOLVE_H

#include "base/run.h"
#include "modal/mass.h"
#include "modal/modes.h"

/* Optional exact-rank form of K: K = B^T diag(c) B + G with c >= 0, rows x n (column-major, ld
 * rows). With it the lowest modes keep their relative accuracy however much the stiffnesses c
 * differ; without G, rigid-body modes are the null space of B, for any c. G is the part that is
 * not a sum of squares, such as the geometric stiffness of loads: the accuracy is then that of
 * G, independent of the stiffnesses c. Ignored where M is singular. */
typedef struct mt_stiffness_factor {
    int rows;
    const double *b; /* rows x n */
    const double *c; /* [rows], >= 0 */
    /* rows x n: bounds of the errors of the entries, for rows that are small differences of
     * large terms; NULL: rounding of the entries */
    const double *noise;
    const double *g;         /* n x n symmetric, lower read; NULL: none */
    mt_interrupt *interrupt; /* NULL, or checked between the steps: MT_E_INTERRUPTED */
} mt_stiffness_factor;

/*
 * The plain path leaves an error of about eps s on every eigenvalue. Results are guaranteed to
 * a relative 1e-9 or better; this limit leaves the lowest mode two digits for the factors in
 * "about". The factor path costs about three times as much.
 */
#define MT_MODAL_ACCURACY 1e-11

/* A part of the spectrum: the `first` lowest vibration modes and all those up to `up_to`; all
 * modes where both are 0. Includes the whole cluster of the last of them, and all modes without
 * an index: rigid-body, unstable and undecided ones. */
typedef struct mt_modal_part {
    int first;
    double up_to; /* [rad^2/s^2] */
} mt_modal_part;

/*
 * From this order on, and up to this part of them (n / MT_MODAL_PART), some vectors cost less
 * than all: medians of one core with 8 vectors, dsyevd against dsytrd + dsterf + dstein +
 * dormtr [us]:
 * n = 11: 5.7, 10.9; 24: 28, 26; 48: 103, 73; 100: 416, 237; 300: 4546, 2138.
 */
enum { MT_MODAL_PART_ORDER = 32, MT_MODAL_PART = 3 };

typedef struct mt_modal_options {
    int n_rigid;          /* -1: decide here; otherwise the number of rigid-body modes */
    mt_modal_part modes;  /* modes wanted; frequencies alone cost the same for all */
    bool vectors;         /* compute y */
    mt_modal_part shapes; /* of those, modes with shapes; also all of uncertain sign */
    /* above 0, with a factor: use it whenever eps * s / lambda_lowest_flexible exceeds this, or
     * where signs and ranks are not certain */
    double accuracy;
    /* mt_modal_judge follows, which needs shapes only: their errors, error_i / gap, enter the
     * quotients squared */
    bool judged;
    bool check; /* compute residual and orthogonality (with vectors) */
} mt_modal_options;
/* n_rigid -1, all modes, vectors and check on, accuracy 0. */
mt_modal_options mt_modal_options_default(void);

/* Compute the modes. opt NULL: default; factor may be NULL. Results in mem, scratch is
 * returned; repeated calls with mem rewound do not touch the heap. O(n^3), about 11 us for n =
 * 11 with vectors. Method: Cholesky, mt_eig_sym (dsterf and dstein for a few of many modes);
 * dgejsv for the factor. On failure, the caller rewinds mem. Fails: MT_E_MASSLESS
 * (out->massless); MT_E_DOMAIN; MT_E_NO_CONVERGENCE; MT_E_MEMORY. */
mt_status mt_modal_solve(const double *k, const mt_mass_factor *mass,
                         const mt_stiffness_factor *factor, const mt_modal_options *opt,
                         mt_arena *mem, mt_modes *out, mt_err *err);

#endif
