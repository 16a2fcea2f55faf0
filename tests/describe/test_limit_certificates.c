/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What is proven of limits beside what can be reached, in closed form: one mass on a spring
 * whose frequency is between 10 and 12 Hz. A limit cannot be met where all of that is beyond it
 * by more than its tolerance; another goal, which no design meets, lets the proofs be asked
 * for.
 */
#include "study_fixture.h"

#define MODEL                                                                                \
    "{'format': 'modetune-model/1', 'dimension': 2, 'parameters': {'hz': 11},"               \
    "'bodies': [{'name': 'm1', 'mass_kg': 1, 'centre': [1, 0]}],"                            \
    "'joints': [{'name': 'r1', 'type': 'pin-in-slot', 'bodies': ['ground', 'm1'], 'at': "    \
    "[1, 0], 'axis': [1, 0]}],"                                                              \
    "'springs': [{'name': 's1', 'type': 'axial', 'bodies': ['ground', 'm1'], 'at': [[0, 0]," \
    " [1, 0]], 'stiffness_n_per_m': '(2*pi*hz)^2'}]}"

static const double LOW_HZ = 10.0;
static const double HIGH_HZ = 12.0;

static void limits__cannot_be_met_beyond_their_tolerance_alone(mt_test *t)
{
    static const struct {
        const char *limits;
        double tolerance_percent;
        bool impossible;
    } rows[] = {
        {"'at_most_hz': 12.5", 1.0, false},   {"'at_most_hz': 11", 1.0, false},
        {"'at_most_hz': 9.95", 1.0, false},   {"'at_most_hz': 9.85", 1.0, true},
        {"'at_most_hz': 9.6", 5.0, false},    {"'at_most_hz': 9.4", 5.0, true},
        {"'at_least_hz': 9", 1.0, false},     {"'at_least_hz': 11", 1.0, false},
        {"'at_least_hz': 12.05", 1.0, false}, {"'at_least_hz': 12.2", 1.0, true},
        {"'at_least_hz': 12.5", 5.0, false},  {"'at_least_hz': 12.8", 5.0, true},
        {"'at_most_hz': 9.999", 1e-4, true},  {"'at_least_hz': 12.001", 1e-4, true},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        study_case c;
        char members[512];
        int told = 0;
        mt_test_row(t, "%s within %g %%", rows[i].limits, rows[i].tolerance_percent);
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'hz', 'lower': 10, 'upper': 12}], 'goals': "
                       "[{'type': 'frequency', 'mode': 1, %s, 'tolerance_percent': %g}, "
                       "{'type': 'frequency', 'mode': 1, 'at_least_hz': 50}]",
                       rows[i].limits, rows[i].tolerance_percent);
        if (study_solve(t, MODEL, members, &c)) {
            CHECK_INT(t, c.result->status, MT_RESULT_INFEASIBLE);
            for (int k = 0; k < c.result->n_certificates; k++) {
                const mt_certificate *const own = &c.result->certificates[k];
                if (own->pointer == NULL || strcmp(own->pointer, "/goals/0") != 0) {
                    continue;
                }
                told++;
                CHECK(t, own->proven);
                CHECK_STR(t, own->kind, rows[i].impossible ? "infeasible" : "range");
                CHECK(t, own->reachable_lower_hz <= LOW_HZ);
                CHECK(t, own->reachable_upper_hz >= HIGH_HZ);
                CHECK_NEAR(t, own->reachable_lower_hz, LOW_HZ, 1e-6);
                CHECK_NEAR(t, own->reachable_upper_hz, HIGH_HZ, 1e-6);
            }
            CHECK_INT(t, told, 1);
        }
        study_free(&c);
    }
}

/* Two masses, springs between 0.5 and 2: lambda_1 of 0.6 takes both nearly at 2 (there it is
 * 0.764), lambda_2 of 1.5 both nearly at 0.5 (there it is 1.309). Each alone can be had. */
static void limits__that_contradict_each_other_are_proven_together(mt_test *t)
{
    study_case c;
    char members[512];
    bool together = false;
    (void)snprintf(members, sizeof members,
                   "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 2}, {'parameter': "
                   "'k2', 'lower': 0.5, 'upper': 2}], 'goals': [{'type': 'frequency', 'mode': "
                   "1, 'at_least_hz': %.17g}, {'type': 'frequency', 'mode': 2, 'at_most_hz': "
                   "%.17g}]",
                   study_hz(0.6), study_hz(1.5));
    if (study_solve(t, STUDY_TWO_MASSES("'k1': 1, 'k2': 1, 'm': 1", ""), members, &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_INFEASIBLE);
        for (int k = 0; k < c.result->n_certificates; k++) {
            const mt_certificate *const own = &c.result->certificates[k];
            together = together || (own->pointer == NULL && own->proven &&
                                    strstr(own->text, "all limits together: proven") != NULL);
        }
        CHECK(t, together);
    }
    study_free(&c);
}

/* Equal masses in a row: with r = k2 / k1 the ratio of the frequencies is h + sqrt(h^2 - 1),
 * h = (1 + 2 r) / (2 sqrt r), least at r = 1/2, where it is 1 + sqrt 2. */
static void ratios__are_met_down_to_their_least_and_proven_impossible_below(mt_test *t)
{
    const double least = 1.0 + sqrt(2.0);
    static const struct {
        const char *goal;
    } rows[] = {{"'type': 'ratio', 'mode': 2, 'of': {'mode': 1}, 'at_most'"},
                {"'type': 'ratio', 'mode': 2, 'of': {'mode': 1}, 'target'"}};
    for (int i = 0; i < 2 * MT_COUNT(rows); i++) {
        const bool above = i >= MT_COUNT(rows);
        const double asked = least * (above ? 1.0005 : 0.999);
        study_case c;
        char members[512];
        bool proven = false;
        mt_test_row(t, "%s: %.17g", rows[i % MT_COUNT(rows)].goal, asked);
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 20}, "
                       "{'parameter': 'k2', 'lower': 0.2, 'upper': 5}], 'goals': [{%s: %.17g}]",
                       rows[i % MT_COUNT(rows)].goal, asked);
        if (study_solve(t, STUDY_TWO_MASSES("'k1': 3, 'k2': 1, 'm': 1", ""), members, &c)) {
            const mt_recommendation *const r = &c.result->recommendations[0];
            const double ratio = r->parameters[1].recommended / r->parameters[0].recommended;
            const double h = (1.0 + (2.0 * ratio)) / (2.0 * sqrt(ratio));
            CHECK(t, above == (c.result->status == MT_RESULT_SOLVED));
            CHECK_NEAR(t, r->goals[0].value, h + sqrt((h * h) - 1.0), 1e-9);
            CHECK_NEAR(t, r->goals[0].value, above ? asked : least, 2e-6);
            for (int k = 0; k < c.result->n_certificates; k++) {
                const mt_certificate *const own = &c.result->certificates[k];
                proven = proven || (own->pointer == NULL && own->proven &&
                                    strcmp(own->kind, "infeasible") == 0);
            }
            CHECK(t, proven != above);
        }
        study_free(&c);
    }
}

MT_TEST_MAIN(MT_TEST(ratios__are_met_down_to_their_least_and_proven_impossible_below),
             MT_TEST(limits__that_contradict_each_other_are_proven_together),
             MT_TEST(limits__cannot_be_met_beyond_their_tolerance_alone))
