/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * When a measure is affine in y. A vector s of a body stays where it is while the body does not
 * turn, or turns about an axis along s ("steady"). With d = Q_b - P_a:
 *     PLANE     u_a . d: u steady, and each point's vector steady or its body's axis along u;
 *               or d itself steady on a, along its axis or 0 (two discs on one shaft)
 *     DISTANCE  |d|: points steady, and d moves along itself or not at all
 *     ANGLE     about an axis n of body a: what turns, turns about n
 *     DOT       u_a . v_b, which joints hold: constant where one is steady and the other's body
 *               turns about it, or both turn together
 *     ROTATION  no body turns; BEAM: no body moves
 * Positions reached so fulfil the joints at any y. What is smaller than rounding of the basis
 * is 0 here; simulate/propagate.c puts the motion that follows into the whole equations.
 */
#include "mechanics/affine.h"

#include "mechanics/linear_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Entries of an orthonormal basis (rotations as arcs at the model's length) below this are
 * rounding. */
static const double NOISE = 1024.0 * DBL_EPSILON;

static double norm3(const double *v)
{
    return mt_norm2(3, v);
}

static bool is_parallel(const double *a, const double *b)
{
    double c[3];
    mt_cross3(a, b, c);
    return norm3(c) <= NOISE * norm3(a) * norm3(b);
}

/* A vector of the drawing at the linearised position; 0 without one. */
static void vector_at(const mt_linear *lin, int body, int vector, double out[3])
{
    mt_cx v[3] = {0.0, 0.0, 0.0};
    if (vector >= 0) {
        cx_rotate3(mt_pose_of(lin->position.at.pose, body)->r, lin->data.vec[vector], v);
    }
    for (int k = 0; k < 3; k++) {
        out[k] = creal(v[k]);
    }
}

static bool body_turns(const mt_affine *a, int body)
{
    return body >= 0 && a->body[body].turns;
}

static bool body_moves(const mt_affine *a, int body)
{
    return body >= 0 && a->body[body].moves;
}

static bool is_steady(const mt_affine *a, int body, const double s[3])
{
    return !body_turns(a, body) || is_parallel(s, a->body[body].axis);
}

/* True where the component of a body's vector s along the constant vector u is constant. */
static bool is_steady_along(const mt_affine *a, int body, const double s[3], const double u[3])
{
    return is_steady(a, body, s) || is_parallel(u, a->body[body].axis);
}

/* Translation of body b against body a with freedom j. */
static void relative_way(const mt_linear *lin, const mt_affine *a, const int body[2], int j,
                         double out[3])
{
    const double *const z = a->z + ((ptrdiff_t)j * a->nq);
    for (int k = 0; k < 3; k++) {
        const int from = body[0] >= 0 ? lin->sys->bodies[body[0]].dof[k] : -1;
        const int to = body[1] >= 0 ? lin->sys->bodies[body[1]].dof[k] : -1;
        out[k] = (to >= 0 ? z[to] : 0.0) - (from >= 0 ? z[from] : 0.0);
    }
}

/* True where the vector between the centres is constant, or (along not NULL) changes along that
 * direction only. */
static bool moves_along(const mt_linear *lin, const mt_affine *a, const int body[2],
                        const double *along)
{
    for (int j = 0; j < a->n; j++) {
        double way[3];
        relative_way(lin, a, body, j, way);
        const double part = along == NULL ? 0.0 : mt_dot(3, way, along);
        for (int k = 0; k < 3; k++) {
            if (!(fabs(way[k] - (along == NULL ? 0.0 : part * along[k])) <= NOISE)) {
                return false;
            }
        }
    }
    return true;
}

