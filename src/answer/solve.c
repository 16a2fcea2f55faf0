/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A study answered in phases. Each may be cut by the caller's wish to stop. Which ones were is
 * told by the interrupt itself, which every unit of work passes (base/run.h): no phase
 * hands it up, so none can forget to. What a phase that was cut has written is taken back, and
 * those that need what it would have found are not begun.
 */
#include "answer/solve.h"

#include <limits.h>
#include <math.h>
#include <stdatomic.h>

#include "answer/examine.h"
#include "answer/trade.h"
#include "answer/warnings.h"
#include "answer/weight_sensitivity.h"
#include "base/base.h"
#include "base/format.h"
#include "base/number.h"
#include "base/run.h"
#include "base/workers.h"
#include "describe/certificates.h"
#include "describe/describe.h"
#include "describe/describe_search.h"
#include "problem/configuration.h"
#include "problem/tolerance_cut.h"
#include "search/catalogue_search.h"
#include "search/drive_path.h"
#include "search/mode_placements.h"
#include "search/proof.h"
#include "search/search.h"

/*
 * The phases of an answer in order: id, name of what it writes in a result, makes_ready (the
 * phase puts known results into their form, and continues until MT_STOP_REQUEST_END), and its
 * function.
 */
#define PHASE_LIST(X)                                                      \
    X(PHASE_BASELINE, "baseline", true, run_baseline)                      \
    X(PHASE_SEARCH, "search", false, run_search)                           \
    X(PHASE_RECOMMENDATIONS, "recommendations", true, run_recommendations) \
    X(PHASE_WEIGHT_SENSITIVITY, "spread", false, run_weight_sensitivity)   \
    X(PHASE_CERTIFICATES, "certificates", false, run_certificates)         \
    X(PHASE_RELAXATIONS, "relaxations", false, run_relaxations)            \
    X(PHASE_PUBLISHED, "published", true, run_published)                   \
    X(PHASE_TRADE, "trade", false, run_trade)
#define PHASE_ENUM(id, name, makes_ready, work) id,
typedef enum phase_id { PHASE_LIST(PHASE_ENUM) PHASE_COUNT } phase_id;
#undef PHASE_ENUM

/* One answer to a question. */
typedef struct answer {
    mt_question *q;
    const mt_study *study; /* the question's, like the next two */
    const mt_problem *p;
    mt_interrupt *interrupt;
    /* counters of its work: the question's, except for an early answer */
    mt_work_counters *spent;
    mt_result_mark mark; /* of the result: the complete part */
    int threads;
    const mt_incumbent_callback *incumbent; /* may be NULL */
    const mt_task_path *whole;              /* path of the whole answer, or NULL */
    mt_task_path task_path;                 /* path of the current phase */
    mt_subproblem asked;                    /* the whole subproblem, with the caller's start */
    mt_workspace **workers;                 /* [n_workers] owned, set to `asked` */
    int n_workers;
    mt_result *result;
    mt_arena mem;
    mt_nlp_result found;
    /* multipliers of limits between positions (search.h) */
    const struct mt_at_position_price *at_position;
    mt_mode_placement_result placements; /* where there are bands: source of `found` */
    mt_catalogue_search_report discrete; /* where there are catalogues: report of the search */
    int stage;                           /* stage of `found` */
    mt_err why;                          /* reason where no start of the search had a value */
    bool searched;                       /* there is something to search */
    bool unsearched;                     /* no search was needed: the original is the answer */
    bool infeasible;                     /* proven infeasible, and no compromise is wanted */
    bool impossible;                     /* proven: no design meets all goals */
} answer;

/* Callback before a long proof: builds the answer that an interrupt would give now, with the
 * best of the designs found, and passes it to a->incumbent. */
static mt_status tell_incumbent(void *context, const mt_mode_placement_result *found,
                                mt_err *err);

/* The question. */

/* A design may take so much of a budget on its way along one drive. */
enum { OF_BUDGET = 10 };

static int positions_of(long most)
{
    const long part = most / OF_BUDGET;
    return most <= 0 ? 0 : part < 1 ? 1 : part < INT_MAX ? (int)part : INT_MAX;
}

long mt_question_left(const mt_question *q)
{
    const mt_search *const s = &q->p->whole.search;
    const long spent = mt_work_counters_of(&q->spent, MT_WORK_DESIGNS) +
                       mt_work_counters_of(&q->spent, MT_WORK_POSITIONS);
    const long left = s->max_evaluations <= 0      ? LONG_MAX
                      : spent < s->max_evaluations ? s->max_evaluations - spent
                                                   : 0;
    if (s->solutions_each <= 0) {
        return left;
    }
    const long solved = mt_work_counters_of(&q->spent, MT_WORK_MODAL);
    const long other = solved < s->max_modal_solutions
                           ? (s->max_modal_solutions - solved) / s->solutions_each
                           : 0;
    return other < left ? other : left;
}

/* The study's budget; one of modal solutions in evaluations. */
static void set_budget(mt_question *q)
{
    mt_search *const s = &q->p->whole.search;
    if (s->max_modal_solutions > 0) {
        const long each = mt_subproblem_solutions(&q->p->whole);
        s->solutions_each = each > 1 ? each : 1;
        const long n = s->max_modal_solutions / s->solutions_each;
        s->by_solutions = s->max_evaluations <= 0 || n < s->max_evaluations;
        s->max_evaluations = s->by_solutions ? (n > 1 ? n : 1) : s->max_evaluations;
    }
    s->max_positions = positions_of(s->max_evaluations);
}

/* Analyses the original design, which every part of the answer needs. */
static mt_status end_at_once(const mt_question *q, mt_status rc, const mt_err *own, mt_err *err)
{
    if (mt_interrupt_is_cut(&q->interrupt, PHASE_BASELINE) && !mt_is_final(rc)) {
        return mt_fail(err, MT_E_INTERRUPTED,
                       "interrupted before the original design was analysed");
    }
    return rc == MT_OK ? MT_OK : mt_fail(err, rc, "%s", own->text);
}

