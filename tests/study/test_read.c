/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A right study: every member arrives, names are resolved, numbers are evaluated at the
 * original design. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"
#include "io/options.h"
#include "mt_refusals.h"
#include "study/read.h"

#define FULL  MT_TEST_SOURCE_DIR "/tests/documents/good/study_full.json"
#define MODEL MT_TEST_SOURCE_DIR "/tests/documents/wrong/parts/model.json"

static const double TOL = 1e-15; /* a few roundings: quotients and products of two numbers */

static mt_study *load(mt_test *t, const char *path)
{
    mt_study *s = NULL;
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.text = ""};
    CHECK_INT(t, mt_study_load(path, NULL, &s, &messages, &err), MT_OK);
    CHECK_STR(t, messages.lines.s, NULL);
    CHECK_STR(t, err.text, "");
    mt_diagnostics_free(&messages);
    return s;
}

/* A small study with these members, in a file of its own beside the model; the caller deletes
 * it. */
static mt_study *load_text(mt_test *t, const char *members, mt_diagnostics *messages)
{
    char folder[] = "/tmp/mt_study_XXXXXX";
    char path[64];
    mt_study *s = NULL;
    mt_io_options opt = {.root = "/"};
    if (!CHECK(t, mkdtemp(folder) != NULL)) {
        return NULL;
    }
    (void)snprintf(path, sizeof path, "%s/two.masses.json", folder);
    FILE *const f = fopen(path, "w");
    if (CHECK(t, f != NULL)) {
        (void)fprintf(f, "{\"format\": \"modetune-study/1\", \"model\": \"%s\"%s}", MODEL,
                      members);
        CHECK_INT(t, fclose(f), 0);
        CHECK_INT(t, mt_study_load(path, &opt, &s, messages, NULL), MT_OK);
    }
    (void)unlink(path);
    (void)rmdir(folder);
    return s;
}

static void check_variables(mt_test *t, const mt_study *s)
{
    if (!CHECK_INT(t, s->n_variables, 4)) {
        return;
    }
    const mt_variable *const v = s->variables;
    CHECK_INT(t, v[0].parameter, mt_model_find_parameter(s->model, "k1"));
    CHECK_NEAR(t, v[0].lower, 0.5, TOL);
    CHECK_NEAR(t, v[0].upper, 6.0, TOL);
    CHECK_NEAR(t, v[0].original, 3.0, TOL);
    CHECK_NEAR(t, v[0].weight, 2.0, TOL);
    CHECK_NEAR(t, v[0].scale, 0.5, TOL);
    CHECK_NEAR(t, v[0].tolerance_percent, 3.0, TOL);
    if (CHECK_INT(t, v[1].n_catalogue, 3)) { /* ascending */
        CHECK_NEAR(t, v[1].catalogue[0], 1.0, TOL);
        CHECK_NEAR(t, v[1].catalogue[1], 2.5, TOL);
        CHECK_NEAR(t, v[1].catalogue[2], 4.0, TOL);
    }
    CHECK_NEAR(t, v[1].range, 3.0, TOL);
    CHECK_NEAR(t, v[1].weight, 1.0, TOL);
    CHECK(t, !MT_HAS(v[1].tolerance_percent));
    CHECK_NEAR(t, v[2].upper, 0.17453292519943295, TOL);
    CHECK_NEAR_ABS(t, v[2].original, 0.0, 0.0);
    CHECK_INT(t, v[3].parameter, mt_model_find_parameter(s->model, "m"));
    if (CHECK_INT(t, v[3].n_catalogue, 3) && CHECK(t, v[3].rows != NULL)) {
        CHECK_NEAR(t, v[3].catalogue[0], 0.5, TOL);
        CHECK_NEAR(t, v[3].rows->value[1], 1.0, TOL);
        CHECK_STR(t, v[3].rows->names[0], "W500");
        CHECK_INT(t, v[3].rows->number[0], 3);
        CHECK_NEAR(t, v[3].tolerance_percent, 1.0, TOL);
    }
    if (CHECK_INT(t, s->n_catalogues, 2) && CHECK_INT(t, s->catalogues[1].n_rows, 2)) {
        CHECK_STR(t, s->catalogues[1].columns.items[1].s, "mass");
        CHECK_STR(t, s->catalogues[1].units.items[1].s, "g");
        CHECK_NEAR(t, s->catalogues[1].number[5], 2.5, TOL);
        CHECK(t, s->catalogues[1].text[0] && !s->catalogues[1].text[1]);
        CHECK_STR(t, s->catalogues[1].names.items[1].s, "W500");
    }
}

