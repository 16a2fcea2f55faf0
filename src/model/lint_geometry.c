/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The drawing of a configuration, judged: joints and springs off what they hold, pairs of
 * points that only closing brings together, sizes. With a segment P + s d, 0 <= s <= 1, the
 * distance of a point X is |X - P - clamp(d . (X - P) / d . d) d|.
 */
#include "model/lint_geometry.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "base/format.h"
#include "base/possible.h"
#include "model/lint.h"
#include "model/model.h"

mt_warning *mt_lint_addr(mt_lint *j, mt_warning *warning, mt_addr addr, const char *pointer)
{
    if (warning == NULL) {
        return NULL;
    }
    warning->addr = addr;
    warning->pointer = pointer;
    warning->file = mt_model_file(j->model, addr);
    warning->configuration = j->model->configurations[j->configuration].name.s;
    if (!mt_model_locate(j->model, addr, &warning->line, &warning->column)) {
        warning->line = 0;
        warning->column = 0;
    }
    return warning;
}

const char *mt_lint_drive_pointer(const mt_lint *j, const mt_drive *d, const char *member)
{
    const char *const owner = j->model->configurations[d->owner].name.s;
    return d->item < 0
               ? mt_arena_printf(j->out->mem, "/configurations/%s/drive/%s", owner, member)
               : mt_arena_printf(j->out->mem, "/configurations/%s/drive/%d/%s", owner, d->item,
                                 member);
}

/* The coordinates of a position; false: not known. */
static bool lint_position(const mt_lint *j, const mt_position *p, double x[3])
{
    const mt_num *const own = p->point >= 0 ? j->model->points[p->point].x : p->x;
    bool known = true;
    for (int k = 0; k < 3; k++) {
        x[k] = own[k] == MT_ABSENT ? 0.0 : j->value[own[k]];
        known = known && isfinite(x[k]);
    }
    return known && own[0] != MT_ABSENT;
}

/*
 * What no mechanism is built like, by several numbers at once. A spring matrix is the second
 * derivative of an energy and therefore symmetric. What acts along the line between two points
 * needs two points.
 */

enum { AXES = 3, MATRIX = 6 };
/* Of the entries: what six printed digits leave open. */
static const double MATRIX_ROUNDING = 1e-6;
/* Of sqrt(K_ii K_jj): an entry so small is what a transformation left of 0. */
static const double MATRIX_NOISE = 1e-9;
/* Of the coordinates' size: points that differ by rounding are the same point. */
static const double SAME_POINT = 1e-14;

static mt_addr addr_of(const mt_lint *j, mt_num num, mt_addr other)
{
    return num == MT_ABSENT ? other : j->model->nums[num].addr;
}

/* Check symmetry of a bushing's matrix; an error is reported at the later of the two
 * entries. */
static void lint_matrix(mt_lint *j, const mt_item *item, const mt_spring *s)
{
    double k[MATRIX * MATRIX];
    for (int i = 0; s->matrix != NULL && i < MATRIX * MATRIX; i++) {
        k[i] = s->matrix[i] == MT_ABSENT ? 0.0 : j->value[s->matrix[i]];
    }
    for (int row = 1; s->matrix != NULL && row < MATRIX; row++) {
        for (int column = 0; column < row; column++) {
            const double below = k[(MATRIX * row) + column];
            const double above = k[(MATRIX * column) + row];
            const double size = fmax(fabs(below), fabs(above));
            const double noise = sqrt(fabs(k[((ptrdiff_t)MATRIX + 1) * row])) *
                                 sqrt(fabs(k[((ptrdiff_t)MATRIX + 1) * column])) * MATRIX_NOISE;
            if (!(fabs(below - above) > fmax(MATRIX_ROUNDING * size, noise))) {
                continue;
            }
            (void)mt_lint_addr(
                j,
                mt_warning_add(
                    j->out, MT_LEVEL_FAULT, "symmetric",
                    "%s \"%s\": stiffness_matrix is not symmetric: its entry [%d][%d] "
                    "is %g and [%d][%d] is %g (counted from 0); what has no energy, as "
                    "the cross-coupling of a bearing, cannot be a spring",
                    item->what, item->name, row, column, below, column, row, above),
                addr_of(j, s->matrix[(MATRIX * row) + column], s->name.addr),
                mt_arena_printf(j->out->mem, "/%s/%d/stiffness_matrix/%d/%d", item->list,
                                item->index, row, column));
            return;
        }
    }
}

