/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_FREQUENCY_H
#define PROBLEM_FREQUENCY_H

#include "environment/bands.h"
#include "problem/workspace.h"

/*
 * Rows in ln f. A spring of stiffness 0 gives f = 0 and df/dk infinite, while d(f^2)/dk is
 * finite: below floor_hz, MT_FREQUENCY_FLOOR of the frequency compared with, ln f is continued
 * by its tangent in f^2,
 *     ln f_0 + (f^2 / f_0^2 - 1) / 2,
 * with a finite value and slope at 0 Hz, the same sign, and the same derivative at f_0. No goal
 * is met below floor_hz, whatever its tolerance.
 */
#define MT_FREQUENCY_FLOOR 1e-3
/* Log depth of a mode at 0 Hz in a band that begins there, a factor of 1000 of its upper edge:
 * ln(1 / MT_FREQUENCY_FLOOR). */
#define MT_MOST_INSIDE 7.0
/* ln(f / edge_hz), continued as above; of a mode at infinity MT_MOST_INSIDE, without a
 * slope. */
double mt_frequency_ln_ratio(double hz, double edge_hz, double floor_hz);
/* The same for the mode at pos; -1: at infinity. */
double mt_problem_ln_ratio(const mt_modes *modes, int pos, double edge_hz, double floor_hz);
/* out[n]: its slope lambda'/(2 lambda) with respect to all coordinates t. Of a repeated mode:
 * the mean of its cluster, which is smooth where single modes are not. */
mt_status mt_problem_dln_frequency(mt_workspace *w, mt_analysis *a, int pos, double floor_hz,
                                   double *out, mt_err *err);

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
