/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_WATCH_H
#define CLI_WATCH_H

#include "base/progress.h"
#include "cli/args.h"

/*
 * What standard error says of a long piece of work while it lasts (--progress): a thread of its
 * own looks at the progress, so that neither a slow terminal nor a long step changes the pace
 * of either. One work at a time. Nothing else is to be written to standard error between begin
 * and end.
 */

/* Begin to look at what is done for operand i of the command, in its first phase. NULL where
 * nobody is to be told, or where there is nothing to do it with; mt_watch_end follows in any
 * case. */
mt_progress *mt_watch_begin(const mt_args *args, int i, const char *phase);
/* In between: the line is wiped until it goes on, and something else may be said. */
void mt_watch_hold(void);
void mt_watch_go_on(void);
/* The line is wiped, the last word is said. complete: nothing was cut. */
void mt_watch_end(bool complete);

#endif
