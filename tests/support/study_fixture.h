/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Studies for tests: model and study as texts (with ' for ", so that they can be read here),
 * written beside each other into a folder of their own, loaded the way a user's files are, and
 * solved.
 */
#ifndef TESTS_STUDY_FIXTURE_H
#define TESTS_STUDY_FIXTURE_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/options.h"
#include "result/result.h"
#include "study/read.h"
#include "study/study.h"
#include "support/mt_test.h"

enum { STUDY_PATH = 512 };

static const double STUDY_PI = 3.14159265358979323846;

/* Two masses in a row: ground - k1 - m1 - k2 - m2, guided along x. K = [k1 + k2, -k2; -k2,
 * k2]. */
#define STUDY_TWO_MASSES_ROW                                                              \
    "'bodies': [{'name': 'm1', 'mass_kg': 'm', 'centre': [1, 0]},"                        \
    " {'name': 'm2', 'mass_kg': 'm', 'centre': [2, 0]}],"                                 \
    "'joints': ["                                                                         \
    "{'name': 'r1', 'type': 'pin-in-slot', 'bodies': ['ground', 'm1'], 'at': [1, 0],"     \
    " 'axis': [1, 0]},"                                                                   \
    "{'name': 'r2', 'type': 'pin-in-slot', 'bodies': ['ground', 'm2'], 'at': [2, 0],"     \
    " 'axis': [1, 0]}],"                                                                  \
    "'springs': ["                                                                        \
    "{'name': 's1', 'type': 'axial', 'bodies': ['ground', 'm1'], 'at': [[0, 0], [1, 0]]," \
    " 'stiffness_n_per_m': 'k1'},"                                                        \
    "{'name': 's2', 'type': 'axial', 'bodies': ['m1', 'm2'], 'at': [[1, 0], [2, 0]],"     \
    " 'stiffness_n_per_m': 'k2'}],"                                                       \
    "'sensors': [{'name': 'p1', 'on': 'm1', 'directions': ['x']},"                        \
    " {'name': 'p2', 'on': 'm2', 'directions': ['x']}]"
#define STUDY_TWO_MASSES(parameters, rest)                                 \
    "{'format': 'modetune-model/1', 'name': 'two masses', 'dimension': 2," \
    "'parameters': {" parameters "}," STUDY_TWO_MASSES_ROW rest "}"

/* The lower (sign -1) or higher (sign +1) omega^2 of that row. */
static inline double study_two_lambda(double k1, double k2, double m, int sign)
{
    const double half = 0.5 * (k1 + (2.0 * k2));
    return (half + (sign * sqrt((half * half) - (k1 * k2)))) / m;
}

static inline double study_hz(double lambda)
{
    return sqrt(lambda) / (2.0 * STUDY_PI);
}

typedef struct study_case {
    mt_study *study;   /* owned */
    mt_result *result; /* owned */
    mt_status rc;      /* of loading, then of solving */
    mt_err err;
} study_case;

static inline void study_free(study_case *c)
{
    mt_result_delete(c->result);
    mt_study_delete(c->study);
    *c = (study_case){.rc = MT_OK};
}

static inline bool study_write(const char *path, const char *text)
{
    FILE *const f = fopen(path, "w");
    if (f == NULL) {
        return false;
    }
    for (const char *p = text; *p != '\0'; p++) {
        (void)fputc(*p == '\'' ? '"' : *p, f);
    }
    return fclose(f) == 0;
}

/* Load the study with these members (after "format" and "model"). model: a text that begins
 * with a brace, or the name of a file in tests/models. */
static inline bool study_load(mt_test *t, const char *model, const char *members, study_case *c)
{
    char folder[] = "/tmp/mt_tune_XXXXXX";
    char model_path[STUDY_PATH];
    char study_path[STUDY_PATH];
    char text[2 * STUDY_PATH];
    mt_diagnostics messages = {.count = 0};
    const mt_io_options opt = {.root = "/"};
    *c = (study_case){.rc = MT_E_SYSTEM};
    if (!CHECK(t, mkdtemp(folder) != NULL)) {
        return false;
    }
    const bool inside = model[0] == '{';
    (void)snprintf(study_path, sizeof study_path, "%s/study.json", folder);
    if (inside) {
        (void)snprintf(model_path, sizeof model_path, "%s/model.json", folder);
    } else {
        const int length = snprintf(model_path, sizeof model_path,
                                    "%s/tests/models/%.100s.json", MT_TEST_SOURCE_DIR, model);
        CHECK(t, length > 0 && length < STUDY_PATH);
    }
    (void)snprintf(text, sizeof text, "{'format': 'modetune-study/1', 'model': '%s', ",
                   inside ? "model.json" : model_path);
    mt_text study = {0};
    mt_text_add(&study, text);
    mt_text_add(&study, members);
    mt_text_add(&study, "}");
    if (CHECK(t, !study.failed && (!inside || study_write(model_path, model)) &&
                     study_write(study_path, study.s))) {
        c->rc = mt_study_load(study_path, &opt, &c->study, &messages, &c->err);
    }
    if (!CHECK_INT(t, c->rc, MT_OK)) {
        (void)fprintf(stderr, "%s\n",
                      messages.lines.s == NULL ? c->err.text : messages.lines.s);
    }
    (void)unlink(study_path);
    (void)unlink(model_path + (inside ? 0 : strlen(model_path)));
    (void)rmdir(folder);
    mt_text_free(&study);
    mt_diagnostics_free(&messages);
    return c->rc == MT_OK;
}

/* Load and solve; c->rc is what solving returned. */
static inline bool study_try(mt_test *t, const char *model, const char *members, study_case *c)
{
    if (!study_load(t, model, members, c)) {
        return false;
    }
    c->rc = mt_study_solve(c->study, NULL, &c->result, &c->err);
    return c->rc == MT_OK;
}

/* The same, and it must succeed. */
static inline bool study_solve(mt_test *t, const char *model, const char *members,
                               study_case *c)
{
    const bool ok = study_try(t, model, members, c);
    if (!CHECK(t, ok)) {
        (void)fprintf(stderr, "%s: %s\n", mt_status_name(c->rc), c->err.text);
    }
    return ok;
}

/* Solve a study that is loaded with so many threads, for a row of that name; it must succeed,
 * and recommend something. */
static inline bool study_solve_threads(mt_test *t, const char *name, int threads, study_case *c)
{
    const mt_solve_options opt = {.size = sizeof opt, .threads = threads};
    mt_test_row(t, "%s, %d threads", name, threads);
    CHECK_INT(t, mt_study_solve(c->study, &opt, &c->result, &c->err), MT_OK);
    return c->result != NULL && CHECK(t, c->result->n_recommendations > 0);
}

/* Value of a parameter in recommendation `rank` (from 1; 0: the baseline); NaN where there is
 * none. */
static inline double study_value(const study_case *c, int rank, const char *parameter)
{
    if (c->result == NULL || rank > c->result->n_recommendations) {
        return nan("");
    }
    const mt_recommendation *const r =
        rank == 0 ? &c->result->baseline : &c->result->recommendations[rank - 1];
    for (int i = 0; i < r->n_parameters; i++) {
        if (strcmp(r->parameters[i].name, parameter) == 0) {
            return r->parameters[i].recommended;
        }
    }
    return nan("");
}

/* Row of a mode of a configuration in a recommendation; NULL where there is none. */
static inline const mt_result_frequency *study_row(const study_case *c, int rank,
                                                   const char *configuration, int mode)
{
    if (c->result == NULL || rank > c->result->n_recommendations) {
        return NULL;
    }
    const mt_recommendation *const r =
        rank == 0 ? &c->result->baseline : &c->result->recommendations[rank - 1];
    for (int i = 0; i < r->n_frequencies; i++) {
        if (strcmp(r->frequencies[i].configuration, configuration) == 0 &&
            r->frequencies[i].mode == mode) {
            return &r->frequencies[i];
        }
    }
    return NULL;
}

/* Its frequency [Hz]. */
static inline double study_frequency(const study_case *c, int rank, const char *configuration,
                                     int mode)
{
    const mt_result_frequency *const f = study_row(c, rank, configuration, mode);
    return f == NULL ? nan("") : f->recommended_hz;
}

/* Does one of the n texts hold `part`? */
static inline bool study_says(int n, const char *const *texts, const char *part)
{
    for (int i = 0; i < n; i++) {
        if (strstr(texts[i], part) != NULL) {
            return true;
        }
    }
    return false;
}

static inline bool study_warns(const study_case *c, const char *part)
{
    return study_says(c->result->n_warnings, c->result->warnings, part);
}

/* Does one of the reasons of a design hold `part`? */
static inline bool study_gives(const mt_recommendation *r, const char *part)
{
    for (int i = 0; i < r->n_reasons; i++) {
        if (strstr(r->reasons[i].text, part) != NULL) {
            return true;
        }
    }
    return false;
}

static inline bool study_reasons(const study_case *c, int rank, const char *part)
{
    return rank <= c->result->n_recommendations &&
           study_gives(&c->result->recommendations[rank - 1], part);
}

/* For a failing test: everything that was said. */
static inline void study_print(const study_case *c)
{
    (void)fprintf(stderr, "%s\n", c->result->status_text);
    for (int k = 0; k < c->result->n_recommendations; k++) {
        const mt_recommendation *const r = &c->result->recommendations[k];
        for (int i = 0; i < r->n_parameters; i++) {
            (void)fprintf(stderr, "  %d: %s = %.12g\n", r->rank, r->parameters[i].name,
                          r->parameters[i].recommended);
        }
        for (int i = 0; i < r->n_reasons; i++) {
            (void)fprintf(stderr, "  %d: %s\n", r->rank, r->reasons[i].text);
        }
    }
    for (int i = 0; i < c->result->n_warnings; i++) {
        (void)fprintf(stderr, "  warning: %s\n", c->result->warnings[i]);
    }
}

#endif
