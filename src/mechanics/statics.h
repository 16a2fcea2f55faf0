/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_STATICS_H
#define MECHANICS_STATICS_H

#include "mechanics/linear.h"

/*
 * A scalar of a mechanism at rest, where it is linearised:
 *     SENSOR  displacement of a sensor's point from the reference position (loops closed, no
 *             loads, nothing driven) along its global axis [m]; of a rotation the component of
 *             the rotation vector from there [rad]
 *     SPRING  force or torque in a spring, above 0 where it pulls; of a bushing a component
 *     JOINT   component along global axes of what the joint's first body does to its second:
 *             the force (axis 0 ... 2), the moment about the joint's point on the second body
 *             (3 ... 5); what holds a locked drive is part of it
 *     HOLD    force or torque along the coordinate of the joint that is locked at its driven
 *             position, of the first body on the second
 */
typedef enum mt_static_kind {
    MT_STATIC_SENSOR,
    MT_STATIC_SPRING,
    MT_STATIC_JOINT,
    MT_STATIC_HOLD
} mt_static_kind;

typedef struct mt_static {
    mt_static_kind kind;
    int index; /* of the system: channel, spring, joint */
    int axis;  /* of a joint; component of a bushing (3 ... 5: moments), or -1 */
} mt_static;

/* After an update. Fails: MT_E_USAGE (a joint that is redundant with others in this component;
 * one without bodies of its own; nothing holds it), MT_E_MEMORY. */
mt_status mt_static_value(mt_linear *lin, const mt_static *q, double *value, mt_err *err);
/* slope[n_inputs]: exact derivatives, after an update with gradients; that of equilibrium and
 * multipliers from the implicit function (position.h). O(n_inputs nq^2). Fails also:
 * MT_E_INTERNAL (no gradient). */
mt_status mt_static_slopes(mt_linear *lin, const mt_static *q, double *slope, mt_err *err);

/*
 * Static compliance: the small displacement (rotation) along sensor direction `out` by a unit
 * force (moment) along `in` at the equilibrium, with K_r x = b, K_r y = s
 *     C = s . x,      dC = ds . x + y . db - y . dK_r x
 * of the tangent stiffness, geometric part and constraints included, without damping and loss
 * factors. A sensor within a beam element moves as on its chord (rows.c): it is off by the part
 * that the bow is of the element's length. After an update; slope[n_inputs] (NULL: not wanted)
 * after one with gradients, NaN where redundant joints leave no derivative. Nothing may be free
 * to move (mt_modes). O(n^3). Fails: MT_E_NOT_SPD (K_r is not positive definite), MT_E_MEMORY.
 */
mt_status mt_static_compliance(mt_linear *lin, int out, int in, double *value, double *slope,
                               mt_err *err);

#endif
