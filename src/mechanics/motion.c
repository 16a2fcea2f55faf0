/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Derivation. T(g, v) = 1/2 sum_t c_t (f_t(g) . v)^2, f the rows of the masses (rows.h). A
 * variation that moves a body by (d, eta) changes its velocities by (d', eta' + eta x omega),
 * because R' = omega^ R and delta R = eta^ R. So, with the momenta p = M v, Hamilton's
 * principle gives for the translations and rotations of each body
 *     d/dt p_x = D_x T - D_x V + Q_x,
 *     d/dt p_theta = omega x p_theta + D_theta T - D_theta V + Q_theta,
 * D the derivative along a motion of the body with v held (Hamel's equations), or
 *     M v' = Q - D V + [0; omega x p_theta] + D T - (dM/dt) v.
 * A row has s = f . v and, along the motion, f' = df/dt; then (dM/dt) v = sum c (f' s + f (f'
 * . v)) and D_k T = sum c s (D_k f . v). f' and D_k f are complex steps. What this makes of a
 * rigid body is -omega x J omega: its rows turn with it, D T = -omega x p and (dM/dt) v = omega
 * x p. Translations of centres give nothing.
 *     A joint c(g) = 0 has c' = A v = 0 and A v' = -(dA/dt) v, dA/dt along the motion: the
 * derivative of the gradients that A consists of, again a complex step.
 */
#include "mechanics/motion.h"

#include "mechanics/linear_priv.h"

#include <math.h>
#include <string.h>

#include "mechanics/singular.h"

enum { ROOM_ROWS = 16 }; /* more than any term has (rows.h) */

mt_status mt_motion_init(mt_motion *o, mt_linear *lin, mt_arena *mem, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    const size_t nq = (size_t)sys->nq;
    *o = (mt_motion){.lin = lin, .nq = sys->nq, .m = lin->m};
    const size_t m = (size_t)o->m;
    o->mass = mt_arena_f64(mem, nq, nq);
    o->force = mt_arena_f64(mem, nq, 1);
    o->damping = mt_arena_f64(mem, nq, 1);
    o->own = mt_arena_f64(mem, nq, 1);
    o->a = mt_arena_f64(mem, m, nq);
    o->b = mt_arena_f64(mem, m, 1);
    o->gap = mt_arena_f64(mem, m, 1);
    o->rate = mt_arena_f64(mem, m, 1);
    o->tangent = mt_arena_alloc(mem, (size_t)sys->n_bodies, sizeof *o->tangent);
    o->probe = mt_arena_alloc(mem, (size_t)sys->n_bodies, sizeof *o->probe);
    for (int i = 0; i < 2; i++) {
        o->rows[i] = mt_arena_alloc(mem, (size_t)ROOM_ROWS * MT_LOCAL, sizeof(mt_cx));
    }
    return mt_lagrangian_init(&o->l, sys, false, mem, err);
}

/* The velocities of a term's bodies. */
static void local_velocity(const mt_system *sys, const int body[2], const double *v,
                           double out[MT_LOCAL])
{
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(sys, body, k);
        out[k] = dof >= 0 ? v[dof] : 0.0;
    }
}

static void add_local(const mt_system *sys, const int body[2], const double own[MT_LOCAL],
                      double *out)
{
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(sys, body, k);
        if (dof >= 0) {
            out[dof] += own[k];
        }
    }
}

static double row_times_motion(const mt_cx *row, const double v[MT_LOCAL])
{
    double s = 0.0;
    for (int k = 0; k < MT_LOCAL; k++) {
        s += creal(row[k]) * v[k];
    }
    return s;
}

static double slope_along(const mt_cx *row, const double v[MT_LOCAL])
{
    double s = 0.0;
    for (int k = 0; k < MT_LOCAL; k++) {
        s += cx_derivative(row[k]) * v[k];
    }
    return s;
}

/* A term as products of rows: number i of them is weight * (f g^T + g f^T)/2. */
static int products_of(const mt_term *t)
{
    return t->pair ? 1 : t->count;
}

/* (f s_g + g s_f)/2, s = f . v and g . v: such a product times v. */
static void add_times(double weight, const mt_cx *f, const mt_cx *g, const double v[MT_LOCAL],
                      double out[MT_LOCAL])
{
    const double sf = 0.5 * weight * row_times_motion(f, v);
    const double sg = 0.5 * weight * row_times_motion(g, v);
    for (int k = 0; k < MT_LOCAL; k++) {
        out[k] += (creal(f[k]) * sg) + (creal(g[k]) * sf);
    }
}

