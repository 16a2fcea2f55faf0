/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The options of `simulate` in the words of a system. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/simulate.h"
#include "model/values.h"
#include "response/ports.h"
#include "simulate/realise.h"

/* Lines of the result in a period of a sine, so that its harmonics are told apart. */
enum { STEADY_SAMPLES = 24 };
enum { AXES = 3 };
static const char *const base_ports[AXES] = {"base.x", "base.y", "base.z"};

/* A port of an input: what stands before '='. */
typedef struct port {
    mt_sim_push push;
    int at;    /* channel or axis */
    int slope; /* BASE: which derivative of the signal is the acceleration */
    int joint; /* MOVE */
} port;

static const char *option_name(mt_option_id option)
{
    return mt_options[option].name;
}

/* "NAME=REST": the name into mem, what follows. */
static mt_status split_name_and_rest(const mt_repeat *r, mt_arena *mem, const char **name,
                                     const char **rest, mt_err *err)
{
    const char *const equals = strchr(r->value, '=');
    if (equals == NULL || equals == r->value || equals[1] == '\0') {
        return mt_fail(err, MT_E_USAGE, "--%s: \"%s\" is not %s", option_name(r->option),
                       r->value, mt_options[r->option].value);
    }
    *name = mt_arena_strndup(mem, r->value, (size_t)(equals - r->value));
    *rest = equals + 1;
    return mt_arena_check(mem, err);
}

static bool is_input(mt_option_id option)
{
    return option == MT_OPT_PUSH || option == MT_OPT_SINE || option == MT_OPT_CHIRP ||
           option == MT_OPT_RANDOM;
}

/* A joint of the model, or a link's hinge ("beam.h3"), not a sensor's channel. */
static bool is_joint(const mt_model *model, const char *name)
{
    for (int i = 0; i < model->n_joints; i++) {
        if (strcmp(model->joints[i].name.s, name) == 0) {
            return true;
        }
    }
    const char *const dot = strchr(name, '.');
    return dot != NULL && dot[1] == 'h' && dot[2] >= '0' && dot[2] <= '9';
}

mt_status mt_sim_moved_joint(const mt_args *args, const mt_model *model, mt_arena *mem,
                             const char **name, mt_err *err)
{
    *name = NULL;
    for (int i = 0; i < args->n_repeats; i++) {
        const char *joint = "";
        const char *rest = "";
        if (!is_input(args->repeats[i].option)) {
            continue;
        }
        MT_TRY(split_name_and_rest(&args->repeats[i], mem, &joint, &rest, err));
        if (!is_joint(model, joint)) {
            continue;
        }
        if (*name != NULL && strcmp(*name, joint) != 0) {
            return mt_fail(err, MT_E_USAGE,
                           "--%s: one joint can be moved, \"%s\" already is, \"%s\" would be "
                           "the second",
                           option_name(args->repeats[i].option), *name, joint);
        }
        *name = joint;
    }
    return MT_OK;
}

mt_status mt_sim_start_of(const mt_args *args, mt_loaded_model *s, const char *joint,
                          bool *given, double *value, mt_err *err)
{
    *given = false;
    *value = 0.0;
    for (int i = 0; i < args->n_repeats; i++) {
        const char *name = "";
        const char *rest = "";
        if (args->repeats[i].option != MT_OPT_START) {
            continue;
        }
        MT_TRY(split_name_and_rest(&args->repeats[i], &s->mem, &name, &rest, err));
        if (strcmp(name, joint) == 0) {
            MT_TRY(mt_loaded_model_number(s, option_name(MT_OPT_START),
                                          mt_loaded_model_joint_unit(s->model, name), rest,
                                          strlen(rest), value, err));
            *given = true;
        }
    }
    return MT_OK;
}

static mt_status no_such_port(const mt_system *sys, mt_option_id option, const char *name,
                              bool base, bool channels, mt_arena *mem, mt_err *err)
{
    const size_t room = (size_t)sys->n_channels + (size_t)sys->n_joints + AXES;
    const char **const names = mt_arena_alloc(mem, room, sizeof *names);
    MT_TRY(mt_arena_check(mem, err));
    int n = 0;
    for (int i = 0; channels && i < sys->n_channels; i++) {
        names[n++] = sys->channels[i].name;
    }
    for (int i = 0; i < sys->n_joints; i++) {
        if (sys->joints[i].coordinate >= 0) {
            names[n++] = sys->joints[i].name;
        }
    }
    for (int i = 0; base && i < sys->dimension; i++) {
        names[n++] = base_ports[i];
    }
    const char *const nearest = mt_text_nearest(name, names, n);
    return mt_fail(err, MT_E_USAGE, "--%s: there is no %s \"%s\" in this configuration%s%s%s",
                   option_name(option), channels ? "sensor's direction and no joint" : "joint",
                   name, nearest == NULL ? "" : "; did you mean \"",
                   nearest == NULL ? "" : nearest, nearest == NULL ? "" : "\"?");
}

