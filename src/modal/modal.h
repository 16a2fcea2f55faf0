/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_MODAL_H
#define MODAL_MODAL_H

#include <stdbool.h>

#include "base/arena.h"
#include "base/interrupt.h"

/*
 * Undamped natural modes of the reduced system
 *     K y = lambda M y,   lambda = omega^2,   Y^T M Y = I,   lowest first.
 * This room knows matrices only. K, M: n x n symmetric, column-major, lower triangle read,
 * unchanged. K may be indefinite; M must be positive (semi)definite. Units are the caller's,
 * rows may have different ones: no decision below depends on them.
 *
 * M singular: the directions without mass are condensed statically where K is regular on them
 * (K10 K00^-1 K01); n_condensed of them, then only n - n_condensed modes exist. Otherwise
 * MT_E_MASSLESS with the direction.
 *
 * Kinds (never take the absolute value of an eigenvalue): with the stiffness scale s and noise
 * = 16 n eps s (see modal_priv.h), |lambda| <= noise is a rigid-body mode (lambda set to
 * exactly 0), below minus that unstable, above flexible. Where n_rigid >= 0 is given (fixed for
 * a family of designs) exactly the n_rigid eigenvalues of smallest magnitude are rigid-body
 * modes; of the others those below -noise are unstable, and those in [-noise, 0) are flexible
 * with lambda = 0: a vibration of 0 Hz, as a spring lets go whose stiffness reaches 0. Where
 * stiffness holds some of the n_rigid, n_held says how many: the number given is wrong there.
 * Matrices alone cannot tell a rigid-body mode from one whose stiffness drowned in rounding:
 * that takes the terms of K (mt_modal_judge), and a mode that even they leave open, |lambda| at
 * most its error while springs do move, is undecided. No mode has an index beside an unstable
 * or an undecided one.
 */
typedef enum mt_mode_kind {
    MT_MODE_FLEXIBLE,
    MT_MODE_RIGID_BODY,
    MT_MODE_UNSTABLE,
    MT_MODE_UNDECIDED /* rounding hides the sign of lambda */
} mt_mode_kind;

/* A mass matrix made ready for many solves. Lives in the arena that it was made in; fields are
 * for src/modal only, except n, rank and condition. */
typedef struct mt_mass_factor {
    int n;
    int rank;        /* directions with mass; n - rank have none */
    const double *m; /* n x n, the caller's, must outlive this; NULL: identity */
    /* n x n Cholesky factor of m; NULL where t is used, or m is the identity */
    const double *l;
    const double *t;  /* n x n basis [T1 T0], T1^T M T1 = I (rank columns), M T0 = 0; NULL where
                         l is used */
    const double *d;  /* [n] 1/sqrt(m_ii), 0 for a coordinate without mass */
    const double *w;  /* [n] diagonal of M^-1 (of T1 T1^T) */
    double condition; /* max m_ii (M^-1)_ii, >= 1: how oblique the coordinates are to M;
                         infinite where singular */
    double kept;      /* the same of the directions that have mass */
} mt_mass_factor;

/* Factor M. O(n^3), 2 us for n = 11. A direction has no mass where the eigenvalue of the mass
 * matrix scaled to unit diagonal is at most 16 n eps. Fails: MT_E_NOT_SPD (a direction with
 * negative mass), MT_E_DOMAIN (not finite), MT_E_MEMORY. */
mt_status mt_modal_factor_mass(int n, const double *m, mt_arena *mem, mt_mass_factor *out,
                               mt_err *err);
/* M = I. Costs nothing and makes each solve cheaper. */
mt_status mt_modal_identity_mass(int n, mt_arena *mem, mt_mass_factor *out, mt_err *err);

/* Optional exact-rank form of K: K = B^T diag(c) B + G with c >= 0, rows x n (column-major, ld
 * rows). With it the lowest modes keep their relative accuracy however far the stiffnesses c
 * lie apart; without G, rigid-body modes are found as the null space of B, whatever c is. G is
 * the part that is no sum of squares, as the geometric stiffness of loads: accuracy is then
 * that of G, but no stiffness c costs any of it (loaded.c). Ignored where M is singular. */
typedef struct mt_stiffness_factor {
    int rows;
    const double *b; /* rows x n */
    const double *c; /* [rows], >= 0 */
    /* rows x n: bounds of the entries' errors, for rows that are small differences of large
     * terms; NULL: roundings of the entries themselves */
    const double *noise;
    const double *g;         /* n x n symmetric, lower read; NULL: none */
    mt_interrupt *interrupt; /* NULL, or asked between the steps: then MT_E_INTERRUPTED */
} mt_stiffness_factor;

typedef struct mt_modal_options {
    int n_rigid;        /* -1: decide here; else the number of rigid-body modes */
    bool vectors;       /* compute y */
    bool need_accuracy; /* with a factor: use it whenever eps * s / lambda_lowest_flexible
                           exceeds 1e-11, or signs and ranks are in doubt */
    bool check;         /* compute residual and orthogonality (with vectors) */
} mt_modal_options;
/* n_rigid -1, vectors and check on, need_accuracy off. */
mt_modal_options mt_modal_options_default(void);

