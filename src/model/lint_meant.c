/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is possible and hardly meant, beside single numbers: gravity that points up, bushings
 * whose two points are apart, and what a kind of link leaves out. */
#include "model/lint_priv.h"

#include <math.h>
#include <stddef.h>

#include "base/format.h"

/* A bushing's two points so far apart, in parts of the drawing's size, are two points. */
static const double BUSHING_APART = 0.01;

/* Of the drawing's size, what a point is placed away from the origin, and a unit is small. */
static const double LEAST_PLACED = 0.05;
static const double MOST_NEAR = 100.0;

/* m/s^2: a load factor of an aircraft or a rocket is below 20. */
static const double MOST_GRAVITY = 200.0;
static const double LEAST_MULTIPLE = 0.5;
static const double MOST_MULTIPLE = 1.5;

enum { AXES = 3, PLACE = 96 };

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
    if (s->n_at == 2 && mt_lint_position(j, &s->at[0], x[0]) &&
        mt_lint_position(j, &s->at[1], x[1])) {
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
    const bool known = body ? mt_lint_position(j, &j->model->bodies[second->index].centre, x[1])
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

void mt_lint_suspicious(mt_lint *j, double size)
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
