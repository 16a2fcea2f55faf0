/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/interrupt.h"

void mt_interrupt_init(mt_interrupt *i, int (*request)(void *context), void *context,
                       mt_interrupt *whole)
{
    i->request = request;
    i->cause = NULL;
    i->context = context;
    i->whole = whole;
    i->phase = 0;
    i->makes_ready = false;
    i->needed = false;
    atomic_init(&i->level, MT_STOP_REQUEST_NONE);
    atomic_init(&i->cut, 0U);
}

void mt_interrupt_enter(mt_interrupt *i, int phase, bool makes_ready)
{
    i->phase = phase;
    i->makes_ready = makes_ready;
}

/* The strongest request so far, asked again until it cannot become stronger. Parts have no
 * request of their own: that of the outermost computation applies. */
static int request_of(mt_interrupt *i)
{
    while (i->whole != NULL) {
        i = i->whole;
    }
    int had = atomic_load(&i->level);
    if (i->request != NULL && had < MT_STOP_REQUEST_END) {
        const int now = i->request(i->context);
        while (had < now && !atomic_compare_exchange_weak(&i->level, &had, now)) {
        }
    }
    return atomic_load(&i->level);
}

bool mt_interrupted(mt_interrupt *i)
{
    if (i == NULL ||
        request_of(i) < (i->makes_ready ? MT_STOP_REQUEST_END : MT_STOP_REQUEST_FINISH) ||
        (i->needed && mt_interrupt_reason(i) == MT_STOP_REASON_TIME_LIMIT)) {
        return false;
    }
    mt_interrupt_cut(i, i->phase);
    return true;
}

mt_status mt_interrupt_check(mt_interrupt *i, mt_err *err)
{
    return mt_interrupted(i) ? mt_fail(err, MT_E_INTERRUPTED, "interrupted") : MT_OK;
}

void mt_interrupt_cut(mt_interrupt *i, int phase)
{
    (void)atomic_fetch_or(&i->cut, 1U << (unsigned)phase);
    if (i->whole != NULL) {
        mt_interrupt_cut(i->whole, i->whole->phase);
    }
}

bool mt_interrupt_is_cut(const mt_interrupt *i, int phase)
{
    return (atomic_load(&i->cut) & (1U << (unsigned)phase)) != 0U;
}

int mt_interrupt_reason(const mt_interrupt *i)
{
    while (i != NULL && i->whole != NULL) {
        i = i->whole;
    }
    return i != NULL && i->cause != NULL ? i->cause(i->context) : MT_STOP_REASON_INTERRUPT;
}

bool mt_interrupt_any(const mt_interrupt *i)
{
    return atomic_load(&i->cut) != 0U;
}