/* Its derivative along the motion times v. */
static void add_slope_times(double weight, const mt_cx *f, const mt_cx *g,
                            const double v[MT_LOCAL], double out[MT_LOCAL])
{
    const double half = 0.5 * weight;
    const double sf = half * row_times_motion(f, v);
    const double sg = half * row_times_motion(g, v);
    const double df = half * slope_along(f, v);
    const double dg = half * slope_along(g, v);
    for (int k = 0; k < MT_LOCAL; k++) {
        out[k] += (cx_derivative(f[k]) * sg) + (creal(f[k]) * dg);
        out[k] += (cx_derivative(g[k]) * sf) + (creal(g[k]) * df);
    }
}

/* matrix += weight (f g^T + g f^T)/2. */
static void add_symmetric_product(const mt_system *sys, const mt_term *t, double weight,
                                  const mt_cx *f, const mt_cx *g, double *matrix)
{
    int own[MT_LOCAL] = {0}; /* where one of them is not 0 */
    int dof[MT_LOCAL] = {0};
    int n = 0;
    for (int k = 0; k < MT_LOCAL; k++) {
        const bool none = creal(f[k]) == 0.0 && creal(g[k]) == 0.0;
        dof[n] = none ? -1 : mt_local_dof(sys, t->body, k);
        own[n] = k;
        n += dof[n] >= 0 ? 1 : 0;
    }
    for (int c = 0; c < n; c++) {
        const int j = own[c];
        for (int r = 0; r < n; r++) {
            const int i = own[r];
            matrix[dof[r] + ((ptrdiff_t)dof[c] * sys->nq)] +=
                0.5 * weight * ((creal(f[i]) * creal(g[j])) + (creal(g[i]) * creal(f[j])));
        }
    }
}

/* out[side's rotation] += sign omega x p. */
static void add_gyroscopic(double sign, const double v[MT_LOCAL], const double p[MT_LOCAL],
                           double out[MT_LOCAL])
{
    for (int side = 0; side < MT_LOCAL; side += 6) {
        const double *const w = v + side + 3;
        const double *const l = p + side + 3;
        double *const to = out + side + 3;
        to[0] += sign * ((w[1] * l[2]) - (w[2] * l[1]));
        to[1] += sign * ((w[2] * l[0]) - (w[0] * l[2]));
        to[2] += sign * ((w[0] * l[1]) - (w[1] * l[0]));
    }
}

/* out += D T of a term between two bodies: one complex step for each of their freedoms. */
static void add_kinetic_slope(mt_motion *o, const mt_placement *at, const mt_term *t,
                              double weight, const double v[MT_LOCAL], double out[MT_LOCAL])
{
    const mt_system *const sys = o->lin->sys;
    for (int k = 0; k < MT_LOCAL; k++) {
        const int body = t->body[k / 6];
        if (mt_local_dof(sys, t->body, k) < 0) {
            continue;
        }
        double unit[6] = {0.0};
        unit[k % 6] = 1.0;
        mt_pose_tangent(&o->probe[body], unit, unit + 3);
        mt_term_rows(&o->lin->data, MT_TERM_MASS, t, o->probe, o->rows[1]);
        o->probe[body] = at->pose[body];
        for (int r = 0; r < products_of(t); r++) {
            const mt_cx *const f = o->rows[1] + ((ptrdiff_t)r * MT_LOCAL);
            out[k] += weight * row_times_motion(f, v) * slope_along(f, v);
        }
    }
}

