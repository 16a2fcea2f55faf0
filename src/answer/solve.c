/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A study answered in phases. Each may be cut by the caller's wish to stop. Which ones were is
 * told by the interrupt itself, which every unit of work passes (base/interrupt.h): no phase
 * hands it up, so none can forget to. What a phase that was cut has written is taken back, and
 * those that need what it would have found are not begun.
 */
#include "answer/solve_priv.h"

#include <math.h>

#include "answer/doubts.h"
#include "answer/spread.h"
#include "answer/trade.h"
#include "base/options.h"
#include "base/workers.h"
#include "describe/certificates.h"
#include "describe/describe_discrete.h"
#include "describe/describe_relax.h"
#include "search/search.h"

static mt_status describe_solutions(mt_answer *a, mt_err *err)
{
    const mt_nlp_result *const found = &a->found;
    mt_result *const result = a->result;
    const bool discrete = mt_study_is_discrete(a->study);
    const bool kinds = a->gaps.n_solutions > 0;
    const int most = a->study->recommendations;
    const int n = found->n_solutions < most ? found->n_solutions : most;
    result->recommendations =
        mt_arena_alloc(&result->mem, (size_t)n, sizeof *result->recommendations);
    MT_TRY(mt_arena_check(&result->mem, err));
    MT_TRY(mt_describe_undetermined(a->p, found, result, err));
    for (int i = 0; i < n; i++) {
        a->mark = mt_result_get_mark(result);
        const mt_design design = {.t = found->solutions[i].t,
                                  .found = &found->solutions[i],
                                  .stage = a->stage,
                                  .rank = i + 1,
                                  .cut = mt_interrupt_is_cut(&a->interrupt, MT_PHASE_SEARCH),
                                  .discrete = discrete ? &a->discrete : NULL,
                                  .gaps = kinds ? &a->gaps : NULL,
                                  .below = kinds ? a->gaps.solutions[i].below : NULL};
        mt_recommendation *const rec = &result->recommendations[i];
        MT_TRY(mt_describe_design(a->p, &design, &result->baseline, result, rec, err));
        MT_TRY(mt_describe_reasons(a->p, &design, found, result, rec, err));
        if (mt_interrupt_is_cut(&a->interrupt, MT_PHASE_RECOMMENDATIONS)) {
            return MT_OK;
        }
        result->n_recommendations++;
    }
    a->mark = mt_result_get_mark(result);
    if (found->n_solutions > n) {
        MT_TRY(mt_describe_warn(result, err,
                                "%d more distinct designs were found; \"recommendations\" in "
                                "the study says how many to report",
                                found->n_solutions - n));
    }
    return MT_OK;
}

/* The values of designs that there was no time to analyse anew: hours of search may be in
 * them. */
static mt_status tell_undescribed(const mt_answer *a, mt_err *err)
{
    mt_arena *const mem = &a->result->mem;
    const mt_problem *const p = a->p;
    double *const x = mt_arena_f64(mem, (size_t)p->n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = a->result->n_recommendations;
         i < a->found.n_solutions && i < a->study->recommendations; i++) {
        const char *text = "";
        mt_case_x(&a->asked, a->found.solutions[i].t, x);
        for (int k = 0; k < p->n && text != NULL; k++) {
            text = mt_arena_printf(mem, "%s%s%s = %.17g", text, k > 0 ? ", " : "",
                                   p->study->variables[k].parameter_name.s, x[k]);
        }
        MT_TRY(text == NULL ? mt_fail_memory(err)
                            : mt_describe_warn(a->result, err,
                                               "interrupted before design %d of the search was "
                                               "analysed anew, nothing is verified of it: %s",
                                               i + 1, text));
    }
    return MT_OK;
}

