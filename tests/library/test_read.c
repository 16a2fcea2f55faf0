/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that are given by their texts, options that grow, and every diagnostic. */
#include "modetune/mechanism.h"
#include "modetune/model.h"
#include "modetune/study.h"

#include <math.h>
#include <string.h>

#include "base/base.h"
#include "io/file.h"
#include "mt_test.h"

/* A pendulum: one parameter, one configuration. */
#define PENDULUM                                                                       \
    "{\"format\": \"modetune-model/1\", \"dimension\": 2,\n"                           \
    " \"gravity_m_per_s2\": [0, -9.81], \"parameters\": {\"L\": 1},\n"                 \
    " \"bodies\": [{\"name\": \"rod\", \"mass_kg\": 1, \"inertia_kg_m2\": \"L^2/12\"," \
    " \"centre\": [0, \"-L/2\"]}],\n"                                                  \
    " \"joints\": [{\"name\": \"pin\", \"type\": \"revolute\","                        \
    " \"bodies\": [\"ground\", \"rod\"], \"at\": [0, 0]}]}\n"
#define QUESTION                                                                \
    "{\"format\": \"modetune-study/1\", \"model\": \"../models/p.json\",\n"     \
    " \"variables\": [{\"parameter\": \"L\", \"lower\": 0.5, \"upper\": 2}],\n" \
    " \"goals\": [{\"type\": \"frequency\", \"configuration\": \"default\","    \
    " \"mode\": 1, \"at_least_hz\": 0.6}]}\n"

static const mt_file_text both[2] = {
    {"box/studies/q.json", QUESTION},
    {"box/models/p.json", PENDULUM},
};

static void read__a_study_and_its_model_come_from_memory(mt_test *t)
{
    const mt_read_options opt = {
        .size = sizeof opt, .files = both, .n_files = 2, .files_only = 1};
    mt_study *study = NULL;
    mt_err err = {MT_OK, ""};
    CHECK_INT(t, mt_study_read("box/studies/q.json", &opt, &study, &err), MT_OK);
    CHECK_STR(t, err.text, "");
    mt_study_delete(study);
    /* what is named is found by where it leads, not by how it is spelled */
    CHECK_INT(t, mt_study_read("./box//models/../studies/q.json", &opt, &study, &err), MT_OK);
    mt_study_delete(study);
}

static void read__what_is_not_given_is_not_there(mt_test *t)
{
    mt_read_options opt = {.size = sizeof opt, .files = both, .n_files = 1, .files_only = 1};
    mt_study *study = NULL;
    mt_model *model = NULL;
    mt_err err = {MT_OK, ""};
    REQUIRE(t, mt_diagnostics_new(&opt.diagnostics, NULL) == MT_OK);
    CHECK_INT(t, mt_study_read("box/studies/q.json", &opt, &study, &err), MT_E_INPUT);
    CHECK_INT(t, mt_diagnostics_count(opt.diagnostics), 1);
    CHECK_STR(t, mt_diagnostics_pointer(opt.diagnostics, 0), "/model");
    CHECK_INT(t, mt_diagnostics_line(opt.diagnostics, 0), 1);
    CHECK_STR(t, mt_diagnostics_message(opt.diagnostics, 0),
              "box/studies/../models/p.json: is not among the files that are given");
    CHECK_INT(t, mt_study_read("q.json", &opt, &study, &err), MT_E_SYSTEM);
    CHECK_INT(t, mt_diagnostics_count(opt.diagnostics), 0); /* emptied */
    CHECK_STR(t, mt_diagnostics_text(opt.diagnostics), "");
    /* a file of the disk, unless only what is given counts */
    const char shipped[] = MT_TEST_SOURCE_DIR "/tests/models/pendulum.json";
    CHECK_INT(t, mt_model_read(shipped, &opt, &model, &err), MT_E_SYSTEM);
    opt.files_only = 0;
    CHECK_INT(t, mt_model_read(shipped, &opt, &model, &err), MT_OK);
    mt_model_delete(model);
    mt_diagnostics_delete(opt.diagnostics);
}

