/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Goals about shares of a mode's energy: their members, and what cannot be meant. Bodies and
 * links move, springs and links are strained; the ground does neither.
 */
#include "study/energy_goal.h"

#include <math.h>
#include <string.h>

#include "study/check.h"
#include "study/reader.h"

/* Instead of a mode's index or name. */
static const char MOST[] = "most";

/* Reading */

static void read_directions(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    ((mt_goal_parts *)item)->energy.direction_names = mt_reader_one_or_refs(r, key, value);
}

/* A body or a spring, and what goes with each. */
static void energy_check(mt_reader *r, mt_object *o)
{
    mt_goal_check(r, o);
    (void)mt_object_one_of(r, o, "body", 2);
    if (mt_object_has(r, o, "direction") && mt_object_has(r, o, "directions")) {
        (void)mt_object_one_of(r, o, "direction", 2);
        mt_object_leave_out(o, "direction", 2);
    }
}

static void note_company(mt_reader *r, const mt_object *o, const char *member, const char *with)
{
    if (mt_object_has(r, o, member) && !mt_object_has(r, o, with)) {
        mt_diag_structure(r->diags, mt_object_place(r, o, member), "\"%s\" goes with \"%s\"",
                          member, with);
    }
}

static void energy_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    static const char *const of_bodies[] = {"direction", "directions", "about", "axes"};
    mt_goal_parts *const parts = item;
    mt_goal_finish(r, o, which, item);
    for (int i = 0; i < MT_COUNT(of_bodies); i++) {
        note_company(r, o, of_bodies[i], "body");
    }
    note_company(r, o, "component", "spring");
    parts->goal.energy = mt_arena_alloc(r->mem, 1, sizeof parts->energy);
    if (parts->goal.energy != NULL) {
        *parts->goal.energy = parts->energy;
    }
}

#define THIS mt_goal_parts
static const mt_key ENERGY[] = {
    MT_GOAL_ROWS(MT_GOAL_TOLERANCE),
    MT_GOAL_CONFIGURATION_ROWS,
    MT_S_MODE("mode", goal.mode,
              "Which mode: index from 1, name, or \"most\": the one that has most of this "
              "energy, whichever it is. Modes of one frequency count together, by the sum of "
              "their shares."),
    MT_M_REF("body", false, energy.body_name,
             "The body, or flexible link, whose share of the kinetic energy is meant."),
    MT_M_REF("spring", false, energy.spring_name,
             "The spring, or flexible link, whose share of the strain energy is meant."),
    {.name = "direction",
     .type = MT_KEY_TEXT,
     MT_M_TO(read_directions, mt_name_list, energy.direction_names),
     .says = "Of the body's energy only that along x, y or z, or about them: rx, ry or rz. It "
             "is below 0 where the axes couple (products of inertia). Absent: the whole.",
     .schema = "\"enum\": [\"x\", \"y\", \"z\", \"rx\", \"ry\", \"rz\"]"},
    {.name = "directions",
     .type = MT_KEY_LIST,
     MT_M_TO(read_directions, mt_name_list, energy.direction_names),
     .what = "the list of directions",
     .says = "Several directions: the goal holds for each of them, with \"mode\": \"most\" "
             "each by a mode of its own."},
    MT_M_CHOICE("component", false, energy.component, int, "component", mt_energy_directions,
                "Of a bushing's energy only that of one component."),
    MT_M_REF("about", false, energy.point_name,
             "A point of the model, about which the directions are meant. Absent: the body's "
             "centre."),
    MT_M_CHOICE(
        "axes", false, energy.about.axes, mt_energy_axes, "axes", mt_energy_axes_names,
        "Along which axes: the global ones, the body's principal axes of inertia, each "
        "named after the global one next to it, or its torque roll axis, about which it "
        "begins to turn under a torque about x, y or z, in the place of that one.",
        .otherwise = "\"global\""),
    MT_S_NUMBER("at_least_percent", false, goal.at_least, ENERGY_SHARE,
                "Least share [%], from 0 to 100."),
    MT_S_NUMBER("at_most_percent", false, goal.at_most, ENERGY_SHARE,
                "Greatest share [%], from 0 to 100."),
};
#undef THIS

