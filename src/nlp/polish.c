/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * From nearly there to full accuracy: Newton's method on the KKT conditions in the null space
 * of the active constraints (Nocedal and Wright, Numerical Optimization, 2006, section 18.3).
 *
 *     C p_y = -c              least norm, from the QR of C^T
 *     Z^T H Z p_z = -Z^T g    Z an orthonormal basis of the null space of C (on the free
 *                             variables)
 *     t := t + p_y + Z p_z
 *
 * H is the Hessian of the Lagrangian. Gradients are exact, so Z^T H Z comes from one further
 * gradient per column of Z (forward difference; its error of about 1e-6 costs one digit in six
 * per step, and the fixed point, where Z^T g = 0 and c = 0, does not depend on it). That is
 * most of the cost, so one Hessian serves as long as steps shrink fast with it and the active
 * constraints are the same (the simplified Newton method). A negative eigenvalue of Z^T H Z at
 * a stationary point tells a saddle from a minimum, and ends the iteration: the caller leaves
 * it. Where the Hessian is too expensive or a point refuses a value, the step is Gauss-Newton's
 * or there is none: the best point stands.
 */
#include "nlp/polish.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "nlp/kkt.h"

enum { ITERATIONS = 14, HESSIAN_MOST = 64 };
/* Difference step in t: near the square root of the rounding of a gradient. */
static const double STEP_H = 1e-6;
/* A Newton step longer than this is not a polish: shortened. */
static const double STEP_MOST = 0.3;
/* A shorter one is rounding of t. */
static const double STEP_LEAST = 16 * DBL_EPSILON;
/* A variable this near to its bound, relative to the width, is on it. */
static const double ON_BOUND = 1e-8;
/* KKT residual and violation that cannot be improved in double precision. */
static const double KKT_DONE = 1e-13;
static const double VIOLATION_DONE = 1e-6;
/* Eigenvalues of the reduced Hessian below this part of the largest are noise of the
 * differences: no step along them; below minus SADDLE of it they are negative. */
static const double CURVATURE_NOISE = 1e-7;
static const double SADDLE = 1e-4;
/* Curvatures and multipliers below this part of the gradients hold nothing: a direction with no
 * more is known to rounding over it, to fewer digits than are told. Of gradients that vanish
 * this part of the largest one met counts, as in kkt.c. */
static const double LOOSE = 1e-5;
static const double GRADIENT_FLOOR = 1e-3;
/* Squares whose least curvature is more than this part of the greatest rise on all sides. */
static const double RISES = 1e-4;
/* A step must not be longer than this part of the one before, or the iteration is not
 * converging; with an old Hessian not longer than the second, or it takes a new one. */
static const double CONTRACTION = 0.7;
static const double CONTRACTION_OLD = 0.2;
/* ... unless it is as short as this: then t is known as well as its gradients tell. */
static const double STEP_KNOWN = 1e-10;
/* Relative rounding allowed in the objective of the better of two points. */
static const double F_ROUNDING = 1e-9;

typedef struct polish {
    mt_nlp_engine *e;
    mt_nlp_stage stage;
    mt_nlp_active a;
    int nz;
    double *Z;    /* n_free x nz */
    double *H;    /* nz x nz, then its eigenvectors */
    int n_v;      /* columns of the last Hessian; -1: there is none */
    double *V;    /* n x n_v: its eigenvectors Z H on all variables */
    double *w;    /* [n_v] its eigenvalues */
    int *active;  /* [n + 1 + rows] the active set it is of */
    double *gl;   /* [n] gradient of the Lagrangian elsewhere */
    double *step; /* [n] */
    double *t;    /* [n] */
    mt_nlp_point *cur;
    mt_nlp_point *trial;
    mt_nlp_point *best;
    double limit;  /* the objective must not end above this */
    int n_loose;   /* at cur; -1: not known */
    bool isolated; /* likewise: squares rise on all sides */
} polish;

/* The active set as numbers: sides of the variables, rows. */
static bool active_changed(polish *w)
{
    const int n = w->e->n;
    bool changed = w->n_v < 0 || w->active[n] != w->a.k;
    for (int j = 0; j < n && !changed; j++) {
        changed = w->active[j] != w->a.side[j];
    }
    for (int i = 0; i < w->a.k && !changed; i++) {
        changed = w->active[n + 1 + i] != w->a.row[i];
    }
    memcpy(w->active, w->a.side, (size_t)n * sizeof *w->active);
    memcpy(w->active + n + 1, w->a.row, (size_t)w->a.k * sizeof *w->active);
    w->active[n] = w->a.k;
    return changed;
}

