/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The sign of an eigenvector is free; a rule must give the same one on every machine and along
 * a search. "The largest entry is positive" alone does not: a symmetrical structure has mirror
 * entries of equal size and, in its antisymmetrical modes, of opposite sign, and rounding picks
 * the larger. Vectors of modes that are not clustered are accurate to about n eps s / gap, far
 * better than 1e-6 unless modes are nearly repeated or the spread is extreme; so entries within
 * TIE of the largest count as equal and their order decides. A structure whose entries differ
 * by just TIE flips; no rule is continuous, and engineers draw equal entries far more often
 * than those.
 */
#include "modal/sign.h"

#include <math.h>
#include <stddef.h>

static const double TIE = 1e-6;

void mt_modal_fix_sign(int n, int r, double *phi)
{
    for (int j = 0; j < r; j++) {
        double *const v = phi + (ptrdiff_t)j * n;
        double most = 0.0;
        for (int i = 0; i < n; i++) {
            most = fmax(most, fabs(v[i]));
        }
        int first = 0;
        while (first < n && !(fabs(v[first]) >= (1.0 - TIE) * most)) {
            first++;
        }
        if (first < n && v[first] < 0.0) {
            for (int i = 0; i < n; i++) {
                v[i] = -v[i];
            }
        }
    }
}
