/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sentences that an engineer pastes into a report, word for word. */
#include "study_fixture.h"

static void check_reason(mt_test *t, const study_case *c, int rank, const char *text)
{
    mt_test_row(t, "%s", text);
    if (!CHECK(t, study_reasons(c, rank, text))) {
        study_print(c);
    }
}

/* One unit mass on k: f = sqrt(k)/(2 pi), so one per cent more of k is half a per cent of f. */
#define ONE_MASS                                                                   \
    "{'format': 'modetune-model/1', 'dimension': 2,"                               \
    "'parameters': {'k': {'value': 4, 'unit': 'N/m'}, 'idle': 1},"                 \
    "'bodies': [{'name': 'm1', 'mass_kg': 1, 'centre': [1, 0]}],"                  \
    "'joints': [{'name': 'r1', 'type': 'pin-in-slot', 'bodies': ['ground', 'm1']," \
    " 'at': [1, 0], 'axis': [1, 0]}],"                                             \
    "'springs': [{'name': 's1', 'type': 'axial', 'bodies': ['ground', 'm1'],"      \
    " 'at': [[0, 0], [1, 0]], 'stiffness_n_per_m': 'k'}]}"
#define STIFFNESS "'variables': [{'parameter': 'k', 'lower': 1, 'upper': 16}],"

static void target_that_is_reached__is_said_plainly(mt_test *t)
{
    study_case c;
    if (study_solve(t, ONE_MASS,
                    STIFFNESS
                    "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': '3/(2*pi)'}]",
                    &c)) {
        check_reason(t, &c, 1, "k rises by 125 %, from 4 to 9 N/m.");
        check_reason(t, &c, 1,
                     "default mode 1 moves from 0.31831 to 0.477465 Hz, its target; k moves it "
                     "most, +0.00239 Hz for 1 % more.");
        check_reason(t, &c, 1, "It is the only design that 12 starts found");
    }
    study_free(&c);
}

static void target_that_is_met_already__stays(mt_test *t)
{
    study_case c;
    if (study_solve(
            t, ONE_MASS,
            STIFFNESS "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': '1/pi'}]", &c)) {
        check_reason(t, &c, 1, "The original design stays as it is.");
        check_reason(t, &c, 1, "default mode 1 stays at 0.31831 Hz, its target;");
    }
    study_free(&c);
}

static void target_out_of_reach__is_told_from_which_side(mt_test *t)
{
    study_case c;
    if (study_solve(t, ONE_MASS,
                    STIFFNESS
                    "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': '5/(2*pi)'}]",
                    &c)) {
        check_reason(
            t, &c, 1,
            "default mode 1 moves from 0.31831 to 0.63662 Hz, 20 % below its target of "
            "0.795775 Hz; k moves it most,");
        check_reason(t, &c, 1, "k stands at its upper bound");
    }
    study_free(&c);
}

static void limits__are_at_clear_or_between(mt_test *t)
{
    static const struct {
        const char *goal;
        const char *text;
    } rows[] = {
        {            "'at_least_hz': '3/(2*pi)'","to 0.477465 Hz, at its lower limit;"                                                 },
        {           "'at_most_hz': '1.5/(2*pi)'",                      "to 0.238732 Hz, at its upper limit;"},
        {                   "'at_least_hz': 0.1", "stays at 0.31831 Hz, clear of its lower limit of 0.1 Hz;"},
        {                    "'at_most_hz': 0.5", "stays at 0.31831 Hz, clear of its upper limit of 0.5 Hz;"},
        {"'at_least_hz': 0.3, 'at_most_hz': 0.4",
         "stays at 0.31831 Hz, between its limits of 0.3 and 0.4 Hz;"                                       },
        {            "'at_least_hz': '5/(2*pi)'",               "25 % below its lower limit of 0.795775 Hz;"},
        {           "'at_most_hz': '0.5/(2*pi)'",             "100 % above its upper limit of 0.0795775 Hz;"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        study_case c;
        char members[512];
        (void)snprintf(members, sizeof members,
                       "%s'goals': [{'type': 'frequency', 'mode': 1, %s}]", STIFFNESS,
                       rows[i].goal);
        if (study_solve(t, ONE_MASS, members, &c)) {
            check_reason(t, &c, 1, rows[i].text);
        }
        study_free(&c);
    }
}

static void parameters_that_stay__are_listed(mt_test *t)
{
    study_case c;
    if (study_solve(t, STUDY_TWO_MASSES("'k1': 2, 'k2': 1, 'm': 1, 'u': 3, 'v': 4", ""),
                    "'variables': [{'parameter': 'k1', 'lower': 1, 'upper': 16},"
                    " {'parameter': 'u', 'lower': 1, 'upper': 16},"
                    " {'parameter': 'v', 'lower': 1, 'upper': 16}],"
                    "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': 0.13}]",
                    &c)) {
        check_reason(t, &c, 1, "u and v keep their original values.");
        check_reason(t, &c, 1, "The goals do not settle u:");
        check_reason(t, &c, 1, "The goals do not settle v:");
    }
    study_free(&c);
}

MT_TEST_MAIN(MT_TEST(target_that_is_reached__is_said_plainly),
             MT_TEST(target_that_is_met_already__stays),
             MT_TEST(target_out_of_reach__is_told_from_which_side),
             MT_TEST(limits__are_at_clear_or_between),
             MT_TEST(parameters_that_stay__are_listed))
