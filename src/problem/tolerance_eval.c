/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows at the corners: as requirement.c and avoidance.c make them, with the corner's modes and
 * its factors in the gradient. */
#include <math.h>

#include "analysis/count.h"
#include "problem/avoidance.h"
#include "problem/frequency.h"
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

/* ln(f / limit) at the corner, with its slopes over t in tolerance_box->slope. */
static mt_status frequency(mt_workspace *w, const mt_row *row, bool with_gradient,
                           double *value, mt_err *err)
{
    mt_analysis *const a = w->views[row->view].corners[row->corner];
    const double *const factor =
        w->c->tolerance_box->views[row->view].corners[row->corner].factor;
    const int pos = mt_modal_flexible(&a->modes, row->mode);
    const double floor_hz = MT_FREQUENCY_FLOOR * row->limit;
    if (pos < 0 && !mt_analysis_is_infinite(a, row->mode)) {
        return mt_fail(err, MT_E_DOMAIN,
                       "configuration \"%s\" has no vibration mode %d at a corner of the "
                       "tolerances",
                       mt_analysis_configuration(a), row->mode);
    }
    *value = mt_problem_ln_ratio(&a->modes, pos, row->limit, floor_hz);
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

double mt_tolerance_row_margin(const mt_subproblem *c, const mt_row *row, double value)
{
    const double sign = mt_row_sign(row);
    if (row->view >= 0) {
        return sign * -mt_log_ratio(row->limit, value);
    }
    return sign * (value - row->limit) /
           mt_requirement_unit(&c->requirements[row->requirement], row->limit);
}

static mt_status value_at_corner(mt_workspace *w, const mt_row *row, bool with_gradient,
                                 quantity *q, mt_err *err)
{
    if (row->view >= 0) {
        q->z = row->avoidance >= 0 && w->c->clearance ? w->t[w->p->n] : 0.0;
        return frequency(w, row, with_gradient, &q->value, err);
    }
    const mt_requirement *const d = &w->c->requirements[row->requirement];
    const mt_tolerance_corners *const set = &w->c->tolerance_box->limits[row->requirement];
    const double unit = mt_requirement_unit(d, row->limit);
    q->edge = row->limit / unit;
    return expression(w, &set->corners[row->corner], d->node, unit, with_gradient, &q->value,
                      err);
}

static mt_status eval_corners(mt_workspace *w, bool with_gradient, mt_nlp_values *out,
                              mt_err *err)
{
    const ptrdiff_t rows = w->c->rows.in.n;
    const int n = w->p->n;
    for (int at = mt_tolerance_next_row(w->c, 0); at >= 0;
         at = mt_tolerance_next_row(w->c, at + 1)) {
        const mt_row *const row = &w->c->rows.in.rows[at];
        const double sign = mt_row_sign(row);
        quantity q = {.z = 0.0};
        MT_TRY(value_at_corner(w, row, with_gradient, &q, err));
        out->in[at] = (sign * (q.value - q.edge)) - q.z;
        for (int i = 0; i < n && with_gradient; i++) {
            out->din[at + (i * rows)] = sign * w->tolerance_box->slope[i];
        }
        if (with_gradient && w->c->n_t > n) {
            out->din[at + (n * rows)] = row->avoidance < 0 ? 0.0 : -1.0;
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

/* mt_avoidance_margin over all corners, or over the ranges where known; modes correspond by
 * index. */
static double tolerance_margin(const mt_workspace *w, const mt_avoidance *c)
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

double mt_avoidance_margin(const mt_workspace *w, const mt_avoidance *c)
{
    return w->c->tolerance_box != NULL
               ? tolerance_margin(w, c)
               : mt_avoidance_find_modes(c, &w->views[c->view].analysis->modes, NULL);
}

double mt_avoidances_margin(const mt_workspace *w)
{
    double room = HUGE_VAL;
    for (int i = 0; i < w->c->n_avoidances; i++) {
        const mt_avoidance *const c = &w->c->avoidances[i];
        const double here = w->views[c->view].solved ? mt_avoidance_margin(w, c) : nan("");
        room = here < room || !MT_HAS(here) ? here : room;
    }
    return room;
}

const mt_row_ops mt_rows_corners = {.lay_out = mt_tolerance_lay_out, .eval = eval_corners};
