/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "response/ports.h"

#include <string.h>

#include "base/text.h"

static const char *const MOTIONS[3] = {"displacement", "velocity", "acceleration"};
static const char *const UNITS[2][3] = {{"m", "m/s", "m/s^2"}, {"rad", "rad/s", "rad/s^2"}};
static const char *const FORCES[2] = {"N", "N m"};
static const char AXES[] = "xyz";
static const char RELATIVE[] = "relative_";
static const char BASE[] = "base.";
static const char JOINT[] = "joint.";
static const char *const WITH_FORCE[2] = {"spring.", "damper."};

static bool begins(const char *text, const char *with)
{
    return strncmp(text, with, strlen(with)) == 0;
}

mt_status mt_port_split(const char *text, bool relative_too, mt_arena *mem, const char **name,
                        mt_port *out, mt_err *err)
{
    const char *const colon = strchr(text, ':');
    *name = colon == NULL ? text : mt_arena_strndup(mem, text, (size_t)(colon - text));
    MT_TRY(mt_arena_check(mem, err));
    if (colon == NULL) {
        return MT_OK;
    }
    const char *motion = colon + 1;
    if (relative_too && begins(motion, RELATIVE)) {
        out->relative = true;
        motion += strlen(RELATIVE);
    }
    for (int k = 0; k < 3; k++) {
        if (strcmp(motion, MOTIONS[k]) == 0) {
            out->motion = k;
            return MT_OK;
        }
    }
    return mt_fail(err, MT_E_USAGE,
                   "\"%s\": \"%s\" is not displacement, velocity or acceleration%s", text,
                   colon + 1, relative_too ? ", nor relative_displacement, ..." : "");
}

/* The names of all ports of a kind, for "did you mean". */
static mt_status refuse_unknown_port(const mt_system *sys, const char *text, bool input,
                                     mt_arena *mem, mt_err *err)
{
    const size_t most =
        (size_t)sys->n_channels + (size_t)sys->n_springs + (3 * (size_t)sys->n_joints) + 3;
    const char **const names = mt_arena_alloc(mem, most, sizeof *names);
    MT_TRY(mt_arena_check(mem, err));
    int n = 0;
    for (int i = 0; i < sys->n_channels; i++) {
        names[n++] = sys->channels[i].name;
    }
    for (int k = 0; k < sys->dimension && input; k++) {
        names[n++] = mt_arena_printf(mem, "%s%c", BASE, AXES[k]);
    }
    for (int i = 0; i < sys->n_springs && !input; i++) {
        names[n++] = mt_arena_printf(mem, "%s%s", WITH_FORCE[sys->springs[i].damper ? 1 : 0],
                                     sys->springs[i].name);
    }
    for (int i = 0; i < sys->n_joints * sys->dimension && !input; i++) {
        names[n++] =
            mt_arena_printf(mem, "%s%s.%c", JOINT, sys->joints[i / sys->dimension].name,
                            AXES[i % sys->dimension]);
    }
    MT_TRY(mt_arena_check(mem, err));
    const char *const nearest = mt_text_nearest(text, names, n);
    const char *const what = input ? "input" : "output";
    return nearest == NULL
               ? mt_fail(err, MT_E_USAGE, "no %s is called \"%s\"", what, text)
               : mt_fail(err, MT_E_USAGE, "no %s is called \"%s\"; did you mean \"%s\"?", what,
                         text, nearest);
}

/* Axis of a single letter at the end; -1: none. */
static int axis_of(const mt_system *sys, const char *letter)
{
    const char *const at = letter[0] == '\0' ? NULL : strchr(AXES, letter[0]);
    const int axis = at == NULL || letter[1] != '\0' ? -1 : (int)(at - AXES);
    return axis < sys->dimension ? axis : -1;
}

static void set_motion(mt_arena *mem, const char *name, mt_port *out)
{
    out->name = mt_arena_printf(mem, "%s:%s%s", name, out->relative ? RELATIVE : "",
                                MOTIONS[out->motion]);
    out->unit = UNITS[out->turns ? 1 : 0][out->motion];
}

