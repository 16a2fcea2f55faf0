/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune simulate: motion of one configuration in time. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "base/run.h"
#include "cli/cli.h"
#include "cli/shipped.h"
#include "environment/vibration.h"
#include "inspect/response.h"
#include "mechanics/position.h"
#include "model/values.h"
#include "report/table.h"
#include "response/ports.h"
#include "result/write.h"
#include "simulate/reading.h"
#include "simulate/signal.h"
#include "simulate/start.h"
#include "vibration/profile_response.h"

/* The quantity of a gauge in an output. */
typedef enum seen_quantity { SEEN_VALUE, SEEN_SPEED, SEEN_ACCELERATION } seen_quantity;

/* One --measure. */
typedef struct sim_output {
    const char *port; /* "grip.x:velocity" */
    int gauge;        /* index among the options' gauges */
    seen_quantity what;
    bool angle;
} sim_output;

/* A realisation of --vibration. */
typedef struct sim_forced_response {
    const mt_vibration *v; /* NULL: none */
    int axis;              /* axis of the ground */
    unsigned long seed;
    double rms; /* RMS of the random parts over the duration [m/s^2] */
} sim_forced_response;

enum { SIM_SEED = 1, AXES = 3 };
static const char *const base_ports[AXES] = {"base.x", "base.y", "base.z"};

/* The options of the command, resolved for a system. */
typedef struct sim_request {
    mt_sim_options opt;
    int n_outputs;
    sim_output *outputs;
    int n_starts;
    mt_sim_joint *starts;
    int n_rates;
    mt_sim_joint *rates;
    int mode; /* 0: not given */
    double amplitude;
    sim_forced_response forced_response;
    double steady_hz; /* the single frequency of --sine; 0: none, or several */
} sim_request;

/* The vibrations identified in the motion of one gauge. */
typedef struct sim_reading {
    const char *name; /* port without quantity */
    bool angle;
    mt_ring ring;
    mt_tones tones;
    mt_steady steady;
} sim_reading;

/* A motion with all that its output needs. */
typedef struct sim_view {
    const char *configuration;
    const mt_system *sys;
    const sim_request *request;
    const mt_sim_result *r;
    sim_reading *readings; /* [gauges] */
    bool free;             /* no excitation: rings and tones are meaningful */
} sim_view;

/* A profile of vibration as a motion of the ground: one realisation of it. */

/* Split --vibration [PORT=]FILE, "base.y=FILE": returns the file; *port: where the port begins,
 * NULL without one. */
static const char *sim_profile_of(const char *text, const char **port)
{
    const char *const equals = strchr(text, '=');
    const bool has = strncmp(text, "base.", strlen("base.")) == 0 && equals != NULL;
    *port = has ? text : NULL;
    return has ? equals + 1 : text;
}

static mt_status find_axis(const mt_args *args, const mt_vibration *v, const mt_system *sys,
                           mt_arena *mem, int *axis, mt_err *err)
{
    const char *port = NULL;
    const char *const file = sim_profile_of(args->value[MT_OPT_VIBRATION], &port);
    mt_response_request request = {.n_in = 0};
    mt_port ground;
    if (port != NULL) {
        port = mt_arena_strndup(mem, port, (size_t)(file - 1 - port));
        request = (mt_response_request){.n_in = 1, .inputs = &port};
    }
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_err_in(err, mt_profiled_ports(v, sys, mem, &request, err), "--vibration PORT=%s",
                     file));
    MT_TRY(mt_err_in(err, mt_port_input(sys, request.inputs[0], mem, &ground, err),
                     "--vibration"));
    MT_TRY(mt_err_in(err, mt_profiled_input(&ground, err), "--vibration"));
    *axis = ground.index;
    return MT_OK;
}

/* Append the profile's parts to the inputs. */
static mt_status sim_vibrate(const mt_args *args, mt_loaded_model *s, const mt_system *sys,
                             const mt_vibration *v, sim_request *out, mt_sim_input *inputs,
                             mt_err *err)
{
    sim_forced_response *const to = &out->forced_response;
    mt_realised shake;
    int axis = 0;
    MT_TRY(find_axis(args, v, sys, &s->mem, &axis, err));
    *to = (sim_forced_response){
        .v = v, .axis = axis, .seed = args->given[MT_OPT_SEED] ? args->seed : SIM_SEED};
    const mt_status rc = mt_realise(v, args->duration_s, to->seed, &s->mem, &shake, err);
    MT_TRY(
        mt_err_in(err, rc, "--vibration: %s in %g s", mt_vibrated_name(v), args->duration_s));
    mt_realise_inputs(&shake, axis, inputs + out->opt.n_inputs);
    out->opt.n_inputs += shake.n;
    out->steady_hz = 0.0;
    to->rms = shake.rms;
    return MT_OK;
}

static void sim_forced_response_print(const sim_forced_response *s, mt_text *out)
{
    const mt_vibration *const v = s->v;
    mt_text_addf(out, "  %s is shaken by %s", base_ports[s->axis], mt_vibrated_name(v));
    if (v->n_random > 0) {
        mt_text_addf(
            out,
            ": random parts of %.5g g RMS in this realisation (seed %lu), %.5g g in the "
            "profile",
            s->rms / MT_STANDARD_GRAVITY, s->seed, mt_vibration_rms(v) / MT_STANDARD_GRAVITY);
    }
    mt_text_add(out, v->n_tones > 0 ? "; tones go through their ranges once.\n" : ".\n");
    mt_vibrated_marks(v, out);
}

/* The same for JSON. */
typedef struct shaken_row {
    const char *file;
    const char *name;
    const char *port;
    long seed;
    double rms_m_per_s2;
    double realised_rms_m_per_s2;
    mt_rule_row rule;
} shaken_row;

#define THIS shaken_row
static const mt_field shaken_fields[] = {
    MT_F_TEXT("file", file, "The profile's file."),
    MT_F_TEXT_OR_NULL("name", name, "Its name."),
    MT_F_CHOICE("port", port, base_ports, "The direction in which the ground moves."),
    MT_F_LONG("seed", seed, "Seed of the realisation, from --seed."),
    MT_F_NUMBER("rms_m_per_s2", rms_m_per_s2, "RMS of its random parts in the profile."),
    MT_F_NUMBER("realised_rms_m_per_s2", realised_rms_m_per_s2, "RMS in this realisation."),
    MT_RULE_FIELDS(rule),
};
static const mt_record shaken_record =
    MT_F_RECORD_OF(shaken_fields, NULL, "A profile that shakes the ground.");
