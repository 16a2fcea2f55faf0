/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_SLOPES_FORMS_H
#define RESPONSE_SLOPES_FORMS_H

#include "response/slopes.h"

/*
 * The derivatives of one response at many frequencies, each by itself. With x' = (x, 1) and y'
 * = (y, 1) of the solutions x and y,
 *     dH/dp = y'^T (T_0p + i T_1p + s T_2p + s^2 T_3p) x',
 * where the T are real and independent of the frequency: they are computed once.
 */
typedef struct mt_slope_forms {
    const mt_slope_problem *p;
    mt_solutions of;
    int out;
    int in;
    /* fewer frequencies than degrees of freedom: no T; mt_response_slopes is used instead */
    bool single;
    int used;   /* entries of T that are nonzero for some p */
    int *entry; /* [used] position: part + 4 (row + column (n + 1)) */
    double *t;  /* n_inputs x used */
    bool *none; /* [n_inputs] no derivative exists (slopes.h) */
} mt_slope_forms;

/* Prepare for `frequencies` frequencies. Results in mem; refers to p, whose basis has all
 * modes. O(n_inputs (n^2 nq + n entries of the terms)). Fails as mt_response_slopes. */
mt_status mt_slope_forms_make(const mt_slope_problem *p, int out, int in, int frequencies,
                              mt_arena *mem, mt_slope_forms *f, mt_err *err);
/**
 * Response and derivatives at w[count] > 0 [rad/s], in O(n^2 n_inputs) for each (n^3 where
 * damping couples modes).
 * @param[out] h   [count] the response; infinite where it has no value
 * @param[out] dh  n_inputs x count; NaN as mt_response_slopes
 * Fails: as mt_response_slopes, MT_E_INTERRUPTED.
 */
mt_status mt_slope_forms_at(const mt_slope_forms *f, int count, const double *w,
                            double complex *h, double complex *dh, mt_arena *scratch,
                            mt_err *err);

#endif
