/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_JSON_PRIV_H
#define IO_JSON_PRIV_H

#include <cjson/cJSON.h>

#include "io/json.h"
#include "io/scan.h"

/* cJSON holds names, values and who is whose child; beside it stands only what it has no room
 * for: the text, where in it each value stands, and the way from an address to the item (back
 * it is the item's valueint, which nobody else uses). */
struct mt_json {
    mt_arena mem;
    mt_diags diags;
    char *text; /* copy; a NUL stands behind it */
    size_t length;
    mt_json_spots spots;
    cJSON **items;     /* [spots.n]; NULL where the text is not JSON */
    cJSON *tree;       /* the whole, without what was passed over */
    cJSON *duplicates; /* a list of what was: members whose name the object has already */
};

#endif