#undef THIS

static shaken_row shaken_row_of(const sim_forced_response *s)
{
    return (shaken_row){.file = s->v->path,
                        .name = s->v->name,
                        .port = base_ports[s->axis],
                        .seed = (long)s->seed,
                        .rms_m_per_s2 = mt_vibration_rms(s->v),
                        .realised_rms_m_per_s2 = s->rms,
                        .rule = mt_rule_row_of(s->v)};
}

/* The options of `simulate` in the words of a system. */

/* Lines of the result in a period of a sine, so that its harmonics are told apart. */
enum { STEADY_SAMPLES = 24 };
/* A port of an input: what stands before '='. */
typedef struct input_port {
    mt_sim_push push;
    int at;    /* channel or axis */
    int slope; /* BASE: which derivative of the signal is the acceleration */
    int joint; /* MOVE */
} input_port;

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
    return option == MT_OPT_PUSH || option == MT_OPT_SINE || option == MT_OPT_SINE_SWEEP ||
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

/* The joints that --input, --sine or --sine-sweep moves. Fails: MT_E_USAGE (too many),
 * MT_E_MEMORY. */
static mt_status sim_moved_joints(const mt_args *args, const mt_model *model, mt_arena *mem,
                                  mt_system_drive drives[MT_DRIVES_MOST], int *n, mt_err *err)
{
    *n = 0;
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
        bool known = false;
        for (int k = 0; k < *n; k++) {
            known = known || strcmp(drives[k].joint, joint) == 0;
        }
        if (!known && *n == MT_DRIVES_MOST) {
            return mt_fail(err, MT_E_USAGE, "--%s: at most %d joints can be moved",
                           option_name(args->repeats[i].option), (int)MT_DRIVES_MOST);
        }
        if (!known) {
            drives[(*n)++] = (mt_system_drive){.joint = joint, .fixed = true};
        }
    }
    return MT_OK;
}

/* The value of --start for the joint of this name; *given: true where there is one. */
static mt_status sim_start_of(const mt_args *args, mt_loaded_model *s, const char *joint,
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
                           mt_arena *mem, input_port *out, mt_err *err)
{
    *out = (input_port){.push = MT_SIM_FORCE, .at = mt_system_find_channel(sys, name)};
    if (out->at >= 0) {
        return MT_OK;
    }
    if (strncmp(name, "base.", strlen("base.")) == 0) {
        mt_port ground;
        MT_TRY(mt_err_in(err, mt_port_input(sys, name, mem, &ground, err), "--%s",
                         option_name(option)));
        *out =
            (input_port){.push = MT_SIM_BASE, .at = ground.index, .slope = 2 - ground.motion};
        return MT_OK;
    }
    const int joint = mt_system_find_joint(sys, name);
    const int drive = joint >= 0 ? mt_system_drive_of(sys, joint) : -1;
    if (drive >= 0 && sys->drives[drive].spring < 0) {
        *out = (input_port){.push = MT_SIM_MOVE, .at = drive, .joint = joint};
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
    const mt_expr_scope scope = {.lookup = lookup,
                                 .context = model,
                                 .curves = model->curves,
                                 .n_curves = model->n_curves};
    MT_TRY(mt_expr_parse(text, &scope, &s->mem, &e, err));
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
                                           const input_port *p)
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
        return mt_fail(err, MT_E_USAGE, "--sine-sweep: %s: a frequency is not above 0",
                       r->value);
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
    const unsigned long seed = args->given[MT_OPT_SEED] ? args->seed : SIM_SEED;
    return mt_err_in(err, mt_realise_psd(&psd, args->duration_s, seed, &s->mem, out, err),
                     "--random: %s", r->value);
}

