/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The search for one move. In the coordinates t of the study, with one more, s:
 *     minimise 1/2 s^2   subject to   in_i(t) + s >= 0 (i: rows of the moved number),
 *         eq_i(t) - s = 0,   all other rows as they are;
 * for a bound there is no s: its variable may leave it, and 1/2 (t_j - bound)^2 beyond it is
 * minimised.
 */
#include "search/relax.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/workers.h"
#include "search/gaps.h"
#include "search/motion.h"

/* Local searches of one move in one assignment, and what each of them may cost. */
enum { STARTS = 6, EVALUATIONS = 200, ASSIGNMENTS = 6 };
/* Where the study sets a budget: what a search of one move needs at least of it. */
enum { BUDGET_LEAST = 2 * EVALUATIONS };
/* A move smaller than this is none: then a design exists without it, and the search has missed
 * it. */
static const double LEAST = 1e-9;

typedef struct relaxed {
    mt_problem *q;
    const mt_move *move;
    double bound_t; /* of a bound that is moved */
} relaxed;

typedef struct task_result {
    mt_arena mem;
    long evals;
    int starts;
    bool stopped;
} task_result;

typedef struct job {
    const mt_problem *p;
    mt_moves *moves;
    const double *near;
    long budget; /* evaluations of each move */
    task_result *results;
} job;

/* 1/2 (distance beyond the old bound)^2. */
static void beyond_bound(const relaxed *r, const double *t, bool with_gradient,
                         mt_nlp_values *out)
{
    const int j = r->move->variable;
    const double d =
        r->move->upper ? fmax(t[j] - r->bound_t, 0.0) : fmin(t[j] - r->bound_t, 0.0);
    out->f = 0.5 * d * d;
    if (with_gradient) {
        memset(out->df, 0, (size_t)r->q->n * sizeof *out->df);
        out->df[j] = d;
    }
}

static void relax_rows(const relaxed *r, double s, bool with_gradient, mt_nlp_values *out)
{
    const mt_problem *const q = r->q;
    const ptrdiff_t n = q->n;
    out->f = 0.5 * s * s;
    if (with_gradient) {
        memset(out->df, 0, (size_t)n * sizeof *out->df);
        out->df[n] = s;
        memset(out->din + (n * q->n_in), 0, (size_t)q->n_in * sizeof *out->din);
        memset(out->deq + (n * q->n_eq), 0, (size_t)q->n_eq * sizeof *out->deq);
    }
    for (int i = 0; i < q->n_in; i++) {
        if (mt_relax_is_row(q, r->move, false, i)) {
            out->in[i] += s;
            if (with_gradient) {
                out->din[i + (n * q->n_in)] = 1.0;
            }
        }
    }
    for (int i = 0; i < q->n_eq; i++) {
        if (mt_relax_is_row(q, r->move, true, i)) {
            out->eq[i] -= s;
            if (with_gradient) {
                out->deq[i + (n * q->n_eq)] = -1.0;
            }
        }
    }
}

static mt_status evaluate(void *context, const double *t, bool with_gradient,
                          mt_nlp_values *out, mt_err *err)
{
    const relaxed *const r = context;
    MT_TRY(mt_problem_eval(r->q, t, with_gradient, out, err));
    if (r->move->kind == MT_MOVE_BOUND) {
        beyond_bound(r, t, with_gradient, out);
    } else {
        relax_rows(r, t[r->q->n], with_gradient, out);
    }
    return MT_OK;
}

/* Does the design of q hold between the positions of its drives, too? An edge is moved in one
 * position only, which says nothing of the others. */
static mt_status hold_motion(mt_problem *q, const mt_move *m, mt_arena *mem, double *value,
                             mt_err *err)
{
    bool kept = true;
    if (mt_family_any(q) && q->below != NULL) {
        kept = m->kind != MT_MOVE_EDGE;
        MT_TRY(kept ? mt_motion_kept(q, q->below, mem, &kept, err) : MT_OK);
    }
    *value = kept ? *value : nan("");
    return MT_OK;
}

/* The number that the move needs at the design t of q, and its inputs x; NaN where that does
 * not do. */
static mt_status confirm(mt_problem *q, const mt_move *m, const double *t, mt_arena *mem,
                         double *x, double *value, mt_err *err)
{
    mt_nlp_values v;
    mt_err own = {0};
    *value = nan("");
    MT_TRY(mt_problem_values_init(q, mem, &v, err));
    const mt_status rc = mt_problem_eval(q, t, false, &v, &own);
    if (rc != MT_OK) {
        return mt_pass_final(rc, &own, err);
    }
    *value = mt_relax_value(q, m, &v);
    memcpy(x, q->x, (size_t)q->n * sizeof *x);
    return hold_motion(q, m, mem, value, err);
}

/* Keep what was found where it is the least move so far, and a problem made anew confirms
 * it. */
static mt_status keep(const job *j, const mt_study *study, const int *below, mt_move *m,
                      const mt_nlp_solution *found, mt_arena *mem, mt_err *err)
{
    mt_problem *q = NULL;
    double *const x = mt_arena_f64(mem, (size_t)j->p->n, 1);
    double to = nan("");
    if (x == NULL) {
        return mt_fail_memory(err);
    }
    const double size = sqrt(2.0 * found->f);
    if (!found->feasible || !(size > LEAST) || (m->found && size >= m->size)) {
        return MT_OK;
    }
    MT_TRY(mt_problem_new_in_gap(study, j->p->references, below, &q, err));
    const mt_status rc = confirm(q, m, found->t, mem, x, &to, err);
    mt_problem_delete(q);
    MT_TRY(rc);
    if (MT_HAS(to)) {
        m->found = true;
        m->to = to;
        m->size = size;
        memcpy(m->x, x, (size_t)j->p->n * sizeof *x);
    }
    return MT_OK;
}

