/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ENVIRONMENT_PSD_H
#define ENVIRONMENT_PSD_H

/*
 * A one-sided power spectral density by its breakpoints: G(f) = G_i (f / f_i)^b between
 * breakpoints i and i + 1, a straight line in log-log scales of b 10 log10(2) dB per octave;
 * 0 below the first and above the last. Two breakpoints at one frequency are a step.
 */
typedef struct mt_psd {
    int n;         /* at least 2 */
    double *hz;    /* [n] above 0, ascending, at most two the same, the ends not */
    double *level; /* [n] above 0 [unit of the input^2/Hz] */
} mt_psd;

/* ln(b / a) of numbers above 0, exact to rounding next to 1. */
double mt_psd_log_ratio(double a, double b);
/* The exponent b of segment i, 0 <= i < n - 1; 0 of a step. */
double mt_psd_exponent(const mt_psd *psd, int i);
/* Slope of segment i [dB/octave]. */
double mt_psd_slope_db(const mt_psd *psd, int i);
/* G(f); the larger level at a step. */
double mt_psd_at(const mt_psd *psd, double hz);
/* Integral of (f / f_1)^(e - 1) df / f_1 from f_1 to f_2, l = ln(f_2 / f_1). */
double mt_psd_power_integral(double e, double l);
/* Integral of G df between two frequencies, in closed form [unit of the input^2]. */
double mt_psd_area(const mt_psd *psd, double from_hz, double to_hz);
/* Integral of G df over all frequencies [unit of the input^2]. */
double mt_psd_mean_square(const mt_psd *psd);

#endif
