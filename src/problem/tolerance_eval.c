/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows at the corners: as requirement.c and goal_avoid.c make them, with the corner's modes and
 * its factors in the gradient. */
#include <math.h>

#include "analysis/count.h"
#include "problem/goal_avoid.h"
#include "problem/goal_frequency.h"
#include "problem/mode_band_pairs.h"
#include "problem/requirement.h"
#include "problem/tolerance.h"

static void scale_design(const mt_workspace *w, const double *factor)
{
    for (int i = 0; i < w->p->n; i++) {
        w->tolerance_box->x[i] = w->x[i] * factor[i];
    }
}

mt_status mt_tolerance_solve(mt_workspace *w, bool with_gradient, mt_err *err)
{
    for (int i = 0; w->c->tolerance_box != NULL && i < w->c->n_views; i++) {
        const mt_tolerance_corners *const set = &w->c->tolerance_box->views[i];
        const mt_analysis_options opt =
            mt_configuration_queries(w, &w->views[i], with_gradient);
        for (int k = 0; k < set->n; k++) {
            mt_analysis *const a = w->views[i].corners[k];
            scale_design(w, set->corners[k].factor);
            MT_TRY(mt_err_in(err, mt_analysis_solve(a, w->tolerance_box->x, &opt, err),
                             "configuration \"%s\" at a corner of the tolerances",
                             mt_analysis_configuration(a)));
        }
    }
    return MT_OK;
}

/* in = sign (q - edge) - z: q = ln(f / limit) and edge 0, or an expression and its limit over
 * their unit. */
typedef struct quantity {
    double value;
    double edge;
    double z; /* least clearance that is asked for */
} quantity;

/* ln(f / edge_hz) at the corner, with its slopes over t in tolerance_box->slope. */
static mt_status frequency(mt_workspace *w, int view, const mt_tolerance_row *row, int mode,
                           double edge_hz, bool with_gradient, double *value, mt_err *err)
{
    mt_analysis *const a = w->views[view].corners[row->corner];
    const double *const factor = w->c->tolerance_box->views[view].corners[row->corner].factor;
    const int pos = mt_modal_flexible(&a->modes, mode);
    const double floor_hz = MT_FREQUENCY_FLOOR * edge_hz;
    if (pos < 0 && !mt_analysis_is_infinite(a, mode)) {
        return mt_fail(err, MT_E_DOMAIN,
                       "configuration \"%s\" has no vibration mode %d at a corner of the "
                       "tolerances",
                       mt_analysis_configuration(a), mode);
    }
    *value = mt_problem_ln_ratio(&a->modes, pos, edge_hz, floor_hz);
    if (with_gradient) {
        MT_TRY(mt_problem_dln_frequency(w, a, pos, floor_hz, w->tolerance_box->slope, err));
        for (int i = 0; i < w->p->n; i++) {
            w->tolerance_box->slope[i] *= factor[i];
        }
    }
    return MT_OK;
}

static mt_status expression(mt_workspace *w, const mt_tolerance_corner *c, mt_node node,
                            double unit, bool with_gradient, double *value, mt_err *err)
{
    const mt_problem *const p = w->p;
    mt_tolerance_work *const r = w->tolerance_box;
    mt_node bad = MT_NO_NODE;
    mt_err own = {0};
    scale_design(w, c->factor);
    const mt_status rc =
        with_gradient ? mt_program_gradient(&p->program, r->x, r->value, r->grad, &bad, &own)
                      : mt_program_eval(&p->program, r->x, r->value, &bad, &own);
    if (rc != MT_OK && !(rc == MT_E_DOMAIN && bad >= p->n_searched)) {
        return mt_fail(err, rc, "%s", own.text);
    }
    *value = r->value[node] / unit;
    for (int i = 0; i < p->n && with_gradient; i++) {
        r->slope[i] = mt_workspace_dx_dt(w, i) * c->factor[i] *
                      r->grad[((ptrdiff_t)node * p->n) + i] / unit;
    }
    return MT_OK;
}

/* Limit of a row; of a target with its tolerance. */
static double limit_of(const mt_problem *p, const mt_tolerance_row *row)
{
    const mt_requirement *const d = &p->requirements[row->requirement];
    const bool low = row->side == MT_LOWEST;
    const double give = low ? -d->tolerance : d->tolerance;
    if (!d->ranged) {
        return low ? d->goal->at_least : d->goal->at_most;
    }
    return d->measure == MT_MEASURE_RATIO
               ? d->equals * (1.0 + give)
               : d->equals + (give * mt_requirement_unit(d, d->equals));
}

static double edge_of(const mt_subproblem *c, const mt_tolerance_row *row)
{
    const mt_band *const band = &c->avoidances[row->at.avoidance].bands.items[row->at.band];
    return row->at.above ? band->upper_hz : band->lower_hz;
}

bool mt_tolerance_at_corner(const mt_subproblem *c, int i)
{
    for (int k = 0; c->tolerance_box != NULL && k < c->tolerance_box->n_rows; k++) {
        if (c->tolerance_box->rows[k].row == i) {
            return true;
        }
    }
    return false;
}