mt_status mt_question_init(mt_question *q, const mt_study *study, const mt_run *run,
                           const mt_solve_options *opt, mt_err *err)
{
    const mt_run *const whole = mt_run_or_none(run);
    mt_err own = {.code = MT_OK};
    mt_interrupt_init(&q->interrupt, opt->stop, opt->stop_context, whole->interrupt);
    q->interrupt.cause = opt->cause;
    mt_interrupt_enter(&q->interrupt, PHASE_BASELINE, true);
    mt_work_counters_init(&q->spent);
    q->study = study;
    q->run = (mt_run){.interrupt = &q->interrupt,
                      .progress = whole->progress,
                      .work = &q->spent,
                      .profile = whole->profile};
    const mt_status rc = mt_problem_new(study, &q->run, &q->p, &own);
    if (rc == MT_OK) {
        set_budget(q);
    }
    return end_at_once(q, rc, &own, err);
}

void mt_question_enter_search(mt_question *q)
{
    mt_interrupt_enter(&q->interrupt, PHASE_SEARCH, false);
    q->spent.phase = PHASE_SEARCH;
}

void mt_question_free(mt_question *q)
{
    mt_problem_delete(q->p);
    q->p = NULL;
}

/*
 * The original design as the answer. The total change is 0 there and above 0 at every other
 * design, as all weights are above 0: where the original meets all goals of a study that makes
 * the change least first, it is the best design there is, and nothing is left to search or to
 * prove. That it meets them is read from its description, which judges it as every design that
 * is reported: over its tolerances and between the positions of drives, too.
 */

static bool is_sensitivity_to_weights_asked(const mt_problem *p)
{
    return MT_HAS(p->study->weight_sensitivity.factor) &&
           mt_objective_is(p->stages[0].type, MT_RESIDUALS) &&
           !mt_study_has_catalogues(p->study);
}

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

/* True where the original meets all goals and no objective precedes the total change. After the
 * baseline. */
static bool is_original_best(const answer *a)
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
    for (int k = 0; k < p->n_choices; k++) {
        if (mt_choice_find(&p->choices[k], p->original) == MT_ABSENT) {
            return false; /* its values are those of several rows */
        }
    }
    return true;
}

/* Sets a->found to the original, without a search. */
static mt_status take_original(answer *a, mt_err *err)
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
static mt_status run_baseline(answer *a, mt_err *err)
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
static long original(const answer *a)
{
    const long solved = mt_work_counters_in(a->spent, PHASE_BASELINE, MT_WORK_MODAL);
    return mt_subproblem_worth(&a->asked, solved);
}

/* Evaluations for describing one design: mt_describe_design, and following its drives. Those
 * for its tolerances are known from the original design. */
static long description(const answer *a)
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

static void allow_search(answer *a)
{
    const long left = mt_question_left(a->q);
    if (left == LONG_MAX) {
        return;
    }
    const long part = left / PART_AFTER;
    const long n = limited(part / description(a), 1, a->study->recommendations);
    const long rest = left - (n * description(a)) - (a->study->n_published > 0 ? 2 : 0) -
                      (is_sensitivity_to_weights_asked(a->p) ? part : 0);
    a->asked.search.max_evaluations = rest > 1 ? rest : 1;
    a->asked.search.judged_as = mt_tolerance_is_sampled(&a->asked) ? original(a) : 0;
}

/* Solutions of the search over mode placements in the form of any other search. */
static mt_status take_placements(answer *a, mt_err *err)
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

static mt_status search_placements(answer *a, mt_err *err)
{
    const mt_mode_placement_incumbent incumbent = {tell_incumbent, a};
    MT_TRY(mt_mode_placements_solve(a->workers, a->n_workers,
                                    a->incumbent != NULL ? &incumbent : NULL, &a->mem,
                                    &a->placements, err));
    return take_placements(a, err);
}

/* Reports as progress that a short proof shows the study infeasible, before the search; the
 * answer and its cost do not depend on it. */
static mt_status report_infeasible(answer *a, mt_err *err)
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

static mt_status search_by_study_kind(answer *a, mt_err *err)
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

static mt_status run_search(answer *a, mt_err *err)
{
    const bool alone = a->study->recommendations == 1 || !a->study->alternatives;
    allow_search(a);
    if (alone && is_original_best(a)) {
        MT_TRY(take_original(a, err));
        return mt_describe_history(a->p, &a->found, a->stage, a->result, err);
    }
    MT_TRY(report_infeasible(a, err));
    MT_TRY(search_by_study_kind(a, err));
    return mt_describe_history(a->p, &a->found, a->stage, a->result, err);
}

static bool is_cut(const answer *a, phase_id which)
{
    return mt_interrupt_is_cut(a->interrupt, (int)which);
}

