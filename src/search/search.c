/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "search/search.h"

#include <math.h>
#include <string.h>

/* Designs nearer than this (0.1 percent in a positive parameter) are one, as in the search
 * itself. */
static const double SAME = 1e-3;
/* Values of a held objective that differ by less, relatively, rank by the next objective. */
static const double EQUAL = 4e-6;
/* KKT residuals of local optima, and of what is none. */
static const double SHOWN = 1e-6;
static const double NOT_SHOWN = 1e-4;
/* Evaluations of one stage from one design where the study sets no budget. */
enum { STAGE_EVALUATIONS = 2000 };

/* Options that all stages share. */
static mt_nlp_options options_of(const mt_problem *p)
{
    mt_nlp_options opt = mt_nlp_options_default();
    opt.seed = p->study->search.seed;
    opt.starts = p->study->search.starts > 0 ? p->study->search.starts : p->starts;
    opt.max_evals = p->study->search.max_evaluations;
    opt.least_change = p->aims[p->stage].type == MT_OBJECTIVE_CHANGE;
    return opt;
}

static mt_status first_stage(mt_problem *const *problems, int n_workers, mt_arena *mem,
                             mt_nlp_result *out, mt_err *err)
{
    const mt_nlp_options opt = options_of(problems[0]);
    mt_nlp nlp = mt_problem_nlp(problems[0]);
    void **const contexts = mt_arena_alloc(mem, (size_t)n_workers, sizeof *contexts);
    if (contexts == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < n_workers; i++) {
        contexts[i] = problems[i];
    }
    nlp.n_workers = n_workers;
    nlp.contexts = contexts;
    return mt_nlp_solve(&nlp, &opt, mem, out, err);
}

/* The present stage from one design. */
static mt_status later_stage(mt_problem *p, const double *from, long budget, mt_arena *mem,
                             mt_nlp_result *out, mt_err *err)
{
    mt_nlp_options opt = options_of(p);
    mt_nlp nlp = mt_problem_nlp(p);
    opt.starts = 1;
    opt.max_evals = budget;
    nlp.origin = from;
    MT_TRY(mt_nlp_solve(&nlp, &opt, mem, out, err));
    return mt_search_repeated(p, p->study->search.max_evaluations > 0 ? budget : 0, mem, out,
                              err);
}

/* Objectives of one design: f[n_aims]. */
static mt_status aims_at(mt_problem *p, const double *t, mt_arena *mem, double *f, mt_err *err)
{
    mt_nlp_values v;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const int stage = p->stage;
    p->stage = 0; /* nothing need be held yet */
    mt_status rc = mt_problem_values_init(p, mem, &v, err);
    rc = rc == MT_OK ? mt_problem_eval(p, t, false, &v, err) : rc;
    for (int k = 0; k < p->n_aims && rc == MT_OK; k++) {
        f[k] = mt_aim_value(p, k, NULL);
    }
    p->stage = stage;
    mt_arena_rewind(mem, mark);
    return rc;
}

/* The stages of one search after the first. */
typedef struct stages {
    mt_problem *p;
    mt_arena *mem;
    mt_nlp_result *out;
    double *f;     /* n_aims values of each solution, at its present design */
    double *limit; /* n_aims values of each, at the end of the objective's own stage */
} stages;

static long budget_left(const stages *s)
{
    const long most = s->p->study->search.max_evaluations;
    const long left = most - s->out->evals;
    return most > 0 && left < STAGE_EVALUATIONS ? left : STAGE_EVALUATIONS;
}

/* Improve solution i in the present stage. */
static mt_status refine(stages *s, int i, mt_err *err)
{
    mt_problem *const p = s->p;
    mt_nlp_solution *const old = &s->out->solutions[i];
    double *const f = s->f + ((ptrdiff_t)i * p->n_aims);
    double *const limit = s->limit + ((ptrdiff_t)i * p->n_aims);
    mt_nlp_result next = {0};
    const long budget = budget_left(s);
    if (budget <= 0) {
        s->out->stop = MT_STOP_MAX_EVALS;
        return MT_OK;
    }
    MT_TRY(aims_at(p, old->t, s->mem, f, err)); /* the residuals that a misfit is held at */
    limit[p->stage - 1] = f[p->stage - 1];
    for (int k = 0; k < p->stage; k++) {
        mt_aim_hold(p, k, limit[k]);
    }
    MT_TRY(later_stage(p, old->t, budget, s->mem, &next, err));
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
        s->out->n_undetermined = next.n_undetermined;
        s->out->undetermined = next.undetermined;
        s->out->undetermined_effect = next.undetermined_effect;
    }
    return aims_at(p, old->t, s->mem, f, err);
}

