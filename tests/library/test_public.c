/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Every function of include/, with NULL for each of its pointers in turn: what the convention
 * in modetune/status.h says is what happens. The headers are read, so that a function, or an
 * argument, that is not in the table here is found.
 */

#include <dirent.h>

#include "library/public_calls.h"

/* One letter for each pointer among the arguments: r refused, u refused for what else is asked,
 * a allowed, n answered with nothing. */
#define ROW(name, nulls)                \
    {                                   \
        "mt_" #name, nulls, call_##name \
    }
static const struct {
    const char *name;
    const char *nulls;
    mt_status (*call)(int null);
} rows[] = {
    ROW(status_text, ""),
    ROW(status_name, ""),
    ROW(fail, "aa"),
    ROW(err_in, "aa"),
    ROW(version, ""),
    ROW(diagnostics_new, "ra"),
    ROW(diagnostics_delete, "a"),
    ROW(diagnostics_count, "n"),
    ROW(diagnostics_left_out, "a"),
    ROW(diagnostics_severity, "n"),
    ROW(diagnostics_file, "n"),
    ROW(diagnostics_line, "n"),
    ROW(diagnostics_column, "n"),
    ROW(diagnostics_pointer, "n"),
    ROW(diagnostics_message, "n"),
    ROW(diagnostics_text, "n"),
    ROW(model_read, "rara"),
    ROW(model_delete, "a"),
    ROW(model_title, "n"),
    ROW(model_dimension, "n"),
    ROW(model_parameter_count, "n"),
    ROW(model_parameter_name, "n"),
    ROW(model_parameter_unit, "n"),
    ROW(model_parameter_follows, "a"),
    ROW(model_configuration_count, "n"),
    ROW(model_configuration_name, "n"),
    ROW(model_modes, "rara"),
    ROW(model_mac, "rrura"),
    ROW(model_sensitivity, "rara"),
    ROW(model_response, "rura"),
    ROW(model_sweep, "rura"),
    ROW(mechanism_new, "rurra"),
    ROW(mechanism_delete, "a"),
    ROW(mechanism_evaluate, "rra"),
    ROW(mechanism_value, "nn"),
    ROW(mechanism_vibration_modes, "n"),
    ROW(mechanism_rigid_body_modes, "a"),
    ROW(mechanism_unstable_modes, "a"),
    ROW(mechanism_undecided_modes, "a"),
    ROW(mechanism_hz, "n"),
    ROW(mechanism_error_hz, "n"),
    ROW(mechanism_multiplicity, "n"),
    ROW(mechanism_channels, "n"),
    ROW(mechanism_channel, "n"),
    ROW(mechanism_shape, "rra"),
    ROW(mechanism_mac, "rrra"),
    ROW(mechanism_sensitivities, "rra"),
    ROW(mechanism_response, "rrrrraa"),
    ROW(mechanism_response_slopes, "rrrra"),
    ROW(mechanism_vibration, "rarra"),
    ROW(mechanism_motion, "rrrraa"),
    ROW(vibration_read, "rara"),
    ROW(vibration_delete, "a"),
    ROW(vibration_rms, "n"),
    ROW(study_read, "rara"),
    ROW(study_delete, "a"),
    ROW(study_title, "n"),
    ROW(study_model, "n"),
    ROW(study_variable_count, "n"),
    ROW(study_variable_name, "n"),
    ROW(study_variable_original, "n"),
    ROW(study_variable_lower, "n"),
    ROW(study_variable_upper, "n"),
    ROW(stop_request_at, "a"),
    ROW(study_solve, "rara"),
    ROW(result_delete, "a"),
    ROW(result_outcome, "n"),
    ROW(result_status_name, ""),
    ROW(result_summary, "n"),
    ROW(result_recommendations, "n"),
    ROW(result_feasible, "n"),
    ROW(result_value, "nn"),
    ROW(result_hz, "nn"),
    ROW(result_reasons, "n"),
    ROW(result_reason, "n"),
    ROW(result_json, "rra"),
    ROW(result_read, "rara"),
    ROW(result_html, "rra"),
    ROW(result_page, "rara"),
    ROW(result_model, "rrara"),
    ROW(string_delete, "a"),
    ROW(solve_json, "raara"),
    ROW(udwadia_kalaba, "rrrrra"),
    ROW(udwadia_phohomsiri, "rrrrra"),
};