/* The position of one side of an item between two points: its `at`, otherwise the centre of the
 * body. */
static bool side_of(const mt_lint *j, const mt_attach *body, int n_at, const mt_position *at,
                    double x[3])
{
    const mt_position *where = n_at > 0 ? at : NULL;
    const bool centre = where == NULL && body->kind == MT_ATTACH_BODY && body->index >= 0;
    if (centre) {
        where = &j->model->bodies[body->index].centre;
    }
    x[0] = x[1] = x[2] = 0.0; /* the ground's */
    return where != NULL ? lint_position(j, where, x) : body->kind == MT_ATTACH_GROUND;
}

static bool are_apart(const double a[3], const double b[3])
{
    double way = 0.0;
    double size = 0.0;
    for (int k = 0; k < AXES; k++) {
        way = fmax(way, fabs(a[k] - b[k]));
        size = fmax(size, fmax(fabs(a[k]), fabs(b[k])));
    }
    return way > SAME_POINT * size;
}

static void lint_line(mt_lint *j, const mt_item *item, const mt_attach bodies[2], int n_at,
                      const mt_position at[2], mt_addr name)
{
    double x[2][AXES];
    for (int side = 0; side < 2; side++) {
        if (bodies[side].name.s == NULL ||
            !side_of(j, &bodies[side], n_at, &at[n_at == 2 ? side : 0], x[side])) {
            return;
        }
    }
    if (are_apart(x[0], x[1])) {
        return;
    }
    (void)mt_lint_addr(
        j,
        mt_warning_add(
            j->out, MT_LEVEL_FAULT, "coincident",
            "%s \"%s\": its two points coincide (%g, %g, %g): it acts along the line "
            "between them, which has no direction%s",
            item->what, item->name, x[0][0], x[0][1], x[0][2],
            n_at > 0 ? "" : "; give \"at\": the point on each body"),
        n_at == 2 ? at[1].addr : name,
        mt_arena_printf(j->out->mem, n_at == 2 ? "/%s/%d/at/1" : "/%s/%d", item->list,
                        item->index));
}

/* A drive takes the points apart before anything is asked of a spring whose free length does
 * not come from the drawing. */
static bool needs_drawn_length(const mt_lint *j, const mt_spring *s)
{
    return j->model->configurations[j->configuration].n_drives == 0 ||
           s->free_length == MT_ABSENT;
}

/* The largest component; NaN where one has no value. */
static double direction_of_axis(const mt_lint *j, const mt_num axis[3], double x[3])
{
    double largest = 0.0;
    for (int k = 0; k < AXES; k++) {
        x[k] = axis[k] == MT_ABSENT ? 0.0 : j->value[axis[k]];
        if (isnan(x[k])) {
            return x[k];
        }
        largest = fmax(largest, fabs(x[k]));
    }
    for (int k = 0; k < AXES && largest > 0.0; k++) {
        x[k] /= largest;
    }
    return largest;
}

static void fault_axis(mt_lint *j, const mt_item *item, const mt_num axis[3], mt_addr name,
                       const char *member, const char *why)
{
    (void)mt_lint_addr(
        j,
        mt_warning_add(j->out, MT_LEVEL_FAULT, "axis", "%s \"%s\": %s %s", item->what,
                       item->name, member, why),
        addr_of(j, axis[0], name),
        mt_arena_printf(j->out->mem, "/%s/%d/%s", item->list, item->index, member));
}

