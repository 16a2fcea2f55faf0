/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Beam links against Euler and Bernoulli: omega = (beta L)^2 sqrt(EI/(rho A))/L^2, where beta L
 * is a root of
 *     free-free cos cosh = 1,   pinned-free tan = tanh,   pinned-pinned sin = 0,
 *         clamped-free cos cosh = -1.
 * The frequency of a consistent-mass cubic element is too high by a relative C (beta L/n)^4.
 */
#include "mechanics/mech.h"

enum { TEXT = 3000 };

static const double E = 7e10;
static const double RHO = 2700.0;
static const double SIDE = 0.02;
static const double LENGTH = 1.3;

static double free_free(double x)
{
    return cos(x) - 1.0 / cosh(x);
}

static double clamped_free(double x)
{
    return cos(x) + 1.0 / cosh(x);
}

static double pinned_free(double x)
{
    return sin(x) - cos(x) * tanh(x);
}

static double pinned_pinned(double x)
{
    return sin(x);
}

/* The root between low and high by bisection, to the last bit. */
static double root(double (*f)(double), double low, double high)
{
    for (int i = 0; i < 200; i++) {
        const double mid = 0.5 * (low + high);
        if ((f(mid) > 0.0) == (f(low) > 0.0)) {
            low = mid;
        } else {
            high = mid;
        }
    }
    return 0.5 * (low + high);
}

/* A plane beam laid obliquely; `joints` are JSON objects, each with a comma in front. */
static mt_model *beam(mt_test *t, int elements, const char *joints)
{
    char text[TEXT];
    (void)snprintf(
        text, sizeof text,
        "{\"format\": \"modetune-model/1\", \"dimension\": 2,"
        "\"points\": {\"a\": [0.1, 0.2], \"b\": [\"0.1 + %.17g*cos(0.7)\", \"0.2 + "
        "%.17g*sin(0.7)\"]},"
        "\"links\": [{\"name\": \"beam\", \"kind\": \"beam\", \"from\": \"a\", \"to\": \"b\", "
        "\"elements\": %d,"
        "\"youngs_modulus_pa\": %.17g, \"density_kg_per_m3\": %.17g,"
        "\"section\": {\"shape\": \"rectangle\", \"width_m\": %.17g, \"height_m\": %.17g}}],"
        "\"joints\": [%s]}",
        LENGTH, LENGTH, elements, E, RHO, SIDE, SIDE, joints);
    return mech_parse(t, text);
}

#define PIN_A                                                                               \
    "{\"name\": \"pa\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"beam.start\"], " \
    "\"at\": \"a\"}"
#define PIN_B                                                                             \
    "{\"name\": \"pb\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"beam.end\"], " \
    "\"at\": \"b\"}"
#define CLAMP                                                                            \
    "{\"name\": \"ca\", \"type\": \"fixed\", \"bodies\": [\"ground\", \"beam.start\"], " \
    "\"at\": \"a\"}"

typedef struct support {
    const char *name;
    const char *joints;
    double (*f)(double);
    double first; /* start of the interval of length pi/2 around the first root */
    int rigid;
} support;

static const support SUPPORTS[] = {{"free-free", "", free_free, 4.0, 3},
                                   {"pinned-free", PIN_A, pinned_free, 3.2, 1},
                                   {"pinned-pinned", PIN_A ", " PIN_B, pinned_pinned, 2.4, 0},
                                   {"clamped-free", CLAMP, clamped_free, 1.2, 0}};

/* Relative error of the frequency of bending mode k (from 0). */
static double error_of(mt_test *t, const support *c, int elements, int k)
{
    const double pi = MECH_PI;
    const double x = root(c->f, c->first + k * pi, c->first + k * pi + 0.5 * pi);
    const double area = SIDE * SIDE;
    const double ei = E * area * area / 12.0;
    const double exact = x * x * sqrt(ei / (RHO * area)) / (LENGTH * LENGTH) / (2.0 * pi);
    double hz = nan("");
    mech s;
    if (mech_must(t, beam(t, elements, c->joints), NULL, "", &s)) {
        CHECK_INT(t, s.a->modes.n_rigid, c->rigid);
        hz = mech_hz(&s, k + 1); /* the first axial mode lies far above */
    }
    mech_free(&s);
    return hz / exact - 1.0;
}

