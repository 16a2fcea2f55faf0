/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Newton with multipliers. At a position q with constraints c, Jacobian A, freedoms Z (A Z =
 * 0):
 *     lambda  = least-squares solution of A^T lambda = -g
 *     v       = -A^+ c                                    back to the constraints
 *     H       = Hessian of V + lambda c
 *     Z^T H Z eta = -Z^T (g + H v)                        towards equilibrium
 *     q      <- q (+) (v + Z eta).
 * No basis Z is needed for that where the equations are regular: with r = g + A^T lambda
 *     [ I A^T; A 0 ] [r; -lambda] = [g; 0],      [ H A^T; A 0 ] [v + Z eta; .] = [-r; -c]
 * (I in scaled coordinates), which stay sparse (saddle.h). After a short step lambda is what
 * the second made of it: the first is solved where there is no such step.
 * Freedoms without stiffness (singular values of Z^T H Z below NO_STIFFNESS of H itself in
 * scaled coordinates) take no step; the residual test then decides whether something still
 * pushes along them. With `trim` the force tau of one spring is unknown and the drive's row
 * (a_d, c_d) is its equation:
 *     [Z^T H Z   Z^T t] [eta]   [-Z^T (g + H v)  ]
 *     [a_d Z       0  ] [tau] = [-(c_d + a_d v)  ].
 */
#include "mechanics/newton_step.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/run.h"
#include "mechanics/constraint.h"

/* Singular values of the reduced Hessian below this fraction of the largest stiffness, be it
 * one that the joints hold, belong to freedoms without stiffness: rounding leaves about n eps ~
 * 1e-14 of them, and a real stiffness may be 1e12 times softer than its neighbour. */
static const double NO_STIFFNESS = 1e-13;
/* Of the inverse of the sparse equations, in scaled units. The first is that of a singular
 * value of A of 1e-4, far above what singular.c looks at; the other a thousandth of
 * 1/NO_STIFFNESS, for what the estimate of the norm and sums over many freedoms may be off. */
static const double FAR_FROM_DEPENDENT = 1e8;
static const double FIRM = 1e10;
/* Gaps up to here are rounding of the drawing [model lengths], and so is what is unbalanced up
 * to this many eps of the forces on a body: their products with arms, and their sum. */
static const double CLOSED = 64.0 * DBL_EPSILON;
static const double FORCE_ULPS = 4.0;
/* A step downhill that is longer than it may be by no more than this is shortened as a whole.
 * */
static const double LITTLE_LONGER = 2.0;

mt_status mt_newton_work_init(mt_newton_work *w, const mt_newton_problem *p, mt_arena *mem,
                              mt_err *err)
{
    const mt_system *const sys = p->data->sys;
    const size_t nq = (size_t)sys->nq;
    const size_t m = (size_t)sys->n_constraints;
    *w = (mt_newton_work){.p = p, .sys = sys};
    w->g = mt_arena_f64(mem, nq, 1);
    w->c = mt_arena_f64(mem, m, 1);
    w->trim = mt_arena_f64(mem, nq, 1);
    if (mt_saddle_pays(sys)) {
        w->sparse = (mt_lagrangian){.g = w->g, .c = w->c, .trim = w->trim};
        mt_lagrangian_want_rows(&w->sparse, sys, mem);
        w->least = mt_arena_f64(mem, sys->layout->envelope.count, 1);
        w->turn = mt_arena_f64(mem, m, 1);
    } else {
        MT_TRY(mt_newton_dense(w, mem, err));
    }
    w->lambda_cx = mt_arena_alloc(mem, m, sizeof *w->lambda_cx);
    w->lambda = mt_arena_f64(mem, m, 1);
    w->v = mt_arena_f64(mem, nq, 1);
    w->step = mt_arena_f64(mem, nq, 1);
    w->reduced = mt_arena_f64(mem, nq + 1, 1);
    return mt_arena_check(mem, err);
}

mt_status mt_newton_dense(mt_newton_work *w, mt_arena *mem, mt_err *err)
{
    if (w->h != NULL) {
        return MT_OK;
    }
    if (w->p->sparse) {
        return mt_fail(err, MT_E_EQUILIBRIUM, "equations that are not regular beyond doubt");
    }
    const size_t nq = (size_t)w->sys->nq;
    w->a = mt_arena_f64(mem, (size_t)w->sys->n_constraints, nq);
    w->h = mt_arena_f64(mem, nq, nq);
    w->l = (mt_lagrangian){.g = w->g, .c = w->c, .trim = w->trim, .a = w->a, .h = w->h};
    w->l.push = mt_arena_f64(mem, (size_t)w->sys->n_bodies, 1);
    return mt_arena_check(mem, err);
}