/* A joint with a coordinate. */
static mt_status find_coordinate_joint(const mt_system *sys, mt_option_id option,
                                       const char *name, mt_arena *mem, int *out, mt_err *err)
{
    *out = mt_system_find_joint(sys, name);
    if (*out < 0) {
        return no_such_port(sys, option, name, false, false, mem, err);
    }
    return sys->joints[*out].coordinate >= 0
               ? MT_OK
               : mt_fail(err, MT_E_USAGE, "--%s: joint \"%s\" (%s) has no coordinate",
                         option_name(option), name, mt_joint_type_name(sys->joints[*out].type));
}

static mt_status find_port(const mt_system *sys, mt_option_id option, const char *name,
                           mt_arena *mem, port *out, mt_err *err)
{
    *out = (port){.push = MT_SIM_FORCE, .at = mt_system_find_channel(sys, name)};
    if (out->at >= 0) {
        return MT_OK;
    }
    if (strncmp(name, "base.", strlen("base.")) == 0) {
        mt_port ground;
        MT_TRY(mt_err_in(err, mt_port_input(sys, name, mem, &ground, err), "--%s",
                         option_name(option)));
        *out = (port){.push = MT_SIM_BASE, .at = ground.index, .slope = 2 - ground.motion};
        return MT_OK;
    }
    const int joint = mt_system_find_joint(sys, name);
    if (joint >= 0 && sys->driven && joint == sys->drive_joint && !sys->trim) {
        *out = (port){.push = MT_SIM_MOVE, .joint = joint};
        return MT_OK;
    }
    return no_such_port(sys, option, name, true, true, mem, err);
}

/* Parameters of the model, and behind them the time. */
static int lookup(const void *context, const char *name, size_t length)
{
    const mt_model *const model = context;
    return length == 1 && name[0] == 't' ? model->n_parameters
                                         : mt_model_lookup(model, name, length);
}

static mt_status read_expression(mt_loaded_model *s, const char *text, mt_signal *out,
                                 mt_err *err)
{
    const mt_model *const model = s->model;
    mt_program *const p = mt_arena_alloc(&s->mem, 1, sizeof *p);
    mt_node *const nodes =
        mt_arena_alloc(&s->mem, (size_t)model->n_parameters + 1, sizeof *nodes);
    mt_expr e;
    MT_TRY(mt_arena_check(&s->mem, err));
    MT_TRY(mt_expr_parse(text, lookup, model, NULL, 0, &s->mem, &e, err));
    MT_TRY(mt_program_init(p, 1, &s->mem, err));
    for (int i = 0; i < model->n_parameters; i++) {
        nodes[i] = mt_program_const(p, s->values[i]);
    }
    nodes[model->n_parameters] = mt_program_input(p, 0, MT_NO_ADDR);
    out->kind = MT_SIGNAL_EXPRESSION;
    out->program = p;
    out->node = mt_program_expr(p, &e, nodes, MT_NO_ADDR);
    MT_TRY(mt_program_finish(p, err));
    out->work = mt_arena_alloc(&s->mem, (size_t)p->count, sizeof *out->work);
    return mt_arena_check(&s->mem, err);
}

/* The unit of amplitudes at a port in the model; NULL: SI. */
static const mt_unit *shown_amplitude_unit(const mt_loaded_model *s, const mt_system *sys,
                                           const port *p)
{
    switch (p->push) {
    case MT_SIM_FORCE:
        break;
    case MT_SIM_BASE:
        return p->slope > 0 ? s->model->units[MT_LENGTH] : NULL;
    case MT_SIM_MOVE:
        return mt_loaded_model_joint_unit(s->model, sys->joints[p->joint].name);
    }
    return NULL;
}