/* Add a term to M, and its velocity terms. */
static void add_inertia(mt_motion *o, const mt_placement *at, const mt_term *t,
                        const double *velocity)
{
    const mt_system *const sys = o->lin->sys;
    const mt_inertia_kind kind = sys->inertias[t->source].kind;
    const double weight = o->lin->value[t->coefficient];
    double v[MT_LOCAL];
    double p[MT_LOCAL] = {0.0};
    double force[MT_LOCAL] = {0.0};
    double change[MT_LOCAL] = {0.0}; /* (dM/dt) v */
    const bool moves = kind != MT_INERTIA_TRANSLATION && kind != MT_INERTIA_ROTATION;
    if (kind == MT_INERTIA_TRANSLATION) { /* of a centre: the same wherever it is */
        for (int k = 0; k < sys->dimension; k++) {
            const int dof = mt_local_dof(sys, t->body, k);
            if (dof >= 0) {
                o->mass[dof + ((ptrdiff_t)dof * sys->nq)] += weight;
            }
        }
        return;
    }
    local_velocity(sys, t->body, velocity, v);
    mt_term_rows(&o->lin->data, MT_TERM_MASS, t, o->tangent, o->rows[0]);
    for (int r = 0; r < products_of(t); r++) {
        const mt_cx *const f = o->rows[0] + ((ptrdiff_t)r * MT_LOCAL);
        const mt_cx *const g = t->pair ? f + MT_LOCAL : f;
        add_symmetric_product(sys, t, weight, f, g, o->mass);
        add_times(weight, f, g, v, p);
        if (moves) {
            add_slope_times(weight, f, g, v, change);
        }
    }
    if (kind == MT_INERTIA_ROTATION) {
        add_gyroscopic(-1.0, v, p, force);
    } else if (moves) {
        add_gyroscopic(1.0, v, p, force);
        add_kinetic_slope(o, at, t, weight, v, force);
    }
    for (int k = 0; k < MT_LOCAL; k++) {
        force[k] -= change[k];
    }
    add_local(sys, t->body, force, o->force);
}

static void add_dampers(mt_motion *o, const double *velocity)
{
    const mt_system *const sys = o->lin->sys;
    const mt_term_list *const list = &o->lin->list[MT_TERM_DAMPING];
    memset(o->damping, 0, (size_t)o->nq * sizeof *o->damping);
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        const double weight = o->lin->value[t->coefficient];
        double v[MT_LOCAL];
        double force[MT_LOCAL] = {0.0};
        local_velocity(sys, t->body, velocity, v);
        mt_term_rows(&o->lin->data, MT_TERM_DAMPING, t, o->tangent, o->rows[0]);
        for (int r = 0; r < products_of(t); r++) {
            const mt_cx *const f = o->rows[0] + ((ptrdiff_t)r * MT_LOCAL);
            add_times(weight, f, t->pair ? f + MT_LOCAL : f, v, force);
        }
        add_local(sys, t->body, force, o->damping);
    }
}

/* Add factor times a measure to row i of A, A v and b; squares: of its entries, and of their
 * change along the motion, turns as arcs. */
static void add_gradient(mt_motion *o, int i, const mt_measure_def *def, double factor,
                         const mt_relative_jet *jet, const double *v, double squares[2])
{
    const mt_system *const sys = o->lin->sys;
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(sys, def->body, k);
        const mt_cx g = mt_relative_sign(k) * jet->g[mt_relative_of(k)];
        if (dof < 0 || (creal(g) == 0.0 && cimag(g) == 0.0)) {
            continue;
        }
        const double a = factor * creal(g);
        const double slope = factor * cx_derivative(g);
        const double unit = k % 6 < 3 ? 1.0 : 1.0 / sys->length_m;
        o->a[i + ((ptrdiff_t)dof * o->m)] += a;
        o->rate[i] += a * v[dof];
        o->b[i] -= slope * v[dof];
        squares[0] += a * unit * a * unit;
        squares[1] += slope * unit * slope * unit;
    }
}

static void add_joints(mt_motion *o, const mt_placement *at, const double *v)
{
    const mt_data *const d = &o->lin->data;
    const mt_system *const sys = d->sys;
    mt_placement moving = *at;
    moving.pose = o->tangent;
    mt_relative_jet jet;
    memset(o->a, 0, (size_t)o->m * (size_t)o->nq * sizeof *o->a);
    o->swing = 0.0;
    for (int i = 0; i < o->m; i++) {
        double squares[2] = {0.0};
        const mt_constraint_def *const c = &sys->constraints[i];
        double value = -creal(mt_data_target(d, i, at));
        o->rate[i] = 0.0;
        o->b[i] = 0.0;
        for (int t = 0; t < c->terms; t++) {
            const mt_measure_def *const def = &sys->measures[c->measure[t]];
            const double factor = creal(mt_data_scalar(d, c->coefficient[t], 1.0));
            mt_data_relative(d, def, &moving, false, NULL, &jet);
            value += factor * creal(jet.value);
            add_gradient(o, i, def, factor, &jet, v, squares);
        }
        o->swing += squares[0] > 0.0 ? squares[1] / squares[0] : 0.0;
        o->gap[i] = value - mt_constraint_turns(d, i, value);
    }
    o->swing = sqrt(o->swing);
}

