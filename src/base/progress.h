/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_PROGRESS_H
#define BASE_PROGRESS_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "base/base.h"

/*
 * How far a long piece of work is. Those who do it leave word here, from any thread; somebody
 * outside looks now and then (mt_progress_read), so that nobody who works waits for a terminal.
 *
 * The work has phases, a phase steps one after the other: "12 of 28 starts". A step that begins
 * while another one is open is a part of that one's work and is not told: it is enough to begin
 * and to end what may be outermost. What only counts is told wherever it happens. All functions
 * accept NULL: nobody listens.
 */
typedef struct mt_progress_mark {
    double cpu_s;     /* of who looks (mt_progress.clock); NaN: it has not happened */
    long evaluations; /* of designs until then */
} mt_progress_mark;

typedef struct mt_progress_view {
    const char *phase; /* NULL: none yet */
    /* counts what has begun, phases and steps of them, from 1; 0: none yet. A phase may come
     * again, a step does not: its time counts from where this changed. */
    long step;
    const char *unit; /* of what the step consists: "starts"; NULL: not in parts */
    long done;        /* of them */
    long total;       /* 0: not known */
    double share;     /* of the step, 0 to 1; NaN: not known */
    bool ended;       /* the step has */
    long evaluations; /* of designs */
    long solutions;   /* modal ones that these and others took (base/work_counters.h) */
    long boxes;       /* of proofs */
    const char *what; /* the objective that `best` is the value of; NULL: none yet */
    double best;
    mt_progress_mark first;   /* a design was known that meets all goals */
    mt_progress_mark best_at; /* the best so far was, but for its last digits */
    bool impossible;          /* it is proven that no design meets all goals */
    mt_progress_mark proof;   /* the last proof that has settled its question so far did */
} mt_progress_view;

typedef struct mt_progress {
    pthread_mutex_t lock; /* of `now`, but for what is counted */
    mt_progress_view now;
    /* CPU seconds so far, by who looks, who sets it before the work begins; asked when a mark
     * is made, by any thread. NULL: marks have no time */
    double (*clock)(void);
    double best_f;       /* what makes a design better is less */
    double marked;       /* the best at its mark */
    bool open;           /* a step is */
    atomic_bool designs; /* the phase looks for them */
    atomic_long done;
    atomic_long evaluations;
    atomic_long solutions;
    atomic_long boxes;
    atomic_int ppm; /* share of a step that is not counted, in millionths; -1: not known */
} mt_progress;

/* Fails: MT_E_SYSTEM; mt_progress_free follows where it does not. */
mt_status mt_progress_init(mt_progress *p, mt_err *err);
void mt_progress_free(mt_progress *p);

/* A phase begins, of a name that stays; not while a step is open. designs: it looks for
 * designs that meet the goals, the best of which is told. */
void mt_progress_phase(mt_progress *p, const char *name, bool designs);
/* A step of `total` units (0: how many is not known) begins. False: it is a part of another
 * one, and not told. */
bool mt_progress_begin(mt_progress *p, const char *unit, long total);
/* Of a step that was begun so (outermost: what mt_progress_begin said): one more unit is done;
 * or a share of it is, which never becomes less; or all of it, be it that some was left out. */
void mt_progress_done(mt_progress *p, bool outermost);
void mt_progress_share(mt_progress *p, bool outermost, double share);
void mt_progress_end(mt_progress *p, bool outermost);
/* A design was evaluated; n modal solutions were made; a box of a proof was looked at. */
void mt_progress_evaluated(mt_progress *p);
void mt_progress_solved(mt_progress *p, long n);
void mt_progress_boxed(mt_progress *p);
/* Whether the phase is one that looks for designs. */
bool mt_progress_seeks(mt_progress *p);
/* A design that meets all goals has the value f, which is made least, of an objective, shown
 * as `value`. */
void mt_progress_found(mt_progress *p, const char *what, double f, double value);
/* A proof settled its question; no design meets all goals, which is proven. */
void mt_progress_proved(mt_progress *p);
void mt_progress_impossible(mt_progress *p);

/* What is known now. */
mt_progress_view mt_progress_read(mt_progress *p);

#endif
