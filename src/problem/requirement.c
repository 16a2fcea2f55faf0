/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One requirement of any kind: its number q against what is asked for, as the kind measures it.
 * With off(limit) of problem/goal.h
 *     target:   eq = off(target)
 *     limits:   in = off(at_least), -off(at_most)
 *     residual: r  = sqrt(w) off(target)
 */
#include "problem/requirement.h"

#include <math.h>

#include "analysis/count.h"
#include "problem/forced_response.h"
#include "problem/goal.h"
#include "problem/goal_frequency.h"

bool mt_requirement_is_frequency(const mt_requirement *d)
{
    return d->quantity == MT_QUANTITY_FREQUENCY && d->mode > 0;
}

bool mt_requirement_is_modal(const mt_requirement *d)
{
    return d->view >= 0 && d->goal->response_limit == NULL;
}

double mt_requirement_weight(const mt_workspace *w, const mt_requirement *d)
{
    return w->c->weight[d - w->p->requirements];
}

static void write_gradient_row(const mt_workspace *w, double *matrix, int rows, int row,
                               double factor, const double *gradient)
{
    const int n = w->p->n;
    if (gradient != NULL && w->c->n_t > n && matrix != w->dr) {
        /* the last coordinate enters no goal, but bands or those of its own */
        matrix[row + ((ptrdiff_t)n * rows)] = 0.0;
    }
    for (int i = 0; i < n && gradient != NULL; i++) {
        matrix[row + ((ptrdiff_t)i * rows)] = factor * gradient[i];
    }
}

bool mt_forced_response_given(const mt_workspace *w)
{
    return w->c->forced_response && w->t[w->p->n] != 0.0;
}

double mt_requirement_unit(const mt_requirement *d, double asked)
{
    const bool none = d->measure == MT_MEASURE_PART && !(fabs(asked) > 0.0);
    return none ? d->size : mt_measure_unit(d->measure, asked);
}

/* Deviation of q from a limit, and the factor of its slope. */
static double off(const mt_workspace *w, const mt_requirement *d, double q, double limit,
                  double *factor)
{
    const double unit = mt_requirement_unit(d, limit);
    *factor = 1.0 / unit;
    if (isinf(q) && d->goal->response_limit != NULL) {
        return MT_MOST_INSIDE + w->beyond;
    }
    return d->measure == MT_MEASURE_RATIO ? mt_frequency_ln_ratio(q, limit, d->floor_hz)
                                          : (q - limit) / unit;
}

/* Writes part k of a goal with an upper limit to its row. */
static void store_most(mt_workspace *w, const mt_requirement *d, int k, double q,
                       const double *slope, mt_nlp_values *out)
{
    double factor = 1.0;
    const int rows = mt_subproblem_rows_in(w->c);
    const double over = off(w, d, q, d->goal->at_most, &factor);
    if (d->row_soft < 0) {
        out->in[d->row_in + k] = -over;
        write_gradient_row(w, out->din, rows, d->row_in + k, -factor, slope);
        return;
    }
    w->worst = over <= w->worst ? w->worst : over;
    if (w->c->forced_response) {
        const int row = w->c->first_soft_row + d->row_soft + k;
        out->in[row] =
            mt_forced_response_given(w) ? w->t[w->p->n] - MT_FORCED_RESPONSE_SHIFT - over : 0.0;
        write_gradient_row(w, out->din, rows, row, -factor, slope);
        if (slope != NULL) {
            out->din[row + ((ptrdiff_t)w->p->n * rows)] = 1.0;
        }
    }
}

/* Rows of a number: slope NULL where none is wanted. */
static void write_requirement_rows(mt_workspace *w, const mt_requirement *d, double q,
                                   const double *slope, mt_nlp_values *out)
{
    double factor = 1.0;
    const double target = off(w, d, q, d->equals, &factor);
    if (d->row_res >= 0) {
        const double weight = sqrt(mt_requirement_weight(w, d));
        w->r[d->row_res] = weight * target;
        write_gradient_row(w, w->dr, w->p->n_res, d->row_res, weight * factor, slope);
        return;
    }
    if (d->row_eq >= 0) {
        out->eq[d->row_eq] = target;
        write_gradient_row(w, out->deq, mt_subproblem_rows_eq(w->c), d->row_eq, factor, slope);
        return;
    }
    if (d->row_soft < 0 && d->row_in < 0) {
        return; /* a range over tolerances */
    }
    const bool least = MT_HAS(d->goal->at_least);
    if (least) {
        out->in[d->row_in] = off(w, d, q, d->goal->at_least, &factor);
        write_gradient_row(w, out->din, mt_subproblem_rows_in(w->c), d->row_in, factor, slope);
    }
    if (MT_HAS(d->goal->at_most)) {
        store_most(w, d, least ? 1 : 0, q, slope, out);
    }
}

