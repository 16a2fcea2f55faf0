/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_SINGULAR_H
#define MECHANICS_SINGULAR_H

#include "mechanics/data.h"
#include "mechanics/eliminate.h"
#include "mechanics/lagrangian.h"

/* Distance of a position to one where equations of joints are dependent there only. */
typedef struct mt_nearness {
    bool near; /* within MT_NEAR_DISTANCE; otherwise the other members are void */
    /* a singular value of the equations in rows of unit length: about 1 far away, 0 at the
     * singular position */
    double independence;
    double distance;       /* approximate distance [rad, model lengths] */
    mt_joint_names joints; /* joints of the dependent equations */
} mt_nearness;

/* Positions up to this distance are reported as near [rad, model lengths]: about three
 * degrees. */
static const double MT_NEAR_DISTANCE = 0.05;

/**
 * Refuse a singular position, where equations of joints are dependent but not next to it (a
 * dead centre, a folded parallelogram, a rope just taut): the motions that A allows to first
 * order are then not real motions, and the forces of the joints are not determined. Joints that
 * are redundant everywhere are not refused.
 * @param[in] d, at     closed position (to rounding)
 * @param[in] e         elimination of the first e->m constraints there
 * Fails: MT_E_DEAD_CENTRE with the joints' names, MT_E_MEMORY. Costs nothing where the
 * equations are far from dependent; otherwise a few products with A and O(e->m nq) per freedom.
 */
mt_status mt_singular_refuse(const mt_data *d, const mt_placement *at, const mt_elimination *e,
                             mt_arena *scratch, mt_err *err);
/* Distance to such a position. Arguments as above; names are in mem. */
mt_status mt_singular_nearness(const mt_data *d, const mt_placement *at,
                               const mt_elimination *e, mt_arena *scratch, mt_arena *mem,
                               mt_nearness *out, mt_err *err);

/* Values and curvature of the equations of joints, without anything else. */

/* Part to subtract from `value` of constraint i: whole turns of an angle, so that it is nearest
 * to its target; of a gear's two angles the one without a ratio (term 0) may turn on, the other
 * stays within half a turn. */
double mt_constraint_turns(const mt_data *d, int i, double value);
/* c[m]: values of the constraints. */
void mt_constraint_values(const mt_data *d, const mt_placement *at, int m, double *c);

#endif
