/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Eigenvalues. dsyevd and not dsyevr: the latter loses orthogonality on clusters in the LAPACK
 * that we build on. */
#include "linalg/eig.h"

#include "linalg/lapack_priv.h"

#include <limits.h>

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

mt_status mt_eig_sym(int n, double *a, double *w, bool vectors, mt_arena *scratch, mt_err *err)
{
    if (n == 0) {
        return MT_OK;
    }
    if (!mt_lower_finite(n, a)) {
        return mt_lapack_not_finite("dsyevd", err);
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = eig_sym(n, a, w, vectors ? 'V' : 'N', scratch, err);
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
