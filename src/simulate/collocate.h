/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_COLLOCATE_H
#define SIMULATE_COLLOCATE_H

#include "simulate/simulate_priv.h"

/*
 * One step of a stiff motion: vibrations of the springs about the pose where the step begins
 * are solved exactly, and what is left of the accelerations is a polynomial of time, so that a
 * step is as long as that is smooth, not as the fastest vibration is.
 */

/* s->collocation, where the springs at s->base make the motion stiff. Fails: MT_E_MEMORY,
 * MT_E_NO_CONVERGENCE (eigenvalues), MT_E_DOMAIN. */
mt_status mt_collocation_new(mt_sim *s, mt_err *err);
/* A step has been taken to t: s->base has moved. Where collocation does not pay it ends
 * here. */
void mt_collocation_accept(mt_sim *s, double t);
/* s->y := what s->begin becomes in a step h from t; s->error. s->stalls: the iteration does not
 * converge, the step is too long. Fails as mt_sim_slope. */
mt_status mt_collocate(mt_sim *s, double t, double h, mt_err *err);

#endif
