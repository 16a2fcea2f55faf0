/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every exit status that a command can have is provoked and seen, and the commands, and their
 * document, know no other. */
#include <ctype.h>
#include <gsl/gsl_errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/cli.h"
#include "linalg/dense.h"
#include "mt_alloc.h"
#include "mt_child.h"
#include "mt_test.h"

/* A body without mass that nothing holds. */
static const char GHOST[] =
    "{ \"format\": \"modetune-model/1\", \"dimension\": 2, \"parameters\": { \"m\": 0 },\n"
    "  \"bodies\": [ { \"name\": \"ghost\", \"mass_kg\": \"m\", \"centre\": [0, 0] } ],\n"
    "  \"sensors\": [ { \"name\": \"g\", \"on\": \"ghost\", \"at\": [0, 0] } ] }\n";
static const char GHOST_STUDY[] =
    "{ \"format\": \"modetune-study/1\", \"model\": \"ghost.json\",\n"
    "  \"variables\": [ { \"parameter\": \"m\", \"lower\": 0, \"upper\": 1 } ],\n"
    "  \"goals\": [ { \"type\": \"frequency\", \"mode\": 1, \"target_hz\": 1 } ] }\n";
/* No length within the bounds swings so fast; what is published is not what is found. */
static const char FAST_STUDY[] =
    "{ \"format\": \"modetune-study/1\", \"model\": \"pendulum.json\",\n"
    "  \"variables\": [ { \"parameter\": \"L\", \"lower\": 0.5, \"upper\": 2 } ],\n"
    "  \"goals\": [ { \"type\": \"frequency\", \"configuration\": \"hanging\", \"mode\": 1, "
    "\"target_hz\": 5 } ],\n"
    "  \"published\": [ { \"label\": \"status\", \"status\": \"solved\", "
    "\"role\": \"verifies\", \"source\": \"none\" } ] }\n";
static const char PENDULUM[] =
    "{ \"format\": \"modetune-model/1\", \"dimension\": 2, \"gravity_m_per_s2\": [0, -9.81],\n"
    "  \"parameters\": { \"L\": 1 },\n"
    "  \"bodies\": [ { \"name\": \"bar\", \"mass_kg\": 1, \"inertia_kg_m2\": \"L^2/12\", "
    "\"centre\": [0, \"-L/2\"] } ],\n"
    "  \"joints\": [ { \"name\": \"pivot\", \"type\": \"revolute\", \"bodies\": [\"ground\", "
    "\"bar\"], \"at\": [0, 0] } ],\n"
    "  \"configurations\": { \"hanging\": {} } }\n";

typedef enum how {
    AS_IT_IS,
    SHORT,   /* memory runs out */
    FULL,    /* the device that standard output goes to is full */
    STOPPED, /* an interrupt has come before the work begins */
} how;

