/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Newton with multipliers. At a position q with constraints c, Jacobian A, freedoms Z (A Z = 0):
 *     lambda  = least-squares solution of A^T lambda = -g
 *     v       = -A^+ c                                    back to the constraints
 *     H       = Hessian of V + lambda c
 *     Z^T H Z eta = -Z^T (g + H v)                        towards equilibrium
 *     q      <- q (+) (v + Z eta).
 * Freedoms without stiffness (singular values of Z^T H Z below NO_STIFFNESS of the largest) take no step; the residual test then decides whether something still
 * pushes along them. With `trim` the force tau of one spring is unknown and the drive's row (a_d, c_d) is its equation:
 *     [Z^T H Z   Z^T t] [eta]   [-Z^T (g + H v)  ]
 *     [a_d Z       0  ] [tau] = [-(c_d + a_d v)  ].
 * Where Newton does not converge from the drawing, a descent on the energy along the constraints brings the mechanism near a stable equilibrium first.
 */
#include "mechanics/newton.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Singular values of the reduced Hessian below this fraction of the largest belong to freedoms without stiffness. */
static const double NO_STIFFNESS = 1e-11;
/* Converged: the step is below this fraction of the model length (quadratic convergence makes the error its square)... */
static const double STEP_DONE = 1e-10;
/* ...and the unbalanced force below this fraction of the forces at work (rounding of their sum is ~ n eps). */
static const double FORCE_DONE = 1e-11;
/* Largest motion of one step in model lengths: beyond it the quadratic model means nothing. */
static const double STEP_LIMIT = 0.3;
enum { NEWTON_LIMIT = 60, DESCENT_LIMIT = 400 };

typedef struct work {
    const mt_newton_problem *p;
    const mt_system *sys;
    mt_lagrangian l;
    mt_cx *lambda_cx;
    double *lambda;
    double *g;
    double *c;
    double *a;
    double *h;
    double *trim;
    double *v;
    double *step;
    double *reduced; /* Z^T g, order */
    double tau;
    double residual; /* unbalanced force / force scale */
    double gap;      /* model lengths */
    double moved;    /* model lengths */
    int null_freedoms;
} work;

static mt_status work_init(work *w, const mt_newton_problem *p, mt_arena *mem, mt_err *err)
{
    const mt_system *const sys = p->data->sys;
    const size_t nq = (size_t)sys->nq;
    const size_t m = (size_t)sys->n_constraints;
    *w = (work){.p = p, .sys = sys};
    MT_TRY(mt_lagrangian_init(&w->l, sys, mem, err));
    w->lambda_cx = mt_arena_alloc(mem, m, sizeof *w->lambda_cx);
    w->lambda = mt_arena_f64(mem, m, 1);
    w->g = mt_arena_f64(mem, nq, 1);
    w->c = mt_arena_f64(mem, m, 1);
    w->a = mt_arena_f64(mem, m, nq);
    w->h = mt_arena_f64(mem, nq, nq);
    w->trim = mt_arena_f64(mem, nq, 1);
    w->v = mt_arena_f64(mem, nq, 1);
    w->step = mt_arena_f64(mem, nq, 1);
    w->reduced = mt_arena_f64(mem, nq + 1, 1);
    const bool bad = w->lambda_cx == NULL || w->lambda == NULL || w->g == NULL ||
                     w->c == NULL || w->a == NULL || w->h == NULL || w->trim == NULL ||
                     w->v == NULL || w->step == NULL || w->reduced == NULL;
    return bad ? mt_fail_memory(err) : MT_OK;
}

static void real_part(ptrdiff_t n, const mt_cx *from, double *to)
{
    for (ptrdiff_t i = 0; i < n; i++) {
        to[i] = creal(from[i]);
    }
}

