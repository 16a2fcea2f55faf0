/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/workers.h"

#include <stdlib.h>

#include "base/format.h"

typedef struct pool {
    pthread_mutex_t lock;
    int next; /* first task not taken yet */
    const mt_tasks *tasks;
    const mt_scope *scope; /* of the list; NULL: nowhere */
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

mt_status mt_ledger_init(mt_ledger *ledger, mt_err *err)
{
    *ledger = (mt_ledger){.part = 0};
    return make_lock(&ledger->lock, err);
}

void mt_ledger_free(mt_ledger *ledger)
{
    (void)pthread_mutex_destroy(&ledger->lock);
}

static const uint64_t *find(mt_ledger *ledger, const char *key, size_t *n)
{
    (void)pthread_mutex_lock(&ledger->lock);
    const uint64_t *const words = ledger->find(ledger->context, key, n);
    (void)pthread_mutex_unlock(&ledger->lock);
    return words;
}

static void put(mt_ledger *ledger, const char *key, const mt_tape *tape)
{
    (void)pthread_mutex_lock(&ledger->lock);
    ledger->put(ledger->context, key, tape->words, tape->n);
    (void)pthread_mutex_unlock(&ledger->lock);
}

mt_scope mt_scope_in(const mt_scope *whole, const char *name)
{
    mt_scope s = {.ledger = NULL};
    if (whole == NULL) {
        return s;
    }
    s.progress = whole->progress;
    if (whole->ledger == NULL) {
        return s;
    }
    const char *const slash = whole->path[0] == '\0' ? "" : "/";
    s.ledger = whole->ledger;
    s.interrupt = whole->interrupt;
    s.inner = whole->inner;
    const int n = mt_snprintf(s.path, sizeof s.path, "%s%s%s", whole->path, slash, name);
    s.ledger = n >= 0 && n < MT_KEY_SIZE ? s.ledger : NULL;
    return s;
}

static mt_scope task_scope(const mt_scope *list, int task)
{
    char name[16]; /* the digits of an int */
    (void)mt_snprintf(name, sizeof name, "%d", task);
    mt_scope s = mt_scope_in(list, name);
    s.inner = true;
    return s;
}

static int take(pool *p)
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

/* What the task at s has left. One that has no room to be kept is not left out: a part of a run
 * would be told to be done without it. */
static mt_status keep(const mt_tasks *tasks, int task, const mt_scope *s, mt_err *err)
{
    mt_tape tape = {.words = NULL};
    bool no_memory = false;
    if (s->interrupt == NULL || !mt_interrupt_any(s->interrupt)) {
        tasks->tape(tasks->context, task, &tape);
        if (!tape.failed) {
            put(s->ledger, s->path, &tape);
        }
        no_memory = tape.no_memory;
    }
    mt_tape_free(&tape);
    return no_memory ? mt_fail_memory(err) : MT_OK;
}

static void *work(void *argument)
{
    worker *const w = argument;
    const mt_tasks *const tasks = w->pool->tasks;
    for (int task = take(w->pool); task >= 0; task = take(w->pool)) {
        mt_err err = {0};
        const mt_scope own = task_scope(w->pool->scope, task);
        const bool kept = tasks->tape != NULL && own.ledger != NULL;
        mt_scope inner = own;
        inner.ledger = kept ? NULL : own.ledger;
        mt_status rc = tasks->run(tasks->context, w->number, task, &inner, &err);
        rc = rc == MT_OK && kept ? keep(tasks, task, &own, &err) : rc;
        if (rc != MT_OK) {
            note_failure(w->pool, task, rc, &err);
        }
        mt_progress_done(w->pool->progress, w->pool->told);
    }
    return NULL;
}

/* Which tasks are left out: those that are known, and those of other parts: *missing. */
static mt_status look_up(pool *p, bool *missing, mt_err *err)
{
    const mt_tasks *const tasks = p->tasks;
    mt_ledger *const ledger = p->scope->ledger;
    p->left = calloc((size_t)tasks->n + 1, sizeof *p->left);
    if (p->left == NULL) {
        return mt_fail_memory(err);
    }
    for (int k = 0; k < tasks->n; k++) {
        const mt_scope own = task_scope(p->scope, k);
        size_t n = 0;
        const uint64_t *const words =
            tasks->tape == NULL || own.ledger == NULL ? NULL : find(ledger, own.path, &n);
        if (words != NULL) {
            mt_tape tape = mt_tape_of(words, n);
            tasks->tape(tasks->context, k, &tape);
            p->left[k] = mt_tape_is_read(&tape);
        }
        if (!p->left[k] && !p->scope->inner && ledger->parts > 0) {
            p->left[k] = k % ledger->parts != ledger->part - 1;
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

mt_status mt_workers_run(int workers, mt_scope *scope, const mt_tasks *tasks, mt_err *err)
{
    pool p = {.tasks = tasks, .failed = tasks->n, .rc = MT_OK};
    mt_scope list = {.ledger = NULL};
    bool missing = false;
    if (scope != NULL && scope->ledger != NULL) {
        char name[16]; /* the digits of an int */
        (void)mt_snprintf(name, sizeof name, "%d", scope->lists++);
        list = mt_scope_in(scope, name);
    }
    if (list.ledger != NULL) {
        p.scope = &list;
        MT_TRY(look_up(&p, &missing, err));
    }
    mt_status rc = make_lock(&p.lock, err);
    if (rc == MT_OK) {
        p.progress = scope == NULL ? NULL : scope->progress;
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