static void check_energy_goals(mt_test *t, const mt_study *s)
{
    const mt_goal *const g = &s->goals[14];
    if (CHECK(t, g[0].energy != NULL) && CHECK(t, g[1].energy != NULL)) {
        CHECK(t, mt_goal_is_most(&g[0]));
        CHECK_INT(t, g[0].n_configurations, 2);
        CHECK_INT(t, mt_goal_directions(&g[0]), 2);
        CHECK_INT(t, g[0].energy->directions[0], 0);
        CHECK_INT(t, g[0].energy->directions[1], 5);
        CHECK_STR(t, g[0].energy->body_name.s, "a");
        CHECK_NEAR(t, g[0].at_least, 3.0, TOL);
        CHECK_NEAR(t, g[0].at_most, 98.0, TOL);
        CHECK(t, !mt_goal_is_most(&g[1]));
        CHECK_INT(t, mt_goal_directions(&g[1]), 1);
        CHECK_INT(t, g[1].mode.index, 2);
        CHECK_STR(t, g[1].energy->spring_name.s, "second");
        CHECK_INT(t, g[1].energy->component, MT_ABSENT);
    }
}

static void check_frequency_goals(mt_test *t, const mt_study *s)
{
    const mt_goal *const g = s->goals;
    CHECK_INT(t, g[0].type, MT_GOAL_FREQUENCY);
    CHECK_NEAR(t, g[0].equals, 0.3, TOL);
    CHECK_NEAR(t, g[0].tolerance_percent, 0.5, TOL);
    CHECK_NEAR(t, g[0].weight, 3.0, TOL);
    CHECK_INT(t, g[0].mode.index, 1);
    CHECK_INT(t, g[0].mode.named, MT_ABSENT);
    CHECK_STR(t, g[0].description, "the first");
    CHECK(t, !MT_HAS(g[0].at_least) && !MT_HAS(g[0].at_most));
    CHECK_INT(t, g[1].n_configurations, 2);
    CHECK_INT(t, g[1].configurations[1], mt_model_find_configuration(s->model, "heavy"));
    CHECK_INT(t, g[1].mode.index, 0);
    CHECK_INT(t, g[1].mode.named, mt_model_find_mode(s->model, "in phase"));
    CHECK_NEAR(t, g[1].at_least, 0.1, TOL);
    CHECK_NEAR(t, g[1].at_most, 7.0, TOL);
    CHECK(t, !MT_HAS(g[1].equals) && !MT_HAS(g[1].weight));
    CHECK_NEAR(t, g[1].tolerance_percent, 1e-4, TOL);
}

static void check_other_goals(mt_test *t, const mt_study *s)
{
    const mt_goal *const g = s->goals;
    CHECK_INT(t, g[2].type, MT_GOAL_SHAPE);
    CHECK_INT(t, g[2].reference, mt_study_find_reference(s, "test"));
    CHECK_INT(t, g[2].reference_mode, 1);
    CHECK_INT(t, g[3].type, MT_GOAL_MAC);
    CHECK_INT(t, g[3].reference, mt_study_find_reference(s, "same"));
    CHECK_INT(t, g[3].reference_mode, 0);
    CHECK_NEAR(t, g[3].at_least, 0.95, TOL);
    CHECK_INT(t, g[4].type, MT_GOAL_LIMIT);
    CHECK_STR(t, g[4].expression_text, "m + k1");
    CHECK(t, g[4].expression.length == 3);
    CHECK_INT(t, g[4].n_configurations, 0);
    CHECK_NEAR(t, g[4].at_most, 7.0, TOL);
    CHECK_NEAR_ABS(t, g[5].equals, 0.0, 0.0);
    CHECK_INT(t, g[6].type, MT_GOAL_FREQUENCY);
    CHECK_INT(t, g[6].reference, mt_study_find_reference(s, "test"));
    CHECK_INT(t, g[6].reference_mode, 2);
    CHECK(t, !MT_HAS(g[6].equals));
    CHECK_INT(t, g[0].reference, MT_ABSENT);
}

