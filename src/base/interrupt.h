/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_INTERRUPT_H
#define BASE_INTERRUPT_H

#include <stdatomic.h>
#include <stdbool.h>

#include "base/base.h"

/*
 * The wish of somebody outside that a long piece of work end, and what of the work it cut.
 *
 * Whoever is about to begin a unit of work (one analysis, one Newton step, one box of a proof)
 * asks mt_interrupted first and leaves the unit undone where the answer is yes. The answer
 * itself notes the phase that it was given in: what was cut is known without anybody handing it
 * up, whatever the functions in between make of a unit that is missing. And where no answer was
 * yes, nothing is missing. Once yes, it stays so.
 */
enum { MT_INTERRUPT_PHASES = 16 };
/* From matrices of this order on, one of the steps that a decomposition of ours consists of is
 * a unit of work; smaller ones are done before anybody waits. */
enum { MT_INTERRUPT_ORDER = 128 };

typedef struct mt_interrupt {
    /* an mt_stop_request; called by all workers; NULL: none ever */
    int (*request)(void *context);
    /* an mt_stop_reason, asked after a wish; NULL: MT_STOP_REASON_INTERRUPT */
    int (*cause)(void *context);
    void *context; /* of both */
    /* NULL, or of the work that this is a part of: its wish is this one's, and where this is
     * cut it is */
    struct mt_interrupt *whole;
    /* that is being worked on, below MT_INTERRUPT_PHASES; changed while no worker runs */
    int phase;
    bool makes_ready; /* this phase goes on until MT_STOP_REQUEST_END */
    /* and now something that is worth more than a time limit, so until an interrupt's; changed
     * while no worker runs */
    bool needed;
    atomic_int level; /* the strongest wish so far */
    atomic_uint cut;  /* bit k: phase k is not complete */
} mt_interrupt;

/* Zeroed but for the wish, or for the whole (either may be NULL). */
void mt_interrupt_init(mt_interrupt *i, int (*request)(void *context), void *context,
                       mt_interrupt *whole);
/* The phase that begins. */
void mt_interrupt_enter(mt_interrupt *i, int phase, bool makes_ready);
/* True where the next unit of work is to be left undone; then the phase is cut. NULL: false.
 * Any thread. */
bool mt_interrupted(mt_interrupt *i);
/* The same as a status: MT_E_INTERRUPTED. */
mt_status mt_interrupt_check(mt_interrupt *i, mt_err *err);
/* Note that a phase is not complete (one that was not even begun). */
void mt_interrupt_cut(mt_interrupt *i, int phase);
bool mt_interrupt_is_cut(const mt_interrupt *i, int phase);
/* Why anything is cut, an mt_stop_reason: of the outermost work. NULL:
 * MT_STOP_REASON_INTERRUPT. */
int mt_interrupt_reason(const mt_interrupt *i);
/* Whether any phase is cut. */
bool mt_interrupt_any(const mt_interrupt *i);

#endif
