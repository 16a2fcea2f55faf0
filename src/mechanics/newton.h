/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_NEWTON_H
#define MECHANICS_NEWTON_H

#include "mechanics/eliminate.h"
#include "mechanics/saddle.h"

/* One stage of the position analysis: a stationary point of an energy under the first m
 * constraints. */
typedef struct mt_newton_problem {
    const mt_data *data;
    mt_energy energy;
    const mt_pose *drawn; /* anchor */
    /* of the springs' rest values, where those are of a position; NULL: not known */
    const mt_pose *rest;
    int m;
    /* the constraints of the drives that springs hold, the last, are held by the unknown forces
     * of these springs instead of their multipliers */
    bool trim;
    /* sparse matrices only: MT_E_EQUILIBRIUM where they are not sufficient. Freedoms without
     * stiffness are not detected */
    bool sparse;
} mt_newton_problem;

/*
 * Where an equilibrium is looked for is the same position of many designs: the drawing, or
 * where the driven joint has brought it. What does not depend on what differs between them is
 * kept: jets of measures, and the least-squares factor of the constraints. It is used where
 * all numbers that it was made of have the same values, so that results are the same with and
 * without.
 */
typedef struct mt_newton_start {
    mt_jets jets;
    mt_jets end; /* where the search ended, for who goes on from there */
    int rows;    /* that are factored; -1: none */
    bool apart;
    bool sure;
    mt_sparse_row *row; /* [rows] */
    mt_saddle least;
    mt_arena mem; /* of row and least */
} mt_newton_start;

/*
 * Solver of the equations of a step. Sparse, as a saddle-point system, where that is safely
 * regular; otherwise dense in a basis of the freedoms with a pseudo-inverse, which handles
 * redundant equations and freedoms without stiffness.
 */
typedef struct mt_newton_solver {
    bool sparse;
    mt_saddle saddle; /* of all equations, those of drives included */
    mt_border border; /* of the saddle, with trim */
    mt_elimination e; /* with trim: without the rows of trimmed drives */
    /* pseudo-inverse of the (bordered) reduced Hessian, order n (n + n_trims with trim) */
    double *inverse;
} mt_newton_solver;

/* Result of a stage. */
typedef struct mt_stage {
    bool active;             /* this stage ran */
    int iterations;          /* also where it failed */
    int factors;             /* matrix factorisations in them */
    mt_newton_solver solver; /* at the solution */
    int m;
    double *lambda; /* [m] multipliers: constraint force A^T lambda */
    double *h;      /* nq x nq Hessian of the Lagrangian; NULL: the solver is sparse */
    double *a;      /* m x nq; NULL: the solver is sparse */
    double *trim;   /* nq x n_trims, gradients of the trimmed springs' measures */
    mt_trim_forces trim_force; /* their forces; physical energy [N, N m] */
    double residual;           /* largest unbalanced force / largest force */
    mt_newton_residual left;   /* with the physical energy */
    int null_freedoms;         /* freedoms without stiffness at the solution */
    /* derivatives by one input, for the physical energy (position.h) */
    double *d_lambda; /* [m] */
    mt_trim_forces d_trim_force;
} mt_stage;

/* Largest |c| of the first m constraints (angles and cosines in model lengths) [m]. */
mt_status mt_newton_gap(const mt_newton_problem *problem, const mt_placement *at, mt_arena *mem,
                        double *gap_m, mt_err *err);
/* Solve from `at`, which is moved to the solution. Adds to stage->iterations; the rest of stage
 * is filled on success. Fails: MT_E_ASSEMBLY, MT_E_EQUILIBRIUM, MT_E_DEAD_CENTRE, MT_E_MEMORY,
 * MT_E_INTERRUPTED. */
mt_status mt_newton_solve(const mt_newton_problem *problem, mt_placement *at, mt_arena *mem,
                          mt_stage *stage, mt_err *err);

/*
 * Adjoint: with x and y from the transposed equations of such a stage,
 *     H x + A^T y = pull,  A x = across,  t . x = pull_trim
 * (the last with trimmed springs, where x has no equations of their drives' rows), additional
 * forces f and gaps c change pull . q + across . lambda + pull_trim tau by -(x . f + y . c).
 * pull [nq], across [m], pull_trim [n_trims], x [nq], y [m].
 */
mt_status mt_newton_adjoint(const mt_stage *stage, const double *pull, const double *across,
                            const double *pull_trim, double *x, double *y, mt_arena *scratch,
                            mt_err *err);

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
    double *trim;    /* nq x n_trims, gradients of the trimmed springs' measures */
    double *v;       /* [nq] step back to the constraints */
    double *step;    /* [nq] */
    double *turn;    /* [m] change of the multipliers by the step, where it was found sparse */
    double *reduced; /* [nq + n_trims] Z^T g, and the drives' equations with trim */
    mt_trim_forces tau; /* of the trimmed springs */
    double residual;    /* unbalanced force / force scale */
    double noise;       /* its rounding error */
    double gap;         /* model lengths */
    double moved;       /* model lengths */
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
/* Largest motion of one step in model lengths: beyond it the quadratic model is not valid. */
static const double MT_STEP_LIMIT = 0.3;

mt_status mt_newton_work_init(mt_newton_work *w, const mt_newton_problem *p, mt_arena *mem,
                              mt_err *err);
/* Allocate dense matrices, once: required by all evaluations except mt_newton_linearise_sparse
 * and mt_newton_gap_at. */
mt_status mt_newton_dense(mt_newton_work *w, mt_arena *mem, mt_err *err);
/* Trimmed springs whose forces are unknown: all of the system's with trim, else none. */
int mt_newton_trims(const mt_newton_problem *p);
/* Lagrangian at a position with w->lambda and w->tau. */
void mt_newton_evaluate(mt_newton_work *w, const mt_placement *at, bool hessian);
/* *firm: the sparse Z^T H Z is safely invertible. Checked before a solution is reported. */
mt_status mt_newton_is_firm(const mt_saddle *saddle, mt_arena *scratch, bool *firm,
                            mt_err *err);
/* Least squares for the w->sparse last evaluated. *sure: the equations are independent; with
 * `apart` also everywhere next to this position. */
mt_status mt_newton_least_squares(mt_newton_work *w, bool apart, mt_arena *mem,
                                  mt_saddle *least, bool *sure, mt_err *err);
/* Pseudo-inverse (order n, with trim n + n_trims) of the (bordered) reduced w->h; sets the
 * number of freedoms without stiffness in w. */
mt_status mt_newton_invert(mt_newton_work *w, const mt_elimination *e, mt_arena *mem,
                           double **inverse, mt_err *err);
/* Move the position along w->step, at most `limit` model lengths. */
void mt_newton_take_step(mt_newton_work *w, mt_placement *at, double limit);
/* Largest motion of dq in model lengths, rotations unscaled. */
double mt_newton_scaled_norm(const mt_newton_work *w, const double *dq);
/* Largest violation of the constraints last evaluated, in model lengths. */
double mt_newton_gap_of(const mt_newton_work *w);

#endif
