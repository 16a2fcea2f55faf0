/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which responses a result shows: those that the study lists, then those that its goals are
 * about, each pair of ports once, with what goals ask of it. */
#include <complex.h>
#include <math.h>
#include <string.h>

#include "describe/describe.h"
#include "problem/configuration.h"
#include "problem/goal_frequency_response.h"
#include "response/ports.h"

/* Beyond the band of a goal, and about a single frequency, so much more is shown. */
static const double BESIDE_BAND = 1.5;
static const double BESIDE_ONE = 4.0;
static const double TWO_PI = 6.283185307179586477;
enum { MOST_MEASURED = 400 };

/* True where both have the same ports of the same configuration and the same profile. */
static bool is_same_curve(const mt_result_curve *a, const mt_result_curve *b,
                          const mt_response_limit *s)
{
    const char *const of = a->profile == NULL ? NULL : a->profile->file;
    const char *const by = s->profile_name.s;
    return strcmp(a->configuration, b->configuration) == 0 && strcmp(a->input, b->input) == 0 &&
           strcmp(a->output, b->output) == 0 &&
           (by == NULL || (of != NULL && strcmp(of, by) == 0));
}

static mt_result_curve *find_curve(const mt_result *result, const mt_result_curve *like,
                                   const mt_response_limit *s)
{
    for (int i = 0; i < result->n_curves; i++) {
        if (is_same_curve(&result->curves[i], like, s)) {
            return &result->curves[i];
        }
    }
    return NULL;
}

static mt_status put_profile(const mt_response_limit *s, mt_arena *mem, mt_result_curve *out,
                             mt_err *err)
{
    const mt_vibration *const v = s->profile;
    if (v == NULL) {
        return MT_OK;
    }
    mt_result_profile *const p = mt_arena_alloc(mem, 1, sizeof *p);
    MT_TRY(mt_arena_check(mem, err));
    *p = (mt_result_profile){
        .file = s->profile_name.s,
        .name = v->name,
        .rms = mt_vibration_rms(v),
        .sigma = v->sigma,
        .rule = mt_vibration_sum_names[v->rule],
        .densities = mt_arena_alloc(mem, (size_t)v->n_random, sizeof *p->densities),
        .tones = mt_arena_alloc(mem, (size_t)v->n_tones, sizeof *p->tones)};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < v->n_random; i++) {
        const mt_psd *const g = &v->random[i].psd;
        p->densities[p->n_densities++] =
            (mt_result_density){.n_hz = g->n, .hz = g->hz, .n_level = g->n, .level = g->level};
    }
    for (int i = 0; i < v->n_tones; i++) {
        const mt_vibration_tone *const t = &v->tones[i];
        p->tones[p->n_tones++] = (mt_result_tone){t->label, t->lower_hz, t->upper_hz, t->level};
    }
    out->profile = p;
    return MT_OK;
}

/* Ports in full, and what the numbers are in. */
static mt_status put_ports(const mt_problem *p, int configuration, const mt_response_limit *s,
                           mt_arena *mem, mt_result_curve *out, mt_err *err)
{
    mt_system *sys = NULL;
    mt_port in;
    mt_port to;
    const mt_system_def def = mt_problem_system(p, configuration, p->original);
    mt_status rc = mt_system_new_of(&def, &sys, err);
    rc = rc == MT_OK ? mt_port_input(sys, s->input.s, mem, &in, err) : rc;
    rc = rc == MT_OK ? mt_port_output(sys, s->output.s, mem, &to, err) : rc;
    if (rc == MT_OK) {
        out->input = mt_arena_strdup(mem, in.name);
        out->output = mt_arena_strdup(mem, to.name);
        out->unit = mt_arena_printf(mem, "%s per %s", to.unit, in.unit);
        out->output_unit = mt_arena_strdup(mem, to.unit);
        rc = mt_arena_check(mem, err);
    }
    mt_system_delete(sys);
    return rc;
}

/* Choose the frequency range of the curve of a goal. */
static void choose_band(const mt_response_limit *s, mt_result_curve *out)
{
    const mt_vibration *const v = s->profile;
    double hz[2] = {s->lower_hz / BESIDE_BAND, s->upper_hz * BESIDE_BAND};
    if (v != NULL) {
        mt_vibration_range(v, true, true, hz);
    }
    out->lower_hz = hz[0];
    out->upper_hz = hz[1];
    if (!(out->lower_hz * BESIDE_BAND < out->upper_hz)) {
        out->lower_hz /= BESIDE_ONE;
        out->upper_hz *= BESIDE_ONE;
    }
}

/* The measurement that the goal compares the response with; NULL: none. */
static const mt_fit *fit_of(const mt_problem *p, int goal, int configuration)
{
    for (int i = 0; i < p->n_requirements; i++) {
        const mt_requirement *const d = &p->requirements[i];
        if (d->goal_index == goal && d->view >= 0 &&
            p->views[d->view].configuration == configuration) {
            return d->fit;
        }
    }
    return NULL;
}