static void evaluate(work *w, const mt_pose *poses, bool hessian)
{
    const int m = w->p->m;
    const ptrdiff_t nq = w->sys->nq;
    w->l.trim_force = w->tau;
    w->l.trim_force_derivative = 0.0;
    for (int i = 0; i < m; i++) {
        w->lambda_cx[i] = w->lambda[i];
    }
    mt_lagrangian_eval(w->p->data, w->p->energy, w->p->drawn, poses, m, w->lambda_cx, hessian,
                       false, &w->l);
    real_part(nq, w->l.g, w->g);
    real_part(nq, w->l.trim, w->trim);
    real_part(m, w->l.c, w->c);
    real_part(m * nq, w->l.a, w->a);
    if (hessian) {
        real_part(nq * nq, w->l.h, w->h);
    }
    if (w->p->energy == MT_ENERGY_ANCHOR) {
        w->l.force_scale =
            w->sys->length_m; /* the anchor's own unit: a displacement of one model length */
    }
}

/* Rows that are eliminated: with trim all but the last. */
static int eliminated(const mt_newton_problem *p)
{
    return p->trim ? p->m - 1 : p->m;
}

static mt_status eliminate(const work *w, mt_arena *mem, mt_elimination *e, mt_err *err)
{
    const int m = eliminated(w->p);
    if (m == w->p->m) {
        return mt_eliminate(w->sys, m, w->a, mem, e, err);
    }
    double *const a = mt_arena_f64(mem, (size_t)m, (size_t)w->sys->nq);
    if (a == NULL) {
        return mt_fail_memory(err);
    }
    for (ptrdiff_t j = 0; j < w->sys->nq; j++) {
        memcpy(a + (j * m), w->a + (j * w->p->m), (size_t)m * sizeof *a);
    }
    return mt_eliminate(w->sys, m, a, mem, e, err);
}

static double scaled_norm(const work *w, const double *dq)
{
    double s = 0.0;
    for (int b = 0; b < w->sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            const int dof = w->sys->bodies[b].dof[k];
            if (dof >= 0) {
                s = fmax(s, fabs(dq[dof]) * (k < 3 ? 1.0 / w->sys->length_m : 1.0));
            }
        }
    }
    return s;
}

static double constraint_gap(const work *w)
{
    double gap = 0.0;
    for (int i = 0; i < w->p->m; i++) {
        const mt_measure_kind kind = w->sys->measures[w->sys->constraints[i].measure[0]].kind;
        const bool length = kind == MT_MEASURE_PLANE || kind == MT_MEASURE_DISTANCE;
        const double c = fabs(w->c[i]) / (length ? w->sys->length_m : 1.0);
        gap = !(c <= gap) ? c : gap;
    }
    return gap;
}

/* Bordered reduced Hessian, its pseudo-inverse (order x order), the number of freedoms without stiffness. */
static mt_status invert_reduced(work *w, const mt_elimination *e, mt_arena *mem,
                                double **inverse, mt_err *err)
{
    const int n = e->n;
    const int nq = e->nq;
    const int order = n + (w->p->trim ? 1 : 0);
    double *const k = mt_arena_f64(mem, (size_t)order, (size_t)order);
    double *const hz = mt_arena_f64(mem, (size_t)nq, (size_t)n);
    *inverse = mt_arena_f64(mem, (size_t)order, (size_t)order);
    if (k == NULL || hz == NULL || *inverse == NULL) {
        return mt_fail_memory(err);
    }
    mt_gemm(false, false, nq, n, nq, 1.0, w->h, nq, e->z, nq, 0.0, hz, nq);
    mt_gemm(true, false, n, n, nq, 1.0, e->z, nq, hz, nq, 0.0, k, order);
    if (w->p->trim) {
        const double stiffness = mt_max_abs((ptrdiff_t)order * order, k);
        const double scale =
            stiffness > 0.0
                ? stiffness
                : 1.0; /* force unit that keeps the border of the size of the rest */
        for (int c = 0; c < n; c++) {
            const double *const zc = e->z + ((ptrdiff_t)c * nq);
            double row = 0.0;
            for (int j = 0; j < nq; j++) {
                row += w->a[(w->p->m - 1) + ((ptrdiff_t)j * w->p->m)] * zc[j];
            }
            k[n + ((ptrdiff_t)c * order)] = scale * row;
            k[c + ((ptrdiff_t)n * order)] = scale * mt_dot(nq, zc, w->trim);
        }
        k[n + ((ptrdiff_t)n * order)] = 0.0;
        int rank = 0;
        MT_TRY(mt_pinv(order, order, k, NO_STIFFNESS, *inverse, &rank, mem, err));
        w->null_freedoms = order - rank;
        for (int c = 0; c < order; c++) { /* undo the scale on the last row and column */
            (*inverse)[n + ((ptrdiff_t)c * order)] *= scale;
            (*inverse)[c + ((ptrdiff_t)n * order)] *= scale;
        }
        return MT_OK;
    }
    int rank = 0;
    MT_TRY(mt_pinv(order, order, k, NO_STIFFNESS, *inverse, &rank, mem, err));
    w->null_freedoms = order - rank;
    return MT_OK;
}

