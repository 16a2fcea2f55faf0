/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_JSON_PRIV_H
#define IO_JSON_PRIV_H

#include <cjson/cJSON.h>

#include "io/json.h"

/* One value, in document order: the first child of a list or object is the next node, its
 * siblings follow `next`. A node of type 0 is no value but the place of a syntax error. */
typedef struct mt_json_node {
    unsigned start; /* offset of its first byte */
    unsigned end;   /* one past its last byte; numbers only */
    unsigned name;  /* offset of the quote that opens the member name; 0: not a member */
    int parent;     /* MT_NO_ADDR for the root */
    int next;
    int children;
    int type;       /* mt_json_type, 0 */
    bool duplicate; /* a member whose name the object has already: passed over */
    cJSON *item;
} mt_json_node;

struct mt_json {
    mt_arena mem;
    mt_diags diags;
    char *text; /* copy; a NUL stands behind it */
    size_t length;
    mt_json_node *nodes;
    int count;
    int capacity;
    cJSON *tree;
};

/* Validate doc->text and fill doc->nodes. Fails: MT_E_INPUT (problems are in doc->diags),
 * MT_E_MEMORY. */
mt_status mt_json_scan(mt_json *doc, mt_err *err);

#endif
