/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The first lines of a page: the largest changes first, what was 0 before all others, names as
 * text, and a claim of proof only where there is one. */
#include <math.h>
#include <string.h>

#include "report/page.h"
#include "support/mt_test.h"

static mt_result_parameter parameter(const char *name, double original, double recommended)
{
    mt_result_parameter p = {.name = name, .unit = "N/m"};
    p.original = original;
    p.recommended = recommended;
    p.change_percent = original > 0.0 ? 100.0 * (recommended / original - 1.0) : nan("");
    return p;
}

/* Does the gist of one design with these certificates hold all of the words? */
static void expect(mt_test *t, const char *grade, int n_certificates, bool proven,
                   const char *words)
{
    mt_result_parameter p[6] = {parameter("a", 1.0, 1.01),   parameter("b<i>", 1.0, 0.5),
                                parameter("same", 1.0, 1.0), parameter("zero", 0.0, 3.0),
                                parameter("c", 1.0, 1.2),    parameter("d", 1.0, 1.1)};
    mt_result_goal goals[2] = {{.met = true}, {.met = false, .weighted = true}};
    mt_certificate certificate = {.text = "None is lower.", .proven = proven};
    mt_recommendation r = {.rank = 1,
                           .grade = grade,
                           .change = 0.25,
                           .misfit = nan(""),
                           .clearance_percent = nan(""),
                           .n_parameters = 6,
                           .parameters = p,
                           .n_goals = 2,
                           .goals = goals};
    const mt_result result = {.status = MT_RESULT_SOLVED,
                              .status_text = "Solved: 1 design.",
                              .n_recommendations = 1,
                              .recommendations = &r,
                              .n_certificates = n_certificates,
                              .certificates = &certificate};
    mt_text out = {.s = NULL};
    mt_report_abstract(&result, &out);
    mt_test_row(t, "%s", words);
    CHECK(t, !out.failed && out.s != NULL && strstr(out.s, words) != NULL);
    CHECK(t, out.s != NULL && strstr(out.s, "<i>") == NULL && strstr(out.s, "inf") == NULL);
    mt_text_free(&out);
}

static void gist__tells_changes_goals_and_proof(mt_test *t)
{
    expect(t, "feasible", 0, false, "<b>Solved</b>: 1 design.</p>");
    expect(t, "feasible", 0, false,
           "zero to 3.00 N/m, b&lt;i&gt; -50.0 %, c +20.0 %, d +10.0 % and 1 other.");
    expect(t, "feasible", 0, false, "the goal is met.");
    expect(t, "feasible", 0, false, "nothing; designs were found by local searches");
    expect(t, "feasible", 1, false, "nothing; what was sampled is listed below");
    expect(t, "feasible", 1, true, "<b>Proven</b>: None is lower.</li>");
    expect(t, "feasible and proven", 0, false, "that the best design meets the goals.");
}

MT_TEST_MAIN(MT_TEST(gist__tells_changes_goals_and_proof))
