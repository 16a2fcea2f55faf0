/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_INTERRUPT_H
#define BASE_INTERRUPT_H

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
    /* the current part of the phase outlasts a time limit and ends only at an interrupt;
     * changed while no worker runs */
    bool needed;
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

#endif
