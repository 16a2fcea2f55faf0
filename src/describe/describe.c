/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "describe/describe.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "base/number.h"
#include "base/run.h"
#include "problem/avoidance.h"
#include "problem/configuration.h"
#include "problem/objective.h"
#include "problem/tolerance.h"

/* The objective as the search had it and as it is recomputed may differ by this much,
 * relatively: both are good to about n eps. Roots of squares, so that an exact identification
 * (f of 1e-24) is not judged by its rounding. */
static const double SAME_OBJECTIVE = 1e-8;
/* Of a design that is described: as the study reads it, and by systems that are made anew. */
enum { ANALYSES = 2 };

mt_status mt_describe_warn(mt_result *result, mt_err *err, const char *fmt, ...)
{
    va_list args;
    int capacity = result->n_warnings;
    const char **const grown = mt_arena_grow(&result->mem, result->warnings, result->n_warnings,
                                             &capacity, sizeof *grown);
    va_start(args, fmt);
    const char *const text = mt_arena_vprintf(&result->mem, fmt, args);
    va_end(args);
    MT_TRY(mt_arena_check(&result->mem, err));
    result->warnings = grown;
    for (int i = 0; i < result->n_warnings; i++) {
        if (strcmp(result->warnings[i], text) == 0) {
            return MT_OK;
        }
    }
    result->warnings[result->n_warnings++] = text;
    return MT_OK;
}

/* The parts that the design takes from catalogues. */
static void describe_parts(const mt_problem *p, const double *x, mt_result *result,
                           mt_recommendation *rec)
{
    for (int k = 0; k < p->n_choices; k++) {
        const mt_choice *const own = &p->choices[k];
        const int row = own->rows == NULL ? MT_ABSENT : mt_choice_find(own, x);
        const char *part = NULL;
        if (row != MT_ABSENT) {
            part = own->rows->names != NULL
                       ? mt_arena_strdup(&result->mem, own->rows->names[row])
                       : mt_arena_printf(&result->mem, "row %d", own->rows->number[row]);
        }
        for (int i = own->first; i < own->first + own->n && own->rows != NULL; i++) {
            rec->parameters[i].catalogue = mt_arena_strdup(&result->mem, own->rows->catalogue);
            rec->parameters[i].part = part;
        }
    }
}

static mt_status describe_parameters(const mt_problem *p, const double *x, const double *t,
                                     mt_result *result, mt_recommendation *rec, mt_err *err)
{
    rec->n_parameters = p->n;
    rec->parameters = mt_arena_alloc(&result->mem, (size_t)p->n, sizeof *rec->parameters);
    MT_TRY(mt_arena_check(&result->mem, err));
    double change = 0.0;
    for (int i = 0; i < p->n; i++) {
        const mt_variable *const v = &p->study->variables[i];
        const mt_parameter *const parameter = &p->study->model->parameters[v->parameter];
        const double original = p->original[i];
        const double d = t[i] - p->whole.origin_t[i];
        change += v->weight * d * d;
        rec->parameters[i] = (mt_result_parameter){
            .name = parameter->name.s,
            .unit = parameter->unit,
            .display_unit = mt_unit_name(v->shown, NULL),
            .display_factor = mt_unit_display(v->shown),
            .original = original,
            .recommended = x[i],
            .change_percent =
                original != 0.0 ? 100.0 * (x[i] - original) / fabs(original) : nan(""),
            .at_bound = x[i] == v->lower   ? "lower"
                        : x[i] == v->upper ? "upper"
                                           : NULL,
            .lower = v->lower,
            .upper = v->upper,
            .measure = MT_HAS(p->scale[i]) ? "linear"
                       : p->floor[i] > 0.0 ? "logarithmic with floor"
                                           : "logarithmic",
            .measure_floor = p->floor[i] > 0.0 ? p->floor[i] : nan(""),
            .measure_scale = p->scale[i],
        };
    }
    rec->change = sqrt(change);
    describe_parts(p, x, result, rec);
    return mt_arena_check(&result->mem, err);
}

/* The objective at this design. The fresh problem has no coordinate for the least clearance: it
 * is found among the modes. */
static double stage_value(const mt_workspace *fresh, int k, double motion_margin)
{
    if (mt_objective_is(fresh->c->stages[k].type, MT_SHAKES)) {
        return fresh->worst;
    }
    if (!mt_objective_is(fresh->c->stages[k].type, MT_BANDS)) {
        return mt_objective_stage_value(fresh, k, NULL);
    }
    const double room = mt_avoidances_margin(fresh);
    return -(motion_margin < room ? motion_margin : room); /* NaN: unstable */
}

static mt_status describe_objectives(const mt_workspace *fresh, double motion_margin,
                                     const mt_recommendation *baseline, mt_result *result,
                                     mt_recommendation *rec, mt_err *err)
{
    const int n = result->n_objectives;
    rec->objectives = mt_arena_alloc(&result->mem, (size_t)n, sizeof *rec->objectives);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int k = 0; k < n; k++) {
        const double shown = mt_objective_stage_shown(&fresh->c->stages[k],
                                                      stage_value(fresh, k, motion_margin));
        const double value = isfinite(shown) ? shown : nan("");
        rec->objectives[rec->n_objectives++] = (mt_design_objective){
            .text = result->objectives[k].text,
            .unit = result->objectives[k].unit,
            .original = baseline == NULL ? value : baseline->objectives[k].original,
            .recommended = value};
    }
    if (fresh->c->rows.res.n > 0) {
        rec->misfit = mt_norm2(fresh->c->rows.res.n, fresh->r);
    }
    rec->score = n > 0 && rec->feasible ? rec->objectives[0].recommended : nan("");
    return MT_OK;
}

