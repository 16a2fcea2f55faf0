/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Root mean squares of responses: closed forms, long double, Lyapunov's equation, slopes. */
#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "mt_random.h"
#include "mt_slope.h"
#include "mt_test.h"
#include "reference.h"
#include "vibration/spectral.h"

static const mt_spectral_method WAYS[] = {MT_SPECTRAL_BEST, MT_SPECTRAL_CLOSED,
                                          MT_SPECTRAL_PANELS};
static const char *const WAY_NAMES[] = {"best", "closed", "panels"};

static mt_spectral_answer rms_of(mt_test *t, const mt_pole_sum *h, const mt_psd *g,
                                 mt_spectral_method way)
{
    mt_arena mem = {0};
    mt_spectral s;
    mt_spectral_answer a = {.rms = nan("")};
    if (CHECK_INT(t, mt_spectral_init(&s, h, &mem, NULL), MT_OK)) {
        a = mt_spectral_rms(&s, g, way);
    }
    mt_arena_free(&mem);
    return a;
}

/* White acceleration of the base: sqrt(pi/2 f Q S (1 + 4 zeta^2)), Q = 1/(2 zeta), over all
 * frequencies; the band below goes so far that what it leaves out is far below the tolerance:
 * |H| is 1 up to the resonance and 2 zeta f_n / f above. */
static void spectral__one_mass_under_white_noise(mt_test *t)
{
    static const double zetas[] = {0.9, 0.5, 0.05, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8};
    double hz[] = {1e-13, 1e15};
    double level[] = {0.37, 0.37};
    const mt_psd g = {.n = 2, .hz = hz, .level = level};
    for (int i = 0; i < MT_COUNT(zetas); i++) {
        const double zeta = zetas[i];
        const double want = sqrt((double)REF_PI / 2.0 * 22.09 / (2.0 * zeta) * level[0] *
                                 (1.0 + 4.0 * zeta * zeta));
        double complex s[2];
        double complex r[2];
        const mt_pole_sum h =
            ref_one_mass(2.0 * (double)REF_PI * 22.09, zeta, REF_ABSOLUTE, s, r);
        for (int k = 0; k < MT_COUNT(WAYS); k++) {
            const mt_spectral_answer a = rms_of(t, &h, &g, WAYS[k]);
            mt_test_row(t, "zeta %g, %s", zeta, WAY_NAMES[k]);
            CHECK_INT(t, a.end, MT_FORCED_FINITE);
            CHECK_NEAR(t, a.rms, want, 1e-11);
            CHECK(t, a.bound <= 1e-11 * want);
        }
    }
}

/* A density of several segments, of which G = a f^b; flat, steep, very steep (b = 326), a step
 * up and down. */
static mt_psd hard_density(void)
{
    static double hz[] = {1.0, 5.0, 12.0, 20.0, 20.0, 48.0, 80.0, 120.0, 121.0, 121.0, 1500.0};
    static double level[] = {1e-3, 2e-2, 2e-2, 1e-3, 5e-1, 5e-2, 2e-4, 2e-4, 3e-3, 1e-2, 1e-7};
    return (mt_psd){.n = MT_COUNT(hz), .hz = hz, .level = level};
}

