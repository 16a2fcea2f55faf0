/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_BORDERED_H
#define MODAL_BORDERED_H

#include "modal/derivative.h"

/* The two matrices of the eigenproblem K y = lambda M y. */
typedef struct mt_pencil {
    int n;
    const double *k;
    const double *m;
} mt_pencil;

/*
 * Derivatives of one mode by the bordered system (Lee and Jung 1997), valid for a simple mode
 * of any kind, also with singular M:
 *   [K - lambda M   -M y] [dy     ]   [-(dK - lambda dM) y]
 *   [-y^T M          0  ] [dlambda] = [ 1/2 y^T dM y       ]
 * One factorisation, np right-hand sides. Fails: MT_E_SINGULAR at a repeated mode (reciprocal
 * condition of the scaled system at rounding level; dy is NaN then).
 */
mt_status mt_modal_dvector(const mt_pencil *p, double lambda, const double *y,
                           const mt_directions *dir, double *dy, double *dlambda,
                           mt_arena *scratch, mt_err *err);

#endif
