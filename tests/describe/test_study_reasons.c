/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sentences that an engineer pastes into a report, word for word. */
#include "mt_random.h"
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
        {"'at_least_hz': '3/(2*pi)'", "to 0.477465 Hz, at its lower limit;"},
        {"'at_most_hz': '1.5/(2*pi)'", "to 0.238732 Hz, at its upper limit;"},
        {"'at_least_hz': 0.1", "stays at 0.31831 Hz, clear of its lower limit of 0.1 Hz;"},
        {"'at_most_hz': 0.5", "stays at 0.31831 Hz, clear of its upper limit of 0.5 Hz;"},
        {"'at_least_hz': 0.3, 'at_most_hz': 0.4",
         "stays at 0.31831 Hz, between its limits of 0.3 and 0.4 Hz;"},
        {"'at_least_hz': '5/(2*pi)'", "20 % below its lower limit of 0.795775 Hz;"},
        {"'at_most_hz': '0.5/(2*pi)'", "100 % above its upper limit of 0.0795775 Hz;"},
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

/* The number before "% below" or "% above" and the one behind "of" of a sentence with `part`;
 * false where there is none. */
static bool told(const study_case *c, const char *part, double *percent, double *limit_hz)
{
    const mt_recommendation *const r = &c->result->recommendations[0];
    for (int i = 0; i < r->n_reasons; i++) {
        const char *const at = strstr(r->reasons[i].text, part);
        const char *number = at;
        while (number != NULL && number > r->reasons[i].text && number[-1] != ',') {
            number--;
        }
        if (number != NULL) {
            const char *const of = strstr(at, " of ");
            *percent = strtod(number, NULL);
            *limit_hz = of == NULL ? nan("") : strtod(of + strlen(" of "), NULL);
            return true;
        }
    }
    return false;
}

/* Whatever is asked, however far away: percentages in sentences, of goals and of frequencies
 * are those of the frequency and the limit that stand beside them. */
