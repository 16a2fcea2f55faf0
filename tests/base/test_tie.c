/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

#include "base/base.h"
#include "base/number.h"
#include "support/mt_test.h"

static void tie__what_rounding_tells_apart_is_equal(mt_test *t)
{
    static const struct {
        const char *name;
        double a;
        double b;
        bool exceeds;
    } rows[] = {
        {"more", 1.0 + 1e-5, 1.0, true},
        {"less", 1.0, 1.0 + 1e-5, false},
        {"equal", 1.0, 1.0, false},
        {"rounding", 1.0 + 1e-12, 1.0, false},
        {"rounding of what is small", 1e-30 * (1.0 + 1e-12), 1e-30, false},
        {"more of what is small", 2e-30, 1e-30, true},
        {"negative", -1.0, -1.0 - 1e-5, true},
        {"rounding of what is negative", -1.0, -1.0 - 1e-12, false},
        {"more than nothing", 1e-300, 0.0, true},
        {"infinite", HUGE_VAL, 1.0, true},
        {"both infinite", HUGE_VAL, HUGE_VAL, false},
        {"more than minus infinite", 1.0, -HUGE_VAL, true},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].name);
        CHECK(t, mt_exceeds(rows[i].a, rows[i].b) == rows[i].exceeds);
        CHECK(t, !(mt_exceeds(rows[i].a, rows[i].b) && mt_exceeds(rows[i].b, rows[i].a)));
    }
    mt_test_row(t, "no number");
    CHECK(t, !mt_exceeds(nan(""), 1.0) && !mt_exceeds(1.0, nan("")));
}

static void tie__noise_is_nothing(mt_test *t)
{
    CHECK(t, mt_without_noise(3e-11, MT_RATIO_NOISE) == 0.0);
    CHECK(t, mt_without_noise(-3e-11, MT_RATIO_NOISE) == 0.0);
    CHECK(t, mt_without_noise(-3e-9, MT_RATIO_NOISE) == -3e-9);
    CHECK(t, isnan(mt_without_noise(nan(""), MT_PERCENT_NOISE)));
}

MT_TEST_MAIN(MT_TEST(tie__what_rounding_tells_apart_is_equal), MT_TEST(tie__noise_is_nothing))
