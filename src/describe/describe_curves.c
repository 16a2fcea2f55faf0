/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What turns, and how often per turn it excites: the lines of a Campbell diagram, one per rotor
 * and machine of an avoid goal. */
#include <complex.h>
#include <math.h>
#include <string.h>

#include "describe/describe.h"
#include "problem/configuration.h"
#include "problem/forced_response.h"
#include "problem/goal_frequency_response.h"
#include "problem/goals.h"
#include "response/ports.h"
#include "response/response.h"
#include "vibration/profile_response.h"

static mt_status put_rotor(const mt_rotor *rotor, mt_arena *mem, mt_result_excitation *e,
                           mt_err *err)
{
    const char *const name = rotor->name != NULL         ? rotor->name
                             : rotor->aircraft.s != NULL ? rotor->aircraft.s
                                                         : "rotor";
    e->name = mt_arena_strdup(mem, name);
    e->speed_lower_hz = rotor->speed_hz * rotor->range_lower;
    e->speed_upper_hz = rotor->speed_hz * rotor->range_upper;
    e->orders = mt_arena_alloc(mem, (size_t)rotor->n_harmonics, sizeof *e->orders);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < rotor->n_harmonics; i++) {
        const double order =
            mt_rotor_harmonic_hz(rotor, &rotor->harmonics[i]) / rotor->speed_hz;
        if (order > 0.0) {
            e->orders[e->n_orders++] = (mt_result_order){
                .label = mt_arena_strdup(mem, rotor->harmonics[i].text), .order = order};
        }
    }
    return mt_arena_check(mem, err);
}

static mt_status put_machine(const mt_machine *machine, mt_arena *mem, mt_result_excitation *e,
                             mt_err *err)
{
    const int n = mt_machine_line_count(machine);
    const char *const name = machine->name != NULL ? machine->name : "machine";
    mt_order_line *const lines = mt_arena_alloc(mem, (size_t)n, sizeof *lines);
    e->name = mt_arena_strdup(mem, name);
    e->speed_lower_hz = mt_machine_speed_hz(machine, 0);
    e->speed_upper_hz = mt_machine_speed_hz(machine, 1);
    e->orders = mt_arena_alloc(mem, (size_t)n, sizeof *e->orders);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_machine_lines(machine, mem, lines, err));
    e->n_orders = n;
    for (int i = 0; i < n; i++) {
        const bool own = strcmp(lines[i].of, name) == 0;
        e->orders[i] = (mt_result_order){
            .label = own ? mt_arena_strdup(mem, lines[i].what)
                         : mt_arena_printf(mem, "%s of %s", lines[i].what, lines[i].of),
            .order = lines[i].order};
    }
    return mt_arena_check(mem, err);
}

static mt_status describe_goal(const mt_study *study, int goal, mt_result *result, mt_err *err)
{
    const mt_goal *const g = &study->goals[goal];
    const mt_bands_source *const source = &g->avoid->source;
    mt_arena *const mem = &result->mem;
    for (int i = 0; i < source->n_rotors + source->n_machines; i++) {
        const bool machine = i >= source->n_rotors;
        mt_result_excitation *const e = &result->excitations[result->n_excitations];
        const mt_rotor *const rotor = machine ? NULL : &source->rotors[i];
        const mt_machine *const m = machine ? &source->machines[i - source->n_rotors] : NULL;
        *e = (mt_result_excitation){
            .pointer = mt_arena_printf(mem, "/goals/%d", goal),
            .up_to_hz = source->up_to_hz,
            .configurations = mt_arena_alloc(mem, (size_t)g->n_configurations, sizeof(char *))};
        MT_TRY(mt_arena_check(mem, err));
        for (int k = 0; k < g->n_configurations; k++) {
            const char *const name = study->model->configurations[g->configurations[k]].name.s;
            e->configurations[e->n_configurations++] = mt_arena_strdup(mem, name);
        }
        e->margin_percent =
            mt_bands_margin(source, machine ? m->margin_percent : rotor->margin_percent);
        MT_TRY(machine ? put_machine(m, mem, e, err) : put_rotor(rotor, mem, e, err));
        result->n_excitations++;
    }
    return MT_OK;
}

