/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_SAVE_H
#define CLI_SAVE_H

#include "base/sha256.h"
#include "cli/args.h"
#include "io/write_json.h"
#include "result/result.h"

/* Check, before anything is run, that every study has its own folder. Returns MT_EXIT_DONE, or
 * the exit status, with all messages given. */
int mt_save_plan(const mt_args *args);

/* The folder for the results of all studies, and the folder for the result of one (heap, NULL
 * when out of memory). */
const char *mt_save_base(const mt_args *args);
char *mt_save_folder(const mt_args *args, const char *study_path);
/* The files of the index of several studies, the last one decisive. */
enum { MT_INDEX_FILES = 2 };
extern const char *const mt_index_names[MT_INDEX_FILES];

/* Write all files of a result into its folder atomically, and record them in result->run.
 * Returns the exit status, with all messages given. scene: of its mechanism, as JSON for the
 * report; NULL: none. sha256: of result.json, "" where it was not written. */
int mt_save(const mt_args *args, const char *study_path, mt_result *result, const char *scene,
            double seconds, char sha256[MT_SHA256_TEXT]);
/* mt_save for a result that was read; timing.json is kept where the one next to result_path
 * names the written result. */
int mt_save_again(const mt_args *args, const char *result_path, mt_result *result,
                  const char *scene);
/* Append the standard output: summary (with published values for --verify), table, page, or, as
 * a value of w, the result. */
void mt_save_print(const mt_args *args, const mt_result *result, const char *scene,
                   mt_json_writer *w, mt_text *out);

#endif
