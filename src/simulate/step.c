/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One step of a motion: by the pair of GSL, or, where springs make it stiff, by collocation
 * (step_collocate.c). */
#include "simulate/step.h"

#include <float.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/arena.h"
#include "linalg/dense.h"
#include "mechanics/eliminate.h"

/* out[n] = f(t, y[n]). Its failure ends the step, which fails with the same status. */
typedef mt_status (*ode_slope)(void *context, double t, const double *y, double *out,
                               mt_err *err);

static void ode_delete(mt_ode *ode); /* accepts NULL */

/* Steps of an ordinary differential equation. */

struct mt_ode {
    int n;
    ode_slope slope;
    void *context;
    gsl_odeiv2_step *step;
    gsl_odeiv2_system system;
    double *before; /* [n] */
    mt_status rc;   /* of the last evaluation that failed */
    mt_err *err;
};

static int evaluate_slope(double t, const double y[], double out[], void *context)
{
    mt_ode *const ode = context;
    ode->rc = ode->slope(ode->context, t, y, out, ode->err);
    return ode->rc == MT_OK ? GSL_SUCCESS : GSL_EBADFUNC;
}

/* *out is the caller's. Fails: MT_E_MEMORY, provided that the process has called
 * gsl_set_error_handler_off (a decision of the program); else GSL ends the process. */
static mt_status ode_new(int n, ode_slope slope, void *context, mt_ode **out, mt_err *err)
{
    mt_ode *const ode = calloc(1, sizeof *ode);
    *out = NULL;
    if (ode == NULL) {
        return mt_fail_memory(err);
    }
    ode->n = n;
    ode->slope = slope;
    ode->context = context;
    ode->before = calloc((size_t)n, sizeof *ode->before);
    ode->step = gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, (size_t)n);
    ode->system = (gsl_odeiv2_system){evaluate_slope, NULL, (size_t)n, ode};
    if (ode->before == NULL || ode->step == NULL) {
        ode_delete(ode);
        return mt_fail_memory(err);
    }
    *out = ode;
    return MT_OK;
}

static void ode_delete(mt_ode *ode)
{
    if (ode != NULL) {
        if (ode->step != NULL) {
            gsl_odeiv2_step_free(ode->step);
        }
        free(ode->before);
        free(ode);
    }
}

static bool all_finite(int n, const double *x)
{
    bool finite = true;
    for (int i = 0; i < n; i++) {
        finite = finite && isfinite(x[i]);
    }
    return finite;
}

/* Replace y[n] at t by y at t + h; error[n]: the difference of the two orders; slope_in[n]: the
 * known f(t, y). On failure y is unchanged. No heap. Fails as f; MT_E_DOMAIN: a number is not
 * finite. */
static mt_status ode_step(mt_ode *ode, double t, double h, double *y, const double *slope_in,
                          double *error, mt_err *err)
{
    const size_t size = (size_t)ode->n * sizeof *y;
    memcpy(ode->before, y, size);
    ode->rc = MT_OK;
    ode->err = err;
    const int status =
        gsl_odeiv2_step_apply(ode->step, t, h, y, error, slope_in, NULL, &ode->system);
    ode->err = NULL;
    if (status == GSL_SUCCESS && all_finite(ode->n, y) && all_finite(ode->n, error)) {
        return MT_OK;
    }
    memcpy(y, ode->before, size);
    return ode->rc != MT_OK ? ode->rc
                            : mt_fail(err, MT_E_DOMAIN, "the motion has no finite value");
}

/* Successive solutions for accelerations. */

/*
 * With an inverse B of the matrix K of both equations, x and lambda at once, at an earlier
 * position, x <- x + B (rhs - K x) contracts by |1 - B K|, which is about what the position has
 * changed by; the limit is that of K, to what rounding leaves of rhs - K x.
 */

/* So many unknowns have an inverse: for fewer an elimination takes no longer, and what it
 * rounds is less where forces are large against accelerations; more would take 8 MB. */
