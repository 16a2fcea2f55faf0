/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_MODES_H
#define MODAL_MODES_H

#include <stdbool.h>

#include "base/arena.h"

typedef enum mt_mode_kind {
    MT_MODE_FLEXIBLE,
    MT_MODE_RIGID_BODY,
    MT_MODE_UNSTABLE,
    MT_MODE_UNDECIDED /* rounding hides the sign of lambda */
} mt_mode_kind;

typedef struct mt_modes {
    int n;           /* order of K, M */
    int all;         /* number of modes: n - n_condensed */
    int count;       /* those wanted, the lowest */
    int shaped;      /* the lowest of these, with shapes in y; 0 without vectors */
    int n_condensed; /* directions without mass */
    int n_rigid;
    int n_held;     /* of a given n_rigid: those that are not null directions of K */
    int n_unstable; /* all unstable directions, including those without mass */
    int n_undecided;
    int n_unstable_condensed; /* of n_unstable: directions without mass and with negative
                                 stiffness, which no entry of lambda shows */
    /* [all] ascending [rad^2/s^2]; beyond count as computed, without kinds */
    double *lambda;
    mt_mode_kind *kind; /* [count] */
    /* [count] cluster of repeated modes of each mode, from 0, ascending */
    int *cluster;
    /* n x shaped, mass-normalised, sign by mt_modal_fix_sign; NULL without vectors */
    double *y;
    /* [shaped] ||K y - lambda M y|| / ((||K|| + |lambda| ||M||) ||y|| n eps) in coordinates
     * scaled to m_ii = 1: O(1) is perfect; NULL without vectors and check */
    double *residual;
    /* [shaped] max_j |y_i^T M y_j - delta_ij| / (n eps); NULL without vectors and check */
    double *orthogonality;
    /* [all] |error of lambda_i| <= error_i: backward error, generously counted, or improved by
     * mt_modal_judge */
    double *error;
    /* |error of lambda_i| <= error_bound + error_relative * |lambda_i|, for proofs: backward
     * error, generously counted */
    double error_bound;
    double error_relative;
    bool from_factor; /* the stiffness factor was used */
    double scale;     /* the stiffness scale s [rad^2/s^2] */
    double *massless; /* [n] after MT_E_MASSLESS: the offending direction, largest entry 1; else
                         NULL */
} mt_modes;

/* Shape y of the mode at position i, [n], followed by those of the next modes. NULL where it
 * was not wanted (modes->shaped). */
const double *mt_modal_shape(const mt_modes *modes, int i);

/* True where each flexible mode has an index: no mode is unstable or undecided. */
bool mt_modal_indexed(const mt_modes *modes);
/* lambda -> Hz: sqrt(lambda)/(2 pi); 0 for rigid-body modes; NaN for unstable and undecided
 * ones. */
double mt_modal_hz(const mt_modes *modes, int i);
/* |error of mt_modal_hz| <= this [Hz], from error_i; NaN where the frequency is NaN. */
double mt_modal_error_hz(const mt_modes *modes, int i);
/* d lambda -> d Hz of a mode at hz: d lambda/(8 pi^2 hz). NaN at 0 Hz, where the square of a
 * frequency has a derivative and the frequency has none. */
double mt_modal_hz_slope(double dlambda, double hz);
/* Number of vibration modes: all but rigid-body modes. Unstable and undecided modes are
 * counted, although no mode then has an index. */
int mt_modal_vibrations(const mt_modes *modes);
/* Position in lambda of vibration mode `index` (1-based, flexible modes ascending); -1 where
 * there are fewer, or where any mode is unstable or undecided. */
int mt_modal_flexible(const mt_modes *modes, int index);
/* Inverse of mt_modal_flexible: the number of flexible modes up to position pos; 0 for -1. */
int mt_modal_index(const mt_modes *modes, int pos);
/* First position of the cluster of mode i, with *size modes. Size 1: a simple mode. */
int mt_modal_cluster(const mt_modes *modes, int i, int *size);

/* Make each column's entry of largest magnitude positive; entries within a relative 1e-6 of the
 * largest count as tied, and the first of them decides. phi n x r. */
void mt_modal_fix_sign(int n, int r, double *phi);

/*
 * MAC (Ewins; paper Eq. 19) of shapes sampled at common sensors, a ns x ra, b ns x rb, mac ra x
 * rb column-major:
 *   mac_ij = (a_i . b_j)^2 / ((a_i . a_i)(b_j . b_j)), in [0, 1];
 * NaN where a shape vanishes at all sensors.
 */
void mt_mac_matrix(int ns, int ra, const double *a, int rb, const double *b, double *mac);
/* One-to-one pairing that maximises the sum of MAC; pair[ra] = column of b or -1 (none left, or
 * only NaN left). */
mt_status mt_mac_pair(int ra, int rb, const double *mac, int *pair, mt_arena *scratch,
                      mt_err *err);
/* Subspace MAC: squared cosine of each principal angle between span(a) and span(b), descending,
 * cos2[min(ra, rb)]; for clusters. Where the sensors see fewer independent shapes, the last
 * entries are NaN. Fails: MT_E_DOMAIN, MT_E_NO_CONVERGENCE, MT_E_MEMORY. */
