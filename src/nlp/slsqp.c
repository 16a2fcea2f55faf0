/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The only door to NLopt: SLSQP with exact gradients. Nothing it returns is believed. Every
 * point it asks about is evaluated once (objective and constraints are asked for separately at
 * the same t) and kept when it is better than all before. It never sees a value that is not
 * finite: such a point gets the last finite values, and the run is stopped and begun again from
 * the best point in a box half as wide as the failing step; the box widens again while the runs
 * in it succeed.
 */
#include "nlp/slsqp.h"

#include <nlopt.h>

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nlp/kkt.h"

/* NLopt (2.7.1, nlopt_vsprintf) ends the process where it has no memory for the sentence that
 * goes with NLOPT_FAILURE: that there is some is known when a run begins. */
enum { MESSAGE_ROOM = 1024 };
enum { EVALS_BASE = 200, EVALS_PER_VARIABLE = 20, RESTARTS = 12 };
/* Where SLSQP may stop: what is left, our Newton iteration does in a few steps. (A hundredth
 * takes a fifth more evaluations; with a hundred times as much ends of one optimum are no
 * longer known for one, and take as many more.) */
static const double F_TOL_REL = 1e-8;
static const double T_TOL_ABS = 1e-7;
/* ... and where it did not, SLSQP goes on to so much of these. */
static const double CLOSE = 1e-2;
/* Change of the box after a failed (half the failing step) and after a good run. */
static const double BOX_SHRINK = 0.5;
static const double BOX_GROW = 4.0;

typedef struct slsqp {
    mt_nlp_engine *e;
    int n; /* free variables */
    int *free;
    int n_rows;
    const int *rows;
    double *lower;
    double *upper;
    double *x;
    double *tol;
    double *tol_in;   /* [n_in + n_next] */
    double *t;        /* [engine n] */
    double *t_failed; /* [engine n] */
    mt_nlp_point *cur;
    mt_nlp_point *trial;
    mt_nlp_point *best;
    bool failed;
    double nearer; /* multiplies the tolerances */
    nlopt_opt opt;
} slsqp;

/* Bring cur to x. On failure cur stays the last finite point and the run is told to stop. */
static void evaluate_at(slsqp *w, const double *x)
{
    mt_nlp_engine *const e = w->e;
    bool same = true;
    for (int i = 0; i < w->n; i++) {
        w->t[w->free[i]] = x[i];
        same = same && x[i] == w->cur->t[w->free[i]];
    }
    if (same || w->failed) {
        return;
    }
    if (!mt_nlp_evaluate(e, w->t, true, w->trial)) {
        w->failed = true;
        memcpy(w->t_failed, w->t, (size_t)e->n * sizeof *w->t);
        (void)nlopt_force_stop(w->opt);
        return;
    }
    mt_nlp_point_swap(&w->cur, &w->trial);
    if (mt_nlp_better(w->cur, w->best)) {
        mt_nlp_point_copy(e, w->best, w->cur);
    }
}

static double objective(unsigned int n, const double *x, double *grad, void *data)
{
    slsqp *const w = data;
    evaluate_at(w, x);
    for (unsigned int i = 0; grad != NULL && i < n; i++) {
        grad[i] = w->cur->df[w->free[i]];
    }
    return w->cur->f;
}

static void equalities(unsigned int m, double *c, unsigned int n, const double *x, double *grad,
                       void *data)
{
    slsqp *const w = data;
    evaluate_at(w, x);
    for (unsigned int i = 0; i < m; i++) {
        const int row = w->rows[i];
        c[i] = w->cur->eq[row];
        for (unsigned int j = 0; grad != NULL && j < n; j++) {
            grad[(size_t)i * n + j] =
                w->cur->deq[row + (ptrdiff_t)w->free[j] * w->e->nlp->n_eq];
        }
    }
}

