/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frequencies and shapes of measurements and of other configurations: as targets, as misfit, as
 * MAC. */
#include "study_fixture.h"

static const double TOL = 1e-6;

/* Shape of mode `sign` of the row (k1, k2), m = 1, at the two masses: (k2, k1 + k2 -
 * lambda). */
static void two_shape(double k1, double k2, int sign, double s[2])
{
    s[0] = k2;
    s[1] = k1 + k2 - study_two_lambda(k1, k2, 1.0, sign);
}

static double two_mac(const double a[2], const double b[2])
{
    const double ab = (a[0] * b[0]) + (a[1] * b[1]);
    return ab * ab / (((a[0] * a[0]) + (a[1] * a[1])) * ((b[0] * b[0]) + (b[1] * b[1])));
}

#define MODEL STUDY_TWO_MASSES("'k1': 2.5, 'k2': 1.2, 'm': 1", "")
#define SPRINGS                                                     \
    "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 10}," \
    " {'parameter': 'k2', 'lower': 0.5, 'upper': 10}],"

/* "test": the modes of (2, 1), the first with the opposite sign and another length, the second
 * with its sensors in another order. */
static const char *references(char text[1024])
{
    double a[2];
    double b[2];
    two_shape(2.0, 1.0, -1, a);
    two_shape(2.0, 1.0, 1, b);
    (void)snprintf(text, 1024,
                   "'references': {'test': {'modes': ["
                   "{'frequency_hz': %.17g, 'shape': {'p1.x': %.17g, 'p2.x': %.17g}},"
                   "{'frequency_hz': %.17g, 'shape': {'p2.x': %.17g, 'p1.x': %.17g}}]}},",
                   study_hz(study_two_lambda(2.0, 1.0, 1.0, -1)), -3.0 * a[0], -3.0 * a[1],
                   study_hz(study_two_lambda(2.0, 1.0, 1.0, 1)), 0.1 * b[1], 0.1 * b[0]);
    return text;
}

static void measured_frequencies_and_shapes__are_identified_exactly(mt_test *t)
{
    study_case c;
    char text[1024];
    char members[4096];
    (void)snprintf(members, sizeof members,
                   "%s%s'goals': ["
                   "{'type': 'frequency', 'mode': 1, 'reference': 'test', 'weight': 1},"
                   "{'type': 'frequency', 'mode': 2, 'reference': 'test', 'weight': 2},"
                   "{'type': 'shape', 'mode': 1, 'reference': 'test', 'weight': 0.5},"
                   "{'type': 'shape', 'mode': 2, 'reference': 'test', 'weight': 1}],"
                   "'objective': {'minimise': 'misfit'}",
                   SPRINGS, references(text));
    if (study_solve(t, MODEL, members, &c)) {
        const mt_recommendation *const r = &c.result->recommendations[0];
        CHECK_INT(t, c.result->status, MT_RESULT_FITTED);
        CHECK_NEAR(t, study_value(&c, 1, "k1"), 2.0, TOL);
        CHECK_NEAR(t, study_value(&c, 1, "k2"), 1.0, TOL);
        CHECK_NEAR_ABS(t, r->misfit, 0.0, 1e-9);
        CHECK_NEAR_ABS(t, r->score, 0.0, 1e-9);
        CHECK(t, study_reasons(&c, 1, "The 4 weighted goals deviate by"));
        const mt_result_frequency *const f = study_row(&c, 1, "default", 1);
        if (CHECK(t, f != NULL)) { /* the opposite sign counts for nothing */
            CHECK_NEAR(t, f->mac, 1.0, 1e-12);
            CHECK_STR(t, f->reference, "test");
        }
        for (int i = 0; i < r->n_goals; i++) {
            CHECK(t, r->goals[i].weighted);
            CHECK_NEAR_ABS(t, r->goals[i].violation_percent, 0.0, 1e-7);
        }
    }
    study_free(&c);
}

