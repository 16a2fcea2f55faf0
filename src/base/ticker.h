/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_TICKER_H
#define BASE_TICKER_H

#include <pthread.h>
#include <stdbool.h>

/* A background thread with a small stack. */
typedef struct mt_ticker {
    /* waits as long as needed, then does one turn; false ends the thread */
    bool (*turn)(void *context);
    void *context;
    pthread_t thread;
} mt_ticker;

/* Start the thread, which calls turn until it returns false; t must not move until
 * mt_ticker_join. False where the system has no thread. */
bool mt_ticker_start(mt_ticker *t, bool (*turn)(void *context), void *context);
/* Wait for the end of the thread; the caller has made turn return false. */
void mt_ticker_join(mt_ticker *t);

#endif