double mt_newton_gap_at(mt_newton_work *w, const mt_placement *at)
{
    mt_constraint_values(w->p->data, at, w->p->m, w->c);
    return mt_newton_gap_of(w);
}

/* Set the scales of residuals: the anchor's own unit is a displacement of one model length. */
static void set_residual_scales(mt_newton_work *w, const mt_lagrangian *l, double unbalanced)
{
    const bool anchor = w->p->energy == MT_ENERGY_ANCHOR;
    const double force = anchor ? w->sys->length_m : l->force_scale;
    const double scale = force > 0.0 ? force : 1.0;
    w->gap = mt_newton_gap_of(w);
    w->residual = unbalanced / scale;
    w->noise = l->force_noise / scale;
}

static void load_multipliers(mt_newton_work *w)
{
    for (int i = 0; i < w->p->m; i++) {
        w->lambda_cx[i] = w->lambda[i];
    }
}

void mt_newton_evaluate(mt_newton_work *w, const mt_placement *at, bool hessian)
{
    const int m = w->p->m;
    w->l.trim_force = w->tau;
    w->l.trim_force_derivative = 0.0;
    load_multipliers(w);
    mt_lagrangian_eval(w->p->data, w->p->energy, w->p->drawn, at, m, w->lambda_cx,
                       hessian ? MT_CURVATURE_FULL : MT_CURVATURE_NONE, &w->l);
}

/* How many rows carry a multiplier: with trim all but the last. */
static int rows(const mt_newton_work *w)
{
    return w->p->trim ? w->p->m - 1 : w->p->m;
}

/* Elimination of those rows. */
static mt_status eliminate_rows(const mt_newton_work *w, mt_arena *mem, mt_elimination *e,
                                mt_err *err)
{
    const int m = rows(w);
    if (m == w->p->m) {
        return mt_eliminate(w->sys, m, w->a, mem, e, err);
    }
    double *const a = mt_arena_f64(mem, (size_t)m, (size_t)w->sys->nq);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t j = 0; j < w->sys->nq; j++) {
        memcpy(a + (j * m), w->a + (j * w->p->m), (size_t)m * sizeof *a);
    }
    return mt_eliminate(w->sys, m, a, mem, e, err);
}

double mt_newton_scaled_norm(const mt_newton_work *w, const double *dq)
{
    double s = 0.0;
    for (int b = 0; b < w->sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            const int dof = w->sys->bodies[b].dof[k];
            if (dof >= 0) {
                const double x = fabs(dq[dof]) * (k < 3 ? 1.0 / w->sys->length_m : 1.0);
                s = !(x <= s) ? x : s; /* NaN is kept */
            }
        }
    }
    return s;
}

double mt_newton_gap_of(const mt_newton_work *w)
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

