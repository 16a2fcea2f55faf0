/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_FOLLOW_H
#define MECHANICS_FOLLOW_H

#include "base/arena.h"

/*
 * Dependent coordinates d as functions of the free ones f, by independent equations [A_d A_f]
 * dq = 0:
 *     dq_d = -X dq_f,   X = A_d^-1 A_f,
 * with error bounds for entries known to E,
 *     dX = |A_d^-1| (E_d |X| + E_f),
 * which grow as the mechanism transmits its errors, not with the sizes of all steps (Higham,
 * Accuracy and Stability of Numerical Algorithms, 7.2).
 */
typedef struct mt_follow {
    int rank;
    int nq;
    const double *g;     /* rank x nq, row-major: A */
    const double *e;     /* as g: E */
    const bool *follows; /* [nq] true for coordinates in d */
    double *x;           /* out: rank rows of n = nq - rank, X; rows and columns in ascending
                            order of their coordinates */
    double *dx;          /* out: as x, bounds */
} mt_follow;

/* x and dx in mem; *holds false: errors of A as large as E may make A_d singular, and there are
 * none. O(rank^3 + rank^2 n). */
mt_status mt_follow_find(mt_follow *f, mt_arena *mem, bool *holds, mt_err *err);

#endif
