/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Sylvester: P^T S (A - shift B) S P = L D L^T keeps the numbers of negative, zero and positive
 * eigenvalues, and D has blocks of order one and two only. S = diag(2^-e), e chosen such that
 * |a_ii| + |shift b_ii| becomes about one: the pivots of D then say how much is left after
 * cancellation, whatever the units of the rows are; powers of two change no digit.
 */
#include "linalg/inertia.h"

#include "linalg/lapack_priv.h"

#include <float.h>
#include <math.h>

/* c := scaled A - shift B, lower triangle. exponent[n] is scratch. */
static void shifted(int n, const double *a, const double *b, double shift, double *c,
                    int *exponent)
{
    for (int i = 0; i < n; i++) {
        const ptrdiff_t ii = i + (ptrdiff_t)i * n;
        const double size = fabs(a[ii]) + fabs(shift) * (b == NULL ? 1.0 : fabs(b[ii]));
        int e = 0;
        if (size > 0.0 && isfinite(size)) {
            (void)frexp(size, &e);
        }
        exponent[i] = e / 2;
    }
    for (int j = 0; j < n; j++) {
        for (int i = j; i < n; i++) {
            const ptrdiff_t ij = i + (ptrdiff_t)j * n;
            const double unit = i == j ? 1.0 : 0.0;
            const double entry = a[ij] - shift * (b == NULL ? unit : b[ij]);
            c[ij] = ldexp(entry, -exponent[i] - exponent[j]);
        }
    }
}

/* Eigenvalues of [p q; q r]: the large one by the formula without cancellation, the small one
 * from the determinant. */
static void eig2(double p, double q, double r, double e[2])
{
    const double mean = 0.5 * (p + r);
    const double radius = hypot(0.5 * (p - r), q);
    e[0] = mean >= 0.0 ? mean + radius : mean - radius;
    e[1] = e[0] == 0.0 ? 0.0 : (p / e[0]) * r - (q / e[0]) * q;
}

typedef struct tally {
    int count[3];
    double least;
    double most;
} tally;

static void count_eigenvalue(tally *t, double e)
{
    t->count[e < 0.0 ? 0 : (e > 0.0 ? 2 : 1)]++;
    t->least = fmin(t->least, fabs(e));
    t->most = fmax(t->most, fabs(e));
}

static mt_status factor_symmetric(int n, double *c, lapack_int *ipiv, mt_arena *scratch,
                                  mt_err *err)
{
    double query = 0.0;
    lapack_int info = LAPACKE_dsytrf_work(LAPACK_COL_MAJOR, 'L', n, c, n, ipiv, &query, -1);
    if (info != 0) {
        return mt_lapack_bug("dsytrf", info, err);
    }
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, query, n, &work, &lwork, err));
    info = LAPACKE_dsytrf_work(LAPACK_COL_MAJOR, 'L', n, c, n, ipiv, work, lwork);
    /* > 0: a zero pivot is counted */
    return info < 0 ? mt_lapack_bug("dsytrf", info, err) : MT_OK;
}

static tally count_blocks(int n, const double *c, const lapack_int *ipiv)
{
    tally t = {.least = HUGE_VAL};
    for (int i = 0; i < n; i++) {
        const double *const d = c + i + (ptrdiff_t)i * n;
        if (ipiv[i] > 0 || i + 1 == n) {
            count_eigenvalue(&t, d[0]);
            continue;
        }
        double e[2];
        eig2(d[0], d[1], d[n + 1], e);
        count_eigenvalue(&t, e[0]);
        count_eigenvalue(&t, e[1]);
        i++;
    }
    return t;
}

static mt_status inertia(int n, const double *a, const double *b, double shift, tally *t,
                         mt_arena *scratch, mt_err *err)
{
    double *const c = mt_arena_f64(scratch, (size_t)n, (size_t)n);
    int *const exponent = mt_arena_int(scratch, (size_t)n);
    lapack_int *const ipiv = mt_arena_alloc(scratch, (size_t)n, sizeof *ipiv);
    MT_TRY(mt_arena_check(scratch, err));
    shifted(n, a, b, shift, c, exponent);
    if (!mt_lower_finite(n, c)) {
        return mt_lapack_not_finite("dsytrf", err);
    }
    MT_TRY(factor_symmetric(n, c, ipiv, scratch, err));
    *t = count_blocks(n, c, ipiv);
    return MT_OK;
}

mt_status mt_inertia(int n, const double *a, const double *b, double shift, int count[3],
                     double *gap, mt_arena *scratch, mt_err *err)
{
    tally t = {.least = HUGE_VAL};
    mt_status rc = MT_OK;
    if (n > 0) {
        const mt_arena_mark mark = mt_arena_get_mark(scratch);
        rc = inertia(n, a, b, shift, &t, scratch, err);
        mt_arena_rewind(scratch, mark);
    }
    for (int i = 0; i < 3; i++) {
        count[i] = rc == MT_OK ? t.count[i] : 0;
    }
    if (gap != NULL) {
        const double zero = n > 0 ? 0.0 : 1.0;
        *gap = rc == MT_OK && t.most > 0.0 ? t.least / t.most : zero;
    }
    return rc;
}