/* Gradient of the Lagrangian with the present multipliers at a point. */
static void lagrangian(const polish *w, const mt_nlp_point *p, double *gl)
{
    mt_nlp_gradient(w->e, p, w->stage, gl);
    for (int i = 0; i < w->a.k; i++) {
        for (int j = 0; j < w->e->n; j++) {
            gl[j] -= w->a.lambda[i] * mt_nlp_row_slope(w->e, p, w->a.row[i], j);
        }
    }
}

/* t := cur + h v on the free variables, backwards where that would leave the bounds; the signed
 * h. */
static double offset(polish *w, const double *v)
{
    const mt_nlp *const q = w->e->nlp;
    double h = STEP_H;
    for (int i = 0; i < w->a.n_free; i++) {
        const double x = w->cur->t[w->a.free[i]] + h * v[i];
        if (x < q->lower[w->a.free[i]] || x > q->upper[w->a.free[i]]) {
            h = -STEP_H;
            break;
        }
    }
    memcpy(w->t, w->cur->t, (size_t)w->e->n * sizeof *w->t);
    for (int i = 0; i < w->a.n_free; i++) {
        w->t[w->a.free[i]] += h * v[i];
    }
    return h;
}

/* H := Z^T (Hessian of the Lagrangian) Z, symmetrised. */
static bool reduced_hessian(polish *w)
{
    const int nf = w->a.n_free;
    for (int c = 0; c < w->nz; c++) {
        const double h = offset(w, w->Z + (ptrdiff_t)c * nf);
        if (!mt_nlp_evaluate(w->e, w->t, true, w->trial)) {
            return false;
        }
        lagrangian(w, w->trial, w->gl);
        for (int r = 0; r < w->nz; r++) {
            double sum = 0;
            for (int i = 0; i < nf; i++) {
                const int j = w->a.free[i];
                sum += w->Z[i + (ptrdiff_t)r * nf] * (w->gl[j] - w->a.z[j]);
            }
            w->H[r + (ptrdiff_t)c * w->nz] = sum / h;
        }
    }
    for (int c = 0; c < w->nz; c++) {
        for (int r = c + 1; r < w->nz; r++) {
            double *const lower = w->H + r + (ptrdiff_t)c * w->nz;
            *lower = 0.5 * (*lower + w->H[c + (ptrdiff_t)r * w->nz]);
        }
    }
    return true;
}

/* Gauss-Newton's Z^T J^T J Z for residuals: no evaluation. */
static bool gauss_newton(polish *w)
{
    const mt_nlp *const q = w->e->nlp;
    const int nf = w->a.n_free;
    if (q->n_res == 0 || w->stage == MT_NLP_SQUARES) {
        return false;
    }
    double *const jz = mt_arena_f64(&w->e->scratch, (size_t)q->n_res, (size_t)w->nz);
    if (!mt_nlp_has_room(w->e, &w->e->scratch)) {
        return false;
    }
    for (int c = 0; c < w->nz; c++) {
        for (int i = 0; i < nf; i++) {
            mt_axpy(q->n_res, w->Z[i + (ptrdiff_t)c * nf],
                    w->cur->dr + (ptrdiff_t)w->a.free[i] * q->n_res,
                    jz + (ptrdiff_t)c * q->n_res);
        }
    }
    mt_gemm(true, false, w->nz, w->nz, q->n_res, 1.0, jz, q->n_res, jz, q->n_res, 0.0, w->H,
            w->nz);
    return true;
}

/* step += Z p_z, from the eigenvalues of H; negative curvature is used by its size. */
static void reduced_step(polish *w)
{
    const int n = w->e->n;
    double largest = 0;
    for (int c = 0; c < w->n_v; c++) {
        largest = fmax(largest, fabs(w->w[c]));
    }
    for (int c = 0; c < w->n_v; c++) {
        const double *const v = w->V + (ptrdiff_t)c * n;
        if (fabs(w->w[c]) > CURVATURE_NOISE * largest) {
            mt_axpy(n, -mt_dot(n, v, w->a.z) / fabs(w->w[c]), v, w->step);
        }
    }
}

