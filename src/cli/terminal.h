/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_TERMINAL_H
#define CLI_TERMINAL_H

#include <stdbool.h>

#include "base/diagnostics.h"
#include "base/run.h"
#include "base/text.h"
#include "cli/args.h"
#include "io/write_json.h"
#include "result/record.h"
#include "study/study.h"

/* The members of a line of progress. */
extern const mt_record mt_progress_record;

/* Exit status of the program. */
enum {
    MT_EXIT_DONE = 0,
    MT_EXIT_GOALS = 1,
    MT_EXIT_INPUT = 2,
    MT_EXIT_NUMERICAL = 3,
    MT_EXIT_SYSTEM = 4,
    MT_EXIT_INTERRUPTED = 130
};
int mt_exit_of(mt_status status);
/* True where anything has ended with MT_E_MEMORY so far. */
bool mt_exit_without_memory(void);
/* The worse of two exit statuses: 4 (output was lost), then 130, 3, 2, 1, 0. */
int mt_exit_worse(int a, int b);

/*
 * All writing to standard output and error. Characters that a terminal would obey (control
 * characters, marks of direction) are made visible, see base/text.h; only colours and the
 * erasing of the progress line are sent as such.
 */

/* Write the collected standard output; the text is empty afterwards. A closed reader (EPIPE) is
 * a failure without a message. Returns MT_EXIT_DONE or MT_EXIT_SYSTEM. */
int mt_terminal_put(mt_text *out);
/* Close standard output: a network disk may report a failed write only now. Returns as
 * mt_terminal_put. */
int mt_terminal_close(void);
/* Called at the start: open closed descriptors 0 to 2 so that using them fails; otherwise an
 * opened file could get one, and messages would go into it. SIGPIPE and SIGXFSZ become write
 * errors; SIGINT and SIGTERM keep their action and end the program, except while they are
 * held. */
void mt_terminal_open(void);
/* Write "modetune: error: ..." to standard error. */
void mt_terminal_error(const char *fmt, ...) MT_PRINTF(1, 2);
void mt_terminal_warning(const char *fmt, ...) MT_PRINTF(1, 2);
/* Messages: write a line to standard error unless quiet. */
void mt_terminal_talk(bool quiet, const char *fmt, ...) MT_PRINTF(2, 3);
/* Report the outcome of loading a file: its diagnostics, or the error where there are none.
 * Returns the exit status of rc; frees the messages. */
int mt_cli_loaded(mt_status rc, mt_diagnostics *messages, const mt_err *err);

/* Report an error found in a study with its model: in messages with its place where the study
 * knows it, else in err with the file first. Nothing where rc is MT_OK. */
void mt_cli_place(const mt_study *study, const char *path, mt_status rc, mt_err *err,
                  mt_diagnostics *messages);

/* Report err and return the exit status of rc. */
int mt_cli_failed(mt_status rc, const mt_err *err);

/* Columns of the terminal of standard output; 0: not a terminal, or unknown. */
int mt_terminal_width(void);
/* Write lines to standard error unchanged. */
void mt_terminal_write(const char *text, size_t length);

/*
 * Hold and release signals. In between the first SIGINT or SIGTERM is only recorded, for work
 * that stops by itself (mt_terminal_stop_request) or must be completed; the second ends the
 * program. A signal ignored at the program's start stays ignored.
 */
void mt_terminal_hold_signals(void);
void mt_terminal_release_signals(void);
/* True where a signal was recorded since the program began. */
bool mt_terminal_is_stopped(void);
/* Set a time limit: after so many seconds from now (0: none, at most MT_SECONDS_MOST)
 * mt_terminal_stop_request answers as after a signal. Call it while no worker runs. */
#define MT_SECONDS_MOST 1e9
void mt_terminal_limit(double seconds);
/* Reserve time before the limit: so many seconds before it, or at half of the remaining time,
 * the request becomes to finish, and at the limit to end. Any thread. */
void mt_terminal_reserve(double seconds);
/* The `stop` of a solve, an mt_stop_request: to finish after a signal or at the time limit, and
 * a moment later to end. Any thread. */
int mt_terminal_stop_request(void *unused);
/* The `cause` of a solve, an mt_stop_reason: a signal, or the time limit. */
int mt_terminal_stop_reason(void *unused);
/* Set a line (cut where too long) that is written to standard error when a signal ends the
 * program; NULL: none. Not while signals are held. */
void mt_terminal_last_words(const char *text);
/* Seconds of a monotonic clock. */
double mt_terminal_seconds(void);

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

/* Counters of the evaluations of a model from here on, with --timing; else NULL. */
mt_profile *mt_cli_profile(const mt_args *args, mt_profile *own);

/* Print the stages as a table on standard error; NULL: nothing. Returns the exit status. */
int mt_cli_profile_print(mt_profile *p);

#endif