bool mt_search_before(int n, const double *a, const double *b)
{
    for (int k = 0; k < n; k++) {
        if (fabs(a[k] - b[k]) > EQUAL * fmax(fabs(a[k]), fabs(b[k]))) {
            return a[k] < b[k];
        }
    }
    return false;
}

bool mt_search_same(int n, const double *a, const double *b)
{
    double most = 0.0;
    for (int i = 0; i < n; i++) {
        most = fmax(most, fabs(a[i] - b[i]));
    }
    return most <= SAME;
}

/* Behind a design that is shown to be a local optimum those that are not are ends of failed
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

/* Drop what has become one, then rank (insertion, stable). */
static void rank(stages *s)
{
    const int n_aims = s->p->n_aims;
    int kept = 0;
    for (int i = 0; i < s->out->n_solutions; i++) {
        mt_nlp_solution *const all = s->out->solutions;
        const mt_nlp_solution one = all[i];
        double *const f = s->f + ((ptrdiff_t)i * n_aims);
        bool twin = false;
        for (int k = 0; k < kept; k++) {
            twin = twin || mt_search_same(s->p->n, all[k].t, one.t);
        }
        if (twin) {
            continue;
        }
        int at = kept++;
        for (; at > 0 && mt_search_before(n_aims, f, s->f + ((ptrdiff_t)(at - 1) * n_aims));
             at--) {
            all[at] = all[at - 1];
        }
        all[at] = one;
        /* the values move along: rotate f[at..] by one row */
        double *const base = s->f + ((ptrdiff_t)at * n_aims);
        for (double *row = f; row > base; row -= n_aims) {
            for (int k = 0; k < n_aims; k++) {
                const double swap = row[k];
                row[k] = row[k - n_aims];
                row[k - n_aims] = swap;
            }
        }
    }
    s->out->n_solutions = kept;
    drop_failed(s->out);
}

static mt_status later_stages(stages *s, int *stage, mt_err *err)
{
    mt_problem *const p = s->p;
    mt_nlp_result *const out = s->out;
    const size_t n_aims = (size_t)p->n_aims;
    s->f = mt_arena_f64(s->mem, n_aims, (size_t)out->n_solutions);
    s->limit = mt_arena_f64(s->mem, n_aims, (size_t)out->n_solutions);
    if (s->f == NULL || s->limit == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < out->n_solutions; i++) {
        MT_TRY(aims_at(p, out->solutions[i].t, s->mem, s->f + ((ptrdiff_t)i * p->n_aims), err));
    }
    for (int k = 1; k < p->n_aims && out->stop == MT_STOP_DONE; k++) {
        p->stage = k;
        for (int i = 0; i < out->n_solutions && out->stop == MT_STOP_DONE; i++) {
            MT_TRY(refine(s, i, err));
        }
        *stage = k;
    }
    /* solutions that a stage has not reached keep the value of an earlier one: say so by one
     * measure for all */
    for (int i = 0; i < out->n_solutions; i++) {
        out->solutions[i].f = s->f[((ptrdiff_t)i * p->n_aims) + *stage];
    }
    rank(s);
    return MT_OK;
}

mt_status mt_search_designs(mt_problem *const *problems, int n_workers, mt_arena *mem,
                            mt_nlp_result *out, int *stage, mt_err *why, mt_err *err)
{
    mt_problem *const p = problems[0];
    mt_err own = {.code = MT_OK};
    *stage = 0;
    const mt_status rc = first_stage(problems, n_workers, mem, out, &own);
    if (mt_is_final(rc) || rc == MT_E_USAGE) {
        return mt_fail(err, rc, "%s", own.text);
    }
    if (rc != MT_OK) {
        out->n_solutions = 0;
        *why = own;
        return MT_OK;
    }
    MT_TRY(mt_search_repeated(p, p->study->search.max_evaluations, mem, out, err));
    if (p->n_aims == 1 || out->compromise || out->n_solutions == 0 ||
        out->stop != MT_STOP_DONE) {
        return mt_search_join_continua(p, mem, out, err);
    }
    stages s = {.p = p, .mem = mem, .out = out};
    const mt_status later = later_stages(&s, stage, err);
    p->stage = 0;
    if (later == MT_E_INTERRUPTED) {
        out->stop = MT_STOP_USER;
        return MT_OK;
    }
    return later == MT_OK ? mt_search_join_continua(p, mem, out, err) : later;
}
