/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef VIBRATION_PROFILED_PRIV_H
#define VIBRATION_PROFILED_PRIV_H

#include "vibration/profiled.h"

/* Fill out->answers, each with its list of tones, by quadrature, without a sum of poles. */
mt_status mt_profiled_quadrature(mt_response *r, mt_profiled *out, mt_err *err);

#endif