/* Warn where the fresh objective does not agree with the one that the search ended with. */
static mt_status check_fresh_objective(const mt_workspace *fresh, const mt_design *design,
                                       double motion_margin, mt_result *result, mt_err *err)
{
    const int k = design->stage;
    const bool bands = mt_objective_is(fresh->c->stages[k].type, MT_BANDS);
    const double f =
        mt_objective_stage_root(&fresh->c->stages[k], stage_value(fresh, k, motion_margin));
    const double had = mt_objective_stage_root(&fresh->c->stages[k], design->found->f);
    const bool searched_within = bands && fresh->c->tolerance_box != NULL &&
                                 !mt_ranges_proven(mt_tolerance_known(fresh));
    /* a clearance that is missed is that of the kind searched */
    const bool other_kind = bands && !design->found->feasible;
    if (other_kind || fabs(f - had) <= SAME_OBJECTIVE * fmax(fabs(f), 1.0) || searched_within) {
        /* within the tolerances more was found than at the corners of the search */
        return MT_OK;
    }
    return mt_describe_warn(result, err,
                            "recommendation %d: the search ended with an objective of %.12g, "
                            "recomputed it is %.12g",
                            design->rank, had * fresh->c->stages[k].size,
                            f * fresh->c->stages[k].size);
}

/* Warn of a design at which a fresh analysis disagrees; it does not count as meeting any goal,
 * see describe_run.c. */
static mt_status warn_disagreement(const mt_design *design, mt_result *result,
                                   mt_recommendation *rec, mt_err *err)
{
    if (rec->disagreement == NULL) {
        return MT_OK;
    }
    rec->feasible = false;
    return design->found == NULL
               ? mt_describe_warn(result, err, "the original design is not verified: %s",
                                  rec->disagreement)
               : mt_describe_warn(result, err, "recommendation %d is not verified: %s",
                                  design->rank, rec->disagreement);
}

/* Grade a fit, whose goals decide nothing, by how near its misfit is to the least. */
static void grade_fit(const mt_problem *p, const mt_design *design, mt_recommendation *rec)
{
    if (mt_study_is_fit(p->study) && rec->feasible && rec->disagreement == NULL) {
        rec->grade = design->cut || !mt_describe_is_optimum(rec)          ? "not converged"
                     : design->rank == 1 || rec->misfit <= MT_RATIO_NOISE ? "fitted"
                                                                          : "local minimum";
    }
}

static mt_status describe_design(mt_workspace *fresh, const mt_design *design,
                                 const mt_recommendation *baseline, mt_result *result,
                                 mt_recommendation *rec, mt_err *err)
{
    double motion_margin = HUGE_VAL;
    *rec = mt_recommendation_default();
    rec->rank = design->rank;
    MT_TRY(mt_describe_goals(fresh, design, result, rec, &motion_margin, err));
    MT_TRY(mt_describe_responses(fresh, result, rec, err));
    MT_TRY(mt_describe_between(fresh, design, result, rec, err));
    MT_TRY(describe_parameters(fresh->p, fresh->x, design->t, result, rec, err));
    MT_TRY(mt_describe_frequencies(fresh, design, baseline, result, rec, err));
    MT_TRY(warn_disagreement(design, result, rec, err));
    MT_TRY(mt_describe_clearances(fresh, result, rec, err));
    MT_TRY(describe_objectives(fresh, motion_margin, baseline, result, rec, err));
    if (fresh->c->tolerance_box != NULL) {
        rec->worst_case = mt_ranges_proven(mt_tolerance_known(fresh)) ? "proven" : "sampled";
    }
    MT_TRY(mt_describe_curves(fresh, result, rec, err));
    rec->grade = rec->disagreement != NULL ? "not verified"
                 : rec->feasible           ? "feasible"
                                           : "compromise";
    if (design->found == NULL) {
        return MT_OK;
    }
    MT_TRY(mt_describe_tolerance(fresh, result, rec, err));
    if (!design->cut) {
        rec->kkt_residual = design->found->kkt;
        rec->singular = design->found->singular;
    }
    grade_fit(fresh->p, design, rec);
    if (design->cut) {
        return MT_OK;
    }
    return check_fresh_objective(fresh, design, motion_margin, result, err);
}

mt_status mt_describe_design(const mt_problem *p, const mt_design *design,
                             const mt_recommendation *baseline, mt_result *result,
                             mt_recommendation *rec, mt_err *err)
{
    mt_workspace *fresh = NULL;
    MT_TRY(mt_workspace_new(p, &fresh, err));
    mt_work_counters_note(p->run->work, MT_WORK_DESIGNS, ANALYSES);
    mt_problem_note_modal(p, ANALYSES * mt_subproblem_solutions(&p->whole));
    mt_status rc = describe_design(fresh, design, baseline, result, rec, err);
    rc = rc == MT_OK ? mt_describe_slopes(fresh, design, result, rec, err) : rc;
    mt_workspace_delete(fresh);
    return rc;
}

bool mt_describe_is_optimum(const mt_recommendation *rec)
{
    /* NaN: nothing is free, or the search was over a catalogue */
    return !(rec->kkt_residual > MT_KKT_TOLD);
}