mt_status mt_newton_reduce_hessian(const mt_newton_work *w, const mt_elimination *e, double *k,
                                   int ld, mt_arena *mem, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    double *const hz = mt_arena_f64(mem, (size_t)e->nq, (size_t)e->n);
    MT_TRY(mt_arena_check(mem, err));
    mt_gemm(false, false, e->nq, e->n, e->nq, 1.0, w->h, e->nq, e->z, e->nq, 0.0, hz, e->nq);
    mt_gemm(true, false, e->n, e->n, e->nq, 1.0, e->z, e->nq, hz, e->nq, 0.0, k, ld);
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

/* Length of a row in the elimination's coordinates, in which angles and displacements have
 * equal weight; 1 for an empty row. */
static double row_length(const mt_elimination *e, const double *row, ptrdiff_t step)
{
    double length = 0.0;
    for (ptrdiff_t j = 0; j < e->nq; j++) {
        length = hypot(length, row[j * step] * e->dc[j]);
    }
    return length > 0.0 ? length : 1.0;
}

/* Row and column of the drive, times scale[0] and scale[1]. */
static void border(const mt_newton_work *w, const mt_elimination *e, const double scale[2],
                   double *k)
{
    const int n = e->n;
    const ptrdiff_t order = n + 1;
    for (int c = 0; c < n; c++) {
        const double *const zc = e->z + ((ptrdiff_t)c * e->nq);
        double row = 0.0;
        for (int j = 0; j < e->nq; j++) {
            row += w->a[(w->p->m - 1) + ((ptrdiff_t)j * w->p->m)] * zc[j];
        }
        k[n + (c * order)] = scale[0] * row;
        k[c + (n * order)] = scale[1] * mt_dot(e->nq, zc, w->trim);
    }
    k[n + (n * order)] = 0.0;
}

/* Largest entry of the Hessian in the elimination's coordinates, in which Z has orthonormal
 * columns. */
static double stiffness_scale(const mt_newton_work *w, const mt_elimination *e)
{
    double most = 0.0;
    for (ptrdiff_t j = 0; j < e->nq; j++) {
        for (ptrdiff_t i = 0; i < e->nq; i++) {
            most = fmax(most, fabs(e->dc[i] * w->h[i + (j * e->nq)] * e->dc[j]));
        }
    }
    return most;
}

/* inverse := k^-1 where no singular value can be below `tolerance` of the largest: the
 * Frobenius norms of both bound their ratio, and rounding leaves less than half of the
 * inverse's. */
static mt_status invert_regular(int n, const double *k, double tolerance, double *inverse,
                                bool *regular, mt_arena *mem, mt_err *err)
{
    static const double ROUNDED = 2.0;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const ptrdiff_t entries = (ptrdiff_t)n * n;
    double *const copy = mt_arena_f64(mem, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(mem, err));
    *regular = false;
    if (!mt_all_finite(entries, k)) {
        mt_arena_rewind(mem, mark);
        return MT_OK;
    }
    memcpy(copy, k, (size_t)entries * sizeof *copy);
    memset(inverse, 0, (size_t)entries * sizeof *inverse);
    for (ptrdiff_t i = 0; i < n; i++) {
        inverse[i + (i * n)] = 1.0;
    }
    const mt_status rc = mt_lu_solve(n, copy, n, inverse, NULL, mem, NULL);
    if (rc == MT_OK) {
        const double norms = mt_norm2((int)entries, k) * mt_norm2((int)entries, inverse);
        *regular = norms * tolerance * ROUNDED < 1.0;
    }
    mt_arena_rewind(mem, mark);
    return rc == MT_E_MEMORY ? mt_fail_memory(err) : MT_OK;
}

mt_status mt_newton_invert(mt_newton_work *w, const mt_elimination *e, mt_arena *mem,
                           double **inverse, mt_err *err)
{
    const int order = e->n + (w->p->trim ? 1 : 0);
    int rank = 0;
    double scale[2] = {1.0, 1.0}; /* of the border: row, column */
    double *const k = mt_arena_f64(mem, (size_t)order, (size_t)order);
    *inverse = mt_arena_f64(mem, (size_t)order, (size_t)order);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_newton_reduce_hessian(w, e, k, order, mem, err));
    const double noise = NO_STIFFNESS * stiffness_scale(w, e);
    if (w->p->trim) { /* units that keep the border of the size of the rest */
        const double most = mt_max_abs((ptrdiff_t)order * order, k);
        const double stiffness = most > 0.0 ? most : 1.0;
        scale[0] = stiffness / row_length(e, w->a + (w->p->m - 1), w->p->m);
        scale[1] = stiffness / row_length(e, w->trim, 1);
        border(w, e, scale, k);
    }
    const double most = mt_max_abs((ptrdiff_t)order * order, k);
    const double tolerance = fmax(NO_STIFFNESS, most > 0.0 ? noise / most : 0.0);
    bool regular = false;
    MT_TRY(invert_regular(order, k, tolerance, *inverse, &regular, mem, err));
    if (regular) {
        rank = order;
    } else {
        MT_TRY(mt_pinv(order, order, k, tolerance, *inverse, &rank, mem, err));
    }
    w->null_freedoms = order - rank;
    for (int c = 0; c < order && w->p->trim; c++) { /* undone: the inverse's rows belong to the
                                                       columns of what was inverted */
        (*inverse)[e->n + ((ptrdiff_t)c * order)] *= scale[1];
        (*inverse)[c + ((ptrdiff_t)e->n * order)] *= scale[0];
    }
    return MT_OK;
}

