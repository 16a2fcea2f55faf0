/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_HELP_H
#define CLI_HELP_H

#include "base/text.h"

/* What --help prints: of the whole (MT_CMD_NONE) or of one command. */
void mt_help(int command, mt_text *out);

#endif
