/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_VISIBLE_H
#define BASE_VISIBLE_H

#include "base/text.h"

/*
 * Escapes for text from outside (names, titles, paths, arguments), which may hold control
 * characters (C0, DEL, C1), marks that change the direction of writing, zero-width characters,
 * line and paragraph separators, tags, and bytes that are not UTF-8. They are shown as JSON
 * escapes, \u001b, beyond U+FFFF as a pair of surrogates, a byte that is not UTF-8 as \x9b. A
 * JSON text, where such characters occur in strings only, keeps its meaning.
 */
enum { MT_VISIBLE_SIZE = 16 };

/* Length in bytes of the well-formed UTF-8 character at the start of the n bytes at s (Unicode
 * 15, table 3-7); 0: not well formed. */
size_t mt_utf8_length(const char *s, size_t n);
/* Code point of the well-formed character of `length` bytes. */
unsigned mt_utf8_code(const char *s, size_t length);
/* Number of leading bytes of s that can be shown unchanged. `lines`: tabs, line feeds, and
 * carriage returns before a line feed can. */
size_t mt_visible_run(const char *s, size_t n, bool lines);
/* Escape the first character or byte of the n > 0 bytes at s into out; returns the number of
 * bytes of s consumed. */
size_t mt_visible_escape(const char *s, size_t n, char out[MT_VISIBLE_SIZE]);
/* Append s with the escapes above. */
void mt_text_add_visible(mt_text *t, const char *s);

#endif