/* Numbers between the separators, the first in a unit: text "A@B" or "A@B:C". */
static mt_status read_numbers(mt_loaded_model *s, const mt_repeat *r, const mt_unit *unit,
                              const char *text, const char *separators, double *out,
                              mt_err *err)
{
    for (size_t k = 0;; k++) {
        const char *const end = separators[k] == '\0' ? NULL : strchr(text, separators[k]);
        if (end == NULL && separators[k] != '\0') {
            return mt_fail(err, MT_E_USAGE, "--%s: \"%s\" is not %s", option_name(r->option),
                           r->value, mt_options[r->option].value);
        }
        const size_t length = end == NULL ? strlen(text) : (size_t)(end - text);
        MT_TRY(mt_loaded_model_number(s, option_name(r->option), k == 0 ? unit : NULL, text,
                                      length, &out[k], err));
        if (end == NULL) {
            return MT_OK;
        }
        text = end + 1;
    }
}

static mt_status read_sine(mt_loaded_model *s, const mt_repeat *r, const mt_unit *unit,
                           const char *text, mt_signal *out, mt_err *err)
{
    double number[2] = {0.0, 0.0};
    mt_sine *const sine = mt_arena_alloc(&s->mem, 1, sizeof *sine);
    MT_TRY(mt_arena_check(&s->mem, err));
    MT_TRY(read_numbers(s, r, unit, text, "@", number, err));
    if (!(number[1] > 0.0)) {
        return mt_fail(err, MT_E_USAGE, "--sine: %s: the frequency is not above 0", r->value);
    }
    *sine = (mt_sine){.amplitude = number[0], .hz = number[1]};
    *out = (mt_signal){.kind = MT_SIGNAL_SINES, .n = 1, .sines = sine};
    return MT_OK;
}

static mt_status read_sweep(mt_loaded_model *s, const mt_repeat *r, const mt_unit *unit,
                            const char *text, double duration_s, mt_signal *out, mt_err *err)
{
    static const char suffix[] = ":linear";
    double number[3] = {0.0, 0.0, 0.0};
    const size_t length = strlen(text);
    const size_t tail = sizeof suffix - 1;
    const bool linear = length > tail && strcmp(text + length - tail, suffix) == 0;
    const char *const numbers =
        mt_arena_strndup(&s->mem, text, linear ? length - tail : length);
    MT_TRY(mt_arena_check(&s->mem, err));
    MT_TRY(read_numbers(s, r, unit, numbers, "@:", number, err));
    if (!(number[1] > 0.0) || !(number[2] > 0.0)) {
        return mt_fail(err, MT_E_USAGE, "--sweep: %s: a frequency is not above 0", r->value);
    }
    *out = (mt_signal){.kind = MT_SIGNAL_SWEEP,
                       .level = number[0],
                       .from_hz = number[1],
                       .to_hz = number[2],
                       .duration_s = duration_s,
                       .linear = linear};
    return MT_OK;
}

/* "HZ:PSD,HZ:PSD,...": of so many lines that it does not repeat. */
static mt_status read_random(mt_loaded_model *s, const mt_args *args, const mt_repeat *r,
                             const char *text, mt_signal *out, mt_err *err)
{
    size_t n = 1;
    for (const char *at = strchr(text, ','); at != NULL; at = strchr(at + 1, ',')) {
        n++;
    }
    double *const hz = mt_arena_f64(&s->mem, n, 1);
    double *const value = mt_arena_f64(&s->mem, n, 1);
    MT_TRY(mt_arena_check(&s->mem, err));
    for (size_t i = 0; i < n; i++) {
        const size_t length = strcspn(text, ",");
        const char *const pair = mt_arena_strndup(&s->mem, text, length);
        double number[2] = {0.0, 0.0};
        MT_TRY(mt_arena_check(&s->mem, err));
        MT_TRY(read_numbers(s, r, NULL, pair, ":", number, err));
        hz[i] = number[0];
        value[i] = number[1];
        text += length + (text[length] == ',' ? 1 : 0);
    }
    const mt_psd psd = {.n = (int)n, .hz = hz, .level = value};
    const unsigned long seed = args->given[MT_OPT_SEED] ? args->seed : MT_SIM_SEED;
    return mt_err_in(err, mt_realise_psd(&psd, args->duration_s, seed, &s->mem, out, err),
                     "--random: %s", r->value);
}

