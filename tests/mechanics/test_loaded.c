/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What a load costs in accuracy: nothing. References are the same equations in displacements or
 * angles, in thirty digits:
 *   chain    rigid links of length l_i and mass m_i, hinged with torsional springs k_i, hung on
 *            (or standing on) a pin in gravity: with the links' angles a,
 *            2 V = sum k_i (a_i+1 - a_i)^2 + g sum m_i (sum_j<i l_j a_j^2 + l_i/2 a_i^2),   the
 *                    second sum negative where it stands
 *   strip    a clamped Euler-Bernoulli beam in cubic elements, with a preloaded string
 *            elsewhere in the model
 */
#include "mechanics/mech.h"
#include "mt_writer.h"
#include "support/mt_quad.h"
#include "support/mt_random.h"

enum { TEXT = 16000, LINKS = 10 };

/* What is promised of the lowest modes. */
static const double PROMISED = 1e-9;
/* Where nothing is lost but last digits. */
static const double FINE = 1e-13;

static mt_quad_pencil exact;

static void clear_exact(int n, int band)
{
    memset(&exact, 0, sizeof exact);
    exact.n = n;
    exact.band = band;
}

/* Uniform chain of length 1 m in lateral displacements of its joints, where everything is
 * banded. */
static void uniform_chain(int n, double mass, double spring, double gravity)
{
    const mt_quad h = (mt_quad)1 / n;
    const mt_quad m = (mt_quad)mass / n;
    clear_exact(n, 2);
    for (int i = 1; i <= n; i++) {
        const int at[3] = {i - 3, i - 2, i - 1};
        const mt_quad both[2] = {1, (mt_quad)1 / 2};
        const mt_quad end[1] = {1};
        const mt_quad slope[2] = {-1 / h, 1 / h};
        const mt_quad bend[3] = {1 / h, -2 / h, 1 / h};
        mt_quad_add(exact.m, m / 3, 2, at + 1, both);
        mt_quad_add(exact.m, m / 4, 1, at + 2, end);
        mt_quad_add(exact.k, (mt_quad)gravity * m * h * ((mt_quad)(n - i) + (mt_quad)1 / 2), 2,
                    at + 1, slope);
        if (i > 1) {
            mt_quad_add(exact.k, (mt_quad)spring, 3, at, bend);
        }
    }
}

/* lambda of the mode next to `want`, and that its error holds. */
static void check_mode(mt_test *t, const mt_modes *modes, double want, double tol)
{
    int best = 0;
    for (int i = 1; i < modes->count; i++) {
        if (fabs(modes->lambda[i] - want) < fabs(modes->lambda[best] - want)) {
            best = i;
        }
    }
    CHECK_INT(t, modes->kind[best], MT_MODE_FLEXIBLE);
    CHECK_NEAR(t, modes->lambda[best], want, tol);
    CHECK_NEAR_ABS(t, modes->lambda[best], want, modes->error[best]);
    CHECK(t, modes->error[best] < 1e-6 * want);
}

static void loaded__hanging_chain_of_stiff_links_swings(mt_test *t)
{
    static const int ELEMENTS[] = {5, 20, 60, 120};
    for (int r = 0; r < MT_COUNT(ELEMENTS); r++) {
        char text[TEXT];
        mech s;
        const int n = ELEMENTS[r];
        mt_test_row(t, "%d links", n);
        (void)snprintf(
            text, sizeof text,
            "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"gravity_m_per_s2\": [0, "
            "-9.81],"
            "\"points\": {\"a\": [0.3, 2], \"b\": [0.3, 1]},"
            "\"links\": [{\"name\": \"c\", \"from\": \"a\", \"to\": \"b\", \"elements\": %d, "
            "\"mass_kg\": 1.5, \"stiffness_n_m_per_rad\": %d}],"
            "\"joints\": [{\"name\": \"pin\", \"type\": \"revolute\", \"bodies\": [\"ground\", "
            "\"c.start\"], \"at\": \"a\"}]}",
            n, 9800 * n);
        uniform_chain(n, 1.5, 9800.0 * n, 9.81);
        if (mech_must(t, mech_parse(t, text), NULL, "", &s)) {
            CHECK_INT(t, s.a->modes.n_rigid + s.a->modes.n_unstable + s.a->modes.n_undecided,
                      0);
            for (int k = 0; k < 3; k++) {
                check_mode(t, &s.a->modes, (double)mt_quad_eigenvalue(&exact, k), PROMISED);
            }
        }
        mech_free(&s);
    }
}

