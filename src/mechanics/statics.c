/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * At rest the forces of loads and springs, V_q, and of the equations of joints balance,
 *     V_q + A^T lambda = 0,   c = 0,
 * so the equations c of a joint push its second body with
 *     F = -sum lambda_i dc_i/dx,   M_P = -sum lambda_i (dc_i/dtheta - r x dc_i/dx),
 * r from the centre of the body to the joint's point P. F and M_P are t . lambda with a t of
 * each component: they are determined where t lies in the range of A, whatever the redundancy.
 *
 * Every quantity is evaluated in complex arithmetic (cx.h) at poses, vectors, rest values and
 * multipliers that carry their derivative by one input.
 *
 * Rounded positions leave a motion `left` to the balance (newton.h): a spring of stiffness k
 * and gradient g has k g . left more force, and that is the force that balances.
 */
#include "mechanics/statics.h"

#include "mechanics/linear_priv.h"

#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "mechanics/products.h"
#include "model/model.h"

/* A v - t of a component that is determined, in parts of t's largest entry and equations of
 * unit length. */
static const double DETERMINED = 1e-9;

static const mt_cx CENTRE[3] = {0.0, 0.0, 0.0};
static const mt_cx UNIT[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};

/* Where a quantity is read: numbers, or numbers with their derivative. */
typedef struct rest_place {
    const mt_linear *lin;
    const mt_data *data;
    const mt_pose *reference;
    mt_placement at;
    bool slope;
} rest_place;

/* Sensors */

static void place_point(const mt_pose *pose, const mt_cx *arm, mt_cx out[3])
{
    cx_rotate3(pose->r, arm, out);
    for (int k = 0; k < 3; k++) {
        out[k] += pose->x[k];
    }
}

/* Rotation vector of the rotation that takes frame a to frame b (column-major), in a. */
static void turn_between(const mt_cx *a, const mt_cx *b, mt_cx out[3])
{
    mt_pose from = {.x = {0.0, 0.0, 0.0}};
    mt_pose to = {.x = {0.0, 0.0, 0.0}};
    memcpy(from.r, a, sizeof from.r);
    memcpy(to.r, b, sizeof to.r);
    for (int k = 0; k < 3; k++) {
        const mt_measure_data m = {
            .kind = MT_MEASURE_ROTATION, .component = k, .dir = {UNIT[0], UNIT[1], UNIT[2]}};
        out[k] = mt_measure_value(&m, &from, &to, NULL);
    }
}

/* out = a b^T. */
static void times_transposed(const mt_cx *a, const mt_cx *b, mt_cx out[9])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            out[i + (3 * j)] =
                cx_mul(a[i], b[j]) + cx_mul(a[i + 3], b[j + 3]) + cx_mul(a[i + 6], b[j + 6]);
        }
    }
}

