/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_POSITION_H
#define MECHANICS_POSITION_H

#include "mechanics/eliminate.h"
#include "mechanics/lagrangian.h"

/*
 * Positions of a system at one design, each the minimiser of an energy under constraints:
 *   reference the drawn position with its loops closed by the smallest motion (anchor energy);
 *   skipped where the drawing already closes driven the same with the driven joint at its
 *   place; only with `drive`, and only where the equilibrium leaves freedoms without stiffness,
 *   which then stay next to the drawing equilibrium the physical energy; skipped where nothing
 *   loads the mechanism
 * Each stage solves grad V + A^T lambda = 0, c = 0 by Newton with multipliers and checks its
 * residual; a stage that does not converge is an error, never a result. The derivative of a
 * stage with respect to an input follows from the same equations (implicit function theorem).
 */
typedef struct mt_stage {
    bool active;       /* did this stage run? */
    int m;             /* constraints in force */
    mt_elimination e;  /* at the solution (with trim: without the drive's row) */
    double *lambda;    /* [m] multipliers: constraint force A^T lambda */
    double *h;         /* nq x nq Hessian of the Lagrangian */
    double *a;         /* m x nq */
    int order;         /* n (+1 with trim) */
    double *inverse;   /* order x order pseudo-inverse of the (bordered) reduced Hessian */
    double *trim;      /* [nq] gradient of the trimmed spring's measure */
    mt_step_left left; /* with the physical energy */
    int null_freedoms; /* freedoms without stiffness at the solution */
} mt_stage;

/* Where to begin driving from, instead of the reference position: a sweep's last point. */
typedef struct mt_drive_start {
    bool valid;
    double position; /* of the driven joint */
    mt_pose *pose;   /* [bodies] */
    double *turn;    /* [measures] as mt_data.turn */
} mt_drive_start;

typedef struct mt_state {
    const mt_system *sys;
    mt_pose *drawn;
    mt_pose *reference;
    mt_pose *driven_pose; /* after the driven stage */
    double *driven_turn;  /* [measures] mt_data.turn there */
    mt_pose *pose;        /* where the system is linearised */
    mt_stage closure;
    mt_stage driven;
    mt_stage equilibrium;
    double reached;    /* how far the driven joint came, rad or m from the reference position */
    double trim_force; /* of the trimmed spring, N or N m */
    int iterations;
    /* equilibrium: largest unbalanced force / largest force; 0 where skipped */
    double residual;
    double gap_m; /* largest violation of a constraint at the final position */
    /* how far the bodies went from the drawing, or from where the drive brought them, to
     * `pose` */
    double moved_m;    /* furthest centre */
    double turned_rad; /* furthest turn, at most half a turn */
    int moved_body;    /* whose centre and whose turn; -1: none */
    int turned_body;
    /* derivatives with respect to one input (mt_position_tangent) */
    double *d_reference; /* [nq] */
    double *d_pose;      /* [nq] */
    double *d_lambda;    /* [equilibrium.m] */
    double d_trim_force;
} mt_state;

/* data holds values (input -1) with vectors loaded; targets, rest values and turns are filled
 * here. Results and work in mem. start: NULL, or where a driven joint begins. Fails:
 * MT_E_ASSEMBLY (a gap, named with its joint; contradictory joints), MT_E_EQUILIBRIUM (does not
 * converge, or free to move under load), MT_E_DEAD_CENTRE (singular.h: where it begins). */
mt_status mt_position_solve(const mt_system *sys, mt_data *data, const mt_drive_start *start,
                            mt_arena *mem, mt_state *out, mt_err *err);
/* Derivative with respect to data->input (vectors, targets loaded with derivatives here). Fills
 * d_*, and data's rest values with their derivative. */
mt_status mt_position_tangent(mt_state *p, mt_data *data, mt_arena *scratch, mt_err *err);
/* Move all bodies by dq (real). */
void mt_position_move(const mt_system *sys, mt_pose *poses, const double *dq);
/* Poses with derivative dq on them. out may be poses. */
void mt_position_complex(const mt_system *sys, const mt_pose *poses, const double *dq,
                         mt_pose *out);

/* The bodies and directions that dominate the motion Z y, for messages: "bob" (along x), "rod"
 * (rotation). y[e->n], text[size]. */
void mt_position_name_motion(const mt_system *sys, const mt_elimination *e, const double *y,
                             char *text, size_t size);

#endif
