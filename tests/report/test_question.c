/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The question in one sentence, for goals of every kind and number, and the title block: names
 * as text, assumptions with unit and source. */
#include <math.h>
#include <string.h>

#include "report/page.h"
#include "support/mt_test.h"

static mt_result_goal goal(const char *pointer, const char *type, const char *configuration,
                           const char *quantity, const char *text)
{
    mt_result_goal g = mt_result_goal_default();
    g.pointer = pointer;
    g.type = type;
    g.configuration = configuration;
    g.quantity = quantity;
    g.text = text;
    return g;
}

static void expect(mt_test *t, const mt_result *result, const char *want)
{
    mt_text out = {.s = NULL};
    mt_report_question(result, &out);
    mt_test_row(t, "%s", want);
    CHECK_STR(t, out.s == NULL ? "" : out.s, want);
    CHECK(t, !out.failed);
    mt_text_free(&out);
}

static const char *NAMES[] = {"k", "m", "a", "b", "c"};

static void question__counts_what_it_has_no_room_for(mt_test *t)
{
    mt_result_objective change = {"change", "change", ""};
    mt_result_goal goals[] = {
        goal("/goals/0", "frequency", "fwd", "fwd mode 1", "fwd mode 1 at 18 Hz"),
        goal("/goals/1", "frequency", "fwd", "fwd mode 2", "fwd mode 2 at least 30 Hz"),
        goal("/goals/2", "limit", NULL, "k + m", "k + m at most 5"),
        goal("/goals/3", "mac", "fwd", "fwd mode 1: MAC", "fwd mode 1: MAC at least 0.9"),
        goal("/goals/4", "limit", NULL, "m", "m at most 2 kg"),
    };
    mt_result r = {.n_variables = 2, .variables = NAMES, .n_objectives = 1};
    r.objectives = &change;
    r.baseline.goals = goals;
    r.baseline.n_goals = 1;
    expect(t, &r,
           "Which values of k and m hold fwd mode 1 at 18 Hz, with the least total "
           "change?");
    r.n_variables = 5;
    r.baseline.n_goals = 3;
    expect(t, &r,
           "Which values of the 5 variables hold fwd mode 1 at 18 Hz; fwd mode 2 at "
           "least 30 Hz; and k + m at most 5, with the least total change?");
    r.n_variables = 3;
    r.baseline.n_goals = 5;
    expect(t, &r, "Which values of k, m and a hold all 5 goals, with the least total change?");
}

static void question__joins_configurations_and_the_motion_between(mt_test *t)
{
    mt_result_objective objectives[] = {{"mass", "mass of bar_*", "kg"},
                                        {"clearance", "clearance", "%"}};
    mt_result_goal goals[] = {
        goal("/goals/0", "avoid", "fwd", "fwd", "fwd clear of 2 bands up to 50 Hz"),
        goal("/goals/0", "avoid", "aft", "aft", "aft clear of 2 bands up to 50 Hz"),
        goal("/goals/0", "avoid", NULL, "pivot from 0 to 1 rad",
             "pivot from 0 to 1 rad clear of its bands between the positions"),
    };
    mt_result r = {.n_variables = 1, .variables = NAMES, .n_objectives = 2};
    r.objectives = objectives;
    r.baseline.goals = goals;
    r.baseline.n_goals = 3;
    expect(t, &r,
           "Which values of k keep fwd, aft and pivot from 0 to 1 rad clear of 2 bands "
           "up to 50 Hz, with the least mass of bar_*, then the greatest clearance?");
}

static void question__without_goals_or_variables(mt_test *t)
{
    mt_result_objective misfit = {"misfit", "misfit", ""};
    mt_result_goal g = goal("/goals/0", "shape", "fwd", "fwd mode 1 shaped as mode 1 of \"fe\"",
                            "fwd mode 1 shaped as mode 1 of \"fe\"");
    mt_result r = {.n_variables = 0, .variables = NAMES};
    expect(t, &r, "What are the natural frequencies of the design as it is?");
    r.baseline.goals = &g;
    r.baseline.n_goals = 1;
    expect(t, &r, "Does the design as it is hold fwd mode 1 shaped as mode 1 of \"fe\"?");
    g.weighted = true;
    expect(t, &r,
           "How well does the design as it is fit fwd mode 1 shaped as mode 1 of \"fe\"?");
    r.n_variables = 1;
    r.n_objectives = 1;
    r.objectives = &misfit;
    expect(t, &r,
           "Which values of k fit fwd mode 1 shaped as mode 1 of \"fe\", with the least "
           "misfit?");
}

static void title__has_what_the_study_says_of_itself(mt_test *t)
{
    static const char digest[] =
        "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";
    mt_result_digest input = {"m.json", digest};
    mt_result_assumption a = {"k<i>", "N/m", "N/mm", 1000.0, 260000.0, "Fig. 2", true};
    mt_result r = {.study = {"S", "s.json", "A & B", NULL, "2026-03-02"}};
    r.model = (mt_result_source){NULL, "m.json"};
    r.run.inputs = &input;
    r.run.n_inputs = 1;
    r.assumptions = &a;
    r.n_assumptions = 1;
    static const char *const want[] = {
        "<dt>Study</dt><dd>s.json</dd>",
        "<dt>Author</dt><dd>A &amp; B</dd>",
        "<dt>Date</dt><dd>2026-03-02</dd>",
        "<dt>Model</dt><dd>m.json, SHA-256 0123456789ab</dd>",
        "<dt>Assumed</dt><dd>k&lt;i&gt; = 260 N/mm (Fig. 2; before the change)</dd>",
    };
    mt_text out = {.s = NULL};
    mt_report_title(&r, &out);
    CHECK(t, !out.failed && out.s != NULL && strstr(out.s, "Revision") == NULL);
    for (int i = 0; i < MT_COUNT(want) && out.s != NULL; i++) {
        mt_test_row(t, "%s", want[i]);
        CHECK(t, strstr(out.s, want[i]) != NULL);
    }
    mt_text_free(&out);
}

MT_TEST_MAIN(MT_TEST(question__counts_what_it_has_no_room_for),
             MT_TEST(question__joins_configurations_and_the_motion_between),
             MT_TEST(question__without_goals_or_variables),
             MT_TEST(title__has_what_the_study_says_of_itself))
