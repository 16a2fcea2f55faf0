/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The search of a subproblem: all objectives in order, and one solution of each continuum. */
#include "search/search.h"

#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "nlp/merit.h"
#include "problem/evaluate.h"
#include "problem/objective.h"
#include "search/catalogue_search.h"
#include "search/proof.h"

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
    if (!told && other->kkt <= MT_STATIONARY && mt_search_nearer(c->ws->c, other->t, s->t)) {
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

/* Of solutions connected by designs that are feasible and have the same
 * objectives, keep one (solution->continuum); n_found and n_once are adjusted. At most 3
 * evaluations for each pair with equal objectives. In place; compromises are unchanged. Fails:
 * MT_E_MEMORY. */
static mt_status search_join_continua(mt_workspace *ws, mt_arena *mem, mt_nlp_result *out,
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

/* The search. */

/* KKT residuals of local optima, and of what is none. */
static const double SHOWN = 1e-6;
static const double NOT_SHOWN = 1e-4;
/* Evaluations of one stage from one design where the study sets no budget. */
enum { STAGE_EVALUATIONS = 2000 };

/* Of a proof that there is no design, where the first starts found none: some milliseconds.
 * What it says is not asked again later. */
static const double PROOF_WORK = 4e6;

/* Options that all stages share. */
static mt_nlp_options options_of(const mt_subproblem *c)
{
    mt_nlp_options opt = mt_nlp_options_default();
    opt.seed = c->search.seed;
    opt.starts = c->search.starts > 0 ? c->search.starts : c->starts;
    opt.any_best = c->as_found;
    opt.max_evals = c->search.max_evaluations;
    opt.least_change = c->stages[c->stage].type == MT_OBJECTIVE_CHANGE;
    return opt;
}

/* A case of which it may be proven that it has no design. */
typedef struct impossible {
    const mt_subproblem *c;
    mt_arena *mem;
    long boxes; /* of the proof */
} impossible;

static mt_status prove_none(void *context, bool *none, mt_err *err)
{
    impossible *const i = context;
    const mt_infeasible_presolve_question q = {
        .c = i->c, .but = -1, .counted = true, .most = PROOF_WORK, .boxes = &i->boxes};
    return mt_infeasible_presolve(&q, i->mem, none, err);
}

/* From many starts; from one design where `from` is not NULL. */
static mt_status first_stage(mt_workspace *const *workers, int n_workers, const double *from,
                             mt_arena *mem, mt_nlp_result *out, mt_err *err)
{
    mt_nlp_options opt = options_of(workers[0]->c);
    mt_nlp nlp = mt_workspace_nlp(workers[0]);
    void **const contexts = mt_arena_alloc(mem, (size_t)n_workers, sizeof *contexts);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < n_workers; i++) {
        contexts[i] = workers[i];
    }
    nlp.n_workers = n_workers;
    nlp.contexts = contexts;
    const mt_subproblem *const c = workers[0]->c;
    impossible asked = {.c = c, .mem = mem};
    /* who asks for more than one design wants other compromises, too */
    if (c->p->n_avoidances == 0 && c->search.starts <= 0 && c->p->study->recommendations == 1 &&
        !mt_study_has_catalogues(c->p->study)) {
        opt.none = c->search.impossible;
        asked.boxes = opt.none ? 1 : 0; /* of that other question: more than none */
        opt.prove_none = opt.none ? NULL : prove_none;
        opt.prove_context = &asked;
    }
    /* roots are all met twice, whatever they cost */
    opt.settles = c->search.settles && c->rows.eq.n < c->p->n;
    opt.agree = from == NULL && (opt.settles || c->best_alone) ? c->search.agree : 0;
    if (from != NULL) {
        opt.starts = 1;
        nlp.origin = from;
        nlp.hint = NULL;
    }
    const mt_status rc = mt_workspace_solve(workers[0], &nlp, &opt, mem, out, err);
    out->boxes = asked.boxes;
    return rc;
}

/* The stages of one search after the first. */
typedef struct stages {
    mt_workspace *ws;
    const mt_subproblem *first;
    mt_subproblem later; /* with the objectives before its stage held */
    mt_arena *mem;
    mt_nlp_result *out;
    double *f;     /* n_stages values of each solution, at its present design */
    double *limit; /* n_stages values of each, at the end of the objective's own stage */
} stages;

/* Objectives of one design, where nothing is held yet: f[n_stages]. */
static mt_status stage_values_at(const stages *s, const double *t, double *f, mt_err *err)
{
    mt_nlp_values v;
    const mt_arena_mark mark = mt_arena_get_mark(s->mem);
    mt_workspace_back(s->ws, s->first);
    mt_status rc = mt_subproblem_values_init(s->first, s->mem, &v, err);
    s->out->evals++;
    rc = rc == MT_OK ? mt_workspace_eval(s->ws, t, false, &v, err) : rc;
    for (int k = 0; k < s->first->n_stages && rc == MT_OK; k++) {
        f[k] = mt_objective_stage_value(s->ws, k, NULL);
    }
    mt_arena_rewind(s->mem, mark);
    return rc;
}

/* Improve solution i in the present stage. */
static mt_status improve_solution(stages *s, int i, mt_err *err)
{
    mt_subproblem *const c = &s->later;
    mt_nlp_solution *const old = &s->out->solutions[i];
    double *const f = s->f + ((ptrdiff_t)i * c->n_stages);
    double *const limit = s->limit + ((ptrdiff_t)i * c->n_stages);
    mt_nlp_result next = {0};
    const long most = s->first->search.max_evaluations;
    const long left = most - s->out->evals - 2; /* its objectives before and behind it */
    const long budget = most > 0 && left < STAGE_EVALUATIONS ? left : STAGE_EVALUATIONS;
    if (budget <= 0) {
        s->out->stop = MT_STOP_MAX_EVALS;
        return MT_OK;
    }
    MT_TRY(stage_values_at(s, old->t, f, err)); /* the residuals that a misfit is held at */
    limit[c->stage - 1] = f[c->stage - 1];
    mt_objectives_hold(c, s->ws, c->stage, limit);
    mt_workspace_back(s->ws, c);
    mt_nlp_options opt = options_of(c);
    mt_nlp nlp = mt_workspace_nlp(s->ws);
    opt.starts = 1;
    opt.max_evals = budget;
    nlp.origin = old->t;
    MT_TRY(mt_workspace_solve(s->ws, &nlp, &opt, s->mem, &next, err));
    mt_steps_append(&s->out->steps, &next.steps, s->out->evals, c->stage, 0);
    MT_TRY(mt_search_repeated_eigenvalues(s->ws, most > 0 ? budget : 0, s->mem, &next, err));
    s->out->evals += next.evals;
    s->out->stop = next.stop;
    if (next.n_solutions == 0 || next.compromise) {
        return MT_OK; /* the design stands as it is */
    }
    const bool singular = old->singular;
    const int start = old->start;
    *old = next.solutions[0];
    old->singular = old->singular || singular;
    old->start = start;
    if (i == 0) {
        s->out->n_unidentifiable = next.n_unidentifiable;
        s->out->unidentifiable = next.unidentifiable;
        s->out->unidentifiable_effect = next.unidentifiable_effect;
    }
    return stage_values_at(s, old->t, f, err);
}

bool mt_search_same(int n, const double *a, const double *b)
{
    double most = 0.0;
    for (int i = 0; i < n; i++) {
        most = fmax(most, fabs(a[i] - b[i]));
    }
    return most <= MT_SAME_DESIGN;
}

/* Drops solutions not shown to be local optima that rank behind one that is: ends of failed
 * searches. */
static void drop_failed(mt_nlp_result *out)
{
    int kept = 0;
    for (int i = 0; i < out->n_solutions; i++) {
        if (i == 0 || !(out->solutions[0].kkt <= SHOWN) ||
            !(out->solutions[i].kkt > NOT_SHOWN)) {
            out->solutions[kept++] = out->solutions[i];
        }
    }
    out->n_solutions = kept;
}

/* Of two equally good flat optima the one of less total change ranks first. */
static bool is_nearer(const stages *s, const mt_nlp_solution *a, const mt_nlp_solution *b)
{
    return a->feasible && a->flat && b->flat && mt_search_nearer(s->first, a->t, b->t);
}

/* True where `one` is the same design as one of the first `kept`. The nearer of two flat ones
 * stays. */
static bool is_twin(const stages *s, int kept, const mt_nlp_solution *one)
{
    mt_nlp_solution *const all = s->out->solutions;
    for (int k = 0; k < kept; k++) {
        if (mt_search_same(s->first->p->n, all[k].t, one->t)) {
            const bool continuum = all[k].continuum || one->continuum;
            all[k] = is_nearer(s, one, &all[k]) ? *one : all[k];
            all[k].continuum = continuum;
            return true;
        }
    }
    return false;
}

/* Drop what has become one, then rank (insertion, stable). */
static void rank_without_duplicates(stages *s)
{
    const int n_stages = s->first->n_stages;
    int kept = 0;
    for (int i = 0; i < s->out->n_solutions; i++) {
        mt_nlp_solution *const all = s->out->solutions;
        const mt_nlp_solution one = all[i];
        double *const f = s->f + ((ptrdiff_t)i * n_stages);
        if (is_twin(s, kept, &one)) {
            continue;
        }
        int at = kept++;
        const mt_merit own = {one.feasible, one.squares, n_stages, f};
        for (; at > 0; at--) {
            const double *const g = s->f + ((ptrdiff_t)(at - 1) * n_stages);
            const mt_merit other = {all[at - 1].feasible, all[at - 1].squares, n_stages, g};
            const bool before = mt_merit_before(&own, &other, MT_EQUAL_FOUND);
            if (!before && (mt_merit_before(&other, &own, MT_EQUAL_FOUND) ||
                            !is_nearer(s, &one, &all[at - 1]))) {
                break;
            }
            all[at] = all[at - 1];
        }
        all[at] = one;
        /* the values move along: rotate f[at..] by one row */
        double *const base = s->f + ((ptrdiff_t)at * n_stages);
        for (double *row = f; row > base; row -= n_stages) {
            for (int k = 0; k < n_stages; k++) {
                const double swap = row[k];
                row[k] = row[k - n_stages];
                row[k - n_stages] = swap;
            }
        }
    }
    s->out->n_solutions = kept;
    drop_failed(s->out);
}

static mt_status later_stages(stages *s, int *stage, mt_err *err)
{
    mt_nlp_result *const out = s->out;
    const int n_stages = s->first->n_stages;
    MT_TRY(mt_subproblem_for_stages(s->first, s->mem, &s->later, err));
    s->f = mt_arena_f64(s->mem, (size_t)n_stages, (size_t)out->n_solutions);
    s->limit = mt_arena_f64(s->mem, (size_t)n_stages, (size_t)out->n_solutions);
    MT_TRY(mt_arena_check(s->mem, err));
    for (int i = 0; i < out->n_solutions; i++) {
        MT_TRY(stage_values_at(s, out->solutions[i].t, s->f + ((ptrdiff_t)i * n_stages), err));
    }
    for (int k = 1; k < n_stages && out->stop == MT_STOP_DONE; k++) {
        s->later.stage = k;
        for (int i = 0; i < out->n_solutions && out->stop == MT_STOP_DONE; i++) {
            MT_TRY(improve_solution(s, i, err));
        }
        *stage = k;
    }
    mt_workspace_back(s->ws, s->first);
    MT_TRY(mt_search_nearest(s->ws, s->first->search.max_evaluations, s->f, s->limit, s->mem,
                             out, err));
    /* solutions that a stage has not reached keep the value of an earlier one: say so by one
     * measure for all */
    for (int i = 0; i < out->n_solutions; i++) {
        out->solutions[i].f = s->f[((ptrdiff_t)i * n_stages) + *stage];
    }
    rank_without_duplicates(s);
    return MT_OK;
}

mt_status mt_search_rank(mt_workspace *ws, int stage, mt_arena *mem, mt_nlp_result *out,
                         mt_err *err)
{
    const size_t n_stages = (size_t)ws->c->n_stages;
    stages s = {.ws = ws, .first = ws->c, .mem = mem, .out = out};
    s.f = mt_arena_f64(mem, n_stages, (size_t)out->n_solutions);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < out->n_solutions; i++) {
        double *const f = s.f + ((size_t)i * n_stages);
        MT_TRY(stage_values_at(&s, out->solutions[i].t, f, err));
        out->solutions[i].f = f[stage];
    }
    rank_without_duplicates(&s);
    return MT_OK;
}

