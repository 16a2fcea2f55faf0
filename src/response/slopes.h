/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_SLOPES_H
#define RESPONSE_SLOPES_H

#include "response/basis.h"
#include "response/problem.h"

/* Ports of a problem and the basis of all modes that solves it. */
typedef struct mt_slope_problem {
    mt_analysis *a; /* its last solve had a gradient */
    const mt_basis *basis;
    const mt_port_set *ports;
    const mt_response_ways *ways;
} mt_slope_problem;

/**
 * Exact derivatives of all responses with respect to all inputs of the analysis, at w [rad/s].
 * @param[out] dh  n_out x n_in x n_inputs, column-major [unit of H per unit of the input]; NaN
 *   where no derivative exists: at an undamped resonance, and where joints that are redundant
 *   at this value only would block a motion or come apart at neighbouring values
 * O(n^3 + pairs n_inputs entries of the terms). Fails: MT_E_INTERNAL (no gradient),
 * MT_E_MEMORY.
 */
mt_status mt_response_slopes(const mt_slope_problem *p, double w, double complex *dh,
                             mt_arena *scratch, mt_err *err);

/* Shared by the derivatives at one frequency and their sums over many. */

/* c_0 + c_1 s + c_2 s^2. */
typedef struct mt_slope_factor {
    double complex c[MT_FORCED_POWERS];
} mt_slope_factor;

/* Factors of the sum D over the states: K + s beta K, i H, s C, s^2 M + s alpha M. Modal
 * damping ratios are separate. */
enum { MT_SLOPE_MATRICES = 4 };
void mt_slope_matrices(const mt_analysis *a, mt_slope_factor *d);

/* f[nq] += force of an input. */
void mt_slope_push(const mt_linear *lin, const mt_port *in, double *f);
/* e, nq x (n + 1): the motions of the n degrees of freedom, and -v[nq] (NULL: 0). Fails:
 * MT_E_MEMORY. */
mt_status mt_slope_motions(const mt_linear *lin, int nq, int n, const double *v, double *e,
                           mt_arena *mem, mt_err *err);
/* Row of a sensor's direction among the channel terms. */
int mt_slope_channel(const mt_linear *lin, const mt_port *port);
/* A part of an output other than a joint's force: factor times the motion along row. */
typedef struct mt_slope_part {
    int row;
    mt_term_kind kind;
    mt_slope_factor factor;
    mt_force_part force; /* of a spring or damper; term NULL: neither */
} mt_slope_part;
/* part[MT_FORCE_PARTS]: the parts of an output. Returns their number. */
int mt_slope_parts(const mt_analysis *a, const mt_port *port, mt_slope_part *part);
/* Derivative of a part's factor with respect to input p. */
mt_slope_factor mt_slope_turn(const mt_analysis *a, int p, const mt_slope_part *part);
/* Derivative of a node with respect to input p; 0 where there is none. */
double mt_slope_node(const mt_analysis *a, int p, mt_node node);
/* Checks that the last solve had a gradient. Fails: MT_E_INTERNAL. */
mt_status mt_slope_admit(const mt_slope_problem *p, mt_err *err);

/*
 * Solutions x = D^-1 B u and adjoints y = D^-1 S^T of one input and one output at many
 * frequencies, in the coordinates of the problem.
 */
typedef struct mt_solutions {
    const mt_basis *basis; /* not owned */
    mt_transfer one;       /* the transfer of that pair alone */
    int in;
    int out;
} mt_solutions;

/* Real and imaginary parts, each n x count. */
typedef struct mt_solved {
    double *x[2];
    double *y[2];
} mt_solved;

/* Solutions at w [rad/s] for all inputs and outputs: x (n x n_in) and y (n x n_out). *singular:
 * D is singular, x and y are not set. Fails: MT_E_DOMAIN, MT_E_MEMORY. */
mt_status mt_basis_solve(const mt_basis *b, double w, double complex *x, double complex *y,
                         bool *singular, mt_arena *scratch, mt_err *err);
/* Results in mem; refers to the basis. Fails: MT_E_MEMORY. */
mt_status mt_solutions_open(const mt_basis *basis, int out, int in, mt_arena *mem,
                            mt_solutions *s, mt_err *err);
/* At w: x[n], y[n], and the value h of the response, infinite where it has none (transfer.h).
 * *singular: x and y are not set. Fails: MT_E_DOMAIN, MT_E_MEMORY. */
mt_status mt_solutions_one(const mt_solutions *s, double w, double complex *x,
                           double complex *y, double complex *h, bool *singular,
                           mt_arena *scratch, mt_err *err);
/* At w[count]. *singular: D is singular at one of them. O(n^2) for each where damping is
 * diagonal. Fails: MT_E_DOMAIN, MT_E_MEMORY. */
mt_status mt_solutions_at(const mt_solutions *s, int count, const double *w,
                          const mt_solved *out, bool *singular, mt_arena *scratch, mt_err *err);

#endif