static void read__paths_are_compared_by_their_words(mt_test *t)
{
    static const struct {
        const char *given;
        const char *wanted;
        bool same;
    } rows[] = {
        {"a", "a", true},
        {"a", "./a", true},
        {"a", "b/a", false},
        {"a/b", "a//b/.", true},
        {"a/b", "a/c/d/../../b", true},
        {"../a", "b/../../a", true},
        {"../a", "a", false},
        {"../../a", "../a", false},
        {"/a", "/../b/../a", true},
        {"/a", "a", false},
        {"/", "/a/..", true},
        {".a", "a", false},
        {"a/..", ".", true},
        {"..a/b", "..a/b", true},
        {"b", "..a/../b", true},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const mt_file_text given = {rows[i].given, "{}"};
        const mt_files files = {.given = &given, .n = 1, .only = true};
        mt_test_row(t, "\"%s\" and \"%s\"", rows[i].given, rows[i].wanted);
        CHECK_INT(t, mt_files_lack(&files, rows[i].wanted), !rows[i].same);
    }
}

static void read__every_problem_is_listed_with_its_place(mt_test *t)
{
    static const mt_file_text file = {"m.json",
                                      "{\"format\": \"modetune-model/1\", \"dimension\": 4,\n"
                                      " \"parameters\": {\"a/b\": 1},\n"
                                      " \"bodies\": [{\"nme\": \"x\"}] }"};
    mt_read_options opt = {.size = sizeof opt, .files = &file, .n_files = 1};
    mt_model *model = NULL;
    mt_err err = {MT_OK, ""};
    REQUIRE(t, mt_diagnostics_new(&opt.diagnostics, NULL) == MT_OK);
    CHECK_INT(t, mt_model_read("m.json", &opt, &model, &err), MT_E_INPUT);
    const mt_diagnostics *const d = opt.diagnostics;
    static const struct {
        const char *pointer;
        int line;
        int column;
        const char *message;
    } rows[] = {
        {"/dimension", 1, 45, "must be 2 or 3"},
        {"/parameters", 2, 17,
         "\"a/b\" is not a name: a letter or _, then letters, digits and _"},
        {"/bodies/0", 3, 13, "member \"name\" is missing"},
        {"/bodies/0", 3, 14, "unknown member \"nme\"; did you mean \"name\"?"},
    };
    CHECK_INT(t, mt_diagnostics_left_out(d), 0);
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].message);
        int found = -1;
        for (int k = 0; k < mt_diagnostics_count(d); k++) {
            found = strcmp(mt_diagnostics_message(d, k), rows[i].message) == 0 ? k : found;
        }
        if (CHECK(t, found >= 0)) {
            CHECK_INT(t, mt_diagnostics_severity(d, found), MT_SEVERITY_ERROR);
            CHECK_STR(t, mt_diagnostics_file(d, found), "m.json");
            CHECK_STR(t, mt_diagnostics_pointer(d, found), rows[i].pointer);
            CHECK_INT(t, mt_diagnostics_line(d, found), rows[i].line);
            CHECK_INT(t, mt_diagnostics_column(d, found), rows[i].column);
        }
    }
    mt_diagnostics_delete(opt.diagnostics);
}

/* A caller of tomorrow, whose options have one member more. */
typedef struct grown_options {
    mt_read_options known;
    const char *more;
} grown_options;

static void read__options_may_grow(mt_test *t)
{
    mt_model *model = NULL;
    mt_err err = {MT_OK, ""};
    grown_options grown = {.known = {.size = sizeof grown, .files = both, .n_files = 2}};
    CHECK_INT(t, mt_model_read("box/models/p.json", &grown.known, &model, &err), MT_OK);
    mt_model_delete(model);
    grown.more = "please";
    CHECK_INT(t, mt_model_read("box/models/p.json", &grown.known, &model, &err), MT_E_USAGE);
    CHECK_STR(t, err.text,
              "mt_model_read: an option is set that this version of the library does not know");
    /* a caller of yesterday, who knew no more than the root: files are not looked at */
    grown.known.size = offsetof(mt_read_options, files);
    CHECK_INT(t, mt_model_read("box/models/p.json", &grown.known, &model, &err), MT_E_SYSTEM);
    grown.known.size = 0;
    CHECK_INT(t, mt_model_read("box/models/p.json", &grown.known, &model, &err), MT_E_USAGE);
    CHECK_STR(t, err.text, "mt_model_read: the size of the options is not set");
}

static double hz_of(const mt_model *model)
{
    mt_mechanism *mechanism = NULL;
    (void)mt_mechanism_new(model, NULL, 0, NULL, &mechanism, NULL);
    const double hz = mt_mechanism_hz(mechanism, 1);
    mt_mechanism_delete(mechanism);
    return hz;
}

