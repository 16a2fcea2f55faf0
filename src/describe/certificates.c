/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a study's answer may claim as proven, in sentences; and whether it is a proof that no
 * design exists. */
#include "describe/certificates.h"

#include <math.h>
#include <stdarg.h>

#include "describe/describe.h"
#include "problem/configuration.h"
#include "problem/requirement.h"
#include "prove/certify.h"
#include "search/proof.h"

static mt_status state(mt_result *result, const char *kind, bool proven, mt_err *err,
                       const char *fmt, ...) MT_PRINTF(5, 6);

static mt_status state(mt_result *result, const char *kind, bool proven, mt_err *err,
                       const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    const char *const text = mt_arena_vprintf(&result->mem, fmt, args);
    va_end(args);
    return mt_describe_certificate(result, kind, proven, text, err);
}

mt_status mt_describe_certificate(mt_result *result, const char *kind, bool proven,
                                  const char *text, mt_err *err)
{
    int capacity = result->n_certificates;
    mt_certificate *const grown = mt_arena_grow(
        &result->mem, result->certificates, result->n_certificates, &capacity, sizeof *grown);
    MT_TRY(mt_arena_check(&result->mem, err));
    result->certificates = grown;
    mt_certificate *const c = &result->certificates[result->n_certificates++];
    *c = mt_certificate_default();
    c->kind = kind;
    c->text = text;
    c->proven = proven;
    return MT_OK;
}

bool mt_describe_placements_unsearched(const mt_mode_placement_result *placements)
{
    return placements->ended &&
           (!placements->proven || placements->n_searched < placements->n_candidates);
}

/* A least change to four digits, never above what is proven. */
static double shown_least(double rest)
{
    static const double DIGITS = 1e3;
    const double change = sqrt(2.0 * rest);
    const double unit = change > 0.0 ? pow(10.0, floor(log10(change))) / DIGITS : 1.0;
    return floor(change / unit) * unit;
}

/* Describe a search that ended when no other placement could give one of the requested
 * designs. */
static mt_status describe_best_first(const mt_mode_placement_result *placements,
                                     mt_result *result, mt_err *err)
{
#define WHICH "which of the others can be met is not known"
    const int open = placements->n_searched - placements->n_feasible;
    const bool unknown = isfinite(placements->rest);
    if (placements->proven) {
        MT_TRY(state(result, "gap_assignments", true, err,
                     "Of %.0f mode placements %d can be met within the bounds; all others are "
                     "proven infeasible (branch and bound, %ld boxes).",
                     placements->n_possible, placements->n_candidates, placements->boxes));
    }
    if (unknown) {
        MT_TRY(
            state(result, "least_change", true, err,
                  "%d of %.0f mode placements were searched, in the order of the least "
                  "change that each can do with by bounds of its stiffnesses and masses. "
                  "Every design in one of the others changes by %.4g or more%s.",
                  placements->n_searched, placements->n_possible, shown_least(placements->rest),
                  placements->bounded ? ""
                                      : ", which leaves open whether one is better than those "
                                        "recommended"));
    } else if ((double)placements->n_searched < placements->n_possible && !placements->proven) {
        MT_TRY(state(result, "gap_assignments", true, err,
                     "%d of %.0f mode placements were searched; by bounds of the stiffnesses "
                     "and masses the others have no design within the bounds.",
                     placements->n_searched, placements->n_possible));
    }
    if (!placements->proven && open > 0) {
        MT_TRY(state(result, "gap_assignments", false, err,
                     "In %d of the %d mode placements that were searched no design was found "
                     "that meets all goals%s (no proof: %s).",
                     open, placements->n_searched, unknown ? ", and " WHICH : "",
                     placements->reason));
    } else if (!placements->proven && unknown) {
        MT_TRY(state(result, "gap_assignments", false, err,
                     "All that were searched have a design, and " WHICH " (no proof: %s).",
                     placements->reason));
    }
    return state(result, "optimality", false, err,
                 "Each design is the best of its mode placement: %d starts found none better.",
                 placements->starts);
#undef WHICH
}

