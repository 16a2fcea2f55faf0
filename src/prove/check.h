/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_CHECK_H
#define PROVE_CHECK_H

#include "prove/enclosure.h"

/* True where the analysis can be enclosed over lower <= x <= upper; false with the reason.
 * frozen[n_inputs]: mt_enclosure_shaping. */
bool mt_enclosure_admits(const mt_analysis *a, const double *lower, const double *upper,
                         bool *frozen, char *reason);

#endif
