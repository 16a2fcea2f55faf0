/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One local search: SLSQP, and its two halves. */
#include "nlp/local.h"

#include <nlopt.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nlp/kkt.h"
#include "nlp/lsq.h"
#include "nlp/near_null_directions.h"
#include "nlp/polish.h"

/*
 * The only door to NLopt: SLSQP with exact gradients. Nothing it returns is believed. Every
 * point it asks about is evaluated once (objective and constraints are asked for separately at
 * the same t) and kept when it is better than all before. It never sees a value that is not
 * finite: such a point gets the last finite values, and the run is stopped and begun again from
 * the best point in a box half as wide as the failing step; the box widens again while the runs
 * in it succeed.
 */

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

/* One local search from p; the equalities are rows[n_rows]. close: tolerances of a hundredth,
 * where Newton's method failed from the usual stop. last: the final point; p: the best point
 * met, by mt_nlp_better. */
static void nlp_slsqp(mt_nlp_engine *e, int n_rows, const int *rows, bool close,
                      mt_nlp_point *p, mt_nlp_point *last)
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

/*
 * One local search, in two halves. The approach is of first order and comes to within about
 * 1e-5 of where it leads:
 *
 *     roots by least squares         where the equalities leave no freedom
 *     least squares                  where there are residuals and bounds only
 *     SLSQP, or a restoration        otherwise
 *
 * The second half is Newton's, with Hessians by differences: full accuracy, and the sign of the
 * curvature. A saddle is left along its direction, and the approach is made again from there.
 * An infeasible end is a local minimum of the squares of the violations.
 */

enum { ROUNDS = 3 };
/* Length of the first step away from a saddle. */
static const double SADDLE_STEP = 0.05;
/* Rows and those that follow from them are one within this: there rows have no slopes of their
 * own, and Newton's method comes to rest by chance only. */
static const double TOGETHER = 1e-4;
/* A smaller gain of a round, relative to the objective, is what tolerances buy. */
static const double GAIN = 1e-5;
/* Violation (in tolerances) below which an end is worth a Newton polish before a
 * restoration. */
static const double NEARLY = 1e4;
/* ... before anything more, where a compromise is of no use. */
static const double WORTH = 100.0;

bool mt_nlp_nearly_feasible(const mt_nlp_point *p)
{
    return p->violation <= NEARLY;
}

mt_nlp_local mt_nlp_local_new(const mt_nlp_engine *e, mt_arena *mem)
{
    return (mt_nlp_local){.p = mt_nlp_point_new(e, mem),
                          .last = mt_nlp_point_new(e, mem),
                          .from = mt_arena_f64(mem, (size_t)e->n, 1),
                          .rows = mt_arena_int(mem, (size_t)e->nlp->n_eq),
                          .kkt = HUGE_VAL,
                          .hits = 1};
}

const mt_nlp_point *mt_nlp_local_stand(const mt_nlp_local *s)
{
    return s->stage == MT_NLP_OBJECTIVE && !s->polished && mt_nlp_nearly_feasible(s->last)
               ? s->last
               : s->p;
}

/* True where compromises are not wanted and the end is far from feasible. */
static bool is_given_up(const mt_nlp_engine *e, const mt_nlp_local *s)
{
    return e->opt.no_compromise && !(s->p->violation <= WORTH) &&
           !(s->last->violation <= WORTH);
}

/* SLSQP from p, to close tolerances where Newton's method has failed; an end far from feasible
 * is restored where possible. */
static void descend(mt_nlp_engine *e, bool close, mt_nlp_local *s)
{
    nlp_slsqp(e, s->n_rows, s->rows, close, s->p, s->last);
    s->abandoned = is_given_up(e, s);
    s->restored = !s->abandoned && !mt_nlp_feasible(s->p) && !mt_nlp_nearly_feasible(s->last);
    if (s->restored) {
        mt_nlp_least_squares(e, MT_NLP_SQUARES, s->p);
        mt_nlp_point_copy(e, s->last, s->p);
    }
}

/* Newton from the end of SLSQP, or from the best point met where that is better; an infeasible
 * point is restored first. */
static void newton(mt_nlp_engine *e, mt_nlp_local *s, double *saddle)
{
    mt_nlp_point *const p = s->p;
    memset(saddle, 0, (size_t)e->n * sizeof *saddle);
    if (mt_nlp_nearly_feasible(s->last)) {
        mt_nlp_polish(e, MT_NLP_OBJECTIVE, s->last, saddle);
        if (mt_nlp_feasible(s->last) &&
            (s->last->kkt <= MT_STATIONARY || !mt_nlp_feasible(p))) {
            mt_nlp_point_copy(e, p, s->last);
            return;
        }
    }
    if (!mt_nlp_feasible(p) && !s->restored) {
        mt_nlp_least_squares(e, MT_NLP_SQUARES, p);
    }
    if (mt_nlp_feasible(p)) {
        mt_nlp_polish(e, MT_NLP_OBJECTIVE, p, saddle);
    }
}

