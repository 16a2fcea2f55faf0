/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_LARGE_PRIV_H
#define RESPONSE_LARGE_PRIV_H

#include "mechanics/absolute.h"
#include "mechanics/rows.h"
#include "response/large.h"

/* Shared by large.c and large_forces.c. */

/* A generalised force on the bodies, and its projections. */
typedef struct mt_large_force {
    mt_lowest_push push;
    double loss;    /* loss factor of a spring's force: the force times 1 + i loss */
    double *in_all; /* [n] in the coordinates of the problem */
    mt_left_part left;
} mt_large_force;

typedef struct mt_large_side {
    mt_large_force f;
    double damping;
    double structural;
    int partner; /* the side paired with this one; may be itself */
} mt_large_side;

typedef struct mt_large_work {
    mt_lowest *l;
    const mt_port_set *ports;
    mt_arena *mem;
    mt_arena *scratch;
    mt_large *out;
    char *why;
    mt_data d;
    mt_placement at;
    mt_term_list list[MT_TERM_KINDS];
    int n_x;
    int free;
    int kept;     /* vibration modes */
    int size;     /* columns of x */
    int most;     /* capacity of x, columns */
    double *x;    /* n_x x most, orthonormal */
    double *ax;   /* H A times each column: x^T A x in the norm of H is x^T ax */
    double *dual; /* [n_x] work */
    double to;
    double shift;
    double alpha;
    double beta;
    double loss; /* common to all springs */
    mt_large_force *in;
    mt_large_force *outs;
    mt_large_side *sides;
    int n_sides;
    double *states; /* [nq] */
    double *theta;
    double *z;
} mt_large_work;

/* Sets the reason of a refusal; returns false. */
bool mt_large_refuse(mt_large_work *k, const char *why);
/* Value of a node; 0 where there is none. */
double mt_large_value(const mt_large_work *k, mt_node node);
/* Power of s of an output. */
int mt_large_power(const mt_port *out);
/* Writes the row of a sensor's direction into k->states. */
void mt_large_sensor_row(mt_large_work *k, int channel);
/* Forces of all inputs, outputs and local dampers. *is false: refused. Fails: MT_E_MEMORY. */
mt_status mt_large_forces(mt_large_work *k, bool *is, mt_err *err);

#endif
