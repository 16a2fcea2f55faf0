/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_PROPAGATE_PRIV_H
#define SIMULATE_PROPAGATE_PRIV_H

#include "linalg/exponential.h"
#include "simulate/form.h"
#include "simulate/propagate.h"

/* The state of a linear motion during propagation (its states are listed in propagate.c). */

/* The states of one input. */
typedef struct mt_input_state {
    bool fitted;
    int first;  /* index of its first state */
    int degree; /* of the polynomial; -1: none */
    double scale;
    mt_form form; /* the present form */
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
    double *see;          /* gauges x nz: accelerations of gauges */
    mt_exponential whole; /* over one sample */
    bool has_whole;
    int halvings; /* halvings of each step */
    double *z;
    double *begin; /* [nz] at the beginning of the step */
    double *inner; /* [nz] within the step */
    double *rate;  /* [nz] z' */
    double *work;  /* [nz] */
    double *u;     /* [inputs] */
    double t;
    double until; /* end of the present piece */
    double done;  /* work [J] */
    double energy0;
    double potential0;
    double set_at; /* time of the states of inputs, NaN: none */
    double set_step;
    int pieces;          /* pieces of the inputs so far */
    double free_state;   /* |(a, b)| below which no distance becomes 0 */
    double fast;         /* largest speed of a body so far [m/s] */
    double *turn_weight; /* [nq] 1, or the model's length on rotations */
    double *speed;       /* [gauges] at the beginning of the step */
    double *checked;     /* CHECKS x (n e, n e', n e'', inputs): states to be checked */
    double *weight;      /* [CHECKS] size of these states */
    bool known;          /* inputs and lengths meet the conditions of this method */
    bool coarse;         /* the polynomial of an input does not fit it */
} mt_propagation;

static inline void mt_propagation_add(mt_propagation *r, int row, int column, double value)
{
    r->a[row + ((ptrdiff_t)column * r->nz)] += value;
}

/* Set the forms of all inputs after r->t, r->until and r->known. *changed: their states differ
 * from those before, or there were none. */
mt_status mt_propagation_forms(mt_propagation *r, bool *changed, mt_err *err);
/* Set the entries of input i in A and P; h: unit of time of its polynomial. */
void mt_propagation_couple(mt_propagation *r, int i, double h);
/* Set the states of inputs at t, the beginning of a step h (the end where h < 0), and r->u. */
mt_status mt_propagation_set(mt_propagation *r, double t, double h, mt_err *err);
/* Value and velocity of a gauge, and its acceleration relative to the ground. */
void mt_propagation_see(const mt_propagation *r, int g, double out[3]);
/* Add the turning points of all gauges within the step of e->f[j] from t, which begins at
 * r->begin and ends at r->z. Turning points within rounding of the motion of the bodies are
 * left out. */
mt_status mt_propagation_turnings(mt_propagation *r, const mt_exponential *e, int j, double t,
                                  mt_err *err);

#endif
