/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Where solutions form a continuum, every start ends at another place of it. Two solutions a
 * and b belong to one continuum where
 *
 *     t = a + s (b - a),   s = 1/4, 1/2, 3/4,
 *
 * meet all goals with the objectives that a and b have, within their tolerance. Isolated
 * solutions do not: between them the objective rises or a goal is missed. Of a continuum one is
 * kept, the nearest to the original design.
 *
 * Exact fits of fewer residuals than variables lie on a curved continuum, which the chord
 * leaves. Its points are brought back by the shortest steps to r = 0 (Gauss and Newton),
 *     t := t - J^T (J J^T)^-1 r   on the variables that have not come to a bound;
 * a and b belong together where all of them come back, not farther than a quarter of the chord.
 * Other curved ones are not told.
 */
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "nlp/merit.h"
#include "problem/evaluate.h"
#include "problem/objective.h"
#include "search/search.h"

enum { BETWEEN = 3 };
/* Objectives that differ by less are equal: relative to their size; those without unit (roots
 * of half squares, clearances) to this at least, as residuals are. */
static const double EQUAL = 1e-6;
/* Back to r = 0: residuals below this are none, in so many steps. */
static const double RESIDUAL = 1e-9;
enum { STEPS = 12 };
static const double RANK_TOL = 1e-10;
/* No farther from the chord than this part of it. */
static const double ASIDE = 0.25;
/* KKT residuals below this are local solutions, as in the search. */
static const double STATIONARY = 1e-6;

typedef struct continua {
    mt_workspace *ws;
    mt_nlp_result *out;
    mt_nlp_values v;
    double *stages; /* n_stages of each solution */
    double *at;     /* [n_stages] between two of them */
    double *t;      /* [n_t] */
    bool fits;      /* residuals alone, fewer than variables */
    mt_arena *mem;
    mt_status rc; /* what ends the comparison */
    mt_err err;
} continua;

/* The objectives at t, half squares as roots; false where they have no value or a goal is not
 * met. */
static bool evaluate_objectives(continua *c, const double *t, double *stages)
{
    mt_workspace *const ws = c->ws;
    const long most = ws->c->search.max_evaluations;
    if (c->rc != MT_OK || (most > 0 && c->out->evals >= most)) {
        return false;
    }
    c->out->evals++;
    const mt_status rc = mt_workspace_eval(ws, t, false, &c->v, &c->err);
    bool good = rc == MT_OK;
    c->rc = mt_is_final(rc) ? rc : MT_OK;
    if (good) {
        const mt_missed m = mt_subproblem_missed(ws->c, &c->v);
        good = mt_is_met(m.violation, 1.0);
    }
    for (int k = 0; k < ws->c->n_stages && good; k++) {
        stages[k] =
            mt_objective_stage_root(&ws->c->stages[k], mt_objective_stage_value(ws, k, NULL));
        good = isfinite(stages[k]);
    }
    return good;
}

static bool equal(const mt_workspace *ws, const double *a, const double *b)
{
    for (int k = 0; k < ws->c->n_stages; k++) {
        const bool unit = mt_objective_is(ws->c->stages[k].type, MT_AMOUNT);
        const double size = fmax(fabs(a[k]), fabs(b[k]));
        if (!(fabs(a[k] - b[k]) <= EQUAL * (unit ? size : fmax(size, 1.0)))) {
            return false;
        }
    }
    return true;
}

/* The Jacobian of the residuals at c->t on the variables free[n_free]: the step to r = 0, into
 * step[n_free]. */
static mt_status shortest_step(continua *c, int n_free, const int *free, double *step,
                               mt_err *err)
{
    const int m = c->ws->c->rows.res.n;
    mt_qr qr;
    double *const jt = mt_arena_f64(c->mem, (size_t)n_free, (size_t)m);
    double *const r = mt_arena_f64(c->mem, (size_t)m, 1);
    MT_TRY(mt_arena_check(c->mem, err));
    for (int i = 0; i < m; i++) {
        r[i] = -c->v.r[i];
        for (int k = 0; k < n_free; k++) {
            jt[k + ((ptrdiff_t)i * n_free)] = c->v.dr[i + ((ptrdiff_t)free[k] * m)];
        }
    }
    MT_TRY(mt_qr_factor(n_free, m, jt, n_free, RANK_TOL, c->mem, &qr, err));
    return mt_qr_solve_transposed(&qr, 1, r, step, c->mem, err);
}

