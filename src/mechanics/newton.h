/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_NEWTON_H
#define MECHANICS_NEWTON_H

#include "mechanics/eliminate.h"
#include "mechanics/lagrangian.h"

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
} mt_newton_problem;

/* Its solution. */
typedef struct mt_stage {
    bool active;       /* did this stage run? */
    int iterations;    /* also where it was not solved */
    mt_elimination e;  /* at the solution (with trim: without the drive's row) */
    double *lambda;    /* [m] multipliers: constraint force A^T lambda */
    double *h;         /* nq x nq Hessian of the Lagrangian */
    double *a;         /* m x nq */
    int order;         /* n (+1 with trim) */
    double *inverse;   /* order x order pseudo-inverse of the (bordered) reduced Hessian */
    double *trim;      /* [nq] gradient of the trimmed spring's measure */
    double trim_force; /* its force; physical energy [N, N m] */
    double residual;   /* largest unbalanced force / largest force */
    mt_step_left left; /* with the physical energy */
    int null_freedoms; /* freedoms without stiffness at the solution */
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

#endif
