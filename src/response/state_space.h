/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_STATE_SPACE_H
#define RESPONSE_STATE_SPACE_H

#include "response/basis.h"

/*
 * A forced problem as x' = A x + B u, y = C x + D u with real matrices, for programs of
 * control. The states are, in this order: coordinates of modes, their rates, coordinates of
 * directions without mass that a damper holds, and integrals of inputs (the velocity and the
 * displacement of a ground whose acceleration is the input, where an output's motion in space
 * needs them).
 *
 * Modes are mass-normalised; of those above the lowest `keep` only the static response to each
 * input remains, as residual shapes: the responses that the kept modes leave, orthogonal to
 * these in mass and stiffness, each with a frequency of its own above theirs. (Residual
 * vectors; MacNeal, Computers and Structures 1 (1971) 581-601, in the form of proper modes.) At
 * rest the response is that of all modes, and accelerations have a finite limit at high
 * frequencies, which a static correction in D alone has not.
 *
 * Loss factors have no real state space: each becomes the viscous damping that takes as much
 * energy from each mode at its own frequency, c_ij = h_ij/sqrt(w_i w_j).
 */
typedef struct mt_state_space {
    int n; /* states: 2 (modes + residual) + massless + integrals */
    int n_in;
    int n_out;
    double *a;     /* n x n, column-major, as b, c and d */
    double *b;     /* n x n_in */
    double *c;     /* n_out x n */
    double *d;     /* n_out x n_in */
    int modes;     /* kept, rigid-body modes included */
    int residual;  /* residual shapes */
    int massless;  /* coordinates without mass */
    int integrals; /* of inputs: integral i is of input integral_of[i], over time
                     * integral_order[i] times */
    int *integral_of;
    int *integral_order;
    bool lossy; /* loss factors stand as viscous damping */
    /* where there is none: the input or output that has none; -1: neither */
    int refused_input;
    int refused_output;
} mt_state_space;

/* From a basis of all modes, results in mem. keep: lowest modes; more than there are: all.
 * Rigid-body modes are always kept. O(n^2 + n_out n). Fails: MT_E_USAGE where there is no
 * proper state space, with the reason: an input whose derivative acts (velocity or displacement
 * of the ground), an output that follows a derivative of an input, loss factors at a direction
 * without mass; MT_E_MEMORY. */
mt_status mt_state_space_make(const mt_basis *basis, int keep, mt_arena *mem,
                              mt_state_space *out, mt_err *err);

/* Its response at w [rad/s], h[n_out x n_in]; infinite real part: none (an undamped motion
 * resonates). O(n^3). Fails: MT_E_MEMORY. */
mt_status mt_state_space_at(const mt_state_space *s, double w, double complex *h,
                            mt_arena *scratch, mt_err *err);

#endif