/* Everything at the present position: multipliers, Hessian, elimination, and the step v + Z eta (unlimited). */
static mt_status linearise(work *w, const mt_pose *poses, mt_arena *mem, mt_elimination *e,
                           double **inverse, mt_err *err)
{
    const int nq = w->sys->nq;
    memset(w->lambda, 0, (size_t)w->p->m * sizeof *w->lambda);
    evaluate(w, poses, false);
    MT_TRY(eliminate(w, mem, e, err));
    for (int j = 0; j < nq; j++) {
        w->v[j] = -w->g[j];
    }
    MT_TRY(mt_eliminate_multipliers(e, w->v, w->lambda, mem, err));
    evaluate(w, poses, true);
    w->gap = constraint_gap(w);
    mt_eliminate_project(e, w->g, w->reduced);
    const double unbalanced = mt_max_abs(e->n, w->reduced);
    w->residual = w->l.force_scale > 0.0 ? unbalanced / w->l.force_scale : unbalanced;
    MT_TRY(invert_reduced(w, e, mem, inverse, err));
    double *const minus_c = mt_arena_f64(mem, (size_t)w->p->m, 1);
    double *const hv = mt_arena_f64(mem, (size_t)nq, 1);
    double *const eta = mt_arena_f64(mem, (size_t)e->n + 1, 1);
    if (minus_c == NULL || hv == NULL || eta == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < w->p->m; i++) {
        minus_c[i] = -w->c[i];
    }
    MT_TRY(mt_eliminate_particular(e, minus_c, w->v, mem, err));
    memcpy(hv, w->g, (size_t)nq * sizeof *hv);
    mt_gemv(false, nq, nq, 1.0, w->h, nq, w->v, 1.0, hv);
    mt_eliminate_project(e, hv, w->reduced);
    const int order = e->n + (w->p->trim ? 1 : 0);
    for (int i = 0; i < e->n; i++) {
        w->reduced[i] = -w->reduced[i];
    }
    if (w->p->trim) {
        double row = w->c[w->p->m - 1];
        for (int j = 0; j < nq; j++) {
            row += w->a[(w->p->m - 1) + ((ptrdiff_t)j * w->p->m)] * w->v[j];
        }
        w->reduced[e->n] = -row;
    }
    mt_gemv(false, order, order, 1.0, *inverse, order, w->reduced, 0.0, eta);
    mt_eliminate_expand(e, eta, w->step);
    mt_axpy(nq, 1.0, w->v, w->step);
    w->moved = scaled_norm(w, w->step);
    if (w->p->trim) {
        w->tau += eta[e->n];
    }
    return MT_OK;
}

static void take_step(work *w, mt_pose *poses, double limit)
{
    const double factor = w->moved > limit ? limit / w->moved : 1.0;
    for (int j = 0; j < w->sys->nq; j++) {
        w->step[j] *= factor;
    }
    mt_position_move(w->sys, poses, w->step);
}