typedef struct mt_modes {
    int n;           /* order of K, M */
    int count;       /* modes: n - n_condensed */
    int n_condensed; /* directions without mass */
    int n_rigid;
    int n_held; /* of an n_rigid that was given: those that are no null directions of K */
    int n_unstable;
    int n_undecided;
    int n_unstable_condensed; /* directions without mass and with negative stiffness: unstable,
                                 though no entry of lambda shows it */
    double *lambda;           /* [count] ascending [rad^2/s^2] */
    mt_mode_kind *kind;       /* [count] */
    int *cluster; /* [count] number of the cluster of repeated modes that a mode belongs to
                     (from 0, ascending) */
    double *y; /* n x count, mass-normalised, sign by mt_modal_fix_sign; NULL without vectors */
    double *residual; /* [count] ||K y - lambda M y|| / ((||K|| + |lambda| ||M||) ||y|| n eps)
                       * in coordinates scaled to m_ii = 1: O(1) is perfect; NULL without
                       * vectors and check */
    double *orthogonality; /* [count] max_j |y_i^T M y_j - delta_ij| / (n eps); NULL likewise */
    double *error;         /* [count] |error of lambda_i| <= error_i: backward error, generously
                           counted, or what mt_modal_judge made of it */
    double error_bound; /* |error of lambda_i| <= error_bound + error_relative * |lambda_i|, for
                           certificates: backward error, generously counted */
    double error_relative;
    bool from_factor; /* the stiffness factor was used */
    double scale;     /* the stiffness scale s [rad^2/s^2] */
    double *massless; /* [n] after MT_E_MASSLESS: the offending direction, largest entry 1; else
                         NULL */
} mt_modes;

/* Shape y of the mode at position i, [n]; those of the modes behind it follow. After a solve
 * with vectors. */
const double *mt_modal_shape(const mt_modes *modes, int i);

/* Compute the modes. opt NULL: default; factor may be NULL. Results live in mem, scratch is
 * given back; repeated calls with mem rewound do not touch the heap. O(n^3), about 11 us for
 * n = 11 with vectors.
 * Method: Cholesky, dsyevd; dgejsv for the factor. On failure, memory taken from mem is the
 * caller's to rewind. Fails: as mt_modal_factor_mass; MT_E_MASSLESS (out->massless);
 * MT_E_DOMAIN; MT_E_NO_CONVERGENCE; MT_E_MEMORY. */
mt_status mt_modal_solve(int n, const double *k, const double *m,
                         const mt_stiffness_factor *factor, const mt_modal_options *opt,
                         mt_arena *mem, mt_modes *out, mt_err *err);
/* The same for a mass that is factored already. */
mt_status mt_modal_solve_factored(const double *k, const mt_mass_factor *mass,
                                  const mt_stiffness_factor *factor,
                                  const mt_modal_options *opt, mt_arena *mem, mt_modes *out,
                                  mt_err *err);

/*
 * What the terms that K and M are sums of say of the shapes y, each term evaluated by itself:
 * spring by spring c (f . y)^2, and so on. Where stiff springs hardly take part in a mode,
 * their terms are tiny, and the sum is accurate where an entry of the assembled K is not.
 */
typedef struct mt_mode_energies {
    double *stiffness;       /* [count] y^T K y */
    double *mass;            /* [count] y^T M y */
    double *stiffness_noise; /* [count] what rounding may have made of it, counted by terms */
    double *mass_noise;      /* [count] */
    double *load_noise; /* [count] the part of stiffness_noise that is in K as it is given, and
                           that no solution of K can be without */
    bool *strained; /* [count] does any spring move by more than the rounding of its terms? */
} mt_mode_energies;
/*
 * Replace each lambda_i by the quotient of its energies where that is the surer one, and decide
 * the kinds anew, mode by mode: n_rigid as in the options of the solve that gave `modes` (with
 * vectors). Now a rigid-body mode is one within its error in which no spring is strained, and
 * one that is strained is undecided. A shape whose error is at most r in the norm of the
 * residual changes the quotient by r min(1, r/gap) at most, gap: distance to the next lambda
 * (Parlett, The Symmetric Eigenvalue Problem, sec. 10-5 and 11-7). Overwrites e.
 */
void mt_modal_judge(mt_mode_energies *e, int n_rigid, mt_modes *modes);

/* Is that worth its while: could a kind be wrong, or is an error above 1e-9 of its lambda? */
bool mt_modal_in_doubt(const mt_modes *modes);

/* Has each flexible mode an index: is no mode unstable or undecided? */
bool mt_modal_indexed(const mt_modes *modes);
/* lambda -> Hz: sqrt(lambda)/(2 pi); 0 for rigid-body modes; NaN for unstable and undecided
 * ones. */
