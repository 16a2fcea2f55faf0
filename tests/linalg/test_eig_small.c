/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The eigenvalues of small symmetric matrices against Jacobi's method with 113 bits, on the
 * types of matrices that LAPACK tests its own with (Lapack Working Note 41, dchkst): zero, unit
 * and diagonal ones, spectra that are even, geometric, clustered or random, turned by a random
 * orthogonal matrix, at sizes near the ends of the range; and graded ones, in every order.
 */
#include <lapacke.h>

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "linalg/dense.h"
#include "linalg/eig_small.h"
#include "support/mt_random.h"
#include "support/mt_test.h"

__extension__ typedef __float128 quad;

enum { MOST = MT_EIG_SMALL, SWEEPS = 60 };

/* As in test_eig.c: units of n eps. */
static const double RATIO = 10.0;
/* Of an eigenvalue. Most are found to 0.3; a fourfold one, in a matrix that another kernel of
 * the BLAS has made, to 1.4: where eigenvalues are equal what is neglected counts to first
 * order. LAPACK's own tests allow 30. */
static const double RATIO_VALUE = 3.0;

static mt_arena mem;

static quad quad_abs(quad x)
{
    return x < 0 ? -x : x;
}

/* Newton's method doubles the 53 digits that the start has. */
static quad quad_sqrt(quad x)
{
    quad r = (quad)sqrt((double)x);
    for (int i = 0; i < 2 && r > 0; i++) {
        r = (r + x / r) / 2;
    }
    return r;
}

/* One rotation of Jacobi's that makes a_pq zero. */
static void jacobi_turn(int n, quad *a, int p, int q)
{
    const quad apq = a[p + q * n];
    const quad theta = (a[q + q * n] - a[p + p * n]) / (2 * apq);
    const quad root =
        quad_abs(theta) > (quad)1e60 ? quad_abs(theta) : quad_sqrt(theta * theta + 1);
    const quad t = (theta < 0 ? -1 : 1) / (quad_abs(theta) + root);
    const quad c = 1 / quad_sqrt(t * t + 1);
    const quad s = t * c;
    for (int k = 0; k < n; k++) {
        const quad x = a[p + k * n];
        const quad y = a[q + k * n];
        a[p + k * n] = c * x - s * y;
        a[q + k * n] = s * x + c * y;
    }
    for (int k = 0; k < n; k++) {
        const quad x = a[k + p * n];
        const quad y = a[k + q * n];
        a[k + p * n] = c * x - s * y;
        a[k + q * n] = s * x + c * y;
    }
    a[p + q * n] = 0;
    a[q + p * n] = 0;
}

/* Eigenvalues of the lower triangle, ascending; true: all of them to 113 bits, relative to the
 * diagonal entries between which something is left. */
static bool reference(int n, const double *lower, quad *w)
{
    static quad a[MOST * MOST];
    bool turned = true;
    for (int j = 0; j < n; j++) {
        for (int i = j; i < n; i++) {
            a[i + j * n] = (quad)lower[i + j * n];
            a[j + i * n] = a[i + j * n];
        }
    }
    for (int sweep = 0; sweep < SWEEPS && turned; sweep++) {
        turned = false;
        for (int p = 0; p < n; p++) {
            for (int q = p + 1; q < n; q++) {
                const quad left = a[p + q * n] * a[p + q * n];
                if (left > (quad)1e-64 * quad_abs(a[p + p * n] * a[q + q * n])) {
                    jacobi_turn(n, a, p, q);
                    turned = true;
                }
            }
        }
    }
    for (int i = 0; i < n; i++) {
        w[i] = a[i + i * n];
        for (int at = i; at > 0 && w[at - 1] > w[at]; at--) {
            const quad swap = w[at];
            w[at] = w[at - 1];
            w[at - 1] = swap;
        }
    }
    return !turned;
}

/* A random orthogonal matrix: the product of reflections on random directions. */
static void random_orthogonal(mt_random *r, int n, double *q)
{
    memset(q, 0, (size_t)n * (size_t)n * sizeof *q);
    for (int i = 0; i < n; i++) {
        q[i + i * n] = 1.0;
    }
    for (int k = 0; k < n; k++) {
        double u[MOST];
        mt_random_fill(r, n, u);
        const double square = mt_dot(n, u, u);
        for (int j = 0; j < n; j++) {
            mt_axpy(n, -2.0 * mt_dot(n, u, q + (ptrdiff_t)j * n) / square, u,
                    q + (ptrdiff_t)j * n);
        }
    }
}

