/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The terminal: streams, signals, time, and how far a run has come. */
#include "cli/terminal.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include "base/format.h"
#include "base/run.h"
#include "base/text.h"
#include "cli/cli.h"
#include "report/table.h"
#include "result/write.h"

/* The only place that prints, looks at the environment, the clock or signals. */

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

/* Mark the collected text as incomplete for lack of memory: the next mt_terminal_put discards
 * it. */
static void drop_output(void)
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

/* Turn SIGPIPE and SIGXFSZ into write errors. */
static void ignore_signals(void)
{
    struct sigaction ignore;
    memset(&ignore, 0, sizeof ignore);
    ignore.sa_handler = SIG_IGN;
    (void)sigaction(SIGPIPE, &ignore, NULL);
    (void)sigaction(SIGXFSZ, &ignore, NULL);
}

void mt_terminal_open(void)
{
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++) {
        if (fcntl(fd, F_GETFD) < 0 && errno == EBADF) {
            (void)open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY);
        }
    }
    ignore_signals();
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

/* Write lines of diagnostics to standard error; "error:" and "warning:" are coloured on a
 * terminal. */
static void print_diagnostics(const char *lines)
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

/* How a failure is said, and what the program ends with then. */

int mt_cli_failed(mt_status rc, const mt_err *err)
{
    mt_terminal_error("%s", err->text);
    if (rc == MT_E_MEMORY) {
        drop_output();
    }
    return mt_exit_of(rc);
}

int mt_cli_loaded(mt_status rc, mt_diagnostics *messages, const mt_err *err)
{
    const bool told = mt_diagnostics_first_error(messages) >= 0;
    mt_err shortage = {.code = MT_OK};
    if (messages->lines.failed && rc != MT_E_MEMORY) { /* some of them are missing */
        rc = mt_fail_memory(&shortage);
        err = &shortage;
    }
    print_diagnostics(mt_diagnostics_text(messages));
    mt_diagnostics_free(messages);
    if (rc != MT_OK && !(told && rc == MT_E_INPUT)) {
        return mt_cli_failed(rc, err);
    }
    return mt_exit_of(rc);
}

void mt_cli_place(const mt_study *study, const char *path, mt_status rc, mt_err *err,
                  mt_diagnostics *messages)
{
    mt_diagnostic_place place = {.file = path};
    if (rc != MT_E_INPUT || !mt_study_locate(study, err->text, &place.line, &place.column)) {
        (void)mt_err_in(err, rc, "%s", path);
        return;
    }
    mt_diagnostics_add(messages, MT_SEVERITY_ERROR, &place, err->text);
}

/* True where standard error is a terminal. */
static bool terminal_is_watched(void)
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

/* Rewrite the progress line of the terminal. Text NULL: erase it. A signal that ends the
 * program erases it, too. */
static void terminal_line(const char *text)
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

/* CPU seconds of the process so far, of all its threads. */
static double terminal_cpu_seconds(void)
{
    return seconds_of(CLOCK_PROCESS_CPUTIME_ID);
}

/* How far a run has come. */

enum { TEXT = 512, DURATION = 32, LOOK_MS = 100 };

/* Between lines where nobody looks at them live. */
static const double PLAIN_S = 10.0;
static const double JSON_S = 0.5;
/* A share below says nothing of the rest, nor does a time. */
static const double SHARE_LEAST = 0.02;
static const double TIME_LEAST = 1.0;

static const double PER_CENT = 100.0;
static const double MINUTE = 60.0;
static const double HOUR = 3600.0;

/* Whom the words are for. */
typedef enum reader { READER_NONE, READER_TERMINAL, READER_LOG, READER_PROGRAM } reader;

typedef struct watch {
    const mt_args *args;
    int operand;
    reader reader;
    mt_progress progress;
    mt_ticker ticker;
    int over[2]; /* a pipe: closed at the end */
    bool has_progress;
    bool has_ticker;
    /* of the watching thread, then of mt_watch_end */
    double begun_s;
    double begun_cpu_s;
    double step_s; /* when the present step began */
    double told_s; /* when the last word was said */
    bool told_impossible;
    mt_progress_view last;
} watch;

static watch it;

