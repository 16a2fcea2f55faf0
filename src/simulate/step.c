/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One step of a motion. Increments of rotations: with R = exp(u^) R_g and R' = omega^ R,
 *     u' = omega - 1/2 u x omega + c(|u|) u x (u x omega),   c(a) = (1 - a/2 cot(a/2))/a^2.
 * Work: inputs push with Q, dampers with -C v, and what holds the driven joint, lambda, along
 * its coordinate's velocity s': w' = Q . v - v . C v + lambda s'.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "simulate/collocate.h"

/* Gaps below so many rounding errors of the model's length are none. */
static const double CLOSED = 16.0 * DBL_EPSILON;
enum { CLOSING_STEPS = 4 };
/* Of independent equations the weakest, below which steps mind dead centres. */
static const double WEAK = 0.3;
/* So far a step may go then [rad, model lengths]: less than dead centres are seen from. */
static const double SEEN_FROM = 0.8 * MT_NEAR_DISTANCE;
static const double HALF_WAY = 0.5;
/* Nearer than this it is one [rad, model lengths]: accelerations are known to eps over it. */
static const double DEAD = 1e-6;

/* c(a); below SMALL its series, whose next term is a^6/1209600: < 1e-16 there. */
static double turn_factor(double a)
{
    static const double SMALL = 0.02;
    if (a < SMALL) {
        return (1.0 / 12.0) + (a * a / 720.0) + (a * a * a * a / 30240.0);
    }
    return (1.0 - (0.5 * a / tan(0.5 * a))) / (a * a);
}

/* out[nq] = u'. */
static void increments(const mt_system *sys, const double *u, const double *v, double *out)
{
    memcpy(out, v, (size_t)sys->nq * sizeof *out);
    for (int b = 0; b < sys->n_bodies && sys->dimension == 3; b++) {
        const int *const dof = sys->bodies[b].dof + 3;
        if (dof[0] < 0) {
            continue;
        }
        const double turn[3] = {u[dof[0]], u[dof[1]], u[dof[2]]};
        const double omega[3] = {v[dof[0]], v[dof[1]], v[dof[2]]};
        double once[3];
        double twice[3];
        mt_cross3(turn, omega, once);
        mt_cross3(turn, once, twice);
        const double c = turn_factor(mt_norm2(3, turn));
        for (int k = 0; k < 3; k++) {
            out[dof[k]] += (c * twice[k]) - (0.5 * once[k]);
        }
    }
}

static void add_base(const mt_sim *s, int axis, double acceleration, double *push)
{
    const mt_system *const sys = s->sys;
    for (int b = 0; b < sys->n_bodies; b++) {
        const int dof = sys->bodies[b].dof[axis];
        if (dof >= 0) {
            mt_axpy(s->nq, -acceleration, s->motion.mass + ((ptrdiff_t)dof * s->nq), push);
        }
    }
}

static int drive_of(const mt_sim *s)
{
    const int drive = s->sys->drive_constraint;
    return drive < s->m ? drive : -1;
}

/* The prescribed motion of the driven joint at t: position relative to its held one, velocity
 * and acceleration. */
static mt_status moved(const mt_sim *s, double t, double out[3], mt_err *err)
{
    memset(out, 0, 3 * sizeof *out);
    for (int i = 0; i < s->opt->n_inputs; i++) {
        if (s->opt->inputs[i].push == MT_SIM_MOVE) {
            double by[3];
            MT_TRY(mt_signal_eval(s->opt->inputs[i].signal, t, by, err));
            for (int k = 0; k < 3; k++) {
                out[k] += by[k];
            }
        }
    }
    return MT_OK;
}

/* s->push: forces of the inputs at t; s->motion is evaluated. */
static mt_status pushed(mt_sim *s, double t, const double *v, mt_err *err)
{
    memset(s->push, 0, (size_t)s->nq * sizeof *s->push);
    for (int i = 0; i < s->opt->n_inputs; i++) {
        const mt_sim_input *const in = &s->opt->inputs[i];
        double value[3];
        if (in->push == MT_SIM_MOVE) {
            continue;
        }
        MT_TRY(mt_signal_eval(in->signal, t, value, err));
        if (in->push == MT_SIM_BASE) {
            add_base(s, in->at, value[in->slope], s->push);
        } else {
            const mt_gauge g = {.channel = in->at, .joint = -1};
            mt_motion_gauge(&s->motion, &s->at, v, g, &s->gauge);
            mt_axpy(s->nq, value[0], s->gauge.row, s->push);
        }
    }
    return MT_OK;
}