static void spectral__one_mass_in_bands_agrees_with_long_double(mt_test *t)
{
    static const double zetas[] = {2.0, 0.7, 0.1, 1e-2, 1e-4, 1e-6};
    static const double hz[] = {0.01, 1.0, 3.0, 12.0, 20.0, 33.0, 120.5, 121.0, 900.0, 1e5};
    const mt_psd g = hard_density();
    for (int i = 0; i < MT_COUNT(zetas) * MT_COUNT(hz); i++) {
        const double zeta = zetas[i % MT_COUNT(zetas)];
        const double f = hz[i / MT_COUNT(zetas)];
        for (int kind = REF_RELATIVE; kind <= REF_FORCE; kind++) {
            double complex s[2];
            double complex r[2];
            const mt_pole_sum h =
                ref_one_mass(2.0 * (double)REF_PI * f, zeta, (ref_kind)kind, s, r);
            const double want = (double)sqrtl(ref_mean_square(&h, &g, true));
            const double exactly = (double)sqrtl(ref_mean_square(&h, &g, false));
            for (int k = 0; k < MT_COUNT(WAYS); k++) {
                const mt_spectral_answer a = rms_of(t, &h, &g, WAYS[k]);
                mt_test_row(t, "zeta %g, %g Hz, kind %d, %s", zeta, f, kind, WAY_NAMES[k]);
                CHECK(t, fabs(a.rms - exactly) <= a.bound + (1e-15 * want));
                if (WAYS[k] != MT_SPECTRAL_CLOSED) {
                    CHECK_NEAR(t, a.rms, want, 1e-12);
                    CHECK(t, a.bound <= (1e-10 + (4.0 * DBL_EPSILON / zeta)) * want);
                }
            }
        }
    }
}

enum { MOST_POLES = 24 };

/* Poles in pairs, some close to each other, some without a partner (structural damping), some
 * real; any residues, a polynomial. */
static mt_pole_sum any_sum(mt_random *rng, double complex *s, double complex *r)
{
    mt_pole_sum h = {.s = s, .residue = r};
    const int n = 1 + mt_random_int(rng, MOST_POLES / 2);
    for (int i = 0; i < n; i++) {
        const double w = 6.0 * pow(2000.0, mt_random_in(rng, 0.0, 1.0));
        const double zeta = pow(10.0, mt_random_in(rng, -6.0, -0.3));
        const double complex residue =
            mt_random_in(rng, -1.0, 1.0) + (mt_random_in(rng, -1.0, 1.0) * REF_I);
        const int what = mt_random_int(rng, 8);
        s[h.n] = w * (-zeta + (sqrt(1.0 - zeta * zeta) * REF_I));
        if (what == 0 && h.n > 0) {
            s[h.n] = s[h.n - 1] * (1.0 + (1e-5 * mt_random_in(rng, -1.0, 1.0)));
        }
        r[h.n++] = residue;
        if (what == 1) {
            s[h.n - 1] = -w; /* overdamped */
            r[h.n - 1] = creal(residue);
        } else if (what > 2) {
            s[h.n] = conj(s[h.n - 1]);
            r[h.n++] = conj(residue);
        }
    }
    for (int j = 0; j < 3; j++) {
        h.d[j] = mt_random_int(rng, 2) == 0 ? 0.0 : mt_random_in(rng, -1.0, 1.0) * pow(1e-3, j);
    }
    return h;
}

static void spectral__any_sum_agrees_with_long_double(mt_test *t)
{
    const int rounds = getenv("MT_EVERY") != NULL ? 400 : 40;
    mt_random rng = mt_random_seed(514);
    for (int i = 0; i < rounds; i++) {
        double complex s[MOST_POLES];
        double complex r[MOST_POLES];
        const mt_pole_sum h = any_sum(&rng, s, r);
        const mt_psd g = hard_density();
        const double want = (double)sqrtl(ref_mean_square(&h, &g, true));
        for (int k = 0; k < MT_COUNT(WAYS); k++) {
            const mt_spectral_answer a = rms_of(t, &h, &g, WAYS[k]);
            mt_test_row(t, "system %d of %d poles, %s", i, h.n, WAY_NAMES[k]);
            CHECK(t, fabs(a.rms - want) <= a.bound + (1e-15 * want));
            if (WAYS[k] != MT_SPECTRAL_CLOSED) {
                CHECK_NEAR(t, a.rms, want, 1e-11);
                CHECK(t, a.bound <= 1e-9 * want);
            }
        }
    }
}