typedef enum spectrum {
    EVEN,
    GEOMETRIC,
    CLUSTERED, /* one and else eps */
    CLUSTERED_ONE,
    RANDOM,
    SPECTRA
} spectrum;

/* The eigenvalue that stands at `part` of the way from the first to the last. */
static double of_spectrum(mt_random *r, spectrum kind, double part)
{
    switch (kind) {
    case EVEN:
        return 1.0 - part * (1.0 - DBL_EPSILON);
    case GEOMETRIC:
        return pow(DBL_EPSILON, part);
    case CLUSTERED:
        return part > 0.0 ? DBL_EPSILON : 1.0;
    case CLUSTERED_ONE:
        return part < 1.0 ? 1.0 : DBL_EPSILON;
    case RANDOM:
    case SPECTRA:
        break;
    }
    return pow(DBL_EPSILON, mt_random_in(r, 0.0, 1.0));
}

static void fill_spectrum(mt_random *r, spectrum kind, bool signs, int n, double *d)
{
    for (int i = 0; i < n; i++) {
        const bool negative = signs && mt_random_int(r, 2) == 0;
        d[i] = of_spectrum(r, kind, n == 1 ? 0.0 : (double)i / (n - 1));
        d[i] = negative ? -d[i] : d[i];
    }
}

/* size * Q diag(d) Q^T, Q of `turned`: random, else a permutation backwards; the upper triangle
 * is NaN. */
static void matrix_of(mt_random *r, int n, const double *d, bool turned, double size, double *a)
{
    static double q[MOST * MOST];
    static double scaled[MOST * MOST];
    static double whole[MOST * MOST];
    random_orthogonal(r, n, q);
    for (int i = 0; i < n && !turned; i++) {
        for (int j = 0; j < n; j++) {
            q[i + j * n] = i + j == n - 1 ? 1.0 : 0.0;
        }
    }
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < n; i++) {
            scaled[i + j * n] = q[i + j * n] * d[j];
        }
    }
    mt_gemm(false, true, n, n, n, 1.0, scaled, n, q, n, 0.0, whole, n);
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < n; i++) {
            a[i + j * n] = i < j ? nan("") : whole[i + j * n] * size;
        }
    }
}

static double size_of(int n, const double *a)
{
    double most = 0.0;
    for (int j = 0; j < n; j++) {
        most = fmax(most, mt_max_abs(n - j, a + j + (ptrdiff_t)j * n));
    }
    return most;
}

/* |A V - V W| and |V^T V - I| in units of n eps, of a matrix whose size is 1. lost: an error of
 * w besides. */
static void check_vectors(mt_test *t, int n, const double *a, const double *v, const double *w,
                          double lost)
{
    static double av[MOST * MOST];
    static double g[MOST * MOST];
    mt_symm(n, n, a, v, av);
    mt_gemm(true, false, n, n, n, 1.0, v, n, v, n, 0.0, g, n);
    for (int j = 0; j < n; j++) {
        mt_axpy(n, -w[j], v + (ptrdiff_t)j * n, av + (ptrdiff_t)j * n);
        g[j + j * n] -= 1.0;
    }
    const double unit = n * DBL_EPSILON;
    CHECK(t, mt_max_abs((ptrdiff_t)n * n, av) <=
                 RATIO * unit * fmax(1.0, mt_max_abs(n, w)) + lost);
    CHECK(t, mt_max_abs((ptrdiff_t)n * n, g) <= RATIO * unit);
}