/* s->at: the base moved by u, the drive where it is at t; drive[3]: moved. */
static mt_status move_placement(mt_sim *s, double t, const double *u, double drive[3],
                                mt_err *err)
{
    MT_TRY(moved(s, t, drive, err));
    mt_placement_copy(s->sys, &s->base, &s->at);
    mt_poses_move(s->sys, s->at.pose, u);
    s->at.drive = s->still + drive[0];
    return MT_OK;
}

/* Accelerations at s->at into out[nq]; power of what is not in the energy. */
static mt_status accelerate(mt_sim *s, double t, const double *v, const double drive[3],
                            double *out, double *power, mt_err *err)
{
    mt_motion *const o = &s->motion;
    const int d = drive_of(s);
    s->evaluations++;
    mt_motion_eval(o, &s->at, v);
    MT_TRY(pushed(s, t, v, err));
    memcpy(s->force, o->force, (size_t)s->nq * sizeof *s->force);
    mt_axpy(s->nq, 1.0, s->push, s->force);
    memcpy(s->b, o->b, (size_t)s->m * sizeof *s->b);
    if (d >= 0) {
        s->b[d] += drive[2];
    }
    const mt_gauss g = {.m = s->m, .mass = o->mass, .force = s->force, .a = o->a, .b = s->b};
    MT_TRY(mt_gauss_solve_near(&s->gauss, s->sys, &g, out, d >= 0 ? s->lambda : NULL, s->mem,
                               err));
    *power = mt_dot(s->nq, s->push, v) - mt_dot(s->nq, o->damping, v);
    *power += d >= 0 ? s->lambda[d] * drive[1] : 0.0;
    return MT_OK;
}

mt_status mt_sim_rates(mt_sim *s, double t, const double *u, const double *v, double *out,
                       double *rows, mt_err *err)
{
    double drive[3];
    MT_TRY(move_placement(s, t, u, drive, err));
    MT_TRY(accelerate(s, t, v, drive, out, out + s->nq, err));
    if (rows != NULL) {
        memcpy(rows, s->push, (size_t)s->nq * sizeof *rows);
        out[s->nq] -= mt_dot(s->nq, s->push, v);
    }
    for (int i = 0; i < s->opt->n_gauges; i++) {
        mt_motion_gauge(&s->motion, &s->at, v, s->opt->gauges[i], &s->gauge);
        out[s->nq + 1 + i] = rows == NULL ? mt_dot(s->nq, s->gauge.row, v) : 0.0;
        if (rows != NULL) {
            memcpy(rows + ((ptrdiff_t)(1 + i) * s->nq), s->gauge.row,
                   (size_t)s->nq * sizeof *rows);
        }
    }
    return MT_OK;
}

mt_status mt_sim_slope(void *sim, double t, const double *y, double *out, mt_err *err)
{
    mt_sim *const s = sim;
    increments(s->sys, y, y + s->nq, out);
    return mt_sim_rates(s, t, y, y + s->nq, out + s->nq, NULL, err);
}

mt_status mt_sim_advance(mt_sim *s, double t, double h, mt_err *err)
{
    memcpy(s->y, s->begin, (size_t)s->n * sizeof *s->y);
    if (s->collocation != NULL) {
        return mt_collocate(s, t, h, err);
    }
    return mt_ode_step(s->ode, t, h, s->y, s->slope, s->error, err);
}

/* The largest of x[m] as lengths: each over the length of its row of A in model lengths. */
static double as_length(const mt_elimination *e, const double *x)
{
    double most = 0.0;
    for (int i = 0; i < e->m; i++) {
        const double d = fabs(x[i]) * e->dr[i];
        most = !(d <= most) ? d : most;
    }
    return most;
}

/*
 * Limit steps near a dead centre. Where joints become dependent (a parallelogram in a line) the
 * motion may continue on more than one branch, and nearby accelerations are dominated by
 * rounding: a step across it could end on either branch. So a step goes at most half of the
 * distance to such a position, and one that leads into it is refused. The position is detected
 * from 0.05 rad (or model lengths) on (singular.h), which no step may exceed where the
 * equations are weak.
 */
static mt_status look_out(mt_sim *s, const mt_elimination *e, mt_err *err)
{
    mt_nearness near;
    s->rank = s->rank < 0 ? e->qr.rank : s->rank;
    mt_arena_clear(&s->names);
    MT_TRY(mt_motion_nearness(&s->motion, &s->at, e, s->mem, &s->names, &near, err));
    s->free_way = e->qr.kept < WEAK ? SEEN_FROM : HUGE_VAL;
    s->free_way = near.near ? HALF_WAY * near.distance : s->free_way;
    if (e->qr.rank == s->rank && !(near.near && near.distance < DEAD)) {
        return MT_OK;
    }
    return mt_fail(err, MT_E_DEAD_CENTRE,
                   "dead centre: joints %s become dependent here, and the motion can branch",
                   near.near ? near.joints.text : "of a loop");
}

