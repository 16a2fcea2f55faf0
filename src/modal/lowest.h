/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_LOWEST_H
#define MODAL_LOWEST_H

#include "base/arena.h"
#include "modal/modes.h"

/* Results for one mode from its shape. */
typedef struct mt_lowest_quotient {
    double lambda; /* energy over mass, term by term */
    double noise;  /* bound of its relative rounding error */
    bool rigid;    /* its strains are rounding: a rigid-body mode */
} mt_lowest_quotient;

/*
 * The lowest modes of a system too large for all of them: A x = x / (lambda + shift). In tree
 * coordinates x, with spring energy |x|^2/2 and rigid-body motions that follow freely, A is the
 * mass in x, and nothing is factored. In the coordinates of the matrices, A = (K + shift M)^-1
 * M, self-adjoint in the metric M.
 */
typedef struct mt_lowest_problem {
    int n;       /* coordinates without the rigid-body modes */
    int most;    /* number of modes in them at most */
    int n_rigid; /* rigid-body modes besides */
    int count;   /* vibration modes wanted */
    bool shapes; /* shapes are wanted as well */
    int block;   /* best number of columns per product with A; 0: one */
    /* Y := A X, n x count */
    mt_status (*apply)(void *context, int count, const double *x, double *y, mt_err *err);
    double shift;
    /* y := M x; NULL: the identity */
    void (*metric)(void *context, const double *x, double *y);
    /* Y := A X as accurately as possible, n x count, and the quotients from each x and y */
    mt_status (*refine)(void *context, int count, const double *x, double *y,
                        mt_lowest_quotient *quotient, mt_err *err);
    /* number of modes below lambda = tau > 0, rigid-body ones included; `known` of them were
     * found; *below may be too large; *certain: no pivot's sign is due to rounding */
    mt_status (*below)(void *context, double tau, int known, int *below, bool *certain,
                       mt_err *err);
    void *context;
} mt_lowest_problem;

typedef struct mt_lowest_modes {
    /* count: n_rigid, then the lowest modes, at most those wanted and the repetitions of the
     * last; y NULL; n: coordinates including the rigid-body ones */
    mt_modes modes;
    /* n x (count - the problem's n_rigid): modes found, columns of size 1 (in the metric) */
    double *x;
    double tau; /* no mode below this was missed, by count [rad^2/s^2] */
    int below;  /* number of modes below tau, rigid-body ones included */
} mt_lowest_modes;

/**
 * Lanczos' method, one Rayleigh quotient per mode, and a count of the modes below a frequency
 * above the last one; where some are missing (repeated ones) they are sought in the complement
 * of those found. The error of lambda includes the residual rho (with the gap to the
 * neighbours, rho^2/gap: Kato and Temple) and the quotient's noise. Results in mem, scratch is
 * returned. Fails: MT_E_NO_CONVERGENCE, as apply and below, MT_E_MEMORY.
 */
mt_status mt_modal_lowest(const mt_lowest_problem *p, mt_arena *mem, mt_lowest_modes *out,
                          mt_err *err);

#endif
