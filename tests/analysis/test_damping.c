/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Damping of whole mechanisms: ratios come back, closed forms, derivatives against slopes. */
#include <float.h>

#include "analysis/damping.h"
#include "linalg/complex.h"
#include "mechanics/mech.h"
#include "support/mt_alloc.h"
#include "support/mt_slope.h"

static const double TOL = 1e-12;
/* Roots repeat to some n eps; equilibria are found to 1e-13. */
static const double NOISE = 3e-13;
static const double STEP = 3e-3; /* of each input's value */

static bool solve(mech *s, const double *x, bool gradient)
{
    mt_analysis_options opt = mt_analysis_options_default();
    opt.gradient = gradient;
    return mt_analysis_solve(s->a, x, &opt, &s->err) == MT_OK;
}

/* Complex modes at x; NULL where they fail. */
static const mt_damped_modes *damped_at(mech *s, const double *x, bool gradient)
{
    const mt_damped_modes *d = NULL;
    return solve(s, x, gradient) && mt_analysis_damped(s->a, &d, &s->err) == MT_OK ? d : NULL;
}

/* Of the i-th mode that oscillates, from 1. */
static double complex root(const mt_damped_modes *d, int i)
{
    const int at = d == NULL ? -1 : mt_damped_oscillating(d, i);
    return at < 0 ? mt_complex(nan(""), nan("")) : mt_complex(d->re[at], d->im[at]);
}

static double ratio(double complex s)
{
    return -creal(s) / cabs(s);
}

/* One mass of 2 kg guided along x by a spring of 50 N/m: members are filled in. */
#define ONE_MASS(type, spring, rest)                                                          \
    "{\"format\": \"modetune-model/1\", \"dimension\": 3, \"bodies\": [{\"name\": \"m\","     \
    " \"mass_kg\": 2, \"inertia_kg_m2\": [1, 1, 1], \"centre\": [0, 0, 0]}], \"joints\":"     \
    " [{\"name\": \"j\", \"type\": \"" type "\", \"bodies\": [\"ground\", \"m\"], \"at\":"    \
    " [0, 0, 0], \"axis\": [1, 0, 0]}], \"springs\": [{\"name\": \"s\", \"type\": \"axial\"," \
    " \"joint\": \"j\", \"stiffness_n_per_m\": 50" spring "}]" rest "}"

static void damping__one_mass_has_its_closed_forms(mt_test *t)
{
    static const double OMEGA = 5.0;
    static const struct {
        const char *name;
        const char *model;
        double c;
        double eta;
    } rows[] = {
        {"damper along a slide",
         ONE_MASS("prismatic", "",
                  ", \"dampers\": [{\"name\": \"d\", \"type\": \"axial\", \"joint\": \"j\","
                  " \"damping_n_s_per_m\": 3}]"),
         3.0, 0.0},
        {"along a cylinder",
         ONE_MASS("cylindrical", "",
                  ", \"dampers\": [{\"name\": \"d\", \"type\": \"axial\", \"joint\": \"j\","
                  " \"damping_n_s_per_m\": 3}, {\"name\": \"e\", \"type\": \"torsion\","
                  " \"joint\": \"j\", \"damping_n_m_s_per_rad\": 0}]"),
         3.0, 0.0},
        {"ratio", ONE_MASS("prismatic", "", ", \"damping\": {\"ratio\": 0.04}"),
         2.0 * 0.04 * 5.0 * 2.0, 0.0},
        {"ratios",
         ONE_MASS("prismatic", "", ", \"damping\": {\"ratio\": 9, \"ratios\": [0.04]}"),
         2.0 * 0.04 * 5.0 * 2.0, 0.0},
        {"proportional",
         ONE_MASS("prismatic", "",
                  ", \"damping\": {\"mass_per_s\": 0.3, \"stiffness_s\": 0.01}"),
         (0.3 * 2.0) + (0.01 * 50.0), 0.0},
        {"loss factor", ONE_MASS("prismatic", ", \"loss_factor\": 0.2", ""), 0.0, 0.2},
        {"everything",
         ONE_MASS("prismatic", ", \"loss_factor\": 0.2",
                  ", \"damping\": {\"ratio\": 0.04, \"mass_per_s\": 0.3},"
                  " \"dampers\": [{\"name\": \"d\", \"type\": \"axial\", \"joint\": \"j\","
                  " \"damping_n_s_per_m\": 1}]"),
         1.0 + 0.8 + 0.6, 0.2},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mech s;
        mt_test_row(t, "%s", rows[i].name);
        if (mech_must(t, mech_parse(t, rows[i].model), NULL, "", &s)) {
            const double complex under =
                csqrt(mt_complex((rows[i].c * rows[i].c) - 400.0, -400.0 * rows[i].eta));
            const double complex want =
                ((cimag(under) > 0.0 ? under : -under) - rows[i].c) / 4.0;
            const double complex got = root(damped_at(&s, s.at, false), 1);
            CHECK_NEAR_ABS(t, cabs(got - want), 0.0, TOL * OMEGA);
        }
        mech_free(&s);
    }
}