static void read__values_are_set_instead_of_the_files(mt_test *t)
{
    static const char *const sets[] = {"w=2*w"};
    static const char *const odd[] = {"W=1"};
    static const int seed = 7;
    const mt_file_text files[] = {
        {"box/studies/q.json", QUESTION},
        {"box/models/p.json",
         "{\"format\": \"modetune-model/1\", \"dimension\": 2,\n"
         " \"gravity_m_per_s2\": [0, \"-g\"],\n"
         " \"parameters\": {\"L\": 1, \"w\": {\"value\": 9.81, \"unit\": \"m/s^2\"},"
         " \"g\": \"w\"},\n"
         " \"bodies\": [{\"name\": \"bob\", \"mass_kg\": 1, \"inertia_kg_m2\": 0,"
         " \"centre\": [0, \"-L\"]}],\n"
         " \"joints\": [{\"name\": \"pin\", \"type\": \"revolute\","
         " \"bodies\": [\"ground\", \"bob\"], \"at\": [0, 0]}]}\n"}};
    mt_read_options opt = {.size = sizeof opt, .files = files, .n_files = 2, .files_only = 1};
    mt_model *model = NULL;
    mt_study *study = NULL;
    mt_result *result = NULL;
    char *text = NULL;
    mt_err err = {MT_OK, ""};
    CHECK_INT(t, mt_model_read("box/models/p.json", &opt, &model, &err), MT_OK);
    CHECK_STR(t, err.text, "");
    const double hz = hz_of(model);
    CHECK_STR(t, mt_model_parameter_unit(model, 1), "m/s^2");
    CHECK(t, mt_model_parameter_unit(model, 2) == NULL);
    CHECK_INT(t, mt_model_parameter_follows(model, 1), 0);
    CHECK_INT(t, mt_model_parameter_follows(model, 2), 1);
    mt_model_delete(model);
    opt.sets = sets;
    opt.n_sets = 1;
    opt.seed = &seed;
    CHECK_INT(t, mt_model_read("box/models/p.json", &opt, &model, &err), MT_OK);
    CHECK_NEAR(t, hz_of(model), hz * sqrt(2.0), 1e-12); /* (1/2 pi) sqrt(g/L) */
    mt_model_delete(model);
    /* a study says what it was asked for */
    REQUIRE(t, mt_study_read("box/studies/q.json", &opt, &study, &err) == MT_OK);
    CHECK_INT(t, mt_study_solve(study, NULL, &result, &err), MT_OK);
    CHECK_INT(t, mt_result_json(result, &text, NULL), MT_OK);
    CHECK(t, text != NULL && strstr(text, "\"seed\": 7") != NULL &&
                 strstr(text, "\"overrides\": [\n") != NULL);
    mt_string_delete(text);
    mt_result_delete(result);
    mt_study_delete(study);
    opt.sets = odd;
    CHECK_INT(t, mt_study_read("box/studies/q.json", &opt, &study, &err), MT_E_USAGE);
    CHECK(t, study == NULL && strstr(err.text, "\"W\"") != NULL);
    CHECK_INT(t, mt_model_read("box/models/p.json", &opt, &model, &err), MT_E_USAGE);
    CHECK(t, model == NULL);
}

static void read__wrong_options_are_refused(mt_test *t)
{
    static const mt_file_text no_text = {"a", NULL};
    static const mt_file_text no_path = {NULL, "a"};
    static const char *const no_set[] = {NULL};
    static const int below = -1;
    const mt_read_options rows[] = {
        {.size = sizeof rows[0], .sets = NULL, .n_sets = 1},
        {.size = sizeof rows[0], .sets = no_set, .n_sets = 1},
        {.size = sizeof rows[0], .n_sets = -1},
        {.size = sizeof rows[0], .seed = &below},
        {.size = sizeof rows[0], .files = NULL, .n_files = 1},
        {.size = sizeof rows[0], .files = &no_text, .n_files = 1},
        {.size = sizeof rows[0], .files = &no_path, .n_files = 1},
        {.size = sizeof rows[0], .n_files = -1},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_study *study = NULL;
        mt_test_row(t, "row %d", i);
        CHECK_INT(t, mt_study_read("a", &rows[i], &study, NULL), MT_E_USAGE);
        CHECK(t, study == NULL);
    }
}

MT_TEST_MAIN(MT_TEST(read__a_study_and_its_model_come_from_memory),
             MT_TEST(read__what_is_not_given_is_not_there),
             MT_TEST(read__paths_are_compared_by_their_words),
             MT_TEST(read__every_problem_is_listed_with_its_place),
             MT_TEST(read__options_may_grow),
             MT_TEST(read__values_are_set_instead_of_the_files),
             MT_TEST(read__wrong_options_are_refused))
