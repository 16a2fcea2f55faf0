/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_DIGITS_H
#define BASE_DIGITS_H

/* The double nearest to x rounded to 15 significant digits, which every double keeps (IEEE
 * 754-2019, 5.12.2); NaN where x is not finite, or far too large or small. */
double mt_few_digits(double x);

#endif
