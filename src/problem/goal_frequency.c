/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * "frequency": q = the frequency of a mode [Hz], its rows in ln q,
 *     d ln q / dt = lambda' / (2 lambda) dx/dt
 */
#include "problem/goal_frequency.h"

#include <math.h>
#include <string.h>

#include "analysis/tracking.h"
#include "problem/goal.h"
#include "prove/box.h"
#include "prove/enclosure.h"

/* No floor lies lower: the square of an angular frequency would leave the range of a double. */
static const double LEAST_FLOOR_HZ = 1e-150;

double mt_frequency_ln_ratio(double hz, double edge_hz, double floor_hz)
{
    const double floor = fmax(floor_hz, LEAST_FLOOR_HZ);
    const double part = hz / floor;
    if (isinf(hz)) {
        return MT_MOST_INSIDE;
    }
    return part < 1.0 ? log(floor / edge_hz) + (0.5 * ((part * part) - 1.0))
                      : log(hz / edge_hz);
}

double mt_problem_ln_ratio(const mt_modes *modes, int pos, double edge_hz, double floor_hz)
{
    const double hz = pos < 0 ? HUGE_VAL : mt_modal_hz(modes, pos);
    return mt_frequency_ln_ratio(hz, edge_hz, floor_hz);
}

mt_status mt_problem_dln_frequency(mt_workspace *w, mt_analysis *a, int pos, double floor_hz,
                                   double *out, mt_err *err)
{
    const int n = w->p->n;
    int size = 1;
    int vibrating = 0;
    const mt_modes *const modes = &a->modes;
    if (pos < 0) {
        memset(out, 0, (size_t)n * sizeof *out);
        return MT_OK;
    }
    const int first = mt_modal_cluster(modes, pos, &size);
    const double lambda =
        fmax(modes->lambda[pos], mt_enclosure_lambda(fmax(floor_hz, LEAST_FLOOR_HZ)));
    for (int k = first; k < first + size; k++) {
        MT_TRY(mt_analysis_dlambda_raw(a, k, w->work, err));
        for (int i = 0; i < n; i++) {
            out[i] = k == first ? w->work[i] : out[i] + w->work[i];
        }
        /* vibrations of 0 Hz share their cluster with rigid-body modes, which have no slope and
         * add nothing to the sum */
        vibrating += modes->kind[k] == MT_MODE_FLEXIBLE ? 1 : 0;
    }
    for (int i = 0; i < n && vibrating > 0; i++) {
        out[i] *= mt_problem_dx_dt_at(w->p, i, w->x[i]) / (2.0 * lambda * (double)vibrating);
    }
    return MT_OK;
}

/* The same of a named mode: in a cluster by the vector of its own. */
static mt_status dln_named(mt_workspace *w, const mt_requirement *d, int pos, double *out,
                           mt_err *err)
{
    const mt_configuration_work *const view = &w->views[d->view];
    mt_analysis *const a = view->analysis;
    int size = 1;
    const double lambda = pos < 0 ? 0.0 : a->modes.lambda[pos];
    bool own = pos >= 0 && d->named >= 0 && lambda > mt_enclosure_lambda(d->floor_hz);
    if (own) {
        (void)mt_modal_cluster(&a->modes, pos, &size);
        own = size > 1;
    }
    if (own) {
        MT_TRY(mt_track_dlambda(a, view->of->shape[d->named], pos, out, &own, err));
    }
    for (int i = 0; i < w->p->n && own; i++) {
        out[i] *= mt_workspace_dx_dt(w, i) / (2.0 * lambda);
    }
    return own ? MT_OK : mt_problem_dln_frequency(w, a, pos, d->floor_hz, out, err);
}

/* The reference's frequency is the target. */
static mt_status compile_frequency(mt_problem *p, mt_requirement *d, mt_err *err)
{
    const mt_goal *const g = d->goal;
    if (g->reference_name.s != NULL) {
        MT_TRY(mt_reference_frequency_init(p->references, g->reference,
                                           mt_goal_reference_mode(p, d), &d->shape, err));
        d->equals = d->shape.frequency_hz;
    }
    d->floor_hz = MT_FREQUENCY_FLOOR * fmin(fmin(d->equals, g->at_least), g->at_most);
    return MT_OK;
}

static mt_status evaluate_frequency(mt_workspace *w, const mt_requirement *d, int pos,
                                    double *q, double *slope, mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    *q = pos < 0 ? HUGE_VAL : mt_modal_hz(&a->modes, pos);
    if (!(*q >= 0.0)) {
        return mt_fail(err, MT_E_DOMAIN, "configuration \"%s\": the mode has no frequency",
                       mt_analysis_configuration(a));
    }
    return slope == NULL ? MT_OK : dln_named(w, d, pos, slope, err);
}

const mt_goal_ops mt_goal_frequency = {.quantity = MT_QUANTITY_FREQUENCY,
                                       .compile = compile_frequency,
                                       .value = evaluate_frequency,
                                       .number = "frequency",
                                       .equals = "at"};
