/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_REDUNDANT_H
#define MECHANICS_REDUNDANT_H

#include "mechanics/linear.h"
#include "mechanics/singular.h"

/* Results of the elimination at the linearised position, in names of the model. After an
 * update. */

/* Number of redundant equations (m - rank); names of the joints of set k, in mem. */
int mt_linear_redundant(const mt_linear *lin);
mt_status mt_linear_redundant_set(mt_linear *lin, int k, mt_arena *mem, mt_joint_names *out,
                                  mt_err *err);
/* Distance to a position where equations are dependent there only (singular.h). Names are in
 * mem. */
mt_status mt_linear_nearness(mt_linear *lin, mt_arena *mem, mt_nearness *out, mt_err *err);
/* Names of the bodies and directions that dominate a direction y in the freedoms, "bob
 * (rotation)", for messages, in text[size]. */
void mt_linear_name_direction(const mt_linear *lin, const double *y, char *text, size_t size);

#endif