static mt_status read_input(mt_loaded_model *s, const mt_args *args, const mt_system *sys,
                            const mt_repeat *r, mt_sim_request *out, mt_sim_input *inputs,
                            mt_err *err)
{
    const char *name = "";
    const char *rest = "";
    port p = {.push = MT_SIM_FORCE};
    mt_signal *const signal = mt_arena_alloc(&s->mem, 1, sizeof *signal);
    MT_TRY(mt_arena_check(&s->mem, err));
    MT_TRY(split_name_and_rest(r, &s->mem, &name, &rest, err));
    MT_TRY(find_port(sys, r->option, name, &s->mem, &p, err));
    if (r->option == MT_OPT_SINE) {
        MT_TRY(read_sine(s, r, shown_amplitude_unit(s, sys, &p), rest, signal, err));
        const double hz = signal->sines[0].hz;
        const bool first = out->opt.n_inputs == 0;
        out->steady_hz = first || out->steady_hz == hz ? hz : 0.0;
    } else if (r->option == MT_OPT_CHIRP) {
        MT_TRY(read_sweep(s, r, shown_amplitude_unit(s, sys, &p), rest, out->opt.duration_s,
                          signal, err));
    } else if (r->option == MT_OPT_RANDOM) {
        MT_TRY(read_random(s, args, r, rest, signal, err));
    } else {
        const mt_status rc = read_expression(s, rest, signal, err);
        MT_TRY(mt_err_in(err, rc == MT_E_INPUT ? MT_E_USAGE : rc, "--input: %s", rest));
    }
    out->steady_hz = r->option == MT_OPT_SINE ? out->steady_hz : 0.0;
    inputs[out->opt.n_inputs++] =
        (mt_sim_input){.push = p.push, .at = p.at, .slope = p.slope, .signal = signal};
    return MT_OK;
}

/* The gauge of a port without its quantity, each once. */
static mt_status find_gauge(const mt_system *sys, const char *name, mt_sim_request *out,
                            mt_gauge *gauges, mt_arena *mem, int *at, mt_err *err)
{
    mt_gauge g = {.channel = mt_system_find_channel(sys, name), .joint = -1};
    if (g.channel < 0) {
        g.joint = mt_system_find_joint(sys, name);
        if (g.joint < 0) {
            return no_such_port(sys, MT_OPT_SEEN, name, false, true, mem, err);
        }
        MT_TRY(find_coordinate_joint(sys, MT_OPT_SEEN, name, mem, &g.joint, err));
    }
    for (*at = 0; *at < out->opt.n_gauges; ++*at) {
        if (gauges[*at].channel == g.channel && gauges[*at].joint == g.joint) {
            return MT_OK;
        }
    }
    gauges[out->opt.n_gauges++] = g;
    return MT_OK;
}

static bool is_angle(const mt_system *sys, mt_gauge g)
{
    if (g.channel < 0) {
        return sys->joints[g.joint].angle;
    }
    return mt_channel_turns(sys->channels[g.channel].kind);
}

static mt_status read_output(const mt_system *sys, const char *text, mt_sim_request *out,
                             mt_gauge *gauges, mt_arena *mem, mt_err *err)
{
    mt_sim_output *const o = &out->outputs[out->n_outputs];
    const char *name = "";
    mt_port seen = {.motion = 0};
    *o = (mt_sim_output){.port = text};
    MT_TRY(mt_err_in(err, mt_port_split(text, false, mem, &name, &seen, err), "--output"));
    o->what = (mt_seen)seen.motion;
    MT_TRY(find_gauge(sys, name, out, gauges, mem, &o->gauge, err));
    o->angle = is_angle(sys, gauges[o->gauge]);
    out->n_outputs++;
    return MT_OK;
}

static mt_status read_outputs(const mt_args *args, const mt_system *sys, mt_arena *mem,
                              mt_sim_request *out, mt_err *err)
{
    const size_t room =
        (size_t)args->n_repeats + (size_t)sys->n_channels + (size_t)sys->n_joints;
    mt_gauge *const gauges = mt_arena_alloc(mem, room, sizeof *gauges);
    out->outputs = mt_arena_alloc(mem, room, sizeof *out->outputs);
    MT_TRY(mt_arena_check(mem, err));
    out->opt.gauges = gauges;
    for (int i = 0; i < args->all[MT_OPT_SEEN].n; i++) {
        MT_TRY(read_output(sys, args->all[MT_OPT_SEEN].value[i], out, gauges, mem, err));
    }
    for (int i = 0; !args->given[MT_OPT_SEEN] && i < sys->n_channels; i++) {
        MT_TRY(read_output(sys, sys->channels[i].name, out, gauges, mem, err));
    }
    const bool joints = out->n_outputs == 0;
    for (int i = 0; joints && i < sys->n_joints; i++) {
        if (sys->joints[i].coordinate >= 0) {
            MT_TRY(read_output(sys, sys->joints[i].name, out, gauges, mem, err));
        }
    }
    return MT_OK;
}