static void beams__converge_with_fourth_order(mt_test *t)
{
    static const double FLOOR = 1e-7; /* below it bending is rounding of the axial stiffness */
    for (int i = 0; i < MT_COUNT(SUPPORTS); i++) {
        for (int k = 0; k < 2; k++) {
            mt_test_row(t, "%s, mode %d", SUPPORTS[i].name, k + 1);
            /* the second mode needs twice as many to be in its wave */
            const int n = k == 0 ? 4 : 8;
            const double coarse = error_of(t, &SUPPORTS[i], n, k);
            const double middle = error_of(t, &SUPPORTS[i], 2 * n, k);
            const double fine = error_of(t, &SUPPORTS[i], 4 * n, k);
            CHECK(t, coarse > middle && middle > fine && fine > 0.0); /* from above */
            CHECK(t, fine > FLOOR);
            CHECK_NEAR_ABS(t, log2(coarse / middle), 4.0, 0.3); /* sixth order still shows */
            CHECK_NEAR_ABS(t, log2(middle / fine), 4.0, 0.1);
        }
    }
}

/* E A/L of the bar: the exact frequency of a fixed-free bar is c/(4 L). */
static void beams__axial_mode_of_a_clamped_beam(mt_test *t)
{
    mech s;
    if (mech_must(t, beam(t, 40, CLAMP), NULL, "", &s)) {
        const double exact = sqrt(E / RHO) / (4.0 * LENGTH);
        double nearest = HUGE_VAL;
        for (int i = 1; i <= s.a->modes.count; i++) {
            nearest = fmin(nearest, fabs(mech_hz(&s, i) / exact - 1.0));
        }
        CHECK(t, nearest < 1e-3);
    }
    mech_free(&s);
}

/* Own weight: tip deflection q L^4/(8 EI) in small displacements, and frequencies that hardly
 * change. A stiff beam under a small load must find its equilibrium. */
static void beams__hang_under_their_weight(mt_test *t)
{
    mech s;
    char text[TEXT];
    (void)snprintf(
        text, sizeof text,
        "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"gravity_m_per_s2\": [0, -9.81],"
        "\"links\": [{\"name\": \"beam\", \"kind\": \"beam\", \"from\": [0, 0], \"to\": [0.5, "
        "0], \"elements\": 8,"
        "\"youngs_modulus_pa\": 2.1e11, \"density_kg_per_m3\": 7850,"
        "\"section\": {\"shape\": \"rectangle\", \"width_m\": 0.02, \"height_m\": 0.02}}],"
        "\"joints\": [{\"name\": \"c\", \"type\": \"fixed\", \"bodies\": [\"ground\", "
        "\"beam.start\"], \"at\": [0, 0]}]}");
    if (mech_must(t, mech_parse(t, text), NULL, "", &s)) {
        const mt_pose *const tip = &mt_linear_position(s.a->lin)->at.pose[8];
        const double ei = 2.1e11 * pow(0.02, 4) / 12.0;
        const double q = 7850.0 * 4e-4 * 9.81;
        /* terms of second order: (w/L)^2 ~ 3e-8 */
        CHECK_NEAR(t, creal(tip->x[1]), -q * pow(0.5, 4) / (8.0 * ei), 1e-6);
        CHECK_NEAR(t, mech_hz(&s, 1),
                   1.8751040687 * 1.8751040687 * sqrt(ei / (7850.0 * 4e-4)) / 0.25 /
                       (2.0 * MECH_PI),
                   1e-4);
    }
    mech_free(&s);
}

/* A cantilever of L = E I = 1 that hardly stretches, with a dead load at its end; drawn from
 * its end to its root where `flip`. */
