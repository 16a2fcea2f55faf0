/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One step of a motion: by the pair of GSL, or, where springs make it stiff, by collocation. */
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
static void collocation_accept(mt_sim *s, double t);
static mt_status collocate(mt_sim *s, double t, double h, mt_err *err);

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

/*
 * A slow wave is integrated by Gauss and Legendre's rule, whose nodes are enough for
 * FAST_WAVE/(2 pi) periods and the polynomial; a fast one by parts, a finite sum whose terms
 * fall as (derivatives of l_j)/x^k.
 */

enum { DEGREE = MT_FILON_DEGREE, POINTS = MT_FILON_POINTS, GAUSS = MT_FILON_GAUSS };
static const double PI = 3.14159265358979323846;
static const double FAST_WAVE = 50.0;
enum { NEWTON_STEPS = 8 };

/* Legendre's polynomial of degree GAUSS: nodes and weights on [0, 1]. */
static void make_quadrature(mt_filon *q)
{
    for (int i = 0; i < GAUSS; i++) {
        double x = cos(PI * (i + 0.75) / (GAUSS + 0.5));
        double slope = 1.0;
        for (int round = 0; round < NEWTON_STEPS; round++) {
            double p0 = 1.0;
            double p1 = x;
            for (int k = 2; k <= GAUSS; k++) {
                const double p2 = (((2 * k) - 1) * x * p1 - ((k - 1) * p0)) / k;
                p0 = p1;
                p1 = p2;
            }
            slope = GAUSS * ((x * p1) - p0) / ((x * x) - 1.0);
            x -= p1 / slope;
        }
        q->node[i] = 0.5 * (1.0 + x);
        q->gauss[i] = 1.0 / ((1.0 - (x * x)) * slope * slope);
    }
}

/* l_j at x. */
static double lagrange(const mt_filon *q, int j, double x)
{
    double value = 1.0;
    for (int k = 0; k < POINTS; k++) {
        value *= k == j ? 1.0 : (x - q->point[k]) / (q->point[j] - q->point[k]);
    }
    return value;
}

static void make_derivatives(mt_filon *q)
{
    double *const d = q->derivative[1];
    for (int i = 0; i < POINTS; i++) {
        q->derivative[0][i + (i * POINTS)] = 1.0;
        double sum = 0.0;
        for (int j = 0; j < POINTS; j++) {
            if (j != i) {
                d[i + (j * POINTS)] = q->last[j] / q->last[i] / (q->point[i] - q->point[j]);
                sum += d[i + (j * POINTS)];
            }
        }
        d[i + (i * POINTS)] = -sum;
    }
    for (int k = 2; k < POINTS; k++) {
        mt_gemm(false, false, POINTS, POINTS, POINTS, 1.0, d, POINTS, q->derivative[k - 1],
                POINTS, 0.0, q->derivative[k], POINTS);
    }
}

void mt_filon_make(mt_filon *q)
{
    for (int i = 0; i < POINTS; i++) {
        q->point[i] = 0.5 * (1.0 - cos(PI * i / DEGREE));
        q->last[i] = (i % 2 == 0 ? 1.0 : -1.0) * (i == 0 || i == DEGREE ? 0.5 : 1.0) / DEGREE;
    }
    make_quadrature(q);
    for (int i = 0; i < POINTS; i++) {
        for (int g = 0; g < GAUSS; g++) {
            for (int j = 0; j < POINTS; j++) {
                q->basis[j + (POINTS * (g + (GAUSS * i)))] =
                    lagrange(q, j, q->point[i] * q->node[g]);
            }
        }
    }
    make_derivatives(q);
}

/* sin(x c)/x, x >= 0. */
static double filon_sine_over(double x, double c)
{
    return x > 0.0 ? sin(x * c) / x : c;
}

/* int_0^c e^(i x (c - s)) l_j ds by parts: sum_k (i x)^-(k+1) (e^(i x c) l_j^(k)(0) -
 * l_j^(k)(c)). */
