/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/workers.h"
#include "support/mt_test.h"

enum { TASKS = 1000 };

typedef struct job {
    int done[TASKS];
    int worker_seen[MT_WORKERS_MOST];
    int fail_from;
} job;

static mt_status square(void *context, int worker, int task, mt_err *err)
{
    job *const j = context;
    j->done[task] += task * task;
    j->worker_seen[worker] = 1;
    if (j->fail_from > 0 && task >= j->fail_from) {
        return mt_fail(err, MT_E_DOMAIN, "task %d", task);
    }
    return MT_OK;
}

static void workers__every_task_is_done_once_whatever_their_number(mt_test *t)
{
    static const int counts[] = {1, 2, 8, 64, 1000};
    for (int c = 0; c < MT_COUNT(counts); c++) {
        job j = {0};
        int wrong = 0;
        mt_test_row(t, c == 0 ? "one" : "several");
        CHECK_INT(t, mt_workers_run(counts[c], TASKS, square, &j, NULL), MT_OK);
        for (int i = 0; i < TASKS; i++) {
            wrong += j.done[i] != i * i ? 1 : 0;
        }
        CHECK_INT(t, wrong, 0);
    }
}

static void workers__the_lowest_failing_task_is_reported(mt_test *t)
{
    for (int round = 0; round < 20; round++) {
        job j = {.fail_from = 17};
        mt_err err = {0};
        CHECK_INT(t, mt_workers_run(4, TASKS, square, &j, &err), MT_E_DOMAIN);
        CHECK_STR(t, err.text, "task 17");
        CHECK_INT(t, j.done[TASKS - 1], (TASKS - 1) * (TASKS - 1));
    }
}

static void workers__no_task_is_fine(mt_test *t)
{
    job j = {0};
    CHECK_INT(t, mt_workers_run(4, 0, square, &j, NULL), MT_OK);
}

MT_TEST_MAIN(MT_TEST(workers__every_task_is_done_once_whatever_their_number),
             MT_TEST(workers__the_lowest_failing_task_is_reported),
             MT_TEST(workers__no_task_is_fine))
