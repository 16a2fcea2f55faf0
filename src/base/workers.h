/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_WORKERS_H
#define BASE_WORKERS_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/arena.h"
#include "base/base.h"
#include "base/run.h"

/*
 * A record as a list of 64-bit words. One function lists the members of a struct, and the same
 * function writes or reads them, so the two directions cannot differ. Numbers keep their bits.
 * Input is not trusted: a missing word or a word out of its range sets `failed`, and nothing
 * more is read; the caller checks mt_serializer_is_read at the end, before it uses anything it
 * read.
 */
typedef struct mt_serializer {
    uint64_t *words; /* heap and owned when writing; borrowed when reading */
    size_t n;
    size_t room;
    size_t at; /* next word to be read */
    bool reads;
    bool failed; /* reading failed, or the value to be written is not a valid record */
    /* writing ran out of memory, which does not say whether the value is a valid record */
    bool no_memory;
} mt_serializer;

mt_serializer mt_serializer_of(const uint64_t *words, size_t n); /* for reading */
void mt_serializer_free(mt_serializer *t);
/* True where all words were read and none is missing. */
bool mt_serializer_is_read(const mt_serializer *t);

void mt_serializer_numbers(mt_serializer *t, size_t n, double *x);
void mt_serializer_long(mt_serializer *t, long *x, long least, long most);
void mt_serializer_int(mt_serializer *t, int *x, int least, int most);
void mt_serializer_flag(mt_serializer *t, bool *x);
/* NULL is a valid text; a text that is read is in mem. */
void mt_serializer_text(mt_serializer *t, const char **text, mt_arena *mem);
/* Reading: zeroed room in mem for the *n items of `size` bytes that follow, each at least one
 * word; writing: returns items. NULL: none. */
void *mt_serializer_items(mt_serializer *t, int *n, size_t size, void *items, mt_arena *mem);

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

/* For data that several workers share and change. A lock that could not be made does nothing:
 * mt_lock_init tells. */
typedef struct mt_lock {
    pthread_mutex_t mutex;
    bool made;
} mt_lock;
/* Fails: MT_E_MEMORY. */
mt_status mt_lock_init(mt_lock *lock, mt_err *err);
/* Accepts a zeroed lock. */
void mt_lock_free(mt_lock *lock);
void mt_lock_take(mt_lock *lock);
void mt_lock_release(mt_lock *lock);

#endif
