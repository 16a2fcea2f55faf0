/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_ENERGY_SHARE_H
#define ANALYSIS_ENERGY_SHARE_H

#include "analysis/analysis.h"
#include "mechanics/energy_share.h"

/*
 * Shares of a mode's energy (mechanics/energy_share.h) as functions of the inputs. Of modes of
 * one frequency, whose single shapes are anything, the share is the sum over all of them, which
 * no choice of shapes changes: with r modes the shares of all bodies sum to r, and those of one
 * direction are still at most 1 where none is negative. It is the trace of the form over the
 * cluster and has exact slopes there, too.
 */

/* *share: of the cluster of the mode at pos; dshare[n_inputs] (may be NULL): its derivatives,
 * after a solve with gradient. Shapes must have been wanted. Fails: MT_E_DOMAIN (strain of a
 * mode at 0 Hz; as mt_energy_part_slope), MT_E_SINGULAR, MT_E_MEMORY, MT_E_INTERNAL. */
mt_status mt_analysis_energy_share(mt_analysis *a, int pos, const mt_energy_part *part,
                                   double *share, double *dshare, mt_err *err);

/* Position of the vibration mode that has most of a part, the first of clusters and of equal
 * ones; -1: there is none. Fails as mt_analysis_energy_share. */
mt_status mt_analysis_most_energy(mt_analysis *a, const mt_energy_part *part, int *pos,
                                  mt_err *err);

/* All shares of one mode, or of the modes of one frequency. */
typedef struct mt_energy_shares {
    int first;      /* position of the first mode */
    int modes;      /* number of modes of that frequency; what the shares sum to */
    double *motion; /* [n_bodies x 6] by body */
    bool *global;   /* [n_bodies] along the global axes: it has no others */
    /* [n_springs x 6] of bushings their components, otherwise first the whole; NaN for a mode
     * at 0 Hz, which strains nothing */
    double *strain;
    double loads;      /* geometric part */
    double motion_sum; /* of all of `motion` */
    double strain_sum; /* of all of `strain` and loads */
} mt_energy_shares;

/* In mem. Fails: MT_E_MEMORY, MT_E_DOMAIN (the point has no place), MT_E_INTERNAL (no
 * shape). */
mt_status mt_analysis_energy_shares(mt_analysis *a, int pos, const mt_energy_owners *owners,
                                    const mt_energy_about *about, mt_arena *mem,
                                    mt_energy_shares *out, mt_err *err);

#endif
