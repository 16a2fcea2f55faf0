/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_FILE_INFO_H
#define CLI_FILE_INFO_H

#include <stdbool.h>

#include "base/text.h"
#include "cli/args.h"
#include "result/record.h"

/* What JSON has of a file that is no model. */
extern const mt_record mt_held_file_record;

/**
 * Append what the file of the first operand (or the result of a folder) holds, where that is no
 * model: a study, a result, a profile, a catalogue of aircraft, measured responses (a table, or
 * a universal file), or what the program writes beside them. Its kind follows from its bytes,
 * and the reader of that kind checks it.
 * @param[out] is_model the file is a model, and nothing was done
 * Returns the exit status, with all messages given.
 */
int mt_file_info(const mt_args *args, bool *is_model, mt_text *out);

#endif
