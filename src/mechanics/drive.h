/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_DRIVE_H
#define MECHANICS_DRIVE_H

#include "mechanics/newton.h"

/*
 * Bring the driven joint from where `at` says that it stands to its place, on the branch where
 * it stands; at: in, out. Closed there, the springs strained about as little as they can be.
 * Angles are followed over whole turns. Where it fails, at->drive tells how far it came; what
 * Newton needed is added to *iterations. Fails: MT_E_ASSEMBLY beyond mt_drive_reach, where
 * MOST_STEPS (drive.c) do not get there, at a limit position, in a position that the other
 * joints hold, and where they do not stay closed; MT_E_DEAD_CENTRE from where the drawing is
 * one; MT_E_MEMORY.
 *     brief: the mechanism is closed where that takes the smallest steps, instead of next to
 * where each step led: another place to second order, on the same branch, for a quarter of the
 * work.
 */
mt_status mt_drive_solve(const mt_data *data, bool brief, mt_placement *at, int *iterations,
                         mt_arena *mem, mt_err *err);

/* The farthest position that a joint (of sys->joints) is brought to: MT_DRIVE_REACH rad, or
 * model lengths [m]. */
double mt_drive_reach(const mt_system *sys, int joint);
/* The motion dq/ds with which the driven joint goes on from where `at` stands: rate[nq]; *size:
 * how far it moves bodies [model lengths, rad] while the joint goes by 1 rad or a model length;
 * *held: there is none, the other joints hold it. Fails: as Newton's steps, MT_E_MEMORY. */
mt_status mt_drive_motion(const mt_data *data, mt_placement *at, double *rate, double *size,
                          bool *held, mt_arena *mem, mt_err *err);
/* d(measure)/ds along the motion rate[nq] at poses. */
double mt_drive_rate(const mt_data *data, int measure, const mt_pose *poses,
                     const double *rate);

#endif
