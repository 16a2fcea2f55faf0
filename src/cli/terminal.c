/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The only place that prints, looks at the environment, the clock or signals. */
#include "cli/terminal.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include "base/format.h"
#include "base/text.h"

enum {
    LINE_SIZE = 8192, /* longer lines of talk are cut */
    PROGRESS_SIZE = 512,
    DEFAULT_WIDTH = 80,
    LAST_WORDS_SIZE = 512
};

static const char RED[] = "\033[1;31m";
static const char YELLOW[] = "\033[1;33m";
static const char PLAIN[] = "\033[0m";
static const char WIPE[] = "\r\033[K"; /* the line of progress */

#define NS_PER_S 1000000000LL
/* How long what was found may be made ready after the signal; a user waits half a second at
 * most. */
#define MAKE_READY_NS (NS_PER_S / 4)

static atomic_llong stop_ns; /* when the first signal was noted; 0: none */
static atomic_bool line_is_shown;
static long long limit_ns = 0; /* when the time is over; 0: never */
static atomic_llong early_ns;  /* when the search ends, to leave time for what it found */
static char last_words[LAST_WORDS_SIZE];
static size_t last_words_length = 0;
static bool dropped = false; /* what is being collected */

static bool without_memory = false;

bool mt_exit_without_memory(void)
{
    return without_memory;
}

int mt_exit_of(mt_status status)
{
    switch (status) {
    case MT_OK:
        return MT_EXIT_DONE;
    case MT_E_USAGE:
    case MT_E_INPUT:
        return MT_EXIT_INPUT;
    case MT_E_SYSTEM:
        return MT_EXIT_SYSTEM;
    case MT_E_MEMORY:
        without_memory = true;
        return MT_EXIT_SYSTEM;
    case MT_E_INTERRUPTED:
        return MT_EXIT_INTERRUPTED;
    case MT_E_NOT_SPD:
    case MT_E_SINGULAR:
    case MT_E_ASSEMBLY:
    case MT_E_EQUILIBRIUM:
    case MT_E_DEAD_CENTRE:
    case MT_E_MASSLESS:
    case MT_E_NO_CONVERGENCE:
    case MT_E_DOMAIN:
    case MT_E_INTERNAL:
    case MT_STATUS_COUNT:
        break;
    }
    return MT_EXIT_NUMERICAL;
}

int mt_exit_worse(int a, int b)
{
    const bool lost = a == MT_EXIT_SYSTEM || b == MT_EXIT_SYSTEM;
    return lost ? MT_EXIT_SYSTEM : a > b ? a : b;
}

/* True where standard output (descriptor 1) or error (2) is a terminal where colour is
 * welcome. */
static bool takes_colour(int descriptor)
{
    const char *const refused = getenv("NO_COLOR");
    const char *const terminal = getenv("TERM");
    return (refused == NULL || refused[0] == '\0') && isatty(descriptor) == 1 &&
           terminal != NULL && strcmp(terminal, "dumb") != 0;
}

/* Write all bytes, waiting for the reader; false with errno. */
static bool write_out(const char *bytes, size_t length)
{
    size_t done = 0;
    while (done < length) {
        const ssize_t n = write(STDOUT_FILENO, bytes + done, length - done);
        if (n >= 0) {
            done += (size_t)n;
        } else if (errno == EAGAIN) { /* somebody else made it non-blocking */
            struct pollfd reader = {.fd = STDOUT_FILENO, .events = POLLOUT};
            (void)poll(&reader, 1, -1);
        } else if (errno != EINTR) {
            return false;
        }
    }
    return true;
}

static bool write_stream(FILE *to, const char *s, size_t n)
{
    return to == stdout ? write_out(s, n) : fwrite(s, 1, n, to) == n;
}

/* The only output function: characters that a terminal would obey are made visible. `lines`:
 * the text contains lines. */
static bool show(FILE *to, const char *s, size_t n, bool lines)
{
    bool ok = true;
    while (ok && n > 0) {
        const size_t run = mt_visible_run(s, n, lines);
        ok = run == 0 || write_stream(to, s, run);
        s += run;
        n -= run;
        if (ok && n > 0) {
            char escape[MT_VISIBLE_SIZE];
            const size_t used = mt_visible_escape(s, n, escape);
            ok = write_stream(to, escape, strlen(escape));
            s += used;
            n -= used;
        }
    }
    return ok;
}

static int output_failed(void)
{
    if (errno != EPIPE) {
        mt_terminal_error("standard output: %s", strerror(errno));
    }
    return MT_EXIT_SYSTEM;
}