static void loaded__hundred_links_to_forty_digits(mt_test *t)
{
    uniform_chain(100, 1.5, 980000.0, 9.81);
    const double hz = sqrt((double)mt_quad_eigenvalue(&exact, 0)) / (2.0 * MECH_PI);
    CHECK_NEAR(t, hz, 0.610519973531, 1e-12);
}

static void cantilever(int n, double bending, double line_mass)
{
    static const int STIFF[4][4] = {
        {12, 6, -12, 6}, {6, 4, -6, 2}, {-12, -6, 12, -6}, {6, 2, -6, 4}};
    static const int MASS[4][4] = {
        {156, 22, 54, -13}, {22, 4, 13, -3}, {54, 13, 156, -22}, {-13, -3, -22, 4}};
    const mt_quad h = (mt_quad)1 / n;
    clear_exact(2 * n, 3);
    for (int e = 0; e < n; e++) {
        for (int i = 0; i < 4; i++) {
            for (int j = 0; j <= i; j++) {
                const int row = 2 * (e - 1) + i;
                const int col = 2 * (e - 1) + j;
                if (col >= 0) {
                    exact.k[row][row - col] += (mt_quad)bending / (h * h * h) * STIFF[i][j];
                    exact.m[row][row - col] += (mt_quad)line_mass * h / 420 * MASS[i][j];
                }
            }
        }
    }
}

static void loaded__preloaded_string_elsewhere_costs_a_strip_nothing(mt_test *t)
{
    static const int ELEMENTS[] = {4, 30, 90};
    for (int r = 0; r < MT_COUNT(ELEMENTS); r++) {
        char text[TEXT];
        mech s;
        const int n = ELEMENTS[r];
        mt_test_row(t, "%d elements", n);
        (void)snprintf(
            text, sizeof text,
            "{\"format\": \"modetune-model/1\", \"dimension\": 2,"
            "\"points\": {\"a\": [0, 0], \"b\": [1, 0]},"
            "\"links\": [{\"name\": \"strip\", \"kind\": \"beam\", \"from\": \"a\", \"to\": "
            "\"b\", \"elements\": %d, \"youngs_modulus_pa\": 2e11, \"density_kg_per_m3\": 8000,"
            "\"section\": {\"shape\": \"general\", \"area_m2\": 1e-5, \"second_moment_m4\": "
            "2e-13}}],"
            "\"bodies\": [{\"name\": \"bead\", \"mass_kg\": 0.2, \"centre\": [0, 3]}],"
            "\"springs\": [{\"name\": \"l\", \"type\": \"axial\", \"bodies\": [\"ground\", "
            "\"bead\"], \"at\": [[-0.5, 3], [0, 3]], \"stiffness_n_per_m\": 2000, "
            "\"preload_n\": 50},"
            "{\"name\": \"r\", \"type\": \"axial\", \"bodies\": [\"ground\", \"bead\"], "
            "\"at\": "
            "[[0.5, 3], [0, 3]], \"stiffness_n_per_m\": 2000, \"preload_n\": 50}],"
            "\"joints\": [{\"name\": \"wall\", \"type\": \"fixed\", \"bodies\": [\"ground\", "
            "\"strip.start\"], \"at\": \"a\"}]}",
            n);
        cantilever(n, 0.04, 0.08);
        if (mech_must(t, mech_parse(t, text), NULL, "", &s)) {
            CHECK_INT(t, s.a->modes.n_rigid + s.a->modes.n_unstable + s.a->modes.n_undecided,
                      0);
            for (int k = 0; k < 3; k++) {
                check_mode(t, &s.a->modes, (double)mt_quad_eigenvalue(&exact, k), PROMISED);
            }
            check_mode(t, &s.a->modes, 2.0 * 50.0 / 0.5 / 0.2, PROMISED); /* of the string */
            check_mode(t, &s.a->modes, 2.0 * 2000.0 / 0.2, PROMISED);
        }
        mech_free(&s);
    }
}