static mt_model *cantilever(mt_test *t, int elements, bool flip, const char *load)
{
    char text[TEXT];
    const char *const a = flip ? "[1, 0]" : "[0, 0]";
    const char *const b = flip ? "[0, 0]" : "[1, 0]";
    (void)snprintf(
        text, sizeof text,
        "{\"format\": \"modetune-model/1\", \"dimension\": 2,"
        "\"links\": [{\"name\": \"beam\", \"kind\": \"beam\", \"from\": %s, \"to\": %s, "
        "\"elements\": %d, \"youngs_modulus_pa\": 1, \"mass_kg\": 1,"
        "\"section\": {\"shape\": \"general\", \"area_m2\": 1e6, \"second_moment_m4\": 1}}],"
        "\"joints\": [{\"name\": \"c\", \"type\": \"fixed\", \"bodies\": [\"ground\", "
        "\"beam.%s\"], \"at\": [0, 0]}],"
        "\"loads\": [{\"name\": \"tip\", \"on\": \"beam.%s\", %s}]}",
        a, b, elements, flip ? "end" : "start", flip ? "start" : "end", load);
    return mech_parse(t, text);
}

/* The elastica: u and w of the end under P L^2/(EI) across (K. Mattiasson, Int. J. Num. Meth.
 * Eng. 17 (1981) 145-153, elliptic integrals). */
static void beams__bend_to_the_elastica(mt_test *t)
{
    static const struct {
        const char *load;
        double u;
        double w;
    } rows[] = {{"\"force_n\": [0, 1]", 0.05643, 0.30172},
                {"\"force_n\": [0, 2]", 0.16064, 0.49346},
                {"\"force_n\": [0, 5]", 0.38763, 0.71379},
                {"\"force_n\": [0, 10]", 0.55500, 0.81061}};
    for (int i = 0; i < 2 * MT_COUNT(rows); i++) {
        const bool flip = i % 2 == 1;
        mech s;
        mt_test_row(t, "%s%s", rows[i / 2].load, flip ? ", drawn from its end" : "");
        if (mech_must(t, cantilever(t, 16, flip, rows[i / 2].load), NULL, "", &s)) {
            const mt_pose *const tip = &mt_linear_position(s.a->lin)->at.pose[flip ? 0 : 16];
            CHECK_NEAR_ABS(t, 1.0 - creal(tip->x[0]), rows[i / 2].u, 3e-5);
            CHECK_NEAR_ABS(t, creal(tip->x[1]), rows[i / 2].w, 3e-5);
        }
        mech_free(&s);
    }
}

/* A moment of pi E I/L at its end bends it to a half circle: the end turns by pi exactly, and
 * lies a diameter 2 L/pi above the root. */
static void beams__bend_to_a_half_circle(mt_test *t)
{
    double error[2] = {nan(""), nan("")};
    for (int i = 0; i < 2; i++) {
        const int n = 8 << i;
        mech s;
        mt_test_row(t, "%d elements", n);
        if (mech_must(t, cantilever(t, n, false, "\"moment_n_m\": \"pi\""), NULL, "", &s)) {
            const mt_pose *const tip = &mt_linear_position(s.a->lin)->at.pose[n];
            CHECK_NEAR_ABS(t, creal(tip->r[0]), -1.0, 1e-9);
            CHECK_NEAR_ABS(t, creal(tip->r[1]), 0.0, 1e-9);
            CHECK_NEAR_ABS(t, creal(tip->x[0]), 0.0, 1e-9);
            error[i] = creal(tip->x[1]) - 2.0 / MECH_PI;
        }
        mech_free(&s);
    }
    CHECK(t, fabs(error[1]) < 2e-6);
    CHECK_NEAR_ABS(t, log2(error[0] / error[1]), 4.0, 0.2);
}

MT_TEST_MAIN(MT_TEST(beams__converge_with_fourth_order),
             MT_TEST(beams__axial_mode_of_a_clamped_beam),
             MT_TEST(beams__hang_under_their_weight), MT_TEST(beams__bend_to_the_elastica),
             MT_TEST(beams__bend_to_a_half_circle))
