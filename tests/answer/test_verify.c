/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Fresh analyses that disagree, through a whole answer. No study is known for which they do, so
 * it is planted: this program has its own mt_describe_disagreement in place of the one in
 * describe_verify.c (which test_rank.c tests).
 */
#include "describe/describe.h"
#include "study_fixture.h"

static double planted_above_hz; /* mode 1 above it: disagree */

const char *mt_describe_disagreement(const mt_modes *study, const mt_modes *fresh,
                                     const char *configuration, mt_arena *mem)
{
    (void)fresh;
    return mt_modal_hz(study, 0) > planted_above_hz
               ? mt_arena_printf(mem, "mode 1 of \"%s\" is planted", configuration)
               : "";
}

#define BAND    "'goals': [{'type': 'avoid', 'bands_hz': [[2.5, 3.5]]}]"
#define LIMIT   "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 3.5}]"
#define TO_4000 "'variables': [{'parameter': 'k1', 'lower': 500, 'upper': 4000}], "

static const struct {
    const char *name;
    const char *members;
    double above_hz;
    bool baseline; /* also the original design, or it alone, is doubted */
    bool first;    /* recommendation 1 is */
} ROWS[] = {
    {"nowhere, band", TO_4000 BAND, 9.0, false, false},
    {"nowhere, limit", TO_4000 LIMIT, 9.0, false, false},
    {"everywhere, band", TO_4000 BAND, 0.0, true, true},
    {"everywhere, limit", TO_4000 LIMIT, 0.0, true, true},
    {"the recommendation", TO_4000 LIMIT, 3.3, false, true},
    {"a catalogue", "'variables': [{'parameter': 'k1', 'catalogue': [500, 2000, 4000]}], " BAND,
     0.0, true, true},
    {"infeasible", "'variables': [{'parameter': 'k1', 'lower': 500, 'upper': 1000}], " LIMIT,
     0.0, true, true},
};

static void verify__what_is_doubted_is_not_graded_nor_proven(mt_test *t)
{
    for (int i = 0; i < MT_COUNT(ROWS); i++) {
        study_case c;
        mt_test_row(t, "%s", ROWS[i].name);
        planted_above_hz = ROWS[i].above_hz;
        if (!study_solve(t, STUDY_TWO_MASSES("'m': 1, 'k1': 1000, 'k2': 1000", ""),
                         ROWS[i].members, &c)) {
            continue;
        }
        const bool doubted = ROWS[i].baseline || ROWS[i].first;
        CHECK_INT(t, c.result->status == MT_RESULT_SOLVED, !doubted);
        CHECK_INT(t, strncmp(c.result->status_text, "Not verified", 12) == 0, doubted);
        CHECK_INT(t, study_warns(&c, "is not verified: mode 1 of"), doubted);
        CHECK_INT(t, strcmp(c.result->baseline.grade, "not verified") == 0, ROWS[i].baseline);
        CHECK(t, c.result->n_recommendations > 0);
        for (int k = 0; k < c.result->n_recommendations && doubted; k++) {
            const mt_recommendation *const r = &c.result->recommendations[k];
            CHECK(t, strstr(r->grade, "proven") == NULL && r->tolerance_box == NULL);
            CHECK(t, k > 0 || (strcmp(r->grade, "not verified") == 0 && !r->feasible));
            CHECK(t, k > 0 || study_reasons(&c, 1, "NOT VERIFIED, do not use"));
        }
        for (int k = 0; k < c.result->n_certificates && doubted; k++) {
            CHECK(t, !c.result->certificates[k].proven);
            CHECK(t, strstr(c.result->certificates[k].text, "Withdrawn") != NULL);
        }
        if (!doubted && i == 0) {
            CHECK_STR(t, c.result->recommendations[0].grade, "feasible and proven");
            CHECK(t, c.result->certificates[0].proven);
        }
        study_free(&c);
    }
}

MT_TEST_MAIN(MT_TEST(verify__what_is_doubted_is_not_graded_nor_proven))