/* Solve A x = b in place, A by rows, by elimination with pivoting. */
static void solve(ptrdiff_t n, long double *a, long double *b)
{
    for (ptrdiff_t k = 0; k < n; k++) {
        ptrdiff_t best = k;
        for (ptrdiff_t i = k + 1; i < n; i++) {
            best = fabsl(a[(i * n) + k]) > fabsl(a[(best * n) + k]) ? i : best;
        }
        for (ptrdiff_t j = 0; j < n; j++) {
            const long double x = a[(k * n) + j];
            a[(k * n) + j] = a[(best * n) + j];
            a[(best * n) + j] = x;
        }
        const long double y = b[k];
        b[k] = b[best];
        b[best] = y;
        for (ptrdiff_t i = k + 1; i < n; i++) {
            const long double f = a[(i * n) + k] / a[(k * n) + k];
            for (ptrdiff_t j = k; j < n; j++) {
                a[(i * n) + j] -= f * a[(k * n) + j];
            }
            b[i] -= f * b[k];
        }
    }
    for (ptrdiff_t k = n - 1; k >= 0; k--) {
        for (ptrdiff_t j = k + 1; j < n; j++) {
            b[k] -= a[(k * n) + j] * b[j];
        }
        b[k] /= a[(k * n) + k];
    }
}

/* n masses in a row to the ground, springs and dashpots all alike: modes are sines. White
 * forces on the first mass; x' = A x + B u, covariance A X + X A^T + B B^T S/2 = 0 with the
 * one-sided density S. */
enum { CHAIN = 3, STATES = 2 * CHAIN };

static void chain_matrix(double k, double c, long double a[STATES][STATES])
{
    for (int i = 0; i < CHAIN; i++) {
        a[i][i + CHAIN] = 1.0L;
        for (int j = 0; j < CHAIN; j++) {
            const double second = i == j ? -2.0 : abs(i - j) == 1;
            a[i + CHAIN][j] = (long double)(second * k);
            a[i + CHAIN][j + CHAIN] = (long double)(second * c);
        }
    }
}

static long double chain_variance(double k, double c, double density, int state)
{
    enum { N = STATES * STATES };
    static long double big[N][N];
    long double a[STATES][STATES] = {{0.0L}};
    long double x[N] = {0.0L};
    chain_matrix(k, c, a);
    memset(big, 0, sizeof big);
    x[(CHAIN * STATES) + CHAIN] = -0.5L * (long double)density;
    for (int i = 0; i < N; i++) {
        for (int q = 0; q < STATES; q++) {
            big[i][(q * STATES) + (i % STATES)] += a[i / STATES][q];
            big[i][(i / STATES * STATES) + q] += a[i % STATES][q];
        }
    }
    solve(N, &big[0][0], x);
    return x[(state * STATES) + state];
}

static void spectral__chain_under_white_force_agrees_with_lyapunov(mt_test *t)
{
    double hz[] = {1e-12, 1e14};
    double level[] = {0.8, 0.8};
    const mt_psd g = {.n = 2, .hz = hz, .level = level};
    for (int state = 0; state < STATES; state++) {
        const double k = 4.0e4;
        const double c = 5.0;
        double complex s[STATES];
        double complex r[STATES];
        const mt_pole_sum h = {.n = STATES, .s = s, .residue = r};
        for (ptrdiff_t m = 0; m < CHAIN; m++) {
            const double angle = (double)REF_PI * (double)(m + 1) / (CHAIN + 1);
            const double lambda = 2.0 - (2.0 * cos(angle));
            const double shape =
                2.0 / (CHAIN + 1) * sin(angle) * sin(angle * ((state % CHAIN) + 1));
            const double damps = 0.5 * c * lambda;
            s[2 * m] = -damps + (sqrt((k * lambda) - (damps * damps)) * REF_I);
            s[(2 * m) + 1] = conj(s[2 * m]);
            r[2 * m] = shape / (s[2 * m] - s[(2 * m) + 1]) * (state < CHAIN ? 1.0 : s[2 * m]);
            r[(2 * m) + 1] = conj(r[2 * m]);
        }
        const double want = (double)sqrtl(chain_variance(k, c, level[0], state));
        for (int way = 0; way < MT_COUNT(WAYS); way++) {
            mt_test_row(t, "state %d, %s", state, WAY_NAMES[way]);
            CHECK_NEAR(t, rms_of(t, &h, &g, WAYS[way]).rms, want, 1e-10);
        }
    }
}

