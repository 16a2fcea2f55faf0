/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Every place that asks an arena for memory, from the command line to what is printed, is
 * refused once: the command says so with the exit status of a shortage and gives everything
 * back. So it does where the system itself runs out, at any allocation.
 */
#include <fcntl.h>
#include <gsl/gsl_errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/cli.h"
#include "mt_alloc.h"
#include "mt_sites.h"
#include "mt_test.h"

enum { MOST_WORDS = 16, ALLOCATIONS_TRIED = 60 };

static int catcher; /* file that standard output goes to */
static char folder[] = "/tmp/mt_commands_XXXXXX";

#define MODELS "tests/models/"
static const struct {
    const char *words; /* separated by blanks; @: the folder for results */
    int code;
} commands[] = {
    {"modes --shapes --damped " MODELS "space_body.json", MT_EXIT_DONE},
    {"modes --shapes --format json " MODELS "space_stick.json", MT_EXIT_DONE},
    {"modes -c damped --damped --set kr=900 " MODELS "space_body.json", MT_EXIT_DONE},
    {"modes --damped --format json " MODELS "space_body.json", MT_EXIT_DONE},
    {"modes --damped --format csv " MODELS "space_body.json", MT_EXIT_DONE},
    {"modes --damped -c named " MODELS "damped_linkage.json", MT_EXIT_DONE},
    {"modes --shapes --set h=0.11 --format csv " MODELS "space_frame.json", MT_EXIT_DONE},
    {"modes " MODELS "driven_rod.json", MT_EXIT_DONE},
    {"modes " MODELS "ring.json", MT_EXIT_DONE},
    {"mac " MODELS "space_frame.json:loaded " MODELS "space_frame.json:weightless",
     MT_EXIT_DONE},
    {"mac --format json " MODELS "space_frame.json:loaded " MODELS
     "space_frame.json:weightless",
     MT_EXIT_DONE},
    {"mac --format csv " MODELS "driven_rod.json:sprung " MODELS "driven_rod.json:locked",
     MT_EXIT_DONE},
    {"sensitivity " MODELS "space_frame.json", MT_EXIT_DONE},
    {"sensitivity --format json " MODELS "ring.json", MT_EXIT_DONE},
    {"sensitivity --format csv " MODELS "driven_rod.json", MT_EXIT_DONE},
    {"response --input tip.x --measure tip.y:velocity --sensitivity k -c still --points 3 "
     "--from 1 --to 2 " MODELS "four_bar.json",
     MT_EXIT_DONE},
    {"response --vibration tests/documents/good/profile.json --input base.y -c still --points "
     "3 "
     "--format csv " MODELS "four_bar.json",
     MT_EXIT_DONE},
    {"info " MODELS "space_stick.json", MT_EXIT_DONE},
    {"info --format json " MODELS "space_four_bar.json", MT_EXIT_DONE},
    {"info --format csv " MODELS "four_bar.json", MT_EXIT_DONE},
    {"info tests/documents/good/study_full.json", MT_EXIT_DONE},
    {"info --format json problems/measurements/three_masses.csv", MT_EXIT_DONE},
    {"info --format csv tests/documents/good/profile.json", MT_EXIT_DONE},
    {"info problems/aircraft.json", MT_EXIT_DONE},
    {"info tests/result/written_by/2026-11-27/inceptor_tuning_1.1-of-2.journal", MT_EXIT_DONE},
    {"sweep --drive pivot=-0.1:0.1:3 --frequencies " MODELS "driven_rod.json", MT_EXIT_DONE},
    {"simulate --vibration base.y=tests/documents/good/profile.json -c still --duration 0.01 "
     "--format "
     "json " MODELS "four_bar.json",
     MT_EXIT_DONE},
    {"simulate -c still --start jA=0.1 --rate jA=1 --duration 0.05 --format json " MODELS
     "four_bar.json",
     MT_EXIT_DONE},
    {"simulate -c still --input jA=0.1*t --input base.x=sin(9*t) --duration 0.01 " MODELS
     "four_bar.json",
     MT_EXIT_DONE},
    {"simulate -c still --start-mode 1:1e-3 --duration 0.9 --dt-out 0.1 --format csv " MODELS
     "four_bar.json",
     MT_EXIT_DONE},
    {"check --format json tests/schema/space.json tests/schema/plane.json", MT_EXIT_DONE},
    {"check tests/documents/good/study_full.json problems/aircraft.json "
     "studies/engine_orders.json",
     MT_EXIT_INPUT},
    {"check tests/documents/wrong/dampers.json", MT_EXIT_INPUT},
    {"check --format sarif tests/documents/wrong/dampers.json tests/schema/plane.json",
     MT_EXIT_INPUT},
    {"run --threads 1 -o @ --quiet studies/engine_orders.json", MT_EXIT_DONE},
    {"run --threads 1 -o @ --quiet studies/inceptor_tuning_2.json", MT_EXIT_DONE},
    {"compare --threads 1 --format json studies/inceptor_catalogue.json", MT_EXIT_DONE},
    {"compare --threads 1 --set m_raft=21 --starts 4 studies/engine_orders.json", MT_EXIT_DONE},
    {"check @/engine_orders/result.json", MT_EXIT_DONE},
    {"info @/engine_orders", MT_EXIT_DONE},
    {"info --format json @/engine_orders/timing.json", MT_EXIT_DONE},
    {"examples", MT_EXIT_DONE},
    {"schema --format json", MT_EXIT_DONE},
    {"profile --spectrum 10:90:3 tests/documents/good/profile.json", MT_EXIT_DONE},
    {"profile --format json helicopter_uh60_cargo", MT_EXIT_DONE},
    {"check tests/documents/wrong/profile_members.json", MT_EXIT_INPUT},
    {"diff @/engine_orders @/inceptor_tuning_2", MT_EXIT_GOALS},
    {"diff --format json @/engine_orders @/inceptor_tuning_2", MT_EXIT_GOALS},
    {"diff --rel-tol 0.1 --format csv @/engine_orders @/inceptor_tuning_2", MT_EXIT_GOALS},
    {"apply --root / --model problems/engine_accessory.json @/engine_orders/result.json",
     MT_EXIT_DONE},
};

