/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The k-th allocation is refused, or all from the k-th on, in every command, whoever asks for
 * it: our own rooms, cJSON, NLopt, GSL, LAPACKE, the C library. Requests of our arenas, which
 * hand out most memory without asking the system, are numbered with them. Each time the command
 * runs in a process of its own, which has to end as ever (the same exit status, output and
 * files to the byte: an allocation that is not missed) or with the exit status of a shortage, a
 * message, and nothing half done. It may not crash, hang, leak (in instrumented builds), call a
 * file wrong, or answer otherwise.
 *
 *     test_allocation_sites                            a sample, of a seed that is printed;
 *                                                      places that ask for memory come first
 *     test_allocation_sites --seed S --count N         N of each command
 *     test_allocation_sites --all                      every k of every command, both ways:
 *                                                      hours
 *     test_allocation_sites --line 1 "run -o @ FILE" ...    of this command line, which ends
 *                                                           with 1 where nothing is refused
 *     test_allocation_sites --only 7 --at 42 [--on]    one of them again (--on: all from the
 *                                                      42nd on); with MT_ALLOCATIONS_TALK=1 it
 *                                                      says who asked
 */
#define _GNU_SOURCE /* memmem, MAP_ANONYMOUS; NOLINT(cert-dcl37-c,cert-dcl51-cpp) */
#include <execinfo.h>
#include <gsl/gsl_errno.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "cli/cli.h"
#include "linalg/dense.h"
#include "mt_alloc.h"
#include "mt_child.h"
#include "mt_random.h"
#include "mt_sites.h"
#include "mt_test.h"

enum {
    MOST_ASKED = 1 << 20,
    SECONDS_MOST = 120, /* for one run: what takes longer hangs */
};

/* A part of the sample, in per cent: runs of the search take longer than all else. */
enum { FULL = 100, SOME = 25, FEW = 10 };