mt_status mt_describe_excitations(const mt_study *study, mt_result *result, mt_err *err)
{
    size_t most = 0;
    for (int i = 0; i < study->n_goals; i++) {
        const mt_avoid *const avoid = study->goals[i].avoid;
        most += avoid == NULL ? 0 : (size_t)avoid->source.n_rotors;
        most += avoid == NULL ? 0 : (size_t)avoid->source.n_machines;
    }
    result->excitations = mt_arena_alloc(&result->mem, most, sizeof *result->excitations);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < study->n_goals; i++) {
        if (study->goals[i].avoid != NULL) {
            MT_TRY(describe_goal(study, i, result, err));
        }
    }
    return MT_OK;
}

/* Which responses a result shows: those that the study lists, then those that its goals are
 * about, each pair of ports once, with what goals ask of it. */

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

/* Responses of a design that its result shows: each from an analysis made anew there, with all
 * modes. */

/* Points that all curves have, of which the picture then takes what it needs. */
enum { GRID = 100, MOST = 400 };

/* The pole that is nearest to i w; NaN: there is none. */
static double complex nearest_pole(const mt_response *r, double w)
{
    double complex nearest = nan("");
    double least = HUGE_VAL;
    for (int k = 0; k < r->n_poles; k++) {
        const double complex s = r->poles[k];
        const double distance = hypot(creal(s), cimag(s) - w);
        if (cimag(s) > 0.0 && distance < least) {
            least = distance;
            nearest = s;
        }
    }
    return nearest;
}

static mt_result_extreme extreme_of(const mt_response *r, const mt_extreme *e)
{
    /* what rounding leaves of 0 is 0 */
    const double complex h = !e->infinite && cabs(e->h) > e->error ? e->h : 0.0;
    const double complex s = e->peak ? nearest_pole(r, e->w) : nan("");
    return (mt_result_extreme){
        .kind = e->infinite        ? "resonance"
                : e->peak          ? "peak"
                : e->antiresonance ? "antiresonance"
                                   : "minimum",
        .hz = e->w / TWO_PI,
        .magnitude = e->infinite ? nan("") : cabs(h),
        .phase_deg = mt_phase_deg(h),
        .natural_hz = cabs(s) / TWO_PI,
        .damping_ratio = -creal(s) / cabs(s),
    };
}

static mt_status put_curve(const mt_response *r, const mt_curve *c, mt_arena *mem,
                           mt_design_curve *out, mt_err *err)
{
    int n = 0;
    int *kept = NULL;
    mt_arena scratch;
    MT_TRY(mt_arena_init(&scratch, 0, err));
    mt_status rc = mt_curve_thin(c, 0, 1, MOST, &scratch, &n, &kept, err);
    mt_curve_points *const to = &out->drawn;
    to->hz = mt_arena_f64(mem, (size_t)n, 1);
    to->magnitude = mt_arena_f64(mem, (size_t)n, 1);
    to->phase_deg = mt_arena_f64(mem, (size_t)n, 1);
    out->extremes = mt_arena_alloc(mem, (size_t)c->n_extremes, sizeof *out->extremes);
    rc = rc == MT_OK ? mt_arena_check(mem, err) : rc;
    for (int i = 0; i < n && rc == MT_OK; i++) {
        to->hz[i] = c->w[kept[i]] / TWO_PI;
        to->magnitude[i] = cabs(c->h[kept[i]]);
        to->phase_deg[i] = mt_phase_deg(c->h[kept[i]]);
        to->n_hz = to->n_magnitude = to->n_phase = i + 1;
    }
    for (int e = 0; e < c->n_extremes && rc == MT_OK; e++) {
        out->extremes[out->n_extremes++] = extreme_of(r, &c->extremes[e]);
    }
    mt_arena_free(&scratch);
    return rc;
}

