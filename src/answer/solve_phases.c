/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The original design as the answer. The total change is 0 there and above 0 at every other
 * design, as all weights are above 0: where the original meets all goals of a study that makes
 * the change least first, it is the best design there is, and nothing is left to search or to
 * prove. That it meets them is read from its description, which judges it as every design that
 * is reported: over its tolerances and between the positions of drives, too.
 */
#include "answer/solve_priv.h"

#include <math.h>
#include <stdatomic.h>

#include "answer/examine.h"
#include "answer/trade.h"
#include "answer/weight_sensitivity.h"
#include "describe/certificates.h"
#include "describe/describe.h"
#include "describe/describe_search.h"
#include "problem/tolerance_cut.h"
#include "search/drive_path.h"
#include "search/proof.h"
#include "search/search.h"

/* True where x is within the bounds of variable v and, where it has a catalogue, one of its
 * values. */
static bool is_allowed(const mt_variable *v, double x)
{
    bool listed = v->n_catalogue == 0;
    for (int i = 0; i < v->n_catalogue && !listed; i++) {
        listed = v->catalogue[i] == x;
    }
    return listed && x >= v->lower && x <= v->upper;
}

bool mt_answer_original_is_best(const mt_answer *a)
{
    const mt_problem *const p = a->p;
    const mt_recommendation *const original = &a->result->baseline;
    if (!a->searched || p->whole.rows.eq.n > 0 || p->stages[0].type != MT_OBJECTIVE_CHANGE ||
        !original->feasible || original->disagreement != NULL ||
        !mt_describe_keeps_between(original)) {
        return false;
    }
    for (int i = 0; i < p->n; i++) {
        if (!is_allowed(&p->study->variables[i], p->original[i])) {
            return false;
        }
    }
    return true;
}

/* Sets a->found to the original, without a search. */
static mt_status take_original(mt_answer *a, mt_err *err)
{
    const size_t n = (size_t)a->p->n;
    mt_nlp_solution *const s = mt_arena_alloc(&a->mem, 1, sizeof *s);
    double *const t = mt_arena_f64(&a->mem, n, 1);
    int *const bound = mt_arena_int(&a->mem, n);
    a->found = (mt_nlp_result){.stop = MT_STOP_DONE,
                               .solutions = s,
                               .n_solutions = 1,
                               .steps = mt_steps_new(MT_STEPS_OF_TASK, &a->mem)};
    MT_TRY(mt_arena_check(&a->mem, err));
    for (size_t i = 0; i < n; i++) {
        t[i] = a->p->whole.origin_t[i];
    }
    /* the gradient of the change is 0 here, and so is each multiplier */
    *s = (mt_nlp_solution){.t = t, .feasible = true, .bound = bound};
    a->stage = 0;
    a->unsearched = true;
    return MT_OK;
}

/* What the phases of an answer do, in their order. */

/* The original design, without which there is nothing to tell. */
mt_status mt_answer_baseline(mt_answer *a, mt_err *err)
{
    const mt_problem *const p = a->p;
    mt_result *const result = a->result;
    const mt_design original = {.t = p->whole.origin_t};
    MT_TRY(mt_describe_run(a->study, result, err));
    MT_TRY(mt_describe_excitations(a->study, result, err));
    MT_TRY(mt_describe_asked_curves(p, result, err));
    if (!a->study->examined) {
        mt_warning_list list = mt_warning_list_default(&result->mem);
        MT_TRY(mt_study_examine(a->study, a->p->run, HUGE_VAL, &list, err));
        MT_TRY(mt_result_take_warnings(result, &list, err));
    }
    MT_TRY(mt_describe_design(p, &original, NULL, result, &result->baseline, err));
    return mt_describe_baseline_reasons(p, result, err);
}

/* With a budget in modal solutions: evaluations that those of the original design count as. */
static long original(const mt_answer *a)
{
    const long solved = mt_work_counters_in(a->spent, MT_PHASE_BASELINE, MT_WORK_MODAL);
    return mt_subproblem_worth(&a->asked, solved);
}

/* Evaluations for describing one design: mt_describe_design, and following its drives. Those
 * for its tolerances are known from the original design. */
static long description(const mt_answer *a)
{
    const long most = 2 + mt_drive_path_most(&a->asked);
    const long worth = original(a);
    return most > worth ? most : worth;
}

static int limited(long n, int least, int most)
{
    return n < least ? least : n > most ? most : (int)n;
}

/*
 * A budget is of the whole answer. The search has what is left of it but for a quarter at most,
 * which describes its designs (one in any case), and another one where other weights are asked
 * for; what it leaves is there for all that follows.
 */
