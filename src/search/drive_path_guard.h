/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_DRIVE_PATH_GUARD_H
#define SEARCH_DRIVE_PATH_GUARD_H

#include "mechanics/forcing.h"
#include "problem/requirement.h"

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

/* Guards of a requirement, for the modes of the solved analysis. Fails: MT_E_MEMORY. */
mt_status mt_guards_init(const mt_requirement *d, const mt_analysis *a, mt_arena *mem,
                         mt_guards *out, mt_err *err);
/* Adds to opt the modes that a goal and its guards need. */
void mt_guards_query(const mt_requirement *d, mt_analysis_options *opt);
/* Reads the guards after a solve with gradient. Fails: MT_E_MEMORY, as mt_drive_path_rate. */
mt_status mt_guards_read(const mt_guards *g, mt_analysis *a, mt_arena *mem,
                         mt_guard_sample *out, mt_err *err);
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

#endif