static void public__null_is_refused_allowed_or_nothing(mt_test *t)
{
    const mt_file_text file = {"wrong.json", "{}"};
    mt_read_options opt = {.size = sizeof opt, .files = &file, .n_files = 1};
    REQUIRE(t, mt_diagnostics_new(&list, &said) == MT_OK);
    REQUIRE(t, mt_diagnostics_new(&wrong, &said) == MT_OK);
    opt.diagnostics = wrong;
    REQUIRE(t, mt_model_read("wrong.json", &opt, &model, &said) == MT_E_INPUT);
    REQUIRE(t, mt_model_read(MODEL, NULL, &model, &said) == MT_OK);
    REQUIRE(t, mt_study_read(STUDY, NULL, &study, &said) == MT_OK);
    const mt_file_text along_x = {
        "x.json", "{\"format\": \"modetune-profile/1\", \"axis\": \"x\", \"tones\": "
                  "[{\"frequency_hz\": [0.1, 0.2], \"acceleration_g\": 1}]}"};
    opt = (mt_read_options){.size = sizeof opt, .files = &along_x, .n_files = 1};
    REQUIRE(t, mt_vibration_read("x.json", &opt, &profile, &said) == MT_OK);
    const char *const names[] = {parameter};
    REQUIRE(t, mt_mechanism_new(model, configuration, 1, names, &mechanism, &said) == MT_OK);
    REQUIRE(t, mt_study_solve(study, NULL, &result, &said) == MT_OK);
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s, everything given", rows[i].name);
        if (!CHECK_INT(t, rows[i].call(-1), MT_OK)) {
            (void)fprintf(stderr, "  %s\n", said.text);
        }
        for (int k = 0; rows[i].nulls[k] != '\0'; k++) {
            const char letter = rows[i].nulls[k];
            mt_test_row(t, "%s, pointer %d NULL", rows[i].name, k);
            said = (mt_err){MT_OK, ""};
            CHECK_INT(t, rows[i].call(k), letter == 'a' ? MT_OK : MT_E_USAGE);
            CHECK(t, letter != 'r' || (said.code == MT_E_USAGE &&
                                       strstr(said.text, rows[i].name) == said.text));
        }
    }
    mt_result_delete(result);
    mt_study_delete(study);
    mt_vibration_delete(profile);
    mt_mechanism_delete(mechanism);
    mt_model_delete(model);
    mt_diagnostics_delete(list);
    mt_diagnostics_delete(wrong);
}

/* Comments of a header as blanks. */
static void blank_comments(char *s)
{
    for (char *at = strstr(s, "/*"); at != NULL; at = strstr(at, "/*")) {
        const char *const end = strstr(at, "*/");
        const size_t n = end == NULL ? strlen(at) : (size_t)(end - at) + 2;
        memset(at, ' ', n);
    }
}

/* The declaration from `at` to its semicolon: in the table, with as many pointers? */
static void check_declaration(mt_test *t, const char *at)
{
    const size_t length = strcspn(at, ";");
    const char *const open = memchr(at, '(', length);
    char name[64] = "";
    int pointers = 0;
    if (!CHECK(t, open != NULL)) {
        return;
    }
    const char *begin = open;
    while (begin > at && (begin[-1] == '_' || (begin[-1] >= 'a' && begin[-1] <= 'z'))) {
        begin--;
    }
    (void)snprintf(name, sizeof name, "%.*s", (int)(open - begin), begin);
    bool counted = false; /* this argument: a pointer may point to another one */
    for (const char *p = open; *p != ')' && p < at + length; p++) {
        pointers += *p == '*' && !counted ? 1 : 0;
        counted = *p != ',' && (counted || *p == '*');
    }
    mt_test_row(t, "%s in the headers, with %d pointers", name, pointers);
    int found = -1;
    for (int i = 0; i < MT_COUNT(rows); i++) {
        found = strcmp(rows[i].name, name) == 0 ? (int)strlen(rows[i].nulls) : found;
    }
    CHECK_INT(t, found, pointers);
}