/* Springs and loads. A trimmed spring has its own force at the linearised position, and its
 * stiffness from there: both in its energy, too. */
static void add_energy(mt_motion *o, const mt_placement *at)
{
    const mt_linear *const lin = o->lin;
    const mt_system *const sys = lin->sys;
    const double *const held = lin->position.equilibrium.trim_force.of;
    double stored = 0.0;
    for (int i = 0; i < sys->n_trims; i++) {
        const mt_spring_def *const s =
            &sys->springs[sys->drives[sys->n_drives - sys->n_trims + i].spring];
        const mt_measure_def *const def = &sys->measures[s->measure[0]];
        const double way = creal(mt_data_value(&lin->data, def, at, NULL)) -
                           creal(mt_data_value(&lin->data, def, &lin->position.at, NULL));
        const double k = lin->value[s->stiffness];
        o->l.trim_force.of[i] = held[i] + (k * way);
        stored += way * (held[i] + (0.5 * k * way));
    }
    mt_lagrangian_eval(&lin->data, MT_ENERGY_PHYSICAL, lin->position.drawn, at, 0, NULL,
                       MT_CURVATURE_NONE, &o->l);
    o->potential = mt_energy_value(&lin->data, at, NULL, NULL) + stored;
}

void mt_motion_eval(mt_motion *o, const mt_placement *at, const double *v)
{
    const mt_system *const sys = o->lin->sys;
    const mt_term_list *const list = &o->lin->list[MT_TERM_MASS];
    const size_t nq = (size_t)o->nq;
    memset(o->mass, 0, nq * nq * sizeof *o->mass);
    mt_poses_tangent(sys, at->pose, v, o->tangent);
    memcpy(o->probe, at->pose, (size_t)sys->n_bodies * sizeof *o->probe);
    add_energy(o, at);
    add_dampers(o, v);
    for (size_t i = 0; i < nq; i++) {
        o->force[i] = -o->l.g[i] - o->damping[i];
    }
    for (int i = 0; i < list->n_terms; i++) {
        add_inertia(o, at, &list->terms[i], v);
    }
    mt_gemv(false, o->nq, o->nq, 1.0, o->mass, o->nq, v, 0.0, o->own);
    o->kinetic = 0.5 * mt_dot(o->nq, v, o->own);
    add_joints(o, at, v);
}

void mt_motion_base(mt_motion *o, const mt_placement *at, int axis, double factor, double *out)
{
    const mt_system *const sys = o->lin->sys;
    const mt_term_list *const list = &o->lin->list[MT_TERM_MASS];
    for (int b = 0; b < sys->n_bodies; b++) {
        const int dof = sys->bodies[b].dof[axis];
        if (dof >= 0) {
            mt_axpy(o->nq, -factor, o->mass + ((ptrdiff_t)dof * o->nq), out);
        }
    }
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        if (t->body[0] != MT_GROUND && t->body[1] != MT_GROUND) {
            continue;
        }
        const int held = t->body[0] == MT_GROUND ? axis : (MT_LOCAL / 2) + axis;
        const double weight = -factor * o->lin->value[t->coefficient];
        double own[MT_LOCAL] = {0.0};
        mt_term_rows(&o->lin->data, MT_TERM_MASS, t, at->pose, o->rows[0]);
        for (int r = 0; r < t->count; r++) {
            const mt_cx *const f = o->rows[0] + ((ptrdiff_t)r * MT_LOCAL);
            for (int k = 0; k < MT_LOCAL; k++) {
                own[k] += weight * creal(f[held]) * creal(f[k]);
            }
        }
        add_local(sys, t->body, own, out);
    }
}

void mt_motion_stiffness(mt_motion *o, const mt_placement *at, double *k)
{
    const mt_term_list *const list = &o->lin->list[MT_TERM_STIFFNESS];
    memset(k, 0, (size_t)o->nq * (size_t)o->nq * sizeof *k);
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        const double weight = o->lin->value[t->coefficient];
        mt_term_rows(&o->lin->data, MT_TERM_STIFFNESS, t, at->pose, o->rows[0]);
        for (int r = 0; r < products_of(t); r++) {
            const mt_cx *const f = o->rows[0] + ((ptrdiff_t)r * MT_LOCAL);
            add_symmetric_product(o->lin->sys, t, weight, f, t->pair ? f + MT_LOCAL : f, k);
        }
    }
}

