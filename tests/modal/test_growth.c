/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What grows by itself: poles against the axis, and matrices that can push nothing on. */
#include <math.h>

#include "modal/damped.h"
#include "support/mt_test.h"

static const double EPS = 2.220446049250313e-16;

static double complex at(double re, double im)
{
    return re + (im * (double complex)I);
}

static void growth__of_poles(mt_test *t)
{
    const struct {
        const char *name;
        double complex s[3];
        double rounding;
        int growing;
    } rows[] = {
        {"all decay", {at(-1.0, 0.0), at(-1e-9, 7.0), at(-0.1, -7.0)}, 0.0, -1},
        {"on the axis", {at(0.0, 7.0), at(0.0, 0.0), at(0.0, -7.0)}, 0.0, -1},
        {"rounding of the pole", {at(60.0 * EPS * 7.0, 7.0), -1.0, -1.0}, 0.0, -1},
        {"above rounding of the pole", {-1.0, at(70.0 * EPS * 7.0, 7.0), -1.0}, 0.0, 1},
        {"rounding of the solver", {at(1e-10, 7.0), -1.0, -1.0}, 1e-9, -1},
        {"above that of the solver", {at(1e-8, 7.0), -1.0, -1.0}, 1e-9, 0},
        {"the fastest of two", {at(0.1, 7.0), at(0.2, 3.0), at(0.3, -3.0)}, 0.0, 1},
        {"without oscillation", {-1.0, -1.0, at(1e-3, 0.0)}, 0.0, 2},
        {"images alone", {at(0.1, -7.0), at(0.2, -3.0), -1.0}, 0.0, -1},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].name);
        CHECK_INT(t, mt_modal_growing_pole(3, rows[i].s, rows[i].rounding), rows[i].growing);
    }
    CHECK_INT(t, mt_modal_growing_pole(0, NULL, 0.0), -1);
}

/* Lower triangles of [[a, b], [b, c]]: the upper one must not be read. */
static void growth__needs_a_negative_direction(mt_test *t)
{
    static const struct {
        const char *name;
        double c[3];
        double h[3];
        bool passive;
    } rows[] = {
        {"nothing damps", {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, true},
        {"both damped", {1.0, 0.5, 1.0}, {0.0, 0.0, 0.0}, true},
        {"one damped, exactly", {1.0, 1.0, 1.0}, {0.0, 0.0, 0.0}, true},
        {"a negative damper", {1.0, 0.0, -1e-6}, {0.0, 0.0, 0.0}, false},
        {"a coupling that pushes on", {1.0, 1.001, 1.0}, {0.0, 0.0, 0.0}, false},
        {"structural alone", {0.0, 0.0, 0.0}, {2.0, 1.0, 2.0}, true},
        {"structural pushes on", {1.0, 0.0, 1.0}, {1.0, 0.0, -1.0}, false},
    };
    mt_arena mem = {0};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const double *const c = rows[i].c;
        const double *const h = rows[i].h;
        const double full_c[] = {c[0], c[1], nan(""), c[2]};
        const double full_h[] = {h[0], h[1], nan(""), h[2]};
        bool passive = !rows[i].passive;
        mt_test_row(t, "%s", rows[i].name);
        CHECK_INT(t, mt_modal_is_passive(2, full_c, full_h, &mem, &passive, NULL), MT_OK);
        CHECK_INT(t, passive, rows[i].passive);
    }
    bool passive = false;
    CHECK_INT(t, mt_modal_is_passive(2, NULL, NULL, &mem, &passive, NULL), MT_OK);
    CHECK(t, passive);
    mt_arena_free(&mem);
}

MT_TEST_MAIN(MT_TEST(growth__of_poles), MT_TEST(growth__needs_a_negative_direction))
