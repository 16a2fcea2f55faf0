/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A text that a test puts together at its end, in memory of its own. */
#ifndef MT_WRITER_H
#define MT_WRITER_H

#include <stddef.h>

typedef struct mt_writer {
    char *text; /* room bytes, NUL-terminated once something is written */
    size_t room;
    size_t used; /* without the terminator; 0 begins anew */
} mt_writer;

/* As printf, behind what is there. A text that does not fit ends the program: a test of one
 * that is cut would judge another than it says. */
void mt_write(mt_writer *w, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
