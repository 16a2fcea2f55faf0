/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What a study asks for, held against what its model does, in closed form: bands that no mode
 * comes near, targets far from where the mode is, references in another unit. One mass, whose
 * frequency is 1 Hz sqrt(stiffness), and two.
 */
#include "answer/examine.h"
#include "answer/warnings.h"
#include "study_fixture.h"

enum { TEXT = 2048 };

#define FOUR_PI_2 "39.478417604357434" /* (2 pi)^2: 1 kg at 1 Hz */
#define MODEL                                                                                \
    "{'format': 'modetune-model/1', 'dimension': 2, 'parameters': {'a': 1, 'b': 1},"         \
    "'bodies': [{'name': 'm1', 'mass_kg': 1, 'centre': [1, 0]}],"                            \
    "'joints': [{'name': 'r1', 'type': 'pin-in-slot', 'bodies': ['ground', 'm1'], 'at': "    \
    "[1, 0], 'axis': [1, 0]}],"                                                              \
    "'springs': [{'name': 's1', 'type': 'axial', 'bodies': ['ground', 'm1'], 'at': [[0, 0]," \
    " [1, 0]], 'stiffness_n_per_m': '" FOUR_PI_2 "*(%s)'}]}"

/* The study's doubts of a kind; *text: the first one's. */
static int doubts_of(mt_test *t, const char *model, const char *members, const char *kind,
                     char text[TEXT])
{
    study_case c;
    mt_arena mem = {0};
    mt_err err = {.text = ""};
    int n = 0;
    text[0] = '\0';
    if (study_load(t, model, members, &c) &&
        CHECK_INT(t, mt_arena_init(&mem, 0, NULL), MT_OK)) {
        mt_warning_list list = mt_warning_list_default(&mem);
        CHECK_INT(t, mt_study_examine(c.study, NULL, HUGE_VAL, &list, &err), MT_OK);
        for (int i = 0; i < list.n; i++) {
            const bool is = strcmp(list.items[i].kind, kind) == 0;
            if (is && n == 0) {
                (void)snprintf(text, TEXT, "%s", list.items[i].text);
            }
            n += is;
        }
    }
    mt_arena_free(&mem);
    study_free(&c);
    return n;
}

/* Looked at are the original design, each variable at either bound, and all of them at their
 * lower, and at their upper bounds: ranges are the same for a and b. */
static const struct {
    const char *stiffness;
    double lower;
    double upper;
    double hz[7]; /* of these designs */
} ways[] = {
    {"a*b", 1.0, 256.0, {1.0, 1.0, 16.0, 1.0, 16.0, 1.0, 256.0}},
    {"a*b", 1.0 / 256.0, 1.0, {1.0, 1.0 / 16.0, 1.0, 1.0 / 16.0, 1.0, 1.0 / 256.0, 1.0}},
    {"a/b", 1.0, 256.0, {1.0, 1.0, 16.0, 1.0, 1.0 / 16.0, 1.0, 1.0}},
    {"a", 1.0, 256.0, {1.0, 1.0, 16.0, 1.0, 1.0, 1.0, 16.0}},
    {"b", 1.0, 256.0, {1.0, 1.0, 1.0, 1.0, 16.0, 1.0, 16.0}},
    {"b", 1.0 / 256.0, 1.0, {1.0, 1.0, 1.0, 1.0 / 16.0, 1.0, 1.0 / 16.0, 1.0}},
};

/* The least factor between a band and a frequency; 1 where one is inside, or some are above
 * and some below. */
static double factor_of(int way, double lower, double upper)
{
    double least = HUGE_VAL;
    int above = 0;
    for (int k = 0; k < 7; k++) {
        const double hz = ways[way].hz[k];
        least = fmin(least, fmax(1.0, hz < lower ? lower / hz : hz / upper));
        above += hz >= upper;
    }
    return above == 0 || above == 7 ? least : 1.0;
}

