/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANSWER_SOLVE_H
#define ANSWER_SOLVE_H

#include "base/run.h"
#include "base/workers.h"
#include "study/study.h"

/* Called before a proof that may take long, with the answer so far (status "interrupted"),
 * which the caller may keep in case the run is killed. */
typedef struct mt_incumbent_callback {
    mt_status (*tell)(void *context, mt_result *so_far, mt_err *err);
    void *context;
} mt_incumbent_callback;

/*
 * mt_study_solve within a run (NULL: none). run->tasks: the path of its tasks; their store
 * holds what earlier runs of the same study completed and receives what this one completes. The
 * result does not depend on the store's content. Where the store selects a part of the work
 * (parts > 0) there is no answer: the tasks are in the store, and *out has what is known
 * without them. incumbent may be NULL. Fails also: as incumbent->tell.
 */
mt_status mt_study_solve_with(const mt_study *study, const mt_solve_options *opt,
                              const mt_run *run, const mt_incumbent_callback *incumbent,
                              mt_result **out, mt_err *err);

#endif
