/* SPDX-License-Identifier: GPL-3.0-or-later */
/* result.json: what is written, what `apply` reads back, and what damaged files say. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/file.h"
#include "io/io.h"
#include "io/json.h"
#include "mt_alloc.h"
#include "mt_test.h"

static mt_result_parameter PARAMETERS[] = {
    {.name = "K_T1",
     .unit = "N m/rad",
     .original = 1e4,
     .recommended = 10147.0 + 1.0 / 3.0,
     .change_percent = 1.4733333333333334,
     .at_bound = NULL,
     .measure = "logarithmic with floor",
     .measure_floor = 20.0},
    {.name = "M_SAU",
     .unit = NULL,
     .original = 0.0,
     .recommended = 0.2,
     .at_bound = "lower",
     .lower = 0.2,
     .upper = 0.5,
     .measure = "linear",
     .measure_scale = 10.0},
};
static double SENSITIVITY[] = {1.25e-3, -2.0};
static mt_result_goal GOALS[] = {{.text = "installed mode 1 at 18 Hz",
                                  .pointer = "/goals/0",
                                  .value = 18.0,
                                  .type = "frequency",
                                  .configuration = "installed",
                                  .mode = 1,
                                  .unit = "Hz",
                                  .target = 18.0,
                                  .tolerance_percent = 1e-4,
                                  .met = true,
                                  .off_most_hz = 17.25,
                                  .off_most_ratio = 1.125,
                                  .off_most_phase_deg = -3.5,
                                  .worst = 17.5,
                                  .sensitivity = SENSITIVITY}};
static mt_reason REASONS[] = {{"change", "K_T1", "K_T1 rises by 1.5 %."},
                              {"rank", NULL, "It is the only one."}};
static const char *WARNINGS[] = {"It is hot."};
static const char *VARIABLES[] = {"K_T1", "M_SAU"};
static double DIRECTION[] = {0.0, 1.0};
static const char *INCOMPLETE[] = {"trade"};
static const char SHA256[] = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
static mt_result_digest INPUTS[] = {{"study.json", SHA256}};
static mt_result_override OVERRIDES[] = {{"parameter", "l", "m", "mm", 1e-3, 0.5, 0.25}};
static mt_result_step HISTORY[] = {{1, 1, 3, 0.5, 12.5, false}, {2, 1, 1000, 0.25, 0.0, true}};
static mt_result_digest OUTPUTS[] = {{"report.html", SHA256}};
static mt_doubt DOUBTS[] = {{.kind = "margin",
                             .text = "a margin of 0.1 %",
                             .level = MT_LEVEL_DOUBT,
                             .file = "study_1.json",
                             .line = 12,
                             .column = 3}};
static mt_doubt FACTS[] = {
    {.kind = "free_motion", .text = "2 free motions", .configuration = "installed"}};
static double DESIGN[] = {1e4, 0.25};
static mt_relaxation RELAXATIONS[] = {{.kind = "bound",
                                       .pointer = "/variables/0",
                                       .what = "upper bound of K_T1",
                                       .unit = "N m/rad",
                                       .from = 1e4,
                                       .to = 2e4,
                                       .change_percent = 100.0,
                                       .design = DESIGN,
                                       .text = "raise it"}};
static mt_design_objective REACHED[] = {{"change", "", 0.0, 0.1 + 0.2},
                                        {"k1 + k2", NULL, 7.5, -1.25}};
static mt_result_objective OBJECTIVES[] = {{"change", "change", ""},
                                           {"expression", "a + b", NULL}};
static const char *CONFIGURATIONS[] = {"installed"};
static mt_result_order ORDERS[] = {{"4P", 4.0}};
static mt_result_excitation EXCITATIONS[] = {{"/goals/1", "UH-60", 4.0, 4.5, 10.0, 60.0,
                                              MT_COUNT(CONFIGURATIONS), CONFIGURATIONS,
                                              MT_COUNT(ORDERS), ORDERS}};

typedef struct sample {
    mt_result *result;
    mt_result_frequency frequency;
    mt_recommendation recommendation;
    mt_undetermined undetermined;
    mt_result_spread spread;
    mt_certificate certificate;
    mt_tolerance_box box;
    mt_trade_point point;
    mt_trade_result trade;
    mt_result_published published[2];
} sample;

static void fill_design(sample *s, mt_recommendation *r)
{
    PARAMETERS[1].change_percent = nan("");
    *r = mt_recommendation_default();
    r->feasible = true;
    r->grade = "feasible";
    r->score = 0.1 + 0.2;
    r->n_objectives = MT_COUNT(REACHED);
    r->objectives = REACHED;
    r->change = 0.25;
    r->violation_percent = 0.0;
    r->n_parameters = MT_COUNT(PARAMETERS);
    r->parameters = PARAMETERS;
    r->n_frequencies = 1;
    r->frequencies = &s->frequency;
    r->n_goals = MT_COUNT(GOALS);
    r->goals = GOALS;
    r->n_reasons = MT_COUNT(REASONS);
    r->reasons = REASONS;
}

static mt_result_clearance CLEARANCES[] = {
    {.configuration = "installed",
     .band = "4P of UH-60",
     .band_id = 1,
     .mode = 1,
     .hz = 14.0,
     .percent = 12.5,
     .side = "below"},
    {.configuration = "installed",
     .band = "4P of UH-60",
     .band_id = 1,
     .mode = 2,
     .hz = 25.0,
     .percent = 30.0,
     .side = "above"},
};
static mt_result_gap GAPS[] = {
    {.id = 1, .configuration = "installed", .band = "4P of UH-60", .modes_below = 1},
};
static mt_result_motion MOTIONS[] = {
    {.pointer = "/goals/0",
     .drive = "pivot",
     .unit = "rad",
     .from = -0.25,
     .to = 0.5,
     .positions = 40,
     .least_clearance_percent = 10.5,
     .margin_percent = 10.0,
     .at = 0.125,
     .hz = 14.5,
     .mode = 1,
     .band = "4P of UH-60",
     .band_id = 1,
     .grade = "sampled",
     .text = "mode 1 comes nearest"},
};
static mt_result_response RESPONSES[] = {
    {.pointer = "/goals/2",
     .configuration = "installed",
     .input = "base.z",
     .output = "grip.x:acceleration",
     .profile = "helicopter_uh60_panel",
     .quantity = "rms",
     .unit = "m/s^2",
     .value = 3.25,
     .error = 1e-9,
     .frequency_hz = 17.25,
     .at_edge = true,
     .lower_hz = 5.0,
     .upper_hz = 500.0,
     .end = "finite",
     .grade = "proven",
     .text = "the acceleration of grip.x is 3.25 m/s^2 rms"},
};
static mt_result_tolerance TOLERANCES[] = {
    {"K_T1", 4.5, "mode 1 at 4P of UH-60"},
    {"M_SAU", HUGE_VAL, NULL},
};
static double TRADE_VALUES[] = {10.0, 0.25};
static mt_trade_vary VARY[] = {
    {"upper bound of l", "/trade/vary/0", "m", "in", 0.0254},
    {"margin_percent", "/trade/vary/1", NULL, NULL, 0.0},
};
static const char *FRONT[] = {"change", "clearance"};

/* What a study with bands and a trade section adds. */
static void fill_bands(sample *s)
{
    s->box = mt_tolerance_box_default();
    s->box.all_percent = 2.5;
    s->box.edge = "mode 1 at 4P of UH-60";
    s->box.proven = true;
    s->box.n_variables = MT_COUNT(TOLERANCES);
    s->box.variables = TOLERANCES;
    mt_recommendation *const r = &s->recommendation;
    r->clearance_percent = 12.5;
    r->n_clearances = MT_COUNT(CLEARANCES);
    r->clearances = CLEARANCES;
    r->n_gaps = MT_COUNT(GAPS);
    r->gaps = GAPS;
    r->n_motions = MT_COUNT(MOTIONS);
    r->motions = MOTIONS;
    r->n_responses = MT_COUNT(RESPONSES);
    r->responses = RESPONSES;
    r->tolerance_box = &s->box;
    s->point = (mt_trade_point){.n_values = MT_COUNT(TRADE_VALUES),
                                .values = TRADE_VALUES,
                                .status = MT_RESULT_SOLVED,
                                .status_text = "Solved.",
                                .best = *r,
                                .pareto = true};
    s->trade = (mt_trade_result){
        MT_COUNT(VARY), VARY, MT_COUNT(FRONT), FRONT, 1, &s->point,
    };
    s->result->trade = &s->trade;
}

