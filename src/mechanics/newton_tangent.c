/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Derivative of a stage's solution (q, lambda, tau) with respect to one input, by the implicit
 * function theorem. With d the motion that the input causes already (drawn positions, earlier
 * stages) and a dot the derivative along (input, d) at fixed lambda and tau:
 *     v = -A^+ c.,   K eta = -Z^T ((grad L). + H v),   q' = d + v + Z eta,
 *         A^T lambda' = -(grad L). - H (v + Z eta) - t tau',
 * K the reduced Hessian of newton_step.c with the border of the trimmed spring. The chart moves
 * with the position; that adds nothing, because grad L = 0 there.
 */
#include "mechanics/newton_tangent.h"

#include <string.h>

#include "mechanics/newton_step.h"

/* (grad L). into w->g and -c. into w->c. */
static mt_status differentiate(mt_newton_work *w, const mt_placement *at, const mt_stage *stage,
                               const double *d, mt_arena *scratch, mt_err *err)
{
    const int m = w->p->m;
    mt_lagrangian *const l = stage->solver.sparse ? &w->sparse : &w->l;
    mt_placement moved = *at;
    moved.pose = mt_arena_alloc(scratch, (size_t)w->sys->n_bodies, sizeof *moved.pose);
    MT_TRY(mt_arena_check(scratch, err));
    mt_poses_tangent(w->sys, at->pose, d, moved.pose);
    l->slope = true;
    l->trim_force = stage->trim_force;
    mt_lagrangian_eval(w->p->data, w->p->energy, w->p->drawn, &moved, m, NULL,
                       MT_CURVATURE_NONE, l);
    for (int i = 0; i < m && l->row != NULL; i++) {
        for (int k = 0; k < l->row[i].n; k++) {
            w->g[l->row[i].dof[k]] += l->row[i].a[k] * stage->lambda[i];
        }
    }
    if (l->a != NULL) {
        mt_gemv(true, m, w->sys->nq, 1.0, l->a, m, stage->lambda, 1.0, w->g);
    }
    for (int i = 0; i < m; i++) {
        w->c[i] = -w->c[i];
    }
    return MT_OK;
}

/* d += v + Z eta; d_lambda [m] and *d_trim follow. */
static mt_status respond(mt_newton_work *w, const mt_stage *stage, double *d, double *d_lambda,
                         double *d_trim, mt_arena *scratch, mt_err *err)
{
    const int nq = w->sys->nq;
    const int m = w->p->m;
    const mt_elimination *const e = &stage->solver.e;
    const int order = e->n + (w->p->trim ? 1 : 0);
    double *const eta = mt_arena_f64(scratch, (size_t)order + 1, 1);
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(mt_eliminate_particular(e, w->c, w->v, scratch, err));
    mt_gemv(false, nq, nq, 1.0, stage->h, nq, w->v, 1.0, w->g);
    mt_eliminate_project(e, w->g, w->reduced);
    for (int i = 0; i < e->n; i++) {
        w->reduced[i] = -w->reduced[i];
    }
    if (w->p->trim) {
        double row = w->c[m - 1];
        for (int j = 0; j < nq; j++) {
            row -= stage->a[(m - 1) + ((ptrdiff_t)j * m)] * w->v[j];
        }
        w->reduced[e->n] = row;
    }
    mt_gemv(false, order, order, 1.0, stage->solver.inverse, order, w->reduced, 0.0, eta);
    mt_eliminate_expand(e, eta, w->step);
    mt_gemv(false, nq, nq, 1.0, stage->h, nq, w->step, 1.0, w->g);
    if (w->p->trim) {
        mt_axpy(nq, eta[e->n], stage->trim, w->g);
    }
    for (int j = 0; j < nq; j++) {
        w->g[j] = -w->g[j];
    }
    mt_axpy(nq, 1.0, w->v, d);
    mt_axpy(nq, 1.0, w->step, d);
    *d_trim = w->p->trim ? eta[e->n] : 0.0;
    return mt_eliminate_multipliers(e, w->g, d_lambda, scratch, err);
}

