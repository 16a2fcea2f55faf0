/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers: which are equal but for rounding, and their decimal digits. */
#include "base/number.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Ties. */

bool mt_exceeds(double a, double b)
{
    const double size = fmax(fabs(a), fabs(b));
    return a > b && (isinf(size) || a - b > MT_TIE * size);
}

double mt_without_noise(double x, double noise)
{
    return fabs(x) < noise ? 0.0 : x;
}

/*
 * An integer n below 1e15 over (or times) a power of ten, which as p + e of two doubles is
 * exact up to 1e44; the quotient is corrected by its remainder.
 */

double mt_few_digits(double x)
{
    enum { DIGITS = 15, EXACT = 22, SUM = 44 };
    const int k = x == 0.0 ? 0 : DIGITS - 1 - (int)floor(log10(fabs(x)));
    double scale = 1.0;
    double more = 1.0;
    if (k > SUM || k < -EXACT) {
        return nan("");
    }
    for (int i = 0; i < abs(k); i++) {
        *(i < EXACT ? &scale : &more) *= 10.0;
    }
    if (k < 0) {
        return round(x / scale) * scale;
    }
    const double p = scale * more;
    const double n = round(x * p);
    const double q = n / p;
    return q + (fma(-q, p, n) - q * fma(scale, more, -p)) / p;
}

/*
 * |x| = m 2^e with a whole m < 2^53. Let 10^k <= |x| < 10^(k+1) and p digits be asked for: the
 * text has the digits of N, which is |x| 10^s, s = p - 1 - k, rounded to a whole number, ties
 * to even. No exponent is written where -4 <= k < p <= 17: there 0 <= s <= 20, -66 <= e <= 4,
 * and m 10^s < 2^53 2^66.5 and its shift by e are numbers of 128 bits. Nothing is lost, and the
 * text is the C library's, which takes numbers of any length and ten times as long for it.
 */

__extension__ typedef unsigned __int128 wide;

enum { POWERS = 18 };

static const uint64_t power[POWERS] = {1U,
                                       10U,
                                       100U,
                                       1000U,
                                       10000U,
                                       100000U,
                                       1000000U,
                                       10000000U,
                                       100000000U,
                                       1000000000U,
                                       10000000000U,
                                       100000000000U,
                                       1000000000000U,
                                       10000000000000U,
                                       100000000000000U,
                                       1000000000000000U,
                                       10000000000000000U,
                                       100000000000000000U};

/* m 2^e 10^s to the nearest whole number, ties to even. */
static uint64_t scaled(uint64_t m, int e, int s)
{
    const int first = s < POWERS ? s : POWERS - 1;
    const wide product = (wide)m * power[first] * power[s - first];
    if (e >= 0) {
        return (uint64_t)(product << e);
    }
    const wide unit = (wide)1 << -e;
    const wide twice = 2 * (product & (unit - 1));
    const uint64_t whole = (uint64_t)(product >> -e);
    return whole + (twice > unit || (twice == unit && (whole & 1U) != 0) ? 1U : 0U);
}

/* Write the p digits of n, the first of which is at 10^k, without trailing zeros. */
static size_t lay_out(uint64_t n, int p, int k, char *out)
{
    char digits[MT_DECIMAL_DIGITS] = "";
    for (int i = p - 1; i >= 0; i--) {
        digits[i] = (char)('0' + (int)(n % 10U));
        n /= 10U;
    }
    while (p > 1 && digits[p - 1] == '0') {
        p--;
    }
    if (k < 0) {
        const size_t zeros = (size_t)(1 - k); /* with the point */
        memcpy(out, "0.000", zeros);
        memcpy(out + zeros, digits, (size_t)p);
        return zeros + (size_t)p;
    }
    size_t at = 0;
    for (int i = 0; i < p || i <= k; i++) {
        if (i == k + 1) {
            out[at++] = '.';
        }
        out[at++] = '0';
        if (i < p) {
            out[at - 1] = digits[i];
        }
    }
    return at;
}

size_t mt_decimal(double x, int digits, char out[MT_DECIMAL_TEXT])
{
    static const double LEAST = 1e-4; /* below, an exponent is written */
    const double size = fabs(x);
    const size_t sign = signbit(x) ? 1 : 0;
    int e = 0;
    if (digits < 1 || digits > MT_DECIMAL_DIGITS ||
        !(x == 0.0 || (size >= LEAST && size < (double)power[digits]))) {
        return 0;
    }
    const uint64_t m = (uint64_t)ldexp(frexp(size, &e), DBL_MANT_DIG);
    e -= DBL_MANT_DIG;
    out[0] = '-';
    size_t length = 1;
    out[sign] = '0';
    if (m > 0) {
        /* the exponent of the power of two below: k, or one less than it */
        int k = (int)floor(0.30102999566398120 * (e + DBL_MANT_DIG - 1));
        uint64_t n = scaled(m, e, digits - 1 - k);
        if (n >= power[digits]) { /* one less; or rounded up to a power of ten */
            k++;
            n = k < digits ? scaled(m, e, digits - 1 - k) : 0;
        }
        if (k < -4 || k >= digits) {
            return 0;
        }
        length = lay_out(n, digits, k, out + sign);
    }
    out[sign + length] = '\0';
    return sign + length;
}
