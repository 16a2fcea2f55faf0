/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_LOWEST_FORCED_H
#define ANALYSIS_LOWEST_FORCED_H

#include "analysis/lowest.h"

/*
 * Forces and motions of a large mechanism, in the coordinates of its modes' search: x, and the
 * amplitudes a of its rigid-body modes, with which x has no mass in common:
 *     K = diag(H - s H A, 0),    M = diag(H A, I).
 * Of a tree H is the identity, s is 0, and A costs O(bodies); else H = K + s M of the bodies,
 * on motions that the joints allow, and A = H^-1 M is a solution with its factor. s is 0 where
 * K alone can be solved with. Sizes are those in the norm of H.
 */

/* After mt_lowest_new with shapes. *is false: sixteen digits do not resolve its motions. Fails:
 * as mt_sparse_solver_new. */
mt_status mt_lowest_open_forced(mt_lowest *l, bool *is, mt_err *err);
int mt_lowest_coordinates(const mt_lowest *l); /* of x */
int mt_lowest_free(const mt_lowest *l);        /* of a */
double mt_lowest_shift(const mt_lowest *l);    /* s [rad^2/s^2] */
/* x of vibration mode i, of any size. */
const double *mt_lowest_mode(const mt_lowest *l, int i);
/* H x, in work[coordinates] or x itself. */
const double *mt_lowest_dual(const mt_lowest *l, const double *x, double *work);

/* What a force does there. */
typedef struct mt_lowest_push {
    double *x;    /* [coordinates] H^-1 times it */
    double *dual; /* [coordinates] it, as work on x; NULL: x */
    double *a;    /* [free] */
    double size;  /* of x, before what the rigid-body modes take is off it */
    double noise; /* rounding of x, in the norm of H, and of what modes have of it */
    double loose; /* of a */
} mt_lowest_push;

/* Arrays in mem; a shortage is the arena's. */
void mt_lowest_push_init(const mt_lowest *l, mt_arena *mem, mt_lowest_push *p);
/* Of the force[nq] on all states. Fails: MT_E_INTERRUPTED. */
mt_status mt_lowest_force(const mt_lowest *l, const double *force, mt_lowest_push *p,
                          mt_err *err);
/* Of M times the motion of all bodies by -1 along a global axis. */
mt_status mt_lowest_base(mt_lowest *l, int axis, mt_lowest_push *p, mt_err *err);
/* x := the motion next to it, in the norm of H, that the joints allow and no rigid-body mode
 * has a part in: what is left of such ones that cancel may be off by their rounding. */
mt_status mt_lowest_admit(const mt_lowest *l, double *x, mt_err *err);
/* y := A x. */
mt_status mt_lowest_mass(const mt_lowest *l, const double *x, double *y, mt_err *err);
/* y := H A x. */
mt_status mt_lowest_momentum(const mt_lowest *l, const double *x, double *y, mt_err *err);

#endif