/* Bring c->t back to an exact fit, which bounds that it meets hold it at; false where that does
 * not come about. */
static bool restore_exact_fit(continua *c)
{
    const mt_subproblem *const k = c->ws->c;
    const long most = k->search.max_evaluations;
    const int n = k->n_t;
    int *const free = mt_arena_int(c->mem, (size_t)n);
    double *const step = mt_arena_f64(c->mem, (size_t)n, 1);
    int n_free = 0;
    c->rc = c->rc == MT_OK ? mt_arena_check(c->mem, &c->err) : c->rc;
    for (int j = 0; j < n && c->rc == MT_OK; j++) {
        free[n_free] = j;
        n_free += k->lower_t[j] < k->upper_t[j] ? 1 : 0;
    }
    for (int i = 0; i < STEPS && c->rc == MT_OK; i++) {
        if ((most > 0 && c->out->evals >= most) || n_free < c->ws->c->rows.res.n) {
            return false;
        }
        c->out->evals++;
        mt_status rc = mt_workspace_eval(c->ws, c->t, true, &c->v, &c->err);
        if (rc == MT_OK && mt_max_abs(c->ws->c->rows.res.n, c->v.r) <= RESIDUAL) {
            return true;
        }
        rc = rc == MT_OK ? shortest_step(c, n_free, free, step, &c->err) : rc;
        c->rc = mt_is_final(rc) ? rc : MT_OK;
        if (rc != MT_OK) {
            return false;
        }
        int left = 0;
        for (int f = 0; f < n_free; f++) {
            const int j = free[f];
            const double to = c->t[j] + step[f];
            c->t[j] = fmin(fmax(to, k->lower_t[j]), k->upper_t[j]);
            free[left] = j;
            left += c->t[j] == to ? 1 : 0;
        }
        n_free = left;
    }
    return false;
}

/* The same of a point of the chord, which it may leave by `aside`. */
static bool restore_near(continua *c, double aside)
{
    const int n = c->ws->c->n_t;
    const mt_arena_mark mark = mt_arena_get_mark(c->mem);
    double *const from = mt_arena_f64(c->mem, (size_t)n, 1);
    c->rc = c->rc == MT_OK ? mt_arena_check(c->mem, &c->err) : c->rc;
    bool near = c->rc == MT_OK;
    if (near) {
        memcpy(from, c->t, (size_t)n * sizeof *from);
        near = restore_exact_fit(c);
        mt_axpy(n, -1.0, c->t, from);
        near = near && mt_norm2(n, from) <= aside;
    }
    mt_arena_rewind(c->mem, mark);
    return near;
}

/* True where all designs between solutions i and k are as good as they are. */
static bool connected(continua *c, int i, int k)
{
    const double *const a = c->out->solutions[i].t;
    const double *const b = c->out->solutions[k].t;
    const double *const stages = c->stages + ((ptrdiff_t)i * c->ws->c->n_stages);
    bool one = equal(c->ws, stages, c->stages + ((ptrdiff_t)k * c->ws->c->n_stages));
    const bool curved = c->fits && stages[0] <= EQUAL;
    double chord = 0.0;
    for (int j = 0; j < c->ws->c->n_t; j++) {
        chord = hypot(chord, b[j] - a[j]);
    }
    for (int m = 1; m <= BETWEEN && one; m++) {
        for (int j = 0; j < c->ws->c->n_t; j++) {
            c->t[j] = a[j] + ((b[j] - a[j]) * m / (BETWEEN + 1));
        }
        one = (!curved || restore_near(c, ASIDE * chord)) &&
              evaluate_objectives(c, c->t, c->at) && equal(c->ws, stages, c->at);
    }
    return one;
}

bool mt_search_nearer(const mt_subproblem *c, const double *s, const double *t)
{
    return mt_is_nearer(c->p->n, c->origin_t, c->change_weight, s, t);
}