static void fill_run(mt_result *r)
{
    r->n_objectives = MT_COUNT(OBJECTIVES);
    r->objectives = OBJECTIVES;
    r->run = (mt_result_run){.modetune_version = "0.1.0",
                             .build = {"0123456789ab", "GNU 12.2.0"},
                             .blas = "OpenBLAS 0.3.21",
                             .nlopt_version = "2.7.1",
                             .gsl_version = "2.7.1",
                             .seed = 1,
                             .evaluations = 1234,
                             .spent = {1000, 100, 14, 20, 30, 70, 123456789},
                             .starts = 16,
                             .distinct_designs = 9,
                             .found_once = 3,
                             .estimated_missing = 1.5,
                             .n_history = MT_COUNT(HISTORY),
                             .history = HISTORY,
                             .n_overrides = MT_COUNT(OVERRIDES),
                             .overrides = OVERRIDES,
                             .n_inputs = MT_COUNT(INPUTS),
                             .inputs = INPUTS,
                             .n_outputs = MT_COUNT(OUTPUTS),
                             .outputs = OUTPUTS,
                             .n_incomplete = MT_COUNT(INCOMPLETE),
                             .incomplete = INCOMPLETE,
                             .cut_by = "time limit"};
}

static bool make_sample(sample *s)
{
    if (mt_result_new(&s->result, NULL) != MT_OK) {
        return false;
    }
    mt_result *const r = s->result;
    s->frequency = mt_result_frequency_default();
    s->frequency.configuration = "installed";
    s->frequency.mode = 1;
    s->frequency.original_hz = 17.5;
    s->frequency.recommended_hz = 18.0;
    s->frequency.target_hz = 18.0;
    s->frequency.error_percent = 0.0;
    s->frequency.sensitivity = SENSITIVITY;
    fill_design(s, &r->baseline);
    fill_design(s, &s->recommendation);
    s->recommendation.rank = 1;
    s->undetermined = (mt_undetermined){DIRECTION, "M_SAU", 1e-5};
    s->spread = (mt_result_spread){.parameter = "M_SAU",
                                   .unit = "kg",
                                   .display_unit = NULL,
                                   .display_factor = nan(""),
                                   .value = 0.4,
                                   .low = 0.3,
                                   .high = 0.4,
                                   .low_percent = -25.0,
                                   .high_percent = nan(""),
                                   .low_goal = "/goals/0",
                                   .low_factor = 0.25,
                                   .high_factor = nan("")};
    s->certificate = mt_certificate_default();
    s->certificate.kind = "range";
    s->certificate.text = "Mode 1 stays below 20 Hz.";
    s->certificate.proven = true;
    s->certificate.pointer = "/goals/0";
    s->certificate.reachable_upper_hz = 19.5;
    fill_bands(s);
    s->published[0] = mt_result_published_default();
    s->published[0].label = "M_SAU";
    s->published[0].pointer = "/published/0";
    s->published[0].role = "verifies";
    s->published[0].kind = "parameter";
    s->published[0].published = 0.2;
    s->published[0].computed = 0.2;
    s->published[0].demand = "within 1 %";
    s->published[0].holds = true;
    s->published[1] = s->published[0];
    s->published[1].kind = "status";
    s->published[1].published_text = "solved";
    s->published[1].computed_text = "compromise";
    s->published[1].holds = false;
    r->study = (mt_result_source){"Study \"1\"", "study_1.json"};
    r->model = (mt_result_source){"Inceptor", "../problems/inceptor.json"};
    r->n_doubts = MT_COUNT(DOUBTS);
    r->doubts = DOUBTS;
    r->n_facts = MT_COUNT(FACTS);
    r->facts = FACTS;
    r->n_relaxations = MT_COUNT(RELAXATIONS);
    r->relaxations = RELAXATIONS;
    r->n_excitations = MT_COUNT(EXCITATIONS);
    r->excitations = EXCITATIONS;
    r->status = MT_RESULT_COMPROMISE;
    r->status_text = "No design meets every goal.";
    r->n_variables = MT_COUNT(VARIABLES);
    r->variables = VARIABLES;
    r->n_recommendations = 1;
    r->recommendations = &s->recommendation;
    r->n_undetermined = 1;
    r->undetermined = &s->undetermined;
    r->n_spread = 1;
    r->spread = &s->spread;
    r->n_certificates = 1;
    r->certificates = &s->certificate;
    r->n_published = 2;
    r->published = s->published;
    r->n_warnings = 1;
    r->warnings = WARNINGS;
    fill_run(r);
    return true;
}

