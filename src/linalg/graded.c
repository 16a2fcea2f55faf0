/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "linalg/graded.h"

#include <stddef.h>

#include "linalg/cholesky.h"
#include "linalg/svd.h"

static mt_status graded(int n, double *a, double *w, mt_arena *scratch, mt_err *err)
{
    double *const factor = mt_arena_f64(scratch, (size_t)n, (size_t)n); /* zero */
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(mt_cholesky(n, a, NULL, err));
    for (ptrdiff_t j = 0; j < n; j++) {
        for (ptrdiff_t i = j; i < n; i++) {
            factor[j + (i * n)] = a[i + (j * n)]; /* L^T: its right vectors are those of A */
        }
    }
    MT_TRY(mt_svd_jacobi(n, n, factor, w, a, scratch, err));
    for (int i = 0; i < n; i++) {
        w[i] *= w[i];
    }
    return MT_OK;
}

mt_status mt_eig_graded(int n, double *a, double *w, mt_arena *scratch, mt_err *err)
{
    if (n == 0) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = graded(n, a, w, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}
