/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models for tests: read from tests/models, or from a text with numbers filled in; analysed
 * with named parameters as inputs. */
#ifndef TESTS_MECHANICS_MECH_H
#define TESTS_MECHANICS_MECH_H

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/analysis.h"
#include "io/json.h"
#include "model/read.h"
#include "support/mt_test.h"

enum { MECH_PATH = 512, MECH_INPUTS = 16 };

static const double MECH_PI = 3.14159265358979323846;

static inline mt_model *mech_load(mt_test *t, const char *file)
{
    char path[MECH_PATH];
    mt_err err = {.text = ""};
    mt_model *model = NULL;
    (void)snprintf(path, sizeof path, "%s/tests/models/%s.json", MT_TEST_SOURCE_DIR, file);
    if (!CHECK(t, mt_model_load(path, NULL, &model, NULL, &err) == MT_OK)) {
        (void)fprintf(stderr, "%s\n", err.text);
    }
    return model;
}

/* From a text. */
static inline mt_model *mech_parse(mt_test *t, const char *text)
{
    mt_err err = {.text = ""};
    mt_json *doc = NULL;
    mt_model *model = NULL;
    mt_status rc = mt_json_parse(text, strlen(text), &doc, &err);
    if (rc == MT_OK) {
        rc = mt_model_from_json(doc, "text", &model, &err);
    }
    mt_json_delete(doc);
    if (!CHECK(t, rc == MT_OK)) {
        (void)fprintf(stderr, "%s\n", err.text);
    }
    return model;
}

/* One configuration of a model under analysis, with inputs at their original values. */
typedef struct mech {
    mt_model *model; /* owned */
    mt_analysis *a;
    int n;                  /* inputs */
    double at[MECH_INPUTS]; /* their original values */
    mt_status rc;
    mt_err err;
} mech;

static inline void mech_free(mech *s)
{
    mt_analysis_delete(s->a);
    mt_model_delete(s->model);
    *s = (mech){0};
}

/* Value of a parameter without inputs: parameters of test models that serve as inputs are plain
 * numbers. */
static inline double mech_value(const mt_model *model, int parameter)
{
    const mt_expr *const e = &model->nums[model->parameters[parameter].value].expr;
    double value = 0.0;
    return mt_expr_is_constant(e, &value) ? value : nan("");
}

/* Inputs: names separated by a space, "" for none. Takes the model. s->rc tells how it went. */
static inline bool mech_open(mt_test *t, mt_model *model, const char *configuration,
                             const char *inputs, mech *s)
{
    int parameter[MECH_INPUTS];
    *s = (mech){.model = model, .rc = MT_E_INPUT};
    if (model == NULL) {
        return false;
    }
    for (const char *p = inputs; *p != '\0' && s->n < MECH_INPUTS;) {
        char name[64];
        const size_t length = strcspn(p, " ");
        (void)snprintf(name, sizeof name, "%.*s", (int)length, p);
        const int at = mt_model_find_parameter(model, name);
        if (!CHECK(t, at >= 0)) {
            return false;
        }
        s->at[s->n] = mech_value(model, at);
        parameter[s->n++] = at;
        p += length + strspn(p + length, " ");
    }
    const int c = configuration == NULL ? 0 : mt_model_find_configuration(model, configuration);
    if (!CHECK(t, c >= 0)) {
        return false;
    }
    s->rc = mt_analysis_new(model, c, s->n, parameter, s->at, &s->a, &s->err);
    return s->rc == MT_OK && s->a != NULL;
}

/* The same, and it must succeed. */
static inline bool mech_must(mt_test *t, mt_model *model, const char *configuration,
                             const char *inputs, mech *s)
{
    if (CHECK(t, mech_open(t, model, configuration, inputs, s)) && s->a != NULL) {
        return true;
    }
    (void)fprintf(stderr, "%s: %s\n", mt_status_name(s->rc), s->err.text);
    return false;
}

/* Frequency of vibration mode `index` (from 1) [Hz]; NaN where there is none. */
static inline double mech_hz(const mech *s, int index)
{
    const int at = mt_modal_flexible(&s->a->modes, index);
    return at < 0 ? nan("") : mt_modal_hz(&s->a->modes, at);
}

/* All vibration modes, no more and no fewer, in Hz; and the number of rigid-body modes. */
static inline void mech_expect(mt_test *t, const mech *s, int n, const double *hz, int n_rigid,
                               double tol)
{
    CHECK_INT(t, s->a->modes.n_unstable, 0);
    CHECK_INT(t, s->a->modes.n_rigid, n_rigid);
    CHECK_INT(t, s->a->modes.count - s->a->modes.n_rigid, n);
    for (int i = 0; i < n; i++) {
        CHECK_NEAR(t, mech_hz(s, i + 1), hz[i], tol);
    }
}

#endif
