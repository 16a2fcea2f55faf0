/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_WRITE_JSON_H
#define IO_WRITE_JSON_H

#include <stdbool.h>
#include <stddef.h>

#include "base/text.h"

/*
 * A streaming JSON writer: RFC 8259 text, two spaces per level, members in the order written,
 * no heap of its own. The same calls give the same bytes, in any locale.
 *
 *     mt_json_writer w = mt_json_writer_default(&text);
 *     mt_json_open(&w, NULL, '{');
 *     mt_json_put_number(&w, "frequency_hz", 18.0);
 *     mt_json_close(&w);
 *     if (!mt_json_done(&w)) ...
 *
 * `name` is the member's name inside an object and NULL inside an array or at the top. Misuse
 * (a name in an array, none in an object, a bracket left open, nesting beyond the limit) is a
 * bug of the caller: it is remembered, and mt_json_done returns false.
 */
enum { MT_JSON_WRITER_DEPTH = 32, MT_JSON_NUMBER_SIZE = 32 };

typedef struct mt_json_writer {
    mt_text *out; /* not owned */
    int depth;
    bool misused;
    bool tight;                       /* without any white space: for programs */
    char close[MT_JSON_WRITER_DEPTH]; /* the bracket that ends each open level */
    bool any[MT_JSON_WRITER_DEPTH];   /* something has been written on that level */
    bool flat[MT_JSON_WRITER_DEPTH];  /* on one line */
} mt_json_writer;

mt_json_writer mt_json_writer_default(mt_text *out);
/* Begin an object '{' or an array '['. */
void mt_json_open(mt_json_writer *w, const char *name, char bracket);
/* As mt_json_open, on one line: for short lists of numbers. Nested levels are on the same
 * line. */
void mt_json_open_flat(mt_json_writer *w, const char *name, char bracket);
void mt_json_close(mt_json_writer *w);
/* A number with 17 significant digits, so that reading it gives the same double; NaN and
 * infinities become null. */
void mt_json_put_number(mt_json_writer *w, const char *name, double value);
/* The same with `digits` significant digits, 1 to 17: for drawings. */
void mt_json_put_rounded(mt_json_writer *w, const char *name, double value, int digits);
void mt_json_put_integer(mt_json_writer *w, const char *name, long long value);
void mt_json_put_bool(mt_json_writer *w, const char *name, bool value);
/* Text, escaped; NULL becomes null. Bytes are taken as UTF-8; ill-formed ones become U+FFFD. */
void mt_json_put_string(mt_json_writer *w, const char *name, const char *value);
void mt_json_put_null(mt_json_writer *w, const char *name);
/* Add the final line feed, unless tight. True where all brackets are closed, nothing was
 * misused, and memory sufficed. */
bool mt_json_done(mt_json_writer *w);

/* The number as mt_json_put_number writes it; "null" where it is not finite. Returns buffer. */
const char *mt_json_format_number(double value, char buffer[MT_JSON_NUMBER_SIZE]);
/* The number with the fewest digits that read back as the same double: for people. */
const char *mt_json_format_shortest(double value, char buffer[MT_JSON_NUMBER_SIZE]);

#endif
