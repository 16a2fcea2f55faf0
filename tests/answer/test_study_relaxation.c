/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where no design exists: the nearest one, and which single number would let one exist. One
 * mass on a spring, m (2 pi f)^2 = k, and the row of two masses, both in closed form. */
#include "study_fixture.h"

static const double TOL = 1e-5;

#define ONE_MASS_OF(mass)                                                                    \
    "{'format': 'modetune-model/1', 'dimension': 2, 'parameters': {'k': 1000, 'm': 1},"      \
    "'bodies': [{'name': 'm1', 'mass_kg': '" mass "', 'centre': [1, 0]}],"                   \
    "'joints': [{'name': 'r1', 'type': 'pin-in-slot', 'bodies': ['ground', 'm1'], 'at': "    \
    "[1, 0], 'axis': [1, 0]}],"                                                              \
    "'springs': [{'name': 's1', 'type': 'axial', 'bodies': ['ground', 'm1'], 'at': [[0, 0]," \
    " [1, 0]], 'stiffness_n_per_m': 'k'}]}"
#define ONE_MASS ONE_MASS_OF("1")
#define RANGE    "'variables': [{'parameter': 'k', 'lower': 800, 'upper': 1200}],"

static double stiffness(double hz)
{
    return 4.0 * STUDY_PI * STUDY_PI * hz * hz;
}

static double frequency(double k)
{
    return study_hz(k);
}

static const mt_relaxation *relaxation(const study_case *c, const char *what)
{
    for (int i = 0; c->result != NULL && i < c->result->n_relaxations; i++) {
        if (strstr(c->result->relaxations[i].what, what) != NULL) {
            return &c->result->relaxations[i];
        }
    }
    return NULL;
}

/* A move that is there, to this value, with this stiffness. */
static void check_move(mt_test *t, const study_case *c, const char *what, double to, double k)
{
    const mt_relaxation *const r = relaxation(c, what);
    if (CHECK(t, r != NULL)) {
        CHECK_NEAR(t, r->to, to, TOL);
        CHECK_NEAR(t, r->design[0], k, TOL);
        CHECK_NEAR(t, r->change_percent, 100.0 * (r->to - r->from) / fabs(r->from), TOL);
        CHECK(t, strstr(r->text, r->what) != NULL);
    } else {
        study_print(c);
    }
}

static void one_mass__every_kind_of_move_is_exact(mt_test *t)
{
    const double low = frequency(800.0);
    const double high = frequency(1200.0);
    static const double HZ = 6.0;
    static const double LOW_HZ = 4.0;
    const struct {
        const char *name;
        const char *goals;
        const char *what[3];
        double to[3];
        double k[3];
        int n; /* moves there are */
    } rows[] = {
        {"at least",
         "{'type': 'frequency', 'mode': 1, 'at_least_hz': 6}",
         {"at_least_hz", "upper bound of k"},
         {high, stiffness(HZ)},
         {1200.0, stiffness(HZ)},
         2},
        {"at most",
         "{'type': 'frequency', 'mode': 1, 'at_most_hz': 4}",
         {"at_most_hz", "lower bound of k"},
         {low, stiffness(LOW_HZ)},
         {800.0, stiffness(LOW_HZ)},
         2},
        {"target",
         "{'type': 'frequency', 'mode': 1, 'target_hz': 6}",
         {"target_hz", "upper bound of k"},
         {high, stiffness(HZ)},
         {1200.0, stiffness(HZ)},
         2},
        {"band",
         "{'type': 'avoid', 'bands_hz': [[4, 6]]}",
         {"upper edge", "lower edge", "upper bound of k"},
         {high, low, stiffness(HZ)},
         {1200.0, 800.0, stiffness(HZ)},
         4},
        {"limit",
         "{'type': 'limit', 'expression': '2*k', 'at_most': 1500}",
         {"at_most of goal /goals/0", "lower bound of k"},
         {1600.0, 750.0},
         {800.0, 750.0},
         2},
        {"equals",
         "{'type': 'limit', 'expression': '2*k', 'equals': 1500}",
         {"equals of goal /goals/0", "lower bound of k"},
         {1600.0, 750.0},
         {800.0, 750.0},
         2},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        study_case c;
        char members[1024];
        mt_test_row(t, "%s", rows[i].name);
        (void)snprintf(members, sizeof members, RANGE "'goals': [%s]", rows[i].goals);
        if (study_solve(t, ONE_MASS, members, &c)) {
            CHECK(t, c.result->status == MT_RESULT_INFEASIBLE ||
                         c.result->status == MT_RESULT_COMPROMISE);
            CHECK_INT(t, c.result->n_relaxations, rows[i].n);
            for (int m = 0; m < 3 && rows[i].what[m] != NULL; m++) {
                check_move(t, &c, rows[i].what[m], rows[i].to[m], rows[i].k[m]);
            }
            /* the nearest design comes with the proof */
            CHECK(t, c.result->n_recommendations > 0);
        }
        study_free(&c);
    }
}