static void check_at_rest(mt_test *t, const mt_study *s)
{
    const mt_goal *const g = &s->goals[8];
    CHECK_INT(t, g->type, MT_GOAL_STATIC);
    if (CHECK(t, g->static_limit != NULL)) {
        CHECK_STR(t, g->static_limit->output.s, "s2.r");
        CHECK_STR(t, g->static_limit->input.s, "s2.x");
        CHECK_INT(t, g->static_limit->quantity, MT_STATIC_STIFFNESS);
        CHECK_INT(t, g->static_limit->against, 0);
        CHECK_STR(t, g->static_limit->unit, "N per rad");
    }
    CHECK_NEAR(t, g->equals, 1.0 / 3.0, TOL);
    CHECK_NEAR(t, g->weight, 4.0, TOL);
    if (CHECK(t, g[1].static_limit != NULL)) {
        CHECK_STR(t, g[1].static_limit->unit, "N m");
        CHECK(t, g[1].static_limit->input.s == NULL);
        CHECK_INT(t, g[1].static_limit->against, MT_ABSENT);
    }
    CHECK_NEAR(t, g[1].at_least, -2.0, TOL);
}

static void check_goals_of_two_modes(mt_test *t, const mt_study *s)
{
    const mt_goal *const g = s->goals + 10;
    CHECK_INT(t, g[0].type, MT_GOAL_RATIO);
    CHECK_INT(t, g[0].of.configuration, mt_model_find_configuration(s->model, "bare"));
    CHECK_INT(t, g[0].of.mode.index, 2);
    CHECK_INT(t, g[0].of.mode.named, MT_ABSENT);
    CHECK_INT(t, g[0].mode.named, mt_model_find_mode(s->model, "in phase"));
    CHECK_NEAR(t, g[0].equals, 0.6, TOL);
    CHECK_NEAR(t, g[0].weight, 4.0, TOL);
    CHECK_INT(t, g[1].of.configuration, MT_ABSENT);
    CHECK_INT(t, g[1].of.mode.index, 1);
    CHECK_INT(t, g[1].n_configurations, 2);
    CHECK_NEAR(t, g[1].at_least, 1.5, TOL);
    CHECK_NEAR(t, g[1].at_most, 4.0, TOL);
    CHECK_INT(t, g[2].type, MT_GOAL_APART);
    if (CHECK_INT(t, g[2].n_modes, 2)) {
        CHECK_INT(t, g[2].modes[0].index, 1);
        CHECK_INT(t, g[2].modes[1].named, mt_model_find_mode(s->model, "in phase"));
    }
    CHECK_NEAR(t, g[2].at_least, 5.0, TOL);
    CHECK(t, !MT_HAS(g[2].at_least_hz) && !MT_HAS(g[2].at_most) && !MT_HAS(g[2].equals));
    CHECK_STR(t, mt_study_goal_unit(s, &g[2]), "%");
    CHECK_STR(t, mt_goal_number_name(&g[2], MT_SLOT_AT_LEAST), "at_least_percent");
    if (CHECK_INT(t, g[3].n_modes, 3)) {
        CHECK_INT(t, g[3].modes[2].index, 3);
        CHECK_INT(t, g[3].modes[2].named, MT_ABSENT);
    }
    CHECK_NEAR(t, g[3].at_least, 0.01, TOL);
    CHECK_NEAR(t, g[3].at_least_hz, 0.01, TOL);
    CHECK_STR(t, mt_study_goal_unit(s, &g[3]), "Hz");
    CHECK_STR(t, mt_goal_number_name(&g[3], MT_SLOT_AT_LEAST), "at_least_hz");
}