/* Z has orthonormal columns in the elimination's coordinates. */
mt_status mt_newton_falls(mt_newton_work *w, const mt_elimination *e, const double *way,
                          bool *falls, mt_arena *mem, mt_err *err)
{
    const int n = e->n;
    double *const k = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const values = mt_arena_f64(mem, (size_t)n, 1);
    double *const scaled = mt_arena_f64(mem, (size_t)e->nq, 1);
    double *const y = mt_arena_f64(mem, (size_t)n, 1);
    double *const down = mt_arena_f64(mem, (size_t)n, 1);
    *falls = false;
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_newton_reduce_hessian(w, e, k, n, mem, err));
    MT_TRY(mt_eig_sym(n, k, values, true, mem, err));
    for (int j = 0; j < e->nq; j++) {
        scaled[j] = way[j] / e->dc[j] / e->dc[j]; /* the square may leave the range */
    }
    mt_eliminate_project(e, scaled, y);
    const double noise = NO_STIFFNESS * stiffness_scale(w, e);
    for (int i = 0; i < n && values[i] < -noise; i++) {
        const double *const v = k + ((ptrdiff_t)i * n);
        mt_axpy(n, -mt_dot(n, v, y), v, down);
    }
    *falls = mt_norm2(n, down) > MT_DRAWN * w->sys->length_m;
    if (*falls) {
        mt_eliminate_expand(e, down, w->step);
    }
    return MT_OK;
}

bool mt_newton_at_rest(mt_newton_work *w, const mt_elimination *e)
{
    const mt_system *const sys = w->sys;
    bool rest = w->gap <= CLOSED;
    mt_eliminate_project(e, w->g, w->reduced);
    for (int i = 0; i < e->n && rest; i++) {
        const double *const z = e->z + ((ptrdiff_t)i * e->nq);
        double terms = 0.0;
        for (int b = 0; b < sys->n_bodies; b++) {
            for (int k = 0; k < 6; k++) {
                const int dof = sys->bodies[b].dof[k];
                const double arm = k < 3 ? 1.0 : sys->length_m;
                terms += dof >= 0 ? arm * w->l.push[b] * fabs(z[dof]) : 0.0;
            }
        }
        rest = fabs(w->reduced[i]) <= FORCE_ULPS * DBL_EPSILON * terms;
    }
    return rest;
}

/* out[nq] = g + A^T lambda. Unlike Z^T g, forces cancel where they act, not in a sum over all
 * freedoms, whose rounding would move soft freedoms. */
static void find_unbalanced(const mt_newton_work *w, double *out)
{
    for (int j = 0; j < w->sys->nq; j++) {
        const double *const column = w->a + ((ptrdiff_t)j * w->p->m);
        out[j] = w->g[j] + mt_dot(w->p->m, column, w->lambda);
    }
}

/* Multipliers, then gradient, Hessian and residual with them. */
static mt_status evaluate_with_multipliers(mt_newton_work *w, const mt_placement *at,
                                           mt_arena *mem, mt_elimination *e, mt_err *err)
{
    memset(w->lambda, 0, (size_t)w->p->m * sizeof *w->lambda);
    w->l.trim_force = w->tau;
    w->l.trim_force_derivative = 0.0;
    mt_lagrangian_eval(w->p->data, w->p->energy, w->p->drawn, at, w->p->m, NULL,
                       w->elastic ? MT_CURVATURE_ELASTIC : MT_CURVATURE_FULL, &w->l);
    MT_TRY(eliminate_rows(w, mem, e, err));
    for (int j = 0; j < w->sys->nq; j++) {
        w->v[j] = -w->g[j];
    }
    MT_TRY(mt_eliminate_multipliers(e, w->v, w->lambda, mem, err));
    if (!w->elastic) {
        load_multipliers(w);
        mt_lagrangian_curve(w->p->data, at, w->p->m, w->lambda_cx, &w->l);
    }
    find_unbalanced(w, w->v);
    mt_eliminate_project(e, w->v, w->reduced);
    set_residual_scales(w, &w->l, mt_max_abs(e->n, w->reduced));
    return MT_OK;
}

/* g + A^T lambda into w->reduced [nq]; returns its largest entry in scaled coordinates. */
static double unbalanced(mt_newton_work *w, const mt_saddle *s)
{
    const mt_layout *const o = w->sys->layout;
    double most = 0.0;
    memcpy(w->reduced, w->g, (size_t)w->sys->nq * sizeof *w->reduced);
    mt_lagrangian_pull(&w->sparse, w->p->m, w->lambda, w->reduced);
    for (int j = 0; j < w->sys->nq; j++) {
        const double force = fabs(s->d[o->state[j]] * w->reduced[j]);
        most = !(force <= most) ? force : most; /* NaN is kept */
    }
    return most;
}