const mt_key_table mt_goal_energy_keys = {
    .what = "goal_energy",
    .keys = ENERGY,
    .n = MT_COUNT(ENERGY),
    .check = energy_check,
    .finish = energy_finish,
    .says = "The share of a mode's energy that a body has in a direction, or a spring: how far "
            "modes are decoupled. No proof covers it.",
    .examples = "[{\"type\": \"energy\", \"mode\": \"most\", \"body\": \"engine\", "
                "\"directions\": [\"x\", \"y\", \"z\", \"rx\", \"ry\", \"rz\"], "
                "\"at_least_percent\": 85}]",
    .rules = "\"not\": {\"anyOf\": [{\"required\": [\"configuration\", \"configurations\"]}, "
             "{\"required\": [\"direction\", \"directions\"]}]}, \"oneOf\": [{\"required\": "
             "[\"body\"]}, {\"required\": [\"spring\"]}], \"anyOf\": [{\"required\": "
             "[\"at_least_percent\"]}, {\"required\": [\"at_most_percent\"]}], "
             "\"dependencies\": {\"direction\": [\"body\"], \"directions\": [\"body\"], "
             "\"about\": [\"body\"], \"axes\": [\"body\"], \"component\": [\"spring\"]}"};

/* Checks */

/* The record of that name, each of which begins with its own; MT_ABSENT, noted. */
static int find_name(mt_study_check *c, mt_name name, const char *what, const void *records,
                     int n, size_t size)
{
    for (int i = 0; i < n; i++) {
        const mt_name *const own =
            (const mt_name *)(const void *)((const char *)records + ((size_t)i * size));
        if (strcmp(own->s, name.s) == 0) {
            return i;
        }
    }
    mt_check_unknown_name(c, name, what, records, n, size);
    return MT_ABSENT;
}

static void check_presence(mt_study_check *c, const mt_goal *goal, const mt_presence *in,
                           mt_name name)
{
    for (int i = 0; i < goal->n_configurations; i++) {
        const int at = goal->configurations[i];
        if (at != MT_ABSENT && !mt_model_present(in, at)) {
            mt_diag_error(c->diags, name.addr, "\"%s\" is not in configuration \"%s\"", name.s,
                          c->model->configurations[at].name.s);
        }
    }
}

/* The bodies and then the links of the model, or its springs, links and then the bearings of
 * joints that yield, "NAME.bearing", by name. */
static int list_names(mt_study_check *c, bool springs, mt_name **out)
{
    const mt_model *const m = c->model;
    mt_arena *const mem = &c->study->mem;
    const int own = springs ? m->n_springs : m->n_bodies;
    const size_t most = (size_t)own + (size_t)m->n_links + (size_t)m->n_joints;
    int n = 0;
    mt_name *const names = mt_arena_alloc(mem, most, sizeof *names);
    for (int i = 0; i < own && names != NULL; i++) {
        names[n++] = springs ? m->springs[i].name : m->bodies[i].name;
    }
    for (int i = 0; i < m->n_links && names != NULL; i++) {
        names[n++] = m->links[i].name;
    }
    for (int i = 0; i < m->n_joints && springs && names != NULL; i++) {
        const mt_joint *const joint = &m->joints[i];
        const char *const bearing = joint->compliance == NULL
                                        ? NULL
                                        : mt_arena_printf(mem, "%s.bearing", joint->name.s);
        if (bearing != NULL) {
            names[n++] = (mt_name){.s = bearing, .addr = joint->name.addr};
        }
    }
    *out = names;
    return n;
}

/* The joint whose bearing has this name. */
static const mt_joint *bearing_of(const mt_model *m, const char *name)
{
    static const char bearing[] = ".bearing";
    for (int i = 0; i < m->n_joints; i++) {
        const char *const own = m->joints[i].name.s;
        const size_t length = strlen(own);
        if (strncmp(own, name, length) == 0 && strcmp(name + length, bearing) == 0) {
            return &m->joints[i];
        }
    }
    return NULL;
}

static void check_directions(mt_study_check *c, mt_energy_goal *e, const mt_body *body)
{
    const int n = e->direction_names.count;
    e->directions = mt_arena_int(&c->study->mem, (size_t)n);
    for (int i = 0; i < n && e->directions != NULL; i++) {
        const mt_name name = e->direction_names.items[i];
        int found = MT_ABSENT;
        for (int k = 0; k < MT_ENERGY_DIRECTIONS; k++) {
            found = strcmp(mt_energy_directions[k], name.s) == 0 ? k : found;
        }
        const bool across = found == 2 || found == 3 || found == 4;
        if (found == MT_ABSENT) {
            mt_diag_error(c->diags, name.addr,
                          "unknown direction \"%s\" (known: x, y, z, rx, ry, rz)", name.s);
        } else if (c->model->dimension == 2 && across) {
            mt_diag_error(c->diags, name.addr,
                          "nothing moves along or about \"%s\" in the plane: x, y or rz",
                          name.s);
        } else if (body != NULL && body->point_mass && found >= 3) {
            mt_diag_error(c->diags, name.addr,
                          "\"%s\" is a point mass and has no rotation: x, y or z",
                          body->name.s);
        }
        for (int k = 0; k < i; k++) {
            if (found != MT_ABSENT && e->directions[k] == found) {
                mt_diag_error(c->diags, name.addr, "\"%s\" is named already", name.s);
            }
        }
        e->directions[i] = found;
    }
    e->n_directions = n;
}