static mt_status describe_placements(const mt_mode_placement_result *placements,
                                     mt_result *result, bool infeasible, mt_err *err)
{
    if (infeasible) {
        return state(
            result, "infeasible", true, err,
            "No design within the bounds keeps clear of the bands and meets the other limits: "
            "all %.0f mode placements are proven infeasible (branch and bound, %ld boxes).",
            placements->n_possible, placements->boxes);
    }
    if (mt_describe_placements_unsearched(placements)) {
        return describe_best_first(placements, result, err);
    }
    if (placements->proven) {
        const int open = placements->n_candidates - placements->n_feasible;
        MT_TRY(open == 0
                   ? state(result, "gap_assignments", true, err,
                           "Of %.0f mode placements %d can be met within the bounds; all "
                           "others are proven infeasible (branch and bound, %ld boxes).",
                           placements->n_possible, placements->n_candidates, placements->boxes)
                   : state(result, "gap_assignments", true, err,
                           "Of %.0f mode placements all but %d are proven infeasible (branch "
                           "and bound, %ld boxes%s); in %d of these no design was found that "
                           "meets all goals, which is sampled.",
                           placements->n_possible, placements->n_candidates, placements->boxes,
                           placements->tolerances ? ", the tolerances of the variables left out"
                                                  : "",
                           open));
        return state(
            result, "optimality", false, err,
            "Each design is the best of its mode placement: %d starts found none better.",
            placements->starts);
    }
    return state(result, "gap_assignments", false, err,
                 "%d of %.0f mode placements were searched; the others were ruled out by "
                 "samples, not by proof (no proof: %s).",
                 placements->n_candidates, placements->n_possible,
                 placements->reason != NULL && placements->reason[0] != '\0'
                     ? placements->reason
                     : "not asked for");
}

const char *mt_describe_placements_left(const mt_mode_placement_result *placements,
                                        mt_arena *mem)
{
    const int open = (placements->ended ? placements->n_searched : placements->n_candidates) -
                     placements->n_feasible;
    const bool excluded =
        placements->proven || (placements->ended && !isfinite(placements->rest));
    if (placements->ended && placements->bounded && isfinite(placements->rest)) {
        return "those that were not searched change more, which is proven";
    }
    if (!excluded || (placements->ended && !placements->bounded)) {
        return "sampled, not proven";
    }
    return open == 0
               ? "the others proven infeasible"
               : mt_arena_printf(mem,
                                 "the others proven infeasible, but %d in which no design "
                                 "was found",
                                 open);
}

mt_status mt_describe_placement_certificate(const mt_mode_placement_result *placements,
                                            mt_result *result, bool *infeasible, mt_err *err)
{
    *infeasible = placements->proven && placements->n_candidates == 0;
    MT_TRY(describe_placements(placements, result, *infeasible, err));
    if (!placements->driven) {
        return MT_OK;
    }
    return placements->motion
               ? state(result, "positions", false, err,
                       "All positions of a drive have the same number of modes below each "
                       "band: if two differed, a mode would cross the band between them. "
                       "Between the positions each recommendation is sampled, not proven.")
               : state(result, "positions", false, err,
                       "Statements on driven positions hold at the named positions; between "
                       "them the design space is not searched.");
}

/* Write the frequencies that one limit's mode can reach. */
static mt_status write_reach(const mt_requirement *d, const char *configuration,
                             const mt_certify_reach *r, mt_result *result, mt_err *err)
{
    const bool impossible = r->verdict == MT_VERDICT_IMPOSSIBLE;
    if (isnan(r->low_hz)) {
        return state(result, impossible ? "infeasible" : "range", impossible, err,
                     impossible
                         ? "Goal /goals/%d cannot be met: %s has no mode %d at any design."
                         : "Goal /goals/%d: the range of %s mode %d is not known.",
                     d->goal_index, configuration, d->mode);
    }
    if (impossible) {
        return state(result, "infeasible", true, err,
                     "Goal /goals/%d cannot be met within the bounds: %s mode %d stays between "
                     "%.6g and %.6g Hz (two eigensolves and %ld boxes).",
                     d->goal_index, configuration, d->mode, r->low_hz, r->high_hz, r->boxes);
    }
    return state(result, "range", true, err,
                 "%s mode %d stays between %.6g and %.6g Hz within the bounds.", configuration,
                 d->mode, r->low_hz, r->high_hz);
}