static reader reader_of(const mt_args *args)
{
    if (!mt_option_is_of(MT_OPT_PROGRESS, args->command)) {
        return READER_NONE;
    }
    if (args->progress == MT_PROGRESS_JSON) {
        return READER_PROGRAM;
    }
    if (args->progress == MT_PROGRESS_LINE) {
        return READER_LOG;
    }
    if (args->progress == MT_PROGRESS_NONE || args->given[MT_OPT_QUIET]) {
        return READER_NONE;
    }
    return terminal_is_watched() ? READER_TERMINAL : READER_LOG;
}

/* "42 s", "3 min 20 s", "5 h 12 min" */
static const char *duration(double s, char out[DURATION])
{
    const double whole = floor(s);
    if (whole < MINUTE) {
        (void)mt_snprintf(out, DURATION, "%.0f s", whole);
    } else if (whole < HOUR) {
        (void)mt_snprintf(out, DURATION, "%.0f min %.0f s", floor(whole / MINUTE),
                          fmod(whole, MINUTE));
    } else {
        (void)mt_snprintf(out, DURATION, "%.0f h %.0f min", floor(whole / HOUR),
                          floor(fmod(whole, HOUR) / MINUTE));
    }
    return out;
}

/* Of the present step, if it goes on as it did; NaN: not known. */
static double step_left(const mt_progress_view *v, double now)
{
    const double so_far = now - it.step_s;
    const bool known = !v->ended && v->share >= SHARE_LEAST && so_far >= TIME_LEAST;
    return known ? so_far * (1.0 - v->share) / v->share : nan("");
}

/* Of --time; NaN: there is none. */
static double limit_left(double now)
{
    const double most = it.args->time_s;
    return most > 0.0 ? fmax(0.0, most - (now - it.begun_s)) : nan("");
}

static void add_status_text(char text[TEXT], int *n, const char *fmt, ...) MT_PRINTF(3, 4);

static void add_status_text(char text[TEXT], int *n, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    const int more = mt_vsnprintf(text + *n, (size_t)(TEXT - *n), fmt, args);
    va_end(args);
    *n = more < 0 ? *n : *n + more < TEXT ? *n + more : TEXT - 1;
}

/* "study.json (2 of 3): search: 12 of 28 starts, 42 %, best change 0.034, about 9 s left of
 * this step, 7 s, 1209 designs evaluated": what a narrow terminal cuts matters least. */
static void words(const mt_progress_view *v, double now, char text[TEXT])
{
    char time[DURATION];
    const double step = step_left(v, now);
    const double limit = limit_left(now);
    int n = 0;
    text[0] = '\0';
    if (it.args->n_operands > 1) {
        add_status_text(text, &n,
                        "%s (%d of %d): ", mt_text_base_name(it.args->operands[it.operand]),
                        it.operand + 1, it.args->n_operands);
    }
    add_status_text(text, &n, "%s", v->phase);
    if (v->total > 0) {
        add_status_text(text, &n, ": %ld of %ld %s", v->done, v->total, v->unit);
    } else if (v->unit != NULL && v->done > 0) {
        add_status_text(text, &n, ": %ld %s", v->done, v->unit);
    } else if (v->unit != NULL) {
        add_status_text(text, &n, ": %s", v->unit);
    }
    if (isfinite(v->share)) {
        add_status_text(text, &n, ", %.0f %%", floor(PER_CENT * v->share));
    }
    if (v->what != NULL) {
        add_status_text(text, &n, ", best %s %.4g", v->what, v->best);
    }
    if (v->impossible) {
        add_status_text(text, &n,
                        ", no design meets all goals (proven): searching for the nearest");
    }
    if (isfinite(step)) {
        add_status_text(text, &n, ", about %s left of this step", duration(step, time));
    }
    if (isfinite(limit)) {
        add_status_text(text, &n, ", %s left of --time", duration(limit, time));
    }
    add_status_text(text, &n, ", %s", duration(now - it.begun_s, time));
    if (v->evaluations > 0) {
        add_status_text(text, &n, ", %ld designs evaluated", v->evaluations);
    }
    if (v->solutions > 0) {
        add_status_text(text, &n, ", %ld modal solutions", v->solutions);
    }
    if (v->boxes > 0) {
        add_status_text(text, &n, ", %ld boxes", v->boxes);
    }
}

