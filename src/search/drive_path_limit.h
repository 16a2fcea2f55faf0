/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_MOTION_LIMIT_H
#define SEARCH_MOTION_LIMIT_H

#include "problem/forced_response.h"
#include "search/drive_path.h"

/* A goal with limits over the positions of one drive. */
typedef struct mt_limit_drive_path {
    mt_drive_path_end end;
    const char *why;
    double broken_at;
    double from; /* first and last position that is given [rad, m] */
    double to;
    int positions;
    /* MT_MOTION_NONE as `end`: they are one position, and nothing else is set */
    /* the most that a limit is exceeded by (mt_requirement_over); negative: the least room;
     * where it is infinite, HUGE_VAL. NaN: no position has a value */
    double off;
    double at;
    bool given; /* that is one of the positions given */
    mt_forced_response_value worst;
    int n_ways;
    double *way_at; /* [n_ways] the worst strictly between two of those; NaN: there is none */
    double *way_off;
} mt_limit_drive_path;

/*
 * The goal of d at positions between those of its family that the goal, or another that asks
 * the same, names, at the design ws->x, at which the views have been solved: samples, closer
 * where modes come to or leave what the goal looks at, where the mechanism turns, and around
 * the worst, whose top is then known to 1e-4 of the value. That is no proof: what no mode, no
 * turn and no neighbour shows is not seen. Fails: as mt_drive_path_follow.
 */
mt_status mt_drive_path_limit(mt_workspace *ws, const mt_requirement *d, mt_arena *mem,
                              mt_limit_drive_path *out, mt_err *err);

#endif
