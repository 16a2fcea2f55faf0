/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "linalg/lapack_priv.h"

#include <limits.h>
#include <math.h>

mt_status mt_lapack_bug(const char *routine, lapack_int info, mt_err *err)
{
    return mt_fail(err, MT_E_INTERNAL, "%s: argument %d is wrong", routine, (int)-info);
}

mt_status mt_lapack_not_finite(const char *routine, mt_err *err)
{
    return mt_fail(err, MT_E_DOMAIN, "%s: a matrix entry is not a finite number", routine);
}

mt_status mt_lapack_work(mt_arena *scratch, double query, double minimum, double **work,
                         lapack_int *lwork, mt_err *err)
{
    const double size = ceil(fmax(fmax(query, minimum), 1.0));
    if (!(size <= (double)INT_MAX)) {
        return mt_fail_memory(err);
    }
    *lwork = (lapack_int)size;
    *work = mt_arena_f64(scratch, (size_t)size, 1);
    return mt_arena_check(scratch, err);
}