#define MODELS "tests/models/"
#define WRONG  "tests/documents/wrong/"
static struct {
    /* separated by blanks; @: a folder for results, empty before each run; %: one with a
     * result */
    const char *words;
    int code;
    int share;
} commands[] = {
    {"--version", MT_EXIT_DONE, FULL},
    {"--help", MT_EXIT_DONE, FULL},
    {"run --help", MT_EXIT_DONE, FULL},
    {"--manual", MT_EXIT_DONE, FULL},
    {"runn", MT_EXIT_INPUT, FULL},
    {"help", MT_EXIT_DONE, FULL},
    {"help margin_percent", MT_EXIT_DONE, FULL},
    {"help marign", MT_EXIT_INPUT, FULL},
    {"modes --shapes --damped " MODELS "space_body.json", MT_EXIT_DONE, FULL},
    {"modes --shapes --set h=0.11 --format json " MODELS "space_frame.json", MT_EXIT_DONE,
     FULL},
    {"modes --damped --format csv " MODELS "space_body.json", MT_EXIT_DONE, FULL},
    {"modes --damped -c named " MODELS "damped_linkage.json", MT_EXIT_DONE, FULL},
    {"info -c all " MODELS "damped_linkage.json", MT_EXIT_DONE, FULL},
    {"check " WRONG "damping.json", MT_EXIT_INPUT, FULL},
    {"modes --set mas=1 " MODELS "ring.json", MT_EXIT_INPUT, FULL},
    {"modes -c nowhere " MODELS "ring.json", MT_EXIT_INPUT, FULL},
    {"mac " MODELS "space_frame.json:loaded " MODELS "space_frame.json:weightless",
     MT_EXIT_DONE, FULL},
    {"mac --format json " MODELS "driven_rod.json:sprung " MODELS "driven_rod.json:locked",
     MT_EXIT_DONE, FULL},
    {"mac --format csv " MODELS "driven_rod.json:sprung " MODELS "driven_rod.json:locked",
     MT_EXIT_DONE, FULL},
    {"sensitivity " MODELS "space_frame.json", MT_EXIT_DONE, FULL},
    {"sensitivity --format json " MODELS "ring.json", MT_EXIT_DONE, FULL},
    {"sensitivity --format csv --parameters mas " MODELS "ring.json", MT_EXIT_INPUT, FULL},
    {"info " MODELS "space_stick.json", MT_EXIT_DONE, FULL},
    {"info --format json " MODELS "space_four_bar.json", MT_EXIT_DONE, FULL},
    {"info --format csv " MODELS "four_bar.json", MT_EXIT_DONE, FULL},
    {"info --format json tests/documents/good/study_full.json", MT_EXIT_DONE, SOME},
    {"info tests/result/written_by/2026-11-27/inceptor_tuning_1.1-of-2.journal", MT_EXIT_DONE,
     SOME},
    {"info problems/measurements/three_masses.csv", MT_EXIT_DONE, SOME},
    {"sweep --drive pivot=-0.1:0.1:3 --frequencies " MODELS "driven_rod.json", MT_EXIT_DONE,
     FULL},
    {"sweep --drive pivot=-0.1:0.1:3 --format json " MODELS "driven_rod.json", MT_EXIT_DONE,
     FULL},
    {"sweep --drive pivo=-0.1:0.1:3 --format csv " MODELS "driven_rod.json", MT_EXIT_INPUT,
     FULL},
    {"simulate --vibration base.y=tests/documents/good/profile.json -c still --duration "
     "0.01 " MODELS "four_bar.json",
     MT_EXIT_DONE, SOME},
    {"simulate -c loaded --duration 0.02 --start jA=0.1 --rate jA=1 " MODELS
     "space_four_bar.json",
     MT_EXIT_DONE, FULL},
    {"simulate -c still --start-mode 1:1e-3 --duration 0.9 --dt-out 0.1 --format json " MODELS
     "four_bar.json",
     MT_EXIT_DONE, FULL},
    {"simulate -c still --input jA=0.1*t --input base.x=sin(9*t) --input tip.x=t --duration "
     "0.01 "
     "--format csv " MODELS "four_bar.json",
     MT_EXIT_DONE, FULL},
    {"check --format json tests/schema/space.json tests/schema/plane.json", MT_EXIT_DONE, FULL},
    {"check tests/documents/good/study_full.json problems/aircraft.json "
     "studies/engine_orders.json",
     MT_EXIT_INPUT, FULL},
    {"check --format csv " WRONG "dampers.json " WRONG "study_unknown_names.json",
     MT_EXIT_INPUT, FULL},
    {"check " WRONG "study_model_wrong.json " WRONG "links.json " WRONG "circle.json",
     MT_EXIT_INPUT, FULL},
    {"check " WRONG "syntax_many.json " WRONG "unknown_members.json " WRONG "types.json",
     MT_EXIT_INPUT, FULL},
    {"check --format json " WRONG "study_model_outside.json " WRONG "study_model_missing.json",
     MT_EXIT_INPUT, FULL},
    {"check %/engine_orders/result.json", MT_EXIT_DONE, FULL},
    {"profile --spectrum 10:90:3 tests/documents/good/profile.json", MT_EXIT_DONE, FULL},
    {"profile --format json helicopter_uh60_cargo", MT_EXIT_DONE, FULL},
    {"profile --format csv white", MT_EXIT_DONE, FULL},
    {"profile " WRONG "profile_tones.json", MT_EXIT_INPUT, FULL},
    {"show " MODELS "space_frame.json", MT_EXIT_DONE, SOME},
    {"show --format json -o @/scene.json " MODELS "driven_rod.json", MT_EXIT_DONE, SOME},
    {"show --svg --mode 1 " MODELS "ring.json", MT_EXIT_DONE, FULL},
    {"show --root / --format json %/engine_orders/result.json", MT_EXIT_DONE, SOME},
    {"show --mode 1 " MODELS "ring.json", MT_EXIT_INPUT, FULL},
    {"report --verify %/engine_orders/result.json", MT_EXIT_DONE, FULL},
    {"report --format html -o @ %/engine_orders/result.json", MT_EXIT_DONE, FULL},
    {"explain %/engine_orders/result.json", MT_EXIT_DONE, FULL},
    {"explain --format csv %/engine_orders/result.json", MT_EXIT_DONE, FULL},
    {"explain --format json %/engine_orders/result.json", MT_EXIT_DONE, FULL},
    {"apply --root / %/engine_orders/result.json", MT_EXIT_DONE, FULL},
    {"apply --root / --model problems/engine_accessory.json %/engine_orders/result.json",
     MT_EXIT_DONE, FULL},
    {"apply --root / --model problems/beam_lumped.json %/engine_orders/result.json",
     MT_EXIT_INPUT, FULL},
    {"apply --rank 9 %/engine_orders/result.json", MT_EXIT_INPUT, FULL},
    {"compare --threads 1 --format json studies/inceptor_catalogue.json", MT_EXIT_DONE, SOME},
    {"compare --threads 1 studies/beam_table_3.json", MT_EXIT_DONE, SOME},
    {"compare --threads 1 --format csv studies/engine_orders.json", MT_EXIT_DONE, SOME},
    {"compare --threads 1 --set m_raft=21 --starts 4 studies/engine_orders.json", MT_EXIT_DONE,
     SOME},
    {"compare --set m_raf=21 studies/engine_orders.json", MT_EXIT_INPUT, FULL},
    {"check --format sarif " WRONG "study_bounds.json " MODELS "ring.json", MT_EXIT_INPUT,
     FULL},
    {"diff %/engine_orders %/engine_orders/result.json", MT_EXIT_DONE, FULL},
    {"run --threads 1 -o @ studies/engine_orders.json", MT_EXIT_DONE, SOME},
    {"run -o @ --threads 1 --shard 1/2 studies/engine_orders.json", MT_EXIT_DONE, SOME},
    {"run -o @ --threads 1 --shard 1/2 studies/inceptor_tuning_1.json", MT_EXIT_DONE, SOME},
    {"merge -o @ --threads 1 studies/engine_orders.json %/engine_orders.1-of-2.journal",
     MT_EXIT_DONE, SOME},
    {"run -o @ --threads 2 studies/inceptor_tuning_2.json", MT_EXIT_DONE, SOME},
    /* (as text it ends with a table that has times) */
    {"run --threads 1 -o @ --format csv studies/inceptor_catalogue.json "
     "studies/engine_orders.json",
     MT_EXIT_DONE, SOME},
    {"run --threads 1 -o @ --format json studies/inceptor_stick.json", MT_EXIT_DONE, SOME},
    {"run --threads 1 -o @ --verify --format csv studies/beam_table_4.json", MT_EXIT_DONE,
     SOME},
    {"run --threads 1 -o @ studies/six_masses_infeasible.json", MT_EXIT_GOALS, FEW},
    {"run --threads 1 -o @ studies/inceptor_trade.json", MT_EXIT_DONE, FEW},
    {"run --threads 1 -o @ studies/six_masses_bands.json", MT_EXIT_DONE, FEW},
    {"run --threads 1 -o @ " WRONG "study_bounds.json", MT_EXIT_INPUT, FULL},
    {"response --input base.x --measure tip.x:velocity --measure joint.pivot.x "
     "--sensitivity m,L -c hanging " MODELS "pendulum.json",
     MT_EXIT_DONE, FULL},
    {"response --vibration helicopter_uh60_panel --input base.x -c still --points 3 " MODELS
     "four_bar.json",
     MT_EXIT_DONE, FULL},
    {"response --vibration tests/documents/good/profile.json --input base.y --format json -c "
     "still "
     "--points 3 " MODELS "four_bar.json",
     MT_EXIT_DONE, SOME},
    {"response --input tip.x --format json --sensitivity a,k -c still --points 3 " MODELS
     "four_bar.json",
     MT_EXIT_DONE, FULL},
};