static void check_measured(mt_test *t, const mt_study *s)
{
    const mt_goal *const g = &s->goals[7];
    if (!CHECK_INT(t, s->n_measurements, 2) ||
        !CHECK_INT(t, g->type, MT_GOAL_FREQUENCY_RESPONSE)) {
        return;
    }
    const mt_measurement *const m = &s->measurements[0];
    CHECK_INT(t, g->n_configurations, 2);
    CHECK_STR(t, g->response_limit->input.s, "s1.x");
    CHECK_STR(t, g->response_limit->output.s, "s2.x:acceleration");
    CHECK_INT(t, g->response_limit->measurement, 0);
    CHECK(t, g->response_limit->coherence);
    CHECK_NEAR(t, g->response_limit->lower_hz, 0.5, TOL);
    CHECK_NEAR(t, g->response_limit->upper_hz, 3.0, TOL);
    CHECK_NEAR(t, g->weight, 2.0, TOL);
    CHECK_NEAR(t, m->factor, 2.0, TOL);
    if (CHECK_INT(t, m->n_responses, 1) && CHECK_INT(t, m->responses[0].n_lines, 3)) {
        CHECK_NEAR(t, m->responses[0].scale, 2.0, TOL);
        CHECK_NEAR(t, m->responses[0].lines[2].coherence, 0.75, TOL);
    }
    CHECK(t, s->measurements[1].responses[0].scale == 1.0);
}

static void check_references(mt_test *t, const mt_study *s)
{
    if (!CHECK_INT(t, s->n_references, 2)) {
        return;
    }
    const mt_reference *const r = s->references;
    CHECK(t, r[0].model == s->model); /* the same file is read once */
    CHECK_INT(t, r[0].configuration, mt_model_find_configuration(s->model, "loaded"));
    CHECK(t, r[1].model == NULL);
    if (CHECK_INT(t, r[1].n_modes, 2) && CHECK_INT(t, r[1].modes[0].n_values, 3)) {
        CHECK_NEAR(t, r[1].modes[0].frequency_hz, 4.3, TOL);
        CHECK_STR(t, r[1].modes[0].channels[1].s, "s2.x");
        CHECK_NEAR(t, r[1].modes[0].values[1], 0.25, TOL);
        CHECK_INT(t, r[1].modes[1].n_values, 0);
    }
    CHECK_STR(t, r[1].source, "made up");
}

static void check_objectives(mt_test *t, const mt_study *s)
{
    if (!CHECK_INT(t, s->n_objectives, 4)) {
        return;
    }
    CHECK_INT(t, s->objectives[0].type, MT_OBJECTIVE_MISFIT);
    CHECK_INT(t, s->objectives[1].type, MT_OBJECTIVE_MASS);
    CHECK_INT(t, s->objectives[1].of.count, 2);
    CHECK_INT(t, s->objectives[2].type, MT_OBJECTIVE_EXPRESSION);
    CHECK_STR(t, s->objectives[2].expression_text, "k1 + k2");
    CHECK_INT(t, s->objectives[3].type, MT_OBJECTIVE_CHANGE);
}

static void check_published(mt_test *t, const mt_study *s)
{
    if (!CHECK_INT(t, s->n_published, 6)) {
        return;
    }
    const mt_published *const p = s->published;
    CHECK_INT(t, p[0].kind, MT_PUBLISHED_PARAMETER);
    CHECK_INT(t, p[0].role, MT_ROLE_CALIBRATES);
    CHECK_STR(t, p[0].label, "first spring");
    CHECK_STR(t, p[0].source, "Table 2");
    CHECK_NEAR(t, p[0].tolerance_percent, 1.0, TOL);
    CHECK(t, !MT_HAS(p[0].tolerance) && !p[0].original);
    CHECK_INT(t, p[1].kind, MT_PUBLISHED_QUANTITY);
    CHECK(t, p[1].original);
    CHECK_INT(t, p[1].role, MT_ROLE_NOT_COMPARABLE);
    CHECK_INT(t, p[2].kind, MT_PUBLISHED_FREQUENCY);
    CHECK_INT(t, p[2].configuration, mt_model_find_configuration(s->model, "bare"));
    CHECK_INT(t, p[2].mode.index, 2);
    CHECK_INT(t, p[2].role, MT_ROLE_VERIFIES);
    CHECK_INT(t, p[3].kind, MT_PUBLISHED_MAC);
    CHECK_INT(t, p[3].reference, mt_study_find_reference(s, "test"));
    CHECK_INT(t, p[3].reference_mode, 1);
    CHECK_NEAR(t, p[3].value, 0.99804, TOL);
    CHECK_NEAR(t, p[3].at_least, 0.99784, TOL);
    CHECK_NEAR(t, p[4].at_most, 1.5, TOL);
    CHECK_INT(t, p[5].kind, MT_PUBLISHED_STATUS);
    CHECK_STR(t, p[5].status, "compromise");
}

