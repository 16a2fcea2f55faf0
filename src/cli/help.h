/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_HELP_H
#define CLI_HELP_H

#include "base/text.h"

/* Append the text of --help: of the program (MT_CMD_NONE) or of one command. */
void mt_help(int command, mt_text *out);
/* Append paragraphs of words (one per line of s) in lines of up to 92 columns that begin at
 * `column`; the caller has already written up to there for the first line. */
void mt_help_fill(const char *s, int column, mt_text *out);

#endif