/* Everything that is promised of a matrix. */
static void check_matrix(mt_test *t, int n, const double *a)
{
    static double v[MOST * MOST];
    static double one[MOST * MOST];
    double w[MOST];
    double only[MOST];
    quad exact[MOST];
    const double size = size_of(n, a);
    memcpy(v, a, (size_t)n * (size_t)n * sizeof *v);
    REQUIRE(t, mt_eig_sym(n, v, only, false, &mem, NULL) == MT_OK);
    memcpy(v, a, (size_t)n * (size_t)n * sizeof *v);
    REQUIRE(t, mt_eig_sym(n, v, w, true, &mem, NULL) == MT_OK);
    REQUIRE(t, reference(n, a, exact));
    const quad most = (quad)fmax(fabs(w[0]), fabs(w[n - 1]));
    for (int i = 0; i < n; i++) {
        const quad unit = (quad)(RATIO_VALUE * n * DBL_EPSILON);
        const quad bound = unit * most + (quad)DBL_TRUE_MIN;
        CHECK(t, quad_abs((quad)w[i] - exact[i]) <= bound);
        CHECK(t, quad_abs((quad)only[i] - exact[i]) <= bound);
        CHECK(t, i == 0 || (w[i - 1] <= w[i] && only[i - 1] <= only[i]));
    }
    /* brought to size 1, so that products are numbers; w may have lost digits to underflow */
    const int power = size > 0.0 ? -ilogb(size) : 0;
    for (int j = 0; j < n; j++) {
        w[j] = ldexp(w[j], power);
        for (int i = 0; i < n; i++) {
            one[i + j * n] = i < j ? nan("") : ldexp(a[i + j * n], power);
        }
    }
    check_vectors(t, n, one, v, w, ldexp(DBL_TRUE_MIN, power));
}

static void eig__of_all_types_is_that_of_113_bits(mt_test *t)
{
    static const int orders[] = {1, 2, 3, 4, 5, 8, 11, 16, MOST};
    static const double sizes[] = {1.0, 1e-155, 1e154, 1e-290, 1e300, 1e-308};
    static double a[MOST * MOST];
    double d[MOST];
    mt_random r = mt_random_seed(3);
    int k = 0;
    for (int o = 0; o < MT_COUNT(orders); o++) {
        const int n = orders[o];
        for (int kind = 0; kind < SPECTRA; kind++) {
            for (int way = 0; way < 4; way++, k++) {
                const double size = n < 16 ? sizes[k % MT_COUNT(sizes)] : sizes[k % 2];
                mt_test_row(t, "n = %d, spectrum %d, way %d, size %g", n, kind, way, size);
                fill_spectrum(&r, (spectrum)kind, way % 2 == 1, n, d);
                matrix_of(&r, n, d, way >= 2, size, a);
                check_matrix(t, n, a);
            }
        }
    }
}

/* Zero, unit and all ones; random entries; tridiagonal ones, among them Wilkinson's with its
 * close pairs; only one entry; entries that all but overflow. */
typedef enum special {
    ZERO,
    UNIT,
    ONES,
    ANY,
    TRIDIAGONAL,
    WILKINSON,
    CORNER,
    ARROW,
    HUGE_ONES,
    SPECIALS
} special;

static double entry_of(special kind, int n, int i, int j, double any)
{
    const bool diagonal = i == j;
    const bool beside = i == j + 1;
    switch (kind) {
    case ZERO:
    case SPECIALS:
        break;
    case UNIT:
        return diagonal ? 1.0 : 0.0;
    case ONES:
        return 1.0;
    case ANY:
        return any;
    case TRIDIAGONAL:
        return diagonal || beside ? any : 0.0;
    case WILKINSON:
        return diagonal ? abs(i - n / 2) : beside ? 1.0 : 0.0;
    case CORNER:
        return i == n - 1 && j == 0 ? 1.0 : 0.0;
    case ARROW:
        return diagonal || j == 0 ? any : 0.0;
    case HUGE_ONES:
        return DBL_MAX / (2.0 * n);
    }
    return 0.0;
}

static void eig__of_special_matrices_is_that_of_113_bits(mt_test *t)
{
    static const int orders[] = {1, 2, 3, 7, 21};
    static double a[MOST * MOST];
    mt_random r = mt_random_seed(5);
    for (int o = 0; o < MT_COUNT(orders); o++) {
        const int n = orders[o];
        for (int kind = 0; kind < SPECIALS; kind++) {
            mt_test_row(t, "n = %d, kind %d", n, kind);
            for (int j = 0; j < n; j++) {
                for (int i = 0; i < n; i++) {
                    const double any = mt_random_in(&r, -1.0, 1.0);
                    a[i + j * n] = i < j ? nan("") : entry_of((special)kind, n, i, j, any);
                }
            }
            check_matrix(t, n, a);
        }
    }
}

