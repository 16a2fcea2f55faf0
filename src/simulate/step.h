/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_STEP_H
#define SIMULATE_STEP_H

#include "base/base.h"
#include "simulate/accelerate.h"
#include "simulate/simulate.h"

/*
 * Successive solutions along a motion, whose masses and equations change little between them:
 * with the inverse of
 *     S [M -A^T; A 0] S,   S a scale of each unknown,
 * at an earlier position, the residual of the present equations is reduced by iterative
 * refinement until it is rounding, for a fourth of the work of an elimination. Where that does
 * not converge, or the equations are singular, mt_gauss_solve gives the answer, and its
 * position the next inverse.
 */
typedef struct mt_gauss_near {
    int n; /* unknowns; 0: too many, every solution by elimination */
    bool known;
    double *inverse; /* n x n */
    double *scale;   /* [n] */
    double *x;       /* [n] */
    double *rest;    /* [n] */
    double *step;    /* [n] */
    long served;     /* solutions by this inverse */
    long wait;       /* eliminations until the next inverse */
    long patience;   /* least wait after an inverse that did not converge */
} mt_gauss_near;

mt_status mt_gauss_near_init(mt_gauss_near *o, const mt_system *sys, int m, mt_arena *mem,
                             mt_err *err);
/* As mt_gauss_solve. O(nq^2) where the inverse serves. */
mt_status mt_gauss_solve_near(mt_gauss_near *o, const mt_system *sys, const mt_gauss *g,
                              double *x, double *lambda, mt_arena *mem, mt_err *err);

/*
 * Steps of an ordinary differential equation y' = f(t, y): Prince and Dormand's explicit
 * Runge-Kutta pair of the orders eight and seven, thirteen evaluations a step (GSL's).
 */
typedef struct mt_ode mt_ode;

enum { MT_ODE_ORDER = 8 };

/*
 * The state of a motion during integration. The integrated vector y[n]:
 *     u  [nq]  increments from the pose `base`, where the step began
 *     v  [nq]  velocities
 *     w  [1]   work of inputs and dampers
 *     z  [n_gauges]  integrals of velocities of gauges that have no value; 0 of the others
 */
typedef struct mt_collocation mt_collocation;

typedef struct mt_sim {
    mt_linear *lin;
    const mt_system *sys;
    const mt_sim_options *opt;
    mt_arena *mem;
    mt_motion motion;
    mt_placement start; /* at the start of the motion */
    mt_placement base;
    mt_placement at;
    mt_gauss_near gauss;
    mt_ode *ode;
    mt_collocation *collocation; /* NULL: explicit steps */
    long stiff_steps;            /* steps by collocation */
    bool stalls;                 /* the last step is too long for the collocation */
    int nq;
    int m;
    int n;           /* of y */
    double *y;       /* at the end of the step */
    double *begin;   /* at its beginning: u = 0 */
    double *slope;   /* slope at its beginning */
    double *error;   /* of the step */
    double *probe;   /* [n] */
    double *along;   /* [nq] */
    double *push;    /* [nq] inputs */
    double *force;   /* [nq] */
    double *b;       /* [m] */
    double *lambda;  /* [m] */
    double *weight;  /* [nq] 1, or the model's length on rotations */
    double *speed;   /* [n_gauges] at the beginning of the step */
    int n_integrals; /* gauges that have no value, only the integral of their velocity */
    int *integral;   /* [n_integrals] */
    double *rows;    /* nq x (1 + n_integrals): forces of the inputs, rows of these gauges */
    mt_gauge_motion gauge;
    double still[MT_DRIVES_MOST]; /* drives of the rest position */
    int rank;         /* rank of the joints' equations at the start; -1: not known yet */
    mt_arena names;   /* names of joints, for messages */
    double free_way;  /* largest displacement in a step [rad, model lengths] */
    double free_time; /* a step as long as this is free of that limit [s] */
    long evaluations;
    double far;  /* largest displacement of a body so far [m] */
    double fast; /* largest speed of a body so far [m/s] */
    double gap_m;
    double left_m;
} mt_sim;