static void spectral__what_has_no_number_says_why(mt_test *t)
{
    static const struct {
        const char *name;
        double re;
        double im;
        double residue;
        mt_forced_end end;
    } rows[] = {
        {"undamped, in the band", 0.0, 60.0, 1.0, MT_FORCED_INFINITE},
        {"by rounding only", -1e-15, 60.0, 1.0, MT_FORCED_INFINITE},
        {"undamped, not excited", 0.0, 60.0, 0.0, MT_FORCED_FINITE},
        {"undamped, at the end of the band", 0.0, 6.28318530717958647693, 1.0,
         MT_FORCED_INFINITE},
        {"undamped, outside", 0.0, 1e4, 1.0, MT_FORCED_FINITE},
        {"rigid", 0.0, 0.0, 1.0, MT_FORCED_FINITE},
        {"growing", 0.1, 60.0, 1.0, MT_FORCED_UNSTABLE},
        {"growing, outside", 0.1, 1e4, 1.0, MT_FORCED_UNSTABLE},
        {"growing, though this pair does not see it", 0.1, 60.0, 0.0, MT_FORCED_UNSTABLE},
        {"divergent", 5.0, 0.0, 1.0, MT_FORCED_UNSTABLE},
        {"mirror image of structural damping", 0.1, -60.0, 1.0, MT_FORCED_FINITE},
    };
    double hz[] = {1.0, 20.0};
    double level[] = {1.0, 1.0};
    const mt_psd g = {.n = 2, .hz = hz, .level = level};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const double complex s = rows[i].re + (rows[i].im * REF_I);
        const double complex r = rows[i].residue;
        const mt_pole_sum h = {.n = 1, .s = &s, .residue = &r, .d = {1.0}};
        const mt_spectral_answer a = rms_of(t, &h, &g, MT_SPECTRAL_BEST);
        mt_test_row(t, "%s", rows[i].name);
        CHECK_INT(t, a.end, rows[i].end);
        CHECK(t, a.end == MT_FORCED_FINITE ? isfinite(a.rms) && a.bound <= 1e-9 * a.rms
                                           : a.rms != a.rms && a.pole == 0);
    }
}

/* An undamped resonance next to a band, where the density slopes: the closed form has no answer
 * and says so, the other way has. */
static void spectral__undamped_beside_a_band(mt_test *t)
{
    static const double hz[] = {0.9, 0.9999, 20.0001, 22.0, 90.0};
    double ends[] = {1.0, 20.0};
    double level[] = {1.0, 7.0};
    const mt_psd g = {.n = 2, .hz = ends, .level = level};
    for (int i = 0; i < MT_COUNT(hz); i++) {
        const double w = 2.0 * (double)REF_PI * hz[i];
        const double complex s[] = {w * REF_I, -w * REF_I};
        const double complex r[] = {-0.5 * w * REF_I, 0.5 * w * REF_I};
        const mt_pole_sum h = {.n = 2, .s = s, .residue = r};
        const double want = (double)sqrtl(ref_mean_square(&h, &g, true));
        for (int k = 0; k < MT_COUNT(WAYS); k++) {
            const mt_spectral_answer a = rms_of(t, &h, &g, WAYS[k]);
            mt_test_row(t, "%g Hz, %s", hz[i], WAY_NAMES[k]);
            CHECK(t, fabs(a.rms - want) <= a.bound + (1e-15 * want));
            CHECK(t, WAYS[k] == MT_SPECTRAL_CLOSED || a.bound <= 1e-10 * want);
        }
    }
    mt_arena mem = {0};
    mt_spectral of;
    const double complex s = 2.0 * (double)REF_PI * 4.0 * REF_I;
    const double complex r = 1.0;
    const mt_pole_sum h = {.n = 1, .s = &s, .residue = &r};
    REQUIRE(t, mt_spectral_init(&of, &h, &mem, NULL) == MT_OK);
    CHECK(t, mt_spectral_psd(&of, &g, 4.0) == HUGE_VAL);
    CHECK(t, isfinite(mt_spectral_psd(&of, &g, 4.1)));
    mt_arena_free(&mem);
}

