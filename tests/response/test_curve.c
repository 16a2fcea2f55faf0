/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a response is looked at: peaks and antiresonances against closed forms, what lies
 * between points, how many there are. */
#include "response/curve.h"
#include "response/forced_fixture.h"

/* A peak's place and height. */
static const double PLACE = 1e-8; /* |H|^2 is flat there: half of the digits */
static const double HEIGHT = 1e-12;
/* What a straight line in log |H| may be off by. */
static const double BETWEEN = 0.011;

static bool trace(mt_test *t, forced *p, double from, double to, bool log, mt_curve *out)
{
    mt_curve_options opt = {.from = from, .to = to, .points = 20, .log = log};
    double complex *poles = NULL;
    mt_status rc = mt_response_pole_list(&p->basis, &p->mem, &opt.n_poles, &poles, &p->err);
    opt.poles = poles;
    rc = rc == MT_OK ? mt_curve_trace(&p->basis.t, &opt, &p->mem, out, &p->err) : rc;
    return CHECK(t, rc == MT_OK) && CHECK(t, out->complete);
}

static void curve__one_mass_peaks_at_its_closed_form(mt_test *t)
{
    static const double ZETA[] = {0.5, 0.1, 1e-2, 1e-4, 1e-7};
    const double k = 300.0;
    const double m = 3.0;
    for (size_t r = 0; r < sizeof ZETA / sizeof ZETA[0]; r++) {
        forced p;
        forced_all(&p, 1);
        p.k[0] = k;
        p.m[0] = m;
        p.c[0] = 2.0 * ZETA[r] * sqrt(k * m);
        p.f.c = p.c;
        mt_test_row(t, "ratio %g", ZETA[r]);
        mt_curve c = {.n = 0};
        if (forced_make(t, &p, 0) && trace(t, &p, 1.0, 100.0, r % 2 == 0, &c)) {
            const double z = ZETA[r];
            CHECK_INT(t, c.n_extremes, 1);
            CHECK(t, c.extremes[0].peak && !c.extremes[0].infinite);
            CHECK_NEAR(t, c.extremes[0].w, 10.0 * sqrt(1.0 - (2.0 * z * z)), PLACE);
            CHECK_NEAR(t, cabs(c.extremes[0].h), 1.0 / (2.0 * k * z * sqrt(1.0 - (z * z))),
                       fmax(HEIGHT, 1e-15 / z));
            CHECK(t, c.n < 400);
        }
        mt_arena_free(&p.mem);
    }
}

/* What is drawn between two points of a picture is straight over log w in log |H| and phase. */
static double drawn_off(const mt_curve *c, int a, int b, int i)
{
    const double part = log(c->w[i] / c->w[a]) / log(c->w[b] / c->w[a]);
    const double complex step = clog(c->h[b] / c->h[a]);
    return cabs((c->h[a] * cexp(part * step) / c->h[i]) - 1.0);
}

static void check_thin(mt_test *t, forced *p, const mt_curve *c, int most, double off)
{
    int n = 0;
    int *kept = NULL;
    double worst = 0.0;
    if (!CHECK(t, mt_curve_thin(c, 0, 1, most, &p->mem, &n, &kept, NULL) == MT_OK) ||
        !CHECK(t, n >= 2 && kept[0] == 0 && kept[n - 1] == c->n - 1)) {
        return;
    }
    CHECK(t, n <= most);
    for (int e = 0; e < c->n_extremes; e++) {
        int found = 0;
        for (int k = 0; k < n; k++) {
            found += c->w[kept[k]] == c->extremes[e].w;
        }
        CHECK_INT(t, found, c->extremes[e].infinite ? 0 : 1);
    }
    for (int k = 1; k < n; k++) {
        CHECK(t, kept[k] > kept[k - 1]);
        for (int i = kept[k - 1] + 1; i < kept[k]; i++) {
            worst = fmax(worst, drawn_off(c, kept[k - 1], kept[k], i));
        }
    }
    CHECK(t, worst <= off);
}

/* A picture needs few of the points, extremes always; of a resonance that nothing damps both
 * sides, and nothing is drawn through it. */
static void curve__is_drawn_by_few_points(mt_test *t)
{
    static const double ZETA[] = {0.5, 0.02, 1e-5, 0.0};
    for (int r = 0; r < (int)(sizeof ZETA / sizeof ZETA[0]); r++) {
        forced p;
        forced_all(&p, 1);
        p.k[0] = 300.0;
        p.m[0] = 3.0;
        p.c[0] = 60.0 * ZETA[r];
        p.f.c = p.c;
        mt_test_row(t, "ratio %g", ZETA[r]);
        mt_curve c = {.n = 0};
        if (forced_make(t, &p, 0) && trace(t, &p, 0.1, 1000.0, true, &c)) {
            check_thin(t, &p, &c, 400, 0.021);
            check_thin(t, &p, &c, 8, 1e9);
        }
        mt_arena_free(&p.mem);
    }
}