static void study__every_member_arrives(mt_test *t)
{
    mt_study *const s = load(t, FULL);
    REQUIRE(t, s != NULL);
    CHECK_STR(t, s->name, "Every member once");
    CHECK_INT(t, s->recommendations, 3);
    CHECK_INT(t, s->search.seed, 7);
    CHECK_INT(t, s->search.starts, 12);
    CHECK_INT(t, s->search.max_evaluations, 5000);
    CHECK_INT(t, s->search.max_modal_solutions, 90000);
    CHECK_NEAR(t, s->search.proof_s, 10.0, 0.0);
    CHECK_NEAR(t, s->weight_sensitivity.factor, 4.0, 0.0);
    if (CHECK_INT(t, s->n_goals, 16)) {
        check_goals_of_two_modes(t, s);
        check_frequency_goals(t, s);
        check_other_goals(t, s);
        check_energy_goals(t, s);
        check_measured(t, s);
        check_at_rest(t, s);
    }
    check_variables(t, s);
    check_references(t, s);
    check_objectives(t, s);
    check_published(t, s);
    mt_study_delete(s);
}

static void study__inputs_are_listed_with_their_digests(mt_test *t)
{
    mt_study *const s = load(t, FULL);
    REQUIRE(t, s != NULL);
    if (CHECK_INT(t, s->n_inputs, 5)) {
        CHECK_STR(t, s->inputs[0].name, "study_full.json");
        CHECK_STR(t, s->inputs[1].name, "../wrong/parts/model.json");
        CHECK_STR(t, s->inputs[2].name, "../wrong/parts/weights.csv");
        CHECK_STR(t, s->inputs[3].name, "../wrong/parts/measured.csv");
        CHECK_STR(t, s->inputs[1].sha256, s->model->sha256);
        CHECK_INT(t, strlen(s->inputs[0].sha256), 64);
    }
    mt_study_delete(s);
}

static void study__defaults_are_filled_in(mt_test *t)
{
    mt_study *s = load_text(t, "", NULL);
    if (s != NULL) {
        CHECK_STR(t, s->name, "two.masses");
        CHECK_INT(t, s->recommendations, 5);
        CHECK_INT(t, s->search.seed, 1);
        CHECK_INT(t, s->search.starts, 0);
        CHECK(t, isnan(s->weight_sensitivity.factor));
        CHECK_INT(t, s->n_objectives, 0); /* nothing may change */
    }
    mt_study_delete(s);
    s = load_text(t, ", \"variables\": [{\"parameter\": \"k1\", \"lower\": 1, \"upper\": 10}]",
                  NULL);
    if (s != NULL && CHECK_INT(t, s->n_objectives, 1)) {
        CHECK_INT(t, s->objectives[0].type, MT_OBJECTIVE_CHANGE);
    }
    mt_study_delete(s);
}

static void study__bounds_below_zero_are_fine(mt_test *t)
{
    mt_study *const s = load_text(
        t, ", \"variables\": [{\"parameter\": \"k1\", \"lower\": -1, \"upper\": 4}]", NULL);
    if (s != NULL) {
        CHECK_NEAR(t, s->variables[0].lower, -1.0, TOL);
        CHECK_NEAR(t, s->variables[0].range, 5.0, TOL);
    }
    mt_study_delete(s);
}

static void study__an_original_value_outside_the_bounds_is_a_warning(mt_test *t)
{
    mt_diagnostics messages = {.count = 0};
    mt_study *const s = load_text(
        t, ", \"variables\": [{\"parameter\": \"k1\", \"lower\": 4, \"upper\": 5}]", &messages);
    CHECK(t, messages.lines.s != NULL &&
                 strstr(messages.lines.s,
                        "warning: /variables/0: the original value of \"k1\" (3) "
                        "lies outside 4 to 5\n") != NULL);
    mt_study_delete(s);
    mt_diagnostics_free(&messages);
}