static void check_body(mt_study_check *c, const mt_goal *goal, mt_energy_goal *e)
{
    const mt_model *const m = c->model;
    mt_name *names = NULL;
    if (strcmp(e->body_name.s, "ground") == 0) {
        mt_diag_error(c->diags, e->body_name.addr,
                      "the ground does not move and has no kinetic energy");
        return;
    }
    const int n = list_names(c, false, &names);
    const int at = find_name(c, e->body_name, "body or link", names, n, sizeof *names);
    if (at == MT_ABSENT) {
        return;
    }
    const bool link = at >= m->n_bodies;
    check_presence(c, goal, link ? &m->links[at - m->n_bodies].in : &m->bodies[at].in,
                   e->body_name);
    check_directions(c, e, link ? NULL : &m->bodies[at]);
    if (e->point_name.s != NULL) {
        e->about.point =
            find_name(c, e->point_name, "point", m->points, m->n_points, sizeof *m->points);
    }
    if (link && (e->point_name.s != NULL || e->about.axes != MT_ENERGY_AXES_GLOBAL)) {
        mt_diag_error(c->diags, e->body_name.addr,
                      "\"%s\" is a link: its parts move about their own centres along global "
                      "axes, without \"about\" and \"axes\"",
                      e->body_name.s);
    }
}

static void check_spring(mt_study_check *c, const mt_goal *goal, const mt_energy_goal *e)
{
    const mt_model *const m = c->model;
    mt_name *names = NULL;
    const int n = list_names(c, true, &names);
    const int at = find_name(c, e->spring_name, "spring or link", names, n, sizeof *names);
    if (at == MT_ABSENT) {
        return;
    }
    const mt_spring *const spring = at < m->n_springs ? &m->springs[at] : NULL;
    const mt_joint *const joint =
        at < m->n_springs + m->n_links ? NULL : bearing_of(m, e->spring_name.s);
    if (joint != NULL) {
        check_presence(c, goal, &joint->in, e->spring_name);
        return;
    }
    check_presence(c, goal, spring != NULL ? &spring->in : &m->links[at - m->n_springs].in,
                   e->spring_name);
    if (spring != NULL && spring->damper) {
        mt_diag_error(c->diags, e->spring_name.addr,
                      "\"%s\" is a damper, which has no strain energy", spring->name.s);
    }
    if (e->component != MT_ABSENT && (spring == NULL || spring->type != MT_SPRING_BUSHING)) {
        mt_diag_error(c->diags, mt_diag_member(c->diags, goal->addr, "component"),
                      "only a bushing has components, and \"%s\" is none", e->spring_name.s);
    }
}

void mt_study_check_energy(mt_study_check *c, mt_goal *goal)
{
    mt_energy_goal *const e = goal->energy;
    const bool least = mt_check_given(c, goal->at_least, goal->addr, "at_least_percent");
    const bool most = mt_check_given(c, goal->at_most, goal->addr, "at_most_percent");
    if (e == NULL || c->model == NULL) {
        return; /* memory is out, or there is no model */
    }
    e->most = goal->mode.mode_name.s != NULL && strcmp(goal->mode.mode_name.s, MOST) == 0 &&
              mt_model_find_mode(c->model, MOST) == MT_ABSENT;
    if (e->body_name.s != NULL) {
        check_body(c, goal, e);
    } else if (e->spring_name.s != NULL) {
        check_spring(c, goal, e);
    }
    if (!least && !most) {
        mt_diag_error(c->diags, goal->addr,
                      "the goal demands nothing: give \"at_least_percent\" or "
                      "\"at_most_percent\"");
    }
    if (goal->at_least >= goal->at_most) {
        mt_diag_error(c->diags, mt_diag_member(c->diags, goal->addr, "at_most_percent"),
                      "at_most_percent (%g) is not above at_least_percent (%g)", goal->at_most,
                      goal->at_least);
    }
}
