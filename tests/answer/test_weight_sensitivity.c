/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One spring, one mass, f = sqrt(k/m)/(2 pi), and two measurements f_1, f_2 that contradict
 * each other, weights w_1, w_2. In t = ln k each residual is (t - t_i)/2, so the misfit is
 * least at the weighted mean
 *     ln k = (w_1 ln k_1 + w_2 ln k_2)/(w_1 + w_2),   k_i = (2 pi f_i)^2 m.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "mt_test.h"
#include "result/result.h"
#include "study/read.h"
#include "study/study.h"

static const char MODEL[] =
    "{\"format\": \"modetune-model/1\", \"dimension\": 2,"
    " \"parameters\": {\"k\": {\"value\": 50, \"unit\": \"N/m\"}, \"L\": 1},"
    " \"bodies\": [{\"name\": \"a\", \"mass_kg\": 2, \"centre\": [1, 0]}],"
    " \"joints\": [{\"name\": \"rail\", \"type\": \"pin-in-slot\", \"bodies\": [\"ground\", "
    "\"a\"], \"at\": [1, 0], \"axis\": [1, 0]}],"
    " \"springs\": [{\"name\": \"s\", \"type\": \"axial\", \"bodies\": [\"ground\", \"a\"], "
    "\"at\": [[0, 0], [1, 0]], \"stiffness_n_per_m\": \"k\"}],"
    " \"configurations\": {\"only\": {}}}";
static const char STUDY[] =
    "{\"format\": \"modetune-study/1\", \"model\": \"model.json\","
    " \"variables\": [{\"parameter\": \"k\", \"lower\": 1, \"upper\": 1000}],"
    " \"goals\": [{\"type\": \"frequency\", \"mode\": 1, \"target_hz\": 1.0, \"weight\": 1},"
    "  {\"type\": \"frequency\", \"mode\": 1, \"target_hz\": %s, \"weight\": 3}],"
    " \"objective\": {\"minimise\": \"misfit\"}%s}";
static const double PI = 3.14159265358979323846;
/* The least-squares step ends at 1e-8 of the gradient; the slope is about one. */
static const double TOL = 1e-7;

static void write_file(mt_test *t, const char *folder, const char *name, const char *format,
                       const char *a, const char *b)
{
    char path[64];
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *const f = fopen(path, "w");
    if (CHECK(t, f != NULL)) {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
        (void)fprintf(f, format, a, b);
#pragma GCC diagnostic pop
        CHECK_INT(t, fclose(f), 0);
    }
}

/* Solve with a second target and further members; NULL where that fails. */
static mt_result *solve(mt_test *t, const char *second_hz, const char *more)
{
    char folder[] = "/tmp/mt_weight_sensitivity_XXXXXX";
    char path[64];
    mt_study *study = NULL;
    mt_result *result = NULL;
    mt_err err = {.text = ""};
    if (!CHECK(t, mkdtemp(folder) != NULL)) {
        return NULL;
    }
    write_file(t, folder, "model.json", "%s%s", MODEL, "");
    write_file(t, folder, "study.json", STUDY, second_hz, more);
    (void)snprintf(path, sizeof path, "%s/study.json", folder);
    CHECK_INT(t, mt_study_load(path, NULL, &study, NULL, &err), MT_OK);
    if (study != NULL) {
        CHECK_INT(t, mt_study_solve(study, NULL, &result, &err), MT_OK);
    }
    CHECK_STR(t, err.text, "");
    mt_study_delete(study);
    (void)unlink(path);
    (void)snprintf(path, sizeof path, "%s/model.json", folder);
    (void)unlink(path);
    (void)rmdir(folder);
    return result;
}

static double mean_stiffness(double w1, double w2, double f2)
{
    const double k1 = 4.0 * PI * PI * 2.0;
    const double k2 = k1 * f2 * f2;
    return exp(((w1 * log(k1)) + (w2 * log(k2))) / (w1 + w2));
}

static void spread__is_the_range_of_weighted_means(mt_test *t)
{
    mt_result *const r = solve(t, "1.2", ", \"spread\": {\"factor\": 5}");
    REQUIRE(t, r != NULL);
    CHECK_INT(t, r->n_weight_sensitivity, 1);
    if (r->n_weight_sensitivity == 1) {
        const mt_result_weight_sensitivity *const s = &r->weight_sensitivity[0];
        const double value = mean_stiffness(1.0, 3.0, 1.2);
        const double low = mean_stiffness(5.0, 3.0, 1.2); /* as good as 1 and 3/5 */
        const double high = mean_stiffness(1.0, 15.0, 1.2);
        CHECK_STR(t, s->parameter, "k");
        CHECK_STR(t, s->unit, "N/m");
        CHECK_NEAR(t, s->value, value, TOL);
        CHECK_NEAR(t, s->low, low, TOL);
        CHECK_NEAR(t, s->high, high, TOL);
        CHECK_NEAR(t, s->low_percent, 100.0 * (low / value - 1.0), 1e-4);
        CHECK_NEAR(t, s->high_percent, 100.0 * (high / value - 1.0), 1e-4);
        /* raising one weight and lowering the other give the same design: either is a true
         * answer */
        if (CHECK(t, s->low_goal != NULL && s->high_goal != NULL)) {
            CHECK(t, s->low_factor == (s->low_goal[7] == '0' ? 5.0 : 0.2));
            CHECK(t, s->high_factor == (s->high_goal[7] == '0' ? 0.2 : 5.0));
        }
    }
    CHECK_NEAR(t, r->recommendations[0].parameters[0].recommended,
               mean_stiffness(1.0, 3.0, 1.2), TOL);
    mt_result_delete(r);
}

static void spread__is_nothing_where_the_data_agree(mt_test *t)
{
    mt_result *const r = solve(t, "1.0", ", \"spread\": {\"factor\": 5}");
    REQUIRE(t, r != NULL);
    CHECK_INT(t, r->n_weight_sensitivity, 1);
    if (r->n_weight_sensitivity == 1) {
        CHECK_NEAR(t, r->weight_sensitivity[0].low, r->weight_sensitivity[0].value, TOL);
        CHECK_NEAR(t, r->weight_sensitivity[0].high, r->weight_sensitivity[0].value, TOL);
    }
    mt_result_delete(r);
}

static void spread__is_absent_where_nobody_asks(mt_test *t)
{
    mt_result *const r = solve(t, "1.2", "");
    REQUIRE(t, r != NULL);
    CHECK_INT(t, r->n_weight_sensitivity, 0);
    mt_result_delete(r);
}

MT_TEST_MAIN(MT_TEST(spread__is_the_range_of_weighted_means),
             MT_TEST(spread__is_nothing_where_the_data_agree),
             MT_TEST(spread__is_absent_where_nobody_asks))