/* Component along a global axis of the rotation from frame a to frame b. */
static mt_cx turned_about(const mt_cx *a, const mt_cx *b, int axis)
{
    static const mt_cx ground[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    mt_cx r[9];
    mt_cx turn[3];
    times_transposed(b, a, r);
    turn_between(ground, r, turn);
    return turn[axis];
}

/* A point within a beam element: between its nodes, and off the chord by what the rotations of
 * the nodes against the chord do to it. chord: its frame. */
static mt_cx beam_bow(const rest_place *p, int channel, const mt_pose *poses, mt_cx chord[9])
{
    const mt_channel_def *const c = &p->data->sys->channels[channel];
    mt_beam_geometry g = {.length = 0.0};
    mt_cx row[MT_LOCAL];
    mt_cx bow = 0.0;
    mt_beam_frame(p->data, c->body, c->dir, poses, &g);
    memcpy(chord, g.e, sizeof g.e);
    mt_term_rows(p->data, MT_TERM_CHANNEL, &p->lin->list[MT_TERM_CHANNEL].terms[channel], poses,
                 row);
    for (int side = 0; side < 2; side++) {
        mt_cx triad[9];
        mt_cx turn[3];
        for (int k = 0; k < 3; k++) {
            cx_rotate3(mt_pose_of(poses, c->body[side])->r, p->data->vec[c->dir[k]],
                       triad + ((ptrdiff_t)3 * k));
        }
        turn_between(chord, triad, turn);
        for (int k = 0; k < 3; k++) {
            bow += cx_mul(turn[k], cx_dot3(row + ((ptrdiff_t)6 * side) + 3, g.e[k]));
        }
    }
    return bow;
}

static mt_cx beam_place(const rest_place *p, int channel, const mt_pose *poses)
{
    const mt_channel_def *const c = &p->data->sys->channels[channel];
    const mt_cx x = mt_data_scalar(p->data, c->fraction, 0.0);
    mt_cx chord[9];
    const mt_cx bow = beam_bow(p, channel, poses, chord);
    return cx_mul(1.0 - x, mt_pose_of(poses, c->body[0])->x[c->axis]) +
           cx_mul(x, mt_pose_of(poses, c->body[1])->x[c->axis]) + bow;
}

static mt_cx read_sensor(const rest_place *p, int channel)
{
    const mt_channel_def *const c = &p->data->sys->channels[channel];
    const mt_pose *const now = mt_pose_of(p->at.pose, c->body[0]);
    const mt_pose *const then = mt_pose_of(p->reference, c->body[0]);
    mt_cx here[9];
    mt_cx there[9];
    switch (c->kind) {
    case MT_CHANNEL_POINT:
        place_point(now, c->point < 0 ? CENTRE : p->data->vec[c->point], here);
        place_point(then, c->point < 0 ? CENTRE : p->data->vec[c->point], there);
        return here[c->axis] - there[c->axis];
    case MT_CHANNEL_ROTATION:
        return turned_about(then->r, now->r, c->axis);
    case MT_CHANNEL_BEAM_POINT:
        return beam_place(p, channel, p->at.pose) - beam_place(p, channel, p->reference);
    case MT_CHANNEL_BEAM_ROTATION: {
        const mt_cx bow = beam_bow(p, channel, p->at.pose, here);
        const mt_cx before = beam_bow(p, channel, p->reference, there);
        return turned_about(there, here, c->axis) + bow - before;
    }
    }
    return nan("");
}

/* Springs */

/* Stretch of a spring's measure, with what rounding of the positions left. */
static mt_cx stretch(const rest_place *p, int spring, int side)
{
    const mt_system *const sys = p->data->sys;
    const mt_measure_def *const def = &sys->measures[sys->springs[spring].measure[side]];
    const mt_stage *const stage = &p->lin->position.equilibrium;
    mt_cx d = mt_data_value(p->data, def, &p->at, NULL) - p->data->rest[spring][side];
    if (stage->active && stage->left.q != NULL) {
        mt_jet jet;
        mt_data_eval(p->data, def, &p->at, false, NULL, &jet);
        d += mt_jet_along(sys, def->body, &jet, stage->left.q);
    }
    return d;
}

/* Component of a bushing that a measure is. */
static int axis_of_measure(const mt_measure_def *m)
{
    return m->component + (m->kind == MT_MEASURE_ROTATION ? 3 : 0);
}

/* Force of one element of a spring on the measure of its side. */
static mt_cx element_force(const rest_place *p, int spring, int side)
{
    const mt_system *const sys = p->data->sys;
    const mt_spring_def *const s = &sys->springs[spring];
    const mt_stage *const stage = &p->lin->position.equilibrium;
    const int trim = mt_system_trim_of(sys, spring);
    if (trim >= 0 && stage->active) {
        return cx_make(stage->trim_force.of[trim] + stage->left.trim.of[trim],
                       p->slope ? stage->d_trim_force.of[trim] : 0.0);
    }
    const mt_cx k = mt_data_scalar(p->data, s->stiffness, 0.0);
    return s->measure[0] == s->measure[1]
               ? cx_mul(k, stretch(p, spring, 0)) + mt_data_scalar(p->data, s->preload, 0.0)
               : 0.5 * cx_mul(k, stretch(p, spring, 1 - side));
}

static mt_cx read_spring(const rest_place *p, const mt_static *q)
{
    const mt_system *const sys = p->data->sys;
    const mt_spring_def *const own = &sys->springs[q->index];
    mt_cx force = 0.0;
    for (int i = q->index; i < sys->n_springs; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        const bool named = s->name != NULL && own->name != NULL;
        if (i != q->index &&
            !(named && s->damper == own->damper && strcmp(s->name, own->name) == 0)) {
            continue;
        }
        for (int side = 0; side < (s->measure[0] == s->measure[1] ? 1 : 2); side++) {
            if (q->axis < 0 || axis_of_measure(&sys->measures[s->measure[side]]) == q->axis) {
                force += element_force(p, i, side);
            }
        }
    }
    return force;
}

/* Joints */

/* Arm from the centre of the joint's second body to its point there, as the body stands. */
static void arm_of(const rest_place *p, int joint, mt_cx out[3])
{
    const mt_system *const sys = p->data->sys;
    out[0] = out[1] = out[2] = 0.0;
    for (int i = 0; i < sys->n_constraints; i++) {
        const mt_measure_def *const def = &sys->measures[sys->constraints[i].measure[0]];
        const bool placed = def->kind == MT_MEASURE_PLANE || def->kind == MT_MEASURE_DISTANCE;
        if (sys->constraints[i].joint == joint && placed && def->point[1] >= 0) {
            cx_rotate3(mt_pose_of(p->at.pose, def->body[1])->r, p->data->vec[def->point[1]],
                       out);
            return;
        }
    }
}

/* What equation i does to the component: t_i of t . lambda. */
static mt_cx weight_of(const rest_place *p, int i, int axis, const mt_cx arm[3])
{
    const mt_system *const sys = p->data->sys;
    const mt_measure_def *const def = &sys->measures[sys->constraints[i].measure[0]];
    mt_jet jet;
    mt_cx moment[3];
    mt_data_eval(p->data, def, &p->at, false, NULL, &jet);
    if (axis < 3) {
        return -jet.g[6 + axis];
    }
    cx_cross3(arm, jet.g + 6, moment);
    return moment[axis - 3] - jet.g[6 + axis];
}

/* True where equation i of the joint acts: that of a drive does not where a spring holds it. */
static bool acts(const mt_system *sys, int i, int joint)
{
    return i < sys->n_constraints - sys->n_trims && sys->constraints[i].joint == joint;
}

static mt_cx multiplier(const rest_place *p, int i)
{
    const mt_stage *const stage = &p->lin->position.equilibrium;
    if (!stage->active) {
        return 0.0;
    }
    const double left = stage->left.lambda == NULL ? 0.0 : stage->left.lambda[i];
    return cx_make(stage->lambda[i] + left, p->slope ? stage->d_lambda[i] : 0.0);
}

static mt_cx read_joint(const rest_place *p, const mt_static *q)
{
    const mt_system *const sys = p->data->sys;
    mt_cx arm[3];
    mt_cx sum = 0.0;
    arm_of(p, q->index, arm);
    for (int i = 0; i < sys->n_constraints; i++) {
        if (acts(sys, i, q->index)) {
            sum += cx_mul(multiplier(p, i), weight_of(p, i, q->axis, arm));
        }
    }
    return sum;
}

/* Refuses a component that another distribution of forces among redundant joints changes. */
static mt_status admit_joint(mt_linear *lin, const rest_place *p, const mt_static *q,
                             mt_err *err)
{
    static const char *const names[] = {"x", "y", "z", "rx", "ry", "rz"};
    const mt_system *const sys = lin->sys;
    const ptrdiff_t m = lin->m;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const t = mt_arena_f64(&lin->scratch, (size_t)m, 1);
    double *const v = mt_arena_f64(&lin->scratch, (size_t)sys->nq, 1);
    double *const back = mt_arena_f64(&lin->scratch, (size_t)m, 1);
    mt_cx arm[3];
    double size = 0.0;
    double off = 0.0;
    if (mt_joint_kind_of(sys->joints[q->index].type)->couples) {
        return mt_fail(err, MT_E_USAGE, "joint \"%s\" has no bodies of its own, and no force",
                       sys->joints[q->index].name);
    }
    MT_TRY(mt_arena_check(&lin->scratch, err));
    if (mt_linear_redundant(lin) == 0) {
        mt_arena_rewind(&lin->scratch, mark);
        return MT_OK;
    }
    arm_of(p, q->index, arm);
    for (int i = 0; i < m; i++) {
        t[i] = acts(sys, i, q->index) ? creal(weight_of(p, i, q->axis, arm)) : 0.0;
    }
    MT_TRY(mt_eliminate_particular(&lin->e, t, v, &lin->scratch, err));
    memcpy(back, t, (size_t)m * sizeof *back);
    mt_gemv(false, lin->m, sys->nq, 1.0, lin->a, lin->m, v, -1.0, back);
    for (ptrdiff_t i = 0; i < m; i++) {
        size = fmax(size, lin->e.dr[i] * fabs(t[i]));
        off = fmax(off, lin->e.dr[i] * fabs(back[i]));
    }
    mt_arena_rewind(&lin->scratch, mark);
    return off <= DETERMINED * size
               ? MT_OK
               : mt_fail(err, MT_E_USAGE,
                         "joint \"%s\" is redundant with others in %s: what it carries there "
                         "is not determined",
                         sys->joints[q->index].name, names[q->axis]);
}

/* The equation of the drive of a joint, which is driven. */
static int drive_constraint(const mt_system *sys, int joint)
{
    return sys->drives[mt_system_drive_of(sys, joint)].constraint;
}

static mt_status admit_hold(const mt_system *sys, const mt_static *q, mt_err *err)
{
    const char *const name = sys->joints[q->index].name;
    const int drive = mt_system_drive_of(sys, q->index);
    const int spring = drive < 0 ? -1 : sys->drives[drive].spring;
    if (drive >= 0 && spring < 0) {
        return MT_OK;
    }
    return drive >= 0
               ? mt_fail(err, MT_E_USAGE,
                         "joint \"%s\" is held by a spring here: its force is \"spring.%s\"",
                         name, sys->springs[spring].name)
               : mt_fail(err, MT_E_USAGE, "joint \"%s\" is not driven here: nothing holds it",
                         name);
}

static mt_status admit(mt_linear *lin, const rest_place *p, const mt_static *q, mt_err *err)
{
    return q->kind == MT_STATIC_JOINT  ? admit_joint(lin, p, q, err)
           : q->kind == MT_STATIC_HOLD ? admit_hold(lin->sys, q, err)
                                       : MT_OK;
}

static mt_cx read_quantity(const rest_place *p, const mt_static *q)
{
    switch (q->kind) {
    case MT_STATIC_SENSOR:
        return read_sensor(p, q->index);
    case MT_STATIC_SPRING:
        return read_spring(p, q);
    case MT_STATIC_JOINT:
        return read_joint(p, q);
    case MT_STATIC_HOLD:
        return -multiplier(p, drive_constraint(p->data->sys, q->index));
    }
    return nan("");
}

/* Of a sensor: what is left of its motion to the balance. */
static double left_over(const mt_linear *lin, const mt_static *q)
{
    const mt_stage *const stage = &lin->position.equilibrium;
    const bool any = q->kind == MT_STATIC_SENSOR && stage->active && stage->left.q != NULL;
    return any ? mt_rows_dot(&lin->full[MT_TERM_CHANNEL],
                             lin->list[MT_TERM_CHANNEL].terms[q->index].first, stage->left.q)
               : 0.0;
}

mt_status mt_static_value(mt_linear *lin, const mt_static *q, double *value, mt_err *err)
{
    const rest_place p = {.lin = lin,
                          .data = &lin->data,
                          .reference = lin->position.reference.pose,
                          .at = lin->position.at};
    MT_TRY(admit(lin, &p, q, err));
    *value = creal(read_quantity(&p, q)) + left_over(lin, q);
    return MT_OK;
}

/* *known: input p leaves a derivative: redundant joints stay closed and redundant. */
static mt_status has_slope(mt_linear *lin, int p, bool *known, mt_err *err)
{
    mt_independence at;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    MT_TRY(mt_linear_independence(lin, p, &lin->scratch, &at, err));
    mt_arena_rewind(&lin->scratch, mark);
    *known = !at.opens && !at.blocks;
    return MT_OK;
}

/* Derivative by the data's input. */
static mt_status slope_by(mt_linear *lin, mt_data *data, const mt_static *q, mt_pose *reference,
                          mt_pose *pose, double *slope, mt_err *err)
{
    mt_state *const s = &lin->position;
    rest_place p = {
        .lin = lin, .data = data, .reference = reference, .at = s->at, .slope = true};
    MT_TRY(mt_position_tangent(s, data, &lin->scratch, err));
    mt_poses_tangent(lin->sys, s->reference.pose, s->d_reference, reference);
    mt_poses_tangent(lin->sys, s->at.pose, s->d_pose, pose);
    p.at.pose = pose;
    *slope = cx_derivative(read_quantity(&p, q));
    return MT_OK;
}

mt_status mt_static_slopes(mt_linear *lin, const mt_static *q, double *slope, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    const size_t n = (size_t)sys->n_bodies;
    if (!lin->graded) {
        return mt_fail(err, MT_E_INTERNAL, "slopes asked for without a gradient");
    }
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    mt_data data;
    MT_TRY(mt_data_init(&data, sys, &lin->scratch, err));
    mt_pose *const reference = mt_arena_alloc(&lin->scratch, n, sizeof *reference);
    mt_pose *const pose = mt_arena_alloc(&lin->scratch, n, sizeof *pose);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    data.value = lin->value;
    data.grad = lin->grad;
    for (int p = 0; p < sys->n_inputs; p++) {
        bool known = true;
        data.input = p;
        slope[p] = 0.0;
        if (mt_stages_has(lin->stages.loaded, p)) {
            MT_TRY(slope_by(lin, &data, q, reference, pose, &slope[p], err));
            MT_TRY(has_slope(lin, p, &known, err));
        }
        slope[p] = known ? slope[p] : nan("");
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

/* Compliance */

/* x[n] := K_r^-1 x for each of two columns; rows and columns of K_r scaled to a diagonal of 1,
 * so that stiffnesses of any units and sizes lose no digits. */
static mt_status solve_stiffness(const mt_linear *lin, double *x, mt_arena *mem, mt_err *err)
{
    const ptrdiff_t n = lin->n;
    double *const l = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const d = mt_arena_f64(mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t i = 0; i < n; i++) {
        const double k = lin->k[i + (i * n)];
        if (!(k > 0.0)) {
            return mt_fail(err, MT_E_NOT_SPD, "the tangent stiffness is not positive");
        }
        d[i] = 1.0 / sqrt(k);
    }
    for (ptrdiff_t j = 0; j < n; j++) {
        for (ptrdiff_t i = 0; i < n; i++) {
            l[i + (j * n)] = d[i] * lin->k[i + (j * n)] * d[j];
        }
    }
    MT_TRY(mt_cholesky(lin->n, l, NULL, err));
    for (ptrdiff_t i = 0; i < 2 * n; i++) {
        x[i] *= d[i % n];
    }
    mt_tri_solve(false, lin->n, 2, l, x, lin->n);
    mt_tri_solve(true, lin->n, 2, l, x, lin->n);
    for (ptrdiff_t i = 0; i < 2 * n; i++) {
        x[i] *= d[i % n];
    }
    return MT_OK;
}

/* dC by input p; xy: n x 2, of the input and of the output. */
static mt_status compliance_slope(mt_linear *lin, int p, const int channel[2], const double *xy,
                                  double *work, double *slope, mt_err *err)
{
    const double *const x = xy;
    const double *const y = xy + lin->n;
    const double *const none = work + ((ptrdiff_t)2 * lin->n); /* stays 0 */
    double by_out = 0.0;
    double by_in = 0.0;
    bool blocked[2] = {false, false};
    MT_TRY(mt_linear_blocked(lin, p, 2, xy, blocked, err));
    MT_TRY(mt_linear_products(lin, p, 1, x, work, work + lin->n, err));
    MT_TRY(mt_linear_sense_derivative(lin, p, 1, &channel[1], 1, x, none, &by_out, err));
    MT_TRY(mt_linear_sense_derivative(lin, p, 1, &channel[0], 1, y, none, &by_in, err));
    *slope = blocked[0] || blocked[1] ? nan("") : by_out + by_in - mt_dot(lin->n, y, work);
    return MT_OK;
}

mt_status mt_static_compliance(mt_linear *lin, int out, int in, double *value, double *slope,
                               mt_err *err)
{
    const ptrdiff_t n = lin->n;
    const int channel[2] = {in, out};
    const mt_term *const terms = lin->list[MT_TERM_CHANNEL].terms;
    mt_arena mem;
    MT_TRY(mt_arena_init(&mem, 0, err));
    double *const xy = mt_arena_f64(&mem, (size_t)n, 2);
    double *const work = mt_arena_f64(&mem, (size_t)n, 3);
    mt_status rc = mt_arena_check(&mem, err);
    if (rc != MT_OK) {
        goto done;
    }
    for (int k = 0; k < 2; k++) {
        memcpy(xy + (k * n), mt_linear_row(lin, MT_TERM_CHANNEL, terms[channel[k]].first),
               (size_t)n * sizeof *xy);
    }
    rc = solve_stiffness(lin, xy, &mem, err);
    if (rc != MT_OK) {
        goto done;
    }
    *value = mt_dot(lin->n, mt_linear_row(lin, MT_TERM_CHANNEL, terms[out].first), xy);
    rc = slope == NULL ? MT_OK : mt_linear_complete(lin, err);
    for (int p = 0; p < lin->sys->n_inputs && slope != NULL && rc == MT_OK; p++) {
        rc = compliance_slope(lin, p, channel, xy, work, &slope[p], err);
    }
done:
    mt_arena_free(&mem);
    return rc;
}
