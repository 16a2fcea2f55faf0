/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_PROPAGATE_PRIV_H
#define SIMULATE_PROPAGATE_PRIV_H

#include "linalg/exponential.h"
#include "simulate/form.h"
#include "simulate/propagate.h"

/* A linear motion under way (propagate.c says which states it has). */

/* One input's own states. */
typedef struct mt_input_state {
    bool fitted;
    int first;  /* its states */
    int degree; /* of the polynomial; -1: none */
    double scale;
    mt_form form; /* now */
    double largest;
} mt_input_state;

typedef struct mt_propagation {
    mt_oscillators o;
    const mt_sim_options *opt;
    mt_arena *mem;
    mt_arena own; /* the matrices of a piece */
    mt_sim_result *out;
    int room;
    int n;  /* modes */
    int nz; /* states */
    double *w;
    mt_input_state *input;
    double *a; /* nz x nz */
    double *p;
    double *see;          /* gauges x nz: accelerations */
    mt_exponential whole; /* a sample's step */
    bool has_whole;
    int halvings; /* of each step */
    double *z;
    double *begin; /* [nz] of the step */
    double *inner; /* [nz] within it */
    double *rate;  /* [nz] z' */
    double *work;  /* [nz] */
    double *u;     /* [inputs] */
    double t;
    double until; /* the end of the piece */
    double done;  /* work [J] */
    double energy0;
    double potential0;
    double set_at; /* where the states of inputs stand, NaN: nowhere, and for which step */
    double set_step;
    int pieces;          /* of the inputs, so far */
    double free_state;   /* |(a, b)| below which no distance comes to 0 */
    double fast;         /* how fast bodies have been [m/s] */
    double *turn_weight; /* [nq] 1, or the model's length on rotations */
    double *speed;       /* [gauges] at the begin of the step */
    double *checked;     /* CHECKS x (n e, n e', n e'', inputs): states to be checked */
    double *weight;      /* [CHECKS] their size */
    bool known;          /* inputs and lengths are as they have to be */
    bool coarse;         /* an input is not fitted by its polynomial */
} mt_propagation;

static inline void mt_propagation_add(mt_propagation *r, int row, int column, double value)
{
    r->a[row + ((ptrdiff_t)column * r->nz)] += value;
}

/* Forms of all inputs behind r->t, r->until and r->known. *changed: they have other states than
 * before, or there were none. */
mt_status mt_propagation_forms(mt_propagation *r, bool *changed, mt_err *err);
/* The entries of input i in A and P; h: unit of time of its polynomial. */
void mt_propagation_couple(mt_propagation *r, int i, double h);
/* The states of inputs at t, where a step h begins (below 0: ends), and r->u. */
mt_status mt_propagation_set(mt_propagation *r, double t, double h, mt_err *err);
/* Value and velocity of a gauge, and its acceleration against the ground. */
void mt_propagation_see(const mt_propagation *r, int g, double out[3]);
/* Turning points of all gauges in the step of e->f[j] from t on; its begin is in r->begin, its
 * end in r->z. What is rounding beside the motion of the bodies does not count. */
mt_status mt_propagation_turnings(mt_propagation *r, const mt_exponential *e, int j, double t,
                                  mt_err *err);

#endif
