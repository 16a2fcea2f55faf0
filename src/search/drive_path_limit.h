/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_DRIVE_PATH_LIMIT_H
#define SEARCH_DRIVE_PATH_LIMIT_H

#include "problem/forced_response.h"
#include "search/drive_path.h"

/* A goal with limits, followed over the positions of one drive. */
typedef struct mt_limit_drive_path {
    mt_drive_path_end end;
    const char *why;
    double broken_at;
    double from; /* first and last named position [rad, m] */
    double to;
    int positions;
    /* where `end` is MT_MOTION_NONE they are one position, and nothing below is set */
    /* largest excess over a limit (mt_requirement_over); negative: the least margin; infinite
     * excess: HUGE_VAL. NaN: no position has a value */
    double off;
    double at;
    bool given; /* `at` is a named position */
    mt_forced_response_value worst;
    int n_ways;
    /* [n_ways] worst position strictly inside each interval; NaN: it is at an end */
    double *way_at;
    double *way_off;
} mt_limit_drive_path;

/*
 * Follow the goal of d between those positions of its drive that the goal, or another with the
 * same requirement, names, at the design ws->x, at which the configurations have been solved.
 * Samples are closer where modes enter or leave what the goal looks at, where the mechanism
 * turns, and around the worst, whose maximum is found to 1e-4 of the value. This is no proof: a
 * change that no mode, no turn and no neighbouring sample shows is missed. Fails: as
 * mt_drive_path_follow.
 */
mt_status mt_drive_path_limit(mt_workspace *ws, const mt_requirement *d, mt_arena *mem,
                              mt_limit_drive_path *out, mt_err *err);

#endif
