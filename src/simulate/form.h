/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_FORM_H
#define SIMULATE_FORM_H

#include "simulate/signal.h"

/*
 * A function of time as a polynomial and sines,
 *     u(t) = sum_k c_k t^k + sum_i (a_i cos w_i t + b_i sin w_i t),
 * a solution of a linear equation u^(m) = ... without input: such inputs are states of a linear
 * system of their own. Steps, ramps and samples joined by lines have this form piece by piece.
 */
enum { MT_FORM_DEGREE = 8, MT_FORM_WAVES = 24 };

typedef struct mt_wave {
    double w; /* > 0 [rad/s] */
    double cosine;
    double sine;
} mt_wave;

typedef struct mt_form {
    int degree; /* of the polynomial; -1: none */
    double c[MT_FORM_DEGREE + 1];
    int n;
    mt_wave wave[MT_FORM_WAVES];
} mt_form;

/**
 * The derivative of order `slope` of the signal just after t, as a form.
 * @param[out] until the form holds up to there (infinite: for all times)
 * @return false where it has no known form: a varying frequency, exp(t), a kink at a place
 *         without a closed form
 * Kinks are places where an argument of abs, min or max changes sign. mem remembers a shortage.
 */
bool mt_form_of_signal(const mt_signal *s, int slope, double t, mt_arena *mem, mt_form *out,
                       double *until);
/* out[k] = derivative of order k at t, k < count. */
void mt_form_derivatives(const mt_form *f, double t, int count, double *out);
/* Value and derivative of one wave at t. */
void mt_wave_eval(const mt_wave *w, double t, double out[2]);

#endif
