/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_MODAL_PRIV_H
#define MODAL_MODAL_PRIV_H

#include "linalg/dense.h"
#include "modal/damped.h"

/*
 * Tolerances of this room. eps = DBL_EPSILON.
 *
 * NOISE_ULPS n eps s is what a dense symmetric solution may leave on an eigenvalue that is
 * zero: dsyevd's backward error is a small multiple of n eps |lambda|max, and forming
 * L^-1 K L^-T perturbs it by up to about n eps max_i |K_ii| (M^-1)_ii, which oblique
 * coordinates make the larger one. s is the larger of the two scales. Measured: at most
 * 0.8 n eps s over 60,000 random free chains of 2 to 16 masses, in their own and in oblique
 * coordinates (there |lambda|max alone would be short by up to 1e7). 16 leaves room for entries
 * of K that were assembled with roundings of their own.
 *
 * The same 16 n eps, applied to matrices scaled to unit diagonal, decides whether a direction
 * has mass, whether a direction without mass has stiffness, and whether rows of a stiffness
 * factor are independent. A coordinate has no mass of its own where
 * m_ii <= (16 n eps)^2 max m: a constraint null space that is orthogonal to rounding leaves
 * entries of size eps in place of zeros, and m is quadratic in them.
 */
static const double MT_MODAL_NOISE_ULPS = 16.0;

/* 16 n eps. */
double mt_modal_tolerance(int n);
/* Relative error of an eigenvalue due to the entries of the matrices: an entry of K or M is a
 * sum of rounded products (a spring's elongation through a loop of joints has a few dozen
 * roundings), for any n. Measured: 33 eps, a four-bar of one freedom, among 1500 random
 * mechanisms. */
double mt_modal_relative(int n);

/* Fill lambda, y (where wanted), n_condensed..., scale from K restricted to directions with
 * mass. Kinds, clusters, sign and checks come later. later (may be NULL) is filled where y is
 * left to mt_modal_plain_lowest, which computes out->shaped vectors; otherwise later->n is
 * 0. */
mt_status mt_modal_plain(const double *k, const mt_mass_factor *mass, mt_arena *scratch,
                         mt_modes *out, mt_tridiagonal *later, mt_err *err);
mt_status mt_modal_plain_lowest(const double *k, const mt_mass_factor *mass,
                                const mt_tridiagonal *later, mt_arena *scratch, mt_modes *out,
                                mt_err *err);
/* As mt_modal_plain with K = B^T diag(c) B and regular M: *null_count eigenvalues are exactly
 * zero. */
mt_status mt_modal_by_factor(const mt_stiffness_factor *factor, const mt_mass_factor *mass,
                             mt_arena *scratch, mt_modes *out, int *null_count, mt_err *err);
/* Factor D C of rank >= 1, C^T in ct (n x rows, destroyed), D = diag(d), as U w Q1^T: U
 * orthonormal, Q1 the first rank columns of q, with its row i at coordinate place[i]. */
typedef struct mt_graded {
    int n;
    int rows;
    int rank;
    const double *d; /* [rows] */
    double *ct;
    int *place; /* [n] in: coordinate in each row of ct; out: see above */
    mt_qr q;    /* out */
    double *w;  /* out: rank x rank, zero on entry */
    mt_interrupt *interrupt;
} mt_graded;
mt_status mt_modal_graded(mt_graded *g, mt_arena *mem, mt_err *err);
/* Y := T1 Q: from the coordinates in which M is the identity to the caller's. q, y n x count;
 * the same array only where mass->t is NULL. Regular M only. */
void mt_modal_back(const mt_mass_factor *mass, int count, const double *q, double *y);
/* After mt_modal_by_factor with y: modes of B^T diag(c) B + G from those without G; G n x n
 * symmetric, lower read. */
mt_status mt_modal_add_load(const double *g, const mt_mass_factor *mass, mt_arena *scratch,
                            mt_modes *out, mt_err *err);
/* Set kinds, n_rigid, n_unstable, and lambda of rigid-body modes; n_rigid < 0: decide here.
 * n_held: given rigid-body modes above the noise. Returns the greatest |lambda| of a given
 * rigid-body mode. noise[count]: at most this is 0 (NULL: error_bound); strained[count]: not 0
 * where springs are strained (NULL: unknown). */
double mt_modal_classify(mt_modes *modes, int n_rigid, const double *noise,
                         const bool *strained);
/* Without a factor, a given rigid-body mode counts as held above HELD times the noise: the
 * residual of an equilibrium found by iteration stays below that on a null direction (the
 * mechanics room takes forces of up to 1e4 times the rounding of the positions as none). */
static const double MT_MODAL_HELD = 1e4;
/* Find clusters; after the kinds. */
void mt_modal_find_clusters(mt_modes *modes);
/* Fill residual and orthogonality. */
mt_status mt_modal_check(const double *k, const mt_mass_factor *mass, mt_arena *scratch,
                         mt_modes *modes, mt_err *err);
/* K restricted to directions with mass, the others condensed: a (rank x rank, full), t1 (n x
 * rank) with Y = t1 Q. Fails MT_E_MASSLESS. */
mt_status mt_modal_condense(const double *k, const mt_mass_factor *mass, mt_arena *scratch,
                            double *a, double *t1, mt_modes *out, mt_err *err);

/* Refine s and fill the residual of damped modes. */
mt_status mt_damped_check(const mt_damped_problem *p, mt_damped_modes *out, mt_arena *mem,
                          mt_err *err);

#endif