/* Back to the constraints by least-norm steps. */
static mt_status restore(work *w, mt_pose *poses, mt_arena *mem, mt_err *err)
{
    for (int it = 0; it < 20; it++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        mt_elimination e;
        evaluate(w, poses, false);
        if (constraint_gap(w) <= STEP_DONE) {
            return MT_OK;
        }
        double *const minus_c = mt_arena_f64(mem, (size_t)w->p->m, 1);
        if (minus_c == NULL) {
            return mt_fail_memory(err);
        }
        for (int i = 0; i < w->p->m; i++) {
            minus_c[i] = -w->c[i];
        }
        MT_TRY(mt_eliminate(w->sys, w->p->m, w->a, mem, &e, err));
        MT_TRY(mt_eliminate_particular(&e, minus_c, w->step, mem, err));
        w->moved = scaled_norm(w, w->step);
        take_step(w, poses, STEP_LIMIT);
        mt_arena_rewind(mem, mark);
    }
    return MT_E_ASSEMBLY;
}

/* One descent direction: eigenvalues of the reduced Hessian made positive, freedoms without stiffness given the softest stiffness that keeps the step short. */
static mt_status descent_direction(work *w, const mt_elimination *e, mt_arena *mem, mt_err *err)
{
    const int n = e->n;
    const int nq = e->nq;
    double *const k = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const hz = mt_arena_f64(mem, (size_t)nq, (size_t)n);
    double *const values = mt_arena_f64(mem, (size_t)n, 1);
    double *const eta = mt_arena_f64(mem, (size_t)n, 1);
    if (k == NULL || hz == NULL || values == NULL || eta == NULL) {
        return mt_fail_memory(err);
    }
    mt_gemm(false, false, nq, n, nq, 1.0, w->h, nq, e->z, nq, 0.0, hz, nq);
    mt_gemm(true, false, n, n, nq, 1.0, e->z, nq, hz, nq, 0.0, k, n);
    mt_eliminate_project(e, w->g, w->reduced);
    const double soft = mt_norm2(n, w->reduced) / (STEP_LIMIT * w->sys->length_m);
    MT_TRY(mt_eig_sym(n, k, values, true, mem, err));
    memset(eta, 0, (size_t)n * sizeof *eta);
    for (int i = 0; i < n; i++) {
        const double *const vec = k + ((ptrdiff_t)i * n);
        mt_axpy(n, -mt_dot(n, vec, w->reduced) / fmax(fabs(values[i]), soft), vec, eta);
    }
    mt_eliminate_expand(e, eta, w->step);
    w->moved = scaled_norm(w, w->step);
    return MT_OK;
}

/* Energy descent along the constraints with halving of the step, until Newton is likely to finish. */
static mt_status descend(work *w, mt_pose *poses, mt_arena *mem, mt_err *err)
{
    const size_t size = (size_t)w->sys->n_bodies * sizeof *poses;
    mt_pose *const kept = mt_arena_alloc(mem, (size_t)w->sys->n_bodies, sizeof *kept);
    double *const direction = mt_arena_f64(mem, (size_t)w->sys->nq, 1);
    if (kept == NULL || direction == NULL) {
        return mt_fail_memory(err);
    }
    MT_TRY(restore(w, poses, mem, err));
    double energy = mt_energy_value(w->p->data, poses, w->tau);
    for (int it = 0; it < DESCENT_LIMIT; it++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        mt_elimination e;
        double *inverse = NULL;
        bool lower = false;
        MT_TRY(linearise(w, poses, mem, &e, &inverse, err));
        if (w->residual <= 1e3 * FORCE_DONE) {
            mt_arena_rewind(mem, mark);
            return MT_OK;
        }
        MT_TRY(descent_direction(w, &e, mem, err));
        memcpy(direction, w->step, (size_t)w->sys->nq * sizeof *direction);
        memcpy(kept, poses, size);
        double length = fmin(w->moved, STEP_LIMIT);
        const double full = w->moved;
        for (int half = 0; half < 30 && !lower; half++) {
            memcpy(poses, kept, size);
            memcpy(w->step, direction, (size_t)w->sys->nq * sizeof *direction);
            w->moved = full;
            take_step(w, poses, length);
            lower = restore(w, poses, mem, NULL) == MT_OK &&
                    mt_energy_value(w->p->data, poses, w->tau) < energy;
            length *= 0.5;
        }
        mt_arena_rewind(mem, mark);
        if (!lower) {
            memcpy(poses, kept, size);
            return MT_OK; /* as low as rounding lets us see: Newton decides */
        }
        energy = mt_energy_value(w->p->data, poses, w->tau);
    }
    return MT_OK;
}