typedef mt_child_text text;
typedef mt_child_left left;

/* Which allocations are refused. */
typedef struct refusal {
    long k;  /* negative: none */
    bool on; /* all from the k-th on */
} refusal;

/* What the child that refuses nothing tells its parent: who asked, and how often. */
typedef struct asked {
    _Atomic long n;
    struct {
        const void *caller;
        size_t size;
    } by[MOST_ASKED];
} asked;
static asked *heard;

static void hear(const void *caller, size_t size)
{
    const long i = heard->n++;
    if (i < MOST_ASKED) {
        heard->by[i].caller = caller;
        heard->by[i].size = size;
    }
}

/* With --at: where the first refused request comes from, for addr2line. */
static int shown = -1; /* standard error of the test */
static long to_show;

static void show(const void *caller, size_t size)
{
    void *calls[32];
    if (to_show-- == 0) {
        (void)dprintf(shown, "  %zu bytes, asked for at %p, by\n", size, caller);
        backtrace_symbols_fd(calls, backtrace(calls, MT_COUNT(calls)), shown);
    }
}

/* In the child, before main. */
static void begin(void *context)
{
    const refusal r = *(const refusal *)context;
    if (shown >= 0 && r.k >= 0) {
        void *calls[1];
        (void)backtrace(calls, 1); /* which allocates the first time */
        to_show = r.k;
    }
    mt_alloc_watch(r.k < 0 ? hear : shown >= 0 ? show : NULL);
    if (r.k >= 0 && r.on) {
        mt_alloc_fail_after(r.k);
    } else if (r.k >= 0) {
        mt_alloc_fail_only(r.k);
    }
    mt_sites_ask(mt_alloc_refuses);
    mt_terminal_open();
    mt_blas_set_threads(1);
    (void)gsl_set_error_handler_off(); /* as main does */
}

