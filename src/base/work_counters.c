/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/work_counters.h"

void mt_work_counters_init(mt_work_counters *s)
{
    s->phase = 0;
    for (int i = 0; i < MT_INTERRUPT_PHASES; i++) {
        for (int k = 0; k < MT_WORK_KINDS; k++) {
            atomic_init(&s->count[i][k], 0);
        }
    }
}

void mt_work_counters_copy(const mt_work_counters *from, mt_work_counters *to)
{
    to->phase = from->phase;
    for (int i = 0; i < MT_INTERRUPT_PHASES; i++) {
        for (int k = 0; k < MT_WORK_KINDS; k++) {
            atomic_init(&to->count[i][k], mt_work_counters_in(from, i, (mt_work_kind)k));
        }
    }
}

void mt_work_counters_note(mt_work_counters *s, mt_work_kind kind, long n)
{
    if (s != NULL) {
        (void)atomic_fetch_add_explicit(&s->count[s->phase][kind], n, memory_order_relaxed);
    }
}

long mt_work_counters_in(const mt_work_counters *s, int phase, mt_work_kind kind)
{
    return atomic_load_explicit(&s->count[phase][kind], memory_order_relaxed);
}

long mt_work_counters_of(const mt_work_counters *s, mt_work_kind kind)
{
    long sum = 0;
    for (int i = 0; i < MT_INTERRUPT_PHASES; i++) {
        sum += mt_work_counters_in(s, i, kind);
    }
    return sum;
}
