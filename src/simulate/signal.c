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
    const double value = s->amplitude * sin(angle);
    out[0] += value;
    out[1] += s->amplitude * w * cos(angle);
    out[2] -= w * w * value;
}

/* e^(i w_k t) is multiplied from line to line, at a tenth of the cost of sine and cosine; it is
 * recomputed every so many lines, which removes the accumulated rounding. */
static void add_lines(const mt_signal *s, double t, double out[3])
{
    enum { FRESH = 64 };
    const double turn[2] = {cos(TWO_PI * s->step_hz * t), sin(TWO_PI * s->step_hz * t)};
    double re = 0.0;
    double im = 0.0;
    for (int k = 0; k < s->n; k++) {
        const double w = TWO_PI * (s->from_hz + (k * s->step_hz));
        if (k % FRESH == 0) {
            re = cos(w * t);
            im = sin(w * t);
        }
        const double value = (s->cosine[k] * im) + (s->sine[k] * re);
        out[0] += value;
        out[1] += w * ((s->cosine[k] * re) - (s->sine[k] * im));
        out[2] -= w * w * value;
        const double next = (re * turn[0]) - (im * turn[1]);
        im = (re * turn[1]) + (im * turn[0]);
        re = next;
    }
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
    case MT_SIGNAL_LINES:
        add_lines(s, t, out);
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
    const int last = psd->n - 1;
    bool good = psd->n >= 2 && lines >= 1 && psd->hz[0] < psd->hz[last];
    for (int i = 0; i < psd->n && good; i++) {
        good =
            psd->level[i] > 0.0 && psd->hz[i] > 0.0 && (i == 0 || psd->hz[i] >= psd->hz[i - 1]);
    }
    if (!good) {
        return mt_fail(err, MT_E_INPUT,
                       "a power spectral density needs two breakpoints or more, ascending in "
                       "frequency, with values above 0");
    }
    double *const cosine = mt_arena_f64(mem, (size_t)lines, 1);
    double *const sine = mt_arena_f64(mem, (size_t)lines, 1);
    MT_TRY(mt_arena_check(mem, err));
    const double df = (psd->hz[last] - psd->hz[0]) / lines;
    uint64_t state = seed;
    for (int i = 0; i < lines; i++) {
        const double from = psd->hz[0] + (df * i);
        const double to = i + 1 < lines ? from + df : psd->hz[last];
        const double amplitude = sqrt(2.0 * mt_psd_area(psd, from, to));
        const double phase = TWO_PI * uniform(&state);
        cosine[i] = amplitude * cos(phase);
        sine[i] = amplitude * sin(phase);
    }
    *out = (mt_signal){.kind = MT_SIGNAL_LINES,
                       .n = lines,
                       .cosine = cosine,
                       .sine = sine,
                       .from_hz = psd->hz[0] + (0.5 * df),
                       .step_hz = df};
    return MT_OK;
}

mt_status mt_signal_rms(int n, const mt_signal *signals, double duration_s, int samples,
                        double *rms, mt_err *err)
{
    double square = 0.0;
    for (int i = 0; i < samples; i++) {
        double sum = 0.0;
        for (int k = 0; k < n; k++) {
            double value[3];
            MT_TRY(mt_signal_eval(&signals[k], duration_s * (i + 0.5) / samples, value, err));
            sum += value[0];
        }
        square += sum * sum / samples;
    }
    *rms = sqrt(square);
    return MT_OK;
}

/* Realisations of profiles. */

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
