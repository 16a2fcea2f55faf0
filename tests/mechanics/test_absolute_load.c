/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Geometric stiffness of a body between two pairs of prestressed springs that balance, in the
 * plane, without joints: with tensions T along x and S along y and lengths of 0.3 each is
 *     2 S / 0.3  along x,   2 T / 0.3  along y,   0 between them,
 * and no entry is told more exactly than its own rounding.
 */
#include <float.h>

#include "mech.h"
#include "mechanics/absolute.h"

#define SPRING(name, x, y, tension)                                                           \
    "{\"name\": \"" name "\", \"type\": \"axial\", \"bodies\": [\"ground\", \"b\"], \"at\": " \
    "[[" x ", " y "], [0, 0]], \"stiffness_n_per_m\": 1000, \"preload_n\": \"" tension "\"}"

static void absolute_load__is_told_no_more_exactly_than_it_is(mt_test *t)
{
    static const double length = 0.3;
    static const double along[2] = {7.0, 11.0}; /* T and S */
    static const double most = 1e-12; /* of an entry: what 16 roundings are far below */
    mech s;
    mt_arena mem = {0};
    mt_absolute o;
    mt_absolute_load load = {.mu = NULL};
    mt_err err = {.text = ""};
    char why[MT_ABSOLUTE_WHY] = "";
    bool is = false;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    REQUIRE(
        t, mech_must(
               t,
               mech_parse(t, "{\"format\": \"modetune-model/1\", \"dimension\": 2, "
                             "\"parameters\": {\"T\": 7, \"S\": 11}, \"bodies\": "
                             "[{\"name\": \"b\", \"mass_kg\": 1, "
                             "\"inertia_kg_m2\": 1, \"centre\": [0, 0]}], "
                             "\"springs\": [" SPRING("e", "0.3", "0", "T") ", " SPRING(
                                 "w", "-0.3", "0",
                                 "T") ", " SPRING("n", "0", "0.3",
                                                  "S") ", " SPRING("s", "0", "-0.3", "S") "]}"),
               NULL, "T S", &s));
    const mt_system *const sys = s.a->sys;
    REQUIRE(t, mt_absolute_new(sys, s.at, NULL, &mem, &o, &is, why, &err) == MT_OK && is);
    REQUIRE(t, o.a.n_rows == 0);
    load.mu = mt_arena_f64(&mem, 1, 1);
    load.open = mt_arena_f64(&mem, 1, 1);
    REQUIRE(t, mt_absolute_load_new(&o, s.at, &mem, &load, &is, why, &err) == MT_OK && is);
    double g[3][3] = {{0.0}};
    for (int j = 0; j < load.g.n; j++) {
        for (int i = load.g.start[j]; i < load.g.start[j + 1]; i++) {
            const double value = load.g.value[i];
            REQUIRE(t, j < 3 && load.g.row[i] < 3);
            g[load.g.row[i]][j] += value;
            mt_test_row(t, "row %d, column %d", load.g.row[i], j);
            CHECK(t, load.noise[i] >= DBL_EPSILON * fabs(value));
            CHECK(t, load.noise[i] <= most * (2.0 * along[1] / length));
        }
    }
    CHECK_NEAR(t, g[0][0], 2.0 * along[1] / length, 1e-14);
    CHECK_NEAR(t, g[1][1], 2.0 * along[0] / length, 1e-14);
    CHECK_NEAR_ABS(t, g[1][0], 0.0, 1e-13);
    mech_free(&s);
    mt_arena_free(&mem);
}

MT_TEST_MAIN(MT_TEST(absolute_load__is_told_no_more_exactly_than_it_is))