typedef struct links {
    int n;
    double length[LINKS];
    double mass[LINKS];
    double spring[LINKS]; /* n - 1 */
    double gravity;       /* negative: it stands */
} links;

static links draw(uint64_t seed)
{
    mt_random r = mt_random_seed(seed);
    const double decades = (double)(seed % 4) * 3.0;
    links s = {.n = 2 + mt_random_int(&r, LINKS - 2)};
    for (int i = 0; i < s.n; i++) {
        s.length[i] = 0.0625 * (1 + mt_random_int(&r, 16)); /* their sums round nothing */
        s.mass[i] = pow(10.0, mt_random_in(&r, -1.5, 1.5));
        s.spring[i] = pow(10.0, mt_random_in(&r, -1.0, decades));
    }
    s.gravity = seed % 2 == 0 ? 9.81 : -9.81;
    return s;
}

/* In the links' angles. */
static void exact_links(const links *s)
{
    clear_exact(s->n, s->n - 1);
    for (int i = 0; i < s->n; i++) {
        int at[LINKS];
        mt_quad f[LINKS];
        const mt_quad turn[2] = {1, -1};
        const mt_quad weight = (mt_quad)s->gravity * (mt_quad)s->mass[i];
        const mt_quad half = (mt_quad)s->length[i] / 2;
        for (int j = 0; j <= i; j++) {
            at[j] = j;
            f[j] = j < i ? (mt_quad)s->length[j] : half;
            mt_quad_add(exact.k, weight * f[j], 1, at + j, turn);
        }
        mt_quad_add(exact.m, (mt_quad)s->mass[i], i + 1, at, f);
        /* its own moment of inertia, m l^2/12 */
        mt_quad_add(exact.m, (mt_quad)s->mass[i] * half * half / 3, 1, at + i, turn);
        if (i > 0) {
            mt_quad_add(exact.k, (mt_quad)s->spring[i - 1], 2, at + i - 1, turn);
        }
    }
}

static mt_model *links_model(mt_test *t, const links *s)
{
    static char text[TEXT];
    double sum = 0.0;
    mt_writer w = {text, sizeof text, 0};
    mt_write(
        &w,
        "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"gravity_m_per_s2\": [0, "
        "-9.81], "
        "\"joints\": [{\"name\": \"pin\", \"type\": \"revolute\", \"bodies\": [\"ground\", "
        "\"c.start\"], \"at\": \"a\"}], \"links\": [{\"name\": \"c\", \"from\": \"a\", \"to\": "
        "\"b\", \"elements\": %d",
        s->n);
    const struct {
        const char *name;
        const double *x;
        int n;
    } lists[] = {{"element_length_m", s->length, s->n},
                 {"element_mass_kg", s->mass, s->n},
                 {"stiffness_n_m_per_rad", s->spring, s->n - 1}};
    for (int k = 0; k < MT_COUNT(lists); k++) {
        mt_write(&w, ", \"%s\": [", lists[k].name);
        for (int i = 0; i < lists[k].n; i++) {
            mt_write(&w, "%s%.17g", i > 0 ? ", " : "", lists[k].x[i]);
        }
        mt_write(&w, "]");
    }
    for (int i = 0; i < s->n; i++) {
        sum += s->length[i];
    }
    mt_write(&w, "}], \"points\": {\"a\": [0, 0], \"b\": [0, %.17g]}}",
             s->gravity > 0.0 ? -sum : sum);
    return mech_parse(t, text);
}

