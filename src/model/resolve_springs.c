/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Springs and dampers: what they hold on to, and which members each type needs. */
#include "model/resolve_priv.h"

#include <string.h>

#include "model/joint.h"

/* Members that a type needs (N), may have (M), or has not ( ). */
typedef enum need { NONE, MAY, NEEDS } need;

bool mt_resolve_hinge(mt_resolve *f, mt_name name, int *at, int *number)
{
    const char *const dot = strchr(name.s, '.');
    bool found = false;
    if (dot == NULL || dot[1] != 'h') {
        return false;
    }
    const int i = mt_names_find(&f->m->tables->bodies, name.s, (size_t)(dot - name.s), &found);
    if (!found || i >= 0) {
        return false;
    }
    const mt_link *const link = &f->m->links[-1 - i];
    int hinge = 0;
    const char *c = dot + 2;
    for (; *c >= '0' && *c <= '9' && hinge < MT_MAX_ELEMENTS; c++) {
        hinge = 10 * hinge + (*c - '0');
    }
    const int hinges = link->kind == MT_LINK_BEAM ? 0 : link->elements - 1;
    if (*c != '\0' || dot[2] == '0' || hinge < 1 || hinge > hinges) {
        mt_diag_error(f->d, name.addr, "\"%s\": link \"%s\" has %d hinges", name.s,
                      link->name.s, hinges < 0 ? 0 : hinges);
        return true;
    }
    *at = -1 - i;
    *number = hinge - 1;
    return true;
}

/* True where the joint has the coordinate that the spring acts on: an angle, or a displacement.
 * Also true for a type that could not be read. */
static bool has_freedom(const mt_joint *joint, bool torsion)
{
    if (joint->type == MT_JOINT_TYPE_COUNT) {
        return true;
    }
    return torsion ? mt_joint_kind_of(joint->type)->coordinate == MT_COORDINATE_ANGLE
                   : mt_joint_slides(joint->type);
}

static void check_joint(mt_resolve *f, const mt_spring *s)
{
    const char *const what = s->damper ? "damper" : "spring";
    const bool torsion = s->type == MT_SPRING_TORSION;
    if (s->joint != MT_ABSENT) {
        const mt_joint *const joint = &f->m->joints[s->joint];
        const bool acts = has_freedom(joint, torsion);
        if (!acts) {
            mt_diag_error(f->d, s->joint_name.addr, "%s %s acts on the %s; \"%s\" is %s",
                          torsion ? "a torsion" : "an axial", what,
                          torsion ? "angle of a revolute joint"
                                  : "displacement of a joint that slides",
                          joint->name.s, mt_joint_type_name(joint->type));
        }
        mt_resolve_needs(f, s->name, what, &s->in, &joint->in, "joint", joint->name.s);
        for (int side = 0; side < 2 && acts && torsion; side++) {
            if (mt_resolve_is_point_mass(f, &joint->bodies[side])) {
                mt_diag_error(f->d, s->joint_name.addr,
                              "\"%s\" of joint \"%s\" is a point mass, which does not turn",
                              joint->bodies[side].name.s, joint->name.s);
            }
        }
    } else if (s->joint_link != MT_ABSENT) {
        mt_resolve_needs(f, s->name, what, &s->in, &f->m->links[s->joint_link].in, "link",
                         f->m->links[s->joint_link].name.s);
        if (!torsion) {
            mt_diag_error(f->d, s->joint_name.addr,
                          "an axial %s acts on the displacement of a joint that slides; \"%s\" "
                          "is a hinge",
                          what, s->joint_name.s);
        }
    }
}

static void check_torsion(mt_resolve *f, const mt_spring *s)
{
    const bool bodies = s->bodies[0].name.s != NULL;
    const bool joint = s->joint_name.s != NULL;
    if (bodies == joint || (bodies && f->m->dimension == 3)) {
        mt_diag_error(f->d, s->name.addr, "a torsion %s needs %s",
                      s->damper ? "damper" : "spring",
                      f->m->dimension == 3
                          ? "\"joint\", not \"bodies\": in three dimensions it acts about the "
                            "axis of a revolute joint; without one, a bushing holds two bodies"
                          : "either \"joint\" or \"bodies\"");
    }
    check_joint(f, s);
}

