/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_DAMPING_H
#define ANALYSIS_DAMPING_H

#include "analysis/analysis.h"
#include "modal/damped.h"

/*
 * Damping of a configuration, in the freedoms of the last solve (linear.h):
 *     C = dampers + mass M + stiffness K + sum_j 2 zeta_j omega_j (M phi_j)(M phi_j)^T,
 *     H = sum over springs of loss factor times stiffness.
 * Modal ratios zeta_j apply to flexible modes as in model.h: by name of a mode, which is
 * followed by its shape at the first design of the analysis (tracking.h); by index; or to all
 * others. Where vibrations of equal frequency have different ratios, C depends on the shapes
 * that the solve has found, and has no derivative.
 */

/*
 * After a solve: C and H, both n x n, column-major, both triangles; either NULL: not wanted.
 * *structural (may be NULL): H is not 0. Kept until the next solve. O(n^3) with modal ratios.
 * Fails: MT_E_INTERNAL (modal ratios, but the solve had not all modes with vectors), MT_E_INPUT
 * (a ratio of a mode that does not exist), MT_E_DOMAIN (ratios by index or name where modes
 * have no index), MT_E_MEMORY.
 */
mt_status mt_analysis_damping(mt_analysis *a, double *c, double *h, bool *structural,
                              mt_err *err);
/* After a solve with gradient: products of the derivatives by input p with x, n x cols, in the
 * moving coordinates of mt_linear_products: dcx = (dC/dp) x and dhx = (dH/dp) x. NaN where
 * equal frequencies with different ratios leave dC undefined. With modal ratios another O(n)
 * products with K and M. Fails as above, as mt_linear_products. */
mt_status mt_analysis_damping_products(mt_analysis *a, int p, int cols, const double *x,
                                       double *dcx, double *dhx, mt_err *err);

/* Modal ratios: factors f_j = 2 zeta_j omega_j and shapes Phi of the modes of the last solve. r
 * 0: none. Valid until the next solve. Fails as mt_analysis_damping. */
typedef struct mt_ratio_modes {
    int r;
    const double *y; /* n x r: Phi */
    const double *f; /* [r] */
} mt_ratio_modes;
mt_status mt_analysis_ratio_modes(mt_analysis *a, mt_ratio_modes *out, mt_err *err);
/* q (r x r) := Phi^T M d(Phi F Phi^T) M Phi by input p, after a solve with gradient, in the
 * moving coordinates of mt_linear_products. NaN where equal frequencies with different ratios
 * leave it undefined. O(n) products with K and M. */
mt_status mt_analysis_ratio_slope(mt_analysis *a, int p, double *q, mt_err *err);
/* Force of the modal ratios on a motion v that the joints do not allow, given w = Z^T M v:
 * out[n] += N F Phi^T w, N = M Phi. */
mt_status mt_analysis_ratio_force(mt_analysis *a, const double *w, double *out, mt_err *err);

/* Complex modes with this damping, after a solve of all modes with vectors; valid until the
 * next one. Fails as above and as mt_modal_damped. */
mt_status mt_analysis_damped(mt_analysis *a, const mt_damped_modes **out, mt_err *err);
/* Position in d of oscillating mode `index` (1-based, ascending |s|); -1 where there are fewer,
 * or where a motion is unstable: then no mode has an index. */
int mt_damped_oscillating(const mt_damped_modes *d, int index);
/* Position of the oscillating mode with the largest share |phi^T M y|^2/(y^H M y) of the
 * undamped mode phi at pos; -1 as above. Fails: MT_E_MEMORY. */
mt_status mt_analysis_damped_of(mt_analysis *a, int pos, int *out, mt_err *err);
/*
 * After a solve with gradient: derivatives [n_inputs] of the root s at position i of
 * mt_analysis_damped,
 *     ds/dp = -y^T (s^2 dM + s dC + dK + i dH) y / (y^T (2 s M + C) y)
 * (y^T, because all matrices are symmetric), re and im [rad/s per unit of the input]. NaN, and
 * *repeated (may be NULL), where the root is repeated. Fails as above.
 */
mt_status mt_analysis_dpole(mt_analysis *a, int i, double *dre, double *dim, bool *repeated,
                            mt_err *err);

/* Damping at the last solve (a->damping), shared by the files damping*.c; in damping_mem. Made
 * by mt_analysis_damping. */
struct mt_damping_work {
    int n;
    int r;          /* modes; 0 without ratios */
    double *zeta;   /* [r] */
    mt_node *ratio; /* [r] node of zeta; MT_NO_NODE: 0 */
    double *omega;  /* [r] of modes with a ratio; otherwise 0 */
    double *f;      /* [r] 2 zeta omega */
    double *n_phi;  /* n x r: M Phi */
    double *c;      /* n x n */
    double *h;      /* n x n; NULL: 0 */
    bool solved;    /* `damped` is valid */
    mt_damped_modes damped;
};

#endif
