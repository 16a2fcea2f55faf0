/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_DAMPED_H
#define MODAL_DAMPED_H

#include <complex.h>

#include "base/arena.h"
#include "modal/mass.h"
#include "modal/modes.h"

/*
 * Modes with damping:  (s^2 M + s C + K + i H) y = 0,  s = sigma +- i omega_d.
 *   natural frequency |s| / 2 pi, damped frequency Im s / 2 pi, damping ratio -Re s / |s|.
 * Without structural damping H: one entry for a pair of conjugate s (with Im s > 0), one for
 * each real s. An overdamped motion has two real roots, a spring and a damper in series without
 * mass between them one.
 *
 * H applies to motions e^{i w t}, w > 0. With it only the roots with Im s > 0 are listed, one
 * for each mode; they have no conjugates (roots with Im s < 0 belong to no motion). A mass on a
 * spring k (1 + i eta) has s = i sqrt(k (1 + i eta)/m), a damping ratio of about eta/2. Real
 * roots of motions without H are listed as above.
 */
typedef enum mt_damped_kind {
    MT_DAMPED_OSCILLATING, /* Im s > 0, Re s <= 0 (to rounding) */
    MT_DAMPED_OVERDAMPED,  /* s real, <= 0: decays without oscillation */
    /* s = 0: one entry for each rigid-body mode of the undamped system; a damped one has a
     * second, real root */
    MT_DAMPED_RIGID_BODY,
    MT_DAMPED_UNSTABLE, /* Re s > 0 */
    /* of an undecided mode of the undamped system: rounding hides the sign of s^2 */
    MT_DAMPED_UNDECIDED
} mt_damped_kind;

typedef struct mt_damped_problem {
    int n;
    const double *k;
    const double *c; /* n x n symmetric, lower triangle read, as k [s times the unit of k] */
    const double *h; /* n x n symmetric, lower triangle read, as k; NULL: none */
    const mt_mass_factor *mass; /* of M */
    const mt_modes *modes;      /* of K, M, all of them with vectors */
} mt_damped_problem;

typedef struct mt_damped_modes {
    int n;
    int count;
    mt_damped_kind *kind; /* [count] rigid-body modes first, then ascending |s| */
    double *re;           /* [count] Re s [rad/s] */
    double *im;           /* [count] Im s >= 0 [rad/s] */
    /* [count] ||(s^2 M + s C + K + i H) y|| / ((|s|^2 ||M|| + |s| ||C|| + ||K|| + ||H||) ||y||
     * n eps) in coordinates scaled to m_ii = 1; 0 for rigid-body modes */
    double *residual;
    /* n x count shapes, largest entry 1; 0 for rigid-body modes (their shapes are those of the
     * undamped system) */
    double *y_re;
    double *y_im;
} mt_damped_modes;

/* All damped modes. Results in mem. O(n^3): a general eigenproblem of order up to 2 n, complex
 * with H. C must be positive semidefinite where there are directions without mass. Fails:
 * MT_E_USAGE (modes without vectors), MT_E_SINGULAR (a direction without mass, damping and
 * stiffness), MT_E_DOMAIN, MT_E_NO_CONVERGENCE, MT_E_MEMORY. */
mt_status mt_modal_damped(const mt_damped_problem *p, mt_arena *mem, mt_damped_modes *out,
                          mt_err *err);

/* True where every oscillating motion has an index, from 1 by ascending |s|: no mode is
 * undecided. */
bool mt_damped_indexed(const mt_damped_modes *d);
/* |s|/2 pi and Im s/2 pi [Hz]; damping ratio -Re s/|s| (NaN where s = 0). */
double mt_damped_natural_hz(const mt_damped_modes *d, int i);
double mt_damped_hz(const mt_damped_modes *d, int i);
double mt_damped_ratio(const mt_damped_modes *d, int i);

/*
 * The rule for growing motions, used wherever a system is assumed to come to rest or to a
 * steady response.
 *
 * Index of the pole with the largest Re s among those with Im s >= 0 (the others are their
 * conjugates) and Re s above rounding: 64 units in the last place of |s|, or `rounding` where
 * that is more (the error of an eigenvalue solver, in the unit of s). -1: none. O(n).
 */
int mt_modal_growing_pole(int n, const double complex *s, double rounding);

/*
 * *passive: C and H have no negative direction, so the system feeds no energy to its motions.
 * In a stable position (K without a negative direction) a pole grows only where C or H has a
 * negative direction: for x^H (s^2 M + s C + K + i H) x = 0 with Im s >= 0 and C, H >= 0 there
 * is no Re s > 0. A pole of a passive system with Re s > 0 is therefore rounding.
 * @param[in]  c, h  n x n symmetric, lower triangles read; NULL: 0
 * O(n^3). Fails: MT_E_NO_CONVERGENCE, MT_E_MEMORY.
 */
mt_status mt_modal_is_passive(int n, const double *c, const double *h, mt_arena *mem,
                              bool *passive, mt_err *err);

#endif