/* The response to the whole profile, proven where it is a sum over poles. */
static mt_status response_limit(mt_response *r, const mt_vibration *v, mt_arena *mem,
                                mt_design_curve *out, mt_err *err)
{
    mt_profiled all;
    MT_TRY(mt_profiled_find(r, v, &all, err));
    const mt_vibration_response found = all.answers[0];
    mt_result_forced_response *const to = mt_arena_alloc(mem, 1, sizeof *to);
    mt_result_forced_response_tone *const tones =
        mt_arena_alloc(mem, (size_t)v->n_tones, sizeof *tones);
    MT_TRY(mt_arena_check(mem, err));
    *to = (mt_result_forced_response){.end = mt_forced_end_name(found.end),
                                      .proven = all.no_sums == NULL,
                                      .rms = found.rms,
                                      .rms_error_at_most = found.rms_bound,
                                      .sine = found.sine,
                                      .peak = found.peak,
                                      .n_tones = v->n_tones,
                                      .tones = tones};
    for (int i = 0; i < v->n_tones; i++) {
        const mt_sine_peak *const t = &found.tones[i];
        tones[i] =
            (mt_result_forced_response_tone){.label = v->tones[i].label,
                                             .hz = t->omega / TWO_PI,
                                             .peak = mt_vibration_respond_tone(v, &found, i),
                                             .excess_at_most = t->excess,
                                             .at_edge = t->at_edge};
    }
    out->vibration = to;
    return MT_OK;
}

static const mt_vibration *profile_of(const mt_study *study, const mt_result_curve *asked)
{
    for (int i = 0; i < study->n_profiles && asked->profile != NULL; i++) {
        if (strcmp(study->profiles[i].name.s, asked->profile->file) == 0) {
            return study->profiles[i].profile;
        }
    }
    return NULL;
}

/* G |H|^2 at the points that are drawn. */
static mt_status put_psd(const mt_vibration *v, mt_arena *mem, mt_curve_points *to, mt_err *err)
{
    to->psd = mt_arena_f64(mem, (size_t)to->n_hz, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < to->n_hz && v->n_random > 0; i++) {
        const double level = mt_vibration_density(v, to->hz[i]);
        to->psd[to->n_psd++] =
            level > 0.0 ? level * to->magnitude[i] * to->magnitude[i] : nan("");
    }
    return MT_OK;
}

static mt_status trace(mt_analysis *a, const mt_result_curve *asked, const mt_vibration *v,
                       mt_arena *mem, mt_design_curve *out, mt_err *err)
{
    mt_response r = {.a = NULL};
    mt_curve curve;
    const mt_response_request request = {
        .n_in = 1, .inputs = &asked->input, .n_out = 1, .outputs = &asked->output};
    const mt_curve_options opt = {.from = TWO_PI * asked->lower_hz,
                                  .to = TWO_PI * asked->upper_hz,
                                  .points = GRID,
                                  .log = true};
    mt_status rc = mt_response_open(a, &request, &r, err);
    if (rc == MT_OK && r.growing >= 0) {
        out->trouble = "unstable: a motion grows by itself, so there is no steady response";
    } else if (rc == MT_OK) {
        rc = mt_response_curve(&r, &opt, &curve, err);
        rc = rc == MT_OK ? put_curve(&r, &curve, mem, out, err) : rc;
        rc = rc == MT_OK && v != NULL ? put_psd(v, mem, &out->drawn, err) : rc;
        rc = rc == MT_OK && v != NULL ? response_limit(&r, v, mem, out, err) : rc;
    }
    mt_response_free(&r);
    return rc;
}

