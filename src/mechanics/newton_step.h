/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_NEWTON_STEP_H
#define MECHANICS_NEWTON_STEP_H

#include "mechanics/newton.h"

/* What the files newton*.c share: one linearisation of a stage at the present position. All
 * arrays live in the arena given to mt_newton_work_init. */
typedef struct mt_newton_work {
    const mt_newton_problem *p;
    const mt_system *sys;
    mt_lagrangian l;      /* dense, at the present position, of g, c, trim, a, h */
    mt_lagrangian sparse; /* of g, c, trim, with rows and a sparse Hessian, where that pays */
    double *least; /* entries of the sparse system of least squares; NULL: it does not pay */
    mt_cx *lambda_cx;
    double *lambda;  /* [m] */
    double *g;       /* [nq] gradient of the energy */
    double *c;       /* [m] */
    double *a;       /* m x nq; NULL until mt_newton_dense */
    double *h;       /* nq x nq; likewise */
    double *trim;    /* [nq] gradient of the trimmed spring's measure */
    double *v;       /* [nq] step back to the constraints */
    double *step;    /* [nq] */
    double *turn;    /* [m] what the step makes of the multipliers, where it was found sparse */
    double *reduced; /* [nq + 1] Z^T g, and the drive's equation with trim */
    double tau;      /* force of the trimmed spring */
    double residual; /* unbalanced force / force scale */
    double noise;    /* what rounding may leave of it */
    double gap;      /* model lengths */
    double moved;    /* model lengths */
    int null_freedoms;
    int factors; /* so far */
    /* leave plain Newton at once where the Hessian is indefinite and the start no
     * equilibrium */
    bool watch;
    /* sparse: w->lambda and w->turn are of a step that was taken whole, and short */
    bool followed;
    /* leave out of the Hessian what forces make of it */
    bool elastic;
} mt_newton_work;

/* Converged: the step is below this fraction of the model length (quadratic convergence makes
 * the error its square)... */
static const double MT_STEP_DONE = 1e-10;
/* ...and the unbalanced force below this fraction of the forces at work (rounding of their sum
 * is ~ n eps). */
static const double MT_FORCE_DONE = 1e-11;
/* A drawing has some six digits: nearer than this is where it is drawn [model lengths, rad]. */
static const double MT_DRAWN = 1e-6;
/* Rounding of the largest single spring force, summed over many springs and projected, stays
 * below this many times itself. */
static const double MT_NOISE_ROOM = 32.0;
/* Largest motion of one step in model lengths: beyond it the quadratic model means nothing. */
static const double MT_STEP_LIMIT = 0.3;

mt_status mt_newton_work_init(mt_newton_work *w, const mt_newton_problem *p, mt_arena *mem,
                              mt_err *err);
/* Room for dense matrices, once: what evaluates needs it, but mt_newton_linearise_sparse and
 * mt_newton_gap_at. */
mt_status mt_newton_dense(mt_newton_work *w, mt_arena *mem, mt_err *err);
/* Lagrangian at a place with w->lambda and w->tau. */
void mt_newton_evaluate(mt_newton_work *w, const mt_placement *at, bool hessian);
/* Everything at a place: multipliers, Hessian, elimination, inverse, and the step v + Z eta
 * (unlimited); tau is advanced. */
mt_status mt_newton_linearise(mt_newton_work *w, const mt_placement *at, mt_arena *mem,
                              mt_newton_solver *solver, mt_err *err);
/* The same sparse. *sure: the equations are regular by a margin, and the step is not much
 * longer than it may be; else nothing that was found means anything. first: also, by as much as
 * says that no equation depends on others next to here, and that Z^T H Z is positive definite.
 * */
mt_status mt_newton_linearise_sparse(mt_newton_work *w, const mt_placement *at, bool first,
                                     mt_arena *mem, mt_newton_solver *solver, bool *sure,
                                     mt_err *err);
/* *firm: the sparse Z^T H Z has an inverse, beyond doubt. Before a solution is told. */
mt_status mt_newton_is_firm(const mt_saddle *saddle, mt_arena *scratch, bool *firm,
                            mt_err *err);
/* Least squares of the w->sparse last evaluated. *sure: the equations are independent; apart:
 * and there is no place next to here where they are not. */
mt_status mt_newton_least_squares(mt_newton_work *w, bool apart, mt_arena *mem,
                                  mt_saddle *least, bool *sure, mt_err *err);
/* Largest violation of the constraints at a place, in model lengths. */
double mt_newton_gap_at(mt_newton_work *w, const mt_placement *at);
/* Z^T H Z, n x n with leading dimension ld. */
mt_status mt_newton_reduce_hessian(const mt_newton_work *w, const mt_elimination *e, double *k,
                                   int ld, mt_arena *mem, mt_err *err);
/* Pseudo-inverse (order n, with trim n + 1) of the (bordered) reduced w->h, and the number of
 * freedoms without stiffness into w. */
mt_status mt_newton_invert(mt_newton_work *w, const mt_elimination *e, mt_arena *mem,
                           double **inverse, mt_err *err);
/* True where what was last evaluated dense, with its elimination, is at rest: closed, and
 * nothing unbalanced but rounding of the forces that meet in each body. However little holds
 * it, it then stays. */
bool mt_newton_at_rest(mt_newton_work *w, const mt_elimination *e);
/* Move the place along w->step, at most `limit` model lengths. */
void mt_newton_take_step(mt_newton_work *w, mt_placement *at, double limit);
/* Physical energy: note the whole turns of angles after a step (springs wind up); else they
 * stay where the drive left them. */
void mt_newton_follow(const mt_newton_work *w, mt_placement *at);
/* Largest motion of dq in model lengths, rotations as they are. */
double mt_newton_scaled_norm(const mt_newton_work *w, const double *dq);
/* Largest violation of the constraints last evaluated, in model lengths. */
double mt_newton_gap_of(const mt_newton_work *w);
/* *falls: Z^T H Z of the w->h last evaluated has eigenvalues below 0 by more than rounding, and
 * the motion `way`[nq] a part along their vectors that is more than the digits of a drawing
 * leave open. That part, reversed, goes into w->step, which else stays. */
mt_status mt_newton_falls(mt_newton_work *w, const mt_elimination *e, const double *way,
                          bool *falls, mt_arena *mem, mt_err *err);

#endif
