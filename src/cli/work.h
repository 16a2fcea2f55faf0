/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_WORK_H
#define CLI_WORK_H

#include "cli/args.h"
#include "io/journal.h"
#include "result/result.h"
#include "study/study.h"

/*
 * The journal of one study's run, for --resume, --shard and merge. All functions return an exit
 * status, with all messages given.
 */

/* Open the journal for a study that was read; NULL on failure. */
int mt_work_begin(const mt_args *args, const char *study_path, const mt_study *study,
                  mt_journal **out);
/* End the journal after an answer with this exit status so far. `complete`: nothing is left to
 * resume, and the journal, unless it is a part's, is removed. A failure to write it is a
 * warning, for a part an error. */
int mt_work_end(const mt_args *args, const char *study_path, int code, bool complete,
                mt_journal *j);

#endif
