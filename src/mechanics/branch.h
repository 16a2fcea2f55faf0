/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_BRANCH_H
#define MECHANICS_BRANCH_H

#include "mechanics/eliminate.h"

/* Which assembly of a closed loop a walk is in: the orientation of the equations it holds. */
typedef struct mt_branch {
    const mt_system *sys;
    int n;      /* independent equations where the walk stands */
    int most;   /* room for that many; 0: too many are held to look */
    int *row;   /* [n] which they are */
    double *a;  /* n x nq, their gradients there, scaled as mt_eliminate does but for lengths */
    double *to; /* n x nq, of where it goes */
    double *b;  /* n x n */
} mt_branch;

/* For m equations. Of more than a hundred and fifty nothing is told. Fails: MT_E_MEMORY. */
mt_status mt_branch_init(mt_branch *b, const mt_system *sys, int m, mt_arena *mem, mt_err *err);
/* The walk stands where the equations have the gradients a (m x nq, column-major). e: their
 * elimination; NULL: they are independent. */
void mt_branch_stand(mt_branch *b, int m, const double *a, const mt_elimination *e);
/* *kept: a short step that leads to gradients `a` stays on its branch. O(n^2 nq + n^3). Fails:
 * MT_E_MEMORY. */
mt_status mt_branch_kept(mt_branch *b, int m, const double *a, bool *kept, mt_arena *scratch,
                         mt_err *err);

#endif
