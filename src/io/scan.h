/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_SCAN_H
#define IO_SCAN_H

#include "base/diag.h"

/*
 * The strict scanner of JSON texts: all that io/json.h refuses is refused here, but for names
 * given twice and numbers out of range, which takes values. It keeps what cJSON does not, where
 * each value stands, and nothing that cJSON does.
 */

/* A value, in document order: its index is its address. Or a mistake of syntax. */
typedef struct mt_json_spot {
    unsigned start; /* offset of its first byte */
    unsigned name;  /* of the quote that opens the name in front of it; 0: not a member */
    int parent;     /* the list or object that it is in; MT_NO_ADDR: none */
    bool mistake;
} mt_json_spot;

typedef struct mt_json_spots {
    mt_json_spot *items; /* in the arena of the diagnostics, which remembers a shortage */
    int n;
    int capacity;
    int most; /* in: values of a text, else it is refused */
} mt_json_spots;

/* All values of a text of length bytes, with a NUL behind them; its mistakes go to diags, with
 * their addresses. Of a text longer than MT_JSON_MAX_BYTES nothing is read. O(length). */
void mt_json_scan(const char *text, size_t length, mt_json_spots *out, mt_diags *diags);

#endif