/* A pin in a slot of a frame that turns with the body that has it; the same in the plane. */
static void damping__acts_along_a_slot_in_the_plane(mt_test *t)
{
    static const char *const model =
        "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"bodies\": [{\"name\": \"m\","
        " \"mass_kg\": 2, \"centre\": [1, 2]}], \"joints\": [{\"name\": \"j\","
        " \"type\": \"pin-in-slot\", \"bodies\": [\"ground\", \"m\"], \"at\": [1, 2],"
        " \"axis\": [3, 4]}], \"springs\": [{\"name\": \"s\", \"type\": \"axial\","
        " \"joint\": \"j\", \"stiffness_n_per_m\": 50, \"preload_n\": 20}],"
        " \"dampers\": [{\"name\": \"d\", \"type\": \"axial\", \"joint\": \"j\","
        " \"damping_n_s_per_m\": 3}]}";
    mech s;
    if (mech_must(t, mech_parse(t, model), NULL, "", &s)) {
        const double complex got = root(damped_at(&s, s.at, false), 1);
        CHECK_NEAR(t, cabs(got), 5.0, TOL);
        CHECK_NEAR(t, ratio(got), 3.0 / (2.0 * 2.0 * 5.0), TOL);
        /* the preload draws it back against the axis by 20/50 m */
        CHECK_NEAR(t, creal(mt_linear_position(s.a->lin)->at.pose[0].x[0]), 1.0 - (0.4 * 0.6),
                   TOL);
        CHECK_NEAR(t, creal(mt_linear_position(s.a->lin)->at.pose[0].x[1]), 2.0 - (0.4 * 0.8),
                   TOL);
    }
    mech_free(&s);
}

/* Modal ratios come back exactly, of a mechanism with loops under load; C is symmetric. */
static void damping__ratios_come_back(mt_test *t)
{
    static const char *const model =
        "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"gravity_m_per_s2\": [0, -9.81],"
        " \"bodies\": [{\"name\": \"m\", \"mass_kg\": 2, \"inertia_kg_m2\": 0.1,"
        " \"centre\": [1.2, 0.1]}],"
        " \"links\": [{\"name\": \"l\", \"kind\": \"beam\", \"from\": [0, 0], \"to\": [1, 0],"
        " \"elements\": 4, \"mass_kg\": 1, \"youngs_modulus_pa\": 2e11, \"section\":"
        " {\"shape\": \"circle\", \"diameter_m\": 0.01}}],"
        " \"joints\": [{\"name\": \"a\", \"type\": \"fixed\", \"bodies\":"
        " [\"ground\", \"l.start\"], \"at\": [0, 0]}, {\"name\": \"b\", \"type\": \"revolute\","
        " \"bodies\": [\"l.end\", \"m\"], \"at\": [1, 0]}],"
        " \"springs\": [{\"name\": \"s\", \"type\": \"torsion\", \"joint\": \"b\","
        " \"stiffness_n_m_per_rad\": 90}],"
        " \"modes\": {\"second\": {\"configuration\": \"by_name\", \"index\": 2}},"
        " \"damping\": {\"ratio\": 0.03}, \"configurations\": {\"by_all\": {}, \"by_index\":"
        " {\"damping\": {\"ratio\": 0.02, \"ratios\": [0.05, 0.001, 0.3]}}, \"by_name\":"
        " {\"damping\": {\"ratios\": [0.05, 0.4], \"modes\": {\"second\": 0.2}}},"
        " \"like_index\": {\"like\": \"by_index\"}}}";
    static const char *const names[] = {"by_all", "by_index", "by_name", "like_index"};
    static const double first[4][3] = {
        {0.03, 0.03, 0.03}, {0.05, 0.001, 0.3}, {0.05, 0.2, 0.0}, {0.05, 0.001, 0.3}};
    static const double others[] = {0.03, 0.02, 0.0, 0.02};
    for (int c = 0; c < MT_COUNT(names); c++) {
        mech s;
        mt_test_row(t, "%s", names[c]);
        if (mech_must(t, mech_parse(t, model), names[c], "", &s)) {
            const mt_damped_modes *const d = damped_at(&s, s.at, false);
            const mt_modes *const m = &s.a->modes;
            CHECK(t, m->count >= 10);
            for (int i = 1; i <= m->count && CHECK(t, d != NULL); i++) {
                const double want = i <= 3 ? first[c][i - 1] : others[c];
                const double complex got = root(d, i);
                const double omega = sqrt(m->lambda[i - 1]);
                mt_test_row(t, "%s, mode %d", names[c], i);
                CHECK_NEAR_ABS(t, ratio(got), want, TOL);
                CHECK_NEAR(t, cabs(got), omega, 1e-10);
            }
        }
        mech_free(&s);
    }
}

