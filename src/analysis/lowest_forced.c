/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * In (y, r) of the tree K = diag(I, 0). With r = -M_rr^-1 M_ry x + L^-T a, L L^T = M_rr, what
 * follows x and what is free have no mass in common, and a force (g_y, g_r) there is
 *     g_y - M_yr M_rr^-1 g_r  by x,    L^-1 g_r  by a.
 */
#include "analysis/lowest_forced.h"

#include "analysis/lowest_priv.h"

#include <string.h>

#include "base/interrupt.h"
#include "linalg/dense.h"

int mt_lowest_coordinates(const mt_lowest *l)
{
    return l->tree->n_x;
}

int mt_lowest_free(const mt_lowest *l)
{
    return l->tree->n_rigid;
}

/* x[] of forces x and o->r; a[] (NULL: not asked for). Returns the size of x before. */
static double part(const mt_lowest *l, double *x, double *a)
{
    const mt_tree *const t = l->tree;
    const struct mt_lowest_operation *const o = l->operation;
    const double size = mt_norm2(t->n_x, x);
    if (t->n_rigid == 0) {
        return size;
    }
    if (a != NULL) {
        memcpy(a, o->r, (size_t)t->n_rigid * sizeof *a);
        mt_tri_solve(false, t->n_rigid, 1, o->m_rr, a, t->n_rigid);
    }
    mt_lowest_solve_free(o);
    mt_gemv(false, t->n_x, t->n_rigid, -1.0, o->m_yr, t->n_x, o->r, 1.0, x);
    return size;
}

double mt_lowest_force(const mt_lowest *l, const double *force, double *x, double *a)
{
    const struct mt_lowest_operation *const o = l->operation;
    mt_tree_push(l->tree, force, o->f);
    mt_tree_gather(l->tree, o->f, x, o->r);
    return part(l, x, a);
}

double mt_lowest_base(const mt_lowest *l, int axis, double *x, double *a)
{
    const struct mt_lowest_operation *const o = l->operation;
    mt_tree_shift(l->tree, axis, o->v);
    mt_tree_momentum(l->tree, o->v, o->f, x, o->r);
    return part(l, x, a);
}

mt_status mt_lowest_mass(const mt_lowest *l, const double *x, double *y, mt_err *err)
{
    const struct mt_lowest_operation *const o = l->operation;
    MT_TRY(mt_interrupt_check(l->sys->run->interrupt, err));
    mt_tree_motion(l->tree, x, NULL, o->v);
    mt_tree_momentum(l->tree, o->v, o->f, y, o->r);
    (void)part(l, y, NULL);
    return MT_OK;
}
