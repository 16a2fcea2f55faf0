/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_TIE_H
#define BASE_TIE_H

#include <stdbool.h>

/*
 * Numbers that rounding alone tells apart, and what is nothing but rounding: decided by a rule,
 * so that the answer is the same on every processor.
 */

/* Of equal numbers the relative difference, at most: above what searches leave open of a design
 * (about 1e-9) and of its slopes, and no more than the last digit of those that are shown. */
#define MT_TIE 1e-6

/* a > b by more than MT_TIE of the larger size; false where one is NaN. Whoever looks for the
 * greatest, and means the first of equal ones, keeps the one so far unless
 * mt_exceeds(next, so_far). */
bool mt_exceeds(double a, double b);

/* Below this a part of a number (a misfit, a change, a difference of logarithms) is what
 * searches and rounding leave open: a thousandth of the tolerance of a goal by default. */
#define MT_RATIO_NOISE   1e-9
#define MT_PERCENT_NOISE 1e-7
/* What rounding alone makes of a slope that is 0, as part of the number, for 1 % more. */
#define MT_SLOPE_NOISE 1e-12

/* x, or 0 where it is smaller than the noise. */
double mt_without_noise(double x, double noise);

#endif
