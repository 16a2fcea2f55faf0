/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives against central differences, judged by their order of agreement; each check also
 * refuses a slope that is wrong by one in a million. */
#include <float.h>
#include <math.h>

#include "linalg/dense.h"
#include "modal/chain.h"
#include "modal/modal.h"
#include "support/mt_random.h"
#include "support/mt_slope.h"
#include "support/mt_test.h"
#include "support/solve_pair.h"

enum { N = 6, P = 5 };

/* h for parameters of order one whose functions bend on a scale of order one. */
static const double STEP = 3e-4;
/* Error of one evaluation: the eigenvalues spread over a factor of some tens. Agreement is then
 * judged to about 1e-8. */
static const double NOISE = 100.0 * DBL_EPSILON;
/* The planted error, of the largest slope of that function: a small slope of a strongly bent
 * function is not measurable to six digits of its own. */
static const double PLANTED = 1e-6;

static mt_arena mem;

/* K = sum x_p Kp, M = sum (1 + x_p) Mp: symmetric, Kp and Mp positive definite for x near 1. */
typedef struct family {
    double kp[P][N * N];
    double mp[P][N * N];
    double b[N];   /* a reference shape */
    bool massless; /* the last coordinate has no mass */
    int mode;
    int entry;        /* of the vector; -1: the eigenvalue; -2: MAC with b */
    const double *y0; /* decides the sign */
} family;

static void gram(mt_random *g, double size, bool massless, double *a)
{
    double root[N * N];
    mt_random_fill(g, N * N, root);
    for (int j = 0; j < N && massless; j++) {
        root[N - 1 + j * N] = 0.0;
    }
    mt_gemm(false, true, N, N, N, size, root, N, root, N, 0.0, a, N);
}

static void random_family(mt_random *g, bool massless, family *f)
{
    f->massless = massless;
    for (int p = 0; p < P; p++) {
        gram(g, 1.0, false, f->kp[p]);
        gram(g, 0.1, massless, f->mp[p]);
        for (int i = 0; i < N - (massless ? 1 : 0); i++) {
            f->mp[p][i + i * N] += 0.3;
        }
    }
    mt_random_fill(g, N, f->b);
}

static void assemble(const family *f, const double *x, double *k, double *m)
{
    for (int e = 0; e < N * N; e++) {
        k[e] = 0.0;
        m[e] = 0.0;
        for (int p = 0; p < P; p++) {
            k[e] += x[p] * f->kp[p][e];
            m[e] += (1.0 + x[p]) * f->mp[p][e];
        }
    }
}

static double mac_with(const family *f, const double *y)
{
    double mac = 0.0;
    mt_mac_matrix(N, 1, y, 1, f->b, &mac);
    return mac;
}

static double value(const void *ctx, int n, const double *x)
{
    const family *const f = ctx;
    double k[N * N];
    double m[N * N];
    mt_modes modes;
    (void)n;
    assemble(f, x, k, m);
    const mt_arena_mark mark = mt_arena_get_mark(&mem);
    const bool ok = solve_pair(N, k, m, NULL, NULL, &mem, &modes, NULL) == MT_OK;
    double result = nan("");
    if (ok) {
        const double *const y = modes.y + (ptrdiff_t)f->mode * N;
        const double sign = mt_dot(N, y, f->y0) < 0.0 ? -1.0 : 1.0;
        result = f->entry == -1 ? modes.lambda[f->mode] : mac_with(f, y);
        result = f->entry >= 0 ? sign * y[f->entry] : result;
    }
    mt_arena_rewind(&mem, mark);
    return result;
}

static void check_slope(mt_test *t, const family *f, double *x, int p, double slope,
                        double most)
{
    const double wrong = slope + PLANTED * most;
    CHECK(t, mt_slope_agrees(value, f, P, x, p, slope, STEP, NOISE));
    CHECK(t, !mt_slope_agrees(value, f, P, x, p, wrong, STEP, NOISE));
}

/* dky, dmy: N x P products with mode i. */
static void products(const family *f, const double *y, double *dky, double *dmy)
{
    for (int p = 0; p < P; p++) {
        mt_symm(N, 1, f->kp[p], y, dky + (ptrdiff_t)p * N);
        mt_symm(N, 1, f->mp[p], y, dmy + (ptrdiff_t)p * N);
    }
}

typedef struct solved {
    double k[N * N];
    double m[N * N];
    mt_modes modes;
    double dky[N * P];
    double dmy[N * P];
    double dy[N * P];
    double dlambda[P];
} solved;