/* What the last command printed. */
static char printed[1 << 20];
static size_t n_printed;

static void read_printed(int file)
{
    n_printed = 0;
    (void)lseek(file, 0, SEEK_SET);
    for (ssize_t got = 1; got > 0 && n_printed < sizeof printed;) {
        got = read(file, printed + n_printed, sizeof printed - n_printed);
        n_printed += got > 0 ? (size_t)got : 0;
    }
}

/* Run a command line as the program would, and keep what it prints. */
static int run(const char *line)
{
    char expanded[1024];
    char program[] = "modetune";
    char *argv[MOST_WORDS + 2] = {program};
    int argc = 1;
    size_t at = 0;
    for (const char *p = line; *p != '\0' && at + sizeof folder < sizeof expanded; p++) {
        if (*p == '@') {
            at += (size_t)snprintf(expanded + at, sizeof expanded - at, "%s", folder);
        } else {
            expanded[at++] = *p;
        }
    }
    expanded[at] = '\0';
    char *rest = NULL;
    for (char *word = strtok_r(expanded, " ", &rest); word != NULL && argc <= MOST_WORDS;
         word = strtok_r(NULL, " ", &rest)) {
        argv[argc++] = word;
    }
    (void)fflush(stdout);
    (void)fflush(stderr);
    const int nowhere = open("/dev/null", O_WRONLY);
    const int out = dup(STDOUT_FILENO);
    const int err = dup(STDERR_FILENO);
    (void)ftruncate(catcher, 0);
    (void)lseek(catcher, 0, SEEK_SET);
    (void)dup2(catcher, STDOUT_FILENO);
    (void)dup2(nowhere, STDERR_FILENO);
    (void)gsl_set_error_handler_off(); /* as main does */
    const int code = mt_cli_main(argc, argv);
    (void)fflush(stdout);
    (void)fflush(stderr);
    (void)dup2(out, STDOUT_FILENO);
    (void)dup2(err, STDERR_FILENO);
    (void)close(out);
    (void)close(err);
    (void)close(nowhere);
    read_printed(catcher);
    return code;
}

static char whole[sizeof printed];
static size_t n_whole;

static void keep(void)
{
    memcpy(whole, printed, n_printed);
    n_whole = n_printed;
}