/* A mass with an absorber: the antiresonance of the mass is the absorber's own frequency. */
static void curve__an_absorber_makes_an_antiresonance(mt_test *t)
{
    for (int damped = 0; damped < 2; damped++) {
        forced p;
        forced_all(&p, 2);
        p.m[0] = 4.0;
        p.m[3] = 0.25;
        forced_between(p.k, 2, -1, 0, 400.0);
        forced_between(p.k, 2, 0, 1, 36.0);
        forced_between(p.c, 2, -1, 0, damped ? 0.5 : 0.0);
        p.f.c = damped ? p.c : NULL;
        mt_test_row(t, "%s", damped ? "damped" : "undamped");
        mt_curve c = {.n = 0};
        if (forced_make(t, &p, 0) && trace(t, &p, 2.0, 50.0, false, &c)) {
            int zeros = 0;
            int infinite = 0;
            for (int e = 0; e < c.n_extremes; e++) {
                const mt_extreme *const x = &c.extremes[e];
                CHECK_INT(t, x->antiresonance, x->pair % 3 == 0 && !x->peak);
                if (x->pair == 0 && !x->peak) {
                    zeros++;
                    CHECK_NEAR(t, c.extremes[e].w, 12.0, PLACE);
                    CHECK(t, cabs(c.extremes[e].h) <= c.extremes[e].error);
                }
                infinite += c.extremes[e].infinite ? 1 : 0;
            }
            CHECK_INT(t, zeros, 1);
            CHECK_INT(t, infinite, damped ? 0 : 8);
        }
        mt_arena_free(&p.mem);
    }
}

/* A point of the grid is a resonance to the bit, or next to it. */
static void curve__a_resonance_on_the_grid_is_found_once(mt_test *t)
{
    for (int off = -1; off <= 1; off++) {
        forced p;
        forced_all(&p, 1);
        p.k[0] = 16.0;
        p.m[0] = 1.0;
        const double from = 4.0 - (19.0 * 0.1) + (off * 1e-15);
        mt_test_row(t, "off %d", off);
        mt_curve c = {.n = 0};
        if (forced_make(t, &p, 0) && trace(t, &p, 4.0, 6.0, false, &c)) {
            CHECK_INT(t, c.n_extremes, 1);
            CHECK(t, c.extremes[0].infinite);
        }
        if (trace(t, &p, from, from + 3.8, false, &c)) {
            CHECK_INT(t, c.n_extremes, 1);
            CHECK(t, c.extremes[0].infinite);
            CHECK_NEAR(t, c.extremes[0].w, 4.0, 1e-14);
        }
        mt_arena_free(&p.mem);
    }
}

static void curve__lines_between_points_hold(mt_test *t)
{
    for (int log_scale = 0; log_scale < 2; log_scale++) {
        forced p;
        forced_all(&p, 5);
        for (ptrdiff_t i = 0; i < 5; i++) {
            p.m[i + (i * 5)] = 1.0 + (double)i;
            forced_between(p.k, 5, (int)i - 1, (int)i, 1e4);
            forced_between(p.h, 5, (int)i - 1, (int)i, 60.0 + (100.0 * (double)i));
        }
        p.f.h = p.h;
        p.f.n_in = 1;
        mt_test_row(t, "%s", log_scale ? "log" : "linear");
        mt_curve c = {.n = 0};
        const mt_transfer *const tr = &p.basis.t;
        if (forced_make(t, &p, 0) && trace(t, &p, 5.0, 300.0, log_scale == 1, &c)) {
            mt_sample s = forced_sample(&p, &p.mem);
            CHECK(t, c.n < 500);
            for (int i = 0; i + 1 < c.n; i++) {
                CHECK(t, c.w[i + 1] > c.w[i]);
                const double w =
                    log_scale ? sqrt(c.w[i] * c.w[i + 1]) : 0.5 * (c.w[i] + c.w[i + 1]);
                CHECK(t, mt_transfer_at(tr, w, &s, &p.mem, &p.err) == MT_OK);
                for (int pair = 0; pair < 5; pair++) {
                    const double line = 0.5 * (log(cabs(c.h[pair + (i * 5)])) +
                                               log(cabs(c.h[pair + ((i + 1) * 5)])));
                    CHECK_NEAR_ABS(t, log(cabs(s.h[pair])), line, BETWEEN);
                }
            }
        }
        mt_arena_free(&p.mem);
    }
}

MT_TEST_MAIN(MT_TEST(curve__one_mass_peaks_at_its_closed_form),
             MT_TEST(curve__is_drawn_by_few_points),
             MT_TEST(curve__an_absorber_makes_an_antiresonance),
             MT_TEST(curve__a_resonance_on_the_grid_is_found_once),
             MT_TEST(curve__lines_between_points_hold))
