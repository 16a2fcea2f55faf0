/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_SOLUTIONS_H
#define RESPONSE_SOLUTIONS_H

#include "response/basis.h"

/*
 * Solutions x = D^-1 B u and adjoints y = D^-1 S^T of one input and one output at many
 * frequencies, in the coordinates of the problem.
 */
typedef struct mt_solutions {
    const mt_basis *basis; /* not owned */
    mt_transfer one;       /* the transfer of that pair alone */
    int in;
    int out;
} mt_solutions;

/* Real and imaginary parts, each n x count. */
typedef struct mt_solved {
    double *x[2];
    double *y[2];
} mt_solved;

/* Solutions at w [rad/s] for all inputs and outputs: x (n x n_in) and y (n x n_out). *singular:
 * D is singular, x and y are not set. Fails: MT_E_DOMAIN, MT_E_MEMORY. */
mt_status mt_basis_solve(const mt_basis *b, double w, double complex *x, double complex *y,
                         bool *singular, mt_arena *scratch, mt_err *err);
/* Results in mem; refers to the basis. Fails: MT_E_MEMORY. */
mt_status mt_solutions_open(const mt_basis *basis, int out, int in, mt_arena *mem,
                            mt_solutions *s, mt_err *err);
/* At w: x[n], y[n], and the value h of the response, infinite where it has none (transfer.h).
 * *singular: x and y are not set. Fails: MT_E_DOMAIN, MT_E_MEMORY. */
mt_status mt_solutions_one(const mt_solutions *s, double w, double complex *x,
                           double complex *y, double complex *h, bool *singular,
                           mt_arena *scratch, mt_err *err);
/* At w[count]. *singular: D is singular at one of them. O(n^2) for each where damping is
 * diagonal. Fails: MT_E_DOMAIN, MT_E_MEMORY. */
mt_status mt_solutions_at(const mt_solutions *s, int count, const double *w,
                          const mt_solved *out, bool *singular, mt_arena *scratch, mt_err *err);

#endif
