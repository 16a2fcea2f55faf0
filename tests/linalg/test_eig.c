/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "support/mt_random.h"
#include "support/mt_test.h"

enum { MOST = 70 };

/* LAPACK's own test ratios stay below 30 for its residuals in units of n eps; healthy results
 * are near one. */
static const double RATIO = 10.0;

static mt_arena mem;

/* Random symmetric matrix with NaN in the upper triangle. */
static void poisoned_symmetric(mt_random *r, int n, double *a)
{
    mt_random_fill(r, n * n, a);
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < j; i++) {
            a[i + j * n] = nan("");
        }
    }
}

/* max |A V - V W| and max |V^T V - I| over n eps max|w|. */
static double residual(int n, const double *a, const double *v, const double *w)
{
    static double av[MOST * MOST];
    mt_symm(n, n, a, v, av);
    for (int j = 0; j < n; j++) {
        mt_axpy(n, -w[j], v + (ptrdiff_t)j * n, av + (ptrdiff_t)j * n);
    }
    return mt_max_abs((ptrdiff_t)n * n, av) / (n * DBL_EPSILON * mt_max_abs(n, w));
}

static double orthogonality(int n, const double *v)
{
    static double g[MOST * MOST];
    mt_gemm(true, false, n, n, n, 1.0, v, n, v, n, 0.0, g, n);
    for (int i = 0; i < n; i++) {
        g[i + i * n] -= 1.0;
    }
    return mt_max_abs((ptrdiff_t)n * n, g) / (n * DBL_EPSILON);
}

/* D C D with D over many decades and C = Q Q^T + I of Q random: its small eigenvalues are those
 * of the Schur complements, whatever is large beside them. */
static void eig__graded_solutions_have_small_residuals_in_each_scale(mt_test *t)
{
    static const double step[] = {1.0, 0.5, 1e-2, 1e-3};
    enum { N = 12 };
    static double c[N * N];
    static double a[N * N];
    static double v[N * N];
    double d[N];
    double w[N];
    mt_random r = mt_random_seed(7);
    for (int k = 0; k < MT_COUNT(step); k++) {
        mt_test_row(t, "step %g", step[k]);
        mt_random_fill(&r, N * N, v);
        mt_gemm(false, true, N, N, N, 1.0, v, N, v, N, 0.0, c, N);
        for (int i = 0; i < N; i++) {
            d[i] = pow(step[k], i);
            c[i + i * N] += 1.0;
        }
        for (int j = 0; j < N; j++) {
            for (int i = 0; i < N; i++) {
                a[i + j * N] = i < j ? nan("") : d[i] * c[i + j * N] * d[j];
            }
        }
        memcpy(v, a, sizeof a);
        REQUIRE(t, mt_eig_graded(N, v, w, &mem, NULL) == MT_OK);
        mt_symmetrise_lower(N, a);
        CHECK(t, orthogonality(N, v) <= RATIO);
        REQUIRE(t, mt_eig_sym(N, c, d, false, &mem, NULL) == MT_OK);
        const double unit = RATIO * N * N * DBL_EPSILON * (d[N - 1] / d[0]);
        for (int j = 0; j < N; j++) { /* v_i^T A v_j in the size of both */
            double av[N];
            mt_symm(N, 1, a, v + (ptrdiff_t)j * N, av);
            CHECK(t, j == 0 || w[j] <= w[j - 1]);
            for (int i = 0; i <= j; i++) {
                const double sum = mt_dot(N, v + (ptrdiff_t)i * N, av);
                CHECK_NEAR_ABS(t, sum / sqrt(w[i] * w[j]), i == j ? 1.0 : 0.0, unit);
            }
        }
    }
    v[0] = -1.0;
    CHECK_INT(t, mt_eig_graded(1, v, w, &mem, NULL), MT_E_NOT_SPD);
    CHECK_INT(t, mt_eig_graded(0, v, w, &mem, NULL), MT_OK);
}

