/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_NAMES_H
#define MODEL_NAMES_H

#include "base/sorted.h"
#include "model/model.h"

typedef struct mt_named {
    const char *name; /* not copied */
    int value;
} mt_named;

/* Names to values. */
typedef struct mt_names {
    mt_named *items; /* [count] */
    int count;
    int room;
    mt_sorted order; /* of the names */
} mt_names;

/* One table per name space. Bodies and links share one: both may be given as a body. */
typedef struct mt_model_names {
    mt_names parameters;
    mt_names points;
    mt_names bodies; /* body i: i; link i: -1 - i */
    mt_names joints;
    mt_names springs;
    mt_names loads;
    mt_names sensors;
    mt_names modes;
    mt_names configurations;
} mt_model_names;

/* Add a name. *taken: it exists already and is unchanged. */
void mt_names_add(mt_names *t, mt_arena *mem, const char *name, int value, bool *taken);
/* Value of a name of `length` bytes; *found: it exists. */
int mt_names_find(const mt_names *t, const char *name, size_t length, bool *found);

/* Make the table of parameters before the others, so that mt_model_lookup is fast while
 * expressions are read. Duplicates are left to mt_model_resolve. */
void mt_model_index_parameters(mt_model *model);
/* The same for points, for reading positions. */
void mt_model_index_points(mt_model *model);

#endif