/* step := p_y, the least-norm correction of the active constraints. */
static bool normal_step(polish *w)
{
    mt_arena *const mem = &w->e->scratch;
    memset(w->step, 0, (size_t)w->e->n * sizeof *w->step);
    double *const rhs = mt_arena_f64(mem, (size_t)w->a.k, 1);
    double *const y = mt_arena_f64(mem, (size_t)w->a.n_free, 1);
    if (!mt_nlp_has_room(w->e, mem)) {
        return false;
    }
    for (int i = 0; i < w->a.k; i++) {
        rhs[i] = -w->a.c[i] / w->a.scale[i];
    }
    if (!mt_nlp_ok(w->e, mt_qr_solve_transposed(&w->a.qr, 1, rhs, y, mem, w->e->err))) {
        return false;
    }
    for (int i = 0; i < w->a.n_free; i++) {
        w->step[w->a.free[i]] = y[i];
    }
    return true;
}

/* Size of the step (largest entry), after variables at an active bound were put on it, and the
 * whole shortened to STEP_MOST and to the first bound met. A variable that stands on a bound
 * and would cross it stays: its multiplier is about zero, and a step shortened to nothing would
 * end the iteration. */
static double take_step(polish *w)
{
    const mt_nlp *const q = w->e->nlp;
    double size = 0;
    for (int j = 0; j < w->e->n; j++) {
        size = fmax(size, fabs(w->step[j]));
    }
    double part = size > STEP_MOST ? STEP_MOST / size : 1;
    for (int j = 0; j < w->e->n; j++) {
        const double room = (w->step[j] < 0 ? q->lower[j] : q->upper[j]) - w->cur->t[j];
        const double near = ON_BOUND * (q->upper[j] - q->lower[j]);
        if (w->a.side[j] == 0 && fabs(w->step[j]) * part > fabs(room) && fabs(room) > near) {
            part = fabs(room) / fabs(w->step[j]);
        }
    }
    for (int j = 0; j < w->e->n; j++) {
        w->t[j] = w->a.side[j] < 0   ? q->lower[j]
                  : w->a.side[j] > 0 ? q->upper[j]
                                     : mt_nlp_clamp(q, j, w->cur->t[j] + part * w->step[j]);
    }
    return size;
}

/* Allowed rise of the objective, since p may use the tolerances: multipliers times these. */
static double rise_allowed(const polish *w, const mt_nlp_point *p)
{
    double rise = F_ROUNDING * fabs(p->f);
    for (int i = 0; i < w->a.k; i++) {
        const double tol = mt_nlp_row_tol(w->e, w->a.row[i]);
        rise += 2 * fabs(w->a.lambda[i]) * fmax(tol, fabs(w->a.c[i]));
    }
    return rise;
}

/* Keep cur as the best where it is: feasible (or the aim has no constraints), not above the
 * limit, and nearer to a KKT point or, equally near, to the constraints. */
static void keep_if_better(polish *w)
{
    mt_nlp_point *const p = w->cur;
    const mt_nlp_point *const b = w->best;
    const bool constrained = w->stage == MT_NLP_OBJECTIVE;
    p->kkt = w->a.kkt;
    const double value = w->stage == MT_NLP_SQUARES ? p->squares : p->f;
    if ((constrained && mt_nlp_feasible(b) && !mt_nlp_feasible(p)) ||
        (value > w->limit && (!constrained || mt_nlp_feasible(b)))) {
        return;
    }
    const double mine = constrained ? fmax(p->kkt, p->violation * MT_STATIONARY) : p->kkt;
    const double theirs = constrained ? fmax(b->kkt, b->violation * MT_STATIONARY) : b->kkt;
    const bool first = constrained && mt_nlp_feasible(p) && !mt_nlp_feasible(b);
    /* from outside, the requirements cost what they cost: the limit counts from here */
    if (first) {
        w->limit = fmax(w->limit, p->f + rise_allowed(w, p));
    }
    if (mine < theirs || first) {
        mt_nlp_point_copy(w->e, w->best, p);
    }
}

/* saddle: eigenvector of a negative eigenvalue of Z^T H Z, largest entry positive; false:
 * none. */
