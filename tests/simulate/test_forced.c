/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Small steady motions under a sine are those of the linear system,
 *     (K + i w C - w^2 M) y = B,   (relative, under unit base acceleration B = -M r; of bars
 * that the ground holds it has a part too)
 * solved here as one real system of twice the size; and a linear mechanism is so at any size.
 */
#include "simulate/motions.h"

static const double TURN = 6.283185307179586477;
static const double HZ = 3.0;
enum { SETTLE = 60, LAST = 10, SAMPLES = 20 };

/* Amplitude and phase (against the sine) of gauge `g` in the linear system, n freedoms. */
static void linear_response(mt_test *t, motion *m, const double *b, const double *row, double w,
                            double out[2])
{
    const mt_reduced r = mt_linear_reduced(m->lin);
    const int n = r.n;
    const int nn = 2 * n;
    double *const c = mt_arena_f64(&m->mem, (size_t)n, (size_t)n);
    double *const a = mt_arena_f64(&m->mem, (size_t)nn, (size_t)nn);
    double *const x = mt_arena_f64(&m->mem, (size_t)nn, 1);
    double *const q = mt_arena_f64(&m->mem, (size_t)m->sys->nq, 2);
    mt_linear_damping(m->lin, c);
    for (ptrdiff_t j = 0; j < n; j++) {
        for (ptrdiff_t i = 0; i < n; i++) {
            const double s = r.k[i + (j * n)] - (w * w * r.m[i + (j * n)]);
            a[i + (j * nn)] = s;
            a[n + i + ((n + j) * nn)] = s;
            a[i + ((n + j) * nn)] = -w * c[i + (j * n)];
            a[n + i + (j * nn)] = w * c[i + (j * n)];
        }
        /* Z^T b: the unit vectors' motions along b */
        double *const unit = mt_arena_f64(&m->mem, (size_t)n, 1);
        unit[j] = 1.0;
        mt_linear_expand(m->lin, 1, unit, q);
        x[j] = mt_dot(m->sys->nq, q, b);
    }
    CHECK(t, mt_lu_solve(nn, a, 1, x, NULL, &m->mem, &m->err) == MT_OK);
    mt_linear_expand(m->lin, 1, x, q);
    mt_linear_expand(m->lin, 1, x + n, q + m->sys->nq);
    const double re = mt_dot(m->sys->nq, row, q);
    const double im = mt_dot(m->sys->nq, row, q + m->sys->nq);
    out[0] = hypot(re, im);
    out[1] = atan2(im, re);
}

/* The force of the input on the states at rest, and the row of the gauge. */
static void at_rest(motion *m, const mt_sim_input *in, double *b, double *row)
{
    const size_t nq = (size_t)m->sys->nq;
    mt_motion o;
    mt_gauge_motion g = {.row = b};
    double *const still = mt_arena_f64(&m->mem, nq, 1);
    (void)mt_motion_init(&o, m->lin, &m->mem, NULL);
    mt_motion_eval(&o, &m->start.at, still);
    if (in->push == MT_SIM_FORCE) {
        mt_motion_gauge(&o, &m->start.at, still, (mt_gauge){in->at, -1}, &g);
    } else {
        double *const along = mt_arena_f64(&m->mem, nq, 1);
        for (int i = 0; i < m->sys->n_bodies; i++) {
            along[m->sys->bodies[i].dof[in->at]] = 1.0;
        }
        mt_gemv(false, m->sys->nq, m->sys->nq, -1.0, o.mass, m->sys->nq, along, 0.0, b);
        for (int i = 0; i < m->sys->n_inertias; i++) { /* b/6 of a bar between them */
            const mt_inertia_def *const bar = &m->sys->inertias[i];
            const int end = bar->body[0] == MT_GROUND ? bar->body[1] : bar->body[0];
            if (bar->body[0] == MT_GROUND || bar->body[1] == MT_GROUND) {
                b[m->sys->bodies[end].dof[in->at]] -=
                    mt_linear_value(m->lin, bar->coefficient) / 6.0;
            }
        }
    }
    g.row = row;
    mt_motion_gauge(&o, &m->start.at, still, m->gauges[0], &g);
}

