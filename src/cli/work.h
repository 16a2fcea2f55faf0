/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_WORK_H
#define CLI_WORK_H

#include "cli/args.h"
#include "io/journal.h"
#include "result/result.h"
#include "study/study.h"

/*
 * The journal of one study's run: what --resume, --shard and merge ask for. All of these return
 * an exit status, everything said.
 */

/* Opened for a study that was read; NULL where that fails. */
int mt_work_begin(const mt_args *args, const char *study_path, const mt_study *study,
                  mt_journal **out);
/* After the answer, of the exit status so far: `complete` where there is nothing left to be
 * resumed, and the journal goes. What cannot be written of it is a warning, but of a part. */
int mt_work_end(const mt_args *args, const char *study_path, int code, bool complete,
                mt_journal *j);

#endif
