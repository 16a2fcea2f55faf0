/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_RUN_H
#define BASE_RUN_H

#include "base/interrupt.h"
#include "base/profile.h"
#include "base/progress.h"
#include "base/work_counters.h"

/*
 * A run: what long work shares with whoever conducts it, besides the model and the study, which
 * it only reads. The conductor makes one and hands it down; the work asks it whether to stop,
 * and reports to it. It outlives the work. Every member may be NULL. One model or study may be
 * worked on in any number of runs at once.
 */
typedef struct mt_run {
    mt_interrupt *interrupt;          /* asked before each unit of work; NULL: never stopped */
    mt_progress *progress;            /* told how far the work is; NULL: nobody listens */
    mt_work_counters *work;           /* what the work has cost; NULL: not counted */
    mt_profile *profile;              /* stages of the evaluations; NULL: not measured */
    const struct mt_task_path *tasks; /* where lists of tasks stand (base/workers.h) */
} mt_run;

/* A run that is never stopped and reports to nobody. */
extern const mt_run mt_run_none;

/* run, or mt_run_none where it is NULL. */
static inline const mt_run *mt_run_or_none(const mt_run *run)
{
    return run != NULL ? run : &mt_run_none;
}

#endif
