/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_SINGULAR_H
#define MECHANICS_SINGULAR_H

#include "mechanics/eliminate.h"
#include "mechanics/lagrangian.h"
#include "mechanics/names.h"

/* How near a position is to one where the equations of joints depend on each other there
 * only. */
typedef struct mt_nearness {
    bool near; /* one is within MT_NEAR_DISTANCE; else nothing below means anything */
    /* what is left of the equations' independence: a singular value of the equations in rows of
     * unit length, about 1 far away, 0 there */
    double independence;
    double distance;       /* about how far it is [rad, model lengths] */
    mt_joint_names joints; /* whose equations they are */
} mt_nearness;

/* Said to be near up to this distance [rad, model lengths]: about three degrees. */
static const double MT_NEAR_DISTANCE = 0.05;

/**
 * Refuses a position that is not like any other beside it: one where equations of joints depend
 * on each other here only (a dead centre, a folded parallelogram, a rope just taut). Then the
 * motions that A allows to first order are not the motions that there are, and the forces of
 * the joints are not determined. Joints that are redundant everywhere are none of this.
 * @param[in] d, at     closed position (to rounding)
 * @param[in] e elimination of the first e->m constraints there Fails: MT_E_DEAD_CENTRE with the
 *   joints' names, MT_E_MEMORY. Costs nothing where the equations are far from dependent; else
 *   a few products with A and O(e->m nq) per freedom.
 */
mt_status mt_singular_refuse(const mt_data *d, const mt_placement *at, const mt_elimination *e,
                             mt_arena *scratch, mt_err *err);
/* How near such a position is. Arguments as above; names are in mem. */
mt_status mt_singular_nearness(const mt_data *d, const mt_placement *at,
                               const mt_elimination *e, mt_arena *scratch, mt_arena *mem,
                               mt_nearness *out, mt_err *err);

#endif
