/* SPDX-License-Identifier: GPL-3.0-or-later */
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
 * and the left side is solved exactly (filon.h),
 *     P xi(c h) = sin(w c h)/w P V_0 + h sum_j int_0^c cos(w h (c - s)) l_j(s) ds P N_1j + ...
 * Values and states at the points are found by turns until they stand; this contracts by what
 * the directions of springs change within the step. The part of N with the highest Chebyshev
 * polynomial alone, put through the same equations, is the error. (Exponential integrators:
 * Hochbruck and Ostermann, Acta Numerica 19 (2010) 209-286.)
 */
#include "simulate/collocate.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "mechanics/eliminate.h"
#include "simulate/filon.h"

enum { DEGREE = MT_FILON_DEGREE, POINTS = MT_FILON_POINTS, ROUNDS = 14 };
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
    MT_TRY(mt_sim_rates(s, t, u, v, q->a, rows, err));
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
        double e = start * h * (mt_filon_sine_over(w->x, c) - c);
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

void mt_collocation_accept(mt_sim *s, double t)
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

mt_status mt_collocate(mt_sim *s, double t, double h, mt_err *err)
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
