/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_POSE_H
#define MECHANICS_POSE_H

#include "mechanics/system.h"

void mt_cross3(const double a[3], const double b[3], double out[3]);
/* out := v[3 x count] rotated by theta (Rodrigues); not in place. */
void mt_turn3(const double theta[3], int count, const double *v, double *out);

/* Poses: of one body, of all bodies of a system, and with the other data of a position. */

mt_pose mt_pose_ground(void);
const mt_pose *mt_pose_of(const mt_pose *poses, int body); /* the ground's for MT_GROUND */
/* R -> exp(theta^) R (Rodrigues), x -> x + dx; real increments; derivative parts of the pose
 * are dropped. */
void mt_pose_move(mt_pose *pose, const double *dx, const double *theta);
/* Give a real pose the derivative (dx, theta): x + i h dx, R + i h theta^ R. */
void mt_pose_tangent(mt_pose *pose, const double *dx, const double *theta);

/* The six components of dq of a body; 0 for those it does not have. */
void mt_pose_motion(const mt_system *sys, int body, const double *dq, double out[6]);
/* All bodies along dq[nq]: moved (real), or with dq as their derivative; out may be poses. */
void mt_poses_move(const mt_system *sys, mt_pose *poses, const double *dq);
void mt_poses_tangent(const mt_system *sys, const mt_pose *poses, const double *dq,
                      mt_pose *out);
/* Largest difference: model lengths, and entries of the rotations; NaN if any difference is
 * NaN. */
double mt_poses_distance(const mt_system *sys, const mt_pose *a, const mt_pose *b);
/* way[nq] := the motion from `from` to `to`. */
void mt_poses_increment(const mt_system *sys, const mt_pose *from, const mt_pose *to,
                        double *way);

/* A position of a system: poses, and the data that poses do not contain. */
typedef struct mt_placement {
    mt_pose *pose; /* [bodies] */
    /* [measures] each angle with whole turns; 0 in the reference position. An angle is read as
     * the value nearest to this */
    double *turn;
    double drive; /* position of the driven joint from the reference position [rad, m] */
} mt_placement;

mt_status mt_placement_init(mt_placement *place, const mt_system *sys, mt_arena *mem,
                            mt_err *err);
void mt_placement_copy(const mt_system *sys, const mt_placement *from, mt_placement *to);

#endif