#define MODELS "tests/models/"
static const struct {
    const char *words;
    int code;
    how how;
} rows[] = {
    {"--version", MT_EXIT_DONE, AS_IT_IS},
    {"--version", MT_EXIT_SYSTEM, SHORT},
    {"--help", MT_EXIT_SYSTEM, FULL},
    {"", MT_EXIT_INPUT, AS_IT_IS},

    {"run -o @ studies/engine_orders.json", MT_EXIT_DONE, AS_IT_IS},
    {"run -o @ %/fast.json", MT_EXIT_GOALS, AS_IT_IS},
    {"run -o @ --verify %/fast.json", MT_EXIT_GOALS, AS_IT_IS},
    {"run -o @ --verify studies/beam_table_3.json", MT_EXIT_DONE, AS_IT_IS},
    {"run", MT_EXIT_INPUT, AS_IT_IS},
    {"run -o @ %/none.json", MT_EXIT_SYSTEM, AS_IT_IS},
    {"run -o @ tests/documents/wrong/study_bounds.json", MT_EXIT_INPUT, AS_IT_IS},
    {"run -o @ --verify tests/install/pendulum_study.json", MT_EXIT_INPUT, AS_IT_IS},
    {"run -o @ %/ghost_study.json", MT_EXIT_NUMERICAL, AS_IT_IS},
    {"run -o /dev/null/x studies/engine_orders.json", MT_EXIT_SYSTEM, AS_IT_IS},
    {"run -o @ studies/engine_orders.json", MT_EXIT_SYSTEM, SHORT},
    {"run -o @ studies/engine_orders.json", MT_EXIT_SYSTEM, FULL},
    {"run -o @ studies/engine_orders.json", MT_EXIT_INTERRUPTED, STOPPED},
    {"run -o @ %/fast.json %/ghost_study.json studies/engine_orders.json", MT_EXIT_NUMERICAL,
     AS_IT_IS},

    {"run -o % --quiet --shard 1/1 studies/engine_orders.json", MT_EXIT_DONE, AS_IT_IS},
    {"run -o % --quiet --shard 1/1 %/fast.json", MT_EXIT_DONE, AS_IT_IS},
    {"run -o % --quiet --shard 1/1 %/ghost_study.json", MT_EXIT_NUMERICAL, AS_IT_IS},
    {"merge -o @ studies/engine_orders.json %/engine_orders.1-of-1.journal", MT_EXIT_DONE,
     AS_IT_IS},
    {"merge -o @ %/fast.json %/fast.1-of-1.journal", MT_EXIT_GOALS, AS_IT_IS},
    {"merge -o @ %/fast.json %/engine_orders.1-of-1.journal", MT_EXIT_INPUT, AS_IT_IS},
    {"merge -o @ %/ghost_study.json %/ghost_study.1-of-1.journal", MT_EXIT_NUMERICAL, AS_IT_IS},
    {"merge -o @ %/fast.json %/none.journal", MT_EXIT_SYSTEM, AS_IT_IS},
    {"merge -o @ %/fast.json %/fast.1-of-1.journal", MT_EXIT_SYSTEM, SHORT},
    {"merge -o @ %/fast.json %/fast.1-of-1.journal", MT_EXIT_INTERRUPTED, STOPPED},

    {"compare studies/beam_table_3.json", MT_EXIT_DONE, AS_IT_IS},
    {"compare %/fast.json", MT_EXIT_GOALS, AS_IT_IS},
    {"compare tests/documents/wrong/study_bounds.json", MT_EXIT_INPUT, AS_IT_IS},
    {"compare %/ghost_study.json", MT_EXIT_NUMERICAL, AS_IT_IS},
    {"compare studies/beam_table_3.json", MT_EXIT_SYSTEM, SHORT},
    {"compare studies/beam_table_3.json", MT_EXIT_SYSTEM, FULL},

    {"modes " MODELS "ring.json", MT_EXIT_DONE, AS_IT_IS},
    {"modes -c nowhere " MODELS "ring.json", MT_EXIT_INPUT, AS_IT_IS},
    {"modes %/ghost.json", MT_EXIT_NUMERICAL, AS_IT_IS},
    {"modes " MODELS "ring.json", MT_EXIT_SYSTEM, SHORT},
    {"modes " MODELS "ring.json", MT_EXIT_SYSTEM, FULL},

    {"mac " MODELS "driven_rod.json:sprung " MODELS "driven_rod.json:locked", MT_EXIT_DONE,
     AS_IT_IS},
    {"mac " MODELS "driven_rod.json " MODELS "driven_rod.json:locked", MT_EXIT_INPUT, AS_IT_IS},
    {"mac %/ghost.json %/ghost.json", MT_EXIT_NUMERICAL, AS_IT_IS},
    {"mac " MODELS "driven_rod.json:sprung " MODELS "driven_rod.json:locked", MT_EXIT_SYSTEM,
     SHORT},
    {"mac " MODELS "driven_rod.json:sprung " MODELS "driven_rod.json:locked", MT_EXIT_SYSTEM,
     FULL},

    {"sweep --drive pivot=-0.1:0.1:3 " MODELS "driven_rod.json", MT_EXIT_DONE, AS_IT_IS},
    {"sweep --drive pivo=-0.1:0.1:3 " MODELS "driven_rod.json", MT_EXIT_INPUT, AS_IT_IS},
    {"sweep --drive jD=0:3:4 " MODELS "four_bar.json", MT_EXIT_NUMERICAL, AS_IT_IS},
    {"sweep --drive pivot=-0.1:0.1:3 " MODELS "driven_rod.json", MT_EXIT_SYSTEM, SHORT},
    {"sweep --drive pivot=-0.1:0.1:3 " MODELS "driven_rod.json", MT_EXIT_SYSTEM, FULL},

    {"simulate --vibration base.x=truck_vertical --duration 0.01 " MODELS
     "pendulum.json -c hanging",
     MT_EXIT_DONE, AS_IT_IS},
    {"simulate --vibration truck_vertical --duration 0.01 " MODELS "pendulum.json -c hanging",
     MT_EXIT_INPUT, AS_IT_IS},
    {"simulate --duration 0.1 -c still " MODELS "four_bar.json", MT_EXIT_DONE, AS_IT_IS},
    {"simulate --duration 0.1 " MODELS "four_bar.json", MT_EXIT_INPUT, AS_IT_IS},
    {"simulate --duration 0.1 -c sprung --input base.x=10*t " MODELS "massless.json",
     MT_EXIT_NUMERICAL, AS_IT_IS},
    {"simulate --duration 0.1 -c still " MODELS "four_bar.json", MT_EXIT_INTERRUPTED, STOPPED},
    {"simulate --duration 0.1 -c still " MODELS "four_bar.json", MT_EXIT_SYSTEM, SHORT},
    {"simulate --duration 0.1 -c still " MODELS "four_bar.json", MT_EXIT_SYSTEM, FULL},

    {"sensitivity " MODELS "ring.json", MT_EXIT_DONE, AS_IT_IS},
    {"sensitivity --parameters xyz " MODELS "ring.json", MT_EXIT_INPUT, AS_IT_IS},
    {"sensitivity %/ghost.json", MT_EXIT_NUMERICAL, AS_IT_IS},
    {"sensitivity " MODELS "ring.json", MT_EXIT_SYSTEM, SHORT},
    {"sensitivity " MODELS "ring.json", MT_EXIT_SYSTEM, FULL},

    {"response --input tip.x " MODELS "pendulum.json -c hanging", MT_EXIT_DONE, AS_IT_IS},
    {"response --vibration white --input base.x " MODELS "pendulum.json -c hanging",
     MT_EXIT_DONE, AS_IT_IS},
    {"response --vibration white " MODELS "pendulum.json -c hanging", MT_EXIT_INPUT, AS_IT_IS},
    {"response --vibration %/none.json --input base.x " MODELS "pendulum.json -c hanging",
     MT_EXIT_SYSTEM, AS_IT_IS},
    {"response --input tip.q " MODELS "pendulum.json -c hanging", MT_EXIT_INPUT, AS_IT_IS},
    {"response --input tip.x " MODELS "pendulum.json -c upside_down", MT_EXIT_NUMERICAL,
     AS_IT_IS},
    {"response --input tip.x " MODELS "pendulum.json -c hanging", MT_EXIT_SYSTEM, SHORT},
    {"response --input tip.x " MODELS "pendulum.json -c hanging", MT_EXIT_SYSTEM, FULL},

    {"info " MODELS "ring.json", MT_EXIT_DONE, AS_IT_IS},
    {"info --set xyz=1 " MODELS "ring.json", MT_EXIT_INPUT, AS_IT_IS},
    {"info %/ghost.json", MT_EXIT_NUMERICAL, AS_IT_IS},
    {"info studies/engine_orders.json", MT_EXIT_DONE, AS_IT_IS},
    {"info LICENSE", MT_EXIT_INPUT, AS_IT_IS},
    {"info %/none.json", MT_EXIT_SYSTEM, AS_IT_IS},
    {"info studies/engine_orders.json", MT_EXIT_SYSTEM, FULL},
    {"info " MODELS "ring.json", MT_EXIT_SYSTEM, SHORT},
    {"info " MODELS "ring.json", MT_EXIT_SYSTEM, FULL},

    {"show " MODELS "ring.json", MT_EXIT_DONE, AS_IT_IS},
    {"show %/ghost.json", MT_EXIT_DONE, AS_IT_IS}, /* drawn, with a warning */
    {"show --root / --svg %/engine_orders/result.json", MT_EXIT_DONE, AS_IT_IS},
    {"show --format csv " MODELS "ring.json", MT_EXIT_INPUT, AS_IT_IS},
    {"show %/none.json", MT_EXIT_SYSTEM, AS_IT_IS},
    {"show " MODELS "ring.json", MT_EXIT_SYSTEM, SHORT},
    {"show " MODELS "ring.json", MT_EXIT_SYSTEM, FULL},

    {"report %/engine_orders/result.json", MT_EXIT_DONE, AS_IT_IS},
    {"report --format htm %/engine_orders/result.json", MT_EXIT_INPUT, AS_IT_IS},
    {"report %/none.json", MT_EXIT_SYSTEM, AS_IT_IS},
    {"report %/engine_orders/result.json", MT_EXIT_SYSTEM, SHORT},
    {"report %/engine_orders/result.json", MT_EXIT_SYSTEM, FULL},

    {"explain %/engine_orders/result.json", MT_EXIT_DONE, AS_IT_IS},
    {"explain --rank 99 %/engine_orders/result.json", MT_EXIT_INPUT, AS_IT_IS},
    {"explain %/none.json", MT_EXIT_SYSTEM, AS_IT_IS},
    {"explain %/engine_orders/result.json", MT_EXIT_SYSTEM, SHORT},
    {"explain %/engine_orders/result.json", MT_EXIT_SYSTEM, FULL},

    {"apply --root / %/engine_orders/result.json", MT_EXIT_DONE, AS_IT_IS},
    {"apply --rank 99 %/engine_orders/result.json", MT_EXIT_INPUT, AS_IT_IS},
    {"apply %/none.json", MT_EXIT_SYSTEM, AS_IT_IS},
    {"apply --root / %/engine_orders/result.json", MT_EXIT_SYSTEM, SHORT},
    {"apply --root / %/engine_orders/result.json", MT_EXIT_SYSTEM, FULL},

    {"diff %/engine_orders %/engine_orders/result.json", MT_EXIT_DONE, AS_IT_IS},
    {"diff %/engine_orders %/bare.json", MT_EXIT_GOALS, AS_IT_IS},
    {"diff %/engine_orders %/fast.json", MT_EXIT_INPUT, AS_IT_IS},
    {"diff %/engine_orders %/none.json", MT_EXIT_SYSTEM, AS_IT_IS},
    {"diff %/engine_orders %/bare.json", MT_EXIT_SYSTEM, SHORT},
    {"diff %/engine_orders %/bare.json", MT_EXIT_SYSTEM, FULL},

    {"check " MODELS "ring.json", MT_EXIT_DONE, AS_IT_IS},
    {"check tests/documents/wrong/dampers.json", MT_EXIT_INPUT, AS_IT_IS},
    {"check %/ghost.json", MT_EXIT_NUMERICAL, AS_IT_IS},
    {"check %/none.json", MT_EXIT_SYSTEM, AS_IT_IS},
    {"check tests/documents/wrong/dampers.json %/ghost.json %/none.json", MT_EXIT_SYSTEM,
     AS_IT_IS},
    {"check " MODELS "ring.json", MT_EXIT_SYSTEM, SHORT},
    {"check " MODELS "ring.json", MT_EXIT_SYSTEM, FULL},

    {"init @", MT_EXIT_DONE, AS_IT_IS},
    {"init @ @", MT_EXIT_INPUT, AS_IT_IS},
    {"init /dev/null/x", MT_EXIT_SYSTEM, AS_IT_IS},
    {"init @", MT_EXIT_SYSTEM, SHORT},
    {"init @", MT_EXIT_SYSTEM, FULL},

    {"examples", MT_EXIT_DONE, AS_IT_IS},
    {"examples -o @ engine_orders", MT_EXIT_DONE, AS_IT_IS},
    {"examples engine_ordres", MT_EXIT_INPUT, AS_IT_IS},
    {"examples -o /dev/null/x engine_orders", MT_EXIT_SYSTEM, AS_IT_IS},
    {"examples", MT_EXIT_SYSTEM, SHORT},
    {"examples", MT_EXIT_SYSTEM, FULL},

    {"schema", MT_EXIT_DONE, AS_IT_IS},
    {"schema model", MT_EXIT_DONE, AS_IT_IS},
    {"schema modle", MT_EXIT_INPUT, AS_IT_IS},
    {"schema model", MT_EXIT_SYSTEM, SHORT},
    {"schema model", MT_EXIT_SYSTEM, FULL},

    {"profile", MT_EXIT_DONE, AS_IT_IS},
    {"profile gevs_qualification --spectrum 10:100:3", MT_EXIT_DONE, AS_IT_IS},
    {"profile gevs_qualificatio", MT_EXIT_INPUT, AS_IT_IS},
    {"profile --spectrum 10:1:3 white", MT_EXIT_INPUT, AS_IT_IS},
    {"profile tests/documents/wrong/profile_tones.json", MT_EXIT_INPUT, AS_IT_IS},
    {"profile %/none.json", MT_EXIT_SYSTEM, AS_IT_IS},
    {"profile tests/documents/good/profile.json", MT_EXIT_SYSTEM, SHORT},
    {"profile tests/documents/good/profile.json", MT_EXIT_SYSTEM, FULL},

    {"help", MT_EXIT_DONE, AS_IT_IS},
    {"help avoid", MT_EXIT_DONE, AS_IT_IS},
    {"help avod", MT_EXIT_INPUT, AS_IT_IS},
    {"help avoid", MT_EXIT_SYSTEM, SHORT},
    {"help avoid", MT_EXIT_SYSTEM, FULL},
};

