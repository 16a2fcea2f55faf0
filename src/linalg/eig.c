/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Eigenvalues of small symmetric matrices by eig_small.c, others by LAPACK. dsyevd and not
 * dsyevr: the latter loses orthogonality on clusters in the LAPACK that we build on. */
#include "linalg/eig.h"

#include "linalg/lapack_priv.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "linalg/eig_small.h"

static mt_status eig_sym(int n, double *a, double *w, char job, mt_arena *scratch, mt_err *err)
{
    double query = 0.0;
    lapack_int iquery = 0;
    lapack_int info = 0;
    if (n > MT_LAPACK_UNBLOCKED) {
        info = LAPACKE_dsyevd_work(LAPACK_COL_MAJOR, job, 'L', n, a, n, w, &query, -1, &iquery,
                                   -1);
    }
    if (info != 0) {
        return mt_lapack_bug("dsyevd", info, err);
    }
    /* documented minima: 1 + 6 n + 2 n^2 and 3 + 5 n with vectors, 2 n + 1 and 1 without */
    const double size = n;
    const double least = job == 'V' ? 1.0 + 6.0 * size + 2.0 * size * size : 2.0 * size + 1.0;
    const int ileast = n > (INT_MAX - 3) / 5 ? INT_MAX : 3 + 5 * n;
    const int liwork = iquery > ileast ? (int)iquery : ileast;
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, query, least, &work, &lwork, err));
    int *const iwork = mt_arena_int(scratch, (size_t)liwork);
    MT_TRY(mt_arena_check(scratch, err));
    info =
        LAPACKE_dsyevd_work(LAPACK_COL_MAJOR, job, 'L', n, a, n, w, work, lwork, iwork, liwork);
    if (info < 0) {
        return mt_lapack_bug("dsyevd", info, err);
    }
    if (info > 0 ||
        !mt_all_finite(n, w)) { /* entries near overflow may leave NaN and info = 0 */
        return mt_fail(err, MT_E_NO_CONVERGENCE, "dsyevd: the eigenvalues did not converge");
    }
    return MT_OK;
}

/* Far from these, squares of entries leave the range of numbers. */
static const double LEAST_SIZE = 1e-100;
static const double MOST_SIZE = 1e100;

/* a *= the power of 2 that makes its size 1, unless its size is a moderate one. */
static double scale_lower(int n, double *a)
{
    double size = 0.0;
    for (ptrdiff_t j = 0; j < n; j++) {
        size = fmax(size, mt_max_abs(n - j, a + j + (j * n)));
    }
    if (size == 0.0 || (size >= LEAST_SIZE && size <= MOST_SIZE)) {
        return 1.0;
    }
    const int least = DBL_MIN_EXP; /* of a subnormal size the inverse may have no number */
    const double scale = ldexp(1.0, -(ilogb(size) > least ? ilogb(size) : least));
    for (ptrdiff_t j = 0; j < n; j++) {
        for (ptrdiff_t i = j; i < n; i++) {
            a[i + (j * n)] *= scale;
        }
    }
    return scale;
}

static mt_status eig_small(int n, double *a, double *w, bool vectors, mt_err *err)
{
    const double scale = scale_lower(n, a);
    const bool converged = mt_eig_small(n, a, w, vectors);
    for (int i = 0; i < n; i++) {
        w[i] /= scale;
    }
    return converged && mt_all_finite(n, w)
               ? MT_OK
               : mt_fail(err, MT_E_NO_CONVERGENCE, "QL: the eigenvalues did not converge");
}

