/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every goal as text, with its value, what it asks for, and whether it is met. */
#include <math.h>

#include "describe/describe.h"
#include "problem/configuration.h"
#include "problem/evaluate.h"
#include "problem/goal_frequency_response.h"
#include "problem/goals.h"
#include "problem/requirement.h"

static const double PERCENT = 100.0;
static const double HALF_TURN = 3.14159265358979323846;
static const double HALF_TURN_DEG = 180.0;
/* A phase that rises by more [rad] through a peak is no noise: a quarter turn is due. */
static const double CONJUGATED = 0.5;

/* "installed mode 1", "installed \"heave\"", or the expression. */
static const char *quantity_text(const mt_problem *p, const mt_requirement *d, mt_arena *mem)
{
    if (d->view < 0) {
        return d->goal->expression_text;
    }
    const char *const configuration = mt_configuration_name(p, &p->views[d->view]);
    if (!mt_requirement_is_modal(d)) {
        return configuration;
    }
    return d->mode > 0
               ? mt_arena_printf(mem, "%s mode %d", configuration, d->mode)
               : mt_arena_printf(mem, "%s \"%s\"", configuration, d->goal->mode.mode_name.s);
}

/* " from a to b Hz", " at least a Hz", " at most b Hz", " at a Hz as mode 2 of \"fe\"", or
 * nothing. */
static const char *interval_text(const mt_problem *p, const mt_requirement *d, mt_arena *mem)
{
    const mt_goal *const g = d->goal;
    const mt_unit *const shown = mt_study_requirement_unit(p->study, &g->expression);
    const char *const name = mt_unit_name(shown, mt_study_goal_unit(p->study, g));
    const char *const unit = mt_arena_printf(mem, "%s%s", name[0] != '\0' ? " " : "", name);
    const bool least = MT_HAS(g->at_least);
    const double equals = mt_unit_from_si(shown, d->equals);
    const double low = mt_unit_from_si(shown, g->at_least);
    const double high = mt_unit_from_si(shown, g->at_most);
    const double number = least ? low : high;
    if (unit == NULL) {
        return NULL;
    }
    if (MT_HAS(d->equals) && d->shape.reference != NULL) {
        return mt_arena_printf(mem, " %s %.10g%s as mode %d of \"%s\"", d->ops->equals, equals,
                               unit, d->shape.mode, d->shape.reference);
    }
    if (MT_HAS(d->equals)) {
        return mt_arena_printf(mem, " %s %.10g%s", d->ops->equals, equals, unit);
    }
    if (least && MT_HAS(g->at_most)) {
        return mt_arena_printf(mem, " from %.10g to %.10g%s", low, high, unit);
    }
    if (!MT_HAS(number)) {
        return "";
    }
    return mt_arena_printf(mem, " at %s %.10g%s", least ? "least" : "most", number, unit);
}

/* Texts of the quantity that a requirement limits, and of the whole requirement. */
static void name_goal(const mt_problem *p, const mt_requirement *d, mt_arena *mem,
                      mt_result_goal *g)
{
    const char *const quantity = quantity_text(p, d, mem);
    const char *const interval = interval_text(p, d, mem);
    g->quantity = quantity == NULL || d->ops->subject == NULL
                      ? quantity
                      : d->ops->subject(d, quantity, mem);
    g->text = g->quantity == NULL || interval == NULL
                  ? NULL
                  : mt_arena_printf(mem, "%s%s", g->quantity, interval);
}

/* Of two parts of a violation the greater; NaN is the greatest. */
static double greater(double a, double b)
{
    return b <= a ? a : b;
}

/* Relative violation of a requirement that has been evaluated, that of a frequency a logarithm;
 * of a shape its distance. */
static double requirement_violation(const mt_workspace *fresh, const mt_requirement *d,
                                    const mt_nlp_values *v, double own_worst)
{
    const int row = mt_requirement_row(fresh->c, d);
    double worst = 0.0;
    if (d->role == MT_ROLE_RESIDUAL) {
        return mt_norm2(d->n_rows, fresh->r + row) / sqrt(d->goal->weight);
    }
    if (d->role == MT_ROLE_TARGET) {
        return fabs(v->eq[row]);
    }
    if (d->role == MT_ROLE_VIBRATION) {
        return fmax(own_worst, 0.0); /* of this requirement alone */
    }
    for (int k = 0; k < d->n_rows; k++) {
        worst = greater(worst, -v->in[row + k]);
    }
    return worst;
}

double mt_describe_off_by(const mt_requirement *d, double q, double violation)
{
    const mt_goal *const g = d->goal;
    double worst = 0.0;
    if (d->measure != MT_MEASURE_RATIO) {
        return violation;
    }
    if (MT_HAS(d->equals)) {
        return fabs(q / d->equals - 1.0);
    }
    worst = MT_HAS(g->at_least) ? greater(worst, 1.0 - q / g->at_least) : worst;
    return MT_HAS(g->at_most) ? greater(worst, q / g->at_most - 1.0) : worst;
}

