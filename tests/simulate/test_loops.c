/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Loops, moved through whole turns: positions, velocities and accelerations are those of the
 * geometry; what the drive does is in the energy.
 */
#include "simulate/motions.h"

static const double TURN = 6.283185307179586477;

/* theta = 3 t + 0.2 sin(2 pi 1.5 t): from 0, never uniform. */
typedef struct angle {
    double value;
    double speed;
    double acceleration;
} angle;

static angle angle_at(double t)
{
    const double w = TURN * 1.5;
    return (angle){(3.0 * t) + (0.2 * sin(w * t)), 3.0 + (0.2 * w * cos(w * t)),
                   -0.2 * w * w * sin(w * t)};
}

/* The same as a signal: an expression of the time. */
typedef struct expression {
    mt_program program;
    mt_signal signal;
} expression;

static int only_t(const void *context, const char *name, size_t length)
{
    (void)context;
    return length == 1 && name[0] == 't' ? 0 : -1;
}

static void express(mt_test *t, const char *text, mt_arena *mem, expression *out)
{
    mt_expr e;
    CHECK(t, mt_expr_parse(text, &(mt_expr_scope){.lookup = only_t}, mem, &e, NULL) == MT_OK);
    CHECK(t, mt_program_init(&out->program, 1, mem, NULL) == MT_OK);
    const mt_node time = mt_program_input(&out->program, 0, MT_NO_ADDR);
    out->signal = (mt_signal){.kind = MT_SIGNAL_EXPRESSION, .program = &out->program};
    out->signal.node = mt_program_expr(&out->program, &e, &time, MT_NO_ADDR);
    CHECK(t, mt_program_finish(&out->program, NULL) == MT_OK);
    out->signal.work =
        mt_arena_alloc(mem, (size_t)out->program.count, sizeof *out->signal.work);
}

/* Move `joint` by the angle for `turns` turns of its mean. */
static bool drive(mt_test *t, motion *m, mt_model *model, const char *configuration,
                  const char *joint, const char *const *watched, int samples)
{
    expression e;
    const mt_sim_input input = {.push = MT_SIM_MOVE, .signal = &e.signal};
    if (!motion_open_driven(t, model, configuration, joint, 0.0, m)) {
        return false;
    }
    for (int i = 0; watched[i] != NULL; i++) {
        motion_watch(t, m, watched[i]);
    }
    express(t, "3*t + 0.2*sin(2*pi*1.5*t)", &m->mem, &e);
    m->opt.n_inputs = 1;
    m->opt.inputs = &input;
    const double rate = angle_at(0.0).speed;
    return motion_done(t, m,
                       mt_start_rates(m->lin, 0, NULL, &rate, &m->mem, &m->start, &m->err)) &&
           motion_run(t, m, 2.0 * TURN / 3.0, 2.0 * TURN / 3.0 / samples);
}

static double speed_of(const motion *m, int g, int i)
{
    return m->r.speed[g + ((ptrdiff_t)i * m->r.n_gauges)];
}

static double acceleration_of(const motion *m, int g, int i)
{
    return m->r.acceleration[g + ((ptrdiff_t)i * m->r.n_gauges)];
}

/* C keeps its distances to the crank's pin B and to the rocker's pivot D. */
static void check_four_bar(mt_test *t, const motion *m)
{
    for (int i = 0; i < m->r.n; i++) {
        const angle a = angle_at(m->r.t[i]);
        const double s[2] = {sin(1.0 + a.value), cos(1.0 + a.value)};
        const double c[2] = {0.35 + motion_value(m, 0, i), 0.25 + motion_value(m, 1, i)};
        const double cv[2] = {speed_of(m, 0, i), speed_of(m, 1, i)};
        const double ca[2] = {acceleration_of(m, 0, i), acceleration_of(m, 1, i)};
        const double d[2] = {c[0] - 0.4, c[1]};
        const double b[2] = {c[0] - (0.15 * s[1]), c[1] - (0.15 * s[0])};
        const double bv[2] = {cv[0] + (0.15 * s[0] * a.speed), cv[1] - (0.15 * s[1] * a.speed)};
        const double ba[2] = {
            ca[0] + (0.15 * ((s[0] * a.acceleration) + (s[1] * a.speed * a.speed))),
            ca[1] - (0.15 * ((s[1] * a.acceleration) - (s[0] * a.speed * a.speed)))};
        const double rod = hypot(0.35 - (0.15 * cos(1.0)), 0.25 - (0.15 * sin(1.0)));
        CHECK_NEAR(t, hypot(d[0], d[1]), hypot(0.05, 0.25), 1e-12);
        CHECK_NEAR(t, hypot(b[0], b[1]), rod, 1e-12);
        CHECK_NEAR_ABS(t, (d[0] * cv[0]) + (d[1] * cv[1]), 0.0, 1e-12);
        CHECK_NEAR_ABS(t, (b[0] * bv[0]) + (b[1] * bv[1]), 0.0, 1e-12);
        CHECK_NEAR_ABS(t, (cv[0] * cv[0]) + (cv[1] * cv[1]) + (d[0] * ca[0]) + (d[1] * ca[1]),
                       0.0, 1e-10);
        CHECK_NEAR_ABS(t, (bv[0] * bv[0]) + (bv[1] * bv[1]) + (b[0] * ba[0]) + (b[1] * ba[1]),
                       0.0, 1e-10);
        CHECK_NEAR_ABS(t, motion_value(m, 2, i), a.value, 1e-12);
    }
}

