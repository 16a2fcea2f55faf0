/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_PORTS_H
#define RESPONSE_PORTS_H

#include "mechanics/statics.h"
#include "mechanics/system.h"

/*
 * Inputs and outputs of a forced vibration, by name:
 *     inputs   grip.x             force along the direction of a sensor (grip.rx: moment)
 *              base.x[:MOTION]    motion of the ground along a global axis, by default its
 *                                 acceleration
 *     outputs  grip.x[:MOTION]    motion of a sensor, by default its displacement; in space, or
 *                                 relative to the ground (MOTION relative_acceleration, ...)
 *              spring.NAME        force or torque in a spring, loss factor included; positive
 *              damper.NAME        in tension; the same of a damper
 *              spring.NAME.x      component of a bushing's force (moment: .rx, in the plane
 *                                 .r): its stiffness times the motion of the second end
 *                                 relative to the first, along axes fixed to the first; the
 *                                 same of a damper
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
    /* index in the system of the channel, ground axis, spring, damper or joint */
    int index;
    /* axis of a joint's force, at rest also of its moment (3 ... 5) or MT_PORT_HOLD; component
     * of a bushing's (3 ... 5: moments), or -1 */
    int axis;
    int motion;       /* derivative in time: 0 displacement, 1 velocity, 2 acceleration */
    bool relative;    /* of a sensor: relative to the ground */
    bool turns;       /* rotational: an angle or a torque */
    const char *name; /* full name, such as "grip.x:acceleration" */
    const char *unit; /* "m/s^2" */
} mt_port;

/* Of a joint at rest: what holds it at its driven position. */
enum { MT_PORT_HOLD = 6 };

/* The ports of one response. */
typedef struct mt_port_set {
    int n_in;
    int n_out;
    mt_port *in;  /* [n_in] */
    mt_port *out; /* [n_out] */
} mt_port_set;

/* Splits NAME:MOTION: the name, in mem, and out's motion where given; with relative_too also
 * out's `relative`, from the prefix "relative_". Fails: MT_E_USAGE, MT_E_MEMORY. */
mt_status mt_port_split(const char *text, bool relative_too, mt_arena *mem, const char **name,
                        mt_port *out, mt_err *err);
/* Port by its name; port->name is in mem. Fails: MT_E_USAGE (an unknown name, with the nearest
 * known one; an element without a single force), MT_E_MEMORY. */
mt_status mt_port_input(const mt_system *sys, const char *text, mt_arena *mem, mt_port *out,
                        mt_err *err);
mt_status mt_port_output(const mt_system *sys, const char *text, mt_arena *mem, mt_port *out,
                         mt_err *err);
/*
 * What there is at rest (mechanics/statics.h): a sensor's displacement, a spring's force, and
 * of joints also moments, "joint.NAME.rx" (in the plane "joint.NAME.rz"), and what holds a
 * driven one, "joint.NAME.hold". The same failures; MT_E_USAGE for a motion or a damper.
 */
mt_status mt_port_at_rest(const mt_system *sys, const char *text, mt_arena *mem, mt_port *out,
                          mt_err *err);
/* What such a port is read as. */
mt_static mt_port_static(const mt_port *port);

#endif
