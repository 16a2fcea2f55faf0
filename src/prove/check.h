/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_CHECK_H
#define PROVE_CHECK_H

#include "prove/enclosure.h"

/* Is the analysis one that can be enclosed? False with the reason. */
bool mt_enclosure_admits(const mt_analysis *a, char *reason);

#endif
