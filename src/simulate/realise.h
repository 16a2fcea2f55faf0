/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_REALISE_H
#define SIMULATE_REALISE_H

#include "environment/vibration.h"
#include "simulate/simulate.h"

/* One realisation of a profile of vibration as a motion of the ground: random parts first, then
 * tones, each of which stays at its frequency or sweeps its range once. */
typedef struct mt_realised {
    int n;
    mt_signal *signals; /* [n] accelerations [m/s^2] */
    double rms;         /* RMS of the random parts over the duration [m/s^2] */
} mt_realised;

/* Make a realisation, all in mem. Fails: as mt_realise_psd, MT_E_MEMORY. */
mt_status mt_realise(const mt_vibration *v, double duration_s, unsigned long seed,
                     mt_arena *mem, mt_realised *out, mt_err *err);
/* A realisation of a density whose period exceeds the duration. Fails: MT_E_USAGE (too many
 * lines are needed), as mt_signal_of_psd. */
mt_status mt_realise_psd(const mt_psd *psd, double duration_s, unsigned long seed,
                         mt_arena *mem, mt_signal *out, mt_err *err);
/* The signals as inputs that accelerate the ground along an axis: inputs[n]. */
void mt_realise_inputs(const mt_realised *r, int axis, mt_sim_input *inputs);

#endif
