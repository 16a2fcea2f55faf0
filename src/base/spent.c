/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/spent.h"

void mt_spent_init(mt_spent *s)
{
    s->phase = 0;
    for (int i = 0; i < MT_INTERRUPT_PHASES; i++) {
        for (int k = 0; k < MT_SPENT_KINDS; k++) {
            atomic_init(&s->count[i][k], 0);
        }
    }
}

void mt_spent_copy(const mt_spent *from, mt_spent *to)
{
    to->phase = from->phase;
    for (int i = 0; i < MT_INTERRUPT_PHASES; i++) {
        for (int k = 0; k < MT_SPENT_KINDS; k++) {
            atomic_init(&to->count[i][k], mt_spent_in(from, i, (mt_spent_kind)k));
        }
    }
}

void mt_spent_note(mt_spent *s, mt_spent_kind kind, long n)
{
    if (s != NULL) {
        (void)atomic_fetch_add_explicit(&s->count[s->phase][kind], n, memory_order_relaxed);
    }
}

long mt_spent_in(const mt_spent *s, int phase, mt_spent_kind kind)
{
    return atomic_load_explicit(&s->count[phase][kind], memory_order_relaxed);
}

long mt_spent_of(const mt_spent *s, mt_spent_kind kind)
{
    long sum = 0;
    for (int i = 0; i < MT_INTERRUPT_PHASES; i++) {
        sum += mt_spent_in(s, i, kind);
    }
    return sum;
}