static void simulate__four_bar_goes_round_with_its_geometry(mt_test *t)
{
    static const char *const watched[] = {"tip.x", "tip.y", "jA", NULL};
    motion m;
    if (drive(t, &m, mech_load(t, "four_bar"), "loaded", "jA", watched, 60)) {
        check_four_bar(t, &m);
        CHECK(t, m.r.gap_m < 1e-11);
        CHECK(t, m.r.left_m < 1e-14);
        CHECK(t, m.r.energy_error_j < 1e-9 * m.r.energy_scale_j);
    }
    motion_free(&m);
}

static const char SLIDER[] =
    "{\"format\": \"modetune-model/1\", \"name\": \"slider-crank\", \"dimension\": 2,"
    " \"gravity_m_per_s2\": [0, -9.81],"
    " \"points\": {\"O\": [0, 0], \"P\": [0.1, 0], \"Q\": [0.4, 0]},"
    " \"bodies\": [{\"name\": \"crank\", \"mass_kg\": 1, \"inertia_kg_m2\": 0.01, \"centre\": "
    "[0.05, 0]},"
    " {\"name\": \"rod\", \"mass_kg\": 0.5, \"inertia_kg_m2\": 0.004, \"centre\": [0.25, 0]},"
    " {\"name\": \"piston\", \"mass_kg\": 0.3, \"inertia_kg_m2\": 0.001, \"centre\": \"Q\"}],"
    " \"joints\": [{\"name\": \"shaft\", \"type\": \"revolute\", \"bodies\": [\"ground\", "
    "\"crank\"], \"at\": \"O\"},"
    " {\"name\": \"pin\", \"type\": \"revolute\", \"bodies\": [\"crank\", \"rod\"], \"at\": "
    "\"P\"},"
    " {\"name\": \"small_end\", \"type\": \"revolute\", \"bodies\": [\"rod\", \"piston\"], "
    "\"at\": \"Q\"},"
    " {\"name\": \"guide\", \"type\": \"prismatic\", \"bodies\": [\"ground\", \"piston\"], "
    "\"at\": \"Q\", \"axis\": [1, 0]}],"
    " \"sensors\": [{\"name\": \"s\", \"on\": \"piston\", \"directions\": [\"x\"]}],"
    " \"configurations\": {\"c\": {}}}";

/* x = r cos + root, root = sqrt(l^2 - r^2 sin^2); it passes both dead centres of the piston. */
static void simulate__slider_crank_is_that_of_its_closed_form(mt_test *t)
{
    static const char *const watched[] = {"s.x", "guide", NULL};
    const double r = 0.1;
    const double l = 0.3;
    motion m;
    if (drive(t, &m, mech_parse(t, SLIDER), NULL, "shaft", watched, 60)) {
        for (int i = 0; i < m.r.n; i++) {
            const angle a = angle_at(m.r.t[i]);
            const double s = sin(a.value);
            const double c = cos(a.value);
            const double root = sqrt((l * l) - (r * r * s * s));
            /* derivatives by the angle */
            const double first = -(r * s) - (r * r * s * c / root);
            const double second = -(r * c) - (r * r * ((c * c) - (s * s)) / root) -
                                  (r * r * r * r * s * s * c * c / (root * root * root));
            CHECK_NEAR_ABS(t, motion_value(&m, 0, i), (r * c) + root - (r + l), 1e-13);
            CHECK_NEAR_ABS(t, motion_value(&m, 1, i), motion_value(&m, 0, i), 1e-13);
            CHECK_NEAR_ABS(t, speed_of(&m, 0, i), first * a.speed, 1e-12);
            CHECK_NEAR_ABS(t, acceleration_of(&m, 0, i),
                           (second * a.speed * a.speed) + (first * a.acceleration), 1e-10);
        }
        CHECK(t, m.r.gap_m < 1e-11);
        CHECK(t, m.r.energy_error_j < 1e-9 * m.r.energy_scale_j);
    }
    motion_free(&m);
}