mt_status mt_port_input(const mt_system *sys, const char *text, mt_arena *mem, mt_port *out,
                        mt_err *err)
{
    const char *name = NULL;
    *out = (mt_port){.kind = MT_PORT_BASE, .motion = 2};
    MT_TRY(mt_port_split(text, false, mem, &name, out, err));
    const int axis = begins(name, BASE) ? axis_of(sys, name + strlen(BASE)) : -1;
    const int channel = mt_system_find_channel(sys, name);
    if (axis >= 0) {
        out->index = axis;
        set_motion(mem, name, out);
        return mt_arena_check(mem, err);
    }
    if (channel < 0) {
        return refuse_unknown_port(sys, name, true, mem, err);
    }
    if (strchr(text, ':') != NULL) {
        return mt_fail(err, MT_E_USAGE, "\"%s\": the input at a sensor is its force", text);
    }
    *out = (mt_port){.kind = MT_PORT_SENSOR,
                     .index = channel,
                     .turns = mt_channel_turns(sys->channels[channel].kind),
                     .name = sys->channels[channel].name};
    out->unit = FORCES[out->turns ? 1 : 0];
    return MT_OK;
}

/* Number of force components of the spring (or damper) of this name; *first: the first of
 * them. */
static int count_forces(const mt_system *sys, const char *own, bool damper, int *first)
{
    int count = 0;
    for (int i = sys->n_springs - 1; i >= 0; i--) {
        const mt_spring_def *const s = &sys->springs[i];
        if (s->damper == damper && s->name != NULL && strcmp(s->name, own) == 0) {
            count++;
            *first = i;
        }
    }
    return count;
}

/* True where forces of this name are components: of a bushing, or of a joint's bearing, which
 * is one of the system alone. */
static bool is_bushing(const mt_system *sys, const char *own, bool damper)
{
    const mt_model *const m = sys->model;
    bool is = false;
    int elements = 0;
    for (int i = 0; i < m->n_springs; i++) {
        const mt_spring *const s = &m->springs[i];
        is = is || (s->damper == damper && s->type == MT_SPRING_BUSHING &&
                    strcmp(s->name.s, own) == 0);
    }
    for (int i = 0; i < sys->n_springs; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        const mt_measure_kind kind = sys->measures[s->measure[0]].kind;
        const bool component = kind == MT_MEASURE_PLANE || kind == MT_MEASURE_ROTATION;
        elements +=
            component && s->damper == damper && s->name != NULL && strcmp(s->name, own) == 0
                ? 1
                : 0;
    }
    return is || elements > 1;
}

/* "NAME.x" of a bushing (moments "NAME.rx", in the plane "NAME.r"): *own becomes its name, and
 * the component is returned; -1: it is none. */
static int component_of(const mt_system *sys, const char **own, bool damper, mt_arena *mem)
{
    const char *const dot = strrchr(*own, '.');
    const bool turns = dot != NULL && dot[1] == 'r';
    int axis = dot == NULL ? -1 : axis_of(sys, dot + (turns ? 2 : 1));
    if (turns && sys->dimension == 2) {
        axis = dot[2] == '\0' ? 2 : -1;
    }
    const char *const name =
        mt_arena_strndup(mem, *own, dot == NULL ? 0 : (size_t)(dot - *own));
    if (name == NULL || axis < 0 || !is_bushing(sys, name, damper)) {
        return -1;
    }
    *own = name;
    return axis + (turns ? 3 : 0);
}

/* "spring.NAME", "damper.NAME", or a component of a bushing's. */
static mt_status find_spring(const mt_system *sys, const char *name, mt_arena *mem, bool damper,
                             mt_port *out, mt_err *err)
{
    const char *own = name + strlen(WITH_FORCE[0]);
    int count = count_forces(sys, own, damper, &out->index);
    out->axis = -1;
    if (count == 0) {
        out->axis = component_of(sys, &own, damper, mem);
        count = out->axis < 0 ? 0 : count_forces(sys, own, damper, &out->index);
    }
    if (count == 0) {
        return refuse_unknown_port(sys, name, false, mem, err);
    }
    if (count > 1 && out->axis < 0) {
        return mt_fail(err, MT_E_USAGE,
                       "\"%s\" has several forces, not one: name one of its components, "
                       "\"%s.x\" or, a moment, \"%s.%s\"",
                       name, name, name, sys->dimension == 2 ? "r" : "rz");
    }
    const mt_measure_kind kind = sys->measures[sys->springs[out->index].measure[0]].kind;
    out->kind = damper ? MT_PORT_DAMPER : MT_PORT_SPRING;
    out->turns = out->axis < 0 ? kind == MT_MEASURE_ANGLE || kind == MT_MEASURE_ROTATION
                               : out->axis >= 3;
    out->name = mt_arena_strdup(mem, name);
    out->unit = FORCES[out->turns ? 1 : 0];
    return mt_arena_check(mem, err);
}