mt_status mt_eig_sym(int n, double *a, double *w, bool vectors, mt_arena *scratch, mt_err *err)
{
    if (n == 0) {
        return MT_OK;
    }
    if (!mt_lower_finite(n, a)) {
        return mt_lapack_not_finite("dsyevd", err);
    }
    if (n <= MT_EIG_SMALL) {
        return eig_small(n, a, w, vectors, err);
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = eig_sym(n, a, w, vectors ? 'V' : 'N', scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

static mt_status eig_sym_values(const mt_tridiagonal *t, double *w, mt_arena *scratch,
                                mt_err *err)
{
    const int n = t->n;
    double query = 0.0;
    lapack_int info =
        LAPACKE_dsytrd_work(LAPACK_COL_MAJOR, 'L', n, t->a, n, t->d, t->e, t->tau, &query, -1);
    if (info != 0) {
        return mt_lapack_bug("dsytrd", info, err);
    }
    double *const beside = mt_arena_f64(scratch, (size_t)n, 1);
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, query, (double)n, &work, &lwork, err));
    info =
        LAPACKE_dsytrd_work(LAPACK_COL_MAJOR, 'L', n, t->a, n, t->d, t->e, t->tau, work, lwork);
    if (info != 0) {
        return mt_lapack_bug("dsytrd", info, err);
    }
    memcpy(w, t->d, (size_t)n * sizeof *w);
    memcpy(beside, t->e, (size_t)n * sizeof *beside);
    info = LAPACKE_dsterf_work(n, w, beside);
    if (info < 0) {
        return mt_lapack_bug("dsterf", info, err);
    }
    for (int i = 0; i < n; i++) {
        w[i] /= t->scale;
    }
    return info > 0 || !mt_all_finite(n, w)
               ? mt_fail(err, MT_E_NO_CONVERGENCE, "dsterf: the eigenvalues did not converge")
               : MT_OK;
}

mt_status mt_eig_sym_values(int n, double *a, double *w, mt_arena *mem, mt_tridiagonal *out,
                            mt_err *err)
{
    const size_t size = (size_t)n;
    *out = (mt_tridiagonal){.n = n, .scale = 1.0, .a = a};
    if (n == 0) {
        return MT_OK;
    }
    if (!mt_lower_finite(n, a)) {
        return mt_lapack_not_finite("dsytrd", err);
    }
    out->scale = scale_lower(n, a);
    out->tau = mt_arena_f64(mem, size, 1);
    out->d = mt_arena_f64(mem, size, 1);
    out->e = mt_arena_f64(mem, size, 1);
    MT_TRY(mt_arena_check(mem, err));
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const mt_status rc = eig_sym_values(out, w, mem, err);
    mt_arena_rewind(mem, mark);
    return rc;
}

/* dstein orthogonalises vectors whose eigenvalues differ by less than a thousandth of the norm
 * of T; other pairs are orthogonal to eps times the norm over their distance, up to a thousand
 * eps. The correction changes the residual by its size times the distance: by eps times the
 * norm. */
static void make_orthogonal(int n, int count, double *z)
{
    for (ptrdiff_t i = 0; i < count; i++) {
        double *const own = z + (i * n);
        for (ptrdiff_t j = 0; j < i; j++) {
            mt_axpy(n, -mt_dot(n, z + (j * n), own), z + (j * n), own);
        }
        const double norm = mt_norm2(n, own);
        for (ptrdiff_t k = 0; k < n; k++) {
            own[k] /= norm;
        }
    }
}

static mt_status eig_sym_lowest(const mt_tridiagonal *t, int count, const double *w, double *z,
                                mt_arena *scratch, mt_err *err)
{
    const int n = t->n;
    const size_t size = (size_t)n;
    double query = 0.0;
    lapack_int info = LAPACKE_dormtr_work(LAPACK_COL_MAJOR, 'L', 'L', 'N', n, count, t->a, n,
                                          t->tau, z, n, &query, -1);
    if (info != 0) {
        return mt_lapack_bug("dormtr", info, err);
    }
    double *const scaled = mt_arena_f64(scratch, (size_t)count, 1);
    int *const block = mt_arena_int(scratch, size);
    int *const end = mt_arena_int(scratch, size);
    int *const iwork = mt_arena_int(scratch, size);
    int *const failed = mt_arena_int(scratch, (size_t)count);
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, query, 5.0 * n, &work, &lwork, err));
    MT_TRY(mt_arena_check(scratch, err));
    for (int i = 0; i < n; i++) {
        block[i] = 1; /* all of T is one */
    }
    for (int i = 0; i < count; i++) {
        scaled[i] = w[i] * t->scale;
    }
    end[0] = n;
    info = LAPACKE_dstein_work(LAPACK_COL_MAJOR, n, t->d, t->e, count, scaled, block, end, z, n,
                               work, iwork, failed);
    if (info < 0) {
        return mt_lapack_bug("dstein", info, err);
    }
    if (info > 0) {
        return mt_fail(err, MT_E_NO_CONVERGENCE, "dstein: %d vectors did not converge", info);
    }
    make_orthogonal(n, count, z);
    info = LAPACKE_dormtr_work(LAPACK_COL_MAJOR, 'L', 'L', 'N', n, count, t->a, n, t->tau, z, n,
                               work, lwork);
    return info == 0 ? MT_OK : mt_lapack_bug("dormtr", info, err);
}