/* Between two points, or along the axis of a joint, which has points of its own and no length
 * that could be free. */
static void check_axial(mt_resolve *f, const mt_spring *s)
{
    const char *const what = s->damper ? "damper" : "spring";
    const bool joint = s->joint_name.s != NULL;
    if ((s->bodies[0].name.s != NULL) == joint) {
        mt_diag_error(f->d, s->name.addr, "an axial %s needs either \"bodies\" or \"joint\"",
                      what);
    }
    if (joint && s->n_at > 0) {
        mt_diag_error(f->d, s->at[0].addr,
                      "%s \"%s\" acts along joint \"%s\" and has no \"at\"", what, s->name.s,
                      s->joint_name.s);
    }
    if (joint && s->free_length != MT_ABSENT) {
        mt_diag_error(f->d, mt_resolve_addr(f->m, s->free_length),
                      "spring \"%s\" acts along joint \"%s\" and has no free length: give its "
                      "\"preload_n\"",
                      s->name.s, s->joint_name.s);
    }
    check_joint(f, s);
}

static void check_bodies(mt_resolve *f, const mt_spring *s)
{
    const char *const what = s->damper ? "damper" : "spring";
    const bool turns = s->type == MT_SPRING_TORSION || s->type == MT_SPRING_BUSHING;
    for (int side = 0; side < 2; side++) {
        const mt_attach *const a = &s->bodies[side];
        if (a->name.s == NULL) {
            continue;
        }
        mt_resolve_needs_attach(f, s->name, what, &s->in, a);
        if (!mt_resolve_is_point_mass(f, a)) {
            continue;
        }
        const mt_body *const body = &f->m->bodies[a->index];
        const int at = s->n_at == 2 ? side : 0;
        if (turns && (s->type == MT_SPRING_TORSION || side == 0)) {
            mt_diag_error(f->d, a->name.addr, "\"%s\" is a point mass, which does not turn",
                          body->name.s);
        } else if (s->n_at > 0 && !mt_resolve_same_position(f->m, &s->at[at], &body->centre)) {
            mt_diag_error(f->d, s->at[at].addr,
                          "\"%s\" is a point mass and can be held at its centre only: use the "
                          "same point for both",
                          body->name.s);
        }
    }
    const mt_attach *const a = &s->bodies[0];
    const mt_attach *const b = &s->bodies[1];
    if (mt_resolve_same_attach(a, b)) {
        mt_diag_error(f->d, b->name.addr, "%s \"%s\" holds \"%s\" to itself", what, s->name.s,
                      a->name.s);
    }
}

/* What a type of spring holds, by mt_spring_type; a damper can only have what its file format
 * has. */
typedef struct rule {
    need bodies;
    need joint;
    need at;
    need coefficient; /* one number, N/m or N m/rad */
    need material;    /* Young's modulus, area */
    need density;
    need free_length;
    need free_angle;
    need preload;
    need lists; /* per direction, N/m and N m/rad */
    need matrix;
} rule;

static const rule RULES[] = {
    [MT_SPRING_TORSION] =
        {.bodies = MAY, .joint = MAY, .coefficient = NEEDS, .free_angle = MAY, .preload = MAY},
    [MT_SPRING_AXIAL] = {.bodies = MAY,
                         .joint = MAY,
                         .at = MAY,
                         .coefficient = NEEDS,
                         .free_length = MAY,
                         .preload = MAY},
    [MT_SPRING_BAR] =
        {.bodies = NEEDS, .at = MAY, .material = NEEDS, .density = MAY, .preload = MAY},
    [MT_SPRING_BUSHING] = {.bodies = NEEDS, .at = MAY, .lists = NEEDS, .matrix = MAY},
};

