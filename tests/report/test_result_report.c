/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A result built by hand: what its summary, spreadsheet and page say. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "mt_test.h"
#include "report/design.h"
#include "report/page.h"
#include "report/summary.h"

static mt_result_parameter parameters[2];
static mt_result_frequency frequencies[2];
static mt_recommendation recommendations[1];
static mt_result_published published[3];
static mt_unidentifiable_direction unidentifiable;
static mt_result_weight_sensitivity weight_sensitivity;
static mt_certificate certificate;
static mt_relaxation relaxation;
static mt_result_objective objectives[] = {{"mass", "mass of <bar>*", "kg"},
                                           {"change", "change", ""}};
static mt_design_objective reached[] = {{"mass of <bar>*", "kg", 3.5, 1.25},
                                        {"change", "", 0.0, 0.5}};

/* Two variables, two frequencies, one recommendation; published values that hold, fail and
 * cannot be compared. */
static mt_result *make(mt_test *t)
{
    static const char *variables[] = {"k<1>", "m"};
    static mt_reason reasons[] = {{"change", "k<1>", "k<1> rises & m falls."},
                                  {"rank", NULL, "It is the only one."}};
    mt_result *r = NULL;
    if (!CHECK(t, mt_result_new(&r, NULL) == MT_OK)) {
        return NULL;
    }
    parameters[0] = (mt_result_parameter){"k<1>",
                                          "N/m",
                                          NULL,
                                          nan(""),
                                          50.0,
                                          92.942,
                                          85.884,
                                          NULL,
                                          10.0,
                                          100.0,
                                          "logarithmic with floor",
                                          0.05,
                                          nan(""),
                                          NULL,
                                          NULL};
    parameters[1] =
        (mt_result_parameter){"m", NULL, NULL,     nan(""), 1.0, 0.5,  -50.0, "lower",
                              0.5, 2.0,  "linear", nan(""), 2.0, NULL, NULL};
    for (int i = 0; i < 2; i++) {
        frequencies[i] = mt_result_frequency_default();
        frequencies[i].configuration = "held";
        frequencies[i].mode = i + 1;
        frequencies[i].original_hz = 0.75 + i;
        frequencies[i].recommended_hz = 1.0 + i;
    }
    frequencies[0].target_hz = 1.0;
    frequencies[0].error_percent = 2e-14;
    frequencies[1].at_least_hz = 1.9;
    recommendations[0] = mt_recommendation_default();
    recommendations[0].rank = 1;
    recommendations[0].feasible = true;
    recommendations[0].grade = "feasible";
    recommendations[0].parameters = parameters;
    recommendations[0].n_parameters = 2;
    recommendations[0].frequencies = frequencies;
    recommendations[0].n_frequencies = 2;
    recommendations[0].objectives = reached;
    recommendations[0].n_objectives = 2;
    recommendations[0].reasons = reasons;
    recommendations[0].n_reasons = 2;
    for (int i = 0; i < 3; i++) {
        published[i] = mt_result_published_default();
        published[i].label = i == 0 ? "good" : i == 1 ? "bad" : "other";
        published[i].role = i == 2 ? "not_comparable" : "verifies";
        published[i].published = 1.0;
        published[i].computed = 1.0 + i;
        published[i].holds = i == 0;
    }
    r->study.name = "A <study>";
    r->status = MT_RESULT_SOLVED;
    r->status_text = "Solved.";
    r->baseline = recommendations[0];
    r->baseline.rank = 0;
    r->recommendations = recommendations;
    r->n_recommendations = 1;
    r->objectives = objectives;
    r->n_objectives = 2;
    r->variables = variables;
    r->n_variables = 2;
    r->published = published;
    r->n_published = 3;
    r->unidentifiable = &unidentifiable; /* computed, and there are none */
    r->weight_sensitivity = &weight_sensitivity;
    r->certificates = &certificate;
    r->relaxations = &relaxation;
    return r;
}

