/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every routine that takes scratch, with every one of its allocations failing in turn: it must
 * say so and leave the arena as it was. */
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "linalg/eig_small.h"
#include "support/mt_alloc.h"
#include "support/mt_random.h"
#include "support/mt_test.h"

enum { M = 9, N = 6 };

typedef mt_status routine(double *a, mt_arena *mem, mt_err *err);

/* Of an order that is LAPACK's. */
static mt_status run_eig_sym(double *a, mt_arena *mem, mt_err *err)
{
    enum { ORDER = MT_EIG_SMALL + 1 };
    double large[ORDER * ORDER] = {0.0};
    double w[ORDER];
    memcpy(large, a, (size_t)M * N * sizeof *a);
    return mt_eig_sym(ORDER, large, w, true, mem, err);
}

static mt_status run_eig_general(double *a, mt_arena *mem, mt_err *err)
{
    double wr[N];
    double wi[N];
    return mt_eig_general(N, a, wr, wi, NULL, mem, err);
}

static mt_status run_eig_complex(double *a, mt_arena *mem, mt_err *err)
{
    double complex z[N * N];
    double complex w[N];
    for (int i = 0; i < N * N; i++) {
        z[i] = a[i];
        a[i] = 0.0; /* used up, as by the others */
    }
    return mt_eig_complex(N, z, w, NULL, mem, err);
}

static mt_status run_inertia(double *a, mt_arena *mem, mt_err *err)
{
    int count[3];
    return mt_inertia(N, a, NULL, 0.5, count, NULL, mem, err);
}

static mt_status run_lu(double *a, mt_arena *mem, mt_err *err)
{
    double b[N] = {1.0};
    double rcond = 0.0;
    return mt_lu_solve(N, a, 1, b, &rcond, mem, err);
}

static mt_status run_svd(double *a, mt_arena *mem, mt_err *err)
{
    double s[N];
    double u[M * N];
    return mt_svd(M, N, a, s, u, NULL, mem, err);
}

static mt_status run_svd_other(double *a, mt_arena *mem, mt_err *err)
{
    double s[N];
    double vt[N * N];
    return mt_svd(M, N, a, s, NULL, vt, mem, err);
}

static mt_status run_jacobi(double *a, mt_arena *mem, mt_err *err)
{
    double s[N];
    double v[N * N];
    return mt_svd_jacobi(M, N, a, s, v, mem, err);
}

static mt_status run_pinv(double *a, mt_arena *mem, mt_err *err)
{
    double p[M * N];
    return mt_pinv(M, N, a, 1e-12, p, NULL, mem, err);
}

static mt_status run_assign(double *a, mt_arena *mem, mt_err *err)
{
    int pair[M];
    return mt_assign(M, N, a, pair, mem, err);
}

static mt_status run_qr_factor(double *a, mt_arena *mem, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    mt_qr f;
    const mt_status rc = mt_qr_factor(M, N, a, M, 1e-12, mem, &f, err);
    mt_arena_rewind(mem, mark); /* the factor is the caller's */
    return rc;
}

/* A factor by hand, so that only the solves allocate: A = [I; 0], R = -I. */
static mt_status run_qr_solve(double *a, mt_arena *mem, mt_err *err)
{
    int perm[N];
    double qr[M * N] = {0.0};
    double tau[N];
    double x[N];
    double y[M];
    for (int i = 0; i < N; i++) {
        perm[i] = i;
        tau[i] = 2.0;
        qr[i + i * M] = -1.0;
    }
    const mt_qr f = {.m = M, .n = N, .rank = N, .perm = perm, .qr = qr, .tau = tau};
    const mt_status rc = mt_qr_solve(&f, 1, a, x, mem, err);
    return rc != MT_OK ? rc : mt_qr_solve_transposed(&f, 1, a, y, mem, err);
}

static void linalg__failing_allocations_are_reported_and_scratch_is_given_back(mt_test *t)
{
    static const struct {
        const char *name;
        routine *run;
    } rows[] = {
        {"eig_sym", run_eig_sym},
        {"eig_general", run_eig_general},
        {"eig_complex", run_eig_complex},
        {"inertia", run_inertia},
        {"lu_solve", run_lu},
        {"svd with u", run_svd},
        {"svd with vt", run_svd_other},
        {"svd_jacobi", run_jacobi},
        {"pinv", run_pinv},
        {"assign", run_assign},
        {"qr_factor", run_qr_factor},
        {"qr_solve", run_qr_solve},
    };
    for (int r = 0; r < MT_COUNT(rows); r++) {
        mt_status rc = MT_E_MEMORY;
        for (long nth = 0; rc != MT_OK && nth < 100; nth++) {
            mt_random g = mt_random_seed(61);
            double a[M * N];
            mt_arena tiny; /* a block per request */
            mt_err err;
            mt_test_row(t, "%s, allocation %ld", rows[r].name, nth);
            mt_random_fill(&g, M * N, a);
            REQUIRE(t, mt_arena_init(&tiny, MT_ALIGN, NULL) == MT_OK);
            mt_alloc_fail_after(mt_alloc_works() ? nth : -1);
            rc = rows[r].run(a, &tiny, &err);
            mt_alloc_fail_after(-1);
            CHECK(t, rc == MT_OK || rc == MT_E_MEMORY);
            CHECK_INT(t, tiny.used, 0);
            CHECK(t, !mt_alloc_works() || nth > 0 || rc == MT_E_MEMORY);
            mt_arena_free(&tiny);
        }
        CHECK_INT(t, rc, MT_OK);
    }
}

MT_TEST_MAIN(MT_TEST(linalg__failing_allocations_are_reported_and_scratch_is_given_back))
