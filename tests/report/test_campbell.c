/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Campbell diagrams of results built by hand: what is marked is what crosses within the
 * operating range. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "mt_random.h"
#include "mt_test.h"
#include "report/campbell.h"
#include "report/summary.h"

enum { ORDERS = 6, MODES = 4, LABEL = 16 };

typedef struct sample {
    mt_result *result;
    mt_result_excitation excitation;
    mt_result_order orders[ORDERS];
    char labels[ORDERS][LABEL];
    const char *configurations[1];
    mt_result_frequency frequencies[MODES + 1];
    mt_recommendation recommendation;
} sample;

/* An engine from 10 to 50 turns per second; modes before and after anywhere, one of another
 * configuration. */
static bool begin(mt_test *t, mt_random *random, sample *s)
{
    *s = (sample){.result = NULL};
    if (!CHECK_INT(t, mt_result_new(&s->result, NULL), MT_OK)) {
        return false;
    }
    for (int i = 0; i < ORDERS; i++) {
        s->orders[i].order = 0.5 * (double)(i + 1);
        (void)snprintf(s->labels[i], LABEL, "%gE", s->orders[i].order);
        s->orders[i].label = s->labels[i];
    }
    s->configurations[0] = "held";
    s->excitation = (mt_result_excitation){.pointer = "/goals/0",
                                           .name = "engine <1>",
                                           .speed_lower_hz = 10.0,
                                           .speed_upper_hz = 50.0,
                                           .margin_percent = 5.0,
                                           .n_configurations = 1,
                                           .configurations = s->configurations,
                                           .n_orders = ORDERS,
                                           .orders = s->orders};
    for (int i = 0; i <= MODES; i++) {
        s->frequencies[i] = mt_result_frequency_default();
        s->frequencies[i].configuration = i < MODES ? "held" : "other";
        s->frequencies[i].mode = i + 1;
        s->frequencies[i].original_hz = mt_random_in(random, 1.0, 150.0);
        s->frequencies[i].recommended_hz = mt_random_in(random, 1.0, 150.0);
    }
    s->recommendation = mt_recommendation_default();
    s->recommendation.n_frequencies = MODES + 1;
    s->recommendation.frequencies = s->frequencies;
    s->result->n_recommendations = 1;
    s->result->recommendations = &s->recommendation;
    s->result->n_excitations = 1;
    s->result->excitations = &s->excitation;
    return true;
}

static int count(const char *text, const char *part)
{
    int n = 0;
    for (const char *s = text; s != NULL && (s = strstr(s, part)) != NULL; s += strlen(part)) {
        n++;
    }
    return n;
}

static int crossings(double hz)
{
    int n = 0;
    for (int i = 0; i < ORDERS; i++) {
        n += hz >= 5.0 * (double)(i + 1) && hz <= 25.0 * (double)(i + 1) ? 1 : 0;
    }
    return n;
}

static void campbell__marks_what_crosses_in_the_range(mt_test *t)
{
    mt_random random = mt_random_seed(12);
    for (int k = 0; k < 50; k++) {
        sample s;
        mt_text out = {.s = NULL};
        int before = 0;
        int after = 0;
        mt_test_row(t, "sample %d", k);
        if (!begin(t, &random, &s)) {
            continue;
        }
        for (int i = 0; i < MODES; i++) {
            before += crossings(s.frequencies[i].original_hz);
            after += crossings(s.frequencies[i].recommended_hz);
        }
        mt_report_svg_campbell(s.result, &out);
        CHECK(t, !out.failed);
        CHECK_INT(t, count(out.s, " before at "), before);
        CHECK_INT(t, count(out.s, " after at "), after);
        CHECK_INT(t, count(out.s, "<polygon"), ORDERS);
        CHECK_INT(t, count(out.s, "engine &lt;1&gt;"), 1);
        CHECK_INT(t, count(out.s, "speed [1/min]") + count(out.s, "frequency [Hz]"), 2);
        CHECK_INT(t, count(out.s, "operating range, 600 to 3000/min"), 1);
        CHECK_INT(t, count(out.s, "with their margin of 5 %"), 1);
        CHECK_INT(t, count(out.s, "=\"nan") + count(out.s, "nan,") + count(out.s, "inf"), 0);
        mt_text_free(&out);
        mt_result_delete(s.result);
    }
}

static void campbell__is_there_without_a_design_and_absent_without_a_machine(mt_test *t)
{
    mt_random random = mt_random_seed(13);
    mt_text out = {.s = NULL};
    sample s;
    REQUIRE(t, begin(t, &random, &s));
    s.result->n_recommendations = 0;
    s.result->baseline = s.recommendation;
    s.excitation.margin_percent = 0.0;
    s.frequencies[0].recommended_hz = nan("");
    mt_report_svg_campbell(s.result, &out);
    CHECK_INT(t, count(out.s, "<svg"), 1);
    CHECK_INT(t, count(out.s, " before at ") + count(out.s, "<polygon"), 0);
    CHECK_INT(t, count(out.s, "modes as they are"), 1);
    CHECK_INT(t, count(out.s, "=\"nan") + count(out.s, "nan,"), 0);
    mt_text_free(&out);
    s.excitation.speed_upper_hz = nan(""); /* nothing to draw */
    mt_report_svg_campbell(s.result, &out);
    CHECK_INT(t, count(out.s, "<svg"), 0);
    s.result->n_excitations = 0;
    mt_report_svg_campbell(s.result, &out);
    CHECK_STR(t, out.s, NULL);
    mt_result_delete(s.result);
}

/* A result file may say so: its line lies on the axis, or below it, and meets nothing. */
static void campbell__an_order_of_0_meets_nothing(mt_test *t)
{
    mt_random random = mt_random_seed(14);
    mt_text out = {.s = NULL};
    sample s;
    REQUIRE(t, begin(t, &random, &s));
    for (int i = 0; i < ORDERS; i++) {
        s.orders[i].order = i == 0 ? 1.0 : i == 1 ? 0.0 : -1.0;
    }
    s.frequencies[0].original_hz = 0.0;
    s.frequencies[1].original_hz = 20.0;
    mt_report_svg_campbell(s.result, &out);
    CHECK_INT(t, count(out.s, "<svg"), 1);
    CHECK(t, count(out.s, " before at ") <= MODES);
    CHECK_INT(t, count(out.s, "=\"nan") + count(out.s, "nan,") + count(out.s, "inf"), 0);
    mt_text_free(&out);
    mt_result_delete(s.result);
}

MT_TEST_MAIN(MT_TEST(campbell__an_order_of_0_meets_nothing),
             MT_TEST(campbell__marks_what_crosses_in_the_range),
             MT_TEST(campbell__is_there_without_a_design_and_absent_without_a_machine))
