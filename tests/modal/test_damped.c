/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Damped modes against closed forms, characteristic polynomials and the undamped limit. */
#include <complex.h>

#include "linalg/complex.h"
#include "mechanics/mech.h"
#include "modal/damped.h"
#include "support/mt_alloc.h"

static const double TWO_PI = 2.0 * 3.14159265358979323846;
/* Rounding of a few well-scaled freedoms. */
static const double TOL = 1e-12;
/* A residual of this many n eps is not perfect, but rounding. */
static const double RESIDUAL = 20.0;

/* Masses on a line; springs[i] before mass i, springs[n] behind the last one, to walls at both
 * ends. */
static void chain_matrices(int n, const double *springs, const double *masses, double *k,
                           double *m)
{
    memset(k, 0, (size_t)n * (size_t)n * sizeof *k);
    memset(m, 0, (size_t)n * (size_t)n * sizeof *m);
    for (int i = 0; i < n; i++) {
        m[i + i * n] = masses[i];
        k[i + i * n] = springs[i] + springs[i + 1];
        if (i > 0) {
            k[i + (i - 1) * n] = -springs[i];
            k[(i - 1) + i * n] = -springs[i];
        }
    }
}

typedef struct damped {
    mt_arena mem;
    mt_mass_factor mass;
    mt_modes modes;
    mt_damped_modes d;
    mt_err err;
} damped;

/* With structural damping h; NULL: none. */
static bool structural_solve(mt_test *t, int n, const double *k, const double *c,
                             const double *h, const double *m, damped *s)
{
    *s = (damped){.err.text = ""};
    const mt_damped_problem p = {
        .n = n, .k = k, .c = c, .h = h, .mass = &s->mass, .modes = &s->modes};
    mt_status rc = mt_arena_init(&s->mem, 0, &s->err);
    rc = rc == MT_OK ? mt_modal_factor_mass(n, m, &s->mem, &s->mass, &s->err) : rc;
    rc =
        rc == MT_OK ? mt_modal_solve(k, &s->mass, NULL, NULL, &s->mem, &s->modes, &s->err) : rc;
    rc = rc == MT_OK ? mt_modal_damped(&p, &s->mem, &s->d, &s->err) : rc;
    if (!CHECK(t, rc == MT_OK)) {
        (void)fprintf(stderr, "%s\n", s->err.text);
        return false;
    }
    for (int i = 0; i < s->d.count; i++) {
        CHECK(t, s->d.residual[i] <= RESIDUAL);
    }
    return true;
}

static bool damped_solve(mt_test *t, int n, const double *k, const double *c, const double *m,
                         damped *s)
{
    return structural_solve(t, n, k, c, NULL, m, s);
}

static double complex root(const damped *s, int i)
{
    return mt_complex(s->d.re[i], s->d.im[i]);
}

static void expect(mt_test *t, const damped *s, int i, mt_damped_kind kind, double re,
                   double im)
{
    const double size = hypot(re, im);
    REQUIRE(t, i < s->d.count);
    CHECK_INT(t, s->d.kind[i], kind);
    CHECK_NEAR_ABS(t, s->d.re[i], re, TOL * size);
    CHECK_NEAR_ABS(t, s->d.im[i], im, TOL * size);
}

