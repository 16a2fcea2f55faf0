/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tune/describe.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Modes listed of a configuration beyond those that goals name. */
enum { LISTED_MODES = 4 };
/* Frequencies of the search and of the fresh analysis that differ by more than this (relative) are worth a warning; both are good to about n eps. */
static const double RECOMPUTED_AGREES = 1e-9;

mt_status mt_describe_warn(mt_result *result, mt_err *err, const char *fmt, ...)
{
    va_list args;
    int capacity = result->n_warnings;
    const char **const grown = mt_arena_grow(&result->mem, result->warnings, result->n_warnings,
                                             &capacity, sizeof *grown);
    va_start(args, fmt);
    const char *const text = mt_arena_vprintf(&result->mem, fmt, args);
    va_end(args);
    if (grown == NULL || text == NULL) {
        return mt_fail_memory(err);
    }
    result->warnings = grown;
    result->warnings[result->n_warnings++] = text;
    return MT_OK;
}

static mt_status describe_parameters(const mt_problem *p, const double *x, const double *t,
                                     mt_result *result, mt_recommendation *rec, mt_err *err)
{
    rec->n_parameters = p->n;
    rec->parameters = mt_arena_alloc(&result->mem, (size_t)p->n, sizeof *rec->parameters);
    if (rec->parameters == NULL) {
        return mt_fail_memory(err);
    }
    double change = 0.0;
    for (int i = 0; i < p->n; i++) {
        const mt_variable *const v = &p->study->variables[i];
        const mt_parameter *const parameter = &p->study->model->parameters[v->parameter];
        const double d = t[i] - p->origin_t[i];
        change += v->weight * d * d;
        rec->parameters[i] = (mt_result_parameter){
            .name = parameter->name.s,
            .unit = parameter->unit,
            .original = p->original[i],
            .recommended = x[i],
            .change_percent = p->original[i] != 0.0
                                  ? 100.0 * (x[i] - p->original[i]) / fabs(p->original[i])
                                  : nan(""),
            .at_bound = !(x[i] > v->lower) ? "lower" : (!(x[i] < v->upper) ? "upper" : NULL),
        };
    }
    rec->change = sqrt(change);
    return MT_OK;
}

/* Buffers for one evaluation of all goals. */
static mt_status values_init(const mt_problem *p, mt_arena *mem, mt_nlp_values *v, mt_err *err)
{
    const size_t n = (size_t)p->n;
    v->f = 0.0;
    v->df = mt_arena_f64(mem, n, 1);
    v->r = mt_arena_f64(mem, (size_t)p->n_res, 1);
    v->dr = mt_arena_f64(mem, (size_t)p->n_res, n);
    v->eq = mt_arena_f64(mem, (size_t)p->n_eq, 1);
    v->deq = mt_arena_f64(mem, (size_t)p->n_eq, n);
    v->in = mt_arena_f64(mem, (size_t)p->n_in, 1);
    v->din = mt_arena_f64(mem, (size_t)p->n_in, n);
    const bool bad = v->df == NULL || v->r == NULL || v->dr == NULL || v->eq == NULL ||
                     v->deq == NULL || v->in == NULL || v->din == NULL;
    return bad ? mt_fail_memory(err) : MT_OK;
}

static const char *mode_text(const mt_problem *p, const mt_demand *d, mt_arena *mem)
{
    const char *const configuration = mt_analysis_configuration(p->views[d->view].analysis);
    if (d->mode > 0) {
        return mt_arena_printf(mem, "%s mode %d", configuration, d->mode);
    }
    return mt_arena_printf(mem, "%s \"%s\"", configuration, d->goal->mode.mode_name.s);
}

/* What a demand asks for, as text, and the number that it asks for. */
static const char *demand_text(const mt_problem *p, const mt_demand *d, mt_arena *mem,
                               double *number)
{
    const mt_goal *const g = d->goal;
    const char *const mode = d->view >= 0 ? mode_text(p, d, mem) : g->expression_text;
    *number = MT_HAS(g->at_least) ? g->at_least : g->at_most;
    if (mode == NULL) {
        return NULL;
    }
    switch (g->type) {
    case MT_GOAL_FREQUENCY:
        if (MT_HAS(d->target_hz)) {
            *number = d->target_hz;
            return d->shape.reference == NULL
                       ? mt_arena_printf(mem, "%s at %.10g Hz", mode, d->target_hz)
                       : mt_arena_printf(mem, "%s at %.10g Hz as mode %d of \"%s\"", mode,
                                         d->target_hz, d->shape.mode, d->shape.reference);
        }
        if (MT_HAS(g->at_least) && MT_HAS(g->at_most)) {
            return mt_arena_printf(mem, "%s from %.10g to %.10g Hz", mode, g->at_least,
                                   g->at_most);
        }
        return mt_arena_printf(mem, "%s at %s %.10g Hz", mode,
                               MT_HAS(g->at_least) ? "least" : "most", *number);
    case MT_GOAL_SHAPE:
        *number = 0.0;
        return mt_arena_printf(mem, "%s shaped as mode %d of \"%s\"", mode, d->shape.mode,
                               d->shape.reference);
    case MT_GOAL_MAC:
        return mt_arena_printf(mem, "%s with MAC at least %.10g to mode %d of \"%s\"", mode,
                               g->at_least, d->shape.mode, d->shape.reference);
    case MT_GOAL_LIMIT:
        if (MT_HAS(g->equals)) {
            *number = g->equals;
            return mt_arena_printf(mem, "%s equal to %.10g", mode, g->equals);
        }
        return mt_arena_printf(mem, "%s at %s %.10g", mode,
                               MT_HAS(g->at_least) ? "least" : "most", *number);
    case MT_GOAL_AVOID:
    case MT_GOAL_TYPE_COUNT:
        break;
    }
    return "";
}