/* Joins `other` into solution `into`. The record is that of the one nearer to the original,
 * unless unidentifiable directions belong to `into` or the nearer one is no local solution. */
static void join_solutions(const continua *c, int into, const mt_nlp_solution *other)
{
    mt_nlp_result *const out = c->out;
    mt_nlp_solution *const s = &out->solutions[into];
    const int hits = s->hits + other->hits;
    const int start = s->start < other->start ? s->start : other->start;
    const bool told = into == 0 && out->n_unidentifiable > 0;
    if (!told && other->kkt <= STATIONARY && mt_search_nearer(c->ws->c, other->t, s->t)) {
        *s = *other;
    }
    s->hits = hits;
    s->start = start;
    s->continuum = true;
}

/* group[i]: the first solution of i's continuum; i itself where it is alone. All pairs are
 * compared, so the result does not depend on which one is kept. */
static void find_groups(continua *c, int *group)
{
    for (int i = 0; i < c->out->n_solutions; i++) {
        group[i] = i;
        for (int k = 0; k < i; k++) {
            if (group[k] == group[i] || !connected(c, k, i)) {
                continue;
            }
            const int one = group[k] < group[i] ? group[k] : group[i];
            const int other = group[k] < group[i] ? group[i] : group[k];
            for (int m = 0; m <= i; m++) {
                group[m] = group[m] == other ? one : group[m];
            }
        }
    }
}

/* Ranked: joins each solution into the better one of its group. group: on return the place of
 * each group's first in the list, as -1 - place. */
static void join_all(const continua *c, int *group)
{
    mt_nlp_result *const out = c->out;
    int kept = 0;
    for (int i = 0; i < out->n_solutions; i++) {
        if (group[i] < i) {
            join_solutions(c, -1 - group[group[i]], &out->solutions[i]);
            continue;
        }
        out->solutions[kept] = out->solutions[i];
        group[i] = -1 - kept++;
    }
    out->n_solutions = kept;
}

static void count_solutions(mt_nlp_result *out, int before)
{
    if (out->n_solutions == before) {
        return;
    }
    out->n_found = out->n_solutions; /* of those not kept nobody knows */
    out->n_once = 0;
    for (int i = 0; i < out->n_solutions; i++) {
        out->n_once += out->solutions[i].hits == 1;
    }
    out->missing = nan("");
}

mt_status mt_search_join_continua(mt_workspace *ws, mt_arena *mem, mt_nlp_result *out,
                                  mt_err *err)
{
    continua c = {.ws = ws, .out = out, .mem = mem};
    c.fits = ws->c->n_stages == 1 && mt_objective_is(ws->c->stages[0].type, MT_RESIDUALS) &&
             ws->c->rows.eq.n == 0 && ws->c->rows.res.n < ws->c->n_t;
    const int n = out->n_solutions;
    if (out->compromise || n < 2 || out->stop == MT_STOP_USER) {
        return MT_OK;
    }
    c.stages = mt_arena_f64(mem, (size_t)ws->c->n_stages, (size_t)n);
    c.at = mt_arena_f64(mem, (size_t)ws->c->n_stages, 1);
    c.t = mt_arena_f64(mem, (size_t)ws->c->n_t, 1);
    int *const group = mt_arena_int(mem, (size_t)n);
    MT_TRY(mt_arena_check(mem, err));
    mt_status rc = mt_subproblem_values_init(ws->c, mem, &c.v, err);
    for (int i = 0; i < n && rc == MT_OK; i++) {
        double *const stages = c.stages + ((ptrdiff_t)i * ws->c->n_stages);
        if (!evaluate_objectives(&c, out->solutions[i].t, stages)) {
            stages[0] = nan(""); /* equal to nothing */
        }
    }
    if (rc == MT_OK) {
        find_groups(&c, group);
    }
    if (rc == MT_OK && c.rc != MT_OK) {
        rc = mt_fail(err, c.rc, "%s", c.err.text);
    }
    if (rc == MT_OK) {
        join_all(&c, group);
        count_solutions(out, n);
    }
    return rc;
}
