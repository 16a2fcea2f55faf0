/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Linear motions without integration: one mass has closed forms; rows of masses and discs on
 * shafts are integrated as well, at a tight tolerance; and what is not linear, or goes too far,
 * is not taken for it.
 */
#include <complex.h>
#include <stdlib.h>

#include "mt_writer.h"
#include "simulate/motions.h"
#include "support/mt_random.h"

enum { TEXT = 20000, SAMPLES = 60 };
static const double TURN = 6.283185307179586477;
static const double PERIOD = 0.05;
static const double LONG = 3.0;

static int only_time(const void *context, const char *name, size_t length)
{
    (void)context;
    return length == 1 && name[0] == 't' ? 0 : -1;
}

static mt_signal expression(mt_test *t, const char *source, mt_arena *mem)
{
    mt_signal s = {.kind = MT_SIGNAL_EXPRESSION};
    mt_program *const p = mt_arena_alloc(mem, 1, sizeof *p);
    mt_expr e;
    CHECK(t,
          mt_expr_parse(source, &(mt_expr_scope){.lookup = only_time}, mem, &e, NULL) == MT_OK);
    CHECK(t, mt_program_init(p, 1, mem, NULL) == MT_OK);
    const mt_node time = mt_program_input(p, 0, MT_NO_ADDR);
    s.node = mt_program_expr(p, &e, &time, MT_NO_ADDR);
    CHECK(t, mt_program_finish(p, NULL) == MT_OK);
    s.program = p;
    s.work = mt_arena_alloc(mem, (size_t)p->count, sizeof *s.work);
    return s;
}

/* One mass on a spring and a damper to the ground, a metre away. */
static mt_model *one_mass(mt_test *t, double m, double k, double c)
{
    char text[TEXT];
    mt_writer x = {text, sizeof text, 0};
    mt_write(
        &x, "{\"format\": \"modetune-model/1\", \"name\": \"m\", \"dimension\": 2, \"bodies\": "
            "[{\"name\": \"m\", ");
    mt_write(&x, "\"mass_kg\": %.17g, \"centre\": [1, 0]}],", m);
    mt_write(&x, "\"joints\": [{\"name\": \"g\", \"type\": \"pin-in-slot\", \"bodies\": "
                 "[\"ground\", \"m\"], \"at\": [1, 0], \"axis\": [1, 0]}],");
    if (k > 0.0) {
        mt_write(
            &x,
            "\"springs\": [{\"name\": \"k\", \"type\": \"axial\", \"bodies\": [\"ground\", "
            "\"m\"], \"at\": [[0, 0], [1, 0]], \"stiffness_n_per_m\": %.17g}],",
            k);
    }
    if (c > 0.0) {
        mt_write(
            &x,
            "\"dampers\": [{\"name\": \"c\", \"type\": \"axial\", \"bodies\": [\"ground\", "
            "\"m\"], \"at\": [[0, 0], [1, 0]], \"damping_n_s_per_m\": %.17g}],",
            c);
    }
    mt_write(&x, "\"sensors\": [{\"name\": \"s\", \"on\": \"m\", \"directions\": [\"x\"]}]}");
    return mech_parse(t, x.text);
}

typedef struct oscillator {
    double m;
    double k;
    double c;
} oscillator;

/* From rest under a force that grows from 0 at t = 0: f t. */
static double under_ramp(const oscillator *o, double f, double t)
{
    if (t <= 0.0) {
        return 0.0;
    }
    const double d = 0.5 * o->c / o->m;
    const double w2 = o->k / o->m;
    const double v = sqrt(w2 - (d * d));
    const double late = 2.0 * d / w2;
    const double swing = (late * cos(v * t)) + (((d * late) - 1.0) / v * sin(v * t));
    return f / o->k * (t - late + (exp(-d * t) * swing));
}

/* From rest under f sin(w t). */
static double under_sine(const oscillator *o, double f, double w, double t)
{
    const double complex x = f / (o->k - (o->m * w * w) + ((double complex)I * (o->c * w)));
    const double d = 0.5 * o->c / o->m;
    const double v = sqrt((o->k / o->m) - (d * d));
    const double a = -cimag(x);
    const double b = ((d * a) - (w * creal(x))) / v;
    return cimag(x * cexp((double complex)I * (w * t))) +
           (exp(-d * t) * ((a * cos(v * t)) + (b * sin(v * t))));
}

