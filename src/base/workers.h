/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_WORKERS_H
#define BASE_WORKERS_H

#include <pthread.h>

#include "base/interrupt.h"
#include "base/progress.h"
#include "base/serializer.h"

enum { MT_WORKERS_MOST = 64, MT_KEY_SIZE = 128 };

/*
 * Storage of task results between runs of the same question. A key is a path of names and
 * numbers, the same in every run; a record holds the words of a serializer. Calls come from any
 * thread, one at a time.
 */
typedef struct mt_checkpoint_store {
    pthread_mutex_t lock;
    /* the record of a key, valid until the end; NULL: not known */
    const uint64_t *(*find)(void *context, const char *key, size_t *n);
    void (*put)(void *context, const char *key, const uint64_t *words, size_t n);
    void *context;
    /* of every list, only tasks part - 1, part - 1 + parts, ... are run; 0: all */
    int part;
    int parts;
} mt_checkpoint_store;
/* Zeroed except for its lock. Fails: MT_E_SYSTEM. After success the caller calls
 * mt_checkpoint_store_free. */
mt_status mt_checkpoint_store_init(mt_checkpoint_store *store, mt_err *err);
void mt_checkpoint_store_free(mt_checkpoint_store *store);

/*
 * Position of a list of tasks in the whole computation, from which keys are made. Lists begun
 * one after the other at the same position are numbered; a task is a position as well and may
 * begin lists of its own.
 */
typedef struct mt_task_path {
    mt_checkpoint_store *store; /* NULL: no records are read or kept */
    /* of the whole computation: once any phase is cut, no further task is kept, because it may
     * depend on incomplete results */
    const mt_interrupt *interrupt;
    mt_progress *progress; /* of the whole computation; NULL: not reported */
    char path[MT_KEY_SIZE];
    int lists;  /* lists begun so far */
    bool inner; /* inside a task: all tasks of its lists are run, whatever `part` is */
} mt_task_path;

/* Position below `whole` (NULL: no position, and no records); records with keys that are too
 * long are not kept. */
mt_task_path mt_task_path_enter(const mt_task_path *whole, const char *name);

/*
 * Tasks 0 .. n - 1 shared among workers, in any order. A task may write only its own data (its
 * slot of a result array) and use only the data of its worker (an evaluation context). The
 * results then do not depend on the number of workers.
 */
typedef struct mt_tasks {
    int n;
    /* own: the task's position for lists that it begins; none where the task is kept as a
     * whole */
    mt_status (*run)(void *context, int worker, int task, mt_task_path *own, mt_err *err);
    /* Serializes the result of the task; NULL: the task runs in every run. Written by the
     * task's worker, read by the caller before any worker begins; a failed read must leave the
     * task as if it had not been tried. */
    void (*serializer)(void *context, int task, mt_serializer *serializer);
    void *context;
    const char *unit; /* name of the tasks in progress messages */
} mt_tasks;

/* Run all tasks on `workers` threads (at least 1; the caller's thread is worker 0), except
 * those with known records. A failing task does not stop the others; the failure of the lowest
 * task number is returned with its text. Where a thread cannot be started, the other workers do
 * its share. task_path NULL: no records, and all tasks run whatever `part` is. Fails:
 * MT_E_INTERRUPTED where tasks are left to other parts; MT_E_MEMORY. */
mt_status mt_workers_run(int workers, mt_task_path *task_path, const mt_tasks *tasks,
                         mt_err *err);

#endif
