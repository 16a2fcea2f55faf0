/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tune/solve.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "base/workers.h"
#include "tune/describe.h"
#include "tune/discrete.h"
#include "tune/doubts.h"
#include "tune/gaps.h"
#include "tune/relax.h"
#include "tune/search.h"
#include "tune/trade.h"

mt_solve_options mt_solve_options_default(void)
{
    const mt_solve_options opt = {.threads = 1};
    return opt;
}

/* One study being answered. */
typedef struct answer {
    const mt_study *study;
    mt_problem *p;        /* workers[0] */
    mt_problem **workers; /* [n_workers] owned */
    int n_workers;
    mt_result *result;
    mt_arena mem;
    mt_reference_cache references;
    mt_nlp_result found;
    mt_gap_result gaps;          /* where there are bands: found is made from it */
    mt_discrete_report discrete; /* where there are catalogues: what the search did */
    int stage;                   /* of found */
    mt_err why;                  /* no start of the search had a value */
    bool searched;
    bool infeasible; /* proven, and no compromise is asked for */
    bool impossible; /* proven that no design meets all goals */
} answer;

static mt_status describe_solutions(answer *a, mt_err *err)
{
    const mt_nlp_result *const found = &a->found;
    mt_result *const result = a->result;
    const bool discrete = mt_study_is_discrete(a->study);
    const bool kinds = a->gaps.n_solutions > 0;
    const int most = a->study->recommendations;
    const int n = found->n_solutions < most ? found->n_solutions : most;
    result->recommendations =
        mt_arena_alloc(&result->mem, (size_t)n, sizeof *result->recommendations);
    if (result->recommendations == NULL) {
        return mt_fail_memory(err);
    }
    MT_TRY(mt_describe_undetermined(a->p, found, result, err));
    for (int i = 0; i < n; i++) {
        const mt_design design = {.t = found->solutions[i].t,
                                  .found = &found->solutions[i],
                                  .stage = a->stage,
                                  .rank = i + 1,
                                  .discrete = discrete ? &a->discrete : NULL,
                                  .gaps = kinds ? &a->gaps : NULL,
                                  .below = kinds ? a->gaps.solutions[i].below : NULL};
        mt_recommendation *const rec = &result->recommendations[i];
        MT_TRY(mt_describe_design(a->p, &design, &result->baseline, result, rec, err));
        MT_TRY(mt_describe_reasons(a->p, &design, found, result, rec, err));
        result->n_recommendations++;
    }
    if (found->n_solutions > n) {
        MT_TRY(mt_describe_warn(result, err,
                                "%d more distinct designs were found; \"recommendations\" in "
                                "the study says how many to report",
                                found->n_solutions - n));
    }
    return MT_OK;
}

/* Isolated designs that no start met are to be expected where some were met once only. */
static mt_status warn_of_missing(const answer *a, mt_err *err)
{
    const mt_nlp_result *const f = &a->found;
    if (!MT_HAS(a->result->run.estimated_missing) || f->n_once == 0) {
        return MT_OK;
    }
    const bool some = f->missing >= 1.0;
    char more[48] = "there may be more";
    if (some) {
        (void)mt_snprintf(more, sizeof more, "about %.0f more, at least, are to be expected",
                          f->missing);
    }
    return mt_describe_warn(a->result, err,
                            "%d of the %d designs found %s met by one of %d starts only: %s; "
                            "more \"starts\" or \"max_evaluations\" may find them",
                            f->n_once, f->n_found, f->n_once == 1 ? "was" : "were", f->starts,
                            more);
}

static mt_status warn_of_continua(const answer *a, mt_err *err)
{
    for (int i = 0; i < a->result->n_recommendations; i++) {
        if (a->found.solutions[i].continuum) {
            MT_TRY(mt_describe_warn(a->result, err,
                                    "recommendation %d: a continuum of designs is as good as "
                                    "this one; a second objective, or one more goal, would "
                                    "choose among them",
                                    i + 1));
        }
    }
    return MT_OK;
}