enum { PART_AFTER = 4 };

static void allow_search(mt_answer *a)
{
    const long left = mt_question_left(a->q);
    if (left == LONG_MAX) {
        return;
    }
    const long part = left / PART_AFTER;
    const long n = limited(part / description(a), 1, a->study->recommendations);
    const long rest = left - (n * description(a)) - (a->study->n_published > 0 ? 2 : 0) -
                      (mt_weight_sensitivity_is_asked(a->p) ? part : 0);
    a->asked.search.max_evaluations = rest > 1 ? rest : 1;
    a->asked.search.judged_as = mt_tolerance_is_sampled(&a->asked) ? original(a) : 0;
}

/* Solutions of the search over mode placements in the form of any other search. */
mt_status mt_answer_take_placements(mt_answer *a, mt_err *err)
{
    const mt_mode_placement_result *const g = &a->placements;
    a->found.solutions =
        mt_arena_alloc(&a->mem, (size_t)g->n_solutions, sizeof *a->found.solutions);
    MT_TRY(mt_arena_check(&a->mem, err));
    for (int i = 0; i < g->n_solutions; i++) {
        a->found.solutions[i] = *g->solutions[i].found;
    }
    a->found.n_solutions = g->n_solutions;
    a->found.compromise = g->compromise;
    a->found.n_unidentifiable = g->n_unidentifiable;
    a->found.unidentifiable = g->unidentifiable;
    a->found.unidentifiable_effect = g->unidentifiable_effect;
    a->stage = g->stage;
    a->found.evals = g->evals;
    a->found.steps = g->steps;
    a->found.starts = g->starts;
    a->found.stop = g->stop;
    return MT_OK;
}

static mt_status search_placements(mt_answer *a, mt_err *err)
{
    const mt_mode_placement_incumbent incumbent = {mt_answer_incumbent, a};
    MT_TRY(mt_mode_placements_solve(a->workers, a->n_workers,
                                    a->incumbent != NULL ? &incumbent : NULL, &a->mem,
                                    &a->placements, err));
    return mt_answer_take_placements(a, err);
}

/* Reports as progress that a short proof shows the study infeasible, before the search; the
 * answer and its cost do not depend on it. */
static mt_status report_infeasible(mt_answer *a, mt_err *err)
{
    mt_progress *const progress = a->p->run->progress;
    const mt_infeasible_presolve_question q = {.c = &a->asked, .but = -1, .bands = true};
    mt_err own = {.code = MT_OK};
    bool presolve = false;
    if (progress == NULL || mt_describe_is_doubted(a->result)) {
        return MT_OK;
    }
    const mt_status rc = mt_infeasible_presolve(&q, &a->mem, &presolve, &own);
    if (rc == MT_OK && presolve) {
        mt_progress_impossible(progress);
    }
    return mt_pass_final(rc, &own, err);
}

static mt_status search_by_study_kind(mt_answer *a, mt_err *err)
{
    if (mt_study_has_catalogues(a->study)) {
        return mt_catalogue_search_solve(a->workers, a->n_workers, &a->mem, &a->found,
                                         &a->discrete, err);
    }
    if (a->p->n_avoidances > 0) {
        return search_placements(a, err);
    }
    MT_TRY(mt_search_over_tolerances(a->workers, a->n_workers, &a->mem, &a->found, &a->stage,
                                     &a->at_position, &a->why, err));
    a->result->run.distinct_designs = a->found.compromise ? 0 : a->found.n_found;
    a->result->run.singletons = a->found.compromise ? 0 : a->found.n_once;
    a->result->run.estimated_unseen = a->found.missing;
    return MT_OK;
}

mt_status mt_answer_search(mt_answer *a, mt_err *err)
{
    const bool alone = a->study->recommendations == 1 || !a->study->alternatives;
    allow_search(a);
    if (alone && mt_answer_original_is_best(a)) {
        MT_TRY(take_original(a, err));
        return mt_describe_history(a->p, &a->found, a->stage, a->result, err);
    }
    MT_TRY(report_infeasible(a, err));
    MT_TRY(search_by_study_kind(a, err));
    return mt_describe_history(a->p, &a->found, a->stage, a->result, err);
}

static bool is_cut(const mt_answer *a, mt_phase which)
{
    return mt_interrupt_is_cut(a->interrupt, (int)which);
}

