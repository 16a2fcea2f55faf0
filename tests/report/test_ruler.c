/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where marks stand on the ruler of frequencies: by their column. */
#include <math.h>
#include <string.h>

#include "mt_test.h"
#include "report/design.h"

enum { MODES = 3 };

/* Three modes of "held": 5 to 10, 20 to 30, 900 Hz; a band from 14 to 16, margin 12 to 18. */
static mt_recommendation make(mt_result_frequency f[MODES], mt_result_mode_placement *gap)
{
    static const double hz[MODES][2] = {{5.0, 10.0}, {20.0, 30.0}, {900.0, 900.0}};
    mt_recommendation r = mt_recommendation_default();
    for (int i = 0; i < MODES; i++) {
        f[i] = mt_result_frequency_default();
        f[i].configuration = "held";
        f[i].mode = i + 1;
        f[i].original_hz = hz[i][0];
        f[i].recommended_hz = hz[i][1];
    }
    *gap = (mt_result_mode_placement){.configuration = "held",
                                      .lower_hz = 14.0,
                                      .upper_hz = 16.0,
                                      .margin_lower_hz = 12.0,
                                      .margin_upper_hz = 18.0};
    r.rank = 1;
    r.frequencies = f;
    r.n_frequencies = MODES;
    r.placements = gap;
    r.n_placements = 1;
    return r;
}

/* The frequency that a column of the first line stands for, read off the scale below it. */
static double hz_at(const char *ruler, const char *at)
{
    const char *const scale = strchr(ruler, '\n') + 1;
    const char *const zero = strchr(scale, '0');
    const char *const ten = strstr(scale, "10");
    const long column = at - ruler - (zero - scale);
    return 10.0 * (double)column / (double)(ten - zero);
}

static void ruler__has_every_mark_at_its_place(mt_test *t)
{
    mt_result_frequency f[MODES];
    mt_result_mode_placement gap;
    mt_recommendation r = make(f, &gap);
    r.frequencies[1].target_hz = 33.0;
    for (int width = 0; width <= 200; width += 50) {
        mt_text out = {.s = NULL};
        mt_test_row(t, "width %d", width);
        mt_report_ruler(&r, width, &out);
        REQUIRE(t, out.s != NULL && !out.failed);
        const struct {
            const char *mark;
            double hz;
        } rows[] = {{"o", 5.0},  {"1", 10.0}, {"2", 30.0},
                    {"|", 33.0}, {"#", 14.0}, {"-", 12.0}};
        for (int i = 0; i < MT_COUNT(rows); i++) {
            const char *const at = strstr(out.s, rows[i].mark);
            mt_test_row(t, "width %d, mark %s", width, rows[i].mark);
            CHECK(t, at != NULL && at < strchr(out.s, '\n'));
            CHECK(t, at != NULL && fabs(hz_at(out.s, at) - rows[i].hz) < 1.3);
        }
        CHECK(t, strstr(out.s, " >1\n") != NULL); /* 900 Hz lies beyond */
        CHECK(t,
              strstr(out.s, "digits: modes, o: before, #: band, -: its margin, |: target\n") !=
                  NULL);
        mt_text_free(&out);
    }
}

/* A band that begins next to the modes and has no end to speak of leaves them their places. */
static void ruler__ends_within_a_band_that_goes_far_beyond(mt_test *t)
{
    mt_result_frequency f[MODES];
    mt_result_mode_placement gap;
    mt_recommendation r = make(f, &gap);
    mt_text out = {.s = NULL};
    r.n_frequencies = 2;
    r.placements[0].upper_hz = 5000.0;
    r.placements[0].margin_upper_hz = 6000.0;
    r.frequencies[1].target_hz = 33.0;
    mt_report_ruler(&r, 100, &out);
    REQUIRE(t, out.s != NULL && !out.failed);
    const char *const end = strchr(out.s, '\n');
    const char *const target = strchr(out.s, '|');
    CHECK(t, target != NULL && target < end && fabs(hz_at(out.s, target) - 33.0) < 1.3);
    mt_text_free(&out);
}

static void ruler__is_not_drawn_where_nothing_is_asked(mt_test *t)
{
    mt_result_frequency f[MODES];
    mt_result_mode_placement gap;
    mt_recommendation r = make(f, &gap);
    mt_text out = {.s = NULL};
    r.n_placements = 0;
    mt_report_ruler(&r, 0, &out);
    CHECK(t, out.s == NULL && !out.failed);
    r.frequencies[0].target_hz = nan("");
    r.frequencies[1].at_least_hz = HUGE_VAL;
    mt_report_ruler(&r, 0, &out);
    CHECK(t, out.s == NULL && !out.failed);
}

MT_TEST_MAIN(MT_TEST(ruler__has_every_mark_at_its_place),
             MT_TEST(ruler__ends_within_a_band_that_goes_far_beyond),
             MT_TEST(ruler__is_not_drawn_where_nothing_is_asked))