/* Worst relative error of n eigenvalues that are not zero. */
static double relative_error(int n, const double *w, const quad *exact)
{
    double worst = 0.0;
    for (int i = 0; i < n; i++) {
        const double error = (double)(quad_abs((quad)w[i] - exact[i]) / quad_abs(exact[i]));
        worst = error <= worst ? worst : isnan(error) ? HUGE_VAL : error;
    }
    return worst;
}

/* D C D over 24 decades, C = Q Q^T + I of Q random: small eigenvalues are those of Schur
 * complements, to all of their digits but what the condition of C costs, and now and then two
 * more, where a QL step does not see the grading. With large entries first dsyevd has them, in
 * other orders none; here they are had in every order. */
static void eig__of_graded_matrices_keeps_what_dsyevd_keeps_in_its_best_order(mt_test *t)
{
    enum { N = 13, ROUNDS = 20, ORDERS = 3 };
    static double c[N * N];
    static double a[N * N];
    static double v[N * N];
    mt_random r = mt_random_seed(11);
    double ours[ORDERS] = {0.0};
    double theirs[ORDERS] = {0.0};
    for (int round = 0; round < ROUNDS; round++) {
        for (int order = 0; order < ORDERS; order++) {
            double work[1 + 6 * N + 2 * N * N];
            int iwork[3 + 5 * N];
            double w[N];
            double d[N];
            quad exact[N];
            mt_random_fill(&r, N * N, v);
            mt_gemm(false, true, N, N, N, 1.0, v, N, v, N, 0.0, c, N);
            for (int i = 0; i < N; i++) {
                const int place = order == 0 ? i : order == 1 ? N - 1 - i : (5 * i + 3) % N;
                d[i] = pow(10.0, -place);
                c[i + i * N] += 1.0;
            }
            for (int j = 0; j < N; j++) {
                for (int i = 0; i < N; i++) {
                    a[i + j * N] = d[i] * c[i + j * N] * d[j];
                }
            }
            mt_test_row(t, "round %d, order %d", round, order);
            REQUIRE(t, reference(N, a, exact));
            memcpy(v, a, sizeof a);
            REQUIRE(t, mt_eig_sym(N, v, w, true, &mem, NULL) == MT_OK);
            ours[order] = fmax(ours[order], relative_error(N, w, exact));
            memcpy(v, a, sizeof a);
            REQUIRE(t, LAPACKE_dsyevd_work(LAPACK_COL_MAJOR, 'V', 'L', N, v, N, w, work,
                                           MT_COUNT(work), iwork, MT_COUNT(iwork)) == 0);
            theirs[order] = fmax(theirs[order], relative_error(N, w, exact));
        }
    }
    for (int order = 0; order < ORDERS; order++) {
        mt_test_row(t, "order %d: %g, dsyevd %g", order, ours[order], theirs[order]);
        CHECK(t, ours[order] <= 10.0 * theirs[0]);
        CHECK(t, order == 0 ? theirs[order] <= 1e-10 : theirs[order] >= 0.1);
    }
}

static void eig__refuses_what_is_no_number(mt_test *t)
{
    const double bad[] = {nan(""), HUGE_VAL, -HUGE_VAL};
    for (int k = 0; k < MT_COUNT(bad); k++) {
        double a[9] = {2.0, 1.0, 0.0, nan(""), 2.0, 1.0, nan(""), nan(""), 2.0};
        double w[3];
        CHECK_INT(t, mt_eig_sym(3, a, w, false, &mem, NULL), MT_OK);
        double b[9] = {2.0, 1.0, bad[k], 0.0, 2.0, 1.0, 0.0, 0.0, 2.0};
        CHECK_INT(t, mt_eig_sym(3, b, w, true, &mem, NULL), MT_E_DOMAIN);
    }
    double a[4] = {DBL_MAX, DBL_MAX, 0.0, DBL_MAX}; /* 2 DBL_MAX is none */
    double w[2];
    CHECK_INT(t, mt_eig_sym(2, a, w, true, &mem, NULL), MT_E_NO_CONVERGENCE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(eig__of_all_types_is_that_of_113_bits),
        MT_TEST(eig__of_special_matrices_is_that_of_113_bits),
        MT_TEST(eig__of_graded_matrices_keeps_what_dsyevd_keeps_in_its_best_order),
        MT_TEST(eig__refuses_what_is_no_number),
    };
    const int failed = mt_arena_init(&mem, 0, NULL) != MT_OK
                           ? 1
                           : cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
    mt_arena_free(&mem);
    return failed != 0;
}
