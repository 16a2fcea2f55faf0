/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mechanisms of models for users of the library: modes, responses, and motion in time. */
#include "modetune/mechanism.h"

#include "modetune/motion.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/analysis.h"
#include "base/base.h"
#include "base/text.h"
#include "model/lint.h"
#include "model/values.h"
#include "response/response.h"
#include "simulate/signal.h"
#include "simulate/start.h"
#include "vibration/profile_response.h"

struct mt_mechanism {
    mt_analysis *a; /* owned */
    mt_arena mem;   /* lives as long as this */
    mt_arena scratch;
    int n_inputs;
    int *inputs;   /* [n_inputs] parameters */
    double *at;    /* [n_inputs] their values at the last evaluation */
    bool slopes;   /* derivatives were requested once: prepare them again */
    bool has_none; /* the last evaluation failed */
};

/* Modes and responses. */

static const double TWO_PI = 6.283185307179586477;

static mt_status refuse_missing_name(const char *what, const char *name, int n,
                                     const char *const *names, mt_err *err)
{
    const char *const nearest = mt_text_nearest(name, names, n);
    return nearest == NULL
               ? mt_fail(err, MT_E_USAGE, "no %s is called \"%s\"", what, name)
               : mt_fail(err, MT_E_USAGE, "no %s is called \"%s\"; did you mean \"%s\"?", what,
                         name, nearest);
}

/* The names of n things that `name_of` gives. */
static const char **names_of(const mt_model *model, int n,
                             const char *(*name_of)(const mt_model *model, int i),
                             mt_arena *mem, mt_err *err)
{
    const char **const names = mt_arena_alloc(mem, (size_t)n, sizeof *names);
    for (int i = 0; names != NULL && i < n; i++) {
        names[i] = name_of(model, i);
    }
    (void)mt_arena_check(mem, err);
    return names;
}

/* Fail where no configuration is named and there are several. */
static mt_status ask_which(int n, const char *const *names, mt_arena *mem, mt_err *err)
{
    enum { LISTED_MOST = 10 };
    const char *list = "";
    for (int i = 0; i < n && i < LISTED_MOST && list != NULL; i++) {
        list = mt_arena_printf(mem, "%s%s\"%s\"", list, i == 0 ? "" : ", ", names[i]);
    }
    MT_TRY(mt_arena_check(mem, err));
    return mt_fail(err, MT_E_USAGE, "the model has %d configurations: say which (%s%s)", n,
                   list, n > LISTED_MOST ? ", ..." : "");
}

static mt_status find_configuration(const mt_model *model, const char *name, mt_arena *mem,
                                    int *out, mt_err *err)
{
    const int n = mt_model_configuration_count(model);
    *out = name != NULL ? mt_model_find_configuration(model, name) : n == 1 ? 0 : MT_ABSENT;
    if (*out != MT_ABSENT) {
        return MT_OK;
    }
    const char **const names = names_of(model, n, mt_model_configuration_name, mem, err);
    if (names == NULL) {
        return MT_E_MEMORY;
    }
    return name == NULL ? ask_which(n, names, mem, err)
                        : refuse_missing_name("configuration", name, n, names, err);
}

static mt_status find_inputs(mt_mechanism *m, const mt_model *model, const char *const *inputs,
                             mt_err *err)
{
    const int n = mt_model_parameter_count(model);
    double *const own = mt_arena_f64(&m->scratch, (size_t)n, 1);
    m->inputs = mt_arena_int(&m->mem, (size_t)m->n_inputs);
    m->at = mt_arena_f64(&m->mem, (size_t)m->n_inputs, 1);
    MT_TRY(mt_arena_check(&m->mem, err));
    MT_TRY(mt_arena_check(&m->scratch, err));
    MT_TRY(mt_model_original_values(model, &m->scratch, own, NULL, err));
    for (int i = 0; i < m->n_inputs; i++) {
        if (inputs[i] == NULL) {
            return mt_fail(err, MT_E_USAGE, "mt_mechanism_new: inputs[%d] is NULL", i);
        }
        m->inputs[i] = mt_model_find_parameter(model, inputs[i]);
        if (m->inputs[i] == MT_ABSENT) {
            const char **const names =
                names_of(model, n, mt_model_parameter_name, &m->scratch, err);
            return names == NULL ? MT_E_MEMORY
                                 : refuse_missing_name("parameter", inputs[i], n, names, err);
        }
        for (int k = 0; k < i; k++) {
            if (m->inputs[k] == m->inputs[i]) {
                return mt_fail(err, MT_E_USAGE, "parameter \"%s\" is given twice", inputs[i]);
            }
        }
        m->at[i] = own[m->inputs[i]];
    }
    return MT_OK;
}

