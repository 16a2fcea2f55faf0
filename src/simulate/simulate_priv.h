/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_SIMULATE_PRIV_H
#define SIMULATE_SIMULATE_PRIV_H

#include "simulate/accelerate.h"
#include "simulate/ode.h"
#include "simulate/simulate.h"

/*
 * The state of a motion during integration. The integrated vector y[n]:
 *     u  [nq]  increments from the pose `base`, where the step began
 *     v  [nq]  velocities
 *     w  [1]   work of inputs and dampers
 *     z  [n_gauges]  integrals of the gauges' velocities
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
    int n;          /* of y */
    double *y;      /* at the end of the step */
    double *begin;  /* at its beginning: u = 0 */
    double *slope;  /* slope at its beginning */
    double *error;  /* of the step */
    double *probe;  /* [n] */
    double *along;  /* [nq] */
    double *push;   /* [nq] inputs */
    double *force;  /* [nq] */
    double *b;      /* [m] */
    double *lambda; /* [m] */
    double *weight; /* [nq] 1, or the model's length on rotations */
    double *speed;  /* [n_gauges] at the beginning of the step */
    mt_gauge_motion gauge;
    double still;    /* drive of the rest position */
    int rank;        /* rank of the joints' equations at the start; -1: not known yet */
    mt_arena names;  /* names of joints, for messages */
    double free_way; /* largest displacement in a step [rad, model lengths] */
    long evaluations;
    double far;  /* largest displacement of a body so far [m] */
    double fast; /* largest speed of a body so far [m/s] */
    double gap_m;
    double left_m;
} mt_sim;

mt_status mt_sim_init(mt_sim *s, mt_linear *lin, const mt_sim_start *start,
                      const mt_sim_options *opt, mt_arena *mem, mt_err *err);
void mt_sim_free(mt_sim *s);
/* The mt_ode_slope of an mt_sim. */
mt_status mt_sim_slope(void *sim, double t, const double *y, double *out, mt_err *err);
/* Accelerations, power and velocities of gauges where the base is moved by u, at velocities v,
 * into out[nq + 1 + gauges]. rows not NULL, nq x (1 + gauges): gets forces of the inputs and
 * rows of the gauges; out then lacks their products with v. */
mt_status mt_sim_rates(mt_sim *s, double t, const double *u, const double *v, double *out,
                       double *rows, mt_err *err);
/* Allowed errors of a step h: of positions [m] and of velocities [m/s]. */
void mt_sim_allowed(const mt_sim *s, double h, double out[2]);
/* Advance s->begin by a step h from t into s->y. */
mt_status mt_sim_advance(mt_sim *s, double t, double h, mt_err *err);
/* Make s->y at t the beginning of the next step: projected onto the joints, base moved, turns
 * counted, slope computed. */
mt_status mt_sim_accept(mt_sim *s, double t, mt_err *err);
/* Value, velocity and absolute acceleration of a gauge at the beginning of the step, at t. */
mt_status mt_sim_gauge(mt_sim *s, double t, int gauge, double out[3], mt_err *err);
/* mt_sim_ahead evaluates at s->y, after mt_sim_advance to t; mt_sim_gauge_ahead then gives
 * value, velocity and acceleration relative to the ground of a gauge there. */
mt_status mt_sim_ahead(mt_sim *s, double t, mt_err *err);
void mt_sim_gauge_ahead(mt_sim *s, int gauge, double out[3]);

#endif