/* Move p a little along `saddle`; false where there is none, or no value there. */
static bool step_off(mt_nlp_engine *e, const double *saddle, mt_nlp_point *p)
{
    const double most = mt_max_abs(e->n, saddle);
    if (!(most > 0.0)) {
        return false;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    mt_nlp_point *const to = mt_nlp_point_new(e, &e->scratch);
    bool moved = false;
    if (mt_nlp_has_room(e, &e->scratch)) {
        mt_nlp_point_copy(e, to, p);
        mt_axpy(e->n, SADDLE_STEP / most, saddle, to->t);
        moved = mt_nlp_evaluate(e, to->t, true, to);
        if (moved) {
            mt_nlp_point_copy(e, p, to);
        }
    }
    mt_arena_rewind(&e->scratch, mark);
    return moved;
}

/* True where rows swap at p, on their limit. */
static bool is_crossing(const mt_nlp_engine *e, const mt_nlp_point *p)
{
    for (int i = 0; i < e->nlp->n_next; i++) {
        const double row = p->in[e->nlp->next_of[i]];
        if (fabs(row) <= TOGETHER && fabs(p->next[i] - row) <= TOGETHER) {
            return true;
        }
    }
    return false;
}

/* From the end of SLSQP: Newton, and SLSQP again while that is no minimum; never makes p
 * worse. */
static void finish_minimum(mt_nlp_engine *e, mt_nlp_local *s)
{
    mt_nlp_point *const before = mt_nlp_point_new(e, &e->scratch);
    double *const saddle = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return;
    }
    for (int round = 0; round < ROUNDS && !e->ended; round++) {
        if (round > 0) {
            descend(e, true, s);
        }
        newton(e, s, saddle);
        if (round > 0 &&
            !mt_nlp_better(s->p, before)) { /* the same again would end there again */
            mt_nlp_point_copy(e, s->p, before);
            return;
        }
        const bool idle = round > 0 && mt_nlp_feasible(before) && s->p->kkt > MT_STATIONARY &&
                          is_crossing(e, s->p) &&
                          s->p->f >= before->f - (GAIN * fabs(before->f));
        mt_nlp_point_copy(e, before, s->p);
        const bool last = round + 1 == ROUNDS || idle || !mt_nlp_feasible(s->p);
        if (last || (!step_off(e, saddle, s->p) && s->p->kkt <= MT_STATIONARY)) {
            return;
        }
    }
    mt_nlp_point_copy(e, s->p, before); /* the search ended on the way */
}

void mt_nlp_minimise(mt_nlp_engine *e, mt_nlp_local *s)
{
    s->stage = MT_NLP_OBJECTIVE;
    descend(e, false, s);
    finish_minimum(e, s);
}

/* Roots of equalities that leave no freedom; where these are dependent, the objective
 * decides. */
static void find_root(mt_nlp_engine *e, mt_nlp_local *s)
{
    mt_nlp_near_null_directions w;
    mt_nlp_least_squares(e, MT_NLP_SQUARES, s->p);
    if (!mt_nlp_feasible(s->p) || e->ended ||
        !mt_nlp_near_null_directions_at(e, s->p, &e->scratch, &w)) {
        return;
    }
    s->curve = w.curve;
    if (w.curve && w.n_rows < e->n_free) {
        s->stage = MT_NLP_OBJECTIVE;
        s->n_rows = w.n_rows;
        memcpy(s->rows, w.rows, (size_t)w.n_rows * sizeof *s->rows);
        descend(e, false, s);
    }
}

static void approach(mt_nlp_engine *e, mt_nlp_local *s)
{
    const mt_nlp *const q = e->nlp;
    for (s->n_rows = 0; s->n_rows < q->n_eq; s->n_rows++) {
        s->rows[s->n_rows] = s->n_rows;
    }
    if (e->impossible) {
        s->stage = MT_NLP_SQUARES;
        mt_nlp_least_squares(e, MT_NLP_SQUARES, s->p);
    } else if (q->n_eq >= e->n_free) {
        s->stage = MT_NLP_SQUARES;
        find_root(e, s);
    } else if (q->n_res > 0 && q->n_eq == 0 && q->n_in == 0) {
        s->stage = MT_NLP_RESIDUALS;
        mt_nlp_least_squares(e, MT_NLP_RESIDUALS, s->p);
    } else {
        s->stage = MT_NLP_OBJECTIVE;
        descend(e, false, s);
    }
}

void mt_nlp_local_approach(mt_nlp_engine *e, mt_nlp_local *s)
{
    approach(e, s);
    s->polished = s->stage == MT_NLP_SQUARES && mt_nlp_feasible(s->p);
    const mt_nlp_point *const at = mt_nlp_local_stand(s);
    /* or it minimises squares by now */
    const bool below = mt_nlp_feasible(at) || at == s->last;
    mt_nlp_active a;
    memcpy(s->from, at->t, (size_t)e->n * sizeof *s->from);
    if (!e->ended && !s->polished &&
        mt_nlp_active_set(e, at, below ? s->stage : MT_NLP_SQUARES, &e->scratch, &a)) {
        s->kkt = a.kkt;
    }
}

void mt_nlp_local_finish(mt_nlp_engine *e, mt_nlp_local *s)
{
    mt_nlp_point *const before = mt_nlp_point_new(e, &e->scratch);
    double *const saddle = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
    const bool room = mt_nlp_has_room(e, &e->scratch);
    for (int round = 0; room && !s->abandoned && round < ROUNDS; round++) {
        if (round > 0) {
            approach(e, s);
        }
        if (s->abandoned) {
            break;
        }
        if (s->stage == MT_NLP_OBJECTIVE) {
            finish_minimum(e, s);
        } else if (s->stage == MT_NLP_RESIDUALS) {
            mt_nlp_polish(e, MT_NLP_RESIDUALS, s->p, NULL);
        }
        if (!mt_nlp_feasible(s->p)) {
            mt_nlp_polish(e, MT_NLP_SQUARES, s->p, saddle);
        }
        if (round > 0 && mt_nlp_better(before, s->p)) {
            mt_nlp_point_copy(e, s->p, before);
        }
        mt_nlp_point_copy(e, before, s->p);
        const bool last = round + 1 == ROUNDS || mt_nlp_feasible(s->p) || e->ended;
        if (last || !step_off(e, saddle, s->p)) {
            break;
        }
    }
    s->polished = true;
}
