/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A fresh analysis decides. Search, proofs and readings of a study rest on analyses that were
 * opened at the original design and count their modes as the whole study does. A design that is
 * reported is analysed once more from nothing: a new system made there, no bounds, its own
 * number of rigid-body modes. Mode by mode the two must agree, where
 *     a vibration of 0 Hz of the study is a rigid-body mode of the fresh analysis,
 * else nothing that the study says of the design is trusted.
 */
#include <math.h>

#include "describe/describe.h"

/* Frequencies that differ by more than this (relative) beyond their error bounds disagree: both
 * are good to about n eps. */
static const double RECOMPUTED_AGREES = 1e-9;
static double hz_of(double lambda)
{
    static const double TWO_PI = 6.283185307179586476925;
    return sqrt(fmax(lambda, 0.0)) / TWO_PI;
}

const char *mt_describe_disagreement(const mt_modes *study, const mt_modes *fresh,
                                     const char *configuration, mt_arena *mem)
{
    if (study->count != fresh->count || study->n_unstable != fresh->n_unstable ||
        study->n_undecided != fresh->n_undecided) {
        return mt_arena_printf(
            mem,
            "\"%s\" has %d modes, %d of them unstable or undecided; a fresh analysis finds "
            "%d and %d",
            configuration, study->count, study->n_unstable + study->n_undecided, fresh->count,
            fresh->n_unstable + fresh->n_undecided);
    }
    if (fresh->n_rigid < study->n_rigid) {
        return mt_arena_printf(mem,
                               "\"%s\" was taken to have %d rigid-body modes; a fresh analysis "
                               "finds %d",
                               configuration, study->n_rigid, fresh->n_rigid);
    }
    for (int i = 0; i < study->count && mt_modal_indexed(study); i++) {
        const double a = study->lambda[i];
        const double b = fresh->lambda[i];
        const double agrees = 2.0 * RECOMPUTED_AGREES * fmax(fabs(a), fabs(b));
        if (!(fabs(a - b) <= agrees + study->error[i] + fresh->error[i])) {
            return mt_arena_printf(mem,
                                   "mode %d of \"%s\" was taken to be at %.12g Hz; a fresh "
                                   "analysis gives %.12g Hz",
                                   i + 1 - study->n_rigid, configuration, hz_of(a), hz_of(b));
        }
    }
    return "";
}