static void settles(mt_test *t, mt_model *model, const char *configuration, const char *force,
                    const char *seen, double amplitude)
{
    motion m;
    const mt_sine sine = {.amplitude = amplitude, .hz = HZ};
    const mt_signal signal = {.kind = MT_SIGNAL_SINES, .n = 1, .sines = &sine};
    if (motion_open(t, model, configuration, &m)) {
        const int channel = force == NULL ? -1 : mt_system_find_channel(m.sys, force);
        const mt_sim_input in = {.push = force == NULL ? MT_SIM_BASE : MT_SIM_FORCE,
                                 .at = force == NULL ? 0 : channel,
                                 .signal = &signal};
        double *const b = mt_arena_f64(&m.mem, (size_t)m.sys->nq, 1);
        double *const row = mt_arena_f64(&m.mem, (size_t)m.sys->nq, 1);
        double want[2];
        mt_steady steady;
        motion_watch(t, &m, seen);
        at_rest(&m, &in, b, row);
        linear_response(t, &m, b, row, TURN * HZ, want);
        m.opt.n_inputs = 1;
        m.opt.inputs = &in;
        if (motion_run(t, &m, (SETTLE + LAST) / HZ, 1.0 / (SAMPLES * HZ))) {
            const mt_samples samples = {.n = m.r.n, .stride = 1, .t = m.r.t, .x = m.r.value};
            CHECK(t, mt_steady_read(&samples, HZ, LAST, &m.mem, &steady, NULL) == MT_OK);
            CHECK_INT(t, steady.periods, LAST);
            CHECK_NEAR(t, steady.amplitude[0], amplitude * want[0], 1e-6);
            CHECK_NEAR_ABS(t, remainder(steady.phase[0] - want[1], TURN), 0.0, 1e-6);
            CHECK(t, steady.residual < 1e-6);
            CHECK(t, m.r.energy_error_j < 1e-8 * m.r.energy_scale_j);
            /* in space: the ground's acceleration is in it */
            const double last = m.r.acceleration[m.r.n - 1];
            const double w = TURN * HZ;
            const double time = m.r.t[m.r.n - 1];
            const double relative = -w * w * amplitude * want[0] * sin((w * time) + want[1]);
            const double ground = force == NULL ? amplitude * sin(w * time) : 0.0;
            CHECK_NEAR_ABS(t, last, relative + ground,
                           1e-5 * w * w * amplitude * want[0] + (1e-9 * fabs(ground)));
        }
    }
    motion_free(&m);
}

static const char CHAIN[] =
    "{\"format\": \"modetune-model/1\", \"name\": \"two masses\", \"dimension\": 2,"
    " \"gravity_m_per_s2\": [0, 0],"
    " \"points\": {\"o\": [0, 0], \"a\": [1, 0], \"b\": [2, 0]},"
    " \"bodies\": [{\"name\": \"m1\", \"mass_kg\": 2, \"inertia_kg_m2\": 1, \"centre\": \"a\"},"
    " {\"name\": \"m2\", \"mass_kg\": 1, \"inertia_kg_m2\": 1, \"centre\": \"b\"}],"
    " \"joints\": [{\"name\": \"g1\", \"type\": \"prismatic\", \"bodies\": [\"ground\", "
    "\"m1\"],"
    " \"at\": \"a\", \"axis\": [1, 0]}, {\"name\": \"g2\", \"type\": \"prismatic\", "
    "\"bodies\": "
    "[\"ground\", \"m2\"], \"at\": \"b\", \"axis\": [1, 0]}],"
    " \"springs\": [{\"name\": \"k1\", \"type\": \"axial\", \"bodies\": [\"ground\", \"m1\"],"
    " \"at\": [\"o\", \"a\"], \"stiffness_n_per_m\": 900},"
    " {\"name\": \"k2\", \"type\": \"axial\", \"bodies\": [\"m1\", \"m2\"], \"at\": [\"a\", "
    "\"b\"], \"stiffness_n_per_m\": 400}],"
    " \"dampers\": [{\"name\": \"c1\", \"type\": \"axial\", \"bodies\": [\"ground\", \"m1\"],"
    " \"at\": [\"o\", \"a\"], \"damping_n_s_per_m\": 8},"
    " {\"name\": \"c2\", \"type\": \"axial\", \"bodies\": [\"m1\", \"m2\"], \"at\": [\"a\", "
    "\"b\"], \"damping_n_s_per_m\": 3}],"
    " \"sensors\": [{\"name\": \"s1\", \"on\": \"m1\", \"directions\": [\"x\"]},"
    " {\"name\": \"s2\", \"on\": \"m2\", \"directions\": [\"x\"]}],"
    " \"configurations\": {\"c\": {}}}";

