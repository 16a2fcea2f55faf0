/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * By how much a number moves, and where it has to be for a row to hold, for every kind of
 * number: the two are inverse to each other. A row of value r, short of 0 by -r, is made up for
 * by a move of the size -r, the number being
 *
 *     v0 exp(+-r)  (ratios),   v0 +- r |v0|  (parts),   v0 +- r  (differences, limits of 0 in
 *     their own unit).
 */
#include <math.h>

#include "search/relaxation.h"
#include "support/mt_test.h"

typedef enum limit {
    LEAST,
    MOST,
    BOTH,
    TARGET
} limit; /* BOTH: at_most, its row is the second */

static const struct {
    const char *name;
    mt_goal_measure measure;
    double from;
    double unit; /* 0: of a ratio */
} numbers[] = {
    {"a frequency", MT_MEASURE_RATIO, 40.0, 0.0},
    {"a part", MT_MEASURE_PART, 1500.0, 1500.0},
    {"a part below 0", MT_MEASURE_PART, -0.25, 0.25},
    {"a part of a limit of 0", MT_MEASURE_PART, 0.0, 7.0},
    {"a difference", MT_MEASURE_DIFFERENCE, 0.9, 1.0},
};
static const double SIZE_OF_NOTHING = 7.0; /* mt_requirement.size, for a limit of 0 */
static const double ROUNDING = 1e-13;      /* sizes of 1, numbers of 1e3 */

/* One requirement, its rows, and the number that is moved. */
typedef struct asked {
    mt_goal goal;
    mt_requirement requirement;
    mt_problem p;
    mt_subproblem c;
    mt_workspace w;
    mt_move m;
    mt_row typed[2];
    double rows[2];
    double tol[2];
} asked;

static void ask(asked *a, int number, limit kind)
{
    const double from = numbers[number].from;
    const bool upper = kind == MOST || kind == BOTH;
    *a = (asked){.goal = {.at_least = kind == LEAST  ? from
                                      : kind == BOTH ? from - 1.0
                                                     : nan(""),
                          .at_most = upper ? from : nan("")},
                 .tol = {1e-6, 1e-6}};
    a->requirement = (mt_requirement){.role = kind == TARGET ? MT_ROLE_TARGET : MT_ROLE_LIMIT,
                                      .measure = numbers[number].measure,
                                      .goal = &a->goal,
                                      .equals = kind == TARGET ? from : nan(""),
                                      .size = SIZE_OF_NOTHING};
    a->p = (mt_problem){.requirements = &a->requirement, .n_requirements = 1};
    const mt_row_sense first = kind == TARGET ? MT_EQUAL
                               : kind == MOST ? MT_AT_MOST
                                              : MT_AT_LEAST;
    a->typed[0] = mt_row_init(MT_ROW_GOAL, first);
    a->typed[1] = mt_row_init(MT_ROW_GOAL, MT_AT_MOST);
    a->typed[0].requirement = a->typed[1].requirement = 0;
    const mt_row_block rows = {.n = kind == BOTH ? 2 : 1, .rows = a->typed, .tol = a->tol};
    a->c = (mt_subproblem){.p = &a->p};
    *(kind == TARGET ? &a->c.rows.eq : &a->c.rows.in) = rows;
    a->w = (mt_workspace){.p = &a->p, .c = &a->c};
    a->m =
        (mt_move){.kind = MT_MOVE_GOAL, .upper = upper, .target = kind == TARGET, .from = from};
}

/* The number that the row asks for, in closed form. */
static double wanted(int number, limit kind, double row)
{
    const double off = kind == MOST || kind == BOTH ? -row : row;
    return numbers[number].unit > 0.0 ? numbers[number].from + (off * numbers[number].unit)
                                      : numbers[number].from * exp(off);
}

static void moves__size_and_value_are_inverse(mt_test *t)
{
    static const char *const kinds[] = {"at least", "at most", "at most, of two", "target"};
    static const double missing[] = {1e-5, 0.01, 0.3, 0.999, 2.3};
    for (int i = 0; i < MT_COUNT(numbers); i++) {
        for (int k = 0; k < MT_COUNT(kinds); k++) {
            for (int r = 0; r < 2 * MT_COUNT(missing); r++) {
                const double row = r % 2 == 0 ? -missing[r / 2] : missing[r / 2];
                asked a;
                ask(&a, i, (limit)k);
                mt_test_row(t, "%s, %s, row %g", numbers[i].name, kinds[k], row);
                a.rows[a.c.rows.in.n > 1 ? 1 : 0] = row;
                const mt_nlp_values v = {.eq = a.rows, .in = a.rows};
                const double to = mt_relaxation_value(&a.w, &a.m, &v);
                const double size = mt_relaxation_size(&a.p, &a.m, to);
                CHECK_NEAR(t, to, wanted(i, (limit)k, row), ROUNDING);
                if (k == TARGET || row < 0.0) {
                    CHECK_NEAR(t, size, fabs(row), ROUNDING * (1.0 + fabs(a.m.from)) / 1e-5);
                } else {
                    CHECK(t, isnan(size)); /* it holds: there is nothing to move */
                }
            }
        }
    }
}

