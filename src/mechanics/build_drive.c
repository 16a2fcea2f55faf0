/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The driven joint: that of the configuration, or one that the caller names, whose position is
 * then an input. */
#include <string.h>

#include "base/text.h"
#include "mechanics/build.h"

/* Who drives what, in names: `who` begins the message where something is wrong. */
typedef struct request {
    const char *who;
    const char *joint;
    mt_node position;
    const char *spring; /* NULL: lock */
} request;

static mt_status no_such_joint(mt_builder *b, const request *r, int found)
{
    const mt_system *const sys = b->sys;
    const char *const configuration = b->model->configurations[sys->configuration].name.s;
    if (found >= 0) {
        return mt_fail(b->err, MT_E_INPUT, "%s: joint \"%s\" (%s) has no coordinate to drive",
                       r->who, r->joint, mt_joint_type_name(sys->joints[found].type));
    }
    const char **const names =
        mt_arena_alloc(&b->sys->mem, (size_t)sys->n_joints, sizeof *names);
    MT_TRY(mt_arena_check(&b->sys->mem, b->err));
    int n = 0;
    for (int i = 0; i < sys->n_joints; i++) {
        if (sys->joints[i].coordinate >= 0) {
            names[n++] = sys->joints[i].name;
        }
    }
    const char *const nearest = mt_text_nearest(r->joint, names, n);
    return mt_fail(b->err, MT_E_INPUT,
                   "%s: there is no joint \"%s\" in configuration \"%s\"%s%s%s", r->who,
                   r->joint, configuration, nearest == NULL ? "" : "; did you mean \"",
                   nearest == NULL ? "" : nearest, nearest == NULL ? "" : "\"?");
}

static mt_status find_spring(mt_builder *b, const request *r)
{
    mt_system *const sys = b->sys;
    for (int i = 0; i < sys->n_springs && sys->trim_spring < 0; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        if (!s->damper && s->measure[0] == s->measure[1] && strcmp(s->name, r->spring) == 0) {
            sys->trim_spring = i;
        }
    }
    if (sys->trim_spring < 0) {
        return mt_fail(b->err, MT_E_INPUT,
                       "%s: there is no spring \"%s\" to hold it in configuration \"%s\"",
                       r->who, r->spring, b->model->configurations[sys->configuration].name.s);
    }
    return MT_OK;
}

static mt_status drive(mt_builder *b, const request *r)
{
    mt_system *const sys = b->sys;
    const int joint = mt_system_find_joint(sys, r->joint);
    if (joint < 0 || sys->joints[joint].coordinate < 0) {
        return no_such_joint(b, r, joint);
    }
    sys->drive = r->position;
    sys->drive_joint = joint;
    sys->driven = true;
    sys->drive_constraint = sys->n_constraints;
    mt_build_constraint(b, sys->joints[joint].coordinate, MT_NO_NODE, false);
    if (!mt_arena_failed(&sys->mem)) {
        sys->constraints[sys->drive_constraint].joint = joint;
    }
    sys->trim = r->spring != NULL;
    return sys->trim ? find_spring(b, r) : MT_OK;
}

mt_status mt_build_drive(mt_builder *b)
{
    mt_system *const sys = b->sys;
    const mt_configuration *const c = &b->model->configurations[sys->configuration];
    sys->drive_constraint = -1;
    sys->drive_joint = -1;
    sys->trim_spring = -1;
    if (b->drive != NULL) {
        const request r = {
            .who = "drive",
            .joint = b->drive->joint,
            .position = b->drive->fixed
                            ? mt_program_const(&sys->program, b->drive->position)
                            : mt_program_input(&sys->program, sys->n_inputs - 1, MT_NO_ADDR),
            .spring = b->drive->spring,
        };
        return drive(b, &r);
    }
    if (!c->drive.given) {
        return MT_OK;
    }
    const request r = {
        .who = mt_build_name(b, "drive of configuration \"%s\"", c->name.s),
        .joint = b->model->joints[c->drive.joint].name.s,
        .position = mt_build_num(b, c->drive.position),
        .spring = c->drive.trim ? b->model->springs[c->drive.trim_spring].name.s : NULL,
    };
    return drive(b, &r);
}
