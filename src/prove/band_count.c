/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "prove/band_count.h"

#include <float.h>

#include "linalg/dense.h"
#include "prove/box.h"

/* A pivot ratio (mt_inertia's gap) at or below UNSURE_ULPS n eps says nothing about the
 * sign. */
static const double UNSURE_ULPS = 16.0;

/* Vibration modes below hz. */
static mt_status count_vibration_modes_below(const mt_linear *lin, int n_rigid, double hz,
                                             mt_arena *scratch, int *modes, bool *sure,
                                             mt_err *err)
{
    const mt_reduced r = mt_linear_reduced(lin);
    int count[3];
    double gap = 0.0;
    *modes = 0;
    if (!(hz > 0.0)) {
        return MT_OK;
    }
    MT_TRY(mt_inertia(r.n, r.k, r.m, mt_enclosure_lambda(hz), count, &gap, scratch, err));
    *sure = *sure && gap > UNSURE_ULPS * (double)r.n * DBL_EPSILON;
    *modes = count[0] > n_rigid ? count[0] - n_rigid : 0;
    return MT_OK;
}

mt_status mt_certify_count(const mt_linear *lin, int n_rigid, double lower_hz, double upper_hz,
                           double tolerance, mt_arena *scratch, mt_band_count *out, mt_err *err)
{
    int under = 0;
    *out = (mt_band_count){.sure = true};
    MT_TRY(count_vibration_modes_below(lin, n_rigid, lower_hz * (1.0 + tolerance), scratch,
                                       &out->below, &out->sure, err));
    MT_TRY(count_vibration_modes_below(lin, n_rigid, upper_hz * (1.0 - tolerance), scratch,
                                       &under, &out->sure, err));
    out->inside = under > out->below ? under - out->below : 0;
    return MT_OK;
}
