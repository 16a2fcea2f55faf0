/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values of parameters at the original design. */
#include <math.h>
#include <string.h>

#include "base/text.h"
#include "io/json.h"
#include "model/read.h"
#include "model/values.h"
#include "mt_test.h"

/* A model with these parameters (members of "parameters"). */
static mt_model *model_of(mt_test *t, const char *parameters)
{
    mt_text text = {0};
    mt_json *doc = NULL;
    mt_model *m = NULL;
    mt_text_addf(&text,
                 "{\"format\": \"modetune-model/1\", \"name\": \"test\", \"dimension\": 2, "
                 "\"parameters\": {%s}}",
                 parameters);
    if (CHECK(t, !text.failed) &&
        CHECK_INT(t, mt_json_parse(text.s, text.length, &doc, NULL), MT_OK)) {
        CHECK_INT(t, mt_model_from_json(doc, "test", &m, NULL), MT_OK);
    }
    mt_json_delete(doc);
    mt_text_free(&text);
    return m;
}

static void values__follow_the_dependence_in_any_order(mt_test *t)
{
    static const double TOL = 1e-15; /* one or two roundings */
    double v[5] = {0.0};
    int bad = 0;
    mt_model *const m = model_of(
        t, "\"a\": \"b + c\", \"b\": \"2*c\", \"c\": 1.5, \"d\": \"sqrt(b)/a\", \"e\": \"b\"");
    if (m != NULL) {
        const size_t used = m->mem.used;
        CHECK_INT(t, mt_model_original_values(m, &m->mem, v, &bad, NULL), MT_OK);
        CHECK(t, m->mem.used == used); /* scratch is given back */
    }
    CHECK_INT(t, bad, MT_ABSENT);
    CHECK_NEAR(t, v[0], 4.5, TOL);
    CHECK_NEAR(t, v[1], 3.0, TOL);
    CHECK_NEAR(t, v[2], 1.5, TOL);
    CHECK_NEAR(t, v[3], 0.38490017945975052, TOL); /* sqrt(3)/4.5 */
    CHECK_NEAR(t, v[4], 3.0, TOL);
    mt_model_delete(m);
}

static void values__name_the_parameter_without_a_value(mt_test *t)
{
    static const struct {
        const char *name;
        const char *parameters;
        const char *want;
    } rows[] = {
        {"itself", "\"a\": 1, \"b\": \"ln(a - 1)\"",
         "/parameters/b: parameter \"b\": ln(0) has no finite value"},
        {"not the one that uses it", "\"u\": \"2*b\", \"b\": \"1/z\", \"z\": 0",
         "/parameters/b: parameter \"b\": 1 / 0 has no finite value"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_text text = {0};
        mt_json *doc = NULL;
        mt_model *m = NULL;
        mt_err err = {.text = ""};
        mt_test_row(t, "%s", rows[i].name);
        mt_text_addf(&text,
                     "{\"format\": \"modetune-model/1\", \"dimension\": 2, "
                     "\"parameters\": {%s}}",
                     rows[i].parameters);
        CHECK_INT(t, mt_json_parse(text.s, text.length, &doc, NULL), MT_OK);
        CHECK_INT(t, mt_model_from_json(doc, "test", &m, &err), MT_E_INPUT);
        CHECK(t, strstr(err.text, rows[i].want) != NULL);
        mt_json_delete(doc);
        mt_text_free(&text);
    }
}

/* A model that is made in memory is not looked at when it is read. */
static void values__of_a_model_in_memory_name_it_too(mt_test *t)
{
    double v[3] = {0.0};
    int bad = MT_ABSENT;
    mt_err err = {.text = ""};
    mt_expr e = {0};
    mt_model *const m = model_of(t, "\"u\": \"2*b\", \"b\": \"1/z\", \"z\": 1");
    if (m != NULL && CHECK_INT(t, mt_expr_number(0.0, &m->mem, &e, NULL), MT_OK)) {
        m->parameters[2].value = mt_model_add_num(m, e, MT_NO_ADDR);
        CHECK_INT(t, mt_model_original_values(m, &m->mem, v, &bad, &err), MT_E_DOMAIN);
        CHECK_INT(t, bad, mt_model_find_parameter(m, "b"));
    }
    CHECK_STR(t, err.text, "parameter \"b\" has no finite value");
    mt_model_delete(m);
}

static void values__a_long_chain_needs_no_deep_stack(mt_test *t)
{
    enum { N = 20000 };
    mt_text text = {0};
    for (int i = 0; i < N; i++) { /* p0 = p1 + 1, ..., the last is 1 */
        if (i < N - 1) {
            mt_text_addf(&text, "\"p%d\": \"p%d + 1\", ", i, i + 1);
        } else {
            mt_text_addf(&text, "\"p%d\": 1", i);
        }
    }
    mt_model *const m = text.failed ? NULL : model_of(t, text.s);
    double *const v = m == NULL ? NULL : mt_arena_f64(&m->mem, N, 1);
    if (CHECK(t, v != NULL)) {
        CHECK_INT(t, mt_model_original_values(m, &m->mem, v, NULL, NULL), MT_OK);
        CHECK_NEAR(t, v[0], (double)N, 0.0); /* whole numbers: exact */
    }
    mt_model_delete(m);
    mt_text_free(&text);
}

static void values__of_an_expression(mt_test *t)
{
    mt_model *const m = model_of(t, "\"a\": 2, \"b\": 3");
    REQUIRE(t, m != NULL);
    static const struct {
        const char *text;
        double want; /* 0: there is no finite value */
    } rows[] = {{"a*b^2", 18.0}, {"7", 7.0}, {"1/(b - a - 1)", 0.0}, {"1e308*10", 0.0}};
    const double values[] = {2.0, 3.0};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_expr e = {0};
        double got = nan("");
        mt_test_row(t, "%s", rows[i].text);
        CHECK_INT(t,
                  mt_expr_parse(rows[i].text,
                                &(mt_expr_scope){.lookup = mt_model_lookup, .context = m},
                                &m->mem, &e, NULL),
                  MT_OK);
        const mt_status rc = mt_model_expr_value(m, values, &e, &m->mem, &got, NULL);
        if (rows[i].want > 0.0) {
            CHECK_INT(t, rc, MT_OK);
            CHECK_NEAR(t, got, rows[i].want, 0.0);
        } else {
            CHECK_INT(t, rc, MT_E_DOMAIN);
        }
    }
    mt_model_delete(m);
}

MT_TEST_MAIN(MT_TEST(values__follow_the_dependence_in_any_order),
             MT_TEST(values__name_the_parameter_without_a_value),
             MT_TEST(values__of_a_model_in_memory_name_it_too),
             MT_TEST(values__a_long_chain_needs_no_deep_stack),
             MT_TEST(values__of_an_expression))
