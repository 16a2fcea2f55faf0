/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_COUNT_H
#define ANALYSIS_COUNT_H

#include "analysis/analysis.h"
#include "model/count_box.h"

/*
 * Count the modes for all designs of the box (NULL or empty: nothing changes) and set n_rigid
 * accordingly; the modes of the last solve are void where it changed. With constant geometry
 * and without loads, n_rigid never exceeds the number of free directions of any design of the
 * box: a term of K counts unless interval arithmetic shows its coefficient to be 0 over the
 * whole box. Otherwise it is the least over a fixed list of designs (the first, corners,
 * middle, eight more), and a solve at a design with fewer free directions fails. Cost: nothing
 * where no direction is free at the first design; otherwise one more system and one eigensolve,
 * or some fifteen solves. Fails as mt_analysis_new_of.
 */
mt_status mt_analysis_count(mt_analysis *a, const mt_count_box *box,
                            const mt_system_drive *drive, double position, mt_err *err);
/* Position in a->modes of the vibration mode that the model names by `index`, which counts at
 * the first design alone, without the vibrations of 0 Hz of other designs. -1: as
 * mt_modal_flexible. */
int mt_analysis_named(const mt_analysis *a, int index);
/* True where the family has more vibration modes than the last solve's design, and this index
 * is one of the missing ones (a mass is 0): its frequency is infinite. */
bool mt_analysis_is_infinite(const mt_analysis *a, int index);
/* Number of directions that remain free where only the terms of K with holds[t] (one for each
 * of mt_linear_terms(lin, MT_TERM_STIFFNESS)) resist: null directions of their sum, for any
 * sizes. Geometry and mass are those of the last update. Not where the mechanism is loaded
 * (mt_reduced.loaded). O(n^3). */
mt_status mt_analysis_free_directions(const mt_linear *lin, const mt_mass_factor *mass,
                                      const bool *holds, mt_arena *scratch, int *n,
                                      mt_err *err);
/* True where the mode at pos is a vibration of 0 Hz (after a solve with vectors); text[size]:
 * the springs of zero stiffness that would resist it, "\"ground\", \"k2\"", or "". */
bool mt_analysis_slack(const mt_analysis *a, int pos, char *text, size_t size);

#endif
