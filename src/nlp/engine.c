/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The only caller of the problem's callback: budget, finite values and failures are decided
 * here. */
#include "nlp/engine.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "nlp/merit.h"

enum { STARTS_BASE = 8, STARTS_PER_VARIABLE = 4, STARTS_MOST = 64, EVALS_PER_START = 2000 };
enum { SOLUTIONS_KEPT = 16 };
/* What differs from a bound by less, relative to the bounds, differs by rounding: a few
 * operations on t. */
static const double ON_IT = 64 * DBL_EPSILON;

static mt_status check_problem(const mt_nlp *p, mt_err *err)
{
    if (p->n < 0 || p->n_res < 0 || p->n_eq < 0 || p->n_in < 0 || p->eval == NULL) {
        return mt_fail(err, MT_E_USAGE, "search: negative size or no callback");
    }
    for (int j = 0; j < p->n; j++) {
        if (!isfinite(p->lower[j]) || !isfinite(p->upper[j]) || p->lower[j] > p->upper[j] ||
            !isfinite(p->origin[j])) {
            return mt_fail(
                err, MT_E_USAGE,
                "search: variable %d has no finite bounds in order, %g to %g, origin %g", j,
                p->lower[j], p->upper[j], p->origin[j]);
        }
    }
    for (int i = 0; i < p->n_eq + p->n_in; i++) {
        const double tol = i < p->n_eq ? p->eq_tol[i] : p->in_tol[i - p->n_eq];
        if (!(tol > 0 && isfinite(tol))) {
            return mt_fail(err, MT_E_USAGE, "search: constraint %d has the tolerance %g", i,
                           tol);
        }
    }
    for (int i = 0; i < p->n_next; i++) {
        if (p->next_of[i] < 0 || p->next_of[i] >= p->n_in) {
            return mt_fail(err, MT_E_USAGE, "search: row %d follows from none", i);
        }
    }
    return MT_OK;
}

mt_status mt_nlp_engine_init(mt_nlp_engine *e, const mt_nlp *nlp, const mt_nlp_options *opt,
                             mt_err *err)
{
    *e = (mt_nlp_engine){.nlp = nlp, .opt = *opt, .n = nlp->n, .err = err};
    e->impossible = opt->none;
    MT_TRY(check_problem(nlp, err));
    MT_TRY(mt_arena_init(&e->scratch, 0, err));
    e->origin = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
    e->held = mt_arena_alloc(&e->scratch, (size_t)e->n, sizeof *e->held);
    const mt_status rc = mt_arena_check(&e->scratch, err);
    if (rc != MT_OK) {
        mt_arena_free(&e->scratch);
        return rc;
    }
    for (int j = 0; j < e->n; j++) {
        e->held[j] = nlp->lower[j] >= nlp->upper[j];
        e->n_free += !e->held[j];
        e->origin[j] = mt_nlp_clamp(nlp, j, nlp->origin[j]);
    }
    for (int i = 0; i < nlp->n_eq; i++) {
        e->eq_tol = fmax(e->eq_tol, nlp->eq_tol[i]);
    }
    e->open_starts = opt->starts <= 0;
    mt_nlp_options *const o = &e->opt;
    if (o->starts <= 0) {
        const int wanted = STARTS_BASE + STARTS_PER_VARIABLE * e->n_free;
        o->starts = wanted < STARTS_MOST ? wanted : STARTS_MOST;
    }
    o->max_evals = o->max_evals > 0 ? o->max_evals : (long)EVALS_PER_START * o->starts;
    o->max_solutions = o->max_solutions > 0 ? o->max_solutions : SOLUTIONS_KEPT;
    return MT_OK;
}

void mt_nlp_engine_free(mt_nlp_engine *e)
{
    mt_arena_free(&e->scratch);
}

bool mt_nlp_ok(mt_nlp_engine *e, mt_status rc)
{
    e->ended = e->ended || rc != MT_OK;
    e->fatal = e->fatal == MT_OK ? rc : e->fatal;
    return rc == MT_OK;
}

bool mt_nlp_has_room(mt_nlp_engine *e, mt_arena *mem)
{
    return mt_nlp_ok(e, mt_arena_check(mem, e->err));
}

