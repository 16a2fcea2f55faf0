/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 *     dlambda/dp = y^T (dK - lambda dM) y,   f = sqrt(lambda) / (2 pi),
 *     df/dp = (dlambda/dp) / (8 pi^2 f).
 *
 * Where joints are redundant at the present value of a parameter only, frequencies jump there:
 * no derivative (mt_linear_independence).
 */
#include "analysis/sensitivity.h"

#include <math.h>

#include "linalg/dense.h"
#include "mechanics/products.h"

/* Derivatives of the cluster that begins at position first: its directional values,
 * ascending. */
static mt_status cluster_values(mt_analysis *a, int p, int first, int size, double *dlambda,
                                mt_err *err)
{
    const size_t n = (size_t)mt_linear_freedoms(a->lin);
    const size_t r = (size_t)size;
    const mt_arena_mark mark = mt_arena_get_mark(&a->mem);
    if (size == 1) { /* by all inputs at once, and kept */
        double *const all = mt_arena_f64(&a->mem, (size_t)a->sys->n_inputs, 1);
        MT_TRY(mt_arena_check(&a->mem, err));
        MT_TRY(mt_analysis_dlambda_raw(a, first, all, err));
        *dlambda = all[p];
        mt_arena_rewind(&a->mem, mark);
        return MT_OK;
    }
    double *const dky = mt_arena_f64(&a->mem, n, r);
    double *const dmy = mt_arena_f64(&a->mem, n, r);
    double *const matrix = mt_arena_f64(&a->mem, r, r);
    MT_TRY(mt_arena_check(&a->mem, err));
    MT_TRY(
        mt_linear_products(a->lin, p, size, mt_modal_shape(&a->modes, first), dky, dmy, err));
    MT_TRY(mt_modal_dcluster(&a->modes, first, size, dky, dmy, matrix, &a->mem, err));
    MT_TRY(mt_eig_sym(size, matrix, dlambda, false, &a->mem, err));
    mt_arena_rewind(&a->mem, mark);
    return MT_OK;
}

mt_status mt_analysis_sensitivity(mt_analysis *a, int p, int n, const int *position,
                                  mt_arena *mem, double *hz_per_unit, mt_independence *why,
                                  mt_err *err)
{
    const mt_modes *const modes = &a->modes;
    double *const values = mt_arena_f64(mem, (size_t)modes->count, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_linear_independence(a->lin, p, mem, why, err));
    /* where a mode is blocked, those above it are counted again */
    bool gone = why->opens;
    for (int i = 0; i < n;) {
        int size = 1;
        const int first = mt_modal_cluster(modes, position[i], &size);
        MT_TRY(cluster_values(a, p, first, size, values, err));
        for (int j = first; j < first + size && why->blocks && !gone; j++) {
            MT_TRY(mt_linear_blocked(a->lin, p, 1, mt_modal_shape(modes, j), &gone, err));
        }
        for (int j = 0; j < size && i < n; j++, i++) {
            const double hz = mt_modal_hz(modes, position[i]);
            hz_per_unit[i] = gone ? nan("") : mt_modal_hz_slope(values[j], hz);
        }
    }
    return MT_OK;
}
