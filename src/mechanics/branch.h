/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_BRANCH_H
#define MECHANICS_BRANCH_H

#include "mechanics/eliminate.h"

/* Assembly of a closed loop during a continuation: the orientation of the independent
 * constraint equations. */
typedef struct mt_branch {
    const mt_system *sys;
    int n;      /* independent equations at the current position */
    int most;   /* room for that many; 0: too many equations to check */
    int *row;   /* [n] their indices */
    double *a;  /* n x nq, their gradients there, scaled as in mt_eliminate but for lengths */
    double *to; /* n x nq, gradients at the end of the step */
    double *b;  /* n x n */
} mt_branch;

/* For m equations; more than 150 are not checked. Fails: MT_E_MEMORY. */
mt_status mt_branch_init(mt_branch *b, const mt_system *sys, int m, mt_arena *mem, mt_err *err);
/* Set the current position, where the equations have the gradients a (m x nq, column-major). e:
 * their elimination; NULL: they are independent. */
void mt_branch_stand(mt_branch *b, int m, const double *a, const mt_elimination *e);
/* *kept: a short step to a position with gradients `a` stays on its branch. O(n^2 nq + n^3).
 * Fails: MT_E_MEMORY. */
mt_status mt_branch_kept(mt_branch *b, int m, const double *a, bool *kept, mt_arena *scratch,
                         mt_err *err);

#endif