static void summary__says_status_numbers_and_reasons(mt_test *t)
{
    static const char *const parts[] = {
        "A <study>\nSolved.\n",
        "  mass of <bar>*  kg    3.50000  1.25000\n  change          -     0        0.500000\n",
        "  k<1>       N/m   50.0000   92.9420         +85.9  -\n",
        "  m          -      1.00000   0.500000       -50.0  lower\n",
        "  The change of k<1> counts as ln(new/original), below 0.0500000 N/m linearly.\n",
        "  The change of m counts linearly, 2.00000 as 1.\n",
        "     1     0.750000     1.00000           1.00000          0\n",
        "at least 1.90000",
        ("\nWhy: what changes\n  - k<1> rises & m falls.\n\nWhy: how it stands\n  - It is the "
         "only one.\n"),
    };
    mt_result *const r = make(t);
    REQUIRE(t, r != NULL);
    mt_text out = {.s = NULL};
    mt_report_summary(r, false, 0, &out);
    CHECK(t, !out.failed && out.s != NULL);
    for (int i = 0; out.s != NULL && i < MT_COUNT(parts); i++) {
        mt_test_row(t, "%s", parts[i]);
        CHECK(t, strstr(out.s, parts[i]) != NULL);
    }
    CHECK(t, out.s != NULL && strstr(out.s, "Published") == NULL);
    mt_text_free(&out);
    mt_report_summary(r, true, 0, &out);
    CHECK(t, out.s != NULL && strstr(out.s, "Published against computed") != NULL);
    CHECK(t, out.s != NULL && strstr(out.s, "FAILS") != NULL);
    mt_text_free(&out);
    mt_result_delete(r);
}

static int count(const char *text, const char *part)
{
    int n = 0;
    for (const char *s = text; s != NULL && (s = strstr(s, part)) != NULL; s++) {
        n++;
    }
    return n;
}

static void check_missing(mt_test *t, const mt_result *r, const char *title, int wanted)
{
    char text[160];
    char page[160];
    mt_text told[2] = {{.s = NULL}, {.s = NULL}};
    (void)snprintf(text, sizeof text, "\n%s\n  not computed: the run was stopped before\n",
                   title);
    (void)snprintf(page, sizeof page, "<h2>%s</h2>\n<p>not computed: the run", title);
    mt_report_summary(r, true, 0, &told[0]);
    mt_report_html_told(r, &told[1]);
    mt_test_row(t, "%s, %d not computed", title, wanted);
    CHECK(t, wanted == 0 || count(told[0].s, text) == 1);
    CHECK(t, wanted == 0 || count(told[1].s, page) == 1);
    CHECK_INT(t, count(told[0].s, "not computed"), wanted);
    CHECK_INT(t, count(told[1].s, "not computed"), wanted);
    mt_text_free(&told[0]);
    mt_text_free(&told[1]);
}

/* Null is not computed, empty is none: of one list after the other, then of the trade study. */
static void sections__that_an_interrupt_cut_say_so(mt_test *t)
{
    static const char *incomplete[] = {"spread", "trade"};
    mt_result *const r = make(t);
    REQUIRE(t, r != NULL);
    check_missing(t, r, "What is proven", 0);
    r->unidentifiable = NULL;
    check_missing(t, r, "Not identifiable: directions along which the goals hardly change", 1);
    r->weight_sensitivity = NULL;
    check_missing(
        t, r,
        "Sensitivity to the weights (the scatter of repeated tests may be many times larger)",
        2);
    r->certificates = NULL;
    check_missing(t, r, "What is proven", 3);
    r->relaxations = NULL;
    check_missing(t, r, "What would make it feasible, one change at a time", 4);
    r->published = NULL;
    r->n_published = 0;
    check_missing(t, r, "Published against computed", 5);
    r->run.incomplete = incomplete;
    r->run.n_incomplete = 2;
    check_missing(t, r, "Trade study: the best design of each point", 6);
    mt_result_delete(r);
}

static void verification__ignores_only_what_is_not_comparable(mt_test *t)
{
    mt_result *const r = make(t);
    int judged = 0;
    REQUIRE(t, r != NULL);
    CHECK(t, !mt_report_verified(r, &judged));
    CHECK_INT(t, judged, 2);
    published[1].holds = true;
    CHECK(t, mt_report_verified(r, NULL));
    r->n_published = 0;
    CHECK(t, mt_report_verified(r, &judged));
    CHECK_INT(t, judged, 0);
    mt_result_delete(r);
}

static void designs__have_the_baseline_first_and_one_column_per_variable(mt_test *t)
{
    mt_result *const r = make(t);
    mt_text out = {.s = NULL};
    REQUIRE(t, r != NULL);
    mt_table designs = mt_report_designs(r);
    mt_table_csv(&designs, &out);
    CHECK_STR(t, out.s,
              "rank,feasible,grade,score,objective mass of <bar>* [kg],change,misfit,"
              "violation_percent,k<1> [N/m],m,held.mode_1_hz,held.mode_2_hz\r\n"
              "0,true,feasible,,1.25,0.5,,,50,1,1,2\r\n"
              "1,true,feasible,,1.25,0.5,,,92.941999999999993,0.5,1,2\r\n");
    mt_text_free(&out);
    mt_table_free(&designs);
    mt_result_delete(r);
}

