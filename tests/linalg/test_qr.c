/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "support/mt_random.h"
#include "support/mt_test.h"

enum { MOST = 12 };

/* Entries are of order one and orders below twelve: rounding stays below 1e-13 for these
 * well-conditioned matrices. */
static const double TOL = 1e-13;
/* Rank tolerance: far above rounding, far below the smallest independent part of a random
 * matrix. */
static const double RANK_TOL = 1e-10;

static mt_arena mem;

/* m x n of rank r: product of random factors. */
static void with_rank(mt_random *g, int m, int n, int r, double *a)
{
    double left[MOST * MOST];
    double right[MOST * MOST];
    mt_random_fill(g, m * r, left);
    mt_random_fill(g, r * n, right);
    mt_gemm(false, false, m, n, r, 1.0, left, m, right, r, 0.0, a, m);
}

static void check_factor(mt_test *t, int m, int n, const double *a, const mt_qr *f)
{
    double q[MOST * MOST];
    double r[MOST * MOST] = {0};
    double back[MOST * MOST];
    CHECK_INT(t, mt_qr_q(f, 0, q, &mem, NULL), MT_OK);
    for (int j = 0; j < n; j++) {
        for (int i = 0; i <= j && i < m; i++) {
            r[i + j * m] = f->qr[i + j * m];
        }
    }
    mt_gemm(false, false, m, n, m, 1.0, q, m, r, m, 0.0, back, m);
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < m; i++) {
            CHECK_NEAR_ABS(t, back[i + j * m], a[i + f->perm[j] * m], TOL);
        }
    }
}

static void check_complement(mt_test *t, int m, int n, const double *a, const mt_qr *f)
{
    double z[MOST * MOST];
    double gram[MOST * MOST];
    const int k = m - f->rank;
    CHECK_INT(t, mt_qr_q(f, f->rank, z, &mem, NULL), MT_OK);
    mt_gemm(true, false, k, n, m, 1.0, z, m, a, m, 0.0, gram, k);
    CHECK(t, mt_max_abs((ptrdiff_t)k * n, gram) <= TOL * t->tol_scale);
    mt_gemm(true, false, k, k, m, 1.0, z, m, z, m, 0.0, gram, k);
    for (int i = 0; i < k; i++) {
        gram[i + i * k] -= 1.0;
    }
    CHECK(t, mt_max_abs((ptrdiff_t)k * k, gram) <= TOL * t->tol_scale);
}

static void qr__finds_rank_range_and_complement(mt_test *t)
{
    static const struct {
        int m;
        int n;
        int rank;
    } rows[] = {{6, 4, 4}, {6, 4, 2}, {4, 6, 4}, {4, 6, 3},
                {5, 5, 5}, {5, 5, 0}, {1, 1, 1}, {12, 12, 7}};
    mt_random g = mt_random_seed(3);
    for (int k = 0; k < MT_COUNT(rows); k++) {
        const int m = rows[k].m;
        const int n = rows[k].n;
        double a[MOST * MOST] = {0};
        mt_qr f;
        mt_test_row(t, "%d x %d of rank %d", m, n, rows[k].rank);
        with_rank(&g, m, n, rows[k].rank, a);
        const mt_arena_mark mark = mt_arena_get_mark(&mem);
        CHECK_INT(t, mt_qr_factor(m, n, a, m, RANK_TOL, &mem, &f, NULL), MT_OK);
        CHECK_INT(t, f.rank, rows[k].rank);
        CHECK(t, f.kept > RANK_TOL && f.kept <= 1.0 && f.dropped < RANK_TOL);
        check_factor(t, m, n, a, &f);
        check_complement(t, m, n, a, &f);
        mt_arena_rewind(&mem, mark);
    }
}

static void qr__solves_least_squares_and_transposed_systems(mt_test *t)
{
    enum { M = 7, N = 5, RANK = 3, NRHS = 2 };
    mt_random g = mt_random_seed(4);
    double a[M * N];
    double b[M * NRHS];
    double kept_b[M * NRHS];
    double x[N * NRHS];
    double res[M * NRHS];
    double normal[N * NRHS];
    mt_qr f;
    with_rank(&g, M, N, RANK, a);
    mt_random_fill(&g, M * NRHS, b);
    memcpy(kept_b, b, sizeof b);
    REQUIRE(t, mt_qr_factor(M, N, a, M, RANK_TOL, &mem, &f, NULL) == MT_OK);
    CHECK_INT(t, mt_qr_solve(&f, NRHS, b, x, &mem, NULL), MT_OK);
    for (int i = 0; i < M * NRHS; i++) {
        CHECK_NEAR(t, b[i], kept_b[i], 0.0);
    }
    /* the residual is orthogonal to the range, and the solution is basic */
    memcpy(res, b, sizeof b);
    mt_gemm(false, false, M, NRHS, N, 1.0, a, M, x, N, -1.0, res, M);
    mt_gemm(true, false, N, NRHS, M, 1.0, a, M, res, M, 0.0, normal, N);
    CHECK(t, mt_max_abs((ptrdiff_t)N * NRHS, normal) <= 10.0 * TOL * t->tol_scale);
    for (int j = RANK; j < N; j++) {
        CHECK_NEAR(t, x[f.perm[j]], 0.0, 0.0);
    }
    /* A^T y = c for a c in the row space; minimum norm: y has no part in the complement */
    double c[N * NRHS];
    double y[M * NRHS];
    double back[N * NRHS];
    double part[M * NRHS];
    double z[M * M];
    mt_gemm(true, false, N, NRHS, M, 1.0, a, M, b, M, 0.0, c, N);
    CHECK_INT(t, mt_qr_solve_transposed(&f, NRHS, c, y, &mem, NULL), MT_OK);
    mt_gemm(true, false, N, NRHS, M, 1.0, a, M, y, M, 0.0, back, N);
    for (int i = 0; i < N * NRHS; i++) {
        CHECK_NEAR_ABS(t, back[i], c[i], 10.0 * TOL);
    }
    CHECK_INT(t, mt_qr_q(&f, RANK, z, &mem, NULL), MT_OK);
    mt_gemm(true, false, M - RANK, NRHS, M, 1.0, z, M, y, M, 0.0, part, M - RANK);
    CHECK(t, mt_max_abs((ptrdiff_t)(M - RANK) * NRHS, part) <= 10.0 * TOL * t->tol_scale);
}

