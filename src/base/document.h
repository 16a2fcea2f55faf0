/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_DOCUMENT_H
#define BASE_DOCUMENT_H

#include "base/diagnostics.h"

/* What the records of all documents (models, studies, profiles, measurements) are made of. */

/* MT_ABSENT: an index of nothing. MT_MAX_LIST: greatest length of a list of modes. */
enum { MT_ABSENT = -1, MT_MAX_LIST = 100000 };

/* True where a number is given; NaN (nan("")) stands for "not given". */
#define MT_HAS(x) ((x) == (x))

/* A name in the file: text and location. s == NULL: absent. */
typedef struct mt_name {
    const char *s;
    mt_addr addr;
} mt_name;

typedef struct mt_name_list {
    int count;
    mt_name *items;
} mt_name_list;

/* The origin of a number. */
typedef enum mt_origin {
    MT_ORIGIN_NONE,
    MT_ORIGIN_PUBLISHED,
    MT_ORIGIN_IDENTIFIED,
    MT_ORIGIN_ASSUMED
} mt_origin;

/* The members of a list that grows (mt_arena_grow). */
#define MT_LIST_OF(type, name) \
    type *name;                \
    int n_##name;              \
    int cap_##name

#endif