/* What the engineer should know of the search besides its answers. */
static mt_status warn(const answer *a, mt_err *err)
{
    for (int i = 0; i < a->study->n_warnings; i++) {
        MT_TRY(mt_describe_warn(a->result, err, "%s", a->study->warnings[i]));
    }
    for (int i = 0; i < a->p->n; i++) {
        const mt_variable *const v = &a->study->variables[i];
        if (v->original < v->lower || v->original > v->upper) {
            MT_TRY(mt_describe_warn(a->result, err,
                                    "the original value of %s, %.6g, lies outside its bounds "
                                    "(%.6g to %.6g)",
                                    v->parameter_name.s, v->original, v->lower, v->upper));
        }
    }
    if (a->found.stop == MT_STOP_MAX_EVALS) {
        MT_TRY(mt_describe_warn(a->result, err,
                                "the budget of evaluations ran out after %ld: a larger "
                                "\"max_evaluations\" may find more",
                                a->found.evals));
    }
    MT_TRY(warn_of_missing(a, err));
    MT_TRY(warn_of_continua(a, err));
    if (a->why.code != MT_OK) {
        MT_TRY(mt_describe_warn(a->result, err, "%s", a->why.text));
    }
    return MT_OK;
}

static mt_result_status status_of(const answer *a, const mt_recommendation *best)
{
    if (a->found.stop == MT_STOP_USER) {
        return MT_RESULT_INTERRUPTED;
    }
    if (mt_describe_is_doubted(a->result)) {
        return MT_RESULT_COMPROMISE;
    }
    if (a->infeasible) {
        return MT_RESULT_INFEASIBLE;
    }
    return best->feasible ? MT_RESULT_SOLVED : MT_RESULT_COMPROMISE;
}

/* Is a named mode that cannot be told all that is wrong? */
static bool is_doubtful(const mt_recommendation *best)
{
    bool doubtful = false;
    for (int i = 0; i < best->n_goals; i++) {
        const mt_result_goal *const g = &best->goals[i];
        if (!g->met && !g->weighted && !g->doubtful) {
            return false;
        }
        doubtful = doubtful || g->doubtful;
    }
    return doubtful;
}

/* Is a design of the search a local optimum, as far as its gradients tell? "" where it is. */
static const char *doubt_text(const mt_recommendation *best, mt_arena *mem)
{
    return !mt_describe_is_optimum(best)
               ? mt_arena_printf(mem,
                                 " The best is not shown to be a local optimum (KKT residual "
                                 "%.2g).",
                                 best->kkt_residual)
               : "";
}

/* Answers that do not depend on a search's success; NULL: it does. */
static const char *early_text(const answer *a, const mt_recommendation *best)
{
    if (a->found.stop == MT_STOP_USER) {
        return a->found.n_solutions > 0 ? "Interrupted: the best designs found so far."
                                        : "Interrupted before any design was found.";
    }
    if (mt_describe_is_doubted(a->result)) {
        return "Not verified: a fresh analysis disagrees with what the search read, so that "
               "nothing here is proven and designs graded \"not verified\" must not be used "
               "(see the warnings).";
    }
    if (best->n_goals == 0) {
        return "No goals: the model as it is, against published values.";
    }
    if (!a->searched) {
        return best->feasible ? "The original design meets all goals."
                              : "The original design does not meet all goals.";
    }
    return NULL;
}

