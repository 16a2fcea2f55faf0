/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_HELP_H
#define CLI_HELP_H

#include <stdbool.h>

#include "base/text.h"

/* A manual page, section 1, in the language of man(7): modetune(1) with MT_CMD_NONE, or
 * modetune-COMMAND(1). */
void mt_manual(int command, mt_text *out);

#endif
