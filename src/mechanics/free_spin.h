/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_FREE_SPIN_H
#define MECHANICS_FREE_SPIN_H

#include "mechanics/linear.h"

/* Remove spins of bodies that no inertia, stiffness or joint resists from the basis of the
 * freedoms (lin->e.z, its errors, lin->n) and record them (lin->n_free_spins, lin->free_spins,
 * lin->free_spin_varies). In space, after the rows are evaluated and the basis is chosen,
 * before they are reduced. Costs nothing where every body has inertia about all axes. Fails:
 * MT_E_MEMORY, MT_E_NO_CONVERGENCE. */
mt_status mt_free_spin_remove(mt_linear *lin, mt_err *err);

#endif
