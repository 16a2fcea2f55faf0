/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_WORKERS_H
#define BASE_WORKERS_H

#include <pthread.h>

#include "base/interrupt.h"
#include "base/progress.h"
#include "base/serializer.h"

enum { MT_WORKERS_MOST = 64, MT_KEY_SIZE = 128 };

/*
 * What earlier runs of the same question have left of their tasks, and where this one leaves
 * its own. A key is a path of names and numbers, the same in every run; a record the words of a
 * tape. Calls come from any thread, one at a time.
 */
typedef struct mt_checkpoint_store {
    pthread_mutex_t lock;
    /* The record of a key, which stays until the end; NULL: not known. */
    const uint64_t *(*find)(void *context, const char *key, size_t *n);
    void (*put)(void *context, const char *key, const uint64_t *words, size_t n);
    void *context;
    /* Of every list of tasks only number part - 1, part - 1 + parts, ... are done; 0: all. */
    int part;
    int parts;
} mt_checkpoint_store;
/* Zeroed but for its lock. Fails: MT_E_SYSTEM; mt_checkpoint_store_free follows where it does
 * not. */
mt_status mt_checkpoint_store_init(mt_checkpoint_store *store, mt_err *err);
void mt_checkpoint_store_free(mt_checkpoint_store *store);

/*
 * The place of a list of tasks in the whole work. Lists that begin one after the other in a
 * place have numbers; a task is a place, too, in which it may begin lists of its own.
 */
typedef struct mt_task_path {
    mt_checkpoint_store *store; /* NULL: nothing is known and nothing is kept */
    /* of the whole work: once anything of it is cut no task is kept, for the ones that follow
     * rest on what is missing */
    const mt_interrupt *interrupt;
    mt_progress *progress; /* of the whole work; NULL: nobody listens */
    char path[MT_KEY_SIZE];
    int lists;  /* begun so far */
    bool inner; /* of a task: whoever does that does all of it */
} mt_task_path;

/* A place in another one (NULL: nowhere, and so is this); keys that are too long are not
 * kept. */
mt_task_path mt_task_path_enter(const mt_task_path *whole, const char *name);

/*
 * Tasks 0 .. n - 1 shared out to workers. Which worker does which task, and in which order, is
 * open; so a task may only write what belongs to it (its slot of a result array) and use what
 * belongs to its worker (an evaluation context). What comes out then does not depend on the
 * number of workers.
 */
typedef struct mt_tasks {
    int n;
    /* own: the task's place, for the lists that it begins; nowhere where the task is kept as a
     * whole */
    mt_status (*run)(void *context, int worker, int task, mt_task_path *own, mt_err *err);
    /* What the task leaves, on tape; NULL: it is done in every run. Written by its worker, read
     * by the caller before any worker begins; one that fails to be read must leave the task to
     * be run as if it had not been tried. */
    void (*serializer)(void *context, int task, mt_serializer *serializer);
    void *context;
    const char *unit; /* what tasks are called where the progress is told */
} mt_tasks;

/* Do all tasks on `workers` threads (at least 1; the caller's own thread is worker 0), but for
 * those whose records are known. A task that fails does not stop the others; the failure of the
 * lowest task number is returned with its text. Where a thread cannot be started its share is
 * done by the others. scope: NULL: nowhere, and all of the work whatever part is asked for.
 * Fails: MT_E_INTERRUPTED where tasks are left to other parts; MT_E_MEMORY. */
mt_status mt_workers_run(int workers, mt_task_path *task_path, const mt_tasks *tasks,
                         mt_err *err);

#endif