/* Solve all views; the first that fails otherwise than by memory is told in `why`. */
static mt_status solve_views(mt_workspace *fresh, mt_err *why, mt_err *err)
{
    for (int i = 0; i < fresh->c->n_views; i++) {
        mt_configuration_work *const view = &fresh->views[i];
        mt_err own = {0};
        mt_configuration_query_all(view);
        view->ask.vectors = view->ask.vectors || view->of->n_named > 0;
        const mt_status rc = mt_configuration_solve(fresh, view, false, &own);
        if (mt_is_final(rc)) {
            return mt_fail(err, rc, "%s", own.text);
        }
        if (rc != MT_OK && why->code == MT_OK) {
            *why = own;
        }
    }
    mt_err own = {0};
    const mt_status rc = why->code == MT_OK ? mt_describe_ranges(fresh, &own) : MT_OK;
    *why = rc != MT_OK ? own : *why;
    return mt_pass_final(rc, &own, err);
}

/* Warn that the mode of the goal is not identified: the goal is not met, for any value. */
static mt_status warn_unidentified(const mt_workspace *fresh, const mt_requirement *d,
                                   mt_result *result, mt_result_goal *g, mt_err *err)
{
    const char *const why =
        mt_describe_identity(&fresh->views[d->view], d->named, &result->mem);
    g->met = false;
    g->text = mt_arena_printf(&result->mem, "%s, %s", g->text, why);
    g->doubtful = true;
    return mt_arena_check(&result->mem, err);
}

/* Write quantity and requirement in numbers. */
static void write_what(const mt_problem *p, const mt_requirement *d, mt_result_goal *g)
{
    const mt_goal *const asked = d->goal;
    const mt_goal_kind *const kind = mt_goal_kind_of(asked->type);
    g->type = kind->name;
    const char *const unit = mt_study_goal_unit(p->study, asked);
    const mt_unit *const shown = mt_study_requirement_unit(p->study, &asked->expression);
    g->unit = d->view < 0 && unit[0] == '\0' ? NULL : unit;
    g->display_unit = mt_unit_name(shown, NULL);
    g->display_factor = mt_unit_display(shown);
    g->expression = d->view < 0 ? asked->expression_text : NULL;
    g->reference = asked->response_limit != NULL ? asked->response_limit->measurement_name.s
                                                 : asked->reference_name.s;
    if (d->view >= 0) {
        g->configuration = mt_configuration_name(p, &p->views[d->view]);
    }
    if (mt_requirement_is_modal(d)) {
        g->mode = d->mode;
        g->name = d->mode > 0 ? NULL : asked->mode.mode_name.s;
    }
    g->at_least = asked->at_least;
    g->at_most = asked->at_most;
    g->target = d->ops->value == NULL ? 0.0 : d->equals; /* a distance is to be none */
    g->tolerance_percent = asked->tolerance_percent;
}

/* Write the measured line of the largest deviation. */
static void write_line(const mt_workspace *fresh, const mt_requirement *d, mt_result_goal *g)
{
    double complex off = 0.0;
    if (mt_fit_worst(fresh, d, &g->off_most_hz, &off)) {
        g->off_most_ratio = exp(creal(off));
        g->off_most_phase_deg = cimag(off) / HALF_TURN * HALF_TURN_DEG;
    }
}

static mt_status describe_requirement(mt_workspace *fresh, const mt_requirement *d,
                                      mt_nlp_values *v, mt_result *result, mt_result_goal *g,
                                      mt_err *why, mt_err *err)
{
    mt_err own = {0};
    double violation = nan("");
    double percent = nan("");
    *g = mt_result_goal_default();
    write_what(fresh->p, d, g);
    const double others = fresh->worst;
    const bool residual = d->role == MT_ROLE_RESIDUAL;
    const bool vibration = d->role == MT_ROLE_VIBRATION;
    fresh->worst = -HUGE_VAL;
    const mt_status rc = mt_requirement_eval(fresh, d, false, v, &g->value, &own);
    if (mt_is_final(rc)) {
        return mt_fail(err, rc, "%s", own.text);
    }
    if (rc == MT_OK) {
        const double own_worst = fresh->worst;
        const bool none = vibration && !isfinite(g->value); /* a resonance undamped */
        fresh->worst = none || isnan(others) ? nan("") : fmax(others, own_worst);
        violation = requirement_violation(fresh, d, v, own_worst);
        g->value = isfinite(g->value) ? g->value : nan(""); /* a mode at infinity has none */
        percent = PERCENT * mt_describe_off_by(d, g->value, violation);
        write_line(fresh, d, g);
        MT_TRY(mt_describe_worst(fresh, d, result, g, &violation, &percent, err));
    } else {
        g->value = nan("");
        fresh->worst = vibration ? nan("") : others;
        *why = why->code == MT_OK ? own : *why;
        for (int i = 0; i < d->n_rows && residual; i++) {
            /* nor is the misfit known */
            fresh->r[mt_requirement_row(fresh->c, d) + i] = nan("");
        }
    }
    g->weighted = residual || vibration;
    name_goal(fresh->p, d, &result->mem, g);
    g->pointer = mt_arena_printf(&result->mem, "/goals/%d", d->goal_index);
    g->violation_percent = percent;
    g->met = mt_is_met(violation, d->tolerance);
    MT_TRY(mt_arena_check(&result->mem, err));
    return !mt_requirement_is_modal(d) || mt_describe_is_told(&fresh->views[d->view], d)
               ? MT_OK
               : warn_unidentified(fresh, d, result, g, err);
}

