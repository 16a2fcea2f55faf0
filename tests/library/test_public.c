/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Every function of include/, with NULL for each of its pointers in turn: what the convention
 * in modetune/status.h says is what happens. The headers are read, so that a function, or an
 * argument, that is not in the table here is found.
 */
#include "modetune/dynamics.h"
#include "modetune/model.h"
#include "modetune/modes.h"
#include "modetune/read.h"
#include "modetune/study.h"
#include "modetune/version.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/base.h"
#include "mt_test.h"

#define MODEL MT_TEST_SOURCE_DIR "/tests/models/pendulum.json"
#define STUDY MT_TEST_SOURCE_DIR "/tests/install/pendulum_study.json"

/* What the calls need, made once. */
static mt_model *model;
static mt_study *study;
static mt_result *result;
static const char configuration[] = "hanging";
static const char parameter[] = "L";
static mt_diagnostics *list;
static mt_diagnostics *wrong; /* of a file that is */
static mt_err said;

/* Argument number k of a call where pointer number `null` is to be NULL. */
#define ARG(k, pointer) (null == (k) ? NULL : (pointer))
/* An answer, or nothing, as a status: what is not there is MT_E_USAGE. */
#define ANSWER(is) ((is) ? MT_OK : MT_E_USAGE)
/* The functions that take a format, as if they took any text: the compiler refuses NULL
 * there. */
static mt_status (*volatile any_fail)(mt_err *err, mt_status code, const char *fmt,
                                      ...) = mt_fail;
static mt_status (*volatile any_err_in)(mt_err *err, mt_status rc, const char *fmt,
                                        ...) = mt_err_in;

static mt_status call_status_text(int null)
{
    (void)null;
    return ANSWER(strcmp(mt_status_text(MT_E_MEMORY), "out of memory") == 0 &&
                  mt_status_text((mt_status)-1) != NULL);
}

static mt_status call_status_name(int null)
{
    (void)null;
    return ANSWER(strcmp(mt_status_name(MT_OK), "MT_OK") == 0 &&
                  mt_status_name(MT_STATUS_COUNT) != NULL);
}

static mt_status call_fail(int null)
{
    return ANSWER(any_fail(ARG(0, &said), MT_E_INPUT, ARG(1, "text")) == MT_E_INPUT);
}

static mt_status call_err_in(int null)
{
    said.text[0] = '\0';
    return ANSWER(any_err_in(ARG(0, &said), MT_E_INPUT, ARG(1, "text")) == MT_E_INPUT);
}

static mt_status call_version(int null)
{
    (void)null;
    return ANSWER(strcmp(mt_version(), MT_VERSION_STRING) == 0);
}

static mt_status call_diagnostics_new(int null)
{
    mt_diagnostics *out = null == 0 ? list : NULL;
    const mt_status rc = mt_diagnostics_new(ARG(0, &out), ARG(1, &said));
    mt_diagnostics_delete(null == 0 ? NULL : out);
    return rc;
}

static mt_status call_diagnostics_delete(int null)
{
    mt_diagnostics *own = NULL;
    const mt_status rc = mt_diagnostics_new(&own, &said);
    mt_diagnostics_delete(ARG(0, own));
    if (null == 0) {
        mt_diagnostics_delete(own);
    }
    return rc;
}

static mt_status call_diagnostics_count(int null)
{
    return ANSWER(mt_diagnostics_count(ARG(0, wrong)) > 0);
}

static mt_status call_diagnostics_left_out(int null)
{
    return ANSWER(mt_diagnostics_left_out(ARG(0, wrong)) == 0);
}

static mt_status call_diagnostics_severity(int null)
{
    return ANSWER((int)mt_diagnostics_severity(ARG(0, wrong), 0) != MT_SEVERITY_COUNT);
}

static mt_status call_diagnostics_file(int null)
{
    return ANSWER(mt_diagnostics_file(ARG(0, wrong), 0) != NULL);
}

static mt_status call_diagnostics_line(int null)
{
    return ANSWER(mt_diagnostics_line(ARG(0, wrong), 0) > 0);
}

static mt_status call_diagnostics_column(int null)
{
    return ANSWER(mt_diagnostics_column(ARG(0, wrong), 0) > 0);
}

static mt_status call_diagnostics_pointer(int null)
{
    return ANSWER(mt_diagnostics_pointer(ARG(0, wrong), 0) != NULL);
}

