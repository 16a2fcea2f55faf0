/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A profile of vibration as a motion of the ground: one realisation of it. */
#include <math.h>
#include <string.h>

#include "cli/simulate.h"
#include "cli/vibrated.h"
#include "vibration/shaken.h"

enum { LINES_MOST = 100000 };
/* Values that the RMS of a realisation is taken from, and what these may cost (values times
 * lines): next to nothing beside the motion itself. */
enum { VALUES_LEAST = 1000 };
static const double VALUES_A_PERIOD = 4.0;
static const double WORK_MOST = 1e9;
/* The random parts of a profile have phases of their own. */
static const unsigned long NEXT_SEED = 0x9e3779b9UL;

mt_status mt_sim_realise(const mt_psd *psd, double duration_s, unsigned long seed,
                         mt_arena *mem, mt_signal *out, mt_err *err)
{
    const double lines = ceil((psd->hz[psd->n - 1] - psd->hz[0]) * duration_s) + 1.0;
    if (!(lines <= LINES_MOST)) {
        return mt_fail(err, MT_E_USAGE, "more than %d lines would be needed", (int)LINES_MOST);
    }
    const mt_status rc =
        mt_signal_of_psd(psd, lines > 1.0 ? (int)lines : 1, seed, mem, out, err);
    return rc == MT_E_INPUT ? mt_fail(err, MT_E_USAGE, "%s", err == NULL ? "" : err->text) : rc;
}

/* "base.y=FILE": the file, and where the port begins; else NULL. */
const char *mt_sim_profile_of(const char *text, const char **port)
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
    const char *const file = mt_sim_profile_of(args->value[MT_OPT_VIBRATION], &port);
    mt_response_request request = {.n_in = 0};
    mt_port ground;
    if (port != NULL) {
        port = mt_arena_strndup(mem, port, (size_t)(file - 1 - port));
        request = (mt_response_request){.n_in = 1, .inputs = &port};
    }
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_err_in(err, mt_shaken_ports(v, sys, mem, &request, err), "--vibration PORT=%s",
                     file));
    MT_TRY(mt_err_in(err, mt_port_input(sys, request.inputs[0], mem, &ground, err),
                     "--vibration"));
    MT_TRY(mt_err_in(err, mt_shaken_input(&ground, err), "--vibration"));
    *axis = ground.index;
    return MT_OK;
}

/* A tone stays at its frequency, or goes through its range once. */
static mt_signal tone_of(const mt_vibration_tone *tone, double duration_s, mt_sine *sine)
{
    *sine = (mt_sine){.amplitude = tone->level, .hz = tone->lower_hz};
    return tone->upper_hz > tone->lower_hz
               ? (mt_signal){.kind = MT_SIGNAL_SWEEP,
                             .level = tone->level,
                             .from_hz = tone->lower_hz,
                             .to_hz = tone->upper_hz,
                             .duration_s = duration_s}
               : (mt_signal){.kind = MT_SIGNAL_SINES, .n = 1, .sines = sine};
}

/* RMS of the random parts as they are in this realisation. */
static mt_status realised(const mt_vibration *v, const mt_signal *signals, double duration_s,
                          double *rms, mt_err *err)
{
    double hz = 0.0;
    double lines = 0.0;
    for (int i = 0; i < v->n_random; i++) {
        hz = fmax(hz, v->random[i].psd.hz[v->random[i].psd.n - 1]);
        lines += signals[i].n;
    }
    const double values =
        fmin(ceil(VALUES_A_PERIOD * hz * duration_s), ceil(WORK_MOST / fmax(lines, 1.0)));
    return mt_signal_rms(v->n_random, signals, duration_s,
                         values > VALUES_LEAST ? (int)values : VALUES_LEAST, rms, err);
}

mt_status mt_sim_shake(const mt_args *args, mt_subject *s, const mt_system *sys,
                       const mt_vibration *v, mt_sim_request *out, mt_sim_input *inputs,
                       mt_err *err)
{
    const int n = v->n_random + v->n_tones;
    mt_signal *const signals = mt_arena_alloc(&s->mem, (size_t)n, sizeof *signals);
    mt_sine *const sines = mt_arena_alloc(&s->mem, (size_t)v->n_tones, sizeof *sines);
    int axis = 0;
    MT_TRY(mt_arena_check(&s->mem, err));
    MT_TRY(find_axis(args, v, sys, &s->mem, &axis, err));
    out->shaken = (mt_sim_shaken){
        .v = v, .axis = axis, .seed = args->given[MT_OPT_SEED] ? args->seed : MT_SIM_SEED};
    for (int i = 0; i < v->n_random; i++) {
        const unsigned long seed = out->shaken.seed + (NEXT_SEED * (unsigned long)i);
        const mt_status rc = mt_sim_realise(&v->random[i].psd, args->duration_s, seed, &s->mem,
                                            &signals[i], err);
        MT_TRY(mt_err_in(err, rc, "--vibration: %s in %g s", mt_vibrated_name(v),
                         args->duration_s));
    }
    for (int i = 0; i < v->n_tones; i++) {
        signals[v->n_random + i] = tone_of(&v->tones[i], args->duration_s, &sines[i]);
    }
    for (int i = 0; i < n; i++) {
        inputs[out->opt.n_inputs++] =
            (mt_sim_input){.push = MT_SIM_BASE, .at = axis, .signal = &signals[i]};
    }
    out->steady_hz = 0.0;
    return realised(v, signals, args->duration_s, &out->shaken.rms, err);
}

static const char *axis_of(const mt_sim_shaken *s)
{
    static const char *const names[] = {"base.x", "base.y", "base.z"};
    return names[s->axis];
}

void mt_sim_shaken_print(const mt_sim_shaken *s, mt_text *out)
{
    const mt_vibration *const v = s->v;
    mt_text_addf(out, "  %s is shaken by %s", axis_of(s), mt_vibrated_name(v));
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

void mt_sim_shaken_json(const mt_sim_shaken *s, mt_json_writer *w)
{
    mt_json_open(w, "vibration", '{');
    mt_json_put_string(w, "file", s->v->path);
    mt_json_put_string(w, "name", s->v->name);
    mt_json_put_string(w, "port", axis_of(s));
    mt_json_put_integer(w, "seed", (long)s->seed);
    mt_json_put_number(w, "rms_m_per_s2", mt_vibration_rms(s->v));
    mt_json_put_number(w, "realised_rms_m_per_s2", s->rms);
    mt_vibrated_rule_json(w, s->v);
    mt_json_close(w);
}