static void examine__bands_without_effect_are_those_no_mode_comes_near(mt_test *t)
{
    static const double bands[][2] = {
        {0.0001, 0.00021}, {0.0003, 0.0005}, {0.005, 0.0059},  {0.006, 0.0065}, {0.02, 0.03},
        {0.09, 0.11},      {2.0, 3.0},       {9.9, 10.5},      {10.1, 11.0},    {100.0, 110.0},
        {159.0, 165.0},    {161.0, 170.0},   {2500.0, 2600.0}, {2570.0, 2600.0}};
    for (int w = 0; w < MT_COUNT(ways); w++) {
        for (int b = 0; b < MT_COUNT(bands); b++) {
            char model[TEXT];
            char members[TEXT];
            char text[TEXT];
            const double factor = factor_of(w, bands[b][0], bands[b][1]);
            char says[64];
            (void)snprintf(model, sizeof model, MODEL, ways[w].stiffness);
            (void)snprintf(members, sizeof members,
                           "'variables': [{'parameter': 'a', 'lower': %.17g, 'upper': %.17g}, "
                           "{'parameter': 'b', 'lower': %.17g, 'upper': %.17g}], 'goals': "
                           "[{'type': 'avoid', 'bands_hz': [[%g, %g]], 'margin_percent': 0}]",
                           ways[w].lower, ways[w].upper, ways[w].lower, ways[w].upper,
                           bands[b][0], bands[b][1]);
            (void)snprintf(says, sizeof says, "nearer than a factor of %.3g (", factor);
            mt_test_row(t, "%s, %g to %g, %g to %g Hz", ways[w].stiffness, ways[w].lower,
                        ways[w].upper, bands[b][0], bands[b][1]);
            CHECK_INT(t, doubts_of(t, model, members, "no_effect", text), factor > 10.0);
            CHECK(t, factor <= 10.0 || strstr(text, says) != NULL);
        }
    }
}

/* A hundred times away, on the side where the goal is not met anyhow or may never be. */
static void examine__targets_a_hundred_times_away_are_doubted(mt_test *t)
{
    static const struct {
        const char *goal;
        double hz;
        int warning_list;
    } rows[] = {{"'target_hz'", 99.0, 0},     {"'target_hz'", 101.0, 1},
                {"'target_hz'", 0.0101, 0},   {"'target_hz'", 0.0099, 1},
                {"'at_least_hz'", 99.0, 0},   {"'at_least_hz'", 101.0, 1},
                {"'at_least_hz'", 0.0099, 0}, {"'at_most_hz'", 101.0, 0},
                {"'at_most_hz'", 0.0101, 0},  {"'at_most_hz'", 0.0099, 1}};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        char model[TEXT];
        char members[TEXT];
        char text[TEXT];
        char says[64];
        const bool above = rows[i].hz > 1.0;
        (void)snprintf(model, sizeof model, MODEL, "a");
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'a', 'lower': 0.5, 'upper': 2}], 'goals': "
                       "[{'type': 'frequency', 'mode': 1, %s: %g}]",
                       rows[i].goal, rows[i].hz);
        (void)snprintf(says, sizeof says, "is %.3g times %s the original frequency, 1 Hz",
                       above ? rows[i].hz : 1.0 / rows[i].hz, above ? "above" : "below");
        mt_test_row(t, "%s %g", rows[i].goal, rows[i].hz);
        CHECK_INT(t, doubts_of(t, model, members, "target", text), rows[i].warning_list);
        CHECK(t, rows[i].warning_list == 0 || strstr(text, says) != NULL);
    }
}

/* Both frequencies of a measurement within 15 % (as logarithms) of 2 pi, or 60, times the
 * model's, or of that part of them. */