static void lint_axes(mt_lint *j, const mt_item *item, const mt_joint *joint)
{
    static const double PARALLEL = 1e-9; /* sine of the angle between */
    static const char NO_LENGTH[] = "has length 0 and no direction";
    double a[AXES];
    double b[AXES];
    const double first = joint->has_axis ? direction_of_axis(j, joint->axis, a) : 1.0;
    const double second = joint->has_axis_b ? direction_of_axis(j, joint->axis_b, b) : 1.0;
    if (first == 0.0) {
        fault_axis(j, item, joint->axis, joint->name.addr, "axis", NO_LENGTH);
    }
    if (second == 0.0) {
        fault_axis(j, item, joint->axis_b, joint->name.addr, "axis_b", NO_LENGTH);
    }
    if (!joint->has_axis || !joint->has_axis_b || !(first > 0.0) || !(second > 0.0)) {
        return;
    }
    double across = 0.0;
    for (int k = 0; k < AXES; k++) {
        const int n = (k + 1) % AXES;
        across = fmax(across, fabs((a[k] * b[n]) - (a[n] * b[k])));
    }
    if (across < PARALLEL) {
        fault_axis(
            j, item, joint->axis_b, joint->name.addr, "axis_b",
            "is parallel to axis: two axes along the same line do not make a universal joint");
    }
}

/* Check that an item's own axes, a member `where` of it, have directions. */
static void lint_own_axes(mt_lint *j, const mt_item *item, const mt_axes *a, const char *where,
                          mt_addr name)
{
    double e[AXES][AXES];
    const mt_axes_fault fault = mt_axes_of(a, j->value, e);
    const bool first = fault == MT_AXES_NO_X;
    const mt_num *const x = first ? a->x : a->has_y ? a->y : a->z;
    const char *const member = first ? "x" : a->has_y ? "y" : "z";
    if (fault != MT_AXES_SOUND) {
        fault_axis(j, item, x, name, mt_arena_printf(j->out->mem, "%s/%s", where, member),
                   fault == MT_AXES_PARALLEL
                       ? "is parallel to x: two vectors along the same line do not make axes"
                       : "has length 0 and no direction");
    }
}

/* And those of a compliance, of which the joint's own axis is one. */
static void lint_yielding_axes(mt_lint *j, const mt_item *item, const mt_joint *joint)
{
    const mt_axes *const own = &joint->compliance->axes;
    mt_axes both = {.given = true, .has_x = true, .has_y = true};
    double e[AXES][AXES];
    if (!own->given || !joint->has_axis) {
        lint_own_axes(j, item, own, "compliance/axes", joint->name.addr);
        return;
    }
    memcpy(both.x, joint->axis, sizeof both.x);
    memcpy(both.y, own->x, sizeof both.y);
    const mt_axes_fault fault = mt_axes_of(&both, j->value, e);
    if (fault == MT_AXES_NO_OTHER || fault == MT_AXES_PARALLEL) {
        fault_axis(j, item, own->x, joint->name.addr, "compliance/axes/x",
                   fault == MT_AXES_PARALLEL ? "is parallel to the joint's axis"
                                             : "has length 0 and no direction");
    }
}

/* Check that a link's hinge axis has a direction and is perpendicular to the link. */
static void lint_hinge_axis(mt_lint *j, int i, const mt_link *l)
{
    static const double NOT_PERPENDICULAR = 1e-6; /* cosine; as the mechanism is built */
    const mt_item item = {"link", "links", i, l->name.s};
    double axis[AXES] = {0.0};
    double from[AXES];
    double to[AXES];
    if (!l->has_hinge_axis || j->model->dimension == 2) {
        return;
    }
    const double length = direction_of_axis(j, l->hinge_axis, axis);
    if (length == 0.0) {
        fault_axis(j, &item, l->hinge_axis, l->name.addr, "hinge_axis",
                   "has length 0 and no direction");
        return;
    }
    if (!(length > 0.0) || !lint_position(j, &l->from, from) || !lint_position(j, &l->to, to)) {
        return;
    }
    double dot = 0.0;
    double a = 0.0;
    double b = 0.0;
    for (int k = 0; k < AXES; k++) {
        const double along = to[k] - from[k];
        dot += axis[k] * along;
        a = hypot(a, axis[k]);
        b = hypot(b, along);
    }
    if (fabs(dot) > NOT_PERPENDICULAR * a * b) {
        fault_axis(j, &item, l->hinge_axis, l->name.addr, "hinge_axis",
                   "is not perpendicular to the link");
    }
}

