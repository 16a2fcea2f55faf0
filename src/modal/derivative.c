/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Differentiate K y = lambda M y and y^T M y = 1 along a parameter (a dot is d/dp), with
 * f = (Kdot - lambda Mdot) y:
 *     (K - lambda M) ydot - lambdadot M y = -f,
 *     y^T M ydot = -1/2 y^T Mdot y.
 * From the left with y^T:                   lambdadot = y^T f.
 * From the left with another mode's y_j^T:  y_j^T M ydot = y_j^T f / (lambda - lambda_j).
 */
#include "modal/derivative.h"

#include "modal/modal_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"

/* f := dky - lambda dmy, entries count. */
static void mode_derivative_force(ptrdiff_t count, double lambda, const double *dky,
                                  const double *dmy, double *f)
{
    for (ptrdiff_t i = 0; i < count; i++) {
        f[i] = dky[i] - (dmy == NULL ? 0.0 : lambda * dmy[i]);
    }
}

static void fill_nan(ptrdiff_t count, double *x)
{
    for (ptrdiff_t i = 0; i < count; i++) {
        x[i] = nan("");
    }
}

mt_status mt_modal_dcluster(const mt_modes *modes, int first, int r, const double *dky,
                            const double *dmy, double *out, mt_arena *scratch, mt_err *err)
{
    const int n = modes->n;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const f = mt_arena_f64(scratch, (size_t)n, (size_t)r);
    MT_TRY(mt_arena_check(scratch, err));
    double mean = 0.0;
    for (int i = 0; i < r; i++) {
        mean += modes->lambda[first + i] / r;
    }
    mode_derivative_force((ptrdiff_t)n * r, mean, dky, dmy, f);
    mt_gemm(true, false, r, r, n, 1.0, modes->y + (ptrdiff_t)first * n, n, f, n, 0.0, out, r);
    for (int j = 0; j < r; j++) {
        for (int i = j + 1; i < r; i++) {
            double *const lower = out + i + (ptrdiff_t)j * r;
            double *const upper = out + j + (ptrdiff_t)i * r;
            *lower = 0.5 * (*lower + *upper);
            *upper = *lower;
        }
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

/* dy := sum over modes j of y_j a_j; a (count x np) comes in as Y^T f. */
static void combine(const mt_modes *modes, int i, const mt_directions *dir, double *a,
                    double *dy, double *dlambda)
{
    const int r = modes->count;
    for (int p = 0; p < dir->np; p++) {
        double *const ap = a + (ptrdiff_t)p * r;
        if (dlambda != NULL) {
            dlambda[p] = ap[i];
        }
        for (int j = 0; j < r; j++) {
            ap[j] /= j == i ? 1.0 : modes->lambda[i] - modes->lambda[j];
        }
        const double *const dmy = dir->dmy == NULL ? NULL : dir->dmy + (ptrdiff_t)p * modes->n;
        const double *const y = modes->y + (ptrdiff_t)i * modes->n;
        ap[i] = dmy == NULL ? 0.0 : -0.5 * mt_dot(modes->n, y, dmy);
    }
    mt_gemm(false, false, modes->n, dir->np, r, 1.0, modes->y, modes->n, a, r, 0.0, dy,
            modes->n);
}

static mt_status repeated_mode(ptrdiff_t entries, double *dy, int np, double *dlambda,
                               mt_err *err)
{
    fill_nan(entries, dy);
    if (dlambda != NULL) {
        fill_nan(np, dlambda);
    }
    return mt_fail(err, MT_E_SINGULAR, "a repeated mode has no derivative of its own");
}

mt_status mt_modal_dvector_by_modes(const mt_modes *modes, int i, const mt_directions *dir,
                                    double *dy, double *dlambda, mt_arena *scratch, mt_err *err)
{
    const int n = modes->n;
    if (modes->y == NULL || modes->n_condensed > 0 || modes->shaped < modes->all) {
        return mt_fail(err, MT_E_USAGE,
                       "mt_modal_dvector_by_modes: needs all modes with vectors");
    }
    const ptrdiff_t entries = (ptrdiff_t)n * dir->np;
    int size = 0;
    (void)mt_modal_cluster(modes, i, &size);
    if (size > 1) {
        return repeated_mode(entries, dy, dir->np, dlambda, err);
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const f = mt_arena_f64(scratch, (size_t)n, (size_t)dir->np);
    double *const a = mt_arena_f64(scratch, (size_t)n, (size_t)dir->np);
    const mt_status rc = mt_arena_check(scratch, err);
    if (rc == MT_OK) {
        mode_derivative_force(entries, modes->lambda[i], dir->dky, dir->dmy, f);
        mt_gemm(true, false, n, dir->np, n, 1.0, modes->y, n, f, n, 0.0, a, n);
        combine(modes, i, dir, a, dy, dlambda);
    }
    mt_arena_rewind(scratch, mark);
    return rc;
}
