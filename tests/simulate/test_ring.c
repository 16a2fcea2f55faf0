/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Small motions ring with the frequencies of the linearisation: started along each of the
 * lowest modes and let go, the strongest tone of what moves most is that mode's. The two have
 * rows and energies in common, and nothing of linearisation, eigenproblem and integration.
 *     The amplitude is 1e-5 of the model's length: frequencies depend on its square; what the
 * first mode drags along, a shape's curvature, is other tones of the reading.
 */
#include <stdlib.h>

#include "simulate/motions.h"
#include "simulate/reading.h"

static const double AMPLITUDE = 1e-5;
static const double TOL = 1e-6;
enum { PERIODS = 6, SAMPLES = 20 };

/* Of all sensors and joints the one that goes furthest along dq, rotations as arcs. */
static mt_gauge liveliest(motion *m, const double *dq)
{
    const size_t nq = (size_t)m->sys->nq;
    mt_motion o;
    mt_gauge best = {.channel = -1, .joint = -1};
    mt_gauge_motion along = {.row = mt_arena_f64(&m->mem, nq, 1)};
    const double *const still = mt_arena_f64(&m->mem, nq, 1);
    double most = 0.0;
    (void)mt_motion_init(&o, m->lin, &m->mem, NULL);
    mt_motion_eval(&o, &m->start.at, still);
    for (int i = 0; i < m->sys->n_channels + m->sys->n_joints; i++) {
        const bool channel = i < m->sys->n_channels;
        const int joint = i - m->sys->n_channels;
        const mt_gauge g = {.channel = channel ? i : -1, .joint = channel ? -1 : joint};
        if (!channel && m->sys->joints[joint].coordinate < 0) {
            continue;
        }
        mt_motion_gauge(&o, &m->start.at, still, g, &along);
        const bool angle = channel ? m->sys->channels[i].kind == MT_CHANNEL_ROTATION ||
                                         m->sys->channels[i].kind == MT_CHANNEL_BEAM_ROTATION
                                   : m->sys->joints[joint].angle;
        const double way =
            fabs(mt_dot((int)nq, along.row, dq)) * (angle ? m->sys->length_m : 1.0);
        best = way > most ? g : best;
        most = fmax(way, most);
    }
    return best;
}

static void check_ring(mt_test *t, motion *m, double hz)
{
    mt_tones tones;
    CHECK(t, mt_tones_read(m->r.n, 1.0 / (SAMPLES * hz), m->r.value, 1, &m->mem, &tones,
                           NULL) == MT_OK);
    CHECK(t, tones.n > 0);
    CHECK_NEAR(t, tones.tone[0].hz, hz, TOL);
    CHECK(t, fabs(tones.tone[0].damping) < TOL);
    CHECK(t, m->r.gap_m < 1e-10 * m->sys->length_m);
    /* loads do so much work along eps of a length */
    const double noise = 1e-13 * m->weight * m->sys->length_m;
    CHECK(t, m->r.energy_error_j <= (1e-8 * m->r.energy_scale_j) + noise);
    if (getenv("MT_TOL_SCALE") != NULL) {
        (void)fprintf(stderr, "    %g Hz, off by %.1e, residual %.1e\n", hz,
                      (tones.tone[0].hz / hz) - 1.0, tones.residual);
        motion_tell(m);
    }
}

/* Vibration mode `index`, at AMPLITUDE. */
static bool ring(mt_test *t, mt_model *model, const char *configuration, int index)
{
    motion m;
    const mt_modes *modes = NULL;
    if (!motion_open(t, model, configuration, &m)) {
        motion_free(&m);
        return false;
    }
    modes = &m.mech.a->modes;
    const int at = mt_modal_flexible(modes, index);
    if (at < 0) {
        motion_free(&m);
        return false;
    }
    const double hz = mt_modal_hz(modes, at);
    double *const dq = mt_arena_f64(&m.mem, (size_t)m.sys->nq, 1);
    mt_linear_expand(m.lin, 1, mt_modal_shape(modes, at), dq);
    double most = 0.0;
    for (int b = 0; b < m.sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            const int dof = m.sys->bodies[b].dof[k];
            const double way = dof < 0 ? 0.0 : fabs(dq[dof]);
            most = fmax(most, k < 3 ? way / m.sys->length_m : way);
        }
    }
    for (int i = 0; i < m.sys->nq; i++) {
        dq[i] *= AMPLITUDE / most;
    }
    m.gauges[0] = liveliest(&m, dq);
    m.opt.n_gauges = 1;
    if (motion_done(t, &m, mt_start_along(m.lin, dq, &m.mem, &m.start, &m.err)) &&
        motion_run(t, &m, PERIODS / hz, 1.0 / (SAMPLES * hz))) {
        check_ring(t, &m, hz);
    }
    motion_free(&m);
    return true;
}

/* Without MT_EVERY=1 the highest of a row's modes is enough, and none of "installed", whose
 * lowest takes longer than all others together; counters see all but that one. */
static bool left_out(const char *configuration, int mode, int modes)
{
    const bool installed = strcmp(configuration, "installed") == 0;
    return getenv("MT_INSTRUMENTED") != NULL ? installed && mode == 1
                                             : installed || mode < modes;
}

static void simulate__small_motions_ring_with_the_frequencies_of_modes(mt_test *t)
{
    static const struct {
        const char *file; /* of tests/models */
        const char *configuration;
        int modes;
    } rows[] = {
        {"double_pendulum", "distances", 2},
        {"double_pendulum", "rods", 2}, /* massless rods between point masses */
        {"four_bar", "still", 1},
        {"four_bar", "loaded", 1},
        {"four_bar", "trimmed", 1},      /* a spring carries the trimmed force */
        {"space_four_bar", "loaded", 1}, /* redundant joints */
        {"space_four_bar", "trimmed", 1},
        {"rods", "bodies", 2},      /* consistent masses of bars */
        {"couplings", "planet", 2}, /* gears */
        {"couplings", "driven", 2},
        {"driven_rod", "locked", 1},
        {"loads", "dead", 2},
        {"space_couplings", "loaded", 2},
        {"taut_string", "preload", 2},
        {"space_body", "hanging", 2},
        {"../../problems/inceptor", "stick_free", 2},
        {"../../problems/inceptor", "installed", 2},
        {"../../problems/beam_lumped", "pinned_free", 3},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        for (int k = 1; k <= rows[i].modes; k++) {
            if (getenv("MT_EVERY") == NULL &&
                left_out(rows[i].configuration, k, rows[i].modes)) {
                continue;
            }
            mt_test_row(t, "%s, %s, mode %d", rows[i].file, rows[i].configuration, k);
            CHECK(t, ring(t, mech_load(t, rows[i].file), rows[i].configuration, k));
        }
    }
}

MT_TEST_MAIN(MT_TEST(simulate__small_motions_ring_with_the_frequencies_of_modes))
