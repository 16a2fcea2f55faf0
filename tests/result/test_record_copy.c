/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A design that is copied beside another one: it says what it said, and what both say is kept
 * once. */
#include <string.h>

#include "result/record.h"
#include "result/result.h"
#include "support/mt_test.h"

enum { VARIABLES = 2 };

/* What a design is made of, each in the memory of the test. */
typedef struct made {
    mt_result_parameter parameters[VARIABLES];
    mt_result_mode_placement placements[2];
    mt_reason reasons[2];
    mt_result_frequency frequencies[1];
    double slopes[VARIABLES];
    mt_result_tolerance tolerances[VARIABLES];
    mt_tolerance_box box;
    mt_recommendation r;
} made;

static void make(made *m)
{
    m->r = mt_recommendation_default();
    for (int i = 0; i < VARIABLES; i++) {
        m->parameters[i] =
            (mt_result_parameter){.name = i == 0 ? "k" : "mass", .recommended = 1.25 * i};
        m->tolerances[i] = (mt_result_tolerance){m->parameters[i].name, 2.5, "an edge"};
        m->placements[i] =
            (mt_result_mode_placement){.id = i + 1, .configuration = "held", .band = "4P"};
        m->slopes[i] = 0.5 + i;
    }
    m->reasons[0] = (mt_reason){"change", NULL, "k rises by 3 %."};
    m->reasons[1] = (mt_reason){"hold", "mass", "mass is at its lower bound."};
    m->frequencies[0] = mt_result_frequency_default();
    m->frequencies[0].configuration = "held";
    m->frequencies[0].sensitivity = m->slopes;
    m->box = (mt_tolerance_box){2.5, "an edge", true, VARIABLES, m->tolerances};
    m->r.rank = 1;
    m->r.grade = "feasible";
    m->r.parameters = m->parameters;
    m->r.n_parameters = VARIABLES;
    m->r.frequencies = m->frequencies;
    m->r.n_frequencies = 1;
    m->r.placements = m->placements;
    m->r.n_placements = 2;
    m->r.reasons = m->reasons;
    m->r.n_reasons = 2;
    m->r.tolerance_box = &m->box;
}

/* All that both hold is the same. */
static bool are_equal(mt_recommendation *a, mt_recommendation *b)
{
    mt_serializer x = {.words = NULL};
    mt_serializer y = {.words = NULL};
    mt_record_serialize(&mt_design_record, a, VARIABLES, &x, NULL);
    mt_record_serialize(&mt_design_record, b, VARIABLES, &y, NULL);
    const bool same = !x.failed && !y.failed && x.n == y.n && x.n > 0 &&
                      memcmp(x.words, y.words, x.n * sizeof *x.words) == 0;
    mt_serializer_free(&x);
    mt_serializer_free(&y);
    return same;
}

typedef void (*change)(made *m);

static void change_nothing(made *m)
{
    (void)m;
}

static void change_number(made *m)
{
    m->parameters[1].recommended = 7.0;
}

static void change_text(made *m)
{
    m->reasons[1].text = "mass is at its upper bound.";
}

static void change_deep_text(made *m)
{
    m->tolerances[1].edge = NULL;
}

static void change_slope(made *m)
{
    m->slopes[1] = -1.0;
}

static void change_count(made *m)
{
    m->placements[1].modes_below = 3;
}

static void change_flag(made *m)
{
    m->box.proven = false;
}

static void leave_item(made *m)
{
    m->r.n_reasons = 1;
}

static void leave_list(made *m)
{
    m->r.placements = NULL;
    m->r.n_placements = 0;
}

static void leave_option(made *m)
{
    m->r.tolerance_box = NULL;
}

static void leave_slopes(made *m)
{
    m->frequencies[0].sensitivity = NULL;
}

static const struct {
    const char *name;
    change by;
} CHANGES[] = {{"nothing", change_nothing},
               {"a number", change_number},
               {"a text", change_text},
               {"a text of a list's list", change_deep_text},
               {"a number by variable", change_slope},
               {"a count", change_count},
               {"a flag", change_flag},
               {"an item less", leave_item},
               {"a list less", leave_list},
               {"an option less", leave_option},
               {"no numbers by variable", leave_slopes}};

static void copy__says_the_same_beside_any_other(mt_test *t)
{
    for (int i = 0; i < MT_COUNT(CHANGES); i++) {
        for (int way = 0; way < 2; way++) {
            made one;
            made other;
            mt_recommendation first;
            mt_recommendation second;
            mt_arena mem = {0};
            mt_err err;
            mt_test_row(t, "%s, %s", CHANGES[i].name, way == 0 ? "second" : "first");
            make(&one);
            make(&other);
            CHANGES[i].by(way == 0 ? &other : &one);
            REQUIRE(t, mt_arena_init(&mem, 0, &err) == MT_OK);
            CHECK_INT(t, mt_recommendation_copy(&one.r, NULL, &mem, &first, &err), MT_OK);
            CHECK_INT(t, mt_recommendation_copy(&other.r, &first, &mem, &second, &err), MT_OK);
            CHECK(t, are_equal(&first, &one.r));
            CHECK(t, are_equal(&second, &other.r));
            CHECK(t, are_equal(&first, &second) == (i == 0));
            mt_arena_free(&mem);
        }
    }
}

static void copy__keeps_once_what_both_say(mt_test *t)
{
    made one;
    made other;
    mt_recommendation first;
    mt_recommendation second;
    mt_arena mem = {0};
    mt_err err;
    make(&one);
    make(&other);
    change_text(&other);
    REQUIRE(t, mt_arena_init(&mem, 0, &err) == MT_OK);
    CHECK_INT(t, mt_recommendation_copy(&one.r, NULL, &mem, &first, &err), MT_OK);
    const size_t alone = mem.used;
    CHECK_INT(t, mt_recommendation_copy(&other.r, &first, &mem, &second, &err), MT_OK);
    CHECK(t, mem.used - alone < alone / 4);
    CHECK(t, second.parameters == first.parameters && second.placements == first.placements);
    CHECK(t, second.tolerance_box == first.tolerance_box && second.grade == first.grade);
    CHECK(t, second.frequencies == first.frequencies);
    CHECK(t, second.reasons != first.reasons && second.reasons != other.reasons);
    CHECK(t, second.reasons[0].text == first.reasons[0].text);
    CHECK(t, second.reasons[1].text != other.reasons[1].text);
    mt_arena_free(&mem);
}

MT_TEST_MAIN(MT_TEST(copy__says_the_same_beside_any_other),
             MT_TEST(copy__keeps_once_what_both_say))
