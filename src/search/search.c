/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "search/search.h"

#include <math.h>
#include <string.h>

#include "nlp/merit.h"
#include "problem/evaluate.h"
#include "problem/objective.h"
#include "search/catalogue_search.h"
#include "search/infeasible_presolve.h"

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
        opt.prove_none = prove_none;
        opt.prove_context = &asked;
    }
    /* roots are all met twice, whatever they cost */
    opt.settles = c->search.settles && c->rows.eq.n < c->p->n;
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
        MT_TRY(mt_search_join_continua(ws, mem, out, err));
        return c->n_stages == 1 ? mt_search_nearest(ws, most, NULL, NULL, mem, out, err)
                                : MT_OK;
    }
    if (most > 0 && most - out->evals < out->n_solutions) { /* nothing for their objectives */
        out->stop = MT_STOP_MAX_EVALS;
        return mt_search_join_continua(ws, mem, out, err);
    }
    stages s = {.ws = ws, .first = c, .mem = mem, .out = out};
    const mt_status later = later_stages(&s, stage, err);
    mt_workspace_back(ws, c);
    if (later == MT_E_INTERRUPTED) {
        out->stop = MT_STOP_USER;
        return MT_OK;
    }
    return later == MT_OK ? mt_search_join_continua(ws, mem, out, err) : later;
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
