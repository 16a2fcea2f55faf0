/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_MODE_BAND_PAIRS_H
#define PROBLEM_MODE_BAND_PAIRS_H

#include "modal/modes.h"
#include "study/bands.h"

/*
 * Modes beside bands. The room that a mode at f has beside a band from a to b (with its margin)
 * is ln(a / f) below it, ln(f / b) above it; negative inside, on the way that is left sooner.
 */
/* Every vibration mode beside every band of a list, mode by mode, lowest first. */
typedef struct mt_mode_band_pair {
    const mt_modes *modes;
    const mt_bands *bands;
    int at; /* position among all modes */
    /* the pair: */
    int mode; /* vibration index, where the modes have one */
    int b;
    double hz;
    const mt_band *band;
} mt_mode_band_pair;
mt_mode_band_pair mt_mode_band_pairs_all(const mt_modes *modes, const mt_bands *bands);
/* The first pair, then the next one; false where there is none left. */
bool mt_mode_band_pairs_next(mt_mode_band_pair *p);

/* The room that a mode anywhere between low and high has, at least; not below
 * -MT_MOST_INSIDE. */
double mt_band_margin(const mt_band *band, double low_hz, double high_hz);
/* The room of all modes where k have to lie below the band: of modes k and k + 1. */
double mt_band_margin_with(const mt_modes *modes, const mt_band *band, int k);
/* The least room of any mode beside any band; infinite without bands or modes. below[bands->n]
 * (may be NULL): modes below the (geometric) middle of each; of a band from 0 Hz none is. */
double mt_bands_find(const mt_bands *bands, const mt_modes *modes, int *below);

#endif