static void spectral__refuses_numbers_that_are_not_finite(mt_test *t)
{
    mt_arena mem = {0};
    mt_spectral out;
    for (int i = 0; i < 3; i++) {
        const double complex bad = nan("");
        const double complex s = i == 0 ? bad : (double complex) - 1.0;
        const double complex r = i == 1 ? bad : (double complex)1.0;
        const mt_pole_sum h = {.n = 1, .s = &s, .residue = &r, .d = {i == 2 ? bad : 0.0}};
        CHECK_INT(t, mt_spectral_init(&out, &h, &mem, NULL), MT_E_DOMAIN);
    }
    mt_arena_free(&mem);
}

/* Next to a double pole the two residues are large and cancel. */
static void spectral__poles_next_to_each_other(mt_test *t)
{
    static const double gaps[] = {1e-1, 1e-3, 1e-5, 1e-7};
    const mt_psd g = hard_density();
    for (int i = 0; i < MT_COUNT(gaps); i++) {
        const double complex a = -0.3 + (130.0 * REF_I);
        const double complex s[] = {a, a * (1.0 + gaps[i]), conj(a), conj(a * (1.0 + gaps[i]))};
        const double complex one = 1.0 / (s[0] - s[1]);
        const double complex r[] = {one, -one, conj(one), -conj(one)};
        const mt_pole_sum h = {.n = 4, .s = s, .residue = r};
        const double want = (double)sqrtl(ref_mean_square(&h, &g, true));
        for (int k = 0; k < MT_COUNT(WAYS); k++) {
            const mt_spectral_answer b = rms_of(t, &h, &g, WAYS[k]);
            mt_test_row(t, "gap %g, %s", gaps[i], WAY_NAMES[k]);
            CHECK(t, fabs(b.rms - want) <= b.bound + (1e-15 * want));
            if (WAYS[k] != MT_SPECTRAL_CLOSED) {
                CHECK_NEAR(t, b.rms, want, 1e-15 / gaps[i] + 1e-13);
            }
        }
    }
}

static void spectral__density_of_the_response(mt_test *t)
{
    double complex s[2];
    double complex r[2];
    mt_arena mem = {0};
    mt_spectral of;
    const mt_psd g = hard_density();
    const mt_pole_sum h = ref_one_mass(100.0, 0.02, REF_ABSOLUTE, s, r);
    REQUIRE(t, mt_spectral_init(&of, &h, &mem, NULL) == MT_OK);
    for (int i = 0; i < g.n; i++) {
        const double size = ref_size(&h, 2.0 * (double)REF_PI * g.hz[i]);
        const double level =
            fmax(g.level[i], i > 0 && g.hz[i - 1] == g.hz[i]         ? g.level[i - 1]
                             : i + 1 < g.n && g.hz[i + 1] == g.hz[i] ? g.level[i + 1]
                                                                     : 0.0);
        mt_test_row(t, "%g Hz", g.hz[i]);
        CHECK_NEAR(t, mt_spectral_psd(&of, &g, g.hz[i]), size * size * level, 1e-13);
    }
    CHECK(t, mt_spectral_psd(&of, &g, 0.999) == 0.0);
    CHECK(t, mt_spectral_psd(&of, &g, 1501.0) == 0.0);
    mt_arena_free(&mem);
}