void mt_terminal_drop(void)
{
    dropped = true;
}

int mt_terminal_put(mt_text *out)
{
    bool ok = !out->failed && !dropped;
    if (dropped) {
        dropped = false; /* why has been said */
    } else if (!ok) {
        mt_terminal_error("out of memory");
        without_memory = true;
    } else if (out->length > 0) {
        ok = show(stdout, out->s, out->length, true);
        if (!ok) {
            (void)output_failed();
        }
    }
    mt_text_free(out);
    return ok ? MT_EXIT_DONE : MT_EXIT_SYSTEM;
}

int mt_terminal_close(void)
{
    return close(STDOUT_FILENO) == 0 || errno == EBADF || errno == EINTR ? MT_EXIT_DONE
                                                                         : output_failed();
}

void mt_terminal_open(void)
{
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++) {
        if (fcntl(fd, F_GETFD) < 0 && errno == EBADF) {
            (void)open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY);
        }
    }
}

/* One line of talk to standard error. */
MT_PRINTF(1, 0)
static void line(const char *fmt, va_list args)
{
    char text[LINE_SIZE];
    if (mt_vsnprintf(text, sizeof text, fmt, args) < 0) {
        text[0] = '\0';
    }
    (void)show(stderr, text, strlen(text), false);
    (void)fputc('\n', stderr);
}

MT_PRINTF(3, 0)
static void print_message(const char *kind, const char *colour, const char *fmt, va_list args)
{
    const bool coloured = takes_colour(STDERR_FILENO);
    (void)fprintf(stderr, "modetune: %s%s:%s ", coloured ? colour : "", kind,
                  coloured ? PLAIN : "");
    line(fmt, args);
}

void mt_terminal_error(const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    print_message("error", RED, fmt, args);
    va_end(args);
}

void mt_terminal_warning(const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    print_message("warning", YELLOW, fmt, args);
    va_end(args);
}

static void diagnostic(const char *text, size_t length)
{
    static const struct {
        const char *word;
        const char *colour;
    } words[] = {
        {" error: ", RED},
        {" warning: ", YELLOW},
    };
    const bool coloured = takes_colour(STDERR_FILENO);
    size_t done = 0;
    for (int i = 0; coloured && done == 0 && i < MT_COUNT(words); i++) {
        const char *const at = strstr(text, words[i].word);
        if (at != NULL && at < text + length) {
            const size_t before = (size_t)(at - text) + 1;
            const size_t word = strlen(words[i].word) - 2;
            (void)show(stderr, text, before, false);
            (void)fputs(words[i].colour, stderr);
            (void)show(stderr, text + before, word, false);
            (void)fputs(PLAIN, stderr);
            done = before + word;
        }
    }
    (void)show(stderr, text + done, length - done, false);
    (void)fputc('\n', stderr);
}

void mt_terminal_diagnostics(const char *lines)
{
    while (*lines != '\0') {
        const size_t length = strcspn(lines, "\n");
        diagnostic(lines, length);
        lines += length + (lines[length] == '\n' ? 1 : 0);
    }
}

void mt_terminal_talk(bool quiet, const char *fmt, ...)
{
    if (!quiet) {
        va_list args;
        va_start(args, fmt);
        line(fmt, args);
        va_end(args);
    }
}

bool mt_terminal_is_watched(void)
{
    return isatty(STDERR_FILENO) == 1;
}

void mt_terminal_write(const char *text, size_t length)
{
    (void)show(stderr, text, length, true);
}

int mt_terminal_width(void)
{
    struct winsize w = {0};
    const bool known = isatty(STDOUT_FILENO) == 1 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &w) == 0;
    return known && w.ws_col > 1 ? w.ws_col : 0;
}

/* Columns that fit in the line: one that wraps could not be erased. */
static size_t line_width(void)
{
    struct winsize w = {0};
    const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &w) == 0 && w.ws_col > 1;
    const size_t width = known ? (size_t)w.ws_col : DEFAULT_WIDTH;
    return width < PROGRESS_SIZE ? width : PROGRESS_SIZE;
}

void mt_terminal_line(const char *text)
{
    char shown[PROGRESS_SIZE];
    (void)mt_snprintf(shown, line_width(), "%s", text == NULL ? "" : text);
    atomic_store(&line_is_shown, text != NULL);
    (void)fputs(WIPE, stderr);
    (void)show(stderr, shown, strlen(shown), false);
    (void)fflush(stderr);
}

static long long now_ns(void)
{
    struct timespec now = {0};
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return ((long long)now.tv_sec * NS_PER_S) + (long long)now.tv_nsec;
}

