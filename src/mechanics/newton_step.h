/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_NEWTON_STEP_H
#define MECHANICS_NEWTON_STEP_H

#include "mechanics/newton.h"

/* Shared by the files newton*.c: one linearisation of a stage at the present position. All
 * arrays are in the arena given to mt_newton_work_init. */
typedef struct mt_newton_work {
    const mt_newton_problem *p;
    const mt_system *sys;
    mt_lagrangian l;      /* dense, at the present position: g, c, trim, a, h */
    mt_lagrangian sparse; /* g, c, trim, rows and a sparse Hessian; where that is cheaper */
    /* entries of the sparse least-squares system; NULL: dense is cheaper */
    double *least;
    mt_cx *lambda_cx;
    double *lambda;  /* [m] */
    double *g;       /* [nq] gradient of the energy */
    double *c;       /* [m] */
    double *a;       /* m x nq; NULL until mt_newton_dense */
    double *h;       /* nq x nq; NULL until mt_newton_dense */
    double *trim;    /* [nq] gradient of the trimmed spring's measure */
    double *v;       /* [nq] step back to the constraints */
    double *step;    /* [nq] */
    double *turn;    /* [m] change of the multipliers by the step, where it was found sparse */
    double *reduced; /* [nq + 1] Z^T g, and the drive's equation with trim */
    double tau;      /* force of the trimmed spring */
    double residual; /* unbalanced force / force scale */
    double noise;    /* its rounding error */
    double gap;      /* model lengths */
    double moved;    /* model lengths */
    int null_freedoms;
    int factors; /* factorisations so far */
    /* leave plain Newton at once where the Hessian is indefinite and the start is not an
     * equilibrium */
    bool watch;
    /* sparse: w->lambda and w->turn belong to a full, short step */
    bool followed;
    /* leave the geometric part out of the Hessian */
    bool elastic;
} mt_newton_work;

/* Converged: the step is below this fraction of the model length (the error is its square, by
 * quadratic convergence)... */
static const double MT_STEP_DONE = 1e-10;
/* ...and the unbalanced force below this fraction of the forces (rounding of their sum is ~ n
 * eps). */
static const double MT_FORCE_DONE = 1e-11;
/* A drawing has some six digits: nearer than this is at the drawn position [model lengths,
 * rad]. */
static const double MT_DRAWN = 1e-6;
/* Rounding of the largest single spring force, summed over many springs and projected, stays
 * below this many times itself. */
static const double MT_NOISE_ROOM = 32.0;
/* Largest motion of one step in model lengths: beyond it the quadratic model is not valid. */
static const double MT_STEP_LIMIT = 0.3;

mt_status mt_newton_work_init(mt_newton_work *w, const mt_newton_problem *p, mt_arena *mem,
                              mt_err *err);
/* Allocate dense matrices, once: required by all evaluations except mt_newton_linearise_sparse
 * and mt_newton_gap_at. */
mt_status mt_newton_dense(mt_newton_work *w, mt_arena *mem, mt_err *err);
/* Lagrangian at a position with w->lambda and w->tau. */
void mt_newton_evaluate(mt_newton_work *w, const mt_placement *at, bool hessian);
/* Multipliers, Hessian, elimination, inverse, and the step v + Z eta (unlimited) at a position;
 * tau is updated. */
mt_status mt_newton_linearise(mt_newton_work *w, const mt_placement *at, mt_arena *mem,
                              mt_newton_solver *solver, mt_err *err);
/* The same sparse. *sure: the equations are regular by a margin, and the step is not much
 * longer than allowed; otherwise the results are void. first: the margin also excludes
 * dependent equations next to this position, and Z^T H Z is positive definite. */
mt_status mt_newton_linearise_sparse(mt_newton_work *w, const mt_placement *at, bool first,
                                     mt_arena *mem, mt_newton_solver *solver, bool *sure,
                                     mt_err *err);
/* *firm: the sparse Z^T H Z is safely invertible. Checked before a solution is reported. */
mt_status mt_newton_is_firm(const mt_saddle *saddle, mt_arena *scratch, bool *firm,
                            mt_err *err);
/* Least squares for the w->sparse last evaluated. *sure: the equations are independent; with
 * `apart` also everywhere next to this position. */
mt_status mt_newton_least_squares(mt_newton_work *w, bool apart, mt_arena *mem,
                                  mt_saddle *least, bool *sure, mt_err *err);
/* Largest violation of the constraints at a position, in model lengths. */
double mt_newton_gap_at(mt_newton_work *w, const mt_placement *at);
/* Z^T H Z, n x n with leading dimension ld. */
mt_status mt_newton_reduce_hessian(const mt_newton_work *w, const mt_elimination *e, double *k,
                                   int ld, mt_arena *mem, mt_err *err);
/* Pseudo-inverse (order n, with trim n + 1) of the (bordered) reduced w->h; sets the number of
 * freedoms without stiffness in w. */
mt_status mt_newton_invert(mt_newton_work *w, const mt_elimination *e, mt_arena *mem,
                           double **inverse, mt_err *err);
/* True where the last dense evaluation, with its elimination, is in equilibrium: closed, and
 * unbalanced forces below rounding of the forces on each body, whatever its stiffness. */
bool mt_newton_at_rest(mt_newton_work *w, const mt_elimination *e);
/* Move the position along w->step, at most `limit` model lengths. */
void mt_newton_take_step(mt_newton_work *w, mt_placement *at, double limit);
/* Physical energy: update the whole turns of angles after a step (springs wind up); other
 * energies keep those of the drive. */
void mt_newton_follow(const mt_newton_work *w, mt_placement *at);
/* Largest motion of dq in model lengths, rotations unscaled. */
double mt_newton_scaled_norm(const mt_newton_work *w, const double *dq);
/* Largest violation of the constraints last evaluated, in model lengths. */
double mt_newton_gap_of(const mt_newton_work *w);
/* *falls: Z^T H Z of the w->h last evaluated has eigenvalues below 0 by more than rounding, and
 * the part of the motion `way`[nq] along their vectors exceeds the precision of a drawing.
 * w->step is then set to that part, reversed. */
mt_status mt_newton_falls(mt_newton_work *w, const mt_elimination *e, const double *way,
                          bool *falls, mt_arena *mem, mt_err *err);

#endif
