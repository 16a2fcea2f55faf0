/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a search over catalogues may claim. */
#include "describe/describe_search.h"

#include <math.h>
#include <string.h>

#include "describe/certificates.h"
#include "problem/configuration.h"

/* True where the search is a proof: pure enumeration. A continuous search within each
 * combination is sampled, and a heuristic proves nothing. */
static bool proves(const mt_catalogue_search_report *report)
{
    return report->all && !report->mixed;
}

/* True where branch and bound excludes every combination. */
static bool excluded(const mt_catalogue_search_report *report)
{
    return report->settled && report->n_kinds == 0 && report->feasible == 0;
}

/* True where combinations were left out because none of their designs can be listed. */
static bool leaves_out(const mt_catalogue_search_report *r)
{
    return r->all && !r->branched && (double)r->judged < r->combinations;
}

/* Text of the progress of branch and bound with continuous variables. */
static const char *branched_text(const mt_catalogue_search_report *r, mt_arena *mem,
                                 const char *rest)
{
    if (r->all) {
        return mt_arena_printf(mem,
                               "Of %.6g combinations of catalogue values %d were judged, and "
                               "branch and bound excludes all others: none of them meets all "
                               "goals%s.%s",
                               r->combinations, r->judged,
                               r->feasible > 0 ? " and is better in the first objective than "
                                                 "the best design"
                                               : "",
                               rest);
    }
    const double share = 100.0 * (r->combinations - r->open) / r->combinations;
    const char *const gap = MT_HAS(r->open_within)
                                ? mt_arena_printf(mem, ", which are better by %.3g %% at most",
                                                  100.0 * r->open_within)
                                : "";
    return mt_arena_printf(
        mem,
        "Of %.6g combinations of catalogue values %d were judged; with those "
        "that branch and bound excludes this settles %.3g %%, and its effort "
        "ended before the other %.6g%s%s%s",
        r->combinations, r->judged, share, r->open, gap,
        excluded(r) || MT_HAS(r->best_within) ? " (what is proven of all of them follows)."
                                              : " (heuristic): a better one may exist.",
        rest);
}

static const char *certificate_text(const mt_catalogue_search_report *r,
                                    const mt_nlp_result *found, mt_arena *mem)
{
    const char *const rest =
        r->mixed && !excluded(r)
            ? " The other variables were searched from several starts for each of them, "
              "which is sampled, not proven."
            : "";
    if (r->branched) {
        return branched_text(r, mem, rest);
    }
    if (!r->all) {
        return mt_arena_printf(mem,
                               "Of %.6g combinations of catalogue values %d were judged, near "
                               "the designs of the relaxed problem and their neighbours%s",
                               r->combinations, r->judged,
                               excluded(r) || MT_HAS(r->best_within)
                                   ? " (what is proven of all of them follows)."
                                   : " (heuristic): a better one may exist.");
    }
    if (found->n_solutions == 0 || found->compromise) {
        return mt_arena_printf(mem,
                               "None of the %.0f combinations of catalogue values meets all "
                               "goals: all were enumerated.%s",
                               r->combinations, rest);
    }
    if (leaves_out(r)) {
        return mt_arena_printf(mem,
                               "Enumerated, best first: of %.0f combinations of catalogue "
                               "values %d were judged, and no design of the others can be "
                               "among those asked for.%s",
                               r->combinations, r->judged, rest);
    }
    const char *const between =
        r->broken ? " at the named positions, and not between them"
        : r->driven && r->followed < r->feasible
            ? mt_arena_printf(
                  mem,
                  " at the named positions (%d of these were followed between them, "
                  "those that rank)",
                  r->followed)
        : r->driven ? " (between the named positions by samples)"
                    : "";
    return mt_arena_printf(mem,
                           "Enumerated: all %.0f combinations of catalogue values were "
                           "judged, %d of them meet%s all goals%s.%s",
                           r->combinations, r->feasible, r->feasible == 1 ? "s" : "", between,
                           rest);
}

