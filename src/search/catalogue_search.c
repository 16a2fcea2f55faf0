/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "search/catalogue_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/run.h"
#include "base/workers.h"
#include "problem/drive_positions.h"
#include "problem/objective.h"
#include "search/catalogue_search_proofs.h"
#include "search/search.h"

/* Designs that are kept for alternatives, where the study does not ask for more. */
enum { KEPT = 16 };

bool mt_study_has_catalogues(const mt_study *study)
{
    for (int i = 0; i < study->n_variables; i++) {
        if (study->variables[i].n_catalogue > 0) {
            return true;
        }
    }
    return false;
}

static mt_status list_catalogue_variables(mt_catalogue_search *d, mt_err *err)
{
    const mt_problem *const p = d->p;
    d->variable = mt_arena_int(d->mem, (size_t)p->n);
    d->values = mt_arena_alloc(d->mem, (size_t)d->n_workers, sizeof *d->values);
    d->steps = mt_steps_new(MT_STEPS_MOST, d->mem);
    MT_TRY(mt_arena_check(d->mem, err));
    for (int i = 0; i < p->n; i++) {
        if (p->study->variables[i].n_catalogue > 0) {
            d->variable[d->n_listed++] = i;
        }
    }
    d->mixed = d->n_listed < p->n;
    for (int i = 0; i < d->n_workers && !d->mixed; i++) {
        MT_TRY(mt_subproblem_values_init(d->c, d->mem, &d->values[i], err));
    }
    return MT_OK;
}

void mt_catalogue_search_set(const mt_catalogue_search *d, mt_combination *c)
{
    const mt_problem *const p = d->p;
    double change = 0.0;
    for (int k = 0; k < d->n_listed; k++) {
        const int i = d->variable[k];
        const mt_variable *const v = &p->study->variables[i];
        const double t = mt_problem_t(p, i, v->catalogue[c->pick[k]]);
        const double away = t - d->c->origin_t[i];
        c->t[i] = t;
        change += 0.5 * v->weight * away * away;
    }
    c->change = change;
}

/* The best of some combinations. */
typedef struct ranking_of_combinations {
    int most;
    int n;
    mt_combination **best; /* [most] */
} ranking_of_combinations;

/* Ranks list[n] among those of r, by insertion, so that equal ones keep their order. What would
 * be among them is followed over its motion first. */
static mt_status rank_combinations(mt_catalogue_search *d, mt_combination *const *list, int n,
                                   ranking_of_combinations *r, mt_err *err)
{
    for (int i = 0; i < n; i++) {
        if (r->n < r->most || mt_catalogue_search_before(d, list[i], r->best[r->n - 1])) {
            MT_TRY(mt_catalogue_search_follow(d, list[i], err));
        }
        if (!list[i]->judged || !MT_HAS(list[i]->missed.violation)) {
            continue;
        }
        int at = r->n < r->most ? r->n++ : r->most;
        for (; at > 0 && mt_catalogue_search_before(d, list[i], r->best[at - 1]); at--) {
            if (at < r->most) {
                r->best[at] = r->best[at - 1];
            }
        }
        if (at < r->most) {
            r->best[at] = list[i];
        }
    }
    return MT_OK;
}

/*
 * All combinations, best first. Each has a lower bound of the first objective, over all values
 * of its continuous variables (problem/objective.h); they are judged in the order of these, and
 * the search ends where the next one's is above the last design of the list that is asked for.
 * Where continuous variables remain, a combination is a search of many evaluations: before it
 * comes a short certificate (catalogue_search_proofs.h) with the last design of the list as a
 * cap. What it excludes has no design that could be listed, or none at all, and is not
 * searched; a design that it meets is one more start. Without any design that meets all goals
 * the nearest misses are wanted, and what was excluded is searched, too.
 *
 * A batch has one cap: nothing depends on the workers. Under a budget of evaluations, which is
 * shared out before anything is begun, all are judged in the order of their change.
 */
/* Combinations between two looks at what is left to do: enough for any number of workers, few
 * enough to stop in time. Fixed, so that results do not depend on the workers. */
