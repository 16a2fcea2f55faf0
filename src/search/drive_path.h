/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_MOTION_H
#define SEARCH_MOTION_H

#include "problem/drive_positions.h"

/*
 * A design over the range of motion: the modes beside the bands are followed from each named
 * position of a family to the next, by samples. Their slopes d f / d position are exact and
 * choose the step: between two neighbouring positions no mode moves further than a tenth of
 * what it is away from the band (of what the slopes at both ends say, and as it turned out), or
 * than 1e-4 of itself where it stands nearly on an edge; where the cubic through values and
 * slopes comes nearer than all positions so far, one more position is looked at there. That is
 * no proof: a mode that is at rest at all positions may move between them.
 */
typedef enum mt_drive_path_end {
    MT_MOTION_WHOLE,    /* as said above */
    MT_MOTION_CAPPED,   /* the greatest number of positions was not enough for that */
    MT_MOTION_BROKEN,   /* some positions cannot be reached or have no modes: `why` */
    MT_MOTION_UNSTABLE, /* at some positions */
    MT_MOTION_NONE      /* no frequency is forbidden between the positions */
} mt_drive_path_end;

/* How results grade what was looked at so: "sampled", "sampled coarsely", "incomplete",
 * "unstable". */
const char *mt_drive_path_grade(mt_drive_path_end end);

typedef struct mt_drive_path {
    mt_drive_path_end end;
    const char *why; /* of the first position that is broken or unstable; NULL */
    double broken_at;
    double from; /* first and last named position [rad, m] */
    double to;
    int positions; /* that were looked at */
    /* least ln of the ratio between an edge with its margin and the mode that the assignment
     * keeps on that side; negative: it crosses the edge. HUGE_VAL: no mode beside a band */
    double room;
    double tolerance; /* of the band there */
    /* clearance there from the band without its margin, as a ratio less 1 [%]; negative: beyond
     * it */
    double percent;
    double margin_percent; /* asked for at that edge */
    double at;
    double hz;
    int mode; /* 0: none */
    bool above;
    int tie;
    mt_band band;
    int n_ways; /* pieces of the motion between neighbouring positions */
    /* [n_ways] where each has its least room, strictly between its ends; NaN: it does not */
    double *way_at;
    double *way_margin;
} mt_drive_path;

/*
 * below[n_bands]: the assignment (tied bands agree). After the views have been solved at the
 * design ws->x. out's lists and texts in mem. Cost: some ten to some hundred eigensolves.
 * Fails: MT_E_MEMORY, MT_E_INTERNAL, MT_E_INTERRUPTED.
 */
mt_status mt_drive_path_follow(mt_workspace *ws, int drive_positions, const int *below,
                               mt_arena *mem, mt_drive_path *out, mt_err *err);

/* The worker's own analysis of the family's moving mechanism, ws->driven[family]. Fails:
 * MT_E_DOMAIN where there is none, as mt_analysis_new. */
mt_status mt_drive_path_open(mt_workspace *ws, int drive_positions, mt_err *err);
/* d ln f / d position of the mode at pos of a driven analysis, solved with gradient; NaN where
 * it repeats, or has 0 Hz. Fails: as mt_linear_products. */
mt_status mt_drive_path_rate(mt_analysis *a, int pos, double *rate, mt_err *err);
/* Those that differ, ascending; their number. */
int mt_drive_path_distinct(int n_positions, const double *positions, double unit, double *list);
/* Most positions of each of n ways. */
int mt_drive_path_of_band(const mt_subproblem *c, int n);
/* Intervals of a way at first. */
int mt_drive_path_pieces(double way, double unit, int most);

/* Evaluations that it takes at most to follow a design over all motions; 0: there are none, or
 * there is no limit. */
long mt_drive_path_most(const mt_subproblem *c);

/* *kept: all families keep their bands over the motion, within their tolerance, and are stable.
 * *positions grows. As above. */
mt_status mt_drive_path_kept(mt_workspace *ws, const int *below, mt_arena *mem, bool *kept,
                             long *positions, mt_err *err);

#endif