static mt_status init_mechanism(mt_mechanism *m, const mt_model *model,
                                const char *configuration, const char *const *inputs,
                                mt_err *err)
{
    int which = 0;
    MT_TRY(mt_arena_init(&m->mem, 0, err));
    MT_TRY(mt_arena_init(&m->scratch, 0, err));
    MT_TRY(find_configuration(model, configuration, &m->scratch, &which, err));
    MT_TRY(find_inputs(m, model, inputs, err));
    MT_TRY(mt_analysis_new(model, which, m->n_inputs, m->inputs, m->at, &m->a, err));
    m->a->n_rigid = -1; /* each design counts its own */
    return MT_OK;
}

mt_status mt_mechanism_new(const mt_model *model, const char *configuration, int n_inputs,
                           const char *const *inputs, mt_mechanism **out, mt_err *err)
{
    MT_NOT_NULL(out, err);
    *out = NULL;
    MT_NOT_NULL(model, err);
    if (n_inputs < 0) {
        return mt_fail(err, MT_E_USAGE, "mt_mechanism_new: n_inputs is negative");
    }
    if (n_inputs > 0) {
        MT_NOT_NULL(inputs, err);
    }
    mt_mechanism *const m = calloc(1, sizeof *m);
    if (m == NULL) {
        return mt_fail_memory(err);
    }
    m->n_inputs = n_inputs;
    const mt_status rc = init_mechanism(m, model, configuration, inputs, err);
    if (rc != MT_OK) {
        mt_mechanism_delete(m);
        return rc;
    }
    *out = m;
    return MT_OK;
}

void mt_mechanism_delete(mt_mechanism *mechanism)
{
    if (mechanism != NULL) {
        mt_analysis_delete(mechanism->a);
        mt_arena_free(&mechanism->mem);
        mt_arena_free(&mechanism->scratch);
        free(mechanism);
    }
}

static mt_status solve_modes(mt_mechanism *m, mt_err *err)
{
    mt_analysis_options opt = mt_analysis_options_default();
    opt.check = false;
    opt.gradient = m->slopes;
    mt_arena_clear(&m->scratch);
    m->has_none = true;
    MT_TRY(mt_model_admit(m->a->sys->model, m->a->sys->configuration, m->n_inputs, m->inputs,
                          m->at, &m->scratch, err));
    MT_TRY(mt_err_in(err, mt_analysis_solve(m->a, m->at, &opt, err), "configuration \"%s\"",
                     mt_analysis_configuration(m->a)));
    m->has_none = false;
    return MT_OK;
}

mt_status mt_mechanism_evaluate(mt_mechanism *mechanism, const double *values, mt_err *err)
{
    MT_NOT_NULL(mechanism, err);
    if (mechanism->n_inputs > 0) {
        MT_NOT_NULL(values, err);
    }
    for (int i = 0; i < mechanism->n_inputs; i++) {
        if (!isfinite(values[i])) {
            mechanism->has_none = true;
            return mt_fail(err, MT_E_USAGE, "mt_mechanism_evaluate: values[%d] is not finite",
                           i);
        }
    }
    for (int i = 0; i < mechanism->n_inputs; i++) {
        mechanism->at[i] = values[i];
    }
    return solve_modes(mechanism, err);
}

double mt_mechanism_value(const mt_mechanism *mechanism, const char *parameter)
{
    if (mechanism == NULL || parameter == NULL || mechanism->has_none) {
        return nan("");
    }
    const mt_system *const sys = mechanism->a->sys;
    const int p = mt_model_find_parameter(sys->model, parameter);
    return p == MT_ABSENT ? nan("") : mt_linear_value(mechanism->a->lin, sys->parameters[p]);
}

static const mt_modes *modes_of(const mt_mechanism *m)
{
    static const mt_modes none;
    return m == NULL || m->has_none ? &none : &m->a->modes;
}

int mt_mechanism_vibration_modes(const mt_mechanism *mechanism)
{
    const mt_modes *const modes = modes_of(mechanism);
    return mt_modal_index(modes, modes->count - 1);
}

int mt_mechanism_rigid_body_modes(const mt_mechanism *mechanism)
{
    return modes_of(mechanism)->n_rigid;
}

int mt_mechanism_unstable_modes(const mt_mechanism *mechanism)
{
    const mt_modes *const modes = modes_of(mechanism);
    return modes->n_unstable;
}