double mt_modal_hz(const mt_modes *modes, int i);
/* |error of mt_modal_hz| <= this [Hz], by error_i; NaN where the frequency is. */
double mt_modal_error_hz(const mt_modes *modes, int i);
/* Position in lambda of vibration mode `index` (1-based, flexible modes ascending); -1 where
 * there are fewer, or where any mode is unstable or undecided. */
int mt_modal_flexible(const mt_modes *modes, int index);
/* The cluster that mode i belongs to: its first position; its size in *size. Size 1: a simple
 * mode. */
int mt_modal_cluster(const mt_modes *modes, int i, int *size);

/* Make each column's entry of largest magnitude positive; entries within a relative 1e-6 of the
 * largest count as tied, and the first of them decides. phi n x r. */
void mt_modal_fix_sign(int n, int r, double *phi);

/*
 * Derivatives. The caller gives, for a parameter p, products with the chosen modes: dky =
 * (dK/dp) y_i, dmy = (dM/dp) y_i, columns n each, one column per listed mode. dmy may be NULL
 * everywhere: M does not depend on p.
 */
/* dlambda_i/dp = y_i^T (dky_i - lambda_i dmy_i). For a mode inside a cluster of more than one:
 * *repeated is set and the value is NaN: no single-mode gradient exists. list[count]: positions
 * of modes. dlambda [count]. repeated may be NULL. */
void mt_modal_dlambda(const mt_modes *modes, int count, const int *list, const double *dky,
                      const double *dmy, double *dlambda, bool *repeated);
/* For a cluster: the symmetric r x r matrix Y^T (dK - lambda dM) Y (lambda: mean of the
 * cluster), whose eigenvalues are the directional derivatives of the cluster. first: its first
 * position, r its size; dky, dmy n x r. Fails: MT_E_MEMORY. */
mt_status mt_modal_dcluster(const mt_modes *modes, int first, int r, const double *dky,
                            const double *dmy, double *out, mt_arena *scratch, mt_err *err);

/* np parameters at one mode: column p is the product of dK/dp_p (dM/dp_p) with that mode. */
typedef struct mt_directions {
    int np;
    const double *dky; /* n x np */
    const double *dmy; /* n x np or NULL */
} mt_directions;

/* The two matrices of an eigenproblem, as above. */
typedef struct mt_pencil {
    int n;
    const double *k;
    const double *m;
} mt_pencil;

/*
 * Derivatives of the mass-normalised vector of a simple mode, its sign held: dy n x np,
 * dlambda np (may be NULL).
 *
 * By all other modes (Fox and Kapoor 1968; exact since all of them are there): two small
 * products per mode, the fast way when a solve has given all vectors. Fails: MT_E_SINGULAR at a
 * mode of a cluster (dy is NaN then), MT_E_USAGE without vectors or with condensed directions.
 */
mt_status mt_modal_dvector_by_modes(const mt_modes *modes, int i, const mt_directions *dir,
                                    double *dy, double *dlambda, mt_arena *scratch,
                                    mt_err *err);
/*
 * By the bordered system (Lee and Jung 1997), valid for a simple mode of any kind, also with
 * singular M:
 *   [K - lambda M   -M y] [dy     ]   [-(dK - lambda dM) y]
 *   [-y^T M          0  ] [dlambda] = [ 1/2 y^T dM y       ]
 * One factorisation, np right-hand sides. Fails: MT_E_SINGULAR at a repeated mode (reciprocal
 * condition of the scaled system at rounding level; dy is NaN then).
 */
mt_status mt_modal_dvector(const mt_pencil *p, double lambda, const double *y,
                           const mt_directions *dir, double *dy, double *dlambda,
                           mt_arena *scratch, mt_err *err);

/*
 * MAC (Ewins; paper Eq. 19) of shapes sampled at common sensors, a ns x ra, b ns x rb, mac
 * ra x rb column-major:
 *   mac_ij = (a_i . b_j)^2 / ((a_i . a_i)(b_j . b_j)), in [0, 1];
 * NaN where a shape vanishes at all sensors (no statement possible).
 */
void mt_mac_matrix(int ns, int ra, const double *a, int rb, const double *b, double *mac);
/* One-to-one pairing that maximises the sum of MAC; pair[ra] = column of b or -1 (none left, or
 * only NaN left). */
mt_status mt_mac_pair(int ra, int rb, const double *mac, int *pair, mt_arena *scratch,
                      mt_err *err);
/* Subspace MAC: squared cosine of each principal angle between span(a) and span(b), descending,
 * cos2[min(ra, rb)]. Use inside clusters. Where the sensors see fewer independent shapes than
 * that, the last entries are NaN. Fails: MT_E_DOMAIN, MT_E_NO_CONVERGENCE, MT_E_MEMORY. */
mt_status mt_mac_subspace(int ns, int ra, const double *a, int rb, const double *b,
                          double *cos2, mt_arena *scratch, mt_err *err);
/* d mac(a, b) / dp for da = d a / dp (b fixed):
 *   2 (a.b)(da.b) / ((a.a)(b.b)) - 2 mac (a.da) / (a.a). */
double mt_mac_derivative(int ns, const double *a, const double *da, const double *b);

#endif