/* RMS of two masses as a function of stiffness, damping ratio and coupling: all poles and
 * residues move. */
enum { UNKNOWNS = 3 };

static mt_pole_sum moved(const double *x, double complex *s, double complex *r)
{
    mt_pole_sum a = ref_one_mass(x[0], x[1], REF_ABSOLUTE, s, r);
    mt_pole_sum b = ref_one_mass(x[0] * 1.3, x[1] * 0.5, REF_RELATIVE, s + 2, r + 2);
    r[2] *= x[2];
    r[3] = conj(r[2]);
    a.n += b.n;
    a.d[0] = x[2];
    a.d[1] = 1e-3 * x[2] * x[2];
    return a;
}

static double moved_rms(const void *ctx, int n, const double *x)
{
    double complex s[4];
    double complex r[4];
    mt_arena mem = {0};
    mt_spectral of;
    (void)n;
    const mt_pole_sum h = moved(x, s, r);
    const double rms = mt_spectral_init(&of, &h, &mem, NULL) == MT_OK
                           ? mt_spectral_rms(&of, ctx, MT_SPECTRAL_PANELS).rms
                           : nan("");
    mt_arena_free(&mem);
    return rms;
}

/* The derivatives of poles and residues by difference in long double-like accuracy: complex
 * functions of a real unknown, central and Richardson. */
static void moved_by(const double *x, int i, double complex *ds, double complex *dr,
                     double complex *dd)
{
    double complex s[4][4];
    double complex r[4][4];
    mt_pole_sum h[4];
    const double step = 1e-3 * x[i];
    for (int q = 0; q < 4; q++) {
        double y[UNKNOWNS] = {x[0], x[1], x[2]};
        y[i] += (q < 2 ? step : 0.5 * step) * (q % 2 == 0 ? 1.0 : -1.0);
        h[q] = moved(y, s[q], r[q]);
    }
    for (int k = 0; k < 4; k++) {
        const double complex wide = (s[0][k] - s[1][k]) / (2.0 * step);
        const double complex near = (s[2][k] - s[3][k]) / step;
        const double complex wide_r = (r[0][k] - r[1][k]) / (2.0 * step);
        const double complex near_r = (r[2][k] - r[3][k]) / step;
        ds[k] = (4.0 * near - wide) / 3.0;
        dr[k] = (4.0 * near_r - wide_r) / 3.0;
    }
    for (int j = 0; j < 3; j++) {
        dd[j] =
            (4.0 * (h[2].d[j] - h[3].d[j]) / step - (h[0].d[j] - h[1].d[j]) / (2.0 * step)) /
            3.0;
    }
}

static void spectral__slopes_agree_with_differences(mt_test *t)
{
    static const double zetas[] = {0.3, 0.02, 1e-3};
    const mt_psd g = hard_density();
    for (int q = 0; q < MT_COUNT(zetas); q++) {
        double x[UNKNOWNS] = {110.0, zetas[q], 900.0};
        double complex s[4];
        double complex r[4];
        double complex by_s[4];
        double complex by_r[4];
        double complex by_d[3];
        mt_arena mem = {0};
        mt_spectral of;
        mt_spectral_nodes nodes;
        const mt_pole_sum h = moved(x, s, r);
        REQUIRE(t, mt_spectral_init(&of, &h, &mem, NULL) == MT_OK);
        mt_spectral_slopes(&of, &g, by_s, by_r, by_d);
        CHECK_INT(t, mt_spectral_slope_nodes(&of, &g, &mem, &nodes, NULL), MT_OK);
        for (int i = 0; i < UNKNOWNS; i++) {
            double complex ds[4];
            double complex dr[4];
            double complex dd[3];
            double slope = 0.0;
            double by_nodes = 0.0;
            moved_by(x, i, ds, dr, dd);
            for (int k = 0; k < 4; k++) {
                slope += creal((by_s[k] * ds[k]) + (by_r[k] * dr[k]));
            }
            for (int j = 0; j < 3; j++) {
                slope += creal(by_d[j] * dd[j]);
            }
            for (int p = 0; p < nodes.n; p++) {
                const double complex iw = nodes.omega[p] * REF_I;
                double complex dh = dd[0] + (iw * dd[1]) + (iw * iw * dd[2]);
                for (int k = 0; k < 4; k++) {
                    dh += (dr[k] / (iw - s[k])) + (r[k] * ds[k] / ((iw - s[k]) * (iw - s[k])));
                }
                by_nodes += creal(nodes.weight[p] * dh);
            }
            mt_test_row(t, "zeta %g, unknown %d", zetas[q], i);
            CHECK_NEAR(t, by_nodes, slope, 1e-10);
            CHECK(t, mt_slope_agrees(moved_rms, &g, UNKNOWNS, x, i, slope,
                                     2e-3 * x[i] * (i == 0 ? zetas[q] : 1.0), 1e-13));
        }
        mt_arena_free(&mem);
    }
}