/* On bars: linear in the first, by a rod that swings in the second. */
static const char BARS[] =
    "{\"format\": \"modetune-model/1\", \"name\": \"bars\", \"dimension\": 2,"
    " \"bodies\": [{\"name\": \"table\", \"mass_kg\": 1, \"inertia_kg_m2\": 1,"
    " \"centre\": [0, 0], \"in\": [\"table\"]},"
    " {\"name\": \"m\", \"mass_kg\": 2, \"centre\": [1, 0]}],"
    " \"joints\": [{\"name\": \"rail\", \"type\": \"pin-in-slot\", \"bodies\": [\"ground\","
    " \"m\"], \"at\": [1, 0], \"axis\": [1, 0], \"in\": [\"linear\"]},"
    " {\"name\": \"way\", \"type\": \"prismatic\", \"bodies\": [\"ground\", \"table\"],"
    " \"at\": [0, 0], \"axis\": [1, 0], \"in\": [\"table\"]},"
    " {\"name\": \"rod\", \"type\": \"distance\", \"bodies\": [\"ground\", \"m\"],"
    " \"at\": [[0.6, -0.8], [1, 0]], \"mass_kg\": 5, \"in\": [\"swings\"]},"
    " {\"name\": \"rod_t\", \"type\": \"distance\", \"bodies\": [\"table\", \"m\"],"
    " \"at\": [[0.6, -0.8], [1, 0]], \"mass_kg\": 5, \"in\": [\"table\"]}],"
    " \"springs\": [{\"name\": \"bar\", \"type\": \"bar\", \"bodies\": [\"m\", \"ground\"],"
    " \"at\": [[1, 0], [0, 0]], \"youngs_modulus_pa\": 9e3, \"area_m2\": 0.1,"
    " \"density_kg_per_m3\": 60, \"in\": [\"linear\", \"swings\"]},"
    " {\"name\": \"bar_t\", \"type\": \"bar\", \"bodies\": [\"m\", \"table\"],"
    " \"at\": [[1, 0], [0, 0]], \"youngs_modulus_pa\": 9e3, \"area_m2\": 0.1,"
    " \"density_kg_per_m3\": 60, \"in\": [\"table\"]}],"
    " \"dampers\": [{\"name\": \"c\", \"type\": \"axial\", \"bodies\": [\"ground\", \"m\"],"
    " \"at\": [[0, 0], [1, 0]], \"damping_n_s_per_m\": 20, \"in\": [\"linear\","
    " \"swings\"]},"
    " {\"name\": \"c_t\", \"type\": \"axial\", \"bodies\": [\"table\", \"m\"],"
    " \"at\": [[0, 0], [1, 0]], \"damping_n_s_per_m\": 20, \"in\": [\"table\"]}],"
    " \"sensors\": [{\"name\": \"s\", \"on\": \"m\"}],"
    " \"configurations\": {\"linear\": {}, \"swings\": {},"
    "  \"table\": {}}}";