/* Describes solution i: rec, with texts and lists in `into`, as its warnings. */
static mt_status describe_recommendation(const answer *a, int i, mt_result *into,
                                         mt_recommendation *rec, mt_err *err)
{
    const bool discrete = mt_study_has_catalogues(a->study) && !a->unsearched;
    const bool kinds = a->placements.n_solutions > 0;
    const mt_design design = {.t = a->found.solutions[i].t,
                              .found = &a->found.solutions[i],
                              .stage = a->stage,
                              .rank = i + 1,
                              .cut = is_cut(a, PHASE_SEARCH),
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
    const answer *a;
    part *parts; /* of the best and all behind it */
    mt_progress *progress;
    bool told;
} others;

static mt_status describe_part(const others *o, int task, mt_err *err)
{
    const mt_result *const result = o->a->result;
    part *const p = &o->parts[task];
    if (is_cut(o->a, PHASE_RECOMMENDATIONS)) {
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
    p->whole = !is_cut(o->a, PHASE_RECOMMENDATIONS);
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
static mt_status take_other(answer *a, const part *p, mt_err *err)
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
static mt_status recommend_designs(answer *a, int n, bool told, mt_err *err)
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

static mt_status run_recommendations(answer *a, mt_err *err)
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
    if (n > 0 && !is_cut(a, PHASE_RECOMMENDATIONS)) {
        rc = recommend_designs(a, n, told, err);
    }
    mt_progress_end(progress, told);
    if (rc != MT_OK || is_cut(a, PHASE_RECOMMENDATIONS)) {
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

static mt_status run_weight_sensitivity(answer *a, mt_err *err)
{
    return a->result->n_recommendations == 0
               ? MT_OK
               : mt_weight_sensitivity_solve(a->workers, a->n_workers, &a->found.solutions[0],
                                             &a->mem, mt_question_left(a->q), &a->found.evals,
                                             a->result, err);
}

static mt_status run_certificates(answer *a, mt_err *err)
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
static mt_status run_relaxations(answer *a, mt_err *err)
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
                                  a->p->n_avoidances > 0 ? &a->placements : NULL,
                                  a->q->neighbour != NULL ? a->q->neighbour->known : NULL,
                                  &a->mem, &moves, err));
    if (a->q->moves != NULL) {
        MT_TRY(mt_moves_copy(&moves, a->p->n, a->q->moves_mem, a->q->moves, err));
    }
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

static mt_status run_published(answer *a, mt_err *err)
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

static mt_status run_trade(answer *a, mt_err *err)
{
    return mt_trade_solve(a->study, a->p->run, a->threads, &a->task_path, a->result, err);
}

/* How a search ended, in one sentence, and what the engineer should know of it besides its
 * answers. */

/* Warns that further isolated designs are likely where some were met only once. */
static mt_status warn_of_missing(const answer *a, mt_err *err)
{
    const mt_nlp_result *const f = &a->found;
    if (!MT_HAS(a->result->run.estimated_unseen) || f->n_once == 0) {
        return MT_OK;
    }
    const bool some = f->missing >= 1.0;
    char more[48] = "there may be more";
    if (some) {
        (void)mt_snprintf(more, sizeof more, "about %.0f more, at least, are to be expected",
                          f->missing);
    }
    return mt_describe_warn(
        a->result, err,
        "%d of the %d designs found %s reached from one of %d starts only: %s; more "
        "\"starts\" or \"%s\" may find them",
        f->n_once, f->n_found, f->n_once == 1 ? "was" : "were", f->starts, more,
        mt_search_budget(&a->p->whole.search));
}

/* Warnings about the search. */
static mt_status warn_of_search(const answer *a, mt_err *err)
{
    for (int i = 0; i < a->study->n_warnings; i++) {
        MT_TRY(mt_describe_warn(a->result, err, "%s", a->study->warnings[i]));
    }
    for (int i = 0; i < a->p->n; i++) {
        const mt_variable *const v = &a->study->variables[i];
        if (v->original < v->lower || v->original > v->upper) {
            MT_TRY(mt_describe_warn(a->result, err,
                                    "the original value of %s, %.6g, lies outside its bounds "
                                    "(%.6g to %.6g%s%s)",
                                    v->parameter_name.s, mt_unit_from_si(v->shown, v->original),
                                    mt_unit_from_si(v->shown, v->lower),
                                    mt_unit_from_si(v->shown, v->upper),
                                    v->shown == NULL ? "" : " ", mt_unit_name(v->shown, "")));
        }
    }
    if (a->found.stop == MT_STOP_MAX_EVALS) {
        const mt_search *const s = &a->p->whole.search;
        MT_TRY(mt_describe_warn(
            a->result, err,
            "the budget of %s ran out (%ld of %ld were made in the search): a "
            "larger \"%s\" may find more",
            s->by_solutions ? "modal solutions" : "evaluations",
            mt_work_counters_in(&a->q->spent, PHASE_SEARCH,
                                s->by_solutions ? MT_WORK_MODAL : MT_WORK_DESIGNS),
            s->by_solutions ? s->max_modal_solutions : s->max_evaluations,
            mt_search_budget(s)));
    }
    MT_TRY(warn_of_missing(a, err));
    int one = 0;
    int other = 0;
    if (mt_drive_positions_unfollowed(a->p, &one, &other)) {
        MT_TRY(mt_describe_warn(a->result, err,
                                "nothing is looked at between \"%s\" and \"%s\": a design is "
                                "followed along one joint, from the first position that is "
                                "named to others in which that joint alone differs",
                                mt_configuration_name(a->p, &a->p->views[one]),
                                mt_configuration_name(a->p, &a->p->views[other])));
    }
    for (int i = 0; i < a->result->n_recommendations; i++) {
        if (a->found.solutions[i].continuum) {
            MT_TRY(mt_describe_warn(a->result, err,
                                    "recommendation %d: a continuum of designs is as good as "
                                    "this one; a second objective, or one more goal, would "
                                    "choose among them",
                                    i + 1));
        }
    }
    if (a->why.code != MT_OK) {
        MT_TRY(mt_describe_warn(a->result, err, "%s", a->why.text));
    }
    return MT_OK;
}

/* True where the only fault is a named mode that cannot be identified. */
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

/* Answers that do not depend on a search's success; NULL: it does. */
static const char *incumbent_text(const answer *a, const mt_recommendation *best)
{
    const bool cut = mt_interrupt_is_cut(a->interrupt, PHASE_RECOMMENDATIONS);
    if (cut && a->result->n_recommendations == 0 && a->found.n_solutions > 0) {
        return "Feasible designs may have been found, but none was re-checked (see the designs "
               "not "
               "re-checked).";
    }
    if (a->found.stop == MT_STOP_USER) {
        return a->found.n_solutions > 0 ? "The best designs found so far."
                                        : "No design was found so far.";
    }
    if (mt_describe_is_doubted(a->result)) {
        return "Not verified: recomputed, designs differ from what the search used. Nothing "
               "here is proven, and designs graded \"not verified\" must not be used (see the "
               "warnings).";
    }
    if (best->n_goals == 0) {
        return "No goals: the model as it is, against published values.";
    }
    if (!a->searched && mt_study_is_fit(a->study)) {
        return mt_arena_printf(&a->result->mem,
                               "Nothing to fit: the original design has a misfit of %.4g.",
                               best->misfit);
    }
    if (!a->searched) {
        return best->feasible ? "The original design meets all goals."
                              : "The original design does not meet all goals.";
    }
    return NULL;
}

/* Of half its square; an exact fit leaves rounding. */
static double shown_misfit(double f)
{
    return mt_without_noise(sqrt(2.0 * f), MT_RATIO_NOISE);
}

/* True where there are goals besides limits that only scale an objective. */
static bool has_goals(const mt_recommendation *r)
{
    for (int i = 0; i < r->n_goals; i++) {
        if (!r->goals[i].weighted) {
            return true;
        }
    }
    return false;
}

/* Sentence about limits that scale the objective "vibration": which designs keep all of
 * them. */
static const char *scale_text(const answer *a, mt_arena *mem)
{
    static const double WHOLE = 100.0; /* percent of a limit */
    const mt_result *const r = a->result;
    const double most = WHOLE * (1.0 + (MT_DEFAULT_TOLERANCE_PERCENT / WHOLE));
    int kept = 0;
    const char *list = "";
    for (int i = 0; i < r->n_recommendations && list != NULL; i++) {
        const mt_recommendation *const design = &r->recommendations[i];
        if (design->n_objectives > 0 && design->objectives[0].recommended <= most) {
            list = mt_arena_printf(mem, "%s%s %d", list, kept > 0 ? "," : "", design->rank);
            kept++;
        }
    }
    if (list == NULL) {
        return NULL;
    }
    return kept == 0 ? "no recommendation keeps all limits of vibration"
           : kept == r->n_recommendations
               ? "all limits of vibration are kept"
               : mt_arena_printf(mem,
                                 "all limits of vibration are kept by recommendation%s%s alone",
                                 kept == 1 ? "" : "s", list);
}

/* Of a study that makes vibration least. */
static const char *least_text(const answer *a, const mt_recommendation *best,
                              const char *warning, mt_arena *mem)
{
    const int n = a->found.n_solutions;
    const char *const scale = scale_text(a, mem);
    return scale == NULL ? NULL
                         : mt_arena_printf(mem, "Solved: %d distinct design%s%s; %s.%s", n,
                                           n == 1 ? "" : "s",
                                           !has_goals(best) ? ""
                                           : n == 1         ? " meets all goals"
                                                            : " meet all goals",
                                           scale, warning);
}

/* Of a study with bands. */
static const char *placed_text(const answer *a, const char *warning, mt_arena *mem)
{
    const int n = a->found.n_solutions;
    const bool some = mt_describe_placements_unsearched(&a->placements);
    const char *const left = mt_describe_placements_left(&a->placements, mem);
    const char *const keep = some     ? n == 1 ? "was found to keep" : "were found to keep"
                             : n == 1 ? "keeps"
                                      : "keep";
    return left == NULL
               ? NULL
               : mt_arena_printf(mem,
                                 "Solved: %d of %.0f mode placement%s %s clear of the bands "
                                 "and meet%s all goals (%s).%s",
                                 n, a->placements.n_possible,
                                 a->placements.n_possible > 1.0 ? "s" : "", keep,
                                 n == 1 && !some ? "s" : "", left, warning);
}

static const char *solved_text(const answer *a, const char *warning, mt_arena *mem)
{
    const int n = a->found.n_solutions;
    if (a->placements.n_solutions > 0) {
        return placed_text(a, warning, mem);
    }
    bool continuum = false;
    for (int i = 0; i < n; i++) {
        continuum = continuum || a->found.solutions[i].continuum;
    }
    if (continuum) {
        return n == 1 ? mt_arena_printf(mem,
                                        "Solved: a continuum of equally good designs meets all "
                                        "goals; one of it is recommended.%s",
                                        warning)
                      : mt_arena_printf(mem,
                                        "Solved: %d distinct designs, or continua of equally "
                                        "good designs, meet all goals.%s",
                                        n, warning);
    }
    const char *const many = n == 1 ? " meets" : "s meet";
    if (!mt_objective_is(a->p->stages[0].type, MT_RESIDUALS)) {
        return mt_arena_printf(mem, "Solved: %d distinct design%s all goals.%s", n, many,
                               warning);
    }
    const double least = shown_misfit(a->found.solutions[0].f);
    return n == 1
               ? mt_arena_printf(mem,
                                 "Solved: 1 distinct design meets all goals without a weight; "
                                 "those with a weight have a misfit of %.4g.%s",
                                 least, warning)
               : mt_arena_printf(mem,
                                 "Solved: %d distinct designs meet all goals without a weight; "
                                 "those with a weight have misfits from %.4g to %.4g.%s",
                                 n, least, shown_misfit(a->found.solutions[n - 1].f), warning);
}

/* The search of a fit ended at a least misfit. */
static bool is_fitted(const answer *a, const mt_recommendation *best)
{
    return a->searched && best->rank > 0 && best->feasible && mt_describe_is_optimum(best) &&
           a->found.stop != MT_STOP_MAX_EVALS && mt_study_is_fit(a->study);
}

/* "; 2 designs fit exactly; another local minimum has a misfit above 0" */
static const char *exact_text(const answer *a, mt_arena *mem)
{
    const int n = a->found.n_solutions;
    int exact = 0;
    int continua = 0;
    while (exact < n && !(shown_misfit(a->found.solutions[exact].f) > 0.0)) {
        continua += a->found.solutions[exact++].continuum ? 1 : 0;
    }
    const char *const more = continua == 0       ? ""
                             : continua == exact ? ", each in a continuum of others"
                                                 : ", some in a continuum of others";
    const char *const all =
        exact < 2 ? "" : mt_arena_printf(mem, "; %d designs have it%s", exact, more);
    const char *const rest =
        exact == n ? ""
        : exact + 1 == n
            ? "; another local minimum has a misfit above 0"
            : mt_arena_printf(mem, "; %d other local minima have misfits above 0", n - exact);
    return all == NULL || rest == NULL ? NULL : mt_arena_printf(mem, "%s%s", all, rest);
}

/* "; 4 other local minima have 1.3 to 57 times it" */
static const char *others_text(const answer *a, mt_arena *mem)
{
    const int n = a->found.n_solutions;
    const double least = shown_misfit(a->found.solutions[0].f);
    if (!(least > 0.0)) {
        return exact_text(a, mem);
    }
    if (n < 2) {
        return "";
    }
    const double first = shown_misfit(a->found.solutions[1].f) / least;
    const double last = shown_misfit(a->found.solutions[n - 1].f) / least;
    return n == 2 ? mt_arena_printf(mem, "; another local minimum has %.3g times it", first)
                  : mt_arena_printf(mem, "; %d other local minima have %.3g to %.3g times it",
                                    n - 1, first, last);
}

/* Text such as "; c at its lower bound": the data would need a value beyond the bound. */
static const char *bounds_text(const mt_recommendation *best, mt_arena *mem)
{
    const char *text = "";
    for (int i = 0; i < best->n_parameters && text != NULL; i++) {
        const mt_result_parameter *const p = &best->parameters[i];
        if (p->at_bound != NULL) {
            text =
                mt_arena_printf(mem, "%s; %s is at its %s bound", text, p->name, p->at_bound);
        }
    }
    return text;
}

static const char *fit_text(const answer *a, const mt_recommendation *best, mt_arena *mem)
{
    const char *const rest = others_text(a, mem);
    const char *const bounds = bounds_text(best, mem);
    if (rest == NULL || bounds == NULL) {
        return NULL;
    }
    const bool fitted = is_fitted(a, best);
    const bool several =
        a->found.n_solutions > 1 && !(shown_misfit(a->found.solutions[1].f) > 0.0);
    const char *const end = fitted ? ""
                            : mt_describe_is_optimum(best)
                                ? ", when the evaluations ran out"
                                : ", which is not shown to be a local minimum";
    return mt_arena_printf(
        mem, "%s: the least misfit found from %d start%s is %.4g%s%s%s%s.",
        fitted ? "Fitted" : "Not converged", a->found.starts, a->found.starts == 1 ? "" : "s",
        mt_without_noise(best->misfit, MT_RATIO_NOISE), end,
        a->found.solutions[0].continuum && !several ? "; a continuum of designs has it" : "",
        bounds, rest);
}

static const char *nothing_text(const answer *a)
{
    return a->why.code != MT_OK ? "No design that was tried could be evaluated."
           : a->found.stop == MT_STOP_MAX_EVALS
               ? "The budget ended before any design was found."
               : "No design was found within the bounds (sampled, not proven).";
}

static const char *compromise_text(const answer *a, const mt_recommendation *best,
                                   mt_arena *mem)
{
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
                     a->impossible ? ", which is proven (see \"What is proven\")"
                                   : " (sampled, not proven)",
                     nearest);
}

static const char *status_text(const answer *a, const mt_recommendation *best)
{
    mt_arena *const mem = &a->result->mem;
    const char *const incumbent = incumbent_text(a, best);
    if (incumbent != NULL) {
        return incumbent;
    }
    if (a->infeasible) {
        return mt_arena_printf(mem,
                               "Infeasible: no design within the bounds meets all goals, which "
                               "is proven (see \"What is proven\").%s%s",
                               a->result->n_relaxations > 0 ? " " : "",
                               a->result->n_relaxations > 0 ? a->result->relaxations[0].text
                                                            : "");
    }
    if (a->found.n_solutions == 0) {
        return nothing_text(a);
    }
    if (best->feasible && mt_study_is_fit(a->study)) {
        return fit_text(a, best, mem);
    }
    if (a->unsearched) {
        return "Solved: the original design meets all goals; nothing has to change.";
    }
    const char *const warning =
        is_original_best(a) ? " The original design meets all goals; nothing has to change."
        : mt_describe_is_optimum(best)
            ? ""
            : mt_arena_printf(
                  mem, " The best is not shown to be a local optimum (KKT residual %.2g).",
                  best->kkt_residual);
    if (warning == NULL) {
        return NULL;
    }
    if (best->feasible && a->placements.n_solutions == 0 &&
        mt_objective_is(a->p->stages[0].type, MT_SHAKES)) {
        return least_text(a, best, warning, mem);
    }
    if (best->feasible) {
        return solved_text(a, warning, mem);
    }
    if (is_doubtful(best)) {
        return "Compromise: the numbers of all goals can be met, but there the named modes "
               "cannot be identified (see the goals).";
    }
    return compromise_text(a, best, mem);
}

static mt_result_status status_of(const answer *a, const mt_recommendation *best)
{
    if (mt_describe_is_doubted(a->result)) {
        return MT_RESULT_COMPROMISE;
    }
    if (a->infeasible) {
        return MT_RESULT_INFEASIBLE;
    }
    if (a->searched && mt_study_is_fit(a->study)) {
        return is_fitted(a, best) ? MT_RESULT_FITTED : MT_RESULT_COMPROMISE;
    }
    /* the baseline is no answer of a search */
    return best->feasible && (best->rank > 0 || !a->searched) ? MT_RESULT_SOLVED
                                                              : MT_RESULT_COMPROMISE;
}

/* Puts the warning of an equilibrium far from the reference position before the status
 * sentence. */
static void report_posture(mt_result *result)
{
    for (int i = 0; i < result->n_facts && result->status_text != NULL; i++) {
        const mt_warning *const d = &result->facts[i];
        if (mt_warnings_settles_far(d)) {
            result->status_text = mt_arena_printf(
                &result->mem, "%s%s%s. %s", d->configuration == NULL ? "" : d->configuration,
                d->configuration == NULL ? "" : ": ", d->text, result->status_text);
            return;
        }
    }
}

/* Status and its sentence. */
static mt_status set_status(const answer *a, mt_err *err)
{
    mt_result *const result = a->result;
    const mt_recommendation *const best =
        result->n_recommendations > 0 ? &result->recommendations[0] : &result->baseline;
    result->status = status_of(a, best);
    result->status_text = status_text(a, best);
    report_posture(result);
    return mt_arena_check(&result->mem, err);
}

/* Total work, except for the points of a trade study, which have their own counters. */
static void note_work_counters(const answer *a)
{
    const mt_work_counters *const s = a->spent;
    mt_result_run *const run = &a->result->run;
    mt_result_work_counters *const to = &run->spent;
    long *const designs[PHASE_COUNT] = {[PHASE_BASELINE] = &to->descriptions,
                                        [PHASE_SEARCH] = &to->search,
                                        [PHASE_RECOMMENDATIONS] = &to->descriptions,
                                        [PHASE_WEIGHT_SENSITIVITY] = &to->weight_sensitivity,
                                        [PHASE_CERTIFICATES] = &to->search,
                                        [PHASE_RELAXATIONS] = &to->relaxations,
                                        [PHASE_PUBLISHED] = &to->descriptions,
                                        [PHASE_TRADE] = &to->trade};
    for (int k = 0; k < PHASE_COUNT; k++) {
        *designs[k] += mt_work_counters_in(s, k, MT_WORK_DESIGNS);
    }
    to->positions += mt_work_counters_of(s, MT_WORK_POSITIONS);
    to->multiplications += mt_work_counters_of(s, MT_WORK_MULTIPLICATIONS);
    run->modal_solutions += mt_work_counters_of(s, MT_WORK_MODAL);
    run->evaluations = to->search + to->positions + to->descriptions + to->weight_sensitivity +
                       to->relaxations + to->trade;
}

/* After all phases: status and list of what an interrupt cut. */
static mt_status note_cuts(const answer *a, mt_err *err)
{
#define PHASE_NAME(id, name, makes_ready, work) name,
    static const char *const names[] = {PHASE_LIST(PHASE_NAME)};
#undef PHASE_NAME
    mt_result *const result = a->result;
    mt_result_run *const run = &result->run;
    if (!mt_interrupt_any(a->interrupt)) {
        return MT_OK;
    }
    run->incomplete = mt_arena_alloc(&result->mem, PHASE_COUNT, sizeof *run->incomplete);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int k = 0; k < PHASE_COUNT; k++) {
        if (mt_interrupt_is_cut(a->interrupt, k)) {
            run->incomplete[run->n_incomplete++] = names[k];
        }
    }
    const char *list = run->incomplete[0]; /* "search, certificates and trade" */
    for (int i = 1; i < run->n_incomplete && list != NULL; i++) {
        const char *const link = i + 1 < run->n_incomplete ? ", " : " and ";
        list = mt_arena_printf(&result->mem, "%s%s%s", list, link, run->incomplete[i]);
    }
    const bool late = mt_interrupt_reason(a->interrupt) == MT_STOP_REASON_TIME_LIMIT;
    result->status = late ? MT_RESULT_TIME_LIMIT : MT_RESULT_INTERRUPTED;
    run->cut_by = late ? "time limit" : "interrupt";
    result->status_text = mt_arena_printf(&result->mem, "%s (not complete: %s). %s",
                                          late ? "Stopped at the time limit" : "Interrupted",
                                          list, result->status_text);
    return mt_arena_check(&result->mem, err);
}

