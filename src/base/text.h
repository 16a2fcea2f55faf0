/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_TEXT_H
#define BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/base.h"

/* Growing text (heap, owned by the holder). A failed growth sets `failed` and later writes do
 * nothing: check once at the end. */
typedef struct mt_text {
    char *s; /* NUL-terminated, NULL while empty */
    size_t length;
    size_t capacity;
    bool failed;
} mt_text;

void mt_text_free(mt_text *t);
/* Make room for n more bytes at once, where many additions are known to come. */
void mt_text_reserve(mt_text *t, size_t n);
void mt_text_add(mt_text *t, const char *s);
void mt_text_add_n(mt_text *t, const char *s, size_t n);
/* Formatted, see base/format.h. %s arguments are made visible, so a path is put together with
 * mt_text_add. */
void mt_text_addf(mt_text *t, const char *fmt, ...) MT_PRINTF(2, 3);

/* A path as a URI (RFC 3986): %XX for every byte that is neither unreserved nor a slash. */
void mt_text_add_uri(mt_text *t, const char *path);

/* Names longer than this (bytes) are compared for equality only. */
enum { MT_TEXT_DISTANCE_MAX = 255 };

/* Optimal string alignment distance in bytes (a swap of neighbours costs one), cut off at
 * `most` + 1. Heap: none. */
int mt_text_distance(const char *a, const char *b, int most);
/* The nearest of n names to `name` for a "did you mean": NULL where none is near (distance <= 1
 * + length / 4 and below the length, so that something of the name is left). The first of
 * several equally near. */
const char *mt_text_nearest(const char *name, const char *const *names, int n);
/* True where `name` matches `pattern`, in which * stands for any run of characters and ? for
 * one. (Bytes: names are ASCII.) */
bool mt_text_matches(const char *pattern, const char *name);
/* The last component of a path, "beam.json" of "studies/beam.json"; "" after a last slash; NULL
 * of NULL. */
const char *mt_text_base_name(const char *path);
/* Display width in terminal columns of UTF-8 text: marks that combine take none, ideographs
 * two. */
int mt_text_width(const char *s);

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
