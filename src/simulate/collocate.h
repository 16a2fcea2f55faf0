/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_COLLOCATE_H
#define SIMULATE_COLLOCATE_H

#include "simulate/simulate_priv.h"

/*
 * One step of a stiff motion. Vibrations of the springs about the pose at the beginning of the
 * step are solved exactly; the remaining accelerations are a polynomial in time. Its smoothness
 * limits the step, not the fastest vibration.
 */

/* Make s->collocation where the springs at s->base make the motion stiff. Fails: MT_E_MEMORY,
 * MT_E_NO_CONVERGENCE (eigenvalues), MT_E_DOMAIN. */
mt_status mt_collocation_new(mt_sim *s, mt_err *err);
/* Update after a step to t, which has moved s->base. Collocation ends here where it is not
 * faster. */
void mt_collocation_accept(mt_sim *s, double t);
/* Advance s->begin by a step h from t into s->y, its error in s->error. s->stalls: the
 * iteration did not converge, the step is too long. Fails as mt_sim_slope. */
mt_status mt_collocate(mt_sim *s, double t, double h, mt_err *err);

#endif
