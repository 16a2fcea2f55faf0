/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune simulate: motion of one configuration in time. */
#include <math.h>
#include <string.h>

#include "base/run.h"
#include "cli/simulate.h"
#include "cli/vibrated.h"
#include "mechanics/drive.h"

enum { STEADY_PERIODS = 10 };

/* One configuration at work. */
typedef struct job {
    const mt_args *args;
    mt_vibration *profile; /* --vibration, owned; NULL */
    mt_loaded_model *s;
    mt_run run; /* stopped by the terminal while the motion is computed */
    int c;
    mt_arena mem;
    mt_analysis *a; /* with --mode */
    mt_system *sys; /* without */
    mt_linear *lin;
    mt_sim_request request;
    mt_sim_start start;
    mt_sim_result result;
    mt_sim_view view;
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
    mt_system_drive drive = {.fixed = true};
    bool given = false;
    MT_TRY(mt_sim_moved_joint(j->args, s->model, &s->mem, &drive.joint, err));
    if (drive.joint != NULL) {
        MT_TRY(mt_sim_start_of(j->args, s, drive.joint, &given, &drive.position, err));
    }
    if (j->args->given[MT_OPT_ALONG] && drive.joint != NULL) {
        return mt_fail(err, MT_E_USAGE,
                       "--mode excludes --start and --rate: it starts a motion in which no "
                       "joint is moved");
    }
    if (j->args->given[MT_OPT_ALONG]) {
        MT_TRY(mt_loaded_model_analyse(s, j->c, 0, &j->a, err));
        j->sys = j->a->own_sys;
        j->lin = j->a->lin;
        return MT_OK;
    }
    mt_loaded_model_warn_dropped(s, j->c, "--input", drive.joint);
    mt_system_def def = mt_loaded_model_system(s, j->c, s->n_inputs, s->inputs, s->at);
    def.drive = drive.joint == NULL ? NULL : &drive;
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
    return *size != 0.0 ? MT_OK
                        : mt_fail(err, MT_E_USAGE, "--mode: no sensor moves in this mode");
}

static mt_status start_along(job *j, mt_err *err)
{
    const mt_modes *const modes = &j->a->modes;
    const int at = mt_modal_flexible(modes, j->request.mode);
    double size = 0.0;
    if (at < 0) {
        return mt_fail(err, MT_E_USAGE, "--mode: there are %d vibration modes",
                       mt_modal_vibrations(modes));
    }
    double *const dq = mt_arena_f64(&j->mem, (size_t)j->sys->nq, 1);
    MT_TRY(mt_arena_check(&j->mem, err));
    mt_linear_expand(j->lin, 1, mt_modal_shape(modes, at), dq);
    MT_TRY(shape_size(j, dq, &size, err));
    for (int i = 0; i < j->sys->nq; i++) {
        dq[i] *= j->request.amplitude / size;
    }
    return mt_err_in(err, mt_start_along(j->lin, dq, &j->mem, &j->start, err), "--mode");
}

/* Position and velocities to begin with. */
static mt_status set_start_state(job *j, mt_err *err)
{
    const mt_sim_request *const r = &j->request;
    const int d = j->sys->driven && !j->sys->trim ? j->sys->drive_joint : -1;
    double drive = 0.0;
    int n = 0;
    MT_TRY(mt_start_rest(j->lin, &j->mem, &j->start, err));
    for (int i = 0; i < r->n_starts; i++) { /* the drive is where it starts already */
        if (r->starts[i].joint != d) {
            r->starts[n++] = r->starts[i];
        }
    }
    if (n == 1 && !j->sys->driven) {
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
            drive += value[1];
        }
    }
    return mt_err_in(
        err, mt_start_rates(j->lin, r->n_rates, r->rates, drive, &j->mem, &j->start, err),
        "--rate");
}

static mt_status read_gauge_tones(job *j, int g, mt_sim_reading *out, mt_err *err)
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
    j->view = (mt_sim_view){.configuration = mt_loaded_model_configuration(j->s, j->c),
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
    MT_TRY(mt_sim_read(j->args, j->s, j->sys, j->profile, &j->request, err));
    MT_TRY(set_start_state(j, err));
    MT_TRY(simulate_until_interrupt(j, err));
    return read_all(j, err);
}

static int print_motion(const job *j, mt_text *out)
{
    mt_json_writer w = mt_json_writer_default(out);
    switch (j->args->format) {
    case MT_FORMAT_JSON:
        mt_simulate_json(&j->view, &w);
        return mt_cli_json_done(&w);
    case MT_FORMAT_CSV:
        mt_simulate_csv(&j->view, out);
        return MT_EXIT_DONE;
    case MT_FORMAT_HTML:  /* of report alone */
    case MT_FORMAT_SARIF: /* of check alone */
    case MT_FORMAT_TEXT:
        mt_simulate_print(&j->view, out);
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
                             : mt_vibrated_load(j->args, mt_sim_profile_of(text, &port),
                                                &j->profile, &messages, &err);
    return mt_cli_loaded(rc, &messages, &err);
}

int mt_cmd_simulate(const mt_args *args, mt_text *out)
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
