/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Of H = sum_k r_k / (i w - s_k) + polynomial the largest value over a range, the RMS and the
 * peaks of tones have slopes by the envelope theorem: at the frequency where |H| is the largest
 *     d max|H| = Re(conj(H)/|H| dH),       d RMS = Re integral conj(H) dH G df / RMS,
 * a sum over frequencies of weights times dH, which adjoints give.
 */
#include "problem/forced_response.h"

#include <math.h>
#include <string.h>

#include "problem/forced_response_sampled.h"
#include "problem/goal.h"

void mt_forced_response_close(mt_configuration_work *view)
{
    for (int i = 0; i < view->n_forced_response; i++) {
        if (view->forced_response[i].open) {
            mt_response_free(&view->forced_response[i].r);
            view->forced_response[i].open = false;
        }
    }
}

/* Index of the goal's port pair in the configuration's list; added where missing. */
static int place_of(mt_configuration_problem *view, const mt_response_limit *s)
{
    for (int i = 0; i < view->n_pairs; i++) {
        if (strcmp(view->pairs[i].input, s->input.s) == 0 &&
            strcmp(view->pairs[i].output, s->output.s) == 0) {
            return i;
        }
    }
    view->pairs[view->n_pairs] = (mt_forced_response_pair){s->input.s, s->output.s};
    return view->n_pairs++;
}

static mt_status open_ports(mt_analysis *a, const mt_forced_response_pair *pair,
                            mt_response *out, mt_err *err)
{
    const mt_response_request ask = {
        .n_in = 1, .inputs = &pair->input, .n_out = 1, .outputs = &pair->output};
    const mt_status rc = mt_response_open(a, &ask, out, err);
    if (rc != MT_OK) {
        mt_response_free(out);
    }
    return rc;
}

/* Check that one goal alone has a forced problem at the original design. */
static mt_status try_ports(const mt_configuration_problem *view, const mt_requirement *d,
                           mt_err *err)
{
    const mt_forced_response_pair pair = {d->goal->response_limit->input.s,
                                          d->goal->response_limit->output.s};
    mt_response r = {.a = NULL};
    mt_err own = {.code = MT_OK};
    mt_status rc = open_ports(view->original, &pair, &r, &own);
    mt_response_free(&r);
    if (rc == MT_E_USAGE) {
        return mt_fail(err, MT_E_INPUT, "/goals/%d/output: %s", d->goal_index, own.text);
    }
    return mt_pass_final(rc, &own, err); /* else it may have one at another design */
}

mt_status mt_forced_response_ports_at(const mt_system *sys, const mt_response_limit *s,
                                      const char *at, mt_arena *mem, mt_port *in, mt_port *out,
                                      mt_err *err)
{
    mt_err own = {.code = MT_OK};
    const char *where = "input";
    mt_status rc = mt_port_input(sys, s->input.s, mem, in, &own);
    if (rc == MT_OK) {
        where = "output";
        rc = mt_port_output(sys, s->output.s, mem, out, &own);
    }
    return rc == MT_OK         ? MT_OK
           : rc == MT_E_MEMORY ? mt_fail_memory(err)
                               : mt_fail(err, MT_E_INPUT, "%s/%s: %s", at, where, own.text);
}

mt_status mt_forced_response_ports(mt_problem *p, const mt_requirement *d, mt_port *in,
                                   mt_port *out, mt_err *err)
{
    const char *const at = mt_arena_printf(&p->mem, "/goals/%d", d->goal_index);
    MT_TRY(mt_arena_check(&p->mem, err));
    return mt_forced_response_ports_at(p->views[d->view].original->sys, d->goal->response_limit,
                                       at, &p->mem, in, out, err);
}

mt_status mt_forced_response_compile(mt_problem *p, mt_requirement *d, mt_err *err)
{
    mt_configuration_problem *const view = &p->views[d->view];
    mt_port in;
    mt_port out;
    MT_TRY(mt_forced_response_ports(p, d, &in, &out, err));
    MT_TRY(try_ports(view, d, err));
    if (view->pairs == NULL) {
        view->pairs = mt_arena_alloc(&p->mem, (size_t)p->study->n_goals, sizeof *view->pairs);
        MT_TRY(mt_arena_check(&p->mem, err));
    }
    d->pair = place_of(view, d->goal->response_limit);
    const double limit = fmin(fmin(d->equals, d->goal->at_least), d->goal->at_most);
    d->floor_hz = MT_FORCED_RESPONSE_FLOOR * limit;
    return MT_OK;
}

static mt_status open_sum(mt_forced_response *s, mt_err *err)
{
    mt_err own = {.code = MT_OK};
    mt_status rc = mt_response_sums(&s->r, &s->sum, &own);
    rc = rc == MT_OK ? mt_frf_init(&s->frf, &s->sum, &s->r.mem, &own) : rc;
    s->summed = rc == MT_OK;
    return rc == MT_OK || rc == MT_E_SINGULAR ? MT_OK : mt_fail(err, rc, "%s", own.text);
}