enum { INVERSE_LEAST = 16, INVERSE_MOST = 1000 };
/* An inverse serves while each correction is at most this part of the one before, and few are
 * enough. */
static const double CONTRACTION = 0.1;
enum { CORRECTIONS = 10 };
/* Corrections below this part of the solution that shrink no more are rounding. */
static const double ROUNDED = 1e-13;
/* Of the equations that have an inverse: what is left of its digits makes up for it. */
static const double REGULAR = 1e-10;
/* An inverse that has served so often was worth its while: it is ten eliminations. */
enum { WORTH = 20 };

mt_status mt_gauss_near_init(mt_gauss_near *o, const mt_system *sys, int m, mt_arena *mem,
                             mt_err *err)
{
    const int n = sys->nq + m;
    *o = (mt_gauss_near){.n = n >= INVERSE_LEAST && n <= INVERSE_MOST ? n : 0};
    o->inverse = mt_arena_f64(mem, (size_t)o->n, (size_t)o->n);
    o->scale = mt_arena_f64(mem, (size_t)o->n, 1);
    o->x = mt_arena_f64(mem, (size_t)o->n, 1);
    o->rest = mt_arena_f64(mem, (size_t)o->n, 1);
    o->step = mt_arena_f64(mem, (size_t)o->n, 1);
    return mt_arena_check(mem, err);
}

/* Scales by which masses are at most 1 and the rows of A have length 1; angles count as
 * displacements at the model length. */
static void find_scale(const mt_system *sys, const mt_gauss *g, double *scale)
{
    const ptrdiff_t nq = sys->nq;
    double most = 0.0;
    for (int b = 0; b < sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            const int dof = sys->bodies[b].dof[k];
            if (dof >= 0) {
                scale[dof] = k < 3 ? 1.0 : 1.0 / sys->length_m;
            }
        }
    }
    for (ptrdiff_t j = 0; j < nq; j++) {
        most = fmax(most, scale[j] * g->mass[j + (j * nq)] * scale[j]);
    }
    for (ptrdiff_t i = 0; i < g->m; i++) {
        double squares = 0.0;
        for (ptrdiff_t j = 0; j < nq; j++) {
            const double a = scale[j] * g->a[i + (j * g->m)];
            squares += a * a;
        }
        scale[nq + i] = squares > 0.0 && most > 0.0 ? sqrt(most / squares) : 1.0;
    }
}

/* The inverse at a position; o->known: the equations are regular. */
static mt_status make_inverse(mt_gauss_near *o, const mt_system *sys, const mt_gauss *g,
                              mt_arena *mem, mt_err *err)
{
    const ptrdiff_t n = o->n;
    const ptrdiff_t nq = sys->nq;
    double rcond = 0.0;
    double *const k = mt_arena_f64(mem, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(mem, err));
    find_scale(sys, g, o->scale);
    for (ptrdiff_t j = 0; j < nq; j++) {
        for (ptrdiff_t i = 0; i < nq; i++) {
            k[i + (j * n)] = o->scale[i] * g->mass[i + (j * nq)] * o->scale[j];
        }
        for (ptrdiff_t i = 0; i < g->m; i++) {
            const double a = o->scale[nq + i] * g->a[i + (j * g->m)] * o->scale[j];
            k[nq + i + (j * n)] = a;
            k[j + ((nq + i) * n)] = -a;
        }
    }
    memset(o->inverse, 0, (size_t)(n * n) * sizeof *o->inverse);
    for (ptrdiff_t i = 0; i < n; i++) {
        o->inverse[i + (i * n)] = 1.0;
    }
    const mt_status rc = mt_lu_solve(o->n, k, o->n, o->inverse, &rcond, mem, NULL);
    o->known = rc == MT_OK && rcond > REGULAR;
    o->served = 0;
    return rc == MT_E_MEMORY ? mt_fail_memory(err) : MT_OK;
}