static void lint_ends(mt_lint *j, int i, const mt_link *l)
{
    double from[AXES];
    double to[AXES];
    if (!lint_position(j, &l->from, from) || !lint_position(j, &l->to, to) ||
        are_apart(from, to)) {
        return;
    }
    (void)mt_lint_addr(j,
                       mt_warning_add(j->out, MT_LEVEL_FAULT, "coincident",
                                      "link \"%s\" begins and ends at the same point (%g, %g, "
                                      "%g)",
                                      l->name.s, from[0], from[1], from[2]),
                       l->name.addr, mt_arena_printf(j->out->mem, "/links/%d", i));
}

static void lint_bodies_and_links(mt_lint *j)
{
    const mt_model *const m = j->model;
    for (int i = 0; i < m->n_bodies; i++) {
        const mt_body *const b = &m->bodies[i];
        const mt_item item = {"body", "bodies", i, b->name.s};
        if (mt_model_present(&b->in, j->configuration)) {
            lint_own_axes(j, &item, &b->axes, "axes", b->name.addr);
        }
    }
    for (int i = 0; i < m->n_links; i++) {
        if (mt_model_present(&m->links[i].in, j->configuration)) {
            lint_ends(j, i, &m->links[i]);
            lint_hinge_axis(j, i, &m->links[i]);
        }
    }
}

void mt_lint_structure(mt_lint *j)
{
    const mt_model *const m = j->model;
    int dampers = 0;
    lint_bodies_and_links(j);
    for (int i = 0; i < m->n_springs; i++) {
        const mt_spring *const s = &m->springs[i];
        const mt_item item = {s->damper ? "damper" : "spring",
                              s->damper ? "dampers" : "springs", s->damper ? dampers++ : i,
                              s->name.s};
        const bool line =
            (s->type == MT_SPRING_AXIAL && s->joint_name.s == NULL) || s->type == MT_SPRING_BAR;
        if (!mt_model_present(&s->in, j->configuration)) {
            continue;
        }
        lint_own_axes(j, &item, &s->axes, "axes", s->name.addr);
        lint_matrix(j, &item, s);
        if (line && needs_drawn_length(j, s)) {
            lint_line(j, &item, s->bodies, s->n_at, s->at, s->name.addr);
        }
    }
    for (int i = 0; i < m->n_joints; i++) {
        const mt_joint *const joint = &m->joints[i];
        const mt_item item = {"joint", "joints", i, joint->name.s};
        if (!mt_model_present(&joint->in, j->configuration)) {
            continue;
        }
        lint_axes(j, &item, joint);
        if (joint->compliance != NULL) {
            lint_yielding_axes(j, &item, joint);
        }
        if (mt_joint_kind_of(joint->type)->closes == MT_CLOSES_LENGTH) {
            lint_line(j, &item, joint->bodies, joint->n_at, joint->at, joint->name.addr);
        }
    }
}

/* What is possible and hardly meant, beside single numbers: gravity that points up, bushings
 * whose two points are apart, and what a kind of link leaves out. */

/* A bushing's two points so far apart, in parts of the drawing's size, are two points. */
static const double BUSHING_APART = 0.01;

/* Of the drawing's size, what a point is placed away from the origin, and a unit is small. */
static const double LEAST_PLACED = 0.05;
static const double MOST_NEAR = 100.0;

/* m/s^2: a load factor of an aircraft or a rocket is below 20. */
static const double MOST_GRAVITY = 200.0;
static const double LEAST_MULTIPLE = 0.5;
static const double MOST_MULTIPLE = 1.5;

enum { PLACE = 96 };