/* Describe a curve, or the reason for none. */
static mt_status describe_curve(const mt_workspace *fresh, const mt_result_curve *asked,
                                mt_arena *mem, mt_design_curve *out, mt_err *err)
{
    const mt_problem *const p = fresh->p;
    const mt_model *const model = p->study->model;
    const int configuration = mt_model_find_configuration(model, asked->configuration);
    mt_analysis *a = NULL;
    mt_err why = {.code = MT_OK};
    const mt_system_def def = mt_problem_system(p, configuration, fresh->x);
    mt_status rc = mt_analysis_new_of(&def, 0, &a, &why);
    rc = rc == MT_OK ? trace(a, asked, profile_of(p->study, asked), mem, out, &why) : rc;
    mt_analysis_delete(a);
    MT_TRY(mt_pass_final(rc, &why, err));
    if (rc != MT_OK) {
        *out = (mt_design_curve){.trouble = mt_arena_strdup(mem, why.text)};
    }
    return mt_arena_check(mem, err);
}

mt_status mt_describe_curves(const mt_workspace *fresh, mt_result *result,
                             mt_recommendation *rec, mt_err *err)
{
    rec->curves = mt_arena_alloc(&result->mem, (size_t)result->n_curves, sizeof *rec->curves);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < result->n_curves; i++) {
        mt_design_curve *const out = &rec->curves[rec->n_curves++];
        *out = (mt_design_curve){.trouble = NULL};
        MT_TRY(describe_curve(fresh, &result->curves[i], &result->mem, out, err));
        out->pointer = result->curves[i].pointer;
        out->configuration = result->curves[i].configuration;
    }
    return MT_OK;
}

/* What goals of forced vibration find at a design: how large, where, and how that is known. */

static const double PERCENT = 100.0;

static const char RELATIVE[] = "relative_";
static const char BASE[] = "base.";

/* "the acceleration of grip.x", "the force of spring.mount". */
static const char *output_text(const char *port, mt_arena *mem)
{
    static const char *const forces[] = {"spring.", "damper.", "joint."};
    const char *const colon = strchr(port, ':');
    const int length = (int)strcspn(port, ":");
    for (int k = 0; k < MT_COUNT(forces); k++) {
        if (strncmp(port, forces[k], strlen(forces[k])) == 0) {
            return mt_arena_printf(mem, "the force of %s", port);
        }
    }
    if (colon == NULL) {
        return mt_arena_printf(mem, "the displacement of %s", port);
    }
    const bool relative = strncmp(colon + 1, RELATIVE, strlen(RELATIVE)) == 0;
    return mt_arena_printf(mem, "the %s of %.*s%s",
                           colon + 1 + (relative ? strlen(RELATIVE) : 0), length, port,
                           relative ? " as seen from the ground" : "");
}

const char *mt_describe_response_value(const mt_goal *g, double value, mt_arena *mem)
{
    const bool both = MT_HAS(g->at_most) && MT_HAS(g->at_least);
    const bool lower = both && log(g->at_least / value) > log(value / g->at_most);
    const double limit = lower                 ? g->at_least
                         : MT_HAS(g->at_most)  ? g->at_most
                         : MT_HAS(g->at_least) ? g->at_least
                                               : g->equals;
    const double off = PERCENT * (value / limit - 1.0);
    const char *const what = MT_HAS(g->at_most) || MT_HAS(g->at_least) ? "limit" : "target";
    if (fabs(off) <= MT_DEFAULT_TOLERANCE_PERCENT) {
        return mt_arena_printf(mem, ", at its %s", what);
    }
    return mt_arena_printf(mem, ", %.3g %% %s its %s", fabs(off), off > 0.0 ? "above" : "below",
                           what);
}

const char *mt_describe_response_kind(const mt_response_limit *s)
{
    static const char *const kinds[MT_RESPONSE_LIMIT_QUANTITIES] = {"", " rms", " of its tones",
                                                                    " at peak"};
    return kinds[s->quantity];
}

/* ", largest at 17.2 Hz (proven over 5 to 500 Hz)". */
static const char *where_text(const mt_response_limit *s, const mt_result_response *r,
                              mt_arena *mem)
{
    const bool single = r->lower_hz == r->upper_hz;
    if (single || !MT_HAS(r->frequency_hz)) {
        return "";
    }
    return mt_arena_printf(
        mem, "%s at %.4g Hz%s (%s over %.4g to %.4g Hz)",
        s->quantity == MT_RESPONSE_LIMIT_RESPONSE ? "," : ", the response being largest",
        r->frequency_hz, r->at_edge ? ", an end of its range" : "", r->grade, r->lower_hz,
        r->upper_hz);
}

