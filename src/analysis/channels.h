/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_CHANNELS_H
#define ANALYSIS_CHANNELS_H

#include "analysis/analysis.h"

/* Channels whose names two analyses share: their indices in each, in the order of a. */
typedef struct mt_common_channels {
    int n;
    int *a; /* [n] */
    int *b; /* [n] */
} mt_common_channels;

/* O(channels of a times those of b). Fails: MT_E_MEMORY. */
mt_status mt_analysis_common_channels(const mt_analysis *a, const mt_analysis *b, mt_arena *mem,
                                      mt_common_channels *out, mt_err *err);

/* Weights of channels with displacements and angles: 1, or the length [m] that turns an angle
 * into an arc, in mem; *scale is NULL where all are of one kind. Fails: MT_E_MEMORY. */
mt_status mt_channels_scale(const mt_system *sys, int n, const int *channels, double length,
                            mt_arena *mem, double **scale, mt_err *err);
/* Multiply the rows of shapes[n x columns] by scale; NULL: unchanged. */
void mt_channels_weigh(int n, const double *scale, int columns, double *shapes);

#endif
