/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Fails allocations by the place that asks for them. Arenas hand out most memory without asking
 * the system for it, so failing the k-th allocation of the system seldom meets a given check.
 * Here every function of base/arena.h that hands out memory is replaced by the linker (--wrap,
 * for programs named test_*_sites), which knows its caller by the return address: a first run
 * notes all places, then each is made to fail once; what an earlier run of the program had
 * refused need not be refused again. Where frames can be walked (instrumented builds,
 * MT_SITES_CALLERS) a place is known by the caller's callers, too, so that a refusal also comes
 * up every way that leads to it.
 *
 *     mt_sites_record();
 *     run();
 *     const int n = mt_sites_stop();
 *     for (int i = 0; i < n; i++) {
 *         if (mt_sites_known(i)) {
 *             continue;
 *         }
 *         mt_sites_fail(i);
 *         run() must fail, and leave nothing behind;
 *         mt_sites_stop();
 *     }
 */
#ifndef MT_SITES_H
#define MT_SITES_H

#include <stdbool.h>
#include <stddef.h>

enum { MT_SITES_MOST = 4096 };

/* Ask this about every request from here on, instead of all below; NULL: no more. */
void mt_sites_ask(bool (*refuses)(const void *caller, size_t size));
/* Forget all places and note those that ask from now on. One thread only. */
void mt_sites_record(void);
/* True where this place has been refused before. */
bool mt_sites_known(int i);
/* Let the first call from place i fail from now on. */
void mt_sites_fail(int i);
/* Note and fail nothing more; the number of places noted. */
int mt_sites_stop(void);
/* Has the place that was to fail been met? */
bool mt_sites_failed(void);

#endif
