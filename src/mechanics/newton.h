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
    /* The last constraint (the drive) is held by the unknown force of the trimmed spring
     * instead of by its multiplier. */
    bool trim;
    /* No dense matrices: MT_E_EQUILIBRIUM where the sparse ones do not do. Freedoms without
     * stiffness are not looked for. */
    bool sparse;
} mt_newton_problem;

/*
 * How the equations of a step are solved. Sparse, as a saddle-point system, where that is
 * regular beyond doubt; else in a basis of the freedoms, dense, with a pseudo-inverse:
 * redundant equations and freedoms without stiffness are seen to there.
 */
typedef struct mt_newton_solver {
    bool sparse;
    mt_saddle saddle; /* with all equations, the drive's too */
    mt_border border; /* of it, with trim */
    mt_elimination e; /* (with trim: without the drive's row) */
    /* pseudo-inverse of the (bordered) reduced Hessian, order n (+1 with trim) */
    double *inverse;
} mt_newton_solver;

/* Its solution. */
typedef struct mt_stage {
    bool active;             /* this stage ran */
    int iterations;          /* also where it was not solved */
    int factors;             /* of matrices, in them */
    mt_newton_solver solver; /* at the solution */
    int m;
    double *lambda;          /* [m] multipliers: constraint force A^T lambda */
    double *h;               /* nq x nq Hessian of the Lagrangian; NULL: the solver is sparse */
    double *a;               /* m x nq; likewise */
    double *trim;            /* [nq] gradient of the trimmed spring's measure */
    double trim_force;       /* its force; physical energy [N, N m] */
    double residual;         /* largest unbalanced force / largest force */
    mt_newton_residual left; /* with the physical energy */
    int null_freedoms;       /* freedoms without stiffness at the solution */
    /* derivatives with respect to one input, of the physical energy (newton_tangent.h) */
    double *d_lambda; /* [m] */
    double d_trim_force;
} mt_stage;

/* Largest |c| of the first m constraints (angles and cosines in model lengths) [m]. */
mt_status mt_newton_gap(const mt_newton_problem *problem, const mt_placement *at, mt_arena *mem,
                        double *gap_m, mt_err *err);
/* Solve from `at`, which is moved to the solution. stage: iterations are added to what stands
 * there, all else is filled where there is a solution. Fails: MT_E_ASSEMBLY, MT_E_EQUILIBRIUM,
 * MT_E_DEAD_CENTRE, MT_E_MEMORY, MT_E_INTERRUPTED. */
mt_status mt_newton_solve(const mt_newton_problem *problem, mt_placement *at, mt_arena *mem,
                          mt_stage *stage, mt_err *err);
/* Close the first m constraints by the smallest steps from `at`, which is moved: to a gap of
 * `enough` model lengths, 0: to rounding. *closed false: the steps do not converge as they do
 * beside a regular position, or joints contradict each other; `at` is then anywhere.
 * *iterations grows. (newton_close.c) Fails: MT_E_MEMORY. */
mt_status mt_newton_close(const mt_newton_problem *problem, double enough, mt_placement *at,
                          int *iterations, bool *closed, mt_arena *mem, mt_err *err);

#endif