static bool turn_together(const mt_affine *a, const int body[2])
{
    if (!body_turns(a, body[0]) || !body_turns(a, body[1])) {
        return !body_turns(a, body[0]) && !body_turns(a, body[1]);
    }
    const mt_affine_body *const p = &a->body[body[0]];
    const mt_affine_body *const q = &a->body[body[1]];
    const double sign = mt_dot(3, p->axis, q->axis) < 0.0 ? -1.0 : 1.0;
    bool same = is_parallel(p->axis, q->axis);
    const double most = mt_max_abs(a->n, p->rate);
    for (int j = 0; j < a->n; j++) {
        same = same && fabs(p->rate[j] - (sign * q->rate[j])) <= NOISE * most;
    }
    return same;
}

/* P_a, Q_b from the bodies' centres, and d. */
typedef struct apart {
    double p[3];
    double q[3];
    double d[3];
} apart;

static apart points_of(const mt_linear *lin, const mt_measure_def *m)
{
    apart o = {.d = {0.0}};
    vector_at(lin, m->body[0], m->point[0], o.p);
    vector_at(lin, m->body[1], m->point[1], o.q);
    for (int k = 0; k < 3; k++) {
        o.d[k] = creal(mt_pose_of(lin->position.at.pose, m->body[1])->x[k]) + o.q[k] -
                 creal(mt_pose_of(lin->position.at.pose, m->body[0])->x[k]) - o.p[k];
    }
    return o;
}

static bool is_affine_plane(const mt_linear *lin, const mt_affine *a, const mt_measure_def *m)
{
    const apart o = points_of(lin, m);
    double u[3];
    vector_at(lin, m->body[0], m->dir[0], u);
    if (is_steady(a, m->body[0], u)) {
        return is_steady_along(a, m->body[0], o.p, u) && is_steady_along(a, m->body[1], o.q, u);
    }
    const bool none = norm3(o.d) <= NOISE * lin->sys->length_m;
    return is_steady(a, m->body[0], o.p) && is_steady(a, m->body[1], o.q) &&
           (none || is_steady(a, m->body[0], o.d)) && moves_along(lin, a, m->body, NULL);
}

static bool is_affine_distance(const mt_linear *lin, const mt_affine *a,
                               const mt_measure_def *m)
{
    const apart o = points_of(lin, m);
    const double length = norm3(o.d);
    if (!is_steady(a, m->body[0], o.p) || !is_steady(a, m->body[1], o.q) || !(length > 0.0)) {
        return false;
    }
    const double along[3] = {o.d[0] / length, o.d[1] / length, o.d[2] / length};
    return moves_along(lin, a, m->body, along);
}

static bool is_affine_angle(const mt_linear *lin, const mt_affine *a, const mt_measure_def *m)
{
    double b[3];
    double c[3];
    vector_at(lin, m->body[0], m->dir[0], b);
    vector_at(lin, m->body[0], m->dir[1], c);
    double n[3];
    mt_cross3(b, c, n);
    return is_steady(a, m->body[0], n) && is_steady(a, m->body[1], n);
}

static bool is_affine_dot(const mt_linear *lin, const mt_affine *a, const mt_measure_def *m)
{
    double u[3];
    double v[3];
    vector_at(lin, m->body[0], m->dir[0], u);
    vector_at(lin, m->body[1], m->dir[1], v);
    return turn_together(a, m->body) ||
           (is_steady(a, m->body[0], u) && is_steady_along(a, m->body[1], v, u)) ||
           (is_steady(a, m->body[1], v) && is_steady_along(a, m->body[0], u, v));
}

static bool is_affine(const mt_linear *lin, const mt_affine *a, const mt_measure_def *m)
{
    switch (m->kind) {
    case MT_MEASURE_PLANE:
        return is_affine_plane(lin, a, m);
    case MT_MEASURE_DOT:
        return is_affine_dot(lin, a, m);
    case MT_MEASURE_DISTANCE:
        return is_affine_distance(lin, a, m);
    case MT_MEASURE_ANGLE:
        return is_affine_angle(lin, a, m);
    case MT_MEASURE_ROTATION:
        return !body_turns(a, m->body[0]) && !body_turns(a, m->body[1]);
    case MT_MEASURE_BEAM:
        return !body_moves(a, m->body[0]) && !body_moves(a, m->body[1]);
    }
    return false;
}

