/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The public functions, as a stranger's program sees them: public headers only. */
#include "modetune/model.h"
#include "modetune/modes.h"
#include "modetune/study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mt_test.h"

#define MODELS  MT_TEST_SOURCE_DIR "/tests/models/"
#define STUDIES MT_TEST_SOURCE_DIR "/tests/install/"

static const double PI = 3.14159265358979323846;

/* Uniform bar of length l and square section w on a pivot at its end: omega^2 = (g l/2)/(l^2/3
 * + w^2/12). */
static double pendulum_hz(double l)
{
    const double w = 0.05;
    return sqrt((9.81 * l / 2.0) / ((l * l / 3.0) + (w * w / 12.0))) / (2.0 * PI);
}

static mt_model *read_model(mt_test *t, const char *path)
{
    mt_model *model = NULL;
    CHECK_INT(t, mt_model_read(path, NULL, &model, NULL), MT_OK);
    return model;
}

static void frequencies__follow_settings_and_configurations(mt_test *t)
{
    mt_model *const model = read_model(t, MODELS "pendulum.json");
    const mt_setting settings[] = {{"L", 0.5}, {"m", 7.0}};
    mt_mode_count count;
    double hz[3] = {-1.0, -1.0, -1.0};
    REQUIRE(t, model != NULL);
    CHECK_INT(t, mt_model_frequencies(model, NULL, 0, NULL, 3, hz, &count, NULL), MT_OK);
    CHECK_INT(t, count.vibration, 1);
    CHECK_INT(t, count.rigid_body, 0);
    CHECK_NEAR(t, hz[0], pendulum_hz(1.0), 1e-12);
    CHECK_NEAR_ABS(t, hz[1], -1.0, 0.0); /* not touched */
    CHECK_INT(t, mt_model_frequencies(model, "twice", 2, settings, 3, hz, &count, NULL), MT_OK);
    CHECK_NEAR(t, hz[0], pendulum_hz(0.5), 1e-12);
    hz[0] = -1.0;
    CHECK_INT(t, mt_model_frequencies(model, "upside_down", 0, NULL, 3, hz, &count, NULL),
              MT_OK);
    CHECK_INT(t, count.unstable, 1);
    CHECK_NEAR_ABS(t, hz[0], -1.0, 0.0); /* nothing has an index there */
    mt_model_delete(model);
}

static void frequencies__are_cut_at_the_capacity(mt_test *t)
{
    mt_model *const model = read_model(t, MODELS "eight_masses.json");
    mt_mode_count count;
    double hz[2] = {0.0, 0.0};
    REQUIRE(t, model != NULL);
    CHECK_INT(t, mt_model_frequencies(model, "guided", 0, NULL, 2, hz, &count, NULL), MT_OK);
    CHECK_INT(t, count.vibration, 8);
    for (int k = 1; k <= 2; k++) { /* f_k = (1/pi) sqrt(k/m) sin(k pi/18) */
        CHECK_NEAR(t, hz[k - 1], sqrt(1e4) / PI * sin(k * PI / 18.0), 1e-9);
    }
    CHECK_INT(t, mt_model_frequencies(model, "guided", 0, NULL, 0, NULL, &count, NULL), MT_OK);
    CHECK_INT(t, count.vibration, 8);
    mt_model_delete(model);
}

static void wrong_arguments__are_refused_by_name(mt_test *t)
{
    mt_model *const model = read_model(t, MODELS "pendulum.json");
    const mt_setting unknown = {"l", 0.5};
    const mt_setting twice[] = {{"L", 0.5}, {"L", 0.6}};
    mt_mode_count count;
    mt_err err = {MT_OK, ""};
    REQUIRE(t, model != NULL);
    CHECK_INT(t, mt_model_frequencies(model, "hangin", 0, NULL, 0, NULL, &count, &err),
              MT_E_USAGE);
    CHECK_STR(t, err.text, "no configuration is called \"hangin\"; did you mean \"hanging\"?");
    CHECK_INT(t, mt_model_frequencies(model, NULL, 1, &unknown, 0, NULL, &count, &err),
              MT_E_USAGE);
    CHECK(t, strstr(err.text, "no parameter is called \"l\"") != NULL);
    CHECK_INT(t, mt_model_frequencies(model, NULL, 2, twice, 0, NULL, &count, &err),
              MT_E_USAGE);
    CHECK_STR(t, err.text, "parameter \"L\" is set twice");
    CHECK_INT(t, mt_model_frequencies(model, NULL, 0, NULL, 1, NULL, &count, &err), MT_E_USAGE);
    CHECK_INT(t, mt_model_frequencies(NULL, NULL, 0, NULL, 0, NULL, &count, &err), MT_E_USAGE);
    mt_model_delete(model);
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
    free(text);
    mt_result_delete(result);
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

MT_TEST_MAIN(MT_TEST(frequencies__follow_settings_and_configurations),
             MT_TEST(frequencies__are_cut_at_the_capacity),
             MT_TEST(wrong_arguments__are_refused_by_name),
             MT_TEST(study__is_read_solved_and_told), MT_TEST(missing_study__is_said))