mt_status mt_newton_least_squares(mt_newton_work *w, bool apart, mt_arena *mem,
                                  mt_saddle *least, bool *sure, mt_err *err)
{
    w->factors++;
    MT_TRY(mt_saddle_factor(w->sys, rows(w), &w->sparse, MT_SADDLE_LEAST_SQUARES, w->least, mem,
                            least, err));
    *sure = least->whole;
    return *sure && apart ? mt_saddle_below(least, FAR_FROM_DEPENDENT, mem, sure, err) : MT_OK;
}

/* w->step, w->turn and how much *more the trimmed spring pushes, of w->reduced and w->turn;
 * *sure: the border of such a spring leaves the equations regular. */
static mt_status solve_sparse(mt_newton_work *w, mt_newton_solver *solver, double *more,
                              bool *sure, mt_arena *mem, mt_err *err)
{
    const mt_saddle *const s = &solver->saddle;
    if (!w->p->trim) {
        return mt_saddle_solve(s, w->reduced, w->turn, w->step, w->turn, mem, err);
    }
    MT_TRY(mt_border_init(s, w->trim, FIRM, mem, &solver->border, sure, err));
    return *sure ? mt_border_solve(&solver->border, w->reduced, w->turn, w->step, w->turn, more,
                                   mem, err)
                 : MT_OK;
}

/* w->lambda by least squares, and what they leave unbalanced. */
static mt_status find_multipliers(mt_newton_work *w, bool first, mt_arena *mem, bool *sure,
                                  mt_err *err)
{
    const int m = w->p->m;
    mt_saddle least;
    MT_TRY(mt_newton_least_squares(w, first && !w->p->sparse, mem, &least, sure, err));
    if (!*sure) {
        return MT_OK;
    }
    memset(w->lambda, 0, (size_t)m * sizeof *w->lambda);
    MT_TRY(mt_saddle_solve(&least, w->g, NULL, NULL, w->lambda, mem, err));
    for (int i = 0; i < m; i++) {
        w->lambda[i] = -w->lambda[i];
    }
    set_residual_scales(w, &w->sparse, unbalanced(w, &least));
    return MT_OK;
}

mt_status mt_newton_linearise_sparse(mt_newton_work *w, const mt_placement *at, bool first,
                                     mt_arena *mem, mt_newton_solver *solver, bool *sure,
                                     mt_err *err)
{
    const mt_newton_problem *const p = w->p;
    const int nq = w->sys->nq;
    *solver = (mt_newton_solver){.sparse = true};
    MT_TRY(mt_interrupt_check(w->sys->run->interrupt, err));
    w->sparse.trim_force = w->tau;
    mt_lagrangian_eval(p->data, p->energy, p->drawn, at, p->m, NULL,
                       w->elastic ? MT_CURVATURE_ELASTIC : MT_CURVATURE_FULL, &w->sparse);
    const bool followed = w->followed;
    w->followed = false;
    *sure = true;
    if (followed) {
        mt_axpy(p->m, 1.0, w->turn, w->lambda);
    } else {
        MT_TRY(find_multipliers(w, first, mem, sure, err));
    }
    if (!*sure) {
        return MT_OK;
    }
    if (!w->elastic) {
        load_multipliers(w);
        mt_lagrangian_curve(p->data, at, p->m, w->lambda_cx, &w->sparse);
    }
    w->factors++;
    MT_TRY(mt_saddle_factor(w->sys, p->m, &w->sparse,
                            p->sparse ? MT_SADDLE_SOFT : MT_SADDLE_REGULAR, w->sparse.h, mem,
                            &solver->saddle, err));
    *sure = solver->saddle.whole && (!first || mt_saddle_convex(&solver->saddle));
    if (!*sure) {
        return MT_OK;
    }
    if (followed) { /* (not of soft ones, which are scaled otherwise) */
        set_residual_scales(w, &w->sparse, unbalanced(w, &solver->saddle));
    }
    for (int j = 0; j < nq; j++) {
        w->reduced[j] = -w->reduced[j];
    }
    for (int i = 0; i < p->m; i++) {
        w->turn[i] = -w->c[i];
    }
    double more = 0.0;
    MT_TRY(solve_sparse(w, solver, &more, sure, mem, err));
    if (!*sure) {
        return MT_OK;
    }
    w->moved = mt_newton_scaled_norm(w, w->step);
    w->null_freedoms = 0;
    const bool convex = mt_saddle_convex(&solver->saddle);
    /* (with nothing to compare, one that is too long is shortened as a whole) */
    *sure = w->moved <= (convex ? LITTLE_LONGER : 1.0) * MT_STEP_LIMIT ||
            (p->sparse && w->moved < HUGE_VAL);
    w->tau += *sure ? more : 0.0;
    return MT_OK;
}

