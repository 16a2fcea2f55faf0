/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_WORK_COUNTERS_H
#define BASE_WORK_COUNTERS_H

#include <stdatomic.h>

#include "base/interrupt.h"

/*
 * What the work on a question has cost, by the phase of it: counted where a unit of work is
 * done, so that nobody has to hand it up. Work that an earlier run did, and that is read from
 * its record, is noted by who reads it: the sums are those of a run without a break.
 */
typedef enum mt_work_kind {
    MT_WORK_DESIGNS,   /* evaluated in all configurations */
    MT_WORK_POSITIONS, /* of a drive, looked at beside those that are named */
    /* of one configuration each, at a design, a position or a corner of tolerances; without
     * what named modes take on the way */
    MT_WORK_MODAL,
    MT_WORK_MULTIPLICATIONS, /* of proofs, about */
    MT_WORK_KINDS
} mt_work_kind;

typedef struct mt_work_counters {
    int phase; /* below MT_INTERRUPT_PHASES; changed while no worker runs */
    atomic_long count[MT_INTERRUPT_PHASES][MT_WORK_KINDS];
} mt_work_counters;

void mt_work_counters_init(mt_work_counters *s);
/* As much as `from` has, in its phase. */
void mt_work_counters_copy(const mt_work_counters *from, mt_work_counters *to);
/* So much more, in the present phase; any thread. NULL: nobody asks. */
void mt_work_counters_note(mt_work_counters *s, mt_work_kind kind, long n);
/* In one phase; in all of them. */
long mt_work_counters_in(const mt_work_counters *s, int phase, mt_work_kind kind);
long mt_work_counters_of(const mt_work_counters *s, mt_work_kind kind);

#endif