static mt_result_clearance clearances[] = {
    {"held", "4P of X", 1, 1, 1.0, 20.0, 10.0, "below", 0.0, 0.0},
    {"held", "4P of X", 1, 2, 2.0, 33.0, 10.0, "above", 0.0, 0.0},
    {"held", "8P of X", 1, 2, 2.0, -1.5, 10.0, "inside", 0.0, 0.0},
    {"up", "4P of X", 1, 2, 2.5, 40.0, 10.0, "below", 0.0, 0.0},
};
static mt_result_mode_placement placements[] = {
    {1, "held", "4P of X", 1.25, 1.5, 1.125, 1.65, 1},
    {2, "up", "4P of X", 1.25, 1.5, 1.125, 1.65, 2},
};

/* The sample with bands. */
static mt_result *make_banded(mt_test *t)
{
    mt_result *const r = make(t);
    if (r != NULL) {
        recommendations[0].clearances = clearances;
        recommendations[0].n_clearances = MT_COUNT(clearances);
        recommendations[0].placements = placements;
        recommendations[0].n_placements = MT_COUNT(placements);
        recommendations[0].clearance_percent = -1.5;
        r->baseline = recommendations[0];
        r->baseline.rank = 0;
    }
    return r;
}

static void clearances__stand_in_one_line_per_mode(mt_test *t)
{
    mt_result *const r = make_banded(t);
    mt_text out = {.s = NULL};
    REQUIRE(t, r != NULL);
    mt_table table = mt_report_clearances(recommendations);
    mt_table_csv(&table, &out);
    CHECK_STR(t, out.s,
              "configuration,mode,hz,above_band,above_percent,below_band,below_percent\r\n"
              "held,1,1,,,4P of X,20\r\n"
              "held,2,2,4P of X,33,,\r\n"
              "held,2,2,inside 8P of X,-1.5,,\r\n"
              "up,2,2.5,,,4P of X,40\r\n");
    mt_text_free(&out);
    mt_table_free(&table);
    mt_result_delete(r);
}

static void designs__with_bands_have_clearance_and_assignment(mt_test *t)
{
    mt_result *const r = make_banded(t);
    mt_text out = {.s = NULL};
    REQUIRE(t, r != NULL);
    mt_table designs = mt_report_designs(r);
    mt_table_csv(&designs, &out);
    CHECK(t, out.s != NULL && strstr(out.s, "violation_percent,clearance_percent,"
                                            "gap_assignment,k<1>") != NULL);
    CHECK(t, out.s != NULL &&
                 strstr(out.s, "\r\n1,true,feasible,,1.25,0.5,,,-1.5,1 2,92.9") != NULL);
    mt_text_free(&out);
    mt_table_free(&designs);
    mt_result_delete(r);
}

/* Of two clearances side by side each says which it is. */
static void alternatives__tell_the_objective_from_the_bare_clearance(mt_test *t)
{
    static const char *const headings[] = {"  clearance [%]  modes below", "change  deviation",
                                           "clearance [%]    change",
                                           "without margin [%]  modes"};
    static mt_result_objective best[] = {{"clearance", "clearance", "%"}};
    mt_result *const r = make_banded(t);
    REQUIRE(t, r != NULL);
    recommendations[0].change = 0.25;
    recommendations[0].violation_percent = 0.0;
    for (int i = 0; i < 2; i++) {
        mt_text out = {.s = NULL};
        mt_table table = mt_report_alternatives(r);
        mt_table_print(&table, 0, 0, &out);
        for (int k = 0; k < 2; k++) {
            mt_test_row(t, "%s", headings[2 * i + k]);
            CHECK(t, out.s != NULL && strstr(out.s, headings[2 * i + k]) != NULL);
        }
        mt_text_free(&out);
        mt_table_free(&table);
        r->objectives = best;
        r->n_objectives = 1;
    }
    mt_result_delete(r);
}

/* A design that lists fewer modes of the first configuration must not shift those of the
 * second. */
static void designs__find_frequencies_by_configuration_and_mode(mt_test *t)
{
    mt_result *const r = make(t);
    mt_text out = {.s = NULL};
    REQUIRE(t, r != NULL);
    frequencies[1].configuration = "up";
    r->baseline.frequencies = frequencies;
    recommendations[0].frequencies = &frequencies[1];
    recommendations[0].n_frequencies = 1;
    mt_table designs = mt_report_designs(r);
    mt_table_csv(&designs, &out);
    CHECK(t, out.s != NULL && strstr(out.s, ",0.5,,2\r\n") != NULL);
    mt_text_free(&out);
    mt_table_free(&designs);
    mt_result_delete(r);
}