/* Axis about which y rotates body b; *fixed false where there is more than one. */
static void find_axis(const mt_linear *lin, const mt_affine *a, int b, bool *fixed)
{
    mt_affine_body *const out = &a->body[b];
    const int *const dof = lin->sys->bodies[b].dof;
    const double noise = NOISE / lin->sys->length_m;
    double most = 0.0;
    for (int j = 0; j < a->n; j++) {
        const double *const z = a->z + ((ptrdiff_t)j * a->nq);
        double turn[3];
        for (int k = 0; k < 3; k++) {
            out->moves = out->moves || (dof[k] >= 0 && fabs(z[dof[k]]) > NOISE);
            turn[k] = dof[3 + k] >= 0 ? z[dof[3 + k]] : 0.0;
        }
        const double size = norm3(turn);
        for (int k = 0; k < 3 && size > most; k++) {
            out->axis[k] = turn[k] / size;
        }
        most = fmax(most, size);
    }
    out->turns = most > noise;
    out->moves = out->moves || out->turns;
    for (int j = 0; j < a->n && out->turns; j++) {
        const double *const z = a->z + ((ptrdiff_t)j * a->nq);
        double turn[3];
        for (int k = 0; k < 3; k++) {
            turn[k] = dof[3 + k] >= 0 ? z[dof[3 + k]] : 0.0;
        }
        out->rate[j] = mt_dot(3, turn, out->axis);
        for (int k = 0; k < 3; k++) {
            const double off = turn[k] - (out->rate[j] * out->axis[k]);
            *fixed = *fixed && fabs(off) <= noise;
        }
    }
}

static bool has_linear_masses(const mt_linear *lin, const mt_affine *a)
{
    const mt_system *const sys = lin->sys;
    bool linear = true;
    for (int i = 0; i < sys->n_inertias; i++) {
        const mt_inertia_def *const m = &sys->inertias[i];
        double s[3];
        switch (m->kind) {
        case MT_INERTIA_TRANSLATION:
        case MT_INERTIA_ROTATION: /* about a fixed axis: constant */
            break;
        case MT_INERTIA_BAR:
            for (int k = 0; k < 2; k++) {
                vector_at(lin, m->body[k], m->point[k], s);
                linear = linear && is_steady(a, m->body[k], s);
            }
            break;
        case MT_INERTIA_BEAM:
        case MT_INERTIA_BEAM_TWIST:
        case MT_INERTIA_BEAM_ROTARY:
            linear = linear && !body_moves(a, m->body[0]) && !body_moves(a, m->body[1]);
            break;
        }
    }
    return linear;
}

static bool has_linear_forces(const mt_linear *lin, const mt_affine *a, const bool *affine)
{
    const mt_system *const sys = lin->sys;
    bool linear = true;
    for (int i = 0; i < sys->n_springs; i++) {
        linear = linear && affine[sys->springs[i].measure[0]];
        linear = linear && affine[sys->springs[i].measure[1]];
    }
    for (int i = 0; i < sys->n_loads; i++) {
        const mt_load_def *const l = &sys->loads[i];
        if (l->measure >= 0) {
            linear = linear && affine[l->measure];
        } else {
            double s[3];
            vector_at(lin, l->body, l->point, s);
            linear = linear && is_steady(a, l->body, s);
        }
    }
    return linear;
}

static bool has_linear_joints(const mt_linear *lin, const bool *affine)
{
    bool linear = true;
    for (int i = 0; i < lin->sys->n_constraints; i++) {
        const mt_constraint_def *const c = &lin->sys->constraints[i];
        for (int t = 0; t < c->terms; t++) {
            linear = linear && affine[c->measure[t]];
        }
    }
    return linear;
}