/* Whose gravity is in force: its pointer, and its numbers. */
static const char *gravity_pointer(const mt_lint *j)
{
    const mt_model *const m = j->model;
    const mt_num own = m->configurations[j->configuration].gravity[0];
    int c = j->configuration;
    if (m->has_gravity && m->gravity[0] == own) {
        return "/gravity_m_per_s2";
    }
    for (int like = m->configurations[c].like;
         like != MT_ABSENT && m->configurations[like].gravity[0] == own;
         like = m->configurations[c].like) {
        c = like;
    }
    return mt_arena_printf(j->out->mem, "/configurations/%s/gravity_m_per_s2",
                           m->configurations[c].name.s);
}

/* In cm/s^2 or mm/s^2, or as a multiple of the earth's: between the moon's 1.62 and nothing. */
static void lint_gravity_size(mt_lint *j, const double g[AXES], int most)
{
    const mt_configuration *const c = &j->model->configurations[j->configuration];
    const double size = hypot(hypot(g[0], g[1]), g[2]);
    const bool multiple = size > LEAST_MULTIPLE && size < MOST_MULTIPLE;
    if (!multiple && !(size > MOST_GRAVITY)) {
        return;
    }
    (void)mt_lint_addr(j,
                       mt_warning_add(j->out, MT_LEVEL_WARNING, "gravity",
                                      multiple
                                          ? "gravity_m_per_s2 has a size of %.4g m/s^2: is "
                                            "a multiple of 9.81 m/s^2 meant?"
                                          : "gravity_m_per_s2 has a size of %.4g m/s^2, more "
                                            "than 20 times the earth's: is the unit m/s^2?",
                                      size),
                       j->model->nums[c->gravity[most]].addr, gravity_pointer(j));
}

/* Along +y of a plane, +y or +z of space, more than along any other axis. */
static void lint_gravity(mt_lint *j)
{
    static const char *const axes[] = {"x", "y", "z"};
    const mt_configuration *const c = &j->model->configurations[j->configuration];
    double g[AXES] = {0.0, 0.0, 0.0};
    int most = 0;
    if (!c->has_gravity) {
        return;
    }
    for (int k = 0; k < AXES; k++) {
        g[k] = c->gravity[k] == MT_ABSENT ? 0.0 : j->value[c->gravity[k]];
        most = fabs(g[k]) > fabs(g[most]) ? k : most;
    }
    lint_gravity_size(j, g, most);
    if (most == 0 || !(g[most] > 0.0)) {
        return;
    }
    (void)mt_lint_addr(
        j,
        mt_warning_add(
            j->out, MT_LEVEL_WARNING, "gravity",
            "gravity_m_per_s2 is %g along +%s, which is up where %s is the height: is "
            "%g meant?",
            g[most], axes[most], axes[most], -g[most]),
        j->model->nums[c->gravity[most]].addr, gravity_pointer(j));
}

/* Negative damping, which adds energy to a motion. */
static void lint_damper(mt_lint *j, const mt_item *item, const mt_spring *s)
{
    const mt_num all[] = {s->stiffness,      s->translation[0], s->translation[1],
                          s->translation[2], s->rotation[0],    s->rotation[1],
                          s->rotation[2]};
    for (int k = 0; k < MT_COUNT(all); k++) {
        if (all[k] != MT_ABSENT && j->value[all[k]] < 0.0) {
            (void)mt_lint_addr(
                j,
                mt_warning_add(j->out, MT_LEVEL_NOTE, "damper",
                               "damper \"%s\" has a negative coefficient (%g): it feeds the "
                               "motion",
                               item->name, j->value[all[k]]),
                j->model->nums[all[k]].addr,
                mt_arena_printf(j->out->mem, "/%s/%d", item->list, item->index));
            return;
        }
    }
}

static const char *point_text(const mt_lint *j, const double x[3], char out[PLACE])
{
    (void)(j->model->dimension == 2
               ? mt_snprintf(out, PLACE, "(%.4g, %.4g) m", x[0], x[1])
               : mt_snprintf(out, PLACE, "(%.4g, %.4g, %.4g) m", x[0], x[1], x[2]));
    return out;
}