/* A new file with this text; its path is in `path`, "" where that failed. */
static void write_file(const char *text, char path[64])
{
    (void)snprintf(path, 64, "/tmp/mt_result_XXXXXX");
    const int fd = mkstemp(path);
    const size_t length = strlen(text);
    if (fd < 0 || write(fd, text, length) != (ssize_t)length) {
        path[0] = '\0';
    }
    if (fd >= 0) {
        (void)close(fd);
    }
}

/* The sample written, with one text replaced by another; heap (mt_text). */
static mt_text written(const char *find, const char *replace)
{
    sample s = {.result = NULL};
    mt_text all = {0};
    if (!make_sample(&s) || mt_result_write(s.result, &all, NULL) != MT_OK) {
        mt_text_free(&all);
    }
    mt_result_delete(s.result);
    char *const at = find == NULL || all.s == NULL ? NULL : strstr(all.s, find);
    mt_text out = {0};
    if (find == NULL) {
        return all;
    }
    if (at != NULL) {
        mt_text_add_n(&out, all.s, (size_t)(at - all.s));
        mt_text_add(&out, replace);
        mt_text_add(&out, at + strlen(find));
    }
    mt_text_free(&all);
    return out;
}

/* Read and written again; the path may be gone by then. */
static void result_file__comes_back_whole(mt_test *t)
{
    char path[64];
    mt_text text = written(NULL, NULL);
    mt_diagnostics messages = {.count = 0};
    mt_text again = {0};
    mt_result *r = NULL;
    mt_err err = {.text = ""};
    REQUIRE(t, text.s != NULL);
    write_file(text.s, path);
    CHECK_INT(t, mt_result_load(path, NULL, &r, &messages, &err), MT_OK);
    (void)unlink(path);
    CHECK_STR(t, err.text, "");
    CHECK_STR(t, messages.lines.s, NULL);
    if (r != NULL) {
        CHECK_INT(t, mt_result_write(r, &again, NULL), MT_OK);
        CHECK_STR(t, again.s, text.s);
        CHECK(t, isnan(r->recommendations[0].misfit));
        CHECK(t, r->doubts[0].level == MT_LEVEL_DOUBT && r->facts[0].level == MT_LEVEL_FACT);
    }
    mt_result_delete(r);
    mt_text_free(&again);
    mt_diagnostics_free(&messages);
    mt_text_free(&text);
}

