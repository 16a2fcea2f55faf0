/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_REFERENCE_H
#define PROBLEM_REFERENCE_H

#include "analysis/analysis.h"
#include "base/workers.h"
#include "study/study.h"

/* A frequency and a shape to compare with: of a model's configuration, or measured. */
typedef struct mt_reference_shape {
    const char *reference; /* name; NULL: none */
    int mode;              /* 1-based in the reference */
    int ns;                /* number of common channels */
    int *channel;          /* [ns] channels of the configuration's system */
    /* [ns] factor of each entry of a shape before comparison: an angle times the length that
     * makes it an arc. NULL: displacements or angles alone, unscaled */
    double *scale;
    double length;       /* length for angles [m] */
    double *shape;       /* [ns] of the reference, scaled, unit norm */
    double frequency_hz; /* NaN: not known */
} mt_reference_shape;

/* Analyses of references that are models, made on first use and shared by all problems of a
 * study and by workers, one after the other: they do not depend on the design. */
typedef struct mt_reference_cache {
    const mt_study *study;
    const mt_run *run;
    mt_analysis **analysis; /* [n_references] owned */
    mt_lock lock;           /* of the analyses and their memory */
} mt_reference_cache;

/* Study and run must outlive the cache; its array is in mem: free the cache first. Fails:
 * MT_E_MEMORY. */
mt_status mt_reference_cache_init(mt_reference_cache *cache, const mt_study *study,
                                  const mt_run *run, mt_arena *mem, mt_err *err);
/* Accepts a zeroed cache. */
void mt_reference_cache_free(mt_reference_cache *cache);

/* Shape of a reference's mode at the channels that sys has too, angles times length [m] (NaN:
 * the model's own) where there are displacements as well; results in mem. Fails: MT_E_INPUT (no
 * such mode, no common channel, a shape without motion there; the text names the reference),
 * failures of the reference's own analysis, MT_E_MEMORY. */
mt_status mt_reference_shape_init(mt_reference_cache *cache, int reference, int mode,
                                  const mt_system *sys, double length, mt_arena *mem,
                                  mt_reference_shape *out, mt_err *err);
/* Scales the columns of a shape (ns x n) like the reference's. */
void mt_reference_scale(const mt_reference_shape *ref, int n, double *shape);
/* The reference's frequency alone, for a frequency goal: ns is 0, no sensor is needed. Fails:
 * as mt_reference_shape_init. */
mt_status mt_reference_frequency_init(mt_reference_cache *cache, int reference, int mode,
                                      mt_reference_shape *out, mt_err *err);
/* MAC of the mode at position pos of the last solve with the reference; NaN where the mode does
 * not move at the sensors. */
mt_status mt_reference_mac(mt_analysis *a, int pos, const mt_reference_shape *ref, double *mac,
                           mt_err *err);

#endif