static mt_status keep(const work *w, const mt_elimination *e, double *inverse, mt_arena *mem,
                      mt_state *report, mt_stage *stage, mt_err *err)
{
    const size_t nq = (size_t)w->sys->nq;
    stage->active = true;
    stage->m = w->p->m;
    stage->e = *e;
    stage->order = e->n + (w->p->trim ? 1 : 0);
    stage->inverse = inverse;
    stage->null_freedoms = w->null_freedoms;
    stage->lambda = mt_arena_f64(mem, (size_t)w->p->m, 1);
    stage->h = mt_arena_f64(mem, nq, nq);
    stage->a = mt_arena_f64(mem, (size_t)w->p->m, nq);
    stage->trim = mt_arena_f64(mem, nq, 1);
    if (stage->lambda == NULL || stage->h == NULL || stage->a == NULL || stage->trim == NULL) {
        return mt_fail_memory(err);
    }
    memcpy(stage->lambda, w->lambda, (size_t)w->p->m * sizeof *stage->lambda);
    memcpy(stage->h, w->h, nq * nq * sizeof *stage->h);
    memcpy(stage->a, w->a, (size_t)w->p->m * nq * sizeof *stage->a);
    memcpy(stage->trim, w->trim, nq * sizeof *stage->trim);
    if (w->p->energy == MT_ENERGY_PHYSICAL) {
        report->residual = w->residual;
        report->trim_force = w->tau;
    }
    return MT_OK;
}

/* Plain Newton from the present position; *done tells whether it converged. */
static mt_status iterate(work *w, mt_pose *poses, mt_arena *mem, mt_state *report,
                         mt_stage *stage, bool *done, mt_err *err)
{
    double previous = HUGE_VAL;
    *done = false;
    for (int it = 0; it < NEWTON_LIMIT; it++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        mt_elimination e;
        double *inverse = NULL;
        const double tau = w->tau;
        MT_TRY(linearise(w, poses, mem, &e, &inverse, err));
        report->iterations++;
        /* stop where the step is rounding: small, and no longer shrinking or negligible */
        const bool small = w->moved <= STEP_DONE &&
                           (w->moved >= 0.25 * previous || w->moved <= 8.0 * DBL_EPSILON);
        if (small && w->gap <= STEP_DONE) {
            w->tau = tau;
            if (!(w->residual <= FORCE_DONE)) {
                return MT_OK; /* something pushes along a freedom without stiffness */
            }
            *done = true;
            return keep(w, &e, inverse, mem, report, stage, err);
        }
        previous = w->moved;
        take_step(w, poses, STEP_LIMIT);
        mt_arena_rewind(mem, mark);
        if (!(w->moved < HUGE_VAL)) {
            return MT_OK;
        }
    }
    return MT_OK;
}

