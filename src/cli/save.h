/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_SAVE_H
#define CLI_SAVE_H

#include "cli/args.h"
#include "io/io.h"
#include "result/result.h"

/* Before anything is run: has every study a folder of its own? Returns MT_EXIT_DONE, or the
 * exit status, everything said. */
int mt_save_plan(const mt_args *args);

/* Write all files of a result into its folder, as one; notes them in result->run. Returns the
 * exit status, everything said. */
int mt_save(const mt_args *args, const char *study_path, mt_result *result, double seconds);
/* The same of a result that was read; timing.json is taken over where the one beside
 * result_path names what is written. */
int mt_save_again(const mt_args *args, const char *result_path, mt_result *result);
/* What goes to standard output: summary (with published values where --verify asks), table,
 * page, or, as a value of w, the result. */
void mt_save_print(const mt_args *args, const mt_result *result, mt_json_writer *w,
                   mt_text *out);

#endif
