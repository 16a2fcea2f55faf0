/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The lowest modes where the last one that is asked for is a repeated one: all of its
 * multiplicity are told, in closed form. Point masses, each on springs of one stiffness along
 * all axes: modes come in threes.
 */
#include "analysis/lowest.h"
#include "mechanics/mech.h"
#include "mt_writer.h"

enum { MASSES = 6, TEXT = 8192, AXES = 3 };

static void write_model(mt_writer *w)
{
    mt_write(w, "{\"format\": \"modetune-model/1\", \"dimension\": 3, "
                "\"parameters\": {\"k\": 1.0}, \"bodies\": [");
    for (int i = 0; i < MASSES; i++) {
        mt_write(w, "%s{\"name\": \"b%d\", \"mass_kg\": 1, \"centre\": [%d, 0, 0]}",
                 i == 0 ? "" : ", ", i, i);
    }
    mt_write(w, "], \"springs\": [");
    for (int i = 0; i < AXES * MASSES; i++) {
        const int b = i / AXES;
        const int axis = i % AXES;
        mt_write(w,
                 "%s{\"name\": \"s%d\", \"type\": \"axial\", \"bodies\": [\"ground\", "
                 "\"b%d\"], \"at\": [[%g, %g, %g], [%d, 0, 0]], "
                 "\"stiffness_n_per_m\": \"%d*k\"}",
                 i == 0 ? "" : ", ", i, b, b + (axis == 0 ? 0.5 : 0.0), axis == 1 ? 0.5 : 0.0,
                 axis == 2 ? 0.5 : 0.0, b, 1 + (b * b));
    }
    mt_write(w, "]}");
}

static void lowest__tells_all_of_a_repeated_mode_that_it_ends_with(mt_test *t)
{
    char text[TEXT];
    mt_writer w = {text, sizeof text, 0};
    write_model(&w);
    for (int count = 1; count <= AXES * (MASSES - 1); count++) {
        mech m;
        mt_lowest *l = NULL;
        mt_err err = {.text = ""};
        mt_test_row(t, "%d modes", count);
        if (mech_must(t, mech_parse(t, text), NULL, "k", &m) &&
            CHECK_INT(t,
                      mt_lowest_new(&(mt_system_def){.model = m.model},
                                    (mt_lowest_want){.count = count}, &l, &err),
                      MT_OK) &&
            CHECK(t, l->way != MT_LOWEST_NONE)) {
            const mt_modes *const found = &l->found.modes;
            CHECK_INT(t, found->count, AXES * ((count + AXES - 1) / AXES));
            for (int i = 0; i < found->count; i++) {
                const int b = i / AXES;
                CHECK_NEAR(t, found->lambda[i], 1.0 + (b * b), 1e-12);
            }
        }
        mt_lowest_delete(l);
        mech_free(&m);
    }
}

MT_TEST_MAIN(MT_TEST(lowest__tells_all_of_a_repeated_mode_that_it_ends_with))