static void weigh_fast(const mt_filon *q, int i, mt_filon_weights *w)
{
    const double c = w->c[i];
    const double s = w->s[i];
    for (int j = 0; j < POINTS; j++) {
        double re = 0.0;
        double im = 0.0;
        double power = 1.0 / w->x;
        for (int k = 0; k < POINTS; k++) {
            const double *const d = q->derivative[k] + ((ptrdiff_t)j * POINTS);
            const double from = d[0];
            const double a = (c * from) - d[i];
            const double b = s * from;
            /* times i^-(k+1) */
            const double turned[4][2] = {{b, -a}, {-a, -b}, {-b, a}, {a, b}};
            re += power * turned[k % 4][0];
            im += power * turned[k % 4][1];
            power /= w->x;
        }
        w->nc[i + (j * POINTS)] = re;
        w->ns[i + (j * POINTS)] = im;
        w->nd[i + (j * POINTS)] = im / w->x;
    }
}

static void weigh_slow(const mt_filon *q, int i, mt_filon_weights *w)
{
    const double c = q->point[i];
    for (int g = 0; g < GAUSS; g++) {
        const double left = c * (1.0 - q->node[g]);
        const double cosine = c * q->gauss[g] * cos(w->x * left);
        const double sine = c * q->gauss[g] * sin(w->x * left);
        const double over = c * q->gauss[g] * filon_sine_over(w->x, left);
        const double *const l = q->basis + ((ptrdiff_t)POINTS * (g + (GAUSS * i)));
        for (int j = 0; j < POINTS; j++) {
            w->nc[i + (j * POINTS)] += cosine * l[j];
            w->ns[i + (j * POINTS)] += sine * l[j];
            w->nd[i + (j * POINTS)] += over * l[j];
        }
    }
}