int mt_mechanism_undecided_modes(const mt_mechanism *mechanism)
{
    return modes_of(mechanism)->n_undecided;
}

/* Position of vibration mode `mode` among all modes; -1: none. */
static int position_of(const mt_mechanism *m, int mode)
{
    return mt_modal_flexible(modes_of(m), mode);
}

double mt_mechanism_hz(const mt_mechanism *mechanism, int mode)
{
    const int at = position_of(mechanism, mode);
    return at < 0 ? nan("") : mt_modal_hz(modes_of(mechanism), at);
}

double mt_mechanism_error_hz(const mt_mechanism *mechanism, int mode)
{
    const int at = position_of(mechanism, mode);
    return at < 0 ? nan("") : mt_modal_error_hz(modes_of(mechanism), at);
}

int mt_mechanism_multiplicity(const mt_mechanism *mechanism, int mode)
{
    const int at = position_of(mechanism, mode);
    int size = 0;
    if (at >= 0) {
        (void)mt_modal_cluster(modes_of(mechanism), at, &size);
    }
    return size;
}

int mt_mechanism_channels(const mt_mechanism *mechanism)
{
    return mechanism == NULL ? 0 : mechanism->a->sys->n_channels;
}

const char *mt_mechanism_channel(const mt_mechanism *mechanism, int channel)
{
    return channel < 0 || channel >= mt_mechanism_channels(mechanism)
               ? NULL
               : mechanism->a->sys->channels[channel].name;
}

/* The positions of the first n vibration modes. */
static mt_status positions_of(const mt_mechanism *m, int n, const char *function, mt_arena *mem,
                              int **out, mt_err *err)
{
    if (n < 0 || (n > 0 && position_of(m, n) < 0)) {
        return mt_fail(err, MT_E_USAGE, "%s: there is no vibration mode %d", function, n);
    }
    *out = mt_arena_int(mem, (size_t)n);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < n; i++) {
        (*out)[i] = position_of(m, i + 1);
    }
    return MT_OK;
}

/* Shapes of the modes at these positions at ns channels: ns x n. */
static mt_status shapes_of(mt_mechanism *m, int ns, const int *channels, int n, const int *at,
                           double *shape, mt_err *err)
{
    for (int i = 0; i < n; i++) {
        MT_TRY(mt_analysis_shape(m->a, at[i], ns, channels, shape + ((ptrdiff_t)i * ns), NULL,
                                 err));
    }
    return MT_OK;
}

mt_status mt_mechanism_shape(mt_mechanism *mechanism, int mode, double *shape, mt_err *err)
{
    MT_NOT_NULL(mechanism, err);
    const int ns = mt_mechanism_channels(mechanism);
    const int at = position_of(mechanism, mode);
    if (ns > 0) {
        MT_NOT_NULL(shape, err);
    }
    if (at < 0) {
        return mt_fail(err, MT_E_USAGE, "mt_mechanism_shape: there is no vibration mode %d",
                       mode);
    }
    mt_arena_clear(&mechanism->scratch);
    int *const channels = mt_arena_int(&mechanism->scratch, (size_t)ns);
    MT_TRY(mt_arena_check(&mechanism->scratch, err));
    for (int i = 0; i < ns; i++) {
        channels[i] = i;
    }
    return shapes_of(mechanism, ns, channels, 1, &at, shape, err);
}

mt_status mt_mechanism_mac(mt_mechanism *a, int modes_a, mt_mechanism *b, int modes_b,
                           double *mac, mt_err *err)
{
    mt_common_channels common;
    int *at_a = NULL;
    int *at_b = NULL;
    MT_NOT_NULL(a, err);
    MT_NOT_NULL(b, err);
    MT_NOT_NULL(mac, err);
    mt_arena *const mem = &a->scratch;
    mt_arena_clear(mem);
    MT_TRY(positions_of(a, modes_a, __func__, mem, &at_a, err));
    MT_TRY(positions_of(b, modes_b, __func__, mem, &at_b, err));
    MT_TRY(mt_analysis_common_channels(a->a, b->a, mem, &common, err));
    if (common.n == 0) {
        return mt_fail(err, MT_E_USAGE, "mt_mechanism_mac: there is no channel in common");
    }
    double *const shape_a = mt_arena_f64(mem, (size_t)common.n, (size_t)modes_a);
    double *const shape_b = mt_arena_f64(mem, (size_t)common.n, (size_t)modes_b);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(shapes_of(a, common.n, common.a, modes_a, at_a, shape_a, err));
    MT_TRY(shapes_of(b, common.n, common.b, modes_b, at_b, shape_b, err));
    double *scale = NULL;
    MT_TRY(mt_channels_scale(a->a->sys, common.n, common.a, a->a->sys->length_m, mem, &scale,
                             err));
    mt_channels_weigh(common.n, scale, modes_a, shape_a);
    mt_channels_weigh(common.n, scale, modes_b, shape_b);
    mt_mac_matrix(common.n, modes_a, shape_a, modes_b, shape_b, mac);
    return MT_OK;
}

