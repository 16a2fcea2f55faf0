/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_JSON_PRIV_H
#define IO_JSON_PRIV_H

#include <cjson/cJSON.h>

#include "io/json.h"
#include "io/scan.h"

/* cJSON holds names, values and the tree. This struct adds the text, the place of each value in
 * it, and the map from addresses to items (the map back is the item's valueint, otherwise
 * unused). */
struct mt_json {
    mt_arena mem;
    mt_diags diags;
    char *text; /* copy, followed by a NUL */
    size_t length;
    mt_json_spots spots;
    cJSON **items;     /* [spots.n]; NULL where the text is not JSON */
    cJSON *tree;       /* the whole document without duplicates */
    cJSON *duplicates; /* members left out, as the object has their name already */
};

#endif