/* A sanitizer that is refused memory for a new thread ends the process: is there one? */
static bool alone;

static left run(const char *line, refusal r)
{
    const mt_child p = {
        .main = mt_cli_main, .begin = begin, .context = &r, .seconds = SECONDS_MOST};
    char words[1024];
    const bool tells = strncmp(line, "modes ", 6) == 0 || strncmp(line, "compare ", 8) == 0;
    /* a thread draws it */
    (void)snprintf(words, sizeof words, "%s%s", line, alone && tells ? " --progress none" : "");
    if (r.k < 0) {
        heard->n = 0;
    }
    return mt_child_run(&p, words);
}

static bool is_timing(const char *name)
{
    const char *const slash = strrchr(name, '/');
    return slash != NULL && strcmp(slash, "/timing.json") == 0;
}

/* A journal that could not be written is told; the answer is whole without it. */
static bool is_journals_end(const char *line, size_t n)
{
    static const char told[] = ": the journal: out of memory";
    return memmem(line, n, told, strlen(told)) != NULL;
}

/* Equal, but for the seconds that a run took, and what is told of its journal. */
static bool same_text(const text *a, const text *b, bool timed)
{
    const char *p = a->s;
    const char *q = b->s;
    if (p == NULL || q == NULL) {
        return a->n == b->n;
    }
    if (!timed) {
        return a->n == b->n && memcmp(p, q, a->n) == 0;
    }
    for (;;) {
        size_t n = strcspn(p, "\n");
        if (is_journals_end(p, n)) {
            p += n + (p[n] != '\0' ? 1 : 0);
            n = strcspn(p, "\n");
        }
        if (*p == '\0' || *q == '\0') {
            return *p == *q;
        }
        const size_t m = strcspn(q, "\n");
        const bool seconds =
            memmem(p, n, "solve_s", 7) != NULL || memmem(p, n, "; written to ", 13) != NULL;
        if (!seconds && (n != m || memcmp(p, q, n) != 0)) {
            return false;
        }
        p += n + (p[n] != '\0' ? 1 : 0);
        q += m + (q[m] != '\0' ? 1 : 0);
    }
}

static const text *file_of(const left *l, const char *name)
{
    for (int i = 0; i < l->n_files; i++) {
        if (strcmp(l->name[i], name) == 0) {
            return &l->file[i];
        }
    }
    return NULL;
}

/* An index may say of a study that the shortage came in it, or before it. */
static bool tells_of_it(const char *name, const text *file)
{
    static const char *const words[] = {"not answered", "not run", "\"exit_status\": 4"};
    bool tells = false;
    for (int i = 0; i < MT_COUNT(words); i++) {
        tells = tells || memmem(file->s, file->n, words[i], strlen(words[i])) != NULL;
    }
    return tells && strstr(name, "/index.") != NULL;
}

/* What a run that is cut leaves, to be resumed. */
static bool is_journal(const char *name)
{
    static const char end[] = ".journal";
    const size_t n = strlen(name);
    return n >= strlen(end) && strcmp(name + n - strlen(end), end) == 0;
}

/* Every file that is there is one of the undisturbed run's, to the byte. */
static bool files_are_right(const left *got, const left *want)
{
    for (int i = 0; i < got->n_files; i++) {
        if (is_journal(got->name[i]) && got->code == MT_EXIT_SYSTEM) {
            continue;
        }
        const text *const other = file_of(want, got->name[i]);
        if (other == NULL || (!same_text(&got->file[i], other, is_timing(got->name[i])) &&
                              !tells_of_it(got->name[i], &got->file[i]))) {
            (void)fprintf(stderr, "  %s is %s\n", got->name[i],
                          other == NULL ? "too many" : "another");
            return false;
        }
    }
    return true;
}

static bool as_ever(const left *got, const left *want)
{
    return got->code == want->code && same_text(&got->out, &want->out, false) &&
           same_text(&got->err, &want->err, true) && got->n_files == want->n_files &&
           files_are_right(got, want);
}