static void percentages__are_those_of_the_numbers_beside_them(mt_test *t)
{
    static const char *const kinds[] = {"target_hz", "at_least_hz", "at_most_hz"};
    mt_random random = mt_random_seed(668);
    for (int i = 0; i < 60; i++) {
        const char *const kind = kinds[i % 3];
        const double asked = exp(mt_random_in(&random, log(0.01), log(10.0)));
        study_case c;
        char members[512];
        (void)snprintf(members, sizeof members,
                       "%s'goals': [{'type': 'frequency', 'mode': 1, '%s': %.9g}]", STIFFNESS,
                       kind, asked);
        mt_test_row(t, "%s %.9g", kind, asked);
        if (study_solve(t, ONE_MASS, members, &c)) {
            const mt_recommendation *const r = &c.result->recommendations[0];
            const double hz = study_frequency(&c, 1, "default", 1);
            const double off = 100.0 * ((hz / asked) - 1.0);
            const bool below = off < 0.0;
            const double miss = r->goals[0].met ? 0.0 : fabs(off);
            double percent = nan("");
            double limit = nan("");
            CHECK_NEAR_ABS(t, r->goals[0].violation_percent, miss, 2e-4 + (1e-9 * miss));
            CHECK_NEAR_ABS(t, fabs(r->frequencies[0].error_percent), miss,
                           2e-4 + (1e-9 * miss));
            CHECK_NEAR_ABS(t, r->violation_percent, r->goals[0].violation_percent, 0.0);
            if (!r->goals[0].met &&
                CHECK(t, told(&c, below ? " % below its" : " % above its", &percent, &limit))) {
                CHECK_NEAR(t, limit, asked, 1e-5);
                CHECK_NEAR(t, percent, miss, 5e-3);
            }
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
        check_reason(t, &c, 1, "Not identifiable: u changes");
        check_reason(t, &c, 1, "Not identifiable: v changes");
    }
    study_free(&c);
}

/* s enters only a limit, which an interval of it meets; k the misfit, as `k`. */
#define CONTINUUM(k)                                                               \
    "{'format': 'modetune-model/1', 'dimension': 2,"                               \
    "'parameters': {'k': {'value': 4, 'unit': 'N/m'}, 's': 1},"                    \
    "'bodies': [{'name': 'm1', 'mass_kg': 1, 'centre': [1, 0]}],"                  \
    "'joints': [{'name': 'r1', 'type': 'pin-in-slot', 'bodies': ['ground', 'm1']," \
    " 'at': [1, 0], 'axis': [1, 0]}],"                                             \
    "'springs': [{'name': 's1', 'type': 'axial', 'bodies': ['ground', 'm1'],"      \
    " 'at': [[0, 0], [1, 0]], 'stiffness_n_per_m': '" k "'}]}"

static int count_said(const study_case *c, const char *text)
{
    int n = 0;
    for (int i = 0; i < c->result->n_recommendations; i++) {
        const mt_recommendation *const rec = &c->result->recommendations[i];
        for (int k = 0; k < rec->n_reasons; k++) {
            n += strstr(rec->reasons[k].text, text) != NULL;
        }
    }
    for (int i = 0; i < c->result->n_warnings; i++) {
        n += strstr(c->result->warnings[i], text) != NULL;
    }
    return n;
}

static void a_continuum_of_designs__is_one_and_said_to_be(mt_test *t)
{
    static const char *const STUDY =
        "'variables': [{'parameter': 'k', 'lower': 1, 'upper': 16},"
        " {'parameter': 's', 'lower': 0.5, 'upper': 4}],"
        "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': '3/(2*pi)', 'weight': 1},"
        " {'type': 'limit', 'expression': 's', 'at_most': 3}],"
        "'objective': {'minimise': 'misfit'}, 'recommendations': 16";
    study_case c;
    if (study_solve(t, CONTINUUM("k"), STUDY, &c)) { /* k = 9, s anything below 3 */
        CHECK_INT(t, c.result->n_recommendations, 1);
        CHECK_INT(t, c.result->run.distinct_designs, 1);
        CHECK(t, strstr(c.result->status_text, "a continuum of equally good designs") != NULL);
        CHECK_INT(t, count_said(&c, "continuum of designs is as good as this one"), 2);
        CHECK_INT(t, count_said(&c, "only"), 0);
    }
    study_free(&c);
    if (study_solve(t, CONTINUUM("9 + 0.5*(k - 3)*(k - 12)"), STUDY, &c)) { /* two of them */
        CHECK_INT(t, c.result->n_recommendations, 2);
        CHECK_INT(t, count_said(&c, "continuum of designs is as good as this one"), 4);
    }
    study_free(&c);
}

/* A hill between two valleys that meet all goals, the one below the other: none is as good as
 * what lies between. */
static void two_minima__are_no_continuum(mt_test *t)
{
    study_case c;
    if (study_solve(t, CONTINUUM("k"),
                    "'variables': [{'parameter': 'k', 'lower': 1, 'upper': 16}],"
                    "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.01}],"
                    "'objective': {'minimise': '((k - 4)*(k - 12))^2 + 20*k'}",
                    &c) &&
        CHECK_INT(t, c.result->n_recommendations, 2)) {
        CHECK(t, fabs(study_value(&c, 1, "k") - 4.0) < 0.5);
        CHECK(t, fabs(study_value(&c, 2, "k") - 12.0) < 0.5);
        CHECK_INT(t, count_said(&c, "ontinuum"), 0);
    }
    study_free(&c);
}

MT_TEST_MAIN(MT_TEST(target_that_is_reached__is_said_plainly),
             MT_TEST(target_that_is_met_already__stays),
             MT_TEST(target_out_of_reach__is_told_from_which_side),
             MT_TEST(limits__are_at_clear_or_between),
             MT_TEST(percentages__are_those_of_the_numbers_beside_them),
             MT_TEST(parameters_that_stay__are_listed),
             MT_TEST(a_continuum_of_designs__is_one_and_said_to_be),
             MT_TEST(two_minima__are_no_continuum))
