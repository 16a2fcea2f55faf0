/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_HELP_H
#define CLI_HELP_H

#include "base/text.h"

/* What --help prints: of the whole (MT_CMD_NONE) or of one command. */
void mt_help(int command, mt_text *out);
/* Append paragraphs of words (one a line of s) in lines of up to 92 columns that begin at
 * `column`; where the first one begins, the caller is there already. */
void mt_help_fill(const char *s, int column, mt_text *out);

#endif