static mt_status call_diagnostics_message(int null)
{
    return ANSWER(mt_diagnostics_message(ARG(0, wrong), 0) != NULL);
}

static mt_status call_diagnostics_text(int null)
{
    return ANSWER(mt_diagnostics_text(ARG(0, wrong)) != NULL);
}

static mt_status call_model_read(int null)
{
    mt_model *out = null == 0 ? model : NULL; /* must become NULL */
    const mt_read_options opt = {.size = sizeof opt, .diagnostics = list};
    const mt_status rc =
        mt_model_read(ARG(0, MODEL), ARG(1, &opt), ARG(2, &out), ARG(3, &said));
    const bool owned = out != NULL;
    mt_model_delete(out);
    return rc == MT_OK || !owned ? rc : MT_E_INTERNAL;
}

static mt_status call_model_delete(int null)
{
    mt_model *own = NULL;
    const mt_status rc = mt_model_read(MODEL, NULL, &own, &said);
    mt_model_delete(ARG(0, own));
    if (null == 0) {
        mt_model_delete(own);
    }
    return rc;
}

static mt_status call_model_title(int null)
{
    return ANSWER(mt_model_title(ARG(0, model)) != NULL);
}

static mt_status call_model_dimension(int null)
{
    return ANSWER(mt_model_dimension(ARG(0, model)) == 2);
}

static mt_status call_model_parameter_count(int null)
{
    return ANSWER(mt_model_parameter_count(ARG(0, model)) > 0);
}

static mt_status call_model_parameter_name(int null)
{
    return ANSWER(mt_model_parameter_name(ARG(0, model), 0) != NULL);
}

static mt_status call_model_configuration_count(int null)
{
    return ANSWER(mt_model_configuration_count(ARG(0, model)) > 0);
}

static mt_status call_model_configuration_name(int null)
{
    return ANSWER(mt_model_configuration_name(ARG(0, model), 0) != NULL);
}

static mt_status call_model_frequencies(int null)
{
    const mt_setting setting = {parameter, 1.0};
    double hz[4];
    mt_mode_count count;
    return mt_model_frequencies(ARG(0, model), ARG(1, configuration), 1, ARG(2, &setting), 4,
                                ARG(3, hz), ARG(4, &count), ARG(5, &said));
}

static mt_status call_study_read(int null)
{
    mt_study *out = null == 0 ? study : NULL;
    const mt_read_options opt = {.size = sizeof opt, .diagnostics = list};
    const mt_status rc =
        mt_study_read(ARG(0, STUDY), ARG(1, &opt), ARG(2, &out), ARG(3, &said));
    const bool owned = out != NULL;
    mt_study_delete(out);
    return rc == MT_OK || !owned ? rc : MT_E_INTERNAL;
}

static mt_status call_study_delete(int null)
{
    mt_study *own = NULL;
    const mt_status rc = mt_study_read(STUDY, NULL, &own, &said);
    mt_study_delete(ARG(0, own));
    if (null == 0) {
        mt_study_delete(own);
    }
    return rc;
}

static mt_status call_solve_options_default(int null)
{
    (void)null;
    const mt_solve_options opt = mt_solve_options_default();
    return ANSWER(opt.threads == 1 && opt.hint == NULL && opt.stop == NULL &&
                  opt.progress == NULL);
}

static mt_status call_study_solve(int null)
{
    mt_result *out = null == 0 ? result : NULL;
    const mt_solve_options opt = mt_solve_options_default();
    const mt_status rc =
        mt_study_solve(ARG(0, study), ARG(1, &opt), ARG(2, &out), ARG(3, &said));
    const bool owned = out != NULL;
    mt_result_delete(out);
    return rc == MT_OK || !owned ? rc : MT_E_INTERNAL;
}

static mt_status call_result_delete(int null)
{
    mt_result *own = NULL;
    const mt_status rc = mt_study_solve(study, NULL, &own, &said);
    mt_result_delete(ARG(0, own));
    if (null == 0) {
        mt_result_delete(own);
    }
    return rc;
}

static mt_status call_result_outcome(int null)
{
    const mt_result_status status = mt_result_outcome(ARG(0, result));
    return ANSWER(status != MT_RESULT_STATUS_COUNT);
}

static mt_status call_result_status_name(int null)
{
    (void)null;
    return ANSWER(strcmp(mt_result_status_name(MT_RESULT_SOLVED), "solved") == 0 &&
                  mt_result_status_name(MT_RESULT_STATUS_COUNT) != NULL);
}

