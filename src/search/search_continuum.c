/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Where solutions form a continuum, every start ends at another place of it. Two solutions a
 * and b belong to one continuum where
 *
 *     t = a + s (b - a),   s = 1/4, 1/2, 3/4,
 *
 * meet all goals with the objectives that a and b have, within their tolerance. Isolated
 * solutions do not: between them the objective rises or a goal is missed. Of a continuum one is
 * kept, the nearest to the original design. Curved ones, whose chord leaves them, are not told.
 */
#include <math.h>
#include <string.h>

#include "nlp/merit.h"
#include "problem/objective.h"
#include "search/search.h"

enum { BETWEEN = 3 };
/* Objectives that differ by less are equal: relative to their size; those without unit (roots
 * of half squares, clearances) to this at least, as residuals are. */
static const double EQUAL = 1e-6;
/* KKT residuals below this are local solutions, as in the search. */
static const double STATIONARY = 1e-6;

typedef struct continua {
    mt_workspace *ws;
    mt_nlp_result *out;
    mt_nlp_values v;
    double *aims; /* n_aims of each solution */
    double *at;   /* [n_aims] between two of them */
    double *t;    /* [n_t] */
    mt_status rc; /* what ends the comparison */
    mt_err err;
} continua;

/* The objectives at t, half squares as roots; false where it has none, or misses a goal. */
static bool measure(continua *c, const double *t, double *aims)
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
        const mt_case *const k = ws->c;
        const mt_missed m =
            mt_missed_of(ws->p->n_eq, c->v.eq, k->eq_tol, k->n_in, c->v.in, k->in_tol);
        good = mt_is_met(m.violation, 1.0);
    }
    for (int k = 0; k < ws->c->n_aims && good; k++) {
        aims[k] = mt_aim_root(&ws->c->aims[k], mt_aim_value(ws, k, NULL));
        good = isfinite(aims[k]);
    }
    return good;
}

static bool equal(const mt_workspace *ws, const double *a, const double *b)
{
    for (int k = 0; k < ws->c->n_aims; k++) {
        const bool unit = mt_objective_is(ws->c->aims[k].type, MT_AMOUNT);
        const double size = fmax(fabs(a[k]), fabs(b[k]));
        if (!(fabs(a[k] - b[k]) <= EQUAL * (unit ? size : fmax(size, 1.0)))) {
            return false;
        }
    }
    return true;
}

/* True where all that is between solutions i and k is as good as they are. */
static bool connected(continua *c, int i, int k)
{
    const double *const a = c->out->solutions[i].t;
    const double *const b = c->out->solutions[k].t;
    const double *const aims = c->aims + ((ptrdiff_t)i * c->ws->c->n_aims);
    bool one = equal(c->ws, aims, c->aims + ((ptrdiff_t)k * c->ws->c->n_aims));
    for (int m = 1; m <= BETWEEN && one; m++) {
        for (int j = 0; j < c->ws->c->n_t; j++) {
            c->t[j] = a[j] + ((b[j] - a[j]) * m / (BETWEEN + 1));
        }
        one = measure(c, c->t, c->at) && equal(c->ws, aims, c->at);
    }
    return one;
}

bool mt_search_nearer(const mt_case *c, const double *s, const double *t)
{
    return mt_is_nearer(c->p->n, c->origin_t, c->change_weight, s, t);
}

/* One record for both, at the place of the better: it is that of the nearer to the original,
 * unless directions are told of the better, or the nearer is no local solution. */
static void join(const continua *c, int into, const mt_nlp_solution *other)
{
    mt_nlp_result *const out = c->out;
    mt_nlp_solution *const s = &out->solutions[into];
    const int hits = s->hits + other->hits;
    const int start = s->start < other->start ? s->start : other->start;
    const bool told = into == 0 && out->n_undetermined > 0;
    if (!told && other->kkt <= STATIONARY && mt_search_nearer(c->ws->c, other->t, s->t)) {
        *s = *other;
    }
    s->hits = hits;
    s->start = start;
    s->continuum = true;
}

/* group[i]: the first solution of i's continuum, i itself where it is alone. All pairs are
 * compared, so that it does not matter which of a continuum is kept. */
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

/* Ranked: what belongs to a better one goes into it. group: afterwards its place in the list,
 * as -1 - place, for each first. */
static void join_all(const continua *c, int *group)
{
    mt_nlp_result *const out = c->out;
    int kept = 0;
    for (int i = 0; i < out->n_solutions; i++) {
        if (group[i] < i) {
            join(c, -1 - group[group[i]], &out->solutions[i]);
            continue;
        }
        out->solutions[kept] = out->solutions[i];
        group[i] = -1 - kept++;
    }
    out->n_solutions = kept;
}

static void count(mt_nlp_result *out, int before)
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
    continua c = {.ws = ws, .out = out};
    const int n = out->n_solutions;
    if (out->compromise || n < 2 || out->stop == MT_STOP_USER) {
        return MT_OK;
    }
    c.aims = mt_arena_f64(mem, (size_t)ws->c->n_aims, (size_t)n);
    c.at = mt_arena_f64(mem, (size_t)ws->c->n_aims, 1);
    c.t = mt_arena_f64(mem, (size_t)ws->c->n_t, 1);
    int *const group = mt_arena_int(mem, (size_t)n);
    MT_TRY(mt_arena_check(mem, err));
    mt_status rc = mt_case_values_init(ws->c, mem, &c.v, err);
    for (int i = 0; i < n && rc == MT_OK; i++) {
        double *const aims = c.aims + ((ptrdiff_t)i * ws->c->n_aims);
        if (!measure(&c, out->solutions[i].t, aims)) {
            aims[0] = nan(""); /* equal to nothing */
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
        count(out, n);
    }
    return rc;
}
