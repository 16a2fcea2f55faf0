/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/objective_kinds.h"

#define KIND(id, name, unit, properties) {#name, unit, properties},
static const mt_objective_kind KINDS[] = {MT_OBJECTIVE_LIST(KIND)};

const mt_objective_kind *mt_objective_kind_of(mt_objective_type type)
{
    return &KINDS[type];
}

bool mt_objective_is(mt_objective_type type, unsigned properties)
{
    return (KINDS[type].properties & properties) == properties;
}

int mt_objectives_with(unsigned properties, mt_objective_type *types, const char **names)
{
    int n = 0;
    for (int i = 0; i < MT_OBJECTIVE_TYPE_COUNT; i++) {
        if (mt_objective_is((mt_objective_type)i, properties)) {
            types[n] = (mt_objective_type)i;
            names[n++] = KINDS[i].name;
        }
    }
    return n;
}