mt_status mt_newton_is_firm(const mt_saddle *saddle, mt_arena *scratch, bool *firm, mt_err *err)
{
    return mt_saddle_below(saddle, FIRM, scratch, firm, err);
}

/*
 * Shorten a step that is too long in each eigenvector of Z^T H Z by itself: motions with almost
 * no stiffness (a rod's spin between ball joints, which has none at an equilibrium, but off it
 * some, as large as the unbalanced force) go as far as a step may, and the others their full
 * way. Shortened as a whole such a step would get nowhere.
 */
static mt_status shorten(mt_newton_work *w, const mt_elimination *e, double *eta, mt_arena *mem,
                         mt_err *err)
{
    const ptrdiff_t n = e->n;
    const double most = MT_STEP_LIMIT * w->sys->length_m; /* Z is orthonormal in lengths */
    double *const k = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const values = mt_arena_f64(mem, (size_t)n, 1);
    double *const kept = mt_arena_f64(mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_newton_reduce_hessian(w, e, k, e->n, mem, err));
    MT_TRY(mt_eig_sym(e->n, k, values, true, mem, err));
    for (ptrdiff_t i = 0; i < n; i++) {
        const double *const v = k + (i * n);
        const double part = mt_dot(e->n, v, eta);
        mt_axpy(e->n, fmax(fmin(part, most), -most), v, kept);
    }
    memcpy(eta, kept, (size_t)n * sizeof *eta);
    return MT_OK;
}

mt_status mt_newton_linearise(mt_newton_work *w, const mt_placement *at, mt_arena *mem,
                              mt_newton_solver *solver, mt_err *err)
{
    const int nq = w->sys->nq;
    mt_elimination *const e = &solver->e;
    *solver = (mt_newton_solver){.sparse = false};
    MT_TRY(mt_interrupt_check(w->sys->run->interrupt, err));
    w->factors += 2;
    MT_TRY(evaluate_with_multipliers(w, at, mem, e, err));
    MT_TRY(mt_newton_invert(w, e, mem, &solver->inverse, err));
    double *const minus_c = mt_arena_f64(mem, (size_t)w->p->m, 1);
    double *const hv = mt_arena_f64(mem, (size_t)nq, 1);
    double *const eta = mt_arena_f64(mem, (size_t)e->n + 1, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < w->p->m; i++) {
        minus_c[i] = -w->c[i];
    }
    MT_TRY(mt_eliminate_particular(e, minus_c, w->v, mem, err));
    find_unbalanced(w, hv);
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
    mt_gemv(false, order, order, 1.0, solver->inverse, order, w->reduced, 0.0, eta);
    mt_eliminate_expand(e, eta, w->step);
    mt_axpy(nq, 1.0, w->v, w->step);
    w->moved = mt_newton_scaled_norm(w, w->step);
    if (!w->p->trim && w->moved > MT_STEP_LIMIT && w->moved < HUGE_VAL) {
        MT_TRY(shorten(w, e, eta, mem, err));
        mt_eliminate_expand(e, eta, w->step);
        mt_axpy(nq, 1.0, w->v, w->step);
        w->moved = mt_newton_scaled_norm(w, w->step);
    }
    if (w->p->trim) {
        w->tau += eta[e->n];
    }
    return MT_OK;
}

void mt_newton_follow(const mt_newton_work *w, mt_placement *at)
{
    if (w->p->energy == MT_ENERGY_PHYSICAL) {
        mt_data_turns(w->p->data, at);
    }
}

void mt_newton_take_step(mt_newton_work *w, mt_placement *at, double limit)
{
    const double factor = w->moved > limit ? limit / w->moved : 1.0;
    for (int j = 0; j < w->sys->nq; j++) {
        w->step[j] *= factor;
    }
    mt_poses_move(w->sys, at->pose, w->step);
}
