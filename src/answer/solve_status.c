/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a search ended, in one sentence, and what the engineer should know of it besides its
 * answers. */
#include "answer/solve_priv.h"

#include <math.h>

#include "answer/warnings.h"
#include "base/format.h"
#include "base/number.h"
#include "describe/certificates.h"
#include "describe/describe.h"

/* Warns that further isolated designs are likely where some were met only once. */
static mt_status warn_of_missing(const mt_answer *a, mt_err *err)
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
mt_status mt_answer_warn(const mt_answer *a, mt_err *err)
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
            mt_work_counters_in(&a->q->spent, MT_PHASE_SEARCH,
                                s->by_solutions ? MT_WORK_MODAL : MT_WORK_DESIGNS),
            s->by_solutions ? s->max_modal_solutions : s->max_evaluations,
            mt_search_budget(s)));
    }
    MT_TRY(warn_of_missing(a, err));
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
static const char *incumbent_text(const mt_answer *a, const mt_recommendation *best)
{
    const bool cut = mt_interrupt_is_cut(a->interrupt, MT_PHASE_RECOMMENDATIONS);
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
static const char *scale_text(const mt_answer *a, mt_arena *mem)
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
static const char *least_text(const mt_answer *a, const mt_recommendation *best,
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
static const char *placed_text(const mt_answer *a, const char *warning, mt_arena *mem)
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

static const char *solved_text(const mt_answer *a, const char *warning, mt_arena *mem)
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
static bool is_fitted(const mt_answer *a, const mt_recommendation *best)
{
    return a->searched && best->rank > 0 && best->feasible && mt_describe_is_optimum(best) &&
           a->found.stop != MT_STOP_MAX_EVALS && mt_study_is_fit(a->study);
}

/* "; 2 designs fit exactly; another local minimum has a misfit above 0" */
static const char *exact_text(const mt_answer *a, mt_arena *mem)
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
static const char *others_text(const mt_answer *a, mt_arena *mem)
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

static const char *fit_text(const mt_answer *a, const mt_recommendation *best, mt_arena *mem)
{
    const char *const others = others_text(a, mem);
    const char *const bounds = bounds_text(best, mem);
    if (others == NULL || bounds == NULL) {
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
        bounds, others);
}

static const char *nothing_text(const mt_answer *a)
{
    return a->why.code != MT_OK ? "No design that was tried could be evaluated."
           : a->found.stop == MT_STOP_MAX_EVALS
               ? "The budget ended before any design was found."
               : "No design was found within the bounds (sampled, not proven).";
}

static const char *compromise_text(const mt_answer *a, const mt_recommendation *best,
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

static const char *status_text(const mt_answer *a, const mt_recommendation *best)
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
        mt_answer_original_is_best(a)
            ? " The original design meets all goals; nothing has to change."
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

static mt_result_status status_of(const mt_answer *a, const mt_recommendation *best)
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

mt_status mt_answer_set_status(const mt_answer *a, mt_err *err)
{
    mt_result *const result = a->result;
    const mt_recommendation *const best =
        result->n_recommendations > 0 ? &result->recommendations[0] : &result->baseline;
    result->status = status_of(a, best);
    result->status_text = status_text(a, best);
    report_posture(result);
    return mt_arena_check(&result->mem, err);
}

void mt_answer_note_work_counters(const mt_answer *a)
{
    const mt_work_counters *const s = a->spent;
    mt_result_run *const run = &a->result->run;
    mt_result_work_counters *const to = &run->spent;
    long *const designs[MT_PHASE_COUNT] = {[MT_PHASE_BASELINE] = &to->descriptions,
                                           [MT_PHASE_SEARCH] = &to->search,
                                           [MT_PHASE_RECOMMENDATIONS] = &to->descriptions,
                                           [MT_PHASE_WEIGHT_SENSITIVITY] =
                                               &to->weight_sensitivity,
                                           [MT_PHASE_CERTIFICATES] = &to->search,
                                           [MT_PHASE_RELAXATIONS] = &to->relaxations,
                                           [MT_PHASE_PUBLISHED] = &to->descriptions,
                                           [MT_PHASE_TRADE] = &to->trade};
    for (int k = 0; k < MT_PHASE_COUNT; k++) {
        *designs[k] += mt_work_counters_in(s, k, MT_WORK_DESIGNS);
    }
    to->positions += mt_work_counters_of(s, MT_WORK_POSITIONS);
    to->multiplications += mt_work_counters_of(s, MT_WORK_MULTIPLICATIONS);
    run->modal_solutions += mt_work_counters_of(s, MT_WORK_MODAL);
    run->evaluations = to->search + to->positions + to->descriptions + to->weight_sensitivity +
                       to->relaxations + to->trade;
}

mt_status mt_answer_note_cuts(const mt_answer *a, mt_err *err)
{
#define MT_PHASE_NAME(id, name, makes_ready, work) name,
    static const char *const names[] = {MT_PHASE_LIST(MT_PHASE_NAME)};
#undef MT_PHASE_NAME
    mt_result *const result = a->result;
    mt_result_run *const run = &result->run;
    if (!mt_interrupt_any(a->interrupt)) {
        return MT_OK;
    }
    run->incomplete = mt_arena_alloc(&result->mem, MT_PHASE_COUNT, sizeof *run->incomplete);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int k = 0; k < MT_PHASE_COUNT; k++) {
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