static void page__is_self_contained_and_escaped(mt_test *t)
{
    mt_result *const r = make(t);
    mt_text out = {.s = NULL};
    REQUIRE(t, r != NULL);
    mt_report_html(r, "{\n  \"na me\": \"</script>  <img>\\\\\"\n}", NULL, &out);
    CHECK(t, !out.failed);
    if (CHECK(t, out.s != NULL)) {
        static const char data[] = "<script type=\"application/json\" id=\"data\">";
        CHECK(t, strstr(out.s, "<title>A &lt;study&gt;</title>") != NULL);
        CHECK_INT(t, count(out.s, "<script"), 2);
        CHECK_INT(t, count(out.s, "</script>"), 2);
        CHECK(t, strstr(out.s, "{\"na me\":\"\\u003c/script>  \\u003cimg>\\\\\"}]</script>") !=
                     NULL); /* white space stays where it is a string's */
        CHECK(t, strstr(out.s, "default-src 'none'") != NULL);
        CHECK(t, strstr(out.s, "; script-src 'sha256-") != NULL);
        CHECK(t, strstr(out.s, "</html>") != NULL);
        char *const begin = strstr(out.s, "<script>");
        const char *const markup = strstr(out.s, "<title>");
        char *const script = strstr(out.s, data);
        if (CHECK(t, begin != NULL && begin < markup && markup < script)) {
            *begin = '\0'; /* what is markup */
            *script = '\0';
            CHECK(t, strstr(markup, "k<1>") == NULL && strstr(markup, "style=") == NULL);
            CHECK(t, strstr(out.s, "src=") == NULL && strstr(markup, "src=") == NULL);
            CHECK_INT(t, count(out.s, "href="), count(out.s, "href=\"data:,\""));
            CHECK_INT(t, count(markup, "href="), 0);
            CHECK(t, strstr(markup, "k&lt;1&gt; rises &amp; m falls.") != NULL);
            CHECK(t, strstr(markup, "nan") == NULL && strstr(markup, "inf\"") == NULL);
        }
    }
    mt_text_free(&out);
    mt_result_delete(r);
}

/* Modes below each band, however many there are: as many as a cell holds, none of them cut. */
static void designs__with_many_bands_have_the_first_of_them(mt_test *t)
{
    enum { BANDS = 400, LIST = 4 * BANDS };
    static const int firsts[] = {0, 10, 100}; /* of one digit more each */
    static mt_result_mode_placement many[BANDS];
    static const size_t room = 120; /* of a cell, its end included */
    mt_result *const r = make(t);
    for (int k = 0; r != NULL && k < MT_COUNT(firsts) * 62; k++) {
        const int n = k / MT_COUNT(firsts) < 61 ? 1 + (k / MT_COUNT(firsts)) : BANDS;
        char list[LIST];
        size_t used = 0;
        size_t kept = 0;
        mt_text out = {.s = NULL};
        for (int i = 0; i < n; i++) {
            const int below = i == 0 ? firsts[k % MT_COUNT(firsts)] : i;
            many[i] = (mt_result_mode_placement){
                .id = i + 1, .configuration = "held", .modes_below = below};
            used += (size_t)snprintf(list + used, sizeof list - used, "%s%d", i == 0 ? "" : " ",
                                     below);
            kept = used < room ? used : kept;
        }
        list[kept] = '\0';
        r->baseline.placements = many;
        r->baseline.n_placements = n;
        recommendations[0].placements = many;
        recommendations[0].n_placements = n;
        mt_test_row(t, "%d bands, the first %d", n, firsts[k % MT_COUNT(firsts)]);
        mt_table table = mt_report_alternatives(r);
        mt_table_csv(&table, &out);
        char cell[LIST + 4];
        (void)snprintf(cell, sizeof cell, ",%s,", list);
        CHECK(t, out.s != NULL && strstr(out.s, cell) != NULL);
        mt_text_free(&out);
        mt_table_free(&table);
    }
    mt_result_delete(r);
}

MT_TEST_MAIN(MT_TEST(alternatives__tell_the_objective_from_the_bare_clearance),
             MT_TEST(sections__that_an_interrupt_cut_say_so),
             MT_TEST(summary__says_status_numbers_and_reasons),
             MT_TEST(verification__ignores_only_what_is_not_comparable),
             MT_TEST(designs__have_the_baseline_first_and_one_column_per_variable),
             MT_TEST(clearances__stand_in_one_line_per_mode),
             MT_TEST(designs__with_many_bands_have_the_first_of_them),
             MT_TEST(designs__with_bands_have_clearance_and_assignment),
             MT_TEST(designs__find_frequencies_by_configuration_and_mode),
             MT_TEST(page__is_self_contained_and_escaped))
