/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_PROGRESS_H
#define BASE_PROGRESS_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "base/base.h"

/*
 * Progress of a long computation. The workers record it here, from any thread; a reader polls
 * it (mt_progress_read), so no worker waits for a terminal.
 *
 * The work is a sequence of phases, and a phase a sequence of steps: "12 of 28 starts". A step
 * that begins while another one is open is part of that one and is not reported, so any step
 * that may be outermost calls begin and end. Counters count at every level. All functions
 * accept NULL and then do nothing.
 */
typedef struct mt_progress_mark {
    double cpu_s;     /* by mt_progress.clock; NaN: has not happened */
    long evaluations; /* designs evaluated until then */
} mt_progress_mark;

typedef struct mt_progress_view {
    const char *phase; /* NULL: none yet */
    /* number of phases and steps begun so far; 0: none yet. A phase may be entered again, a
     * step is not: the time of a step starts when this number changes. */
    long step;
    const char *unit; /* unit of the step: "starts"; NULL: not divided */
    long done;        /* units done */
    long total;       /* 0: not known */
    double share;     /* of the step, 0 to 1; NaN: not known */
    bool ended;       /* the step has ended */
    long evaluations; /* of designs */
    long solutions;   /* modal solutions, of designs and others (base/work_counters.h) */
    long boxes;       /* boxes of proofs */
    const char *what; /* the objective whose value is `best`; NULL: none yet */
    double best;
    mt_progress_mark first;   /* the first design that meets all goals */
    mt_progress_mark best_at; /* the best design so far, up to its last digits */
    bool impossible;          /* proven that no design meets all goals */
    mt_progress_mark proof;   /* the last proof so far that settled its question */
} mt_progress_view;

typedef struct mt_progress {
    pthread_mutex_t lock; /* of `now`, except for the counters */
    mt_progress_view now;
    /* CPU seconds so far; set by the reader before the work begins, called by any thread when a
     * mark is made. NULL: marks have no time */
    double (*clock)(void);
    double best_f;       /* objective of the best design; less is better */
    double marked;       /* `best` at the last mark */
    bool open;           /* a step is open */
    atomic_bool designs; /* the phase looks for designs */
    atomic_long done;
    atomic_long evaluations;
    atomic_long solutions;
    atomic_long boxes;
    atomic_int ppm; /* share of a step that is not divided, in millionths; -1: not known */
} mt_progress;

/* Fails: MT_E_SYSTEM. After success the caller calls mt_progress_free. */
mt_status mt_progress_init(mt_progress *p, mt_err *err);
void mt_progress_free(mt_progress *p);

/* Begin a phase; name is not copied. Ignored while a step is open. designs: the phase looks for
 * designs that meet the goals, and its best design is reported. */
void mt_progress_phase(mt_progress *p, const char *name, bool designs);
/* Begin a step of `total` units (0: not known). False: the step is part of an open step and is
 * not reported. */
bool mt_progress_begin(mt_progress *p, const char *unit, long total);
/* One more unit of the step is done; the given share of it is done, which never decreases; the
 * whole step is done, even if units were skipped. outermost: the result of
 * mt_progress_begin. */
void mt_progress_done(mt_progress *p, bool outermost);
void mt_progress_share(mt_progress *p, bool outermost, double share);
void mt_progress_end(mt_progress *p, bool outermost);
/* Count one evaluated design; n modal solutions; one examined box of a proof. */
void mt_progress_evaluated(mt_progress *p);
void mt_progress_solved(mt_progress *p, long n);
void mt_progress_boxed(mt_progress *p);
/* True where the phase looks for designs. */
bool mt_progress_seeks(mt_progress *p);
/* Record a design that meets all goals, with the objective `what` of value f (minimised), shown
 * as `value`. */
void mt_progress_found(mt_progress *p, const char *what, double f, double value);
/* Record a proof that settled its question; the proof that no design meets all goals. */
void mt_progress_proved(mt_progress *p);
void mt_progress_impossible(mt_progress *p);

/* The current state. */
mt_progress_view mt_progress_read(mt_progress *p);

#endif