/* Rows: a force as an expression; what it makes of the mass. */
typedef double formula(double t);
static const oscillator FREE = {2.0, 0.0, 0.0};
static const oscillator HARD = {2.0, 800.0, 0.0};   /* 20 rad/s */
static const oscillator DAMPED = {2.0, 800.0, 4.0}; /* 5 % */

static double free_step(double t)
{
    return 0.5 * t * t / 2.0;
}

static double free_ramp(double t)
{
    return 0.1 * t * t * t / 12.0;
}

static double hard_step(double t)
{
    return 3.0 / 800.0 * (1.0 - cos(20.0 * t));
}

static double hard_ramp(double t)
{
    return under_ramp(&HARD, 3.0, t);
}

static double at_resonance(double t)
{
    return 3.0 / (2.0 * 2.0 * 20.0) * ((sin(20.0 * t) / 20.0) - (t * cos(20.0 * t)));
}

static double damped_sine(double t)
{
    return under_sine(&DAMPED, 3.0, 17.0, t);
}

static double damped_product(double t)
{
    return under_sine(&DAMPED, 1.5, 22.0, t) + under_sine(&DAMPED, 1.5, 12.0, t);
}

static double kinked(double t)
{
    return under_ramp(&DAMPED, 6.0, t - 0.333) - under_ramp(&DAMPED, 6.0, t - 0.777);
}

static void check_row(mt_test *t, const oscillator *o, const char *force, formula *want,
                      mt_sim_method method, double tol)
{
    motion m;
    if (motion_open(t, one_mass(t, o->m, o->k, o->c), NULL, &m)) {
        const mt_signal s = expression(t, force, &m.mem);
        const mt_sim_input in = {
            .push = MT_SIM_FORCE, .at = mt_system_find_channel(m.sys, "s.x"), .signal = &s};
        m.opt.n_inputs = 1;
        m.opt.inputs = &in;
        motion_watch(t, &m, "s.x");
        if (motion_run(t, &m, LONG, PERIOD)) {
            double most = 0.0;
            CHECK_INT(t, m.r.method, method);
            CHECK_INT(t, m.r.n, SAMPLES + 1);
            for (int i = 0; i < m.r.n; i++) {
                most = fmax(most, fabs(want(m.r.t[i])));
            }
            for (int i = 0; i < m.r.n; i++) {
                CHECK_NEAR_ABS(t, motion_value(&m, 0, i), want(m.r.t[i]), tol * most);
            }
            CHECK(t, m.r.energy_error_j <= tol * m.r.energy_scale_j);
        }
    }
    motion_free(&m);
}

static void propagate__one_mass_moves_as_formulas_say(mt_test *t)
{
    static const struct {
        const char *name;
        const oscillator *o;
        const char *force;
        formula *want;
    } rows[] = {
        {"free, step", &FREE, "1", free_step},
        {"free, ramp", &FREE, "t/10", free_ramp},
        {"undamped, step", &HARD, "3", hard_step},
        {"undamped, ramp", &HARD, "3*t", hard_ramp},
        {"in resonance", &HARD, "3*sin(20*t)", at_resonance},
        {"damped, sine", &DAMPED, "3*sin(17*t)", damped_sine},
        {"damped, product of waves", &DAMPED, "3*sin(17*t)*cos(5*t)", damped_product},
        {"damped, from one level to another", &DAMPED, "6*min(0.444, max(0, t - 0.333))",
         kinked},
        {"the same by magnitudes", &DAMPED, "3*(abs(t - 0.333) - abs(t - 0.777) + 0.444)",
         kinked},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].name);
        check_row(t, rows[i].o, rows[i].force, rows[i].want, MT_SIM_EXACT, 1e-13);
    }
}

/* m x'' + k x = f exp(-t): x = f/(m + k) (exp(-t) - cos w t + sin w t/w). */
static double under_decay(double t)
{
    return 3.0 / 802.0 * (exp(-t) - cos(20.0 * t) + (sin(20.0 * t) / 20.0));
}

/* m x'' + k x = f t sin(w t) with 2 m w off resonance: x = a t sin + b cos + ... */
static double under_growing(double t)
{
    const double w = 5.0;
    const double a = 3.0 / (800.0 - (2.0 * w * w));
    const double b = -2.0 * 2.0 * a * w / (800.0 - (2.0 * w * w));
    /* x = a t sin w t + b cos w t - b cos 20 t: at 0 both x and x' are 0 */
    return (a * t * sin(w * t)) + (b * cos(w * t)) - (b * cos(20.0 * t));
}