/* Two limits that meet on one frequency leave all designs of it, k/m = (2 pi f)^2: of these the
 * least change is reported, with d = ln((2 pi f)^2 m / k) at the original and weights w
 *     ln k: d w_m / (w_k + w_m),   ln m: -d w_k / (w_k + w_m).
 * Both moves have the size ln(6/4): they come in the order of the question. */
static void equal_moves__least_change_in_the_order_of_the_question(mt_test *t)
{
    static const char *const LEAST = "{'type': 'frequency', 'mode': 1, 'at_least_hz': 6}";
    static const char *const MOST = "{'type': 'frequency', 'mode': 1, 'at_most_hz': 4}";
    static const double WEIGHT[][2] = {{1.0, 1.0}, {1.0, 3.0}, {5.0, 0.5}};
    for (int i = 0; i < 2 * MT_COUNT(WEIGHT); i++) {
        const double *const w = WEIGHT[i / 2];
        const bool swapped = i % 2 == 1;
        study_case c;
        char members[1024];
        mt_test_row(t, "weights %g and %g, %s first", w[0], w[1], swapped ? "most" : "least");
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'k', 'lower': 100, 'upper': 9000, "
                       "'weight': %g}, {'parameter': 'm', 'lower': 0.1, 'upper': 9, 'weight': "
                       "%g}], 'goals': [%s, %s]",
                       w[0], w[1], swapped ? MOST : LEAST, swapped ? LEAST : MOST);
        if (study_solve(t, ONE_MASS_OF("m"), members, &c) &&
            CHECK(t, c.result->n_relaxations >= 2)) {
            for (int k = 0; k < 2; k++) {
                const bool lower = (k == 0) != swapped;
                const double f = lower ? 4.0 : 6.0; /* the other limit */
                const double d = log(stiffness(f) / 1000.0);
                const mt_relaxation *const r = &c.result->relaxations[k];
                CHECK(t, strstr(r->what, lower ? "at_least_hz" : "at_most_hz") != NULL);
                CHECK_NEAR(t, r->to, f, TOL);
                CHECK_NEAR(t, r->design[0], 1000.0 * exp(d * w[1] / (w[0] + w[1])), TOL);
                CHECK_NEAR(t, r->design[1], exp(-d * w[0] / (w[0] + w[1])), TOL);
            }
        }
        study_free(&c);
    }
}

