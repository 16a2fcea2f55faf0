/* SPDX-License-Identifier: GPL-3.0-or-later */
/* glibc chooses its functions by the processor. Their variants agree in most last bits: a few
 * thousand arguments tell them apart. */
#include "linalg/arithmetic.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/format.h"

enum { ARGUMENTS = 1024, FUNCTIONS = 10 };

/* FNV-1a on words, with the high bits, which know all others, brought down. */
static uint64_t mixed(uint64_t hash, double value)
{
    uint64_t bits = 0;
    memcpy(&bits, &value, sizeof bits);
    hash = (hash ^ bits) * UINT64_C(0x9E3779B97F4A7C15);
    return hash ^ (hash >> 32U);
}

void mt_arithmetic_digest(char out[MT_ARITHMETIC_TEXT])
{
    uint64_t hash = 0;
    for (int i = 0; i < ARGUMENTS; i++) {
        const double x = 0.1 + 0.0371 * i;
        const double all[FUNCTIONS] = {sin(x),        cos(x),        tan(x),      exp(-x),
                                       log(x),        pow(x, 1.7),   atan2(x, 3), hypot(x, 0.7),
                                       sinh(0.1 * x), tanh(0.01 * x)};
        for (int k = 0; k < FUNCTIONS; k++) {
            hash = mixed(hash, all[k]);
        }
    }
    (void)mt_snprintf(out, MT_ARITHMETIC_TEXT, "%08lx%08lx", (unsigned long)(hash >> 32U),
                      (unsigned long)(hash & UINT64_C(0xFFFFFFFF)));
}