enum { BATCH = 4096, BATCH_MIXED = 16 };
/* Of a budget, what each combination of a batch may use at least. */
enum { LEAST_BUDGET = 20 };
/* Work of the certificate of a combination, in boxes: less than its search takes. */
static const double LOOK = 200.0;
/* ... and of all of them together, of the budget of proofs. */
static const double PART = 0.2;
/* First objectives that differ by less are equal where others decide between them. */
static const double EQUAL = 1e-9;

typedef struct enumeration {
    mt_catalogue_search *d;
    ranking_of_combinations *ranking;
    mt_catalogue_search_report *report;
    int n;
    mt_combination *list;               /* [n] by ascending bound */
    int asked;                          /* designs of the list */
    bool looks;                         /* certificates come before searches */
    double last;                        /* objective of the last design asked for; HUGE_VAL */
    double work;                        /* of all looks, as certificates count it */
    mt_proof_cap *caps;                 /* [n_workers] */
    mt_catalogue_search_proofs *proofs; /* [n_workers] */
    double *bounds;                     /* [2 n x n_workers] */
    int first;                          /* combination of the first look */
    mt_catalogue_search_look at[BATCH_MIXED];
} enumeration;

/* All combinations, the last variable fastest. */
static mt_status list_all(enumeration *e, mt_err *err)
{
    const mt_catalogue_search *const d = e->d;
    MT_TRY(mt_catalogue_search_alloc(d, e->n, &e->list, err));
    for (int i = 0; i < e->n; i++) {
        int rest = i;
        for (int k = d->n_listed - 1; k >= 0; k--) {
            const int values = d->p->study->variables[d->variable[k]].n_catalogue;
            e->list[i].pick[k] = rest % values;
            rest /= values;
        }
        mt_catalogue_search_set(d, &e->list[i]);
    }
    return MT_OK;
}

/* The bounds lower[n], upper[n] of the combination's designs. */
static void find_bounds(const mt_catalogue_search *d, const mt_combination *c, double *lower,
                        double *upper)
{
    for (int i = 0; i < d->p->n; i++) {
        lower[i] = d->c->lower[i];
        upper[i] = d->c->upper[i];
    }
    for (int k = 0; k < d->n_listed; k++) {
        const int i = d->variable[k];
        lower[i] = d->p->study->variables[i].catalogue[c->pick[k]];
        upper[i] = lower[i];
    }
}

/* Lower bounds of the first objective; of the change of catalogue values alone it is itself. */
static void bound_all(enumeration *e)
{
    const mt_catalogue_search *const d = e->d;
    const mt_certify_cap *const cap = &e->caps[0].cap;
    const bool change = d->p->stages[0].type == MT_OBJECTIVE_CHANGE;
    const bool known = e->caps[0].known && d->c->search.max_evaluations <= 0;
    double *const lower = e->bounds;
    double *const upper = e->bounds + d->p->n;
    e->report->by_change = change;
    for (int i = 0; i < e->n; i++) {
        mt_combination *const c = &e->list[i];
        c->least = change ? c->change : -HUGE_VAL;
        if (known && (d->mixed || !change)) {
            find_bounds(d, c, lower, upper);
            c->least = fmax(c->least, cap->least(cap->context, lower, upper));
        }
    }
}

/* By the change of their catalogue values, then by the order of the list (pick is in one array
 * in that order). */
static int by_change(const mt_combination *x, const mt_combination *y)
{
    if (x->change != y->change) {
        return x->change < y->change ? -1 : 1;
    }
    return x->pick < y->pick ? -1 : x->pick > y->pick ? 1 : 0;
}

static int by_bound(const void *a, const void *b)
{
    const mt_combination *const x = a;
    const mt_combination *const y = b;
    if (x->least != y->least) {
        return x->least < y->least ? -1 : 1;
    }
    return by_change(x, y);
}

/* The order in which equal designs are listed. */
static int by_place(const void *a, const void *b)
{
    const mt_combination *const *const x = a;
    const mt_combination *const *const y = b;
    return by_change(*x, *y);
}