/* Misfit of the two contradicting frequencies below, from the closed form. */
static double misfit(double k1, double w)
{
    const double a =
        0.5 * log(study_two_lambda(k1, 1.2, 1.0, -1) / study_two_lambda(2.0, 1.2, 1.0, -1));
    const double b =
        0.5 * log(study_two_lambda(k1, 1.2, 1.0, 1) / study_two_lambda(3.0, 1.2, 1.0, 1));
    return sqrt((a * a) + (w * b * b));
}

/* The same errors in percent of the targets, their root mean square. */
static double off_by(double k1, double w)
{
    const double a =
        sqrt(study_two_lambda(k1, 1.2, 1.0, -1) / study_two_lambda(2.0, 1.2, 1.0, -1)) - 1.0;
    const double b =
        sqrt(study_two_lambda(k1, 1.2, 1.0, 1) / study_two_lambda(3.0, 1.2, 1.0, 1)) - 1.0;
    return 100.0 * sqrt(((a * a) + (w * b * b)) / (1.0 + w));
}

/* One unknown, two frequencies of different designs: the misfit is that of the closed form's
 * minimum, found by golden section (k1 to sqrt(eps)). */
static void contradicting_measurements__leave_the_least_misfit(mt_test *t)
{
    study_case c;
    char members[2048];
    const double w = 3.0;
    const double ratio = 0.5 * (sqrt(5.0) - 1.0);
    double low = 1.5;
    double high = 3.5;
    for (int i = 0; i < 100; i++) {
        const double p = high - (ratio * (high - low));
        const double q = low + (ratio * (high - low));
        if (misfit(p, w) < misfit(q, w)) {
            high = q;
        } else {
            low = p;
        }
    }
    (void)snprintf(
        members, sizeof members,
        "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 10}],"
        "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': %.17g, 'weight': 1},"
        "{'type': 'frequency', 'mode': 2, 'target_hz': %.17g, 'weight': %g}],"
        "'objective': {'minimise': 'misfit'}",
        study_hz(study_two_lambda(2.0, 1.2, 1.0, -1)),
        study_hz(study_two_lambda(3.0, 1.2, 1.0, 1)), w);
    if (study_solve(t, MODEL, members, &c)) {
        char rms[64];
        (void)snprintf(rms, sizeof rms, "The 2 weighted goals deviate by %.3g %% rms.",
                       off_by(low, w));
        CHECK_INT(t, c.result->status, MT_RESULT_FITTED);
        CHECK_NEAR(t, study_value(&c, 1, "k1"), low, 1e-6);
        CHECK_NEAR(t, c.result->recommendations[0].misfit, misfit(low, w), 1e-9);
        CHECK(t, study_reasons(&c, 1, rms));
    }
    study_free(&c);
}

/* A MAC as a constraint, in the middle of the way: the least change stops where the MAC is just
 * met. */
static const char *const MAC_GOAL =
    "'goals': [{'type': 'mac', 'mode': 2, 'reference': 'test', 'at_least': 0.99}]";

/* The matrix of the design with these springs. */
static void check_matrix(mt_test *t, const mt_recommendation *r, double k1, double k2)
{
    if (!CHECK(t,
               r->n_macs == 1 && r->macs[0].n_rows == 2 && r->macs[0].n_reference_modes == 2)) {
        return;
    }
    CHECK_STR(t, r->macs[0].configuration, "default");
    CHECK_STR(t, r->macs[0].reference, "test");
    for (int i = 0; i < 4; i++) {
        double now[2];
        double theirs[2];
        two_shape(k1, k2, i / 2 == 0 ? -1 : 1, now);
        two_shape(2.0, 1.0, i % 2 == 0 ? -1 : 1, theirs);
        const mt_result_mac_row *const row = &r->macs[0].rows[i / 2];
        CHECK_INT(t, row->mode, i / 2 + 1);
        CHECK_NEAR_ABS(t, row->values[i % 2], two_mac(now, theirs), 1e-9);
    }
}