mt_status mt_eig_sym_lowest(const mt_tridiagonal *t, int count, const double *w, double *z,
                            mt_arena *scratch, mt_err *err)
{
    if (count == 0) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = eig_sym_lowest(t, count, w, z, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

typedef struct general {
    int n;
    double *a;
    double *wr;
    double *wi;
    double *vr; /* or NULL */
} general;

static lapack_int geev(const general *g, double *work, lapack_int lwork)
{
    double none = 0.0;
    return LAPACKE_dgeev_work(LAPACK_COL_MAJOR, 'N', g->vr == NULL ? 'N' : 'V', g->n, g->a,
                              g->n, g->wr, g->wi, &none, 1, g->vr == NULL ? &none : g->vr,
                              g->vr == NULL ? 1 : g->n, work, lwork);
}

static mt_status eig_general(const general *g, mt_arena *scratch, mt_err *err)
{
    double query = 0.0;
    lapack_int info = geev(g, &query, -1);
    if (info != 0) {
        return mt_lapack_bug("dgeev", info, err);
    }
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, query, 4.0 * g->n, &work, &lwork, err));
    info = geev(g, work, lwork);
    if (info < 0) {
        return mt_lapack_bug("dgeev", info, err);
    }
    if (info > 0 || !mt_all_finite(g->n, g->wr) || !mt_all_finite(g->n, g->wi)) {
        return mt_fail(err, MT_E_NO_CONVERGENCE, "dgeev: the eigenvalues did not converge");
    }
    return MT_OK;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): LAPACK writes through them */
mt_status mt_eig_general(int n, double *a, double *wr, double *wi, double *vr,
                         mt_arena *scratch, mt_err *err)
{
    if (n == 0) {
        return MT_OK;
    }
    if (!mt_all_finite((ptrdiff_t)n * n, a)) {
        return mt_lapack_not_finite("dgeev", err);
    }
    const general g = {.n = n, .a = a, .wr = wr, .wi = wi, .vr = vr};
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = eig_general(&g, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

typedef struct complex_general {
    int n;
    double complex *a;
    double complex *w;
    double complex *vr; /* or NULL */
    double *rwork;      /* [2 n] */
} complex_general;

static lapack_int zgeev(const complex_general *g, double complex *work, lapack_int lwork)
{
    double complex none = 0.0;
    return LAPACKE_zgeev_work(LAPACK_COL_MAJOR, 'N', g->vr == NULL ? 'N' : 'V', g->n, g->a,
                              g->n, g->w, &none, 1, g->vr == NULL ? &none : g->vr,
                              g->vr == NULL ? 1 : g->n, work, lwork, g->rwork);
}

static mt_status eig_complex(complex_general *g, mt_arena *scratch, mt_err *err)
{
    double complex query = 0.0;
    g->rwork = mt_arena_f64(scratch, 2, (size_t)g->n);
    MT_TRY(mt_arena_check(scratch, err));
    lapack_int info = zgeev(g, &query, -1);
    if (info != 0) {
        return mt_lapack_bug("zgeev", info, err);
    }
    double *work = NULL; /* of pairs of doubles */
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, 2.0 * creal(query), 4.0 * g->n, &work, &lwork, err));
    info = zgeev(g, (double complex *)work, lwork / 2);
    if (info < 0) {
        return mt_lapack_bug("zgeev", info, err);
    }
    if (info > 0 || !mt_all_finite(2 * (ptrdiff_t)g->n, (const double *)g->w)) {
        return mt_fail(err, MT_E_NO_CONVERGENCE, "zgeev: the eigenvalues did not converge");
    }
    return MT_OK;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): LAPACK writes through them */
mt_status mt_eig_complex(int n, double complex *a, double complex *w, double complex *vr,
                         mt_arena *scratch, mt_err *err)
{
    if (n == 0) {
        return MT_OK;
    }
    if (!mt_all_finite(2 * (ptrdiff_t)n * n, (const double *)a)) {
        return mt_lapack_not_finite("zgeev", err);
    }
    complex_general g = {.n = n, .a = a, .w = w, .vr = vr};
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = eig_complex(&g, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}
