/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The phase of a sweep of duration T from f0 to f1:
 *     linear       f(t) = f0 + (f1 - f0) t/T,     phase = 2 pi (f0 t + (f1 - f0) t^2/(2 T))
 *     logarithmic  f(t) = f0 exp(r t), r = ln(f1/f0)/T,   phase = 2 pi f0 (exp(r t) - 1)/r.
 */
#include "simulate/signal.h"

#include <math.h>
#include <stdint.h>

static const double TWO_PI = 6.283185307179586477;

static void add_sine(const mt_sine *s, double t, double out[3])
{
    const double w = TWO_PI * s->hz;
    const double angle = (w * t) + s->phase;
    const double a = s->amplitude;
    out[0] += a * sin(angle);
    out[1] += a * w * cos(angle);
    out[2] -= a * w * w * sin(angle);
}

static void sweep(const mt_signal *s, double t, double out[3])
{
    double f = s->from_hz;
    double slope = 0.0; /* df/dt */
    double turns = 0.0; /* phase/(2 pi) */
    if (s->linear || s->from_hz == s->to_hz) {
        slope = (s->to_hz - s->from_hz) / s->duration_s;
        f += slope * t;
        turns = (s->from_hz * t) + (0.5 * slope * t * t);
    } else {
        const double r = log(s->to_hz / s->from_hz) / s->duration_s;
        f *= exp(r * t);
        slope = r * f;
        turns = s->from_hz * expm1(r * t) / r;
    }
    const double angle = TWO_PI * turns;
    const double w = TWO_PI * f;
    out[0] = s->level * sin(angle);
    out[1] = s->level * w * cos(angle);
    out[2] = s->level * ((TWO_PI * slope * cos(angle)) - (w * w * sin(angle)));
}

mt_status mt_signal_eval(const mt_signal *s, double t, double out[3], mt_err *err)
{
    out[0] = 0.0;
    out[1] = 0.0;
    out[2] = 0.0;
    switch (s->kind) {
    case MT_SIGNAL_SINES:
        for (int i = 0; i < s->n; i++) {
            add_sine(&s->sines[i], t, out);
        }
        return MT_OK;
    case MT_SIGNAL_SWEEP:
        sweep(s, t, out);
        return MT_OK;
    case MT_SIGNAL_EXPRESSION:
        MT_TRY(mt_program_second(s->program, t, s->work, err));
        for (int k = 0; k < 3; k++) {
            out[k] = s->work[s->node][k];
        }
        return MT_OK;
    }
    return MT_OK;
}

/* Uniform in [0, 1): splitmix64 (Steele, Lea, Flood, OOPSLA 2014). */
static double uniform(uint64_t *state)
{
    *state += UINT64_C(0x9e3779b97f4a7c15);
    uint64_t z = *state;
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

mt_status mt_signal_of_psd(const mt_psd *psd, int lines, unsigned long seed, mt_arena *mem,
                           mt_signal *out, mt_err *err)
{
    bool good = psd->n >= 2 && lines >= 1;
    for (int i = 0; i < psd->n && good; i++) {
        good = psd->level[i] > 0.0 && psd->hz[i] > (i == 0 ? 0.0 : psd->hz[i - 1]);
    }
    if (!good) {
        return mt_fail(err, MT_E_INPUT,
                       "a power spectral density needs two breakpoints or more, ascending in "
                       "frequency, with values above 0");
    }
    mt_sine *const sines = mt_arena_alloc(mem, (size_t)lines, sizeof *sines);
    MT_TRY(mt_arena_check(mem, err));
    const double df = (psd->hz[psd->n - 1] - psd->hz[0]) / lines;
    uint64_t state = seed;
    for (int i = 0; i < lines; i++) {
        const double from = psd->hz[0] + (df * i);
        const double to = i + 1 < lines ? from + df : psd->hz[psd->n - 1];
        sines[i] = (mt_sine){.amplitude = sqrt(2.0 * mt_psd_area(psd, from, to)),
                             .hz = from + (0.5 * df),
                             .phase = TWO_PI * uniform(&state)};
    }
    *out = (mt_signal){.kind = MT_SIGNAL_SINES, .n = lines, .sines = sines};
    return MT_OK;
}