static void spectral__nothing_comes_of_nothing(mt_test *t)
{
    mt_arena mem = {0};
    mt_spectral of;
    mt_spectral_nodes nodes = {.n = 1};
    double complex by_d[3];
    const mt_pole_sum h = {.n = 0};
    const mt_psd g = hard_density();
    REQUIRE(t, mt_spectral_init(&of, &h, &mem, NULL) == MT_OK);
    const mt_spectral_answer a = mt_spectral_rms(&of, &g, MT_SPECTRAL_BEST);
    CHECK(t, a.end == MT_FORCED_FINITE && a.rms == 0.0 && a.bound == 0.0);
    CHECK_INT(t, mt_spectral_slope_nodes(&of, &g, &mem, &nodes, NULL), MT_OK);
    CHECK_INT(t, nodes.n, 0);
    mt_spectral_slopes(&of, &g, NULL, NULL, by_d);
    CHECK(t, creal(by_d[0]) == 0.0);
    mt_arena_free(&mem);
}

/* A constant response: the density's own integral. */
static void spectral__constant_response_gives_the_input(mt_test *t)
{
    const mt_psd g = hard_density();
    const mt_pole_sum h = {.n = 0, .d = {2.0}};
    for (int k = 0; k < MT_COUNT(WAYS); k++) {
        mt_test_row(t, "%s", WAY_NAMES[k]);
        CHECK_NEAR(t, rms_of(t, &h, &g, WAYS[k]).rms, 2.0 * sqrt(mt_psd_mean_square(&g)),
                   1e-14);
    }
    for (int p = 1; p < 3; p++) { /* i w and its square */
        mt_pole_sum q = {.n = 0};
        q.d[p] = 1.0;
        const double want = (double)sqrtl(ref_mean_square(&q, &g, false));
        for (int k = 0; k < MT_COUNT(WAYS); k++) {
            mt_test_row(t, "power %d, %s", p, WAY_NAMES[k]);
            CHECK_NEAR(t, rms_of(t, &q, &g, WAYS[k]).rms, want, 1e-13);
        }
    }
}

MT_TEST_MAIN(MT_TEST(spectral__one_mass_under_white_noise),
             MT_TEST(spectral__one_mass_in_bands_agrees_with_long_double),
             MT_TEST(spectral__any_sum_agrees_with_long_double),
             MT_TEST(spectral__chain_under_white_force_agrees_with_lyapunov),
             MT_TEST(spectral__what_has_no_number_says_why),
             MT_TEST(spectral__undamped_beside_a_band),
             MT_TEST(spectral__refuses_numbers_that_are_not_finite),
             MT_TEST(spectral__poles_next_to_each_other),
             MT_TEST(spectral__density_of_the_response),
             MT_TEST(spectral__slopes_agree_with_differences),
             MT_TEST(spectral__nothing_comes_of_nothing),
             MT_TEST(spectral__constant_response_gives_the_input))
