/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_MODE_BAND_PAIRS_H
#define PROBLEM_MODE_BAND_PAIRS_H

#include "modal/modes.h"
#include "study/bands.h"

/*
 * Modes and bands. The log margin of a mode at f to a band from a to b (with its margin) is
 * ln(a / f) below it, ln(f / b) above it, and inside it the greater of these two, negative.
 */
/* Iterator over all pairs of vibration mode and band, mode by mode, lowest first. */
typedef struct mt_mode_band_pair {
    const mt_modes *modes;
    const mt_bands *bands;
    int at; /* position among all modes */
    /* the current pair: */
    int mode; /* vibration index, where modes are indexed */
    int b;
    double hz;
    const mt_band *band;
} mt_mode_band_pair;
mt_mode_band_pair mt_mode_band_pairs_all(const mt_modes *modes, const mt_bands *bands);
/* Advances to the first, then the next pair; false after the last. */
bool mt_mode_band_pairs_next(mt_mode_band_pair *p);

/* Least log margin of a mode anywhere in low_hz ... high_hz; at least -MT_MOST_INSIDE. */
double mt_band_margin(const mt_band *band, double low_hz, double high_hz);
/* Log margin of all modes with k of them below the band: the lesser of modes k and k + 1. */
double mt_band_margin_with(const mt_modes *modes, const mt_band *band, int k);
/* Least log margin over all modes and bands; infinite without either. below[bands->n] (may be
 * NULL): number of modes below the geometric middle of each band; 0 for a band from 0 Hz. */
double mt_bands_find(const mt_bands *bands, const mt_modes *modes, int *below);

#endif