/* A bound to four digits, never above what is proven. */
static double shown_bound(double bound)
{
    static const double DIGITS = 1e3;
    const double unit = bound != 0.0 ? pow(10.0, floor(log10(fabs(bound)))) / DIGITS : 1.0;
    return floor(bound / unit) * unit;
}

/* What is known of the combinations that an enumeration left out. */
static mt_status describe_left_out(const mt_catalogue_search_report *r, mt_result *result,
                                   mt_err *err)
{
    mt_arena *const mem = &result->mem;
    const double n = r->combinations - (double)r->judged;
    const char *const which = n > 1.0 ? mt_arena_printf(mem, "the other %.0f combinations", n)
                                      : "the one other combination";
    const char *const how = r->excluded == 0 ? "by bounds of the objective"
                            : isfinite(r->beyond)
                                ? "by bounds of the objective and of the modes"
                                : "by bounds of the modes";
    const char *const text =
        isfinite(r->beyond)
            ? mt_arena_printf(mem,
                              "No design of %s meets all goals and %s below %.4g: proven %s.",
                              which, r->by_change ? "has a change" : "has a first objective",
                              shown_bound(r->beyond), how)
            : mt_arena_printf(mem, "No design of %s meets all goals: proven %s.", which, how);
    return mt_describe_certificate(result, "least_objective", true, text, err);
}

static const char *with_others(const mt_catalogue_search_report *r)
{
    return r->mixed ? " and values of the other variables within their bounds" : "";
}

/* Describe which combinations can meet the goals. */
static mt_status describe_kinds(const mt_catalogue_search_report *r, mt_result *result,
                                mt_err *err)
{
    mt_arena *const mem = &result->mem;
    if (r->reason != NULL) {
        return r->feasible > 0 ? MT_OK
                               : mt_describe_certificate(
                                     result, "infeasible", false,
                                     mt_arena_printf(mem,
                                                     "No combination was found that meets all "
                                                     "goals; this is not proven, because %s.",
                                                     r->reason),
                                     err);
    }
    if (excluded(r)) {
        return mt_describe_certificate(
            result, "infeasible", true,
            mt_arena_printf(mem,
                            "No combination of catalogue values%s meets all goals: "
                            "proven by branch and bound (%ld boxes).",
                            with_others(r), r->boxes),
            err);
    }
    if (!r->settled) {
        return mt_describe_certificate(
            result, "gap_assignments", false,
            mt_arena_printf(mem,
                            "The budget of branch and bound ended before all "
                            "combinations were settled (%ld boxes).",
                            r->boxes),
            err);
    }
    if (!(r->n_possible > 1.0)) {
        return MT_OK;
    }
    return mt_describe_certificate(
        result, "gap_assignments", true,
        mt_arena_printf(mem,
                        "Of %.0f mode placements %d %s be met by catalogue values%s; "
                        "all others are proven infeasible (branch and bound).",
                        r->n_possible, r->n_kinds, r->complete ? "can" : "may", with_others(r)),
        err);
}

static mt_status describe_best(const mt_catalogue_search_report *r, mt_result *result,
                               mt_err *err)
{
    mt_arena *const mem = &result->mem;
    const char *const text =
        r->mixed
            ? mt_arena_printf(mem,
                              "No combination of catalogue values%s is better in the first "
                              "objective than the best design by more than %.3g %%: proven "
                              "by branch and bound (%ld boxes).",
                              with_others(r), 100.0 * r->best_within, r->boxes)
            : mt_arena_printf(mem,
                              "No combination of catalogue values is better in the first "
                              "objective than the best design: proven by branch and bound "
                              "(%ld boxes).",
                              r->boxes);
    return mt_describe_certificate(result, "optimal", true, text, err);
}

