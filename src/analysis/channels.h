/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_CHANNELS_H
#define ANALYSIS_CHANNELS_H

#include "analysis/analysis.h"

/* Channels whose names two analyses share: numbers of them in either, in the order of a. */
typedef struct mt_common_channels {
    int n;
    int *a; /* [n] */
    int *b; /* [n] */
} mt_common_channels;

/* O(channels of a times those of b). Fails: MT_E_MEMORY. */
mt_status mt_analysis_common_channels(const mt_analysis *a, const mt_analysis *b, mt_arena *mem,
                                      mt_common_channels *out, mt_err *err);

#endif
