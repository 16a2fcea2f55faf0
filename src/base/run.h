/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_RUN_H
#define BASE_RUN_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "base/base.h"

/*
 * A request from outside to stop a long computation, and a record of what it left incomplete.
 *
 * Before each unit of work (one analysis, one Newton step, one box of a proof) the code calls
 * mt_interrupted and skips the unit where it returns true. That call also marks the current
 * phase as cut, so callers need not pass the interruption up. A phase that is not marked is
 * complete. Once true, mt_interrupted stays true in that phase.
 */
enum { MT_INTERRUPT_PHASES = 16 };
/* From this matrix order on, one step of our own decompositions is a unit of work; smaller
 * decompositions run without a check. */
enum { MT_INTERRUPT_ORDER = 128 };

typedef struct mt_interrupt {
    /* returns an mt_stop_request; called by all workers; NULL: never stop */
    int (*request)(void *context);
    /* returns an mt_stop_reason, called after a request; NULL: MT_STOP_REASON_INTERRUPT */
    int (*cause)(void *context);
    void *context; /* of both callbacks */
    /* the interrupt of the computation that contains this one, or NULL: its requests apply
     * here, and a cut here is a cut there */
    struct mt_interrupt *whole;
    /* current phase, below MT_INTERRUPT_PHASES; changed while no worker runs */
    int phase;
    bool makes_ready; /* this phase continues until MT_STOP_REQUEST_END */
    /* the current part of the phase outlasts a time limit and ends only at an interrupt; set
     * while no worker runs */
    atomic_bool needed;
    atomic_int level; /* the strongest request so far */
    atomic_uint cut;  /* bit k: phase k is not complete */
} mt_interrupt;

/* Zeroed except for the request or the whole (either may be NULL). */
void mt_interrupt_init(mt_interrupt *i, int (*request)(void *context), void *context,
                       mt_interrupt *whole);
/* Begin a phase. */
void mt_interrupt_enter(mt_interrupt *i, int phase, bool makes_ready);
/* True where the next unit of work is to be skipped; marks the phase as cut. NULL: false. Any
 * thread. */
bool mt_interrupted(mt_interrupt *i);
/* mt_interrupted as a status: MT_E_INTERRUPTED. */
mt_status mt_interrupt_check(mt_interrupt *i, mt_err *err);
/* Mark a phase as not complete, for one that was not begun. */
void mt_interrupt_cut(mt_interrupt *i, int phase);
bool mt_interrupt_is_cut(const mt_interrupt *i, int phase);
/* Reason of the cut, an mt_stop_reason, taken from the outermost computation. NULL:
 * MT_STOP_REASON_INTERRUPT. */
int mt_interrupt_reason(const mt_interrupt *i);
/* True where any phase is cut. */
bool mt_interrupt_any(const mt_interrupt *i);

/*
 * The stages of an evaluation, in order. A stage is computed again only where a value that it
 * depends on has changed since its last computation; otherwise it is skipped, because it would
 * give the same bits.
 */
#define MT_STAGE_LIST(X)                                                 \
    X(PROGRAM, "program", "numbers of the model from the inputs")        \
    X(GEOMETRY, "geometry", "positions, constraints, rows of the terms") \
    X(TANGENT, "tangent", "derivatives of these")                        \
    X(REDUCTION, "reduction", "basis of the freedoms, reduced rows")     \
    X(STIFFNESS, "stiffness", "reduced stiffness matrix")                \
    X(MASS, "mass", "reduced mass matrix")                               \
    X(MODES, "modes", "factor of the mass, eigenvalues, shapes, bounds")

#define MT_STAGE_ID(id, name, text) MT_STAGE_##id,
typedef enum mt_stage_id { MT_STAGE_LIST(MT_STAGE_ID) MT_STAGES } mt_stage_id;
#undef MT_STAGE_ID

/* Work of one evaluator. */
typedef struct mt_stage_counts {
    long done[MT_STAGES];
    long shared[MT_STAGES]; /* taken from another evaluator of the same worker */
    long skipped[MT_STAGES];
    double seconds[MT_STAGES]; /* 0 without a clock */
} mt_stage_counts;

