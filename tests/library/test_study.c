/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The public functions, as a stranger's program sees them: public headers only. */
#include "modetune/study.h"

#include <math.h>
#include <string.h>

#include "mt_test.h"

#define STUDIES MT_TEST_SOURCE_DIR "/tests/install/"

static const double PI = 3.14159265358979323846;

/* Uniform bar of length l and square section w on a pivot at its end: omega^2 = (g l/2)/(l^2/3
 * + w^2/12). */
static double pendulum_hz(double l)
{
    const double w = 0.05;
    return sqrt((9.81 * l / 2.0) / ((l * l / 3.0) + (w * w / 12.0))) / (2.0 * PI);
}

static void study__is_read_solved_and_told(mt_test *t)
{
    mt_study *study = NULL;
    mt_result *result = NULL;
    char *text = NULL;
    CHECK_INT(t, mt_study_read(STUDIES "pendulum_study.json", NULL, &study, NULL), MT_OK);
    REQUIRE(t, study != NULL);
    CHECK_INT(t, mt_study_solve(study, NULL, &result, NULL), MT_OK);
    mt_study_delete(study);
    REQUIRE(t, result != NULL);
    CHECK_INT(t, mt_result_outcome(result), MT_RESULT_SOLVED);
    CHECK_STR(t, mt_result_status_name(mt_result_outcome(result)), "solved");
    CHECK_INT(t, mt_result_recommendations(result), 1);
    CHECK(t, strstr(mt_result_summary(result), "Solved") != NULL);
    CHECK_NEAR(t, mt_result_value(result, 0, "L"), 1.0, 0.0);
    CHECK_NEAR(t, pendulum_hz(mt_result_value(result, 1, "L")), 0.7, 1e-9);
    CHECK_NEAR(t, mt_result_hz(result, 1, "hanging", 1), 0.7, 1e-9);
    CHECK_NEAR(t, mt_result_hz(result, 0, "hanging", 1), pendulum_hz(1.0), 1e-12);
    CHECK(t, mt_result_feasible(result, 1) == 1 && mt_result_feasible(result, 0) == 0);
    CHECK(t, mt_result_reasons(result, 1) > 0 && mt_result_reason(result, 1, 0) != NULL);
    /* what is not there */
    CHECK(t, isnan(mt_result_value(result, 1, "m")) && isnan(mt_result_value(result, 2, "L")));
    CHECK(t, isnan(mt_result_hz(result, 1, "hanging", 2)));
    CHECK(t, isnan(mt_result_hz(result, -1, "hanging", 1)));
    CHECK(t, mt_result_reasons(result, 2) == 0 && mt_result_reason(result, 1, -1) == NULL);
    CHECK_INT(t, mt_result_json(result, &text, NULL), MT_OK);
    CHECK(t, text != NULL && strstr(text, "\"format\": \"modetune-result/1\"") != NULL);
    mt_string_delete(text);
    mt_result_delete(result);
}

/* The question and its model as texts; the answer as that of the file, but for their names. */
static void study__is_text_in_and_text_out(mt_test *t)
{
    static const char question[] =
        "{\"format\": \"modetune-study/1\", \"name\": \"A pendulum\",\n"
        " \"model\": \"p.json\", \"variables\": [\n"
        "  {\"parameter\": \"L\", \"lower\": 0.3, \"upper\": 2},\n"
        "  {\"parameter\": \"m\", \"catalogue\": [3, 1, 2]}],\n"
        " \"goals\": [{\"type\": \"frequency\", \"configuration\": \"default\","
        " \"mode\": 1, \"target_hz\": 0.7}]}";
    static const mt_file_text files[2] = {
        {"p.json", "{\"format\": \"modetune-model/1\", \"dimension\": 2,\n"
                   " \"gravity_m_per_s2\": [0, -9.81], \"parameters\": {\"L\": 1, \"m\": 1},\n"
                   " \"bodies\": [{\"name\": \"rod\", \"mass_kg\": \"m\","
                   " \"inertia_kg_m2\": \"m*(L^2 + 0.05^2)/12\", \"centre\": [0, \"-L/2\"]}],\n"
                   " \"joints\": [{\"name\": \"pin\", \"type\": \"revolute\","
                   " \"bodies\": [\"ground\", \"rod\"], \"at\": [0, 0]}]}\n"},
        {"q.json", question},
    };
    mt_read_options read = {.size = sizeof read, .files = files, .n_files = 2, .files_only = 1};
    mt_study *study = NULL;
    mt_result *result = NULL;
    char *text = NULL;
    mt_err err = {MT_OK, ""};
    CHECK_INT(t, mt_study_read("q.json", &read, &study, &err), MT_OK);
    CHECK_STR(t, err.text, "");
    REQUIRE(t, study != NULL);
    CHECK_STR(t, mt_study_title(study), "A pendulum");
    CHECK_INT(t, mt_model_dimension(mt_study_model(study)), 2);
    CHECK_INT(t, mt_study_variable_count(study), 2);
    CHECK_STR(t, mt_study_variable_name(study, 1), "m");
    CHECK_NEAR(t, mt_study_variable_original(study, 0), 1.0, 0.0);
    CHECK_NEAR(t, mt_study_variable_lower(study, 0), 0.3, 0.0);
    CHECK_NEAR(t, mt_study_variable_upper(study, 0), 2.0, 0.0);
    CHECK_NEAR(t, mt_study_variable_lower(study, 1), 1.0, 0.0);
    CHECK_NEAR(t, mt_study_variable_upper(study, 1), 3.0, 0.0);
    CHECK_INT(t, mt_study_solve(study, NULL, &result, NULL), MT_OK);
    CHECK_NEAR(t, pendulum_hz(mt_result_value(result, 1, "L")), 0.7, 1e-9);
    mt_result_delete(result);
    mt_study_delete(study);
    CHECK_INT(t, mt_solve_json(question, &read, NULL, &text, &err), MT_OK);
    CHECK_STR(t, err.text, "");
    CHECK(t, text != NULL && strstr(text, "\"status\": \"solved\"") != NULL &&
                 strstr(text, "study.json") != NULL);
    mt_string_delete(text);
    /* its faults have places in it */
    REQUIRE(t, mt_diagnostics_new(&read.diagnostics, NULL) == MT_OK);
    CHECK_INT(t, mt_solve_json("{\"goals\": 1}", &read, NULL, &text, &err), MT_E_INPUT);
    CHECK(t, text == NULL && mt_diagnostics_count(read.diagnostics) > 1);
    CHECK_STR(t, mt_diagnostics_file(read.diagnostics, 0), "study.json");
    mt_diagnostics_delete(read.diagnostics);
}

