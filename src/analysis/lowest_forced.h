/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_LOWEST_FORCED_H
#define ANALYSIS_LOWEST_FORCED_H

#include "analysis/lowest.h"

/*
 * Forces and motions of a large mechanism in the coordinates of its mode search: x and the
 * amplitudes a of its rigid-body modes, in which
 *     K = diag(H - s H A, 0),    M = diag(H A, I).
 * For a tree H is the identity, s is 0, and A costs O(bodies). Otherwise H = K + s M of the
 * bodies, on the motions that the joints allow, and A = H^-1 M is one solve with its factor; s
 * is 0 where K itself is regular. Sizes are in the norm of H.
 */

/* Prepare, after mt_lowest_new with shapes. *is false: double precision does not resolve the
 * motions. Fails: as mt_sparse_solver_new. */
mt_status mt_lowest_open_forced(mt_lowest *l, bool *is, mt_err *err);
int mt_lowest_coordinates(const mt_lowest *l); /* number of x */
int mt_lowest_free(const mt_lowest *l);        /* number of a */
double mt_lowest_shift(const mt_lowest *l);    /* s [rad^2/s^2] */
/* x of vibration mode i, of arbitrary size. */
const double *mt_lowest_mode(const mt_lowest *l, int i);
/* H x, in work[coordinates] or x itself. */
const double *mt_lowest_dual(const mt_lowest *l, const double *x, double *work);

/* The response of x and a to a force. */
typedef struct mt_lowest_push {
    double *x;    /* [coordinates] H^-1 times the force */
    double *dual; /* [coordinates] the force by its work on x; NULL: equal to x */
    double *a;    /* [free] */
    double size;  /* |x| before the part of the rigid-body modes is subtracted */
    double noise; /* rounding of x in the norm of H, and of its products with modes */
    double loose; /* rounding of a */
} mt_lowest_push;

/* Allocate the arrays in mem; the arena notes a shortage. */
void mt_lowest_push_init(const mt_lowest *l, mt_arena *mem, mt_lowest_push *p);
/* Of the force[nq] on all states. Fails: MT_E_INTERRUPTED. */
mt_status mt_lowest_force(const mt_lowest *l, const double *force, mt_lowest_push *p,
                          mt_err *err);
/* Of M times the translation of all bodies by -1 along a global axis. */
mt_status mt_lowest_base(mt_lowest *l, int axis, mt_lowest_push *p, mt_err *err);
/* x := its projection, in the norm of H, on the motions that the joints allow, without
 * rigid-body modes: differences of large motions may leave them by rounding. */
mt_status mt_lowest_admit(const mt_lowest *l, double *x, mt_err *err);
/* y := A x. Fails: MT_E_INTERRUPTED. */
mt_status mt_lowest_mass(const mt_lowest *l, const double *x, double *y, mt_err *err);
/* y := H A x. */
mt_status mt_lowest_momentum(const mt_lowest *l, const double *x, double *y, mt_err *err);

#endif