/* The search over gap assignments, its solutions in the form of any other search. */
static mt_status search_gaps(mt_answer *a, mt_err *err)
{
    mt_gap_result *const g = &a->gaps;
    MT_TRY(mt_gaps_solve(a->workers, a->n_workers, &a->mem, g, err));
    a->found.solutions =
        mt_arena_alloc(&a->mem, (size_t)g->n_solutions, sizeof *a->found.solutions);
    MT_TRY(mt_arena_check(&a->mem, err));
    for (int i = 0; i < g->n_solutions; i++) {
        a->found.solutions[i] = *g->solutions[i].found;
    }
    a->found.n_solutions = g->n_solutions;
    a->found.compromise = g->compromise;
    a->found.n_undetermined = g->n_undetermined;
    a->found.undetermined = g->undetermined;
    a->found.undetermined_effect = g->undetermined_effect;
    a->stage = g->stage;
    a->found.evals = g->evals;
    a->found.starts = g->starts;
    a->found.stop = g->stop;
    return MT_OK;
}

static mt_status search(mt_answer *a, mt_err *err)
{
    if (mt_study_is_discrete(a->study)) {
        return mt_discrete_solve(a->workers, a->n_workers, &a->mem, &a->found, &a->discrete,
                                 err);
    }
    if (a->p->n_clears > 0) {
        return search_gaps(a, err);
    }
    MT_TRY(mt_search_designs(a->workers, a->n_workers, &a->mem, &a->found, &a->stage, &a->why,
                             err));
    a->result->run.distinct_designs = a->found.compromise ? 0 : a->found.n_found;
    a->result->run.found_once = a->found.compromise ? 0 : a->found.n_once;
    a->result->run.estimated_missing = a->found.missing;
    return MT_OK;
}

/* Of a search that was cut nothing counts but the designs that it met: they are judged anew. */
static void keep_designs_alone(mt_answer *a)
{
    a->found.stop = MT_STOP_USER;
    a->found.n_undetermined = 0;
    a->found.n_once = 0;
    a->found.missing = nan("");
    a->why = (mt_err){.code = MT_OK};
    a->result->run.distinct_designs = -1;
    a->result->run.found_once = -1;
    a->result->run.estimated_missing = nan("");
}

static mt_status spread(mt_answer *a, mt_err *err)
{
    return a->result->n_recommendations == 0
               ? MT_OK
               : mt_spread_solve(a->workers[0], &a->found.solutions[0], &a->mem,
                                 &a->found.evals, a->result, err);
}

static mt_status certify(mt_answer *a, mt_err *err)
{
    if (mt_study_is_discrete(a->study)) {
        return mt_describe_discrete_certificate(&a->discrete, &a->found, a->result,
                                                &a->infeasible, err);
    }
    if (a->p->n_clears > 0) {
        return mt_describe_gap_certificate(&a->gaps, a->result, &a->infeasible, err);
    }
    if (!a->found.compromise) {
        return MT_OK;
    }
    MT_TRY(mt_describe_limit_certificates(a->p, &a->mem, a->result, &a->infeasible, err));
    a->impossible = a->infeasible;
    /* exact targets are answered by the nearest design, also where it is proven that they
     * cannot be met */
    a->infeasible = a->infeasible && a->p->n_eq == 0;
    return MT_OK;
}

/* What would let a design exist, where none was found. */
static mt_status relax(mt_answer *a, mt_err *err)
{
    mt_moves moves = {0};
    if (!a->infeasible && !a->impossible && !a->found.compromise) {
        return MT_OK;
    }
    MT_TRY(mt_study_is_discrete(a->study)
               ? mt_relax_discrete(a->workers, a->n_workers, &a->found, &a->mem, &moves, err)
               : mt_relax(a->workers, a->n_workers, &a->found, &a->mem, &moves, err));
    a->found.evals += moves.evals;
    a->found.starts += moves.starts;
    if (moves.short_of_budget && a->found.stop != MT_STOP_MAX_EVALS) {
        return mt_describe_warn(a->result, err,
                                "which single change would let a design exist is not known: "
                                "there are too many combinations, or \"max_evaluations\" left "
                                "nothing for it");
    }
    return mt_describe_relaxations(a->p, &moves, a->result, err);
}

