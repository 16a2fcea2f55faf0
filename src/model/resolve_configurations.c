/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Configurations: `like`, what is inherited through it (overrides, gravity, drive), and which
 * items each contains. */
#include "model/resolve_priv.h"

#include <string.h>

#include "model/joint.h"

enum { UNSEEN, ON_PATH, DONE };

/* "a -> b -> a": from configuration c along `like` back to c. */
static void note_like_cycle(mt_resolve *f, int c)
{
    const mt_configuration *const all = f->m->configurations;
    mt_resolve_ring ring = {.first = all[c].name.s};
    for (int at = all[c].like; at != c; at = all[at].like) {
        mt_resolve_ring_add(&ring, all[at].name.s);
    }
    mt_resolve_ring_end(&ring);
    mt_diag_error(f->d, all[c].like_name.addr,
                  "configurations are like each other in a circle: %s", ring.text);
}

/* Walk along `like` from c; a walk that meets itself is cut there. state [n_configurations]. */
static void check_like(mt_resolve *f, int c, int *state)
{
    mt_configuration *const all = f->m->configurations;
    int at = c;
    while (at != MT_ABSENT && state[at] == UNSEEN) {
        state[at] = ON_PATH;
        at = all[at].like;
    }
    const int again = at != MT_ABSENT && state[at] == ON_PATH ? at : MT_ABSENT;
    for (at = c; at != MT_ABSENT && state[at] == ON_PATH; at = all[at].like) {
        state[at] = DONE;
    }
    if (again != MT_ABSENT) {
        note_like_cycle(f, again);
        all[again].like = MT_ABSENT;
    }
}

/* order[n_configurations]: all configurations, each after the one that it is like. chain
 * [n_configurations] is work; state [n_configurations] is 0 on entry. */
static void find_order(mt_resolve *f, int *chain, int *state)
{
    const int n = f->m->n_configurations;
    int done = 0;
    for (int c = 0; c < n; c++) {
        int depth = 0;
        for (int at = c; at != MT_ABSENT && state[at] == UNSEEN;
             at = f->m->configurations[at].like) {
            state[at] = DONE;
            chain[depth++] = at;
        }
        while (depth > 0) {
            f->order[done++] = chain[--depth];
        }
    }
}

/* Own overrides first, then inherited ones that are not overridden. overridden [n_parameters]
 * is false before and after. */
static void inherit_overrides(mt_resolve *f, mt_configuration *c, bool *overridden)
{
    const mt_configuration *const parent = &f->m->configurations[c->like];
    const int own = c->n_overrides;
    if (parent->n_overrides == 0) {
        return;
    }
    mt_override *const all =
        mt_arena_alloc(&f->m->mem, (size_t)own + (size_t)parent->n_overrides, sizeof *all);
    if (all == NULL) {
        return;
    }
    if (own > 0) {
        memcpy(all, c->overrides, (size_t)own * sizeof *all);
    }
    c->overrides = all;
    for (int i = 0; i < own; i++) {
        if (all[i].parameter != MT_ABSENT) {
            overridden[all[i].parameter] = true;
        }
    }
    for (int i = 0; i < parent->n_overrides; i++) {
        const int parameter = parent->overrides[i].parameter;
        if (parameter == MT_ABSENT || !overridden[parameter]) {
            all[c->n_overrides++] = parent->overrides[i];
        }
    }
    for (int i = 0; i < own; i++) {
        if (all[i].parameter != MT_ABSENT) {
            overridden[all[i].parameter] = false;
        }
    }
}

/* The configuration that defines the drive in force in this one. */
static const mt_configuration *driver_of(const mt_resolve *f, const mt_configuration *c)
{
    while (c->drive.inherited) {
        c = &f->m->configurations[c->like];
    }
    return c;
}

/* A configuration has one drive: its own replaces an inherited one of the same joint. A drive
 * of another joint would release the joint that the inherited drive holds. */