static mt_status read_input(mt_loaded_model *s, const mt_args *args, const mt_system *sys,
                            const mt_repeat *r, sim_request *out, mt_sim_input *inputs,
                            mt_err *err)
{
    const char *name = "";
    const char *rest = "";
    input_port p = {.push = MT_SIM_FORCE};
    mt_signal *const signal = mt_arena_alloc(&s->mem, 1, sizeof *signal);
    MT_TRY(mt_arena_check(&s->mem, err));
    MT_TRY(split_name_and_rest(r, &s->mem, &name, &rest, err));
    MT_TRY(find_port(sys, r->option, name, &s->mem, &p, err));
    if (r->option == MT_OPT_SINE) {
        MT_TRY(read_sine(s, r, shown_amplitude_unit(s, sys, &p), rest, signal, err));
        const double hz = signal->sines[0].hz;
        const bool first = out->opt.n_inputs == 0;
        out->steady_hz = first || out->steady_hz == hz ? hz : 0.0;
    } else if (r->option == MT_OPT_SINE_SWEEP) {
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
static mt_status find_gauge(const mt_system *sys, const char *name, sim_request *out,
                            mt_gauge *gauges, mt_arena *mem, int *at, mt_err *err)
{
    mt_gauge g = {.channel = mt_system_find_channel(sys, name), .joint = -1};
    if (g.channel < 0) {
        g.joint = mt_system_find_joint(sys, name);
        if (g.joint < 0) {
            return no_such_port(sys, MT_OPT_MEASURE, name, false, true, mem, err);
        }
        MT_TRY(find_coordinate_joint(sys, MT_OPT_MEASURE, name, mem, &g.joint, err));
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

static mt_status read_output(const mt_system *sys, const char *text, sim_request *out,
                             mt_gauge *gauges, mt_arena *mem, mt_err *err)
{
    sim_output *const o = &out->outputs[out->n_outputs];
    const char *name = "";
    mt_port seen = {.motion = 0};
    *o = (sim_output){.port = text};
    MT_TRY(mt_err_in(err, mt_port_split(text, false, mem, &name, &seen, err), "--measure"));
    o->what = (seen_quantity)seen.motion;
    MT_TRY(find_gauge(sys, name, out, gauges, mem, &o->gauge, err));
    o->angle = is_angle(sys, gauges[o->gauge]);
    out->n_outputs++;
    return MT_OK;
}

static mt_status read_outputs(const mt_args *args, const mt_system *sys, mt_arena *mem,
                              sim_request *out, mt_err *err)
{
    const size_t room =
        (size_t)args->n_repeats + (size_t)sys->n_channels + (size_t)sys->n_joints;
    mt_gauge *const gauges = mt_arena_alloc(mem, room, sizeof *gauges);
    out->outputs = mt_arena_alloc(mem, room, sizeof *out->outputs);
    MT_TRY(mt_arena_check(mem, err));
    out->opt.gauges = gauges;
    for (int i = 0; i < args->all[MT_OPT_MEASURE].n; i++) {
        MT_TRY(read_output(sys, args->all[MT_OPT_MEASURE].value[i], out, gauges, mem, err));
    }
    for (int i = 0; !args->given[MT_OPT_MEASURE] && i < sys->n_channels; i++) {
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
                           sim_request *out, mt_err *err)
{
    char *end = NULL;
    const long n = strtol(text, &end, 10);
    if (text[0] < '1' || text[0] > '9' || *end != ':' || n > 1000000) {
        return mt_fail(err, MT_E_USAGE, "--start-mode: \"%s\" is not N:AMPLITUDE", text);
    }
    out->mode = (int)n;
    return mt_loaded_model_number(s, "mode", shape_unit(s, sys), end + 1, strlen(end + 1),
                                  &out->amplitude, err);
}

/* Resolve all other options for a system; profile: of --vibration, or NULL. Fails: MT_E_USAGE,
 * MT_E_MEMORY. */
static mt_status sim_read(const mt_args *args, mt_loaded_model *s, const mt_system *sys,
                          const mt_vibration *profile, sim_request *out, mt_err *err)
{
    const int shakes = profile == NULL ? 0 : profile->n_random + profile->n_tones;
    const size_t room = (size_t)args->n_repeats + (size_t)shakes + 1;
    mt_sim_input *const inputs = mt_arena_alloc(&s->mem, room, sizeof *inputs);
    *out = (sim_request){.opt = mt_sim_options_default()};
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
        MT_TRY(sim_vibrate(args, s, sys, profile, out, inputs, err));
    }
    if (args->value[MT_OPT_START_MODE] != NULL) {
        MT_TRY(read_mode(s, sys, args->value[MT_OPT_START_MODE], out, err));
    }
    if (args->dt_out_s == 0.0 && out->steady_hz > 0.0) {
        out->opt.sample_s = fmin(out->opt.sample_s, 1.0 / (STEADY_SAMPLES * out->steady_hz));
    }
    out->opt.turning = out->opt.n_inputs == 0;
    return read_outputs(args, sys, &s->mem, out, err);
}

/* A motion as text, JSON and CSV. */

enum { DIGITS = 6, HEADING = 300 };
/* Lines of a table on paper; of more, evenly spaced ones are printed. */
enum { LINES_MOST = 41 };
/* The mean periods of a gauge are told where they differ by less than this part. */
static const double REGULAR = 0.05;
/* A steady amplitude is told where the sum of harmonics leaves less than this of it. */
static const double STEADY = 0.05;
/* Harmonics below this part of the first are left out on paper. */
static const double WEAK = 1e-4;
enum { TONES_SHOWN = 4 };

/* Values of an output, n_gauges apart. */
static double *values_of(const sim_view *v, int output)
{
    const sim_output *const o = &v->request->outputs[output];
    const int what = (int)o->what;
    return (what == 0 ? v->r->value : what == 1 ? v->r->speed : v->r->acceleration) + o->gauge;
}

static const char *motion_output_unit(const sim_output *o)
{
    static const char *const units[2][3] = {{"m", "m/s", "m/s^2"}, {"rad", "rad/s", "rad/s^2"}};
    return units[o->angle ? 1 : 0][o->what];
}

/* "grip.x_m_per_s2" */
static void member_of(const sim_view *v, const sim_output *o, char text[HEADING])
{
    static const char *const units[2][3] = {{"m", "m_per_s", "m_per_s2"},
                                            {"rad", "rad_per_s", "rad_per_s2"}};
    (void)mt_snprintf(text, HEADING, "%s_%s", v->readings[o->gauge].name,
                      units[o->angle ? 1 : 0][o->what]);
}

/* What is told, as records. */

/* What one --output shows. */
typedef struct output_row {
    const char *port;
    const char *unit;
    int n;
    int step; /* between values */
    double *values;
} output_row;

#define THIS output_row
static const char *const output_units[] = {"m", "m/s", "m/s^2", "rad", "rad/s", "rad/s^2"};
static const mt_field output_fields[] = {
    MT_F_TEXT("port", port, "As --output gives it."),
    MT_F_CHOICE("unit", unit, output_units, "Unit of its values."),
    MT_F_NUMBERS("values", values, n, "Its value at each time, in the unit that `unit` names.",
                 MT_F_EVERY(step)),
};
static const mt_record output_record =
    MT_F_RECORD_OF(output_fields, "output", "A quantity over time.");
#undef THIS

/* The turns of a free motion. */
#define THIS mt_ring
static const mt_field ring_fields[] = {
    MT_F_COUNT("periods", periods, 0,
               "Periods between the first and the last maximum; 0: none."),
    MT_F_NUMBER_OR_NULL("frequency_hz", hz, "Frequency of the mean period; null: none."),
    MT_F_NUMBER_OR_NULL("spread", spread,
                        "Longest less shortest period, as a part of the mean: 0 of one "
                        "frequency; null: no period."),
    MT_F_NUMBER_OR_NULL("amplitude", amplitude,
                        "Half of the first swing, in the unit of the port; null: none."),
    MT_F_NUMBER_OR_NULL("damping_ratio", damping,
                        "Damping ratio by the decrease of the swings; null: fewer than two."),
};
static const mt_record ring_record =
    MT_F_RECORD_OF(ring_fields, NULL, "What the turns of a free motion show.");
#undef THIS

#define THIS mt_tone
static const mt_field tone_fields[] = {
    MT_F_NUMBER("frequency_hz", hz, "Frequency of its oscillation."),
    MT_F_NUMBER("damping_ratio", damping, "Its damping ratio."),
    MT_F_NUMBER("amplitude", amplitude, "Its amplitude at the beginning, in the port's unit."),
    MT_F_NUMBER("phase_rad", phase, "Its phase at the beginning."),
};
static const mt_record tone_record =
    MT_F_RECORD_OF(tone_fields, "tone", "A decaying oscillation in a free motion.");
#undef THIS

/* The motion under one sine. */
typedef struct steady_row {
    int periods;
    double hz;
    double mean;
    int n;
    double *amplitudes;
    double *phases;
    double residual;
} steady_row;

#define THIS steady_row
static const mt_field steady_fields[] = {
    MT_F_COUNT("periods", periods, 0,
               "Whole periods at the end of the motion that it is read from; 0: too short, all "
               "else is 0."),
    MT_F_NUMBER("frequency_hz", hz, "Frequency of the sine."),
    MT_F_NUMBER("mean", mean, "Mean, in the unit of the port."),
    MT_F_NUMBERS("amplitudes", amplitudes, n,
                 "Amplitudes of the sine's frequency and its multiples, in the port's unit."),
    MT_F_NUMBERS("phases_rad", phases, n, "Their phases."),
    MT_F_NUMBER("residual", residual,
                "Largest difference of the motion and their sum, as a part of the largest "
                "amplitude."),
};
static const mt_record steady_record =
    MT_F_RECORD_OF(steady_fields, NULL, "The steady motion under one sine.");
#undef THIS

/* What the motion of a port shows. */
typedef struct reading_row {
    const char *port;
    const char *unit;
    bool with_ring; /* of a free motion */
    mt_ring ring;
    int n_tones;
    mt_tone *tones;
    double tones_residual;
    bool with_steady; /* under one sine */
    steady_row steady;
} reading_row;

#define THIS reading_row
static const char *const reading_units[] = {"m", "rad"};
static const mt_field reading_fields[] = {
    MT_F_TEXT("port", port, "The port, without what of it an output shows."),
    MT_F_CHOICE("unit", unit, reading_units, "Its unit."),
    MT_F_RECORD("turnings", ring, mt_ring, ring_record,
                "Of a free motion: what its turns show.", MT_F_WHEN(with_ring)),
    MT_F_LIST("tones", tones, n_tones, mt_tone, tone_record,
              "Of a free motion: the oscillations that it is the sum of, strongest first.",
              .flat = true, MT_F_WHEN(with_ring)),
    MT_F_NUMBER_OR_NULL(
        "tones_residual", tones_residual,
        "Largest difference of the motion and that sum, as a part of its largest "
        "distance from the mean; null: too short.",
        MT_F_WHEN(with_ring)),
    MT_F_RECORD("steady", steady, steady_row, steady_record,
                "Under one --sine: its steady motion.", MT_F_WHEN(with_steady)),
};
static const mt_record reading_record =
    MT_F_RECORD_OF(reading_fields, "reading", "What the motion of a port shows.");
#undef THIS

/* A motion. */
typedef struct motion_row {
    const char *configuration;
    bool complete;
    mt_sim_method method;
    double tolerance;
    bool is_shaken;
    shaken_row vibration;
    int n;
    double *time_s;
    int n_outputs;
    output_row *outputs;
    double *kinetic_j;
    double *potential_j;
    double *work_j;
    double energy_scale_j;
    double energy_error_j;
    double joint_drift_m;
    double joint_gap_m;
    long steps;
    long stiff_steps;
    long rejected_steps;
    long evaluations;
    bool is_linear;
    double equations_residual;
    double input_error;
    int n_readings;
    reading_row *readings;
} motion_row;

#define THIS motion_row
static const mt_field motion_fields[] = {
    MT_F_TEXT("configuration", configuration, "Its name."),
    MT_F_FLAG("complete", complete, "It was not stopped before --duration."),
    MT_F_ENUM(
        "method", method, mt_sim_method, mt_sim_method_names,
        "\"integrated\": in steps with an estimated error; of linear equations \"exact\": by "
        "the matrix exponential, or \"fitted\": so, with inputs as polynomials."),
    MT_F_NUMBER("tolerance", tolerance, "Allowed error of a step, relative."),
    MT_F_RECORD("vibration", vibration, shaken_row, shaken_record,
                "With --vibration: the profile that shakes the ground.", MT_F_WHEN(is_shaken)),
    MT_F_NUMBERS("time_s", time_s, n, "Times of all values."),
    MT_F_LIST("outputs", outputs, n_outputs, output_row, output_record,
              "What each --output shows."),
    MT_F_NUMBERS("kinetic_j", kinetic_j, n, "Kinetic energy."),
    MT_F_NUMBERS("potential_j", potential_j, n, "Potential energy, from the rest position."),
    MT_F_NUMBERS("work_j", work_j, n, "Work of inputs, less that absorbed by dampers."),
    MT_F_NUMBER("energy_scale_j", energy_scale_j,
                "Largest kinetic energy or change of potential energy."),
    MT_F_NUMBER("energy_error_j", energy_error_j, "Largest error of the balance of energy."),
    MT_F_NUMBER("joint_drift_m", joint_drift_m,
                "Largest drift off a joint in a step, before it was corrected."),
    MT_F_NUMBER("joint_gap_m", joint_gap_m, "Largest gap of a joint after that."),
    MT_F_LONG("steps", steps, "Steps."),
    MT_F_LONG("stiff_steps", stiff_steps,
              "Of these, with fast vibrations of stiff springs solved beforehand."),
    MT_F_LONG("rejected_steps", rejected_steps, "Steps that were repeated with a smaller one."),
    MT_F_LONG("evaluations", evaluations, "Evaluations of the equations of motion."),
    MT_F_NUMBER(
        "equations_residual", equations_residual,
        "Of linear equations: what the motion leaves of the whole equations, relative to "
        "their largest force.",
        MT_F_WHEN(is_linear)),
    MT_F_NUMBER(
        "input_error", input_error,
        "Of linear equations: what fitted inputs miss, relative to their largest value.",
        MT_F_WHEN(is_linear)),
    MT_F_LIST("readings", readings, n_readings, reading_row, reading_record,
              "What the motion of each port shows."),
};
static const mt_record motion_record = MT_F_RECORD_OF(motion_fields, NULL, NULL);
enum { IN_CSV_BEHIND = MT_IN_OWN }; /* behind the outputs */
static const mt_record_column motion_columns[] = {
    MT_R_COLUMN(time_s, "time [s]", DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(kinetic_j, "kinetic energy [J]", DIGITS, IN_CSV_BEHIND),
    MT_R_COLUMN(potential_j, "potential energy [J]", DIGITS, IN_CSV_BEHIND),
    MT_R_COLUMN(work_j, "work [J]", DIGITS, IN_CSV_BEHIND),
};
static const mt_record_table motion_rows = MT_R_TABLE_OF(motion_record, motion_columns);
#undef THIS

static output_row output_row_of(const sim_view *v, int k)
{
    const sim_output *const o = &v->request->outputs[k];
    return (output_row){.port = o->port,
                        .unit = motion_output_unit(o),
                        .n = v->r->n,
                        .step = v->r->n_gauges,
                        .values = values_of(v, k)};
}

static reading_row reading_row_of(const sim_view *v, int i)
{
    sim_reading *const g = &v->readings[i];
    return (reading_row){.port = g->name,
                         .unit = reading_units[g->angle ? 1 : 0],
                         .with_ring = v->free,
                         .ring = g->ring,
                         .n_tones = g->tones.n,
                         .tones = g->tones.tone,
                         .tones_residual = g->tones.residual,
                         .with_steady = v->request->steady_hz > 0.0,
                         .steady = {.periods = g->steady.periods,
                                    .hz = v->request->steady_hz,
                                    .mean = g->steady.mean,
                                    .n = MT_HARMONICS,
                                    .amplitudes = g->steady.amplitude,
                                    .phases = g->steady.phase,
                                    .residual = g->steady.residual}};
}

/* Without its lists of records. */
static motion_row motion_row_of(const sim_view *v)
{
    const mt_sim_result *const r = v->r;
    return (motion_row){.configuration = v->configuration,
                        .complete = r->stop == MT_SIM_DONE,
                        .method = r->method,
                        .tolerance = v->request->opt.tolerance,
                        .is_shaken = v->request->forced_response.v != NULL,
                        .n = r->n,
                        .time_s = r->t,
                        .kinetic_j = r->kinetic,
                        .potential_j = r->potential,
                        .work_j = r->work,
                        .energy_scale_j = r->energy_scale_j,
                        .energy_error_j = r->energy_error_j,
                        .joint_drift_m = r->gap_m,
                        .joint_gap_m = r->left_m,
                        .steps = r->steps,
                        .stiff_steps = r->stiff_steps,
                        .rejected_steps = r->rejected,
                        .evaluations = r->evaluations,
                        .is_linear = r->method != MT_SIM_INTEGRATED,
                        .equations_residual = r->fit.residual,
                        .input_error = r->fit.input_error};
}

static void make_motion_columns(const sim_view *v, bool csv, mt_table *t)
{
    char heading[HEADING];
    char member[HEADING];
    mt_table_record_columns(t, &motion_rows, MT_IN_TABLES);
    for (int k = 0; k < v->request->n_outputs; k++) {
        const sim_output *const o = &v->request->outputs[k];
        (void)mt_snprintf(heading, sizeof heading, "%s [%s]", o->port, motion_output_unit(o));
        member_of(v, o, member);
        mt_table_column(t, heading, member, MT_ALIGN_POINT);
    }
    mt_table_record_columns(t, &motion_rows, csv ? IN_CSV_BEHIND : 0U);
}

/* Sample i. */
static void add_sample(const sim_view *v, const motion_row *row, int i, bool csv, mt_table *t)
{
    mt_table_record_nth(t, &motion_rows, MT_IN_TABLES, row, i);
    for (int k = 0; k < v->request->n_outputs; k++) {
        mt_table_number(t, values_of(v, k)[(ptrdiff_t)i * v->r->n_gauges], DIGITS);
    }
    mt_table_record_nth(t, &motion_rows, csv ? IN_CSV_BEHIND : 0U, row, i);
}

static void simulate_csv(const sim_view *v, mt_text *out)
{
    mt_table t = mt_table_default();
    const motion_row row = motion_row_of(v);
    make_motion_columns(v, true, &t);
    for (int i = 0; i < row.n; i++) {
        add_sample(v, &row, i, true, &t);
    }
    mt_table_csv(&t, out);
    mt_table_free(&t);
}

static void write_ring(const sim_reading *g, mt_text *out)
{
    const char *const unit = g->angle ? "rad" : "m";
    if (g->ring.periods > 0 && g->ring.spread < REGULAR) {
        mt_text_addf(out,
                     "  %s turns with %.9g Hz (%d period%s, alike to %.1e), first swing %.6g "
                     "%s either way",
                     g->name, g->ring.hz, g->ring.periods, g->ring.periods == 1 ? "" : "s",
                     g->ring.spread, g->ring.amplitude, unit);
        if (isfinite(g->ring.damping)) {
            mt_text_addf(out, ", damping ratio %.3g", g->ring.damping);
        }
        mt_text_add(out, ".\n");
    }
    if (g->tones.n > 0) {
        mt_text_addf(out, "  Tones of %s (%.1e of it left over):", g->name, g->tones.residual);
        for (int k = 0; k < g->tones.n && k < TONES_SHOWN; k++) {
            const mt_tone *const tone = &g->tones.tone[k];
            mt_text_addf(out, "%s %.9g Hz with %.4g %s, damping ratio %.3g", k == 0 ? "" : ";",
                         tone->hz, tone->amplitude, unit, tone->damping);
        }
        mt_text_add(out, ".\n");
    }
}

static void write_steady(const sim_view *v, const sim_reading *g, mt_text *out)
{
    if (g->steady.periods == 0 || !(g->steady.residual < STEADY)) {
        return;
    }
    mt_text_addf(out, "  %s in the last %d period%s (%.1e of it left over):", g->name,
                 g->steady.periods, g->steady.periods == 1 ? "" : "s", g->steady.residual);
    for (int h = 0; h < MT_HARMONICS; h++) {
        if (h == 0 || g->steady.amplitude[h] > WEAK * g->steady.amplitude[0]) {
            mt_text_addf(out, "%s %.6g %s at %.6g Hz, phase %.4g rad", h == 0 ? "" : ";",
                         g->steady.amplitude[h], g->angle ? "rad" : "m",
                         (h + 1) * v->request->steady_hz, g->steady.phase[h]);
        }
    }
    mt_text_add(out, ".\n");
}

/* How the motion was found, and how well. */
static void write_method(const sim_view *v, mt_text *out)
{
    const mt_sim_result *const r = v->r;
    switch (r->method) {
    case MT_SIM_INTEGRATED:
    case MT_SIM_METHODS:
        if (r->stiff_steps > 0) {
            mt_text_addf(
                out,
                "  Stiff springs: in %ld steps their fast vibrations are solved beforehand.\n",
                r->stiff_steps);
        }
        mt_text_addf(out,
                     "  %ld steps (%ld more rejected), %ld evaluations, tolerance %.1e.\n\n",
                     r->steps, r->rejected, r->evaluations, v->request->opt.tolerance);
        return;
    case MT_SIM_EXACT:
        mt_text_addf(
            out, "  Exact: the equations are linear%s; %ld steps by the matrix exponential.\n",
            v->free ? " and nothing pushes" : ", the inputs are sines and polynomials of time",
            r->steps);
        break;
    case MT_SIM_FITTED:
        mt_text_addf(out,
                     "  The equations are linear: %ld steps by the matrix exponential, with "
                     "inputs as polynomials\n  in each of them, which miss at most %.1e of "
                     "their largest value.\n",
                     r->steps, r->fit.input_error);
        break;
    }
    mt_text_addf(
        out,
        "  Put into the whole equations of motion at %d samples it leaves at most %.1e "
        "of their largest force.\n\n",
        r->fit.checks, r->fit.residual);
}

static void simulate_print(const sim_view *v, mt_text *out)
{
    const mt_sim_result *const r = v->r;
    mt_table t = mt_table_default();
    const int every = ((r->n - 1) / (LINES_MOST - 1)) + ((r->n - 1) % (LINES_MOST - 1) != 0);
    const motion_row row = motion_row_of(v);
    make_motion_columns(v, false, &t);
    for (int i = 0; i < r->n; i++) {
        if (every == 0 || i % every == 0 || i + 1 == r->n) {
            add_sample(v, &row, i, false, &t);
        }
    }
    mt_text_addf(out, "%s\n", v->configuration);
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
    for (int g = 0; g < r->n_gauges; g++) {
        if (v->free) {
            write_ring(&v->readings[g], out);
        }
        write_steady(v, &v->readings[g], out);
    }
    if (v->request->forced_response.v != NULL) {
        sim_forced_response_print(&v->request->forced_response, out);
    }
    mt_text_addf(out, "  Energy: up to %.4g J, balanced to %.1e J.\n", r->energy_scale_j,
                 r->energy_error_j);
    if (v->sys->n_constraints > 0) {
        mt_text_addf(out, "  Joints: at most %.1e m of drift in a step, %.1e m left of it.\n",
                     r->gap_m, r->left_m);
    }
    write_method(v, out);
}

/* Lists in mem. */
static mt_status simulate_json(const sim_view *v, mt_arena *mem, mt_json_writer *w, mt_err *err)
{
    motion_row row = motion_row_of(v);
    row.n_outputs = v->request->n_outputs;
    row.n_readings = v->r->n_gauges;
    row.outputs = mt_arena_alloc(mem, (size_t)row.n_outputs, sizeof *row.outputs);
    row.readings = mt_arena_alloc(mem, (size_t)row.n_readings, sizeof *row.readings);
    MT_TRY(mt_arena_check(mem, err));
    if (row.is_shaken) {
        row.vibration = shaken_row_of(&v->request->forced_response);
    }
    for (int k = 0; k < row.n_outputs; k++) {
        row.outputs[k] = output_row_of(v, k);
    }
    for (int i = 0; i < row.n_readings; i++) {
        row.readings[i] = reading_row_of(v, i);
    }
    mt_record_put_object(w, NULL, &motion_record, &row, 0, NULL);
    return MT_OK;
}

/* The command. */

enum { STEADY_PERIODS = 10 };

/* One configuration at work. */
typedef struct job {
    const mt_args *args;
    mt_vibration *profile; /* --vibration, owned; NULL */
    mt_loaded_model *s;
    mt_run run; /* stopped by the terminal while the motion is computed */
    int c;
    mt_arena mem;
    mt_analysis *a; /* with --start-mode */
    mt_system *sys; /* without */
    mt_linear *lin;
    sim_request request;
    mt_sim_start start;
    mt_sim_result result;
    sim_view view;
} job;

/* Choose the configuration. */
static mt_status choose_moving_configuration(const mt_loaded_model *s, int *c, mt_err *err)
{
    if (s->n_configurations > 1) {
        return mt_fail(err, MT_E_USAGE,
                       "%s has %d configurations: choose the one that moves with -c", s->path,
                       s->n_configurations);
    }
    *c = s->configurations[0];
    return MT_OK;
}

/* The system, driven where an input moves a joint, at its rest position. */
static mt_status make_driven_system(job *j, mt_err *err)
{
    mt_loaded_model *const s = j->s;
    mt_system_drive drives[MT_DRIVES_MOST];
    int n = 0;
    MT_TRY(sim_moved_joints(j->args, s->model, &s->mem, drives, &n, err));
    for (int i = 0; i < n; i++) {
        bool given = false;
        MT_TRY(sim_start_of(j->args, s, drives[i].joint, &given, &drives[i].position, err));
    }
    if (j->args->given[MT_OPT_START_MODE] && n > 0) {
        return mt_fail(
            err, MT_E_USAGE,
            "--start-mode excludes --start and --rate: it starts a motion in which no "
            "joint is moved");
    }
    if (j->args->given[MT_OPT_START_MODE]) {
        MT_TRY(mt_loaded_model_analyse(s, j->c, 0, &j->a, err));
        j->sys = j->a->own_sys;
        j->lin = j->a->lin;
        return MT_OK;
    }
    mt_loaded_model_warn_dropped(s, j->c, "--input", n, drives);
    mt_system_def def = mt_loaded_model_system(s, j->c, s->n_inputs, s->inputs, s->at);
    def.drive = n > 0 ? drives : NULL;
    def.n_drives = n;
    MT_TRY(mt_system_new_of(&def, &j->sys, err));
    MT_TRY(mt_linear_new(j->sys, &j->lin, err));
    return mt_linear_update(j->lin, s->at, false, err);
}

/* Hold a joint at one position until the rest is in equilibrium. */
static mt_status start_held(job *j, const mt_sim_joint *at, mt_err *err)
{
    const mt_loaded_model *const s = j->s;
    const mt_system_drive drive = {
        .joint = j->sys->joints[at->joint].name, .fixed = true, .position = at->value};
    mt_system *sys = NULL;
    mt_linear *lin = NULL;
    if (!(fabs(at->value) <= mt_drive_reach(j->sys, at->joint))) {
        return mt_fail(err, MT_E_USAGE, "--start: joint \"%s\" goes at most to %g", drive.joint,
                       mt_drive_reach(j->sys, at->joint));
    }
    mt_system_def def = mt_loaded_model_system(s, j->c, s->n_inputs, s->inputs, s->at);
    def.drive = &drive;
    mt_status rc = mt_system_new_of(&def, &sys, err);
    rc = rc == MT_OK ? mt_linear_new(sys, &lin, err) : rc;
    rc = rc == MT_OK ? mt_linear_update(lin, s->at, false, err) : rc;
    rc = rc == MT_OK ? mt_start_from(j->lin, lin, &j->start, err) : rc;
    mt_linear_delete(lin);
    mt_system_delete(sys);
    return mt_err_in(err, rc, "--start");
}

/* The channel of the largest motion along dq; displacements before rotations. */
static mt_status shape_size(job *j, const double *dq, double *size, mt_err *err)
{
    mt_motion o;
    mt_gauge_motion along = {.row = mt_arena_f64(&j->mem, (size_t)j->sys->nq, 1)};
    double most[2] = {0.0, 0.0};
    MT_TRY(mt_motion_init(&o, j->lin, &j->mem, err));
    mt_motion_eval(&o, &j->start.at, j->start.v);
    for (int i = 0; i < j->sys->n_channels; i++) {
        const bool turns = mt_channel_turns(j->sys->channels[i].kind);
        const mt_gauge g = {.channel = i, .joint = -1};
        mt_motion_gauge(&o, &j->start.at, j->start.v, g, &along);
        const double way = mt_dot(j->sys->nq, along.row, dq);
        most[turns ? 1 : 0] = fabs(way) > fabs(most[turns ? 1 : 0]) ? way : most[turns ? 1 : 0];
    }
    *size = most[0] != 0.0 ? most[0] : most[1];
    return *size != 0.0
               ? MT_OK
               : mt_fail(err, MT_E_USAGE, "--start-mode: no sensor moves in this mode");
}

static mt_status start_along(job *j, mt_err *err)
{
    const mt_modes *const modes = &j->a->modes;
    const int at = mt_modal_flexible(modes, j->request.mode);
    double size = 0.0;
    if (at < 0) {
        return mt_fail(err, MT_E_USAGE, "--start-mode: there are %d vibration modes",
                       mt_modal_vibrations(modes));
    }
    double *const dq = mt_arena_f64(&j->mem, (size_t)j->sys->nq, 1);
    MT_TRY(mt_arena_check(&j->mem, err));
    mt_linear_expand(j->lin, 1, mt_modal_shape(modes, at), dq);
    MT_TRY(shape_size(j, dq, &size, err));
    for (int i = 0; i < j->sys->nq; i++) {
        dq[i] *= j->request.amplitude / size;
    }
    return mt_err_in(err, mt_start_along(j->lin, dq, &j->mem, &j->start, err), "--start-mode");
}

/* Position and velocities to begin with. */
static mt_status set_start_state(job *j, mt_err *err)
{
    const sim_request *const r = &j->request;
    const mt_system *const sys = j->sys;
    double drive[MT_DRIVES_MOST] = {0.0};
    int n = 0;
    MT_TRY(mt_start_rest(j->lin, &j->mem, &j->start, err));
    for (int i = 0; i < r->n_starts; i++) { /* a drive is where it starts already */
        const int d = mt_system_drive_of(sys, r->starts[i].joint);
        if (d < 0 || sys->drives[d].spring >= 0) {
            r->starts[n++] = r->starts[i];
        }
    }
    if (n == 1 && !sys->driven) {
        MT_TRY(start_held(j, &r->starts[0], err));
    } else if (n > 0) {
        MT_TRY(mt_err_in(err, mt_start_joints(j->lin, n, r->starts, &j->mem, &j->start, err),
                         "--start"));
    }
    if (r->mode > 0) {
        MT_TRY(start_along(j, err));
    }
    for (int i = 0; i < r->opt.n_inputs; i++) {
        if (r->opt.inputs[i].push == MT_SIM_MOVE) {
            double value[3] = {0.0, 0.0, 0.0};
            MT_TRY(mt_signal_eval(r->opt.inputs[i].signal, 0.0, value, err));
            drive[r->opt.inputs[i].at] += value[1];
        }
    }
    return mt_err_in(
        err, mt_start_rates(j->lin, r->n_rates, r->rates, drive, &j->mem, &j->start, err),
        "--rate");
}

static mt_status read_gauge_tones(job *j, int g, sim_reading *out, mt_err *err)
{
    const mt_sim_result *const r = &j->result;
    const mt_gauge gauge = j->request.opt.gauges[g];
    const double *const value = r->value + g;
    out->name = gauge.channel >= 0 ? j->sys->channels[gauge.channel].name
                                   : j->sys->joints[gauge.joint].name;
    for (int i = 0; i < j->request.n_outputs; i++) {
        out->angle =
            j->request.outputs[i].gauge == g ? j->request.outputs[i].angle : out->angle;
    }
    if (j->view.free) {
        out->ring = mt_ring_read(&r->turnings[g]);
        MT_TRY(mt_tones_read(r->n - 1, j->request.opt.sample_s, value, r->n_gauges, &j->mem,
                             &out->tones, err));
    }
    if (j->request.steady_hz > 0.0) {
        const mt_samples samples = {.n = r->n, .stride = r->n_gauges, .t = r->t, .x = value};
        MT_TRY(mt_steady_read(&samples, j->request.steady_hz, STEADY_PERIODS, &j->mem,
                              &out->steady, err));
    }
    return MT_OK;
}

static mt_status read_all(job *j, mt_err *err)
{
    const int n = j->request.opt.n_gauges;
    j->view = (sim_view){.configuration = mt_loaded_model_configuration(j->s, j->c),
                         .sys = j->sys,
                         .request = &j->request,
                         .r = &j->result,
                         .free = j->request.opt.n_inputs == 0};
    j->view.readings = mt_arena_alloc(&j->mem, (size_t)n, sizeof *j->view.readings);
    MT_TRY(mt_arena_check(&j->mem, err));
    for (int g = 0; g < n; g++) {
        MT_TRY(read_gauge_tones(j, g, &j->view.readings[g], err));
    }
    return MT_OK;
}

/* Simulate with the interrupt of the terminal: the motion so far is kept. */
static mt_status simulate_until_interrupt(job *j, mt_err *err)
{
    mt_interrupt interrupt;
    mt_interrupt_init(&interrupt, mt_terminal_stop_request, NULL, NULL);
    mt_terminal_hold_signals();
    mt_terminal_limit(j->args->time_s);
    j->run.interrupt = &interrupt;
    const mt_status rc =
        mt_simulate(j->lin, &j->start, &j->request.opt, &j->mem, &j->result, err);
    j->run.interrupt = NULL;
    mt_terminal_limit(0.0);
    return rc;
}

static mt_status run_motion(job *j, mt_err *err)
{
    MT_TRY(mt_arena_init(&j->mem, 0, err));
    MT_TRY(choose_moving_configuration(j->s, &j->c, err));
    mt_loaded_model_warn_overridden(j->s, j->c);
    MT_TRY(mt_loaded_model_admit_dense(j->s, j->c, "a motion needs them", err));
    MT_TRY(make_driven_system(j, err));
    MT_TRY(sim_read(j->args, j->s, j->sys, j->profile, &j->request, err));
    MT_TRY(set_start_state(j, err));
    MT_TRY(simulate_until_interrupt(j, err));
    return read_all(j, err);
}

static int print_motion(job *j, mt_text *out)
{
    mt_json_writer w = mt_json_writer_default(out);
    mt_err err = {.code = MT_OK};
    mt_status rc = MT_OK;
    switch (j->args->format) {
    case MT_FORMAT_JSON:
        rc = simulate_json(&j->view, &j->mem, &w, &err);
        return rc == MT_OK ? mt_cli_json_done(&w) : mt_cli_failed(rc, &err);
    case MT_FORMAT_CSV:
        simulate_csv(&j->view, out);
        return MT_EXIT_DONE;
    case MT_FORMAT_HTML:  /* of report alone */
    case MT_FORMAT_SARIF: /* of check alone */
    case MT_FORMAT_TEXT:
        simulate_print(&j->view, out);
        mt_loaded_model_note_links(j->s, j->c, out);
        return MT_EXIT_DONE;
    }
    return MT_EXIT_DONE;
}

static int stopped(const job *j)
{
    if (j->result.stop != MT_SIM_INTERRUPTED) {
        return MT_EXIT_DONE;
    }
    mt_terminal_talk(j->args->given[MT_OPT_QUIET], "%s: %s: the motion ends at %.6g s",
                     j->s->path,
                     mt_terminal_is_stopped() ? "interrupted" : "stopped at the time limit",
                     j->result.t[j->result.n - 1]);
    return mt_terminal_is_stopped() ? MT_EXIT_INTERRUPTED : MT_EXIT_GOALS;
}

static int load_motion_profile(job *j)
{
    const char *const text = j->args->value[MT_OPT_VIBRATION];
    const char *port = NULL;
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    const mt_status rc = text == NULL
                             ? MT_OK
                             : mt_shipped_load_profile(j->args, sim_profile_of(text, &port),
                                                       &j->profile, &messages, &err);
    return mt_cli_loaded(rc, &messages, &err);
}

static int run_simulate(const mt_args *args, mt_text *out)
{
    mt_loaded_model s = {.model = NULL};
    job j = {.args = args, .s = &s};
    mt_err err = {.code = MT_OK};
    int code =
        mt_loaded_model_load(args, args->operands[0], args->value[MT_OPT_CONFIGURATION], &s);
    s.run = &j.run;
    code = code == MT_EXIT_DONE ? load_motion_profile(&j) : code;
    if (code != MT_EXIT_DONE) {
        goto done;
    }
    const mt_status rc = run_motion(&j, &err);
    if (rc == MT_OK) {
        code = print_motion(&j, out);
        code = mt_exit_worse(code, stopped(&j));
    } else {
        if (rc != MT_E_USAGE) {
            (void)mt_err_in(&err, rc, "%s", s.path);
        }
        code = mt_cli_failed(rc, &err);
    }
done:
    if (j.a == NULL) {
        mt_linear_delete(j.lin);
        mt_system_delete(j.sys);
    }
    mt_analysis_delete(j.a);
    mt_vibration_delete(j.profile);
    mt_arena_free(&j.mem);
    mt_loaded_model_free(&s);
    return code;
}

const mt_command mt_command_simulate = {
    .name = "simulate",
    .operands = "MODEL",
    .least = 1,
    .most = 1,
    .summary = "motion in time, of any amplitude",
    .details =
        "Integrates the nonlinear equations of motion of one configuration, and so checks "
        "what the other commands compute for small motions. Where bodies only slide along "
        "fixed lines and turn about fixed axes, and all forces grow in proportion, the "
        "equations are linear: then the motion is exact, by the matrix exponential, and the "
        "last lines say so. The motion begins at rest in "
        "equilibrium unless --start, --rate or --start-mode say otherwise; --input, --sine, "
        "--sine-sweep, --random and --vibration excite it. Prints the outputs over time and "
        "what they show: for a free motion its turns and its tones (frequency, damping, "
        "amplitude), under a sine the steady amplitudes and phases, the balance of energy, "
        "and the largest drift of a joint in a step before it was corrected.\n"
        "Springs, viscous dampers, loads and masses are those of the model; bars and beams "
        "of consistent mass move their mass with their frame. Where springs are so stiff that "
        "their vibrations are far faster than the motion, steps solve these beforehand.\n"
        "After an interrupt (Ctrl-C), or at the end of --time, the motion so far is "
        "printed, and the exit status is 130 or 1. The exit status is 3 if the motion "
        "reaches a dead centre, or if an input acts in a direction without mass.",
    .answer = {&motion_record, MT_ANSWER_ONE},
    .run = run_simulate,
};
