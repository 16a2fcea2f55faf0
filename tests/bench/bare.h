/* SPDX-License-Identifier: GPL-3.0-or-later */
/* LAPACK's dsyevd with vectors, by itself: what an answer is measured against. */
#ifndef BENCH_BARE_H
#define BENCH_BARE_H

#include <lapacke.h>

#include "base/arena.h"

/* a[n * n], lower triangle read, becomes the vectors; lambda[n] ascending; scratch from mem. */
static inline mt_status bare_dsyevd(int n, double *a, double *lambda, mt_arena *mem,
                                    mt_err *err)
{
    const int size = 1 + (6 * n) + (2 * n * n);
    double *const work = mt_arena_f64(mem, (size_t)size, 1);
    int *const iwork = mt_arena_int(mem, 3 + (5 * (size_t)n));
    MT_TRY(mt_arena_check(mem, err));
    return LAPACKE_dsyevd_work(LAPACK_COL_MAJOR, 'V', 'L', n, a, n, lambda, work, size, iwork,
                               3 + (5 * n)) == 0
               ? MT_OK
               : mt_fail(err, MT_E_NO_CONVERGENCE, "dsyevd failed");
}

#endif
