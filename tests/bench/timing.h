/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Several things timed side by side: each round runs all of them in turn, so that what
 * disturbs the machine disturbs all alike, and each gets the median of its rounds, with the
 * spread beside it (the largest less the smallest). CPU time of the process.
 */
#ifndef TESTS_BENCH_TIMING_H
#define TESTS_BENCH_TIMING_H

#include "modetune/status.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { TIMING_ROUNDS = 9, TIMING_MOST_CALLS = 1 << 20 };

typedef struct timed {
    const char *what;
    void (*run)(void *context, int call); /* call: its number in the round */
    void *context;
    double median_s; /* of one call, out */
    double spread_s;
    int calls;  /* of a round */
    int rounds; /* fewer where one takes long */
    double round[TIMING_ROUNDS];
} timed;

/* CPU time of a round, and how many of them: shorter where a look will do. */
typedef struct timing {
    double round_s;
    int rounds; /* at most TIMING_ROUNDS */
    double most_s;
} timing;

static const timing TIMING_FULL = {0.02, TIMING_ROUNDS, 20.0};
static const timing TIMING_QUICK = {0.001, 3, 0.2};

static inline double timing_now_s(void)
{
    struct timespec t;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + (1e-9 * (double)t.tv_nsec);
}

static inline double timing_round_s(const timed *t)
{
    const double start = timing_now_s();
    for (int call = 0; call < t->calls; call++) {
        t->run(t->context, call);
    }
    return timing_now_s() - start;
}

static inline int timing_compare(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* How many calls make a round, and how many rounds there is time for. */
static inline void timing_prepare(const timing *how, timed *t)
{
    t->calls = 1;
    double first = timing_round_s(t); /* warms up, too */
    while (first < how->round_s && t->calls < TIMING_MOST_CALLS) {
        t->calls *= 2;
        first = timing_round_s(t);
    }
    const double room = how->most_s / first;
    t->rounds = room < 1.0 ? 1 : how->rounds;
    t->rounds = room < t->rounds ? (int)room : t->rounds;
}

static inline void timing_side_by_side(const timing *how, timed *things, int n)
{
    for (int i = 0; i < n; i++) {
        timing_prepare(how, &things[i]);
    }
    for (int round = 0; round < how->rounds; round++) {
        for (int i = 0; i < n; i++) {
            if (round < things[i].rounds) {
                things[i].round[round] = timing_round_s(&things[i]) / things[i].calls;
            }
        }
    }
    for (int i = 0; i < n; i++) {
        timed *const t = &things[i];
        qsort(t->round, (size_t)t->rounds, sizeof *t->round, timing_compare);
        t->median_s = t->round[t->rounds / 2];
        t->spread_s = t->round[t->rounds - 1] - t->round[0];
    }
}

/* A benchmark has nothing to say after a failure. */
static inline void stop(const char *what, mt_status rc, const mt_err *err)
{
    if (rc != MT_OK) {
        (void)fprintf(stderr, "%s: %s\n", what, err->text);
        exit(EXIT_FAILURE);
    }
}

#endif
