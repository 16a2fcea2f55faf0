/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_MODAL_H
#define MODAL_MODAL_H

#include "modal/bordered.h"
#include "modal/derivative.h"
#include "modal/growth.h"
#include "modal/judge.h"
#include "modal/mac.h"
#include "modal/mass.h"
#include "modal/modes.h"
#include "modal/sign.h"
#include "modal/solve.h"

/*
 * Undamped natural modes of the reduced system
 *     K y = lambda M y,   lambda = omega^2,   Y^T M Y = I,   lowest first.
 * This room knows matrices only. K, M: n x n symmetric, column-major, lower triangle read,
 * unchanged. K may be indefinite; M must be positive (semi)definite. Units are the caller's,
 * rows may have different ones: no decision below depends on them.
 *
 * M singular: the directions without mass are condensed statically where K is regular on them
 * (K10 K00^-1 K01); n_condensed of them, then only n - n_condensed modes exist. Otherwise
 * MT_E_MASSLESS with the direction.
 *
 * Kinds (never take the absolute value of an eigenvalue): with the stiffness scale s and noise
 * = 16 n eps s (see modal_priv.h), |lambda| <= noise is a rigid-body mode (lambda set to
 * exactly 0), below minus that unstable, above flexible. Where n_rigid >= 0 is given (fixed for
 * a family of designs) exactly the n_rigid eigenvalues of smallest magnitude are rigid-body
 * modes; of the others those below -noise are unstable, and those in [-noise, 0) are flexible
 * with lambda = 0: a vibration of 0 Hz, as a spring lets go whose stiffness reaches 0. Where
 * stiffness holds some of the n_rigid, n_held says how many: the number given is wrong there.
 * Matrices alone cannot tell a rigid-body mode from one whose stiffness drowned in rounding:
 * that takes the terms of K (mt_modal_judge), and a mode that even they leave open, |lambda| at
 * most its error while springs do move, is undecided. No mode has an index beside an unstable
 * or an undecided one.
 */

#endif
