/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_NEWTON_H
#define MECHANICS_NEWTON_H

#include "mechanics/border.h"
#include "mechanics/eliminate.h"

/* One stage of the position analysis: a stationary point of an energy under the first m
 * constraints. */
typedef struct mt_newton_problem {
    const mt_data *data;
    mt_energy energy;
    const mt_pose *drawn; /* anchor */
    int m;
    /* the drive's constraint, the last, is held by the unknown force of the trimmed spring
     * instead of its multiplier */
    bool trim;
    /* sparse matrices only: MT_E_EQUILIBRIUM where they are not sufficient. Freedoms without
     * stiffness are not detected */
    bool sparse;
} mt_newton_problem;

/*
 * Solver of the equations of a step. Sparse, as a saddle-point system, where that is safely
 * regular; otherwise dense in a basis of the freedoms with a pseudo-inverse, which handles
 * redundant equations and freedoms without stiffness.
 */
typedef struct mt_newton_solver {
    bool sparse;
    mt_saddle saddle; /* of all equations, the drive's included */
    mt_border border; /* of the saddle, with trim */
    mt_elimination e; /* with trim: without the drive's row */
    /* pseudo-inverse of the (bordered) reduced Hessian, order n (n + 1 with trim) */
    double *inverse;
} mt_newton_solver;

/* Result of a stage. */
typedef struct mt_stage {
    bool active;             /* this stage ran */
    int iterations;          /* also where it failed */
    int factors;             /* matrix factorisations in them */
    mt_newton_solver solver; /* at the solution */
    int m;
    double *lambda;          /* [m] multipliers: constraint force A^T lambda */
    double *h;               /* nq x nq Hessian of the Lagrangian; NULL: the solver is sparse */
    double *a;               /* m x nq; NULL: the solver is sparse */
    double *trim;            /* [nq] gradient of the trimmed spring's measure */
    double trim_force;       /* its force; physical energy [N, N m] */
    double residual;         /* largest unbalanced force / largest force */
    mt_newton_residual left; /* with the physical energy */
    int null_freedoms;       /* freedoms without stiffness at the solution */
    /* derivatives by one input, for the physical energy (newton_tangent.h) */
    double *d_lambda; /* [m] */
    double d_trim_force;
} mt_stage;

/* Largest |c| of the first m constraints (angles and cosines in model lengths) [m]. */
mt_status mt_newton_gap(const mt_newton_problem *problem, const mt_placement *at, mt_arena *mem,
                        double *gap_m, mt_err *err);
/* Solve from `at`, which is moved to the solution. Adds to stage->iterations; the rest of stage
 * is filled on success. Fails: MT_E_ASSEMBLY, MT_E_EQUILIBRIUM, MT_E_DEAD_CENTRE, MT_E_MEMORY,
 * MT_E_INTERRUPTED. */
mt_status mt_newton_solve(const mt_newton_problem *problem, mt_placement *at, mt_arena *mem,
                          mt_stage *stage, mt_err *err);
/* Close the first m constraints by the smallest steps from `at`, which is moved, to a gap of
 * `enough` model lengths; 0: to rounding. *closed false: the steps do not converge as at a
 * regular position, or joints contradict each other; `at` is then arbitrary. Adds to
 * *iterations. (newton_close.c) Fails: MT_E_MEMORY. */
mt_status mt_newton_close(const mt_newton_problem *problem, double enough, mt_placement *at,
                          int *iterations, bool *closed, mt_arena *mem, mt_err *err);

#endif
