/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modetune/motion.h"

#include "library/mechanism_priv.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/base.h"
#include "simulate/realise.h"
#include "simulate/start.h"
#include "vibration/profile_response.h"

/* One motion at work. */
typedef struct work {
    mt_motion_options own;
    mt_linear *lin;
    const mt_system *sys;
    mt_arena mem;
    mt_sim_start start;
    mt_sim_options opt;
    mt_gauge *gauges; /* [n_outputs] */
    int *motion;      /* [n_outputs] 0 place, 1 velocity, 2 acceleration */
    mt_sim_result result;
} work;

static mt_status check_options(const mt_motion_options *o, mt_err *err)
{
    if (o->n_starts < 0 || o->n_rates < 0 || o->n_sines < 0 || o->seed < 0 ||
        !(o->tolerance >= 0.0 && o->tolerance < 1.0)) {
        return mt_fail(err, MT_E_USAGE, "a number of the options is out of its range");
    }
    if ((o->n_starts > 0 && o->starts == NULL) || (o->n_rates > 0 && o->rates == NULL) ||
        (o->n_sines > 0 && o->sines == NULL)) {
        return mt_fail(err, MT_E_USAGE, "a list of the options is NULL");
    }
    for (int i = 0; i < o->n_sines; i++) {
        const mt_motion_sine *const s = &o->sines[i];
        if (s->port == NULL || !(s->hz > 0.0) || !isfinite(s->hz) || !isfinite(s->amplitude) ||
            !isfinite(s->phase_rad)) {
            return mt_fail(err, MT_E_USAGE,
                           "sines[%d] of the options is without a port or a "
                           "number",
                           i);
        }
    }
    return MT_OK;
}

/* A joint with a coordinate. */
static mt_status find_movable_joint(const mt_system *sys, const char *name, int *out,
                                    mt_err *err)
{
    *out = name == NULL ? -1 : mt_system_find_joint(sys, name);
    return *out >= 0 && sys->joints[*out].coordinate >= 0
               ? MT_OK
               : mt_fail(err, MT_E_USAGE, "no joint with a coordinate is called \"%s\"",
                         name == NULL ? "" : name);
}

static mt_status find_joints(work *k, int n, const mt_motion_joint *from, mt_sim_joint **out,
                             mt_err *err)
{
    *out = mt_arena_alloc(&k->mem, (size_t)n, sizeof **out);
    MT_TRY(mt_arena_check(&k->mem, err));
    for (int i = 0; i < n; i++) {
        if (!isfinite(from[i].value)) {
            return mt_fail(err, MT_E_USAGE, "the value of a joint is not finite");
        }
        MT_TRY(find_movable_joint(k->sys, from[i].joint, &(*out)[i].joint, err));
        (*out)[i].value = from[i].value;
    }
    return MT_OK;
}

static mt_status find_outputs(work *k, int n, const char *const *names, mt_err *err)
{
    k->gauges = mt_arena_alloc(&k->mem, (size_t)n, sizeof *k->gauges);
    k->motion = mt_arena_int(&k->mem, (size_t)n);
    MT_TRY(mt_arena_check(&k->mem, err));
    for (int i = 0; i < n; i++) {
        const char *name = "";
        mt_port port = {.motion = 0};
        if (names[i] == NULL) {
            return mt_fail(err, MT_E_USAGE, "outputs[%d] is NULL", i);
        }
        MT_TRY(mt_port_split(names[i], false, &k->mem, &name, &port, err));
        k->gauges[i] = (mt_gauge){.channel = mt_system_find_channel(k->sys, name), .joint = -1};
        if (k->gauges[i].channel < 0) {
            MT_TRY(find_movable_joint(k->sys, name, &k->gauges[i].joint, err));
        }
        k->motion[i] = port.motion;
    }
    k->opt.n_gauges = n;
    k->opt.gauges = k->gauges;
    return MT_OK;
}

static mt_status add_sines(work *k, mt_sim_input *inputs, mt_err *err)
{
    const size_t n = (size_t)k->own.n_sines;
    mt_signal *const signals = mt_arena_alloc(&k->mem, n, sizeof *signals);
    mt_sine *const sines = mt_arena_alloc(&k->mem, n, sizeof *sines);
    MT_TRY(mt_arena_check(&k->mem, err));
    for (int i = 0; i < k->own.n_sines; i++) {
        const mt_motion_sine *const s = &k->own.sines[i];
        mt_port port;
        MT_TRY(mt_port_input(k->sys, s->port, &k->mem, &port, err));
        const bool ground = port.kind == MT_PORT_BASE;
        sines[i] = (mt_sine){.amplitude = s->amplitude, .hz = s->hz, .phase = s->phase_rad};
        signals[i] = (mt_signal){.kind = MT_SIGNAL_SINES, .n = 1, .sines = &sines[i]};
        inputs[k->opt.n_inputs++] = (mt_sim_input){.push = ground ? MT_SIM_BASE : MT_SIM_FORCE,
                                                   .at = port.index,
                                                   .slope = ground ? 2 - port.motion : 0,
                                                   .signal = &signals[i]};
    }
    return MT_OK;
}