/* The phases in order. */

/* True where the study requests what this phase writes. */
static bool is_asked(const answer *a, phase_id which)
{
    switch (which) {
    case PHASE_WEIGHT_SENSITIVITY:
        return a->searched && is_sensitivity_to_weights_asked(a->p);
    case PHASE_PUBLISHED:
        return a->study->n_published > 0;
    case PHASE_TRADE:
        return a->study->trade.n_vary > 0;
    case PHASE_SEARCH:
    case PHASE_RECOMMENDATIONS:
    case PHASE_CERTIFICATES:
    case PHASE_RELAXATIONS:
        return a->searched;
    case PHASE_BASELINE:
    case PHASE_COUNT:
        break;
    }
    return true;
}

/* True where the phase lacks its input: a search that was cut, or a recommendation that was not
 * found. */
static bool is_groundless(const answer *a, phase_id which)
{
    const mt_interrupt *const i = a->interrupt;
    const bool cut =
        mt_interrupt_is_cut(i, PHASE_SEARCH) || mt_interrupt_is_cut(i, PHASE_RECOMMENDATIONS);
    if (which == PHASE_RECOMMENDATIONS) {
        return false;
    }
    if (which == PHASE_PUBLISHED) {
        return cut && a->result->n_recommendations == 0;
    }
    return cut || (which == PHASE_TRADE && mt_interrupt_any(i));
}

