/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Goals at the worst corners: rows as demand.c and problem_clear.c make them, with the corner's modes and its factors in the gradient. */
#include <math.h>

#include "tune/robust.h"

static const mt_corner *corner_of(const mt_problem *p, int view, int corner)
{
    return &p->robust->views[view][corner];
}

static void move(const mt_problem *p, const double *factor)
{
    for (int i = 0; i < p->n; i++) {
        p->robust->x[i] = p->x[i] * factor[i];
    }
}

mt_status mt_robust_solve(mt_problem *p, bool with_gradient, mt_err *err)
{
    const mt_analysis_options opt = {
        .gradient = with_gradient, .vectors = with_gradient, .accuracy = true};
    for (int i = 0; p->robust != NULL && i < MT_CORNERS * p->robust->n_views; i++) {
        const mt_corner *const c = corner_of(p, i / MT_CORNERS, i % MT_CORNERS);
        if (c->analysis != NULL) {
            move(p, c->factor);
            MT_TRY(mt_err_in(err, mt_analysis_solve(c->analysis, p->robust->x, &opt, err),
                             "configuration \"%s\" at a corner of the tolerances",
                             mt_analysis_configuration(c->analysis)));
        }
    }
    return MT_OK;
}

static void put(const mt_problem *p, int row, double value, double sign, const double *slope,
                mt_nlp_values *out)
{
    const ptrdiff_t rows = mt_problem_rows_in(p);
    out->in[row] = value;
    for (int i = 0; i < p->n && slope != NULL; i++) {
        out->din[row + (i * rows)] = sign * slope[i];
    }
}

/* in = sign ln(f / edge) - z of a vibration mode at a corner. */
typedef struct edge {
    int view;
    int corner;
    int mode;
    double hz;
    double z;
    int row;
} edge;

static mt_status put_mode(mt_problem *p, const edge *e, bool with_gradient, mt_nlp_values *out,
                          mt_err *err)
{
    const mt_corner *const c = corner_of(p, e->view, e->corner);
    const double sign = e->corner == MT_SOFT ? 1.0 : -1.0;
    double *const slope = p->robust->slope;
    if (c->analysis == NULL) {
        return MT_OK; /* the row of the design itself stands */
    }
    const int pos = mt_modal_flexible(&c->analysis->modes, e->mode);
    const double floor = MT_FREQUENCY_FLOOR * e->hz;
    if (pos < 0) {
        return mt_fail(err, MT_E_DOMAIN,
                       "configuration \"%s\" has no vibration mode %d at a corner of the "
                       "tolerances",
                       mt_analysis_configuration(c->analysis), e->mode);
    }
    if (with_gradient) {
        MT_TRY(mt_problem_dln_frequency(p, c->analysis, pos, floor, slope, err));
        for (int i = 0; i < p->n; i++) {
            slope[i] *= c->factor[i];
        }
    }
    const double ratio = mt_problem_ln_ratio(&c->analysis->modes, pos, e->hz, floor);
    put(p, e->row, (sign * ratio) - e->z, sign, with_gradient ? slope : NULL, out);
    return MT_OK;
}

/* Value of a limit's expression at its least (0) or greatest (1) corner, slopes into robust->slope. */
static mt_status limit_value(mt_problem *p, int demand, int side, bool with_gradient,
                             double *value, mt_err *err)
{
    mt_robust *const r = p->robust;
    const double *const factor = r->limits[side][demand];
    const mt_node node = p->demands[demand].node;
    move(p, factor);
    MT_TRY(with_gradient ? mt_program_gradient(&p->program, r->x, r->value, r->grad, NULL, err)
                         : mt_program_eval(&p->program, r->x, r->value, NULL, err));
    *value = r->value[node];
    for (int i = 0; i < p->n && with_gradient; i++) {
        r->slope[i] =
            mt_problem_stretch(p, i) * factor[i] * r->grad[((ptrdiff_t)node * p->n) + i];
    }
    return MT_OK;
}