static void propagate__other_smooth_forces_are_fitted(mt_test *t)
{
    mt_test_row(t, "a decaying force");
    check_row(t, &HARD, "3*exp(-t)", under_decay, MT_SIM_FITTED, 1e-11);
    mt_test_row(t, "a growing wave");
    check_row(t, &HARD, "3*t*sin(5*t)", under_growing, MT_SIM_FITTED, 1e-11);
}

static const char *const comma[] = {"", ", "};

static void add_row_bodies(mt_writer *x, mt_random *g, int n, bool space, const char *zero)
{
    for (int i = 0; i < n; i++) {
        const double j = mt_random_in(g, 0.5, 2.0);
        mt_write(x, "%s{\"name\": \"m%d\", \"mass_kg\": %.17g, \"centre\": [%d, 0%s], ",
                 comma[i > 0], i, mt_random_in(g, 0.5, 3.0), i + 1, zero);
        if (space) {
            mt_write(x, "\"inertia_kg_m2\": [%.17g, %.17g, %.17g]}", j, j, j);
        } else {
            mt_write(x, "\"inertia_kg_m2\": %.17g}", j);
        }
    }
}

static void add_row_springs(mt_writer *x, mt_random *g, int n, bool discs, const char *zero)
{
    for (int i = 0; i < n; i++) {
        const double k = pow(10.0, mt_random_in(g, 2.0, 4.0));
        if (discs) {
            mt_write(x,
                     "%s{\"name\": \"k%d\", \"type\": \"torsion\", \"joint\": \"g%d\", "
                     "\"stiffness_n_m_per_rad\": %.17g}",
                     comma[i > 0], i, i, k);
        } else {
            char from[16];
            (void)snprintf(from, sizeof from, i == 0 ? "ground" : "m%d", i - 1);
            mt_write(
                x,
                "%s{\"name\": \"k%d\", \"type\": \"axial\", \"bodies\": [\"%s\", \"m%d\"], "
                "\"at\": [[%d, 0%s], [%d, 0%s]], \"stiffness_n_per_m\": %.17g}",
                comma[i > 0], i, from, i, i, zero, i + 1, zero, k);
        }
    }
}

/* A row of masses on springs between each and the next, or of discs on a shaft. */
static mt_model *random_row(mt_test *t, mt_random *g, int n, bool discs)
{
    char text[TEXT];
    mt_writer x = {text, sizeof text, 0};
    const bool space = mt_random_int(g, 2) == 1;
    const char *const zero = space ? ", 0" : "";
    mt_write(&x,
             "{\"format\": \"modetune-model/1\", \"name\": \"row\", \"dimension\": %d, "
             "\"bodies\": [",
             space ? 3 : 2);
    add_row_bodies(&x, g, n, space, zero);
    mt_write(&x, "], \"joints\": [");
    for (int i = 0; i < n; i++) {
        const char *const axis = discs
                                     ? (space ? ", \"axis\": [0, 0, 1]" : "")
                                     : (space ? ", \"axis\": [1, 0, 0]" : ", \"axis\": [1, 0]");
        mt_write(&x,
                 "%s{\"name\": \"g%d\", \"type\": \"%s\", \"bodies\": [\"ground\", \"m%d\"], "
                 "\"at\": [%d, 0%s]%s}",
                 comma[i > 0], i, discs ? "revolute" : "prismatic", i, i + 1, zero, axis);
    }
    /* discs turn with each other by gears, or stand for themselves: torsion acts on a joint */
    if (discs && n > 1) {
        mt_write(&x,
                 ", {\"name\": \"mesh\", \"type\": \"gear\", \"joints\": [\"g0\", \"g1\"], "
                 "\"ratio\": %.17g}",
                 mt_random_in(g, -3.0, -0.5));
    }
    mt_write(&x, "], \"springs\": [");
    add_row_springs(&x, g, n, discs, zero);
    mt_write(&x, "], \"dampers\": [");
    for (int i = 0; i < n; i++) {
        const double c = pow(10.0, mt_random_in(g, -2.0, 1.5));
        mt_write(&x,
                 discs ? "%s{\"name\": \"c%d\", \"type\": \"torsion\", \"joint\": \"g%d\", "
                         "\"damping_n_m_s_per_rad\": %.17g}"
                       : "%s{\"name\": \"c%d\", \"type\": \"axial\", \"joint\": \"g%d\", "
                         "\"damping_n_s_per_m\": %.17g}",
                 comma[i > 0], i, i, c);
    }
    mt_write(&x, "], \"sensors\": [");
    for (int i = 0; i < n; i++) {
        mt_write(&x, "%s{\"name\": \"s%d\", \"on\": \"m%d\", \"directions\": [\"%s\"]}",
                 comma[i > 0], i, i, discs ? (space ? "rz" : "r") : "x");
    }
    mt_write(&x, "]}");
    return mech_parse(t, x.text);
}