/* Large motions on a moving ground are those on a table that is moved alike. */
static void simulate__a_moving_ground_is_a_table_that_is_moved(mt_test *t)
{
    /* from rest: 0.3 * 0.9 = 0.15 * 1.8 */
    static const mt_sine SINES[2] = {{.amplitude = 0.3, .hz = 0.9},
                                     {.amplitude = -0.15, .hz = 1.8}};
    static const mt_signal SIGNAL = {.kind = MT_SIGNAL_SINES, .n = 2, .sines = SINES};
    static const mt_sim_input IN[2] = {
        {.push = MT_SIM_BASE, .at = 0, .slope = 2, .signal = &SIGNAL},
        {.push = MT_SIM_MOVE, .at = 0, .signal = &SIGNAL}};
    motion m[2];
    bool ran = motion_open(t, mech_parse(t, BARS), "swings", &m[0]);
    ran = motion_open_driven(t, mech_parse(t, BARS), "table", "way", 0.0, &m[1]) && ran;
    for (int i = 0; i < 2 && ran; i++) {
        motion_watch(t, &m[i], "s.x");
        motion_watch(t, &m[i], "s.y");
        m[i].opt.n_inputs = 1;
        m[i].opt.inputs = &IN[i];
        ran = motion_run(t, &m[i], 1.5, 0.1);
    }
    double most = 0.0;
    for (ptrdiff_t at = 0; ran && at < (ptrdiff_t)2 * m[0].r.n; at++) {
        mt_test_row(t, "value %td", at);
        CHECK_NEAR_ABS(t, m[0].r.acceleration[at], m[1].r.acceleration[at], 1e-6);
        most = fmax(most, fabs(m[0].r.acceleration[at]));
    }
    CHECK(t, most > 1.0);
    motion_free(&m[0]);
    motion_free(&m[1]);
}

static void simulate__steady_motions_are_those_of_the_linear_system(mt_test *t)
{
    mt_test_row(t, "two masses, force");
    settles(t, mech_parse(t, CHAIN), NULL, "s1.x", "s2.x", 10.0);
    mt_test_row(t, "two masses, moving ground");
    settles(t, mech_parse(t, CHAIN), NULL, NULL, "s1.x", 2.0);
    mt_test_row(t, "bars, moving ground");
    settles(t, mech_parse(t, BARS), "linear", NULL, "s.x", 2.0);
    settles(t, mech_parse(t, BARS), "swings", NULL, "s.y", 1e-3);
    mt_test_row(t, "a body on a ball joint, a moment");
    settles(t, mech_load(t, "space_body"), "damped", "s.ry", "s.x", 0.1);
    mt_test_row(t, "the same, moving ground");
    settles(t, mech_load(t, "space_body"), "damped", NULL, "s.x", 0.1);
}

/* A realisation of a PSD has its area, whatever its seed; and what it is made of repeats. */
static void simulate__a_random_signal_has_its_mean_square(mt_test *t)
{
    static double hz[] = {5.0, 20.0, 100.0};
    static double w[] = {0.01, 0.04, 0.04 * 0.2};
    /* by pieces: slope +1: (w1 f1 - w0 f0)/2; slope -1: w f ln(f2/f1) */
    const double area = (0.5 * ((0.04 * 20.0) - (0.01 * 5.0))) + (0.04 * 20.0 * log(5.0));
    enum { LINES = 190, TIMES = 4096 };
    const mt_psd psd = {.n = 3, .hz = hz, .level = w};
    mt_arena mem = {0};
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    for (unsigned long seed = 1; seed <= 3; seed++) {
        mt_signal s;
        double square = 0.0;
        mt_test_row(t, "seed %lu", seed);
        CHECK(t, mt_signal_of_psd(&psd, LINES, seed, &mem, &s, NULL) == MT_OK);
        const double period = 2.0 * LINES / 95.0; /* lines at odd halves of df */
        for (int i = 0; i < TIMES; i++) {
            double value[3];
            CHECK(t, mt_signal_eval(&s, period * i / TIMES, value, NULL) == MT_OK);
            square += value[0] * value[0] / TIMES;
        }
        CHECK_NEAR(t, square, area, 1e-9);
    }
    /* a step is one */
    const mt_psd step = {
        .n = 4, .hz = (double[]){5.0, 20.0, 20.0, 30.0}, .level = (double[]){1, 1, 3, 3}};
    double rms = 0.0;
    mt_signal stepped;
    CHECK_INT(t, mt_signal_of_psd(&step, 50, 1, &mem, &stepped, NULL), MT_OK);
    CHECK_INT(t, mt_signal_rms(1, &stepped, 4.0, 4096, &rms, NULL), MT_OK);
    CHECK_NEAR(t, rms, sqrt(45.0), 1e-9); /* 4 s: two of its periods */
    const mt_psd wrong = {.n = 2, .hz = (double[]){5.0, 5.0}, .level = w};
    mt_signal s;
    CHECK_INT(t, mt_signal_of_psd(&wrong, LINES, 1, &mem, &s, NULL), MT_E_INPUT);
    mt_arena_free(&mem);
}

