/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_SWEEP_H
#define MECHANICS_SWEEP_H

#include "mechanics/linear.h"
#include "mechanics/singular.h"

/*
 * Static response of a mechanism along the range of one driven joint, or of several that are
 * driven together: a system made by mt_system_new_of, solved at one position after the other.
 * The sweep starts at the point nearest to the reference position and goes outwards in both
 * directions, each point from its neighbour, so that every point is on the branch of the
 * drawing. A grid consists of lines, each a sweep of its own that starts at the reference
 * position.
 */
typedef struct mt_sweep_point {
    double *drive;    /* [n_drives] positions from the reference position [rad, m] */
    mt_status status; /* MT_OK, or the failure at this point */
    const char *why;  /* its text; NULL where MT_OK */
    /* [n_joints] coordinate of each joint from the reference position, whole turns counted
     * [rad, m]; NaN for a joint without one */
    double *coordinate;
    /* n_joints x n_drives: d coordinate / d drive, exact, along the equilibria, the other
     * drives held */
    double *ratio;
    /* [n_drives] moment or force of the lock along the joint's coordinate, or force of the
     * trimmed spring [N m, N] */
    double *hold;
    double residual; /* of the equilibrium, relative to the forces at work */
    double gap_m;    /* largest violation of a constraint */
    /* distance to a dead centre; NULL where the point failed */
    const mt_nearness *near;
} mt_sweep_point;

typedef struct mt_sweep {
    int n_joints;
    int n_drives; /* of the caller */
    int n_points;
    mt_sweep_point *points; /* in the order of the given positions */
    int n_reached;          /* points with MT_OK */
} mt_sweep;

/* Brings lin to inputs (with gradient) and evaluates what it needs there. Its failure is
 * recorded at the point; a lack of memory, an interrupt, or an internal error ends the
 * sweep. */
typedef struct mt_sweep_visitor {
    mt_status (*visit)(void *context, int point, const double *inputs, mt_err *err);
    void *context;
    /* the visitor does everything: points get no coordinates, ratios, forces or residuals, and
     * no gradient is needed */
    bool alone;
} mt_sweep_visitor;

/* `steps` >= 2 positions from `from` to `to` (or 1: `from`), evenly spaced, both ends exact:
 * positions[steps]. */
void mt_sweep_range(double from, double to, int steps, double *positions);

typedef struct mt_sweep_plan {
    int n;
    int n_drives;            /* 0: 1 */
    int line;                /* of a grid: points of a line, which divide n; 0: one line */
    const double *positions; /* n_drives x n, of the caller's drives in their order */
} mt_sweep_plan;

/**
 * @param lin        of a system with a caller's drives; its scratch is used
 * @param inputs     [lin->sys->n_inputs - n_drives] all but the positions
 * @param visitor    NULL: mt_linear_update alone
 * @param mem        holds the result
 * A point at a dead centre has MT_E_DEAD_CENTRE, and the sweep continues from the point before
 * it. A point beyond a limit position has MT_E_ASSEMBLY and a text that names the limit, as
 * have all points beyond it in its line. Fails: MT_E_MEMORY, MT_E_INTERNAL, MT_E_INTERRUPTED.
 */
mt_status mt_sweep_run(mt_linear *lin, const double *inputs, const mt_sweep_plan *plan,
                       const mt_sweep_visitor *visitor, mt_arena *mem, mt_sweep *out,
                       mt_err *err);

#endif
