/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_BASIS_H
#define RESPONSE_BASIS_H

#include "modal/modal.h"
#include "response/transfer.h"

/*
 * A forced problem in coordinates of its undamped modes: x = Y a + T b, Y the lowest modes, T
 * the directions without mass. Two parts are eliminated: exactly, directions without mass and
 * damping; statically, by K + i H, the modes left out (their inertia and viscous damping are
 * neglected: relative error about (w/w_left)^2 of their part).
 *
 * The first n_modes coordinates have mass 1, the others (damped directions without mass) have
 * mass 0; among the latter c is diagonal, and the stiffness between both kinds has no real
 * part.
 */
typedef struct mt_basis {
    mt_transfer t;
    const mt_forced *f;
    int n_modes;
    int n_left;         /* modes left out */
    double lowest_left; /* eigenvalue of the lowest of them [rad^2/s^2]; infinite: none */
    double *lambda;     /* [n_modes] eigenvalues; 0 of rigid-body modes */
    double *c;          /* t.n x t.n viscous damping; NULL: none */
    double complex *g;  /* t.n x t.n */
    /* x = X q + U (sum_p s^p follow_b[p] u - W q) in the problem's coordinates; follow_s is the
     * counterpart for the adjoint */
    const double *x;         /* f->n x t.n */
    const double *follow;    /* U: f->n x n_follow */
    const double complex *w; /* n_follow x t.n */
    int n_follow;
    const double complex *follow_b[MT_FORCED_POWERS]; /* n_follow x n_in; NULL: 0 */
    const double complex *follow_s[MT_FORCED_POWERS]; /* n_follow x n_out; NULL: 0 */
} mt_basis;

/* The problem in the caller's coordinates. */
typedef struct mt_basis_problem {
    const mt_forced *f;
    const mt_mass_factor *mass; /* of f->m */
    const mt_modes *modes;      /* of f->k and f->m, all of them, with vectors */
    /* number of lowest modes kept, besides all rigid-body modes; 0, or more than exist: all */
    int keep;
} mt_basis_problem;

/* Results in mem. O(n^3). The transfer is diagonal where Y^T C Y and Y^T H Y are, within the
 * rounding of their entries. Fails: MT_E_USAGE (not all modes, or without vectors),
 * MT_E_SINGULAR (a direction without mass and damping that no stiffness holds), MT_E_DOMAIN,
 * MT_E_MEMORY. */
mt_status mt_basis_make(const mt_basis_problem *p, mt_arena *mem, mt_basis *out, mt_err *err);

#endif