/* "k = 1200 N/m, m = 2 kg", with all digits. */
static const char *values_text(const mt_problem *p, const double *x, mt_arena *mem)
{
    const char *text = "";
    for (int k = 0; k < p->n; k++) {
        const mt_variable *const v = &p->study->variables[k];
        text = mt_arena_printf(mem, "%s%s%s = %.17g%s%s", text, k > 0 ? ", " : "",
                               v->parameter_name.s, mt_unit_written(v->shown, x[k]),
                               v->shown == NULL ? "" : " ", mt_unit_name(v->shown, ""));
    }
    return text;
}

/* The values of designs that were not re-checked before the time ran out: hours of search may
 * be in them. */
static mt_status report_undescribed(const answer *a, mt_err *err)
{
    mt_result *const r = a->result;
    const mt_problem *const p = a->p;
    const int asked = a->study->recommendations;
    const int last = a->found.n_solutions < asked ? a->found.n_solutions : asked;
    const int first = r->n_recommendations;
    const int n = last > first ? last - first : 0;
    r->unchecked = mt_arena_alloc(&r->mem, (size_t)n, sizeof *r->unchecked);
    MT_TRY(mt_arena_check(&r->mem, err));
    for (int i = 0; i < n; i++) {
        mt_unchecked *const u = &r->unchecked[i];
        u->values = mt_arena_f64(&r->mem, (size_t)p->n, 1);
        MT_TRY(mt_arena_check(&r->mem, err));
        mt_subproblem_x(&a->asked, a->found.solutions[first + i].t, u->values);
        u->text = values_text(p, u->values, &r->mem);
        r->n_unchecked++;
    }
    return mt_arena_check(&r->mem, err);
}

