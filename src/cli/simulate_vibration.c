/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A profile of vibration as a motion of the ground: one realisation of it. */
#include <string.h>

#include "cli/simulate.h"
#include "cli/vibrated.h"
#include "simulate/realise.h"
#include "vibration/profile_response.h"

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
    MT_TRY(mt_err_in(err, mt_profiled_ports(v, sys, mem, &request, err), "--vibration PORT=%s",
                     file));
    MT_TRY(mt_err_in(err, mt_port_input(sys, request.inputs[0], mem, &ground, err),
                     "--vibration"));
    MT_TRY(mt_err_in(err, mt_profiled_input(&ground, err), "--vibration"));
    *axis = ground.index;
    return MT_OK;
}

mt_status mt_sim_vibrate(const mt_args *args, mt_loaded_model *s, const mt_system *sys,
                         const mt_vibration *v, mt_sim_request *out, mt_sim_input *inputs,
                         mt_err *err)
{
    mt_sim_forced_response *const to = &out->forced_response;
    mt_realised shake;
    int axis = 0;
    MT_TRY(find_axis(args, v, sys, &s->mem, &axis, err));
    *to = (mt_sim_forced_response){
        .v = v, .axis = axis, .seed = args->given[MT_OPT_SEED] ? args->seed : MT_SIM_SEED};
    const mt_status rc = mt_realise(v, args->duration_s, to->seed, &s->mem, &shake, err);
    MT_TRY(
        mt_err_in(err, rc, "--vibration: %s in %g s", mt_vibrated_name(v), args->duration_s));
    mt_realise_inputs(&shake, axis, inputs + out->opt.n_inputs);
    out->opt.n_inputs += shake.n;
    out->steady_hz = 0.0;
    to->rms = shake.rms;
    return MT_OK;
}

static const char *axis_of(const mt_sim_forced_response *s)
{
    static const char *const names[] = {"base.x", "base.y", "base.z"};
    return names[s->axis];
}

void mt_sim_forced_response_print(const mt_sim_forced_response *s, mt_text *out)
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

void mt_sim_forced_response_json(const mt_sim_forced_response *s, mt_json_writer *w)
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