/* Written and read back, a result says the same, to the byte. */
static void study__result_is_read_back(mt_test *t)
{
    mt_study *study = NULL;
    mt_result *result = NULL;
    mt_result *again = NULL;
    char *text[2] = {NULL, NULL};
    char *page[2] = {NULL, NULL};
    mt_err err = {MT_OK, ""};
    REQUIRE(t, mt_study_read(STUDIES "pendulum_study.json", NULL, &study, &err) == MT_OK);
    REQUIRE(t, mt_study_solve(study, NULL, &result, &err) == MT_OK);
    CHECK_INT(t, mt_result_json(result, &text[0], &err), MT_OK);
    CHECK_INT(t, mt_result_html(result, &page[0], &err), MT_OK);
    /* its name is that of a result in its folder, but it is no file */
    const mt_file_text file = {"somewhere/result.json", text[0]};
    mt_read_options opt = {.size = sizeof opt, .files = &file, .n_files = 1, .files_only = 1};
    CHECK_INT(t, mt_result_read("somewhere/result.json", &opt, &again, &err), MT_OK);
    CHECK_STR(t, err.text, "");
    CHECK_INT(t, mt_result_outcome(again), mt_result_outcome(result));
    CHECK_STR(t, mt_result_summary(again), mt_result_summary(result));
    CHECK_NEAR(t, mt_result_value(again, 1, "L"), mt_result_value(result, 1, "L"), 0.0);
    CHECK_INT(t, mt_result_json(again, &text[1], &err), MT_OK);
    CHECK_INT(t, mt_result_html(again, &page[1], &err), MT_OK);
    CHECK_STR(t, text[1], text[0]);
    CHECK_STR(t, page[1], page[0]);
    CHECK(t, page[0] != NULL && strncmp(page[0], "<!DOCTYPE html>", 15) == 0);
    mt_result_delete(again);
    /* what is not a result is said with its place */
    const mt_file_text wrong = {"r.json", "{\n \"status\": \"merry\"}"};
    opt.files = &wrong;
    REQUIRE(t, mt_diagnostics_new(&opt.diagnostics, NULL) == MT_OK);
    CHECK_INT(t, mt_result_read("r.json", &opt, &again, &err), MT_E_INPUT);
    CHECK(t, again == NULL && mt_diagnostics_count(opt.diagnostics) > 0);
    CHECK_STR(t, mt_diagnostics_file(opt.diagnostics, 0), "r.json");
    CHECK_INT(t, mt_result_read("other.json", &opt, &again, &err), MT_E_SYSTEM);
    mt_diagnostics_delete(opt.diagnostics);
    for (int i = 0; i < 2; i++) {
        mt_string_delete(text[i]);
        mt_string_delete(page[i]);
    }
    mt_result_delete(result);
    mt_study_delete(study);
}

static void missing_study__is_said(mt_test *t)
{
    mt_study *study = NULL;
    mt_err err = {MT_OK, ""};
    CHECK_INT(t, mt_study_read(STUDIES "nothing.json", NULL, &study, &err), MT_E_SYSTEM);
    CHECK(t, study == NULL);
    CHECK(t, strstr(err.text, "nothing.json") != NULL);
    mt_study_delete(study);
    mt_result_delete(NULL);
}

MT_TEST_MAIN(MT_TEST(study__is_read_solved_and_told), MT_TEST(study__is_text_in_and_text_out),
             MT_TEST(study__result_is_read_back), MT_TEST(missing_study__is_said))