static void examine__references_in_another_unit_are_doubted(mt_test *t)
{
    static const double two_pi = 6.283185307179586;
    static const double off[][2] = {{0.0, 0.0},   {0.14, -0.14}, {0.16, 0.0}, {0.0, -0.16},
                                    {-0.16, 0.1}, {-1.0, -1.0},  {1.0, 1.0},  {0.0, 1.0}};
    static const double factors[] = {1.0, 6.283185307179586, 60.0, 3.0};
    for (int f = 0; f < 2 * MT_COUNT(factors); f++) {
        for (int i = 0; i < MT_COUNT(off); i++) {
            const double factor = f % 2 == 0 ? factors[f / 2] : 1.0 / factors[f / 2];
            const bool known = f / 2 == 1 || f / 2 == 2;
            const bool alike = fabs(off[i][0]) < 0.15 && fabs(off[i][1]) < 0.15;
            char members[TEXT];
            char text[TEXT];
            char says[96];
            double hz[2];
            for (int k = 0; k < 2; k++) {
                hz[k] = factor * exp(off[i][k]) *
                        study_hz(study_two_lambda(2.5, 1.2, 1.0, k == 0 ? -1 : 1));
            }
            (void)snprintf(
                members, sizeof members,
                "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 10}], 'references': "
                "{'test': {'modes': [{'frequency_hz': %.17g}, {'frequency_hz': %.17g}]}}, "
                "'goals': [{'type': 'frequency', 'mode': 1, 'reference': 'test', 'weight': 1}, "
                "{'type': 'frequency', 'mode': 2, 'reference': 'test', 'weight': 1}], "
                "'objective': {'minimise': 'misfit'}",
                hz[0], hz[1]);
            (void)snprintf(says, sizeof says, "are all about %.3g times %s the model's",
                           f / 2 == 1 ? two_pi : 60.0, f % 2 == 0 ? "above" : "below");
            mt_test_row(t, "%g times, off by %g and %g", factor, off[i][0], off[i][1]);
            if (!(hz[0] < hz[1])) {
                continue;
            }
            CHECK_INT(t,
                      doubts_of(t, STUDY_TWO_MASSES("'k1': 2.5, 'k2': 1.2, 'm': 1", ""),
                                members, "reference", text),
                      known && alike);
            CHECK(t, !(known && alike) || strstr(text, says) != NULL);
        }
    }
}

/* What looking takes: each configuration that is asked for once; for each goal with bands, in
 * each of its configurations, as much as the largest of them 2 n + 3 times. */
static void examine__bands_take_an_analysis_for_every_bound(mt_test *t)
{
    static const struct {
        const char *goals;
        double times; /* what one configuration takes, with two variables */
    } rows[] = {
        {"{'type': 'frequency', 'mode': 1, 'at_least_hz': 1}", 1.0},
        {"{'type': 'avoid', 'bands_hz': [[1, 2]]}", 8.0},
        {"{'type': 'avoid', 'bands_hz': [[1, 2], [3, 4]]}", 8.0},
        {"{'type': 'avoid', 'bands_hz': [[1, 2]]}, {'type': 'avoid', 'bands_hz': [[3, 4]]}",
         15.0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        char model[TEXT];
        char members[TEXT];
        study_case c;
        (void)snprintf(model, sizeof model, MODEL, "a*b");
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'a', 'lower': 0.5, 'upper': 2}, "
                       "{'parameter': 'b', 'lower': 0.5, 'upper': 2}], 'goals': [%s]",
                       rows[i].goals);
        mt_test_row(t, "%s", rows[i].goals);
        if (study_load(t, model, members, &c)) {
            const double work = rows[i].times * mt_warnings_work(c.study->model, 0);
            CHECK(t, work > 0.0 && mt_study_takes_more(c.study, work * (1.0 - 1e-12)));
            CHECK(t, !mt_study_takes_more(c.study, work * (1.0 + 1e-12)));
        }
        study_free(&c);
    }
}

MT_TEST_MAIN(MT_TEST(examine__bands_without_effect_are_those_no_mode_comes_near),
             MT_TEST(examine__targets_a_hundred_times_away_are_doubted),
             MT_TEST(examine__bands_take_an_analysis_for_every_bound),
             MT_TEST(examine__references_in_another_unit_are_doubted))
