/* SPDX-License-Identifier: GPL-3.0-or-later */
/* glibc chooses its functions by the processor. Their variants agree in most last bits: a few
 * thousand arguments tell them apart. */
#include "linalg/arithmetic.h"

#include <math.h>
#include <string.h>

enum { ARGUMENTS = 1024, FUNCTIONS = 10 };

void mt_arithmetic_digest(char out[MT_ARITHMETIC_TEXT])
{
    double values[ARGUMENTS][FUNCTIONS];
    char digest[MT_SHA256_TEXT];
    for (int i = 0; i < ARGUMENTS; i++) {
        const double x = 0.1 + 0.0371 * i;
        const double all[FUNCTIONS] = {sin(x),        cos(x),        tan(x),      exp(-x),
                                       log(x),        pow(x, 1.7),   atan2(x, 3), hypot(x, 0.7),
                                       sinh(0.1 * x), tanh(0.01 * x)};
        memcpy(values[i], all, sizeof all);
    }
    mt_sha256((const char *)values, sizeof values, digest);
    memcpy(out, digest, MT_ARITHMETIC_TEXT - 1);
    out[MT_ARITHMETIC_TEXT - 1] = '\0';
}
