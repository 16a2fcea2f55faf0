/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_DECIMAL_H
#define BASE_DECIMAL_H

#include <stddef.h>

enum { MT_DECIMAL_DIGITS = 17, MT_DECIMAL_TEXT = 32 };

/* What the C library's "%.*g" writes of x, with a point in every locale: its length. 0: digits
 * are not 1 to MT_DECIMAL_DIGITS, |x| is below 1e-4 and not 0, or the text has an exponent. */
size_t mt_decimal(double x, int digits, char out[MT_DECIMAL_TEXT]);

#endif
