/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ENVIRONMENT_BANDS_H
#define ENVIRONMENT_BANDS_H

#include "base/document.h"
#include "environment/machine.h"
#include "environment/rotor.h"

/*
 * Forbidden frequency bands: from lists in Hz, from the harmonics of rotors and from the orders
 * of machines (machine.h). A rotor that turns at f [Hz], within r1 f to r2 f, forbids for its
 * harmonic m
 *     base    [m f r1, m f r2]
 *     margin  [m f r1 (1 - p/100), m f r2 (1 + p/100)]      p: separation margin in percent
 * A design keeps its modes out of the bands with their margin; proofs over tolerances take the
 * base.
 *
 * Bands that overlap or touch with their margins are one band: no mode fits between them. Its
 * base is the hull of their bases. Merging loses no design: a mode that starts outside the
 * merged band and moves continuously meets one of the bases before it can reach a gap between
 * them.
 */

typedef struct mt_band_hz {
    double lower_hz;
    double upper_hz;
    mt_addr addr;
} mt_band_hz;

typedef struct mt_band {
    double base_lower_hz; /* without margin */
    double base_upper_hz;
    double lower_hz; /* with margin: lower_hz <= base_lower_hz <= base_upper_hz <= upper_hz */
    double upper_hz;
    const char *label; /* "4P of UH-60", "8P + 1T of UH-60", "15.5 to 18.9 Hz" */
} mt_band;

typedef struct mt_bands {
    int n;
    mt_band *items; /* [n] ascending, disjoint with their margins */
    int n_notes;
    const char **notes; /* one sentence for each merger */
} mt_bands;

/* Modes of a cluster, which one band may hold. */
enum { MT_DEFAULT_CLUSTER = 2, MT_MAX_CLUSTER = 100 };

/* The sources of a list of bands. */
typedef struct mt_bands_source {
    int n_intervals;
    mt_band_hz *intervals; /* given in Hz */
    int n_rotors;
    mt_rotor *rotors;
    int n_machines;
    mt_machine *machines;
    /* of the intervals, and of rotors and machines that have none; NaN: 0 */
    double margin_percent;
    double up_to_hz; /* bands end there; NaN: no cut-off */
} mt_bands_source;

/* The margin in percent: `own`, or that of the list where `own` is NaN. */
double mt_bands_margin(const mt_bands_source *source, double own);

/**
 * The bands of a source, merged, sorted, cut off at up_to_hz (a base that lies above it becomes
 * the point up_to_hz).
 * @param[in]  margin_percent replaces every margin of the source, those of rotors and machines
 *   too; NaN: margins as given
 * @param[out] out lists and texts in mem
 * Harmonics of unknown frequency and intervals with NaN are left out (the checks of a study
 * note them). O(n log n) in the bands. Fails: MT_E_MEMORY.
 */
mt_status mt_bands_make(const mt_bands_source *source, double margin_percent, mt_arena *mem,
                        mt_bands *out, mt_err *err);
/* One list from several (of all goals that name one configuration), merged again; notes hold
 * the new mergers only. Fails: MT_E_MEMORY. */
mt_status mt_bands_unite(int n, const mt_bands *const *lists, mt_arena *mem, mt_bands *out,
                         mt_err *err);

/* Position relative to the base of a band. */
typedef enum mt_band_side { MT_BELOW_BAND, MT_INSIDE_BAND, MT_ABOVE_BAND } mt_band_side;
const char *mt_band_side_name(mt_band_side side);
/**
 * Clearance |ln(f/edge)| of a frequency from an edge in percent: 100 (greater/smaller - 1),
 * negative beyond the edge. The allowed side is below the edge where `below`, else above it.
 * Infinite unless both numbers are above 0.
 */
double mt_edge_clearance_percent(double edge_hz, bool below, double hz);
/** Clearance from the nearest edge of a band's base; negative inside. side: NULL, or the
 * position */
double mt_band_clearance_percent(const mt_band *band, double hz, mt_band_side *side);

/** ln(a/b) of frequencies or edges, a >= 0; HUGE_VAL where b is not above 0 (a mode of 0 Hz, a
 * band that begins at 0). */
double mt_log_ratio(double a_hz, double b_hz);

#endif