static mt_status read_joint(mt_loaded_model *s, const mt_system *sys, const mt_repeat *r,
                            mt_sim_joint *out, mt_err *err)
{
    const char *name = "";
    const char *rest = "";
    MT_TRY(split_name_and_rest(r, &s->mem, &name, &rest, err));
    MT_TRY(find_coordinate_joint(sys, r->option, name, &s->mem, &out->joint, err));
    return mt_loaded_model_number(s, option_name(r->option),
                                  mt_loaded_model_joint_unit(s->model, name), rest,
                                  strlen(rest), &out->value, err);
}

/* The unit of a displacement along a mode: an angle where sensors show nothing else. */
static const mt_unit *shape_unit(const mt_loaded_model *s, const mt_system *sys)
{
    bool turns = sys->n_channels > 0;
    for (int i = 0; i < sys->n_channels; i++) {
        turns = turns && mt_channel_turns(sys->channels[i].kind);
    }
    return s->model->units[turns ? MT_ANGLE : MT_LENGTH];
}

static mt_status read_mode(mt_loaded_model *s, const mt_system *sys, const char *text,
                           mt_sim_request *out, mt_err *err)
{
    char *end = NULL;
    const long n = strtol(text, &end, 10);
    if (text[0] < '1' || text[0] > '9' || *end != ':' || n > 1000000) {
        return mt_fail(err, MT_E_USAGE, "--mode: \"%s\" is not N:AMPLITUDE", text);
    }
    out->mode = (int)n;
    return mt_loaded_model_number(s, "mode", shape_unit(s, sys), end + 1, strlen(end + 1),
                                  &out->amplitude, err);
}

mt_status mt_sim_read(const mt_args *args, mt_loaded_model *s, const mt_system *sys,
                      const mt_vibration *profile, mt_sim_request *out, mt_err *err)
{
    const int shakes = profile == NULL ? 0 : profile->n_random + profile->n_tones;
    const size_t room = (size_t)args->n_repeats + (size_t)shakes + 1;
    mt_sim_input *const inputs = mt_arena_alloc(&s->mem, room, sizeof *inputs);
    *out = (mt_sim_request){.opt = mt_sim_options_default()};
    out->starts = mt_arena_alloc(&s->mem, room, sizeof *out->starts);
    out->rates = mt_arena_alloc(&s->mem, room, sizeof *out->rates);
    MT_TRY(mt_arena_check(&s->mem, err));
    if (!args->given[MT_OPT_DURATION]) {
        return mt_fail(err, MT_E_USAGE, "\"simulate\" needs --duration SECONDS");
    }
    out->opt.duration_s = args->duration_s;
    out->opt.sample_s = args->dt_out_s > 0.0 ? args->dt_out_s : 0.01 * args->duration_s;
    out->opt.tolerance = args->tolerance > 0.0 ? args->tolerance : out->opt.tolerance;
    out->opt.integrates = args->given[MT_OPT_INTEGRATE];
    out->opt.inputs = inputs;
    for (int i = 0; i < args->n_repeats; i++) {
        const mt_repeat *const r = &args->repeats[i];
        if (is_input(r->option)) {
            MT_TRY(read_input(s, args, sys, r, out, inputs, err));
        } else if (r->option == MT_OPT_START) {
            MT_TRY(read_joint(s, sys, r, &out->starts[out->n_starts++], err));
        } else if (r->option == MT_OPT_RATE) {
            MT_TRY(read_joint(s, sys, r, &out->rates[out->n_rates++], err));
        }
    }
    if (profile != NULL) {
        MT_TRY(mt_sim_vibrate(args, s, sys, profile, out, inputs, err));
    }
    if (args->value[MT_OPT_ALONG] != NULL) {
        MT_TRY(read_mode(s, sys, args->value[MT_OPT_ALONG], out, err));
    }
    if (args->dt_out_s == 0.0 && out->steady_hz > 0.0) {
        out->opt.sample_s = fmin(out->opt.sample_s, 1.0 / (STEADY_SAMPLES * out->steady_hz));
    }
    out->opt.turning = out->opt.n_inputs == 0;
    return read_outputs(args, sys, &s->mem, out, err);
}
