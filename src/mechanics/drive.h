/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_DRIVE_H
#define MECHANICS_DRIVE_H

#include "mechanics/newton.h"

/*
 * Move the driven joint from its position in `at` to its target, by continuation on the present
 * branch; at: in, out. The result is closed, with the springs strained about as little as
 * possible. Angles are followed over whole turns. On failure at->drive is the position reached;
 * Newton iterations are added to *iterations. Fails: MT_E_ASSEMBLY beyond mt_drive_reach, where
 * MOST_STEPS (drive.c) are not enough, at a limit position, in a position that the other joints
 * hold, and where they do not stay closed; MT_E_DEAD_CENTRE where the drawn position is
 * one; MT_E_MEMORY.
 *
 * brief: the mechanism is closed by the smallest steps, not nearest to the predicted position:
 * a different position to second order, on the same branch, for a quarter of the work.
 */
mt_status mt_drive_solve(const mt_data *data, bool brief, mt_placement *at, int *iterations,
                         mt_arena *mem, mt_err *err);

/* The greatest position of a joint (of sys->joints): MT_DRIVE_REACH rad, or model lengths
 * [m]. */
double mt_drive_reach(const mt_system *sys, int joint);
/* The motion dq/ds of the driven joint at `at`: rate[nq]; *size: how far it moves bodies [model
 * lengths, rad] per rad or model length of the joint; *held: there is none, because the other
 * joints hold it. Fails: as Newton's steps, MT_E_MEMORY. */
mt_status mt_drive_motion(const mt_data *data, mt_placement *at, double *rate, double *size,
                          bool *held, mt_arena *mem, mt_err *err);
/* d(measure)/ds along the motion rate[nq] at poses. */
double mt_drive_rate(const mt_data *data, int measure, const mt_pose *poses,
                     const double *rate);

#endif
