/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_MODES_H
#define MODAL_MODES_H

#include <stdbool.h>

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

#endif