static void loaded__errors_of_random_chains_hold(mt_test *t)
{
    int unstable = 0;
    for (uint64_t seed = 1; seed <= 80; seed++) {
        const links s = draw(seed);
        mech m;
        mt_test_row(t, "seed %d, %d links, gravity %g", (int)seed, s.n, s.gravity);
        exact_links(&s);
        if (mech_must(t, links_model(t, &s), NULL, "", &m)) {
            const mt_modes *const modes = &m.a->modes;
            CHECK_INT(t, modes->count, s.n);
            for (int i = 0; i < s.n; i++) {
                const double want = (double)mt_quad_eigenvalue(&exact, i);
                CHECK_NEAR_ABS(t, modes->lambda[i], want, modes->error[i]);
                CHECK(t, modes->error[i] < 1e-6 * fabs(want));
                CHECK_INT(t, modes->kind[i], want < 0.0 ? MT_MODE_UNSTABLE : MT_MODE_FLEXIBLE);
                unstable += want < 0.0 ? 1 : 0;
            }
        }
        mech_free(&m);
    }
    CHECK(t, unstable > 20);
}

/* An arm and its counterweight, in equilibrium in every position: centre of both in the
 * pivot. */
typedef struct arm {
    int dimension;
    double pivot[3];
    double u[3]; /* along the arm */
    double axis[3];
    double m[2];
    double r[2];
    double k; /* of springs of a bead elsewhere; 0: none */
} arm;

static void unit(mt_random *r, int n, double *v)
{
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        v[i] = i < n ? mt_random_in(r, -1.0, 1.0) : 0.0;
        sum += v[i] * v[i];
    }
    for (int i = 0; i < 3; i++) {
        v[i] /= sqrt(sum);
    }
}

static arm draw_arm(uint64_t seed)
{
    mt_random r = mt_random_seed(seed);
    const double size = pow(10.0, mt_random_in(&r, -2.0, 1.0));
    static const double FAR[] = {0.0, 1.0, 30.0};
    arm a = {.dimension = seed % 3 == 0 ? 3 : 2};
    double other[3];
    unit(&r, a.dimension, a.u);
    unit(&r, a.dimension, other);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        a.pivot[i] = i < a.dimension ? size * FAR[seed % 3] * mt_random_in(&r, -1.0, 1.0) : 0.0;
        a.axis[i] = a.u[j] * other[k] - a.u[k] * other[j];
    }
    a.m[0] = pow(10.0, mt_random_in(&r, -2.0, 2.0));
    a.r[0] = size * mt_random_in(&r, 0.3, 1.0);
    a.r[1] = size * mt_random_in(&r, 0.3, 1.0);
    a.m[1] = a.m[0] * a.r[0] / a.r[1];
    a.k = seed % 5 < 2 ? pow(10.0, mt_random_in(&r, 2.0, 8.0)) : 0.0;
    return a;
}

static int put_point(char *text, size_t room, const arm *a, double along)
{
    return snprintf(text, room, a->dimension == 2 ? "[%.17g, %.17g]" : "[%.17g, %.17g, %.17g]",
                    a->pivot[0] + along * a->u[0], a->pivot[1] + along * a->u[1],
                    a->pivot[2] + along * a->u[2]);
}