mt_status mt_describe_catalogue_certificate(const mt_catalogue_search_report *report,
                                            const mt_nlp_result *found, mt_result *result,
                                            bool *infeasible, mt_err *err)
{
    MT_TRY(mt_describe_certificate(result, "enumeration", proves(report),
                                   certificate_text(report, found, &result->mem), err));
    *infeasible =
        excluded(report) || (proves(report) && (found->n_solutions == 0 || found->compromise));
    if (leaves_out(report)) {
        MT_TRY(describe_left_out(report, result, err));
    }
    if (report->asked) {
        MT_TRY(describe_kinds(report, result, err));
    }
    if (report->cut && isnan(report->best_within)) {
        return mt_describe_certificate(
            result, "optimal", false,
            mt_arena_printf(&result->mem,
                            "No combination of catalogue values%s was found that is better in "
                            "the first objective; this is not proven: the budget of branch and "
                            "bound ended after %ld boxes.",
                            with_others(report), report->boxes),
            err);
    }
    return MT_HAS(report->best_within) ? describe_best(report, result, err) : MT_OK;
}

/* Text of the certainty of the order of the combinations. */
static const char *certainty(const mt_catalogue_search_report *r, mt_arena *mem)
{
    if (proves(r)) {
        return "enumerated, which is exact";
    }
    if (MT_HAS(r->best_within)) {
        return r->mixed ? mt_arena_printf(mem, "proven: none is better by more than %.3g %%",
                                          100.0 * r->best_within)
                        : "proven: none is better than the first";
    }
    if (r->branched && r->all) {
        return "branch and bound; the other variables sampled";
    }
    return r->all ? "enumerated; the other variables sampled"
                  : "heuristic: a better one may exist";
}

const char *mt_describe_rank_text(const mt_catalogue_search_report *report,
                                  const mt_nlp_result *found, int rank, const char *objective,
                                  mt_arena *mem)
{
    const char *const how = excluded(report) ? "proven for all" : certainty(report, mem);
    if (found->compromise) {
        return mt_arena_printf(mem,
                               "No combination of catalogue values that was judged meets all "
                               "goals (%d of %.6g, %s); this one comes %s.",
                               report->judged, report->combinations, how,
                               rank == 1 ? "nearest" : "behind those that rank before it");
    }
    return mt_arena_printf(
        mem,
        "Of the combinations of catalogue values it ranks %d by %s (%d of %.6g judged, %s).",
        rank, objective, report->judged, report->combinations, how);
}

/* Moves that let a design exist, as records and sentences. */

static const double PERCENT = 100.0;
/* Sentences of more moves than that do not help. */
enum { MOST = 8 };

static void name_goal(const mt_problem *p, const mt_move *m, mt_arena *mem, mt_relaxation *out)
{
    const mt_requirement *const d = &p->requirements[m->requirement];
    const mt_goal_slot slot = m->target  ? MT_SLOT_EQUALS
                              : m->upper ? MT_SLOT_AT_MOST
                                         : MT_SLOT_AT_LEAST;
    const char *const member = mt_goal_number_name(d->goal, slot);
    out->kind = "goal";
    out->pointer = mt_arena_printf(mem, "/goals/%d", d->goal_index);
    const char *const unit = mt_study_goal_unit(p->study, d->goal);
    const mt_unit *const shown = mt_study_requirement_unit(p->study, &d->goal->expression);
    out->unit = unit[0] != '\0' ? unit : NULL;
    out->display_unit = mt_unit_name(shown, NULL);
    out->display_factor = mt_unit_display(shown);
    out->what = d->view < 0
                    ? mt_arena_printf(mem, "%s of goal %s", member, out->pointer)
                    : mt_arena_printf(mem, "%s of goal %s (\"%s\")", member, out->pointer,
                                      mt_configuration_name(p, &p->views[d->view]));
}