static const char *solved_text(const answer *a, const char *doubt, mt_arena *mem)
{
    const int n = a->found.n_solutions;
    if (a->gaps.n_solutions > 0) {
        const char *const left = mt_describe_gaps_left(&a->gaps, mem);
        return left == NULL ? NULL
                            : mt_arena_printf(
                                  mem,
                                  "Solved: %d kind%s of design keep%s clear of the bands and "
                                  "meet%s all goals (of %.0f gap assignments, %s).%s",
                                  n, n == 1 ? "" : "s", n == 1 ? "s" : "", n == 1 ? "s" : "",
                                  a->gaps.n_possible, left, doubt);
    }
    bool continuum = false;
    for (int i = 0; i < n; i++) {
        continuum = continuum || a->found.solutions[i].continuum;
    }
    if (continuum) {
        return n == 1 ? mt_arena_printf(mem,
                                        "Solved: a continuum of equally good designs meets all "
                                        "goals; one of it is recommended.%s",
                                        doubt)
                      : mt_arena_printf(mem,
                                        "Solved: %d distinct designs, or continua of equally "
                                        "good designs, meet all goals.%s",
                                        n, doubt);
    }
    return mt_arena_printf(mem, "Solved: %d distinct design%s all goals.%s", n,
                           n == 1 ? " meets" : "s meet", doubt);
}

static const char *status_text(const answer *a, const mt_recommendation *best)
{
    mt_arena *const mem = &a->result->mem;
    const int n = a->found.n_solutions;
    const char *const early = early_text(a, best);
    if (early != NULL) {
        return early;
    }
    if (a->infeasible) {
        return mt_arena_printf(mem,
                               "Infeasible: no design within the bounds meets all goals, which "
                               "is proven (see the certificates).%s%s",
                               a->result->n_relaxations > 0 ? " " : "",
                               a->result->n_relaxations > 0 ? a->result->relaxations[0].text
                                                            : "");
    }
    if (n == 0) {
        return a->why.code != MT_OK ? "No design that was tried could be evaluated."
               : a->found.stop == MT_STOP_MAX_EVALS
                   ? "The budget ended before any design was found."
                   : "No design was found within the bounds (sampled, not proven).";
    }
    const char *const doubt = doubt_text(best, mem);
    if (doubt == NULL) {
        return NULL;
    }
    if (best->feasible) {
        return solved_text(a, doubt, mem);
    }
    if (is_doubtful(best)) {
        return "Compromise: by their numbers all goals can be met, but which modes the named "
               "ones "
               "are cannot be told there (see the goals).";
    }
    const char *const nearest =
        isfinite(best->violation_percent)
            ? mt_arena_printf(mem, "the nearest %smisses by %.3g %% at most",
                              a->impossible ? "that was found " : "", best->violation_percent)
            : "at the nearest not every goal has a value";
    return nearest == NULL
               ? NULL
               : mt_arena_printf(
                     mem, "Compromise: no design %swithin the bounds meets all goals%s; %s.",
                     a->impossible ? "" : "found ",
                     a->impossible ? ", which is proven (see the certificates)"
                                   : " (sampled, not proven)",
                     nearest);
}

static void lower_grade(mt_recommendation *r)
{
    if (r->grade != NULL && strcmp(r->grade, "feasible and proven") == 0) {
        r->grade = "feasible";
    }
}

/* The points of a trade study are answers to the same question. */
static void qualify_trade(mt_result *result)
{
    const mt_doubt_list *const list = &result->doubts;
    const bool doubtful = mt_doubt_count(list->n, list->items, MT_LEVEL_DOUBT) > 0;
    for (int i = 0; doubtful && result->trade != NULL && i < result->trade->n_points; i++) {
        lower_grade(&result->trade->points[i].best);
    }
}

/* Nothing is proven of a question that is hardly the one that was meant: the doubts come first, and no design is graded beyond "feasible". */
static mt_status qualify(mt_result *result, mt_err *err)
{
    const mt_doubt_list *const list = &result->doubts;
    const int n = mt_doubt_count(list->n, list->items, MT_LEVEL_DOUBT);
    const char *first = "";
    for (int i = list->n - 1; i >= 0; i--) {
        first = list->items[i].level == MT_LEVEL_DOUBT ? list->items[i].text : first;
    }
    if (n == 0) {
        return MT_OK;
    }
    for (int i = 0; i < result->n_recommendations; i++) {
        lower_grade(&result->recommendations[i]);
    }
    result->status_text =
        n == 1 ? mt_arena_printf(&result->mem, "Doubtful question (%s). %s", first,
                                 result->status_text)
               : mt_arena_printf(&result->mem, "Doubtful question (%s; and %d more). %s", first,
                                 n - 1, result->status_text);
    return result->status_text == NULL ? mt_fail_memory(err) : MT_OK;
}