static mt_nlp nlp_of(relaxed *r, const double *near, double *hint)
{
    mt_problem *const q = r->q;
    mt_nlp nlp = mt_problem_nlp(q);
    nlp.eval = evaluate;
    nlp.n_next = 0; /* they follow from rows that may be moved */
    nlp.context = r;
    if (near != NULL) {
        memcpy(hint, near, (size_t)q->n * sizeof *hint);
        nlp.hint = hint;
    }
    if (r->move->kind == MT_MOVE_BOUND) {
        const mt_move *const m = r->move;
        r->bound_t = mt_problem_t(q, m->variable, m->from);
        return nlp;
    }
    /* problem.c keeps room for one more coordinate */
    nlp.n = q->n + 1;
    q->lower_t[q->n] = r->move->target ? -MT_RELAX_MOST : 0.0;
    q->upper_t[q->n] = MT_RELAX_MOST;
    q->origin_t[q->n] = 0.0;
    hint[q->n] = 0.5 * MT_RELAX_MOST;
    return nlp;
}

static mt_status search_in_gap(const job *j, const mt_study *study, const int *below,
                               mt_move *m, task_result *out, mt_err *err)
{
    relaxed r = {.move = m};
    mt_nlp_result found = {0};
    mt_err why = {0};
    mt_nlp_options opt = mt_nlp_options_default();
    MT_TRY(mt_problem_new_in_gap(study, j->p->references, below, &r.q, err));
    opt.seed = study->search.seed;
    opt.starts = STARTS;
    opt.max_evals = (long)STARTS * EVALUATIONS;
    if (j->budget - out->evals < opt.max_evals) {
        opt.max_evals = j->budget - out->evals;
    }
    if (opt.max_evals <= 0) {
        mt_problem_delete(r.q);
        return MT_OK;
    }
    opt.max_solutions = 1;
    opt.least_change = false;
    double *const hint = mt_arena_f64(&out->mem, (size_t)r.q->n + 1, 1);
    if (hint == NULL) {
        mt_problem_delete(r.q);
        return mt_fail_memory(err);
    }
    const mt_nlp nlp = nlp_of(&r, j->near, hint);
    const mt_status own = mt_nlp_solve(&nlp, &opt, &out->mem, &found, &why);
    mt_status rc = mt_pass_final(own, &why, err);
    out->evals += found.evals;
    out->starts += found.starts;
    out->stopped = out->stopped || found.stop == MT_STOP_USER;
    if (own == MT_OK && found.n_solutions > 0) {
        rc = keep(j, study, below, m, &found.solutions[0], &out->mem, err);
    }
    mt_problem_delete(r.q);
    return rc;
}

/* With bands: in each of the assignments that samples come nearest to. */
static mt_status search_gaps(const job *j, const mt_study *study, mt_move *m, task_result *out,
                             mt_err *err)
{
    mt_problem *plain = NULL;
    mt_gap_candidates near = {0};
    MT_TRY(mt_problem_new(study, j->p->references, &plain, err));
    mt_status rc = mt_gap_candidates_near(plain, ASSIGNMENTS, &out->mem, &near, err);
    out->evals += near.evals;
    for (int k = 0; k < near.n && rc == MT_OK && !out->stopped; k++) {
        rc = search_in_gap(j, study, near.below + ((ptrdiff_t)k * plain->n_bands), m, out, err);
    }
    mt_problem_delete(plain);
    return rc;
}

static mt_status search_move(void *context, int worker, int k, mt_err *err)
{
    const job *const j = context;
    mt_move *const m = &j->moves->items[k];
    task_result *const out = &j->results[k];
    mt_study study;
    bool useful = false;
    (void)worker;
    MT_TRY(mt_arena_init(&out->mem, 0, err));
    MT_TRY(mt_relax_study(j->p->study, m, &out->mem, &study, &useful, err));
    if (!useful) {
        return MT_OK;
    }
    return j->p->n_clears > 0 ? search_gaps(j, &study, m, out, err)
                              : search_in_gap(j, &study, NULL, m, out, err);
}

/* Of the study's budget, if it sets one, an equal share of what is left. */
static long budget_of(const mt_problem *p, long spent, int n_moves)
{
    const long most = p->study->search.max_evaluations;
    return most > 0 && n_moves > 0 ? (most - spent) / n_moves : LONG_MAX;
}

mt_status mt_relax(mt_problem *p, int workers, const mt_nlp_result *search, mt_arena *mem,
                   mt_moves *out, mt_err *err)
{
    MT_TRY(mt_relax_moves(p, mem, out, err));
    job j = {.p = p,
             .moves = out,
             .near = search->n_solutions > 0 ? search->solutions[0].t : NULL,
             .budget = budget_of(p, search->evals, out->n),
             .results = mt_arena_alloc(mem, (size_t)out->n, sizeof *j.results)};
    const int n = out->n;
    const int least = p->n_clears > 0 ? BUDGET_LEAST + MT_GAP_SAMPLES_NEAR : BUDGET_LEAST;
    if (j.results == NULL) {
        return mt_fail_memory(err);
    }
    out->short_of_budget = j.budget < least;
    if (out->short_of_budget) {
        out->n = 0;
        return MT_OK;
    }
    const mt_status rc = mt_workers_run(workers, n, search_move, &j, err);
    for (int k = 0; k < n; k++) {
        out->evals += j.results[k].evals;
        out->starts += j.results[k].starts;
        out->stopped = out->stopped || j.results[k].stopped;
        mt_arena_free(&j.results[k].mem);
    }
    mt_relax_rank(out);
    return rc;
}
