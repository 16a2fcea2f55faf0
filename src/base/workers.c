/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tasks shared among workers, and records of what they found. */
#include "base/workers.h"

#include <limits.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"

/* Records. */

enum { FIRST_ROOM = 64, WORD = sizeof(uint64_t) };

_Static_assert(sizeof(double) == WORD, "a number is one word");

mt_serializer mt_serializer_of(const uint64_t *words, size_t n)
{
    mt_serializer t = {.n = n, .reads = true};
    memcpy(&t.words, &words, sizeof words); /* only read: the qualifier goes, the words stay */
    return t;
}

void mt_serializer_free(mt_serializer *t)
{
    if (!t->reads) {
        free(t->words);
    }
    *t = (mt_serializer){.words = NULL};
}

bool mt_serializer_is_read(const mt_serializer *t)
{
    return t->reads && !t->failed && t->at == t->n;
}

/* The next word; 0 where there is none. */
static uint64_t get(mt_serializer *t)
{
    if (t->failed || t->at >= t->n) {
        t->failed = true;
        return 0;
    }
    return t->words[t->at++];
}

static void append_word(mt_serializer *t, uint64_t word)
{
    if (t->n == t->room && !t->failed) {
        const size_t room = t->room > 0 ? 2 * t->room : FIRST_ROOM;
        uint64_t *const words =
            room > SIZE_MAX / WORD ? NULL : realloc(t->words, room * sizeof *words);
        t->failed = words == NULL;
        t->no_memory = words == NULL;
        t->words = words != NULL ? words : t->words;
        t->room = words != NULL ? room : t->room;
    }
    if (!t->failed) {
        t->words[t->n++] = word;
    }
}

void mt_serializer_numbers(mt_serializer *t, size_t n, double *x)
{
    for (size_t i = 0; i < n && !t->failed; i++) {
        uint64_t word = 0;
        if (t->reads) {
            word = get(t);
            memcpy(&x[i], &word, sizeof word);
        } else {
            memcpy(&word, &x[i], sizeof word);
            append_word(t, word);
        }
    }
}

void mt_serializer_long(mt_serializer *t, long *x, long least, long most)
{
    if (!t->reads) {
        append_word(t, (uint64_t)*x);
        return;
    }
    const uint64_t word = get(t);
    long value = 0;
    memcpy(&value, &word, sizeof value);
    t->failed = t->failed || value < least || value > most;
    *x = t->failed ? least : value;
}

void mt_serializer_int(mt_serializer *t, int *x, int least, int most)
{
    long value = *x;
    mt_serializer_long(t, &value, least, most);
    *x = (int)value;
}

void mt_serializer_flag(mt_serializer *t, bool *x)
{
    int value = !t->reads && *x ? 1 : 0;
    mt_serializer_int(t, &value, 0, 1);
    *x = value != 0;
}

void *mt_serializer_items(mt_serializer *t, int *n, size_t size, void *items, mt_arena *mem)
{
    mt_serializer_int(t, n, 0, INT_MAX);
    if (!t->reads) {
        return items;
    }
    t->failed = t->failed || (size_t)*n > t->n - t->at;
    void *const own = t->failed ? NULL : mt_arena_alloc(mem, (size_t)*n, size);
    t->failed = own == NULL;
    return own;
}

void mt_serializer_text(mt_serializer *t, const char **text, mt_arena *mem)
{
    int n = !t->reads && *text != NULL ? (int)strlen(*text) + 1 : 0; /* with its NUL; 0: NULL */
    mt_serializer_int(t, &n, 0, INT_MAX);
    const size_t words = ((size_t)n + WORD - 1) / WORD;
    char *own = NULL;
    if (t->reads) {
        t->failed = t->failed || words > t->n - t->at;
        own = t->failed || n == 0 ? NULL : mt_arena_alloc(mem, words, WORD);
        t->failed = t->failed || (n > 0 && own == NULL);
    }
    for (size_t i = 0; i < words && !t->failed; i++) {
        const size_t left = (size_t)n - (i * WORD);
        const size_t size = left < WORD ? left : WORD;
        uint64_t word = 0;
        if (own != NULL) {
            uint64_t kept = 0;
            word = get(t);
            memcpy(own + (i * WORD), &word, size);
            memcpy(&kept, own + (i * WORD), size);
            t->failed = t->failed || kept != word; /* behind the text there is nothing */
        } else if (*text != NULL) {
            memcpy(&word, *text + (i * WORD), size);
            append_word(t, word);
        }
    }
    if (t->reads) {
        t->failed = t->failed || (own != NULL && memchr(own, '\0', (size_t)n) != own + n - 1);
        *text = t->failed ? NULL : own;
    }
}

