/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_SIGNAL_H
#define SIMULATE_SIGNAL_H

#include "environment/vibration.h"
#include "expr/program.h"

/* A function of time: a force, an acceleration of the ground or a motion of a drive. */
typedef enum mt_signal_kind {
    MT_SIGNAL_SINES,     /* sum of amplitude sin(2 pi hz t + phase) */
    MT_SIGNAL_LINES,     /* the same, with frequencies in equal steps */
    MT_SIGNAL_SWEEP,     /* level sin(phase(t)), frequency from f0 to f1 */
    MT_SIGNAL_EXPRESSION /* an expression in t */
} mt_signal_kind;

typedef struct mt_sine {
    double amplitude;
    double hz;
    double phase; /* [rad] */
} mt_sine;

typedef struct mt_signal {
    mt_signal_kind kind;
    bool linear;  /* SWEEP: constant rate in Hz per second; else in octaves */
    int n;        /* SINES, LINES */
    mt_node node; /* EXPRESSION: of the program */
    const mt_sine *sines;
    const double *cosine; /* LINES: [n] real part of amplitude e^(i phase) */
    const double *sine;   /* and its imaginary part */
    double step_hz;
    double level;   /* SWEEP */
    double from_hz; /* SWEEP: start; LINES: the first frequency */
    double to_hz;
    double duration_s;         /* SWEEP: duration from from_hz to to_hz */
    const mt_program *program; /* EXPRESSION: one input, t */
    double (*work)[3];         /* [program->count], for one worker */
} mt_signal;

/* out[3] = value and first two derivatives by time at t. Fails: MT_E_DOMAIN (of an
 * expression). */
mt_status mt_signal_eval(const mt_signal *s, double t, double out[3], mt_err *err);

/*
 * One realisation of a density: `lines` sines in the middle of equal parts df of the band,
 * amplitude sqrt(2 W df), W the mean of the PSD over the part, phases from the seed. Its period
 * is 1/df, and its mean square over a period is the area under the PSD. Fails: MT_E_INPUT
 * (breakpoints out of order, values not above 0), MT_E_MEMORY.
 */
mt_status mt_signal_of_psd(const mt_psd *psd, int lines, unsigned long seed, mt_arena *mem,
                           mt_signal *out, mt_err *err);
/* RMS of the sum of n signals over a duration, from `samples` values in the middle of equal
 * parts of it. Fails as mt_signal_eval. */
mt_status mt_signal_rms(int n, const mt_signal *signals, double duration_s, int samples,
                        double *rms, mt_err *err);

/* How a signal drives a motion. */
typedef enum mt_sim_push {
    MT_SIM_FORCE, /* at a sensor's channel, along its global axis [N, N m] */
    MT_SIM_BASE,  /* acceleration of the ground along an axis [m/s^2] */
    MT_SIM_MOVE   /* a locked driven joint's coordinate, from its held position [rad, m] */
} mt_sim_push;

typedef struct mt_sim_input {
    mt_sim_push push;
    int at;    /* FORCE: channel; BASE: axis 0..2; MOVE: of the system's drives */
    int slope; /* BASE: the signal is the acceleration (0), velocity (1) or position (2) */
    const mt_signal *signal;
} mt_sim_input;

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
