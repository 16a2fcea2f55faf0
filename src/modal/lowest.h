/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_LOWEST_H
#define MODAL_LOWEST_H

#include "base/arena.h"
#include "modal/modes.h"

/* What is said of one mode from its shape. */
typedef struct mt_lowest_quotient {
    double lambda; /* energy over mass, term by term */
    double noise;  /* bound of what rounding makes of it, as a part of it */
    bool rigid;    /* its strains are rounding */
} mt_lowest_quotient;

/*
 * The lowest modes of a system too large for all of them: A x = x / (lambda + shift).
 *     In coordinates x in which the energy of the springs is |x|^2/2, rigid-body motions being
 * left free to follow, A is the mass as x feels it, and nothing is factored; in those of the
 * matrices, A = (K + shift M)^-1 M, and M is the metric in which it is self-adjoint.
 */
typedef struct mt_lowest_problem {
    int n;       /* coordinates, rigid-body modes not among them */
    int most;    /* modes that there may be among them */
    int n_rigid; /* rigid-body modes beside them */
    int count;   /* vibration modes wanted */
    bool shapes; /* they are wanted for themselves, too */
    int block;   /* columns that A is best multiplied with at a time; 0: one */
    /* Y := A X, n x count */
    mt_status (*apply)(void *context, int count, const double *x, double *y, mt_err *err);
    double shift;
    /* y := M x; NULL: the identity */
    void (*metric)(void *context, const double *x, double *y);
    /* Y := A X as exactly as can be, n x count, and what each x and y say of their mode */
    mt_status (*refine)(void *context, int count, const double *x, double *y,
                        mt_lowest_quotient *quotient, mt_err *err);
    /* modes below lambda = tau > 0, rigid-body ones included, of which `known` were found;
     * *below may be too large; *certain: no pivot's sign is by rounding */
    mt_status (*below)(void *context, double tau, int known, int *below, bool *certain,
                       mt_err *err);
    void *context;
} mt_lowest_problem;

typedef struct mt_lowest_modes {
    /* count: n_rigid, then as many of the lowest as there are, at most those wanted and what
     * is repeated with the last of them; y NULL; n: coordinates with the rigid-body ones */
    mt_modes modes;
    /* n x (count - the problem's n_rigid), of those found, columns of size 1 (in the metric) */
    double *x;
    double tau; /* no mode below this was missed: they were counted [rad^2/s^2] */
    int below;  /* how many that were, rigid-body ones included */
} mt_lowest_modes;

/**
 * By Lanczos' method, one Rayleigh quotient each, and a count of the modes below a frequency
 * behind the last: where some are missing (repeated ones) they are sought among what is
 * orthogonal to those found. The error of lambda holds the residual rho (with the gap to the
 * neighbours, rho^2/gap: Kato and Temple) and the quotient's noise.
 * Results in mem, scratch is given back. Fails: MT_E_NO_CONVERGENCE, as apply and below,
 * MT_E_MEMORY.
 */
mt_status mt_modal_lowest(const mt_lowest_problem *p, mt_arena *mem, mt_lowest_modes *out,
                          mt_err *err);

#endif