/* alpha M + beta K with the tangent stiffness, gravity and a settled position included. */
static void damping__proportional_damping_takes_the_tangent_stiffness(mt_test *t)
{
    static const char *const rest =
        "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"gravity_m_per_s2\": [0, -9.81],"
        " \"bodies\": [{\"name\": \"rod\", \"mass_kg\": 2, \"inertia_kg_m2\": 0.1,"
        " \"centre\": [0, -1]}, {\"name\": \"bob\", \"mass_kg\": 1, \"inertia_kg_m2\": 0.3,"
        " \"centre\": [0.2, -2]}], \"joints\": [{\"name\": \"a\", \"type\": \"revolute\","
        " \"bodies\": [\"ground\", \"rod\"], \"at\": [0, 0]}, {\"name\": \"b\","
        " \"type\": \"revolute\", \"bodies\": [\"rod\", \"bob\"], \"at\": [0, -1.5]}],"
        " \"damping\": {\"mass_per_s\": 0.2, \"stiffness_s\": 0.01}}";
    mech s;
    if (mech_must(t, mech_parse(t, rest), NULL, "", &s)) {
        const mt_damped_modes *const d = damped_at(&s, s.at, false);
        for (int i = 1; i <= 2; i++) {
            const double omega = sqrt(s.a->modes.lambda[i - 1]);
            CHECK_NEAR(t, ratio(root(d, i)), (0.1 / omega) + (0.005 * omega), 1e-10);
        }
    }
    mech_free(&s);
}

