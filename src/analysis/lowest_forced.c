/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * In (y, r) of the tree K = diag(I, 0). With r = -M_rr^-1 M_ry x + L^-T a, L L^T = M_rr, what
 * follows x and what is free have no mass in common, and a force (g_y, g_r) there is
 *     g_y - M_yr M_rr^-1 g_r  by x,    L^-1 g_r  by a.
 *     In coordinates of the bodies the rigid-body modes are R, R^T M R = I, and a force g is
 *     g - M R R^T g  by x,    R^T g  by a.
 */
#include "analysis/lowest_forced.h"

#include "analysis/lowest_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/run.h"
#include "linalg/dense.h"

/* Roundings of a force for each body that it goes through. */
static const double RECURSION_ULPS = 2.0;
/* Roundings of what rigid-body modes take of a force. */
static const double FREE_ULPS = 64.0;

static bool of_tree(const mt_lowest *l)
{
    return l->way == MT_LOWEST_TREE;
}

static mt_status check_interrupt(const mt_lowest *l, mt_err *err)
{
    return mt_interrupt_check(l->sys->run->interrupt, err);
}

mt_status mt_lowest_open_forced(mt_lowest *l, bool *is, mt_err *err)
{
    const mt_modes *const m = &l->found.modes;
    *is = l->way != MT_LOWEST_NONE;
    if (l->way != MT_LOWEST_SPARSE || l->solver != NULL) {
        return MT_OK;
    }
    const double first = m->n_rigid < m->count ? m->lambda[m->n_rigid] : 0.0;
    MT_TRY(mt_sparse_solver_new(&l->problem, m->n_rigid == 0, first, &l->mem, &l->solver, err));
    *is = l->solver != NULL;
    l->work = mt_arena_f64(&l->mem, (size_t)l->bodies.n, 1);
    return mt_arena_check(&l->mem, err);
}

int mt_lowest_coordinates(const mt_lowest *l)
{
    return of_tree(l) ? l->tree->n_x : l->bodies.n;
}

int mt_lowest_free(const mt_lowest *l)
{
    return of_tree(l) ? l->tree->n_rigid : l->found.modes.n_rigid;
}

double mt_lowest_shift(const mt_lowest *l)
{
    return of_tree(l) ? 0.0 : mt_sparse_solver_shift(l->solver);
}

const double *mt_lowest_mode(const mt_lowest *l, int i)
{
    const ptrdiff_t n = mt_lowest_coordinates(l);
    return l->found.x + (n * (of_tree(l) ? i : i + l->found.modes.n_rigid));
}

const double *mt_lowest_dual(const mt_lowest *l, const double *x, double *work)
{
    if (of_tree(l)) {
        return x;
    }
    mt_sparse_solver_stiffness(l->solver, x, work);
    return work;
}