static mt_status no_mode(const mt_workspace *w, const mt_requirement *d, mt_err *err)
{
    const mt_analysis *const a = w->views[d->view].analysis;
    const char *const why =
        a->modes.n_unstable > 0 ? "is unstable, so that its modes have no index"
        : a->modes.n_undecided > 0
            ? "has a mode of which rounding hides whether it is stable, so that its modes have "
              "no index"
            : "has no such vibration mode here";
    return mt_fail(err, MT_E_DOMAIN, "configuration \"%s\" %s", mt_analysis_configuration(a),
                   why);
}

/* Index of the requirement's mode; -1: a goal without one, or a frequency at infinity. */
static mt_status find_mode(mt_workspace *w, const mt_requirement *d, int *pos, mt_err *err)
{
    *pos = -1;
    if (!mt_requirement_is_modal(d)) {
        return d->view < 0 || w->views[d->view].solved
                   ? MT_OK
                   : mt_fail(err, MT_E_DOMAIN, "configuration \"%s\" has no modes here",
                             mt_analysis_configuration(w->views[d->view].analysis));
    }
    mt_configuration_work *const view = &w->views[d->view];
    MT_TRY(mt_configuration_position(w, view, d->mode, d->named, pos, err));
    const bool infinite = d->quantity == MT_QUANTITY_FREQUENCY && view->solved &&
                          mt_analysis_is_infinite(view->analysis, d->mode);
    return *pos < 0 && !infinite ? no_mode(w, d, err) : MT_OK;
}

/* The rows of a number that is the largest of several. */
static mt_status store_parts(mt_workspace *w, const mt_requirement *d, bool with_gradient,
                             mt_nlp_values *out, double *value, mt_err *err)
{
    double *const slope = with_gradient ? w->slope : NULL;
    *value = 0.0;
    for (int k = 0; k < d->n_parts; k++) {
        double q = nan("");
        MT_TRY(d->ops->part(w, d, k, &q, slope, err));
        store_most(w, d, k, q, slope, out);
        *value = q <= *value ? *value : q;
    }
    return MT_OK;
}

mt_status mt_requirement_eval(mt_workspace *w, const mt_requirement *d, bool with_gradient,
                              mt_nlp_values *out, double *value, mt_err *err)
{
    int pos = -1;
    double q = nan("");
    double *const slope = with_gradient ? w->slope : NULL;
    MT_TRY(find_mode(w, d, &pos, err));
    if (d->ops->value == NULL) {
        MT_TRY(d->ops->residuals(w, d, pos, with_gradient, err));
        q = mt_norm2(d->n_res, w->r + d->row_res) / sqrt(mt_requirement_weight(w, d));
    } else if (d->n_parts > 0) {
        MT_TRY(store_parts(w, d, with_gradient, out, &q, err));
    } else {
        MT_TRY(d->ops->value(w, d, pos, &q, slope, err));
        write_requirement_rows(w, d, q, slope, out);
    }
    if (value != NULL) {
        *value = q;
    }
    return MT_OK;
}

mt_status mt_requirement_find_peak(mt_workspace *w, const mt_requirement *d, mt_analysis *a,
                                   mt_forced_response_value *out, mt_err *err)
{
    if (d->ops->look != NULL) {
        return mt_forced_response_find_peak_at(w, d, a, out, err);
    }
    mt_configuration_work *const view = &w->views[d->view];
    const mt_configuration_work own = *view;
    int pos = -1;
    *out = (mt_forced_response_value){.value = nan(""), .error = nan(""), .omega = nan("")};
    view->analysis = a;
    view->solved = true;
    mt_status rc = find_mode(w, d, &pos, err);
    rc = rc == MT_OK ? d->ops->value(w, d, pos, &out->value, NULL, err) : rc;
    view->analysis = own.analysis;
    view->solved = own.solved;
    out->finite = rc == MT_OK && isfinite(out->value);
    out->end = isinf(out->value) ? MT_FORCED_INFINITE : MT_FORCED_FINITE;
    out->end_name = mt_forced_end_name(out->end);
    return rc;
}

static double over_limit(const mt_requirement *d, double q, double limit)
{
    if (d->measure != MT_MEASURE_RATIO) {
        return (q - limit) / mt_requirement_unit(d, limit);
    }
    const double part = q / limit;
    return log(part >= MT_FORCED_RESPONSE_FLOOR ? part : MT_FORCED_RESPONSE_FLOOR);
}

double mt_requirement_over(const mt_requirement *d, double q)
{
    const mt_goal *const g = d->goal;
    double worst = -HUGE_VAL;
    if (isnan(q)) {
        return q;
    }
    worst = MT_HAS(g->at_most) ? over_limit(d, q, g->at_most) : worst;
    return MT_HAS(g->at_least) ? fmax(worst, -over_limit(d, q, g->at_least)) : worst;
}
