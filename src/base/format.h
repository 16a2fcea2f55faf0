/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_FORMAT_H
#define BASE_FORMAT_H

#include <stdarg.h>
#include <stddef.h>

#include "base/base.h"

/*
 * All formatted text (errors, sentences, tables, pages) is made here, because
 *   - a number that is not finite is written as a word, "undefined" for NaN, "infinite",
 *     "-infinite"; -0 is written as 0, and the decimal point is a point in every locale;
 *   - an argument of %s (or %c) may come from outside and is made visible, see base/text.h;
 *   - a text that is cut, by size or by %.20s, ends before a UTF-8 character, not inside it.
 * Otherwise as vsnprintf with the conversions d i u x X c s e f g and %%, lengths l, ll and z,
 * flags + - 0 #, width and precision (also *). Arguments of system calls (paths) must not be
 * changed: put them together with mt_text_add.
 */

/* Into out[size] (NULL with 0: measure only). Returns the length of the whole text, below 0
 * where fmt has another conversion. */
int mt_vsnprintf(char *out, size_t size, const char *fmt, va_list args) MT_PRINTF(3, 0);
int mt_snprintf(char *out, size_t size, const char *fmt, ...) MT_PRINTF(3, 4);

#endif