/* o->rest := S (rhs - K x). */
static void find_rest(mt_gauss_near *o, int nq, const mt_gauss *g)
{
    double *const force = o->rest;
    double *const gap = o->rest + nq;
    memcpy(force, g->force, (size_t)nq * sizeof *force);
    memcpy(gap, g->b, (size_t)g->m * sizeof *gap);
    mt_gemv(false, nq, nq, -1.0, g->mass, nq, o->x, 1.0, force);
    if (g->m > 0) {
        mt_gemv(true, g->m, nq, 1.0, g->a, g->m, o->x + nq, 1.0, force);
        mt_gemv(false, g->m, nq, -1.0, g->a, g->m, o->x, 1.0, gap);
    }
    for (int i = 0; i < o->n; i++) {
        o->rest[i] *= o->scale[i];
    }
}

/* Refine o->x, the last solution, until the corrections are rounding; false: they do not
 * converge, and o->x is 0. */
static bool correct(mt_gauss_near *o, int nq, const mt_gauss *g)
{
    double before = 0.0;
    for (int it = 0; it < CORRECTIONS; it++) {
        double size = 0.0;
        double moved = 0.0;
        find_rest(o, nq, g);
        mt_gemv(false, o->n, o->n, 1.0, o->inverse, o->n, o->rest, 0.0, o->step);
        for (int i = 0; i < o->n; i++) {
            const double step = fabs(o->step[i]);
            moved = !(step <= moved) ? step : moved; /* NaN is kept */
            o->x[i] += o->scale[i] * o->step[i];
            size = fmax(size, fabs(o->x[i]) / o->scale[i]);
        }
        const bool first = it == 0;
        const double part = first || before == 0.0 ? 0.0 : moved / before;
        if (moved == 0.0 || (!first && part * moved <= 0.5 * DBL_EPSILON * size) ||
            (moved <= ROUNDED * size && part > CONTRACTION)) {
            return true;
        }
        if (!(moved < HUGE_VAL) || part > CONTRACTION) {
            break;
        }
        before = moved;
    }
    memset(o->x, 0, (size_t)o->n * sizeof *o->x);
    return false;
}

mt_status mt_gauss_solve_near(mt_gauss_near *o, const mt_system *sys, const mt_gauss *g,
                              double *x, double *lambda, mt_arena *mem, mt_err *err)
{
    const int nq = sys->nq;
    if (o->known && correct(o, nq, g)) {
        o->served++;
        memcpy(x, o->x, (size_t)nq * sizeof *x);
        if (lambda != NULL) {
            memcpy(lambda, o->x + nq, (size_t)g->m * sizeof *lambda);
        }
        return MT_OK;
    }
    MT_TRY(mt_gauss_solve(sys, g, x, lambda, NULL, mem, err));
    if (o->known) { /* it serves no more */
        o->known = false;
        o->patience = o->served >= WORTH ? 0 : (2 * o->patience) + 1;
        o->wait = o->patience;
    }
    if (o->n > 0 && --o->wait < 0) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        MT_TRY(make_inverse(o, sys, g, mem, err));
        mt_arena_rewind(mem, mark);
        if (!o->known) {
            o->patience = (2 * o->patience) + WORTH;
            o->wait = o->patience;
        }
    }
    return MT_OK;
}

/*
 * One step of a motion. Increments of rotations: with R = exp(u^) R_g and R' = omega^ R,
 *     u' = omega - 1/2 u x omega + c(|u|) u x (u x omega),   c(a) = (1 - a/2 cot(a/2))/a^2.
 * Work: inputs push with Q, dampers with -C v, and what holds the driven joint, lambda, along
 * its coordinate's velocity s': w' = Q . v - v . C v + lambda s'.
 */
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

/* Motions of the locked drives: positions relative to their held ones, velocities and
 * accelerations. */
