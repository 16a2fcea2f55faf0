/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_CMD_RUN_H
#define CLI_CMD_RUN_H

#include "cli/args.h"
#include "io/write_json.h"
#include "result/record.h"
#include "result/result.h"

/* The members of index.json. */
extern const mt_record mt_index_record;

/* mt_save for a result that was read; timing.json is kept where the one next to result_path
 * names the written result. */
int mt_save_again(const mt_args *args, const char *result_path, mt_result *result,
                  const char *scene);
/* Append the standard output: summary (with published values for --verify), table, page, or, as
 * a value of w, the result. */
void mt_save_print(const mt_args *args, const mt_result *result, const char *scene,
                   mt_json_writer *w, mt_text *out);

#endif