static mt_model *arm_model(mt_test *t, const arm *a)
{
    static char text[TEXT];
    char at[3][120];
    char axis[120] = "";
    char bead[900] = "";
    (void)put_point(at[0], sizeof at[0], a, 0.0);
    (void)put_point(at[1], sizeof at[1], a, a->r[0]);
    (void)put_point(at[2], sizeof at[2], a, -a->r[1]);
    if (a->dimension == 3) {
        (void)snprintf(axis, sizeof axis, ", \"axis\": [%.17g, %.17g, %.17g]", a->axis[0],
                       a->axis[1], a->axis[2]);
    }
    if (a->k > 0.0) {
        const char *const z = a->dimension == 3 ? ", 0" : "";
        (void)snprintf(
            bead, sizeof bead,
            ", \"springs\": [{\"name\": \"l\", \"type\": \"axial\", \"bodies\": [\"ground\", "
            "\"bead\"], \"at\": [[-1, 0%s], [0, 0%s]], \"stiffness_n_per_m\": %.17g, "
            "\"preload_n\": 900}, {\"name\": \"r\", \"type\": \"axial\", \"bodies\": "
            "[\"ground\", "
            "\"bead\"], \"at\": [[1, 0%s], [0, 0%s]], \"stiffness_n_per_m\": %.17g, "
            "\"preload_n\": 900}]",
            z, z, a->k, z, z, a->k);
    }
    mt_writer w = {text, sizeof text, 0};
    mt_write(&w,
             "{\"format\": \"modetune-model/1\", \"dimension\": %d, "
             "\"gravity_m_per_s2\": %s, \"bodies\": [",
             a->dimension, a->dimension == 2 ? "[0, -9.81]" : "[0, 0, -9.81]");
    for (int i = 0; i < 2; i++) {
        char inertia[120];
        const double j = 0.1 * a->m[i] * a->r[i] * a->r[i];
        (void)snprintf(inertia, sizeof inertia,
                       a->dimension == 2 ? "%.17g" : "[%.17g, %.17g, %.17g]", j, j, j);
        mt_write(&w,
                 "{\"name\": \"b%d\", \"mass_kg\": %.17g, \"inertia_kg_m2\": %s, "
                 "\"centre\": %s}%s",
                 i, a->m[i], inertia, at[1 + i], i == 0 ? ", " : "");
    }
    if (a->k > 0.0) {
        mt_write(&w, ", {\"name\": \"bead\", \"mass_kg\": 0.2, \"centre\": %s}",
                 a->dimension == 2 ? "[0, 0]" : "[0, 0, 0]");
    }
    mt_write(&w,
             "], \"joints\": [{\"name\": \"pivot\", \"type\": \"revolute\", \"bodies\": "
             "[\"ground\", \"b0\"], \"at\": %s%s}, {\"name\": \"glue\", \"type\": "
             "\"fixed\", \"bodies\": [\"b0\", \"b1\"], \"at\": %s}]%s}",
             at[0], axis, at[0], bead);
    return mech_parse(t, text);
}

static void loaded__balanced_arms_are_neutral(mt_test *t)
{
    for (uint64_t seed = 1; seed <= 120; seed++) {
        const arm a = draw_arm(seed);
        mech m;
        mt_test_row(t, "seed %d, dimension %d, springs %g", (int)seed, a.dimension, a.k);
        if (mech_must(t, arm_model(t, &a), NULL, "", &m)) {
            CHECK_INT(t, m.a->modes.n_rigid, 1);
            CHECK_INT(t, m.a->modes.n_unstable + m.a->modes.n_undecided, 0);
            CHECK(t, m.a->modes.kind[0] == MT_MODE_RIGID_BODY && m.a->modes.lambda[0] == 0.0);
        }
        mech_free(&m);
    }
}

/* The same with a little weight too much on one side, up or down: no longer neutral. */
static void loaded__arms_out_of_balance_are_not_neutral(mt_test *t)
{
    static const double TOO_MUCH = 1e-7;
    for (uint64_t seed = 1; seed <= 60; seed++) {
        arm a = draw_arm(seed);
        mech m;
        const bool hangs = seed % 2 == 0;
        const double down[3] = {0.0, a.dimension == 2 ? -1.0 : 0.0,
                                a.dimension == 3 ? -1.0 : 0.0};
        mt_test_row(t, "seed %d, dimension %d, springs %g", (int)seed, a.dimension, a.k);
        memcpy(a.u, down, sizeof a.u);
        a.axis[0] = 1.0;
        a.axis[1] = 0.3;
        a.axis[2] = 0.0;
        a.m[0] *= hangs ? 1.0 + TOO_MUCH : 1.0 - TOO_MUCH;
        const double moment = 9.81 * (a.m[0] * a.r[0] - a.m[1] * a.r[1]);
        double inertia = 0.0;
        for (int i = 0; i < 2; i++) {
            inertia += 1.1 * a.m[i] * a.r[i] * a.r[i];
        }
        if (mech_must(t, arm_model(t, &a), NULL, "", &m)) {
            const mt_modes *const modes = &m.a->modes;
            CHECK_INT(t, modes->kind[0], hangs ? MT_MODE_FLEXIBLE : MT_MODE_UNSTABLE);
            CHECK_NEAR_ABS(t, modes->lambda[0], moment / inertia, modes->error[0]);
            CHECK_NEAR(t, modes->lambda[0], moment / inertia, 1e-5);
        }
        mech_free(&m);
    }
}

