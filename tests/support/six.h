/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The study of six masses and four bands, changed by tests in place, and its designs judged
 * without the search. */
#ifndef TESTS_SIX_H
#define TESTS_SIX_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/analysis.h"
#include "base/text.h"
#include "mt_test.h"
#include "result/result.h"
#include "result/write.h"
#include "study/read.h"
#include "study/study.h"

enum { SIX = 6, SIX_BANDS = 4, SIX_MOST = 32 };

static const double SIX_BAND[SIX_BANDS][2] = {
    {3.87, 4.73}, {7.74, 9.46}, {15.48, 18.92}, {30.96, 37.84}};

typedef struct six {
    mt_study *study;
    mt_analysis *a; /* of its variables, all six */
    double k[SIX];
    double catalogue[SIX][SIX_MOST];
} six;

static inline bool six_begin(mt_test *t, six *s)
{
    mt_err err = {.text = ""};
    int inputs[SIX];
    *s = (six){.study = NULL};
    mt_status rc = mt_study_load(MT_TEST_SOURCE_DIR "/studies/six_masses_bands.json", NULL,
                                 &s->study, NULL, &err);
    for (int i = 0; i < SIX && rc == MT_OK; i++) {
        inputs[i] = s->study->variables[i].parameter;
        s->k[i] = s->study->variables[i].original;
    }
    rc = rc == MT_OK ? mt_analysis_new(s->study->model, 0, SIX, inputs, s->k, &s->a, &err) : rc;
    if (!CHECK(t, rc == MT_OK)) {
        (void)fprintf(stderr, "%s\n", err.text);
        mt_study_delete(s->study);
        return false;
    }
    return true;
}

static inline void six_end(six *s)
{
    mt_analysis_delete(s->a);
    mt_study_delete(s->study);
}

/* Variable i takes k exp(ln[0 .. n - 1]) only. */
static inline void six_catalogue(six *s, int i, int n, const double *ln)
{
    mt_variable *const v = &s->study->variables[i];
    for (int k = 0; k < n; k++) {
        s->catalogue[i][k] = s->k[i] * exp(ln[k]);
    }
    v->n_catalogue = n;
    v->catalogue = s->catalogue[i];
    v->lower = s->catalogue[i][0];
    v->upper = s->catalogue[i][n - 1];
}

/* Does x[6] keep every mode out of every band, widened by margin (relative)? The search's
 * tolerance is 1e-6. */
static inline bool six_clear(six *s, const double *x, double margin)
{
    mt_err err = {.text = ""};
    const mt_analysis_options opt = mt_analysis_options_default();
    if (mt_analysis_solve(s->a, x, &opt, &err) != MT_OK) {
        return false;
    }
    for (int i = 0; i < SIX; i++) {
        const double f = mt_modal_hz(&s->a->modes, mt_modal_flexible(&s->a->modes, i + 1));
        for (int b = 0; b < SIX_BANDS; b++) {
            const double low = SIX_BAND[b][0] * (1.0 - margin) * (1.0 + 1e-6);
            const double high = SIX_BAND[b][1] * (1.0 + margin) * (1.0 - 1e-6);
            if (f > low && f < high) {
                return false;
            }
        }
    }
    return true;
}

static inline double six_change(const six *s, const double *x)
{
    double sum = 0.0;
    for (int i = 0; i < SIX; i++) {
        sum += log(x[i] / s->k[i]) * log(x[i] / s->k[i]);
    }
    return sqrt(sum);
}

static inline mt_result *six_solve(mt_test *t, const mt_study *study, int threads)
{
    mt_err err = {.text = ""};
    mt_result *result = NULL;
    mt_solve_options opt = {.size = sizeof opt};
    opt.threads = threads;
    if (!CHECK(t, mt_study_solve(study, &opt, &result, &err) == MT_OK)) {
        (void)fprintf(stderr, "%s\n", err.text);
    }
    return result;
}

/* The same bytes with 1 and 8 workers; the answer of one, NULL without any. */
static inline mt_result *six_same_bytes(mt_test *t, const mt_study *study)
{
    static const int workers[] = {1, 8};
    mt_result *result[MT_COUNT(workers)];
    mt_text text[MT_COUNT(workers)] = {{.s = NULL}};
    for (int i = 0; i < MT_COUNT(workers); i++) {
        mt_err err = {.text = ""};
        result[i] = six_solve(t, study, workers[i]);
        mt_test_row(t, "%d workers", workers[i]);
        CHECK(t, result[i] != NULL && mt_result_write(result[i], &text[i], &err) == MT_OK);
        CHECK(t, text[i].s != NULL && text[0].s != NULL && strcmp(text[i].s, text[0].s) == 0);
    }
    for (int i = 0; i < MT_COUNT(workers); i++) {
        mt_text_free(&text[i]);
    }
    mt_result_delete(result[1]);
    return result[0];
}

#endif