static void eig__symmetric_solutions_have_small_residuals(mt_test *t)
{
    static const int orders[] = {1, 2, 3, 11, 26, 33, MOST};
    static double a[MOST * MOST];
    static double v[MOST * MOST];
    double w[MOST];
    double only[MOST];
    mt_random r = mt_random_seed(1);
    for (int k = 0; k < MT_COUNT(orders); k++) {
        const int n = orders[k];
        mt_test_row(t, "n = %d", n);
        poisoned_symmetric(&r, n, a);
        memcpy(v, a, sizeof a);
        CHECK_INT(t, mt_eig_sym(n, v, w, true, &mem, NULL), MT_OK);
        CHECK(t, residual(n, a, v, w) <= RATIO * t->tol_scale);
        CHECK(t, orthogonality(n, v) <= RATIO * t->tol_scale);
        memcpy(v, a, sizeof a);
        CHECK_INT(t, mt_eig_sym(n, v, only, false, &mem, NULL), MT_OK);
        for (int i = 0; i < n; i++) {
            CHECK_NEAR_ABS(t, only[i], w[i], RATIO * n * DBL_EPSILON * mt_max_abs(n, w));
            CHECK(t, i == 0 || w[i - 1] <= w[i]);
        }
    }
    CHECK_INT(t, mem.used, 0);
}

/* -1, 2, -1: lambda_k = 4 sin^2(k pi / 2(n + 1)). */
static void eig__second_difference_matches_closed_form(mt_test *t)
{
    const int n = 20;
    double a[400] = {0};
    double w[20];
    for (int i = 0; i < n; i++) {
        a[i + i * n] = 2.0;
        if (i + 1 < n) {
            a[i + 1 + i * n] = -1.0;
        }
    }
    CHECK_INT(t, mt_eig_sym(n, a, w, false, &mem, NULL), MT_OK);
    for (int k = 1; k <= n; k++) {
        const double s = sin(k * acos(-1.0) / (2.0 * (n + 1)));
        CHECK_NEAR_ABS(t, w[k - 1], 4.0 * s * s, RATIO * n * DBL_EPSILON * 4.0);
    }
}

/* Companion matrix of (x - 1)(x - 2)(x^2 + 1). */
static void eig__general_finds_real_and_complex_roots(mt_test *t)
{
    /* x^4 - 3 x^3 + 3 x^2 - 3 x + 2 */
    const double c[4] = {2.0, -3.0, 3.0, -3.0};
    double a[16] = {0};
    double wr[4];
    double wi[4];
    double vr[16];
    for (int i = 0; i < 4; i++) {
        a[i + 12] = -c[i];
        if (i > 0) {
            a[i + 4 * (i - 1)] = 1.0;
        }
    }
    CHECK_INT(t, mt_eig_general(4, a, wr, wi, vr, &mem, NULL), MT_OK);
    bool seen[4] = {false};
    const double want[4][2] = {{1.0, 0.0}, {2.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}};
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 4; k++) {
            seen[k] = seen[k] || hypot(wr[i] - want[k][0], wi[i] - want[k][1]) <= 1e-13;
        }
    }
    for (int k = 0; k < 4; k++) {
        CHECK(t, seen[k]);
    }
}

static void eig__cholesky_reproduces_and_names_the_pivot(mt_test *t)
{
    const double nil = nan("");
    /* 4 2 / 2 5: L = 2 0 / 1 2 */
    double a[4] = {4.0, 2.0, nil, 5.0};
    int bad = 7;
    CHECK_INT(t, mt_cholesky(2, a, &bad, NULL), MT_OK);
    CHECK_INT(t, bad, -1);
    CHECK_NEAR(t, a[0], 2.0, 0.0);
    CHECK_NEAR(t, a[1], 1.0, 0.0);
    CHECK_NEAR(t, a[3], 2.0, 0.0);
    CHECK(t, isnan(a[2]));
    double linv[4];
    mt_tri_inverse(2, a, linv);
    CHECK_NEAR(t, linv[1], -0.25, 1e-15);
    CHECK_NEAR(t, linv[2], 0.0, 0.0);
    /* L^-1 A L^-T of A itself is the identity; upper triangle is not read but written */
    double same[4] = {4.0, 2.0, nil, 5.0};
    mt_congruence_inverse(2, a, same);
    CHECK_NEAR_ABS(t, same[0], 1.0, 1e-15);
    CHECK_NEAR_ABS(t, same[1], 0.0, 1e-15);
    CHECK_NEAR_ABS(t, same[2], 0.0, 1e-15);
    CHECK_NEAR_ABS(t, same[3], 1.0, 1e-15);
    double indefinite[4] = {1.0, 2.0, nil, 1.0};
    mt_err err;
    CHECK_INT(t, mt_cholesky(2, indefinite, &bad, &err), MT_E_NOT_SPD);
    CHECK_INT(t, bad, 1);
    CHECK_STR(t, err.text, "the matrix loses positivity at row 2");
    double overflow[4] = {1e-300, 1e300, nil, 1.0};
    CHECK_INT(t, mt_cholesky(2, overflow, &bad, NULL), MT_E_NOT_SPD);
}