/* What each command can end with. */
static const int CODES[] = {MT_EXIT_DONE,      MT_EXIT_GOALS,  MT_EXIT_INPUT,
                            MT_EXIT_NUMERICAL, MT_EXIT_SYSTEM, MT_EXIT_INTERRUPTED};
static const struct {
    const char *command;
    bool can[MT_COUNT(CODES)];
} able[MT_CMD_IDS] = {
    [MT_CMD_RUN] = {"run", {true, true, true, true, true, true}},
    [MT_CMD_MERGE] = {"merge", {true, true, true, true, true, true}},
    [MT_CMD_COMPARE] = {"compare", {true, true, true, true, true, false}},
    [MT_CMD_MODES] = {"modes", {true, false, true, true, true, false}},
    [MT_CMD_MAC] = {"mac", {true, false, true, true, true, false}},
    [MT_CMD_SWEEP] = {"sweep", {true, false, true, true, true, false}},
    [MT_CMD_SIMULATE] = {"simulate", {true, false, true, true, true, true}},
    [MT_CMD_SENSITIVITY] = {"sensitivity", {true, false, true, true, true, false}},
    [MT_CMD_RESPONSE] = {"response", {true, false, true, true, true, false}},
    [MT_CMD_INFO] = {"info", {true, false, true, true, true, false}},
    [MT_CMD_SHOW] = {"show", {true, false, true, false, true, false}},
    [MT_CMD_REPORT] = {"report", {true, false, true, false, true, false}},
    [MT_CMD_EXPLAIN] = {"explain", {true, false, true, false, true, false}},
    [MT_CMD_APPLY] = {"apply", {true, false, true, false, true, false}},
    [MT_CMD_DIFF] = {"diff", {true, true, true, false, true, false}},
    [MT_CMD_CHECK] = {"check", {true, false, true, true, true, false}},
    [MT_CMD_INIT] = {"init", {true, false, true, false, true, false}},
    [MT_CMD_EXAMPLES] = {"examples", {true, false, true, false, true, false}},
    [MT_CMD_SCHEMA] = {"schema", {true, false, true, false, true, false}},
    [MT_CMD_PROFILE] = {"profile", {true, false, true, false, true, false}},
    [MT_CMD_HELP] = {"help", {true, false, true, false, true, false}},
};