static mt_status begin(enumeration *e, mt_err *err)
{
    mt_catalogue_search *const d = e->d;
    const size_t n = (size_t)d->p->n;
    const size_t n_workers = (size_t)d->n_workers;
    e->caps = mt_arena_alloc(d->mem, n_workers, sizeof *e->caps);
    e->bounds = mt_arena_f64(d->mem, 2 * n, n_workers);
    MT_TRY(mt_arena_check(d->mem, err));
    for (size_t i = 0; i < n_workers; i++) {
        MT_TRY(mt_proof_cap_init(&e->caps[i], d->p, d->mem, err));
    }
    MT_TRY(list_all(e, err));
    bound_all(e);
    qsort(e->list, (size_t)e->n, sizeof *e->list, by_bound);
    e->looks = d->mixed && d->c->search.max_evaluations <= 0;
    if (!e->looks) {
        return MT_OK;
    }
    double *const x = mt_arena_f64(d->mem, n, BATCH_MIXED);
    e->proofs = mt_arena_alloc(d->mem, n_workers, sizeof *e->proofs);
    MT_TRY(mt_arena_check(d->mem, err));
    for (size_t i = 0; i < BATCH_MIXED; i++) {
        e->at[i].x = x + (i * n);
    }
    for (size_t i = 0; i < n_workers; i++) {
        MT_TRY(mt_catalogue_search_proofs_init(&e->proofs[i], d->c, d->mem, err));
    }
    return MT_OK;
}

/* No design with a first objective above this one is listed. */
static double cap_of(const enumeration *e)
{
    return e->last + (EQUAL * fabs(e->last));
}

static mt_status look_at(void *context, int worker, int task, mt_task_path *own, mt_err *err)
{
    (void)own;
    enumeration *const e = context;
    const mt_catalogue_search *const d = e->d;
    const bool capped = e->last < HUGE_VAL && e->caps[worker].known;
    double *const lower = e->bounds + ((ptrdiff_t)worker * 2 * d->p->n);
    double *const upper = lower + d->p->n;
    mt_arena mem;
    MT_TRY(mt_arena_init(&mem, 0, err));
    e->caps[worker].cap.below = cap_of(e);
    find_bounds(d, &e->list[e->first + task], lower, upper);
    const mt_status rc = mt_catalogue_search_look_at(&e->proofs[worker], lower, upper,
                                                     capped ? &e->caps[worker].cap : NULL, LOOK,
                                                     &mem, &e->at[task], err);
    mt_arena_free(&mem);
    return rc;
}

static void serialize_look(void *context, int task, mt_serializer *serializer)
{
    enumeration *const e = context;
    mt_catalogue_search_look_serialize(e->d->c, &e->at[task], serializer);
}

/* The design that a certificate met, as a start. */
static mt_status start_from(const mt_catalogue_search *d, const double *x, mt_combination *c,
                            mt_err *err)
{
    double *const from = mt_arena_f64(d->mem, (size_t)d->p->n + 1, 1);
    MT_TRY(mt_arena_check(d->mem, err));
    for (int i = 0; i < d->p->n; i++) {
        from[i] = mt_problem_t(d->p, i, x[i]);
    }
    c->from = from;
    return MT_OK;
}

/* Excludes of the next *n combinations what a certificate can: those that are left come first,
 * *n of them. */
static mt_status exclude(enumeration *e, int first, int *n, mt_err *err)
{
    mt_catalogue_search *const d = e->d;
    const mt_tasks tasks = {*n, look_at, serialize_look, e, "boxes of combinations"};
    int left = 0;
    e->first = first;
    for (int i = 0; i < *n; i++) {
        e->at[i] = (mt_catalogue_search_look){.x = e->at[i].x};
    }
    MT_TRY(mt_workers_run(d->n_workers, d->workers[0]->task_path, &tasks, err));
    for (int i = 0; i < *n; i++) {
        mt_combination *const c = &e->list[first + i];
        const mt_catalogue_search_look *const look = &e->at[i];
        e->work += (double)look->work;
        mt_work_counters_note(d->p->run->work, MT_WORK_MULTIPLICATIONS, look->multiplications);
        if (look->met) {
            MT_TRY(start_from(d, look->x, c, err));
        }
        if (look->excluded) {
            e->report->excluded++;
            e->report->beyond = fmin(e->report->beyond, e->last);
            continue;
        }
        const mt_combination kept = *c;
        *c = e->list[first + left];
        e->list[first + left++] = kept;
    }
    *n = left;
    e->looks = e->work < PART * d->c->proof_work;
    return MT_OK;
}