static void public__table_has_every_function(mt_test *t)
{
    static char text[1 << 16];
    const char folder[] = MT_TEST_SOURCE_DIR "/include/modetune";
    int functions = 0;
    DIR *const d = opendir(folder);
    REQUIRE(t, d != NULL);
    for (const struct dirent *e = readdir(d); e != NULL; e = readdir(d)) {
        char path[512];
        (void)snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
        FILE *const file = e->d_name[0] == '.' ? NULL : fopen(path, "r");
        if (file == NULL || strcmp(e->d_name, "export.h") == 0) {
            if (file != NULL) {
                (void)fclose(file);
            }
            continue;
        }
        text[fread(text, 1, sizeof text - 1, file)] = '\0';
        (void)fclose(file);
        blank_comments(text);
        for (const char *at = strstr(text, "MT_API "); at != NULL;
             at = strstr(at + 1, "MT_API ")) {
            check_declaration(t, at);
            functions++;
        }
    }
    (void)closedir(d);
    mt_test_row(t, "functions of the headers");
    CHECK_INT(t, functions, MT_COUNT(rows));
}

static void public__wrong_numbers_are_refused(mt_test *t)
{
    mt_model *m = NULL;
    mt_study *s = NULL;
    mt_result *r = NULL;
    const double hint[1] = {HUGE_VAL};
    REQUIRE(t, mt_model_read(MODEL, NULL, &m, NULL) == MT_OK);
    CHECK(t, mt_model_parameter_name(m, -1) == NULL);
    CHECK(t, mt_model_parameter_name(m, mt_model_parameter_count(m)) == NULL);
    CHECK(t, mt_model_parameter_unit(m, -1) == NULL);
    CHECK_INT(t, mt_model_parameter_follows(m, mt_model_parameter_count(m)), 0);
    CHECK(t, mt_model_configuration_name(m, -1) == NULL);
    CHECK(t, mt_model_configuration_name(m, mt_model_configuration_count(m)) == NULL);
    mt_model_delete(m);

    mt_solve_options opt = {.size = sizeof opt};
    CHECK_INT(t, mt_study_read(STUDY, NULL, &s, NULL), MT_OK);
    for (int i = -1; i <= 1; i += 2) {
        CHECK(t, mt_study_variable_name(s, i) == NULL);
        CHECK(t, isnan(mt_study_variable_original(s, i)));
        CHECK(t, isnan(mt_study_variable_lower(s, i)) && isnan(mt_study_variable_upper(s, i)));
    }
    opt.hint = hint;
    CHECK_INT(t, mt_study_solve(s, &opt, &r, NULL), MT_E_USAGE);
    opt.hint = NULL;
    opt.threads = -3;
    CHECK_INT(t, mt_study_solve(s, &opt, &r, NULL), MT_OK);
    const int past = mt_result_recommendations(r) + 1;
    for (int rank = -1; rank <= past; rank += past + 1) {
        mt_test_row(t, "rank %d", rank);
        CHECK_INT(t, mt_result_feasible(r, rank), 0);
        CHECK_INT(t, mt_result_reasons(r, rank), 0);
        CHECK(t, mt_result_reason(r, rank, 0) == NULL);
        CHECK(t, isnan(mt_result_value(r, rank, "L")));
        CHECK(t, isnan(mt_result_hz(r, rank, configuration, 1)));
    }
    CHECK(t, mt_result_reason(r, 1, -1) == NULL);
    CHECK(t, mt_result_reason(r, 1, mt_result_reasons(r, 1)) == NULL);
    CHECK(t, isnan(mt_result_hz(r, 1, "", 0)));
    mt_result_delete(r);
    mt_study_delete(s);

    double xdd[1];
    CHECK_INT(t, mt_udwadia_kalaba(0, 0, one, one, NULL, NULL, xdd, NULL), MT_E_USAGE);
    CHECK_INT(t, mt_udwadia_kalaba(1, -1, one, one, NULL, NULL, xdd, NULL), MT_E_USAGE);
    CHECK_INT(t, mt_udwadia_kalaba(1, 0, one, one, NULL, NULL, xdd, NULL), MT_OK);
    CHECK_INT(t, mt_udwadia_phohomsiri(0, 1, one, one, one, one, xdd, NULL), MT_E_USAGE);
    CHECK_INT(t, mt_udwadia_phohomsiri(1, 0, one, one, NULL, NULL, xdd, NULL), MT_OK);
}

MT_TEST_MAIN(MT_TEST(public__null_is_refused_allowed_or_nothing),
             MT_TEST(public__table_has_every_function),
             MT_TEST(public__wrong_numbers_are_refused))
