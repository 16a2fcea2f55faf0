/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of motions with stiff springs. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/arena.h"
#include "linalg/dense.h"
#include "mechanics/eliminate.h"
#include "simulate/step.h"

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
        w->nd[i + (j * POINTS)] = im / w->x;
    }
}

static void weigh_slow(const mt_filon *q, int i, mt_filon_weights *w)
{
    const double c = q->point[i];
    for (int g = 0; g < GAUSS; g++) {
        const double left = c * (1.0 - q->node[g]);
        const double cosine = c * q->gauss[g] * cos(w->x * left);
        const double over = c * q->gauss[g] * filon_sine_over(w->x, left);
        const double *const l = q->basis + ((ptrdiff_t)POINTS * (g + (GAUSS * i)));
        for (int j = 0; j < POINTS; j++) {
            w->nc[i + (j * POINTS)] += cosine * l[j];
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

/*
 * Derivation. Positions of a body in the step: R = exp(theta^) R_g, x = x_g + J(theta) rho, J =
 * 1 + (1 - cos a)/a^2 theta^ + (a - sin a)/a^3 theta^^2, a = |theta|; its velocities are
 * carried along, nu = exp(-theta^) x', omega = exp(-theta^) omega_global. Both are elements of
 * the group of motions, in which a body that turns about a fixed axis has theta and rho in
 * proportion, and constant nu and omega: as large as the turn may be, springs between bodies
 * that turn together keep their directions and masses. With xi = (rho, theta), V = (nu, omega),
 * [xi, V] = (theta x nu + rho x omega, theta x omega):
 *     xi' = V + N_1,   N_1 = 1/2 [xi, V] + 1/12 [xi, [xi, V]] - 1/720 [xi, ...]_4 + ...,
 *     nu' = exp(-theta^) x'' - omega x nu,   omega' = exp(-theta^) omega_global'.
 * A spring between bodies that turn together is stretched by f . eta, eta' = V, f its row at g,
 * also where they move across it, which f . xi is not. With K = sum k f f^T, phi, w^2 its modes
 * with M at g, and rows p with p phi = 1,
 *     eta' = V,   V' = -phi w^2 p eta + N_2.
 * Rows of stiff modes are p = w^-2 phi^T K, the stretches themselves: with phi^T M, which has
 * the same products with phi, what the bodies move along the joints as these turn would count
 * as stretch, w^2 times. Those of the others are phi^T M, as K is rounding to them.
 * N_2 is taken as the polynomial through its values at DEGREE + 1 Chebyshev points of the step,
 * and the left side is solved exactly (by the weights above),
 *     p eta(c h) = sin(w c h)/w p V_0
 *                  + h^2 sum_j int_0^c sin(w h (c - s))/(w h) l_j(s) ds p N_2j,
 * N_1 as such a polynomial, too: xi = eta + int N_1, which needs no accelerations.
 * Values and states at the points are found by turns until they stand; this contracts by what
 * the directions of springs change within the step. It begins with the polynomial of the step
 * before: on its axes, which the bodies have turned by R since, the accelerations R (N_2 - phi
 * w^2 p eta) of the slow modes go on as far as degree AHEAD, from the known value N_2(0).
 * The part of N with the highest Chebyshev polynomial alone, put through the same equations, is
 * the error. What of it violates the joints, (1 - phi phi^T M) of it, is taken back after the
 * step by the change of least energy (mt_sim_accept); what it leaves along the motions of the
 * joints is as much as these turn within the step. (Exponential integrators: Hochbruck and
 * Ostermann, Acta Numerica 19 (2010) 209-286.)
 */

/* Rounds of values and states; rounds of xi with given V. */
enum { ROUNDS = 14, CARRIES = 20 };
/* States stand where they move by less than this part of the error that a step may have; the
 * iteration goes nowhere where a round moves them by more than SLOW of the one before. */
static const double STANDS = 0.05;
static const double SLOW = 0.6;
/* xi stands within a round, as a part of that error. */
static const double CARRIED = 0.01;
/* Degree to which N_2 goes on into the next step, and of steps at most so many times as long:
 * T_4 is 3,300 there. */
enum { AHEAD = 4 };
static const double AHEAD_LENGTHS = 2.0;
/* Periods of slow modes are at least 2 pi over this of a step. */
static const double SLOW_WAVE = 3.0;
/* Weights of a slow wave serve for one whose phase at the end differs by less [rad]. */
static const double SAME_PHASE = 1e-3;
/* Frequencies this many times the next lower one are of springs that are as good as rigid. */
static const double APART = 20.0;
/* An eigenvalue below this times the largest is rounding of 0. */
static const double NO_STIFFNESS = 1e3 * DBL_EPSILON;
/* Modes above this part of the highest frequency are stiff: K resolves them to 1e-12. */
static const double STIFF_PART = 1e-2;
/* Steps of the pair are about this over the highest frequency; steps are counted in lots, and
 * where a lot gets no further with its evaluations than they would, the rest is theirs. */
static const double PAIR_STEP = 1.0;
enum { PAIR_EVALUATIONS = 13, LOT = 64 };
/* A step ends where the last one was tried to, within this part of its length. */
static const double SAME_END = 1e-9;

struct mt_collocation {
    int nq;
    int n;     /* modes */
    int stiff; /* the first stiff one */
    int rates; /* of y behind positions and velocities: power, gauges' velocities */
    mt_filon rule;
    double since; /* the lot began: time, evaluations */
    long evaluations;
    int steps;
    bool whole;     /* phi are all motions that the joints allow */
    double *w;      /* [n] */
    double *phi;    /* nq x n */
    double *p;      /* n x nq */
    double *across; /* n x nq: phi^T M */
    double *k;      /* nq x nq */
    double *eta;    /* nq x POINTS */
    double *xi;
    double *v;
    double *n1;
    double *n2;
    double *next;     /* work */
    double *last;     /* work */
    double *past_n2;  /* nq x POINTS: N_2 - phi w^2 p eta of slow modes in the last step */
    double *past_eta; /* nq x POINTS, both on the axes of this one */
    double past_h;    /* its length; 0: there is none */
    double tried_h;   /* the last step that was computed: length, end */
    double tried_end;
    double *rows; /* nq x rates x POINTS */
    double *rate; /* [POINTS] of the first, without the product of its row with V */
    double *y;    /* as of mt_sim */
    double *slope;
    int unknowns;          /* of mt_gauss_near */
    double *found;         /* unknowns x POINTS: solutions of the last round */
    double *m2;            /* n x POINTS: p N_2 */
    double *e;             /* n x POINTS: modes in eta */
    double *de;            /* in V */
    const double *v0;      /* [nq] V_0 */
    double *e0;            /* [n] p V_0 */
    mt_filon_weights zero; /* of no frequency */
    mt_filon_weights *of;  /* [n] */
};

/* phi, w and p of mass[n x n] and stiff[n x n], M and K on the columns of e. */
static mt_status modes_of_springs(mt_sim *s, mt_collocation *q, const mt_elimination *e,
                                  double *mass, double *stiff, mt_err *err)
{
    const int nq = q->nq;
    const int n = e->n;
    const mt_status rc = mt_cholesky(n, mass, NULL, NULL);
    q->whole = rc == MT_OK;
    q->n = q->whole ? n : 0;
    if (!q->whole) {
        return rc == MT_E_MEMORY ? mt_fail_memory(err) : MT_OK;
    }
    /* L^-1 K L^-T, then phi = Z L^-T Y */
    mt_congruence_inverse(n, mass, stiff);
    MT_TRY(mt_eig_sym(n, stiff, q->w, true, s->mem, err));
    mt_tri_solve(true, n, n, mass, stiff, n);
    mt_gemm(false, false, nq, n, n, 1.0, e->z, nq, stiff, n, 0.0, q->phi, nq);
    mt_gemm(true, false, n, nq, nq, 1.0, q->phi, nq, s->motion.mass, nq, 0.0, q->across, n);
    mt_gemm(true, false, n, nq, nq, 1.0, q->phi, nq, q->k, nq, 0.0, q->p, n);
    const double most = n > 0 ? fmax(q->w[n - 1], 0.0) : 0.0;
    q->stiff = n;
    for (int i = n; i-- > 0;) {
        const bool is_stiff = q->w[i] > STIFF_PART * STIFF_PART * most;
        q->stiff = is_stiff ? i : q->stiff;
        for (int k = 0; k < nq; k++) {
            const ptrdiff_t at = i + ((ptrdiff_t)k * n);
            q->p[at] = is_stiff ? q->p[at] / q->w[i] : q->across[at];
        }
        q->w[i] = q->w[i] > NO_STIFFNESS * most ? sqrt(q->w[i]) : 0.0;
    }
    return MT_OK;
}

/* Modes of the springs at s->base, where s->motion was evaluated. e: with z. */
static mt_status begin_modes(mt_sim *s, mt_collocation *q, const mt_elimination *e, mt_err *err)
{
    const int nq = q->nq;
    const int n = e->n;
    mt_motion_stiffness(&s->motion, &s->base, q->k);
    double *const mz = mt_arena_f64(s->mem, (size_t)nq, (size_t)n);
    double *const mass = mt_arena_f64(s->mem, (size_t)n, (size_t)n);
    double *const stiff = mt_arena_f64(s->mem, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(s->mem, err));
    mt_gemm(false, false, nq, n, nq, 1.0, s->motion.mass, nq, e->z, nq, 0.0, mz, nq);
    mt_gemm(true, false, n, n, nq, 1.0, e->z, nq, mz, nq, 0.0, mass, n);
    mt_gemm(false, false, nq, n, nq, 1.0, q->k, nq, e->z, nq, 0.0, mz, nq);
    mt_gemm(true, false, n, n, nq, 1.0, e->z, nq, mz, nq, 0.0, stiff, n);
    return modes_of_springs(s, q, e, mass, stiff, err);
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

/*
 * xi' = V + 1/2 ad V + c_2 ad^2 V + c_4 ad^4 V, ad = [xi, .], which ends there because ad, with
 * the eigenvalues 0 and twice +- i a, has ad (ad^2 + a^2)^2 = 0. With G = a/2 cot(a/2), the sum
 * of the series' even terms at i a, and their derivative there,
 *     c_4 = (1 - G + a G'/2)/a^4,   c_2 = 2 (1 - G)/a^2 + G'/(2 a).
 */
static void carry_factors(double a, double *c2, double *c4)
{
    static const double SMALL = 0.2;
    const double y = a * a;
    if (a < SMALL) { /* next terms: a^10/473e6, a^8/378e6 */
        *c2 = (1.0 / 12.0) -
              (y * y * ((1.0 / 30240.0) + (y * ((2.0 / 1209600.0) + (y * 3.0 / 47900160.0)))));
        *c4 = (-1.0 / 720.0) -
              (y * ((2.0 / 30240.0) + (y * ((3.0 / 1209600.0) + (y * 4.0 / 47900160.0)))));
        return;
    }
    const double half = 0.5 * a;
    const double sine = sin(half);
    const double g = half * cos(half) / sine;
    const double slope = (0.5 * cos(half) / sine) - (0.5 * half / (sine * sine));
    *c4 = (1.0 - g + (half * slope)) / (y * y);
    *c2 = (2.0 * (1.0 - g) / y) + (0.5 * slope / a);
}

/* out[nq] := N_1 = xi' - V. */
static void add_brackets(const mt_system *sys, const double *xi, const double *v, double *out)
{
    for (int b = 0; b < sys->n_bodies; b++) {
        double x[6];
        double vel[6];
        double once[6];
        double twice[6];
        double thrice[6];
        double fourth[6];
        double c2 = 0.0;
        double c4 = 0.0;
        mt_pose_motion(sys, b, xi, x);
        mt_pose_motion(sys, b, v, vel);
        carry_factors(mt_norm2(3, x + 3), &c2, &c4);
        bracket(x, vel, once);
        bracket(x, once, twice);
        bracket(x, twice, thrice);
        bracket(x, thrice, fourth);
        for (int i = 0; i < 6; i++) {
            once[i] = (0.5 * once[i]) + (c2 * twice[i]) + (c4 * fourth[i]);
        }
        put_twist(sys, b, once, out);
    }
}

/* out[nq] := V' from the accelerations a. */
static void to_local(const mt_system *sys, const double *xi, const double *v, const double *a,
                     double *out)
{
    for (int b = 0; b < sys->n_bodies; b++) {
        double x[6];
        double vel[6];
        double acc[6];
        double turned[6];
        mt_pose_motion(sys, b, xi, x);
        mt_pose_motion(sys, b, v, vel);
        mt_pose_motion(sys, b, a, acc);
        const double back[3] = {-x[3], -x[4], -x[5]};
        double spin[3];
        mt_turn3(back, 2, acc, turned);
        mt_cross3(vel + 3, vel, spin);
        for (int k = 0; k < 3; k++) {
            turned[k] -= spin[k];
        }
        put_twist(sys, b, turned, out);
    }
}

/* Rotate x with the bodies; sign -1: back. */
static void turn_with(const mt_system *sys, double sign, const double *xi, double *x)
{
    for (int b = 0; b < sys->n_bodies; b++) {
        double at[6];
        double own[6];
        double turned[6];
        mt_pose_motion(sys, b, xi, at);
        mt_pose_motion(sys, b, x, own);
        const double by[3] = {sign * at[3], sign * at[4], sign * at[5]};
        mt_turn3(by, 2, own, turned);
        put_twist(sys, b, turned, x);
    }
}

/* The integral over the step of rate k. Products of a row f with the velocity V = eta' are
 * integrated by parts, [f eta] - int f' eta: fast vibrations hardly contribute to eta. */
static double integrate(const mt_collocation *q, int k, double h)
{
    const ptrdiff_t nq = q->nq;
    const double *const d = q->rule.derivative[1];
    double sum = 0.0;
    for (int j = 0; j < POINTS; j++) {
        const double weight = q->zero.nc[DEGREE + (j * POINTS)];
        const double *const eta = q->eta + (j * nq);
        const double *const f = q->rows + (((j * (ptrdiff_t)q->rates) + k) * nq);
        sum += k == 0 ? h * weight * q->rate[j] : 0.0;
        sum += j == DEGREE ? mt_dot(q->nq, f, eta) : 0.0;
        for (int i = 0; i < POINTS; i++) {
            const double *const of = q->rows + (((i * (ptrdiff_t)q->rates) + k) * nq);
            sum -= weight * d[j + (i * POINTS)] * mt_dot(q->nq, of, eta);
        }
    }
    return sum;
}

/* to[nq x columns] += sign phi w^2 p eta of the first n modes. */
static void add_springs(const mt_collocation *q, int n, int columns, double sign,
                        const double *eta, double *to)
{
    const int nq = q->nq;
    if (n == 0) {
        return;
    }
    mt_gemm(false, false, n, columns, nq, 1.0, q->p, q->n, eta, nq, 0.0, q->e, n);
    for (ptrdiff_t i = 0; i < columns; i++) {
        for (int k = 0; k < n; k++) {
            q->e[k + (i * n)] *= q->w[k] * q->w[k];
        }
    }
    mt_gemm(false, false, nq, columns, n, sign, q->phi, nq, q->e, n, 1.0, to, nq);
}

/* Rows and rates at point i, from s->rows and the slope there, at velocities v. */
static void note_rates(mt_sim *s, mt_collocation *q, int i, const double *v,
                       const double *slope)
{
    const ptrdiff_t nq = q->nq;
    double *const rows = q->rows + (i * nq * q->rates);
    memcpy(rows, s->rows, (size_t)(nq * q->rates) * sizeof *rows);
    q->rate[i] = slope[2 * nq] - mt_dot(q->nq, rows, v);
    for (int k = 0; k < q->rates; k++) {
        turn_with(s->sys, -1.0, q->xi + (i * nq), rows + (k * nq));
    }
}

/* Modes, states and N_2 at the beginning of a step, where s->motion was evaluated for s->slope.
 * Scratch memory stays in s->mem. */
static mt_status begin_collocation(mt_sim *s, mt_collocation *q, mt_elimination *e, mt_err *err)
{
    const int nq = q->nq;
    e->z = mt_arena_f64(s->mem, (size_t)nq, (size_t)e->n);
    MT_TRY(mt_arena_check(s->mem, err));
    MT_TRY(mt_eliminate_basis(e, s->mem, err));
    MT_TRY(begin_modes(s, q, e, err));
    memset(q->xi, 0, (size_t)nq * sizeof *q->xi);
    memset(q->eta, 0, (size_t)nq * sizeof *q->eta);
    memset(q->n1, 0, (size_t)nq * sizeof *q->n1);
    memcpy(q->v, s->begin + nq, (size_t)nq * sizeof *q->v);
    note_rates(s, q, 0, q->v, s->slope);
    to_local(s->sys, q->xi, q->v, s->slope + nq, q->n2);
    return MT_OK;
}

mt_status mt_collocation_new(mt_sim *s, mt_err *err)
{
    mt_collocation *const q = mt_arena_alloc(s->mem, 1, sizeof *q);
    const size_t nq = (size_t)s->nq;
    MT_TRY(mt_arena_check(s->mem, err));
    q->nq = s->nq;
    q->rates = 1 + s->n_integrals;
    q->unknowns = s->gauss.n;
    double **const square[] = {&q->phi, &q->p, &q->across, &q->k};
    double **const at_points[] = {&q->eta,  &q->xi,      &q->v,  &q->n1, &q->n2, &q->next,
                                  &q->last, &q->past_n2, &q->m2, &q->e,  &q->de, &q->past_eta};
    double **const of_nq[] = {&q->w, &q->e0};
    for (int i = 0; i < MT_COUNT(square); i++) {
        *square[i] = mt_arena_f64(s->mem, nq, nq);
    }
    for (int i = 0; i < MT_COUNT(at_points); i++) {
        *at_points[i] = mt_arena_f64(s->mem, nq, POINTS);
    }
    for (int i = 0; i < MT_COUNT(of_nq); i++) {
        *of_nq[i] = mt_arena_f64(s->mem, nq, 1);
    }
    q->y = mt_arena_f64(s->mem, (size_t)s->n, 1);
    q->slope = mt_arena_f64(s->mem, (size_t)s->n, 1);
    q->rate = mt_arena_f64(s->mem, POINTS, 1);
    q->found = mt_arena_f64(s->mem, (size_t)q->unknowns, POINTS);
    q->rows = mt_arena_f64(s->mem, nq, (size_t)q->rates * POINTS);
    q->of = mt_arena_alloc(s->mem, nq, sizeof *q->of);
    MT_TRY(mt_arena_check(s->mem, err));
    mt_filon_make(&q->rule);
    q->zero.x = nan("");
    for (int i = 0; i < s->nq; i++) {
        q->of[i].x = nan("");
    }
    mt_filon_weigh(&q->rule, 0.0, &q->zero);
    const mt_arena_mark mark = mt_arena_get_mark(s->mem);
    mt_elimination e;
    MT_TRY(mt_eliminate_factor(s->sys, s->m, s->motion.a, s->mem, &e, err));
    MT_TRY(begin_collocation(s, q, &e, err));
    mt_arena_rewind(s->mem, mark);
    s->collocation = is_stiff(s, q) ? q : NULL;
    return MT_OK;
}

/* N_2 at point i, from the states there; in the first round the solution at the point before
 * is near, then that of the last round. *err as of the accelerations. */
static mt_status evaluate_point(mt_sim *s, mt_collocation *q, int i, double t, bool first,
                                mt_err *err)
{
    double *const found = q->found + ((ptrdiff_t)i * q->unknowns);
    const size_t size = (size_t)q->unknowns * sizeof *found;
    if (!first && size > 0) {
        memcpy(s->gauss.x, found, size);
    }
    const ptrdiff_t nq = q->nq;
    double *const v = q->y + nq;
    double *const n2 = q->n2 + (i * nq);
    to_global(s->sys, q->xi + (i * nq), q->v + (i * nq), q->y, v);
    MT_TRY(mt_sim_slope(s, t, q->y, q->slope, err));
    if (size > 0) {
        memcpy(found, s->gauss.x, size);
    }
    note_rates(s, q, i, v, q->slope);
    to_local(s->sys, q->xi + (i * nq), q->v + (i * nq), q->slope + nq, n2);
    add_springs(q, q->n, 1, 1.0, q->eta + (i * nq), n2);
    return MT_OK;
}

/* eta and V at all points from n2, and where the motion `moves` from V_0 and p V_0. */
static void find_states(const mt_collocation *q, double h, bool moves, const double *n2,
                        double *eta, double *v)
{
    const int nq = q->nq;
    const int n = q->n;
    const mt_filon_weights *const z = &q->zero;
    mt_gemm(false, true, nq, POINTS, POINTS, h * h, n2, nq, z->nd, POINTS, 0.0, eta, nq);
    mt_gemm(false, true, nq, POINTS, POINTS, h, n2, nq, z->nc, POINTS, 0.0, v, nq);
    if (n > 0) {
        mt_gemm(false, false, n, POINTS, nq, 1.0, q->p, n, n2, nq, 0.0, q->m2, n);
    }
    for (int k = 0; k < n; k++) {
        const mt_filon_weights *const w = &q->of[k];
        const double start = moves ? q->e0[k] : 0.0;
        for (int i = 0; i < POINTS; i++) {
            const double c = q->rule.point[i];
            double twice = 0.0;
            double once = 0.0;
            for (int j = 0; j < POINTS; j++) {
                const int at = i + (j * POINTS);
                const double b = q->m2[k + ((ptrdiff_t)j * n)];
                twice += (w->nd[at] - z->nd[at]) * b;
                once += (w->nc[at] - z->nc[at]) * b;
            }
            q->e[k + ((ptrdiff_t)i * n)] =
                h * ((start * (filon_sine_over(w->x, c) - c)) + (h * twice));
            q->de[k + ((ptrdiff_t)i * n)] = (start * (w->c[i] - 1.0)) + (h * once);
        }
    }
    if (n > 0) {
        mt_gemm(false, false, nq, POINTS, n, 1.0, q->phi, nq, q->e, n, 1.0, eta, nq);
        mt_gemm(false, false, nq, POINTS, n, 1.0, q->phi, nq, q->de, n, 1.0, v, nq);
    }
    for (ptrdiff_t i = 0; i < POINTS && moves; i++) {
        mt_axpy(nq, h * q->rule.point[i], q->v0, eta + (i * nq));
        mt_axpy(nq, 1.0, q->v0, v + (i * nq));
    }
}

/* The largest entry of |a - b|, both nq x POINTS, as lengths; NaN is kept. */
static double largest_change(const mt_sim *s, const double *a, const double *b)
{
    double most = 0.0;
    for (ptrdiff_t i = 0; i < POINTS; i++) {
        for (ptrdiff_t k = 0; k < s->nq; k++) {
            const double d = fabs(a[k + (i * s->nq)] - b[k + (i * s->nq)]) * s->weight[k];
            most = !(d <= most) ? d : most;
        }
    }
    return most;
}

/* xi = eta + int N_1(xi, V), to `allowed`. */
static void find_increments(mt_sim *s, mt_collocation *q, double h, double allowed)
{
    const int nq = q->nq;
    const size_t size = (size_t)nq * POINTS * sizeof(double);
    double moved = HUGE_VAL;
    for (int round = 0; round < CARRIES && moved > allowed; round++) {
        for (ptrdiff_t i = 1; i < POINTS; i++) {
            add_brackets(s->sys, q->xi + (i * nq), q->v + (i * nq), q->n1 + (i * nq));
        }
        memcpy(q->next, q->eta, size);
        mt_gemm(false, true, nq, POINTS, POINTS, h, q->n1, nq, q->zero.nc, POINTS, 1.0, q->next,
                nq);
        moved = largest_change(s, q->next, q->xi);
        memcpy(q->xi, q->next, size);
    }
}

/* Compute the states at all points from N_2; returns the largest change relative to the
 * allowed error. */
static double update_point_states(mt_sim *s, mt_collocation *q, double h)
{
    const size_t size = (size_t)q->nq * POINTS * sizeof(double);
    double may[2];
    mt_sim_allowed(s, h, may);
    find_states(q, h, true, q->n2, q->eta, q->next);
    const double fast = largest_change(s, q->next, q->v);
    memcpy(q->v, q->next, size);
    memcpy(q->last, q->xi, size);
    find_increments(s, q, h, CARRIED * may[0]);
    const double far = largest_change(s, q->xi, q->last);
    return isfinite(far) && isfinite(fast) ? fmax(far / may[0], fast / may[1]) : HUGE_VAL;
}

/* x[nq x POINTS] := the part of `from` with the highest Chebyshev polynomial, a T_DEGREE(2 c -
 * 1), which is a (-1)^i at the points. */
static void take_highest(const mt_collocation *q, const double *from, double *x)
{
    const ptrdiff_t nq = q->nq;
    for (ptrdiff_t k = 0; k < nq; k++) {
        double a = 0.0;
        for (int j = 0; j < POINTS; j++) {
            a += q->rule.last[j] * from[k + (j * nq)];
        }
        for (int j = 0; j < POINTS; j++) {
            x[k + (j * nq)] = j % 2 == 0 ? a : -a;
        }
    }
}

/* x[nq] := its part that the joints allow, and `part` of the rest. */
static void lessen_violation(const mt_collocation *q, double part, double *x)
{
    if (q->n > 0) {
        mt_gemv(false, q->n, q->nq, 1.0, q->across, q->n, x, 0.0, q->e);
    }
    for (int k = 0; k < q->nq; k++) {
        x[k] *= part;
    }
    if (q->n > 0) {
        mt_gemv(false, q->nq, q->n, 1.0 - part, q->phi, q->nq, q->e, 1.0, x);
    }
}

/* s->error at the end. */
static void estimate_error(mt_sim *s, mt_collocation *q, double h)
{
    const ptrdiff_t nq = q->nq;
    const ptrdiff_t end = DEGREE * nq;
    const size_t size = (size_t)nq * sizeof(double);
    take_highest(q, q->n2, q->last);
    take_highest(q, q->n1, q->n1);
    memset(s->error, 0, size);
    for (int j = 0; j < POINTS; j++) {
        mt_axpy(q->nq, h * q->zero.nc[DEGREE + (j * POINTS)], q->n1 + (j * nq), s->error);
    }
    find_states(q, h, false, q->last, q->n1, q->next);
    mt_axpy(q->nq, 1.0, q->n1 + end, s->error);
    memcpy(s->error + nq, q->next + end, size);
    double part = q->whole ? 0.0 : 1.0; /* the farthest any body moves or turns */
    for (int k = 0; k < q->nq; k++) {
        part = fmax(part, s->weight[k] * fabs(q->xi[end + k]) / s->sys->length_m);
    }
    lessen_violation(q, fmin(part, 1.0), s->error);
    lessen_violation(q, fmin(part, 1.0), s->error + nq);
}

/* s->y and s->error at the end. */
static void finish_collocation(mt_sim *s, mt_collocation *q, double h)
{
    const ptrdiff_t nq = q->nq;
    const ptrdiff_t end = DEGREE * nq;
    to_global(s->sys, q->xi + end, q->v + end, s->y, s->y + nq);
    memcpy(s->y + (2 * nq), s->begin + (2 * nq), (size_t)(s->n - (2 * s->nq)) * sizeof *s->y);
    memset(s->error + (2 * nq), 0, (size_t)(s->n - (2 * s->nq)) * sizeof *s->error);
    s->y[2 * nq] += integrate(q, 0, h);
    for (int k = 0; k < s->n_integrals; k++) {
        s->y[(2 * nq) + 1 + s->integral[k]] += integrate(q, 1 + k, h);
    }
    estimate_error(s, q, h);
}

/* Modes that are slow in a step h. */
static int slow_modes(const mt_collocation *q, double h)
{
    int n = 0;
    while (n < q->n && q->w[n] * h < SLOW_WAVE) {
        n++;
    }
    return n;
}

/* Keep N_2 of the step to t for the next one. */
static void keep_past(mt_sim *s, mt_collocation *q, double t)
{
    const ptrdiff_t nq = q->nq;
    const size_t size = (size_t)nq * POINTS * sizeof(double);
    const double *const end = q->xi + (DEGREE * nq);
    q->past_h = fabs(q->tried_end - t) <= SAME_END * q->tried_h ? q->tried_h : 0.0;
    memcpy(q->past_n2, q->n2, size);
    memcpy(q->past_eta, q->eta, size);
    add_springs(q, slow_modes(q, q->tried_h), POINTS, -1.0, q->past_eta, q->past_n2);
    for (ptrdiff_t i = 0; i < POINTS; i++) {
        turn_with(s->sys, 1.0, end, q->past_n2 + (i * nq));
        turn_with(s->sys, 1.0, end, q->past_eta + (i * nq));
    }
}

/* to[nq x POINTS] += what the polynomial `past` of the last step changes by from its end to the
 * points of this one. */
static void continue_past(const mt_collocation *q, double h, const double *past, double *to)
{
    const ptrdiff_t nq = q->nq;
    for (int i = 1; i < POINTS; i++) {
        const double x = 1.0 + (2.0 * q->rule.point[i] * h / q->past_h);
        for (int j = 0; j < POINTS; j++) {
            const double end = j == 0 || j == DEGREE ? 1.0 : 2.0;
            double before = 1.0;
            double polynomial = x;
            double weight = 0.0;
            for (int d = 1; d <= AHEAD; d++) {
                weight +=
                    end / DEGREE * cos(PI * d * (DEGREE - j) / DEGREE) * (polynomial - 1.0);
                const double next = (2.0 * x * polynomial) - before;
                before = polynomial;
                polynomial = next;
            }
            mt_axpy(q->nq, weight, past + (j * nq), to + (i * nq));
        }
    }
}

/* N_2 at the points from its value at the first, as that of the last step goes on. */
static void predict(mt_collocation *q, double h)
{
    const ptrdiff_t nq = q->nq;
    for (int i = 1; i < POINTS; i++) {
        memcpy(q->n2 + (i * nq), q->n2, (size_t)nq * sizeof *q->n2);
    }
    if (q->past_h > 0.0 && h <= AHEAD_LENGTHS * q->past_h) {
        memset(q->next, 0, (size_t)nq * POINTS * sizeof *q->next);
        continue_past(q, h, q->past_n2, q->n2);
        continue_past(q, h, q->past_eta, q->next);
        add_springs(q, slow_modes(q, h), POINTS, 1.0, q->next, q->n2);
    }
}

/* Update after a step to t, which has moved s->base. Collocation ends here where it is not
 * faster. */
mt_status mt_collocation_accept(mt_sim *s, double t, mt_elimination *closed, mt_err *err)
{
    mt_collocation *const q = s->collocation;
    if (q == NULL) {
        return MT_OK;
    }
    keep_past(s, q, t);
    s->stiff_steps++;
    if (++q->steps < LOT) {
        return begin_collocation(s, q, closed, err);
    }
    const double pairs = (double)(s->evaluations - q->evaluations) / PAIR_EVALUATIONS;
    const double highest = q->n > 0 ? q->w[q->n - 1] : 0.0;
    if ((t - q->since) * highest < PAIR_STEP * pairs) {
        s->collocation = NULL;
        s->stalls = false;
        return MT_OK;
    }
    q->steps = 0;
    q->since = t;
    q->evaluations = s->evaluations;
    return begin_collocation(s, q, closed, err);
}

/* The weights of a step h. A slow mode's frequency that differs by little is as good: N_2 has
 * the rest. */
static void weigh(mt_collocation *q, double h)
{
    for (int k = 0; k < q->n; k++) {
        const double x = q->w[k] * h;
        if (x > FAST_WAVE || !(fabs(x - q->of[k].x) < SAME_PHASE)) {
            mt_filon_weigh(&q->rule, x, &q->of[k]);
        }
        q->w[k] = q->of[k].x / h;
    }
}

/* Advance s->begin by a step h from t into s->y, its error in s->error. s->stalls: the
 * iteration did not converge, the step is too long. Fails as mt_sim_slope. */
mt_status mt_collocate(mt_sim *s, double t, double h, mt_err *err)
{
    mt_collocation *const q = s->collocation;
    const ptrdiff_t nq = q->nq;
    q->v0 = s->begin + nq;
    q->tried_h = h;
    q->tried_end = t + h;
    weigh(q, h);
    if (q->n > 0) {
        mt_gemv(false, q->n, q->nq, 1.0, q->p, q->n, q->v0, 0.0, q->e0);
    }
    for (int i = 1; i < POINTS; i++) {
        memset(q->xi + (i * nq), 0, (size_t)nq * sizeof *q->xi);
        memcpy(q->v + (i * nq), q->v0, (size_t)nq * sizeof *q->v);
    }
    predict(q, h);
    double last = HUGE_VAL;
    s->stalls = false;
    (void)update_point_states(s, q, h);
    for (int round = 0;; round++) {
        for (int i = 1; i < POINTS; i++) {
            MT_TRY(evaluate_point(s, q, i, t + (q->rule.point[i] * h), round == 0, err));
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