static mt_status search_stages(mt_workspace *const *workers, int n_workers, const double *from,
                               mt_arena *mem, mt_nlp_result *out, int *stage, mt_err *why,
                               mt_err *err)
{
    mt_workspace *const ws = workers[0];
    const mt_subproblem *const c = ws->c;
    mt_err own = {.code = MT_OK};
    *stage = 0;
    const mt_status rc = first_stage(workers, n_workers, from, mem, out, &own);
    if (mt_is_final(rc) || rc == MT_E_USAGE) {
        return mt_fail(err, rc, "%s", own.text);
    }
    if (rc != MT_OK) {
        out->n_solutions = 0;
        *why = own;
        return MT_OK;
    }
    MT_TRY(mt_search_repeated_eigenvalues(ws, c->search.max_evaluations, mem, out, err));
    const long most = c->search.max_evaluations;
    if (c->n_stages == 1 || out->compromise || out->n_solutions == 0 ||
        out->stop != MT_STOP_DONE) {
        MT_TRY(search_join_continua(ws, mem, out, err));
        return c->n_stages == 1 ? mt_search_nearest(ws, most, NULL, NULL, mem, out, err)
                                : MT_OK;
    }
    if (most > 0 && most - out->evals < out->n_solutions) { /* nothing for their objectives */
        out->stop = MT_STOP_MAX_EVALS;
        return search_join_continua(ws, mem, out, err);
    }
    stages s = {.ws = ws, .first = c, .mem = mem, .out = out};
    const mt_status later = later_stages(&s, stage, err);
    mt_workspace_back(ws, c);
    if (later == MT_E_INTERRUPTED) {
        out->stop = MT_STOP_USER;
        return MT_OK;
    }
    return later == MT_OK ? search_join_continua(ws, mem, out, err) : later;
}

mt_status mt_search_designs(mt_workspace *const *workers, int n_workers, mt_arena *mem,
                            mt_nlp_result *out, int *stage, mt_err *why, mt_err *err)
{
    return search_stages(workers, n_workers, NULL, mem, out, stage, why, err);
}

mt_status mt_search_from(mt_workspace *ws, const double *from, mt_arena *mem,
                         mt_nlp_result *out, int *stage, mt_err *err)
{
    mt_err why = {.code = MT_OK};
    return search_stages(&ws, 1, from, mem, out, stage, &why, err);
}
