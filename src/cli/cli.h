/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_CLI_H
#define CLI_CLI_H

#include "analysis/analysis.h"
#include "base/run.h"
#include "base/text.h"
#include "cli/args.h"
#include "cli/loaded_model.h"
#include "cli/terminal.h"
#include "environment/aircraft.h"
#include "environment/vibration.h"
#include "io/file.h"
#include "io/json.h"
#include "io/options.h"
#include "io/write_json.h"
#include "mechanics/singular.h"
#include "model/read.h"
#include "result/folder.h"
#include "result/read.h"
#include "result/result.h"
#include "result/write.h"
#include "study/read.h"
#include "study/study.h"

/* The records of the commands, each in its command's file, and all of them. */
#define MT_COMMAND_RECORD(id, name) extern const mt_command mt_command_##name;
MT_COMMAND_LIST(MT_COMMAND_RECORD)
#undef MT_COMMAND_RECORD
extern const mt_command *const mt_commands[MT_CMD_IDS];

/* The whole program except its process-wide settings: parse, run, print. */
int mt_cli_main(int argc, char *const argv[]);

#endif
