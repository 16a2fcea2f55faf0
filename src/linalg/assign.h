/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_ASSIGN_H
#define LINALG_ASSIGN_H

#include "base/arena.h"

/* One-to-one assignment that maximises the sum of score (m x n, column-major): row i is paired
 * with pair[i], or -1. min(m,n) rows are paired, fewer only where no more pairs with finite
 * scores exist: a score that is not finite never makes a pair. O(min(m,n)^2 max(m,n)), shortest
 * augmenting paths (Jonker and Volgenant's form of the Hungarian method). Deterministic: the
 * same scores give the same pairing, a tie goes to the lower column found first. */
mt_status mt_assign(int m, int n, const double *score, int *pair, mt_arena *scratch,
                    mt_err *err);

#endif