static void check_members(mt_resolve *f, const mt_spring *s)
{
    const rule *const r = &RULES[s->type];
    const char *const what = s->damper ? "damper" : "spring";
    const bool torsion = s->type == MT_SPRING_TORSION;
    const char *const force = s->damper ? "damping_n_s_per_m" : "stiffness_n_per_m";
    const char *const torque = s->damper ? "damping_n_m_s_per_rad" : "stiffness_n_m_per_rad";
    const struct {
        bool given;
        need wanted;
        const char *member;
    } members[] = {
        {s->bodies[0].name.s != NULL, r->bodies, "bodies"},
        {s->joint_name.s != NULL, r->joint, "joint"},
        {s->n_at > 0, r->at, "at"},
        {s->stiffness != MT_ABSENT, r->coefficient, torsion ? torque : force},
        {s->youngs_modulus != MT_ABSENT, r->material, "youngs_modulus_pa"},
        {s->area != MT_ABSENT, r->material, "area_m2"},
        {s->density != MT_ABSENT, r->density, "density_kg_per_m3"},
        {s->free_length != MT_ABSENT, r->free_length, "free_length_m"},
        {s->free_angle != MT_ABSENT, r->free_angle, "free_angle_rad"},
        {s->preload != MT_ABSENT, r->preload, torsion ? "preload_n_m" : "preload_n"},
        {s->matrix != NULL, r->matrix, "stiffness_matrix"},
        {s->translation[0] != MT_ABSENT, s->matrix == NULL ? r->lists : MAY, force},
        {s->rotation[2] != MT_ABSENT, s->matrix == NULL ? r->lists : MAY, torque},
    };
    for (int i = 0; i < MT_COUNT(members); i++) {
        const bool given = members[i].given;
        if (members[i].wanted == (given ? NONE : NEEDS)) {
            mt_diag_error(f->d, s->name.addr, "%s \"%s\": %s %s %s %s \"%s\"", what, s->name.s,
                          s->type == MT_SPRING_AXIAL ? "an" : "a", mt_spring_type_name(s->type),
                          what, given ? "has no" : "needs", members[i].member);
        }
    }
}

/* Checks that involve several members. */
static void check_together(mt_resolve *f, const mt_spring *s)
{
    const bool lists = s->translation[0] != MT_ABSENT || s->rotation[2] != MT_ABSENT;
    const bool free_given = s->free_length != MT_ABSENT || s->free_angle != MT_ABSENT;
    if (s->matrix != NULL && lists) {
        mt_diag_error(f->d, s->name.addr,
                      "spring \"%s\": give \"stiffness_matrix\" or the two lists, not both",
                      s->name.s);
    }
    if (s->matrix != NULL && f->m->dimension == 2) {
        mt_diag_error(f->d, s->name.addr,
                      "spring \"%s\": \"stiffness_matrix\" is for three dimensions", s->name.s);
    }
    if (free_given && s->preload != MT_ABSENT) {
        mt_diag_error(
            f->d, mt_resolve_addr(f->m, s->preload),
            "spring \"%s\": a preload follows from the free length or angle; give one of them",
            s->name.s);
    }
    if (s->n_at == 1 && s->joint_name.s == NULL &&
        (s->type == MT_SPRING_AXIAL || s->type == MT_SPRING_BAR)) {
        mt_diag_error(f->d, s->at[0].addr,
                      "\"at\" of %s \"%s\" must be a pair: the point on each body",
                      s->damper ? "damper" : "spring", s->name.s);
    }
}

void mt_resolve_springs(mt_resolve *f)
{
    for (int i = 0; i < f->m->n_springs; i++) {
        mt_spring *const s = &f->m->springs[i];
        s->joint = MT_ABSENT;
        s->joint_link = MT_ABSENT;
        s->joint_hinge = MT_ABSENT;
        for (int side = 0; side < 2; side++) {
            mt_resolve_attach(f, &s->bodies[side]);
        }
        for (int k = 0; k < s->n_at; k++) {
            mt_resolve_position(f, &s->at[k]);
        }
        if (s->joint_name.s != NULL &&
            !mt_resolve_hinge(f, s->joint_name, &s->joint_link, &s->joint_hinge)) {
            s->joint = mt_resolve_find(f, s->joint_name, &f->m->tables->joints, "joint");
        }
        if (s->type == MT_SPRING_TYPE_COUNT || f->m->dimension == 0) {
            continue; /* could not be read */
        }
        check_members(f, s);
        check_together(f, s);
        check_bodies(f, s);
        if (s->type == MT_SPRING_TORSION) {
            check_torsion(f, s);
        } else if (s->type == MT_SPRING_AXIAL) {
            check_axial(f, s);
        }
    }
}