/* Largest difference of the two motions, as a part of the second. */
static double differ(const mt_sim_result *a, const mt_sim_result *b, const double *of_a,
                     const double *of_b)
{
    double most = 0.0;
    double size = 0.0;
    for (ptrdiff_t i = 0; i < (ptrdiff_t)b->n * b->n_gauges; i++) {
        const double d = fabs(of_a[i] - of_b[i]);
        most = !(d <= most) ? d : most;
        size = fmax(size, fabs(of_b[i]));
    }
    return a->n == b->n ? most / fmax(size, 1e-300) : HUGE_VAL;
}

static void compare(mt_test *t, motion *m, mt_sim_method method)
{
    /* what a step of the integration may leave, some hundred times */
    static const double TOL = 1e-9;
    if (!motion_run(t, m, 0.5, 0.013)) {
        return;
    }
    const mt_sim_result exact = m->r;
    CHECK_INT(t, exact.method, method);
    CHECK(t, exact.energy_error_j <= 1e-12 * exact.energy_scale_j);
    CHECK(t, exact.fit.checks > 0 && exact.fit.residual < 1e-9);
    m->opt.integrates = true;
    if (!motion_run(t, m, 0.5, 0.013)) {
        return;
    }
    CHECK_INT(t, m->r.method, MT_SIM_INTEGRATED);
    CHECK(t, differ(&exact, &m->r, exact.value, m->r.value) <= TOL);
    CHECK(t, differ(&exact, &m->r, exact.speed, m->r.speed) <= TOL);
    CHECK(t, differ(&exact, &m->r, exact.acceleration, m->r.acceleration) <= TOL);
    const double scale = fmax(m->r.energy_scale_j, 1e-300);
    for (int i = 0; i < m->r.n; i++) {
        CHECK_NEAR_ABS(t, exact.kinetic[i], m->r.kinetic[i], TOL * scale);
        CHECK_NEAR_ABS(t, exact.potential[i], m->r.potential[i], TOL * scale);
        CHECK_NEAR_ABS(t, exact.work[i], m->r.work[i], TOL * scale);
    }
}

static void propagate__rows_move_as_they_do_when_integrated(mt_test *t)
{
    static const char *const forces[] = {"2*sin(11*t) - cos(40*t)^2", "3", "t - t^3",
                                         "exp(-3*t)*sin(20*t)"};
    const int cases = getenv("MT_EVERY") == NULL ? 40 : 1200;
    mt_random g = mt_random_seed(11);
    for (int i = 0; i < cases; i++) {
        const bool discs = mt_random_int(&g, 3) == 0;
        const int n = 1 + mt_random_int(&g, 4);
        const int force = mt_random_int(&g, MT_COUNT(forces));
        const bool ground = !discs && mt_random_int(&g, 2) == 1;
        motion m;
        mt_test_row(t, "case %d: %d %s, %s of %s", i, n, discs ? "discs" : "masses",
                    ground ? "ground" : "force", forces[force]);
        if (motion_open(t, random_row(t, &g, n, discs), NULL, &m)) {
            const mt_signal s = expression(t, forces[force], &m.mem);
            const mt_sim_input in = {.push = ground ? MT_SIM_BASE : MT_SIM_FORCE,
                                     .at = ground ? 0 : mt_random_int(&g, n),
                                     .signal = &s};
            m.opt.n_inputs = 1;
            m.opt.inputs = &in;
            m.opt.n_gauges = n;
            for (int k = 0; k < n; k++) {
                m.gauges[k] = (mt_gauge){.channel = k, .joint = -1};
            }
            if (motion_turn(t, &m, "g0", mt_random_in(&g, -0.3, 0.3))) {
                compare(t, &m, force == 3 ? MT_SIM_FITTED : MT_SIM_EXACT);
            }
        }
        motion_free(&m);
    }
}

