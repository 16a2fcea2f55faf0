/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_RUN_H
#define BASE_RUN_H

#include "base/interrupt.h"
#include "base/profile.h"
#include "base/progress.h"
#include "base/work_counters.h"

/*
 * The mutable state that a long computation shares with its caller, besides model and study,
 * which it only reads. The caller makes one, passes it down, and keeps it until the computation
 * ends; the computation checks it for requests to stop and reports to it. Every member may be
 * NULL. Any number of runs may use one model or study at once.
 */
typedef struct mt_run {
    mt_interrupt *interrupt; /* checked before each unit of work; NULL: never stopped */
    mt_progress *progress;   /* NULL: not reported */
    mt_work_counters *work;  /* counts of the work done; NULL: not counted */
    mt_profile *profile;     /* stages of the evaluations; NULL: not measured */
    const struct mt_task_path *tasks; /* position of task lists (base/workers.h); NULL: none */
} mt_run;

/* All members NULL: a run that is never stopped and not reported. */
extern const mt_run mt_run_none;

/* run, or mt_run_none where it is NULL. */
static inline const mt_run *mt_run_or_none(const mt_run *run)
{
    return run != NULL ? run : &mt_run_none;
}

#endif