/* Workers. */

typedef struct pool {
    pthread_mutex_t lock;
    int next; /* first task not taken yet */
    const mt_tasks *tasks;
    const mt_task_path *task_path; /* of the list; NULL: nowhere */
    mt_progress *progress;
    bool told;  /* the list is a step of it */
    bool *left; /* [n] not to be done, or NULL: none */
    int failed; /* lowest task that failed; n: none */
    mt_status rc;
    mt_err err;
} pool;

typedef struct worker {
    pool *pool;
    pthread_t thread;
    int number;
    bool started;
} worker;

static mt_status make_lock(pthread_mutex_t *lock, mt_err *err)
{
    return pthread_mutex_init(lock, NULL) == 0
               ? MT_OK
               : mt_fail(err, MT_E_SYSTEM, "a lock cannot be made");
}

mt_status mt_checkpoint_store_init(mt_checkpoint_store *store, mt_err *err)
{
    *store = (mt_checkpoint_store){.part = 0};
    return make_lock(&store->lock, err);
}

void mt_checkpoint_store_free(mt_checkpoint_store *store)
{
    (void)pthread_mutex_destroy(&store->lock);
}

static const uint64_t *find_stored(mt_checkpoint_store *store, const char *key, size_t *n)
{
    (void)pthread_mutex_lock(&store->lock);
    const uint64_t *const words = store->find(store->context, key, n);
    (void)pthread_mutex_unlock(&store->lock);
    return words;
}

static void put_stored(mt_checkpoint_store *store, const char *key,
                       const mt_serializer *serializer)
{
    (void)pthread_mutex_lock(&store->lock);
    store->put(store->context, key, serializer->words, serializer->n);
    (void)pthread_mutex_unlock(&store->lock);
}

mt_task_path mt_task_path_enter(const mt_task_path *whole, const char *name)
{
    mt_task_path s = {.store = NULL};
    if (whole == NULL) {
        return s;
    }
    s.progress = whole->progress;
    if (whole->store == NULL) {
        return s;
    }
    const char *const slash = whole->path[0] == '\0' ? "" : "/";
    s.store = whole->store;
    s.interrupt = whole->interrupt;
    s.inner = whole->inner;
    const int n = mt_snprintf(s.path, sizeof s.path, "%s%s%s", whole->path, slash, name);
    s.store = n >= 0 && n < MT_KEY_SIZE ? s.store : NULL;
    return s;
}

static mt_task_path path_of_task(const mt_task_path *list, int task)
{
    char name[16]; /* the digits of an int */
    (void)mt_snprintf(name, sizeof name, "%d", task);
    mt_task_path s = mt_task_path_enter(list, name);
    s.inner = true;
    return s;
}

static int take_next_task(pool *p)
{
    (void)pthread_mutex_lock(&p->lock);
    while (p->next < p->tasks->n && p->left != NULL && p->left[p->next]) {
        mt_progress_done(p->progress, p->told);
        p->next++;
    }
    const int task = p->next < p->tasks->n ? p->next++ : -1;
    (void)pthread_mutex_unlock(&p->lock);
    return task;
}

static void note_failure(pool *p, int task, mt_status rc, const mt_err *err)
{
    (void)pthread_mutex_lock(&p->lock);
    if (task < p->failed) {
        p->failed = task;
        p->rc = rc;
        p->err = *err;
    }
    (void)pthread_mutex_unlock(&p->lock);
}

/* Store the result of the task at s. A lack of memory is a failure: otherwise a part of a run
 * would be reported as done without it. */
static mt_status store_task_result(const mt_tasks *tasks, int task, const mt_task_path *s,
                                   mt_err *err)
{
    mt_serializer serializer = {.words = NULL};
    bool no_memory = false;
    if (s->interrupt == NULL || !mt_interrupt_any(s->interrupt)) {
        tasks->serializer(tasks->context, task, &serializer);
        if (!serializer.failed) {
            put_stored(s->store, s->path, &serializer);
        }
        no_memory = serializer.no_memory;
    }
    mt_serializer_free(&serializer);
    return no_memory ? mt_fail_memory(err) : MT_OK;
}

