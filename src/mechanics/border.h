/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_BORDER_H
#define MECHANICS_BORDER_H

#include "mechanics/saddle.h"

/*
 * The saddle-point system of a trimmed stage, by the factor of the one in which the drive is
 * held by its multiplier: the last equation stays, what holds it is a force tau along t,
 *     [ H   A_1^T  t ] [ x ]   [ f   ]
 *     [ A_1   0    0 ] [ y ] = [ b_1 ]
 *     [ a_d   0    0 ] [tau]   [ b_d ].
 */
typedef struct mt_border {
    mt_saddle s;         /* factored */
    const double *along; /* [nq] t; NULL: nothing is trimmed */
    double *x_along;     /* [nq], [m] of S^-1 (t, 0) */
    double *y_along;
    double *x_drive; /* [nq], [m] of S^-1 (0, e_d) */
    double *y_drive;
    double pivot; /* t . x_drive */
} mt_border;

/* For the factored s, with t in `along`, which is kept. *sure: the inverse of the whole, in
 * scaled units, is below `most` as far as the border goes. Results in mem. Fails:
 * MT_E_MEMORY. */
mt_status mt_border_init(const mt_saddle *s, const double *along, double most, mt_arena *mem,
                         mt_border *out, bool *sure, mt_err *err);
/* f [nq], b [m]; x [nq], y [m], whose last entry is 0, and tau. */
mt_status mt_border_solve(const mt_border *border, const double *f, const double *b, double *x,
                          double *y, double *tau, mt_arena *scratch, mt_err *err);
/* The transposed system: t . x = pull, and a multiplier for the drive's equation in y. */
mt_status mt_border_adjoint(const mt_border *border, const double *f, const double *b,
                            double pull, double *x, double *y, mt_arena *scratch, mt_err *err);

#endif
