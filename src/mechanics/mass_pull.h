/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_MASS_PULL_H
#define MECHANICS_MASS_PULL_H

#include "mechanics/linear_priv.h"

/* to[nq] += scale times the derivative of phi^T M phi by the position, in the left chart there,
 * at constant components phi. O(terms of M). */
void mt_mass_pull(const mt_linear *lin, double scale, const double *phi, double *to);

#endif
