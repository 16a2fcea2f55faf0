/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Responses of matrices: closed forms, invariants, and one way against the other. */
#include "response/forced_fixture.h"

/* Against closed forms. */
static const double TOL = 1e-12;
/* Two ways to one response. */
static const double WAYS = 1e-9;

/* All ways to entry (o, i) at w give want; its slope is that of want. */
static void expect(mt_test *t, forced *p, double w, int o, int i, double complex want,
                   double complex slope, double scale)
{
    const int at = o + (i * p->f.n_out);
    mt_sample a = forced_sample(p, &p->mem);
    mt_sample b = forced_sample(p, &p->mem);
    CHECK(t, mt_transfer_at(&p->direct, w, &a, &p->mem, &p->err) == MT_OK);
    CHECK(t, mt_transfer_at(&p->basis.t, w, &b, &p->mem, &p->err) == MT_OK);
    CHECK_NEAR_ABS(t, cabs(a.h[at] - want), 0.0, TOL * scale);
    CHECK_NEAR_ABS(t, cabs(b.h[at] - want), 0.0, TOL * scale);
    CHECK(t, cabs(a.h[at] - want) <= a.error[at]);
    CHECK(t, cabs(b.h[at] - want) <= b.error[at]);
    CHECK(t, a.error[at] <= 100.0 * TOL * scale);
    CHECK(t, b.error[at] <= 100.0 * TOL * scale);
    if (isfinite(creal(slope))) {
        CHECK_NEAR_ABS(t, cabs(a.dh[at] - slope), 0.0, 100.0 * TOL * cabs(slope));
        CHECK_NEAR_ABS(t, cabs(b.dh[at] - slope), 0.0, 100.0 * TOL * cabs(slope));
    }
}

static void forced__one_mass_matches_its_closed_form(mt_test *t)
{
    static const struct {
        const char *name;
        double c;
        double h;
    } rows[] = {{"undamped", 0.0, 0.0},   {"viscous", 0.3, 0.0}, {"overdamped", 60.0, 0.0},
                {"structural", 0.0, 5.0}, {"both", 0.7, 5.0},    {"hardly", 1e-9, 0.0}};
    static const double W[] = {0.01, 3.0, 6.32, 7.1, 6.324555320336759, 50.0, 4000.0};
    const double k = 80.0;
    const double m = 2.0;
    for (size_t r = 0; r < sizeof rows / sizeof rows[0]; r++) {
        forced p;
        forced_all(&p, 1);
        p.k[0] = k;
        p.m[0] = m;
        p.c[0] = rows[r].c;
        p.h[0] = rows[r].h;
        p.f.c = rows[r].c != 0.0 ? p.c : NULL;
        p.f.h = rows[r].h != 0.0 ? p.h : NULL;
        mt_pole_sum sum;
        const bool made = forced_make(t, &p, 0);
        CHECK(t, p.basis.t.diagonal);
        CHECK(t, made && mt_response_poles(&p.basis, &p.mem, &sum, &p.err) == MT_OK);
        for (size_t i = 0; i < sizeof W / sizeof W[0] && made; i++) {
            mt_test_row(t, "%s, w = %g", rows[r].name, W[i]);
            const double w = W[i];
            const double complex d =
                k - (m * w * w) + mt_complex(0.0, (w * rows[r].c) + rows[r].h);
            const double complex dd = (-2.0 * m * w) + mt_complex(0.0, rows[r].c);
            const double terms = (k + (m * w * w)) / cabs(d); /* of the denominator */
            if (terms > 1e6 && rows[r].c < 1e-6) {
                continue;
            }
            expect(t, &p, w, 0, 0, 1.0 / d, -dd / (d * d), terms * cabs(1.0 / d));
            CHECK_NEAR_ABS(t, cabs(mt_pole_sum_at(&sum, w) - (1.0 / d)), 0.0,
                           TOL * terms * cabs(1.0 / d));
        }
        mt_arena_free(&p.mem);
    }
}