/* Describes solution i: rec, with texts and lists in `into`, as its warnings. */
static mt_status describe_recommendation(const mt_answer *a, int i, mt_result *into,
                                         mt_recommendation *rec, mt_err *err)
{
    const bool discrete = mt_study_has_catalogues(a->study) && !a->unsearched;
    const bool kinds = a->placements.n_solutions > 0;
    const mt_design design = {.t = a->found.solutions[i].t,
                              .found = &a->found.solutions[i],
                              .stage = a->stage,
                              .rank = i + 1,
                              .cut = is_cut(a, MT_PHASE_SEARCH),
                              .unsearched = a->unsearched,
                              .discrete = discrete ? &a->discrete : NULL,
                              .placements = kinds ? &a->placements : NULL,
                              .below = kinds ? a->placements.solutions[i].below : NULL,
                              .at_position = a->at_position,
                              .held = kinds ? a->placements.solutions[i].held : NULL,
                              .n_held = kinds ? a->placements.solutions[i].n_held : 0};
    MT_TRY(mt_describe_design(a->p, &design, &a->result->baseline, into, rec, err));
    return mt_describe_reasons(a->p, &design, &a->found, into, rec, err);
}

/* A design that is described beside others. */
typedef struct part {
    mt_result *into; /* owned */
    mt_recommendation rec;
    bool whole; /* nothing of it was cut */
} part;

typedef struct others {
    const mt_answer *a;
    part *parts; /* of the best and all behind it */
    mt_progress *progress;
    bool told;
} others;

static mt_status describe_part(const others *o, int task, mt_err *err)
{
    const mt_result *const result = o->a->result;
    part *const p = &o->parts[task];
    if (is_cut(o->a, MT_PHASE_RECOMMENDATIONS)) {
        return MT_OK;
    }
    MT_TRY(mt_result_new(&p->into, err));
    p->into->objectives = result->objectives; /* what is known of all designs */
    p->into->n_objectives = result->n_objectives;
    p->into->curves = result->curves;
    p->into->n_curves = result->n_curves;
    p->into->unidentifiable = result->unidentifiable;
    p->into->n_unidentifiable = result->n_unidentifiable;
    MT_TRY(describe_recommendation(o->a, task, p->into, &p->rec, err));
    p->whole = !is_cut(o->a, MT_PHASE_RECOMMENDATIONS);
    mt_progress_done(o->progress, o->told);
    return MT_OK;
}

/* Without the best one there is no answer: a limit of time waits for it, and no longer. */
static mt_status describe_other(void *context, int worker, int task, mt_task_path *own,
                                mt_err *err)
{
    const others *const o = context;
    (void)worker;
    (void)own;
    const mt_status rc = describe_part(o, task, err);
    if (task == 0) {
        atomic_store(&o->a->interrupt->needed, false);
    }
    return rc;
}

/* Adds a description to the result as if it had been made there. */
static mt_status take_other(mt_answer *a, const part *p, mt_err *err)
{
    mt_result *const result = a->result;
    for (int i = 0; i < p->into->n_warnings; i++) {
        MT_TRY(mt_describe_warn(result, err, "%s", p->into->warnings[i]));
    }
    MT_TRY(mt_recommendation_copy(&p->rec, NULL, &result->mem,
                                  &result->recommendations[result->n_recommendations], err));
    result->n_recommendations++;
    return MT_OK;
}

/* n designs side by side, as many as were described before a cut. */
static mt_status recommend_designs(mt_answer *a, int n, bool told, mt_err *err)
{
    others o = {.a = a,
                .parts = mt_arena_alloc(&a->mem, (size_t)n, sizeof *o.parts),
                .progress = a->p->run->progress,
                .told = told};
    MT_TRY(mt_arena_check(&a->mem, err));
    const mt_tasks tasks = {n, describe_other, NULL, &o, "designs"};
    a->mark = mt_result_get_mark(a->result);
    atomic_store(&a->interrupt->needed, true);
    const mt_status rc = mt_workers_run(a->n_workers, NULL, &tasks, err);
    atomic_store(&a->interrupt->needed, false);
    mt_status taken = MT_OK; /* of a cut is an error, too: what came before it counts */
    for (int i = 0; i < n && !mt_is_final(rc) && taken == MT_OK && o.parts[i].whole; i++) {
        taken = take_other(a, &o.parts[i], err);
        a->mark = mt_result_get_mark(a->result);
    }
    for (int i = 0; i < n; i++) {
        mt_result_delete(o.parts[i].into);
    }
    return taken != MT_OK ? taken : rc;
}