/* Memory for what this form of output does not show (a table beside JSON) is not missed: the
 * command must print what it prints otherwise, byte by byte. */
static bool as_ever(int code, int expected)
{
    return code == expected && n_printed == n_whole && memcmp(printed, whole, n_whole) == 0;
}

/* Every place, else every twentieth; fewer where a sanitizer looks on. */
static int stride(void)
{
    const bool watched = getenv("MT_INSTRUMENTED") != NULL;
    return getenv("MT_EVERY") != NULL ? (watched ? 3 : 1) : watched ? 25 : 20;
}

static void places__each_is_refused_once(mt_test *t)
{
    for (int i = 0; i < MT_COUNT(commands); i++) {
        mt_test_row(t, "%s", commands[i].words);
        mt_sites_record();
        CHECK_INT(t, run(commands[i].words), commands[i].code);
        const int n = mt_sites_stop();
        keep();
        CHECK(t, n > 0 && n < MT_SITES_MOST);
        for (int k = 0; k < n; k += stride()) {
            if (mt_sites_known(k)) {
                continue;
            }
            const long before = mt_alloc_live();
            mt_test_row(t, "%s: place %d of %d", commands[i].words, k, n);
            mt_sites_fail(k);
            const int code = run(commands[i].words);
            CHECK(t, mt_sites_failed());
            (void)mt_sites_stop();
            if (!as_ever(code, commands[i].code)) {
                CHECK_INT(t, code, MT_EXIT_SYSTEM);
            }
            CHECK(t, !mt_alloc_works() || mt_alloc_live() == before);
        }
    }
}

static void system__refuses_at_any_allocation(mt_test *t)
{
    for (int i = 0; i < MT_COUNT(commands) && mt_alloc_works(); i++) {
        if (strncmp(commands[i].words, "run ", 4) == 0) {
            continue; /* the search answers for its own: tests/answer */
        }
        mt_test_row(t, "%s", commands[i].words);
        const long first = mt_alloc_count();
        CHECK_INT(t, run(commands[i].words), commands[i].code);
        const long n = mt_alloc_count() - first;
        keep();
        const long step = n / ALLOCATIONS_TRIED + 1;
        for (long k = 0; k < n; k += step * stride()) {
            const long before = mt_alloc_live();
            mt_test_row(t, "%s: allocation %ld of %ld", commands[i].words, k, n);
            mt_alloc_fail_after(k);
            const int code = run(commands[i].words);
            mt_alloc_fail_after(-1);
            if (!as_ever(code, commands[i].code)) {
                CHECK_INT(t, code, MT_EXIT_SYSTEM);
            }
            CHECK(t, mt_alloc_live() == before);
        }
    }
}

static void commands__tell_every_shortage(mt_test *t)
{
    static const char *const left[] = {"engine_orders", "inceptor_tuning_2"};
    static const char *const files[] = {"result.json", "recommendations.csv", "report.html",
                                        "trade.csv",   "curves.csv",          "timing.json"};
    FILE *const file = tmpfile();
    catcher = file == NULL ? -1 : fileno(file);
    if (!CHECK(t, catcher >= 0 && chdir(MT_TEST_SOURCE_DIR) == 0 && mkdtemp(folder) != NULL)) {
        return;
    }
    places__each_is_refused_once(t);
    system__refuses_at_any_allocation(t);
    for (int i = 0; i < MT_COUNT(left); i++) {
        char path[256];
        for (int k = 0; k < MT_COUNT(files); k++) {
            (void)snprintf(path, sizeof path, "%s/%s/%s", folder, left[i], files[k]);
            (void)unlink(path);
        }
        (void)snprintf(path, sizeof path, "%s/%s.journal", folder, left[i]);
        (void)unlink(path); /* of a run that was cut */
        (void)snprintf(path, sizeof path, "%s/%s.journal.old", folder, left[i]);
        (void)unlink(path);
        (void)snprintf(path, sizeof path, "%s/%s", folder, left[i]);
        CHECK(t, rmdir(path) == 0);
    }
    CHECK(t, rmdir(folder) == 0);
    (void)fclose(file);
}

MT_TEST_MAIN(MT_TEST(commands__tell_every_shortage))
