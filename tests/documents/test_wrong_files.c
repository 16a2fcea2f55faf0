/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Every NAME.json of tests/documents/wrong is wrong, and NAME.expected holds the exact text
 * that says so: all problems, with the file's base name. Files study_* are studies, result_*
 * results, aircraft_* catalogues of aircraft, profile_* profiles, all others models. The files
 * in wrong/parts are what studies refer to. MT_WRONG_PRINT=1 prints what is said, for whoever
 * writes the expected text of a new file: read it, do not just copy it.
 */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/arena.h"
#include "environment/aircraft.h"
#include "environment/vibration.h"
#include "io/file.h"
#include "model/read.h"
#include "mt_refusals.h"
#include "result/read.h"
#include "study/read.h"

enum { MAX_FILES = 500, LEAST_FILES = 30, LEAST_STUDIES = 20 };

static bool starts_with(const char *s, const char *prefix)
{
    return strncmp(s, prefix, strlen(prefix)) == 0;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Names of the .json files of the current folder, sorted; -1 where it cannot be read. */
static int list_files(mt_arena *mem, char **names)
{
    DIR *const folder = opendir(".");
    int n = 0;
    if (folder == NULL) {
        return -1;
    }
    for (const struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
        const size_t length = strlen(entry->d_name);
        if (length > 5 && strcmp(entry->d_name + length - 5, ".json") == 0 && n < MAX_FILES) {
            names[n++] = mt_arena_strdup(mem, entry->d_name);
        }
    }
    (void)closedir(folder);
    qsort(names, (size_t)n, sizeof *names, by_name);
    return n;
}

/* What reading the file says; err where there are no diagnostics (the file itself cannot be
 * read). */
static mt_status read_wrong(const char *name, mt_diagnostics *said)
{
    mt_err err = {.text = ""};
    mt_model *model = NULL;
    mt_study *study = NULL;
    mt_result *result = NULL;
    mt_vibration *profile = NULL;
    mt_status rc = MT_OK;
    if (starts_with(name, "study_")) {
        rc = mt_study_load(name, NULL, &study, said, &err);
    } else if (starts_with(name, "aircraft_")) {
        mt_aircraft_list list = {0};
        mt_arena mem = {0};
        rc = mt_arena_init(&mem, 0, &err);
        rc = rc == MT_OK ? mt_aircraft_load(name, NULL, &mem, &list, said, &err) : rc;
        mt_arena_free(&mem);
    } else if (starts_with(name, "profile_")) {
        rc = mt_vibration_load(name, NULL, &profile, said, &err);
    } else if (starts_with(name, "result_")) {
        rc = mt_result_load(name, NULL, &result, said, &err);
    } else {
        rc = mt_model_load(name, NULL, &model, said, &err);
    }
    if (rc != MT_OK && rc != MT_E_MEMORY && said->count == 0) {
        mt_text_addf(&said->lines, "%s\n", err.text);
    }
    mt_model_delete(model);
    mt_study_delete(study);
    mt_result_delete(result);
    mt_vibration_delete(profile);
    return rc;
}

static void check_file(mt_test *t, const char *name)
{
    enum { LIMIT = 1 << 20 };
    char path[256];
    mt_diagnostics said = {.count = 0};
    mt_file expected = {0};
    mt_test_row(t, "%s", name);
    CHECK_INT(t, read_wrong(name, &said), MT_E_INPUT);
    if (getenv("MT_WRONG_PRINT") != NULL) {
        printf("== %s\n%s", name, mt_diagnostics_text(&said));
    }
    (void)snprintf(path, sizeof path, "%.*sexpected", (int)strlen(name) - 4, name);
    if (CHECK_INT(t, mt_file_read(path, NULL, LIMIT, &expected, NULL), MT_OK)) {
        CHECK_STR(t, said.lines.s, expected.bytes);
    }
    mt_file_free(&expected);
    mt_diagnostics_free(&said);
}

static void wrong_files__say_exactly_what_is_expected(mt_test *t)
{
    mt_arena mem = {0};
    char *names[MAX_FILES];
    int studies = 0;
    REQUIRE(t, chdir(MT_TEST_SOURCE_DIR "/tests/documents/wrong") == 0);
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    const int n = list_files(&mem, names);
    for (int i = 0; i < n; i++) {
        studies += starts_with(names[i], "study_") ? 1 : 0;
        check_file(t, names[i]);
    }
    mt_test_row(t, "all");
    CHECK(t, n >= LEAST_FILES);
    CHECK(t, studies >= LEAST_STUDIES);
    mt_arena_free(&mem);
}

/* Diagnostics are made under the same promise as everything else: no leak, no crash, whichever
 * allocation fails. */
static mt_status read_once(mt_test *t, const void *name)
{
    mt_diagnostics said = {.count = 0};
    const mt_status rc = read_wrong(name, &said);
    (void)t;
    mt_diagnostics_free(&said);
    return rc;
}

static void wrong_files__every_failing_allocation_is_survived(mt_test *t)
{
    static const char *const names[] = {"study_unknown_names.json",
                                        "study_model_wrong.json",
                                        "profile_members.json",
                                        "profile_tones.json",
                                        "drive.json",
                                        "circle_in_configuration.json",
                                        "joint_members.json"};
    REQUIRE(t, chdir(MT_TEST_SOURCE_DIR "/tests/documents/wrong") == 0);
    for (int i = 0; i < MT_COUNT(names); i++) {
        mt_refuse_each(t, names[i], read_once, names[i], MT_E_INPUT);
    }
}

MT_TEST_MAIN(MT_TEST(wrong_files__say_exactly_what_is_expected),
             MT_TEST(wrong_files__every_failing_allocation_is_survived))