static mt_status describe_reach(const mt_problem *p, const mt_proof *proof, int limit,
                                mt_arena *mem, mt_result *result, bool *infeasible, mt_err *err)
{
    mt_certify_reach r = {0};
    const mt_requirement *const d = &p->requirements[proof->limit_requirement[limit]];
    MT_TRY(mt_certify_reach_of(&proof->question, limit, mem, &r, err));
    *infeasible = *infeasible || r.verdict == MT_VERDICT_IMPOSSIBLE;
    MT_TRY(write_reach(d, mt_configuration_name(p, &p->views[d->view]), &r, result, err));
    mt_certificate *const c = &result->certificates[result->n_certificates - 1];
    c->pointer = mt_arena_printf(&result->mem, "/goals/%d", d->goal_index);
    c->reachable_lower_hz = r.low_hz;
    c->reachable_upper_hz = r.high_hz;
    return mt_arena_check(&result->mem, err);
}

/* boxes: of the search's own proof; 0: it has none. */
static mt_status jointly(const mt_proof *proof, long boxes, mt_arena *mem, mt_result *result,
                         bool *infeasible, mt_err *err)
{
    mt_certify q = proof->question;
    mt_certify_search found = {.proven = boxes > 0, .boxes = boxes};
    q.n_bands = 0;
    MT_TRY(boxes > 0 ? MT_OK : mt_certify_assignments(&q, 0, NULL, mem, &found, err));
    if (found.n_found > 0 || found.stopped) {
        return MT_OK;
    }
    if (!found.proven) {
        return state(result, "infeasible", false, err,
                     "No design was found that meets all limits together; this is not proven: "
                     "the budget of the proof ended after %ld boxes, with %.3g %% of the "
                     "designs within the bounds undecided.",
                     found.boxes, 100.0 * found.undecided);
    }
    *infeasible = true;
    return state(result, "infeasible", true, err,
                 "No design within the bounds meets all limits together: proven by branch and "
                 "bound (%ld boxes).",
                 found.boxes);
}

/* True where a goal is a limit or target of frequencies, which a box may exclude. */
static bool limits_frequency(const mt_problem *p)
{
    bool found = false;
    for (int i = 0; i < p->n_requirements && !found; i++) {
        const mt_requirement *const d = &p->requirements[i];
        found = d->role != MT_ROLE_RESIDUAL &&
                (mt_requirement_is_frequency(d) || mt_requirement_is_pair(d));
    }
    return found;
}

mt_status mt_describe_limit_certificates(const mt_problem *p, long boxes, mt_arena *mem,
                                         mt_result *result, bool *infeasible, mt_err *err)
{
    mt_proof proof;
    *infeasible = p->study->examined && boxes > 0 && limits_frequency(p);
    if (*infeasible) { /* no more is told of a point of a trade study */
        mt_progress_proved(p->run->progress);
        return MT_OK;
    }
    mt_status rc = mt_proof_init(&proof, &p->whole, mem, err);
    if (rc == MT_OK && !proof.possible && proof.reason[0] != '\0') {
        rc = state(result, "infeasible", false, err,
                   "No design was found that meets all goals; this is not proven, because %s.",
                   proof.reason);
    }
    /* one budget for all questions: each limit alone, and all of them together */
    proof.question.max_work = proof.left / (1.0 + (double)proof.question.n_limits);
    for (int i = 0; rc == MT_OK && proof.possible && i < proof.question.n_limits; i++) {
        rc = describe_reach(p, &proof, i, mem, result, infeasible, err);
    }
    if (rc == MT_OK && proof.possible && !*infeasible &&
        proof.question.n_limits + proof.question.n_pairs > 0) {
        rc = jointly(&proof, boxes, mem, result, infeasible, err);
    }
    if (rc == MT_OK && *infeasible) {
        mt_progress_proved(p->run->progress);
    }
    mt_proof_free(&proof);
    return rc;
}
