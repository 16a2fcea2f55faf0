/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_TERMINAL_H
#define CLI_TERMINAL_H

#include <stdbool.h>

#include "base/text.h"

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
/* Whether anything has ended as MT_E_MEMORY so far. */
bool mt_exit_without_memory(void);
/* The worse of two: 4 (something is lost), then 130, 3, 2, 1, 0. */
int mt_exit_worse(int a, int b);

/*
 * Whatever leaves the program by standard output or error leaves through here, and what a
 * terminal would obey (control characters, marks of direction) is made visible, see
 * base/visible.h: the colours and the wiping of the line of progress are the only ones.
 */

/* Everything that is written to standard output is collected in a text and leaves through here;
 * the text is empty afterwards. A reader that has gone (EPIPE) is not complained about, but is
 * a failure, too. Returns MT_EXIT_DONE or MT_EXIT_SYSTEM. */
int mt_terminal_put(mt_text *out);
/* What is being collected is not whole, memory being out: the next mt_terminal_put throws it
 * away. */
void mt_terminal_drop(void);
/* The last word of standard output: a network disk may refuse what was written only now. As
 * mt_terminal_put. */
int mt_terminal_close(void);
/* At the start: a descriptor of 0 to 2 that is closed must not become one of a file, which
 * messages would then go into. It is opened so that using it fails. */
void mt_terminal_open(void);
/* To standard error: "modetune: error: ..." */
void mt_terminal_error(const char *fmt, ...) MT_PRINTF(1, 2);
void mt_terminal_warning(const char *fmt, ...) MT_PRINTF(1, 2);
/* Lines of diagnostics as they are; "error:" and "warning:" coloured on a terminal. */
void mt_terminal_diagnostics(const char *lines);
/* Talk: a line to standard error unless quiet. */
void mt_terminal_talk(bool quiet, const char *fmt, ...) MT_PRINTF(2, 3);
/* Columns of the terminal that standard output is; 0: it is none, or does not say. */
int mt_terminal_width(void);
/* Whether standard error is a terminal. */
bool mt_terminal_is_watched(void);
/* Lines to standard error as they are. */
void mt_terminal_write(const char *text, size_t length);
/* One line of a terminal that is written over again and again. Text NULL: wipe it. A signal
 * that ends the program wipes it, too. */
void mt_terminal_line(const char *text);

/* SIGPIPE and SIGXFSZ become errors of writing. SIGINT and SIGTERM stay as the system has them,
 * and end the program, but while they are held. */
void mt_terminal_ignore_signals(void);
/*
 * From here to the release the first SIGINT or SIGTERM is only noted, for work that ends well
 * by itself (mt_terminal_stop_request) or that must not be left half done; the second ends the
 * program. Where the program was started with one of them ignored, it stays so.
 */
void mt_terminal_hold_signals(void);
void mt_terminal_release_signals(void);
/* Whether one has been noted since the program began. */
bool mt_terminal_is_stopped(void);
/* After so many seconds from now (0: never, at most MT_SECONDS_MOST) mt_terminal_stop_request
 * wishes as after a signal. While no worker runs. */
#define MT_SECONDS_MOST 1e9
void mt_terminal_limit(double seconds);
/* So many seconds before that limit, or half of the time that is left, to finish is wished for
 * already, and to end at the limit. Any thread. */
void mt_terminal_reserve(double seconds);
/* An mt_stop_request, the stop of a solve: to finish, and, a moment after the signal or the end
 * of the time, to end. Any thread. */
int mt_terminal_stop_request(void *unused);
/* An mt_stop_reason, why it wishes so: a signal, or the end of the time. */
int mt_terminal_stop_reason(void *unused);
/* One line (cut where it is too long) that is written to standard error when a signal ends the
 * program from now on; NULL: none any more. Not while signals are held. */
void mt_terminal_last_words(const char *text);
/* Seconds of a clock that only runs forward. */
double mt_terminal_seconds(void);
/* CPU seconds of the process so far, of all its threads. */
double mt_terminal_cpu_seconds(void);

#endif
