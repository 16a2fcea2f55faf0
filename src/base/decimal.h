/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_DECIMAL_H
#define BASE_DECIMAL_H

#include <stddef.h>

enum { MT_DECIMAL_DIGITS = 17, MT_DECIMAL_TEXT = 32 };

/* Writes x as "%.*g" of the C library does, with a decimal point in every locale; returns the
 * length. Returns 0 where digits is not in 1 to MT_DECIMAL_DIGITS, where 0 < |x| < 1e-4, or
 * where the text has an exponent. */
size_t mt_decimal(double x, int digits, char out[MT_DECIMAL_TEXT]);

#endif