/* NLopt wants c <= 0. */
static void inequalities(unsigned int m, double *c, unsigned int n, const double *x,
                         double *grad, void *data)
{
    slsqp *const w = data;
    evaluate_at(w, x);
    for (unsigned int i = 0; i < m; i++) {
        const int row = w->e->nlp->n_eq + (int)i;
        c[i] = -mt_nlp_row_value(w->e, w->cur, row);
        for (unsigned int j = 0; grad != NULL && j < n; j++) {
            grad[(size_t)i * n + j] = -mt_nlp_row_slope(w->e, w->cur, row, w->free[j]);
        }
    }
}

/* Status for NLopt's result. Where it stopped, or gave up in its own arithmetic
 * (NLOPT_ROUNDOFF_LIMITED: a singular subproblem; NLOPT_FAILURE: contradicting linearised
 * constraints), the best point met is used, which is verified elsewhere. */
static mt_status status_of(nlopt_result verdict)
{
    switch (verdict) {
    case NLOPT_OUT_OF_MEMORY:
        return MT_E_MEMORY;
    case NLOPT_INVALID_ARGS:
        return MT_E_INTERNAL;
    case NLOPT_SUCCESS:
    case NLOPT_STOPVAL_REACHED:
    case NLOPT_FTOL_REACHED:
    case NLOPT_XTOL_REACHED:
    case NLOPT_MAXEVAL_REACHED:
    case NLOPT_MAXTIME_REACHED:
    case NLOPT_FORCED_STOP: /* by evaluate_at() */
    case NLOPT_ROUNDOFF_LIMITED:
    case NLOPT_FAILURE:
    case NLOPT_NUM_RESULTS:
    case NLOPT_NUM_FAILURES:
        break;
    }
    return MT_OK;
}

static mt_status set_up(slsqp *w)
{
    const mt_nlp *const q = w->e->nlp;
    const unsigned int n_eq = (unsigned int)w->n_rows;
    const unsigned int n_in = (unsigned int)(q->n_in + q->n_next);
    const long left = w->e->opt.max_evals - w->e->evals;
    const int most = EVALS_BASE + EVALS_PER_VARIABLE * w->n;
    for (int i = 0; i < w->n_rows; i++) {
        w->tol[i] = q->eq_tol[w->rows[i]];
    }
    for (int i = 0; i < q->n_in + q->n_next; i++) {
        w->tol_in[i] = mt_nlp_row_tol(w->e, q->n_eq + i);
    }
    w->opt = nlopt_create(NLOPT_LD_SLSQP, (unsigned int)w->n);
    if (w->opt == NULL) {
        return MT_E_MEMORY;
    }
    MT_TRY(status_of(nlopt_set_min_objective(w->opt, objective, w)));
    if (n_eq > 0) {
        MT_TRY(status_of(nlopt_add_equality_mconstraint(w->opt, n_eq, equalities, w, w->tol)));
    }
    if (n_in > 0) {
        MT_TRY(status_of(
            nlopt_add_inequality_mconstraint(w->opt, n_in, inequalities, w, w->tol_in)));
    }
    MT_TRY(status_of(nlopt_set_lower_bounds(w->opt, w->lower)));
    MT_TRY(status_of(nlopt_set_upper_bounds(w->opt, w->upper)));
    MT_TRY(status_of(nlopt_set_ftol_rel(w->opt, w->nearer * F_TOL_REL)));
    MT_TRY(status_of(nlopt_set_xtol_abs1(w->opt, w->nearer * T_TOL_ABS)));
    /* one more than we allow: our own budget, not NLopt's, ends the search */
    return status_of(nlopt_set_maxeval(w->opt, left < most ? (int)left + 1 : most));
}

/* One run from cur in the box [centre - radius, centre + radius] within the bounds. False: it
 * met a point without value, or could not be started. */
