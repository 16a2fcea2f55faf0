/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_MODAL_H
#define MODAL_MODAL_H

#include <stdbool.h>

#include "base/arena.h"

/*
 * Undamped natural modes of the reduced system  K y = lambda M y,  lambda = omega^2,  Y^T M Y = I,  lowest first. This room knows matrices only.
 * K, M: n x n symmetric, lower triangle read, column-major, unchanged. K may be indefinite; M must be positive (semi)definite.
 *
 * M singular: the directions without mass are condensed statically where K is regular on them (K10 K00^-1 K01); n_condensed of them, then only
 * n - n_condensed modes exist. Otherwise MT_E_MASSLESS with the direction.
 *
 * Kinds (numerics: never take the absolute value): with scale s = the stiffness scale of the problem (largest eigenvalue of the pencil restricted to what is
 * stiff), |lambda| <= RIGID_BODY_ULPS * n * eps * s is a rigid-body mode (lambda set to exactly 0), below minus that unstable, above flexible. Where `n_rigid` >= 0 is given
 * (fixed at the original design) exactly the n_rigid eigenvalues of smallest magnitude are rigid-body modes.
 */
typedef enum mt_mode_kind { MT_MODE_FLEXIBLE, MT_MODE_RIGID_BODY, MT_MODE_UNSTABLE } mt_mode_kind;

/* Optional exact-rank form of K: K = B^T diag(c) B with c >= 0, rows x n (column-major, ld rows). With it the lowest modes keep their relative accuracy however
 * far the stiffnesses lie apart (singular values of diag(sqrt c) B L^-T instead of eigenvalues of its square). */
typedef struct mt_stiffness_factor {
    int rows;
    const double *b; /* rows x n */
    const double *c; /* [rows], >= 0 */
} mt_stiffness_factor;

typedef struct mt_modal_options {
    int n_rigid;      /* -1: decide here; else the number of rigid-body modes */
    bool vectors;     /* compute y */
    bool need_accuracy; /* with a factor: use it whenever eps * lambda_max / lambda_lowest_flexible exceeds FACTOR_SWITCH */
} mt_modal_options;
mt_modal_options mt_modal_options_default(void);

typedef struct mt_modes {
    int n;           /* order of K, M */
    int count;       /* modes: n - n_condensed */
    int n_condensed;
    int n_rigid;
    int n_unstable;
    double *lambda;  /* [count] ascending [rad^2/s^2] */
    mt_mode_kind *kind; /* [count] */
    int *cluster;    /* [count] number of the cluster of repeated modes that a mode belongs to (equal numbers, ascending) */
    double *y;       /* n x count, mass-normalised, sign: entry of largest magnitude positive; NULL without vectors */
    double *residual; /* [count] ||K y - lambda M y|| / ((||K|| + |lambda| ||M||) ||y|| n eps): LAPACK-style ratio, O(1) is perfect; with vectors */
    double *orthogonality; /* [count] max_j |y_i^T M y_j - delta_ij| / (n eps); with vectors */
    double error_bound; /* absolute backward error on lambda that the method leaves (for certificates and for saying so) */
    bool from_factor;
    double scale;    /* the stiffness scale s */
} mt_modes;

/* Compute the modes. Results live in mem. massless (n, may be NULL) receives the offending direction on MT_E_MASSLESS. */
mt_status mt_modal_solve(int n, const double *k, const double *m, const mt_stiffness_factor *factor, const mt_modal_options *opt, mt_arena *mem,
                         mt_modes *out, double *massless, mt_err *err);

/* lambda -> Hz: sqrt(lambda)/(2 pi); 0 for rigid-body modes; NaN (nan("")) for unstable modes. */
double mt_modal_hz(const mt_modes *modes, int i);
/* Position in lambda of vibration mode `index` (1-based, flexible modes ascending); -1 where there are fewer, or where any mode is unstable. */
int mt_modal_flexible(const mt_modes *modes, int index);

/* Make each column's entry of largest magnitude positive (first one wins a tie, relative 1e-12...: see modal_sign.c). phi n x r. */
void mt_modal_fix_sign(int n, int r, double *phi);

/*
 * Derivatives. The caller gives, for a parameter p, products with the chosen modes: dky = (dK/dp) y_i, dmy = (dM/dp) y_i, columns n each, one column per listed mode.
 */
/* dlambda_i/dp = y_i^T (dky_i - lambda_i dmy_i). For a mode inside a cluster of more than one: *repeated is set and the value is NaN: no single-mode gradient exists.
 * list[count]: positions of modes. dlambda [count]. */
void mt_modal_dlambda(const mt_modes *modes, int count, const int *list, const double *dky, const double *dmy, double *dlambda, bool *repeated);
/* For a cluster: the r x r matrix Y^T (dK - lambda dM) Y, whose eigenvalues are the directional derivatives of the cluster. first: its first position, r its size. */
void mt_modal_dcluster(const mt_modes *modes, int first, int r, const double *dky, const double *dmy, double *out);

/* Eigenvector derivatives by the bordered system (Lee and Jung 1997), valid for a simple mode of any kind, also with singular M:
 *   [K - lambda M   -M y] [dy     ]   [-(dK - lambda dM) y]
 *   [-y^T M          0  ] [dlambda] = [ 1/2 y^T dM y       ]
 * One factorisation per mode, np right-hand sides: dky, dmy n x np (column p: product with dK/dp_p); dy n x np; dlambda np (may be NULL).
 * Fails MT_E_SINGULAR at a repeated mode. Note dy is the derivative of the mass-normalised vector with its sign held. */
mt_status mt_modal_dvector(int n, const double *k, const double *m, double lambda, const double *y, int np, const double *dky, const double *dmy,
                           double *dy, double *dlambda, mt_arena *scratch, mt_err *err);

/*
 * MAC (Ewins; paper Eq. 19) of shapes sampled at common sensors: a ns x ra, b ns x rb, mac ra x rb column-major:
 *   mac_ij = (a_i . b_j)^2 / ((a_i . a_i)(b_j . b_j)), in [0, 1]; NaN where a shape vanishes at all sensors (no statement possible).
 */
void mt_mac_matrix(int ns, int ra, const double *a, int rb, const double *b, double *mac);
/* One-to-one pairing that maximises the sum of MAC; pair[ra] = column of b or -1. */
mt_status mt_mac_pair(int ra, int rb, const double *mac, int *pair, mt_arena *scratch, mt_err *err);
/* Subspace MAC: squared cosine of each principal angle between span(a) and span(b), descending, cos2[min(ra, rb)]. Use inside clusters. */
mt_status mt_mac_subspace(int ns, int ra, const double *a, int rb, const double *b, double *cos2, mt_arena *scratch, mt_err *err);
/* d mac(a, b) / dp for da = d a / dp (b fixed): 2 (a.b)(da.b)/(aa bb) - 2 mac (a.da)/aa. */
double mt_mac_derivative(int ns, const double *a, const double *da, const double *b);

#endif
