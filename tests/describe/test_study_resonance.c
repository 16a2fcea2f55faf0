/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A design that nothing damps, shaken at its own frequency: there is no number, and none is
 * told, of a displacement that no spring holds (which is no sum over poles) as of an
 * acceleration, and as an objective whichever goal comes first.
 */
#include "study_fixture.h"

enum { TEXT = 2048 };

#define MODEL(c)                                                                    \
    STUDY_TWO_MASSES(                                                               \
        "'k1': 2, 'k2': 1, 'm': 1, 'c': " c,                                        \
        ", 'dampers': [{'name': 'd', 'type': 'axial', 'bodies': ['ground', 'm1'], " \
        "'at': [[0, 0], [1, 0]], 'damping_n_s_per_m': 'c'}]")
/* omega^2 = 2 -+ sqrt(2): 0.1218 and 0.2941 Hz */
#define GOAL(output, from, to)                                                          \
    "{'type': 'response', 'input': 'base.x', 'output': '" output "', 'band_hz': [" from \
    ", " to "], 'at_most': 100}"

/* model: of a damping c; none: so many goals have no number at the original design. */
static void check(mt_test *t, const char *model, const char *objective, const char *goals,
                  int none)
{
    char text[TEXT];
    study_case c;
    (void)snprintf(
        text, sizeof text,
        "'variables': [{'parameter': 'k1', 'lower': 1, 'upper': 4}, {'parameter': "
        "'c', 'lower': -2, 'upper': 2, 'scale': 1}], 'goals': [%s], 'objective': {'minimise': "
        "'%s'}, 'search': {'starts': 2}",
        goals, objective);
    mt_test_row(t, "%s of %s", objective, goals);
    if (study_solve(t, model, text, &c)) {
        const mt_recommendation *const b = &c.result->baseline;
        int found = 0;
        for (int i = 0; i < b->n_goals; i++) {
            found += isnan(b->goals[i].value) ? 1 : 0;
            CHECK(t, !b->goals[i].met || !isnan(b->goals[i].value));
        }
        CHECK_INT(t, found, none);
        CHECK(t, strcmp(objective, "change") == 0 ||
                     isnan(b->objectives[0].recommended) == (none > 0));
    }
    study_free(&c);
}

static void resonance__that_nothing_damps_has_no_number(mt_test *t)
{
    static const char *const objectives[] = {"change", "vibration"};
    for (int i = 0; i < MT_COUNT(objectives); i++) {
        check(t, MODEL("0"), objectives[i], GOAL("p2.x", "0.1", "0.2"), 1);
        check(t, MODEL("0"), objectives[i], GOAL("p2.x", "0.2", "0.29"), 0);
        check(t, MODEL("0"), objectives[i], GOAL("p2.x:acceleration", "0.1", "0.2"), 1);
        check(t, MODEL("0"), objectives[i], GOAL("p2.x:acceleration", "0.2", "0.29"), 0);
        check(t, MODEL("0"), objectives[i],
              GOAL("p2.x", "0.1", "0.2") "," GOAL("p1.x", "0.4", "0.5"), 1);
        check(t, MODEL("0"), objectives[i],
              GOAL("p1.x", "0.4", "0.5") "," GOAL("p2.x", "0.1", "0.2"), 1);
        check(t, MODEL("0"), objectives[i],
              GOAL("p1.x", "0.1", "0.5") "," GOAL("p2.x", "0.1", "0.2"), 2);
    }
}

/* What grows by itself has no answer to shaking either, whatever the band is. */
static void growth__has_no_number(mt_test *t)
{
    static const char *const objectives[] = {"change", "vibration"};
    for (int i = 0; i < MT_COUNT(objectives); i++) {
        check(t, MODEL("-0.01"), objectives[i], GOAL("p2.x", "0.1", "0.2"), 1);
        check(t, MODEL("-0.01"), objectives[i], GOAL("p2.x:acceleration", "0.2", "0.29"), 1);
    }
}

MT_TEST_MAIN(MT_TEST(growth__has_no_number),
             MT_TEST(resonance__that_nothing_damps_has_no_number))
