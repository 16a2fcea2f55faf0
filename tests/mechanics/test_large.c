/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A system is built in time in proportion to its size: nothing is looked for in lists. No time
 * is measured; what takes time in proportion to the square of the size takes hours here. */
#include "mechanics/mech.h"

enum { ELEMENTS = 200000, HINGE = 123456, TEXT = 2000 };

/* A link whose elements each have a place, hinge and spring of their own, and a spring on one
 * of its hinges, found by its name. */
static void build__long_links_have_all_their_parts(mt_test *t)
{
    char text[TEXT];
    mt_err err = {.text = ""};
    mt_system *sys = NULL;
    (void)snprintf(
        text, sizeof text,
        "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"points\": {\"a\": [0, 0], "
        "\"b\": [%d, 0]}, \"links\": [{\"name\": \"first\", \"from\": \"a\", \"to\": \"b\", "
        "\"elements\": 3, \"mass_kg\": 1, \"stiffness_n_m_per_rad\": 1}, {\"name\": \"l\", "
        "\"from\": \"a\", \"to\": \"b\", "
        "\"elements\": %d, \"mass_kg\": 1, \"stiffness_n_m_per_rad\": 2}], \"springs\": "
        "[{\"name\": \"s\", \"type\": \"torsion\", \"joint\": \"l.h%d\", "
        "\"stiffness_n_m_per_rad\": 5}]}",
        ELEMENTS, ELEMENTS, HINGE);
    mt_model *const model = mech_parse(t, text);
    REQUIRE(t, model != NULL);
    if (CHECK_INT(t, mt_system_new(model, 0, 0, NULL, NULL, &sys, &err), MT_OK)) {
        CHECK_INT(t, sys->n_bodies, ELEMENTS + 3);
        CHECK_INT(t, sys->n_joints, ELEMENTS + 1);
        const mt_spring_def *const s = &sys->springs[sys->n_springs - 1];
        const mt_measure_def *const m = &sys->measures[s->measure[0]];
        char name[32];
        (void)snprintf(name, sizeof name, "l.%d", HINGE);
        CHECK_STR(t, sys->bodies[m->body[0]].name, name);
        CHECK_INT(t, m->body[1], m->body[0] + 1);
    }
    mt_system_delete(sys);
    mt_model_delete(model);
}

MT_TEST_MAIN(MT_TEST(build__long_links_have_all_their_parts))