static void begin(void *context)
{
    const how way = *(const how *)context;
    (void)signal(SIGINT, SIG_DFL); /* a background job of a shell has it ignored */
    mt_terminal_open();
    mt_blas_set_threads(1);
    (void)gsl_set_error_handler_off(); /* as main does */
    if (way == STOPPED) {
        mt_terminal_hold_signals();
        (void)raise(SIGINT);
    } else if (way == SHORT) {
        mt_alloc_fail_after(2); /* the arguments are read */
    }
}

static mt_child_left run(const char *words, how way)
{
    const mt_child p = {.main = mt_cli_main,
                        .begin = begin,
                        .context = &way,
                        .output = way == FULL ? "/dev/full" : NULL,
                        .seconds = 120};
    return mt_child_run(&p, words);
}

static int place_of(int code)
{
    for (int k = 0; k < MT_COUNT(CODES); k++) {
        if (CODES[k] == code) {
            return k;
        }
    }
    return -1;
}

static int command_of(const char *words)
{
    const size_t n = strcspn(words, " ");
    for (int c = 0; c < MT_CMD_IDS; c++) {
        if (strlen(able[c].command) == n && strncmp(able[c].command, words, n) == 0) {
            return c;
        }
    }
    return -1;
}

static void try_row(mt_test *t, int i, bool seen[MT_CMD_IDS][MT_COUNT(CODES)])
{
    const int command = command_of(rows[i].words);
    if (rows[i].how == SHORT && !mt_alloc_works()) {
        if (command >= 0) {
            seen[command][place_of(rows[i].code)] = true;
        }
        return;
    }
    mt_test_row(t, "%s (%d)", rows[i].words, (int)rows[i].how);
    mt_child_left got = run(rows[i].words, rows[i].how);
    if (!CHECK_INT(t, got.code, rows[i].code)) {
        (void)fprintf(stderr, "  it says: %.500s\n", got.err.s == NULL ? "" : got.err.s);
    } else if (command >= 0 && place_of(got.code) >= 0) {
        seen[command][place_of(got.code)] = true;
    }
    const bool silent = rows[i].code == MT_EXIT_DONE || rows[i].code == MT_EXIT_GOALS ||
                        rows[i].code == MT_EXIT_INTERRUPTED;
    CHECK(t, silent || got.err.n > 0); /* what went wrong is said */
    mt_child_forget(&got);
}