static bool find_saddle(const polish *w, double *saddle)
{
    const int n = w->e->n;
    memset(saddle, 0, (size_t)n * sizeof *saddle);
    const double largest = w->n_v > 0 ? fmax(fabs(w->w[0]), fabs(w->w[w->n_v - 1])) : 0;
    if (w->n_v <= 0 || !(w->w[0] < -SADDLE * largest)) {
        return false;
    }
    int most = 0;
    for (int j = 1; j < n; j++) {
        most = fabs(w->V[j]) > fabs(w->V[most]) ? j : most;
    }
    mt_axpy(n, w->V[most] > 0 ? 1 : -1, w->V, saddle);
    return true;
}

/* Reduced Hessian at cur and its eigenvectors; without one the normal step alone remains. */
static void curvature(polish *w)
{
    const int nf = w->a.n_free;
    mt_nlp_engine *const e = w->e;
    mt_arena *const mem = &e->scratch;
    w->n_v = -1;
    w->nz = nf - w->a.qr.rank;
    w->Z = mt_arena_f64(mem, (size_t)nf, (size_t)w->nz); /* the rows' null space */
    w->H = mt_arena_f64(mem, (size_t)w->nz, (size_t)w->nz);
    if (!mt_nlp_has_room(e, mem) ||
        (w->nz > 0 && !mt_nlp_ok(e, mt_qr_q(&w->a.qr, w->a.qr.rank, w->Z, mem, e->err)))) {
        return;
    }
    const long left = e->opt.max_evals - e->evals;
    const bool affordable = w->nz > 0 && w->nz <= HESSIAN_MOST && left > 2 * (long)w->nz;
    if (w->nz > 0 && !(affordable && reduced_hessian(w)) && !gauss_newton(w)) {
        return;
    }
    if (!mt_nlp_ok(e, mt_eig_sym(w->nz, w->H, w->w, true, mem, e->err))) {
        return;
    }
    w->n_v = w->nz;
    memset(w->V, 0, (size_t)w->e->n * (size_t)w->n_v * sizeof *w->V);
    for (int c = 0; c < w->n_v; c++) {
        double *const v = w->V + (ptrdiff_t)c * w->e->n;
        for (int r = 0; r < w->n_v; r++) {
            for (int i = 0; i < nf; i++) {
                v[w->a.free[i]] += w->Z[i + (ptrdiff_t)r * nf] * w->H[r + (ptrdiff_t)c * w->nz];
            }
        }
    }
}

/*
 * Number of directions that nothing holds at cur: those without curvature among the ones that
 * the active constraints leave, and one for each active inequality or bound with multiplier 0
 * (a neighbouring minimum is as good). -1: curvature unknown.
 */
static int loose_directions(const polish *w)
{
    const mt_nlp_active *const a = &w->a;
    double scale = GRADIENT_FLOOR * w->e->df_scale;
    int n = 0;
    if (w->n_v < 0 || w->e->nlp->n_res > 0 || w->stage != MT_NLP_OBJECTIVE) {
        return -1;
    }
    mt_nlp_gradient(w->e, w->cur, w->stage, w->gl);
    for (int j = 0; j < w->e->n; j++) {
        scale = w->e->held[j] ? scale : fmax(scale, fabs(w->gl[j]));
    }
    for (int i = 0; i < a->k; i++) {
        scale = fmax(scale, fabs(a->lambda[i]) * a->scale[i]);
    }
    for (int c = 0; c < w->n_v; c++) {
        scale = fmax(scale, fabs(w->w[c]));
    }
    for (int c = 0; c < w->n_v; c++) {
        n += fabs(w->w[c]) <= LOOSE * scale;
    }
    for (int r = 0; r < a->qr.rank; r++) {
        const int i = a->qr.perm[r];
        n += a->row[i] >= w->e->nlp->n_eq && fabs(a->lambda[i]) * a->scale[i] <= LOOSE * scale;
    }
    for (int j = 0; j < w->e->n; j++) {
        n += a->side[j] != 0 && fabs(a->z[j]) <= LOOSE * scale;
    }
    return n;
}

/* True where the squares of violations increase from cur in every direction within the bounds:
 * by their curvature, or by their slope at a bound. */
