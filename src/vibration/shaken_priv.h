/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef VIBRATION_SHAKEN_PRIV_H
#define VIBRATION_SHAKEN_PRIV_H

#include "vibration/shaken.h"

/* Without a sum of poles: out->answers, each with its list of tones, are filled. */
mt_status mt_shaken_quadrature(mt_response *r, mt_shaken *out, mt_err *err);

#endif
