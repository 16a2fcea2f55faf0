/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_POLES_H
#define RESPONSE_POLES_H

#include <complex.h>

#include "response/basis.h"

/* One entry of a frequency response as a sum over poles, valid for w >= 0:
 *     H(w) = sum_k residue_k / (i w - s_k) + d_0 + d_1 (i w) + d_2 (i w)^2.
 * Without structural damping poles come in conjugate pairs, both listed. */
typedef struct mt_pole_sum {
    int n;                         /* poles */
    const double complex *s;       /* [n] [rad/s] */
    const double complex *residue; /* [n] [unit of H times rad/s] */
    double complex d[3];
    /* From this pole on they are eigenvalues of modes coupled by damping, with the absolute
     * error `rounding` [rad/s], which may exceed a light damping; earlier poles are accurate to
     * their own last digits. */
    int first_coupled;
    double rounding;
    /* judged: `growing` was determined for the system (mt_response_sums): the pole that grows
     * by itself, -1: none. Otherwise mt_pole_sum_growing uses the poles alone. */
    bool judged;
    int growing;
} mt_pole_sum;

/*
 * Pole sums of every output for every input: out[n_out x n_in] (column-major), all with the
 * same poles. From the modes alone where these diagonalise the damping, else from the 2n
 * eigenproblem. The sum is checked against direct solves at the poles' frequencies. Results in
 * mem.
 *
 * Fails: MT_E_SINGULAR where H is no sum over simple poles: a pole that is (nearly) double with
 * deficient vectors (critical damping; two modes that damping merges), the displacement of a
 * motion without stiffness and damping (1/s^2), growth faster than s^2. MT_E_NO_CONVERGENCE,
 * MT_E_MEMORY.
 */
mt_status mt_response_poles(const mt_basis *basis, mt_arena *mem, mt_pole_sum *out,
                            mt_err *err);

/* The poles alone, which always exist: *n of them in *s, without those of rigid-body modes.
 * Fails: MT_E_NO_CONVERGENCE, MT_E_MEMORY. */
mt_status mt_response_pole_list(const mt_basis *basis, mt_arena *mem, int *n,
                                double complex **s, mt_err *err);

/* Index of the pole that grows by itself, by the rule of modal/damped.h; -1: none. */
int mt_pole_sum_growing(const mt_pole_sum *p);
/* Value of the sum at w [rad/s]. */
double complex mt_pole_sum_at(const mt_pole_sum *p, double w);

#endif