mt_status mt_sim_init(mt_sim *s, mt_linear *lin, const mt_sim_start *start,
                      const mt_sim_options *opt, mt_arena *mem, mt_err *err);
void mt_sim_free(mt_sim *s);
/* The mt_ode_slope of an mt_sim; s->rows are those there. */
mt_status mt_sim_slope(void *sim, double t, const double *y, double *out, mt_err *err);
/* Allowed errors of a step h: of positions [m] and of velocities [m/s]. */
void mt_sim_allowed(const mt_sim *s, double h, double out[2]);
/* Advance s->begin by a step h from t into s->y. */
mt_status mt_sim_advance(mt_sim *s, double t, double h, mt_err *err);
/* Make s->y at t the beginning of the next step: projected onto the joints, base moved, turns
 * counted, slope computed. */
mt_status mt_sim_accept(mt_sim *s, double t, mt_err *err);
/* Value, velocity and absolute acceleration of a gauge at the beginning of the step, at t. */
mt_status mt_sim_gauge(mt_sim *s, double t, int gauge, double out[3], mt_err *err);
/* Values, velocities and accelerations relative to the ground of all gauges, out[3 n_gauges],
 * at s->y, after mt_sim_advance to t. */
mt_status mt_sim_ahead(mt_sim *s, double t, double *out, mt_err *err);

/*
 * Integrals of waves times polynomials (Filon quadrature): with l_j Lagrange's polynomials
 * through Chebyshev points c_j of [0, 1], the ends among them,
 *     int_0^(c_i) cos(x (c_i - s)) l_j(s) ds, and the same of sin/x,
 * for any x >= 0.
 */
enum { MT_FILON_DEGREE = 8, MT_FILON_POINTS = MT_FILON_DEGREE + 1, MT_FILON_GAUSS = 48 };

/* The part that does not depend on x. */
typedef struct mt_filon {
    double point[MT_FILON_POINTS];
    double node[MT_FILON_GAUSS];
    double gauss[MT_FILON_GAUSS];
    double basis[MT_FILON_POINTS * MT_FILON_GAUSS * MT_FILON_POINTS]; /* l_j at c_i node_g */
    /* number k of l_j at point i: [k][i + j POINTS] */
    double derivative[MT_FILON_POINTS][MT_FILON_POINTS * MT_FILON_POINTS];
    double last[MT_FILON_POINTS]; /* the coefficient of the highest Chebyshev polynomial */
} mt_filon;

/* The integrals for one x: entry i + j POINTS belongs to l_j and c_i. */
typedef struct mt_filon_weights {
    double x;
    double c[MT_FILON_POINTS]; /* cos x c_i */
    double s[MT_FILON_POINTS];
    double nc[MT_FILON_POINTS * MT_FILON_POINTS];
    double nd[MT_FILON_POINTS * MT_FILON_POINTS]; /* with sin/x */
} mt_filon_weights;

void mt_filon_make(mt_filon *q);
/* Compute the weights for x; returns at once where w->x is x (a new w has x NaN). Errors: some
 * 1e-14. */
void mt_filon_weigh(const mt_filon *q, double x, mt_filon_weights *w);

/*
 * One step of a stiff motion. Vibrations of the springs about the pose at the beginning of the
 * step are solved exactly; the remaining accelerations are a polynomial in time. Its smoothness
 * limits the step, not the fastest vibration.
 */

/* Make s->collocation where the springs at s->base make the motion stiff. Fails: MT_E_MEMORY,
 * MT_E_NO_CONVERGENCE (eigenvalues), MT_E_DOMAIN. */
mt_status mt_collocation_new(mt_sim *s, mt_err *err);
/* The step of mt_sim_advance where there is s->collocation. s->stalls: its iteration does not
 * converge, the step is too long. */
mt_status mt_collocate(mt_sim *s, double t, double h, mt_err *err);
/* After a step to t, which has moved s->base, where s->slope was computed and the joints have
 * this elimination; nothing where there is no collocation. Fails as mt_collocation_new. */
mt_status mt_collocation_accept(mt_sim *s, double t, mt_elimination *closed, mt_err *err);

#endif
