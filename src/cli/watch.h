/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_WATCH_H
#define CLI_WATCH_H

#include "base/run.h"
#include "cli/args.h"

/*
 * The progress messages on standard error during long work (--progress). A separate thread
 * reads the progress, so that a slow terminal does not delay the work, nor a long step the
 * messages. One work at a time. Nothing else may be written to standard error between begin and
 * end.
 */

/* Begin to report the progress for operand i of the command, in its first phase. NULL where no
 * reports are requested or possible; mt_watch_end follows in any case. */
mt_progress *mt_watch_begin(const mt_args *args, int i, const char *phase);
/* Erase the line between hold and go_on, so that other messages can be written. */
void mt_watch_hold(void);
void mt_watch_go_on(void);
/* Erase the line and write the last message. complete: nothing was cut. */
void mt_watch_end(bool complete);

#endif