/* Two masses, walls on both sides: D^-1 of a 2 x 2 matrix. */
static void forced__two_masses_match_their_closed_form(mt_test *t)
{
    static const struct {
        const char *name;
        double c[3];
        double h[3];
        bool diagonal;
    } rows[] = {
        {"undamped", {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, true},
        {"proportional", {0.4, 0.2, 0.3}, {0.0, 0.0, 0.0}, true},
        {"viscous, one damper", {0.0, 2.0, 0.0}, {0.0, 0.0, 0.0}, false},
        {"structural, one spring", {0.0, 0.0, 0.0}, {6.0, 0.0, 0.0}, false},
        {"structural, all alike", {0.0, 0.0, 0.0}, {4.0, 2.0, 3.0}, true},
        {"both", {0.0, 1.0, 0.2}, {0.0, 0.0, 9.0}, false},
    };
    const double k[3] = {400.0, 200.0, 300.0};
    const double m[2] = {3.0, 1.5};
    for (size_t r = 0; r < sizeof rows / sizeof rows[0]; r++) {
        forced p;
        forced_all(&p, 2);
        p.m[0] = m[0];
        p.m[3] = m[1];
        p.f.c = rows[r].c[0] + rows[r].c[1] > 0.0 ? p.c : NULL;
        p.f.h = rows[r].h[0] + rows[r].h[2] > 0.0 ? p.h : NULL;
        for (int i = 0; i < 3; i++) {
            const int from = i == 0 ? -1 : i - 1;
            const int to = i == 2 ? -1 : i;
            forced_between(p.k, 2, from, to, k[i]);
            forced_between(p.c, 2, from, to, rows[r].c[i]);
            forced_between(p.h, 2, from, to, rows[r].h[i]);
        }
        mt_pole_sum sum[4];
        const bool made = forced_make(t, &p, 0);
        CHECK_INT(t, p.basis.t.diagonal, rows[r].diagonal);
        CHECK(t, made && mt_response_poles(&p.basis, &p.mem, sum, &p.err) == MT_OK);
        for (int i_w = 0; i_w < 38 && made; i_w++) {
            const double w = 1.0 * pow(1.13, i_w);
            mt_test_row(t, "%s, w = %g", rows[r].name, w);
            double complex d[4];
            for (int i = 0; i < 4; i++) {
                d[i] = p.k[i] - (w * w * p.m[i]) + mt_complex(0.0, p.h[i] + (w * p.c[i]));
            }
            const double complex det = (d[0] * d[3]) - (d[1] * d[2]);
            const double size = 1e3 * (cabs(d[0]) + cabs(d[1]) + cabs(d[3])) / cabs(det);
            expect(t, &p, w, 0, 0, d[3] / det, nan(""), size);
            expect(t, &p, w, 0, 1, -d[1] / det, nan(""), size);
            expect(t, &p, w, 1, 1, d[0] / det, nan(""), size);
            CHECK_NEAR_ABS(t, cabs(mt_pole_sum_at(&sum[2], w) + (d[1] / det)), 0.0, TOL * size);
        }
        mt_arena_free(&p.mem);
    }
}

static void forced__all_ways_agree_and_are_reciprocal(mt_test *t)
{
    mt_random r = mt_random_seed(5);
    for (int round = 0; round < 60; round++) {
        const int n = 1 + mt_random_int(&r, FORCED_MOST);
        forced p;
        forced_random(&r, &p, n, mt_random_int(&r, 4) > 0);
        mt_test_row(t, "round %d, n = %d%s%s", round, n, p.f.c ? ", viscous" : "",
                    p.f.h ? ", structural" : "");
        if (!forced_make(t, &p, 0)) {
            mt_arena_free(&p.mem);
            continue;
        }
        mt_pole_sum *const sum = mt_arena_alloc(&p.mem, (size_t)n * (size_t)n, sizeof *sum);
        mt_sample a = forced_sample(&p, &p.mem);
        mt_sample b = forced_sample(&p, &p.mem);
        const bool rigid = p.modes.n_rigid > 0;
        const mt_status rc = mt_response_poles(&p.basis, &p.mem, sum, &p.err);
        CHECK(t, rigid || rc == MT_OK);
        for (int i_w = 0; i_w < 35; i_w++) {
            const double w = 0.3 * pow(1.31, i_w);
            CHECK(t, mt_transfer_at(&p.direct, w, &a, &p.mem, &p.err) == MT_OK);
            CHECK(t, mt_transfer_at(&p.basis.t, w, &b, &p.mem, &p.err) == MT_OK);
            double largest = 0.0;
            for (int i = 0; i < n * n; i++) {
                largest = fmax(largest, cabs(a.h[i]));
            }
            for (int i = 0; i < n * n; i++) {
                const double off = cabs(a.h[i] - b.h[i]);
                const int turned = (i / n) + ((i % n) * n);
                CHECK_NEAR_ABS(t, off, 0.0, WAYS * largest);
                CHECK(t, off <= a.error[i] + b.error[i]);
                CHECK(t, cabs(a.h[i] - a.h[turned]) <= a.error[i] + a.error[turned]);
                if (rc == MT_OK) {
                    CHECK_NEAR_ABS(t, cabs(mt_pole_sum_at(&sum[i], w) - a.h[i]), 0.0,
                                   WAYS * largest);
                }
                CHECK_NEAR_ABS(t, cabs(a.dh[i] - b.dh[i]), 0.0,
                               WAYS * (cabs(a.dh[i]) + (largest / w)));
            }
        }
        mt_arena_free(&p.mem);
    }
}

/* Directions without mass, with and without a damper: the ways are the same. */
static void forced__directions_without_mass_are_exact(mt_test *t)
{
    mt_random r = mt_random_seed(6);
    for (int round = 0; round < 40; round++) {
        const int n = 2 + mt_random_int(&r, FORCED_MOST - 2);
        forced p;
        forced_random(&r, &p, n, true);
        for (int i = 0; i < 1 + (n / 3); i++) {
            const int at = mt_random_int(&r, n);
            p.m[at + (at * n)] = 0.0;
        }
        mt_test_row(t, "round %d, n = %d%s%s", round, n, p.f.c ? ", viscous" : "",
                    p.f.h ? ", structural" : "");
        mt_pole_sum sum[FORCED_MOST * FORCED_MOST];
        if (!forced_make(t, &p, 0) ||
            !CHECK(t, mt_response_poles(&p.basis, &p.mem, sum, &p.err) == MT_OK)) {
            mt_arena_free(&p.mem);
            continue;
        }
        mt_sample a = forced_sample(&p, &p.mem);
        mt_sample b = forced_sample(&p, &p.mem);
        for (int i_w = 0; i_w < 35; i_w++) {
            const double w = 0.3 * pow(1.31, i_w);
            CHECK(t, mt_transfer_at(&p.direct, w, &a, &p.mem, &p.err) == MT_OK);
            CHECK(t, mt_transfer_at(&p.basis.t, w, &b, &p.mem, &p.err) == MT_OK);
            double largest = 0.0;
            for (int i = 0; i < n * n; i++) {
                largest = fmax(largest, cabs(a.h[i]));
            }
            for (int i = 0; i < n * n; i++) {
                CHECK_NEAR_ABS(t, cabs(a.h[i] - b.h[i]), 0.0, WAYS * largest);
                CHECK_NEAR_ABS(t, cabs(mt_pole_sum_at(&sum[i], w) - a.h[i]), 0.0,
                               WAYS * largest);
            }
        }
        mt_arena_free(&p.mem);
    }
}

/* A free pair of masses, one of them damped against the ground or none: what is asked of
 * displacements has a pole at 0, of accelerations none. */
static void forced__free_motions_have_their_poles(mt_test *t)
{
    for (int damped = 0; damped < 2; damped++) {
        forced p;
        forced_all(&p, 2);
        p.m[0] = 1.0;
        p.m[3] = 2.0;
        forced_between(p.k, 2, 0, 1, 50.0);
        forced_between(p.c, 2, -1, 1, 0.5);
        p.f.c = damped ? p.c : NULL;
        mt_test_row(t, "%s", damped ? "damped" : "free");
        mt_pole_sum sum[4];
        const bool made = forced_make(t, &p, 0);
        const mt_status rc = made ? mt_response_poles(&p.basis, &p.mem, sum, &p.err) : MT_OK;
        CHECK_INT(t, rc, damped ? MT_OK : MT_E_SINGULAR);
        p.f.s[2] = p.s;
        p.f.s[0] = NULL;
        mt_arena_free(&p.mem);
        CHECK(t, forced_make(t, &p, 0) &&
                     mt_response_poles(&p.basis, &p.mem, sum, &p.err) == MT_OK);
        mt_sample a = forced_sample(&p, &p.mem);
        for (int i_w = 0; i_w < 18; i_w++) {
            const double w = 0.01 * pow(1.7, i_w);
            CHECK(t, mt_transfer_at(&p.direct, w, &a, &p.mem, &p.err) == MT_OK);
            for (int i = 0; i < 4; i++) {
                CHECK_NEAR_ABS(t, cabs(mt_pole_sum_at(&sum[i], w) - a.h[i]), 0.0,
                               WAYS * cabs(a.h[0]));
            }
        }
        mt_arena_free(&p.mem);
    }
}

/* Critical damping, and a mode pair that one damper turns into one: no sum of poles, and the
 * other ways hold. */
static void forced__double_poles_are_refused(mt_test *t)
{
    for (int two = 0; two < 2; two++) {
        forced p;
        forced_all(&p, 1 + two);
        mt_pole_sum sum[4];
        if (two == 0) {
            p.k[0] = 9.0;
            p.m[0] = 1.0;
            p.c[0] = 6.0;
        } else { /* x'' + 2 b (x' - y') + x, y'' + ... + (1 + k) y: defective at one b */
            p.m[0] = p.m[3] = 1.0;
            forced_between(p.k, 2, -1, 0, 1.0);
            forced_between(p.k, 2, -1, 1, 1.0);
            forced_between(p.c, 2, 0, 1, 1.0); /* s^2 + 2 s + 1 of the difference */
        }
        p.f.c = p.c;
        mt_test_row(t, "%d masses", 1 + two);
        CHECK(t, forced_make(t, &p, 0));
        CHECK_INT(t, mt_response_poles(&p.basis, &p.mem, sum, &p.err), MT_E_SINGULAR);
        mt_sample a = forced_sample(&p, &p.mem);
        mt_sample b = forced_sample(&p, &p.mem);
        CHECK(t, mt_transfer_at(&p.direct, 0.7, &a, &p.mem, &p.err) == MT_OK);
        CHECK(t, mt_transfer_at(&p.basis.t, 0.7, &b, &p.mem, &p.err) == MT_OK);
        CHECK_NEAR_ABS(t, cabs(a.h[0] - b.h[0]), 0.0, TOL * cabs(a.h[0]));
        mt_arena_free(&p.mem);
    }
}

/* Nothing damps it: at the resonance itself there is no value, and it is said. */
static void forced__undamped_resonance_is_infinite(mt_test *t)
{
    forced p;
    forced_all(&p, 1);
    p.k[0] = 16.0;
    p.m[0] = 1.0;
    CHECK(t, forced_make(t, &p, 0));
    mt_sample a = forced_sample(&p, &p.mem);
    CHECK(t, mt_transfer_at(&p.basis.t, 4.0, &a, &p.mem, &p.err) == MT_OK);
    CHECK(t, isinf(creal(a.h[0])) && isinf(a.error[0]));
    CHECK(t, mt_transfer_at(&p.direct, 4.0, &a, &p.mem, &p.err) == MT_OK);
    CHECK(t, isinf(creal(a.h[0])) && isinf(a.error[0]));
    mt_arena_free(&p.mem);
}

/* Of a chain with many masses the lowest modes, the others statically: exact at 0, and right
 * next to it; free chains too. */
static void forced__modes_that_are_left_out_follow_statically(mt_test *t)
{
    for (int free = 0; free < 2; free++) {
        forced p;
        forced_all(&p, 10);
        for (int i = 0; i < 10; i++) {
            p.m[(ptrdiff_t)i * 11] = 1.0;
            if (i > 0 || free == 0) {
                forced_between(p.k, 10, i - 1, i, 1e4);
                forced_between(p.h, 10, i - 1, i, 300.0);
            }
        }
        p.f.h = p.h;
        mt_test_row(t, "%s", free ? "free" : "held");
        CHECK(t, forced_make(t, &p, 4));
        CHECK_INT(t, p.basis.n_left, 6);
        mt_sample a = forced_sample(&p, &p.mem);
        mt_sample b = forced_sample(&p, &p.mem);
        for (int i_w = 0; i_w < 12; i_w++) {
            const double w = 1e-4 * pow(3.0, i_w);
            CHECK(t, mt_transfer_at(&p.direct, w, &a, &p.mem, &p.err) == MT_OK);
            CHECK(t, mt_transfer_at(&p.basis.t, w, &b, &p.mem, &p.err) == MT_OK);
            const double part = w * w / p.basis.lowest_left;
            for (int i = 0; i < 100; i++) {
                CHECK_NEAR_ABS(t, cabs(a.h[i] - b.h[i]), 0.0,
                               a.error[i] + b.error[i] + (part * 4e-4));
            }
        }
        mt_arena_free(&p.mem);
    }
}

MT_TEST_MAIN(MT_TEST(forced__one_mass_matches_its_closed_form),
             MT_TEST(forced__two_masses_match_their_closed_form),
             MT_TEST(forced__all_ways_agree_and_are_reciprocal),
             MT_TEST(forced__directions_without_mass_are_exact),
             MT_TEST(forced__free_motions_have_their_poles),
             MT_TEST(forced__double_poles_are_refused),
             MT_TEST(forced__undamped_resonance_is_infinite),
             MT_TEST(forced__modes_that_are_left_out_follow_statically))
