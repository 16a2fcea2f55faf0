/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_DERIVATIVE_H
#define MODAL_DERIVATIVE_H

#include "base/arena.h"
#include "modal/modes.h"

/*
 * Derivatives. For a parameter p the caller gives products with the chosen modes: dky = (dK/dp)
 * y_i, dmy = (dM/dp) y_i, one column of n entries per mode. dmy may be NULL everywhere: M does
 * not depend on p.
 */
/* For a cluster: the symmetric r x r matrix Y^T (dK - lambda dM) Y (lambda: mean of the
 * cluster), whose eigenvalues are the directional derivatives of the cluster. first: its first
 * position, r its size; dky, dmy n x r. Fails: MT_E_MEMORY. */
mt_status mt_modal_dcluster(const mt_modes *modes, int first, int r, const double *dky,
                            const double *dmy, double *out, mt_arena *scratch, mt_err *err);

/* np parameters at one mode: column p is the product of dK/dp_p (dM/dp_p) with that mode. */
typedef struct mt_directions {
    int np;
    const double *dky; /* n x np */
    const double *dmy; /* n x np or NULL */
} mt_directions;

/*
 * Derivatives of the mass-normalised vector of a simple mode with constant sign: dy n x np,
 * dlambda np (may be NULL).
 *
 * Expansion in all other modes (Fox and Kapoor 1968; exact with all modes): two small products
 * per mode, the fastest method when a solve has given all vectors. Fails: MT_E_SINGULAR at a
 * mode of a cluster (dy is NaN then), MT_E_USAGE without vectors or with condensed directions.
 */
mt_status mt_modal_dvector_by_modes(const mt_modes *modes, int i, const mt_directions *dir,
                                    double *dy, double *dlambda, mt_arena *scratch,
                                    mt_err *err);

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

/*
 * Derivatives of sums over a cluster C (first, r modes; one mode, or several of one
 * eigenvalue), of which the single vectors have none: with any Q, and b_i = (Q + Q^T) y_i,
 *     d sum_i y_i^T Q y_i = sum_i [y_i^T dQ y_i - x_i . (dK - lambda dM) y_i
 *                                  - 1/2 sum_k (y_k . b_i) (y_k . dM y_i)],
 *     (K - lambda M) x_i = b_i - M Y_C Y_C^T b_i,   Y_C^T M x_i = 0.
 * x := x_i of b, n entries each, for all inputs at once: by all modes where there are all
 * vectors, otherwise by a bordered system (as above, with a column for each mode of C). Fails:
 * MT_E_SINGULAR (another mode at rounding's distance), MT_E_MEMORY.
 */
mt_status mt_modal_adjoint(const mt_pencil *p, const mt_modes *modes, int first, int r,
                           const double *b, double *x, mt_arena *scratch, mt_err *err);

#endif