static void check_mode(mt_test *t, family *f, double *x, const solved *s)
{
    const double *const y = s->modes.y + (ptrdiff_t)f->mode * N;
    double dmac[P];
    f->y0 = y;
    for (int p = 0; p < P; p++) {
        const ptrdiff_t at = (ptrdiff_t)p * N;
        const double only =
            mt_dot(N, y, s->dky + at) - (s->modes.lambda[f->mode] * mt_dot(N, y, s->dmy + at));
        CHECK_NEAR_ABS(t, s->dlambda[p], only, 1e-11 * (1.0 + s->modes.scale));
        dmac[p] = mt_mac_derivative(N, y, s->dy + at, f->b);
    }
    for (int p = 0; p < P; p++) {
        f->entry = -1;
        check_slope(t, f, x, p, s->dlambda[p], mt_max_abs(P, s->dlambda));
        f->entry = -2;
        check_slope(t, f, x, p, dmac[p], mt_max_abs(P, dmac));
        for (f->entry = 0; f->entry < N; f->entry++) {
            check_slope(t, f, x, p, s->dy[f->entry + p * N],
                        mt_max_abs((ptrdiff_t)N * P, s->dy));
        }
    }
}

static void derivative__values_vectors_and_mac_follow_the_slope(mt_test *t)
{
    for (int massless = 0; massless < 2; massless++) {
        mt_random g = mt_random_seed(41);
        family f;
        solved s;
        double x[P] = {1.0, 0.8, 1.2, 0.9, 1.1};
        random_family(&g, massless == 1, &f);
        assemble(&f, x, s.k, s.m);
        REQUIRE(t, solve_pair(N, s.k, s.m, NULL, NULL, &mem, &s.modes, NULL) == MT_OK);
        CHECK_INT(t, s.modes.count, N - massless);
        for (int i = 0; i < s.modes.count; i++) {
            const mt_pencil pencil = {.n = N, .k = s.k, .m = s.m};
            const double *const y = s.modes.y + (ptrdiff_t)i * N;
            const mt_directions dir = {.np = P, .dky = s.dky, .dmy = s.dmy};
            mt_test_row(t, "massless %d, mode %d", massless, i);
            f.mode = i;
            products(&f, y, s.dky, s.dmy);
            REQUIRE(t, mt_modal_dvector(&pencil, s.modes.lambda[i], y, &dir, s.dy, s.dlambda,
                                        &mem, NULL) == MT_OK);
            check_mode(t, &f, x, &s);
            double dy[N * P];
            double dlambda[P];
            const mt_status rc =
                mt_modal_dvector_by_modes(&s.modes, i, &dir, dy, dlambda, &mem, NULL);
            CHECK_INT(t, rc, massless ? MT_E_USAGE : MT_OK);
            for (int e = 0; e < N * P && rc == MT_OK; e++) {
                CHECK_NEAR_ABS(t, dy[e], s.dy[e], 1e-11);
            }
            for (int p = 0; p < P && rc == MT_OK; p++) {
                CHECK_NEAR_ABS(t, dlambda[p], s.dlambda[p], 1e-11 * (1.0 + s.modes.scale));
            }
        }
    }
}

static void derivative__constant_mass_may_be_left_out(mt_test *t)
{
    mt_random g = mt_random_seed(42);
    family f;
    solved s;
    const double x[P] = {1.0, 1.0, 1.0, 1.0, 1.0};
    const double zero[N * P] = {0.0};
    double dy[N * P];
    double dlambda[P];
    random_family(&g, false, &f);
    assemble(&f, x, s.k, s.m);
    REQUIRE(t, solve_pair(N, s.k, s.m, NULL, NULL, &mem, &s.modes, NULL) == MT_OK);
    const double *const y = s.modes.y + 2 * (ptrdiff_t)N;
    const mt_pencil pencil = {.n = N, .k = s.k, .m = s.m};
    products(&f, y, s.dky, s.dmy);
    const mt_directions with = {.np = P, .dky = s.dky, .dmy = zero};
    const mt_directions without = {.np = P, .dky = s.dky};
    CHECK_INT(t, mt_modal_dvector_by_modes(&s.modes, 2, &with, s.dy, s.dlambda, &mem, NULL),
              MT_OK);
    CHECK_INT(t, mt_modal_dvector_by_modes(&s.modes, 2, &without, dy, dlambda, &mem, NULL),
              MT_OK);
    for (int p = 0; p < P; p++) {
        CHECK_NEAR(t, dlambda[p], s.dlambda[p], 0.0);
        CHECK_NEAR(t, mt_dot(N, y, s.dky + (ptrdiff_t)p * N), s.dlambda[p], 1e-12);
    }
    CHECK_INT(t,
              mt_modal_dvector(&pencil, s.modes.lambda[2], y, &without, dy, NULL, &mem, NULL),
              MT_OK);
    for (int e = 0; e < N * P; e++) {
        CHECK_NEAR_ABS(t, dy[e], s.dy[e], 1e-11);
    }
}

