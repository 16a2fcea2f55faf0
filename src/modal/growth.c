/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modal/growth.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"

/* Of a pole's size, or of the largest eigenvalue times the order: what rounding may leave of a
 * damping that is 0. */
static const double ULPS = 64.0;

/* *negative is set where the symmetric matrix has a negative direction, else left. NULL: 0. */
static mt_status find_negative(int n, const double *a, mt_arena *mem, bool *negative,
                               mt_err *err)
{
    if (a == NULL || n == 0) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    double *const copy = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const w = mt_arena_f64(mem, (size_t)n, 1);
    mt_status rc = mt_arena_check(mem, err);
    if (rc == MT_OK) {
        memcpy(copy, a, (size_t)n * (size_t)n * sizeof *copy);
        rc = mt_eig_sym(n, copy, w, false, mem, err);
    }
    if (rc == MT_OK) {
        const double most = fmax(fabs(w[0]), fabs(w[n - 1]));
        *negative = *negative || w[0] < -ULPS * DBL_EPSILON * n * most;
    }
    mt_arena_rewind(mem, mark);
    return rc;
}

int mt_modal_growing_pole(int n, const double complex *s, double rounding)
{
    int growing = -1;
    for (int k = 0; k < n; k++) {
        const double least = fmax(ULPS * DBL_EPSILON * cabs(s[k]), rounding);
        const bool right = cimag(s[k]) >= 0.0 && creal(s[k]) > least;
        if (right && (growing < 0 || creal(s[k]) > creal(s[growing]))) {
            growing = k;
        }
    }
    return growing;
}

mt_status mt_modal_is_passive(int n, const double *c, const double *h, mt_arena *mem,
                              bool *passive, mt_err *err)
{
    bool negative = false;
    MT_TRY(find_negative(n, c, mem, &negative, err));
    MT_TRY(find_negative(n, h, mem, &negative, err));
    *passive = !negative;
    return MT_OK;
}
