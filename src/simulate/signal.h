/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_SIGNAL_H
#define SIMULATE_SIGNAL_H

#include "expr/second.h"
#include "study/psd.h"

/* A function of time that pushes, shakes or moves a mechanism. */
typedef enum mt_signal_kind {
    MT_SIGNAL_SINES,     /* sum of amplitude sin(2 pi hz t + phase) */
    MT_SIGNAL_LINES,     /* the same, at frequencies in equal steps */
    MT_SIGNAL_SWEEP,     /* level sin(phase(t)), the frequency running from f0 to f1 */
    MT_SIGNAL_EXPRESSION /* of t */
} mt_signal_kind;

typedef struct mt_sine {
    double amplitude;
    double hz;
    double phase; /* [rad] */
} mt_sine;

typedef struct mt_signal {
    mt_signal_kind kind;
    bool linear;  /* SWEEP: so many Hz a second; else so many octaves */
    int n;        /* SINES, LINES */
    mt_node node; /* EXPRESSION: of the program */
    const mt_sine *sines;
    const double *cosine; /* LINES: [n] of amplitude e^(i phase), the real part */
    const double *sine;   /* and the imaginary one */
    double step_hz;
    double level;   /* SWEEP */
    double from_hz; /* SWEEP; LINES: the first */
    double to_hz;
    double duration_s;         /* in which it runs from one to the other */
    const mt_program *program; /* EXPRESSION: one input, t */
    double (*work)[3];         /* [program->count], of one worker */
} mt_signal;

/* out[3] = value and first two derivatives by time at t. Fails: MT_E_DOMAIN (of an
 * expression). */
mt_status mt_signal_eval(const mt_signal *s, double t, double out[3], mt_err *err);

/*
 * One realisation of a density: `lines` sines in the middle of equal parts df of the band,
 * amplitude sqrt(2 W df), W the mean of the PSD there, phases from the seed. It repeats after
 * 1/df, and its mean square over that time is the area under the PSD. Fails: MT_E_INPUT
 * (breakpoints out of order, values not above 0), MT_E_MEMORY.
 */
mt_status mt_signal_of_psd(const mt_psd *psd, int lines, unsigned long seed, mt_arena *mem,
                           mt_signal *out, mt_err *err);
/* RMS over a duration of n signals together, from `samples` values in the middle of equal
 * parts of it. Fails as mt_signal_eval. */
mt_status mt_signal_rms(int n, const mt_signal *signals, double duration_s, int samples,
                        double *rms, mt_err *err);

#endif
