/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_LOWEST_FORCED_H
#define ANALYSIS_LOWEST_FORCED_H

#include "analysis/lowest.h"

/*
 * Forces and motions of a large tree (MT_LOWEST_TREE) in the coordinates of its mode search: x
 * and the amplitudes a of its rigid-body modes, in which
 *     K = diag(I, 0),    M = diag(A, I).
 * O(bodies) each.
 */
int mt_lowest_coordinates(const mt_lowest *l); /* number of x */
int mt_lowest_free(const mt_lowest *l);        /* number of a */
/* x[] and a[] := generalised forces of force[nq] on all states. Returns |x| before the part of
 * the rigid-body modes is subtracted, the scale of its rounding. */
double mt_lowest_force(const mt_lowest *l, const double *force, double *x, double *a);
/* The same for M times the translation of all bodies by 1 along a global axis. */
double mt_lowest_base(const mt_lowest *l, int axis, double *x, double *a);
/* y := A x. Fails: MT_E_INTERRUPTED. */
mt_status mt_lowest_mass(const mt_lowest *l, const double *x, double *y, mt_err *err);

#endif