/* slope[n]: of the measure with y. */
static void slope_of(const mt_linear *lin, const mt_affine *a, const mt_measure_def *m,
                     double *slope)
{
    mt_jet jet;
    mt_data_eval(&lin->data, m, &lin->position.at, false, NULL, &jet);
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(lin->sys, m->body, k);
        for (ptrdiff_t j = 0; j < a->n && dof >= 0; j++) {
            slope[j] += creal(jet.g[k]) * a->z[dof + (j * a->nq)];
        }
    }
}

static mt_status make_measures(const mt_linear *lin, mt_affine *a, bool *affine, mt_arena *mem,
                               mt_err *err)
{
    const mt_system *const sys = lin->sys;
    double *const slope = mt_arena_f64(mem, (size_t)a->n, (size_t)sys->n_measures);
    a->length = mt_arena_alloc(mem, (size_t)sys->n_measures, sizeof *a->length);
    a->slope = slope;
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < sys->n_measures; i++) {
        const mt_measure_def *const m = &sys->measures[i];
        double *const own = slope + ((ptrdiff_t)i * a->n);
        affine[i] = is_affine(lin, a, m);
        if (!affine[i]) {
            continue;
        }
        slope_of(lin, a, m, own);
        if (m->kind == MT_MEASURE_DISTANCE) {
            const apart o = points_of(lin, m);
            a->length[a->n_lengths++] = (mt_affine_length){norm3(o.d), own};
        }
    }
    return MT_OK;
}

mt_status mt_affine_make(mt_linear *lin, mt_arena *mem, mt_affine *out, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    const size_t n = (size_t)lin->n;
    *out = (mt_affine){.n = lin->n, .nq = sys->nq, .z = lin->e.z};
    out->body = mt_arena_alloc(mem, (size_t)sys->n_bodies, sizeof *out->body);
    bool *const affine = mt_arena_alloc(mem, (size_t)sys->n_measures, sizeof *affine);
    double *const rate = mt_arena_f64(mem, n, (size_t)sys->n_bodies);
    MT_TRY(mt_arena_check(mem, err));
    bool fixed = lin->n_free_spins == 0;
    for (int b = 0; b < sys->n_bodies; b++) {
        out->body[b].rate = rate + ((ptrdiff_t)b * lin->n);
        find_axis(lin, out, b, &fixed);
    }
    if (!fixed) {
        return MT_OK;
    }
    MT_TRY(make_measures(lin, out, affine, mem, err));
    out->linear = has_linear_joints(lin, affine) && has_linear_forces(lin, out, affine) &&
                  has_linear_masses(lin, out);
    return MT_OK;
}

bool mt_affine_gauge(const mt_linear *lin, const mt_affine *a, mt_gauge gauge)
{
    const mt_system *const sys = lin->sys;
    if (gauge.channel < 0) {
        return is_affine(lin, a, &sys->measures[sys->joints[gauge.joint].coordinate]);
    }
    const mt_channel_def *const c = &sys->channels[gauge.channel];
    double s[3];
    switch (c->kind) {
    case MT_CHANNEL_POINT:
        vector_at(lin, c->body[0], c->point, s);
        return is_steady(a, c->body[0], s);
    case MT_CHANNEL_ROTATION:
        return true;
    case MT_CHANNEL_BEAM_POINT:
    case MT_CHANNEL_BEAM_ROTATION:
        return !body_moves(a, c->body[0]) && !body_moves(a, c->body[1]);
    }
    return false;
}

void mt_affine_position(const mt_linear *lin, const mt_affine *a, const double *y, double *work,
                        mt_placement *at)
{
    const mt_system *const sys = lin->sys;
    const mt_placement *const rest = &lin->position.at;
    mt_placement_copy(sys, rest, at);
    mt_gemv(false, a->nq, a->n, 1.0, a->z, a->nq, y, 0.0, work);
    mt_poses_move(sys, at->pose, work);
    for (int i = 0; i < sys->n_measures; i++) {
        if (sys->measures[i].kind == MT_MEASURE_ANGLE) {
            at->turn[i] = rest->turn[i] + mt_dot(a->n, a->slope + ((ptrdiff_t)i * a->n), y);
        }
    }
}
