/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/workers.h"

#include <pthread.h>
#include <stdbool.h>

typedef struct pool {
    pthread_mutex_t lock;
    int next; /* first task not taken yet */
    int n_tasks;
    mt_task task;
    void *context;
    int failed; /* lowest task that failed; n_tasks: none */
    mt_status rc;
    mt_err err;
} pool;

typedef struct worker {
    pool *pool;
    pthread_t thread;
    int number;
    bool started;
} worker;

static int take(pool *p)
{
    (void)pthread_mutex_lock(&p->lock);
    const int task = p->next < p->n_tasks ? p->next++ : -1;
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

static void *work(void *argument)
{
    worker *const w = argument;
    for (int task = take(w->pool); task >= 0; task = take(w->pool)) {
        mt_err err = {0};
        const mt_status rc = w->pool->task(w->pool->context, w->number, task, &err);
        if (rc != MT_OK) {
            note_failure(w->pool, task, rc, &err);
        }
    }
    return NULL;
}

mt_status mt_workers_run(int workers, int n_tasks, mt_task task, void *context, mt_err *err)
{
    worker list[MT_WORKERS_MOST];
    pool p = {
        .n_tasks = n_tasks, .task = task, .context = context, .failed = n_tasks, .rc = MT_OK};
    int n = workers < n_tasks ? workers : n_tasks;
    n = n < 1 ? 1 : (n > MT_WORKERS_MOST ? MT_WORKERS_MOST : n);
    if (pthread_mutex_init(&p.lock, NULL) != 0) {
        return mt_fail(err, MT_E_SYSTEM, "a lock cannot be made");
    }
    for (int i = 0; i < n; i++) {
        list[i] = (worker){.pool = &p, .number = i};
        list[i].started = i > 0 && pthread_create(&list[i].thread, NULL, work, &list[i]) == 0;
    }
    (void)work(&list[0]);
    for (int i = 1; i < n; i++) {
        if (list[i].started) {
            (void)pthread_join(list[i].thread, NULL);
        }
    }
    (void)pthread_mutex_destroy(&p.lock);
    if (p.rc != MT_OK && err != NULL) {
        *err = p.err;
    }
    return p.rc;
}