mt_status mt_mechanism_sensitivities(mt_mechanism *mechanism, int modes, double *hz_per_unit,
                                     mt_err *err)
{
    int *at = NULL;
    MT_NOT_NULL(mechanism, err);
    if (mechanism->n_inputs > 0) {
        MT_NOT_NULL(hz_per_unit, err);
    }
    if (!mechanism->has_none && !mechanism->a->with_gradient) {
        mechanism->slopes = true;
        MT_TRY(solve_modes(mechanism, err));
    }
    mt_arena_clear(&mechanism->scratch);
    MT_TRY(positions_of(mechanism, modes, __func__, &mechanism->scratch, &at, err));
    for (int p = 0; p < mechanism->n_inputs; p++) {
        mt_independence why;
        MT_TRY(mt_analysis_sensitivity(mechanism->a, p, modes, at, &mechanism->scratch,
                                       hz_per_unit + ((ptrdiff_t)p * modes), &why, err));
    }
    return MT_OK;
}

static mt_status check_ports(const mt_mechanism *m, const mt_ports *ports, const char *function,
                             mt_err *err)
{
    if (ports->n_inputs < 0 || ports->n_outputs < 0) {
        return mt_fail(err, MT_E_USAGE, "%s: a number of ports is negative", function);
    }
    if ((ports->n_inputs > 0 && ports->inputs == NULL) ||
        (ports->n_outputs > 0 && ports->outputs == NULL)) {
        return mt_fail(err, MT_E_USAGE, "%s: ports is without its names", function);
    }
    for (int i = 0; i < ports->n_inputs + ports->n_outputs; i++) {
        const bool input = i < ports->n_inputs;
        if ((input ? ports->inputs[i] : ports->outputs[i - ports->n_inputs]) == NULL) {
            return mt_fail(err, MT_E_USAGE, "%s: the name of a port is NULL", function);
        }
    }
    return m->has_none
               ? mt_fail(err, MT_E_USAGE, "%s: the last evaluation has failed", function)
               : MT_OK;
}

static mt_status check_hz(double hz, const char *function, mt_err *err)
{
    return hz > 0.0 && isfinite(TWO_PI * hz)
               ? MT_OK
               : mt_fail(err, MT_E_USAGE, "%s: a frequency is not above 0", function);
}

static mt_response_request request_of(const mt_ports *ports)
{
    return (mt_response_request){.n_in = ports->n_inputs,
                                 .inputs = ports->inputs,
                                 .n_out = ports->n_outputs,
                                 .outputs = ports->outputs};
}

/* Both parts of n numbers; NaN of what has no value. */
static void store_complex_parts(ptrdiff_t n, const double complex *h, double *re, double *im)
{
    for (ptrdiff_t i = 0; i < n; i++) {
        const bool has = isfinite(creal(h[i])) && isfinite(cimag(h[i]));
        re[i] = has ? creal(h[i]) : nan("");
        im[i] = has ? cimag(h[i]) : nan("");
    }
}

static mt_status respond(mt_response *r, int n, const double *hz, double *re, double *im,
                         double *error, mt_err *err)
{
    const ptrdiff_t pairs = (ptrdiff_t)r->ports.n_in * r->ports.n_out;
    double complex *const h = mt_arena_alloc(&r->mem, (size_t)pairs, sizeof *h);
    MT_TRY(mt_arena_check(&r->mem, err));
    for (ptrdiff_t i = 0; i < n; i++) {
        double *const own = error == NULL ? NULL : error + (i * pairs);
        const mt_sample at = {.h = h, .error = own};
        MT_TRY(mt_transfer_at(r->chosen, TWO_PI * hz[i], &at, &r->mem, err));
        store_complex_parts(pairs, h, re + (i * pairs), im + (i * pairs));
        for (ptrdiff_t k = 0; k < pairs && own != NULL; k++) {
            own[k] = isfinite(own[k]) ? own[k] : nan("");
        }
    }
    return MT_OK;
}

