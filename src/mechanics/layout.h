/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_LAYOUT_H
#define MECHANICS_LAYOUT_H

#include "linalg/ldl.h"
#include "mechanics/system.h"

/*
 * Order of states and equations along the mechanism, in which
 *     [H A^T; A 0],    H the Hessian of the Lagrangian, A the Jacobian of the constraints,
 * has its entries near the diagonal: bodies breadth first from one end of the mechanism along
 * joints and springs; each equation after the last of its bodies.
 */
struct mt_layout {
    int *state;    /* [nq] row of a state */
    int *equation; /* [n_constraints] row of an equation */
    mt_envelope envelope;
    double work; /* multiplications of a factorisation */
};

/* Linear in bodies, joints, springs and loads. In mem; a shortage is the arena's. */
const mt_layout *mt_layout_new(const mt_system *sys, mt_arena *mem);

#endif
