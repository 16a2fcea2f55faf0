/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tune/tracking.h"

mt_status mt_track_weigh(mt_analysis *a, int pos, double *w, mt_err *err)
{
    return mt_linear_mass_product(a->lin, a->modes.y + ((ptrdiff_t)pos * a->lin->n), w, err);
}

/* share: n x count, column-major; rows are the named modes. */
static void shares(const mt_analysis *a, int n, const double *const *w, double *phi,
                   double *share)
{
    const int nq = a->sys->nq;
    for (int c = 0; c < a->modes.count; c++) {
        mt_linear_expand(a->lin, 1, a->modes.y + ((ptrdiff_t)c * a->lin->n), phi);
        for (int r = 0; r < n; r++) {
            const double part = mt_dot(nq, w[r], phi);
            share[r + ((ptrdiff_t)c * n)] = part * part;
        }
    }
    for (int r = 0; r < n; r++) {
        double sum = 0.0;
        for (int c = 0; c < a->modes.count; c++) {
            sum += share[r + ((ptrdiff_t)c * n)];
        }
        for (int c = 0; c < a->modes.count; c++) {
            double *const s = &share[r + ((ptrdiff_t)c * n)];
            *s = sum > 0.0 && a->modes.kind[c] == MT_MODE_FLEXIBLE ? *s / sum : -1.0;
        }
    }
}

mt_status mt_track_assign(mt_analysis *a, int n, const double *const *w, int *pair,
                          double *share, mt_err *err)
{
    for (int r = 0; r < n; r++) {
        pair[r] = -1;
        share[r] = 0.0;
    }
    if (a->modes.n_unstable > 0 || n == 0) {
        return MT_OK;
    }
    if (a->modes.y == NULL) {
        return mt_fail(err, MT_E_INTERNAL,
                       "named modes asked for after a solve without shapes");
    }
    const mt_arena_mark mark = mt_arena_get_mark(&a->mem);
    double *const all = mt_arena_f64(&a->mem, (size_t)n, (size_t)a->modes.count);
    double *const phi = mt_arena_f64(&a->mem, (size_t)a->sys->nq, 1);
    mt_status rc = all == NULL || phi == NULL ? mt_fail_memory(err) : MT_OK;
    if (rc == MT_OK) {
        shares(a, n, w, phi, all);
        rc = mt_assign(n, a->modes.count, all, pair, &a->mem, err);
    }
    for (int r = 0; r < n && rc == MT_OK; r++) {
        const double s = pair[r] < 0 ? -1.0 : all[r + ((ptrdiff_t)pair[r] * n)];
        share[r] = s < 0.0 ? 0.0 : s;
        pair[r] = s < 0.0 ? -1 : pair[r]; /* no vibration mode was left */
    }
    mt_arena_rewind(&a->mem, mark);
    return rc;
}
