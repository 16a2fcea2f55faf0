/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_MOTION_GUARD_H
#define SEARCH_MOTION_GUARD_H

#include "mechanics/directions.h"
#include "problem/requirement.h"

/*
 * What shows, at two positions of a drive, that a number may be another one between them:
 * frequencies of modes c = ln f beside those where the number has its steps (the ends of a
 * goal's range, a limit, the mode next in order), with dc/ds, and how the mechanism lies
 * (mechanics/directions.h). The number alone does not show it: a response is flat on both sides
 * of a resonance that comes and goes.
 */
typedef struct mt_guard {
    int mode;        /* index */
    int beside;      /* the mode that it is compared with; 0: log_edge */
    double log_edge; /* ln of a frequency */
} mt_guard;

typedef struct mt_guards {
    int n;
    mt_guard *items;
    int first; /* indices of the modes that they name; first > last: none */
    int last;
    const mt_system *sys;
    double *log_hz; /* [last - first + 1] work */
    double *rate;
} mt_guards;

/* At one position. */
typedef struct mt_guard_sample {
    /* [n] ln f over what it is compared with; infinite: there is no such mode */
    double *avoidance;
    double *rate; /* [n] its slope over the position; NaN: not known */
    double *directions;
} mt_guard_sample;

/* Those of a requirement, by the modes that the analysis has where it was solved. Fails:
 * MT_E_MEMORY. */
mt_status mt_guards_init(const mt_requirement *d, const mt_analysis *a, mt_arena *mem,
                         mt_guards *out, mt_err *err);
/* Modes that a goal asks for, and those that its guards compare them with. */
void mt_guards_query(const mt_requirement *d, mt_analysis_options *opt);
/* After a solve with gradient. Fails: MT_E_MEMORY, as mt_drive_path_rate. */
mt_status mt_guards_read(const mt_guards *g, mt_analysis *a, mt_arena *mem,
                         mt_guard_sample *out, mt_err *err);
/* True where two positions, h apart, are too far from each other: a body or the line of a
 * spring turns by more than a third of a radian, a length changes by as much of itself, or a
 * mode moves, by the slopes at both or as it turned out, by more than a fourth of its distance
 * from what it is compared with (of a fiftieth, where it is nearer). */
bool mt_guards_keep_distance(const mt_guards *g, const mt_guard_sample *a,
                             const mt_guard_sample *b, double h);
/* The middle one of three positions, before and after apart, is another than the cubics through
 * values and slopes of its neighbours have it. */
bool mt_guards_astray(const mt_guards *g, const mt_guard_sample *a, double before,
                      const mt_guard_sample *middle, double after, const mt_guard_sample *b);

#endif
