/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_TICKER_H
#define BASE_TICKER_H

#include <pthread.h>
#include <stdbool.h>

/* A thread beside those who work, with a small stack. */
typedef struct mt_ticker {
    /* Waits for as long as it likes, then does what is due; false: that was the last time. */
    bool (*turn)(void *context);
    void *context;
    pthread_t thread;
} mt_ticker;

/* Turn after turn until one is the last; t stays where it is until mt_ticker_join. False where
 * the system has no thread for it. */
bool mt_ticker_start(mt_ticker *t, bool (*turn)(void *context), void *context);
/* Wait for the last turn, which the caller has brought about. */
void mt_ticker_join(mt_ticker *t);

#endif