/* A copy of all that it has borrowed: what it was copied from may go. */
static void result_file__is_its_own(mt_test *t)
{
    sample s = {.result = NULL};
    mt_text whole = written(NULL, NULL);
    mt_text text = {0};
    REQUIRE(t, whole.s != NULL && make_sample(&s));
    CHECK_INT(t, mt_result_own(s.result, NULL), MT_OK);
    CHECK(t, s.result->recommendations != &s.recommendation && s.result->trade != &s.trade);
    CHECK(t, s.result->trade->points[0].best.tolerance_box != &s.box);
    mt_result *const result = s.result;
    memset(&s, 0x5a, sizeof s);
    CHECK_INT(t, mt_result_write(result, &text, NULL), MT_OK);
    CHECK_STR(t, text.s, whole.s);
    mt_result_delete(result);
    mt_text_free(&text);
    mt_text_free(&whole);
}

static void result_file__holds_what_the_design_promises(mt_test *t)
{
    static const char *const members[] = {
        "\"status\": \"compromise\"",
        "\"grade\": \"feasible\"",
        "\"score\": 0.30000000000000004",
        "\"violation_percent\": 0",
        "\"target_hz\": 18",
        "\"error_percent\": 0",
        "\"K_T1\": 0.00125",
        "\"clearances\": []",
        "\"gap_assignment\": null",
        "\"motion\": []",
        "\"motion\": [",
        "\"least_clearance_percent\": 10.5",
        "\"tolerance_box\": null",
        "\"clearance_percent\": null",
        "\"clearance_percent\": 12.5",
        "\"side\": \"above\"",
        "\"modes_below\": 1",
        "\"all_percent\": 2.5",
        "\"per_variable\": [",
        "\"reachable_lower_hz\": null",
        "\"reachable_upper_hz\": 19.5",
        "\"values\": [10, 0.25]",
        "\"quantity\": \"upper bound of l\"",
        "\"display_unit\": \"in\"",
        "\"display_factor\": 0.025399999999999999",
        "\"display_factor\": null",
        "\"pareto\": true",
        "\"published\": \"solved\"",
        "\"computed\": \"compromise\"",
        "\"kkt_residual\": null",
        "\"direction\": \"M_SAU\"",
        "\"proven\": true",
        "\"seed\": 1",
        "\"relaxations\": [\n",
        "\"target\": 18,",
        "\"band_id\": 1",
        "\"commit\": \"0123456789ab\"",
    };
    mt_text text = written(NULL, NULL);
    REQUIRE(t, text.s != NULL);
    for (int i = 0; i < MT_COUNT(members); i++) {
        CHECK(t, strstr(text.s, members[i]) != NULL);
    }
    mt_text_free(&text);
}