static void check_dropped_drive(mt_resolve *f, const mt_configuration *c,
                                const mt_configuration *parent)
{
    const mt_drive *const own = &c->drive;
    const mt_drive *const other = &parent->drive;
    if (!own->given || !other->given || own->joint_name.s == NULL ||
        other->joint_name.s == NULL) {
        return;
    }
    const char *const from = driver_of(f, parent)->name.s;
    if (strcmp(own->joint_name.s, other->joint_name.s) != 0) {
        mt_diag_error(f->d, own->addr,
                      "drops the inherited drive of %s: \"%s\" drives joint \"%s\", this one "
                      "\"%s\", and a configuration has one drive; \"like\" must name a "
                      "configuration without a drive, or one that drives \"%s\"",
                      other->joint_name.s, from, other->joint_name.s, own->joint_name.s,
                      own->joint_name.s);
    }
}

/* Settings in force: own, else those of the configuration it is like, else the model's. */
static void inherit(mt_resolve *f, mt_configuration *c, bool *overridden)
{
    const mt_configuration *const parent =
        c->like == MT_ABSENT ? NULL : &f->m->configurations[c->like];
    for (int i = 0; i < c->n_overrides; i++) {
        mt_override *const o = &c->overrides[i];
        o->parameter =
            mt_resolve_find(f, o->parameter_name, &f->m->tables->parameters, "parameter");
    }
    if (parent != NULL) {
        inherit_overrides(f, c, overridden);
    }
    const bool model_has = parent == NULL && f->m->has_gravity;
    if (!c->has_gravity && (model_has || (parent != NULL && parent->has_gravity))) {
        c->has_gravity = true;
        memcpy(c->gravity, model_has ? f->m->gravity : parent->gravity, sizeof c->gravity);
    }
    if (parent != NULL) {
        check_dropped_drive(f, c, parent);
    }
    if (!c->drive.given && parent != NULL) {
        c->drive = parent->drive;
        c->drive.inherited = true;
    }
    if (!c->damping.given) {
        c->damping = parent != NULL ? parent->damping : f->m->damping;
        c->damping.inherited = true;
    }
}

void mt_resolve_configurations(mt_resolve *f)
{
    mt_model *const m = f->m;
    const size_t n = (size_t)m->n_configurations;
    int *const walked = mt_arena_int(&m->mem, n);
    int *const state = mt_arena_int(&m->mem, n);
    int *const chain = mt_arena_int(&m->mem, n);
    bool *const overridden =
        mt_arena_alloc(&m->mem, (size_t)m->n_parameters, sizeof *overridden);
    f->order = mt_arena_int(&m->mem, n);
    if (mt_arena_failed(&m->mem)) {
        return;
    }
    for (int i = 0; i < m->n_modes; i++) {
        mt_named_mode *const mode = &m->modes[i];
        mode->configuration = mt_resolve_find(f, mode->configuration_name,
                                              &m->tables->configurations, "configuration");
    }
    for (int c = 0; c < m->n_configurations; c++) {
        mt_configuration *const it = &m->configurations[c];
        it->like =
            mt_resolve_find(f, it->like_name, &m->tables->configurations, "configuration");
    }
    for (int c = 0; c < m->n_configurations; c++) {
        check_like(f, c, walked);
    }
    find_order(f, chain, state);
    mt_resolve_damping(f);
    for (int i = 0; i < m->n_configurations; i++) {
        inherit(f, &m->configurations[f->order[i]], overridden);
    }
}

/* present[c]: c is named, or the configuration that c is like contains the item. */
static void resolve_presence(mt_resolve *f, mt_presence *in)
{
    mt_model *const m = f->m;
    if (!in->given) {
        return;
    }
    bool *const present = mt_arena_alloc(&m->mem, (size_t)m->n_configurations, sizeof *present);
    if (present == NULL) {
        return;
    }
    for (int i = 0; i < in->names.count; i++) {
        const int c =
            mt_resolve_find(f, in->names.items[i], &m->tables->configurations, "configuration");
        if (c != MT_ABSENT) {
            present[c] = true;
        }
    }
    for (int i = 0; i < m->n_configurations; i++) {
        const int c = f->order[i];
        const int like = m->configurations[c].like;
        present[c] = present[c] || (like != MT_ABSENT && present[like]);
    }
    in->present = present;
}

