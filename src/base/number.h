/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_NUMBER_H
#define BASE_NUMBER_H

#include <stdbool.h>
#include <stddef.h>

/*
 * Rules for numbers that differ by rounding only, so that the result is the same on every
 * processor.
 */

/* Greatest relative difference of equal numbers: more than the tolerance of searches for a
 * design (about 1e-9) and its slopes, and no more than the last digit that is shown. */
#define MT_TIE 1e-6

/* True where a > b by more than MT_TIE of the larger size; false where one is NaN. To find the
 * first of the greatest numbers, keep the current one unless mt_exceeds(next, current). */
bool mt_exceeds(double a, double b);

/* A part of a number (a misfit, a change, a difference of logarithms) below this is due to the
 * tolerance of searches and rounding: a thousandth of the default tolerance of a goal. */
#define MT_RATIO_NOISE   1e-9
#define MT_PERCENT_NOISE 1e-7
/* Greatest relative change per 1 % that rounding alone gives for a slope that is 0. */
#define MT_SLOPE_NOISE 1e-12

/* x, or 0 where |x| is below the noise. */
double mt_without_noise(double x, double noise);

/* The double nearest to x rounded to 15 significant digits, which every double keeps (IEEE
 * 754-2019, 5.12.2); NaN where x is not finite, or far too large or small. */
double mt_few_digits(double x);

enum { MT_DECIMAL_DIGITS = 17, MT_DECIMAL_TEXT = 32 };

/* Writes x as "%.*g" of the C library does, with a decimal point in every locale; returns the
 * length. Returns 0 where digits is not in 1 to MT_DECIMAL_DIGITS, where 0 < |x| < 1e-4, or
 * where the text has an exponent. */
size_t mt_decimal(double x, int digits, char out[MT_DECIMAL_TEXT]);

#endif