/* Work of all evaluators of a model, any number of workers. */
typedef struct mt_profile {
    double (*clock_s)(void); /* CPU time of the thread [s] */
    atomic_long done[MT_STAGES];
    atomic_long shared[MT_STAGES];
    atomic_long skipped[MT_STAGES];
    atomic_llong nanoseconds[MT_STAGES];
} mt_profile;

void mt_profile_init(mt_profile *p, double (*clock_s)(void));
/* Add the work of an evaluator; p NULL: does nothing. */
void mt_profile_add(mt_profile *p, const mt_stage_counts *counts);
/* CPU time of the thread [s] where p has a clock; otherwise 0. */
double mt_profile_now(const mt_profile *p);
/* Name ("geometry") and description of a stage. */
const char *mt_stage_name(mt_stage_id stage);
const char *mt_stage_text(mt_stage_id stage);

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
    long solutions;   /* modal solutions, of designs and others (base/run.h) */
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

/*
 * Counts of the work done, by phase, counted where a unit of work is done. Work of an earlier
 * run that is read from its record is added by the reader, so the sums are those of an
 * uninterrupted run.
 */
typedef enum mt_work_kind {
    MT_WORK_DESIGNS,   /* evaluations in all configurations */
    MT_WORK_POSITIONS, /* positions of a drive beyond the named ones */
    /* modal solutions of one configuration at a design, a position or a tolerance corner,
     * without those for named modes along a path */
    MT_WORK_MODAL,
    MT_WORK_MULTIPLICATIONS, /* multiplications of proofs, approximately */
    MT_WORK_KINDS
} mt_work_kind;

typedef struct mt_work_counters {
    int phase; /* below MT_INTERRUPT_PHASES; changed while no worker runs */
    atomic_long count[MT_INTERRUPT_PHASES][MT_WORK_KINDS];
} mt_work_counters;

void mt_work_counters_init(mt_work_counters *s);
/* Copy counts and phase. */
void mt_work_counters_copy(const mt_work_counters *from, mt_work_counters *to);
/* Add n in the current phase; any thread. s NULL: does nothing. */
void mt_work_counters_note(mt_work_counters *s, mt_work_kind kind, long n);
/* Count of one phase; of all phases. */
long mt_work_counters_in(const mt_work_counters *s, int phase, mt_work_kind kind);
long mt_work_counters_of(const mt_work_counters *s, mt_work_kind kind);

/* A background thread with a small stack. */
typedef struct mt_ticker {
    /* waits as long as needed, then does one turn; false ends the thread */
    bool (*turn)(void *context);
    void *context;
    pthread_t thread;
} mt_ticker;

/* Start the thread, which calls turn until it returns false; t must not move until
 * mt_ticker_join. False where the system has no thread. */
bool mt_ticker_start(mt_ticker *t, bool (*turn)(void *context), void *context);
/* Wait for the end of the thread; the caller has made turn return false. */
void mt_ticker_join(mt_ticker *t);

/*
 * The mutable state that a long computation shares with its caller, besides model and study,
 * which it only reads. The caller makes one, passes it down, and keeps it until the computation
 * ends; the computation checks it for requests to stop and reports to it. Every member may be
 * NULL. Any number of runs may use one model or study at once.
 */
typedef struct mt_run {
    mt_interrupt *interrupt; /* checked before each unit of work; NULL: never stopped */
    mt_progress *progress;   /* NULL: not reported */
    mt_work_counters *work;  /* counts of the work done; NULL: not counted */
    mt_profile *profile;     /* stages of the evaluations; NULL: not measured */
    const struct mt_task_path *tasks; /* position of task lists (base/workers.h); NULL: none */
} mt_run;

/* All members NULL: a run that is never stopped and not reported. */
extern const mt_run mt_run_none;

/* run, or mt_run_none where it is NULL. */
static inline const mt_run *mt_run_or_none(const mt_run *run)
{
    return run != NULL ? run : &mt_run_none;
}

#endif
