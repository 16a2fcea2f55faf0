/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mt_writer.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

void mt_write(mt_writer *w, const char *format, ...)
{
    const size_t left = w->room - w->used;
    va_list args;
    va_start(args, format);
    const int n = vsnprintf(w->text + w->used, left, format, args);
    va_end(args);
    if (n < 0 || (size_t)n >= left) {
        (void)fprintf(stderr, "a text of a test is longer than its %zu bytes\n", w->room);
        abort();
    }
    w->used += (size_t)n;
}
