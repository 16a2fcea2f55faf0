/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_CMD_MODES_H
#define CLI_CMD_MODES_H

#include "analysis/analysis.h"

/* Shapes at given channels of the given positions: value ns x n. */
mt_status mt_shapes_at(mt_analysis *a, int ns, const int *channels, int n, const int *positions,
                       double *value, mt_err *err);

#endif