/* Number of the next n combinations that the budget allows, besides the verification of those
 * that might rank; *share: evaluations for each, 0: no limit. */
static int affordable(const enumeration *e, int n, long *share)
{
    const mt_catalogue_search *const d = e->d;
    const long most = d->c->search.max_evaluations;
    const long kept = e->ranking->most * mt_catalogue_search_verdict(d);
    const long left = most - d->evals - (kept < most / 2 ? kept : most / 2);
    const long least = d->mixed ? LEAST_BUDGET : 1;
    *share = 0;
    if (most <= 0) {
        return n;
    }
    n = left / least < n ? (int)(left > 0 ? left / least : 0) : n;
    *share = n > 0 ? left / n : 0;
    return n;
}

/* True where no combination from `next` on can be among the designs asked for. */
static bool is_settled(const enumeration *e, const mt_combination *next)
{
    return e->last < HUGE_VAL && next->least > cap_of(e);
}

/* Judges n combinations, and ranks them. */
static mt_status judge(enumeration *e, int first, int n, long share, mt_err *err)
{
    const ranking_of_combinations *const r = e->ranking;
    mt_combination **const all = mt_arena_alloc(e->d->mem, (size_t)n, sizeof(mt_combination *));
    MT_TRY(mt_arena_check(e->d->mem, err));
    for (int i = 0; i < n; i++) {
        all[i] = &e->list[first + i];
    }
    MT_TRY(mt_catalogue_search_verify(e->d, n, e->list + first, share, err));
    MT_TRY(rank_combinations(e->d, all, n, e->ranking, err));
    e->last = r->n >= e->asked && r->best[e->asked - 1]->feasible ? r->best[e->asked - 1]->f[0]
                                                                  : HUGE_VAL;
    return MT_OK;
}

static mt_status judge_all(enumeration *e, mt_err *err)
{
    mt_catalogue_search *const d = e->d;
    const int batch = d->mixed ? BATCH_MIXED : BATCH;
    for (int first = 0; first < e->n && d->stop != MT_STOP_USER; first += batch) {
        const int size = e->n - first < batch ? e->n - first : batch;
        long share = 0;
        int now = affordable(e, size, &share);
        const bool spent = now < size;
        if (is_settled(e, &e->list[first])) {
            e->report->beyond = fmin(e->report->beyond, e->list[first].least);
            break;
        }
        MT_TRY(e->looks ? exclude(e, first, &now, err) : MT_OK);
        MT_TRY(judge(e, first, now, share, err));
        if (spent) {
            d->stop = d->stop == MT_STOP_USER ? MT_STOP_USER : MT_STOP_MAX_EVALS;
            break;
        }
    }
    return MT_OK;
}

static int by_exclusion(const void *a, const void *b)
{
    const mt_combination *const x = a;
    const mt_combination *const y = b;
    return x->judged != y->judged ? (x->judged ? -1 : 1) : by_bound(a, b);
}

/* Searches for the nearest misses among what was excluded, where none meets all goals. */
static mt_status judge_excluded(enumeration *e, mt_err *err)
{
    const ranking_of_combinations *const r = e->ranking;
    const int excluded = e->report->excluded;
    if (excluded == 0 || (r->n > 0 && r->best[0]->feasible) || e->d->n_broken > 0) {
        return MT_OK;
    }
    qsort(e->list, (size_t)e->n, sizeof *e->list, by_exclusion);
    e->ranking->n = 0; /* what it has stands in the list */
    e->report->excluded = 0;
    e->report->beyond = HUGE_VAL;
    for (int k = 0; k < excluded && e->d->stop != MT_STOP_USER; k += BATCH_MIXED) {
        const int n = excluded - k < BATCH_MIXED ? excluded - k : BATCH_MIXED;
        MT_TRY(mt_catalogue_search_verify(e->d, n, e->list + e->n - excluded + k, 0, err));
    }
    return MT_OK;
}