/* Result of a phase that was cut. */
static mt_status leave(answer *a, phase_id which, mt_err *err)
{
    mt_result_take_back(a->result, &a->mark);
    if (which == PHASE_SEARCH) {
        /* nothing counts but the designs that it met: they are judged anew */
        a->found.stop = MT_STOP_USER;
        a->found.n_unidentifiable = 0;
        a->found.n_once = 0;
        a->found.missing = nan("");
        a->why = (mt_err){.code = MT_OK};
        a->result->run.distinct_designs = -1;
        a->result->run.singletons = -1;
        a->result->run.estimated_unseen = nan("");
        a->result->run.n_history = 0;
    } else if (which == PHASE_RECOMMENDATIONS) {
        return report_undescribed(a, err);
    } else if (which == PHASE_CERTIFICATES) {
        a->infeasible = false;
        a->impossible = false;
    }
    return MT_OK;
}

static mt_status phase(answer *a, phase_id which, mt_err *err)
{
#define PHASE_WORK(id, name, makes_ready, work) {name, makes_ready, work},
    static const struct {
        const char *name;
        bool makes_ready;
        mt_status (*work)(answer *a, mt_err *err);
    } phases[] = {PHASE_LIST(PHASE_WORK)};
#undef PHASE_WORK
    mt_err own = {.code = MT_OK};
    if (!is_asked(a, which)) {
        return MT_OK;
    }
    if (is_groundless(a, which)) {
        mt_interrupt_cut(a->interrupt, (int)which);
        return MT_OK;
    }
    a->mark = mt_result_get_mark(a->result);
    a->task_path = mt_task_path_enter(a->whole, phases[which].name);
    mt_interrupt_enter(a->interrupt, (int)which, phases[which].makes_ready);
    a->spent->phase = (int)which;
    mt_progress_phase(a->p->run->progress, phases[which].name, which == PHASE_SEARCH);
    const mt_status rc = phases[which].work(a, &own);
    const bool cut = mt_interrupt_is_cut(a->interrupt, (int)which);
    if (rc != MT_OK && !(cut && !mt_is_final(rc))) {
        return mt_fail(err, rc, "%s", own.text);
    }
    return cut ? leave(a, which, err) : MT_OK;
}

