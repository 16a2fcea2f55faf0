/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANSWER_SOLVE_H
#define ANSWER_SOLVE_H

#include "base/workers.h"
#include "study/study.h"

/* Is called before a proof that may take long, with the answer so far (status "interrupted"):
 * it may be kept in case that the whole one never comes. */
typedef struct mt_incumbent_callback {
    mt_status (*tell)(void *context, mt_result *so_far, mt_err *err);
    void *context;
} mt_incumbent_callback;

/* mt_study_solve with what earlier runs of the same question have left of their tasks, and a
 * place for this one's; NULL: neither. Whatever a ledger knows, the result is the same. Where
 * it asks for a part of the work (ledger->parts > 0) there is no answer: *out says of the
 * question what it says at once, and what matters is in the ledger. early may be NULL. Fails
 * also: as early->tell. */
mt_status mt_study_solve_with(const mt_study *study, const mt_solve_options *opt,
                              mt_checkpoint_store *store,
                              const mt_incumbent_callback *incumbent, mt_result **out,
                              mt_err *err);

#endif