/* A line of progress, as schemas/progress.schema.json. */
typedef struct progress_line {
    const char *file;
    int number;
    int files;
    const char *state;
    mt_progress_view view;
    double best;
    double left_s;
    double first_cpu_s;
    double best_cpu_s;
    double proof_cpu_s;
    double cpu_s;
    double elapsed_s;
    long first_evaluations; /* -1: there is none */
    long best_evaluations;
} progress_line;

static const char *const STATES[] = {"running", "done", "ended"};
static const char *const PHASES[] = {
    "reading",      "baseline",    "search",    "recommendations", "spread",
    "certificates", "relaxations", "published", "trade",           "modes"};

#define THIS progress_line
static const mt_field PROGRESS_FIELDS[] = {
    MT_F_FORMAT("format", "modetune-progress/1", "Kind and version of this object."),
    MT_F_TEXT("file", file, "The study or model, as the command line names it.",
              .rules = "\"minLength\": 1"),
    MT_F_COUNT("number", number, 1, "Which of the files that is, from 1."),
    MT_F_COUNT("files", files, 1, "How many files the command was given."),
    MT_F_CHOICE("state", state, STATES,
                "\"running\"; or the last word of reading or answering: \"done\", or \"ended\" "
                "where something was cut or failed."),
    MT_F_CHOICE("phase", view.phase, PHASES,
                "\"reading\"; of a study \"baseline\" (the original design, and what follows "
                "from the question alone), then the lists of the result that are being made; "
                "of a model \"modes\"."),
    MT_F_LONG("step", view.step,
              "Counts what has begun, phases and steps of them, from 1 for each file; never "
              "the same again where a phase comes again. How many there will be is not known.",
              .least = 1),
    MT_F_TEXT_OR_NULL(
        "unit", view.unit,
        "What the step consists of: goals, first values (of starts), starts, ends of "
        "searches, mode placements, combinations, lots of combinations, boxes of "
        "combinations, changes of the question, designs, designs decided (by a proof), "
        "points, stretches of points, points again (from their neighbours), equations, order "
        "of the bodies, matrices of the bodies, iterations."),
    MT_F_LONG("done", view.done, "How many of them are done."),
    MT_F_LONG_OR_NULL("total", view.total, 1, "Of how many."),
    MT_F_NUMBER_OR_NULL(
        "share", view.share,
        "Share of the step that is done; of a proof, the share of all designs that is "
        "decided. Never less than before in the same step; 1 where the state is "
        "\"done\".",
        .rules = "\"minimum\": 0, \"maximum\": 1"),
    MT_F_LONG("evaluations", view.evaluations, "Designs evaluated so far, of all steps."),
    MT_F_LONG("modal_solutions", view.solutions,
              "Modal solutions so far: of one configuration at one design, one position of a "
              "drive or one corner of the tolerances each."),
    MT_F_LONG("boxes", view.boxes, "Boxes of designs that proofs have looked at so far."),
    MT_F_TEXT_OR_NULL("objective", view.what,
                      "The first objective, once a design is known that meets all goals."),
    MT_F_NUMBER_OR_NULL(
        "best", best,
        "Its best value so far. Where designs are judged again over tolerances or "
        "positions of a drive, of those that were; not told of catalogues beside other "
        "variables there, nor of a clearance."),
    MT_F_FLAG("impossible", view.impossible,
              "It is proven that no design meets all goals, by what little work shows before "
              "the search: the nearest designs are sought, and changes of the question. "
              "false says nothing."),
    MT_F_NUMBER_OR_NULL(
        "first_cpu_s", first_cpu_s,
        "CPU time (as cpu_s) until the first design was known that meets all goals.",
        .rules = "\"minimum\": 0"),
    MT_F_LONG_OR_NULL("first_evaluations", first_evaluations, 0,
                      "Designs evaluated until then."),
    MT_F_NUMBER_OR_NULL("best_cpu_s", best_cpu_s,
                        "CPU time until the best so far was known to 1e-6 of its value.",
                        .rules = "\"minimum\": 0"),
    MT_F_LONG_OR_NULL("best_evaluations", best_evaluations, 0, "Designs evaluated until then."),
    MT_F_NUMBER_OR_NULL(
        "proof_cpu_s", proof_cpu_s,
        "CPU time until the last proof by branch and bound, of those that have settled "
        "their question so far.",
        .rules = "\"minimum\": 0"),
    MT_F_NUMBER("cpu_s", cpu_s,
                "CPU time of the process since reading or answering began, of all its threads.",
                .rules = "\"minimum\": 0"),
    MT_F_NUMBER("elapsed_s", elapsed_s, "Time since reading or answering began.",
                .rules = "\"minimum\": 0"),
    MT_F_NUMBER_OR_NULL(
        "left_s", left_s,
        "Time left of the step, if it goes on as it did, or of --time, if that is less.",
        .rules = "\"minimum\": 0"),
};
const mt_record mt_progress_record = MT_F_RECORD_OF(
    PROGRESS_FIELDS, NULL,
    "How far a command is: one object a line on standard error with `--progress json`, as "
    "every phase and step begins that lasts long enough to be seen, twice a second besides, "
    "and once at the end of reading and of answering a file. Other lines of standard error "
    "do not begin with a brace. Every member is always there; null is what there is not, or "
    "what is not known.");