static void *work(void *argument)
{
    worker *const w = argument;
    const mt_tasks *const tasks = w->pool->tasks;
    for (int task = take_next_task(w->pool); task >= 0; task = take_next_task(w->pool)) {
        mt_err err = {0};
        const mt_task_path own = path_of_task(w->pool->task_path, task);
        const bool kept = tasks->serializer != NULL && own.store != NULL;
        mt_task_path inner = own;
        inner.store = kept ? NULL : own.store;
        mt_status rc = tasks->run(tasks->context, w->number, task, &inner, &err);
        rc = rc == MT_OK && kept ? store_task_result(tasks, task, &own, &err) : rc;
        if (rc != MT_OK) {
            note_failure(w->pool, task, rc, &err);
        }
        mt_progress_done(w->pool->progress, w->pool->told);
    }
    return NULL;
}

/* Find the tasks to leave out: those with known records, and those of other parts; *missing:
 * some are left to other parts. */
static mt_status look_up(pool *p, bool *missing, mt_err *err)
{
    const mt_tasks *const tasks = p->tasks;
    mt_checkpoint_store *const store = p->task_path->store;
    p->left = calloc((size_t)tasks->n + 1, sizeof *p->left);
    if (p->left == NULL) {
        return mt_fail_memory(err);
    }
    for (int k = 0; k < tasks->n; k++) {
        const mt_task_path own = path_of_task(p->task_path, k);
        size_t n = 0;
        const uint64_t *const words = tasks->serializer == NULL || own.store == NULL
                                          ? NULL
                                          : find_stored(store, own.path, &n);
        if (words != NULL) {
            mt_serializer serializer = mt_serializer_of(words, n);
            tasks->serializer(tasks->context, k, &serializer);
            p->left[k] = mt_serializer_is_read(&serializer);
        }
        if (!p->left[k] && !p->task_path->inner && store->parts > 0) {
            p->left[k] = k % store->parts != store->part - 1;
            *missing = *missing || p->left[k];
        }
    }
    return MT_OK;
}

static void run_all(int workers, pool *p)
{
    worker list[MT_WORKERS_MOST] = {{.pool = p}};
    int n = workers < p->tasks->n ? workers : p->tasks->n;
    n = n < 1 ? 1 : (n > MT_WORKERS_MOST ? MT_WORKERS_MOST : n);
    for (int i = 1; i < n; i++) {
        list[i] = (worker){.pool = p, .number = i};
        list[i].started = pthread_create(&list[i].thread, NULL, work, &list[i]) == 0;
    }
    (void)work(&list[0]);
    for (int i = 1; i < n; i++) {
        if (list[i].started) {
            (void)pthread_join(list[i].thread, NULL);
        }
    }
}

mt_status mt_workers_run(int workers, mt_task_path *task_path, const mt_tasks *tasks,
                         mt_err *err)
{
    pool p = {.tasks = tasks, .failed = tasks->n, .rc = MT_OK};
    mt_task_path list = {.store = NULL};
    bool missing = false;
    if (task_path != NULL && task_path->store != NULL) {
        char name[16]; /* the digits of an int */
        (void)mt_snprintf(name, sizeof name, "%d", task_path->lists++);
        list = mt_task_path_enter(task_path, name);
    }
    if (list.store != NULL) {
        p.task_path = &list;
        MT_TRY(look_up(&p, &missing, err));
    }
    mt_status rc = make_lock(&p.lock, err);
    if (rc == MT_OK) {
        p.progress = task_path == NULL ? NULL : task_path->progress;
        p.told = mt_progress_begin(p.progress, tasks->unit, tasks->n);
        run_all(workers, &p);
        mt_progress_end(p.progress, p.told);
        (void)pthread_mutex_destroy(&p.lock);
        rc = p.rc;
        if (rc != MT_OK && err != NULL) {
            *err = p.err;
        }
    }
    free(p.left);
    return rc != MT_OK || !missing
               ? rc
               : mt_fail(err, MT_E_INTERRUPTED, "the rest of the tasks is left to other parts");
}

mt_status mt_lock_init(mt_lock *lock, mt_err *err)
{
    lock->made = pthread_mutex_init(&lock->mutex, NULL) == 0;
    return lock->made ? MT_OK : mt_fail_memory(err);
}

void mt_lock_free(mt_lock *lock)
{
    if (lock->made) {
        (void)pthread_mutex_destroy(&lock->mutex);
        lock->made = false;
    }
}

void mt_lock_take(mt_lock *lock)
{
    if (lock->made) {
        (void)pthread_mutex_lock(&lock->mutex);
    }
}

void mt_lock_release(mt_lock *lock)
{
    if (lock->made) {
        (void)pthread_mutex_unlock(&lock->mutex);
    }
}