/* Component of a joint after the last dot: of its force; at rest also of its moment, 3 ... 5,
 * and MT_PORT_HOLD; -1: none. */
static int joint_component(const mt_system *sys, const char *text, bool at_rest)
{
    if (at_rest && strcmp(text, "hold") == 0) {
        return MT_PORT_HOLD;
    }
    if (!at_rest || text[0] != 'r') {
        return axis_of(sys, text);
    }
    const int axis = strcmp(text, "rz") == 0 ? 2 : axis_of(sys, text + 1);
    return axis < 0 || (sys->dimension == 2 && axis != 2) ? -1 : 3 + axis;
}

/* "joint.NAME.x". */
static mt_status find_joint_port(const mt_system *sys, const char *name, bool at_rest,
                                 mt_arena *mem, mt_port *out, mt_err *err)
{
    const char *const own = name + strlen(JOINT);
    const char *const dot = strrchr(own, '.');
    const int axis = dot == NULL ? -1 : joint_component(sys, dot + 1, at_rest);
    if (axis < 0) {
        return refuse_unknown_port(sys, name, false, mem, err);
    }
    const char *const joint = mt_arena_strndup(mem, own, (size_t)(dot - own));
    MT_TRY(mt_arena_check(mem, err));
    const int index = mt_system_find_joint(sys, joint);
    if (index < 0) {
        return refuse_unknown_port(sys, name, false, mem, err);
    }
    const bool turns = axis == MT_PORT_HOLD ? sys->joints[index].angle : axis >= 3;
    *out = (mt_port){.kind = MT_PORT_JOINT,
                     .index = index,
                     .axis = axis,
                     .turns = turns,
                     .name = mt_arena_strdup(mem, name),
                     .unit = FORCES[turns ? 1 : 0]};
    return mt_arena_check(mem, err);
}

mt_status mt_port_output(const mt_system *sys, const char *text, mt_arena *mem, mt_port *out,
                         mt_err *err)
{
    const char *name = NULL;
    *out = (mt_port){.kind = MT_PORT_SENSOR};
    MT_TRY(mt_port_split(text, true, mem, &name, out, err));
    const int channel = mt_system_find_channel(sys, name);
    if (channel >= 0) {
        out->index = channel;
        out->turns = mt_channel_turns(sys->channels[channel].kind);
        set_motion(mem, name, out);
        return mt_arena_check(mem, err);
    }
    const bool spring = begins(name, WITH_FORCE[0]);
    const bool damper = begins(name, WITH_FORCE[1]);
    if (!spring && !damper && !begins(name, JOINT)) {
        return refuse_unknown_port(sys, name, false, mem, err);
    }
    if (strchr(text, ':') != NULL) {
        return mt_fail(err, MT_E_USAGE, "\"%s\": a force has no motion", text);
    }
    return spring || damper ? find_spring(sys, name, mem, damper, out, err)
                            : find_joint_port(sys, name, false, mem, out, err);
}

mt_status mt_port_at_rest(const mt_system *sys, const char *text, mt_arena *mem, mt_port *out,
                          mt_err *err)
{
    const char *const colon = strchr(text, ':');
    if (colon != NULL) {
        return mt_fail(err, MT_E_USAGE, "\"%s\": at rest there is no %s", text, colon + 1);
    }
    if (begins(text, WITH_FORCE[1])) {
        return mt_fail(err, MT_E_USAGE, "\"%s\": a damper carries nothing at rest", text);
    }
    return begins(text, JOINT) && mt_system_find_channel(sys, text) < 0
               ? find_joint_port(sys, text, true, mem, out, err)
               : mt_port_output(sys, text, mem, out, err);
}

mt_static mt_port_static(const mt_port *port)
{
    const bool hold = port->kind == MT_PORT_JOINT && port->axis == MT_PORT_HOLD;
    return (mt_static){.kind = hold                           ? MT_STATIC_HOLD
                               : port->kind == MT_PORT_JOINT  ? MT_STATIC_JOINT
                               : port->kind == MT_PORT_SPRING ? MT_STATIC_SPRING
                                                              : MT_STATIC_SENSOR,
                       .index = port->index,
                       .axis = port->axis};
}