static void wipe_at_once(void)
{
    if (atomic_load(&line_is_shown)) {
        const ssize_t said = write(STDERR_FILENO, WIPE, sizeof WIPE - 1);
        (void)said;
    }
}

/* Signal handlers; they call only async-signal-safe functions. SA_RESETHAND: a signal raised in
 * them gets the system's action after they return. */
static void note_stop_signal(int number)
{
    long long none = 0;
    if (!atomic_compare_exchange_strong(&stop_ns, &none, now_ns())) {
        wipe_at_once();
        (void)raise(number); /* the second one */
    }
}

static void say_and_end(int number)
{
    wipe_at_once();
    const ssize_t said = write(STDERR_FILENO, last_words, last_words_length);
    (void)said;
    (void)raise(number);
}

/* Set the action of a signal, unless the program was started with it ignored (a job in the
 * background). */
static void set_action(int number, void (*to)(int number))
{
    struct sigaction old;
    struct sigaction action;
    memset(&old, 0, sizeof old);
    memset(&action, 0, sizeof action);
    action.sa_handler = to;
    action.sa_flags = (int)SA_RESETHAND;
    if (sigaction(number, NULL, &old) == 0 && old.sa_handler != SIG_IGN) {
        (void)sigaction(number, &action, NULL);
    }
}

static void set_actions(void (*to)(int number))
{
    set_action(SIGINT, to);
    set_action(SIGTERM, to);
}

void mt_terminal_ignore_signals(void)
{
    struct sigaction ignore;
    memset(&ignore, 0, sizeof ignore);
    ignore.sa_handler = SIG_IGN;
    (void)sigaction(SIGPIPE, &ignore, NULL);
    (void)sigaction(SIGXFSZ, &ignore, NULL);
}

void mt_terminal_hold_signals(void)
{
    set_actions(note_stop_signal);
}

void mt_terminal_release_signals(void)
{
    set_actions(SIG_DFL);
}

bool mt_terminal_is_stopped(void)
{
    return atomic_load(&stop_ns) != 0;
}

void mt_terminal_limit(double seconds)
{
    limit_ns = seconds > 0.0 ? now_ns() + (long long)(seconds * (double)NS_PER_S) : 0;
    atomic_store(&early_ns, limit_ns);
}

void mt_terminal_reserve(double seconds)
{
    const long long now = now_ns();
    const long long half = (limit_ns - now) / 2;
    const long long asked = (long long)(fmin(seconds, 1e9) * (double)NS_PER_S);
    if (limit_ns > now) {
        atomic_store(&early_ns, limit_ns - (asked < half ? asked : half));
    }
}

int mt_terminal_stop_request(void *unused)
{
    const long long stopped = atomic_load(&stop_ns);
    long long since = stopped;
    (void)unused;
    if (since == 0 && limit_ns == 0) {
        return MT_STOP_REQUEST_NONE;
    }
    const long long now = now_ns();
    long long last = since + MAKE_READY_NS;
    const long long early = atomic_load(&early_ns);
    if (limit_ns != 0 && (since == 0 || early < since)) {
        since = early;
        last = early + MAKE_READY_NS < limit_ns ? limit_ns : early + MAKE_READY_NS;
        last = stopped != 0 && stopped + MAKE_READY_NS < last ? stopped + MAKE_READY_NS : last;
    }
    if (now < since) {
        return MT_STOP_REQUEST_NONE;
    }
    return now < last ? MT_STOP_REQUEST_FINISH : MT_STOP_REQUEST_END;
}

int mt_terminal_stop_reason(void *unused)
{
    (void)unused;
    return mt_terminal_is_stopped() ? MT_STOP_REASON_INTERRUPT : MT_STOP_REASON_TIME_LIMIT;
}

void mt_terminal_last_words(const char *text)
{
    set_actions(SIG_DFL);
    if (text == NULL) {
        return;
    }
    const size_t most = sizeof last_words - 1;
    const size_t length = strlen(text);
    last_words_length = length < most ? length : most;
    memcpy(last_words, text, last_words_length);
    last_words[last_words_length++] = '\n';
    set_actions(say_and_end);
}

static double seconds_of(clockid_t clock)
{
    struct timespec now = {0};
    (void)clock_gettime(clock, &now);
    return (double)now.tv_sec + ((double)now.tv_nsec * 1e-9);
}

double mt_terminal_seconds(void)
{
    return seconds_of(CLOCK_MONOTONIC);
}

double mt_terminal_cpu_seconds(void)
{
    return seconds_of(CLOCK_PROCESS_CPUTIME_ID);
}