static void qr__takes_empty_matrices_and_refuses_nan(mt_test *t)
{
    mt_qr f;
    double q[9];
    CHECK_INT(t, mt_qr_factor(3, 0, NULL, 3, RANK_TOL, &mem, &f, NULL), MT_OK);
    CHECK_INT(t, f.rank, 0);
    CHECK_INT(t, mt_qr_q(&f, 0, q, &mem, NULL), MT_OK);
    for (int i = 0; i < 9; i++) {
        CHECK_NEAR(t, q[i], i % 4 == 0 ? 1.0 : 0.0, 0.0);
    }
    CHECK_INT(t, mt_qr_factor(0, 2, NULL, 1, RANK_TOL, &mem, &f, NULL), MT_OK);
    double x[2] = {5.0, 5.0};
    CHECK_INT(t, mt_qr_solve(&f, 1, NULL, x, &mem, NULL), MT_OK);
    CHECK_NEAR(t, x[0] + x[1], 0.0, 0.0);
    const double bad[2] = {1.0, nan("")};
    mt_err err;
    CHECK_INT(t, mt_qr_factor(2, 1, bad, 2, RANK_TOL, &mem, &f, &err), MT_E_DOMAIN);
    CHECK_STR(t, err.text, "dgeqp3: a matrix entry is not a finite number");
    double good[2] = {1.0, 2.0};
    CHECK_INT(t, mt_qr_factor(2, 1, good, 2, RANK_TOL, &mem, &f, NULL), MT_OK);
    CHECK_INT(t, mt_qr_solve(&f, 1, bad, x, &mem, NULL), MT_E_DOMAIN);
}

static void solve__lu_agrees_with_the_planted_solution(mt_test *t)
{
    enum { N = 9, NRHS = 3 };
    mt_random g = mt_random_seed(6);
    double a[N * N];
    double x[N * NRHS];
    double b[N * NRHS];
    double rcond = -1.0;
    mt_random_fill(&g, N * N, a);
    mt_random_fill(&g, N * NRHS, x);
    mt_symmetrise_lower(N, a);
    mt_gemm(false, false, N, NRHS, N, 1.0, a, N, x, N, 0.0, b, N);
    CHECK_INT(t, mt_lu_solve(N, a, NRHS, b, &rcond, &mem, NULL), MT_OK);
    CHECK(t, rcond > 0.0 && rcond <= 1.0);
    for (int i = 0; i < N * NRHS; i++) {
        CHECK_NEAR_ABS(t, b[i], x[i], TOL / rcond);
    }
}

static void solve__singular_matrices_are_errors(mt_test *t)
{
    const double a[4] = {1.0, 2.0, 2.0, 4.0};
    double c[4];
    double b[2] = {1.0, 1.0};
    double rcond = 7.0;
    mt_err err;
    memcpy(c, a, sizeof a);
    CHECK_INT(t, mt_lu_solve(2, c, 1, b, &rcond, &mem, &err), MT_E_SINGULAR);
    CHECK_NEAR(t, rcond, 0.0, 0.0);
    CHECK_STR(t, err.text, "LU: the matrix is singular at row 2");
    double near[4] = {1.0, 1.0, 1.0, 1.0 + 4.0 * DBL_EPSILON};
    CHECK_INT(t, mt_lu_solve(2, near, 1, b, &rcond, &mem, NULL), MT_OK);
    CHECK(t, rcond < 4.0 * DBL_EPSILON);
    double poisoned[4] = {1.0, 0.0, 0.0, nan("")};
    CHECK_INT(t, mt_lu_solve(2, poisoned, 1, b, &rcond, &mem, NULL), MT_E_DOMAIN);
    b[0] = HUGE_VAL;
    memcpy(c, a, sizeof a);
    CHECK_INT(t, mt_lu_solve(2, c, 1, b, &rcond, &mem, NULL), MT_E_DOMAIN);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(qr__finds_rank_range_and_complement),
        MT_TEST(qr__solves_least_squares_and_transposed_systems),
        MT_TEST(qr__takes_empty_matrices_and_refuses_nan),
        MT_TEST(solve__lu_agrees_with_the_planted_solution),
        MT_TEST(solve__singular_matrices_are_errors),
    };
    const int failed = mt_arena_init(&mem, 0, NULL) != MT_OK
                           ? 1
                           : cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
    mt_arena_free(&mem);
    return failed != 0;
}
