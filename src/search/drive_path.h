/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_DRIVE_PATH_H
#define SEARCH_DRIVE_PATH_H

#include "problem/drive_positions.h"

/*
 * A design over the range of motion of a drive: the modes beside the bands are followed by
 * samples between consecutive named positions. Exact slopes df/d(position) choose the step:
 * between two neighbouring samples no mode moves (by the slopes at both ends, and in fact) by
 * more than a tenth of its distance from the band, or 1e-4 of itself where it is nearly on an
 * edge; where the cubic through values and slopes comes nearer than all samples so far, one
 * more sample is taken there. This is no proof: a mode that is at rest at all samples may move
 * between them.
 */
typedef enum mt_drive_path_end {
    MT_MOTION_WHOLE,    /* sampled as above */
    MT_MOTION_CAPPED,   /* the maximum number of positions was too small for that */
    MT_MOTION_BROKEN,   /* some positions cannot be reached or have no modes: see `why` */
    MT_MOTION_UNSTABLE, /* unstable at some positions */
    MT_MOTION_NONE      /* no band applies between the positions */
} mt_drive_path_end;

/* Grade of the path in results: "sampled", "sampled coarsely", "incomplete", "unstable". */
const char *mt_drive_path_grade(mt_drive_path_end end);

typedef struct mt_drive_path {
    mt_drive_path_end end;
    const char *why; /* of the first broken or unstable position; NULL: none */
    double broken_at;
    double from; /* first and last named position [rad, m] */
    double to;
    int positions; /* number of samples */
    /* least log margin: ln of the ratio between an edge with its margin and the mode that the
     * placement keeps on that side; negative: the mode crosses the edge. HUGE_VAL: no mode
     * beside a band */
    double room;
    double tolerance; /* of that band */
    /* clearance there from the band without its margin [%]; negative: inside the band */
    double percent;
    double margin_percent; /* required at that edge */
    double at;
    double hz;
    int mode; /* 0: none */
    bool above;
    int tie;
    mt_band band;
    int n_ways; /* intervals between consecutive named positions */
    /* [n_ways] position of the least margin strictly inside each interval; NaN: it is at an
     * end */
    double *way_at;
    double *way_margin;
} mt_drive_path;

/*
 * Follow the design ws->x, at which the configurations have been solved, with the mode
 * placement below[n_bands] (tied bands agree). out's lists and texts in mem. Cost: some ten to
 * some hundred eigensolves. Fails: MT_E_MEMORY, MT_E_INTERNAL, MT_E_INTERRUPTED.
 */
mt_status mt_drive_path_follow(mt_workspace *ws, int drive_positions, const int *below,
                               mt_arena *mem, mt_drive_path *out, mt_err *err);

/* Opens the worker's own analysis of the drive's mechanism, ws->driven[drive_positions]. Fails:
 * MT_E_DOMAIN where there is none, as mt_analysis_new. */
mt_status mt_drive_path_open(mt_workspace *ws, int drive_positions, mt_err *err);
/* rate: d ln f / d position of the mode at pos of a driven analysis, solved with gradient; NaN
 * for a repeated mode or 0 Hz. Fails: as mt_linear_products. */
mt_status mt_drive_path_rate(mt_analysis *a, int pos, double *rate, mt_err *err);
/* list: the distinct positions, ascending. Returns their number. */
int mt_drive_path_distinct(int n_positions, const double *positions, double unit, double *list);
/* Maximum number of samples in each of n intervals. */
int mt_drive_path_of_band(const mt_subproblem *c, int n);
/* Initial number of subintervals of an interval of length `way`. */
int mt_drive_path_pieces(double way, double unit, int most);

/* Maximum number of evaluations for following a design over all drives; 0: no drives, or no
 * limit. */
long mt_drive_path_most(const mt_subproblem *c);

/* *kept: over all drives the design stays outside its bands, within their tolerance, and is
 * stable. *positions is increased by the number of samples. Fails: as mt_drive_path_follow. */
mt_status mt_drive_path_kept(mt_workspace *ws, const int *below, mt_arena *mem, bool *kept,
                             long *positions, mt_err *err);

#endif