typedef struct drive_motions {
    double by[MT_DRIVES_MOST][3];
} drive_motions;

static int locked_drives(const mt_sim *s)
{
    return s->sys->n_drives - s->sys->n_trims;
}

/* The prescribed motions of driven joints at t. */
static mt_status moved(const mt_sim *s, double t, drive_motions *out, mt_err *err)
{
    memset(out, 0, sizeof *out);
    for (int i = 0; i < s->opt->n_inputs; i++) {
        if (s->opt->inputs[i].push == MT_SIM_MOVE) {
            double by[3];
            MT_TRY(mt_signal_eval(s->opt->inputs[i].signal, t, by, err));
            for (int k = 0; k < 3; k++) {
                out->by[s->opt->inputs[i].at][k] += by[k];
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
            mt_motion_base(&s->motion, &s->at, in->at, value[in->slope], s->push);
        } else {
            const mt_gauge g = {.channel = in->at, .joint = -1};
            mt_motion_gauge(&s->motion, &s->at, v, g, &s->gauge);
            mt_axpy(s->nq, value[0], s->gauge.row, s->push);
        }
    }
    return MT_OK;
}

/* s->at: the base moved by u, the drives where they are at t; drive: their motions. */
static mt_status move_placement(mt_sim *s, double t, const double *u, drive_motions *drive,
                                mt_err *err)
{
    MT_TRY(moved(s, t, drive, err));
    mt_placement_copy(s->sys, &s->base, &s->at);
    mt_poses_move(s->sys, s->at.pose, u);
    for (int i = 0; i < locked_drives(s); i++) {
        s->at.drive[i] = s->still[i] + drive->by[i][0];
    }
    return MT_OK;
}

/* Accelerations at s->at into out[nq]; power of what is not in the energy. */
static mt_status accelerate(mt_sim *s, double t, const double *v, const drive_motions *drive,
                            double *out, double *power, mt_err *err)
{
    mt_motion *const o = &s->motion;
    const int locked = locked_drives(s);
    s->evaluations++;
    mt_motion_eval(o, &s->at, v);
    MT_TRY(pushed(s, t, v, err));
    memcpy(s->force, o->force, (size_t)s->nq * sizeof *s->force);
    mt_axpy(s->nq, 1.0, s->push, s->force);
    memcpy(s->b, o->b, (size_t)s->m * sizeof *s->b);
    for (int i = 0; i < locked; i++) {
        s->b[s->sys->drives[i].constraint] += drive->by[i][2];
    }
    const mt_gauss g = {.m = s->m, .mass = o->mass, .force = s->force, .a = o->a, .b = s->b};
    MT_TRY(mt_gauss_solve_near(&s->gauss, s->sys, &g, out, locked > 0 ? s->lambda : NULL,
                               s->mem, err));
    *power = mt_dot(s->nq, s->push, v) - mt_dot(s->nq, o->damping, v);
    for (int i = 0; i < locked; i++) {
        *power += s->lambda[s->sys->drives[i].constraint] * drive->by[i][1];
    }
    return MT_OK;
}

mt_status mt_sim_slope(void *sim, double t, const double *y, double *out, mt_err *err)
{
    mt_sim *const s = sim;
    const ptrdiff_t nq = s->nq;
    const double *const v = y + nq;
    drive_motions drive;
    increments(s->sys, y, v, out);
    MT_TRY(move_placement(s, t, y, &drive, err));
    MT_TRY(accelerate(s, t, v, &drive, out + nq, out + (2 * nq), err));
    memcpy(s->rows, s->push, (size_t)nq * sizeof *s->rows);
    memset(out + (2 * nq) + 1, 0, (size_t)s->opt->n_gauges * sizeof *out);
    for (int i = 0; i < s->n_integrals; i++) {
        double *const row = s->rows + ((1 + i) * nq);
        const mt_gauge gauge = s->opt->gauges[s->integral[i]];
        mt_motion_gauge(&s->motion, &s->at, v, gauge, &s->gauge);
        memcpy(row, s->gauge.row, (size_t)nq * sizeof *row);
        out[(2 * nq) + 1 + s->integral[i]] = mt_dot(s->nq, row, v);
    }
    return MT_OK;
}

/* Rounding errors that a step may leave. */
static const double ROUNDING = 16.0 * DBL_EPSILON;

void mt_sim_allowed(const mt_sim *s, double h, double out[2])
{
    const double rounding = ROUNDING * s->sys->length_m;
    const double *const rate = s->slope + s->nq;
    double fast = s->fast;
    for (int i = 0; i < s->nq; i++) {
        fast = fmax(fast, s->weight[i] * h * fabs(rate[i]));
    }
    const double far = fmax(s->far, h * fast);
    out[0] = (s->opt->tolerance * far) + rounding;
    out[1] = (s->opt->tolerance * fast) + (rounding / h);
}

mt_status mt_sim_advance(mt_sim *s, double t, double h, mt_err *err)
{
    memcpy(s->y, s->begin, (size_t)s->n * sizeof *s->y);
    if (s->collocation != NULL) {
        return mt_collocate(s, t, h, err);
    }
    return ode_step(s->ode, t, h, s->y, s->slope, s->error, err);
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
 * equations are weak. In stiff motions, which have longer steps, it may where the equations
 * turn slowly (a wheel turns in bearings that stay): no singular value of A falls faster than A
 * changes (Weyl), and a step uses at most half of the weakest.
 */
static mt_status look_out(mt_sim *s, const mt_elimination *e, mt_err *err)
{
    mt_nearness near;
    s->rank = s->rank < 0 ? e->qr.rank : s->rank;
    mt_arena_clear(&s->names);
    MT_TRY(mt_motion_nearness(&s->motion, &s->at, e, s->mem, &s->names, &near, err));
    s->free_way = e->qr.kept < WEAK ? SEEN_FROM : HUGE_VAL;
    const bool far = s->collocation != NULL && !near.near && s->motion.swing > 0.0;
    s->free_time = far ? HALF_WAY * e->qr.kept / s->motion.swing : 0.0;
    s->free_way = near.near ? HALF_WAY * near.distance : s->free_way;
    if (e->qr.rank == s->rank && !(near.near && near.distance < DEAD)) {
        return MT_OK;
    }
    return mt_fail(err, MT_E_DEAD_CENTRE,
                   "dead centre: joints %s become dependent here, and the motion can branch",
                   near.near ? near.joints.text : "of a loop");
}

/* s->along := the least change that has A x = b; of least energy in stiff motions, whose error
 * is estimated so (step_collocate.c). */
static mt_status least_change(mt_sim *s, const mt_elimination *e, const double *b, mt_err *err)
{
    const mt_motion *const o = &s->motion;
    if (s->collocation == NULL) {
        return mt_eliminate_particular(e, b, s->along, s->mem, err);
    }
    const size_t size = (size_t)s->gauss.n * sizeof(double);
    double *const kept = mt_arena_f64(s->mem, (size_t)s->gauss.n, 1);
    MT_TRY(mt_arena_check(s->mem, err));
    if (size > 0) { /* the solution for accelerations is not near */
        memcpy(kept, s->gauss.x, size);
        memset(s->gauss.x, 0, size);
    }
    memset(s->force, 0, (size_t)s->nq * sizeof *s->force);
    const mt_gauss g = {.m = s->m, .mass = o->mass, .force = s->force, .a = o->a, .b = b};
    MT_TRY(mt_gauss_solve_near(&s->gauss, s->sys, &g, s->along, NULL, s->mem, err));
    if (size > 0) {
        memcpy(s->gauss.x, kept, size);
    }
    return MT_OK;
}

/* Project s->at, with velocities v, onto the joints; *out: their elimination there, in s->mem.
 */
static mt_status close_joints(mt_sim *s, double *v, const drive_motions *drive,
                              mt_elimination *out, mt_err *err)
{
    mt_motion *const o = &s->motion;
    if (s->m == 0) {
        return mt_eliminate_factor(s->sys, 0, o->a, s->mem, out, err);
    }
    for (int i = 0; i < CLOSING_STEPS; i++) {
        mt_elimination e;
        mt_motion_eval(o, &s->at, v);
        s->evaluations++;
        MT_TRY(mt_eliminate_factor(s->sys, s->m, o->a, s->mem, &e, err));
        const double gap = as_length(&e, o->gap);
        s->gap_m = i == 0 ? fmax(s->gap_m, gap) : s->gap_m;
        const bool closed = gap <= CLOSED * s->sys->length_m;
        if (!closed && i + 1 < CLOSING_STEPS) {
            MT_TRY(least_change(s, &e, o->gap, err));
            for (int k = 0; k < s->nq; k++) {
                s->along[k] = -s->along[k];
            }
            mt_poses_move(s->sys, s->at.pose, s->along);
            continue;
        }
        s->left_m = fmax(s->left_m, gap);
        MT_TRY(look_out(s, &e, err));
        for (int k = 0; k < locked_drives(s); k++) {
            o->rate[s->sys->drives[k].constraint] -= drive->by[k][1];
        }
        MT_TRY(least_change(s, &e, o->rate, err));
        mt_axpy(s->nq, -1.0, s->along, v);
        *out = e;
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
    drive_motions drive;
    memcpy(s->begin, s->y, (size_t)s->n * sizeof *s->begin);
    MT_TRY(move_placement(s, t, s->y, &drive, err));
    mt_elimination closed;
    MT_TRY(close_joints(s, s->begin + s->nq, &drive, &closed, err));
    straighten(s->sys, s->at.pose);
    mt_motion_turns(&s->motion, &s->at);
    mt_placement_copy(s->sys, &s->at, &s->base);
    memset(s->begin, 0, (size_t)s->nq * sizeof *s->begin);
    MT_TRY(begin_step(s, t, err));
    MT_TRY(mt_collocation_accept(s, t, &closed, err));
    mt_arena_rewind(s->mem, mark);
    return MT_OK;
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

mt_status mt_sim_ahead(mt_sim *s, double t, double *out, mt_err *err)
{
    MT_TRY(mt_sim_slope(s, t, s->y, s->probe, err));
    for (int i = 0; i < s->opt->n_gauges; i++) {
        read_gauge(s, i, s->y, s->probe + s->nq, out + ((ptrdiff_t)3 * i));
    }
    return MT_OK;
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
    s->integral = mt_arena_alloc(s->mem, (size_t)s->opt->n_gauges, sizeof *s->integral);
    MT_TRY(mt_arena_check(s->mem, err));
    for (int i = 0; i < s->opt->n_gauges; i++) {
        if (!mt_motion_has_value(s->sys, s->opt->gauges[i])) {
            s->integral[s->n_integrals++] = i;
        }
    }
    s->rows = mt_arena_f64(s->mem, nq, (size_t)1 + (size_t)s->n_integrals);
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
    for (int i = 0; i < locked_drives(s); i++) {
        s->still[i] = mt_linear_position(lin)->at.drive[i];
    }
    mt_placement_copy(sys, &start->at, &s->start);
    mt_placement_copy(sys, &start->at, &s->base);
    memcpy(s->y + s->nq, start->v, (size_t)s->nq * sizeof *s->y);
    MT_TRY(mt_arena_init(&s->names, 0, err));
    MT_TRY(ode_new(s->n, mt_sim_slope, s, &s->ode, err));
    return mt_sim_accept(s, 0.0, err);
}

void mt_sim_free(mt_sim *s)
{
    ode_delete(s->ode);
    mt_arena_free(&s->names);
    s->ode = NULL;
}