static mt_status enumerate(enumeration *e, mt_combination ***all, mt_err *err)
{
    mt_catalogue_search *const d = e->d;
    MT_TRY(begin(e, err));
    MT_TRY(judge_all(e, err));
    MT_TRY(d->stop == MT_STOP_DONE ? judge_excluded(e, err) : MT_OK);
    *all = mt_arena_alloc(d->mem, (size_t)e->n, sizeof(mt_combination *));
    MT_TRY(mt_arena_check(d->mem, err));
    for (int i = 0; i < e->n; i++) {
        (*all)[i] = &e->list[i];
    }
    qsort(*all, (size_t)e->n, sizeof(mt_combination *), by_place);
    e->report->all = d->stop == MT_STOP_DONE;
    return MT_OK;
}

/* Judges the n combinations, best first, until no other can be among the designs asked for.
 * (*all)[n]: all of them, in the order in which equal ones are listed; sets all, excluded and
 * beyond of the report. */
static mt_status enumerate_combinations(mt_catalogue_search *d, int n,
                                        ranking_of_combinations *ranking,
                                        mt_catalogue_search_report *report,
                                        mt_combination ***all, mt_err *err)
{
    enumeration e = {.d = d,
                     .ranking = ranking,
                     .report = report,
                     .n = n,
                     .asked = d->p->study->recommendations,
                     .last = HUGE_VAL};
    const mt_status rc = enumerate(&e, all, err);
    for (int i = 0; i < d->n_workers && e.proofs != NULL; i++) {
        mt_catalogue_search_proofs_free(&e.proofs[i]);
    }
    return rc;
}

/* In the form of any other search: no multipliers, a bound only where a continuous variable
 * stands at one. */
static mt_status to_solution(const mt_catalogue_search *d, const mt_combination *c,
                             mt_nlp_solution *out, mt_err *err)
{
    const mt_problem *const p = d->p;
    const size_t n = (size_t)p->n + 1;
    *out = (mt_nlp_solution){.t = c->t,
                             .f = c->f[0],
                             .violation = c->missed.violation,
                             .squares = c->missed.squares,
                             .feasible = c->feasible,
                             .singular = c->singular,
                             .kkt = c->kkt,
                             .bound = mt_arena_int(d->mem, n),
                             .mult_eq = mt_arena_f64(d->mem, (size_t)d->c->rows.eq.n, 1),
                             .mult_in = mt_arena_f64(d->mem, (size_t)d->c->rows.in.n + 1, 1),
                             .mult_bound = mt_arena_f64(d->mem, n, 1)};
    MT_TRY(mt_arena_check(d->mem, err));
    for (int i = 0; i < d->c->rows.eq.n; i++) {
        out->mult_eq[i] = nan("");
    }
    for (int i = 0; i < d->c->rows.in.n; i++) {
        out->mult_in[i] = nan("");
    }
    for (int i = 0; i < p->n; i++) {
        const bool discrete = p->study->variables[i].n_catalogue > 0;
        out->mult_bound[i] = nan("");
        out->bound[i] = discrete                      ? 0
                        : c->t[i] == d->c->lower_t[i] ? -1
                        : c->t[i] == d->c->upper_t[i] ? 1
                                                      : 0;
    }
    return MT_OK;
}

static mt_status collect_combinations(const mt_catalogue_search *d,
                                      const ranking_of_combinations *r, mt_nlp_result *out,
                                      mt_err *err)
{
    *out = (mt_nlp_result){
        .evals = d->evals, .starts = d->starts, .stop = d->stop, .steps = d->steps};
    out->solutions = mt_arena_alloc(d->mem, (size_t)r->n, sizeof *out->solutions);
    MT_TRY(mt_arena_check(d->mem, err));
    out->compromise = r->n > 0 && !r->best[0]->feasible;
    for (int i = 0; i < r->n && r->best[i]->feasible != out->compromise; i++) {
        MT_TRY(to_solution(d, r->best[i], &out->solutions[i], err));
        out->n_solutions++;
    }
    return MT_OK;
}

