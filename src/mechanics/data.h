/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_DATA_H
#define MECHANICS_DATA_H

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
    /* [sys->n_drives] positions of driven joints from the reference position [rad, m] */
    double drive[MT_DRIVES_MOST];
} mt_placement;

mt_status mt_placement_init(mt_placement *place, const mt_system *sys, mt_arena *mem,
                            mt_err *err);
void mt_placement_copy(const mt_system *sys, const mt_placement *from, mt_placement *to);

/*
 * All numbers of a system at one design, for the complex kernels: values alone (input < 0), or
 * values with the derivative by one input.
 */
typedef struct mt_data {
    const mt_system *sys;
    const double *value; /* [program.count] */
    const double *grad;  /* [program.count x n_inputs]; may be NULL where input < 0 */
    int input;           /* -1: no derivative */
    mt_cx (*vec)[3];     /* [n_vecs] */
    mt_cx (*rest)[2];    /* [n_springs] rest values of the two measures of each spring */
    mt_cx *target;       /* [n_constraints]; those of drives at their positions */
    /* what Newton's method keeps from design to design (newton.h); NULL: nothing */
    struct mt_newton_start *start;
} mt_data;

mt_status mt_data_init(mt_data *d, const mt_system *sys, mt_arena *mem, mt_err *err);
/* Compute vector i from earlier vectors and the nodes. */
void mt_data_vec(mt_data *d, int i);
/* Compute all vectors; all targets, from the drawn position. */
void mt_data_vecs(mt_data *d);
void mt_data_targets(mt_data *d);
/* Compute rest values and the targets of drives at the reference position (poses may have
 * derivatives). */
void mt_data_rest(mt_data *d, const mt_pose *reference);
/* Update the whole turns of the angles in at->turn; each angle is less than half a turn from
 * its last value. */
void mt_data_turns(const mt_data *d, mt_placement *at);
/* Target of constraint i with the driven joints at their positions in `at`. */
mt_cx mt_data_target(const mt_data *d, int i, const mt_placement *at);
/* A node as a complex number; MT_NO_NODE gives `otherwise`. */
mt_cx mt_data_scalar(const mt_data *d, mt_node node, double otherwise);
/* The measure with its vectors; an angle takes the value nearest to 0. */
mt_measure_data mt_data_measure(const mt_data *d, const mt_measure_def *def);
/* Its value at a position, an angle with its whole turns. */
mt_cx mt_data_value(const mt_data *d, const mt_measure_def *def, const mt_placement *at,
                    mt_beam_parts *kept);
/* The same with derivatives, as mt_measure_eval. */
void mt_data_eval(const mt_data *d, const mt_measure_def *def, const mt_placement *at,
                  bool second, mt_beam_parts *kept, mt_jet *out);
void mt_data_relative(const mt_data *d, const mt_measure_def *def, const mt_placement *at,
                      bool second, mt_beam_parts *kept, mt_relative_jet *out);
/* Drawn positions (with their derivative); poses[n_bodies]. */
void mt_data_drawn(const mt_data *d, mt_pose *poses);

#endif