static mt_status open_view(mt_workspace *w, const mt_requirement *d, mt_forced_response **out,
                           mt_err *err)
{
    mt_configuration_work *const view = &w->views[d->view];
    const mt_configuration_problem *const of = &w->c->views[d->view];
    if (view->forced_response == NULL) {
        view->forced_response =
            mt_arena_alloc(&w->mem, (size_t)of->n_pairs, sizeof *view->forced_response);
        MT_TRY(mt_arena_check(&w->mem, err));
        view->n_forced_response = of->n_pairs;
    }
    mt_forced_response *const s = &view->forced_response[d->pair];
    *out = s;
    if (s->open) {
        return MT_OK;
    }
    MT_TRY(open_ports(view->analysis, &of->pairs[d->pair], &s->r, err));
    s->open = true;
    const mt_status rc = open_sum(s, err);
    if (rc != MT_OK) {
        mt_response_free(&s->r);
        s->open = false;
    }
    return rc;
}

mt_status mt_forced_response_find(mt_workspace *w, const mt_requirement *d, double lower,
                                  double upper, mt_forced_response_peak *out, mt_err *err)
{
    mt_forced_response *s = NULL;
    MT_TRY(open_view(w, d, &s, err));
    *out = (mt_forced_response_peak){.proven = s->summed};
    if (!s->summed) {
        return mt_sampled_find(&s->r, lower, upper, &out->at, &out->by_omega, err);
    }
    out->at = mt_sine_peak_find(&s->frf, lower, upper);
    if (out->at.end == MT_FORCED_FINITE) {
        double complex jet[3];
        mt_frf_jet(&s->frf, (mt_near){out->at.omega, 0.0}, jet);
        out->by_omega = creal(mt_frf_times(out->at.direction, jet[1]));
    }
    return MT_OK;
}

mt_status mt_forced_response_respond(mt_workspace *w, const mt_requirement *d,
                                     mt_vibration_response *out, bool *proven, mt_err *err)
{
    const mt_vibration *const v = d->goal->response_limit->profile;
    mt_forced_response *s = NULL;
    MT_TRY(open_view(w, d, &s, err));
    *proven = s->summed;
    return s->summed ? mt_vibration_respond(v, &s->sum, &s->r.mem, out, err)
                     : mt_sampled_respond(&s->r, v, out, err);
}

mt_status mt_forced_response_nodes(mt_workspace *w, const mt_requirement *d,
                                   const mt_vibration_response *r, double by_rms,
                                   double by_sine, mt_spectral_nodes *out, mt_err *err)
{
    const mt_vibration *const v = d->goal->response_limit->profile;
    mt_forced_response *s = NULL;
    MT_TRY(open_view(w, d, &s, err));
    return s->summed
               ? mt_vibration_respond_nodes(v, &s->sum, r, by_rms, by_sine, &s->r.mem, out, err)
               : mt_sampled_nodes(&s->r, v, r, by_rms, by_sine, out, err);
}

mt_status mt_forced_response_slope(mt_workspace *w, const mt_requirement *d,
                                   const mt_spectral_nodes *nodes, double factor, double *out,
                                   mt_err *err)
{
    mt_forced_response *s = NULL;
    MT_TRY(open_view(w, d, &s, err));
    MT_TRY(mt_response_weighted_slopes(&s->r, 0, 0, nodes->n, nodes->omega, nodes->weight, out,
                                       err));
    for (int k = 0; k < w->p->n; k++) {
        out[k] *= factor * mt_workspace_dx_dt(w, k);
    }
    return MT_OK;
}

void mt_forced_response_to_ln(const mt_workspace *w, const mt_requirement *d, double q,
                              double *slope)
{
    const double by = q < d->floor_hz ? q / (d->floor_hz * d->floor_hz) : 1.0 / q;
    for (int k = 0; k < w->p->n; k++) {
        slope[k] *= by;
    }
}

mt_status mt_forced_response_find_peak(mt_workspace *w, const mt_requirement *d,
                                       mt_forced_response_value *out, mt_err *err)
{
    *out = (mt_forced_response_value){.value = nan(""), .error = nan(""), .omega = nan("")};
    MT_TRY(d->ops->look(w, d, out, err));
    out->finite = out->end == MT_FORCED_FINITE;
    out->end_name = mt_forced_end_name(out->end);
    return MT_OK;
}

mt_status mt_forced_response_find_peak_at(mt_workspace *w, const mt_requirement *d,
                                          mt_analysis *a, mt_forced_response_value *out,
                                          mt_err *err)
{
    mt_configuration_work *const view = &w->views[d->view];
    mt_analysis *const own = view->analysis;
    mt_forced_response_close(view);
    view->analysis = a;
    const mt_status rc = mt_forced_response_find_peak(w, d, out, err);
    mt_forced_response_close(view);
    view->analysis = own;
    return rc;
}