/* Of all modes with all of the reference's, at every design, whichever mode the goal names. */
static void mac_matrix__is_that_of_the_closed_form(mt_test *t)
{
    study_case c;
    char text[1024];
    char members[4096];
    (void)snprintf(members, sizeof members, "%s%s%s", SPRINGS, references(text), MAC_GOAL);
    if (study_solve(t, MODEL, members, &c)) {
        check_matrix(t, &c.result->baseline, 2.5, 1.2);
        check_matrix(t, &c.result->recommendations[0], study_value(&c, 1, "k1"),
                     study_value(&c, 1, "k2"));
    }
    study_free(&c);
}

static void mac_at_least__is_a_constraint(mt_test *t)
{
    study_case c;
    char text[1024];
    char members[4096];
    double want[2];
    two_shape(2.0, 1.0, 1, want);
    (void)snprintf(members, sizeof members,
                   "'variables': [{'parameter': 'k2', 'lower': 0.2, 'upper': 20}], %s%s",
                   references(text), MAC_GOAL);
    if (study_solve(t, STUDY_TWO_MASSES("'k1': 2, 'k2': 6, 'm': 1", ""), members, &c)) {
        double now[2];
        two_shape(2.0, study_value(&c, 1, "k2"), 1, now);
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, two_mac(now, want), 0.99, TOL);
        CHECK(t, study_value(&c, 1, "k2") < 6.0);
        CHECK_STR(t, c.result->recommendations[0].goals[0].text,
                  "default mode 2: MAC with mode 2 of \"test\" at least 0.99");
        two_shape(2.0, 6.0, 1, now);
        CHECK_NEAR(t, c.result->baseline.goals[0].value, two_mac(now, want), 1e-12);
        CHECK(t, !c.result->baseline.goals[0].met);
    }
    study_free(&c);
}

/* Another configuration of the same model as reference. */
static void reference_configuration__gives_targets_and_shapes(mt_test *t)
{
    study_case c;
    const char *const model = STUDY_TWO_MASSES(
        "'k1': 2.5, 'k2': 1.2, 'm': 1, 'fixed': 1",
        ", 'configurations': {'now': {}, 'wanted': {'parameters': {'k1': 2, 'k2': 'fixed'}}}");
    if (study_solve(t, model,
                    SPRINGS "'references': {'twin': {'model': 'model.json',"
                            " 'configuration': 'wanted'}},"
                            "'goals': [{'type': 'frequency', 'configuration': 'now', 'mode': 1,"
                            " 'reference': 'twin'},"
                            "{'type': 'shape', 'configuration': 'now', 'mode': 1,"
                            " 'reference': 'twin', 'weight': 1}],"
                            "'objective': {'minimise': 'misfit'}",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, study_value(&c, 1, "k1"), 2.0, 1e-5);
        CHECK_NEAR(t, study_value(&c, 1, "k2"), 1.0, 1e-5);
        CHECK_NEAR_ABS(t, c.result->recommendations[0].misfit, 0.0, 1e-6);
    }
    study_free(&c);
}

/* Of the sensors only those count that both sides have: with a single one every shape is the
 * same, and says nothing. */
static void sensors_of_one_side_only__are_left_out(mt_test *t)
{
    study_case c;
    if (study_solve(t, MODEL,
                    "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 10}],"
                    "'references': {'test': {'modes': [{'frequency_hz': 0.12,"
                    " 'shape': {'p1.x': -7, 'elsewhere.y': 2}}]}},"
                    "'goals': [{'type': 'frequency', 'mode': 1, 'reference': 'test'},"
                    "{'type': 'shape', 'mode': 1, 'reference': 'test', 'weight': 1}],"
                    "'objective': {'minimise': 'misfit'}",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, study_frequency(&c, 1, "default", 1), 0.12, TOL);
        CHECK_NEAR_ABS(t, c.result->recommendations[0].misfit, 0.0, 1e-12);
    }
    study_free(&c);
}

MT_TEST_MAIN(MT_TEST(measured_frequencies_and_shapes__are_identified_exactly),
             MT_TEST(contradicting_measurements__leave_the_least_misfit),
             MT_TEST(mac_matrix__is_that_of_the_closed_form),
             MT_TEST(mac_at_least__is_a_constraint),
             MT_TEST(reference_configuration__gives_targets_and_shapes),
             MT_TEST(sensors_of_one_side_only__are_left_out))
