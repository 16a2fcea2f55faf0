/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/response_limit.h"

const char *const mt_response_limit_names[MT_RESPONSE_LIMIT_QUANTITIES] = {"response", "rms",
                                                                           "sine", "peak"};
