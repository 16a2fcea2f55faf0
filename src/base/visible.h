/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_VISIBLE_H
#define BASE_VISIBLE_H

#include "base/text.h"

/*
 * Text from outside (names, titles, paths, arguments) may hold what a terminal obeys or a
 * reader cannot see: control characters (C0, DEL, C1), marks that turn the direction of
 * writing, zero-width characters, line and paragraph separators, tags, bytes that are no UTF-8.
 * Shown they are as JSON writes them, \u001b, beyond U+FFFF as a pair of surrogates, a byte
 * that is no UTF-8 as \x9b. Within a JSON text, where such characters stand in strings only,
 * its meaning stays what it was.
 */
enum { MT_VISIBLE_SIZE = 16 };

/* Bytes of the well-formed UTF-8 character that the n bytes at s begin with (Unicode 15, table
 * 3-7); 0: there is none. */
size_t mt_utf8_length(const char *s, size_t n);
/* The code point of the well-formed character of so many bytes. */
unsigned mt_utf8_code(const char *s, size_t length);
/* How many of the n bytes at s, from the first on, can be shown as they are. `lines`: so can
 * tabs, line feeds, and carriage returns before a line feed. */
size_t mt_visible_run(const char *s, size_t n, bool lines);
/* What the n > 0 bytes at s begin with, escaped, into out; returns how many bytes of s that
 * was. */
size_t mt_visible_escape(const char *s, size_t n, char out[MT_VISIBLE_SIZE]);
/* Append s with all of that escaped. */
void mt_text_add_visible(mt_text *t, const char *s);

#endif