static mt_status put_limit(mt_problem *p, int demand, int side, int row, bool with_gradient,
                           mt_nlp_values *out, mt_err *err)
{
    const mt_goal *const g = p->demands[demand].goal;
    const double limit = side == 0 ? g->at_least : g->at_most;
    const double unit = fabs(limit) > 0.0 ? fabs(limit) : 1.0;
    const double sign = side == 0 ? 1.0 / unit : -1.0 / unit;
    double value = 0.0;
    MT_TRY(limit_value(p, demand, side, with_gradient, &value, err));
    put(p, row, sign * (value - limit), sign, with_gradient ? p->robust->slope : NULL, out);
    return MT_OK;
}

mt_status mt_robust_demand(mt_problem *p, const mt_demand *d, bool with_gradient,
                           mt_nlp_values *out, mt_err *err)
{
    if (p->robust == NULL || d->row_in < 0) {
        return MT_OK;
    }
    const bool limit = d->goal->type == MT_GOAL_LIMIT;
    const int demand = (int)(d - p->demands);
    const double ends[2] = {d->goal->at_least, d->goal->at_most};
    int row = d->row_in;
    if (limit && p->robust->limits[0][demand] == NULL) {
        return MT_OK;
    }
    for (int side = 0; side < 2; side++) {
        if (!MT_HAS(ends[side])) {
            continue;
        }
        const edge e = {.view = d->view,
                        .corner = side == 0 ? MT_SOFT : MT_STIFF,
                        .mode = d->mode,
                        .hz = ends[side],
                        .row = row};
        MT_TRY(limit ? put_limit(p, demand, side, row, with_gradient, out, err)
                     : put_mode(p, &e, with_gradient, out, err));
        row++;
    }
    return MT_OK;
}

mt_status mt_robust_clears(mt_problem *p, const double *t, bool with_gradient,
                           mt_nlp_values *out, mt_err *err)
{
    mt_clear_row at;
    if (p->robust == NULL || p->below == NULL || p->n_clears == 0) {
        return MT_OK;
    }
    const double z = p->clearance ? t[p->n] : 0.0;
    for (int k = 0; mt_clear_row_at(p, p->below, k, &at); k++) {
        const mt_clear *const c = &p->clears[at.clear];
        const mt_band *const band = &c->bands.items[at.band];
        const edge e = {.view = c->view,
                        .corner = at.above ? MT_SOFT : MT_STIFF,
                        .mode = at.mode,
                        .hz = at.above ? band->upper_hz : band->lower_hz,
                        .z = z,
                        .row = p->clears[0].row_in + k};
        MT_TRY(put_mode(p, &e, with_gradient, out, err));
    }
    return MT_OK;
}

const mt_modes *mt_robust_modes(const mt_problem *p, int view, int corner)
{
    const mt_corner *const c = p->robust == NULL ? NULL : corner_of(p, view, corner);
    return c == NULL || c->analysis == NULL ? &p->views[view].analysis->modes
                                            : &c->analysis->modes;
}

double mt_robust_room(const mt_problem *p, const mt_clear *c)
{
    const mt_modes *const soft = mt_robust_modes(p, c->view, MT_SOFT);
    const mt_modes *const stiff = mt_robust_modes(p, c->view, MT_STIFF);
    double room = soft->n_unstable + stiff->n_unstable > 0 ? nan("") : HUGE_VAL;
    for (int k = 1; mt_modal_flexible(soft, k) >= 0 && MT_HAS(room); k++) {
        const double low = mt_modal_hz(soft, mt_modal_flexible(soft, k));
        const double high = mt_modal_hz(stiff, mt_modal_flexible(stiff, k));
        for (int b = 0; b < c->bands.n; b++) {
            const mt_band *const band = &c->bands.items[b];
            const double below = band->lower_hz > 0.0 ? log(band->lower_hz / high) : -HUGE_VAL;
            const double above = fmax(log(low / band->upper_hz), -MT_MOST_INSIDE);
            room = fmin(room, fmax(below, above));
        }
    }
    return room;
}
