/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_PORTS_H
#define RESPONSE_PORTS_H

#include "mechanics/system.h"

/*
 * What a vibration is caused by (inputs) and seen in (outputs), by name:
 *     inputs   grip.x             force along the direction of a sensor (grip.rx: moment)
 *              base.x[:MOTION]    motion of the ground along a global axis, by default its
 *                                 acceleration
 *     outputs  grip.x[:MOTION]    motion of a sensor, by default its displacement; in space, or
 *                                 as seen from the ground (MOTION relative_acceleration, ...)
 *              spring.NAME        force or torque in a spring, with what its loss factor takes;
 *              damper.NAME        in a damper; positive where it pulls
 *              spring.NAME.x      component of a bushing's force (moment: .rx, in the plane
 *                                 .r): what its stiffness makes of the motion of the second end
 *                                 against the first, along axes that the first carries; of
 *                                 dampers, too
 *              joint.NAME.x       force of the joint's first body on its second, at the joint
 *     MOTION   displacement, velocity, acceleration.
 */
typedef enum mt_port_kind {
    MT_PORT_SENSOR,
    MT_PORT_BASE,
    MT_PORT_SPRING,
    MT_PORT_DAMPER,
    MT_PORT_JOINT
} mt_port_kind;

typedef struct mt_port {
    mt_port_kind kind;
    int index;     /* channel, axis of the ground, spring, joint, of the system */
    int axis;      /* of a joint's force; component of a bushing's (3 ... 5: moments), or -1 */
    int motion;    /* derivative in time: 0 displacement, 1 velocity, 2 acceleration */
    bool relative; /* of a sensor, to the ground */
    bool turns;    /* an angle, or a torque */
    const char *name; /* in full: "grip.x:acceleration" */
    const char *unit; /* "m/s^2" */
} mt_port;

/* Those of one response. */
typedef struct mt_port_set {
    int n_in;
    int n_out;
    mt_port *in;  /* [n_in] */
    mt_port *out; /* [n_out] */
} mt_port_set;

/* The name before the colon, in mem, and what motion stands behind it, where one does: out's
 * motion, and with relative_too what "relative_" says. Fails: MT_E_USAGE, MT_E_MEMORY. */
mt_status mt_port_split(const char *text, bool relative_too, mt_arena *mem, const char **name,
                        mt_port *out, mt_err *err);
/* Read one; the name is in mem. Fails: MT_E_USAGE (there is none of this name, with the nearest
 * one that there is; one that has no single force), MT_E_MEMORY. */
mt_status mt_port_input(const mt_system *sys, const char *text, mt_arena *mem, mt_port *out,
                        mt_err *err);
mt_status mt_port_output(const mt_system *sys, const char *text, mt_arena *mem, mt_port *out,
                         mt_err *err);

#endif