/* The forces of a bushing act at its second point, on both bodies. */
static void lint_bushing(mt_lint *j, const mt_item *item, const mt_spring *s, double size)
{
    double x[2][AXES] = {{0.0}};
    char place[PLACE];
    mt_arena *const mem = j->out->mem;
    const mt_attach *const second = &s->bodies[1];
    if (s->n_at == 2 && lint_position(j, &s->at[0], x[0]) &&
        lint_position(j, &s->at[1], x[1])) {
        const double apart =
            hypot(hypot(x[1][0] - x[0][0], x[1][1] - x[0][1]), x[1][2] - x[0][2]);
        if (!(apart > BUSHING_APART * size)) {
            return;
        }
        mt_warning *const warning =
            mt_warning_add(j->out, MT_LEVEL_WARNING, "bushing",
                           "%s \"%s\": its two points are %.4g m apart; its forces act at the "
                           "second, %s, on both bodies",
                           item->what, item->name, apart, point_text(j, x[1], place));
        if (mt_lint_addr(j, warning, s->at[1].addr,
                         mt_arena_printf(mem, "/%s/%d/at/1", item->list, item->index)) !=
            NULL) {
            warning->size = apart;
        }
        return;
    }
    if (s->n_at > 0 || second->name.s == NULL) {
        return;
    }
    const bool body = second->kind == MT_ATTACH_BODY && second->index >= 0;
    const bool known = body ? lint_position(j, &j->model->bodies[second->index].centre, x[1])
                            : second->kind == MT_ATTACH_GROUND;
    const char *const of = second->kind == MT_ATTACH_GROUND ? "the origin" : "the centre of ";
    (void)mt_lint_addr(
        j,
        mt_warning_add(j->out, MT_LEVEL_NOTE, "bushing",
                       "%s \"%s\" has no \"at\": its forces act at %s%s%s%s%s%s", item->what,
                       item->name, of, second->kind == MT_ATTACH_GROUND ? "" : "\"",
                       second->kind == MT_ATTACH_GROUND ? "" : second->name.s,
                       second->kind == MT_ATTACH_GROUND ? "" : "\"", known ? ", " : "",
                       known ? point_text(j, x[1], place) : ""),
        s->name.addr, mt_arena_printf(mem, "/%s/%d", item->list, item->index));
}

/* Rigid elements are joined by hinges about one axis. */
const char *mt_model_link_limit(const mt_model *model, int configuration, int link,
                                mt_arena *mem)
{
    const mt_link *const l = &model->links[link];
    if (model->dimension == 2 || l->kind == MT_LINK_BEAM || l->elements < 2 ||
        !mt_model_present(&l->in, configuration)) {
        return NULL;
    }
    return mt_arena_printf(
        mem,
        "link \"%s\" of rigid elements bends about its hinge axis only: about "
        "the other axis, and in torsion, it is rigid (\"kind\": \"beam\" bends "
        "about both)",
        l->name.s);
}

static bool is_bare(const mt_number *number)
{
    return number->expr.length == 1 && number->expr.code[0].op == MT_OP_CONST;
}

/* In a file of millimetres a point at (-0.42, 0.15, -0.06) is next to the origin, and as metres
 * within the drawing: two bare coordinates or more below one unit, and none above. */
static void lint_point(mt_lint *j, const mt_point *p, const mt_unit *unit, double size)
{
    const mt_number *const nums = j->model->nums;
    const double factor = mt_unit_factor(unit);
    double metres = 0.0; /* if they are */
    int small = 0;
    mt_num first = MT_ABSENT;
    for (int k = 0; k < j->model->dimension; k++) {
        const double x = fabs(j->value[p->x[k]]);
        if (!(x < factor) || (x > 0.0 && !is_bare(&nums[p->x[k]]))) {
            return;
        }
        metres = fmax(metres, x / factor);
        small += x > 0.0 ? 1 : 0;
        first = x > 0.0 && first == MT_ABSENT ? p->x[k] : first;
    }
    if (small < 2 || !(metres > LEAST_PLACED * size) || !(metres < size) ||
        !(size > MOST_NEAR * factor)) {
        return;
    }
    (void)mt_lint_addr(
        j,
        mt_warning_add(
            j->out, MT_LEVEL_WARNING, "size",
            "point \"%s\" lies within 1 %s of the origin, in a drawing %.4g m wide: is "
            "it meant in metres?",
            p->name.s, unit->name, size),
        nums[first].addr, mt_arena_printf(j->out->mem, "/points/%s", p->name.s));
}