static void ring(chain *s, double first)
{
    chain_start(s, 6, 1.0);
    for (int i = 0; i < 6; i++) {
        chain_spring(s, i, (i + 1) % 6, i == 0 ? first : 1e4);
    }
}

/* Splitting of a pair when one spring of the ring changes: each branch passes through smoothly,
 * but as the upper one on one side and the lower one on the other, so its central difference
 * pairs them crosswise. */
static void derivative__clusters_split_as_their_matrix_says(mt_test *t)
{
    enum { R = 6 };
    /* of 1e4: error h^2 f''' ~ 1e-10 relative, rounding 1e-14 * 1e4 / h = 1e-8 */
    const double h = 1e-2;
    chain s;
    mt_modes modes;
    mt_modes up;
    mt_modes down;
    ring(&s, 1e4);
    REQUIRE(t, solve_pair(R, s.k, s.m, NULL, NULL, &mem, &modes, NULL) == MT_OK);
    ring(&s, 1e4 + h);
    REQUIRE(t, solve_pair(R, s.k, s.m, NULL, NULL, &mem, &up, NULL) == MT_OK);
    ring(&s, 1e4 - h);
    REQUIRE(t, solve_pair(R, s.k, s.m, NULL, NULL, &mem, &down, NULL) == MT_OK);
    for (int first = 1; first <= 3; first += 2) {
        double dky[R * 2];
        double split[4];
        double w[2];
        mt_test_row(t, "pair at %d", first);
        for (int j = 0; j < 2; j++) {
            const double *const y = modes.y + (ptrdiff_t)(first + j) * R;
            for (int i = 0; i < R; i++) {
                const double pull = y[0] - y[1];
                dky[i + j * R] = i == 0 ? pull : (i == 1 ? -pull : 0.0);
            }
        }
        REQUIRE(t, mt_modal_dcluster(&modes, first, 2, dky, NULL, split, &mem, NULL) == MT_OK);
        CHECK_NEAR(t, split[1], split[2], 0.0);
        REQUIRE(t, mt_eig_sym(2, split, w, false, &mem, NULL) == MT_OK);
        for (int j = 0; j < 2; j++) {
            const double branch =
                (up.lambda[first + j] - down.lambda[first + 1 - j]) / (2.0 * h);
            CHECK_NEAR_ABS(t, w[j], branch, 1e-7);
        }
        CHECK(t, w[1] - w[0] > 0.1);
    }
}

static void derivative__a_repeated_mode_has_none(mt_test *t)
{
    enum { R = 6 };
    chain s;
    mt_modes modes;
    ring(&s, 1e4);
    REQUIRE(t, solve_pair(R, s.k, s.m, NULL, NULL, &mem, &modes, NULL) == MT_OK);
    const mt_pencil pencil = {.n = R, .k = s.k, .m = s.m};
    for (int i = 0; i < R; i++) {
        const bool simple = i == 0 || i == 5;
        const double *const y = modes.y + (ptrdiff_t)i * R;
        double dky[R] = {1.0, 2.0, 0.5, 0.0, 0.0, 1.0};
        double dy[R];
        double dlambda = 0.0;
        const mt_directions dir = {.np = 1, .dky = dky};
        const mt_status want = simple ? MT_OK : MT_E_SINGULAR;
        mt_test_row(t, "mode %d", i);
        CHECK_INT(t,
                  mt_modal_dvector(&pencil, modes.lambda[i], y, &dir, dy, &dlambda, &mem, NULL),
                  want);
        CHECK_INT(t, isnan(dy[0]) != 0 && isnan(dlambda) != 0, !simple);
        CHECK_INT(t, mt_modal_dvector_by_modes(&modes, i, &dir, dy, &dlambda, &mem, NULL),
                  want);
        CHECK_INT(t, isnan(dy[0]) != 0 && isnan(dlambda) != 0, !simple);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(derivative__values_vectors_and_mac_follow_the_slope),
        MT_TEST(derivative__constant_mass_may_be_left_out),
        MT_TEST(derivative__clusters_split_as_their_matrix_says),
        MT_TEST(derivative__a_repeated_mode_has_none),
    };
    const int failed = mt_arena_init(&mem, 0, NULL) != MT_OK
                           ? 1
                           : cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
    mt_arena_free(&mem);
    return failed != 0;
}
