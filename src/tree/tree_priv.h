/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TREE_TREE_PRIV_H
#define TREE_TREE_PRIV_H

#include "mechanics/data.h"
#include "tree/tree.h"

/* What the files tree*.c share while a tree is made. */

enum { MT_TREE_MOTION = 6, MT_TREE_EDGE_ROWS = 64 };

typedef struct mt_tree_maker {
    mt_tree *t;
    mt_data data;
    mt_pose *pose; /* [bodies] as drawn */
    char *why;
} mt_tree_maker;

/* Local freedom (0..5) of entry k of a body's motion. */
static inline int mt_tree_freedom(const mt_tree *t, int k)
{
    return t->s == MT_TREE_MOTION || k < 2 ? k : MT_TREE_MOTION - 1;
}
/* v := X_i p, X the rigid motion along with the body before. */
void mt_tree_carry(const mt_tree *t, int i, const double *p, double *v);
/* p += X_i^T f. */
void mt_tree_carry_back(const mt_tree *t, int i, const double *f, double *p);
/* Columns N F, then N R of body i; N' where something loads. */
static inline const double *mt_tree_basis(const mt_tree *t, int i)
{
    return (t->scaled != NULL ? t->scaled : t->basis) +
           ((ptrdiff_t)t->s * (t->y_at[i] + t->free_dof_at[i]));
}

/* Coordinates x of body i: from the first to before the end. */
static inline int mt_tree_first(const mt_tree *t, int i)
{
    return t->scaled != NULL ? t->y_at[i] + t->free_dof_at[i] : t->y_at[i];
}

/* Basis of the edge of body i into basis[s x s]: *n_y columns N F, then *n_free_dofs columns N
 * R; its length, doubt and lost. False with the reason in why: what is no tree. */
bool mt_tree_edge(mt_tree_maker *m, int i, double *basis, int *n_y, int *n_free_dofs);
/* Masses of all bodies; *is_tree false: the same. Fails: MT_E_MEMORY. */
mt_status mt_tree_masses(mt_tree_maker *m, mt_arena *mem, bool *is_tree, mt_err *err);
/* What loads it: geometric stiffness where it is drawn at rest; *is_tree false: the same.
 * Fails: MT_E_MEMORY, MT_E_NOT_SPD. */
mt_status mt_tree_loads(mt_tree_maker *m, mt_arena *mem, bool *is_tree, mt_err *err);
/* The equations of an edge, rows of A, and the factor of A A^T scaled to a unit diagonal. */
typedef struct mt_tree_held {
    int c;
    double row[MT_TREE_MOTION * MT_TREE_MOTION];
    double gram[MT_TREE_MOTION * MT_TREE_MOTION];
    double scale[MT_TREE_MOTION];
} mt_tree_held;
/* row: c x s, by row. Fails: MT_E_NOT_SPD (equations depend on each other). */
mt_status mt_tree_hold(const mt_tree *t, int c, const double *row, mt_tree_held *h,
                       mt_err *err);
/* lambda[c]: A^T lambda = -g, least squares. */
void mt_tree_multipliers(const mt_tree *t, const mt_tree_held *h, const double *g,
                         double *lambda);
/* After them: fill carried, scaled and settled; *positive: K is, as its pivots tell. Fails:
 * MT_E_MEMORY. */
mt_status mt_tree_factor(mt_tree *t, mt_arena *scratch, bool *positive, mt_err *err);

#endif