static void name_edge(const mt_problem *p, const mt_move *m, mt_arena *mem, mt_relaxation *out)
{
    const mt_avoidance *const c = &p->avoidances[m->avoidance];
    const mt_band *const band = &c->bands.items[m->band];
    const bool margin =
        band->lower_hz != band->base_lower_hz || band->upper_hz != band->base_upper_hz;
    out->kind = "band";
    out->pointer = mt_arena_printf(mem, "/goals/%d", c->goal_index);
    out->unit = "Hz";
    out->what = mt_arena_printf(mem, "%s edge of the band \"%s\"%s in \"%s\"",
                                m->upper ? "upper" : "lower", band->label,
                                margin ? " (with its margin)" : "",
                                mt_configuration_name(p, &p->views[c->view]));
}

static void name_bound(const mt_problem *p, const mt_move *m, mt_arena *mem, mt_relaxation *out)
{
    const mt_variable *const v = &p->study->variables[m->variable];
    out->kind = "bound";
    out->pointer = mt_arena_printf(mem, "/variables/%d", m->variable);
    out->unit = p->study->model->parameters[v->parameter].unit;
    out->display_unit = mt_unit_name(v->shown, NULL);
    out->display_factor = mt_unit_display(v->shown);
    out->what = mt_arena_printf(mem, "%s bound of %s", m->upper ? "upper" : "lower",
                                v->parameter_name.s);
}

/* "k1 = 12.3, k2 = 4" */
static const char *design_text(const mt_problem *p, const double *x, mt_arena *mem)
{
    const char *text = "";
    for (int i = 0; i < p->n; i++) {
        const mt_variable *const v = &p->study->variables[i];
        text = mt_arena_printf(mem, "%s%s%s = %.6g%s%s", text, i > 0 ? ", " : "",
                               v->parameter_name.s, mt_unit_from_si(v->shown, x[i]),
                               v->shown == NULL ? "" : " ", mt_unit_name(v->shown, ""));
    }
    return text;
}

static mt_status describe_move(const mt_problem *p, const mt_move *m, mt_arena *mem,
                               mt_relaxation *out, mt_err *err)
{
    *out = (mt_relaxation){.from = m->from, .to = m->to, .display_factor = nan("")};
    out->change_percent =
        fabs(m->from) > 0.0 ? PERCENT * (m->to - m->from) / fabs(m->from) : nan("");
    switch (m->kind) {
    case MT_MOVE_BOUND:
        name_bound(p, m, mem, out);
        break;
    case MT_MOVE_EDGE:
        name_edge(p, m, mem, out);
        break;
    case MT_MOVE_GOAL:
        name_goal(p, m, mem, out);
        break;
    }
    out->design = mt_arena_f64(mem, (size_t)p->n, 1);
    const char *const design = design_text(p, m->x, mem);
    const char *const unit = out->display_unit != NULL ? out->display_unit : out->unit;
    const double factor = out->display_unit != NULL ? out->display_factor : 1.0;
    MT_TRY(mt_arena_check(mem, err));
    memcpy(out->design, m->x, (size_t)p->n * sizeof *out->design);
    const char *const percent =
        fabs(m->from) > 0.0 ? mt_arena_printf(mem, " (%+.3g %%)", out->change_percent) : "";
    out->text =
        mt_arena_printf(mem,
                        "Changing the %s from %.6g to %.6g%s%s%s, and nothing else, lets a "
                        "design meet all goals: %s.",
                        out->what, m->from / factor, m->to / factor, unit != NULL ? " " : "",
                        unit != NULL ? unit : "", percent, design);
    return mt_arena_check(mem, err);
}

mt_status mt_describe_relaxations(const mt_problem *p, const mt_moves *moves, mt_result *result,
                                  mt_err *err)
{
    const int n = moves->n < MOST ? moves->n : MOST;
    result->relaxations = mt_arena_alloc(&result->mem, (size_t)n, sizeof *result->relaxations);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < n; i++) {
        MT_TRY(describe_move(p, &moves->items[i], &result->mem, &result->relaxations[i], err));
        result->n_relaxations = i + 1;
    }
    return MT_OK;
}