static mt_status set_status(const answer *a, mt_err *err)
{
    mt_result *const result = a->result;
    const mt_recommendation *const best =
        result->n_recommendations > 0 ? &result->recommendations[0] : &result->baseline;
    const bool nothing = a->searched && result->n_recommendations == 0;
    result->status = status_of(a, best);
    if (nothing && result->status == MT_RESULT_SOLVED) {
        result->status = MT_RESULT_COMPROMISE; /* the baseline is no answer of the search */
    }
    result->status_text = status_text(a, best);
    return result->status_text == NULL ? mt_fail_memory(err) : qualify(result, err);
}

/* The search over gap assignments, its solutions in the form of any other search. */
static mt_status search_gaps(answer *a, mt_err *err)
{
    mt_gap_result *const g = &a->gaps;
    MT_TRY(mt_gaps_solve(a->p, a->n_workers, &a->mem, g, err));
    a->found.solutions =
        mt_arena_alloc(&a->mem, (size_t)g->n_solutions, sizeof *a->found.solutions);
    if (a->found.solutions == NULL) {
        return mt_fail_memory(err);
    }
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

static mt_status search(answer *a, mt_err *err)
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

static mt_status certify(answer *a, mt_err *err)
{
    if (!a->searched || a->found.stop == MT_STOP_USER) {
        return MT_OK;
    }
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
    /* exact targets are answered by the nearest design, also where it is proven that they cannot be met */
    a->infeasible = a->infeasible && a->p->n_eq == 0;
    return MT_OK;
}

/* What would let a design exist, where none was found. */
static mt_status relax(answer *a, mt_err *err)
{
    mt_moves moves = {0};
    const bool none = a->infeasible || a->impossible || a->found.compromise;
    if (!a->searched || !none || a->found.stop == MT_STOP_USER) {
        return MT_OK;
    }
    MT_TRY(mt_study_is_discrete(a->study)
               ? mt_relax_discrete(a->workers, a->n_workers, &a->found, &a->mem, &moves, err)
               : mt_relax(a->p, a->n_workers, &a->found, &a->mem, &moves, err));
    a->found.evals += moves.evals;
    a->found.starts += moves.starts;
    if (moves.short_of_budget && a->found.stop != MT_STOP_MAX_EVALS) {
        return mt_describe_warn(a->result, err,
                                "which single change would let a design exist is not known: "
                                "there are too many combinations, or \"max_evaluations\" left "
                                "nothing for it");
    }
    if (moves.stopped) {
        return mt_describe_warn(a->result, err,
                                "interrupted before it was known which single change would "
                                "let a design exist");
    }
    return mt_describe_relaxations(a->p, &moves, a->result, err);
}

/* The caller's design as one more start of every search. */
static mt_status take_hint(answer *a, const double *hint, mt_err *err)
{
    const mt_problem *const p = a->p;
    double *const t = mt_arena_f64(&a->mem, (size_t)p->n + 1, 1);
    if (t == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < p->n; i++) {
        t[i] = mt_problem_t(p, i, hint[i]); /* the search brings it within the bounds */
    }
    for (int i = 0; i < a->n_workers; i++) {
        a->workers[i]->hint = t;
    }
    return MT_OK;
}

static mt_status fill(answer *a, const mt_solve_options *opt, mt_err *err)
{
    mt_problem *const p = a->p;
    mt_result *const result = a->result;
    const mt_design original = {.t = p->origin_t};
    double *const x = mt_arena_f64(&a->mem, (size_t)p->n, 1);
    for (int i = 0; i < a->n_workers; i++) {
        a->workers[i]->stop = opt->stop;
    }
    p->progress = opt->progress; /* the first worker's: one line at a time */
    p->progress_context = opt->progress_context;
    a->searched = p->n > 0 && (p->n_demands > 0 || p->n_clears > 0);
    if (x == NULL) {
        return mt_fail_memory(err);
    }
    if (opt->hint != NULL) {
        MT_TRY(take_hint(a, opt->hint, err));
    }
    MT_TRY(mt_describe_run(a->study, result, err));
    MT_TRY(mt_describe_excitations(a->study, result, err));
    result->doubts = mt_doubt_list_default(&result->mem);
    if (!a->study->examined) {
        MT_TRY(mt_study_examine(a->study, HUGE_VAL, &result->doubts, err));
    }
    MT_TRY(mt_describe_design(p, &original, NULL, result, &result->baseline, err));
    MT_TRY(mt_describe_baseline_reasons(p, result, err));
    if (a->searched) {
        MT_TRY(search(a, err));
        MT_TRY(describe_solutions(a, err));
        if (a->found.n_solutions > 0 && a->found.stop != MT_STOP_USER &&
            !mt_study_is_discrete(a->study)) {
            MT_TRY(mt_describe_spread(p, &a->found.solutions[0], &a->mem, &a->found.evals,
                                      result, err));
        }
    }
    MT_TRY(certify(a, err));
    if (mt_describe_is_doubted(result)) {
        MT_TRY(mt_describe_withdraw(result, err));
    }
    MT_TRY(relax(a, err));
    MT_TRY(warn(a, err));
    result->run.evaluations = a->found.evals;
    result->run.starts = a->found.starts;
    MT_TRY(set_status(a, err));
    const bool recommended = a->found.n_solutions > 0;
    if (recommended) {
        mt_problem_x(p, a->found.solutions[0].t, x);
    }
    MT_TRY(mt_describe_published(p, p->original, recommended ? x : NULL, result, err));
    return mt_describe_own(a->study, result, err);
}

/* One problem for each worker; references are analysed with the first and only read afterwards. */
static mt_status open_problems(answer *a, int threads, mt_err *err)
{
    const int most = threads < MT_WORKERS_MOST ? threads : MT_WORKERS_MOST;
    const int n = a->study->n_variables > 0 && most > 1 ? most : 1;
    a->workers = mt_arena_alloc(&a->mem, (size_t)n, sizeof(mt_problem *));
    if (a->workers == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < n; i++) {
        MT_TRY(mt_problem_new(a->study, &a->references, &a->workers[i], err));
        a->n_workers = i + 1;
    }
    a->p = a->workers[0];
    return MT_OK;
}

mt_status mt_study_solve(const mt_study *study, const mt_solve_options *opt, mt_result **out,
                         mt_err *err)
{
    const mt_solve_options defaults = mt_solve_options_default();
    const mt_solve_options *const use = opt != NULL ? opt : &defaults;
    answer a = {.study = study};
    MT_NOT_NULL(out, err);
    *out = NULL;
    MT_NOT_NULL(study, err);
    for (int i = 0; use->hint != NULL && i < study->n_variables; i++) {
        if (!isfinite(use->hint[i])) {
            return mt_fail(err, MT_E_USAGE, "mt_study_solve: hint[%d] is not finite", i);
        }
    }
    mt_status rc = mt_arena_init(&a.mem, 0, err);
    rc = rc == MT_OK ? mt_result_new(&a.result, err) : rc;
    rc = rc == MT_OK ? mt_reference_cache_init(&a.references, study, &a.mem, err) : rc;
    rc = rc == MT_OK ? open_problems(&a, use->threads, err) : rc;
    rc = rc == MT_OK ? fill(&a, use, err) : rc;
    if (rc == MT_OK && a.result->status != MT_RESULT_INTERRUPTED) {
        rc = mt_trade_solve(study, use, a.result, err);
        qualify_trade(a.result);
    }
    for (int i = 0; i < a.n_workers; i++) {
        mt_problem_delete(a.workers[i]);
    }
    mt_reference_cache_free(&a.references);
    mt_arena_free(&a.mem);
    if (rc != MT_OK) {
        mt_result_delete(a.result);
        return rc;
    }
    *out = a.result;
    return MT_OK;
}