/* The same at once: H x + A^T lambda' + t tau' = -(grad L)., A x = -c. */
static mt_status respond_sparse(mt_newton_work *w, const mt_stage *stage, double *d,
                                double *d_lambda, double *d_trim, mt_arena *scratch,
                                mt_err *err)
{
    const int nq = w->sys->nq;
    const mt_newton_solver *const solver = &stage->solver;
    for (int j = 0; j < nq; j++) {
        w->g[j] = -w->g[j];
    }
    MT_TRY(w->p->trim
               ? mt_border_solve(&solver->border, w->g, w->c, w->step, d_lambda, d_trim,
                                 scratch, err)
               : mt_saddle_solve(&solver->saddle, w->g, w->c, w->step, d_lambda, scratch, err));
    mt_axpy(nq, 1.0, w->step, d);
    return MT_OK;
}

mt_status mt_newton_tangent(const mt_newton_problem *problem, const mt_placement *at,
                            mt_stage *stage, double *d, mt_arena *scratch, mt_err *err)
{
    if (!stage->active) {
        return MT_OK;
    }
    mt_newton_work w;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    MT_TRY(mt_newton_work_init(&w, problem, scratch, err));
    double *const d_lambda = mt_arena_f64(scratch, (size_t)problem->m, 1);
    double d_trim = 0.0;
    if (!stage->solver.sparse) {
        MT_TRY(mt_newton_dense(&w, scratch, err));
    }
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(differentiate(&w, at, stage, d, scratch, err));
    MT_TRY(stage->solver.sparse ? respond_sparse(&w, stage, d, d_lambda, &d_trim, scratch, err)
                                : respond(&w, stage, d, d_lambda, &d_trim, scratch, err));
    if (problem->energy == MT_ENERGY_PHYSICAL) {
        memcpy(stage->d_lambda, d_lambda, (size_t)problem->m * sizeof *d_lambda);
        stage->d_trim_force = d_trim;
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

mt_status mt_newton_adjoint(const mt_stage *stage, const double *pull, const double *across,
                            double pull_trim, double *x, double *y, mt_arena *scratch,
                            mt_err *err)
{
    const mt_newton_solver *const solver = &stage->solver;
    if (solver->sparse) {
        return solver->border.along != NULL
                   ? mt_border_adjoint(&solver->border, pull, across, pull_trim, x, y, scratch,
                                       err)
                   : mt_saddle_solve(&solver->saddle, pull, across, x, y, scratch, err);
    }
    const mt_elimination *const e = &stage->solver.e;
    const ptrdiff_t nq = e->nq;
    const int m = stage->m;
    const int order = e->n + (m - e->m);
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const r = mt_arena_f64(scratch, (size_t)nq, 1);
    double *const eta = mt_arena_f64(scratch, (size_t)order + 1, 1);
    double *const b = mt_arena_f64(scratch, (size_t)order + 1, 1);
    double *const way = mt_arena_f64(scratch, (size_t)nq, 1);
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(mt_eliminate_particular(e, across, x, scratch, err));
    memcpy(r, pull, (size_t)nq * sizeof *r);
    mt_gemv(true, e->nq, e->nq, -1.0, stage->h, e->nq, x, 1.0, r);
    mt_eliminate_project(e, r, b);
    b[e->n] = pull_trim - mt_dot(e->nq, stage->trim, x);
    mt_gemv(true, order, order, 1.0, stage->solver.inverse, order, b, 0.0, eta);
    mt_eliminate_expand(e, eta, way);
    mt_axpy(e->nq, 1.0, way, x);
    mt_gemv(true, e->nq, e->nq, -1.0, stage->h, e->nq, way, 1.0, r);
    for (int i = e->m; i < m; i++) { /* the drive's */
        y[i] = eta[e->n];
        for (ptrdiff_t j = 0; j < nq; j++) {
            r[j] -= stage->a[i + (j * m)] * y[i];
        }
    }
    MT_TRY(mt_eliminate_multipliers(e, r, y, scratch, err));
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}
