/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_MODAL_H
#define MODAL_MODAL_H

#include "modal/damped.h"
#include "modal/derivative.h"
#include "modal/mass.h"
#include "modal/modes.h"
#include "modal/solve.h"

/*
 * Undamped natural modes of the reduced system
 *     K y = lambda M y,   lambda = omega^2,   Y^T M Y = I,   lowest first.
 * This room knows matrices only. K, M: n x n symmetric, column-major, lower triangle read,
 * unchanged. K may be indefinite; M must be positive (semi)definite. Units are the caller's and
 * may differ between rows: no decision below depends on them.
 *
 * M singular: the n_condensed directions without mass are condensed statically where K is
 * regular on them (K10 K00^-1 K01), and only n - n_condensed modes exist. Otherwise
 * MT_E_MASSLESS with the direction.
 *
 * Kinds (never take the absolute value of an eigenvalue): with the stiffness scale s and noise
 * = 16 n eps s (see modes.h), |lambda| <= noise is a rigid-body mode (lambda set to
 * exactly 0), below -noise unstable, above noise flexible. Where n_rigid >= 0 is given
 * (constant for a family of designs), exactly the n_rigid eigenvalues of smallest magnitude are
 * rigid-body modes; of the others those below -noise are unstable, and those in [-noise, 0) are
 * flexible with lambda = 0: a vibration of 0 Hz, as where a stiffness reaches 0. Where
 * stiffness resists some of the n_rigid, n_held is their number, and the given n_rigid is
 * wrong. Matrices alone cannot distinguish a rigid-body mode from one whose stiffness is below
 * rounding: that takes the terms of K (mt_modal_judge). A mode that the terms leave open,
 * |lambda| at most its error with strained springs, is undecided. No mode has an index where a
 * mode is unstable or undecided.
 */

#endif