static double demand_value(mt_problem *fresh, const mt_demand *d, const mt_nlp_values *v,
                           mt_err *err)
{
    if (d->goal->type == MT_GOAL_LIMIT) {
        return fresh->value[d->node];
    }
    mt_view *const view = &fresh->views[d->view];
    const int pos = mt_view_position(view, d->mode, d->named, err);
    if (pos < 0) {
        return nan("");
    }
    if (d->goal->type == MT_GOAL_FREQUENCY) {
        return mt_modal_hz(&view->analysis->modes, pos);
    }
    if (d->goal->type == MT_GOAL_SHAPE) {
        return mt_norm2(d->shape.ns, v->r + d->row_res) / sqrt(d->goal->weight);
    }
    double mac = nan("");
    return mt_reference_mac(view->analysis, pos, &d->shape, &mac, err) == MT_OK ? mac : nan("");
}

/* Relative violation of one demand; NaN where it has no value. */
static double demand_violation(const mt_demand *d, const mt_nlp_values *v)
{
    double worst = 0.0;
    if (d->row_eq >= 0) {
        return fabs(v->eq[d->row_eq]);
    }
    for (int k = 0; d->row_in >= 0 && k < (MT_HAS(d->goal->at_least) ? 1 : 0) +
                                              (MT_HAS(d->goal->at_most) ? 1 : 0);
         k++) {
        const double below = -v->in[d->row_in + k];
        worst = !(below <= worst) ? below : worst;
    }
    if (d->row_res >= 0 && d->goal->type != MT_GOAL_SHAPE) {
        return fabs(v->r[d->row_res]) / sqrt(d->goal->weight);
    }
    return worst;
}

/* Rounding of ln and of the eigenvalues may push a goal that is met exactly on its tolerance over it. */
static const double MET_SLACK = 1e-6;

static mt_status describe_goals(mt_problem *fresh, const mt_nlp_values *v, bool evaluated,
                                mt_result *result, mt_recommendation *rec, mt_err *err)
{
    rec->n_goals = fresh->n_demands;
    rec->goals = mt_arena_alloc(&result->mem, (size_t)fresh->n_demands, sizeof *rec->goals);
    rec->feasible = true;
    rec->violation_percent = 0.0;
    if (rec->goals == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < fresh->n_demands; i++) {
        const mt_demand *const d = &fresh->demands[i];
        mt_result_goal *const g = &rec->goals[i];
        const double violation = evaluated ? demand_violation(d, v) : nan("");
        g->weighted = d->row_res >= 0;
        g->text = demand_text(fresh, d, &result->mem, &g->demand);
        g->pointer = mt_arena_printf(&result->mem, "/goals/%d", d->goal_index);
        g->value = demand_value(fresh, d, v, NULL);
        g->violation_percent = 100.0 * violation;
        g->met = violation <= d->tolerance * (1.0 + MET_SLACK);
        if (g->text == NULL || g->pointer == NULL) {
            return mt_fail_memory(err);
        }
        if (!g->weighted) {
            rec->feasible = rec->feasible && g->met;
            rec->violation_percent = g->violation_percent <= rec->violation_percent
                                         ? rec->violation_percent
                                         : g->violation_percent;
        }
    }
    return MT_OK;
}

/* Which vibration index has the mode at position pos? */
static int index_of(const mt_modes *modes, int pos)
{
    int index = 0;
    for (int i = 0; i <= pos; i++) {
        index += modes->kind[i] == MT_MODE_FLEXIBLE ? 1 : 0;
    }
    return index;
}