mt_nlp_point *mt_nlp_point_new(const mt_nlp_engine *e, mt_arena *mem)
{
    const mt_nlp *const q = e->nlp;
    const size_t n = (size_t)e->n;
    const size_t n_res = (size_t)q->n_res;
    const size_t n_eq = (size_t)q->n_eq;
    const size_t n_in = (size_t)q->n_in;
    const size_t n_next = (size_t)q->n_next;
    mt_nlp_point *const p = mt_arena_alloc(mem, 1, sizeof *p);
    if (p != NULL) {
        *p = (mt_nlp_point){.t = mt_arena_f64(mem, n, 1),
                            .df = mt_arena_f64(mem, n, 1),
                            .r = mt_arena_f64(mem, n_res, 1),
                            .dr = mt_arena_f64(mem, n_res, n),
                            .eq = mt_arena_f64(mem, n_eq, 1),
                            .deq = mt_arena_f64(mem, n_eq, n),
                            .in = mt_arena_f64(mem, n_in, 1),
                            .din = mt_arena_f64(mem, n_in, n),
                            .next = mt_arena_f64(mem, n_next, 1),
                            .dnext = mt_arena_f64(mem, n_next, n),
                            .kkt = HUGE_VAL};
    }
    return p;
}

void mt_nlp_point_copy(const mt_nlp_engine *e, mt_nlp_point *to, const mt_nlp_point *from)
{
    const mt_nlp *const q = e->nlp;
    const size_t n = (size_t)e->n;
    const size_t rows[] = {(size_t)q->n_res, (size_t)q->n_eq, (size_t)q->n_in,
                           (size_t)q->n_next};
    double *const v[] = {to->r, to->eq, to->in, to->next};
    double *const d[] = {to->dr, to->deq, to->din, to->dnext};
    const double *const v0[] = {from->r, from->eq, from->in, from->next};
    const double *const d0[] = {from->dr, from->deq, from->din, from->dnext};
    memcpy(to->t, from->t, n * sizeof *to->t);
    memcpy(to->df, from->df, n * sizeof *to->df);
    for (int k = 0; k < MT_COUNT(rows); k++) {
        memcpy(v[k], v0[k], rows[k] * sizeof *v[k]);
        memcpy(d[k], d0[k], rows[k] * n * sizeof *d[k]);
    }
    to->f = from->f;
    to->violation = from->violation;
    to->squares = from->squares;
    to->kkt = from->kkt;
    to->n_loose = from->n_loose;
    to->isolated = from->isolated;
}

void mt_nlp_point_swap(mt_nlp_point **a, mt_nlp_point **b)
{
    mt_nlp_point *const c = *a;
    *a = *b;
    *b = c;
}

double mt_nlp_clamp(const mt_nlp *nlp, int j, double t)
{
    const double lower = nlp->lower[j];
    const double upper = nlp->upper[j];
    const double origin = nlp->origin[j];
    const double near = ON_IT * fmax(fabs(lower), fabs(upper));
    if (fabs(t - origin) <= near && origin >= lower && origin <= upper) {
        return origin;
    }
    if (t <= lower + near) {
        return lower;
    }
    return t >= upper - near ? upper : t;
}

static bool all_finite(ptrdiff_t n, const double *x)
{
    for (ptrdiff_t i = 0; i < n; i++) {
        if (!isfinite(x[i])) {
            return false;
        }
    }
    return true;
}

static bool point_finite(const mt_nlp_engine *e, const mt_nlp_point *p, bool with_gradient)
{
    const mt_nlp *const q = e->nlp;
    const ptrdiff_t n = e->n;
    if (!isfinite(p->f) || !all_finite(q->n_res, p->r) || !all_finite(q->n_eq, p->eq) ||
        !all_finite(q->n_in, p->in) || !all_finite(q->n_next, p->next)) {
        return false;
    }
    return !with_gradient ||
           (all_finite(n, p->df) && all_finite(q->n_res * n, p->dr) &&
            all_finite(q->n_eq * n, p->deq) && all_finite(q->n_in * n, p->din) &&
            all_finite(q->n_next * n, p->dnext));
}

/* Quantities that follow from the values: objective of a misfit, violation, squares. */
static void derive(const mt_nlp_engine *e, mt_nlp_point *p, bool with_gradient)
{
    const mt_nlp *const q = e->nlp;
    if (q->n_res > 0) {
        p->f = 0.5 * mt_dot(q->n_res, p->r, p->r);
        if (with_gradient) {
            mt_gemv(true, q->n_res, e->n, 1.0, p->dr, q->n_res, p->r, 0.0, p->df);
        }
    }
    const mt_missed m = mt_missed_of(q->n_eq, p->eq, q->eq_tol, q->n_in, p->in, q->in_tol);
    p->violation = m.violation;
    p->squares = m.squares;
    p->kkt = HUGE_VAL;
    p->n_loose = 0;
    p->isolated = false;
}