/* Turned on from line to line, they are their sines, with both derivatives. */
static void simulate__lines_are_the_sum_of_their_sines(mt_test *t)
{
    enum { LINES = 300 };
    mt_sine sines[LINES];
    double cosine[LINES];
    double sine[LINES];
    for (int k = 0; k < LINES; k++) {
        sines[k] = (mt_sine){1.0 + sin(k), 20.0 + (0.37 * k), 0.7 * k};
        cosine[k] = sines[k].amplitude * cos(sines[k].phase);
        sine[k] = sines[k].amplitude * sin(sines[k].phase);
    }
    const mt_signal one = {.kind = MT_SIGNAL_SINES, .n = LINES, .sines = sines};
    const mt_signal other = {.kind = MT_SIGNAL_LINES,
                             .n = LINES,
                             .cosine = cosine,
                             .sine = sine,
                             .from_hz = 20.0,
                             .step_hz = 0.37};
    for (int i = 0; i < 40; i++) {
        const double time = 0.731 * i * i;
        double want[3];
        double got[3];
        mt_test_row(t, "t = %g", time);
        CHECK_INT(t, mt_signal_eval(&one, time, want, NULL), MT_OK);
        CHECK_INT(t, mt_signal_eval(&other, time, got, NULL), MT_OK);
        const double w = TURN * (20.0 + (0.37 * LINES));
        const double size = 1e-15 * w * (1.0 + time) * LINES; /* the rounding of w t */
        CHECK_NEAR_ABS(t, got[0], want[0], size);
        CHECK_NEAR_ABS(t, got[1], want[1], w * size);
        CHECK_NEAR_ABS(t, got[2], want[2], w * w * size);
    }
}

/* Derivatives of signals, by differences. */
static void simulate__signals_have_their_derivatives(mt_test *t)
{
    const mt_sine sines[] = {{2.0, 3.0, 0.4}, {0.5, 11.0, -1.0}};
    const mt_signal signals[] = {
        {.kind = MT_SIGNAL_SINES, .n = 2, .sines = sines},
        {.kind = MT_SIGNAL_SWEEP,
         .level = 2.0,
         .from_hz = 1.0,
         .to_hz = 20.0,
         .duration_s = 4.0},
        {.kind = MT_SIGNAL_SWEEP,
         .level = 2.0,
         .from_hz = 20.0,
         .to_hz = 1.0,
         .duration_s = 4.0,
         .linear = true},
        {.kind = MT_SIGNAL_SWEEP,
         .level = 2.0,
         .from_hz = 5.0,
         .to_hz = 5.0,
         .duration_s = 4.0},
    };
    for (int i = 0; i < MT_COUNT(signals); i++) {
        for (int k = 0; k < 5; k++) {
            const double time = 0.3 + (0.77 * k);
            const double h = 1e-4;
            double at[3];
            double on[3];
            double back[3];
            mt_test_row(t, "signal %d at %g", i, time);
            CHECK(t, mt_signal_eval(&signals[i], time, at, NULL) == MT_OK);
            CHECK(t, mt_signal_eval(&signals[i], time + h, on, NULL) == MT_OK);
            CHECK(t, mt_signal_eval(&signals[i], time - h, back, NULL) == MT_OK);
            /* h^2/6 of the third derivative: w^3 amplitude */
            CHECK_NEAR_ABS(t, (on[0] - back[0]) / (2.0 * h), at[1], 2e-2);
            CHECK_NEAR_ABS(t, (on[1] - back[1]) / (2.0 * h), at[2], 4.0);
        }
    }
}

MT_TEST_MAIN(MT_TEST(simulate__steady_motions_are_those_of_the_linear_system),
             MT_TEST(simulate__a_moving_ground_is_a_table_that_is_moved),
             MT_TEST(simulate__a_random_signal_has_its_mean_square),
             MT_TEST(simulate__lines_are_the_sum_of_their_sines),
             MT_TEST(simulate__signals_have_their_derivatives))
