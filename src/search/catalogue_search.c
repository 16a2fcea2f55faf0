/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "search/catalogue_search.h"

#include <math.h>
#include <string.h>

#include "problem/drive_positions.h"
#include "problem/objective.h"
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

/* By insertion, so that equal ones keep their order. */
mt_status mt_catalogue_search_rank(mt_catalogue_search *d, mt_combination *const *list, int n,
                                   mt_combination_ranking *r, mt_err *err)
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
                                      const mt_combination_ranking *r, mt_nlp_result *out,
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
static bool take_broken(const mt_combination_ranking *r, mt_combination *const *all, int n)
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
    mt_combination_ranking r = {.most = asked > KEPT ? asked : KEPT};
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
        MT_TRY(mt_catalogue_search_enumerate(&d, n_all, &r, report, &all, err));
    }
    if ((d.mixed || !report->all) && d.stop != MT_STOP_USER) {
        MT_TRY(
            unless_interrupted(&d, mt_catalogue_search_prove(&d, &all, &n_all, report, err)));
    }
    if (all == NULL) {
        return mt_fail_memory(err);
    }
    r.n = 0;
    MT_TRY(mt_catalogue_search_rank(&d, all, n_all, &r, err));
    report->broken = take_broken(&r, all, n_all);
    if (report->broken) {
        r.n = 0;
        MT_TRY(mt_catalogue_search_rank(&d, all, n_all, &r, err));
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
