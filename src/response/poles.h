/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_POLES_H
#define RESPONSE_POLES_H

#include <complex.h>

#include "response/basis.h"

/* One entry of a frequency response as a sum over poles, valid for w >= 0:
 *     H(w) = sum_k residue_k / (i w - s_k) + d_0 + d_1 (i w) + d_2 (i w)^2.
 * Without structural damping poles come in conjugate pairs, both of which are listed. */
typedef struct mt_pole_sum {
    int n;                         /* poles */
    const double complex *s;       /* [n] [rad/s] */
    const double complex *residue; /* [n] [unit of H times rad/s] */
    double complex d[3];
    /* Poles from this one on are eigenvalues of modes that damping couples, known to `rounding`
     * [rad/s], of which a light damping may be little more; the others to their own last
     * digits. */
    int first_coupled;
    double rounding;
    /* Which of the poles grows by itself, -1: none, where the system was asked
     * (mt_response_sums); else the poles alone tell (mt_pole_sum_growing). */
    bool judged;
    int growing;
} mt_pole_sum;

/*
 * Of every output to every input: out[n_out x n_in] (column-major), all on the same poles. By
 * the modes alone where these diagonalise the damping, else of the 2n eigenproblem. Results in
 * mem.
 *     No sum of simple poles, and MT_E_SINGULAR: a pole that is (nearly) double in a way that
 * the vectors tell (critical damping; two modes that damping turns into one), a motion without
 * stiffness and damping whose displacement is asked for (1/s^2), what grows faster than s^2.
 * What the sum gives is held against direct solves at the poles' frequencies. Fails also:
 * MT_E_NO_CONVERGENCE, MT_E_MEMORY.
 */
mt_status mt_response_poles(const mt_basis *basis, mt_arena *mem, mt_pole_sum *out,
                            mt_err *err);

/* The poles alone, which there always are: *n of them in *s, those of rigid-body modes left
 * out. Fails: MT_E_NO_CONVERGENCE, MT_E_MEMORY. */
mt_status mt_response_pole_list(const mt_basis *basis, mt_arena *mem, int *n,
                                double complex **s, mt_err *err);

/* The pole that grows by itself, by the rule of modal/growth.h; -1: none. */
int mt_pole_sum_growing(const mt_pole_sum *p);
/* Its value at w. */
double complex mt_pole_sum_at(const mt_pole_sum *p, double w);

#endif
