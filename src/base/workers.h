/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_WORKERS_H
#define BASE_WORKERS_H

#include "base/base.h"

/*
 * Tasks 0 .. n_tasks - 1 shared out to workers. Which worker does which task, and in which
 * order, is open; so a task may only write what belongs to it (its slot of a result array) and
 * use what belongs to its worker (an evaluation context). What comes out then does not depend
 * on the number of workers.
 */
typedef mt_status (*mt_task)(void *context, int worker, int task, mt_err *err);

/* Run all tasks on `workers` threads (at least 1; the caller's own thread is worker 0). A task
 * that fails does not stop the others; the failure of the lowest task number is returned with
 * its text. Where a thread cannot be started its share is done by the others. No heap. */
mt_status mt_workers_run(int workers, int n_tasks, mt_task task, void *context, mt_err *err);

enum { MT_WORKERS_MOST = 64 };

#endif
