/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Natural frequencies of a model, as it is or with other values of its parameters. */
#ifndef MODETUNE_MODES_H
#define MODETUNE_MODES_H

#include "modetune/export.h"
#include "modetune/model.h"
#include "modetune/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A value for a parameter, in the parameter's unit; parameters that are expressions of it
 * follow. */
typedef struct mt_setting {
    const char *parameter;
    double value;
} mt_setting;

/* Modes by kind. Vibration modes have an index (from 1, by ascending frequency); where one mode
 * is unstable or undecided, none has. Undecided: rounding hides the sign of the mode's
 * stiffness while springs do move in it, as at a buckling load. */
typedef struct mt_mode_count {
    int vibration;
    int rigid_body;
    int unstable;
    int undecided;
} mt_mode_count;

/**
 * Undamped natural frequencies of one configuration, linearised at its equilibrium.
 * @param[in]  configuration  name; NULL: the model's first
 * @param[in] settings [n_settings] values that replace the model's own; a value that the
 *   configuration itself fixes wins. NULL with n_settings 0
 * @param[in]  capacity       room in frequency_hz, 0 or more
 * @param[out] frequency_hz [capacity] of the vibration modes, ascending [Hz]; NULL with
 *   capacity 0; as many as there are and fit; none where a mode is unstable or undecided
 * @param[out] count how many modes there are, whatever the capacity The model is not changed
 *   and may be shared by threads. Allocates, and gives everything back. O(n^3) in the number of
 *   freedoms. Fails: MT_E_USAGE (no such configuration or parameter, one set twice, a name or
 *   finite value missing, a negative number, a missing array), MT_E_ASSEMBLY, MT_E_EQUILIBRIUM,
 *   MT_E_DEAD_CENTRE, MT_E_MASSLESS, MT_E_DOMAIN, MT_E_INPUT, MT_E_MEMORY: err tells which
 *   joint, number or body.
 */
MT_API mt_status mt_model_frequencies(const mt_model *model, const char *configuration,
                                      int n_settings, const mt_setting *settings, int capacity,
                                      double *frequency_hz, mt_mode_count *count, mt_err *err);

#ifdef __cplusplus
}
#endif

#endif
