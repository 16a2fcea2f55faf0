/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <float.h>
#include <math.h>

#include "linalg/dense.h"
#include "modal/modal.h"
#include "support/mt_random.h"
#include "support/mt_test.h"

static const double TOL = 1e-13;

static mt_arena mem;

static void mac__is_the_squared_cosine(mt_test *t)
{
    const double a[6] = {1.0, 0.0, 0.0, 3.0, 4.0, 0.0};
    const double b[9] = {-2.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 7.0};
    const double want[6] = {1.0, 9.0 / 25.0, 0.5, 49.0 / 50.0, 0.0, 0.0};
    double mac[6];
    mt_mac_matrix(3, 2, a, 3, b, mac);
    for (int i = 0; i < 6; i++) {
        CHECK_NEAR_ABS(t, mac[i], want[i], 4.0 * DBL_EPSILON);
    }
}

static void mac__does_not_depend_on_size_and_never_exceeds_one(mt_test *t)
{
    static const double sizes[] = {1.0, -1e-200, 1e200, 5e-310};
    mt_random g = mt_random_seed(51);
    for (int trial = 0; trial < 50; trial++) {
        double a[5];
        double b[5];
        double want = 0.0;
        double self = 0.0;
        mt_random_fill(&g, 5, a);
        mt_random_fill(&g, 5, b);
        mt_mac_matrix(5, 1, a, 1, b, &want);
        mt_mac_matrix(5, 1, a, 1, a, &self);
        CHECK(t, self <= 1.0 && self >= 1.0 - TOL);
        for (int k = 0; k < MT_COUNT(sizes); k++) {
            double scaled[5];
            double mac = 0.0;
            mt_test_row(t, "trial %d, size %g", trial, sizes[k]);
            for (int i = 0; i < 5; i++) {
                scaled[i] = sizes[k] * b[i];
            }
            mt_mac_matrix(5, 1, a, 1, scaled, &mac);
            CHECK_NEAR_ABS(t, mac, want, TOL);
        }
    }
}

static void mac__of_a_shape_that_no_sensor_sees_is_no_number(mt_test *t)
{
    const double a[4] = {0.0, 0.0, 1.0, 0.0};
    const double b[4] = {1.0, 1.0, 1.0, nan("")};
    double mac[4];
    int pair[2];
    mt_mac_matrix(2, 2, a, 2, b, mac);
    CHECK(t, isnan(mac[0]) && isnan(mac[2]) && isnan(mac[3]));
    CHECK_NEAR(t, mac[1], 0.5, 1e-15);
    CHECK_INT(t, mt_mac_pair(2, 2, mac, pair, &mem, NULL), MT_OK);
    CHECK_INT(t, pair[0], -1);
    CHECK_INT(t, pair[1], 0);
}

/* The best pairing in total, where taking the best single value first goes wrong. */
static void mac__pairs_by_the_sum(mt_test *t)
{
    const double mac[4] = {0.90, 0.85, 0.80, 0.10};
    int pair[2];
    CHECK_INT(t, mt_mac_pair(2, 2, mac, pair, &mem, NULL), MT_OK);
    CHECK_INT(t, pair[0], 1);
    CHECK_INT(t, pair[1], 0);
}

/* Turning and stretching the shapes inside their span changes single values but no angle
 * between spans. */
static void mac__subspace_is_invariant_under_rotation(mt_test *t)
{
    enum { NS = 7, R = 2 };
    mt_random g = mt_random_seed(52);
    for (int trial = 0; trial < 50; trial++) {
        double a[NS * R];
        double b[NS * R];
        double turned[NS * R];
        double want[R];
        double cos2[R];
        const double angle = mt_random_in(&g, 0.0, 6.28);
        const double turn[4] = {3.0 * cos(angle), 3.0 * sin(angle), -sin(angle), cos(angle)};
        mt_test_row(t, "trial %d", trial);
        mt_random_fill(&g, NS * R, a);
        mt_random_fill(&g, NS * R, b);
        CHECK_INT(t, mt_mac_subspace(NS, R, a, R, b, want, &mem, NULL), MT_OK);
        CHECK(t, want[0] >= want[1] && want[1] >= 0.0 && want[0] <= 1.0);
        mt_gemm(false, false, NS, R, R, 1.0, b, NS, turn, R, 0.0, turned, NS);
        CHECK_INT(t, mt_mac_subspace(NS, R, a, R, turned, cos2, &mem, NULL), MT_OK);
        CHECK_NEAR_ABS(t, cos2[0], want[0], TOL);
        CHECK_NEAR_ABS(t, cos2[1], want[1], TOL);
        CHECK_INT(t, mt_mac_subspace(NS, R, turned, R, b, cos2, &mem, NULL), MT_OK);
        CHECK_NEAR_ABS(t, cos2[0], 1.0, TOL);
        CHECK_NEAR_ABS(t, cos2[1], 1.0, TOL);
    }
    CHECK_INT(t, mem.used, 0);
}

/* (1,0,0),(0,1,0) against (0, cos a, sin a): angle a. One shape each: the ordinary MAC. */
static void mac__subspace_matches_known_angles(mt_test *t)
{
    const double plane[6] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    const double tilted[3] = {0.0, cos(0.3), sin(0.3)};
    double cos2[2] = {0.0, 0.0};
    double mac = 0.0;
    CHECK_INT(t, mt_mac_subspace(3, 2, plane, 1, tilted, cos2, &mem, NULL), MT_OK);
    CHECK_NEAR_ABS(t, cos2[0], cos(0.3) * cos(0.3), TOL);
    CHECK_INT(t, mt_mac_subspace(3, 1, plane + 3, 1, tilted, cos2, &mem, NULL), MT_OK);
    mt_mac_matrix(3, 1, plane + 3, 1, tilted, &mac);
    CHECK_NEAR_ABS(t, cos2[0], mac, TOL);
}

static void mac__subspace_of_dependent_shapes_has_fewer_angles(mt_test *t)
{
    const double same[6] = {1.0, 2.0, 3.0, 2.0, 4.0, 6.0};
    const double plane[6] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    const double zero[6] = {0.0};
    double cos2[2];
    CHECK_INT(t, mt_mac_subspace(3, 2, same, 2, plane, cos2, &mem, NULL), MT_OK);
    CHECK_NEAR_ABS(t, cos2[0], 5.0 / 14.0, TOL);
    CHECK(t, isnan(cos2[1]));
    CHECK_INT(t, mt_mac_subspace(3, 2, zero, 2, plane, cos2, &mem, NULL), MT_OK);
    CHECK(t, isnan(cos2[0]) && isnan(cos2[1]));
    const double bad[3] = {1.0, nan(""), 0.0};
    CHECK_INT(t, mt_mac_subspace(3, 1, bad, 2, plane, cos2, &mem, NULL), MT_E_DOMAIN);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(mac__is_the_squared_cosine),
        MT_TEST(mac__does_not_depend_on_size_and_never_exceeds_one),
        MT_TEST(mac__of_a_shape_that_no_sensor_sees_is_no_number),
        MT_TEST(mac__pairs_by_the_sum),
        MT_TEST(mac__subspace_is_invariant_under_rotation),
        MT_TEST(mac__subspace_matches_known_angles),
        MT_TEST(mac__subspace_of_dependent_shapes_has_fewer_angles),
    };
    const int failed = mt_arena_init(&mem, 0, NULL) != MT_OK
                           ? 1
                           : cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
    mt_arena_free(&mem);
    return failed != 0;
}
