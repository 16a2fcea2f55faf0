/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Profiles of vibration from files: random parts and tones of the acceleration of a base.
 * Immutable; one may be shared by threads. */
#ifndef MODETUNE_PROFILE_H
#define MODETUNE_PROFILE_H

#include "modetune/export.h"
#include "modetune/read.h"
#include "modetune/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct mt_vibration mt_vibration;

/**
 * Read a profile (format "modetune-profile/1") and the catalogue of aircraft that its rotors
 * are in.
 * @param[in]  path  as of mt_model_read
 * @param[in]  opt NULL: defaults; its diagnostics include warnings of assumed and unconfirmed
 *   values
 * @param[out] out   owned by the caller; NULL on failure
 * Fails as mt_model_read.
 */
MT_API mt_status mt_vibration_read(const char *path, const mt_read_options *opt,
                                   mt_vibration **out, mt_err *err);
/* Accepts NULL. */
MT_API void mt_vibration_delete(mt_vibration *vibration);
/* RMS of the random parts together [m/s^2]; NaN without a profile. */
MT_API double mt_vibration_rms(const mt_vibration *vibration);

#ifdef __cplusplus
}
#endif

#endif