static mt_status publish(mt_answer *a, mt_err *err)
{
    double *const x = mt_arena_f64(&a->mem, (size_t)a->p->n, 1);
    const bool recommended = a->result->n_recommendations > 0;
    MT_TRY(mt_arena_check(&a->mem, err));
    if (recommended) {
        mt_case_x(&a->asked, a->found.solutions[0].t, x);
    }
    return mt_describe_published(a->workers[0], a->p->original, recommended ? x : NULL,
                                 a->result, err);
}

/* Does the study ask for what this phase writes? */
static bool is_asked(const mt_answer *a, mt_phase which)
{
    switch (which) {
    case MT_PHASE_SPREAD:
        return a->searched && mt_spread_is_asked(a->p);
    case MT_PHASE_PUBLISHED:
        return a->study->n_published > 0;
    case MT_PHASE_TRADE:
        return a->study->trade.n_vary > 0;
    case MT_PHASE_SEARCH:
    case MT_PHASE_RECOMMENDATIONS:
    case MT_PHASE_CERTIFICATES:
    case MT_PHASE_RELAXATIONS:
        return a->searched;
    case MT_PHASE_BASELINE:
    case MT_PHASE_COUNT:
        break;
    }
    return true;
}

/* Would the phase speak of what is not known: of a search that was cut, or of a recommendation
 * that it did not find? */
static bool is_groundless(const mt_answer *a, mt_phase which)
{
    const mt_interrupt *const i = &a->interrupt;
    const bool cut = mt_interrupt_is_cut(i, MT_PHASE_SEARCH) ||
                     mt_interrupt_is_cut(i, MT_PHASE_RECOMMENDATIONS);
    if (which == MT_PHASE_RECOMMENDATIONS) {
        return false;
    }
    if (which == MT_PHASE_PUBLISHED) {
        return cut && a->result->n_recommendations == 0;
    }
    return cut || (which == MT_PHASE_TRADE && mt_interrupt_any(i));
}

/* An error that an interrupt is the reason of is none; shortage of memory and our own errors
 * are. */
static bool is_due_to_cut(mt_status rc)
{
    return rc != MT_E_MEMORY && rc != MT_E_INTERNAL;
}

typedef mt_status (*phase_work)(mt_answer *a, mt_err *err);

static mt_status phase(mt_answer *a, mt_phase which, phase_work work, mt_err *err)
{
#define MT_PHASE_READY(id, name, makes_ready) makes_ready,
    static const bool makes_ready[] = {MT_PHASE_LIST(MT_PHASE_READY)};
#undef MT_PHASE_READY
    mt_err own = {.code = MT_OK};
    if (!is_asked(a, which)) {
        return MT_OK;
    }
    if (is_groundless(a, which)) {
        mt_interrupt_cut(&a->interrupt, (int)which);
        return MT_OK;
    }
    a->mark = mt_result_get_mark(a->result);
    mt_interrupt_enter(&a->interrupt, (int)which, makes_ready[which]);
    const mt_status rc = work(a, &own);
    const bool cut = mt_interrupt_is_cut(&a->interrupt, (int)which);
    if (rc != MT_OK && !(cut && is_due_to_cut(rc))) {
        return mt_fail(err, rc, "%s", own.text);
    }
    if (cut) {
        mt_result_take_back(a->result, &a->mark);
    }
    return MT_OK;
}

/* A list that a phase did not get to is NULL, one that it found nothing for is empty. */
static void *kept(const mt_answer *a, mt_phase which, void *list, int n)
{
    const bool cut = mt_interrupt_is_cut(&a->interrupt, (int)which);
    if (list == NULL && !cut) {
        return mt_arena_alloc(&a->result->mem, 0, 1);
    }
    return n == 0 && cut ? NULL : list;
}

static mt_status tell_cut_lists(mt_answer *a, mt_err *err)
{
    mt_result *const r = a->result;
    r->undetermined = kept(a, MT_PHASE_SEARCH, r->undetermined, r->n_undetermined);
    r->spread = kept(a, MT_PHASE_SPREAD, r->spread, r->n_spread);
    r->certificates = kept(a, MT_PHASE_CERTIFICATES, r->certificates, r->n_certificates);
    r->relaxations = kept(a, MT_PHASE_RELAXATIONS, r->relaxations, r->n_relaxations);
    r->published = kept(a, MT_PHASE_PUBLISHED, r->published, r->n_published);
    return mt_arena_check(&r->mem, err);
}

