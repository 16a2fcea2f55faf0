/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_SIMULATE_H
#define CLI_SIMULATE_H

#include "cli/cli.h"
#include "simulate/reading.h"
#include "simulate/start.h"
#include "study/vibration.h"

/* The quantity of a gauge in an output. */
typedef enum mt_seen { MT_SEEN_VALUE, MT_SEEN_SPEED, MT_SEEN_ACCELERATION } mt_seen;

/* One --output. */
typedef struct mt_sim_output {
    const char *port; /* "grip.x:velocity" */
    int gauge;        /* index among the options' gauges */
    mt_seen what;
    bool angle;
} mt_sim_output;

/* A realisation of --vibration. */
typedef struct mt_sim_forced_response {
    const mt_vibration *v; /* NULL: none */
    int axis;              /* axis of the ground */
    unsigned long seed;
    double rms; /* RMS of the random parts over the duration [m/s^2] */
} mt_sim_forced_response;
enum { MT_SIM_SEED = 1 };

/* The options of the command, resolved for a system. */
typedef struct mt_sim_request {
    mt_sim_options opt;
    int n_outputs;
    mt_sim_output *outputs;
    int n_starts;
    mt_sim_joint *starts;
    int n_rates;
    mt_sim_joint *rates;
    int mode; /* 0: not given */
    double amplitude;
    mt_sim_forced_response forced_response;
    double steady_hz; /* the single frequency of --sine; 0: none, or several */
} mt_sim_request;

/* The name of the joint that --input, --sine or --sweep moves; NULL: none. Fails: MT_E_USAGE
 * (two), MT_E_MEMORY. */
mt_status mt_sim_moved_joint(const mt_args *args, const mt_model *model, mt_arena *mem,
                             const char **name, mt_err *err);
/* The value of --start for the joint of this name; *given: true where there is one. */
mt_status mt_sim_start_of(const mt_args *args, mt_loaded_model *s, const char *joint,
                          bool *given, double *value, mt_err *err);
/* Resolve all other options for a system; profile: of --vibration, or NULL. Fails: MT_E_USAGE,
 * MT_E_MEMORY. */
mt_status mt_sim_read(const mt_args *args, mt_loaded_model *s, const mt_system *sys,
                      const mt_vibration *profile, mt_sim_request *out, mt_err *err);

/* Split --vibration [PORT=]FILE: returns the file; *port: the port, or NULL
 * (simulate_vibration.c). */
const char *mt_sim_profile_of(const char *text, const char **port);
/* Append the profile's parts to the inputs. */
mt_status mt_sim_vibrate(const mt_args *args, mt_loaded_model *s, const mt_system *sys,
                         const mt_vibration *v, mt_sim_request *out, mt_sim_input *inputs,
                         mt_err *err);
void mt_sim_forced_response_print(const mt_sim_forced_response *s, mt_text *out);
/* Member "vibration" of an open object. */
void mt_sim_forced_response_json(const mt_sim_forced_response *s, mt_json_writer *w);

/* The vibrations identified in the motion of one gauge. */
typedef struct mt_sim_reading {
    const char *name; /* port without quantity */
    bool angle;
    mt_ring ring;
    mt_tones tones;
    mt_steady steady;
} mt_sim_reading;

/* A motion with all that its output needs. */
typedef struct mt_sim_view {
    const char *configuration;
    const mt_system *sys;
    const mt_sim_request *request;
    const mt_sim_result *r;
    mt_sim_reading *readings; /* [gauges] */
    bool free;                /* no excitation: rings and tones are meaningful */
} mt_sim_view;

void mt_simulate_print(const mt_sim_view *v, mt_text *out);
void mt_simulate_json(const mt_sim_view *v, mt_json_writer *w);
void mt_simulate_csv(const mt_sim_view *v, mt_text *out);

#endif