/* From a catalogue every combination is looked at: exact, and no bound to move. */
static void catalogue__goals_and_edges_can_move(mt_test *t)
{
    static const struct {
        const char *name;
        const char *goals;
        const char *what;
        double k; /* of the design that is next */
    } rows[] = {
        {"at least", "{'type': 'frequency', 'mode': 1, 'at_least_hz': 6}", "at_least_hz",
         1200.0},
        {"target", "{'type': 'frequency', 'mode': 1, 'target_hz': 5.1}", "target_hz", 1000.0},
        {"upper edge", "{'type': 'avoid', 'bands_hz': [[4, 6]]}", "upper edge", 1200.0},
        {"lower edge", "{'type': 'avoid', 'bands_hz': [[4, 6]]}", "lower edge", 800.0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        study_case c;
        char members[1024];
        mt_test_row(t, "%s", rows[i].name);
        (void)snprintf(
            members, sizeof members,
            "'variables': [{'parameter': 'k', 'catalogue': [800, 1000, 1200]}], 'goals': [%s]",
            rows[i].goals);
        if (study_solve(t, ONE_MASS, members, &c)) {
            check_move(t, &c, rows[i].what, frequency(rows[i].k), rows[i].k);
            CHECK(t, relaxation(&c, "bound") == NULL);
        }
        study_free(&c);
    }
}

/* Two modes in one band: the upper one is out of it but for the tolerance, the lower one is in
 * its middle whatever is chosen. That the other goal gives way alone is not enough. */
static void catalogue__every_mode_of_a_band_counts(mt_test *t)
{
    char members[1024];
    study_case c;
    const double second = frequency(2000.0);
    (void)snprintf(members, sizeof members,
                   "'variables': [{'parameter': 'k', 'catalogue': [800, 1000, 1200]}],"
                   "'goals': [{'type': 'avoid', 'bands_hz': [[3, %.17g]], 'tolerance_percent': "
                   "1}, {'type': 'frequency', 'mode': 2, 'at_least_hz': 9}]",
                   1.005 * second);
    if (study_solve(t,
                    "{'format': 'modetune-model/1', 'dimension': 2, 'parameters': {'k': 1000},"
                    "'bodies': [{'name': 'm1', 'mass_kg': 1, 'centre': [1, 0]},"
                    "{'name': 'm2', 'mass_kg': 1, 'centre': [2, 0]}],"
                    "'joints': [{'name': 'r1', 'type': 'pin-in-slot', 'bodies': ['ground', "
                    "'m1'], 'at': [1, 0], 'axis': [1, 0]}, {'name': 'r2', 'type': "
                    "'pin-in-slot', 'bodies': ['ground', 'm2'], 'at': [2, 0], 'axis': [1, 0]}],"
                    "'springs': [{'name': 's1', 'type': 'axial', 'bodies': ['ground', 'm1'], "
                    "'at': [[0, 0], [1, 0]], 'stiffness_n_per_m': 'k'}, {'name': 's2', 'type': "
                    "'axial', 'bodies': ['ground', 'm2'], 'at': [[0, 0], [2, 0]], "
                    "'stiffness_n_per_m': 2000}]}",
                    members, &c)) {
        CHECK_INT(t, c.result->n_relaxations, 0);
    }
    study_free(&c);
}

/* One stiffness from a catalogue, one continuous: the greatest of both counts. */
static void catalogue_and_continuous__both_kinds_of_move(mt_test *t)
{
    study_case c;
    const double wanted = 1.1 * study_hz(study_two_lambda(400.0, 500.0, 1.0, -1));
    char members[1024];
    (void)snprintf(members, sizeof members,
                   "'variables': [{'parameter': 'k1', 'catalogue': [200, 300, 400]},"
                   "{'parameter': 'k2', 'lower': 100, 'upper': 500}],"
                   "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': %.17g}]",
                   wanted);
    if (study_solve(t, STUDY_TWO_MASSES("'k1': 300, 'k2': 300, 'm': 1", ""), members, &c)) {
        const mt_relaxation *const goal = relaxation(&c, "at_least_hz");
        const mt_relaxation *const bound = relaxation(&c, "upper bound of k2");
        CHECK(t, relaxation(&c, "k1") == NULL);
        if (CHECK(t, goal != NULL && bound != NULL)) {
            CHECK_NEAR(t, goal->to, wanted / 1.1, TOL);
            CHECK_NEAR(t, goal->design[0], 400.0, 0.0);
            CHECK_NEAR(t, study_hz(study_two_lambda(400.0, bound->to, 1.0, -1)), wanted, TOL);
        }
    }
    study_free(&c);
}

static void solved__has_no_move(mt_test *t)
{
    study_case c;
    if (study_solve(t, ONE_MASS,
                    RANGE "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 5}]",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_INT(t, c.result->n_relaxations, 0);
    }
    study_free(&c);
}

/* Two goals that ask for the opposite: no bound helps, either goal does. */
static void contradiction__only_a_goal_can_move(mt_test *t)
{
    study_case c;
    if (study_solve(t, ONE_MASS,
                    RANGE "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 5.2},"
                          "{'type': 'frequency', 'mode': 1, 'at_most_hz': 4.8}]",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_INFEASIBLE);
        CHECK_INT(t, c.result->n_relaxations, 2);
        check_move(t, &c, "at_least_hz of goal /goals/0", 4.8, stiffness(4.8));
        check_move(t, &c, "at_most_hz of goal /goals/1", 5.2, stiffness(5.2));
        CHECK(t, strstr(c.result->status_text, c.result->relaxations[0].text) != NULL);
    }
    study_free(&c);
}

/* Both stiffnesses raise it. */
static double f1(double k1, double k2)
{
    return study_hz(study_two_lambda(k1, k2, 1.0, -1));
}

/* With upper bound k moved to `to`. */
static double f1_moved(const double *top, int k, double to)
{
    return k == 0 ? f1(to, top[1]) : f1(top[0], to);
}

/* The least upper bound k that lets mode 1 reach `wanted`, by bisection. */
static double least_bound(const double *top, int k, double wanted, double most)
{
    double low = top[k];
    double high = most;
    for (int b = 0; b < 80; b++) {
        const double middle = 0.5 * (low + high);
        *(f1_moved(top, k, middle) >= wanted ? &high : &low) = middle;
    }
    return high;
}

static void check_bounds(mt_test *t, const study_case *c, const double *top, double wanted)
{
    static const char *const what[2] = {"upper bound of k1", "upper bound of k2"};
    for (int k = 0; k < 2; k++) {
        const double most = 10.0 * top[k];
        const double least = least_bound(top, k, wanted, most);
        const mt_relaxation *const r = relaxation(c, what[k]);
        CHECK_INT(t, r != NULL, f1_moved(top, k, most) >= wanted);
        CHECK(t, r == NULL || fabs(r->to - least) <= TOL * least);
    }
}

/* Random boxes and limits of mode 1, which rises with both stiffnesses: the moves follow from
 * the closed form. */
static void two_masses__moves_of_random_studies_are_least(mt_test *t)
{
    enum { STUDIES = 60 };
    unsigned long state = 12345;
    for (int i = 0; i < STUDIES; i++) {
        double u[4];
        char members[1024];
        study_case c;
        for (int k = 0; k < 4; k++) {
            state = (state * 1103515245UL + 12345UL) & 0x7fffffffUL;
            u[k] = (double)state / (double)0x7fffffffUL;
        }
        const double top[2] = {500.0 * (1.0 + u[0]), 500.0 * (1.0 + u[1])};
        const double most = f1(top[0], top[1]);
        const double wanted = most * (1.01 + (0.3 * u[2]));
        mt_test_row(t, "study %d", i);
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'k1', 'lower': 100, 'upper': %.17g},"
                       "{'parameter': 'k2', 'lower': 100, 'upper': %.17g}],"
                       "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': %.17g}]",
                       top[0], top[1], wanted);
        if (study_solve(t, STUDY_TWO_MASSES("'k1': 300, 'k2': 300, 'm': 1", ""), members, &c)) {
            const mt_relaxation *const goal = relaxation(&c, "at_least_hz");
            CHECK_INT(t, c.result->status, MT_RESULT_INFEASIBLE);
            CHECK(t, goal != NULL && fabs(goal->to - most) <= TOL * most);
            check_bounds(t, &c, top, wanted);
        }
        study_free(&c);
    }
}

