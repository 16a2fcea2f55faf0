/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a search over catalogues may claim. */
#include "tune/discrete.h"

/* Pure enumeration proves; a continuous search within each combination is sampled, a heuristic all the more. */
static bool proves(const mt_discrete_report *report)
{
    return report->all && !report->mixed;
}

static const char *certificate_text(const mt_discrete_report *r, const mt_nlp_result *found,
                                    mt_arena *mem)
{
    const char *const rest =
        r->mixed ? " The other variables were searched from several starts for each of them, "
                   "which is sampled, not proven."
                 : "";
    if (!r->all) {
        return mt_arena_printf(mem,
                               "Of %.6g combinations of catalogue values %d were judged, near "
                               "the designs of the relaxed problem and their neighbours "
                               "(heuristic): a better one may exist.",
                               r->combinations, r->judged);
    }
    if (found->n_solutions == 0 || found->compromise) {
        return mt_arena_printf(mem,
                               "None of the %.0f combinations of catalogue values meets all "
                               "goals: all were enumerated.%s",
                               r->combinations, rest);
    }
    if ((double)r->judged < r->combinations) {
        return mt_arena_printf(mem,
                               "Enumerated: of %.0f combinations of catalogue values %d were "
                               "judged, in the order of their change, and the others change "
                               "more than every design listed.%s",
                               r->combinations, r->judged, rest);
    }
    return mt_arena_printf(mem,
                           "Enumerated: all %.0f combinations of catalogue values were judged, "
                           "%d of them meet%s all goals.%s",
                           r->combinations, r->feasible, r->feasible == 1 ? "s" : "", rest);
}

mt_status mt_describe_discrete_certificate(const mt_discrete_report *report,
                                           const mt_nlp_result *found, mt_result *result,
                                           bool *infeasible, mt_err *err)
{
    int capacity = result->n_certificates;
    mt_certificate *const grown = mt_arena_grow(
        &result->mem, result->certificates, result->n_certificates, &capacity, sizeof *grown);
    const char *const text = certificate_text(report, found, &result->mem);
    if (grown == NULL || text == NULL) {
        return mt_fail_memory(err);
    }
    result->certificates = grown;
    mt_certificate *const c = &result->certificates[result->n_certificates++];
    *c = mt_certificate_default();
    c->kind = "enumeration";
    c->text = text;
    c->proven = proves(report);
    *infeasible = c->proven && (found->n_solutions == 0 || found->compromise);
    return MT_OK;
}

const char *mt_discrete_rank_text(const mt_discrete_report *report, const mt_nlp_result *found,
                                  int rank, const char *objective, mt_arena *mem)
{
    const char *const how = proves(report) ? "enumerated, which is exact"
                            : report->all  ? "enumerated; the other variables sampled"
                                           : "heuristic: a better one may exist";
    if (found->compromise) {
        return mt_arena_printf(mem,
                               "No combination of catalogue values that was judged meets all "
                               "goals (%d of %.6g, %s); this one comes %s.",
                               report->judged, report->combinations, how,
                               rank == 1 ? "nearest" : "behind those that rank before it");
    }
    return mt_arena_printf(mem,
                           "Of the combinations of catalogue values it ranks %d by %s (%d of "
                           "%.6g judged, %s).",
                           rank, objective, report->judged, report->combinations, how);
}