/* Inertia against eigenvalues, with badly scaled rows. */
static void eig__inertia_counts_eigenvalues_below_the_shift(mt_test *t)
{
    enum { N = 8 };
    mt_random r = mt_random_seed(5);
    for (int trial = 0; trial < 200; trial++) {
        double a[N * N];
        double v[N * N];
        double w[N];
        double gap = -1.0;
        int count[3];
        mt_test_row(t, "trial %d", trial);
        poisoned_symmetric(&r, N, a);
        memcpy(v, a, sizeof a);
        REQUIRE(t, mt_eig_sym(N, v, w, false, &mem, NULL) == MT_OK);
        const double shift = mt_random_in(&r, -2.0, 2.0);
        int below = 0;
        for (int i = 0; i < N; i++) {
            below += w[i] < shift ? 1 : 0;
        }
        /* congruence by powers of ten changes units of rows: A - shift I becomes S A S - shift
         * S^2 */
        double b[N * N];
        double sas[N * N];
        for (int j = 0; j < N; j++) {
            for (int i = 0; i < N; i++) {
                const double s = pow(10.0, (i % 5) + (j % 5));
                sas[i + j * N] = a[i + j * N] * s;
                b[i + j * N] = i == j ? s : (i > j ? 0.0 : nan(""));
            }
        }
        CHECK_INT(t, mt_inertia(N, a, NULL, shift, count, &gap, &mem, NULL), MT_OK);
        CHECK_INT(t, count[0], below);
        CHECK_INT(t, count[1], 0);
        CHECK_INT(t, count[2], N - below);
        CHECK(t, gap > 0.0 && gap <= 1.0);
        CHECK_INT(t, mt_inertia(N, sas, b, shift, count, NULL, &mem, NULL), MT_OK);
        CHECK_INT(t, count[0], below);
        CHECK_INT(t, count[2], N - below);
    }
}

static void eig__inertia_says_when_a_count_is_unsure(mt_test *t)
{
    const double nil = nan("");
    const double a[4] = {2.0, -1.0, nil, 2.0}; /* 1 and 3 */
    int count[3];
    double gap = 0.0;
    CHECK_INT(t, mt_inertia(2, a, NULL, 1.0 + 1e-15, count, &gap, &mem, NULL), MT_OK);
    CHECK(t, gap < 1e-14);
    CHECK_INT(t, mt_inertia(2, a, NULL, 1.0, count, &gap, &mem, NULL), MT_OK);
    CHECK_INT(t, count[1], 1);
    CHECK_NEAR(t, gap, 0.0, 0.0);
    const double off[4] = {0.0, 1.0, nil, 0.0}; /* a block of order two: -1 and 1 */
    CHECK_INT(t, mt_inertia(2, off, NULL, 0.0, count, &gap, &mem, NULL), MT_OK);
    CHECK_INT(t, count[0], 1);
    CHECK_INT(t, count[2], 1);
    CHECK_NEAR(t, gap, 1.0, 1e-15);
    CHECK_INT(t, mt_inertia(0, NULL, NULL, 0.0, count, &gap, &mem, NULL), MT_OK);
    CHECK_INT(t, count[0] + count[1] + count[2], 0);
}