void mt_resolve_presence(mt_resolve *f)
{
    mt_model *const m = f->m;
    for (int i = 0; i < m->n_bodies; i++) {
        resolve_presence(f, &m->bodies[i].in);
    }
    for (int i = 0; i < m->n_links; i++) {
        resolve_presence(f, &m->links[i].in);
    }
    for (int i = 0; i < m->n_joints; i++) {
        resolve_presence(f, &m->joints[i].in);
    }
    for (int i = 0; i < m->n_springs; i++) {
        resolve_presence(f, &m->springs[i].in);
    }
    for (int i = 0; i < m->n_loads; i++) {
        resolve_presence(f, &m->loads[i].in);
    }
}

void mt_resolve_needs(mt_resolve *f, mt_name item, const char *what, const mt_presence *in,
                      const mt_presence *part, const char *part_what, const char *part_name)
{
    for (int c = 0; c < f->m->n_configurations; c++) {
        if (mt_model_present(in, c) && !mt_model_present(part, c)) {
            mt_diag_error(f->d, item.addr,
                          "%s \"%s\" is in configuration \"%s\", but its %s \"%s\" is not",
                          what, item.s, f->m->configurations[c].name.s, part_what, part_name);
            return; /* one configuration is enough to say so */
        }
    }
}

/* The drive in force names a joint that the configuration contains and can move, and a spring
 * that it contains. */
static void check_drive(mt_resolve *f, int index)
{
    mt_model *const m = f->m;
    mt_configuration *const c = &m->configurations[index];
    mt_drive *const drive = &c->drive;
    const bool inherited = drive->inherited; /* unknown names have been noted where it stands */
    if (!drive->given) {
        return;
    }
    drive->joint = inherited
                       ? mt_model_find_joint(m, drive->joint_name.s)
                       : mt_resolve_find(f, drive->joint_name, &m->tables->joints, "joint");
    drive->trim_spring =
        !drive->trim ? MT_ABSENT
        : inherited  ? mt_model_find_spring(m, drive->trim_name.s)
                     : mt_resolve_find(f, drive->trim_name, &m->tables->springs, "spring");
    if (drive->joint != MT_ABSENT && !mt_model_present(&m->joints[drive->joint].in, index)) {
        mt_diag_error(f->d, drive->addr,
                      "configuration \"%s\" drives joint \"%s\", which it does not contain",
                      c->name.s, drive->joint_name.s);
    }
    if (drive->trim_spring != MT_ABSENT) {
        const mt_spring *const spring = &m->springs[drive->trim_spring];
        if (spring->damper) {
            mt_diag_error(f->d, drive->trim_name.addr,
                          "\"%s\" is a damper: only a spring holds a position", spring->name.s);
        } else if (!mt_model_present(&spring->in, index)) {
            mt_diag_error(f->d, drive->addr,
                          "configuration \"%s\" trims spring \"%s\", which it does not contain",
                          c->name.s, spring->name.s);
        }
    }
}

/* position_rad for a joint that turns, position_m for one that slides. */
static void check_drive_unit(mt_resolve *f, const mt_drive *drive)
{
    const mt_joint *const joint = &f->m->joints[drive->joint];
    if (joint->type == MT_JOINT_TYPE_COUNT) {
        return;
    }
    const mt_coordinate coordinate = mt_joint_kind_of(joint->type)->coordinate;
    if (coordinate == MT_COORDINATE_NONE) {
        mt_diag_error(f->d, drive->joint_name.addr, "%s %s joint cannot be driven",
                      mt_joint_article(joint->type), mt_joint_type_name(joint->type));
    } else if (drive->position != MT_ABSENT &&
               drive->position_is_angle != (coordinate == MT_COORDINATE_ANGLE)) {
        mt_diag_error(f->d, mt_resolve_addr(f->m, drive->position),
                      "the position of a %s joint is given as \"%s\"",
                      mt_joint_type_name(joint->type),
                      coordinate == MT_COORDINATE_ANGLE ? "position_rad" : "position_m");
    }
}

void mt_resolve_drives(mt_resolve *f)
{
    for (int c = 0; c < f->m->n_configurations; c++) {
        const mt_configuration *const it = &f->m->configurations[c];
        check_drive(f, c);
        if (it->drive.given && !it->drive.inherited && it->drive.joint != MT_ABSENT) {
            check_drive_unit(f, &it->drive);
        }
    }
}