#undef THIS

/* The evaluations until a mark; -1: it has not been made. */
static long evaluations_until(const mt_progress_mark *m)
{
    return isnan(m->cpu_s) ? -1 : m->evaluations;
}

/* Parts without memory are left out. */
static void put_json(const mt_progress_view *v, const char *state, double now)
{
    mt_text t = {.s = NULL};
    mt_json_writer w = mt_json_writer_default(&t);
    const double step = step_left(v, now);
    const double limit = limit_left(now);
    const progress_line line = {
        .file = it.args->operands[it.operand],
        .number = it.operand + 1,
        .files = it.args->n_operands,
        .state = state,
        .view = *v,
        .best = v->what == NULL ? nan("") : v->best,
        .first_cpu_s = v->first.cpu_s - it.begun_cpu_s,
        .first_evaluations = evaluations_until(&v->first),
        .best_cpu_s = v->best_at.cpu_s - it.begun_cpu_s,
        .best_evaluations = evaluations_until(&v->best_at),
        .proof_cpu_s = v->proof.cpu_s - it.begun_cpu_s,
        .cpu_s = terminal_cpu_seconds() - it.begun_cpu_s,
        .elapsed_s = now - it.begun_s,
        .left_s = isfinite(step) ? fmin(step, limit) : limit,
    };
    mt_json_open_flat(&w, NULL, '{');
    mt_record_put(&w, &mt_progress_record, &line);
    mt_json_close(&w);
    if (mt_json_done(&w)) {
        mt_terminal_write(t.s, t.length);
    }
    mt_text_free(&t);
}

/* Read the progress once, and report it where it is time. */
static void report_progress(void)
{
    const mt_progress_view v = mt_progress_read(&it.progress);
    const double now = mt_terminal_seconds();
    const bool changed = v.step != it.last.step;
    const bool news = v.impossible && !it.told_impossible && now - it.begun_s >= TIME_LEAST;
    char text[TEXT];
    it.step_s = changed ? now : it.step_s;
    it.last = v;
    switch (it.reader) {
    case READER_TERMINAL:
        words(&v, now, text);
        terminal_line(text);
        break;
    case READER_LOG:
        if (news || now - it.told_s >= PLAIN_S) {
            it.told_impossible = v.impossible;
            words(&v, now, text);
            mt_terminal_talk(false, "%s", text);
            it.told_s = now;
        }
        break;
    case READER_PROGRAM:
        if (changed || v.impossible != it.told_impossible || now - it.told_s >= JSON_S) {
            it.told_impossible = v.impossible;
            put_json(&v, "running", now);
            it.told_s = now;
        }
        break;
    case READER_NONE:
        break;
    }
}

static bool turn(void *unused)
{
    struct pollfd over = {.fd = it.over[0], .events = POLLIN};
    (void)unused;
    const bool goes_on = poll(&over, 1, LOOK_MS) == 0;
    if (goes_on) {
        report_progress();
    }
    return goes_on;
}

