/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Motions for tests: a model, where it begins, what is looked at. */
#ifndef TESTS_SIMULATE_MOTIONS_H
#define TESTS_SIMULATE_MOTIONS_H

#include "mechanics/mech.h"
#include "simulate/start.h"

enum { MOTION_GAUGES = 8 };

typedef struct motion {
    mech mech;
    mt_arena mem;
    mt_system *own_sys; /* of motion_open_driven */
    mt_linear *own_lin;
    mt_linear *lin;
    const mt_system *sys;
    double weight; /* sum of the forces of loads and springs at the start [N] */
    mt_sim_start start;
    mt_sim_options opt;
    mt_gauge gauges[MOTION_GAUGES];
    mt_sim_result r;
    mt_err err;
} motion;

/* Sensors "s.x" and joints "pivot" as gauges. */
static inline void motion_watch(mt_test *t, motion *m, const char *name)
{
    mt_gauge *const g = &m->gauges[m->opt.n_gauges++];
    g->channel = mt_system_find_channel(m->sys, name);
    g->joint = g->channel < 0 ? mt_system_find_joint(m->sys, name) : -1;
    CHECK(t, g->channel >= 0 || g->joint >= 0);
}

/* Forces at work where it starts: what their work is known to. */
static inline void motion_weigh(motion *m)
{
    mt_motion o;
    double *const still = mt_arena_f64(&m->mem, (size_t)m->sys->nq, 1);
    m->weight = 0.0;
    if (mt_motion_init(&o, m->lin, &m->mem, &m->err) == MT_OK) {
        mt_motion_eval(&o, &m->start.at, still);
        for (int b = 0; b < m->sys->n_bodies; b++) {
            for (int k = 0; k < 3; k++) {
                const int dof = m->sys->bodies[b].dof[k];
                m->weight += dof >= 0 ? fabs(o.force[dof]) : 0.0;
            }
        }
        m->weight += o.l.force_scale;
    }
}

static inline bool motion_done(mt_test *t, const motion *m, mt_status rc)
{
    if (!CHECK(t, rc == MT_OK)) {
        (void)fprintf(stderr, "%s: %s\n", mt_status_name(rc), m->err.text);
    }
    return rc == MT_OK;
}

/* Takes the model; at rest, nothing watched. */
static inline bool motion_open(mt_test *t, mt_model *model, const char *configuration,
                               motion *m)
{
    *m = (motion){.opt = mt_sim_options_default()};
    if (!mech_must(t, model, configuration, "", &m->mech) ||
        !CHECK(t, mt_arena_init(&m->mem, 0, &m->err) == MT_OK)) {
        return false;
    }
    m->lin = m->mech.a->lin;
    m->sys = mt_linear_system(m->lin);
    m->opt.gauges = m->gauges;
    const bool ok = CHECK(t, mt_start_rest(m->lin, &m->mem, &m->start, &m->err) == MT_OK);
    if (ok) {
        motion_weigh(m);
    }
    return ok;
}

/* With a joint that stands at `position`, and may be moved by an input. */
static inline bool motion_open_driven(mt_test *t, mt_model *model, const char *configuration,
                                      const char *joint, double position, motion *m)
{
    const mt_system_drive drive = {.joint = joint, .fixed = true, .position = position};
    *m = (motion){.opt = mt_sim_options_default(), .mech.model = model};
    const int c = configuration == NULL ? 0 : mt_model_find_configuration(model, configuration);
    mt_status rc = mt_arena_init(&m->mem, 0, &m->err);
    rc = rc == MT_OK
             ? mt_system_new_of(
                   &(mt_system_def){.model = model, .configuration = c, .drive = &drive},
                   &m->own_sys, &m->err)
             : rc;
    rc = rc == MT_OK ? mt_linear_new(m->own_sys, &m->own_lin, &m->err) : rc;
    rc = rc == MT_OK ? mt_linear_update(m->own_lin, NULL, false, &m->err) : rc;
    m->lin = m->own_lin;
    m->sys = m->own_sys;
    m->opt.gauges = m->gauges;
    rc = rc == MT_OK ? mt_start_rest(m->lin, &m->mem, &m->start, &m->err) : rc;
    return motion_done(t, m, rc);
}

static inline void motion_free(motion *m)
{
    mt_linear_delete(m->own_lin);
    mt_system_delete(m->own_sys);
    mt_arena_free(&m->mem);
    mech_free(&m->mech);
}

static inline mt_sim_joint motion_joint(const motion *m, const char *name, double value)
{
    return (mt_sim_joint){.joint = mt_system_find_joint(m->sys, name), .value = value};
}

/* One joint to its place. */
static inline bool motion_put(mt_test *t, motion *m, const char *joint, double value)
{
    const mt_sim_joint j = motion_joint(m, joint, value);
    return motion_done(t, m, mt_start_joints(m->lin, 1, &j, &m->mem, &m->start, &m->err));
}

static inline bool motion_turn(mt_test *t, motion *m, const char *joint, double rate)
{
    const mt_sim_joint j = motion_joint(m, joint, rate);
    return motion_done(t, m, mt_start_rates(m->lin, 1, &j, NULL, &m->mem, &m->start, &m->err));
}

static inline bool motion_run(mt_test *t, motion *m, double duration_s, double sample_s)
{
    m->opt.duration_s = duration_s;
    m->opt.sample_s = sample_s;
    return motion_done(t, m, mt_simulate(m->lin, &m->start, &m->opt, &m->mem, &m->r, &m->err));
}

/* Value of gauge g at sample i. */
static inline double motion_value(const motion *m, int g, int i)
{
    return m->r.value[g + ((ptrdiff_t)i * m->r.n_gauges)];
}

/* Steps, drifts and energies, for who looks (MT_TOL_SCALE=0). */
static inline void motion_tell(const motion *m)
{
    (void)fprintf(stderr,
                  "    %ld steps, %ld rejected, %ld evaluations; gap %.1e, left %.1e m; energy "
                  "%.1e of %.3g J\n",
                  m->r.steps, m->r.rejected, m->r.evaluations, m->r.gap_m, m->r.left_m,
                  m->r.energy_error_j, m->r.energy_scale_j);
}

#endif
