/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Equilibria that a trimmed spring holds, or two of them at once, by both ways. A joint that is
 * there twice holds nothing that it does not hold once, but its equations depend on each other:
 * then the way is dense. Of random chains the place, the springs' forces, frequencies and their
 * slopes are the same.
 */
#include "mechanics/mech.h"
#include "support/mt_random.h"

enum { CHAINS = 60, TEXT = 4000, VIBRATIONS = 3 };

/* Of places in model lengths, of forces and frequencies relative; of slopes, relative to a
 * frequency that goes with its parameter. */
static const double SAME = 1e-10;
static const double SLOPES = 1e-8;

static const char ONCE_MORE[] = ", {\"name\": \"again\", \"type\": \"revolute\", \"bodies\": "
                                "[\"ground\", \"c.start\"], \"at\": [0, 0]}";

/* A chain of rigid elements on a driven pin, pulled by its weight and by a spring at its end,
 * where a hand turns, in configuration "both" driven, too. */
static void write_chain(uint64_t seed, bool twice, size_t size, char *text)
{
    mt_random r = mt_random_seed(seed);
    const int elements = 10 + (int)mt_random_in(&r, 0.0, 20.0);
    const double to[2] = {mt_random_in(&r, -1.0, 1.0), mt_random_in(&r, -1.5, -0.5)};
    const double stiffness = pow(10.0, mt_random_in(&r, 1.5, 4.0));
    const double tie = pow(10.0, mt_random_in(&r, 0.0, 2.5));
    const double weight[2] = {mt_random_in(&r, -3.0, 3.0), mt_random_in(&r, -12.0, -3.0)};
    const double place[2] = {mt_random_in(&r, -2.0, 2.0), mt_random_in(&r, -2.0, 0.0)};
    const char *const trim = mt_random_in(&r, 0.0, 1.0) < 0.5 ? "coil" : "tie";
    const double angle = mt_random_in(&r, -0.4, 0.4);
    const char *const other = mt_random_in(&r, 0.0, 1.0) < 0.5 ? "wrist" : "rope";
    (void)snprintf(
        text, size,
        "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"gravity_m_per_s2\": [%.17g, "
        "%.17g], \"parameters\": {\"K\": {\"value\": %.17g, \"unit\": \"N m/rad\"}, \"T\": "
        "{\"value\": %.17g, \"unit\": \"N/m\"}, \"A\": {\"value\": %.17g, \"unit\": \"rad\"}},"
        "\"bodies\": [{\"name\": \"hand\", \"mass_kg\": 0.1, \"inertia_kg_m2\": 0.01, "
        "\"centre\": [%.17g, %.17g]}],"
        "\"links\": [{\"name\": \"c\", \"from\": [0, 0], \"to\": [%.17g, %.17g], \"elements\": "
        "%d, \"mass_kg\": 2, \"stiffness_n_m_per_rad\": \"K\"}],"
        "\"joints\": [{\"name\": \"pin\", \"type\": \"revolute\", \"bodies\": [\"ground\", "
        "\"c.start\"], \"at\": [0, 0]}, {\"name\": \"grip\", \"type\": \"revolute\", "
        "\"bodies\": [\"c.end\", \"hand\"], \"at\": [%.17g, %.17g]}%s],"
        "\"springs\": [{\"name\": \"coil\", \"type\": \"torsion\", \"joint\": \"pin\", "
        "\"stiffness_n_m_per_rad\": 90}, {\"name\": \"tie\", \"type\": \"axial\", \"bodies\": "
        "[\"ground\", \"c.end\"], \"at\": [[%.17g, %.17g], [%.17g, %.17g]], "
        "\"stiffness_n_per_m\": \"T\"}, {\"name\": \"wrist\", \"type\": \"torsion\", "
        "\"joint\": \"grip\", \"stiffness_n_m_per_rad\": 5}, {\"name\": \"rope\", \"type\": "
        "\"axial\", \"bodies\": [\"ground\", \"hand\"], \"at\": [[%.17g, %.17g], [%.17g, "
        "%.17g]], \"stiffness_n_per_m\": 5}],"
        "\"configurations\": {\"held\": {\"drive\": {\"joint\": \"pin\", \"position_rad\": "
        "\"A\", \"hold\": {\"trim\": \"%s\"}}}, \"both\": {\"like\": \"held\", \"drive\": "
        "[{\"joint\": \"grip\", \"position_rad\": \"A/2\", \"hold\": {\"trim\": "
        "\"%s\"}}]}}}",
        weight[0], weight[1], stiffness, tie, angle, to[0] + 0.1, to[1], to[0], to[1], elements,
        to[0], to[1], twice ? ONCE_MORE : "", place[0], place[1], to[0], to[1], to[0] + 1.0,
        to[1] + 0.5, to[0] + 0.1, to[1] + 0.1, trim, other);
}