/* What reached standard output is whole: nothing, or what was printed about other studies, a
 * part of what the undisturbed run prints that ends with a line. JSON is one document: all or
 * none. */
static bool output_is_whole(const left *got, const left *want, const char *line)
{
    if (got->out.n == 0) {
        return true;
    }
    return strstr(line, "--format json") == NULL
               ? memmem(want->out.s, want->out.n, got->out.s, got->out.n) != NULL &&
                     got->out.s[got->out.n - 1] == '\n'
               : same_text(&got->out, &want->out, false);
}

/* A result's folder is new as a whole, or not at all. */
static bool folder_is_whole(const left *got, const left *want, const char *line)
{
    int n = 0;
    for (int i = 0; i < got->n_files; i++) {
        n += is_journal(got->name[i]) ? 0 : 1;
    }
    return strstr(line, ".json studies/") != NULL || n == 0 || n == want->n_files;
}

static bool says_so(const left *got)
{
    return got->err.s != NULL && strstr(got->err.s, "memory") != NULL;
}

/* Does the command bear it? */
static bool bears(mt_test *t, int i, refusal r, const left *want)
{
    const int failures = t->failures;
    left got = run(commands[i].words, r);
    if (!as_ever(&got, want)) {
        mt_test_row(t, "--only %d --at %ld%s (%s)", i, r.k, r.on ? " --on" : "",
                    commands[i].words);
        CHECK_INT(t, got.code, MT_EXIT_SYSTEM);
        CHECK(t, got.code != MT_EXIT_SYSTEM || says_so(&got));
        CHECK(t, got.code != MT_EXIT_SYSTEM || output_is_whole(&got, want, commands[i].words));
        CHECK(t, files_are_right(&got, want));
        CHECK(t, folder_is_whole(&got, want, commands[i].words));
    }
    const bool ok = t->failures == failures;
    if (!ok) {
        (void)fprintf(stderr, "  it says: %.1500s\n", got.err.s == NULL ? "" : got.err.s);
    }
    mt_child_forget(&got);
    return ok;
}

/* How the sample is taken. */
typedef struct sampling {
    uint64_t seed;
    long count; /* of each command; LONG_MAX: all */
    int only;   /* command; negative: all */
    long at;    /* negative: not one alone */
    bool on;
} sampling;

/* The first requests of every place and size; their number. */
static long find_places(long n, long *first)
{
    enum { SLOTS = 1 << 16 };
    static long slot[SLOTS]; /* 1 + a request, 0: free */
    long found = 0;
    memset(slot, 0, sizeof slot);
    for (long k = 0; k < n && found < SLOTS / 2; k++) {
        const uintptr_t caller = (uintptr_t)heard->by[k].caller;
        const size_t size = heard->by[k].size;
        size_t at = (size_t)((caller ^ (size * 2654435761U)) * 2654435761U >> 8) % SLOTS;
        while (slot[at] != 0 && ((uintptr_t)heard->by[slot[at] - 1].caller != caller ||
                                 heard->by[slot[at] - 1].size != size)) {
            at = (at + 1) % SLOTS;
        }
        if (slot[at] == 0) {
            slot[at] = k + 1;
            first[found++] = k;
        }
    }
    return found;
}

/* The first request of every place and size, then others by chance; in turn alone and with all
 * that follow. */
static long sample(mt_test *t, int i, long n, long count, const left *want, mt_random *random)
{
    long *const first = calloc((size_t)n + 1, sizeof *first);
    long n_first = first == NULL ? 0 : find_places(n, first);
    long tried = 0;
    for (; tried < count && n > 0; tried++) {
        const bool new_place = n_first > 0 && tried % 3 != 2;
        const long pick = mt_random_int(random, (int)(new_place ? n_first : n));
        const refusal r = {.k = new_place ? first[pick] : pick, .on = tried % 4 == 1};
        if (new_place) {
            first[pick] = first[--n_first];
        }
        (void)bears(t, i, r, want);
    }
    free(first);
    return tried;
}

static long all(mt_test *t, int i, long n, const left *want)
{
    for (long k = 0; k < n; k++) {
        (void)bears(t, i, (refusal){.k = k}, want);
        (void)bears(t, i, (refusal){.k = k, .on = true}, want);
    }
    return 2 * n;
}

