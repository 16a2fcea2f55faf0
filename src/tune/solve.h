/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TUNE_SOLVE_H
#define TUNE_SOLVE_H

#include "tune/result.h"
#include "tune/study.h"

typedef struct mt_solve_options {
    int threads;        /* workers */
    const double *hint; /* [n_variables] one more design to start from; NULL: none */
    const volatile int *
        stop; /* NULL, or set non-zero from a signal handler: the search ends with what it has */
    void (*progress)(void *context,
                     const char *text); /* NULL, or called now and then with one line */
    void *progress_context;
} mt_solve_options;
mt_solve_options mt_solve_options_default(void);

/*
 * Answer a study: baseline, search, ranked recommendations, each recomputed from scratch at its design, published values judged. The result is owned by the caller
 * (mt_result_delete). A study whose goals cannot be met is a success with status compromise or infeasible.
 * Fails: MT_E_INPUT (something only numbers can tell: a mode that does not exist at the original design, ...), numerical failures at the original design, MT_E_MEMORY.
 */
mt_status mt_study_solve(const mt_study *study, const mt_solve_options *opt, mt_result **out,
                         mt_err *err);

#endif
