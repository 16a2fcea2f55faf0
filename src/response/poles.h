/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_POLES_H
#define RESPONSE_POLES_H

#include <complex.h>

/* One entry of a frequency response as a sum over poles, valid for w >= 0:
 *     H(w) = sum_k residue_k / (i w - s_k) + d_0 + d_1 (i w) + d_2 (i w)^2.
 * Without structural damping poles come in conjugate pairs, both of which are listed. */
typedef struct mt_pole_sum {
    int n;                         /* poles */
    const double complex *s;       /* [n] [rad/s] */
    const double complex *residue; /* [n] [unit of H times rad/s] */
    double complex d[3];
} mt_pole_sum;

#endif