/* Where none satisfies its limits between the positions, those that satisfy them at the named
 * ones count as feasible. */
static bool take_broken(const ranking_of_combinations *r, mt_combination *const *all, int n)
{
    bool any = false;
    const bool none = r->n == 0 || !r->best[0]->feasible;
    for (int i = 0; i < n && none; i++) {
        any = any || all[i]->broken;
        all[i]->feasible = all[i]->feasible || all[i]->broken;
    }
    return any;
}

/* An interrupt ends a part of the search, and what was found before it stands. */
static mt_status unless_interrupted(mt_catalogue_search *d, mt_status rc)
{
    d->stop = rc == MT_E_INTERRUPTED ? MT_STOP_USER : d->stop;
    return rc == MT_E_INTERRUPTED ? MT_OK : rc;
}

mt_status mt_catalogue_search_solve(mt_workspace *const *workers, int n_workers, mt_arena *mem,
                                    mt_nlp_result *out, mt_catalogue_search_report *report,
                                    mt_err *err)
{
    mt_catalogue_search d = {.workers = workers,
                             .n_workers = n_workers,
                             .p = workers[0]->p,
                             .c = workers[0]->c,
                             .mem = mem};
    MT_TRY(list_catalogue_variables(&d, err));
    const int asked = d.p->study->recommendations;
    ranking_of_combinations r = {.most = asked > KEPT ? asked : KEPT};
    r.best = mt_arena_alloc(mem, (size_t)r.most, sizeof(mt_combination *));
    MT_TRY(mt_arena_check(mem, err));
    double n = 1.0;
    for (int k = 0; k < d.n_listed; k++) {
        n *= (double)d.p->study->variables[d.variable[k]].n_catalogue;
    }
    mt_combination **all = NULL;
    int n_all = 0;
    *report = (mt_catalogue_search_report){
        .mixed = d.mixed, .combinations = n, .beyond = HUGE_VAL, .best_within = nan("")};
    if (n > (double)(d.mixed ? MT_CATALOGUE_SEARCH_MOST_MIXED : MT_CATALOGUE_SEARCH_MOST)) {
        MT_TRY(mt_catalogue_search_near(&d, &all, &n_all, err));
        if (d.mixed && d.stop == MT_STOP_DONE) {
            MT_TRY(unless_interrupted(
                &d, mt_catalogue_search_branch(&d, &all, &n_all, report, err)));
        }
    } else {
        n_all = (int)n;
        MT_TRY(enumerate_combinations(&d, n_all, &r, report, &all, err));
    }
    if ((d.mixed || !report->all) && d.stop != MT_STOP_USER) {
        MT_TRY(
            unless_interrupted(&d, mt_catalogue_search_prove(&d, &all, &n_all, report, err)));
    }
    if (all == NULL) {
        return mt_fail_memory(err);
    }
    r.n = 0;
    MT_TRY(rank_combinations(&d, all, n_all, &r, err));
    report->broken = take_broken(&r, all, n_all);
    if (report->broken) {
        r.n = 0;
        MT_TRY(rank_combinations(&d, all, n_all, &r, err));
    }
    MT_TRY(mt_catalogue_search_settle(&d, r.n < asked ? r.n : asked, r.best, err));
    for (int i = 0; i < n_all; i++) {
        report->judged += all[i]->judged ? 1 : 0;
        report->feasible += all[i]->feasible ? 1 : 0;
        report->followed += all[i]->followed && all[i]->feasible ? 1 : 0;
    }
    report->beyond = isfinite(report->beyond)
                         ? mt_objective_stage_shown(&d.p->stages[0], report->beyond)
                         : report->beyond;
    report->driven = (mt_drive_positions_any(d.p) || mt_search_has_positions(d.c)) && !d.mixed;
    MT_TRY(collect_combinations(&d, &r, out, err));
    const bool known = r.n > 0 && r.best[0]->feasible && d.stop != MT_STOP_USER;
    return known ? unless_interrupted(
                       &d, mt_catalogue_search_unidentifiable(&d, r.best[0], out, err))
                 : MT_OK;
}
