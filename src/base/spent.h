/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_SPENT_H
#define BASE_SPENT_H

#include <stdatomic.h>

#include "base/interrupt.h"

/*
 * What the work on a question has cost, by the phase of it: counted where a unit of work is
 * done, so that nobody has to hand it up. Work that an earlier run did, and that is read from
 * its record, is noted by who reads it: the sums are those of a run without a break.
 */
typedef enum mt_spent_kind {
    MT_SPENT_DESIGNS,   /* evaluated in all configurations */
    MT_SPENT_POSITIONS, /* of a drive, looked at beside those that are named */
    /* of one configuration each, at a design, a position or a corner of tolerances; without
     * what named modes take on the way */
    MT_SPENT_MODAL,
    MT_SPENT_MULTIPLICATIONS, /* of proofs, about */
    MT_SPENT_KINDS
} mt_spent_kind;

typedef struct mt_spent {
    int phase; /* below MT_INTERRUPT_PHASES; changed while no worker runs */
    atomic_long count[MT_INTERRUPT_PHASES][MT_SPENT_KINDS];
} mt_spent;

void mt_spent_init(mt_spent *s);
/* As much as `from` has, in its phase. */
void mt_spent_copy(const mt_spent *from, mt_spent *to);
/* So much more, in the present phase; any thread. NULL: nobody asks. */
void mt_spent_note(mt_spent *s, mt_spent_kind kind, long n);
/* In one phase; in all of them. */
long mt_spent_in(const mt_spent *s, int phase, mt_spent_kind kind);
long mt_spent_of(const mt_spent *s, mt_spent_kind kind);

#endif
