/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_SCAN_H
#define IO_SCAN_H

#include "base/diagnostics.h"

/*
 * The strict scanner of JSON texts. It refuses all that io/json.h refuses except names given
 * twice and numbers out of range, whose detection needs values. It records only what cJSON does
 * not: the place of each value.
 */

/* A value, in document order (its index is its address), or a syntax error. */
typedef struct mt_json_spot {
    unsigned start; /* offset of its first byte */
    unsigned name;  /* offset of the quote that opens its name; 0: not a member */
    int parent;     /* its list or object; MT_NO_ADDR: none */
    bool mistake;
} mt_json_spot;

typedef struct mt_json_spots {
    mt_json_spot *items; /* in the arena of the diagnostics, which remembers a shortage */
    int n;
    int capacity;
    int most; /* [in] largest number of values; a text with more is refused */
} mt_json_spots;

/* Scan all values of a text of length bytes followed by a NUL; syntax errors go to diags with
 * their addresses. A text longer than MT_JSON_MAX_BYTES is not read. O(length). */
void mt_json_scan(const char *text, size_t length, mt_json_spots *out, mt_diags *diags);

#endif
