/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_REFERENCE_H
#define PROBLEM_REFERENCE_H

#include "analysis/analysis.h"
#include "study/study.h"

/* Frequencies and shapes to compare with: those of a model's configuration, or measured
 * ones. */
typedef struct mt_reference_shape {
    const char *reference; /* name; NULL: none */
    int mode;              /* 1-based in the reference */
    int ns;                /* channels that both sides have */
    int *channel;          /* [ns] channels of the configuration's system */
    /* [ns] what the entries of any shape are multiplied by before it is compared: an angle by
     * the length at which it is an arc. NULL: displacements or angles alone, each counts as it
     * is */
    double *scale;
    double length;       /* that length [m] */
    double *shape;       /* [ns] of the reference, scaled, unit norm */
    double frequency_hz; /* NaN: not known */
} mt_reference_shape;

/* References that are models are analysed once, when first asked for, and shared by all
 * problems of a study: they do not depend on the design. */
typedef struct mt_reference_cache {
    const mt_study *study;
    const mt_run *run;
    mt_analysis **analysis; /* [n_references] owned */
} mt_reference_cache;

/* The study and the run must outlive the cache; its array lives in mem, so free the cache
 * first. Fails: MT_E_MEMORY. */
mt_status mt_reference_cache_init(mt_reference_cache *cache, const mt_study *study,
                                  const mt_run *run, mt_arena *mem, mt_err *err);
/* Accepts a zeroed cache. */
void mt_reference_cache_free(mt_reference_cache *cache);

/* The shape of a mode of a reference at the channels that sys has as well, angles at length [m]
 * (NaN: the model's own) where there are displacements, too; results in mem. Fails:
 * MT_E_INPUT (no such mode, no common channel, a shape without motion there; the text names the
 * reference), failures of the reference's own analysis, MT_E_MEMORY. */
mt_status mt_reference_shape_init(mt_reference_cache *cache, int reference, int mode,
                                  const mt_system *sys, double length, mt_arena *mem,
                                  mt_reference_shape *out, mt_err *err);
/* Scale columns of a shape (ns by n) as the reference's is. */
void mt_reference_scale(const mt_reference_shape *ref, int n, double *shape);
/* The reference's frequency alone, for a frequency goal: ns is 0, no sensor is needed. Fails
 * likewise. */
mt_status mt_reference_frequency_init(mt_reference_cache *cache, int reference, int mode,
                                      mt_reference_shape *out, mt_err *err);
/* MAC of the mode at position pos of the last solve with the reference; NaN where the mode does
 * not move at the sensors. */
mt_status mt_reference_mac(mt_analysis *a, int pos, const mt_reference_shape *ref, double *mac,
                           mt_err *err);

#endif
