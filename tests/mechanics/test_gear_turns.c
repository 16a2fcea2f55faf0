/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A wheel on a sprung shaft drives a rotor through a gear of ratio N. Whatever the angle of the
 * shaft,
 *     omega^2 = k / (J_wheel + N^2 J_rotor),
 * also where the rotor has turned by more than half a turn or several whole ones.
 */
#include "mechanics/mech.h"

static const char MODEL[] =
    "{\"format\": \"modetune-model/1\", \"dimension\": 3,"
    " \"parameters\": {\"k\": 30, \"J_wheel\": 0.002, \"J_rotor\": 1e-5, \"N\": 12, \"to\": 1},"
    " \"bodies\": ["
    "  {\"name\": \"wheel\", \"mass_kg\": 1, \"inertia_kg_m2\": [0.001, 0.001, \"J_wheel\"], "
    "\"centre\": [0, 0, 0]},"
    "  {\"name\": \"rotor\", \"mass_kg\": 0.1, \"inertia_kg_m2\": [1e-5, 1e-5, \"J_rotor\"], "
    "\"centre\": [0.1, 0, 0]}],"
    " \"joints\": ["
    "  {\"name\": \"shaft\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"wheel\"], "
    "\"at\": [0, 0, 0], \"axis\": [0, 0, 1]},"
    "  {\"name\": \"motor\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"rotor\"], "
    "\"at\": [0.1, 0, 0], \"axis\": [0, 0, 1]},"
    "  {\"name\": \"gearbox\", \"type\": \"gear\", \"joints\": [\"shaft\", \"motor\"], "
    "\"ratio\": \"N\"}],"
    " \"springs\": [{\"name\": \"servo\", \"type\": \"torsion\", \"joint\": \"shaft\", "
    "\"stiffness_n_m_per_rad\": \"k\"}],"
    " \"configurations\": {\"there\": {\"drive\": {\"joint\": \"shaft\", \"position_rad\": "
    "\"to\", \"hold\": {\"trim\": \"servo\"}}},"
    "  \"half_turn\": {\"like\": \"there\", \"parameters\": {\"to\": \"15*deg\"}},"
    "  \"turns\": {\"like\": \"there\", \"parameters\": {\"to\": -3}},"
    "  \"broken_ratio\": {\"like\": \"there\", \"parameters\": {\"N\": 7.3}}}}";

/* One freedom: only rounding. */
static const double TOL = 1e-12;

static void gear__keeps_its_ratio_over_whole_turns(mt_test *t)
{
    static const struct {
        const char *name;
        double ratio;
    } rows[] = {
        {"there", 12.0},
        {"half_turn", 12.0},
        {"turns", 12.0},
        {"broken_ratio", 7.3},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mech s;
        mt_test_row(t, "%s", rows[i].name);
        if (mech_must(t, mech_parse(t, MODEL), rows[i].name, "", &s)) {
            const double inertia = 0.002 + (rows[i].ratio * rows[i].ratio * 1e-5);
            const double hz = sqrt(30.0 / inertia) / (2.0 * MECH_PI);
            mech_expect(t, &s, 1, &hz, 0, TOL);
        }
        mech_free(&s);
    }
}

MT_TEST_MAIN(MT_TEST(gear__keeps_its_ratio_over_whole_turns))