mt_status mt_mechanism_response(mt_mechanism *mechanism, const mt_ports *ports, int n,
                                const double *hz, double *re, double *im, double *error,
                                mt_err *err)
{
    MT_NOT_NULL(mechanism, err);
    MT_NOT_NULL(ports, err);
    MT_NOT_NULL(hz, err);
    MT_NOT_NULL(re, err);
    MT_NOT_NULL(im, err);
    MT_TRY(check_ports(mechanism, ports, __func__, err));
    for (int i = 0; i < n; i++) {
        MT_TRY(check_hz(hz[i], __func__, err));
    }
    mt_response r = {.a = NULL};
    const mt_response_request request = request_of(ports);
    mt_status rc = mt_response_open(mechanism->a, &request, &r, err);
    rc = rc == MT_OK ? mt_response_admit(&r, err) : rc;
    rc = rc == MT_OK ? respond(&r, n, hz, re, im, error, err) : rc;
    mt_response_free(&r);
    return rc;
}

mt_status mt_mechanism_response_slopes(mt_mechanism *mechanism, const mt_ports *ports,
                                       double hz, double *re, double *im, mt_err *err)
{
    MT_NOT_NULL(mechanism, err);
    MT_NOT_NULL(ports, err);
    if (mechanism->n_inputs > 0) {
        MT_NOT_NULL(re, err);
        MT_NOT_NULL(im, err);
    }
    MT_TRY(check_ports(mechanism, ports, __func__, err));
    MT_TRY(check_hz(hz, __func__, err));
    if (!mechanism->a->with_gradient) {
        mechanism->slopes = true;
        MT_TRY(solve_modes(mechanism, err));
    }
    mt_response r = {.a = NULL};
    const mt_response_request request = request_of(ports);
    mt_status rc = mt_response_open(mechanism->a, &request, &r, err);
    rc = rc == MT_OK ? mt_response_admit(&r, err) : rc;
    if (rc == MT_OK) {
        const ptrdiff_t size = (ptrdiff_t)r.ports.n_in * r.ports.n_out * mechanism->n_inputs;
        double complex *const dh = mt_arena_alloc(&r.mem, (size_t)size, sizeof *dh);
        rc = mt_arena_check(&r.mem, err);
        rc = rc == MT_OK ? mt_response_slopes_at(&r, TWO_PI * hz, dh, err) : rc;
        if (rc == MT_OK) {
            store_complex_parts(size, dh, re, im);
        }
    }
    mt_response_free(&r);
    return rc;
}

static mt_status shake(mt_mechanism *m, const mt_ports *ports, const mt_vibration *v, int room,
                       mt_vibration_answer *answers, mt_response *r, mt_err *err)
{
    mt_response_request request = request_of(ports);
    mt_profiled profiled;
    mt_arena_clear(&m->scratch);
    MT_TRY(mt_profiled_ports(v, m->a->sys, &m->scratch, &request, err));
    MT_TRY(mt_response_open(m->a, &request, r, err));
    MT_TRY(mt_profiled_find(r, v, &profiled, err));
    if (room < profiled.n_pairs) {
        return mt_fail(err, MT_E_USAGE, "mt_mechanism_vibration: room for %d answers, not %d",
                       room, profiled.n_pairs);
    }
    for (int p = 0; p < profiled.n_pairs; p++) {
        const mt_vibration_response *const a = &profiled.answers[p];
        answers[p] = (mt_vibration_answer){.end = (mt_vibration_end)a->end,
                                           .rms = a->rms,
                                           .rms_error = a->rms_bound,
                                           .tones = a->sine,
                                           .peak = a->peak,
                                           .proven = profiled.no_sums == NULL ? 1 : 0};
    }
    return MT_OK;
}

mt_status mt_mechanism_vibration(mt_mechanism *mechanism, const mt_ports *ports,
                                 const mt_vibration *vibration, int room,
                                 mt_vibration_answer *answers, mt_err *err)
{
    static const mt_ports none = {.n_inputs = 0};
    MT_NOT_NULL(mechanism, err);
    MT_NOT_NULL(vibration, err);
    MT_NOT_NULL(answers, err);
    ports = ports == NULL ? &none : ports;
    MT_TRY(check_ports(mechanism, ports, __func__, err));
    mt_response r = {.a = NULL};
    const mt_status rc = shake(mechanism, ports, vibration, room, answers, &r, err);
    mt_response_free(&r);
    return rc;
}

/* Motion in time. */

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
    return mt_start_rates(k->lin, k->own.n_rates, rates, NULL, &k->mem, &k->start, err);
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
