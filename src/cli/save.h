/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_SAVE_H
#define CLI_SAVE_H

#include "cli/args.h"
#include "result/result.h"

/* Before anything is run: has every study a folder of its own? Returns MT_EXIT_DONE, or the
 * exit status, everything said. */
int mt_save_plan(const mt_args *args);

/* Write all files of a result into its folder, as one; notes them in result->run. Returns the
 * exit status, everything said. */
int mt_save(const mt_args *args, const char *study_path, mt_result *result, double seconds);

#endif
