/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two masses, two springs, one target; the original design in each corner of the bounds. No
 * direction is free of influence. */
#include "study_fixture.h"

enum { CORNERS = 8, STEPS = 40, ZOOMS = 8, TEXT = 1024 };
static const double LOWER[3] = {1.0, 0.6, 0.5}; /* k1, k2, m */
static const double UPPER[3] = {4.0, 2.4, 2.0};

/* Least change from `original` with the lower mode at lambda: for any k1, k2 the mass follows,
 * lambda being 1/m of that at m = 1. */
static double least_change(const double *original, double lambda)
{
    double low[2] = {log(LOWER[0]), log(LOWER[1])};
    double high[2] = {log(UPPER[0]), log(UPPER[1])};
    double best = HUGE_VAL;
    for (int zoom = 0; zoom < ZOOMS; zoom++) {
        double at[2] = {low[0], low[1]};
        for (int i = 0; i <= STEPS; i++) {
            for (int j = 0; j <= STEPS; j++) {
                const double t[2] = {low[0] + ((high[0] - low[0]) * i / STEPS),
                                     low[1] + ((high[1] - low[1]) * j / STEPS)};
                const double m = study_two_lambda(exp(t[0]), exp(t[1]), 1.0, -1) / lambda;
                const double d[3] = {t[0] - log(original[0]), t[1] - log(original[1]),
                                     log(m / original[2])};
                const double change = sqrt((d[0] * d[0]) + (d[1] * d[1]) + (d[2] * d[2]));
                if (m >= LOWER[2] && m <= UPPER[2] && change < best) {
                    best = change;
                    at[0] = t[0];
                    at[1] = t[1];
                }
            }
        }
        const double reach = (high[0] - low[0]) / 8.0;
        for (int k = 0; k < 2; k++) {
            low[k] = fmax(log(LOWER[k]), at[k] - reach);
            high[k] = fmin(log(UPPER[k]), at[k] + reach);
        }
    }
    return best;
}

static void study_undetermined__an_original_in_a_corner_gets_the_least_change(mt_test *t)
{
    static const double LAMBDA = 0.45;
    for (int corner = 0; corner < CORNERS; corner++) {
        double x[3];
        mt_text model = {0};
        char members[TEXT];
        study_case c = {.rc = MT_OK};
        for (int i = 0; i < 3; i++) {
            x[i] = (corner >> i) % 2 == 0 ? LOWER[i] : UPPER[i];
        }
        mt_text_addf(&model,
                     "{'format': 'modetune-model/1', 'dimension': 2, 'parameters': "
                     "{'k1': %.17g, 'k2': %.17g, 'm': %.17g}," STUDY_TWO_MASSES_ROW "}",
                     x[0], x[1], x[2]);
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'k1', 'lower': %.17g, 'upper': %.17g},"
                       "{'parameter': 'k2', 'lower': %.17g, 'upper': %.17g},"
                       "{'parameter': 'm', 'lower': %.17g, 'upper': %.17g}],"
                       "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': %.17g}]",
                       LOWER[0], UPPER[0], LOWER[1], UPPER[1], LOWER[2], UPPER[2],
                       study_hz(LAMBDA));
        mt_test_row(t, "corner %d", corner);
        if (CHECK(t, !model.failed) && study_solve(t, model.s, members, &c)) {
            CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
            CHECK_INT(t, c.result->n_unidentifiable, 0);
            CHECK_NEAR(t, c.result->recommendations[0].change, least_change(x, LAMBDA), 1e-5);
        }
        study_free(&c);
        mt_text_free(&model);
    }
}

/* p touches nothing but its own limit, which is wide; whatever is searched, it is named and
 * stays where it was. */
static void study_undetermined__is_told_of_bands_and_catalogues(mt_test *t)
{
    static const struct {
        const char *name;
        const char *variables;
        const char *rest;
        const char *text; /* the direction; NULL: none */
        double p;
    } rows[] = {
        {"bands",
         "{'parameter': 'k1', 'lower': 500, 'upper': 4000}, {'parameter': 'p', 'lower': 1, "
         "'upper': 9}",
         "'goals': [{'type': 'avoid', 'bands_hz': [[2, 3.5]]}]", "p", 3.0},
        {"clearance",
         "{'parameter': 'k1', 'lower': 500, 'upper': 4000}, {'parameter': 'p', 'lower': 1, "
         "'upper': 9}",
         "'goals': [{'type': 'avoid', 'bands_hz': [[2, 3.5]]}], 'objective': {'maximise': "
         "'clearance'}",
         "p", 3.0},
        {"objectives in order",
         "{'parameter': 'k1', 'lower': 500, 'upper': 4000}, {'parameter': 'p', 'lower': 1, "
         "'upper': 9}",
         "'goals': [{'type': 'avoid', 'bands_hz': [[2, 3.5]]}], 'objective': [{'maximise': "
         "'clearance'}, {'minimise': 'change'}]",
         "p", 3.0},
        {"a catalogue",
         "{'parameter': 'k1', 'catalogue': [500, 1000, 4000]}, {'parameter': 'p', "
         "'catalogue': [1, 4, 9]}",
         "'goals': [{'type': 'frequency', 'mode': 1, 'at_most_hz': 3}]", "p", 4.0},
        {"a catalogue that matters",
         "{'parameter': 'k1', 'catalogue': [500, 1000, 4000]}, {'parameter': 'k2', "
         "'catalogue': [500, 1000]}",
         "'goals': [{'type': 'frequency', 'mode': 1, 'at_most_hz': 3}]", NULL, 3.0},
        {"beside a catalogue",
         "{'parameter': 'k1', 'catalogue': [500, 1000, 4000]}, {'parameter': 'p', 'lower': "
         "1, 'upper': 9}",
         "'goals': [{'type': 'frequency', 'mode': 1, 'at_most_hz': 3}]", "p", 3.0},
        {"bands beside a catalogue",
         "{'parameter': 'k1', 'catalogue': [500, 1000, 4000]}, {'parameter': 'p', 'lower': "
         "1, 'upper': 9}",
         "'goals': [{'type': 'avoid', 'bands_hz': [[2, 3.5]]}]", "p", 3.0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        char members[TEXT];
        study_case c;
        mt_test_row(t, "%s", rows[i].name);
        (void)snprintf(members, sizeof members, "'variables': [%s], %s", rows[i].variables,
                       rows[i].rest);
        if (study_solve(t, STUDY_TWO_MASSES("'m': 1, 'k1': 1000, 'k2': 1000, 'p': 3", ""),
                        members, &c)) {
            CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
            CHECK_INT(t, c.result->n_unidentifiable, rows[i].text != NULL ? 1 : 0);
            if (c.result->n_unidentifiable == 1 && rows[i].text != NULL) {
                CHECK_STR(t, c.result->unidentifiable[0].text, rows[i].text);
                CHECK_NEAR(t, study_value(&c, 1, "p"), rows[i].p, 0.0);
                CHECK(t, study_reasons(&c, 1, "Not identifiable: p changes"));
            }
        }
        study_free(&c);
    }
}

MT_TEST_MAIN(MT_TEST(study_undetermined__an_original_in_a_corner_gets_the_least_change),
             MT_TEST(study_undetermined__is_told_of_bands_and_catalogues))
