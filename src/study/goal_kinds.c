/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/goal_kinds.h"

#include <math.h>
#include <stddef.h>

#define MEMBER(slot, name, type, required, row, ...) \
    {MT_SLOT_##slot, name, required, MT_POSSIBLE_##row},
#define MEMBERS(id, ...) \
    static const mt_goal_member id##_MEMBERS[] = {MT_GOAL_##id##_MEMBERS(MEMBER)};
MT_GOAL_LIST(MEMBERS)

#define KIND(id, name, unit, measure, ...)                                                   \
    {#name, unit, MT_MEASURE_##measure, (int)(sizeof id##_MEMBERS / sizeof id##_MEMBERS[0]), \
     id##_MEMBERS},
static const mt_goal_kind KINDS[] = {MT_GOAL_LIST(KIND)};

const mt_goal_kind *mt_goal_kind_of(mt_goal_type type)
{
    return &KINDS[type];
}

int mt_goal_member_at(const mt_goal_kind *kind, mt_goal_slot slot)
{
    for (int i = 0; i < kind->n; i++) {
        if (kind->members[i].slot == slot) {
            return i;
        }
    }
    return -1;
}

const char *mt_goal_member_name(const mt_goal_kind *kind, mt_goal_slot slot)
{
    const int at = mt_goal_member_at(kind, slot);
    return at < 0 ? NULL : kind->members[at].name;
}

double mt_measure_unit(mt_goal_measure measure, double asked)
{
    return measure == MT_MEASURE_PART && fabs(asked) > 0.0 ? fabs(asked) : 1.0;
}

bool mt_goal_may_vary(const mt_goal_member *member)
{
    return member->slot <= MT_SLOT_AT_MOST || member->slot == MT_SLOT_MARGIN;
}
