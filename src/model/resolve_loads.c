/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Dead loads: what they act on. A moment of constant direction in space does the work m .
 * dtheta, which is no differential where a body turns about several axes: turned by a quarter
 * about z, then about x, it does other work than the other way round. Its stiffness would be
 * the skew matrix [m]x/2, and frequencies would not exist as real numbers (Ziegler, Principles
 * of Structural Stability, 1968). So in three dimensions a moment acts on the coordinate of a
 * joint; a pair of forces states any other, with the potential that it has.
 */
#include "model/resolve_priv.h"

#include "model/joint.h"

static void check_joint(mt_resolve *f, const mt_load *l)
{
    if (l->joint_link != MT_ABSENT) {
        const mt_link *const link = &f->m->links[l->joint_link];
        mt_resolve_needs(f, l->name, "load", &l->in, &link->in, "link", link->name.s);
    }
    if (l->joint != MT_ABSENT) {
        const mt_joint *const joint = &f->m->joints[l->joint];
        mt_resolve_needs(f, l->name, "load", &l->in, &joint->in, "joint", joint->name.s);
    }
    const bool known =
        l->joint_link != MT_ABSENT ||
        (l->joint != MT_ABSENT && f->m->joints[l->joint].type != MT_JOINT_TYPE_COUNT);
    if (!known) {
        return;
    }
    const mt_joint *const joint = l->joint == MT_ABSENT ? NULL : &f->m->joints[l->joint];
    /* a link's hinge turns */
    const mt_coordinate coordinate =
        joint == NULL ? MT_COORDINATE_ANGLE : mt_joint_kind_of(joint->type)->coordinate;
    if (coordinate == MT_COORDINATE_NONE) {
        mt_diag_error(f->d, l->joint_name.addr, "\"%s\" is %s, which has no coordinate to load",
                      joint->name.s, mt_joint_type_name(joint->type));
        return;
    }
    if (coordinate == MT_COORDINATE_ANGLE ? l->has_force || !l->has_moment
                                          : l->has_moment || !l->has_force) {
        mt_diag_error(f->d, l->joint_name.addr, "joint \"%s\" %s: its load is \"%s\"",
                      l->joint_name.s, coordinate == MT_COORDINATE_ANGLE ? "turns" : "slides",
                      coordinate == MT_COORDINATE_ANGLE ? "moment_n_m" : "force_n");
    }
    for (int side = 0; side < 2 && joint != NULL && coordinate == MT_COORDINATE_ANGLE; side++) {
        if (mt_resolve_is_point_mass(f, &joint->bodies[side])) {
            mt_diag_error(f->d, l->joint_name.addr,
                          "\"%s\" of joint \"%s\" is a point mass, which does not turn",
                          joint->bodies[side].name.s, joint->name.s);
        }
    }
    if (l->has_force && !l->one_number) {
        mt_diag_error(f->d, mt_diag_member(f->d, l->addr, "force_n"),
                      "must be one number: the force acts along joint \"%s\"", l->joint_name.s);
    }
    if (l->moment_vector) {
        mt_diag_error(f->d, mt_diag_member(f->d, l->addr, "moment_n_m"),
                      "must be one number: the moment acts about joint \"%s\"",
                      l->joint_name.s);
    }
    if (l->at.given) {
        mt_diag_error(f->d, l->at.addr, "a load on a joint has no \"at\"");
    }
}

static void check_body(mt_resolve *f, const mt_load *l)
{
    mt_resolve_needs_attach(f, l->name, "load", &l->in, &l->on);
    const bool point_mass = mt_resolve_is_point_mass(f, &l->on);
    if (l->has_force && l->one_number) {
        mt_diag_error(f->d, mt_diag_member(f->d, l->addr, "force_n"),
                      "must be a list: the force along %s",
                      f->m->dimension == 2 ? "x and y" : "x, y and z");
    }
    if (l->has_moment && (f->m->dimension == 3 || l->moment_vector)) {
        mt_diag_error(f->d, mt_diag_member(f->d, l->addr, "moment_n_m"), "%s",
                      f->m->dimension == 2
                          ? "must be one number: the moment about z"
                          : "a moment of constant direction in space has no potential: put it "
                            "on a joint that turns, or give the forces that make it");
    } else if (l->has_moment && point_mass) {
        mt_diag_error(f->d, l->on.name.addr, "\"%s\" is a point mass, which does not turn",
                      l->on.name.s);
    }
    if (point_mass && l->at.given &&
        !mt_resolve_same_position(f->m, &l->at, &f->m->bodies[l->on.index].centre)) {
        mt_diag_error(f->d, l->at.addr,
                      "\"%s\" is a point mass and can be held at its centre only: use the same "
                      "point for both",
                      l->on.name.s);
    }
}

static void check_load(mt_resolve *f, const mt_load *l)
{
    const bool joint = l->joint_name.s != NULL;
    if ((l->on.name.s != NULL) == joint) {
        mt_diag_error(f->d, l->name.addr, "load \"%s\" needs either \"on\" or \"joint\"",
                      l->name.s);
        return;
    }
    if (!l->has_force && !l->has_moment) {
        mt_diag_error(f->d, l->name.addr,
                      "load \"%s\" has neither \"force_n\" nor \"moment_n_m\"", l->name.s);
        return;
    }
    if (joint) {
        check_joint(f, l);
    } else if (l->on.kind == MT_ATTACH_GROUND) {
        mt_diag_error(f->d, l->on.name.addr, "a load on the ground moves nothing");
    } else {
        check_body(f, l);
    }
}

void mt_resolve_loads(mt_resolve *f)
{
    for (int i = 0; i < f->m->n_loads; i++) {
        mt_load *const l = &f->m->loads[i];
        const int before = f->d->errors;
        l->joint = MT_ABSENT;
        l->joint_link = MT_ABSENT;
        l->joint_hinge = MT_ABSENT;
        mt_resolve_attach(f, &l->on);
        mt_resolve_position(f, &l->at);
        if (l->joint_name.s != NULL &&
            !mt_resolve_hinge(f, l->joint_name, &l->joint_link, &l->joint_hinge)) {
            l->joint = mt_resolve_find(f, l->joint_name, &f->m->tables->joints, "joint");
        }
        if (f->m->dimension != 0 && !l->unread && f->d->errors == before) {
            check_load(f, l);
        }
    }
}
