/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/number.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/format.h"

/* "2.10000e+11" says no more than "2.1e+11", and "100000." no more than "100000". */
static void trim(char *s)
{
    char *const exponent = strchr(s, 'e');
    char *end = exponent == NULL ? s + strlen(s) : exponent;
    const char *const from = end;
    while (exponent != NULL && end > s && end[-1] == '0') {
        end--;
    }
    if (end > s && end[-1] == '.') {
        end--;
    }
    memmove(end, from, strlen(from) + 1);
}

static const char *format(double x, int digits, bool sign, char *buffer)
{
    if (isnan(x)) {
        (void)mt_snprintf(buffer, MT_NUMBER_TEXT, "-");
    } else if (x == 0.0 || isinf(x)) {
        (void)mt_snprintf(buffer, MT_NUMBER_TEXT, "%g", x); /* 0, or the word */
    } else {
        (void)mt_snprintf(buffer, MT_NUMBER_TEXT, sign ? "%+#.*g" : "%#.*g", digits, x);
        trim(buffer);
    }
    return buffer;
}

const char *mt_report_number(double x, int digits, char buffer[MT_NUMBER_TEXT])
{
    return format(x, digits, false, buffer);
}

const char *mt_report_change(double x, int digits, char buffer[MT_NUMBER_TEXT])
{
    return format(x, digits, true, buffer);
}

const char *mt_report_exact(double x, char buffer[MT_NUMBER_TEXT])
{
    if (isfinite(x)) {
        (void)mt_snprintf(buffer, MT_NUMBER_TEXT, "%.17g", x);
    } else {
        buffer[0] = '\0';
    }
    return buffer;
}