mt_status mt_newton_solve(const mt_newton_problem *problem, mt_pose *poses, mt_arena *mem,
                          mt_state *report, mt_stage *stage, mt_err *err)
{
    work w;
    bool done = false;
    const size_t size = (size_t)problem->data->sys->n_bodies * sizeof *poses;
    MT_TRY(work_init(&w, problem, mem, err));
    mt_pose *const start =
        mt_arena_alloc(mem, (size_t)problem->data->sys->n_bodies, sizeof *start);
    if (start == NULL) {
        return mt_fail_memory(err);
    }
    memcpy(start, poses, size);
    MT_TRY(iterate(&w, poses, mem, report, stage, &done, err));
    if (!done && problem->energy == MT_ENERGY_PHYSICAL) {
        memcpy(poses, start, size);
        w.tau = 0.0;
        MT_TRY(descend(&w, poses, mem, err));
        MT_TRY(iterate(&w, poses, mem, report, stage, &done, err));
    }
    if (done) {
        return MT_OK;
    }
    mt_elimination e;
    evaluate(&w, poses, false);
    MT_TRY(mt_eliminate(w.sys, problem->m, w.a, mem, &e, err));
    if (!(constraint_gap(&w) <= STEP_DONE)) {
        return mt_newton_open_loop(problem, poses, &e, mem, err);
    }
    return mt_fail(err, MT_E_EQUILIBRIUM,
                   "no equilibrium found after %d iterations: the largest unbalanced force is "
                   "%.3g of the forces at work (free to move under load?)",
                   report->iterations, w.residual);
}