mt_status mt_mac_subspace(int ns, int ra, const double *a, int rb, const double *b,
                          double *cos2, mt_arena *scratch, mt_err *err);
/* d mac(a, b) / dp for da = d a / dp (b fixed):
 *   2 (a.b)(da.b) / ((a.a)(b.b)) - 2 mac (a.da) / (a.a). */
double mt_mac_derivative(int ns, const double *a, const double *da, const double *b);

/*
 * Energies of the shapes y, summed over the terms of K and M: spring by spring c (f . y)^2, and
 * so on. Where stiff springs hardly take part in a mode, their terms are tiny, and the sum is
 * accurate where an entry of the assembled K is not.
 */
typedef struct mt_mode_energies {
    double *stiffness;       /* [count] y^T K y */
    double *mass;            /* [count] y^T M y */
    double *stiffness_noise; /* [count] bound of its rounding error, by terms */
    double *mass_noise;      /* [count] */
    /* [count] the part of stiffness_noise, and of mass_noise times lambda, that is already in
     * the entries of K and M and that every solution with them has */
    double *given_noise;
    bool *strained; /* [count] a spring moves by more than the rounding of its terms */
    int count;      /* the lowest modes; the others need no check */
    /* NULL, or from mt_modal_groups: then stiffness, mass and their noises continue behind
     * count with the pairs of mt_modal_pair_shapes, which give y_i^T (K - lambda M) y_k */
    const int *group;
} mt_mode_energies;
/*
 * Replace each lambda_i by the quotient of its energies where that is more accurate, and
 * classify the modes again: n_rigid as in the options of the solve that gave `modes` (with
 * vectors). A rigid-body mode is now one that is 0 within its error and strains no spring; one
 * that strains a spring is undecided. A shape with an error of at most r in the norm of the
 * residual changes the quotient by at most r min(1, r/gap), gap: distance to the next lambda
 * (Parlett, The Symmetric Eigenvalue Problem, sec. 10-5 and 11-7). Modes of one group are
 * treated together: their quotients are eigenvalues to the greatest sum of |y_i^T (K - lambda
 * M) y_k| over the others (Weyl), and the gap is that to the modes next to the group.
 * Overwrites e, whose arrays have room for all modes.
 */
void mt_modal_judge(mt_mode_energies *e, int n_rigid, mt_modes *modes);

/* Number of lowest modes worth this check where no errors are wanted: up to the last mode whose
 * kind may be wrong or whose error is above 1e-9 of its lambda. */
int mt_modal_doubtful(const mt_modes *modes);

/* True where a vibration mode with a shape has an error above 1e-9 of its lambda. */
bool mt_modal_rough(const mt_modes *modes);

/* Groups of up to eight neighbours too close for a gap between them: group[count], the first
 * mode of each mode's group. Returns the number of pairs i < k within groups. */
int mt_modal_groups(const mt_modes *modes, int count, int *group);
/* (y_i + y_k)/sqrt 2 of these pairs, y n x pairs. */
void mt_modal_pair_shapes(const mt_modes *modes, int count, const int *group, double *y);

/*
 * Tolerances of this room. eps = DBL_EPSILON.
 *
 * NOISE_ULPS n eps s is what a dense symmetric solution may leave on an eigenvalue that is
 * zero: dsyevd's backward error is a small multiple of n eps |lambda|max, and forming
 * L^-1 K L^-T perturbs it by up to about n eps max_i |K_ii| (M^-1)_ii, which oblique
 * coordinates make the larger one. s is the larger of the two scales. Measured: at most
 * 0.8 n eps s over 60,000 random free chains of 2 to 16 masses, in their own and in oblique
 * coordinates (there |lambda|max alone would be short by up to 1e7). 16 leaves room for entries
 * of K that were assembled with roundings of their own.
 *
 * The same 16 n eps, applied to matrices scaled to unit diagonal, decides whether a direction
 * has mass, whether a direction without mass has stiffness, and whether rows of a stiffness
 * factor are independent. A coordinate has no mass of its own where
 * m_ii <= (16 n eps)^2 max m: a constraint null space that is orthogonal to rounding leaves
 * entries of size eps in place of zeros, and m is quadratic in them.
 */
static const double MT_MODAL_NOISE_ULPS = 16.0;
/* Set kinds, n_rigid, n_unstable, and lambda of rigid-body modes; n_rigid < 0: decide here.
 * n_held: given rigid-body modes above the noise. Returns the greatest |lambda| of a given
 * rigid-body mode. noise[count]: at most this is 0 (NULL: error_bound); strained[count]: not 0
 * where springs are strained (NULL: unknown). */
double mt_modal_classify(mt_modes *modes, int n_rigid, const double *noise,
                         const bool *strained);
/* Without a factor, a given rigid-body mode counts as held above HELD times the noise: the
 * residual of an equilibrium found by iteration stays below that on a null direction (the
 * mechanics room takes forces of up to 1e4 times the rounding of the positions as none). */
static const double MT_MODAL_HELD = 1e4;
/* Find clusters; after the kinds. */
void mt_modal_find_clusters(mt_modes *modes);

#endif