/* Of equal cranks: where all lie in a line the loop may go on as a parallelogram or crossed. */
static const char PARALLEL[] =
    "{\"format\": \"modetune-model/1\", \"name\": \"parallelogram\", \"dimension\": 2,"
    " \"gravity_m_per_s2\": [0, 0],"
    " \"points\": {\"A\": [0, 0], \"B\": [0, 0.1], \"C\": [0.3, 0.1], \"D\": [0.3, 0]},"
    " \"bodies\": [{\"name\": \"left\", \"mass_kg\": 1, \"inertia_kg_m2\": 0.01, \"centre\": "
    "[0, 0.05]},"
    " {\"name\": \"top\", \"mass_kg\": 0.5, \"inertia_kg_m2\": 0.004, \"centre\": [0.15, 0.1]},"
    " {\"name\": \"right\", \"mass_kg\": 1, \"inertia_kg_m2\": 0.01, \"centre\": [0.3, 0.05]}],"
    " \"joints\": [{\"name\": \"jA\", \"type\": \"revolute\", \"bodies\": [\"ground\", "
    "\"left\"], \"at\": \"A\"},"
    " {\"name\": \"jB\", \"type\": \"revolute\", \"bodies\": [\"left\", \"top\"], \"at\": "
    "\"B\"},"
    " {\"name\": \"jC\", \"type\": \"revolute\", \"bodies\": [\"top\", \"right\"], \"at\": "
    "\"C\"},"
    " {\"name\": \"jD\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"right\"], \"at\": "
    "\"D\"}],"
    " \"configurations\": {\"c\": {}}}";

static void simulate__a_parallelogram_passes_its_dead_centres_or_says_so(mt_test *t)
{
    motion m;
    if (motion_open(t, mech_parse(t, PARALLEL), NULL, &m) && motion_turn(t, &m, "jA", 2.0)) {
        motion_watch(t, &m, "jA");
        motion_watch(t, &m, "jD");
        m.opt.duration_s = TURN;
        m.opt.sample_s = 0.01 * TURN;
        const mt_status rc = mt_simulate(m.lin, &m.start, &m.opt, &m.mem, &m.r, &m.err);
        if (rc == MT_OK) { /* two turns, at constant speed, the cranks parallel all the way */
            for (int i = 0; i < m.r.n; i++) {
                CHECK_NEAR_ABS(t, motion_value(&m, 0, i), 2.0 * m.r.t[i], 1e-8);
                CHECK_NEAR_ABS(t, motion_value(&m, 1, i), 2.0 * m.r.t[i], 1e-8);
            }
        } else {
            CHECK_INT(t, rc, MT_E_DEAD_CENTRE);
            CHECK(t, strstr(m.err.text, "dead centre") != NULL);
        }
    }
    motion_free(&m);
}

/* The redundant joints of three dimensions do not matter. */
static void simulate__redundant_joints_move_as_the_plane_does(mt_test *t)
{
    motion plane;
    motion space = {.lin = NULL};
    const bool both = motion_open(t, mech_load(t, "four_bar"), "loaded", &plane) &&
                      motion_open(t, mech_load(t, "space_four_bar"), "loaded", &space);
    if (both && motion_turn(t, &plane, "jA", 9.0) && motion_turn(t, &space, "jA", 9.0)) {
        motion_watch(t, &plane, "jA");
        motion_watch(t, &space, "jA");
        if (motion_run(t, &plane, 1.0, 0.05) && motion_run(t, &space, 1.0, 0.05)) {
            for (int i = 0; i < plane.r.n; i++) {
                CHECK_NEAR_ABS(t, motion_value(&space, 0, i), motion_value(&plane, 0, i), 1e-8);
            }
            CHECK(t, space.r.gap_m < 1e-11);
        }
    }
    motion_free(&plane);
    motion_free(&space);
}

MT_TEST_MAIN(MT_TEST(simulate__four_bar_goes_round_with_its_geometry),
             MT_TEST(simulate__slider_crank_is_that_of_its_closed_form),
             MT_TEST(simulate__a_parallelogram_passes_its_dead_centres_or_says_so),
             MT_TEST(simulate__redundant_joints_move_as_the_plane_does))