/* A = V diag(w) V^-1 with V = [1 i; i 1] (V^-1 = [1 -i; -i 1]/2) has what it was made of. */
static void eig__complex_finds_what_the_matrix_is_made_of(mt_test *t)
{
    const double complex i = mt_complex(0.0, 1.0);
    const double complex w[2] = {mt_complex(-0.5, 3.0), mt_complex(2.0, -1.0)};
    const double complex a[4] = {(w[0] + w[1]) / 2.0, i * (w[0] - w[1]) / 2.0,
                                 i * (w[1] - w[0]) / 2.0, (w[0] + w[1]) / 2.0};
    double complex work[4];
    double complex got[2];
    double complex v[4];
    memcpy(work, a, sizeof a);
    CHECK_INT(t, mt_eig_complex(2, work, got, v, &mem, NULL), MT_OK);
    for (ptrdiff_t k = 0; k < 2; k++) {
        const int which = cabs(got[k] - w[0]) < 1.0 ? 0 : 1;
        CHECK_NEAR_ABS(t, cabs(got[k] - w[which]), 0.0, 1e-14);
        for (int r = 0; r < 2; r++) {
            const double complex av = (a[r] * v[2 * k]) + (a[r + 2] * v[(2 * k) + 1]);
            CHECK_NEAR_ABS(t, cabs(av - (got[k] * v[r + (2 * k)])), 0.0, 1e-14);
        }
    }
    CHECK(t, cabs(got[0] - got[1]) > 1.0);
    CHECK_INT(t, mt_eig_complex(0, NULL, NULL, NULL, &mem, NULL), MT_OK);
    CHECK_INT(t, mem.used, 0);
}

/* Every routine that LAPACK might answer with a success gets its NaN and its infinity. */
static void eig__entries_that_are_not_finite_are_errors(mt_test *t)
{
    const double bad[2] = {nan(""), HUGE_VAL};
    for (int k = 0; k < 2; k++) {
        double w[2];
        double wi[2];
        int count[3];
        mt_err err;
        mt_test_row(t, "%g", bad[k]);
        for (int at = 0; at < 4; at++) {
            const mt_status upper = at == 2 ? MT_OK : MT_E_DOMAIN;
            double a[4] = {2.0, 1.0, 1.0, 2.0};
            a[at] = bad[k];
            double c[4];
            memcpy(c, a, sizeof a);
            CHECK_INT(t, mt_inertia(2, a, NULL, 0.5, count, NULL, &mem, &err), upper);
            CHECK_INT(t, mt_eig_sym(2, a, w, true, &mem, &err), upper);
            memcpy(a, c, sizeof a);
            CHECK_INT(t, mt_cholesky(2, a, NULL, &err), upper);
            memcpy(a, c, sizeof a);
            CHECK_INT(t, mt_eig_general(2, a, w, wi, NULL, &mem, &err), MT_E_DOMAIN);
            CHECK_STR(t, err.text, "dgeev: a matrix entry is not a finite number");
            double complex z[4] = {c[0], c[1], mt_complex(0.0, c[2]), c[3]};
            double complex wz[2];
            CHECK_INT(t, mt_eig_complex(2, z, wz, NULL, &mem, &err), MT_E_DOMAIN);
            CHECK_STR(t, err.text, "zgeev: a matrix entry is not a finite number");
        }
    }
    CHECK_INT(t, mem.used, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(eig__symmetric_solutions_have_small_residuals),
        MT_TEST(eig__second_difference_matches_closed_form),
        MT_TEST(eig__graded_solutions_have_small_residuals_in_each_scale),
        MT_TEST(eig__general_finds_real_and_complex_roots),
        MT_TEST(eig__complex_finds_what_the_matrix_is_made_of),
        MT_TEST(eig__cholesky_reproduces_and_names_the_pivot),
        MT_TEST(eig__inertia_counts_eigenvalues_below_the_shift),
        MT_TEST(eig__inertia_says_when_a_count_is_unsure),
        MT_TEST(eig__entries_that_are_not_finite_are_errors),
    };
    const int failed = mt_arena_init(&mem, 0, NULL) != MT_OK
                           ? 1
                           : cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
    mt_arena_free(&mem);
    return failed != 0;
}
