/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_COMPLETION_H
#define CLI_COMPLETION_H

#include "base/text.h"

typedef enum mt_shell { MT_SHELL_BASH, MT_SHELL_ZSH, MT_SHELL_COUNT } mt_shell;

/* A script for this shell that completes commands, options, their values and files, from the
 * tables of --help. */
void mt_completion(mt_shell shell, mt_text *out);

#endif
