/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/run.h"

const mt_run mt_run_none = {.interrupt = NULL};