mt_status mt_answer_recommend(mt_answer *a, mt_err *err)
{
    const mt_nlp_result *const found = &a->found;
    mt_result *const result = a->result;
    const int asked = a->study->recommendations;
    const int most = limited(mt_question_left(a->q) / description(a), 1, asked);
    const int n = found->n_solutions < most ? found->n_solutions : most;
    mt_progress *const progress = a->p->run->progress;
    result->recommendations =
        mt_arena_alloc(&result->mem, (size_t)n, sizeof *result->recommendations);
    MT_TRY(mt_arena_check(&result->mem, err));
    MT_TRY(mt_describe_unidentifiable(a->p, found, result, err));
    const bool told = mt_progress_begin(progress, "designs", n);
    mt_status rc = MT_OK;
    if (n > 0 && !is_cut(a, MT_PHASE_RECOMMENDATIONS)) {
        rc = recommend_designs(a, n, told, err);
    }
    mt_progress_end(progress, told);
    if (rc != MT_OK || is_cut(a, MT_PHASE_RECOMMENDATIONS)) {
        return rc;
    }
    a->mark = mt_result_get_mark(result);
    if (found->n_solutions > n) {
        MT_TRY(mt_describe_warn(result, err, "%d more distinct designs were found; \"%s\" %s",
                                found->n_solutions - n,
                                n < asked ? mt_search_budget(&a->p->whole.search)
                                          : "recommendations",
                                n < asked ? "leaves no evaluations to check them"
                                          : "in the study says how many to report"));
    }
    return MT_OK;
}

mt_status mt_answer_weight_sensitivity(mt_answer *a, mt_err *err)
{
    return a->result->n_recommendations == 0
               ? MT_OK
               : mt_weight_sensitivity_solve(a->workers, a->n_workers, &a->found.solutions[0],
                                             &a->mem, mt_question_left(a->q), &a->found.evals,
                                             a->result, err);
}

mt_status mt_answer_certify(mt_answer *a, mt_err *err)
{
    if (a->unsearched) {
        return mt_describe_certificate(
            a->result, "least_change", true,
            "The original design meets all goals, and every other design changes more.", err);
    }
    if (mt_study_has_catalogues(a->study)) {
        return mt_describe_catalogue_certificate(&a->discrete, &a->found, a->result,
                                                 &a->infeasible, err);
    }
    if (a->p->n_avoidances > 0) {
        return mt_describe_placement_certificate(&a->placements, a->result, &a->infeasible,
                                                 err);
    }
    if (!a->found.compromise) {
        return MT_OK;
    }
    MT_TRY(mt_describe_limit_certificates(a->p, a->found.boxes, &a->mem, a->result,
                                          &a->infeasible, err));
    a->impossible = a->infeasible;
    /* exact targets are answered by the nearest design, also where it is proven that they
     * cannot be met */
    a->infeasible = a->infeasible && a->p->whole.rows.eq.n == 0;
    return MT_OK;
}

/* Relaxations, where no design was found. */
mt_status mt_answer_relaxation(mt_answer *a, mt_err *err)
{
    mt_moves moves = {0};
    if (!a->infeasible && !a->impossible && !a->found.compromise) {
        return MT_OK;
    }
    const long left = mt_question_left(a->q);
    if (left < LONG_MAX) { /* beside what is counted as the search's */
        a->asked.search.max_evaluations = a->found.evals + left;
    }
    MT_TRY(
        mt_study_has_catalogues(a->study)
            ? mt_relaxation_catalogue(a->workers, a->n_workers, &a->found, &a->mem, &moves, err)
            : mt_relaxation_solve(a->workers, a->n_workers, &a->found,
                                  a->p->n_avoidances > 0 ? &a->placements : NULL, &a->mem,
                                  &moves, err));
    a->found.evals += moves.evals;
    a->found.starts += moves.starts;
    if (moves.short_of_budget && a->found.stop != MT_STOP_MAX_EVALS) {
        return mt_describe_warn(
            a->result, err,
            "the single change that would make the study feasible is not known: there are too "
            "many combinations, or \"%s\" left no evaluations for it",
            mt_search_budget(&a->p->whole.search));
    }
    return mt_describe_relaxations(a->p, &moves, a->result, err);
}

mt_status mt_answer_publish(mt_answer *a, mt_err *err)
{
    double *const x = mt_arena_f64(&a->mem, (size_t)a->p->n, 1);
    const bool recommended = a->result->n_recommendations > 0;
    MT_TRY(mt_arena_check(&a->mem, err));
    if (recommended) {
        mt_subproblem_x(&a->asked, a->found.solutions[0].t, x);
    }
    return mt_describe_published(a->workers[0], a->p->original, recommended ? x : NULL,
                                 a->result, err);
}

mt_status mt_answer_trade(mt_answer *a, mt_err *err)
{
    return mt_trade_solve(a->study, a->p->run, a->threads, &a->task_path, a->result, err);
}
