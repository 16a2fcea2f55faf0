/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_TRANSFER_H
#define RESPONSE_TRANSFER_H

#include <complex.h>
#include <stdbool.h>

#include "base/arena.h"
#include "linalg/complex.h"
#include "response/forced.h"

/*
 * The system solved at each frequency, in coordinates q (of the problem: direct; of its modes:
 * basis.h):
 *     D(s) q = beta(s) u,   D = s^2 m + s c + g,   y = sigma(s) q + rest(s) u,   s = i w.
 * g, c, m are diagonal (vectors), or symmetric with both triangles.
 */
enum { MT_REST_LOWEST = -2, MT_REST_HIGHEST = 4, MT_REST_POWERS = 7 };

/* A force or a motion that a reduced problem represents in few coordinates. The remainder g is
 * in modes above `lambda` (mt_left_out), in coordinates where H = K + shift M is the identity
 * and M is A. */
typedef struct mt_left_part {
    int order;    /* p: A^j g, j < p, are among the coordinates */
    double size;  /* |g| */
    double open;  /* |A^p g| [s^2p] */
    double noise; /* rounding of its part in the vibration modes, in coordinates where H is 1 */
    double loose; /* rounding of its part in the rigid-body modes */
} mt_left_part;

/* What a reduced problem leaves out. For a force f and an output s, with m = w sqrt(w^2 + a^2)
 * plus the shift's part, and q = 1 - m/(lambda + shift), Galerkin's error is at most
 *     c |A^p f| |A^r s| m^(p + r) / q,
 * c from the effect of damping on D = (1 + i t) H - (w^2 + shift (1 + i t) - i w a) M. Damping
 * ratios of the modes left out, replaced by those of other modes, add at most 4 zeta (w /
 * sqrt(lambda)) |f| |s| / q^2. Local damping counts as a force. */
typedef struct mt_left_out {
    double lambda; /* [rad^2/s^2] */
    double shift;  /* [rad^2/s^2] */
    double alpha;  /* damping by mass [1/s] */
    double beta;   /* by stiffness [s] */
    double loss;   /* of all springs */
    double ratio;
    const mt_left_part *in; /* [n_in] */
    int n_out;
    const mt_left_part *out; /* [n_out] parts of outputs */
    const int *out_of;       /* [n_out] output of each */
    /* by output: joints' forces under damping ratios, 4 zeta times the root of the mass left
     * out: w times that times |f| / q is added to the error */
    const double *out_rate;
    int n_side;
    const mt_left_part *side; /* [n_side] */
    const double *row;        /* n x n_side: motion along each side, by coordinate */
    const double *damping;    /* [n_side] */
    const double *structural; /* [n_side] */
    const double *root;       /* [n] root of H's diagonal; 0: a rigid-body mode */
    const double *in_power;   /* [n_in] power of w */
    const double *out_power;  /* [n_out] */
} mt_left_out;

typedef struct mt_transfer {
    int n;
    int n_in;
    int n_out;
    bool diagonal;
    const double *m;         /* n x n, or [n] */
    const double *c;         /* the same; NULL: 0 */
    const double complex *g; /* n x n, or [n] */
    /* [n] error bounds of the eigenvalues, where coordinates are modes [rad^2/s^2]; NULL:
     * rounding of the entries of D */
    const double *error;
    const mt_left_out *left;                       /* NULL: nothing */
    const double complex *beta[MT_FORCED_POWERS];  /* n x n_in; NULL: 0 */
    const double complex *sigma[MT_FORCED_POWERS]; /* n_out x n; NULL: 0 */
    bool real[MT_FORCED_POWERS];                   /* sigma[p] has no imaginary part */
    /* n_out x n_in, coefficient of s^p at p - MT_REST_LOWEST; NULL: 0 */
    const double complex *rest[MT_REST_POWERS];
} mt_transfer;

/* Response at one frequency, n_out x n_in each. */
typedef struct mt_sample {
    /* infinite real part: no value, an undamped motion resonates */
    double complex *h;
    double complex *dh; /* derivative with respect to w [per rad/s]; NULL: not wanted */
    /* NULL: not wanted. |error of h| <= this, to first order: rounding of D (or its eigenpairs)
     * and of the sums that follow. Infinite where h is. */
    double *error;
} mt_sample;

/* The transfer in the problem's own coordinates: one factorisation of D(s) per frequency.
 * Refers to f's matrices. */
mt_status mt_transfer_direct(const mt_forced *f, mt_arena *mem, mt_transfer *out, mt_err *err);

/* Response at w > 0 [rad/s]. O(n (n_in + n_out n_in)) where all is diagonal, else O(n^3). No
 * heap after the first call. Fails: MT_E_DOMAIN, MT_E_MEMORY. */
mt_status mt_transfer_at(const mt_transfer *t, double w, const mt_sample *out,
                         mt_arena *scratch, mt_err *err);
/* Solutions at w: q (n x n_in), and the adjoint a (n x n_out), D a = sigma^T; *singular: D is
 * singular, and neither is set. h (NULL: not wanted): the value, as mt_transfer_at. */
mt_status mt_transfer_solve(const mt_transfer *t, double w, double complex *q,
                            double complex *a, double complex *h, bool *singular,
                            mt_arena *scratch, mt_err *err);

#endif