/* Every spring of a kind with one loss factor: s = i omega sqrt(1 + i eta) for all modes. */
static void damping__one_loss_factor_for_every_kind_of_spring(mt_test *t)
{
    static const double ETA = 0.11;
    static const struct {
        const char *name;
        const char *model;
    } rows[] = {
        {"rigid elements",
         "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"links\": [{\"name\": \"l\","
         " \"from\": [0, 0], \"to\": [1, 0], \"elements\": 6, \"mass_kg\": 1,"
         " \"stiffness_n_m_per_rad\": 20, \"loss_factor\": 0.11}], \"joints\": [{\"name\": "
         "\"j\","
         " \"type\": \"fixed\", \"bodies\": [\"ground\", \"l.start\"], \"at\": [0, 0]}]}"},
        {"Timoshenko's beam in space",
         "{\"format\": \"modetune-model/1\", \"dimension\": 3, \"links\": [{\"name\": \"l\","
         " \"kind\": \"beam\", \"from\": [0, 0, 0], \"to\": [1, 1, 0], \"elements\": 3,"
         " \"density_kg_per_m3\": 7850, \"youngs_modulus_pa\": 2e11, \"shear_modulus_pa\": "
         "8e10,"
         " \"shear\": {\"coefficient\": 0.83}, \"hinge_axis\": [0, 0, 1], \"section\":"
         " {\"shape\": \"rectangle\", \"width_m\": 0.02, \"height_m\": 0.01},"
         " \"loss_factor\": 0.11}], \"joints\": [{\"name\": \"j\", \"type\": \"fixed\","
         " \"bodies\": [\"ground\", \"l.start\"], \"at\": [0, 0, 0]}]}"},
        {"bushing with couplings",
         "{\"format\": \"modetune-model/1\", \"dimension\": 3, \"bodies\": [{\"name\": \"b\","
         " \"mass_kg\": 1, \"inertia_kg_m2\": [1, 2, 3], \"centre\": [0.1, 0, 0.3]}],"
         " \"springs\": [{\"name\": \"s\", \"type\": \"bushing\", \"bodies\":"
         " [\"ground\", \"b\"], \"at\": [0, 0, 0], \"loss_factor\": 0.11, \"stiffness_matrix\":"
         " [[900, 10, 0, 0, 30, 0], [10, 800, 0, -20, 0, 0], [0, 0, 700, 0, 0, 5],"
         " [0, -20, 0, 400, 0, 0], [30, 0, 0, 0, 300, 2], [0, 0, 5, 0, 2, 200]]}]}"},
        {"bar and torsion",
         "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"bodies\": [{\"name\": \"b\","
         " \"mass_kg\": 1, \"inertia_kg_m2\": 0.2, \"centre\": [1, 0]}], \"springs\":"
         " [{\"name\": \"p\", \"type\": \"bar\", \"bodies\": [\"ground\", \"b\"], \"at\":"
         " [[0, 0], [1, 0]], \"youngs_modulus_pa\": 2e9, \"area_m2\": 1e-5,"
         " \"density_kg_per_m3\": 1000, \"loss_factor\": 0.11}, {\"name\": \"q\", \"type\":"
         " \"bar\", \"bodies\": [\"ground\", \"b\"], \"at\": [[0, 1], [1, 0]],"
         " \"youngs_modulus_pa\": 2e9, \"area_m2\": 1e-5, \"loss_factor\": \"0.1 + 0.01\"},"
         " {\"name\": \"r\", \"type\": \"torsion\", \"bodies\": [\"ground\", \"b\"],"
         " \"stiffness_n_m_per_rad\": 30, \"loss_factor\": 0.11}]}"},
    };
    for (int r = 0; r < MT_COUNT(rows); r++) {
        mech s;
        mt_test_row(t, "%s", rows[r].name);
        if (mech_must(t, mech_parse(t, rows[r].model), NULL, "", &s)) {
            const mt_damped_modes *const d = damped_at(&s, s.at, false);
            CHECK(t, d != NULL && d->count == s.a->modes.count);
            for (int i = 1; i <= s.a->modes.count; i++) {
                const double complex want = mt_complex(0.0, sqrt(s.a->modes.lambda[i - 1])) *
                                            csqrt(mt_complex(1.0, ETA));
                CHECK_NEAR_ABS(t, cabs(root(d, i) - want), 0.0, 1e-10 * cabs(want));
            }
        }
        mech_free(&s);
    }
}

typedef struct probe {
    mech *s;
    int mode;
    int part; /* 0 Re, 1 Im of s, relative to |s| of the design that is looked at */
    double size;
} probe;

static double quantity(const void *context, int n, const double *x)
{
    const probe *const p = context;
    (void)n;
    const double complex s = root(damped_at(p->s, x, false), p->mode);
    return 2.0 + ((p->part == 0 ? creal(s) : cimag(s)) / p->size);
}