static mt_status describe_mode(mt_problem *fresh, int v, mt_analysis *scratch, int index,
                               const double *x, mt_result *result, mt_result_frequency *f,
                               mt_err *err)
{
    mt_view *const view = &fresh->views[v];
    const int pos = mt_modal_flexible(&scratch->modes, index);
    *f = mt_result_frequency_default();
    f->configuration = mt_analysis_configuration(scratch);
    f->mode = index;
    f->recommended_hz = pos >= 0 ? mt_modal_hz(&scratch->modes, pos) : nan("");
    f->sensitivity = mt_arena_f64(&result->mem, (size_t)fresh->n, 1);
    if (f->sensitivity == NULL) {
        return mt_fail_memory(err);
    }
    if (pos >= 0) {
        f->residual = scratch->modes.residual[pos];
        f->orthogonality = scratch->modes.orthogonality[pos];
        MT_TRY(mt_analysis_dlambda(scratch, pos, f->sensitivity, &f->repeated, err));
        for (int i = 0; i < fresh->n; i++) { /* d Hz = d lambda / (8 pi^2 Hz) */
            const double pi = 3.14159265358979323846;
            f->sensitivity[i] /= 8.0 * pi * pi * f->recommended_hz;
        }
        const int there = mt_modal_flexible(&view->analysis->modes, index);
        const double other = there >= 0 ? mt_modal_hz(&view->analysis->modes, there) : nan("");
        if (!(fabs(other - f->recommended_hz) <= RECOMPUTED_AGREES * f->recommended_hz)) {
            MT_TRY(mt_describe_warn(
                result, err,
                "%s mode %d: the search had %.12g Hz, a fresh analysis gives %.12g Hz",
                f->configuration, index, other, f->recommended_hz));
        }
    }
    for (int i = 0; i < view->n_named; i++) {
        const int named_pos = mt_view_position(view, 0, i, NULL);
        if (named_pos >= 0 && index_of(&view->analysis->modes, named_pos) == index) {
            f->name = fresh->study->model->modes[view->named[i].named].name.s;
        }
    }
    (void)x;
    return MT_OK;
}

static mt_status attach_demands(mt_problem *fresh, int v, mt_analysis *scratch, int from,
                                mt_recommendation *rec, mt_err *err)
{
    for (int i = 0; i < fresh->n_demands; i++) {
        const mt_demand *const d = &fresh->demands[i];
        if (d->view != v) {
            continue;
        }
        const int pos = mt_view_position(&fresh->views[v], d->mode, d->named, err);
        const int index = pos < 0 ? d->mode : index_of(&fresh->views[v].analysis->modes, pos);
        for (int k = from; k < rec->n_frequencies; k++) {
            mt_result_frequency *const f = &rec->frequencies[k];
            if (f->mode != index) {
                continue;
            }
            if (d->goal->type == MT_GOAL_FREQUENCY) {
                f->target_hz = d->target_hz;
                f->at_least_hz = d->goal->at_least;
                f->at_most_hz = d->goal->at_most;
                const double over = fmax(fmax(d->goal->at_least / f->recommended_hz,
                                              f->recommended_hz / d->goal->at_most) -
                                             1.0,
                                         0.0);
                f->error_percent = MT_HAS(d->target_hz)
                                       ? 100.0 * ((f->recommended_hz / d->target_hz) - 1.0)
                                       : 100.0 * over;
            } else {
                f->reference = d->shape.reference;
                const int there = mt_modal_flexible(&scratch->modes, index);
                if (there >= 0) {
                    MT_TRY(mt_reference_mac(scratch, there, &d->shape, &f->mac, err));
                }
            }
        }
    }
    return MT_OK;
}

static int modes_to_list(mt_problem *fresh, int v)
{
    const mt_modes *const modes = &fresh->views[v].analysis->modes;
    int flexible = 0;
    int wanted = LISTED_MODES;
    for (int i = 0; i < modes->count; i++) {
        flexible += modes->kind[i] == MT_MODE_FLEXIBLE ? 1 : 0;
    }
    for (int i = 0; i < fresh->n_demands; i++) {
        const mt_demand *const d = &fresh->demands[i];
        const int pos =
            d->view == v ? mt_view_position(&fresh->views[v], d->mode, d->named, NULL) : -1;
        const int index = pos < 0 ? 0 : index_of(modes, pos);
        wanted = index > wanted ? index : wanted;
    }
    return wanted < flexible ? wanted : flexible;
}

static double original_hz(const mt_recommendation *baseline, const mt_result_frequency *f)
{
    for (int i = 0; baseline != NULL && i < baseline->n_frequencies; i++) {
        const mt_result_frequency *const b = &baseline->frequencies[i];
        const bool same_name =
            f->name != NULL && b->name != NULL && strcmp(f->name, b->name) == 0;
        const bool same = strcmp(f->configuration, b->configuration) == 0 &&
                          (f->name != NULL ? same_name : f->mode == b->mode);
        if (same) {
            return b->recommended_hz;
        }
    }
    return baseline == NULL ? f->recommended_hz : nan("");
}