static mt_status add_vibration(work *k, mt_sim_input *inputs, mt_err *err)
{
    const mt_vibration *const v = k->own.vibration;
    mt_response_request request = {.n_in = k->own.along == NULL ? 0 : 1,
                                   .inputs = &k->own.along};
    mt_port ground;
    mt_realised shake;
    MT_TRY(mt_profiled_ports(v, k->sys, &k->mem, &request, err));
    MT_TRY(mt_port_input(k->sys, request.inputs[0], &k->mem, &ground, err));
    MT_TRY(mt_profiled_input(&ground, err));
    MT_TRY(mt_realise(v, k->own.duration_s, (unsigned long)k->own.seed, &k->mem, &shake, err));
    mt_realise_inputs(&shake, ground.index, inputs + k->opt.n_inputs);
    k->opt.n_inputs += shake.n;
    return MT_OK;
}

static mt_status prepare_motion(work *k, int n_outputs, const char *const *outputs, mt_err *err)
{
    const mt_vibration *const v = k->own.vibration;
    const size_t room =
        (size_t)k->own.n_sines + (v == NULL ? 0 : (size_t)v->n_random + (size_t)v->n_tones);
    mt_sim_joint *starts = NULL;
    mt_sim_joint *rates = NULL;
    MT_TRY(mt_arena_init(&k->mem, 0, err));
    mt_sim_input *const inputs = mt_arena_alloc(&k->mem, room, sizeof *inputs);
    MT_TRY(mt_arena_check(&k->mem, err));
    k->opt = mt_sim_options_default();
    k->opt.duration_s = k->own.duration_s;
    k->opt.sample_s = k->own.sample_s;
    k->opt.tolerance = k->own.tolerance > 0.0 ? k->own.tolerance : k->opt.tolerance;
    k->opt.inputs = inputs;
    MT_TRY(find_outputs(k, n_outputs, outputs, err));
    MT_TRY(add_sines(k, inputs, err));
    if (v != NULL) {
        MT_TRY(add_vibration(k, inputs, err));
    }
    MT_TRY(find_joints(k, k->own.n_starts, k->own.starts, &starts, err));
    MT_TRY(find_joints(k, k->own.n_rates, k->own.rates, &rates, err));
    MT_TRY(mt_start_rest(k->lin, &k->mem, &k->start, err));
    if (k->own.n_starts > 0) {
        MT_TRY(mt_start_joints(k->lin, k->own.n_starts, starts, &k->mem, &k->start, err));
    }
    return mt_start_rates(k->lin, k->own.n_rates, rates, 0.0, &k->mem, &k->start, err);
}

static mt_status hand_out(const work *k, int room, double *values, mt_motion_told *told,
                          mt_err *err)
{
    const mt_sim_result *const r = &k->result;
    const ptrdiff_t n = k->opt.n_gauges;
    const double *const of[] = {r->value, r->speed, r->acceleration};
    if (n * r->n > room) {
        return mt_fail(err, MT_E_USAGE, "room for %d values, not %d", room, (int)(n * r->n));
    }
    for (ptrdiff_t i = 0; i < r->n; i++) {
        for (ptrdiff_t g = 0; g < n; g++) {
            values[g + (i * n)] = of[k->motion[g]][g + (i * n)];
        }
    }
    if (told != NULL) {
        *told = (mt_motion_told){.samples = r->n,
                                 .energy_scale_j = r->energy_scale_j,
                                 .energy_error_j = r->energy_error_j,
                                 .drift_m = r->gap_m,
                                 .steps = r->steps};
    }
    return MT_OK;
}

static mt_status simulate_outputs(work *k, int n_outputs, const char *const *outputs,
                                  mt_err *err)
{
    MT_TRY(check_options(&k->own, err));
    MT_TRY(prepare_motion(k, n_outputs, outputs, err));
    MT_TRY(mt_simulate(k->lin, &k->start, &k->opt, &k->mem, &k->result, err));
    return k->result.stop == MT_SIM_DONE
               ? MT_OK
               : mt_fail(err, MT_E_INTERRUPTED, "the motion was interrupted");
}

mt_status mt_mechanism_motion(mt_mechanism *mechanism, const mt_motion_options *options,
                              int n_outputs, const char *const *outputs, int room,
                              double *values, mt_motion_told *told, mt_err *err)
{
    MT_NOT_NULL(mechanism, err);
    MT_NOT_NULL(options, err);
    MT_NOT_NULL(outputs, err);
    MT_NOT_NULL(values, err);
    work k = {.lin = mechanism->a->lin, .sys = mechanism->a->sys};
    MT_TRY(MT_OPTIONS_TAKE(options, &k.own, err));
    if (n_outputs < 1 || mechanism->has_none) {
        return mt_fail(err, MT_E_USAGE, "mt_mechanism_motion: %s",
                       n_outputs < 1 ? "there is no output" : "the last evaluation has failed");
    }
    mt_status rc = simulate_outputs(&k, n_outputs, outputs, err);
    rc = rc == MT_OK ? hand_out(&k, room, values, told, err) : rc;
    mt_arena_free(&k.mem);
    return mt_err_in(err, rc, "mt_mechanism_motion");
}