/*
 * What eigenvalues may lose while designs are looked for: nothing that a goal would feel. A
 * polish takes second derivatives by differences of slopes and wants more than goals do.
 * Numbers of a result are computed anew, to MT_MODAL_ACCURACY.
 */
static const double SEARCH_ACCURACY = 1e-10;
static const double OF_TOLERANCE = 1e-3;

static double search_accuracy(const mt_problem *p)
{
    double least = SEARCH_ACCURACY;
    for (int i = 0; i < p->n_requirements; i++) {
        least = fmin(least, OF_TOLERANCE * p->requirements[i].tolerance);
    }
    for (int i = 0; i < p->n_avoidances; i++) {
        least = fmin(least, OF_TOLERANCE * p->avoidances[i].tolerance);
    }
    return fmax(least, MT_MODAL_ACCURACY);
}

/* Beside a neighbour: the original design, the neighbour's, and one from afar; of what misses
 * the goals least, where no design meets them, without that. */
enum { STARTS_AGREE = 3, STARTS_OF_MISS = 2 };

/* A workspace for each worker. */
static mt_status open_workers(answer *a, int threads, mt_err *err)
{
    const bool alone = threads < 1 || a->study->n_variables == 0;
    const int n = alone ? 1 : threads < MT_WORKERS_MOST ? threads : MT_WORKERS_MOST;
    const mt_neighbour *const near = a->q->neighbour;
    a->asked = a->p->whole;
    a->asked.search.agree = near == NULL || !near->alone ? 0
                            : near->impossible           ? STARTS_OF_MISS
                                                         : STARTS_AGREE;
    a->asked.search.impossible = near != NULL && near->impossible;
    a->workers = mt_arena_alloc(&a->mem, (size_t)n, sizeof(mt_workspace *));
    MT_TRY(mt_arena_check(&a->mem, err));
    for (int i = 0; i < n; i++) {
        MT_TRY(mt_workspace_new(a->p, &a->workers[i], err));
        a->workers[i]->accuracy = search_accuracy(a->p);
        /* tasks have places of their own */
        a->workers[i]->task_path = i == 0 ? &a->task_path : NULL;
        mt_workspace_back(a->workers[i], &a->asked);
        a->n_workers = i + 1;
    }
    return MT_OK;
}

/* The caller's design as one more start of every search. */
static mt_status take_hint(answer *a, const double *hint, mt_err *err)
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

/* Workers, and the original design, without which there is nothing to tell. */
static mt_status start_workers_and_baseline(answer *a, const mt_solve_options *opt, mt_err *err)
{
    mt_err own = {.code = MT_OK};
    mt_interrupt_enter(a->interrupt, PHASE_BASELINE, true);
    a->spent->phase = PHASE_BASELINE;
    mt_status rc = open_workers(a, opt->threads, &own);
    rc = rc == MT_OK ? run_baseline(a, &own) : rc;
    MT_TRY(end_at_once(a->q, rc, &own, err));
    a->workers[0]->progress = opt->progress; /* the first worker's: one line at a time */
    a->workers[0]->progress_context = opt->progress_context;
    a->searched = a->p->n > 0 && (a->p->n_requirements > 0 || a->p->n_avoidances > 0);
    if (a->searched && opt->progress != NULL) { /* however few designs its worker evaluates */
        opt->progress(opt->progress_context, "searching: the first designs are evaluated");
    }
    return opt->hint != NULL ? take_hint(a, opt->hint, err) : MT_OK;
}

/* A list that a phase did not get to is NULL, one that it found nothing for is empty. */
static void *kept(const answer *a, phase_id which, void *list, int n)
{
    const bool cut = mt_interrupt_is_cut(a->interrupt, (int)which);
    if (list == NULL && !cut) {
        return mt_arena_alloc(&a->result->mem, 0, 1);
    }
    return n == 0 && cut ? NULL : list;
}

static mt_status report_cut_lists(answer *a, mt_err *err)
{
    mt_result *const r = a->result;
    r->unidentifiable = kept(a, PHASE_SEARCH, r->unidentifiable, r->n_unidentifiable);
    r->weight_sensitivity =
        kept(a, PHASE_WEIGHT_SENSITIVITY, r->weight_sensitivity, r->n_weight_sensitivity);
    r->certificates = kept(a, PHASE_CERTIFICATES, r->certificates, r->n_certificates);
    r->relaxations = kept(a, PHASE_RELAXATIONS, r->relaxations, r->n_relaxations);
    r->published = kept(a, PHASE_PUBLISHED, r->published, r->n_published);
    return mt_arena_check(&r->mem, err);
}

/* A run for a part of the work: the tasks that need no result of other parts. Their results are
 * in the store; the answer, of what is known, is cut. */