/* Start the thread, with signals blocked: the working threads handle them. */
static bool start(void)
{
    sigset_t all;
    sigset_t before;
    if (pipe(it.over) != 0) {
        return false;
    }
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    const bool started = mt_ticker_start(&it.ticker, turn, NULL);
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (!started) {
        (void)close(it.over[0]);
        (void)close(it.over[1]);
    }
    return started;
}

static void stop(void)
{
    (void)close(it.over[1]);
    mt_ticker_join(&it.ticker);
    (void)close(it.over[0]);
}

mt_progress *mt_watch_begin(const mt_args *args, int i, const char *phase)
{
    it = (watch){.args = args, .operand = i, .reader = reader_of(args)};
    if (it.reader == READER_NONE) {
        return NULL;
    }
    it.begun_s = mt_terminal_seconds();
    it.begun_cpu_s = terminal_cpu_seconds();
    it.step_s = it.begun_s;
    it.told_s = it.begun_s;
    it.has_progress = mt_progress_init(&it.progress, NULL) == MT_OK;
    if (!it.has_progress) {
        return NULL;
    }
    it.progress.clock = terminal_cpu_seconds;
    mt_progress_phase(&it.progress, phase, false);
    if (it.reader == READER_PROGRAM) {
        report_progress();
    }
    it.has_ticker = start();
    return &it.progress;
}

void mt_watch_hold(void)
{
    if (it.has_ticker) {
        stop();
        it.has_ticker = false;
        if (it.reader == READER_TERMINAL) {
            terminal_line(NULL);
        }
    }
}

void mt_watch_go_on(void)
{
    it.has_ticker = it.has_progress && start();
}

void mt_watch_end(bool complete)
{
    mt_watch_hold();
    if (it.has_progress && it.reader == READER_PROGRAM) {
        mt_progress_view v = mt_progress_read(&it.progress);
        v.share = complete ? 1.0 : v.share;
        put_json(&v, complete ? "done" : "ended", mt_terminal_seconds());
    }
    if (it.has_progress) {
        mt_progress_free(&it.progress);
    }
    it.has_progress = false;
}

/* --timing: how often each stage of the evaluations was done. */

static const double NANOSECOND = 1e-9;

/* Digits of a time. */
enum { SECONDS_DIGITS = 3 };

mt_profile *mt_cli_profile(const mt_args *args, mt_profile *own)
{
    if (!args->given[MT_OPT_TIMING]) {
        return NULL;
    }
    mt_profile_init(own, mt_terminal_seconds);
    return own;
}

int mt_cli_profile_print(mt_profile *p)
{
    if (p == NULL) {
        return MT_EXIT_DONE;
    }
    mt_text text = {.s = NULL};
    mt_table t = mt_table_default();
    int code = MT_EXIT_DONE;
    mt_table_column(&t, "stage", "stage", MT_ALIGN_LEFT);
    mt_table_column(&t, "done", "done", MT_ALIGN_RIGHT);
    mt_table_column(&t, "shared", "shared", MT_ALIGN_RIGHT);
    mt_table_column(&t, "skipped", "skipped", MT_ALIGN_RIGHT);
    mt_table_column(&t, "time [s]", "time_s", MT_ALIGN_POINT);
    mt_table_column(&t, "what it is", "what", MT_ALIGN_LEFT);
    for (int i = 0; i < MT_STAGES; i++) {
        mt_table_text(&t, mt_stage_name((mt_stage_id)i));
        mt_table_integer(&t, atomic_load(&p->done[i]));
        mt_table_integer(&t, atomic_load(&p->shared[i]));
        mt_table_integer(&t, atomic_load(&p->skipped[i]));
        mt_table_number(&t, NANOSECOND * (double)atomic_load(&p->nanoseconds[i]),
                        SECONDS_DIGITS);
        mt_table_text(&t, mt_stage_text((mt_stage_id)i));
    }
    mt_table_print(&t, 2, mt_terminal_width(), &text);
    if (text.failed) {
        mt_err err;
        code = mt_cli_failed(mt_fail_memory(&err), &err);
    } else {
        print_diagnostics(text.s);
    }
    mt_table_free(&t);
    mt_text_free(&text);
    return code;
}
