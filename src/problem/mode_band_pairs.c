/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "problem/mode_band_pairs.h"

#include <math.h>

#include "problem/goal_frequency.h"

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