static void study__models_lie_beneath_the_root(mt_test *t)
{
    static const struct {
        const char *name;
        const char *root;
        mt_status want;
    } rows[] = {
        {"default: the parent of the study's folder", NULL, MT_OK},
        {"a folder above", MT_TEST_SOURCE_DIR, MT_OK},
        {"a folder that holds the model only", MT_TEST_SOURCE_DIR "/tests/documents/wrong",
         MT_OK},
        {"a folder that does not", MT_TEST_SOURCE_DIR "/tests/documents/good", MT_E_INPUT},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_study *s = NULL;
        mt_diagnostics messages = {.count = 0};
        const mt_io_options opt = {.root = rows[i].root};
        mt_test_row(t, "%s", rows[i].name);
        CHECK_INT(t, mt_study_load(FULL, &opt, &s, &messages, NULL), rows[i].want);
        const bool told = messages.lines.s != NULL &&
                          strstr(messages.lines.s, "outside the root folder") != NULL;
        CHECK(t, told == (rows[i].want != MT_OK));
        mt_study_delete(s);
        mt_diagnostics_free(&messages);
    }
}

/* The place of every member of a long study is known as long as the study lives. */
static void study__the_last_of_many_goals_has_its_line(mt_test *t)
{
    enum { GOALS = 1500 };
    mt_text members = {0};
    mt_diagnostics messages = {.count = 0};
    mt_arena mem = {.first = NULL};
    mt_warning warning = {.addr = MT_NO_ADDR};
    int line = 0;
    int column = 0;
    mt_text_add(&members, ", \"goals\": [");
    for (int i = 0; i < GOALS; i++) {
        mt_text_addf(&members,
                     "%s\n{\"type\": \"frequency\", \"mode\": 1, \"at_most_hz\": %d, "
                     "\"configuration\": \"bare\"}",
                     i == 0 ? "" : ",", 1000 + i);
    }
    mt_text_add(&members, "]");
    mt_study *const s = load_text(t, members.s, &messages);
    if (CHECK(t, s != NULL) && CHECK_INT(t, s->n_goals, GOALS)) {
        const mt_addr last = s->goals[GOALS - 1].addr;
        warning.addr = mt_study_member(s, last, "at_most_hz");
        mt_study_place_warning(s, &mem, &warning);
        CHECK_INT(t, warning.line, GOALS + 1);
        CHECK_STR(t, warning.pointer, "/goals/1499/at_most_hz");
        CHECK(t, mt_study_locate(s, "/goals/1499: what is said", &line, &column));
        CHECK_INT(t, line, GOALS + 1);
        CHECK_INT(t, column, 1);
        CHECK(t, mt_study_locate(s, "/goals/1499/mode: what is said", &line, &column));
        CHECK_INT(t, column, 31);
        CHECK(t, !mt_study_locate(s, "/goals/1500: what is said", &line, &column));
        CHECK(t, !mt_study_locate(s, "/goals/x: what is said", &line, &column));
        CHECK(t, !mt_study_locate(s, "goals: what is said", &line, &column));
        CHECK(t, mt_study_member(s, last, "weight") == last);
    }
    mt_study_delete(s);
    mt_arena_free(&mem);
    mt_diagnostics_free(&messages);
    mt_text_free(&members);
}

static void study__no_file_is_a_system_failure(mt_test *t)
{
    mt_study *s = NULL;
    mt_err err = {.text = ""};
    CHECK_INT(t, mt_study_load("/nonexistent/study.json", NULL, &s, NULL, &err), MT_E_SYSTEM);
    CHECK(t, s == NULL);
    CHECK(t, strstr(err.text, "/nonexistent/study.json") != NULL);
}

static mt_status load_once(mt_test *t, const void *context)
{
    mt_study *s = NULL;
    mt_diagnostics messages = {.count = 0};
    const mt_status rc = mt_study_load(FULL, NULL, &s, &messages, NULL);
    (void)context;
    CHECK(t, (rc == MT_OK) == (s != NULL));
    mt_study_delete(s);
    mt_diagnostics_free(&messages);
    return rc;
}

static void study__every_failing_allocation_is_survived(mt_test *t)
{
    mt_refuse_each(t, "load_once", load_once, NULL, MT_OK);
}

MT_TEST_MAIN(MT_TEST(study__every_member_arrives),
             MT_TEST(study__inputs_are_listed_with_their_digests),
             MT_TEST(study__defaults_are_filled_in), MT_TEST(study__bounds_below_zero_are_fine),
             MT_TEST(study__an_original_value_outside_the_bounds_is_a_warning),
             MT_TEST(study__models_lie_beneath_the_root),
             MT_TEST(study__the_last_of_many_goals_has_its_line),
             MT_TEST(study__no_file_is_a_system_failure),
             MT_TEST(study__every_failing_allocation_is_survived))