/* Constraints relative to what a compromise reaches. */
static void shift(const mt_nlp_engine *e, mt_nlp_point *p)
{
    for (int i = 0; i < e->nlp->n_eq; i++) {
        p->eq[i] -= e->eq_shift[i];
    }
    for (int i = 0; i < e->nlp->n_in; i++) {
        p->in[i] -= e->in_shift[i];
    }
    for (int i = 0; i < e->nlp->n_next; i++) {
        p->next[i] -= e->in_shift[e->nlp->next_of[i]];
    }
}

/* True where this status of the callback ends the search. */
static bool is_final(mt_nlp_engine *e, mt_status rc, const mt_err *here)
{
    if (rc == MT_E_INTERRUPTED) {
        e->ended = true;
        e->stop = MT_STOP_USER;
        return true;
    }
    if (mt_is_final(rc)) {
        return !mt_nlp_ok(e, mt_fail(e->err, rc, "%s", here->text));
    }
    return false;
}

static void record_first_refusal(mt_nlp_engine *e, mt_status rc, const mt_err *here)
{
    if (e->refused != MT_OK) {
        return;
    }
    e->refused = rc;
    e->refused_err = *here;
}

bool mt_nlp_evaluate(mt_nlp_engine *e, const double *t, bool with_gradient, mt_nlp_point *p)
{
    if (e->ended) {
        return false;
    }
    if (e->abort != NULL && atomic_load(e->abort) != 0) {
        e->ended = true;
        return false;
    }
    if (e->evals >= e->opt.max_evals) {
        e->ended = true;
        e->stop = MT_STOP_MAX_EVALS;
        return false;
    }
    for (int j = 0; j < e->n; j++) {
        if (!isfinite(t[j])) {
            return false;
        }
        p->t[j] = mt_nlp_clamp(e->nlp, j, t[j]);
    }
    mt_nlp_values v = {.f = 0,
                       .df = p->df,
                       .r = p->r,
                       .dr = p->dr,
                       .eq = p->eq,
                       .deq = p->deq,
                       .in = p->in,
                       .din = p->din,
                       .next = e->nlp->n_next > 0 ? p->next : NULL,
                       .dnext = p->dnext};
    mt_err here;
    here.code = MT_OK;
    here.text[0] = '\0';
    e->evals++;
    const mt_status rc = e->nlp->eval(e->nlp->context, p->t, with_gradient, &v, &here);
    if (rc != MT_OK) {
        if (!is_final(e, rc, &here)) {
            record_first_refusal(e, rc, &here);
        }
        return false;
    }
    p->f = e->nlp->n_res > 0 ? 0 : v.f;
    if (e->eq_shift != NULL) {
        shift(e, p);
    }
    derive(e, p, with_gradient);
    if (!point_finite(e, p, with_gradient)) {
        (void)mt_fail(&here, MT_E_DOMAIN, "search: a value is not finite");
        record_first_refusal(e, MT_E_DOMAIN, &here);
        return false;
    }
    if (e->steps != NULL && e->eq_shift == NULL) { /* else it is another question */
        const mt_step now = {
            .evals = e->evals, .f = p->f, .violation = p->violation, .squares = p->squares};
        mt_steps_add(e->steps, &now);
    }
    return true;
}

bool mt_nlp_feasible(const mt_nlp_point *p)
{
    return mt_is_held(p->violation);
}

bool mt_nlp_better(const mt_nlp_point *a, const mt_nlp_point *b)
{
    const mt_merit x = {mt_nlp_feasible(a), a->squares, mt_nlp_feasible(a) ? 1 : 0, &a->f};
    const mt_merit y = {mt_nlp_feasible(b), b->squares, mt_nlp_feasible(b) ? 1 : 0, &b->f};
    return mt_merit_before(&x, &y, 0.0);
}

double mt_nlp_distance(const mt_nlp_engine *e, const mt_nlp_point *a, const mt_nlp_point *b)
{
    double d = 0;
    for (int j = 0; j < e->n; j++) {
        d = fmax(d, fabs(a->t[j] - b->t[j]));
    }
    return d;
}

void mt_nlp_gradient(const mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_stage stage,
                     double *g)
{
    const mt_nlp *const q = e->nlp;
    if (stage != MT_NLP_SQUARES) {
        memcpy(g, p->df, (size_t)e->n * sizeof *g);
        return;
    }
    for (int j = 0; j < e->n; j++) {
        const double *const dj = p->din + (ptrdiff_t)j * q->n_in;
        g[j] = mt_dot(q->n_eq, p->deq + (ptrdiff_t)j * q->n_eq, p->eq);
        for (int i = 0; i < q->n_in; i++) {
            g[j] += dj[i] * fmin(p->in[i], 0);
        }
    }
}