/* A link that stands on a torsional spring: at k = m g l/2 it is at its buckling load. Masses
 * and lengths are powers of two: nothing is rounded on the way. */
static void loaded__buckling_load_is_undecided(mt_test *t)
{
    static const struct {
        double part; /* of the buckling stiffness, beyond 1 */
        mt_mode_kind kind;
    } rows[] = {
        {0.0, MT_MODE_UNDECIDED},  {2e-16, MT_MODE_UNDECIDED}, {-2e-16, MT_MODE_UNDECIDED},
        {1e-10, MT_MODE_FLEXIBLE}, {-1e-10, MT_MODE_UNSTABLE},
    };
    for (int r = 0; r < MT_COUNT(rows); r++) {
        char text[TEXT];
        mech s;
        mt_test_row(t, "%g of the stiffness too much", rows[r].part);
        (void)snprintf(
            text, sizeof text,
            "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"gravity_m_per_s2\": [0, "
            "-8],"
            "\"bodies\": [{\"name\": \"rod\", \"mass_kg\": 1, \"inertia_kg_m2\": 1, "
            "\"centre\": "
            "[0, 1]}], \"joints\": [{\"name\": \"pin\", \"type\": \"revolute\", \"bodies\": "
            "[\"ground\", \"rod\"], \"at\": [0, 0]}], \"springs\": [{\"name\": \"k\", "
            "\"type\": "
            "\"torsion\", \"joint\": \"pin\", \"stiffness_n_m_per_rad\": %.17g}]}",
            8.0 * (1.0 + rows[r].part));
        if (mech_must(t, mech_parse(t, text), NULL, "", &s)) {
            const mt_modes *const modes = &s.a->modes;
            CHECK_INT(t, modes->kind[0], rows[r].kind);
            CHECK_NEAR_ABS(t, modes->lambda[0], 4.0 * rows[r].part, modes->error[0]);
            CHECK_INT(t, mt_modal_flexible(modes, 1),
                      rows[r].kind == MT_MODE_FLEXIBLE ? 0 : -1);
            CHECK_INT(t, modes->n_rigid, 0);
        }
        mech_free(&s);
    }
}

/* A weight on a stiff spring whose preload takes all but the weight back swings at g / L, L its
 * length there: the force that is left is the weight, not what a rounding of L makes of it. */
static void loaded__preload_that_all_but_cancels_costs_nothing(mt_test *t)
{
    static const double k = 2.86e7;
    static const double preload = -1.14e6;
    static const double g = 1.625;
    for (int i = 0; i < 8; i++) {
        char text[TEXT];
        mech s;
        const double m = 0.03 * (i + 1);
        (void)snprintf(text, TEXT,
                       "{\"format\": \"modetune-model/1\", \"dimension\": 2, "
                       "\"gravity_m_per_s2\": [0, %.17g], \"bodies\": [{\"name\": \"b\", "
                       "\"mass_kg\": %.17g, \"centre\": [0, -1]}], \"springs\": [{\"name\": "
                       "\"s\", \"type\": \"axial\", \"bodies\": [\"ground\", \"b\"], \"at\": "
                       "[[0, 0], [0, -1]], \"stiffness_n_per_m\": %.17g, \"preload_n\": "
                       "%.17g}]}",
                       -g, m, k, preload);
        mt_test_row(t, "%g kg", m);
        if (mech_must(t, mech_parse(t, text), NULL, "", &s)) {
            check_mode(t, &s.a->modes, g / (1.0 + (((m * g) - preload) / k)), FINE);
        }
        mech_free(&s);
    }
}

MT_TEST_MAIN(MT_TEST(loaded__hundred_links_to_forty_digits),
             MT_TEST(loaded__hanging_chain_of_stiff_links_swings),
             MT_TEST(loaded__preloaded_string_elsewhere_costs_a_strip_nothing),
             MT_TEST(loaded__preload_that_all_but_cancels_costs_nothing),
             MT_TEST(loaded__errors_of_random_chains_hold),
             MT_TEST(loaded__balanced_arms_are_neutral),
             MT_TEST(loaded__arms_out_of_balance_are_not_neutral),
             MT_TEST(loaded__buckling_load_is_undecided))
