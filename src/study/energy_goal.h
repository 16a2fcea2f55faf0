/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_ENERGY_GOAL_H
#define STUDY_ENERGY_GOAL_H

#include "io/members.h"
#include "mechanics/energy_share.h"

/* Whose share of a mode's energy a goal limits: the kinetic energy of a body or link, or the
 * strain energy of a spring or link. */
typedef struct mt_energy_goal {
    mt_name body_name;
    mt_name spring_name; /* s NULL: kinetic energy */
    mt_name_list direction_names;
    int n_directions; /* one requirement each; 0: a single one, of the whole */
    int *directions;  /* [n_directions] */
    int component;    /* of a bushing; MT_ABSENT: of all */
    mt_name point_name;
    mt_energy_about about;
    bool most; /* of the mode that has most of it, instead of one by index or name */
} mt_energy_goal;

static inline mt_energy_goal mt_energy_goal_default(void)
{
    return (mt_energy_goal){.component = MT_ABSENT, .about = {.point = MT_ABSENT}};
}

struct mt_goal;
struct mt_study_check;
/* Check and resolve what the goal names; after its configurations. Its mode "most" is none of
 * the model's. */
void mt_study_check_energy(struct mt_study_check *c, struct mt_goal *goal);

#endif