/* Another row that does not hold is not mended by moving this number. */
static void moves__another_row_in_the_way_is_none(mt_test *t)
{
    static const struct {
        double other;
        bool moves;
    } rows[] = {{0.5, true}, {0.0, true}, {-0.9e-6, true}, {-1.1e-6, false}, {-0.5, false}};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        asked a;
        ask(&a, 0, BOTH);
        mt_test_row(t, "the other row %g", rows[i].other);
        a.rows[0] = rows[i].other;
        a.rows[1] = -0.25;
        const mt_nlp_values v = {.eq = a.rows, .in = a.rows};
        const double to = mt_relaxation_value(&a.w, &a.m, &v);
        CHECK(t, rows[i].moves ? fabs(to - (40.0 * exp(0.25))) <= 40.0 * ROUNDING : isnan(to));
    }
}

/* Edges of bands are frequencies; a lower one gives way upwards. Beyond a factor of ten nothing
 * is a help, nor is a move of nothing. */
static void moves__edges_give_way_into_the_band(mt_test *t)
{
    static const struct {
        const char *name;
        bool upper;
        double to;
        double size; /* NaN: none */
    } rows[] = {
        {"a lower edge upwards", false, 60.0, 0.40546510810816438}, /* ln 1.5 */
        {"a lower edge downwards", false, 30.0, (double)NAN},
        {"an upper edge downwards", true, 30.0, 0.28768207245178090}, /* ln 4/3 */
        {"an upper edge upwards", true, 60.0, (double)NAN},
        {"hardly ten times", false, 399.9, 2.302335061738836},
        {"more than ten times", false, 400.1, (double)NAN},
        {"hardly a tenth", true, 4.001, 2.302335124238838},
        {"less than a tenth", true, 3.999, (double)NAN},
        {"where it is", false, 40.0, (double)NAN},
        {"where it is, the upper one", true, 40.0, (double)NAN},
    };
    const mt_problem p = {0};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const mt_move m = {.kind = MT_MOVE_EDGE, .upper = rows[i].upper, .from = 40.0};
        const double size = mt_relaxation_size(&p, &m, rows[i].to);
        mt_test_row(t, "%s", rows[i].name);
        CHECK(t, isnan(rows[i].size) ? isnan(size) : fabs(size - rows[i].size) <= 1e-12);
    }
}

/* Of moves of one number the least counts, of equal ones that of less change. */
static void moves__the_least_is_kept(mt_test *t)
{
    static const struct {
        double size[2];
        double change[2];
        bool second; /* takes the first one's place */
    } rows[] = {{{0.2, 0.1}, {1.0, 9.0}, true},
                {{0.1, 0.2}, {9.0, 1.0}, false},
                {{0.1, 0.1}, {9.0, 1.0}, true},
                {{0.1, 0.1}, {1.0, 9.0}, false},
                {{0.1, 0.1}, {1.0, 1.0}, false}};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        double x[2] = {0.0, 0.0};
        mt_move own = {.order = 3, .x = &x[0]};
        mt_moves to = {.n = 1, .items = &own};
        mt_test_row(t, "row %d", i);
        for (int k = 0; k < 2; k++) {
            double at = k + 1.0;
            mt_move one = {.order = 3,
                           .found = true,
                           .size = rows[i].size[k],
                           .change = rows[i].change[k],
                           .to = 10.0 * (k + 1.0),
                           .x = &at};
            const mt_moves from = {.n = 1, .items = &one};
            mt_relaxation_merge(&to, &from, 1);
            one.order = 4; /* another number */
            one.size = 0.0;
            mt_relaxation_merge(&to, &from, 1);
        }
        CHECK(t, own.found && x[0] == (rows[i].second ? 2.0 : 1.0));
        CHECK(t, own.to == (rows[i].second ? 20.0 : 10.0));
        CHECK(t, own.size == rows[i].size[rows[i].second ? 1 : 0]);
    }
}

MT_TEST_MAIN(MT_TEST(moves__size_and_value_are_inverse),
             MT_TEST(moves__another_row_in_the_way_is_none),
             MT_TEST(moves__edges_give_way_into_the_band), MT_TEST(moves__the_least_is_kept))