double mt_tolerance_limit_hz(const mt_subproblem *c, const mt_tolerance_row *row)
{
    if (row->requirement < 0) {
        return edge_of(c, row);
    }
    return c->p->requirements[row->requirement].view >= 0 ? limit_of(c->p, row) : nan("");
}

double mt_tolerance_row_margin(const mt_subproblem *c, const mt_tolerance_row *row,
                               double value)
{
    const double sign = row->side == MT_LOWEST ? 1.0 : -1.0;
    const double limit_hz = mt_tolerance_limit_hz(c, row);
    if (MT_HAS(limit_hz)) {
        return sign * -mt_log_ratio(limit_hz, value);
    }
    const double limit = limit_of(c->p, row);
    return sign * (value - limit) /
           mt_requirement_unit(&c->p->requirements[row->requirement], limit);
}

static mt_status requirement_value(mt_workspace *w, const mt_tolerance_row *row,
                                   bool with_gradient, quantity *q, mt_err *err)
{
    const mt_requirement *const d = &w->p->requirements[row->requirement];
    const double limit = limit_of(w->p, row);
    if (d->view >= 0) {
        return frequency(w, d->view, row, d->mode, limit, with_gradient, &q->value, err);
    }
    const double unit = mt_requirement_unit(d, limit);
    q->edge = limit / unit;
    return expression(w, &w->c->tolerance_box->limits[row->requirement].corners[row->corner],
                      d->node, unit, with_gradient, &q->value, err);
}

static mt_status band_value(mt_workspace *w, const mt_tolerance_row *row, bool with_gradient,
                            quantity *q, mt_err *err)
{
    const mt_avoidance *const avoidance = &w->c->avoidances[row->at.avoidance];
    q->z = w->c->clearance ? w->t[w->p->n] : 0.0;
    return frequency(w, avoidance->view, row, row->at.mode, edge_of(w->c, row), with_gradient,
                     &q->value, err);
}

mt_status mt_tolerance_rows(mt_workspace *w, bool with_gradient, mt_nlp_values *out,
                            mt_err *err)
{
    const mt_problem_tolerance_box *const r = w->c->tolerance_box;
    const ptrdiff_t rows = mt_subproblem_rows_in(w->c);
    const int n = w->p->n;
    for (int k = 0; r != NULL && k < r->n_rows; k++) {
        const mt_tolerance_row *const row = &r->rows[k];
        const double sign = row->side == MT_LOWEST ? 1.0 : -1.0;
        quantity q = {.z = 0.0};
        MT_TRY(row->requirement >= 0 ? requirement_value(w, row, with_gradient, &q, err)
                                     : band_value(w, row, with_gradient, &q, err));
        out->in[row->row] = (sign * (q.value - q.edge)) - q.z;
        for (int i = 0; i < n && with_gradient; i++) {
            out->din[row->row + (i * rows)] = sign * w->tolerance_box->slope[i];
        }
        if (with_gradient && w->c->n_t > n) {
            out->din[row->row + (n * rows)] = row->requirement >= 0 ? 0.0 : -1.0;
        }
    }
    return MT_OK;
}

/* Lowest and highest frequency of vibration mode k of a configuration: its range where known,
 * else over the nominal design and its corners; false: no such mode. */
static bool span_of(const mt_workspace *w, int view, int k, double *low, double *high)
{
    const int n_corners = w->c->tolerance_box->views[view].n;
    const mt_ranges *const known = mt_tolerance_known(w);
    const mt_tolerance_range *const range = mt_ranges_hz(known, view, k);
    if (range != NULL) {
        *low = range->value[MT_LOWEST];
        *high = range->value[MT_HIGHEST];
        return true;
    }
    if (known != NULL && known->n[view] > 0) {
        return false;
    }
    *low = HUGE_VAL;
    *high = 0.0;
    for (int c = -1; c < n_corners; c++) {
        const mt_modes *const modes =
            c < 0 ? &w->views[view].analysis->modes : &w->views[view].corners[c]->modes;
        const int pos = mt_modal_flexible(modes, k);
        if (pos < 0) {
            return false;
        }
        *low = fmin(*low, mt_modal_hz(modes, pos));
        *high = fmax(*high, mt_modal_hz(modes, pos));
    }
    return true;
}

double mt_tolerance_margin(const mt_workspace *w, const mt_avoidance *c)
{
    const mt_modes *const modes = &w->views[c->view].analysis->modes;
    const int n_corners = w->c->tolerance_box->views[c->view].n;
    double low = 0.0;
    double high = 0.0;
    bool indexed = mt_modal_indexed(modes);
    for (int k = 0; k < n_corners; k++) {
        indexed = indexed && mt_modal_indexed(&w->views[c->view].corners[k]->modes);
    }
    double room = indexed ? HUGE_VAL : nan("");
    mt_mode_band_pair p = mt_mode_band_pairs_all(modes, &c->bands);
    while (MT_HAS(room) && mt_mode_band_pairs_next(&p)) {
        if (p.b == 0 && !span_of(w, c->view, p.mode, &low, &high)) {
            break;
        }
        room = fmin(room, MT_HAS(low + high) ? mt_band_margin(p.band, low, high) : -HUGE_VAL);
    }
    return room > -HUGE_VAL ? room : nan("");
}