mt_status mt_newton_gap(const mt_newton_problem *problem, const mt_pose *poses, mt_arena *mem,
                        double *gap_m, mt_err *err)
{
    work w;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    MT_TRY(work_init(&w, problem, mem, err));
    evaluate(&w, poses, false);
    *gap_m = constraint_gap(&w) * w.sys->length_m;
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

mt_status mt_newton_tangent(const mt_newton_problem *problem, const mt_pose *poses, mt_state *p,
                            const mt_stage *stage, double *d, mt_arena *scratch, mt_err *err)
{
    if (!stage->active) {
        return MT_OK;
    }
    work w;
    const int m = problem->m;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    MT_TRY(work_init(&w, problem, scratch, err));
    const int nq = w.sys->nq;
    mt_pose *const moved = mt_arena_alloc(scratch, (size_t)w.sys->n_bodies, sizeof *moved);
    double *const eta = mt_arena_f64(scratch, (size_t)stage->order + 1, 1);
    if (moved == NULL || eta == NULL) {
        return mt_fail_memory(err);
    }
    mt_position_complex(w.sys, poses, d, moved);
    for (int i = 0; i < m; i++) {
        w.lambda_cx[i] = stage->lambda[i];
    }
    w.l.trim_force = p->trim_force;
    mt_lagrangian_eval(problem->data, problem->energy, problem->drawn, moved, m, w.lambda_cx,
                       false, false, &w.l);
    /* derivative of grad L = g + A^T lambda at fixed lambda, and of -c */
    for (int j = 0; j < nq; j++) {
        mt_cx sum = w.l.g[j];
        for (int i = 0; i < m; i++) {
            sum += w.lambda_cx[i] * w.l.a[i + ((ptrdiff_t)j * m)];
        }
        w.g[j] = cx_derivative(sum);
    }
    for (int i = 0; i < m; i++) {
        w.c[i] = -cx_derivative(w.l.c[i]);
    }
    MT_TRY(mt_eliminate_particular(&stage->e, w.c, w.v, scratch, err));
    mt_gemv(false, nq, nq, 1.0, stage->h, nq, w.v, 1.0, w.g);
    mt_eliminate_project(&stage->e, w.g, w.reduced);
    for (int i = 0; i < stage->e.n; i++) {
        w.reduced[i] = -w.reduced[i];
    }
    if (problem->trim) {
        double row = w.c[m - 1];
        for (int j = 0; j < nq; j++) {
            row -= stage->a[(m - 1) + ((ptrdiff_t)j * m)] * w.v[j];
        }
        w.reduced[stage->e.n] = row;
    }
    mt_gemv(false, stage->order, stage->order, 1.0, stage->inverse, stage->order, w.reduced,
            0.0, eta);
    mt_eliminate_expand(&stage->e, eta, w.step);
    /* A^T lambda' = -(grad L)' - H (v + Z eta) - t tau' */
    mt_gemv(false, nq, nq, 1.0, stage->h, nq, w.step, 1.0, w.g);
    if (problem->trim) {
        mt_axpy(nq, eta[stage->e.n], stage->trim, w.g);
    }
    mt_axpy(nq, 1.0, w.v, w.step);
    mt_axpy(nq, 1.0, w.step, d);
    if (problem->energy == MT_ENERGY_PHYSICAL) {
        for (int j = 0; j < nq; j++) {
            w.g[j] = -w.g[j];
        }
        memset(p->d_lambda, 0, (size_t)w.sys->n_constraints * sizeof *p->d_lambda);
        MT_TRY(mt_eliminate_multipliers(&stage->e, w.g, p->d_lambda, scratch, err));
        p->d_trim_force = problem->trim ? eta[stage->e.n] : 0.0;
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

enum { NAMES_SIZE = 400 };
/* Entries of a left null vector (largest 1) above this belong to the dependent set. */
static const double IN_THE_SET = 1e-6;

/* "a", "b", ...: joints with an entry in the null vector, each once, cut where the text is full. */
static void join_names(const mt_system *sys, int m, const double *null, char names[NAMES_SIZE])
{
    size_t used = 0;
    int last = -1;
    names[0] = '\0';
    for (int i = 0; i < m; i++) {
        const int joint = sys->constraints[i].joint;
        if (!(fabs(null[i]) > IN_THE_SET) || joint == last || joint < 0) {
            continue;
        }
        const int n = snprintf(names + used, NAMES_SIZE - used, "%s\"%s\"",
                               used == 0 ? "" : ", ", sys->joints[joint].name);
        if (n < 0 || (size_t)n >= NAMES_SIZE - used) {
            names[used] = '\0';
            return;
        }
        used += (size_t)n;
        last = joint;
    }
}

/* Which joints to name: those in the left null vectors of A that the gap lies along (they contradict each other), else the one furthest open. */
mt_status mt_newton_open_loop(const mt_newton_problem *problem, const mt_pose *poses,
                              const mt_elimination *e, mt_arena *scratch, mt_err *err)
{
    work w;
    MT_TRY(work_init(&w, problem, scratch, err));
    evaluate(&w, poses, false);
    int worst = 0;
    double gap = 0.0;
    for (int i = 0; i < problem->m; i++) {
        if (!(fabs(w.c[i]) <= gap)) {
            gap = fabs(w.c[i]);
            worst = i;
        }
    }
    const mt_constraint_def *const c = &w.sys->constraints[worst];
    const mt_measure_kind kind = w.sys->measures[c->measure[0]].kind;
    const bool length = kind == MT_MEASURE_PLANE || kind == MT_MEASURE_DISTANCE;
    const char *const unit = length ? "m" : "(cosine or rad)";
    double *const null = mt_arena_f64(scratch, (size_t)problem->m, 1);
    char names[NAMES_SIZE];
    if (null == NULL) {
        return mt_fail_memory(err);
    }
    for (int k = 0; k < e->m - e->qr.rank; k++) {
        MT_TRY(mt_eliminate_left_null(e, k, null, scratch, err));
        if (fabs(null[worst]) > IN_THE_SET) {
            join_names(w.sys, problem->m, null, names);
            return mt_fail(err, MT_E_ASSEMBLY,
                           "joints %s contradict each other: a gap of %.6g %s is left", names,
                           gap, unit);
        }
    }
    return mt_fail(err, MT_E_ASSEMBLY,
                   "the mechanism cannot be assembled: joint \"%s\" stays open by %.6g %s",
                   w.sys->joints[c->joint].name, gap, unit);
}