/* Project s->at, with velocities v, onto the joints. */
static mt_status close_joints(mt_sim *s, double *v, const double drive[3], mt_err *err)
{
    mt_motion *const o = &s->motion;
    const int d = drive_of(s);
    for (int i = 0; i < CLOSING_STEPS && s->m > 0; i++) {
        mt_elimination e;
        mt_motion_eval(o, &s->at, v);
        s->evaluations++;
        MT_TRY(mt_eliminate_factor(s->sys, s->m, o->a, s->mem, &e, err));
        const double gap = as_length(&e, o->gap);
        s->gap_m = i == 0 ? fmax(s->gap_m, gap) : s->gap_m;
        const bool closed = gap <= CLOSED * s->sys->length_m;
        if (!closed && i + 1 < CLOSING_STEPS) {
            MT_TRY(mt_eliminate_particular(&e, o->gap, s->along, s->mem, err));
            for (int k = 0; k < s->nq; k++) {
                s->along[k] = -s->along[k];
            }
            mt_poses_move(s->sys, s->at.pose, s->along);
            continue;
        }
        s->left_m = fmax(s->left_m, gap);
        MT_TRY(look_out(s, &e, err));
        if (d >= 0) {
            o->rate[d] -= drive[1];
        }
        MT_TRY(mt_eliminate_particular(&e, o->rate, s->along, s->mem, err));
        mt_axpy(s->nq, -1.0, s->along, v);
        break;
    }
    return MT_OK;
}

/* Products of rotations lose orthogonality by rounding, step by step: R := R (3 - R^T R)/2, one
 * step of Newton's method for the nearest rotation. */
static void straighten(const mt_system *sys, mt_pose *poses)
{
    for (int b = 0; b < sys->n_bodies; b++) {
        double r[9];
        double g[9];
        for (int i = 0; i < 9; i++) {
            r[i] = creal(poses[b].r[i]);
        }
        mt_gemm(true, false, 3, 3, 3, -0.5, r, 3, r, 3, 0.0, g, 3);
        for (int i = 0; i < 9; i += 4) {
            g[i] += 1.5;
        }
        double out[9];
        mt_gemm(false, false, 3, 3, 3, 1.0, r, 3, g, 3, 0.0, out, 3);
        for (int i = 0; i < 9; i++) {
            poses[b].r[i] = out[i];
        }
    }
}

static mt_status begin_step(mt_sim *s, double t, mt_err *err)
{
    const double *const v = s->begin + s->nq;
    MT_TRY(mt_sim_slope(s, t, s->begin, s->slope, err));
    for (int i = 0; i < s->nq; i++) {
        s->fast = fmax(s->fast, s->weight[i] * fabs(v[i]));
    }
    const double length = s->sys->length_m;
    const mt_pose *const rest = mt_linear_position(s->lin)->at.pose;
    s->far = fmax(s->far, length * mt_poses_distance(s->sys, s->start.pose, s->base.pose));
    s->far = fmax(s->far, length * mt_poses_distance(s->sys, rest, s->base.pose));
    return MT_OK;
}

mt_status mt_sim_accept(mt_sim *s, double t, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(s->mem);
    double drive[3];
    memcpy(s->begin, s->y, (size_t)s->n * sizeof *s->begin);
    MT_TRY(move_placement(s, t, s->y, drive, err));
    MT_TRY(close_joints(s, s->begin + s->nq, drive, err));
    mt_arena_rewind(s->mem, mark);
    straighten(s->sys, s->at.pose);
    mt_motion_turns(&s->motion, &s->at);
    mt_placement_copy(s->sys, &s->at, &s->base);
    mt_collocation_accept(s, t);
    memset(s->begin, 0, (size_t)s->nq * sizeof *s->begin);
    return begin_step(s, t, err);
}

static double base_acceleration(const mt_sim *s, int axis, double t, mt_err *err, mt_status *rc)
{
    double sum = 0.0;
    for (int i = 0; i < s->opt->n_inputs && *rc == MT_OK; i++) {
        const mt_sim_input *const in = &s->opt->inputs[i];
        double value[3] = {0.0, 0.0, 0.0};
        if (in->push == MT_SIM_BASE && in->at == axis) {
            *rc = mt_signal_eval(in->signal, t, value, err);
        }
        sum += value[in->slope];
    }
    return sum;
}