/* What of the proofs is left where they were cut: nothing. */
static mt_status certify_whole(mt_answer *a, mt_err *err)
{
    MT_TRY(phase(a, MT_PHASE_CERTIFICATES, certify, err));
    if (mt_interrupt_is_cut(&a->interrupt, MT_PHASE_CERTIFICATES)) {
        a->infeasible = false;
        a->impossible = false;
    }
    return mt_describe_is_doubted(a->result) ? mt_describe_withdraw(a->result, err) : MT_OK;
}

/* The caller's design as one more start of every search. */
static mt_status take_hint(mt_answer *a, const double *hint, mt_err *err)
{
    const mt_problem *const p = a->p;
    double *const t = mt_arena_f64(&a->mem, (size_t)p->n + 1, 1);
    MT_TRY(mt_arena_check(&a->mem, err));
    for (int i = 0; i < p->n; i++) {
        t[i] = mt_problem_t(p, i, hint[i]); /* the search brings it within the bounds */
    }
    a->asked.hint = t;
    return MT_OK;
}

static mt_status fill(mt_answer *a, const mt_solve_options *opt, mt_err *err)
{
    const mt_problem *const p = a->p;
    mt_result *const result = a->result;
    a->workers[0]->progress = opt->progress; /* the first worker's: one line at a time */
    a->workers[0]->progress_context = opt->progress_context;
    a->searched = p->n > 0 && (p->n_demands > 0 || p->n_clears > 0);
    if (opt->hint != NULL) {
        MT_TRY(take_hint(a, opt->hint, err));
    }
    MT_TRY(phase(a, MT_PHASE_SEARCH, search, err));
    if (mt_interrupt_is_cut(&a->interrupt, MT_PHASE_SEARCH)) {
        keep_designs_alone(a);
    }
    MT_TRY(phase(a, MT_PHASE_RECOMMENDATIONS, describe_solutions, err));
    if (mt_interrupt_is_cut(&a->interrupt, MT_PHASE_RECOMMENDATIONS)) {
        MT_TRY(tell_undescribed(a, err));
    }
    MT_TRY(phase(a, MT_PHASE_SPREAD, spread, err));
    MT_TRY(certify_whole(a, err));
    MT_TRY(phase(a, MT_PHASE_RELAXATIONS, relax, err));
    MT_TRY(mt_answer_warn(a, err));
    result->run.evaluations = a->found.evals;
    result->run.starts = a->found.starts;
    MT_TRY(mt_answer_set_status(a, err));
    MT_TRY(phase(a, MT_PHASE_PUBLISHED, publish, err));
    MT_TRY(tell_cut_lists(a, err));
    return mt_describe_own(a->study, result, err);
}

/* The original design, without which there is nothing to tell. */
static mt_status describe_baseline(mt_answer *a, mt_err *err)
{
    const mt_problem *const p = a->p;
    mt_result *const result = a->result;
    const mt_design original = {.t = p->whole.origin_t};
    MT_TRY(mt_describe_run(a->study, result, err));
    MT_TRY(mt_describe_excitations(a->study, result, err));
    if (!a->study->examined) {
        mt_doubt_list list = mt_doubt_list_default(&result->mem);
        MT_TRY(mt_study_examine(a->study, HUGE_VAL, &list, err));
        MT_TRY(mt_result_take_doubts(result, &list, err));
    }
    MT_TRY(mt_describe_design(p, &original, NULL, result, &result->baseline, err));
    return mt_describe_baseline_reasons(p, result, err);
}

