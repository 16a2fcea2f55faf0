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
    mt_placement moved = *at;
    moved.pose = mt_arena_alloc(scratch, (size_t)w->sys->n_bodies, sizeof *moved.pose);
    MT_TRY(mt_arena_check(scratch, err));
    mt_poses_tangent(w->sys, at->pose, d, moved.pose);
    for (int i = 0; i < m; i++) {
        w->lambda_cx[i] = stage->lambda[i];
    }
    w->l.slope = true;
    w->l.trim_force = stage->trim_force;
    w->l.trim_force_derivative = 0.0;
    mt_lagrangian_eval(w->p->data, w->p->energy, w->p->drawn, &moved, m, w->lambda_cx,
                       MT_CURVATURE_NONE, &w->l);
    mt_gemv(true, m, w->sys->nq, 1.0, w->a, m, stage->lambda, 1.0, w->g);
    for (int i = 0; i < m; i++) {
        w->c[i] = -w->c[i];
    }
    return MT_OK;
}

/* v into w->v, Z eta into w->step; w->g becomes (grad L). + H (v + Z eta) + t tau'. */
static mt_status respond(mt_newton_work *w, const mt_stage *stage, double *eta,
                         mt_arena *scratch, mt_err *err)
{
    const int nq = w->sys->nq;
    const int m = w->p->m;
    MT_TRY(mt_eliminate_particular(&stage->e, w->c, w->v, scratch, err));
    mt_gemv(false, nq, nq, 1.0, stage->h, nq, w->v, 1.0, w->g);
    mt_eliminate_project(&stage->e, w->g, w->reduced);
    for (int i = 0; i < stage->e.n; i++) {
        w->reduced[i] = -w->reduced[i];
    }
    if (w->p->trim) {
        double row = w->c[m - 1];
        for (int j = 0; j < nq; j++) {
            row -= stage->a[(m - 1) + ((ptrdiff_t)j * m)] * w->v[j];
        }
        w->reduced[stage->e.n] = row;
    }
    mt_gemv(false, stage->order, stage->order, 1.0, stage->inverse, stage->order, w->reduced,
            0.0, eta);
    mt_eliminate_expand(&stage->e, eta, w->step);
    mt_gemv(false, nq, nq, 1.0, stage->h, nq, w->step, 1.0, w->g);
    if (w->p->trim) {
        mt_axpy(nq, eta[stage->e.n], stage->trim, w->g);
    }
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
    double *const eta = mt_arena_f64(scratch, (size_t)stage->order + 1, 1);
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(differentiate(&w, at, stage, d, scratch, err));
    MT_TRY(respond(&w, stage, eta, scratch, err));
    const int nq = w.sys->nq;
    mt_axpy(nq, 1.0, w.v, d);
    mt_axpy(nq, 1.0, w.step, d);
    if (problem->energy == MT_ENERGY_PHYSICAL) {
        for (int j = 0; j < nq; j++) {
            w.g[j] = -w.g[j];
        }
        memset(stage->d_lambda, 0, (size_t)w.p->m * sizeof *stage->d_lambda);
        MT_TRY(mt_eliminate_multipliers(&stage->e, w.g, stage->d_lambda, scratch, err));
        stage->d_trim_force = problem->trim ? eta[stage->e.n] : 0.0;
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}
