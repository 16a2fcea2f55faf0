/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/watch.h"

#include <math.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include "base/format.h"
#include "base/run.h"
#include "cli/cli.h"

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
    return mt_terminal_is_watched() ? READER_TERMINAL : READER_LOG;
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

static void put_mark(mt_json_writer *w, const char *time, const char *evaluations,
                     const mt_progress_mark *m)
{
    mt_json_put_number(w, time, m->cpu_s - it.begun_cpu_s);
    if (isnan(m->cpu_s)) {
        mt_json_put_null(w, evaluations);
    } else {
        mt_json_put_integer(w, evaluations, m->evaluations);
    }
}

/* Write progress as in schemas/progress.schema.json. Parts without memory are left out. */
static void put_json(const mt_progress_view *v, const char *state, double now)
{
    mt_text t = {.s = NULL};
    mt_json_writer w = mt_json_writer_default(&t);
    const double step = step_left(v, now);
    const double limit = limit_left(now);
    mt_json_open_flat(&w, NULL, '{');
    mt_json_put_string(&w, "format", "modetune-progress/1");
    mt_json_put_string(&w, "file", it.args->operands[it.operand]);
    mt_json_put_integer(&w, "number", it.operand + 1);
    mt_json_put_integer(&w, "files", it.args->n_operands);
    mt_json_put_string(&w, "state", state);
    mt_json_put_string(&w, "phase", v->phase);
    mt_json_put_integer(&w, "step", v->step);
    mt_json_put_string(&w, "unit", v->unit);
    mt_json_put_integer(&w, "done", v->done);
    if (v->total > 0) {
        mt_json_put_integer(&w, "total", v->total);
    } else {
        mt_json_put_null(&w, "total");
    }
    mt_json_put_number(&w, "share", v->share);
    mt_json_put_integer(&w, "evaluations", v->evaluations);
    mt_json_put_integer(&w, "modal_solutions", v->solutions);
    mt_json_put_integer(&w, "boxes", v->boxes);
    mt_json_put_string(&w, "objective", v->what);
    mt_json_put_number(&w, "best", v->what == NULL ? nan("") : v->best);
    mt_json_put_bool(&w, "impossible", v->impossible);
    put_mark(&w, "first_cpu_s", "first_evaluations", &v->first);
    put_mark(&w, "best_cpu_s", "best_evaluations", &v->best_at);
    mt_json_put_number(&w, "proof_cpu_s", v->proof.cpu_s - it.begun_cpu_s);
    mt_json_put_number(&w, "cpu_s", mt_terminal_cpu_seconds() - it.begun_cpu_s);
    mt_json_put_number(&w, "elapsed_s", now - it.begun_s);
    mt_json_put_number(&w, "left_s", isfinite(step) ? fmin(step, limit) : limit);
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
        mt_terminal_line(text);
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
    it.begun_cpu_s = mt_terminal_cpu_seconds();
    it.step_s = it.begun_s;
    it.told_s = it.begun_s;
    it.has_progress = mt_progress_init(&it.progress, NULL) == MT_OK;
    if (!it.has_progress) {
        return NULL;
    }
    it.progress.clock = mt_terminal_cpu_seconds;
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
            mt_terminal_line(NULL);
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
