/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_SHAPING_H
#define PROVE_SHAPING_H

#include "analysis/analysis.h"

/* found[n_inputs]: true for inputs that shape the geometry of stiffness and mass. */
void mt_enclosure_shaping(const mt_analysis *a, bool *found);

#endif
