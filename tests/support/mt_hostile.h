/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What tests of hostile files share: where values stand in a text, and what a refusal must look
 * like. */
#ifndef MT_HOSTILE_H
#define MT_HOSTILE_H

#include <stdbool.h>
#include <stddef.h>

/* A value, with the member name in front of it where it has one (else name_begin == begin).
 * Offsets in bytes, ends one past the last. */
typedef struct mt_hostile_node {
    size_t name_begin;
    size_t name_end;
    size_t begin;
    size_t end;
} mt_hostile_node;

/* The values of a JSON text in the order in which they begin, at most `most`; their number. A
 * scan that knows only brackets, quotes and commas: it works on broken texts, too, and shares
 * nothing with the parser under test. */
int mt_hostile_nodes(const char *s, size_t n, int most, mt_hostile_node *nodes);

/* Lines of visible text? */
bool mt_hostile_visible(const char *said, size_t length);
/* Is this what is said of a refused file: visible lines ": error: " or ": warning: ", one error
 * at least, each error with a line and a column in front? */
bool mt_hostile_diagnosed(const char *said, size_t length);

#endif