/* Periods, amplitudes and where the motion ends, from where it goes on. */
static void propagate__a_free_motion_turns_and_goes_on(mt_test *t)
{
    motion m;
    if (motion_open(t, one_mass(t, HARD.m, HARD.k, HARD.c), NULL, &m)) {
        motion_watch(t, &m, "s.x");
        motion_watch(t, &m, "g");
        m.opt.turning = true;
        m.opt.end = &m.start;
        if (motion_turn(t, &m, "g", 2.0) && motion_run(t, &m, 1.55, 0.25)) {
            CHECK_INT(t, m.r.method, MT_SIM_EXACT);
            CHECK_INT(t, m.r.n, 8);
            for (int g = 0; g < 2; g++) {
                const mt_turnings *const list = &m.r.turnings[g];
                const double half = 0.5 * TURN / 20.0;
                CHECK_INT(t, list->n, 10);
                for (int i = 0; i < list->n; i++) {
                    CHECK_NEAR(t, list->at[i].t, half * (0.5 + i), 1e-13);
                    CHECK_NEAR(t, list->at[i].value, i % 2 == 0 ? 0.1 : -0.1, 1e-13);
                    CHECK(t, list->at[i].highest == (i % 2 == 0));
                }
            }
            CHECK_NEAR(t, motion_value(&m, 0, 7), 0.1 * sin(20.0 * 1.55), 1e-12);
            if (motion_run(t, &m, 1.0, 0.5)) {
                CHECK_NEAR(t, motion_value(&m, 0, 0), 0.1 * sin(20.0 * 1.55), 1e-12);
                CHECK_NEAR(t, motion_value(&m, 0, 2), 0.1 * sin(20.0 * 2.55), 1e-12);
            }
        }
    }
    motion_free(&m);
}

/* What is not linear, or not for so far a motion, is integrated. */
static void propagate__nothing_else_is_taken_for_linear(mt_test *t)
{
    static const struct {
        const char *file;
        const char *configuration;
        mt_sim_method method;
    } rows[] = {
        {"double_pendulum", "distances", MT_SIM_INTEGRATED},
        {"four_bar", "still", MT_SIM_INTEGRATED},
        {"space_body", "damped", MT_SIM_INTEGRATED},
        {"taut_string", "preload", MT_SIM_INTEGRATED},
        {"rods", "bodies", MT_SIM_INTEGRATED},
        {"driven_rod", "trimmed", MT_SIM_INTEGRATED},
        {"driven_rod", "locked", MT_SIM_EXACT}, /* what moves is a disc about its centre */
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        motion m;
        mt_test_row(t, "%s, %s", rows[i].file, rows[i].configuration);
        if (motion_open(t, mech_load(t, rows[i].file), rows[i].configuration, &m) &&
            motion_run(t, &m, 1e-3, 1e-3)) {
            CHECK_INT(t, m.r.method, rows[i].method);
        }
        motion_free(&m);
    }
    motion m;
    mt_test_row(t, "the mass comes to where the spring is held");
    if (motion_open(t, one_mass(t, HARD.m, HARD.k, HARD.c), NULL, &m)) {
        motion_watch(t, &m, "s.x");
        /* 21 m/s over 20 rad/s are more than the metre that there is; 19 are not */
        if (motion_turn(t, &m, "g", 19.0) && motion_run(t, &m, 0.1, 0.01)) {
            CHECK_INT(t, m.r.method, MT_SIM_EXACT);
        }
        if (motion_turn(t, &m, "g", -21.0) && motion_run(t, &m, 0.1, 0.01)) {
            CHECK_INT(t, m.r.method, MT_SIM_INTEGRATED);
        }
    }
    motion_free(&m);
}

MT_TEST_MAIN(MT_TEST(propagate__one_mass_moves_as_formulas_say),
             MT_TEST(propagate__other_smooth_forces_are_fitted),
             MT_TEST(propagate__rows_move_as_they_do_when_integrated),
             MT_TEST(propagate__a_free_motion_turns_and_goes_on),
             MT_TEST(propagate__nothing_else_is_taken_for_linear))