static const mt_state *state_of(const mech *s)
{
    return mt_linear_position(s->a->lin);
}

static void check_slopes(mt_test *t, mech *once, mech *twice, int index)
{
    double slope[2][MECH_INPUTS];
    mech *const both[2] = {once, twice};
    mt_err err = {.text = ""};
    for (int k = 0; k < 2; k++) {
        const int at = mt_modal_flexible(&both[k]->a->modes, index);
        CHECK(t, mt_analysis_dlambda(both[k]->a, at, slope[k], NULL, &err) == MT_OK);
    }
    const double lambda = pow(2.0 * MECH_PI * mech_hz(once, index), 2.0);
    for (int i = 0; i < once->n; i++) {
        const double unit = lambda / fmax(fabs(once->at[i]), 0.1);
        CHECK(t, fabs(slope[0][i] - slope[1][i]) <= SLOPES * unit);
    }
}

static bool with_slopes(mt_test *t, mech *s)
{
    mt_analysis_options opt = mt_analysis_options_default();
    mt_err err = {.text = ""};
    opt.gradient = true;
    return CHECK(t, mt_analysis_solve(s->a, s->at, &opt, &err) == MT_OK);
}

/* Counts in *found those of which the first was found by sparse equations, and in *stable those
 * that have frequencies. */
static void compare(mt_test *t, mech *once, mech *twice, int *found, int *stable)
{
    const mt_stage *const sparse = &state_of(once)->equilibrium;
    const mt_stage *const dense = &state_of(twice)->equilibrium;
    CHECK(t, !dense->solver.sparse);
    *found += sparse->solver.sparse ? 1 : 0;
    CHECK(t, mt_poses_distance(once->a->sys, state_of(once)->at.pose,
                               state_of(twice)->at.pose) <= SAME);
    for (int i = 0; i < once->a->sys->n_trims; i++) {
        const double force = dense->trim_force.of[i];
        CHECK(t, fabs(sparse->trim_force.of[i] - force) <= SAME * fmax(fabs(force), 1.0));
    }
    const int unstable = once->a->modes.n_unstable; /* a strut that is trimmed may tip over */
    CHECK_INT(t, unstable, twice->a->modes.n_unstable);
    *stable += unstable == 0 ? 1 : 0;
    if (unstable == 0 && with_slopes(t, once) && with_slopes(t, twice)) {
        for (int i = 1; i <= VIBRATIONS; i++) {
            CHECK(t, fabs((mech_hz(once, i) / mech_hz(twice, i)) - 1.0) <= SAME);
            check_slopes(t, once, twice, i);
        }
    }
}

static void border__trimmed_chains_are_the_same_by_both_ways(mt_test *t)
{
    int found = 0;
    int stable = 0;
    int refused = 0;
    for (int seed = 1; seed <= CHAINS; seed++) {
        const char *const posture = seed % 2 == 0 ? "held" : "both";
        char text[TEXT];
        mech once;
        mech twice;
        mt_test_row(t, "chain %d, %s", seed, posture);
        write_chain((uint64_t)seed, false, sizeof text, text);
        const bool first = mech_open(t, mech_parse(t, text), posture, "K T A", &once);
        write_chain((uint64_t)seed, true, sizeof text, text);
        const bool second = mech_open(t, mech_parse(t, text), posture, "K T A", &twice);
        CHECK(t, first == second);
        CHECK_INT(t, (int)once.rc, (int)twice.rc);
        if (first && second) {
            compare(t, &once, &twice, &found, &stable);
        } else {
            refused++;
        }
        mech_free(&once);
        mech_free(&twice);
    }
    CHECK_INT(t, refused, 0);
    CHECK_INT(t, found, CHAINS);
    CHECK(t, stable >= CHAINS - 2);
}

MT_TEST_MAIN(MT_TEST(border__trimmed_chains_are_the_same_by_both_ways))