static void check_roots(mt_test *t, mech *s, const char *name, int modes)
{
    double dre[MECH_INPUTS];
    double dim[MECH_INPUTS];
    double x[MECH_INPUTS];
    for (int mode = 1; mode <= modes; mode++) {
        memcpy(x, s->at, sizeof x);
        const mt_damped_modes *const d = damped_at(s, x, true);
        const int at = d == NULL ? -1 : mt_damped_oscillating(d, mode);
        bool repeated = true;
        if (!CHECK(t, at >= 0) ||
            !CHECK(t, mt_analysis_dpole(s->a, at, dre, dim, &repeated, &s->err) == MT_OK)) {
            (void)fprintf(stderr, "%s\n", s->err.text);
            return;
        }
        CHECK(t, !repeated);
        const double size = hypot(d->re[at], d->im[at]);
        for (int i = 0; i < s->n; i++) {
            for (int part = 0; part < 2; part++) {
                const probe p = {s, mode, part, size};
                const double slope = (part == 0 ? dre[i] : dim[i]) / size;
                const double step = STEP * (x[i] == 0.0 ? 1.0 : fabs(x[i]));
                mt_test_row(t, "%s, mode %d, input %d, part %d", name, mode, i, part);
                CHECK(t, mt_slope_agrees(quantity, &p, s->n, x, i, slope, step, NOISE));
            }
        }
    }
}

/* Loops that close elsewhere, gravity, a driven position, moving axes; dampers, loss factors,
 * ratios by index, by name and for all, proportional damping with coefficients that vary. */
static void damping__roots_have_exact_derivatives(mt_test *t)
{
    static const char *const names[] = {"dampers", "all", "still", "named", "driven"};
    for (int c = 0; c < MT_COUNT(names); c++) {
        mech s;
        if (mech_must(t, mech_load(t, "damped_linkage"), names[c],
                      "a k m_c alpha c eta zeta rate lag", &s)) {
            check_roots(t, &s, names[c], 4);
        }
        mech_free(&s);
    }
}

/* Masses of 1 kg in a row on springs k1 and 2 N/m to the ground, c between them. */
#define TWO(k1, c, z1, z2, damping)                                                           \
    "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"parameters\": {\"k1\": " k1       \
    ", \"m\": 1, \"c\": " c ", \"z1\": " z1 ", \"z2\": " z2                                   \
    "}, \"bodies\": [{\"name\": \"p\","                                                       \
    " \"mass_kg\": \"m\", \"centre\": [1, 0]}, {\"name\": \"q\", \"mass_kg\": 1, \"centre\":" \
    " [2, 0]}], \"joints\": [{\"name\": \"a\", \"type\": \"pin-in-slot\", \"bodies\":"        \
    " [\"ground\", \"p\"], \"at\": [1, 0], \"axis\": [1, 0]}, {\"name\": \"b\", \"type\":"    \
    " \"pin-in-slot\", \"bodies\": [\"ground\", \"q\"], \"at\": [2, 0], \"axis\": [1, 0]}],"  \
    " \"springs\": [{\"name\": \"s\", \"type\": \"axial\", \"joint\": \"a\","                 \
    " \"stiffness_n_per_m\": \"k1\"}, {\"name\": \"u\", \"type\": \"axial\", \"joint\": "     \
    "\"b\","                                                                                  \
    " \"stiffness_n_per_m\": 2}, {\"name\": \"v\", \"type\": \"axial\", \"bodies\":"          \
    " [\"p\", \"q\"], \"at\": [[1, 0], [2, 0]], \"stiffness_n_per_m\": \"c\"}],"              \
    " \"modes\": {\"left\": {\"configuration\": \"default\", \"index\": 1}},"                 \
    " \"damping\": {" damping "}, \"configurations\": {\"default\": {}}}"

/* An entry of C (n 2) over its size. */
typedef struct entry {
    mech *s;
    int at;
    double size;
} entry;

static double entry_of(const void *context, int n, const double *x)
{
    const entry *const e = context;
    double c[4];
    (void)n;
    return solve(e->s, x, false) &&
                   mt_analysis_damping(e->s->a, c, NULL, NULL, &e->s->err) == MT_OK
               ? 2.0 + (c[e->at] / e->size)
               : nan("");
}

