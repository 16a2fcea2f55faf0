/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "problem/goal.h"

#define OPS(id, name, ...) &mt_goal_##name,
static const mt_goal_ops *const OPERATIONS[] = {MT_GOAL_LIST(OPS)};

const mt_goal_ops *mt_goal_ops_of(mt_goal_type type)
{
    return OPERATIONS[type];
}
