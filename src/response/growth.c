/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "response/growth.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"

/* Of a pole's size, or of the largest eigenvalue times the order: what rounding may leave of a
 * damping that is 0. */
static const double ULPS = 64.0;

/* Has the symmetric matrix a negative direction? NULL: 0. */
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

mt_status mt_response_growing(const mt_forced *f, int n, const double complex *poles,
                              mt_arena *mem, int *growing, mt_err *err)
{
    *growing = -1;
    for (int k = 0; k < n; k++) {
        const double complex s = poles[k]; /* of negative frequency: the image of another */
        const bool right = cimag(s) >= 0.0 && creal(s) > ULPS * DBL_EPSILON * cabs(s);
        if (right && (*growing < 0 || creal(s) > creal(poles[*growing]))) {
            *growing = k;
        }
    }
    if (*growing < 0) {
        return MT_OK;
    }
    bool negative = false;
    MT_TRY(find_negative(f->n, f->c, mem, &negative, err));
    MT_TRY(find_negative(f->n, f->h, mem, &negative, err));
    *growing = negative ? *growing : -1;
    return MT_OK;
}
