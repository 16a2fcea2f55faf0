/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The conventions of the model's schema, said of this model's numbers. The coordinate q of a
 * joint is how far its second body stands from the first, about the axis (right-handed; in two
 * dimensions counter-clockwise) or along it; a spring there has the energy
 * k (q - free)^2 / 2 + preload q, so that it acts with -k (q - free) - preload on the second
 * body.
 */
#include "cli/conventions.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>

#include "model/joint.h"

/* So many lines tell people what is meant; a large model repeats itself. */
enum { MOST_LINES = 24 };

typedef struct writer {
    const mt_model *m;
    int configuration;
    const double *value;
    mt_convention_list *out;
} writer;

/* A number that is given and not 0. */
static bool has_nonzero_value(const writer *w, mt_num num, double *v)
{
    *v = num == MT_ABSENT ? 0.0 : w->value[num];
    return *v != 0.0;
}

/* What a joint or hinge, or two bodies, are called; the second body moves against the first. */
typedef struct pair {
    const char *first;
    const char *second;
} pair;

static pair pair_of(const writer *w, int joint, const mt_attach *bodies)
{
    const mt_attach *const of = joint >= 0 ? w->m->joints[joint].bodies : bodies;
    const char *const first = of == NULL ? NULL : of[0].name.s;
    const char *const second = of == NULL ? NULL : of[1].name.s;
    return (pair){first == NULL ? "the element before" : first,
                  second == NULL ? "the element behind" : second};
}

/* Which member of which item a sentence is about, whose value it is, and between which bodies
 * it acts. */
typedef struct subject {
    const char *list; /* "springs", with index -1 the whole pointer */
    int index;
    const char *member; /* "preload_n_m" */
    double value;
    pair of;
} subject;

static void add_convention(writer *w, const subject *s, const char *fmt, ...) MT_PRINTF(3, 4);
static void add_convention(writer *w, const subject *s, const char *fmt, ...)
{
    mt_convention_list *const out = w->out;
    va_list args;
    va_start(args, fmt);
    const char *const text = mt_arena_vprintf(out->mem, fmt, args);
    va_end(args);
    mt_convention *const items =
        mt_arena_grow(out->mem, out->items, out->n, &out->capacity, sizeof *items);
    if (items == NULL) {
        return;
    }
    items[out->n++] = (mt_convention){
        .pointer = s->index < 0 ? s->list
                                : mt_arena_printf(out->mem, "/%s/%d%s%s", s->list, s->index,
                                                  s->member == NULL ? "" : "/",
                                                  s->member == NULL ? "" : s->member),
        .value = s->value,
        .first = s->of.first,
        .second = s->of.second,
        .text = text,
    };
    out->items = items;
}

static const char *about(const writer *w)
{
    return w->m->dimension == 2 ? "clockwise" : "against the axis";
}

static const char *rotation_sense(const writer *w)
{
    return w->m->dimension == 2 ? "counter-clockwise" : "about the axis";
}

static void write_products(writer *w)
{
    static const char *const names[] = {"xy", "xz", "yz"};
    static const char *const members[] = {"inertia_kg_m2/3", "inertia_kg_m2/4",
                                          "inertia_kg_m2/5"};
    for (int i = 0; i < w->m->n_bodies; i++) {
        const mt_body *const b = &w->m->bodies[i];
        const char *text = "";
        double v = 0.0;
        subject first = {.list = "bodies", .index = i, .member = NULL};
        if (!mt_model_present(&b->in, w->configuration) || w->m->dimension == 2) {
            continue;
        }
        for (int k = 0; k < 3 && text != NULL; k++) {
            if (has_nonzero_value(w, b->inertia[3 + k], &v)) {
                text = mt_arena_printf(w->out->mem, "%s %s %g", text, names[k], v);
                first.value = first.member == NULL ? v : first.value;
                first.member = first.member == NULL ? members[k] : first.member;
            }
        }
        if (text != NULL && *text != '\0') {
            add_convention(
                w, &first,
                "body \"%s\": inertia%s: elements of the tensor, minus the integrals of x y, x "
                "z, y z over the mass (a CAD system's positive integrals change sign)",
                b->name.s, text);
        }
    }
}

/* A member of spring number i of the model, of those of the file's list. */
static subject of_spring(const writer *w, const mt_spring *s, const char *member, double value,
                         pair of)
{
    int index = 0;
    for (const mt_spring *k = w->m->springs; k < s; k++) {
        index += k->damper == s->damper ? 1 : 0;
    }
    return (subject){s->damper ? "dampers" : "springs", index, member, value, of};
}