static bool is_warned(const study_case *c, const char *what)
{
    bool is = false;
    for (int i = 0; i < c->result->n_warnings; i++) {
        is = is || strstr(c->result->warnings[i], what) != NULL;
    }
    return is;
}

/* Whatever the budget is: moves, or why there are none. With variables, and catalogues, and
 * both; a goal, and a band. */
static void budget__moves_or_why_there_are_none(mt_test *t)
{
    static const char *const variables[][2] = {
        {"'lower': 800, 'upper': 1200", "'lower': 0.9, 'upper': 1.1"},
        {"'lower': 800, 'upper': 1200", "'catalogue': [0.9, 1, 1.1]"},
        {"'catalogue': [800, 900, 1000, 1100, 1200]", "'catalogue': [0.9, 1, 1.1]"}};
    static const char *const goals[] = {"{'type': 'frequency', 'mode': 1, 'at_least_hz': 9}",
                                        "{'type': 'avoid', 'bands_hz': [[3, 9]]}"};
    for (int i = 0; i < MT_COUNT(variables) * MT_COUNT(goals); i++) {
        const char *const *const of = variables[i / 2];
        int with = 0;
        int too_few = 0; /* left for the moves, though enough for the search */
        for (long most = 3; most < 20000; most += 1 + (most / 4)) {
            study_case c;
            char members[1024];
            mt_test_row(t, "k %s, m %s, %s, %ld evaluations", of[0], of[1], goals[i % 2], most);
            (void)snprintf(members, sizeof members,
                           "'variables': [{'parameter': 'k', %s}, {'parameter': 'm', %s}], "
                           "'goals': [%s], 'search': {'max_evaluations': %ld}",
                           of[0], of[1], goals[i % 2], most);
            if (study_solve(t, ONE_MASS_OF("m"), members, &c)) {
                const bool ended = is_warned(&c, "budget of evaluations ran out");
                const bool unknown = is_warned(&c, "single change");
                CHECK(t, c.result->n_relaxations > 0 || ended || unknown);
                CHECK(t, c.result->n_relaxations == 0 || !unknown);
                with += c.result->n_relaxations > 0;
                too_few += unknown && !ended;
            }
            study_free(&c);
        }
        CHECK(t, with > 0 && too_few > 0);
    }
}

MT_TEST_MAIN(MT_TEST(one_mass__every_kind_of_move_is_exact), MT_TEST(solved__has_no_move),
             MT_TEST(equal_moves__least_change_in_the_order_of_the_question),
             MT_TEST(contradiction__only_a_goal_can_move),
             MT_TEST(catalogue__goals_and_edges_can_move),
             MT_TEST(catalogue__every_mode_of_a_band_counts),
             MT_TEST(catalogue_and_continuous__both_kinds_of_move),
             MT_TEST(two_masses__moves_of_random_studies_are_least),
             MT_TEST(budget__moves_or_why_there_are_none))