static void damped__single_mass_has_its_closed_form(mt_test *t)
{
    static const struct {
        const char *name;
        double m;
        double c;
        double k;
    } rows[] = {
        {"undamped", 2.0, 0.0, 50.0},
        {"light", 2.0, 1e-9, 50.0},
        {"usual", 2.0, 3.0, 50.0},
        {"nearly critical", 2.0, 19.9, 50.0},
        {"over", 2.0, 25.0, 50.0},
        {"heavily over", 2.0, 2e4, 50.0},
        {"negative damping", 2.0, -3.0, 50.0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        damped s;
        mt_test_row(t, "%s", rows[i].name);
        if (damped_solve(t, 1, &rows[i].k, &rows[i].c, &rows[i].m, &s)) {
            const double omega = sqrt(rows[i].k / rows[i].m);
            const double zeta = rows[i].c / (2.0 * rows[i].m * omega);
            if (zeta < 1.0) {
                CHECK_INT(t, s.d.count, 1);
                expect(t, &s, 0, zeta < 0.0 ? MT_DAMPED_UNSTABLE : MT_DAMPED_OSCILLATING,
                       -zeta * omega, omega * sqrt(1.0 - zeta * zeta));
                CHECK_NEAR(t, mt_damped_natural_hz(&s.d, 0), omega / TWO_PI, TOL);
                CHECK_NEAR_ABS(t, mt_damped_ratio(&s.d, 0), zeta, TOL);
            } else {
                const double fast = -omega * (zeta + sqrt(zeta * zeta - 1.0));
                CHECK_INT(t, s.d.count, 2);
                expect(t, &s, 1, MT_DAMPED_OVERDAMPED, fast, 0.0);
                expect(t, &s, 0, MT_DAMPED_OVERDAMPED, omega * omega / fast, 0.0);
                CHECK_NEAR(t, mt_damped_ratio(&s.d, 0), 1.0, TOL);
            }
        }
        mt_arena_free(&s.mem);
    }
}

static void damped__without_damping_meets_the_modal_solve(mt_test *t)
{
    enum { N = 6 };
    double k[N * N];
    double m[N * N];
    double c[N * N] = {0.0};
    double masses[N];
    double springs[N + 1];
    damped s;
    for (int i = 0; i < N; i++) {
        masses[i] = 1.0 + 0.3 * i;
        springs[i] = 100.0 / (1.0 + i);
    }
    springs[0] = 0.0; /* free */
    springs[N] = 0.0;
    chain_matrices(N, springs, masses, k, m);
    if (damped_solve(t, N, k, c, m, &s)) {
        CHECK_INT(t, s.d.count, N);
        CHECK_INT(t, s.d.kind[0], MT_DAMPED_RIGID_BODY);
        for (int i = 1; i < N; i++) {
            CHECK_INT(t, s.d.kind[i], MT_DAMPED_OSCILLATING);
            CHECK_NEAR(t, mt_damped_hz(&s.d, i), mt_modal_hz(&s.modes, i), 10.0 * TOL);
            CHECK_NEAR_ABS(t, mt_damped_ratio(&s.d, i), 0.0, 10.0 * TOL);
        }
    }
    mt_arena_free(&s.mem);
}

static void damped__proportional_damping_keeps_each_mode(mt_test *t)
{
    enum { N = 5 };
    const double alpha = 0.4;
    const double beta = 0.01;
    double k[N * N];
    double m[N * N];
    double c[N * N];
    const double masses[N] = {1.0, 2.0, 1.0, 3.0, 1.0};
    const double springs[N + 1] = {300.0, 200.0, 100.0, 50.0, 100.0, 20.0};
    damped s;
    chain_matrices(N, springs, masses, k, m);
    for (int i = 0; i < N * N; i++) {
        c[i] = alpha * m[i] + beta * k[i];
    }
    if (damped_solve(t, N, k, c, m, &s)) {
        CHECK_INT(t, s.d.count, N);
        for (int i = 0; i < N; i++) {
            const double omega = sqrt(s.modes.lambda[i]);
            mt_test_row(t, "mode %d", i + 1);
            CHECK_NEAR(t, mt_damped_natural_hz(&s.d, i), omega / TWO_PI, 10.0 * TOL);
            CHECK_NEAR(t, mt_damped_ratio(&s.d, i), 0.5 * (alpha / omega + beta * omega),
                       10.0 * TOL);
        }
    }
    mt_arena_free(&s.mem);
}

static void damped__rigid_body_pairs_stand_apart(mt_test *t)
{
    /* two masses, spring and damper between them; the second row also drags on the ground */
    const double k[4] = {100.0, -100.0, -100.0, 100.0};
    const double m[4] = {1.0, 0.0, 0.0, 4.0};
    const double c[2][4] = {{1.0, -1.0, -1.0, 1.0}, {1.0, -1.0, -1.0, 1.5}};
    damped s;
    if (damped_solve(t, 2, k, c[0], m, &s)) {
        CHECK_INT(t, s.d.count, 2);
        expect(t, &s, 0, MT_DAMPED_RIGID_BODY, 0.0, 0.0);
        expect(t, &s, 1, MT_DAMPED_OSCILLATING, -0.625, sqrt(125.0 - 0.625 * 0.625));
        CHECK(t, isnan(mt_damped_ratio(&s.d, 0)));
    }
    mt_arena_free(&s.mem);
    if (damped_solve(t, 2, k, c[1], m, &s)) {
        CHECK_INT(t, s.d.count, 3);
        expect(t, &s, 0, MT_DAMPED_RIGID_BODY, 0.0, 0.0);
        CHECK_INT(t, s.d.kind[1], MT_DAMPED_OVERDAMPED);
        CHECK_INT(t, s.d.kind[2], MT_DAMPED_OSCILLATING);
        for (int i = 0; i < 3; i++) { /* det(s^2 M + s C + K) / s */
            const double complex x = root(&s, i);
            const double complex det = (x * x + x + 100.0) * (4.0 * x * x + 1.5 * x + 100.0) -
                                       (x + 100.0) * (x + 100.0);
            mt_test_row(t, "root %d", i);
            CHECK_NEAR_ABS(t, cabs(det), 0.0, TOL * 1e4);
        }
    }
    mt_arena_free(&s.mem);
}

static void damped__spring_and_damper_in_a_row_need_no_mass_between(mt_test *t)
{
    /* ground - k0 - mass, and mass - k1 - node - c - ground: (m s^2 + k0)(c s + k1) + k1 c s =
     * 0 */
    static const double k0s[] = {30.0, 0.0};
    const double k1 = 80.0;
    const double c1 = 2.0;
    const double m[4] = {1.5, 0.0, 0.0, 0.0};
    const double c[4] = {0.0, 0.0, 0.0, c1};
    for (int row = 0; row < 2; row++) {
        const double k0 = k0s[row];
        const double k[4] = {k0 + k1, -k1, -k1, k1};
        damped s;
        mt_test_row(t, "k0 = %g", k0);
        if (damped_solve(t, 2, k, c, m, &s)) {
            CHECK_INT(t, s.d.count, row == 0 ? 2 : 3);
            for (int i = 0; i < s.d.count; i++) {
                const double complex x = root(&s, i);
                const double complex p = (1.5 * x * x + k0) * (c1 * x + k1) + k1 * c1 * x;
                const double size = (1.5 * cabs(x * x) + k0) * (c1 * cabs(x) + k1);
                CHECK_NEAR_ABS(t, cabs(p), 0.0, TOL * (size + k1 * c1 * cabs(x)));
            }
            CHECK_INT(t, s.d.kind[row == 0 ? 1 : 0],
                      row == 0 ? MT_DAMPED_OVERDAMPED : MT_DAMPED_RIGID_BODY);
        }
        mt_arena_free(&s.mem);
    }
}

static void damped__massless_nodes_with_and_without_damper(mt_test *t)
{
    /* mass - k1 - node - k2 - node with a damper to ground: as one spring k1 k2/(k1 + k2) in
     * that row */
    const double k1 = 80.0;
    const double k2 = 240.0;
    const double k = 60.0;
    const double m3[9] = {1.5};
    const double k3[9] = {k1 + 30.0, -k1, 0.0, -k1, k1 + k2, -k2, 0.0, -k2, k2};
    const double c3[9] = {[8] = 2.0};
    const double m2[4] = {1.5};
    const double kk[4] = {k + 30.0, -k, -k, k};
    const double c2[4] = {[3] = 2.0};
    damped a = {.err.text = ""};
    damped b = {.err.text = ""};
    const bool solved =
        damped_solve(t, 3, k3, c3, m3, &a) && damped_solve(t, 2, kk, c2, m2, &b);
    CHECK(t, solved);
    if (solved && CHECK(t, a.d.count == b.d.count)) {
        for (int i = 0; i < a.d.count; i++) {
            expect(t, &a, i, b.d.kind[i], b.d.re[i], b.d.im[i]);
        }
    }
    mt_arena_free(&a.mem);
    mt_arena_free(&b.mem);
}

static void damped__unstable_directions_are_said(mt_test *t)
{
    const double k[1] = {-9.0};
    const double m[1] = {1.0};
    const double c[1] = {0.0};
    damped s;
    if (damped_solve(t, 1, k, c, m, &s)) {
        CHECK_INT(t, s.d.count, 2);
        CHECK_NEAR_ABS(t, fabs(s.d.re[0]), 3.0, TOL);
        CHECK_INT(t, s.d.kind[s.d.re[0] > 0.0 ? 0 : 1], MT_DAMPED_UNSTABLE);
    }
    mt_arena_free(&s.mem);
}

/* One body of 1 kg, J = diag(1, 2, 3), 1 m above a ball joint, on a rotational bushing with a
 * damper of 0.01 of its stiffness. */
static void damped__body_on_a_damped_bushing(mt_test *t)
{
    static const double hz[] = {3.53650019, 5.71383732, 8.38400687};
    static const double percent[] = {11.180339887, 18.257418584, 27.386127875};
    mech s;
    if (mech_must(
            t,
            mech_parse(
                t, "{ \"format\": \"modetune-model/1\", \"name\": \"damped\", \"dimension\": 3,"
                   "  \"bodies\": [ { \"name\": \"b\", \"mass_kg\": 1, \"inertia_kg_m2\": [1, "
                   "2, 3], \"centre\": [0, 0, 1] } ],"
                   "  \"joints\": [ { \"name\": \"ball\", \"type\": \"spherical\", \"bodies\": "
                   "[\"ground\", \"b\"], \"at\": [0, 0, 0] } ],"
                   "  \"springs\": [ { \"name\": \"s\", \"type\": \"bushing\", \"bodies\": "
                   "[\"ground\", \"b\"], \"at\": [0, 0, 1],"
                   "    \"stiffness_n_per_m\": [0, 0, 0], \"stiffness_n_m_per_rad\": [1e3, "
                   "4e3, 9e3] } ],"
                   "  \"dampers\": [ { \"name\": \"d\", \"type\": \"bushing\", \"bodies\": "
                   "[\"ground\", \"b\"], \"at\": [0, 0, 1],"
                   "    \"damping_n_s_per_m\": [0, 0, 0], \"damping_n_m_s_per_rad\": [10, 40, "
                   "90] } ] }"),
            NULL, "", &s)) {
        double c[9];
        mt_damped_modes d;
        mt_arena mem;
        const mt_damped_problem p = {.n = 3,
                                     .k = mt_linear_reduced(s.a->lin).k,
                                     .c = c,
                                     .mass = &s.a->mass,
                                     .modes = &s.a->modes};
        CHECK_INT(t, mt_linear_freedoms(s.a->lin), 3);
        mt_linear_damping(s.a->lin, c);
        if (CHECK(t, mt_arena_init(&mem, 0, &s.err) == MT_OK) &&
            CHECK(t, mt_modal_damped(&p, &mem, &d, &s.err) == MT_OK)) {
            CHECK_INT(t, d.count, 3);
            for (int i = 0; i < 3; i++) {
                CHECK_NEAR(t, mt_damped_hz(&d, i), hz[i], 1e-8);
                CHECK_NEAR(t, 100.0 * mt_damped_ratio(&d, i), percent[i], 1e-8);
                CHECK(t, d.residual[i] <= RESIDUAL);
            }
        }
        mt_arena_free(&mem);
    }
    mech_free(&s);
}

/* The root of m s^2 + c s + k (1 + i eta) with Im s > 0. */
static double complex lossy_root(double m, double c, double k, double eta)
{
    const double complex left = csqrt(mt_complex(c * c - 4.0 * m * k, -4.0 * m * k * eta));
    return cimag(left) > 0.0 ? (left - c) / (2.0 * m) : (-left - c) / (2.0 * m);
}

static void structural__single_mass_has_its_closed_form(mt_test *t)
{
    static const struct {
        const char *name;
        double c;
        double eta;
    } rows[] = {
        {"none", 0.0, 0.0},        {"slight", 0.0, 1e-9},      {"usual", 0.0, 0.1},
        {"rubber", 0.0, 2.0},      {"with damper", 3.0, 0.1},  {"nearly critical", 19.9, 0.1},
        {"overdamped", 40.0, 0.1}, {"heavily over", 2e4, 0.1},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const double m = 2.0;
        const double k = 50.0;
        const double h = rows[i].eta * k;
        damped s;
        mt_test_row(t, "%s", rows[i].name);
        if (structural_solve(t, 1, &k, &rows[i].c, &h, &m, &s)) {
            const double complex want = lossy_root(m, rows[i].c, k, rows[i].eta);
            CHECK_INT(t, s.d.count, 1);
            expect(t, &s, 0, MT_DAMPED_OSCILLATING, creal(want), cimag(want));
        }
        mt_arena_free(&s.mem);
        if (rows[i].c == 0.0) { /* s = i omega sqrt(1 + i eta) */
            const double complex want =
                mt_complex(0.0, sqrt(k / m)) * csqrt(mt_complex(1.0, rows[i].eta));
            const double complex got = lossy_root(m, 0.0, k, rows[i].eta);
            CHECK_NEAR_ABS(t, cabs(got - want), 0.0, TOL * cabs(want));
        }
    }
}

static void structural__one_loss_factor_for_all_keeps_each_mode(mt_test *t)
{
    enum { N = 5 };
    const double eta = 0.07;
    double k[N * N];
    double m[N * N];
    double h[N * N];
    const double c[N * N] = {0.0};
    const double masses[N] = {1.0, 2.0, 1.0, 3.0, 1.0};
    const double springs[N + 1] = {300.0, 200.0, 100.0, 50.0, 100.0, 20.0};
    damped s;
    chain_matrices(N, springs, masses, k, m);
    for (int i = 0; i < N * N; i++) {
        h[i] = eta * k[i];
    }
    if (structural_solve(t, N, k, c, h, m, &s)) {
        CHECK_INT(t, s.d.count, N);
        for (int i = 0; i < N; i++) {
            const double complex want =
                mt_complex(0.0, sqrt(s.modes.lambda[i])) * csqrt(mt_complex(1.0, eta));
            mt_test_row(t, "mode %d", i + 1);
            CHECK_NEAR_ABS(t, cabs(root(&s, i) - want), 0.0, 10.0 * TOL * cabs(want));
        }
    }
    mt_arena_free(&s.mem);
}

/* p = (m1 s^2 + (c1 + c2) s + a + b)(m2 s^2 + c2 s + b) - (c2 s + b)^2 with a = k1 (1 + i
 * eta1), b = k2 (1 + i eta2): how far Newton in eighty bits would move the root. */
static double newton_moves(const double *m, const double *c, const double *k, const double *eta,
                           double complex s)
{
    const long double complex x = (long double complex)s;
    const long double complex i = csqrtl(-1.0L);
    const long double complex xx = x * x;
    const long double c1 = (long double)c[0];
    const long double c2 = (long double)c[1];
    const long double m1 = (long double)m[0];
    const long double m2 = (long double)m[1];
    const long double complex a = (long double)k[0] * (1.0L + ((long double)eta[0] * i));
    const long double complex b = (long double)k[1] * (1.0L + ((long double)eta[1] * i));
    const long double complex u = (m1 * xx) + ((c1 + c2) * x) + a + b;
    const long double complex v = (m2 * xx) + (c2 * x) + b;
    const long double complex w = (c2 * x) + b;
    const long double complex du = (2.0L * m1 * x) + (c1 + c2);
    const long double complex dv = (2.0L * m2 * x) + c2;
    const long double complex p = (u * v) - (w * w);
    const long double complex dp = (du * v) + (u * dv) - (2.0L * c2 * w);
    return (double)(cabsl(p / dp) / cabsl(x));
}

static void structural__two_masses_are_roots_of_their_polynomial(mt_test *t)
{
    static const struct {
        const char *name;
        double m[2];
        double c[2];
        double k[2];
        double eta[2];
    } rows[] = {
        {"dampers alone", {1.0, 2.0}, {0.5, 0.1}, {100.0, 50.0}, {0.0, 0.0}},
        {"losses alone", {1.0, 2.0}, {0.0, 0.0}, {100.0, 50.0}, {0.01, 0.3}},
        {"both", {1.0, 2.0}, {3.0, 0.2}, {100.0, 50.0}, {0.2, 0.01}},
        {"one spring loses", {1.0, 0.05}, {0.0, 0.02}, {100.0, 5.0}, {0.0, 0.5}},
        {"apart", {1.0, 1e-4}, {0.1, 1e-3}, {1e6, 3.0}, {1e-3, 1.0}},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const double m[4] = {rows[i].m[0], 0.0, 0.0, rows[i].m[1]};
        double matrix[3][4];
        for (int q = 0; q < 3; q++) {
            double x[2];
            for (int j = 0; j < 2; j++) {
                x[j] = q == 0   ? rows[i].k[j]
                       : q == 1 ? rows[i].c[j]
                                : rows[i].k[j] * rows[i].eta[j];
            }
            matrix[q][0] = x[0] + x[1];
            matrix[q][1] = matrix[q][2] = -x[1];
            matrix[q][3] = x[1];
        }
        damped s;
        mt_test_row(t, "%s", rows[i].name);
        if (structural_solve(t, 2, matrix[0], matrix[1], matrix[2], m, &s)) {
            CHECK_INT(t, s.d.count, 2);
            for (int j = 0; j < 2; j++) {
                CHECK_INT(t, s.d.kind[j], MT_DAMPED_OSCILLATING);
                CHECK_NEAR_ABS(
                    t, newton_moves(rows[i].m, rows[i].c, rows[i].k, rows[i].eta, root(&s, j)),
                    0.0, TOL);
            }
            CHECK(t, cabs(root(&s, 0)) < cabs(root(&s, 1)));
        }
        mt_arena_free(&s.mem);
    }
}

static void structural__free_masses_keep_their_rigid_body_mode(mt_test *t)
{
    const double eta = 0.2;
    const double k[4] = {100.0, -100.0, -100.0, 100.0};
    const double h[4] = {eta * 100.0, -eta * 100.0, -eta * 100.0, eta * 100.0};
    const double m[4] = {1.0, 0.0, 0.0, 4.0};
    const double c[2][4] = {{0.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.5}};
    damped s;
    if (structural_solve(t, 2, k, c[0], h, m, &s)) {
        const double complex want = lossy_root(0.8, 0.0, 100.0, eta);
        CHECK_INT(t, s.d.count, 2);
        expect(t, &s, 0, MT_DAMPED_RIGID_BODY, 0.0, 0.0);
        expect(t, &s, 1, MT_DAMPED_OSCILLATING, creal(want), cimag(want));
    }
    mt_arena_free(&s.mem);
    if (structural_solve(t, 2, k, c[1], h, m, &s)) { /* it drags on the ground */
        int oscillating = 0;
        CHECK_INT(t, s.d.kind[0], MT_DAMPED_RIGID_BODY);
        for (int i = 1; i < s.d.count; i++) {
            const double complex x = root(&s, i);
            const double complex a = mt_complex(100.0, eta * 100.0);
            const double complex det = (x * x + a) * (4.0 * x * x + 0.5 * x + a) - a * a;
            oscillating += s.d.kind[i] == MT_DAMPED_OSCILLATING ? 1 : 0;
            CHECK_NEAR_ABS(t, cabs(det), 0.0, TOL * 1e5);
        }
        CHECK(t, oscillating >= 1);
    }
    mt_arena_free(&s.mem);
}

/* mass - k1 - node - k2 - node with a damper to ground: two springs of one loss factor in a row
 * are one of that factor; the node between has neither mass nor damper. */
static void structural__massless_nodes_follow(mt_test *t)
{
    const double eta = 0.3;
    const double k1 = 80.0;
    const double k2 = 240.0;
    const double k = 60.0;
    const double m3[9] = {1.5};
    const double k3[9] = {k1 + 30.0, -k1, 0.0, -k1, k1 + k2, -k2, 0.0, -k2, k2};
    const double c3[9] = {[8] = 2.0};
    double h3[9];
    damped s;
    memcpy(h3, k3, sizeof h3);
    h3[0] = k1; /* the spring to ground loses nothing */
    for (int i = 0; i < 9; i++) {
        h3[i] *= eta;
    }
    if (structural_solve(t, 3, k3, c3, h3, m3, &s)) {
        CHECK_INT(t, s.d.count, 1); /* the relaxation has Im s < 0 */
        const double complex x = root(&s, 0);
        const double complex a = mt_complex(k, eta * k);
        const double complex p = (1.5 * x * x + 30.0) * (2.0 * x + a) + a * 2.0 * x;
        const double size = (1.5 * cabs(x * x) + 30.0) * (2.0 * cabs(x) + cabs(a));
        CHECK_NEAR_ABS(t, cabs(p), 0.0, TOL * size);
        CHECK_INT(t, s.d.kind[0], MT_DAMPED_OSCILLATING);
    }
    mt_arena_free(&s.mem);
}

/* H = 0 as a matrix is no H: the complex way meets the real one. */
static void structural__without_losses_meets_the_viscous_solve(mt_test *t)
{
    enum { N = 6 };
    double k[N * N];
    double m[N * N];
    double c[N * N];
    const double h[N * N] = {0.0};
    const double masses[N] = {1.0, 2.0, 1.0, 3.0, 1.0, 0.5};
    const double springs[N + 1] = {0.0, 200.0, 100.0, 50.0, 100.0, 20.0, 0.0};
    const double dampers[N + 1] = {0.0, 3.0, 0.0, 0.5, 0.0, 1.0, 0.0};
    damped a = {.err.text = ""};
    damped b = {.err.text = ""};
    chain_matrices(N, dampers, masses, c, m);
    chain_matrices(N, springs, masses, k, m);
    const bool solved =
        structural_solve(t, N, k, c, h, m, &a) && damped_solve(t, N, k, c, m, &b);
    if (CHECK(t, solved) && CHECK_INT(t, a.d.count, b.d.count)) {
        for (int i = 0; i < a.d.count; i++) {
            expect(t, &a, i, b.d.kind[i], b.d.re[i], b.d.im[i]);
        }
    }
    mt_arena_free(&a.mem);
    mt_arena_free(&b.mem);
}

static void damped__failing_allocations_are_errors(mt_test *t)
{
    const double m[9] = {1.5};
    const double k[9] = {110.0, -80.0, 0.0, -80.0, 320.0, -240.0, 0.0, -240.0, 240.0};
    const double c[9] = {[8] = 2.0};
    damped s;
    if (damped_solve(t, 3, k, c, m, &s)) {
        for (int with = 0; with < 2; with++) { /* viscous alone, and with losses */
            const mt_damped_problem p = {.n = 3,
                                         .k = k,
                                         .c = c,
                                         .h = with == 1 ? k : NULL,
                                         .mass = &s.mass,
                                         .modes = &s.modes};
            for (long nth = 0; mt_alloc_works(); nth++) {
                mt_arena mem = {.first = NULL};
                mt_damped_modes d;
                mt_alloc_fail_after(nth);
                mt_status rc = mt_arena_init(&mem, 64, &s.err);
                rc = rc == MT_OK ? mt_modal_damped(&p, &mem, &d, &s.err) : rc;
                mt_alloc_fail_after(-1);
                mt_arena_free(&mem);
                CHECK(t, rc == MT_OK || rc == MT_E_MEMORY);
                if (rc == MT_OK) {
                    break;
                }
            }
        }
    }
    mt_arena_free(&s.mem);
}

MT_TEST_MAIN(MT_TEST(damped__failing_allocations_are_errors),
             MT_TEST(damped__single_mass_has_its_closed_form),
             MT_TEST(damped__without_damping_meets_the_modal_solve),
             MT_TEST(damped__proportional_damping_keeps_each_mode),
             MT_TEST(damped__rigid_body_pairs_stand_apart),
             MT_TEST(damped__spring_and_damper_in_a_row_need_no_mass_between),
             MT_TEST(damped__massless_nodes_with_and_without_damper),
             MT_TEST(damped__unstable_directions_are_said),
             MT_TEST(damped__body_on_a_damped_bushing),
             MT_TEST(structural__single_mass_has_its_closed_form),
             MT_TEST(structural__one_loss_factor_for_all_keeps_each_mode),
             MT_TEST(structural__two_masses_are_roots_of_their_polynomial),
             MT_TEST(structural__free_masses_keep_their_rigid_body_mode),
             MT_TEST(structural__massless_nodes_follow),
             MT_TEST(structural__without_losses_meets_the_viscous_solve))
