/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What no mechanism is built like, by several numbers at once. A tensor of inertia is
 * I = tr(S) E - S with S = int x x^T dm, so that S = tr(I) E / 2 - I has no negative
 * eigenvalue: of moments A, B, C none is more than the other two together. A spring matrix is
 * the second derivative of an energy and therefore symmetric. What acts along the line between
 * two points needs two points.
 */
#include "model/lint_priv.h"

#include <math.h>
#include <stddef.h>

#include "model/joint.h"

enum { AXES = 3, MATRIX = 6 };
/* Of the trace: what three digits of each moment leave open. A plate's moments A + B = C that
 * were rounded one by one are no fault. */
static const double INERTIA_ROUNDING = 1e-3;
/* Of the entries: what six printed digits leave open. */
static const double MATRIX_ROUNDING = 1e-6;
/* Of sqrt(K_ii K_jj): an entry so small is what a transformation left of 0. */
static const double MATRIX_NOISE = 1e-9;
/* Of the coordinates' size: points that differ by rounding are the same point. */
static const double SAME_POINT = 1e-14;

/* True where the symmetric 3 x 3 matrix xx yy zz xy xz yz has no eigenvalue below -noise, by
 * its principal minors, each with the effect of `noise` on the diagonal. */
static bool is_positive(const double v[6], double noise)
{
    const double a = v[0] + noise;
    const double b = v[1] + noise;
    const double c = v[2] + noise;
    const double ab = (a * b) - (v[3] * v[3]);
    const double ac = (a * c) - (v[4] * v[4]);
    const double bc = (b * c) - (v[5] * v[5]);
    const double det = (a * bc) - (v[3] * ((v[3] * c) - (v[5] * v[4]))) +
                       (v[4] * ((v[3] * v[5]) - (b * v[4])));
    return a >= 0.0 && b >= 0.0 && c >= 0.0 && ab >= 0.0 && ac >= 0.0 && bc >= 0.0 &&
           det >= 0.0;
}

const char *mt_lint_tensor(mt_lint *j, const double v[6], int *at)
{
    static const double ROUNDING = 1e-12; /* of the trace */
    double largest = 0.0;
    double u[6]; /* in parts of the trace */
    *at = 0;
    for (int k = 0; k < 6; k++) {
        largest = fmax(largest, fabs(v[k]));
    }
    const double trace =
        largest > 0.0 ? (v[0] / largest) + (v[1] / largest) + (v[2] / largest) : 1.0;
    for (int k = 0; k < 6; k++) {
        u[k] = largest > 0.0 ? v[k] / largest / trace : 0.0;
    }
    if (!(trace > 0.0) || !is_positive(u, ROUNDING)) {
        return "belongs to a tensor with a negative principal moment: its products of inertia "
               "are too large";
    }
    for (int k = 0; k < 6; k++) {
        u[k] = k < AXES ? 0.5 - u[k] : -u[k];
    }
    if (largest == 0.0 || is_positive(u, INERTIA_ROUNDING)) {
        return NULL;
    }
    for (int k = 0; k < AXES; k++) {
        if (u[k] < -INERTIA_ROUNDING) {
            *at = k;
            return mt_arena_printf(
                j->out->mem,
                "is more than the other two moments together (%g + %g), which "
                "no body has",
                v[(k + 1) % AXES], v[(k + 2) % AXES]);
        }
    }
    return "belongs to a tensor that no body has: its largest principal moment is more than "
           "the "
           "other two together";
}

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
    return where != NULL ? mt_lint_position(j, where, x) : body->kind == MT_ATTACH_GROUND;
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
    return !j->model->configurations[j->configuration].drive.given ||
           s->free_length == MT_ABSENT;
}

static double direction_of_axis(const mt_lint *j, const mt_num axis[3], double x[3])
{
    double largest = 0.0;
    for (int k = 0; k < AXES; k++) {
        x[k] = axis[k] == MT_ABSENT ? 0.0 : j->value[axis[k]];
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
    if (!joint->has_axis || !joint->has_axis_b || first == 0.0 || second == 0.0) {
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

/* Check that a link's hinge axis has a direction and is perpendicular to the link. */
static void lint_hinge_axis(mt_lint *j, int i, const mt_link *l)
{
    static const double NOT_PERPENDICULAR = 1e-6; /* cosine; as the mechanism is built */
    const mt_item item = {"link", "links", i, l->name.s};
    double axis[AXES];
    double from[AXES];
    double to[AXES];
    if (!l->has_hinge_axis || j->model->dimension == 2) {
        return;
    }
    if (direction_of_axis(j, l->hinge_axis, axis) == 0.0) {
        fault_axis(j, &item, l->hinge_axis, l->name.addr, "hinge_axis",
                   "has length 0 and no direction");
        return;
    }
    if (!mt_lint_position(j, &l->from, from) || !mt_lint_position(j, &l->to, to)) {
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
    if (!mt_lint_position(j, &l->from, from) || !mt_lint_position(j, &l->to, to) ||
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

void mt_lint_structure(mt_lint *j)
{
    const mt_model *const m = j->model;
    int dampers = 0;
    for (int i = 0; i < m->n_links; i++) {
        if (mt_model_present(&m->links[i].in, j->configuration)) {
            lint_ends(j, i, &m->links[i]);
            lint_hinge_axis(j, i, &m->links[i]);
        }
    }
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
        if (mt_joint_kind_of(joint->type)->closes == MT_CLOSES_LENGTH) {
            lint_line(j, &item, joint->bodies, joint->n_at, joint->at, joint->name.addr);
        }
    }
}
