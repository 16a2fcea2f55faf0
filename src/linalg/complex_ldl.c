/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "linalg/complex_ldl.h"

#include "linalg/lapack_priv.h"

_Static_assert(sizeof(lapack_int) == sizeof(int), "pivots are ints");

/* Both parts of n complex numbers. */
static bool all_finite(ptrdiff_t n, const double complex *x)
{
    return mt_all_finite(2 * n, (const double *)x);
}

/* A work array of complex numbers, as mt_lapack_work. */
static mt_status work_of(mt_arena *scratch, double query, double minimum, double complex **work,
                         lapack_int *lwork, mt_err *err)
{
    double *room = NULL;
    MT_TRY(mt_lapack_work(scratch, 2.0 * query, 2.0 * minimum, &room, lwork, err));
    *lwork /= 2;
    *work = (double complex *)room;
    return MT_OK;
}

mt_status mt_complex_factor(int n, double complex *a, mt_arena *mem, mt_complex_ldl *out,
                            mt_err *err)
{
    *out = (mt_complex_ldl){.n = n, .a = a, .pivot = mt_arena_int(mem, (size_t)n)};
    MT_TRY(mt_arena_check(mem, err));
    if (n == 0) {
        return MT_OK;
    }
    if (!all_finite((ptrdiff_t)n * n, a)) {
        return mt_lapack_not_finite("zsytrf", err);
    }
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    double *const sums = mt_arena_f64(mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(mem, err));
    out->norm = LAPACKE_zlansy_work(LAPACK_COL_MAJOR, '1', 'L', n, a, n, sums);
    double complex query = 1.0;
    double complex *work = NULL;
    lapack_int lwork = 1;
    if (n > MT_LAPACK_UNBLOCKED) {
        (void)LAPACKE_zsytrf_work(LAPACK_COL_MAJOR, 'L', n, a, n, out->pivot, &query, -1);
    }
    MT_TRY(work_of(mem, creal(query), 1.0, &work, &lwork, err));
    const lapack_int info =
        LAPACKE_zsytrf_work(LAPACK_COL_MAJOR, 'L', n, a, n, out->pivot, work, lwork);
    mt_arena_rewind(mem, mark);
    out->singular = info > 0;
    return info < 0 ? mt_lapack_bug("zsytrf", info, err) : MT_OK;
}

mt_status mt_complex_solve(const mt_complex_ldl *f, int nrhs, double complex *b, mt_err *err)
{
    if (f->n == 0 || nrhs == 0) {
        return MT_OK;
    }
    if (!all_finite((ptrdiff_t)f->n * nrhs, b)) {
        return mt_lapack_not_finite("zsytrs", err);
    }
    const lapack_int info =
        LAPACKE_zsytrs_work(LAPACK_COL_MAJOR, 'L', f->n, nrhs, f->a, f->n, f->pivot, b, f->n);
    return info < 0 ? mt_lapack_bug("zsytrs", info, err) : MT_OK;
}

mt_status mt_complex_rcond(const mt_complex_ldl *f, double *rcond, mt_arena *scratch,
                           mt_err *err)
{
    *rcond = f->n == 0 ? 1.0 : 0.0;
    if (f->n == 0 || f->singular) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double complex *const work = mt_arena_alloc(scratch, 2 * (size_t)f->n, sizeof *work);
    MT_TRY(mt_arena_check(scratch, err));
    const lapack_int info = LAPACKE_zsycon_work(LAPACK_COL_MAJOR, 'L', f->n, f->a, f->n,
                                                f->pivot, f->norm, rcond, work);
    mt_arena_rewind(scratch, mark);
    return info < 0 ? mt_lapack_bug("zsycon", info, err) : MT_OK;
}
