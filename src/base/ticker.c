/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/ticker.h"

#include <stddef.h>

enum { STACK = 1 << 20 };

static void *run_ticker(void *argument)
{
    const mt_ticker *const t = argument;
    while (t->turn(t->context)) {
    }
    return NULL;
}

bool mt_ticker_start(mt_ticker *t, bool (*turn)(void *context), void *context)
{
    pthread_attr_t how;
    *t = (mt_ticker){.turn = turn, .context = context};
    if (pthread_attr_init(&how) != 0) {
        return false;
    }
    (void)pthread_attr_setstacksize(&how, STACK);
    const bool made = pthread_create(&t->thread, &how, run_ticker, t) == 0;
    (void)pthread_attr_destroy(&how);
    return made;
}

void mt_ticker_join(mt_ticker *t)
{
    (void)pthread_join(t->thread, NULL);
}