static mt_status describe_frequencies(mt_problem *fresh, const double *x,
                                      const mt_recommendation *baseline, mt_result *result,
                                      mt_recommendation *rec, mt_err *err)
{
    int most = 0;
    for (int v = 0; v < fresh->n_views; v++) {
        most += modes_to_list(fresh, v);
    }
    rec->frequencies = mt_arena_alloc(&result->mem, (size_t)most, sizeof *rec->frequencies);
    if (rec->frequencies == NULL) {
        return mt_fail_memory(err);
    }
    for (int v = 0; v < fresh->n_views; v++) {
        mt_analysis *scratch = NULL;
        mt_analysis_options opt = mt_analysis_options_default();
        const int from = rec->n_frequencies;
        const int count = modes_to_list(fresh, v);
        opt.gradient = true;
        mt_status rc = mt_analysis_new(fresh->study->model, fresh->views[v].configuration,
                                       fresh->n, fresh->inputs, x, &scratch, err);
        rc = rc == MT_OK ? mt_analysis_solve(scratch, x, &opt, err) : rc;
        for (int k = 1; k <= count && rc == MT_OK; k++) {
            rc = describe_mode(fresh, v, scratch, k, x, result,
                               &rec->frequencies[rec->n_frequencies], err);
            rec->n_frequencies += rc == MT_OK ? 1 : 0;
        }
        rc = rc == MT_OK ? attach_demands(fresh, v, scratch, from, rec, err) : rc;
        mt_analysis_delete(scratch);
        MT_TRY(rc);
    }
    for (int k = 0; k < rec->n_frequencies; k++) {
        rec->frequencies[k].original_hz = original_hz(baseline, &rec->frequencies[k]);
    }
    return MT_OK;
}

static void describe_score(const mt_problem *fresh, const mt_nlp_values *v,
                           mt_recommendation *rec)
{
    if (fresh->n_res > 0) {
        rec->misfit = mt_norm2(fresh->n_res, v->r);
    }
    switch (fresh->objective) {
    case MT_OBJECTIVE_CHANGE:
        rec->score = rec->change;
        rec->score_unit = "";
        break;
    case MT_OBJECTIVE_MASS:
        rec->score = v->f;
        rec->score_unit = "kg";
        break;
    case MT_OBJECTIVE_EXPRESSION:
        rec->score = v->f;
        rec->score_unit = "";
        break;
    case MT_OBJECTIVE_MISFIT:
        rec->score = rec->misfit;
        rec->score_unit = "";
        break;
    case MT_OBJECTIVE_NONE:
    case MT_OBJECTIVE_CLEARANCE:
        break;
    }
    if (!rec->feasible) {
        rec->score = nan("");
    }
}

static mt_status describe(mt_problem *fresh, const mt_design *design,
                          const mt_recommendation *baseline, mt_result *result,
                          mt_recommendation *rec, mt_err *err)
{
    mt_nlp_values v;
    mt_err why = {0};
    *rec = mt_recommendation_default();
    rec->rank = design->rank;
    MT_TRY(values_init(fresh, &fresh->mem, &v, err));
    double *const x = mt_arena_f64(&fresh->mem, (size_t)fresh->n, 1);
    if (x == NULL) {
        return mt_fail_memory(err);
    }
    mt_problem_x(fresh, design->t, x);
    MT_TRY(describe_parameters(fresh, x, design->t, result, rec, err));
    const mt_status rc = mt_problem_eval(fresh, design->t, false, &v, &why);
    if (rc == MT_E_MEMORY || rc == MT_E_INTERNAL) {
        return rc;
    }
    if (rc != MT_OK) {
        MT_TRY(mt_describe_warn(
            result, err, "the goals cannot be evaluated at %s: %s",
            design->found == NULL ? "the original design" : "a recommended design", why.text));
    }
    MT_TRY(describe_goals(fresh, &v, rc == MT_OK, result, rec, err));
    MT_TRY(describe_frequencies(fresh, x, baseline, result, rec, err));
    describe_score(fresh, &v, rec);
    rec->grade = rec->feasible ? "feasible" : "compromise";
    if (design->found != NULL) {
        rec->kkt_residual = design->found->kkt;
        rec->singular = design->found->singular;
    }
    return MT_OK;
}

mt_status mt_describe_design(mt_problem *p, const mt_design *design,
                             const mt_recommendation *baseline, mt_result *result,
                             mt_recommendation *rec, mt_err *err)
{
    mt_problem *fresh = NULL;
    MT_TRY(mt_problem_new(p->study, p->references, &fresh, err));
    const mt_status rc = describe(fresh, design, baseline, result, rec, err);
    mt_problem_delete(fresh);
    return rc;
}