static void lint_points(mt_lint *j, double size)
{
    const mt_unit *const unit = j->model->units[MT_LENGTH];
    for (int i = 0; unit != NULL && !mt_unit_is_si(unit) && i < j->model->n_points; i++) {
        lint_point(j, &j->model->points[i], unit, size);
    }
}

/* Gravity that points up, bushings with two points, links that bend about one axis
 *. size: of the drawing [m]. */
static void lint_suspicious(mt_lint *j, double size)
{
    const mt_model *const m = j->model;
    int dampers = 0;
    lint_gravity(j);
    lint_points(j, size);
    for (int i = 0; i < m->n_springs; i++) {
        const mt_spring *const s = &m->springs[i];
        const mt_item item = {s->damper ? "damper" : "spring",
                              s->damper ? "dampers" : "springs", s->damper ? dampers++ : i,
                              s->name.s};
        if (!mt_model_present(&s->in, j->configuration)) {
            continue;
        }
        if (s->type == MT_SPRING_BUSHING) {
            lint_bushing(j, &item, s, size);
        }
        if (s->damper) {
            lint_damper(j, &item, s);
        }
    }
    for (int i = 0; i < m->n_links; i++) {
        const char *const limit = mt_model_link_limit(m, j->configuration, i, j->out->mem);
        if (limit != NULL) {
            (void)mt_lint_addr(
                j, mt_warning_add(j->out, MT_LEVEL_NOTE, "one_axis", "%s", limit),
                m->links[i].name.addr, mt_arena_printf(j->out->mem, "/links/%d", i));
        }
    }
}

/* Joints and springs off what they hold, and sizes. */

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

/* The address of the first number of a position, for messages. */
static mt_addr address_of_position(const mt_position *p)
{
    return p->addr;
}

static void include_position(const mt_lint *j, box *b, const mt_position *p)
{
    double x[3];
    if (!lint_position(j, p, x)) {
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
    segment s = {.known = lint_position(j, &l->from, from) && lint_position(j, &l->to, to)};
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
    return lint_position(j, p, other) ? fmin(least, distance(other, x)) : least;
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
    if (mt_lint_addr(j, warning, address_of_position(p), pointer) != NULL) {
        warning->size = off;
    }
}

static void lint_side(mt_lint *j, const holder *h, int side)
{
    const mt_attach *const a = &h->bodies[side];
    double x[3];
    if (a->name.s == NULL || a->kind == MT_ATTACH_GROUND || h->n_at == 0 ||
        !lint_position(j, side_at(h->n_at, h->at, side), x)) {
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
    if (joint->n_at != 2 || !lint_position(j, &joint->at[0], a) ||
        !lint_position(j, &joint->at[1], b)) {
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
    if (mt_lint_addr(j, warning, address_of_position(&joint->at[1]),
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
    if (!lint_position(j, &l->from, from) || !lint_position(j, &l->to, to) ||
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

static void lint_stroke(mt_lint *j, const mt_drive *d, double size)
{
    if (d->position_is_angle || d->position == MT_ABSENT || size == 0.0 ||
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
            j->model->nums[d->position].addr, mt_lint_drive_pointer(j, d, "position_m"));
        return;
    }
    (void)mt_lint_addr(
        j,
        mt_warning_add(j->out, MT_LEVEL_WARNING, "drive",
                       "\"%s\" is driven by %g m in a drawing %.4g m wide: is it meant in "
                       "millimetres?",
                       d->joint_name.s == NULL ? "" : d->joint_name.s, j->value[d->position],
                       size),
        j->model->nums[d->position].addr, mt_lint_drive_pointer(j, d, "position_m"));
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
    const mt_configuration *const c = &j->model->configurations[j->configuration];
    for (int i = 0; i < c->n_drives; i++) {
        lint_stroke(j, &c->drives[i], size);
    }
    lint_suspicious(j, size);
}