static void write_torsion(writer *w, const mt_spring *s)
{
    const pair of = pair_of(w, s->joint, s->bodies);
    double v = 0.0;
    if (has_nonzero_value(w, s->preload, &v)) {
        const subject at = of_spring(w, s, "preload_n_m", v, of);
        add_convention(
            w, &at, "spring \"%s\": preload_n_m %g turns \"%s\" against \"%s\" %s, as drawn",
            s->name.s, v, of.second, of.first, v > 0.0 ? about(w) : rotation_sense(w));
    }
    if (has_nonzero_value(w, s->free_angle, &v)) {
        const subject at = of_spring(w, s, "free_angle_rad", v, of);
        add_convention(
            w, &at,
            "spring \"%s\": no torque where \"%s\" is turned by %g rad %s against \"%s\", from "
            "the drawing",
            s->name.s, of.second, fabs(v), v > 0.0 ? rotation_sense(w) : about(w), of.first);
    }
}

static void write_axial(writer *w, const mt_spring *s)
{
    const pair of = pair_of(w, s->joint, s->bodies);
    double v = 0.0;
    if (!has_nonzero_value(w, s->preload, &v)) {
        return;
    }
    const subject at = of_spring(w, s, "preload_n", v, of);
    if (s->joint_name.s != NULL) {
        add_convention(w, &at,
                       "spring \"%s\": preload_n %g pushes \"%s\" %s the axis of \"%s\"",
                       s->name.s, v, of.second, v > 0.0 ? "against" : "along", s->joint_name.s);
    } else {
        add_convention(w, &at, "spring \"%s\": preload_n %g is %s: it %s", s->name.s, v,
                       v > 0.0 ? "tension" : "compression",
                       v > 0.0 ? "draws its two points together"
                               : "pushes its two points apart");
    }
}

static void write_bushing(writer *w, const mt_spring *s)
{
    const pair of = pair_of(w, MT_ABSENT, s->bodies);
    const subject at = of_spring(w, s, s->n_at > 0 ? "at" : NULL, nan(""), of);
    add_convention(
        w, &at,
        "%s \"%s\": along the drawing's x, y%s, carried by \"%s\"; about %s of \"%s\", where "
        "its forces act on both",
        s->damper ? "damper" : "spring", s->name.s, w->m->dimension == 2 ? "" : ", z", of.first,
        s->n_at > 0 ? "the point" : "the centre", of.second);
}

static void write_springs(writer *w)
{
    for (int i = 0; i < w->m->n_springs; i++) {
        const mt_spring *const s = &w->m->springs[i];
        if (!mt_model_present(&s->in, w->configuration)) {
            continue;
        }
        switch (s->type) {
        case MT_SPRING_TORSION:
            write_torsion(w, s);
            break;
        case MT_SPRING_AXIAL:
        case MT_SPRING_BAR:
            write_axial(w, s);
            break;
        case MT_SPRING_BUSHING:
            write_bushing(w, s);
            break;
        case MT_SPRING_TYPE_COUNT:
            break;
        }
    }
}

static void write_gears(writer *w)
{
    for (int i = 0; i < w->m->n_joints; i++) {
        const mt_joint *const j = &w->m->joints[i];
        double v = 0.0;
        if (!mt_model_present(&j->in, w->configuration)) {
            continue;
        }
        if (has_nonzero_value(w, j->ratio, &v)) {
            const subject at = {
                "joints", i, "ratio", v, {j->gear_joints[0].s, j->gear_joints[1].s}};
            add_convention(
                w, &at,
                "gear \"%s\": \"%s\" turns %g times as far as \"%s\", each about its own axis",
                j->name.s, j->gear_joints[1].s, v, j->gear_joints[0].s);
        }
        if (has_nonzero_value(w, j->ratio_m_per_rad, &v)) {
            const subject at = {
                "joints", i, "ratio_m_per_rad", v, {j->gear_joints[0].s, j->gear_joints[1].s}};
            add_convention(
                w, &at,
                "rack \"%s\": \"%s\" slides by %g m along its axis when \"%s\" turns by 1 rad",
                j->name.s, j->gear_joints[1].s, v, j->gear_joints[0].s);
        }
    }
}

