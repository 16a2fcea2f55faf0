/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_FREE_SPIN_H
#define MECHANICS_FREE_SPIN_H

#include "mechanics/linear.h"

/* Take the idle spins out of the basis of the freedoms (lin->e.z, its errors, lin->n) and note
 * how many there are and whose (lin->n_free_spins, lin->idle, lin->free_spin_varies). In space,
 * after the rows are evaluated and the basis is chosen, before they are reduced. Costs nothing
 * where every body has inertia about all axes. Fails: MT_E_MEMORY, MT_E_NO_CONVERGENCE. */
mt_status mt_free_spin_remove(mt_linear *lin, mt_err *err);

#endif
