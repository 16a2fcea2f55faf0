/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_FORMAT_H
#define BASE_FORMAT_H

#include <stdarg.h>
#include <stddef.h>

#include "base/base.h"

/*
 * The one door of formatted text: messages of errors, sentences, tables and pages are all made
 * here, so that nobody who writes one can forget that
 *   - a number may be not finite: it is a word then, "undefined" for NaN, "infinite",
 *     "-infinite"; -0 is 0, and a decimal point is one in every locale;
 *   - an argument %s (or %c) may come from outside: it is made visible, see base/visible.h;
 *   - a text that is cut, by size or by %.20s, ends before a UTF-8 character, not in it.
 * Else as vsnprintf with these conversions: d i u x X c s e f g and %%, lengths l, ll and z,
 * flags + - 0 #, width and precision (also *). What a system call is given (a path) is not text
 * for people: put it together with mt_text_add.
 */

/* Into out[size] (NULL with 0: measure only). Returns the length of the whole text, below 0
 * where fmt asks for something else. */
int mt_vsnprintf(char *out, size_t size, const char *fmt, va_list args) MT_PRINTF(3, 0);
int mt_snprintf(char *out, size_t size, const char *fmt, ...) MT_PRINTF(3, 4);

#endif