/* Write the length at which angles count as arcs, where sensors of a MAC or a shape mix
 * displacements and angles and the study does not give it. */
static mt_status write_length(const mt_requirement *d, const mt_design *design,
                              mt_result *result, mt_err *err)
{
    return design->found != NULL || d->shape.scale == NULL || MT_HAS(d->goal->length)
               ? MT_OK
               : mt_describe_warn(result, err,
                                  "/goals/%d: the sensors of \"%s\" mix displacements and "
                                  "rotations: a rotation counts as its arc at %.4g m, the "
                                  "model's length (\"length_m\" of the goal chooses another)",
                                  d->goal_index, d->shape.reference, d->shape.length);
}

/* Warn of measured data that fit no mechanism: where the original design or the best one shows
 * it. */
static mt_status warn_data(const mt_workspace *fresh, const mt_requirement *d,
                           const mt_design *design, mt_result *result, mt_err *err)
{
    double hz = 0.0;
    const double rise = design->found == NULL ? mt_fit_rise(d, &hz) : 0.0;
    if (rise > CONJUGATED) {
        MT_TRY(mt_describe_warn(
            result, err,
            "/goals/%d: the data look conjugated: through the peak at %.6g Hz the measured "
            "phase rises by %.0f degrees, where that of a damped mechanism falls; check the "
            "sign convention of the phase, exp(i w t) or exp(-i w t)",
            d->goal_index, hz, rise * HALF_TURN_DEG / HALF_TURN));
    }
    return design->rank <= 1 && mt_fit_is_reversed(fresh, d)
               ? mt_describe_warn(result, err,
                                  "/goals/%d: the data look reversed: with the other sign of "
                                  "the measured response its phases would fit better; check "
                                  "the direction of the sensor and of the force",
                                  d->goal_index)
               : MT_OK;
}

mt_status mt_describe_goals(mt_workspace *fresh, const mt_design *design, mt_result *result,
                            mt_recommendation *rec, double *motion_margin, mt_err *err)
{
    mt_nlp_values v;
    mt_err why = {.code = MT_OK};
    const size_t most = (size_t)fresh->p->n_requirements +
                        (size_t)mt_describe_avoid_count(fresh->p) +
                        (size_t)mt_describe_motion_count(fresh->p);
    rec->goals = mt_arena_alloc(&result->mem, most, sizeof *rec->goals);
    rec->feasible = true;
    rec->violation_percent = 0.0;
    MT_TRY(mt_arena_check(&result->mem, err));
    MT_TRY(mt_subproblem_values_init(fresh->c, &fresh->mem, &v, err));
    MT_TRY(mt_workspace_place(fresh, design->t, false, err));
    MT_TRY(solve_views(fresh, &why, err));
    for (int i = 0; i < fresh->p->n_requirements; i++) {
        MT_TRY(describe_requirement(fresh, &fresh->p->requirements[i], &v, result,
                                    &rec->goals[i], &why, err));
        MT_TRY(write_length(&fresh->p->requirements[i], design, result, err));
        MT_TRY(warn_data(fresh, &fresh->p->requirements[i], design, result, err));
        rec->n_goals++;
    }
    MT_TRY(mt_describe_avoid_goals(fresh, result, rec, err));
    MT_TRY(mt_describe_motions(fresh, result, rec, motion_margin, err));
    for (int i = 0; i < rec->n_goals; i++) {
        const mt_result_goal *const g = &rec->goals[i];
        if (!g->weighted) {
            const bool worse = !(g->violation_percent <= rec->violation_percent);
            rec->feasible = rec->feasible && g->met;
            rec->violation_percent = worse ? g->violation_percent : rec->violation_percent;
        } else if (!(g->violation_percent >= 0.0)) {
            rec->feasible = false; /* a residual without a value: the misfit has none */
        }
    }
    if (why.code == MT_OK) {
        return MT_OK;
    }
    rec->violation_percent = nan("");
    const char *const where =
        design->found == NULL
            ? "the original design"
            : mt_arena_printf(&result->mem, "recommendation %d", design->rank);
    return where == NULL ? mt_fail_memory(err)
                         : mt_describe_warn(result, err, "not all goals have a value at %s: %s",
                                            where, why.text);
}
