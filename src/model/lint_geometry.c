/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The drawing of a configuration, judged: joints and springs off what they hold, pairs of
 * points that only closing brings together, sizes. With a segment P + s d, 0 <= s <= 1, the
 * distance of a point X is |X - P - clamp(d . (X - P) / d . d) d|.
 */
#include "model/lint_priv.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>

#include "model/joint.h"

/* A joint this part of a link's length away from it is told: less is a drawing's rounding. */
static const double TOLD_OFF = 0.01;
/* A joint farther from its link than the link is long is hardly meant to hold it. Of a body
 * with its joint on one end and all else at the other, as the long arm of a short pendulum, the
 * rest may be narrow: inches for millimetres make 25 of it, centimetres for metres 100. */
static const double DOUBTED_OFF = 1.0;
static const double DOUBTED_OFF_BODY = 20.0;
/* A pair of points so far apart, in parts of the drawing's size, is told; so far, doubted, or a
 * metre. */
static const double TOLD_GAP = 1e-3;
static const double DOUBTED_GAP = 0.1;
static const double DOUBTED_GAP_M = 1.0;
/* m: the box around a mechanism; the smallest micromachines have some 1e-6. A stick of half a
 * metre in millimetres has 500, as a large ship: what tells them apart is the mass in the cube
 * around them [kg/m^3], a ship's 1, a wind turbine's 1e-2, a bridge's 1e-3, and 1e-8 of a stick
 * of 2 kg that is 500 m wide. */
static const double MOST_SIZE_M = 300.0;
static const double LEAST_SIZE_M = 1e-8;
static const double LEAST_FILLED = 1e-4;
/* A section so many times thicker than its link is long is written in millimetres. */
static const double MOST_STOUT = 10.0;
/* Radius of gyration in largest distances of the body's points: a rod's is 0.3 of its length;
 * kg mm^2 for kg m^2 makes it a thousand times too large, g cm^2 three thousand. Of a body with
 * one point, as a rotor, in sizes of the drawing; inertias that a gear multiplies stay
 * below. */
static const double MOST_GYRATION = 3.0;
static const double MOST_ALONE = 30.0;
/* A drive along a line, in sizes of the drawing: a stroke is a part of the mechanism. */
static const double MOST_STROKE = 3.0;
/* Points of bodies are compared with all others: in models of more joints and springs that
 * would cost more than it tells. */
enum { MOST_COMPARED = 2000 };

typedef struct box {
    double low[3];
    double high[3];
    int n;
} box;

typedef struct segment {
    double a[3];
    double b[3];
    double whole; /* length of the link that it is a part of */
    bool known;
} segment;