static void write_load(writer *w, int i)
{
    const mt_load *const load = &w->m->loads[i];
    double v = 0.0;
    const bool on_joint = load->joint_name.s != NULL;
    const pair of =
        on_joint ? pair_of(w, load->joint, NULL) : (pair){"ground", load->on.name.s};
    if (load->has_moment && has_nonzero_value(w, load->moment, &v)) {
        const subject at = {"loads", i, "moment_n_m", v, of};
        add_convention(w, &at, "load \"%s\": moment_n_m %g turns \"%s\" %s%s%s%s", load->name.s,
                       v, of.second, v > 0.0 ? rotation_sense(w) : about(w),
                       on_joint ? ", and \"" : "", on_joint ? of.first : "",
                       on_joint ? "\" the other way" : "");
    } else if (load->has_force && on_joint && has_nonzero_value(w, load->force[0], &v)) {
        const subject at = {"loads", i, "force_n", v, of};
        add_convention(
            w, &at,
            "load \"%s\": force_n %g pushes \"%s\" %s the axis, and \"%s\" the other way",
            load->name.s, v, of.second, v > 0.0 ? "along" : "against", of.first);
    }
}

static void write_loads(writer *w)
{
    for (int i = 0; i < w->m->n_loads; i++) {
        if (mt_model_present(&w->m->loads[i].in, w->configuration)) {
            write_load(w, i);
        }
    }
}

static void write_sections(writer *w)
{
    const char *const axis = w->m->dimension == 2 ? "z, out of the plane" : "its hinge axis";
    for (int i = 0; i < w->m->n_links; i++) {
        const mt_link *const l = &w->m->links[i];
        const bool rectangle = l->section.shape == MT_SECTION_RECTANGLE;
        if (!mt_model_present(&l->in, w->configuration) ||
            (!rectangle && l->section.shape != MT_SECTION_GENERAL)) {
            continue;
        }
        const subject at = {.list = "links", .index = i, .member = "section", .value = nan("")};
        add_convention(w, &at,
                       rectangle ? "link \"%s\": width_m is along %s, height_m across it"
                                 : "link \"%s\": second_moment_m4 is for bending about %s",
                       l->name.s, axis);
    }
}

static void write_drive(writer *w)
{
    const mt_drive *const d = &w->m->configurations[w->configuration].drive;
    double v = 0.0;
    if (!d->given || d->joint == MT_ABSENT || !has_nonzero_value(w, d->position, &v)) {
        return;
    }
    const pair of = pair_of(w, d->joint, NULL);
    const char *const way = d->position_is_angle ? v > 0.0 ? rotation_sense(w) : about(w)
                            : v > 0.0 ? "along the axis"
                                                 : "against the axis";
    const mt_configuration *owner = &w->m->configurations[w->configuration];
    while (owner->drive.inherited && owner->like != MT_ABSENT) {
        owner = &w->m->configurations[owner->like];
    }
    const subject at = {mt_arena_printf(w->out->mem, "/configurations/%s/drive/%s",
                                        owner->name.s,
                                        d->position_is_angle ? "position_rad" : "position_m"),
                        -1, NULL, v, of};
    add_convention(w, &at, "drive: \"%s\" stands %g %s %s against \"%s\", from the drawing",
                   of.second, fabs(v), d->position_is_angle ? "rad" : "m", way, of.first);
}

void mt_cli_find_conventions(const mt_model *model, int configuration, const double *value,
                             mt_convention_list *out)
{
    writer w = {.m = model, .configuration = configuration, .value = value, .out = out};
    write_drive(&w);
    write_products(&w);
    write_sections(&w);
    write_gears(&w);
    write_springs(&w);
    write_loads(&w);
}

void mt_cli_print_conventions(const mt_convention_list *list, mt_text *out)
{
    for (int i = 0; i < list->n && i < MOST_LINES; i++) {
        mt_text_add(out, i == 0 ? "  conventions\n" : "");
        mt_text_addf(out, "    %s\n", list->items[i].text);
    }
    if (list->n > MOST_LINES) {
        mt_text_addf(out, "    and %d more of these kinds\n", list->n - MOST_LINES);
    }
}

void mt_cli_json_conventions(mt_json_writer *w, const mt_convention_list *list)
{
    mt_json_open(w, "conventions", '[');
    for (int i = 0; i < list->n; i++) {
        const mt_convention *const c = &list->items[i];
        mt_json_open_flat(w, NULL, '{');
        mt_json_put_string(w, "pointer", c->pointer);
        mt_json_put_number(w, "value", c->value);
        mt_json_put_string(w, "first", c->first);
        mt_json_put_string(w, "second", c->second);
        mt_json_put_string(w, "text", c->text);
        mt_json_close(w);
    }
    mt_json_close(w);
}
