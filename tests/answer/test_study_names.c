/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Modes by name: followed by their shape while their order changes, and told where that cannot
 * be done. */
#include "study_fixture.h"

static const double TOL = 1e-6;

#define MASS(i, x) "{'name': 'm" i "', 'mass_kg': 1, 'centre': [" x ", 0]}"
#define RAIL(i, x)                                                              \
    "{'name': 'r" i "', 'type': 'pin-in-slot', 'bodies': ['ground', 'm" i "']," \
    " 'at': [" x ", 0], 'axis': [1, 0]}"
#define SPRING(name, from, x, to, y, k)                                       \
    "{'name': '" name "', 'type': 'axial', 'bodies': ['" from "', '" to "']," \
    " 'at': [[" x ", 0], [" y ", 0]], 'stiffness_n_per_m': '" k "'}"

/* Two masses on springs of their own, weakly coupled: the mode of mass 1 is below that of mass
 * 2 at the original design and above it at the answer. */
/* clang-format off */
#define SIDE_BY_SIDE                                             \
    "{'format': 'modetune-model/1', 'dimension': 2,"             \
    "'parameters': {'ka': 1, 'kb': 4, 'kc': 0.01},"              \
    "'bodies': [" MASS("1", "1") "," MASS("2", "2") "],"         \
    "'joints': [" RAIL("1", "1") "," RAIL("2", "2") "],"         \
    "'springs': ["                                               \
    SPRING("sa", "ground", "0", "m1", "1", "ka") ","             \
    SPRING("sb", "ground", "3", "m2", "2", "kb") ","             \
    SPRING("sc", "m1", "1", "m2", "2", "kc") "],"                \
    "'modes': {'first mass': {'configuration': 'default', 'index': 1}," \
    " 'second mass': {'configuration': 'default', 'index': 2}}}"
/* clang-format on */

static void named_modes__keep_their_names_when_their_order_swaps(mt_test *t)
{
    study_case c;
    /* the targets are the modes of ka = 9, kb = 4 */
    const double half = 0.5 * (9.01 + 4.01);
    const double root = hypot(0.5 * (9.01 - 4.01), 0.01);
    char members[1024];
    (void)snprintf(members, sizeof members,
                   "'variables': [{'parameter': 'ka', 'lower': 0.5, 'upper': 20},"
                   " {'parameter': 'kb', 'lower': 0.5, 'upper': 20}],"
                   "'goals': [{'type': 'frequency', 'mode': 'first mass', 'target_hz': %.17g},"
                   "{'type': 'frequency', 'mode': 'second mass', 'target_hz': %.17g}]",
                   study_hz(half + root), study_hz(half - root));
    if (study_solve(t, SIDE_BY_SIDE, members, &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, study_value(&c, 1, "ka"), 9.0, TOL);
        CHECK_NEAR(t, study_value(&c, 1, "kb"), 4.0, TOL);
        const mt_result_frequency *const low = study_row(&c, 1, "default", 1);
        const mt_result_frequency *const high = study_row(&c, 1, "default", 2);
        if (CHECK(t, low != NULL && high != NULL)) {
            CHECK_STR(t, low->name, "second mass");
            CHECK_STR(t, high->name, "first mass");
            CHECK_NEAR(t, high->target_hz, study_hz(half + root), 1e-15);
            /* a named mode is compared with itself, not with the one that had its index */
            CHECK_NEAR(t, high->original_hz, study_frequency(&c, 0, "default", 1), 1e-15);
        }
        CHECK(t, study_reasons(&c, 1, "default mode 2 (first mass) moves from"));
        CHECK(t, !study_warns(&c, "has lost its shape"));
    }
    study_free(&c);
}

/* clang-format off */
#define THREE_NEARLY_APART                                                   \
    "{'format': 'modetune-model/1', 'dimension': 2,"                         \
    "'parameters': {'k1': 1, 'k2': 4, 'k3': 9},"                             \
    "'bodies': [" MASS("1", "1") "," MASS("2", "2") "," MASS("3", "3") "],"  \
    "'joints': [" RAIL("1", "1") "," RAIL("2", "2") "," RAIL("3", "3") "],"  \
    "'springs': ["                                                           \
    SPRING("k1", "ground", "0", "m1", "1", "k1") ","                         \
    SPRING("k2", "ground", "0", "m2", "2", "k2") ","                         \
    SPRING("k3", "ground", "0", "m3", "3", "k3") ","                         \
    SPRING("c12", "m1", "1", "m2", "2", "0.01") ","                          \
    SPRING("c23", "m2", "2", "m3", "3", "0.01") ","                          \
    SPRING("level1", "ground", "0", "m1", "1", "0.01") ","                   \
    SPRING("level3", "ground", "0", "m3", "3", "0.01") "],"                  \
    "'modes': {'one': {'configuration': 'default', 'index': 1},"             \
    " 'two': {'configuration': 'default', 'index': 2},"                      \
    " 'three': {'configuration': 'default', 'index': 3}}}"
/* clang-format on */

/*
 * Three masses, nearly apart at the original design. Where their own springs are equal the
 * modes are those of a chain: the first mass is (1/4, 1/2, 1/4) of them, the second (1/2, 0,
 * 1/2), the third as the first. Two named modes find a half, the last one is left with a
 * quarter.
 */
static void named_mode__that_is_lost_among_others_is_told(mt_test *t)
{
    study_case c;
    if (study_solve(t, THREE_NEARLY_APART,
                    "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 20},"
                    " {'parameter': 'k3', 'lower': 0.5, 'upper': 20}],"
                    "'goals': [{'type': 'limit', 'expression': 'k1', 'equals': 4},"
                    "{'type': 'limit', 'expression': 'k3', 'equals': 4},"
                    "{'type': 'frequency', 'mode': 'one', 'at_least_hz': 0.1},"
                    "{'type': 'frequency', 'mode': 'two', 'at_least_hz': 0.1},"
                    "{'type': 'frequency', 'mode': 'three', 'at_least_hz': 0.1}]",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_COMPROMISE);
        CHECK(t, study_warns(&c, "mode \"one\" of configuration \"default\" is ambiguous "
                                 "between modes 1 and 2"));
        CHECK(t, c.result->recommendations[0].goals[2].doubtful);
    }
    study_free(&c);
}

MT_TEST_MAIN(MT_TEST(named_modes__keep_their_names_when_their_order_swaps),
             MT_TEST(named_mode__that_is_lost_among_others_is_told))