static mt_status conduct_part(answer *a, mt_err *err)
{
    static const phase_id lists[] = {PHASE_SEARCH, PHASE_TRADE};
    for (int i = 0; i < MT_COUNT(lists) && !mt_interrupt_any(a->interrupt); i++) {
        mt_err own = {.code = MT_OK};
        const mt_status rc = phase(a, lists[i], &own);
        if (rc != MT_OK && rc != MT_E_INTERRUPTED) {
            return mt_fail(err, rc, "%s", own.text);
        }
    }
    return MT_OK;
}

/* All that follows a search. */
static mt_status conclude(answer *a, mt_err *err)
{
    MT_TRY(phase(a, PHASE_RECOMMENDATIONS, err));
    MT_TRY(phase(a, PHASE_WEIGHT_SENSITIVITY, err));
    MT_TRY(phase(a, PHASE_CERTIFICATES, err));
    if (mt_describe_is_doubted(a->result)) {
        MT_TRY(mt_describe_withdraw(a->result, err));
    }
    MT_TRY(phase(a, PHASE_RELAXATIONS, err));
    MT_TRY(warn_of_search(a, err));
    a->result->run.starts = a->found.starts;
    MT_TRY(set_status(a, err));
    MT_TRY(phase(a, PHASE_PUBLISHED, err));
    MT_TRY(report_cut_lists(a, err));
    MT_TRY(mt_describe_own(a->study, a->result, err));
    MT_TRY(phase(a, PHASE_TRADE, err));
    note_work_counters(a);
    return note_cuts(a, err);
}

static mt_status incumbent_result(answer *now, mt_err *err)
{
    now->spent->phase = PHASE_BASELINE;
    MT_TRY(run_baseline(now, err));
    MT_TRY(take_placements(now, err));
    now->found.n_solutions = 1;
    now->mark = mt_result_get_mark(now->result);
    mt_interrupt_cut(now->interrupt, PHASE_SEARCH);
    MT_TRY(leave(now, PHASE_SEARCH, err));
    return conclude(now, err);
}

static mt_status tell_incumbent(void *context, const mt_mode_placement_result *found,
                                mt_err *err)
{
    const answer *const a = context;
    mt_interrupt own;       /* the whole is not cut by what this leaves out */
    mt_work_counters spent; /* nor does it pay for what is told early */
    answer now = *a;
    mt_interrupt_init(&own, a->interrupt->request, a->interrupt->context, NULL);
    now.interrupt = &own;
    mt_work_counters_copy(a->spent, &spent);
    now.spent = &spent;
    a->q->run.work = &spent;
    now.mem = (mt_arena){.first = NULL};
    now.placements = *found;
    now.result = NULL;
    mt_status rc = mt_arena_init(&now.mem, 0, err);
    rc = rc == MT_OK ? mt_result_new(&now.result, err) : rc;
    rc = rc == MT_OK ? incumbent_result(&now, err) : rc;
    a->q->run.work = a->spent;
    if (!mt_interrupted(a->interrupt)) { /* else that brings it about */
        rc = rc == MT_OK ? a->incumbent->tell(a->incumbent->context, now.result, err) : rc;
    } else if (!mt_is_final(rc)) {
        rc = MT_OK;
    }
    mt_result_delete(now.result);
    mt_arena_free(&now.mem);
    return rc;
}

static mt_status conduct(answer *a, mt_err *err)
{
    if (a->whole != NULL && a->whole->store != NULL && a->whole->store->parts > 0 &&
        !a->whole->inner) {
        return conduct_part(a, err);
    }
    MT_TRY(phase(a, PHASE_SEARCH, err));
    return conclude(a, err);
}

mt_status mt_question_answer(mt_question *q, const mt_solve_options *opt,
                             const mt_task_path *task_path,
                             const mt_incumbent_callback *incumbent, mt_result **out,
                             mt_err *err)
{
    answer a = {.q = q, .study = q->study, .p = q->p, .interrupt = &q->interrupt};
    a.spent = &q->spent;
    a.threads = opt->threads;
    a.whole = task_path;
    a.incumbent = incumbent;
    *out = NULL;
    mt_status rc = mt_arena_init(&a.mem, 0, err);
    rc = rc == MT_OK ? mt_result_new(&a.result, err) : rc;
    rc = rc == MT_OK ? start_workers_and_baseline(&a, opt, err) : rc;
    rc = rc == MT_OK ? conduct(&a, err) : rc;
    for (int i = 0; i < a.n_workers; i++) {
        mt_workspace_delete(a.workers[i]);
    }
    mt_arena_free(&a.mem);
    if (rc != MT_OK) {
        mt_result_delete(a.result);
        return rc;
    }
    *out = a.result;
    return MT_OK;
}

mt_status mt_study_solve(const mt_study *study, const mt_solve_options *opt, mt_result **out,
                         mt_err *err)
{
    return mt_study_solve_with(study, opt, NULL, NULL, out, err);
}

mt_status mt_study_solve_with(const mt_study *study, const mt_solve_options *opt,
                              const mt_run *run, const mt_incumbent_callback *incumbent,
                              mt_result **out, mt_err *err)
{
    mt_solve_options use;
    mt_question q = {.p = NULL};
    MT_NOT_NULL(out, err);
    *out = NULL;
    MT_NOT_NULL(study, err);
    MT_TRY(MT_OPTIONS_TAKE(opt, &use, err));
    run = mt_run_or_none(run);
    mt_progress_phase(run->progress, "baseline", false);
    for (int i = 0; use.hint != NULL && i < study->n_variables; i++) {
        if (!isfinite(use.hint[i])) {
            return mt_fail(err, MT_E_USAGE, "mt_study_solve: hint[%d] is not finite", i);
        }
    }
    mt_status rc = mt_question_init(&q, study, run, &use, err);
    const mt_task_path whole = {.store = run->tasks != NULL ? run->tasks->store : NULL,
                                .interrupt = &q.interrupt,
                                .progress = run->progress};
    rc = rc == MT_OK ? mt_question_answer(&q, &use, &whole, incumbent, out, err) : rc;
    mt_question_free(&q);
    return rc;
}