static mt_status call_result_summary(int null)
{
    return ANSWER(mt_result_summary(ARG(0, result)) != NULL);
}

static mt_status call_result_recommendations(int null)
{
    return ANSWER(mt_result_recommendations(ARG(0, result)) > 0);
}

static mt_status call_result_feasible(int null)
{
    return ANSWER(mt_result_feasible(ARG(0, result), 1) != 0);
}

static mt_status call_result_value(int null)
{
    return ANSWER(isfinite(mt_result_value(ARG(0, result), 1, ARG(1, "L"))));
}

static mt_status call_result_hz(int null)
{
    return ANSWER(isfinite(mt_result_hz(ARG(0, result), 1, ARG(1, configuration), 1)));
}

static mt_status call_result_reasons(int null)
{
    return ANSWER(mt_result_reasons(ARG(0, result), 1) > 0);
}

static mt_status call_result_reason(int null)
{
    return ANSWER(mt_result_reason(ARG(0, result), 1, 0) != NULL);
}

static mt_status call_result_json(int null)
{
    char *out = NULL;
    const mt_status rc = mt_result_json(ARG(0, result), ARG(1, &out), ARG(2, &said));
    const bool owned = out != NULL;
    free(out);
    return null < 0 && !owned ? MT_E_INTERNAL : rc;
}

static const double one[1] = {1.0};

static mt_status call_udwadia_kalaba(int null)
{
    double xdd[1];
    return mt_udwadia_kalaba(1, 1, ARG(0, one), ARG(1, one), ARG(2, one), ARG(3, one),
                             ARG(4, xdd), ARG(5, &said));
}

static mt_status call_udwadia_phohomsiri(int null)
{
    double xdd[1];
    return mt_udwadia_phohomsiri(1, 1, ARG(0, one), ARG(1, one), ARG(2, one), ARG(3, one),
                                 ARG(4, xdd), ARG(5, &said));
}

/* One letter for each pointer among the arguments: r refused, a allowed, n answered with
 * nothing. */
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
    ROW(model_configuration_count, "n"),
    ROW(model_configuration_name, "n"),
    ROW(model_frequencies, "rarrra"),
    ROW(study_read, "rara"),
    ROW(study_delete, "a"),
    ROW(solve_options_default, ""),
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
    for (const char *p = open; *p != ')' && p < at + length; p++) {
        pointers += *p == '*' && (p[1] != '*') ? 1 : 0;
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
    mt_mode_count count;
    double hz[1];
    const mt_setting unnamed[2] = {{"L", 1.0}, {NULL, 1.0}};
    const mt_setting not_finite = {"L", nan("")};
    const double hint[1] = {HUGE_VAL};
    REQUIRE(t, mt_model_read(MODEL, NULL, &m, NULL) == MT_OK);
    CHECK_INT(t, mt_model_frequencies(m, NULL, -1, NULL, 1, hz, &count, NULL), MT_E_USAGE);
    CHECK_INT(t, mt_model_frequencies(m, NULL, 0, NULL, -1, hz, &count, NULL), MT_E_USAGE);
    CHECK_INT(t, mt_model_frequencies(m, NULL, 2, unnamed, 1, hz, &count, &said), MT_E_USAGE);
    CHECK_STR(t, said.text, "mt_model_frequencies: settings[1] has no name");
    CHECK_INT(t, mt_model_frequencies(m, NULL, 1, &not_finite, 1, hz, &count, NULL),
              MT_E_USAGE);
    CHECK_INT(t, mt_model_frequencies(m, "", 0, NULL, 1, hz, &count, NULL), MT_E_USAGE);
    CHECK_INT(t, mt_model_frequencies(m, NULL, 0, NULL, 0, NULL, &count, NULL), MT_OK);
    CHECK(t, mt_model_parameter_name(m, -1) == NULL);
    CHECK(t, mt_model_parameter_name(m, mt_model_parameter_count(m)) == NULL);
    CHECK(t, mt_model_configuration_name(m, -1) == NULL);
    CHECK(t, mt_model_configuration_name(m, mt_model_configuration_count(m)) == NULL);
    mt_model_delete(m);

    mt_solve_options opt = mt_solve_options_default();
    CHECK_INT(t, mt_study_read(STUDY, NULL, &s, NULL), MT_OK);
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