static bool run_once(slsqp *w, double radius)
{
    const mt_nlp *const q = w->e->nlp;
    for (int i = 0; i < w->n; i++) {
        const int j = w->free[i];
        w->x[i] = w->cur->t[j];
        w->lower[i] = fmax(q->lower[j], w->x[i] - radius);
        w->upper[i] = fmin(q->upper[j], w->x[i] + radius);
    }
    w->failed = false;
    double f = 0;
    void *volatile const room = malloc(MESSAGE_ROOM); /* or a compiler may know better */
    mt_status rc = room == NULL ? MT_E_MEMORY : set_up(w);
    free(room);
    if (rc == MT_OK) {
        nlopt_srand(w->e->opt.seed);
        rc = status_of(nlopt_optimize(w->opt, w->x, &f));
    }
    nlopt_destroy(w->opt);
    w->opt = NULL;
    if (rc != MT_OK && !w->e->ended) {
        (void)mt_nlp_ok(w->e, mt_fail(w->e->err, rc, "SLSQP: %s", mt_status_text(rc)));
    }
    return !w->failed && !w->e->ended;
}

/* True where the run stopped at the box and not at the bounds of the problem. */
static bool at_box(const slsqp *w)
{
    const mt_nlp *const q = w->e->nlp;
    for (int i = 0; i < w->n; i++) {
        const int j = w->free[i];
        const double t = w->cur->t[j];
        if ((t <= w->lower[i] && t > q->lower[j]) || (t >= w->upper[i] && t < q->upper[j])) {
            return true;
        }
    }
    return false;
}

static double failed_step(const slsqp *w)
{
    double step = 0;
    for (int j = 0; j < w->e->n; j++) {
        step = fmax(step, fabs(w->t_failed[j] - w->best->t[j]));
    }
    return step;
}

static void search_with_restarts(slsqp *w)
{
    double radius = HUGE_VAL;
    for (int k = 0; k < RESTARTS && !w->e->ended; k++) {
        if (!run_once(w, radius)) {
            radius = fmin(radius, failed_step(w)) * BOX_SHRINK;
            mt_nlp_point_copy(w->e, w->cur, w->best);
        } else if (at_box(w)) {
            radius *= BOX_GROW;
        } else {
            return;
        }
    }
}

static void allocate(slsqp *w)
{
    const mt_nlp_engine *const e = w->e;
    mt_arena *const mem = &w->e->scratch;
    const size_t n = (size_t)e->n;
    w->free = mt_arena_int(mem, n);
    w->lower = mt_arena_f64(mem, n, 1);
    w->upper = mt_arena_f64(mem, n, 1);
    w->x = mt_arena_f64(mem, n, 1);
    w->t = mt_arena_f64(mem, n, 1);
    w->t_failed = mt_arena_f64(mem, n, 1);
    w->tol = mt_arena_f64(mem, (size_t)w->n_rows, 1);
    w->tol_in = mt_arena_f64(mem, (size_t)e->nlp->n_in + (size_t)e->nlp->n_next, 1);
    w->cur = mt_nlp_point_new(e, mem);
    w->trial = mt_nlp_point_new(e, mem);
    w->best = mt_nlp_point_new(e, mem);
}

void mt_nlp_slsqp(mt_nlp_engine *e, int n_rows, const int *rows, bool close, mt_nlp_point *p,
                  mt_nlp_point *last)
{
    slsqp w = {.e = e, .n_rows = n_rows, .rows = rows, .nearer = close ? CLOSE : 1.0};
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    mt_nlp_point_copy(e, last, p);
    allocate(&w);
    if (e->n_free > n_rows && mt_nlp_has_room(e, &e->scratch)) {
        for (int j = 0; j < e->n; j++) {
            w.t[j] = p->t[j];
            if (!e->held[j]) {
                w.free[w.n++] = j;
            }
        }
        mt_nlp_point_copy(e, w.cur, p);
        mt_nlp_point_copy(e, w.best, p);
        if (w.n > n_rows) {
            search_with_restarts(&w);
        }
        mt_nlp_point_copy(e, p, w.best);
        mt_nlp_point_copy(e, last, w.cur);
    }
    mt_arena_rewind(&e->scratch, mark);
}