static void codes__each_is_seen(mt_test *t)
{
    bool seen[MT_CMD_IDS][MT_COUNT(CODES)] = {{false}};
    REQUIRE(t, chdir(MT_TEST_SOURCE_DIR) == 0 && mt_child_open());
    CHECK(t, mt_child_write("ghost.json", GHOST) &&
                 mt_child_write("ghost_study.json", GHOST_STUDY) &&
                 mt_child_write("fast.json", FAST_STUDY) &&
                 mt_child_write("bare.json", "{ \"format\": \"modetune-result/1\" }") &&
                 mt_child_write("pendulum.json", PENDULUM));
    mt_child_left kept = run("run -o % --quiet studies/engine_orders.json", AS_IT_IS);
    CHECK_INT(t, kept.code, MT_EXIT_DONE);
    mt_child_forget(&kept);
    for (int i = 0; i < MT_COUNT(rows); i++) {
        try_row(t, i, seen);
    }
    for (int c = 0; c < MT_CMD_IDS; c++) {
        CHECK_STR(t, able[c].command, mt_commands[c]->name);
        for (int k = 0; k < MT_COUNT(CODES); k++) {
            mt_test_row(t, "%s can end with %d", able[c].command, CODES[k]);
            CHECK_INT(t, seen[c][k], able[c].can[k]);
        }
    }
    mt_child_close();
}