const char *mt_describe_response_limit(const mt_response_limit *s, mt_arena *mem)
{
    const char *const what = output_text(s->output.s, mem);
    const char *const by = s->profile == NULL ? s->input.s : s->profile_name.s;
    const bool force = strncmp(by, BASE, strlen(BASE)) != 0;
    return what == NULL ? NULL
                        : mt_arena_printf(mem, "%s %s%s", what,
                                          s->profile != NULL ? "under "
                                          : force            ? "under a force at "
                                                             : "for ",
                                          by);
}

static const char *text_of(const mt_goal *g, const mt_result_response *r, mt_arena *mem)
{
    const mt_response_limit *const s = g->response_limit;
    const char *const about = mt_describe_response_limit(s, mem);
    const char *const subject =
        about == NULL ? NULL : mt_arena_printf(mem, "%s in \"%s\"", about, r->configuration);
    if (subject == NULL) {
        return NULL;
    }
    if (!MT_HAS(r->value)) {
        return strcmp(r->end, "infinite") == 0
                   ? mt_arena_printf(mem,
                                     "%s is unbounded: an undamped motion is excited at its "
                                     "natural frequency",
                                     subject)
                   : mt_arena_printf(mem, "%s has no value", subject);
    }
    const char *const beside = mt_describe_response_value(g, r->value, mem);
    const char *const where = where_text(s, r, mem);
    return beside == NULL || where == NULL
               ? NULL
               : mt_arena_printf(mem, "%s is %.4g%s%s%s%s%s", subject, r->value,
                                 r->unit[0] != '\0' ? " " : "", r->unit,
                                 mt_describe_response_kind(s), beside, where);
}

/* Fill a response. A failure leaves it without a value: the text of the goal has the reason. */
static mt_status describe_response(mt_workspace *fresh, const mt_requirement *d, mt_arena *mem,
                                   mt_result_response *out, mt_err *err)
{
    const mt_goal *const g = d->goal;
    mt_forced_response_value v = {.finite = false};
    mt_err own = {.code = MT_OK};
    const mt_status rc = mt_forced_response_find_peak(fresh, d, &v, &own);
    MT_TRY(mt_pass_final(rc, &own, err));
    const bool has = rc == MT_OK && v.finite;
    *out = (mt_result_response){
        .pointer = mt_arena_printf(mem, "/goals/%d", d->goal_index),
        .configuration = mt_configuration_name(fresh->p, &fresh->p->views[d->view]),
        .input = g->response_limit->input.s,
        .output = g->response_limit->output.s,
        .profile = g->response_limit->profile_name.s,
        .quantity = mt_response_limit_names[g->response_limit->quantity],
        .unit = mt_study_goal_unit(fresh->p->study, g),
        .value = has ? v.value : nan(""),
        .error = has ? v.error : nan(""),
        .frequency_hz = has ? v.omega / TWO_PI : nan(""),
        .at_edge = has && v.at_edge,
        .lower_hz = v.lower_hz,
        .upper_hz = v.upper_hz,
        .end = rc == MT_OK ? v.end_name : "none",
        .grade = v.proven ? "proven" : "sampled"};
    out->text = text_of(g, out, mem);
    return mt_arena_check(mem, err);
}

mt_status mt_describe_responses(mt_workspace *fresh, mt_result *result, mt_recommendation *rec,
                                mt_err *err)
{
    const mt_problem *const p = fresh->p;
    rec->responses =
        mt_arena_alloc(&result->mem, (size_t)p->n_requirements, sizeof *rec->responses);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < p->n_requirements; i++) {
        if (p->requirements[i].ops->look != NULL) {
            MT_TRY(describe_response(fresh, &p->requirements[i], &result->mem,
                                     &rec->responses[rec->n_responses++], err));
        }
    }
    return MT_OK;
}
