/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_DRIVE_PATH_H
#define SEARCH_DRIVE_PATH_H

#include "problem/drive_positions.h"
#include "problem/forced_response.h"
#include "problem/requirement.h"

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

/* Maximum number of evaluations for following a design over all drives; 0: no drives, or no
 * limit. */
long mt_drive_path_most(const mt_subproblem *c);

/*
 * Signs, at two positions of a drive, that a goal's value may differ between them: c = ln f of
 * modes relative to the frequencies where the value has its steps (the ends of a goal's range,
 * a limit, the mode next in order), with dc/ds, and the directions of the mechanism
 * (mechanics/forcing.h). The value alone is not enough: a response is flat on both sides of
 * a resonance that passes through its range.
 */
typedef struct mt_guard {
    int mode;        /* index */
    int beside;      /* index of the mode it is compared with; 0: log_edge */
    double log_edge; /* ln of a frequency */
} mt_guard;

typedef struct mt_guards {
    int n;
    mt_guard *items;
    int first; /* range of mode indices used; first > last: none */
    int last;
    const mt_system *sys;
    double *log_hz; /* [last - first + 1] work */
    double *rate;
} mt_guards;

/* Values at one position. */
typedef struct mt_guard_sample {
    /* [n] ln of f over the frequency it is compared with; infinite: no such mode */
    double *avoidance;
    double *rate; /* [n] derivative with respect to the position; NaN: not known */
    double *directions;
} mt_guard_sample;
/* True where two positions, h apart, need another between them: a body or the line of a spring
 * turns by more than a third of a radian, a length changes by more than a third of itself, or a
 * mode moves, by the slopes at both or in fact, by more than a fourth of its distance from what
 * it is compared with (of 1/50 where it is nearer). */
bool mt_guards_keep_distance(const mt_guards *g, const mt_guard_sample *a,
                             const mt_guard_sample *b, double h);
/* True where a value at the middle of three positions, `before` and `after` from its
 * neighbours, deviates from the cubic through their values and slopes. */
bool mt_guards_astray(const mt_guards *g, const mt_guard_sample *a, double before,
                      const mt_guard_sample *middle, double after, const mt_guard_sample *b);

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