static double distance(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

bool mt_lint_position(const mt_lint *j, const mt_position *p, double x[3])
{
    const mt_num *const own = p->point >= 0 ? j->model->points[p->point].x : p->x;
    bool known = true;
    for (int k = 0; k < 3; k++) {
        x[k] = own[k] == MT_ABSENT ? 0.0 : j->value[own[k]];
        known = known && isfinite(x[k]);
    }
    return known && own[0] != MT_ABSENT;
}

/* The address of the first number of a position, for messages. */
static mt_addr addr_of(const mt_position *p)
{
    return p->addr;
}

static void include_position(const mt_lint *j, box *b, const mt_position *p)
{
    double x[3];
    if (!mt_lint_position(j, p, x)) {
        return;
    }
    for (int k = 0; k < 3; k++) {
        b->low[k] = b->n == 0 ? x[k] : fmin(b->low[k], x[k]);
        b->high[k] = b->n == 0 ? x[k] : fmax(b->high[k], x[k]);
    }
    b->n++;
}

/* The points of a joint or a spring on the bodies that it holds. */
static void include_sides(const mt_lint *j, box *boxes, const mt_attach bodies[2], int n_at,
                          const mt_position at[2])
{
    for (int side = 0; side < 2 && n_at > 0; side++) {
        const mt_attach *const a = &bodies[side];
        if (a->name.s != NULL && a->kind == MT_ATTACH_BODY && a->index >= 0) {
            include_position(j, &boxes[a->index], &at[n_at == 2 ? side : 0]);
        }
    }
}

/* The box around the whole drawing except for one joint and one spring (NULL: none is left
 * out). */
static box box_without(const mt_lint *j, const mt_joint *joint, const mt_spring *spring)
{
    const mt_model *const m = j->model;
    box all = {.n = 0};
    for (int i = 0; i < m->n_bodies; i++) {
        if (mt_model_present(&m->bodies[i].in, j->configuration)) {
            include_position(j, &all, &m->bodies[i].centre);
        }
    }
    for (int i = 0; i < m->n_links; i++) {
        if (mt_model_present(&m->links[i].in, j->configuration)) {
            include_position(j, &all, &m->links[i].from);
            include_position(j, &all, &m->links[i].to);
        }
    }
    for (int i = 0; i < m->n_joints; i++) {
        const mt_joint *const at = &m->joints[i];
        for (int k = 0; at != joint && k < at->n_at; k++) {
            if (mt_model_present(&at->in, j->configuration)) {
                include_position(j, &all, &at->at[k]);
            }
        }
    }
    for (int i = 0; i < m->n_springs; i++) {
        const mt_spring *const at = &m->springs[i];
        for (int k = 0; at != spring && k < at->n_at; k++) {
            if (mt_model_present(&at->in, j->configuration)) {
                include_position(j, &all, &at->at[k]);
            }
        }
    }
    return all;
}

static double size_of_box(const box *b)
{
    return b->n == 0 ? 0.0 : distance(b->low, b->high);
}

static void point_between(const double from[3], const double to[3], double part, double out[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = from[k] + (part * (to[k] - from[k]));
    }
}

/* Length of a link's first `count` elements, in parts of the whole. */
static double part_of_whole(const mt_lint *j, const mt_link *l, int count, double whole)
{
    double sum = 0.0;
    for (int i = 0; i < count && l->n_element_length > 0 && whole > 0.0; i++) {
        sum += j->value[l->element_length[l->n_element_length == 1 ? 0 : i]] / whole;
    }
    return l->n_element_length > 0 ? sum : (double)count / (double)l->elements;
}

/* The part of a link that is attached: a rigid element, or a node. */
static segment segment_of(const mt_lint *j, const mt_attach *a)
{
    const mt_link *const l = &j->model->links[a->index];
    double from[3];
    double to[3];
    segment s = {.known =
                     mt_lint_position(j, &l->from, from) && mt_lint_position(j, &l->to, to)};
    if (!s.known || l->elements < 1) {
        s.known = false;
        return s;
    }
    const bool node = a->kind == MT_ATTACH_LINK_NODE;
    const int first = node ? a->element : a->part;
    s.whole = distance(from, to);
    point_between(from, to, part_of_whole(j, l, first, s.whole), s.a);
    point_between(
        from, to,
        part_of_whole(j, l, first + (node || l->kind == MT_LINK_BEAM ? 0 : 1), s.whole), s.b);
    return s;
}

static double distance_to(const segment *s, const double x[3])
{
    double dd = 0.0;
    double dx = 0.0;
    double nearest[3];
    for (int k = 0; k < 3; k++) {
        const double d = s->b[k] - s->a[k];
        dd += d * d;
        dx += d * (x[k] - s->a[k]);
    }
    point_between(s->a, s->b, dd > 0.0 ? fmin(fmax(dx / dd, 0.0), 1.0) : 0.0, nearest);
    return distance(nearest, x);
}

static bool is_on(const mt_attach *a, int body)
{
    return a->name.s != NULL && a->kind == MT_ATTACH_BODY && a->index == body;
}

static double nearer(const mt_lint *j, const mt_position *p, const double x[3], double least)
{
    double other[3];
    return mt_lint_position(j, p, other) ? fmin(least, distance(other, x)) : least;
}

/* The point of `at` that is body `side`'s. */
static const mt_position *side_at(int n_at, const mt_position *at, int side)
{
    return &at[n_at == 2 ? side : 0];
}

/* Distance of x from the nearest other point of the body: centre, other joints, springs,
 * sensors. Infinite: none. */
static double distance_to_body(const mt_lint *j, int body, const mt_joint *joint,
                               const mt_spring *spring, const double x[3])
{
    const mt_model *const m = j->model;
    double least = nearer(j, &m->bodies[body].centre, x, HUGE_VAL);
    for (int i = 0; i < m->n_joints; i++) {
        const mt_joint *const o = &m->joints[i];
        for (int side = 0; side < 2 && o != joint && o->n_at > 0; side++) {
            if (is_on(&o->bodies[side], body)) {
                least = nearer(j, side_at(o->n_at, o->at, side), x, least);
            }
        }
    }
    for (int i = 0; i < m->n_springs; i++) {
        const mt_spring *const o = &m->springs[i];
        for (int side = 0; side < 2 && o != spring && o->n_at > 0; side++) {
            if (is_on(&o->bodies[side], body)) {
                least = nearer(j, side_at(o->n_at, o->at, side), x, least);
            }
        }
    }
    for (int i = 0; i < m->n_sensors; i++) {
        const mt_sensor *const o = &m->sensors[i];
        if (o->on_kind == MT_ATTACH_BODY && o->on == body && o->at.given) {
            least = nearer(j, &o->at, x, least);
        }
    }
    return least;
}

typedef struct holder {
    mt_item item;
    const mt_attach *bodies;
    int n_at;
    const mt_position *at;
    const mt_joint *joint; /* one of them */
    const mt_spring *spring;
} holder;

/* What stands before and after the name of the body. */
typedef struct phrase_around {
    const char *before;
    const char *after;
} phrase_around;

static void say_off(mt_lint *j, const holder *h, int side, mt_warning_level level, double off,
                    phrase_around phrase)
{
    const mt_position *const p = side_at(h->n_at, h->at, side);
    mt_warning *const warning =
        mt_warning_add(j->out, level, "off", "%s \"%s\" lies %.4g m off %s\"%s\"%s",
                       h->item.what, h->item.name, off, phrase.before, h->bodies[side].name.s,
                       phrase.after == NULL ? "" : phrase.after);
    const char *const pointer =
        h->n_at == 2
            ? mt_arena_printf(j->out->mem, "/%s/%d/at/%d", h->item.list, h->item.index, side)
            : mt_arena_printf(j->out->mem, "/%s/%d/at", h->item.list, h->item.index);
    if (mt_lint_addr(j, warning, addr_of(p), pointer) != NULL) {
        warning->size = off;
    }
}

static void lint_side(mt_lint *j, const holder *h, int side)
{
    const mt_attach *const a = &h->bodies[side];
    double x[3];
    if (a->name.s == NULL || a->kind == MT_ATTACH_GROUND || h->n_at == 0 ||
        !mt_lint_position(j, side_at(h->n_at, h->at, side), x)) {
        return;
    }
    if (a->kind == MT_ATTACH_BODY && j->model->n_joints + j->model->n_springs > MOST_COMPARED) {
        return;
    }
    if (a->kind == MT_ATTACH_BODY) {
        const box others = box_without(j, h->joint, h->spring);
        const double off = distance_to_body(j, a->index, h->joint, h->spring, x);
        const double size = size_of_box(&others);
        if (size > 0.0 && off > DOUBTED_OFF_BODY * size && isfinite(off)) {
            say_off(
                j, h, side, MT_LEVEL_WARNING, off,
                (phrase_around){"everything else of ", ", far beyond the rest of the drawing"});
        }
        return;
    }
    const segment s = segment_of(j, a);
    const double off = s.known ? distance_to(&s, x) : 0.0;
    if (off > DOUBTED_OFF * s.whole) {
        const char *const after =
            mt_arena_printf(j->out->mem, "; the whole link is %.4g m long", s.whole);
        say_off(j, h, side, MT_LEVEL_WARNING, off, (phrase_around){"", after});
    } else if (off > TOLD_OFF * s.whole && h->joint != NULL) {
        say_off(j, h, side, MT_LEVEL_NOTE, off, (phrase_around){"", ""});
    }
}

/* Closing error of the joint in the drawn position; NaN: none. */
static double gap_of(const mt_lint *j, const mt_joint *joint)
{
    double a[3];
    double b[3];
    double d[3];
    double axis[3];
    double dot = 0.0;
    if (joint->n_at != 2 || !mt_lint_position(j, &joint->at[0], a) ||
        !mt_lint_position(j, &joint->at[1], b)) {
        return nan("");
    }
    const mt_closes closes = mt_joint_kind_of(joint->type)->closes;
    if (closes == MT_CLOSES_LENGTH) {
        return joint->length == MT_ABSENT ? nan("")
                                          : fabs(distance(a, b) - j->value[joint->length]);
    }
    if (!joint->has_axis || closes == MT_CLOSES_ALL) {
        return distance(a, b);
    }
    for (int k = 0; k < 3; k++) {
        d[k] = b[k] - a[k];
        axis[k] = joint->axis[k] == MT_ABSENT ? 0.0 : j->value[joint->axis[k]];
    }
    const double largest = fmax(fmax(fabs(axis[0]), fabs(axis[1])), fabs(axis[2]));
    if (!(largest > 0.0) || !isfinite(largest)) {
        return nan("");
    }
    const double length = hypot(hypot(axis[0] / largest, axis[1] / largest), axis[2] / largest);
    for (int k = 0; k < 3; k++) {
        axis[k] = axis[k] / largest / length; /* an axis may have any length */
        dot += d[k] * axis[k];
    }
    if (closes == MT_CLOSES_ALONG) {
        return fabs(dot);
    }
    for (int k = 0; k < 3; k++) { /* free along the axis */
        d[k] -= dot * axis[k];
    }
    return hypot(hypot(d[0], d[1]), d[2]);
}

static void lint_gap(mt_lint *j, const mt_item *item, const mt_joint *joint, double size)
{
    const double gap = gap_of(j, joint);
    if (!(gap > TOLD_GAP * size)) {
        return;
    }
    const bool far = gap > DOUBTED_GAP * size || gap > DOUBTED_GAP_M;
    mt_warning *const warning = mt_warning_add(
        j->out, far ? MT_LEVEL_WARNING : MT_LEVEL_NOTE, "gap",
        "joint \"%s\": its two points are drawn %.4g m apart; the bodies are moved until it "
        "closes",
        item->name, gap);
    if (mt_lint_addr(j, warning, addr_of(&joint->at[1]),
                     mt_arena_printf(j->out->mem, "/joints/%d/at/1", item->index)) != NULL) {
        warning->size = gap;
    }
}

/* The masses given in the model, without those from density and section. */
static double mass_of(const mt_lint *j)
{
    const mt_model *const m = j->model;
    double mass = 0.0;
    for (int i = 0; i < m->n_bodies; i++) {
        const mt_num num = m->bodies[i].mass;
        mass += num == MT_ABSENT ? 0.0 : j->value[num];
    }
    for (int i = 0; i < m->n_links; i++) {
        const mt_link *const l = &m->links[i];
        mass += l->mass == MT_ABSENT ? 0.0 : j->value[l->mass];
        for (int k = 0; k < l->n_element_mass; k++) {
            mass += j->value[l->element_mass[k]];
        }
    }
    return mass;
}

static void lint_size(mt_lint *j, double size)
{
    const bool large = size > MOST_SIZE_M && mass_of(j) / size / size / size < LEAST_FILLED;
    if (size == 0.0 || (!large && size >= LEAST_SIZE_M)) {
        return;
    }
    (void)mt_lint_addr(j,
                       mt_warning_add(j->out, MT_LEVEL_WARNING, "size",
                                      "the drawing is %.4g m wide: %s", size,
                                      large ? "are its coordinates millimetres?"
                                            : "are its coordinates metres?"),
                       MT_NO_ADDR, "/points");
}

/* A link's thickest direction against its length. */
static void lint_stout(mt_lint *j, const mt_item *item, const mt_link *l)
{
    static const char *const members[] = {"width_m", "height_m", "diameter_m"};
    const mt_num numbers[] = {l->section.width, l->section.height, l->section.diameter};
    double from[3];
    double to[3];
    if (!mt_lint_position(j, &l->from, from) || !mt_lint_position(j, &l->to, to) ||
        l->section.shape == MT_SECTION_NONE || l->section.shape == MT_SECTION_GENERAL) {
        return;
    }
    const double length = distance(from, to);
    for (int k = 0; k < MT_COUNT(numbers); k++) {
        const bool tube = k == 2 && l->section.shape == MT_SECTION_TUBE;
        const char *const member = tube ? "outer_diameter_m" : members[k];
        if (length == 0.0 || numbers[k] == MT_ABSENT ||
            !(j->value[numbers[k]] > MOST_STOUT * length)) {
            continue;
        }
        (void)mt_lint_addr(
            j,
            mt_warning_add(
                j->out, MT_LEVEL_WARNING, "section",
                "link \"%s\": section/%s (%g) is more than %g times its length (%.4g "
                "m): is it meant in millimetres?",
                item->name, member, j->value[numbers[k]], MOST_STOUT, length),
            j->model->nums[numbers[k]].addr,
            mt_arena_printf(j->out->mem, "/links/%d/section/%s", item->index, member));
    }
}

/* The box of each body's points: its centre, and where joints, springs, loads and sensors hold
 * on to it. NULL: no memory. */
static box *boxes_of_bodies(const mt_lint *j)
{
    const mt_model *const m = j->model;
    box *const boxes = mt_arena_alloc(j->out->mem, (size_t)m->n_bodies, sizeof *boxes);
    for (int i = 0; i < m->n_bodies && boxes != NULL; i++) {
        include_position(j, &boxes[i], &m->bodies[i].centre);
    }
    for (int i = 0; i < m->n_joints && boxes != NULL; i++) {
        const mt_joint *const o = &m->joints[i];
        if (mt_model_present(&o->in, j->configuration)) {
            include_sides(j, boxes, o->bodies, o->n_at, o->at);
        }
    }
    for (int i = 0; i < m->n_springs && boxes != NULL; i++) {
        const mt_spring *const o = &m->springs[i];
        if (mt_model_present(&o->in, j->configuration)) {
            include_sides(j, boxes, o->bodies, o->n_at, o->at);
        }
    }
    for (int i = 0; i < m->n_sensors && boxes != NULL; i++) {
        const mt_sensor *const o = &m->sensors[i];
        if (o->on_kind == MT_ATTACH_BODY && o->on >= 0 && o->at.given) {
            include_position(j, &boxes[o->on], &o->at);
        }
    }
    return boxes;
}

static void lint_gyration(mt_lint *j, const mt_item *item, const mt_body *b, double own,
                          double size)
{
    const double mass = b->mass == MT_ABSENT ? 0.0 : j->value[b->mass];
    double most = 0.0;
    for (int k = 0; k < (j->model->dimension == 2 ? 1 : 3) && !b->point_mass; k++) {
        most = fmax(most, b->inertia[k] == MT_ABSENT ? 0.0 : j->value[b->inertia[k]]);
    }
    const double radius = mass > 0.0 ? sqrt(most) / sqrt(mass) : 0.0;
    const char *const of = own > 0.0 ? "of a body whose points are at most" : "in a drawing";
    /* a drawing of one point: as a body of such a size is judged */
    const bool vast = radius > MOST_SIZE_M && mass / radius / radius / radius < LEAST_FILLED;
    if (own > 0.0    ? radius > MOST_GYRATION * own
        : size > 0.0 ? radius > MOST_ALONE * size
                     : vast) {
        (void)mt_lint_addr(
            j,
            mt_warning_add(j->out, MT_LEVEL_WARNING, "inertia",
                           "body \"%s\": inertia_kg_m2 (%g) and mass_kg (%g) give a radius of "
                           "gyration of %.4g m %s %.4g m %s: is it meant in kg mm^2 or g cm^2?",
                           item->name, most, mass, radius, of, own > 0.0 ? own : size,
                           own > 0.0 ? "apart" : "wide"),
            j->model->nums[b->inertia[0]].addr,
            mt_arena_printf(j->out->mem, "/bodies/%d/inertia_kg_m2", item->index));
    }
}

static void lint_stroke(mt_lint *j, double size)
{
    const mt_drive *const d = &j->model->configurations[j->configuration].drive;
    if (!d->given || d->position_is_angle || d->position == MT_ABSENT || size == 0.0 ||
        !(fabs(j->value[d->position]) > MOST_STROKE * size)) {
        return;
    }
    if (fabs(j->value[d->position]) > MT_DRIVE_REACH * size) {
        (void)mt_lint_addr(
            j,
            mt_warning_add(
                j->out, MT_LEVEL_FAULT, "drive",
                "\"%s\" is driven by %g m in a drawing %.4g m wide: at most %d times "
                "that can be",
                d->joint_name.s == NULL ? "" : d->joint_name.s, j->value[d->position], size,
                (int)MT_DRIVE_REACH),
            j->model->nums[d->position].addr, mt_lint_drive_pointer(j, "position_m"));
        return;
    }
    (void)mt_lint_addr(
        j,
        mt_warning_add(j->out, MT_LEVEL_WARNING, "drive",
                       "\"%s\" is driven by %g m in a drawing %.4g m wide: is it meant in "
                       "millimetres?",
                       d->joint_name.s == NULL ? "" : d->joint_name.s, j->value[d->position],
                       size),
        j->model->nums[d->position].addr, mt_lint_drive_pointer(j, "position_m"));
}

static void lint_loads(mt_lint *j)
{
    const mt_model *const m = j->model;
    for (int i = 0; i < m->n_loads; i++) {
        const mt_load *const o = &m->loads[i];
        const holder h = {
            {"load", "loads", i, o->name.s}, &o->on, o->at.given ? 1 : 0, &o->at, NULL, NULL};
        if (o->on.name.s != NULL && mt_model_present(&o->in, j->configuration)) {
            lint_side(j, &h, 0);
        }
    }
}

void mt_lint_geometry(mt_lint *j)
{
    const mt_model *const m = j->model;
    const box all = box_without(j, NULL, NULL);
    const double size = size_of_box(&all);
    const int first = j->out->n;
    int dampers = 0;
    for (int i = 0; i < m->n_joints; i++) {
        const mt_joint *const o = &m->joints[i];
        const holder h = {
            {"joint", "joints", i, o->name.s}, o->bodies, o->n_at, o->at, o, NULL};
        for (int side = 0; side < 2 && mt_model_present(&o->in, j->configuration); side++) {
            lint_side(j, &h, side);
        }
        if (mt_model_present(&o->in, j->configuration)) {
            lint_gap(j, &h.item, o, size);
        }
    }
    for (int i = 0; i < m->n_springs; i++) {
        const mt_spring *const o = &m->springs[i];
        const holder h = {{o->damper ? "damper" : "spring", o->damper ? "dampers" : "springs",
                           o->damper ? dampers++ : i, o->name.s},
                          o->bodies,
                          o->n_at,
                          o->at,
                          NULL,
                          o};
        for (int side = 0; side < 2 && mt_model_present(&o->in, j->configuration); side++) {
            lint_side(j, &h, side);
        }
    }
    lint_loads(j);
    mt_warning_sort(j->out, first);
    const box *const own = boxes_of_bodies(j);
    for (int i = 0; i < m->n_bodies && own != NULL; i++) {
        if (mt_model_present(&m->bodies[i].in, j->configuration)) {
            const mt_item item = {"body", "bodies", i, m->bodies[i].name.s};
            lint_gyration(j, &item, &m->bodies[i], size_of_box(&own[i]), size);
        }
    }
    for (int i = 0; i < m->n_links; i++) {
        if (mt_model_present(&m->links[i].in, j->configuration)) {
            const mt_item item = {"link", "links", i, m->links[i].name.s};
            lint_stout(j, &item, &m->links[i]);
        }
    }
    lint_size(j, size);
    lint_stroke(j, size);
    mt_lint_suspicious(j, size);
}