/* One problem, and a workspace for each worker. */
static mt_status open_problem(mt_answer *a, mt_err *err)
{
    const bool alone = a->threads < 1 || a->study->n_variables == 0;
    const int n = alone ? 1 : a->threads < MT_WORKERS_MOST ? a->threads : MT_WORKERS_MOST;
    MT_TRY(mt_problem_new(a->study, &a->p, err));
    a->asked = a->p->whole;
    a->workers = mt_arena_alloc(&a->mem, (size_t)n, sizeof(mt_workspace *));
    MT_TRY(mt_arena_check(&a->mem, err));
    for (int i = 0; i < n; i++) {
        MT_TRY(mt_workspace_new(a->p, &a->workers[i], err));
        mt_workspace_back(a->workers[i], &a->asked);
        a->n_workers = i + 1;
    }
    return MT_OK;
}

static mt_status begin(mt_answer *a, mt_err *err)
{
    mt_err own = {.code = MT_OK};
    mt_interrupt_enter(&a->interrupt, MT_PHASE_BASELINE, true);
    mt_status rc = open_problem(a, &own);
    rc = rc == MT_OK ? describe_baseline(a, &own) : rc;
    if (mt_interrupt_is_cut(&a->interrupt, MT_PHASE_BASELINE) && is_due_to_cut(rc)) {
        return mt_fail(err, MT_E_INTERRUPTED,
                       "interrupted before the original design was analysed");
    }
    return rc == MT_OK ? MT_OK : mt_fail(err, rc, "%s", own.text);
}

/* The question, asked of a model that knows the interrupt. */
static mt_status ask(mt_answer *a, const mt_study *study, const mt_solve_options *opt,
                     mt_err *err)
{
    const size_t n = (size_t)study->n_references;
    mt_interrupt_init(&a->interrupt, opt->stop, opt->stop_context, study->model->interrupt);
    a->own_model = *study->model;
    a->own_model.interrupt = &a->interrupt;
    a->own_study = *study;
    a->own_study.model = &a->own_model;
    a->own_study.references = mt_arena_alloc(&a->mem, n, sizeof *study->references);
    a->study = &a->own_study;
    MT_TRY(mt_arena_check(&a->mem, err));
    for (size_t i = 0; i < n; i++) {
        mt_reference *const r = &a->own_study.references[i];
        *r = study->references[i];
        r->model = r->model == study->model ? &a->own_model : r->model;
    }
    return MT_OK;
}

static mt_status trade(mt_answer *a, mt_err *err)
{
    MT_TRY(mt_trade_solve(a->study, a->threads, a->result, err));
    mt_answer_qualify_trade(a->result);
    return MT_OK;
}

mt_status mt_study_solve(const mt_study *study, const mt_solve_options *opt, mt_result **out,
                         mt_err *err)
{
    mt_solve_options use;
    MT_NOT_NULL(out, err);
    *out = NULL;
    MT_NOT_NULL(study, err);
    MT_TRY(MT_OPTIONS_TAKE(opt, &use, err));
    mt_answer a = {.threads = use.threads};
    for (int i = 0; use.hint != NULL && i < study->n_variables; i++) {
        if (!isfinite(use.hint[i])) {
            return mt_fail(err, MT_E_USAGE, "mt_study_solve: hint[%d] is not finite", i);
        }
    }
    mt_status rc = mt_arena_init(&a.mem, 0, err);
    rc = rc == MT_OK ? mt_result_new(&a.result, err) : rc;
    rc = rc == MT_OK ? ask(&a, study, &use, err) : rc;
    rc = rc == MT_OK ? begin(&a, err) : rc;
    rc = rc == MT_OK ? fill(&a, &use, err) : rc;
    rc = rc == MT_OK ? phase(&a, MT_PHASE_TRADE, trade, err) : rc;
    rc = rc == MT_OK ? mt_answer_note_cuts(&a, err) : rc;
    for (int i = 0; i < a.n_workers; i++) {
        mt_workspace_delete(a.workers[i]);
    }
    mt_problem_delete(a.p);
    mt_arena_free(&a.mem);
    if (rc != MT_OK) {
        mt_result_delete(a.result);
        return rc;
    }
    *out = a.result;
    return MT_OK;
}