/* Whole numbers within the paragraph of `path` that begins with `begin` are the codes, each of
 * them. */
static void check_text(mt_test *t, const char *path, const char *begin)
{
    static char text[1 << 18];
    bool told[MT_COUNT(CODES)] = {false};
    FILE *const file = fopen(path, "r");
    REQUIRE(t, file != NULL);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    (void)fclose(file);
    const char *at = strstr(text, begin);
    mt_test_row(t, "%s", path);
    REQUIRE(t, at != NULL);
    const char *const blank = strstr(at, "\n\n");
    const char *const end = blank == NULL ? at + strlen(at) : blank;
    while (at < end) {
        if (!isdigit((unsigned char)*at)) {
            at++;
            continue;
        }
        char *rest = NULL;
        const int k = place_of((int)strtol(at, &rest, 10));
        CHECK(t, k >= 0);
        told[k >= 0 ? k : 0] = true;
        at = rest;
    }
    for (int k = 0; k < MT_COUNT(CODES); k++) {
        mt_test_row(t, "%s tells of %d", path, CODES[k]);
        CHECK(t, told[k]);
    }
}

static void codes__are_those_of_the_document(mt_test *t)
{
    check_text(t, MT_TEST_SOURCE_DIR "/src/cli/README.md", "The exit status is 0 if all goals");
}

MT_TEST_MAIN(MT_TEST(codes__each_is_seen), MT_TEST(codes__are_those_of_the_document))