void mt_lowest_push_init(const mt_lowest *l, mt_arena *mem, mt_lowest_push *p)
{
    const size_t n = (size_t)mt_lowest_coordinates(l);
    *p = (mt_lowest_push){.x = mt_arena_f64(mem, n, 1)};
    p->a = mt_arena_f64(mem, (size_t)mt_lowest_free(l), 1);
    p->dual = of_tree(l) ? NULL : mt_arena_f64(mem, n, 1);
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

static void part_of_tree(const mt_lowest *l, mt_lowest_push *p)
{
    const double unit = RECURSION_ULPS * (1.0 + l->tree->depth) * DBL_EPSILON;
    p->size = part(l, p->x, p->a);
    p->noise = unit * p->size;
    p->loose = unit * mt_norm2(l->tree->n_rigid, p->a);
}

/* x -= R R^T M x; work[n]. */
static void clear_of_free(const mt_lowest *l, double *x, double *work)
{
    const int n = l->bodies.n;
    const int rigid = l->found.modes.n_rigid;
    if (rigid == 0) {
        return;
    }
    mt_sparse_solver_mass(l->solver, x, work);
    for (int i = 0; i < rigid; i++) {
        const double *const r = l->found.x + ((ptrdiff_t)n * i);
        mt_axpy(n, -mt_dot(n, r, work), r, x);
    }
}

/* The largest error of a mode's energy as a part of it: so much of its shape is rounding. */
static double rough(const mt_lowest *l)
{
    const mt_modes *const m = &l->found.modes;
    double most = 0.0;
    for (int i = m->n_rigid; i < m->count; i++) {
        most = fmax(most, m->error[i] / fabs(m->lambda[i]));
    }
    return most;
}

/* Of the force p->dual. */
static mt_status part_of_bodies(const mt_lowest *l, mt_lowest_push *p, mt_err *err)
{
    const int n = l->bodies.n;
    const int rigid = l->found.modes.n_rigid;
    double *const work = l->work;
    double noise = 0.0;
    double sum = 0.0;
    for (int i = 0; i < rigid; i++) {
        const double *const r = l->found.x + ((ptrdiff_t)n * i);
        p->a[i] = mt_dot(n, r, p->dual);
        for (int j = 0; j < n; j++) {
            sum += fabs(r[j] * p->dual[j]);
        }
    }
    for (int i = 0; i < rigid; i++) {
        mt_sparse_solver_mass(l->solver, l->found.x + ((ptrdiff_t)n * i), work);
        mt_axpy(n, -p->a[i], work, p->dual);
    }
    MT_TRY(mt_sparse_solver_solve(l->solver, p->dual, p->x, &noise, err));
    clear_of_free(l, p->x, work);
    p->size = sqrt(fmax(mt_dot(n, p->x, mt_lowest_dual(l, p->x, work)), 0.0));
    p->noise = noise + (rough(l) * p->size);
    p->loose = FREE_ULPS * DBL_EPSILON * sum;
    return MT_OK;
}

mt_status mt_lowest_force(const mt_lowest *l, const double *force, mt_lowest_push *p,
                          mt_err *err)
{
    MT_TRY(check_interrupt(l, err));
    if (!of_tree(l)) {
        mt_absolute_push(&l->bodies, force, p->dual);
        return part_of_bodies(l, p, err);
    }
    const struct mt_lowest_operation *const o = l->operation;
    mt_tree_push(l->tree, force, o->f);
    mt_tree_gather(l->tree, o->f, p->x, o->r);
    part_of_tree(l, p);
    return MT_OK;
}

mt_status mt_lowest_base(mt_lowest *l, int axis, mt_lowest_push *p, mt_err *err)
{
    MT_TRY(check_interrupt(l, err));
    if (!of_tree(l)) {
        MT_TRY(mt_absolute_shift(&l->bodies, l->at, axis, p->dual, &l->mem, err));
        for (int j = 0; j < l->bodies.n; j++) {
            p->dual[j] = -p->dual[j];
        }
        return part_of_bodies(l, p, err);
    }
    const struct mt_lowest_operation *const o = l->operation;
    mt_tree_shift(l->tree, axis, o->v);
    mt_tree_momentum(l->tree, o->v, o->f, p->x, o->r);
    part_of_tree(l, p);
    for (int j = 0; j < l->tree->n_x; j++) {
        p->x[j] = -p->x[j];
    }
    for (int j = 0; j < l->tree->n_rigid; j++) {
        p->a[j] = -p->a[j];
    }
    return MT_OK;
}

mt_status mt_lowest_admit(const mt_lowest *l, double *x, mt_err *err)
{
    if (of_tree(l)) {
        return MT_OK;
    }
    if (l->bodies.a.n_rows > 0) {
        mt_sparse_solver_stiffness(l->solver, x, l->work);
        MT_TRY(mt_sparse_solver_solve(l->solver, l->work, x, NULL, err));
    }
    clear_of_free(l, x, l->work);
    return MT_OK;
}

mt_status mt_lowest_momentum(const mt_lowest *l, const double *x, double *y, mt_err *err)
{
    if (of_tree(l)) {
        return mt_lowest_mass(l, x, y, err);
    }
    mt_sparse_solver_mass(l->solver, x, y);
    return MT_OK;
}

mt_status mt_lowest_mass(const mt_lowest *l, const double *x, double *y, mt_err *err)
{
    MT_TRY(check_interrupt(l, err));
    if (!of_tree(l)) {
        mt_sparse_solver_mass(l->solver, x, l->work);
        MT_TRY(mt_sparse_solver_solve(l->solver, l->work, y, NULL, err));
        clear_of_free(l, y, l->work);
        return MT_OK;
    }
    const struct mt_lowest_operation *const o = l->operation;
    mt_tree_motion(l->tree, x, NULL, o->v);
    mt_tree_momentum(l->tree, o->v, o->f, y, o->r);
    (void)part(l, y, NULL);
    return MT_OK;
}