static void result_file__writing_twice_gives_the_same_bytes(mt_test *t)
{
    mt_text a = written(NULL, NULL);
    mt_text b = written(NULL, NULL);
    CHECK(t, a.s != NULL);
    CHECK_STR(t, a.s, b.s);
    mt_text_free(&a);
    mt_text_free(&b);
}

/* Line of the first place of `what` in the text, from 1. */
static int line_of(const char *text, const char *what)
{
    const char *const at = strstr(text, what);
    int line = 1;
    for (const char *p = text; at != NULL && p < at; p++) {
        line += *p == '\n' ? 1 : 0;
    }
    return line;
}

static void result_file__a_damaged_one_is_refused(mt_test *t)
{
    static const struct {
        const char *name;
        const char *find;
        const char *replace;
        const char *at;   /* what the message points at the line of */
        const char *want; /* the message behind path and line */
    } rows[] = {
        {"format", "modetune-result/1", "modetune-result/2", "modetune-result/2",
         "13: error: /format: unknown format \"modetune-result/2\"; did you mean "
         "\"modetune-result/1\"?\n"},
        {"member gone", "  \"status\": \"compromise\",\n", "", "{",
         "1: error: member \"status\" is missing\n"},
        {"rank", "\"rank\": 1", "\"rank\": 1.5", "\"rank\": 1.5",
         "15: error: /recommendations/0/rank: must be a whole number, 0 or more\n"},
        {"unknown member", "\"rank\": 1", "\"extra\": 0, \"rank\": 1",
         "\"extra\": 0, \"rank\": 1",
         "7: error: /recommendations/0: unknown member \"extra\"\n"},
        {"no such variable", "\"K_T1\": 0.00125", "\"K_T2\": 0.00125", "\"K_T2\": 0.00125",
         "11: error: /baseline/frequencies/0/sensitivity: \"K_T2\" is no variable\n"},
        {"values of a point", "[10, 0.25]", "[10]", "\"values\": [10]",
         "19: error: /trade/points/0/values: must have 2 values, as many as vary\n"},
        {"side", "\"side\": \"above\"", "\"side\": \"beside\"", "\"side\": \"beside\"",
         "19: error: /recommendations/0/clearances/1/side: unknown side \"beside\"; did you "
         "mean \"inside\"?\n"},
        {"text for a number", "\"recommended\": 0.20000000000000001",
         "\"recommended\": \"0.2\"", "\"recommended\": \"0.2\"",
         "24: error: /baseline/parameters/1/recommended: must be a number or null, not a "
         "string\n"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        char path[64];
        mt_test_row(t, "%s", rows[i].name);
        mt_text text = written(rows[i].find, rows[i].replace);
        mt_diagnostics messages = {.count = 0};
        mt_result *r = NULL;
        if (CHECK(t, text.s != NULL)) {
            write_file(text.s, path);
            CHECK_INT(t, mt_result_load(path, NULL, &r, &messages, NULL), MT_E_INPUT);
            CHECK(t, r == NULL);
            char want[300];
            (void)snprintf(want, sizeof want, "%s:%d:%s", path, line_of(text.s, rows[i].at),
                           rows[i].want);
            CHECK_STR(t, messages.lines.s, want);
            (void)unlink(path);
        }
        mt_diagnostics_free(&messages);
        mt_text_free(&text);
    }
}

static void result_file__no_file_is_a_system_failure(mt_test *t)
{
    mt_result *r = NULL;
    mt_err err = {.text = ""};
    CHECK_INT(t, mt_result_load("/nonexistent/result.json", NULL, &r, NULL, &err), MT_E_SYSTEM);
    CHECK(t, r == NULL);
    CHECK(t, strstr(err.text, "/nonexistent/result.json") != NULL);
}

static void result_file__every_failing_allocation_is_survived(mt_test *t)
{
    char path[64];
    mt_text text = written(NULL, NULL);
    REQUIRE(t, text.s != NULL);
    write_file(text.s, path);
    CHECK(t, path[0] != '\0');
    for (long nth = 0; mt_alloc_works(); nth++) {
        mt_result *r = NULL;
        mt_text again = {0};
        mt_diagnostics said = {.count = 0};
        sample s = {.result = NULL};
        const long before = mt_alloc_live();
        mt_test_row(t, "allocation %ld", nth);
        mt_alloc_fail_after(nth);
        mt_status rc = mt_result_load(path, NULL, &r, &said, NULL);
        if (rc == MT_OK) {
            rc = make_sample(&s) ? mt_result_write(s.result, &again, NULL) : MT_E_MEMORY;
        }
        mt_alloc_fail_after(-1);
        CHECK(t, rc == MT_OK || rc == MT_E_MEMORY);
        mt_result_delete(r);
        mt_result_delete(s.result);
        mt_text_free(&again);
        mt_diagnostics_free(&said);
        CHECK_INT(t, mt_alloc_live(), before);
        if (rc != MT_E_MEMORY) {
            break;
        }
    }
    (void)unlink(path);
    mt_text_free(&text);
}

MT_TEST_MAIN(MT_TEST(result_file__comes_back_whole), MT_TEST(result_file__is_its_own),
             MT_TEST(result_file__holds_what_the_design_promises),
             MT_TEST(result_file__writing_twice_gives_the_same_bytes),
             MT_TEST(result_file__a_damaged_one_is_refused),
             MT_TEST(result_file__no_file_is_a_system_failure),
             MT_TEST(result_file__every_failing_allocation_is_survived))