/* C of modal ratios by itself, column by column, where no geometry moves the freedoms. */
static void damping__matrices_have_exact_derivatives(mt_test *t)
{
    static const struct {
        const char *name;
        const char *model;
    } rows[] = {
        {"one ratio", TWO("1.3", "0.4", "0.05", "0.1", "\"ratio\": \"z1\"")},
        {"two ratios", TWO("1.3", "0.4", "0.05", "0.1", "\"ratios\": [\"z1\", \"z2\"]")},
        {"one mode alone", TWO("1.3", "0.4", "0.05", "0.1", "\"modes\": {\"left\": \"z1\"}")},
        {"all of it", TWO("1.3", "0.4", "0.05", "0.1",
                          "\"ratio\": \"z1\", \"modes\": {\"left\": \"z2\"},"
                          " \"mass_per_s\": \"z1*z2\", \"stiffness_s\": \"z1^2\"")},
        {"equal frequencies, one ratio", TWO("2", "0", "0.05", "0.1", "\"ratio\": \"z1\"")},
    };
    static const double unit[4] = {1.0, 0.0, 0.0, 1.0};
    for (int r = 0; r < MT_COUNT(rows); r++) {
        mech s;
        double dc[4];
        double dh[4];
        double c[4];
        double x[MECH_INPUTS];
        const bool apart = r < 4; /* c has no slope to either side of 0 that differs */
        if (!mech_must(t, mech_parse(t, rows[r].model), NULL,
                       apart ? "k1 m c z1 z2" : "k1 m z1", &s)) {
            continue;
        }
        memcpy(x, s.at, sizeof x);
        for (int i = 0; i < s.n; i++) {
            CHECK(t, solve(&s, x, true));
            CHECK(t, mt_analysis_damping(s.a, c, NULL, NULL, &s.err) == MT_OK);
            CHECK(t, mt_analysis_damping_products(s.a, i, 2, unit, dc, dh, &s.err) == MT_OK);
            const double size = fabs(c[0]) + fabs(c[3]);
            CHECK_NEAR_ABS(t, c[1], c[2], TOL * size);
            CHECK_NEAR_ABS(t, dc[1], dc[2], TOL * size / x[i]);
            for (int k = 0; k < 4; k++) {
                const entry e = {&s, k, size};
                mt_test_row(t, "%s, input %d, entry %d", rows[r].name, i, k);
                CHECK_NEAR_ABS(t, dh[k], 0.0, 0.0);
                CHECK(t, mt_slope_agrees(entry_of, &e, s.n, x, i, dc[k] / size, STEP * x[i],
                                         NOISE));
            }
        }
        mech_free(&s);
    }
}

static void damping__equal_frequencies_with_different_ratios_have_none(mt_test *t)
{
    static const double unit[4] = {1.0, 0.0, 0.0, 1.0};
    double dc[4];
    double dh[4];
    mech s;
    if (mech_must(t,
                  mech_parse(t, TWO("2", "0", "0.05", "0.1", "\"ratios\": [\"z1\", \"z2\"]")),
                  NULL, "c", &s) &&
        CHECK(t, solve(&s, s.at, true))) {
        CHECK(t, mt_analysis_damping_products(s.a, 0, 2, unit, dc, dh, &s.err) == MT_OK);
        CHECK(t, isnan(dc[0]) || isnan(dc[1]));
    }
    mech_free(&s);
    if (mech_must(t,
                  mech_parse(t, TWO("2", "0", "0.05", "0.05", "\"ratios\": [\"z1\", \"z2\"]")),
                  NULL, "z1", &s) &&
        CHECK(t, solve(&s, s.at, true))) {
        CHECK(t, mt_analysis_damping_products(s.a, 0, 2, unit, dc, dh, &s.err) == MT_OK);
        CHECK(t, isnan(dc[0]) || isnan(dc[1]));
    }
    mech_free(&s);
}

static void damping__repeated_roots_have_no_derivative_and_say_so(mt_test *t)
{
    const mt_damped_modes *d = NULL;
    double dre[MECH_INPUTS];
    double dim[MECH_INPUTS];
    bool repeated = false;
    mech s;
    if (mech_must(t, mech_parse(t, TWO("2", "0", "0.05", "0.1", "\"ratio\": \"z1\"")), NULL,
                  "k1", &s) &&
        CHECK(t, (d = damped_at(&s, s.at, true)) != NULL)) {
        CHECK(t, mt_analysis_dpole(s.a, 0, dre, dim, &repeated, &s.err) == MT_OK);
        CHECK(t, repeated && isnan(dre[0]) && isnan(dim[0]));
    }
    mech_free(&s);
}