static bool is_isolated(const polish *w)
{
    const mt_nlp_active *const a = &w->a;
    bool rises = w->stage == MT_NLP_SQUARES && w->n_v > 0 && w->n_v == a->n_free &&
                 w->w[0] > RISES * w->w[w->n_v - 1];
    double scale = 0.0;
    for (int j = 0; j < w->e->n && rises; j++) {
        scale = fmax(scale, fabs(a->z[j]));
    }
    for (int j = 0; j < w->e->n && rises; j++) {
        rises = a->side[j] == 0 || fabs(a->z[j]) > LOOSE * scale;
    }
    return rises;
}

static double longest(const polish *w)
{
    return mt_max_abs(w->e->n, w->step);
}

/* One Newton step from cur. False: done, or no further. size: of the step before, then of this
 * one. */
static bool newton_step(polish *w, double *size, double *saddle)
{
    mt_nlp_engine *const e = w->e;
    if (!mt_nlp_active_set(e, w->cur, w->stage, &e->scratch, &w->a)) {
        return false;
    }
    keep_if_better(w);
    const double c = w->stage == MT_NLP_OBJECTIVE ? w->cur->violation : 0;
    const bool done = w->a.kkt <= KKT_DONE && c <= VIOLATION_DONE;
    if (e->ended || (done && saddle == NULL) || !normal_step(w)) {
        return false;
    }
    bool fresh = active_changed(w);
    if (!fresh) {
        reduced_step(w);
        fresh = longest(w) > CONTRACTION_OLD * *size;
        if (fresh && longest(w) <= STEP_KNOWN) {
            return false;
        }
    }
    if (fresh) {
        curvature(w);
        if (e->ended || !normal_step(w)) {
            return false;
        }
        reduced_step(w);
    }
    w->n_loose = loose_directions(w);
    w->isolated = is_isolated(w);
    if (saddle != NULL && w->a.kkt <= MT_STATIONARY && find_saddle(w, saddle)) {
        return false;
    }
    if (done) {
        return false;
    }
    *size = take_step(w);
    return *size > STEP_LEAST && mt_nlp_evaluate(e, w->t, true, w->trial);
}

static void run_newton_iterations(polish *w, double *saddle)
{
    mt_arena *const mem = &w->e->scratch;
    double size = HUGE_VAL;
    for (int it = 0; it < ITERATIONS; it++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        const double previous = size;
        const bool moved = newton_step(w, &size, saddle);
        mt_arena_rewind(mem, mark);
        if (!moved || (it > 3 && size > CONTRACTION * previous)) {
            return;
        }
        mt_nlp_point_swap(&w->cur, &w->trial);
    }
}

void mt_nlp_polish(mt_nlp_engine *e, mt_nlp_stage stage, mt_nlp_point *p, double *saddle)
{
    const mt_nlp *const q = e->nlp;
    polish w = {.e = e, .stage = stage, .n_v = -1, .n_loose = -1};
    mt_arena *const mem = &e->scratch;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    w.gl = mt_arena_f64(mem, (size_t)e->n, 1);
    w.step = mt_arena_f64(mem, (size_t)e->n, 1);
    w.t = mt_arena_f64(mem, (size_t)e->n, 1);
    w.V = mt_arena_f64(mem, (size_t)e->n, (size_t)e->n_free);
    w.w = mt_arena_f64(mem, (size_t)e->n_free, 1);
    const int rows = q->n_eq + q->n_in + q->n_next;
    w.active = mt_arena_int(mem, (size_t)e->n + 1 + (size_t)rows);
    w.cur = mt_nlp_point_new(e, mem);
    w.trial = mt_nlp_point_new(e, mem);
    w.best = mt_nlp_point_new(e, mem);
    if (saddle != NULL) {
        memset(saddle, 0, (size_t)e->n * sizeof *saddle);
    }
    if (mt_nlp_has_room(e, mem) && mt_nlp_active_set(e, p, stage, mem, &w.a)) {
        w.limit = stage == MT_NLP_SQUARES ? p->squares * (1 + F_ROUNDING)
                                          : p->f + rise_allowed(&w, p);
        p->kkt = w.a.kkt;
        mt_nlp_point_copy(e, w.cur, p);
        mt_nlp_point_copy(e, w.best, p);
        run_newton_iterations(&w, saddle);
        w.best->n_loose = w.n_loose >= 0 ? w.n_loose : p->n_loose;
        w.best->isolated = w.isolated && w.best->kkt <= MT_STATIONARY;
        mt_nlp_point_copy(e, p, w.best);
    }
    mt_arena_rewind(mem, mark);
}
