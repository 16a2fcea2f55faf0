/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "simulate/realise.h"

#include <math.h>

enum { LINES_MOST = 100000 };
/* Values that the RMS of a realisation is taken from, and what these may cost (values times
 * lines): next to nothing beside the motion itself. */
enum { VALUES_LEAST = 1000 };
static const double VALUES_A_PERIOD = 4.0;
static const double WORK_MOST = 1e9;
/* The random parts of a profile have phases of their own. */
static const unsigned long NEXT_SEED = 0x9e3779b9UL;

mt_status mt_realise_psd(const mt_psd *psd, double duration_s, unsigned long seed,
                         mt_arena *mem, mt_signal *out, mt_err *err)
{
    const double lines = ceil((psd->hz[psd->n - 1] - psd->hz[0]) * duration_s) + 1.0;
    if (!(lines <= LINES_MOST)) {
        return mt_fail(err, MT_E_USAGE, "more than %d lines would be needed", (int)LINES_MOST);
    }
    const mt_status rc =
        mt_signal_of_psd(psd, lines > 1.0 ? (int)lines : 1, seed, mem, out, err);
    return rc == MT_E_INPUT ? mt_fail(err, MT_E_USAGE, "%s", err == NULL ? "" : err->text) : rc;
}

/* A tone stays at its frequency, or goes through its range once. */
static mt_signal tone_of(const mt_vibration_tone *tone, double duration_s, mt_sine *sine)
{
    *sine = (mt_sine){.amplitude = tone->level, .hz = tone->lower_hz};
    return tone->upper_hz > tone->lower_hz
               ? (mt_signal){.kind = MT_SIGNAL_SWEEP,
                             .level = tone->level,
                             .from_hz = tone->lower_hz,
                             .to_hz = tone->upper_hz,
                             .duration_s = duration_s}
               : (mt_signal){.kind = MT_SIGNAL_SINES, .n = 1, .sines = sine};
}

/* RMS of the random parts as they are in this realisation. */
static mt_status realised(const mt_vibration *v, const mt_signal *signals, double duration_s,
                          double *rms, mt_err *err)
{
    double hz = 0.0;
    double lines = 0.0;
    for (int i = 0; i < v->n_random; i++) {
        hz = fmax(hz, v->random[i].psd.hz[v->random[i].psd.n - 1]);
        lines += signals[i].n;
    }
    const double values =
        fmin(ceil(VALUES_A_PERIOD * hz * duration_s), ceil(WORK_MOST / fmax(lines, 1.0)));
    return mt_signal_rms(v->n_random, signals, duration_s,
                         values > VALUES_LEAST ? (int)values : VALUES_LEAST, rms, err);
}

mt_status mt_realise(const mt_vibration *v, double duration_s, unsigned long seed,
                     mt_arena *mem, mt_realised *out, mt_err *err)
{
    *out = (mt_realised){.n = v->n_random + v->n_tones};
    out->signals = mt_arena_alloc(mem, (size_t)out->n, sizeof *out->signals);
    mt_sine *const sines = mt_arena_alloc(mem, (size_t)v->n_tones, sizeof *sines);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < v->n_random; i++) {
        MT_TRY(mt_realise_psd(&v->random[i].psd, duration_s,
                              seed + (NEXT_SEED * (unsigned long)i), mem, &out->signals[i],
                              err));
    }
    for (int i = 0; i < v->n_tones; i++) {
        out->signals[v->n_random + i] = tone_of(&v->tones[i], duration_s, &sines[i]);
    }
    return realised(v, out->signals, duration_s, &out->rms, err);
}

void mt_realise_inputs(const mt_realised *r, int axis, mt_sim_input *inputs)
{
    for (int i = 0; i < r->n; i++) {
        inputs[i] = (mt_sim_input){.push = MT_SIM_BASE, .at = axis, .signal = &r->signals[i]};
    }
}
