/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coordinates within bounds: what is off the original or a bound by the rounding of a few
 * operations stands on it, so that it is told as what it is. */
#include <float.h>
#include <math.h>

#include "mt_test.h"
#include "nlp/engine.h"

static void clamp__puts_what_rounding_leaves_on_its_mark(mt_test *t)
{
    static const struct {
        double lower;
        double origin;
        double upper;
    } ranges[] = {{0.1, 0.3, 0.9},  {-7.0, 0.0, 2.0}, {-5.0, -4.0, -3.0},
                  {0.0, 0.5, 1e-3}, {0.2, 0.1, 0.8},  {1.0, 1.0 + 1e-3, 1.0 + 2e-3},
                  {2.0, 2.0, 3.0},  {-1e6, 1e-3, 1e6}};
    static const double off[] = {0.0, 0.25, 1.0, 4.0, 30.0, 60.0}; /* epsilons of the bounds */
    static const double beyond[] = {70.0, 1e3, 1e8};
    for (int r = 0; r < MT_COUNT(ranges); r++) {
        const double lower = ranges[r].lower;
        const double upper = ranges[r].upper;
        const double origin = ranges[r].origin;
        const mt_nlp nlp = {.n = 1, .lower = &lower, .upper = &upper, .origin = &origin};
        const double eps = DBL_EPSILON * fmax(fabs(lower), fabs(upper));
        const bool there = origin >= lower && origin <= upper;
        for (int side = -1; side <= 1; side += 2) {
            for (int k = 0; k < MT_COUNT(off); k++) {
                mt_test_row(t, "range %d, off by %g epsilons", r, side * off[k]);
                CHECK(t, mt_nlp_clamp(&nlp, 0, lower + (side * off[k] * eps)) == lower);
                CHECK(t, mt_nlp_clamp(&nlp, 0, upper + (side * off[k] * eps)) == upper);
                CHECK(t, !there ||
                             mt_nlp_clamp(&nlp, 0, origin + (side * off[k] * eps)) == origin);
            }
        }
        for (int k = 0; k < MT_COUNT(beyond); k++) {
            const double away = beyond[k] * eps;
            mt_test_row(t, "range %d, %g epsilons within", r, beyond[k]);
            CHECK(t, mt_nlp_clamp(&nlp, 0, lower + away) == lower + away);
            CHECK(t, mt_nlp_clamp(&nlp, 0, upper - away) == upper - away);
            CHECK(t, !there || origin == lower ||
                         mt_nlp_clamp(&nlp, 0, origin - away) == origin - away);
            CHECK(t, mt_nlp_clamp(&nlp, 0, lower - away) == lower);
            CHECK(t, mt_nlp_clamp(&nlp, 0, upper + away) == upper);
        }
    }
}

MT_TEST_MAIN(MT_TEST(clamp__puts_what_rounding_leaves_on_its_mark))