/* Its lines, every second, third, ... of them where there are many. */
static mt_status put_measured(const mt_fit *fit, mt_arena *mem, mt_result_curve *out,
                              mt_err *err)
{
    const int step = 1 + (fit->n / MOST_MEASURED);
    const size_t n = (size_t)(fit->n / step) + 1;
    mt_curve_points *const to = &out->measured;
    *to = (mt_curve_points){.hz = mt_arena_f64(mem, n, 1),
                            .magnitude = mt_arena_f64(mem, n, 1),
                            .phase_deg = mt_arena_f64(mem, n, 1)};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < fit->n; i += step) {
        to->hz[to->n_hz++] = fit->w[i] / TWO_PI;
        to->magnitude[to->n_magnitude++] = hypot(creal(fit->h[i]), cimag(fit->h[i]));
        to->phase_deg[to->n_phase++] = mt_phase_deg(fit->h[i]);
    }
    return MT_OK;
}

/* Add the limits of the goal to its curve. */
static mt_status add_limit(const mt_goal *g, const char *pointer, mt_arena *mem,
                           mt_result_curve *to, mt_err *err)
{
    const mt_response_limit *const s = g->response_limit;
    int room = to->n_limits;
    if (s->profile_name.s != NULL || s->measurement_name.s != NULL) {
        return MT_OK; /* of a number, not of a curve */
    }
    mt_result_limit *const all =
        mt_arena_grow(mem, to->limits, to->n_limits, &room, sizeof *to->limits);
    MT_TRY(mt_arena_check(mem, err));
    to->limits = all;
    to->limits[to->n_limits++] = (mt_result_limit){.pointer = pointer,
                                                   .lower_hz = s->lower_hz,
                                                   .upper_hz = s->upper_hz,
                                                   .target = g->equals,
                                                   .at_least = g->at_least,
                                                   .at_most = g->at_most};
    return MT_OK;
}

static mt_status add_goal(const mt_problem *p, int goal, int configuration, mt_result *result,
                          mt_err *err)
{
    const mt_study *const study = p->study;
    const mt_goal *const g = &study->goals[goal];
    mt_arena *const mem = &result->mem;
    mt_result_curve own = {.pointer = mt_arena_printf(mem, "/goals/%d", goal),
                           .configuration = study->model->configurations[configuration].name.s,
                           .description = g->description};
    MT_TRY(put_ports(p, configuration, g->response_limit, mem, &own, err));
    mt_result_curve *to = find_curve(result, &own, g->response_limit);
    const mt_fit *const fit = fit_of(p, goal, configuration);
    if (to == NULL) {
        choose_band(g->response_limit, &own);
        if (fit != NULL) {
            own.lower_hz = fit->w[0] / TWO_PI;
            own.upper_hz = fit->w[fit->n - 1] / TWO_PI;
            own.upper_hz *= own.upper_hz > own.lower_hz ? 1.0 : BESIDE_ONE;
        }
        MT_TRY(put_profile(g->response_limit, mem, &own, err));
        to = &result->curves[result->n_curves++];
        *to = own;
    }
    if (fit != NULL && to->measured.n_hz == 0) {
        MT_TRY(put_measured(fit, mem, to, err));
    }
    return add_limit(g, own.pointer, mem, to, err);
}

static mt_status add_listed(const mt_problem *p, int index, mt_result *result, mt_err *err)
{
    const mt_study_response *const r = &p->study->responses[index];
    mt_result_curve *const out = &result->curves[result->n_curves];
    *out = (mt_result_curve){.pointer = mt_arena_printf(&result->mem, "/responses/%d", index),
                             .configuration =
                                 p->study->model->configurations[r->configuration].name.s,
                             .lower_hz = r->response_limit.lower_hz,
                             .upper_hz = r->response_limit.upper_hz,
                             .description = r->description,
                             .source = r->source};
    MT_TRY(put_ports(p, r->configuration, &r->response_limit, &result->mem, out, err));
    MT_TRY(put_profile(&r->response_limit, &result->mem, out, err));
    result->n_curves++;
    return MT_OK;
}

mt_status mt_describe_asked_curves(const mt_problem *p, mt_result *result, mt_err *err)
{
    const mt_study *const study = p->study;
    size_t most = (size_t)study->n_responses;
    if (study->examined) {
        return MT_OK; /* a point of a trade study */
    }
    for (int g = 0; g < study->n_goals; g++) {
        most += study->goals[g].response_limit == NULL
                    ? 0
                    : (size_t)study->goals[g].n_configurations;
    }
    result->curves = mt_arena_alloc(&result->mem, most, sizeof *result->curves);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < study->n_responses; i++) {
        MT_TRY(add_listed(p, i, result, err));
    }
    for (int g = 0; g < study->n_goals; g++) {
        const mt_goal *const goal = &study->goals[g];
        for (int k = 0; k < goal->n_configurations && goal->response_limit != NULL; k++) {
            MT_TRY(add_goal(p, g, goal->configurations[k], result, err));
        }
    }
    return mt_arena_check(&result->mem, err);
}