/* Read a gauge relative to the ground, at s->at, where s->motion was evaluated, with
 * accelerations a. */
static void read_gauge(mt_sim *s, int gauge, const double *y, const double *a, double out[3])
{
    const mt_gauge g = s->opt->gauges[gauge];
    const double *const v = y + s->nq;
    mt_motion_gauge(&s->motion, &s->at, v, g, &s->gauge);
    out[0] =
        mt_motion_has_value(s->sys, g) ? s->gauge.value : y[((ptrdiff_t)2 * s->nq) + 1 + gauge];
    out[1] = mt_dot(s->nq, s->gauge.row, v);
    out[2] = mt_dot(s->nq, s->gauge.row, a) + s->gauge.drift;
}

mt_status mt_sim_gauge(mt_sim *s, double t, int gauge, double out[3], mt_err *err)
{
    const int channel = s->opt->gauges[gauge].channel;
    mt_status rc = MT_OK;
    read_gauge(s, gauge, s->begin, s->slope + s->nq, out);
    if (channel >= 0) {
        const mt_channel_def *const c = &s->sys->channels[channel];
        out[2] += mt_channel_turns(c->kind) ? 0.0 : base_acceleration(s, c->axis, t, err, &rc);
    }
    return rc;
}

mt_status mt_sim_ahead(mt_sim *s, double t, mt_err *err)
{
    return mt_sim_slope(s, t, s->y, s->probe, err);
}

void mt_sim_gauge_ahead(mt_sim *s, int gauge, double out[3])
{
    read_gauge(s, gauge, s->y, s->probe + s->nq, out);
}

static mt_status allocate_step_work(mt_sim *s, mt_err *err)
{
    const size_t nq = (size_t)s->nq;
    const size_t m = (size_t)s->m;
    const size_t n = (size_t)s->n;
    MT_TRY(mt_motion_init(&s->motion, s->lin, s->mem, err));
    MT_TRY(mt_gauss_near_init(&s->gauss, s->sys, s->motion.m, s->mem, err));
    MT_TRY(mt_placement_init(&s->start, s->sys, s->mem, err));
    MT_TRY(mt_placement_init(&s->base, s->sys, s->mem, err));
    MT_TRY(mt_placement_init(&s->at, s->sys, s->mem, err));
    double **const of_n[] = {&s->y, &s->begin, &s->slope, &s->error, &s->probe};
    double **const of_nq[] = {&s->along, &s->push, &s->force, &s->weight, &s->gauge.row};
    for (int i = 0; i < MT_COUNT(of_n); i++) {
        *of_n[i] = mt_arena_f64(s->mem, n, 1);
    }
    for (int i = 0; i < MT_COUNT(of_nq); i++) {
        *of_nq[i] = mt_arena_f64(s->mem, nq, 1);
    }
    s->b = mt_arena_f64(s->mem, m, 1);
    s->lambda = mt_arena_f64(s->mem, m, 1);
    s->speed = mt_arena_f64(s->mem, (size_t)s->opt->n_gauges, 1);
    return mt_arena_check(s->mem, err);
}

mt_status mt_sim_init(mt_sim *s, mt_linear *lin, const mt_sim_start *start,
                      const mt_sim_options *opt, mt_arena *mem, mt_err *err)
{
    const mt_system *const sys = mt_linear_system(lin);
    *s = (mt_sim){.lin = lin, .sys = sys, .opt = opt, .mem = mem, .nq = sys->nq, .rank = -1};
    s->free_way = HUGE_VAL;
    s->m = mt_linear_equations(lin);
    s->n = (2 * s->nq) + 1 + opt->n_gauges;
    MT_TRY(allocate_step_work(s, err));
    for (int b = 0; b < sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            if (sys->bodies[b].dof[k] >= 0) {
                s->weight[sys->bodies[b].dof[k]] = k < 3 ? 1.0 : sys->length_m;
            }
        }
    }
    s->still = mt_linear_position(lin)->at.drive;
    mt_placement_copy(sys, &start->at, &s->start);
    mt_placement_copy(sys, &start->at, &s->base);
    memcpy(s->y + s->nq, start->v, (size_t)s->nq * sizeof *s->y);
    MT_TRY(mt_arena_init(&s->names, 0, err));
    MT_TRY(mt_ode_new(s->n, mt_sim_slope, s, &s->ode, err));
    return mt_sim_accept(s, 0.0, err);
}

void mt_sim_free(mt_sim *s)
{
    mt_ode_delete(s->ode);
    mt_arena_free(&s->names);
    s->ode = NULL;
}
