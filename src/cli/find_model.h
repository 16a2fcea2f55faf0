/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_FIND_MODEL_H
#define CLI_FIND_MODEL_H

#include "cli/args.h"
#include "io/file.h"
#include "result/result.h"

/* The model of a result, the first operand: the file of --model, else a file found that holds
 * exactly the bytes that were solved. file: mt_file_free; path: heap. Fails: MT_E_INPUT (not
 * found), MT_E_SYSTEM, MT_E_MEMORY. */
mt_status mt_find_model(const mt_args *args, const mt_result *result, mt_file *file,
                        char **path, mt_err *err);

#endif
