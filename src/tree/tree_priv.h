/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TREE_TREE_PRIV_H
#define TREE_TREE_PRIV_H

#include "mechanics/data.h"
#include "tree/tree.h"

/* Shared by the files tree*.c while a tree is made. */

enum { MT_TREE_MOTION = 6, MT_TREE_EDGE_ROWS = 64 };

typedef struct mt_tree_maker {
    mt_tree *t;
    mt_data data;
    mt_pose *pose; /* [bodies] drawn position */
    char *why;
} mt_tree_maker;

/* Local freedom (0..5) of entry k of a body's motion. */
static inline int mt_tree_freedom(const mt_tree *t, int k)
{
    return t->s == MT_TREE_MOTION || k < 2 ? k : MT_TREE_MOTION - 1;
}
/* v := X_i p, X the rigid motion with the parent. */
void mt_tree_carry(const mt_tree *t, int i, const double *p, double *v);
/* p += X_i^T f. */
void mt_tree_carry_back(const mt_tree *t, int i, const double *f, double *p);
/* Columns N F, then N R of body i; N' with loads. */
static inline const double *mt_tree_basis(const mt_tree *t, int i)
{
    return (t->scaled != NULL ? t->scaled : t->basis) +
           ((ptrdiff_t)t->s * (t->y_at[i] + t->free_dof_at[i]));
}

/* Coordinates x of body i: the first. */
static inline int mt_tree_first(const mt_tree *t, int i)
{
    return t->scaled != NULL ? t->y_at[i] + t->free_dof_at[i] : t->y_at[i];
}

/* Basis of the edge of body i into basis[s x s]: *n_y columns N F, then *n_free_dofs columns N
 * R; sets its length, condition and lost. False, with the reason in why: not a tree. */
bool mt_tree_edge(mt_tree_maker *m, int i, double *basis, int *n_y, int *n_free_dofs);
/* Set the masses of all bodies; *is_tree false: not a tree, with the reason in why. Fails:
 * MT_E_MEMORY. */
mt_status mt_tree_masses(mt_tree_maker *m, mt_arena *mem, bool *is_tree, mt_err *err);
/* Set the geometric stiffness of the loads, with the drawn position in equilibrium;
 * *is_tree false: not a tree, with the reason in why. Fails: MT_E_MEMORY, MT_E_NOT_SPD. */
mt_status mt_tree_loads(mt_tree_maker *m, mt_arena *mem, bool *is_tree, mt_err *err);
/* The equations of an edge, rows of A, and the factor of A A^T scaled to a unit diagonal. */
typedef struct mt_tree_held {
    int c;
    double row[MT_TREE_MOTION * MT_TREE_MOTION];
    double gram[MT_TREE_MOTION * MT_TREE_MOTION];
    double scale[MT_TREE_MOTION];
} mt_tree_held;
/* Factor the equations, row: c x s, by row. Fails: MT_E_NOT_SPD (the equations are
 * dependent). */
mt_status mt_tree_hold(const mt_tree *t, int c, const double *row, mt_tree_held *h,
                       mt_err *err);
/* lambda[c]: least-squares solution of A^T lambda = -g. */
void mt_tree_multipliers(const mt_tree *t, const mt_tree_held *h, const double *g,
                         double *lambda);
/* After masses and loads: fill transport, scaled and settled; *positive: all pivots of K are
 * positive beyond rounding. Fails: MT_E_MEMORY. */
mt_status mt_tree_factor(mt_tree *t, mt_arena *scratch, bool *positive, mt_err *err);

#endif
