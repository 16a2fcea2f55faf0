/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Logarithms of frequencies, their slopes, and margins of modes to bands. */

#include "problem/frequency.h"

#include <math.h>
#include <string.h>

#include "prove/box.h"

/* No floor lies lower: the square of an angular frequency would leave the range of a double. */
static const double LEAST_FLOOR_HZ = 1e-150;

double mt_frequency_ln_ratio(double hz, double edge_hz, double floor_hz)
{
    const double floor = fmax(floor_hz, LEAST_FLOOR_HZ);
    const double part = hz / floor;
    if (isinf(hz)) {
        return MT_MOST_INSIDE;
    }
    return part < 1.0 ? log(floor / edge_hz) + (0.5 * ((part * part) - 1.0))
                      : log(hz / edge_hz);
}

double mt_problem_ln_ratio(const mt_modes *modes, int pos, double edge_hz, double floor_hz)
{
    const double hz = pos < 0 ? HUGE_VAL : mt_modal_hz(modes, pos);
    return mt_frequency_ln_ratio(hz, edge_hz, floor_hz);
}

mt_status mt_problem_dln_frequency(mt_workspace *w, mt_analysis *a, int pos, double floor_hz,
                                   double *out, mt_err *err)
{
    const int n = w->p->n;
    int size = 1;
    int vibrating = 0;
    const mt_modes *const modes = &a->modes;
    if (pos < 0) {
        memset(out, 0, (size_t)n * sizeof *out);
        return MT_OK;
    }
    const int first = mt_modal_cluster(modes, pos, &size);
    const double lambda =
        fmax(modes->lambda[pos], mt_enclosure_lambda(fmax(floor_hz, LEAST_FLOOR_HZ)));
    for (int k = first; k < first + size; k++) {
        MT_TRY(mt_analysis_dlambda_raw(a, k, w->work, err));
        for (int i = 0; i < n; i++) {
            out[i] = k == first ? w->work[i] : out[i] + w->work[i];
        }
        /* vibrations of 0 Hz share their cluster with rigid-body modes, which have no slope and
         * add nothing to the sum */
        vibrating += modes->kind[k] == MT_MODE_FLEXIBLE ? 1 : 0;
    }
    for (int i = 0; i < n && vibrating > 0; i++) {
        out[i] *= mt_problem_dx_dt_at(w->p, i, w->x[i]) / (2.0 * lambda * (double)vibrating);
    }
    return MT_OK;
}

mt_mode_band_pair mt_mode_band_pairs_all(const mt_modes *modes, const mt_bands *bands)
{
    return (mt_mode_band_pair){.modes = modes, .bands = bands, .at = -1, .b = bands->n - 1};
}

bool mt_mode_band_pairs_next(mt_mode_band_pair *p)
{
    if (++p->b >= p->bands->n) { /* the next mode, beside the first band */
        p->b = 0;
        do {
            p->at++;
        } while (p->at < p->modes->count && p->modes->kind[p->at] != MT_MODE_FLEXIBLE);
        if (p->at >= p->modes->count || p->bands->n == 0) {
            return false;
        }
        p->mode++;
        p->hz = mt_modal_hz(p->modes, p->at);
    }
    p->band = &p->bands->items[p->b];
    return true;
}

/* Margin of a mode required below the band; no mode can be below one from 0 Hz. */
static double margin_below(const mt_band *band, double hz)
{
    return band->lower_hz > 0.0 ? mt_log_ratio(band->lower_hz, hz) : -HUGE_VAL;
}

double mt_band_margin(const mt_band *band, double low_hz, double high_hz)
{
    const double above = mt_log_ratio(low_hz, band->upper_hz);
    return fmax(margin_below(band, high_hz), fmax(above, -MT_MOST_INSIDE));
}

double mt_band_margin_with(const mt_modes *modes, const mt_band *band, int k)
{
    const int under = k > 0 ? mt_modal_flexible(modes, k) : -1;
    const int over = mt_modal_flexible(modes, k + 1);
    const double room = under >= 0 ? margin_below(band, mt_modal_hz(modes, under)) : HUGE_VAL;
    return over >= 0 ? fmin(room, mt_log_ratio(mt_modal_hz(modes, over), band->upper_hz))
                     : room;
}

double mt_bands_find(const mt_bands *bands, const mt_modes *modes, int *below)
{
    mt_mode_band_pair p = mt_mode_band_pairs_all(modes, bands);
    double room = HUGE_VAL;
    for (int b = 0; b < bands->n && below != NULL; b++) {
        below[b] = 0;
    }
    while (mt_mode_band_pairs_next(&p)) {
        room = fmin(room, mt_band_margin(p.band, p.hz, p.hz));
        if (below != NULL && p.band->lower_hz > 0.0) {
            below[p.b] += p.hz <= sqrt(p.band->lower_hz * p.band->upper_hz) ? 1 : 0;
        }
    }
    return room;
}