void mt_motion_turns(const mt_motion *o, mt_placement *at)
{
    mt_data_turns(&o->lin->data, at);
}

mt_status mt_motion_nearness(const mt_motion *o, const mt_placement *at,
                             const mt_elimination *e, mt_arena *scratch, mt_arena *mem,
                             mt_nearness *out, mt_err *err)
{
    return mt_singular_nearness(&o->lin->data, at, e, scratch, mem, out, err);
}

bool mt_motion_has_value(const mt_system *sys, mt_gauge gauge)
{
    return gauge.channel < 0 || sys->channels[gauge.channel].kind == MT_CHANNEL_POINT;
}

/* Coordinate of a sensor's point along its axis. */
static double point_at(const mt_linear *lin, const mt_channel_def *c, const mt_pose *poses)
{
    static const mt_cx centre[3] = {0.0, 0.0, 0.0};
    const mt_pose *const pose = mt_pose_of(poses, c->body[0]);
    mt_cx s[3];
    cx_rotate3(pose->r, c->point < 0 ? centre : lin->data.vec[c->point], s);
    return creal(pose->x[c->axis]) + creal(s[c->axis]);
}

/* out->row and drift from a row over local freedoms. */
static void spread_row(const mt_system *sys, const int body[2], const mt_cx *row,
                       const double *v, mt_gauge_motion *out)
{
    memset(out->row, 0, (size_t)sys->nq * sizeof *out->row);
    out->drift = 0.0;
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(sys, body, k);
        if (dof >= 0) {
            out->row[dof] += creal(row[k]);
            out->drift += cx_derivative(row[k]) * v[dof];
        }
    }
}

void mt_motion_gauge(mt_motion *o, const mt_placement *at, const double *v, mt_gauge gauge,
                     mt_gauge_motion *out)
{
    const mt_linear *const lin = o->lin;
    const mt_system *const sys = lin->sys;
    if (gauge.channel >= 0) {
        const mt_channel_def *const c = &sys->channels[gauge.channel];
        mt_term_rows(&lin->data, MT_TERM_CHANNEL,
                     &lin->list[MT_TERM_CHANNEL].terms[gauge.channel], o->tangent, o->rows[0]);
        spread_row(sys, c->body, o->rows[0], v, out);
        out->value = c->kind == MT_CHANNEL_POINT
                         ? point_at(lin, c, at->pose) - point_at(lin, c, lin->position.at.pose)
                         : nan("");
        return;
    }
    const mt_measure_def *const def = &sys->measures[sys->joints[gauge.joint].coordinate];
    mt_placement moving = *at;
    moving.pose = o->tangent;
    mt_jet jet;
    mt_data_eval(&lin->data, def, &moving, false, NULL, &jet);
    spread_row(sys, def->body, jet.g, v, out);
    out->value = creal(jet.value) -
                 creal(mt_data_value(&lin->data, def, &lin->position.reference, NULL));
}

/* The same equations at rest. */

static mt_status evaluate_displaced(mt_linear *lin, const double *dq, mt_motion *o, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    mt_placement at;
    double *const still = mt_arena_f64(&lin->scratch, (size_t)sys->nq, 1);
    MT_TRY(mt_placement_init(&at, sys, &lin->scratch, err));
    MT_TRY(mt_motion_init(o, lin, &lin->scratch, err));
    mt_placement_copy(sys, &lin->position.at, &at);
    if (dq != NULL) {
        mt_poses_move(sys, at.pose, dq);
    }
    mt_motion_eval(o, &at, still);
    return MT_OK;
}

mt_status mt_displaced_eval(mt_linear *lin, const double *dq, double *m, double *q, double *a,
                            double *c, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    mt_motion o;
    MT_TRY(evaluate_displaced(lin, dq, &o, err));
    const size_t nq = (size_t)o.nq;
    memcpy(m, o.mass, nq * nq * sizeof *m);
    memcpy(q, o.force, nq * sizeof *q);
    memcpy(a, o.a, (size_t)o.m * nq * sizeof *a);
    if (c != NULL) {
        memcpy(c, o.gap, (size_t)o.m * sizeof *c);
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}