void mt_filon_weigh(const mt_filon *q, double x, mt_filon_weights *w)
{
    if (w->x == x) {
        return;
    }
    *w = (mt_filon_weights){.x = x};
    for (int i = 0; i < POINTS; i++) {
        w->c[i] = cos(x * q->point[i]);
        w->s[i] = sin(x * q->point[i]);
        if (x > FAST_WAVE && i > 0) {
            weigh_fast(q, i, w);
        } else {
            weigh_slow(q, i, w);
        }
    }
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

/* Accelerations, power and velocities of gauges where the base is moved by u, at velocities v,
 * into out[nq + 1 + gauges]. rows not NULL, nq x (1 + gauges): gets forces of the inputs and
 * rows of the gauges; out then lacks their products with v. */
static mt_status sim_rates(mt_sim *s, double t, const double *u, const double *v, double *out,
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
    return sim_rates(s, t, y, y + s->nq, out + s->nq, NULL, err);
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
        return collocate(s, t, h, err);
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
    collocation_accept(s, t);
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
    MT_TRY(ode_new(s->n, mt_sim_slope, s, &s->ode, err));
    return mt_sim_accept(s, 0.0, err);
}

void mt_sim_free(mt_sim *s)
{
    ode_delete(s->ode);
    mt_arena_free(&s->names);
    s->ode = NULL;
}

/*
 * Derivation. Positions of a body in the step: R = exp(theta^) R_g, x = x_g + J(theta) rho, J =
 * 1 + (1 - cos a)/a^2 theta^ + (a - sin a)/a^3 theta^^2, a = |theta|; its velocities are
 * carried along, nu = exp(-theta^) x', omega = exp(-theta^) omega_global. Both are elements of
 * the group of motions, in which a body that turns about a fixed axis has theta and rho in
 * proportion, and constant nu and omega: as large as the turn may be, springs between bodies
 * that turn together keep their directions and masses. With xi = (rho, theta), V = (nu, omega),
 * [xi, V] = (theta x nu + rho x omega, theta x omega):
 *     xi' = V + 1/2 [xi, V] + 1/12 [xi, [xi, V]] - 1/720 [xi, ...]_4 + ...,
 *     nu' = exp(-theta^) x'' - omega x nu,   omega' = exp(-theta^) omega_global'.
 * With phi, w^2 the modes of the springs' stiffness sum k f f^T and M at g, and P = phi^T M,
 *     xi' = V + N_1,   V' = -phi w^2 P xi + N_2:
 * N is taken as the polynomial through its values at DEGREE + 1 Chebyshev points of the step,
 * and the left side is solved exactly (by the weights above),
 *     P xi(c h) = sin(w c h)/w P V_0 + h sum_j int_0^c cos(w h (c - s)) l_j(s) ds P N_1j + ...
 * Values and states at the points are found by turns until they stand; this contracts by what
 * the directions of springs change within the step. The part of N with the highest Chebyshev
 * polynomial alone, put through the same equations, is the error. (Exponential integrators:
 * Hochbruck and Ostermann, Acta Numerica 19 (2010) 209-286.)
 */

enum { ROUNDS = 14 };
/* States stand where they move by less than this part of the error that a step may have; the
 * iteration goes nowhere where a round moves them by more than SLOW of the one before. */
static const double STANDS = 0.05;
static const double SLOW = 0.6;
/* Frequencies this many times the next lower one are of springs that are as good as rigid. */
static const double APART = 20.0;
/* An eigenvalue below this times the largest is rounding of 0. */
static const double NO_STIFFNESS = 1e3 * DBL_EPSILON;
/* Steps of the pair are about this over the highest frequency; steps are counted in lots, and
 * where a lot gets no further with its evaluations than they would, the rest is theirs. */
static const double PAIR_STEP = 1.0;
enum { PAIR_EVALUATIONS = 13, LOT = 64 };

struct mt_collocation {
    int nq;
    int n;     /* modes */
    int rates; /* of y behind positions and velocities */
    mt_filon rule;
    double since; /* the lot began: time, evaluations */
    long evaluations;
    int steps;
    bool begun;  /* the matrices belong to s->base */
    double *w;   /* [n] */
    double *phi; /* nq x n */
    double *p;   /* n x nq */
    double *k;   /* nq x nq */
    double *xi;  /* nq x POINTS */
    double *v;
    double *n1;
    double *n2;
    double *rows; /* nq x rates x POINTS */
    double *rate; /* rates x POINTS */
    double *a;    /* [nq + rates] */
    double *work; /* [nq] */
    double *m1;   /* n x POINTS: P N */
    double *m2;
    double *e0;            /* [n] P V_0 */
    mt_filon_weights zero; /* of no frequency */
    mt_filon_weights *of;  /* [n] */
    double *next;          /* [2 nq] */
};

/* Modes of the springs at s->base. */
static mt_status begin_collocation(mt_sim *s, mt_collocation *q, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(s->mem);
    const int nq = q->nq;
    mt_elimination e;
    MT_TRY(mt_eliminate(s->sys, s->m, s->motion.a, s->mem, &e, err));
    mt_motion_stiffness(&s->motion, &s->base, q->k);
    const int n = e.n;
    q->n = n;
    double *const mz = mt_arena_f64(s->mem, (size_t)nq, (size_t)n);
    double *const mass = mt_arena_f64(s->mem, (size_t)n, (size_t)n);
    double *const stiff = mt_arena_f64(s->mem, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(s->mem, err));
    mt_gemm(false, false, nq, n, nq, 1.0, s->motion.mass, nq, e.z, nq, 0.0, mz, nq);
    mt_gemm(true, false, n, n, nq, 1.0, e.z, nq, mz, nq, 0.0, mass, n);
    mt_gemm(false, false, nq, n, nq, 1.0, q->k, nq, e.z, nq, 0.0, mz, nq);
    mt_gemm(true, false, n, n, nq, 1.0, e.z, nq, mz, nq, 0.0, stiff, n);
    mt_status rc = mt_cholesky(n, mass, NULL, NULL);
    if (rc == MT_OK) {
        /* L^-1 K L^-T, then phi = Z L^-T Y */
        mt_congruence_inverse(n, mass, stiff);
        MT_TRY(mt_eig_sym(n, stiff, q->w, true, s->mem, err));
        mt_tri_solve(true, n, n, mass, stiff, n);
        mt_gemm(false, false, nq, n, n, 1.0, e.z, nq, stiff, n, 0.0, q->phi, nq);
        mt_gemm(true, false, n, nq, nq, 1.0, q->phi, nq, s->motion.mass, nq, 0.0, q->p, n);
        const double least = n > 0 ? NO_STIFFNESS * fmax(q->w[n - 1], 0.0) : 0.0;
        for (int i = 0; i < n; i++) {
            q->w[i] = q->w[i] > least ? sqrt(q->w[i]) : 0.0;
        }
    } else {
        q->n = 0; /* a direction without mass: nothing is solved beforehand */
    }
    mt_arena_rewind(s->mem, mark);
    q->begun = true;
    return MT_OK;
}

/* True where the highest frequencies are well above the others and above the rate of the
 * initial motion. */
static bool is_stiff(const mt_sim *s, const mt_collocation *q)
{
    double slow = 0.0;
    for (int i = 0; i < s->nq; i++) {
        const double v = s->weight[i] * fabs(s->begin[s->nq + i]);
        const double a = s->weight[i] * fabs(s->slope[s->nq + i]);
        slow = fmax(slow, fmax(v / s->sys->length_m, sqrt(a / s->sys->length_m)));
    }
    bool apart = false;
    for (int i = 0; i < q->n; i++) {
        apart = apart || q->w[i] > APART * slow;
        slow = fmax(slow, q->w[i]);
    }
    return apart;
}

mt_status mt_collocation_new(mt_sim *s, mt_err *err)
{
    mt_collocation *const q = mt_arena_alloc(s->mem, 1, sizeof *q);
    const size_t nq = (size_t)s->nq;
    MT_TRY(mt_arena_check(s->mem, err));
    q->nq = s->nq;
    q->rates = 1 + s->opt->n_gauges;
    double **const square[] = {&q->phi, &q->p, &q->k};
    double **const states[] = {&q->xi, &q->v, &q->n1, &q->n2, &q->m1, &q->m2};
    for (int i = 0; i < MT_COUNT(square); i++) {
        *square[i] = mt_arena_f64(s->mem, nq, nq);
    }
    for (int i = 0; i < MT_COUNT(states); i++) {
        *states[i] = mt_arena_f64(s->mem, nq, POINTS);
    }
    q->w = mt_arena_f64(s->mem, nq, 1);
    q->e0 = mt_arena_f64(s->mem, nq, 1);
    q->work = mt_arena_f64(s->mem, nq, 2);
    q->next = mt_arena_f64(s->mem, nq, 2);
    q->a = mt_arena_f64(s->mem, nq + (size_t)q->rates, 1);
    q->rate = mt_arena_f64(s->mem, (size_t)q->rates, POINTS);
    q->rows = mt_arena_f64(s->mem, nq, (size_t)q->rates * POINTS);
    q->of = mt_arena_alloc(s->mem, nq, sizeof *q->of);
    MT_TRY(mt_arena_check(s->mem, err));
    mt_filon_make(&q->rule);
    q->zero.x = nan("");
    for (int i = 0; i < s->nq; i++) {
        q->of[i].x = nan("");
    }
    mt_filon_weigh(&q->rule, 0.0, &q->zero);
    MT_TRY(begin_collocation(s, q, err));
    s->collocation = is_stiff(s, q) ? q : NULL;
    return MT_OK;
}

static void put_twist(const mt_system *sys, int body, const double in[6], double *x)
{
    for (int k = 0; k < 6; k++) {
        const int dof = sys->bodies[body].dof[k];
        if (dof >= 0) {
            x[dof] = in[k];
        }
    }
}

/* Path of the centre. */
static void way_of(const double xi[6], double out[3])
{
    static const double SMALL = 0.05;
    const double *const rho = xi;
    const double *const theta = xi + 3;
    const double a = mt_norm2(3, theta);
    const double half = a > 0.0 ? sin(0.5 * a) / (0.5 * a) : 1.0;
    const double a2 = a * a;
    /* (a - sin a)/a^3; below SMALL its series, next term a^8/39916800 */
    const double cubic =
        a < SMALL ? (1.0 / 6.0) - (a2 / 120.0) + (a2 * a2 / 5040.0) - (a2 * a2 * a2 / 362880.0)
                  : (a - sin(a)) / (a2 * a);
    double once[3];
    double twice[3];
    mt_cross3(theta, rho, once);
    mt_cross3(theta, once, twice);
    for (int k = 0; k < 3; k++) {
        out[k] = rho[k] + (0.5 * half * half * once[k]) + (cubic * twice[k]);
    }
}

static void bracket(const double a[6], const double b[6], double out[6])
{
    double first[3];
    double second[3];
    mt_cross3(a + 3, b, first);
    mt_cross3(a, b + 3, second);
    mt_cross3(a + 3, b + 3, out + 3);
    for (int k = 0; k < 3; k++) {
        out[k] = first[k] + second[k];
    }
}

/* u and global velocities (may be v itself) of xi, V. */
static void to_global(const mt_system *sys, const double *xi, const double *v, double *u,
                      double *out)
{
    for (int b = 0; b < sys->n_bodies; b++) {
        double x[6];
        double vel[6];
        double way[6];
        double moved[6];
        mt_pose_motion(sys, b, xi, x);
        mt_pose_motion(sys, b, v, vel);
        way_of(x, way);
        memcpy(way + 3, x + 3, 3 * sizeof *way);
        mt_turn3(x + 3, 2, vel, moved);
        put_twist(sys, b, way, u);
        put_twist(sys, b, moved, out);
    }
}

/* N_1 = xi' - V and V' from the accelerations a. */
static void to_local(const mt_system *sys, const double *xi, const double *v, const double *a,
                     double *n1, double *rate)
{
    static const double series[] = {0.5, 1.0 / 12.0,    0.0, -1.0 / 720.0,
                                    0.0, 1.0 / 30240.0, 0.0, -1.0 / 1209600.0};
    for (int b = 0; b < sys->n_bodies; b++) {
        double x[6];
        double vel[6];
        double acc[6];
        double sum[6] = {0.0};
        double term[6];
        double next[6];
        double turned[6];
        mt_pose_motion(sys, b, xi, x);
        mt_pose_motion(sys, b, v, vel);
        mt_pose_motion(sys, b, a, acc);
        memcpy(term, vel, sizeof term);
        for (int k = 0; k < MT_COUNT(series); k++) {
            bracket(x, term, next);
            memcpy(term, next, sizeof term);
            for (int i = 0; i < 6; i++) {
                sum[i] += series[k] * term[i];
            }
        }
        const double back[3] = {-x[3], -x[4], -x[5]};
        double spin[3];
        mt_turn3(back, 2, acc, turned);
        mt_cross3(vel + 3, vel, spin);
        for (int k = 0; k < 3; k++) {
            turned[k] -= spin[k];
        }
        put_twist(sys, b, sum, n1);
        put_twist(sys, b, turned, rate);
    }
}

/* Rotate x with the bodies. */
static void turn_back(const mt_system *sys, const double *xi, double *x)
{
    for (int b = 0; b < sys->n_bodies; b++) {
        double at[6];
        double own[6];
        double turned[6];
        mt_pose_motion(sys, b, xi, at);
        mt_pose_motion(sys, b, x, own);
        const double back[3] = {-at[3], -at[4], -at[5]};
        mt_turn3(back, 2, own, turned);
        put_twist(sys, b, turned, x);
    }
}

/* The integral over the step of rate k. Products of a row f with the velocity V = xi' - N_1 are
 * integrated by parts, [f xi] - int f' xi - int f N_1: fast vibrations hardly contribute to
 * xi. */
static double integrate(const mt_collocation *q, int k, double h)
{
    const ptrdiff_t nq = q->nq;
    const double *const d = q->rule.derivative[1];
    double sum = 0.0;
    for (int j = 0; j < POINTS; j++) {
        const double weight = q->zero.nc[DEGREE + (j * POINTS)];
        const double *const xi = q->xi + (j * nq);
        const double *const f = q->rows + (((j * (ptrdiff_t)q->rates) + k) * nq);
        sum += h * weight * q->rate[k + ((ptrdiff_t)j * q->rates)];
        sum -= h * weight * mt_dot(q->nq, f, q->n1 + (j * nq));
        sum += j == DEGREE ? mt_dot(q->nq, f, xi) : 0.0;
        for (int i = 0; i < POINTS; i++) {
            const double *const of = q->rows + (((i * (ptrdiff_t)q->rates) + k) * nq);
            sum -= weight * d[j + (i * POINTS)] * mt_dot(q->nq, of, xi);
        }
    }
    return sum;
}

/* N at point i, from the states there; *err as of the accelerations. */
static mt_status evaluate_point(mt_sim *s, mt_collocation *q, int i, double t, mt_err *err)
{
    const ptrdiff_t nq = q->nq;
    double *const u = q->work;
    double *const v = q->work + nq;
    double *const n2 = q->n2 + (i * nq);
    to_global(s->sys, q->xi + (i * nq), q->v + (i * nq), u, v);
    double *const rows = q->rows + (i * nq * q->rates);
    MT_TRY(sim_rates(s, t, u, v, q->a, rows, err));
    for (int k = 0; k < q->rates; k++) {
        turn_back(s->sys, q->xi + (i * nq), rows + (k * nq));
    }
    memcpy(q->rate + ((ptrdiff_t)i * q->rates), q->a + nq, (size_t)q->rates * sizeof *q->rate);
    to_local(s->sys, q->xi + (i * nq), q->v + (i * nq), q->a, q->n1 + (i * nq), n2);
    /* + phi w^2 P xi */
    double *const e = q->work;
    mt_gemv(false, q->n, q->nq, 1.0, q->p, q->n, q->xi + (i * nq), 0.0, e);
    for (int k = 0; k < q->n; k++) {
        e[k] *= q->w[k] * q->w[k];
    }
    mt_gemv(false, q->nq, q->n, 1.0, q->phi, q->nq, e, 1.0, n2);
    return MT_OK;
}

/* xi[nq], v[nq] at point i: from V_0 and its modal part E_0 (or none) with N1, N2 and their
 * modal parts M1, M2. */
static void state_at(const mt_collocation *q, double h, int i, bool moves, double *xi,
                     double *v)
{
    const ptrdiff_t nq = q->nq;
    const double *const v0 = moves ? q->v : NULL;
    const double *const n1 = q->n1;
    const double *const n2 = q->n2;
    const mt_filon_weights *const z = &q->zero;
    for (ptrdiff_t k = 0; k < nq; k++) {
        xi[k] = v0 == NULL ? 0.0 : h * q->rule.point[i] * v0[k];
        v[k] = v0 == NULL ? 0.0 : v0[k];
    }
    for (int j = 0; j < POINTS; j++) {
        const double once = h * z->nc[i + (j * POINTS)];
        const double twice = h * h * z->nd[i + (j * POINTS)];
        mt_axpy(q->nq, once, n1 + (j * nq), xi);
        mt_axpy(q->nq, twice, n2 + (j * nq), xi);
        mt_axpy(q->nq, once, n2 + (j * nq), v);
    }
    for (int k = 0; k < q->n; k++) {
        const mt_filon_weights *const w = &q->of[k];
        const double rate = q->w[k];
        const double start = moves ? q->e0[k] : 0.0;
        const double c = q->rule.point[i];
        double e = start * h * (filon_sine_over(w->x, c) - c);
        double de = start * (w->c[i] - 1.0);
        for (int j = 0; j < POINTS; j++) {
            const int at = i + (j * POINTS);
            const double a = q->m1[k + ((ptrdiff_t)j * q->n)];
            const double b = q->m2[k + ((ptrdiff_t)j * q->n)];
            e += h * (((w->nc[at] - z->nc[at]) * a) + (h * (w->nd[at] - z->nd[at]) * b));
            de += h * (((w->nc[at] - z->nc[at]) * b) - (rate * w->ns[at] * a));
        }
        mt_axpy(q->nq, e, q->phi + (k * nq), xi);
        mt_axpy(q->nq, de, q->phi + (k * nq), v);
    }
}

/* Compute the states at all points from N; returns the largest change relative to the allowed
 * error. */
static double update_point_states(mt_sim *s, mt_collocation *q, double h)
{
    const ptrdiff_t nq = q->nq;
    double most = 0.0;
    double far = 0.0;
    double fast = 0.0;
    mt_gemm(false, false, q->n, POINTS, q->nq, 1.0, q->p, q->n, q->n1, q->nq, 0.0, q->m1, q->n);
    mt_gemm(false, false, q->n, POINTS, q->nq, 1.0, q->p, q->n, q->n2, q->nq, 0.0, q->m2, q->n);
    for (int i = 1; i < POINTS; i++) {
        double *const xi = q->next;
        double *const v = q->next + nq;
        state_at(q, h, i, true, xi, v);
        for (ptrdiff_t k = 0; k < nq; k++) {
            const double dx = fabs(xi[k] - q->xi[k + (i * nq)]) * s->weight[k];
            const double dv = fabs(v[k] - q->v[k + (i * nq)]) * s->weight[k];
            far = !(dx <= far) ? dx : far;
            fast = !(dv <= fast) ? dv : fast;
        }
        memcpy(q->xi + (i * nq), xi, (size_t)nq * sizeof *xi);
        memcpy(q->v + (i * nq), v, (size_t)nq * sizeof *v);
    }
    double may[2];
    mt_sim_allowed(s, h, may);
    most = fmax(far / may[0], fast / may[1]);
    return isfinite(far) && isfinite(fast) ? most : HUGE_VAL;
}

/* s->y and s->error at the end. */
static void finish_collocation(mt_sim *s, mt_collocation *q, double h)
{
    const ptrdiff_t nq = q->nq;
    const ptrdiff_t end = DEGREE * nq;
    to_global(s->sys, q->xi + end, q->v + end, s->y, s->y + nq);
    for (int k = 0; k < q->rates; k++) {
        s->y[(2 * nq) + k] = s->begin[(2 * nq) + k] + integrate(q, k, h);
        s->error[(2 * nq) + k] = 0.0;
    }
    /* N := its highest part, a T_DEGREE(2 c - 1), which is a (-1)^i at the points */
    double *const parts[] = {q->n1, q->n2, q->m1, q->m2};
    for (int p = 0; p < MT_COUNT(parts); p++) {
        const ptrdiff_t rows = p < 2 ? nq : q->n;
        for (ptrdiff_t k = 0; k < rows; k++) {
            double a = 0.0;
            for (int j = 0; j < POINTS; j++) {
                a += q->rule.last[j] * parts[p][k + (j * rows)];
            }
            for (int j = 0; j < POINTS; j++) {
                parts[p][k + (j * rows)] = j % 2 == 0 ? a : -a;
            }
        }
    }
    state_at(q, h, DEGREE, false, s->error, s->error + nq);
}

/* Update after a step to t, which has moved s->base. Collocation ends here where it is not
 * faster. */
static void collocation_accept(mt_sim *s, double t)
{
    mt_collocation *const q = s->collocation;
    if (q == NULL) {
        return;
    }
    q->begun = false;
    s->stiff_steps++;
    if (++q->steps < LOT) {
        return;
    }
    const double pairs = (double)(s->evaluations - q->evaluations) / PAIR_EVALUATIONS;
    const double highest = q->n > 0 ? q->w[q->n - 1] : 0.0;
    if ((t - q->since) * highest < PAIR_STEP * pairs) {
        s->collocation = NULL;
        s->stalls = false;
    }
    q->steps = 0;
    q->since = t;
    q->evaluations = s->evaluations;
}

/* Advance s->begin by a step h from t into s->y, its error in s->error. s->stalls: the
 * iteration did not converge, the step is too long. Fails as mt_sim_slope. */
static mt_status collocate(mt_sim *s, double t, double h, mt_err *err)
{
    mt_collocation *const q = s->collocation;
    const ptrdiff_t nq = q->nq;
    if (!q->begun) {
        MT_TRY(begin_collocation(s, q, err));
    }
    for (int k = 0; k < q->n; k++) {
        mt_filon_weigh(&q->rule, q->w[k] * h, &q->of[k]);
    }
    for (int i = 0; i < POINTS; i++) {
        memset(q->xi + (i * nq), 0, (size_t)nq * sizeof *q->xi);
        memcpy(q->v + (i * nq), s->begin + nq, (size_t)nq * sizeof *q->v);
    }
    mt_gemv(false, q->n, q->nq, 1.0, q->p, q->n, q->v, 0.0, q->e0);
    MT_TRY(evaluate_point(s, q, 0, t, err));
    for (int i = 1; i < POINTS; i++) {
        memcpy(q->n1 + (i * nq), q->n1, (size_t)nq * sizeof *q->n1);
        memcpy(q->n2 + (i * nq), q->n2, (size_t)nq * sizeof *q->n2);
    }
    double last = HUGE_VAL;
    s->stalls = false;
    (void)update_point_states(s, q, h);
    for (int round = 0;; round++) {
        for (int i = 1; i < POINTS; i++) {
            MT_TRY(evaluate_point(s, q, i, t + (q->rule.point[i] * h), err));
        }
        const double moved = update_point_states(s, q, h);
        /* what is left: as much less again */
        if (moved <= STANDS || (round > 0 && moved * (moved / last) <= STANDS)) {
            break;
        }
        s->stalls = round >= ROUNDS || !(moved <= SLOW * last || round < 2);
        if (s->stalls) {
            break;
        }
        last = moved;
    }
    finish_collocation(s, q, h);
    return MT_OK;
}