/* The lighter spring is named; past 2 N/m its mode is the second, and its ratio goes with it.
 * */
static void damping__a_name_keeps_its_ratio(mt_test *t)
{
    static const double stiffness[] = {0.5, 1.0, 1.9, 2.1, 5.0};
    mech s;
    if (mech_must(t,
                  mech_parse(t, TWO("1", "0", "0.05", "0.1",
                                    "\"ratio\": \"z2\", \"modes\": {\"left\": \"z1\"}")),
                  NULL, "k1", &s)) {
        for (int i = 0; i < MT_COUNT(stiffness); i++) {
            const double x[1] = {stiffness[i]};
            const mt_damped_modes *const d = damped_at(&s, x, false);
            mt_test_row(t, "%g N/m", x[0]);
            for (int k = 1; k <= 2; k++) {
                const double complex got = root(d, k);
                const bool left = fabs(cabs(got) - sqrt(x[0])) < 1e-6;
                CHECK_NEAR(t, ratio(got), left ? 0.05 : 0.1, TOL);
            }
        }
    }
    mech_free(&s);
}

static void damping__ratios_of_no_mode_are_refused(mt_test *t)
{
    static const struct {
        const char *name;
        const char *model;
        mt_status rc;
        const char *says;
    } rows[] = {
        {"too many", TWO("1", "0", "0.05", "0.1", "\"ratios\": [0.1, 0.1, 0.1]"), MT_E_INPUT,
         "ratios for 3 vibration modes"},
        {"unstable", TWO("-1", "0", "0.05", "0.1", "\"ratios\": [0.1]"), MT_E_DOMAIN,
         "unstable"},
        {"unstable, ratio for all", TWO("-1", "0", "0.05", "0.1", "\"ratio\": 0.1"), MT_OK, ""},
    };
    for (int r = 0; r < MT_COUNT(rows); r++) {
        mech s;
        double c[4];
        mt_test_row(t, "%s", rows[r].name);
        if (mech_must(t, mech_parse(t, rows[r].model), NULL, "", &s)) {
            CHECK_INT(t, mt_analysis_damping(s.a, c, NULL, NULL, &s.err), rows[r].rc);
            CHECK(t, strstr(s.err.text, rows[r].says) != NULL);
        }
        mech_free(&s);
    }
}

static void damping__failing_allocations_are_errors(mt_test *t)
{
    mech s;
    if (mech_must(t, mech_load(t, "damped_linkage"), "named", "a k eta zeta", &s)) {
        for (long nth = 0; mt_alloc_works(); nth++) {
            const mt_damped_modes *d = NULL;
            double dre[MECH_INPUTS];
            double dim[MECH_INPUTS];
            if (!CHECK(t, solve(&s, s.at, true))) {
                break;
            }
            mt_arena_free(&s.a->damping_mem); /* what it has kept */
            mt_alloc_fail_after(nth);
            mt_status rc = mt_analysis_damped(s.a, &d, &s.err);
            rc = rc == MT_OK ? mt_analysis_dpole(s.a, 0, dre, dim, NULL, &s.err) : rc;
            mt_alloc_fail_after(-1);
            CHECK(t, rc == MT_OK || rc == MT_E_MEMORY);
            if (rc == MT_OK) {
                break;
            }
        }
    }
    mech_free(&s);
}

MT_TEST_MAIN(MT_TEST(damping__one_mass_has_its_closed_forms),
             MT_TEST(damping__acts_along_a_slot_in_the_plane),
             MT_TEST(damping__ratios_come_back),
             MT_TEST(damping__proportional_damping_takes_the_tangent_stiffness),
             MT_TEST(damping__one_loss_factor_for_every_kind_of_spring),
             MT_TEST(damping__roots_have_exact_derivatives),
             MT_TEST(damping__matrices_have_exact_derivatives),
             MT_TEST(damping__equal_frequencies_with_different_ratios_have_none),
             MT_TEST(damping__repeated_roots_have_no_derivative_and_say_so),
             MT_TEST(damping__a_name_keeps_its_ratio),
             MT_TEST(damping__ratios_of_no_mode_are_refused),
             MT_TEST(damping__failing_allocations_are_errors))
