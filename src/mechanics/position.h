/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_POSITION_H
#define MECHANICS_POSITION_H

#include "mechanics/eliminate.h"
#include "mechanics/newton.h"

/* Assembly of a closed loop during a continuation: the orientation of the independent
 * constraint equations. */
typedef struct mt_branch {
    const mt_system *sys;
    int n;      /* independent equations at the current position */
    int most;   /* room for that many; 0: too many equations to check */
    int *row;   /* [n] their indices */
    double *a;  /* n x nq, their gradients there, scaled as in mt_eliminate but for lengths */
    double *to; /* n x nq, gradients at the end of the step */
    double *b;  /* n x n */
} mt_branch;

/* For m equations; more than 150 are not checked. Fails: MT_E_MEMORY. */
mt_status mt_branch_init(mt_branch *b, const mt_system *sys, int m, mt_arena *mem, mt_err *err);
/* Set the current position, where the equations have the gradients a (m x nq, column-major). e:
 * their elimination; NULL: they are independent. */
void mt_branch_stand(mt_branch *b, int m, const double *a, const mt_elimination *e);
/* *kept: a short step to a position with gradients `a` stays on its branch. O(n^2 nq + n^3).
 * Fails: MT_E_MEMORY. */
mt_status mt_branch_kept(mt_branch *b, int m, const double *a, bool *kept, mt_arena *scratch,
                         mt_err *err);

/* The greatest position of a joint (of sys->joints): MT_DRIVE_REACH rad, or model lengths
 * [m]. */
double mt_drive_reach(const mt_system *sys, int joint);
/* d(measure)/ds along the motion rate[nq] at poses. */
double mt_drive_rate(const mt_data *data, int measure, const mt_pose *poses,
                     const double *rate);

/*
 * Positions of a system at one design, each the minimiser of an energy under constraints:
 *   reference    the drawn position with its loops closed by the smallest motion (anchor
 *                energy); skipped where the drawing already closes
 *   driven       the same with the driven joints at their positions; only with `drive`, and
 *                only where the equilibrium leaves freedoms without stiffness, which then stay
 *                next to the drawing
 *   equilibrium  the physical energy; skipped without loads
 * Each stage solves grad V + A^T lambda = 0, c = 0 by Newton with multipliers and checks its
 * residual; a stage that does not converge is an error, never a result. The derivative of a
 * stage by an input follows from the same equations (implicit function theorem).
 *
 * Every design starts at its own drawing, none at the equilibrium of the design before: the
 * drawing selects one of several equilibria, and another start may lead to another one (beyond
 * a fold, across a saddle). Where it leads to the same, the last bits would depend on which
 * designs were evaluated before, and by which worker. It would save one or two of five steps.
 * Only the way of driven joints, where nothing that they go by has changed, need not be gone
 * again (MT_POSITION_AGAIN).
 */
typedef struct mt_state {
    const mt_system *sys;
    bool sparse; /* as mt_newton_problem */
    mt_pose *drawn;
    mt_placement reference;
    mt_placement driven; /* after the driven stage, or where it failed */
    mt_placement at;     /* where the system is linearised */
    mt_stage closure;
    mt_stage anchored; /* the driven stage, where freedoms without stiffness need it */
    mt_stage equilibrium;
    /* driven: the equilibrium is a minimum that any start next to it leads to */
    bool direct;
    int iterations; /* of Newton's method, in all stages */
    double gap_m;   /* largest violation of a constraint at the final position */
    /* largest motions of bodies from the drawing, or from the driven position, to `at` */
    double moved_m;    /* of a centre */
    double turned_rad; /* rotation, at most half a turn */
    int moved_body;    /* body of moved_m and of turned_rad; -1: none */
    int turned_body;
    /* derivatives by one input (mt_position_tangent) */
    double *d_reference; /* [nq] */
    double *d_pose;      /* [nq] */
} mt_state;

/* QUICK: closure by the smallest steps where they converge. EXACT: without it, the slow
 * reference method for QUICK. SPARSE: not driven, in O(bodies) for a chain, or at the cost of
 * the fill-in of a factor; fails with MT_E_EQUILIBRIUM where sparse matrices are not
 * sufficient. AGAIN: `start` is where a design with the same drawing and drive was driven to:
 * from there, where the equilibrium is next to it, else as QUICK from the reference
 * position. */
typedef enum mt_position_method {
    MT_POSITION_QUICK,
    MT_POSITION_EXACT,
    MT_POSITION_SPARSE,
    MT_POSITION_AGAIN
} mt_position_method;

/* data holds values (input -1) with vectors computed; targets and rest values are filled here.
 * Results and work in mem. start: NULL, or the start of driven joints instead of the reference
 * position: a sweep's last point. Fails: MT_E_ASSEMBLY (a gap, named with its joint;
 * contradictory joints), MT_E_EQUILIBRIUM (does not converge, or free to move under load),
 * MT_E_DEAD_CENTRE (singular.h: at the start). */
mt_status mt_position_solve(const mt_system *sys, mt_data *data, const mt_placement *start,
                            mt_position_method way, mt_arena *mem, mt_state *out, mt_err *err);
/* Derivative by data->input (vectors and targets are computed with derivatives here). Fills
 * d_*, and data's rest values with their derivative. */
mt_status mt_position_tangent(mt_state *p, mt_data *data, mt_arena *scratch, mt_err *err);

/*
 * Rounding of positions may change a stiff spring's force by far more than the rounding of the
 * forces themselves: Newton's step that was not taken leads to the balance.
 * left[nq] := that motion, open[nq] := the estimate of its error by a second step. data: of the
 * inputs that p was solved with, rest values filled. After MT_POSITION_SPARSE. Scratch is
 * returned. Fails: MT_E_MEMORY.
 */
mt_status mt_position_balance(const mt_state *p, const mt_data *data, double *left,
                              double *open, mt_arena *scratch, mt_err *err);

/* Close the first m constraints by the smallest steps from `at`, which is moved, to a gap of
 * `enough` model lengths; 0: to rounding. *closed false: the steps do not converge as at a
 * regular position, or joints contradict each other; `at` is then arbitrary. Adds to
 * *iterations. Fails: MT_E_MEMORY. */
mt_status mt_newton_close(const mt_newton_problem *problem, double enough, mt_placement *at,
                          int *iterations, bool *closed, mt_arena *mem, mt_err *err);

#endif