static void try_command(mt_test *t, int i, const sampling *s)
{
    mt_random random = mt_random_seed(s->seed + (uint64_t)i);
    left want = run(commands[i].words, (refusal){.k = -1});
    const long n = heard->n < MOST_ASKED ? heard->n : MOST_ASKED;
    const long count = (s->count * commands[i].share + FULL - 1) / FULL;
    long tried = 1;
    mt_test_row(t, "%d (%s), undisturbed", i, commands[i].words);
    if (!CHECK_INT(t, want.code, commands[i].code)) {
        (void)fprintf(stderr, "  it says: %.500s\n", want.err.s == NULL ? "" : want.err.s);
    } else if (s->at >= 0) {
        (void)bears(t, i, (refusal){.k = s->at, .on = s->on}, &want);
    } else if (s->count == LONG_MAX || 2 * n <= count) {
        tried = all(t, i, n, &want);
    } else {
        tried = sample(t, i, n, count, &want, &random);
    }
    if (getenv("MT_ALLOCATIONS_TALK") != NULL) {
        (void)printf("%2d: %ld of %ld  %s\n", i, tried, n, commands[i].words);
    }
    mt_child_forget(&want);
}

static bool prepare(void)
{
    heard =
        mmap(NULL, sizeof *heard, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (heard == MAP_FAILED || chdir(MT_TEST_SOURCE_DIR) != 0 || !mt_child_open()) {
        return false;
    }
    left l = run("run --threads 1 -o % --quiet studies/engine_orders.json", (refusal){.k = -1});
    bool ok = l.code == MT_EXIT_DONE;
    mt_child_forget(&l);
    l = run("run --threads 1 -o % --quiet --shard 1/2 studies/engine_orders.json",
            (refusal){.k = -1});
    ok = ok && l.code == MT_EXIT_DONE;
    mt_child_forget(&l);
    return ok;
}

static bool read_arguments(int argc, char *argv[], sampling *s)
{
    for (int i = 1; i < argc; i++) {
        const bool more = i + 1 < argc;
        if (strcmp(argv[i], "--all") == 0) {
            s->count = LONG_MAX;
        } else if (strcmp(argv[i], "--on") == 0) {
            s->on = true;
        } else if (strcmp(argv[i], "--seed") == 0 && more) {
            s->seed = strtoull(argv[++i], NULL, 10);
        } else if (strcmp(argv[i], "--count") == 0 && more) {
            s->count = strtol(argv[++i], NULL, 10);
        } else if (strcmp(argv[i], "--only") == 0 && more) {
            s->only = (int)strtol(argv[++i], NULL, 10);
        } else if (strcmp(argv[i], "--line") == 0 && i + 2 < argc) {
            s->only = 0;
            commands[0].code = (int)strtol(argv[++i], NULL, 10);
            commands[0].words = argv[++i];
        } else if (strcmp(argv[i], "--at") == 0 && more) {
            s->at = strtol(argv[++i], NULL, 10);
        } else {
            (void)fprintf(stderr, "unknown argument %s\n", argv[i]);
            return false;
        }
    }
    return true;
}

int main(int argc, char *argv[])
{
    mt_test t = mt_test_begin();
    /* the end of a process takes longest where it tells of leaks, or what was covered */
    const bool slow = getenv("MT_INSTRUMENTED") != NULL;
    const bool quick = !slow && argc == 1 && getenv("MT_EVERY") == NULL;
    alone = slow;
    sampling s = {.seed = 1, .count = slow || quick ? 6 : 10, .only = -1, .at = -1};
    if (!read_arguments(argc, argv, &s)) {
        return 2;
    }
    mt_alloc_use_beside_sanitizer();
    if (!mt_alloc_works()) {
        (void)printf("allocations cannot be refused in this build: nothing is tested\n");
        return 0;
    }
    (void)printf("seed %llu\n", (unsigned long long)s.seed);
    shown = s.at >= 0 && getenv("MT_ALLOCATIONS_TALK") != NULL ? dup(STDERR_FILENO) : -1;
    if (!CHECK(&t, prepare())) {
        return 1;
    }
    for (int i = 0; i < MT_COUNT(commands); i++) {
        const bool bearable = (!alone || strstr(commands[i].words, "--threads") == NULL) &&
                              (!quick || commands[i].share != FEW);
        if ((s.only < 0 && bearable) || s.only == i) {
            try_command(&t, i, &s);
        }
    }
    mt_child_close();
    (void)printf("%d checks, %d failed\n", t.checks, t.failures);
    return mt_test_passed(&t) ? 0 : 1;
}
