/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_WORK_COUNTERS_H
#define BASE_WORK_COUNTERS_H

#include <stdatomic.h>

#include "base/interrupt.h"

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

#endif
