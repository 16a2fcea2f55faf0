/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/shake.h"

const char *const mt_shake_names[MT_SHAKE_QUANTITIES] = {"response", "rms", "sine", "peak"};
