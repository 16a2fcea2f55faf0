/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Least changes of gap assignments: no design within the bounds changes less than what its
 * assignment is said to take, and what is said to have no design has none. Designs drawn at
 * random about the original of a row of three masses, near and far, with springs and masses as
 * variables, weights, a linear measure, bounds that leave the original out, and a limit. The
 * list holds whatever the bounds allow, the least first. Estimates have a closed form where all
 * modes move alike: the product of the eigenvalues of a row is that of its springs over its
 * masses, so that slopes of all modes add up to 1/2 for each spring, and the least change that
 * raises all by the same part is that of all springs alike.
 */
#include "prove/certify.h"
#include "search/mode_placements_bounds.h"
#include "study_fixture.h"
#include "support/mt_random.h"

enum { SAMPLES = 3000, LISTED = 4000 };
static const double WORK = 5e7;
static const double SAME = 1e-12;
static const double LIMIT = 1.9; /* Hz, of mode 1 in the last row */

#define ROW                                                                              \
    "{'format': 'modetune-model/1', 'dimension': 2,"                                     \
    "'parameters': {'k1': 900, 'k2': 500, 'k3': 700, 'm1': 1, 'm2': 2},"                 \
    "'bodies': [{'name': 'a', 'mass_kg': 'm1', 'inertia_kg_m2': 1, 'centre': [1, 0]},"   \
    "{'name': 'b', 'mass_kg': 'm2', 'inertia_kg_m2': 1, 'centre': [2, 0]},"              \
    "{'name': 'c', 'mass_kg': 1, 'inertia_kg_m2': 1, 'centre': [3, 0]}],"                \
    "'joints': ["                                                                        \
    "{'name': 'ja', 'type': 'prismatic', 'bodies': ['ground', 'a'], 'at': [1, 0],"       \
    " 'axis': [1, 0]},"                                                                  \
    "{'name': 'jb', 'type': 'prismatic', 'bodies': ['ground', 'b'], 'at': [2, 0],"       \
    " 'axis': [1, 0]},"                                                                  \
    "{'name': 'jc', 'type': 'prismatic', 'bodies': ['ground', 'c'], 'at': [3, 0],"       \
    " 'axis': [1, 0]}],"                                                                 \
    "'springs': ["                                                                       \
    "{'name': 's1', 'type': 'axial', 'bodies': ['ground', 'a'], 'at': [[0, 0], [1, 0]]," \
    " 'stiffness_n_per_m': 'k1'},"                                                       \
    "{'name': 's2', 'type': 'axial', 'bodies': ['a', 'b'], 'stiffness_n_per_m': 'k2'},"  \
    "{'name': 's3', 'type': 'axial', 'bodies': ['b', 'c'], 'stiffness_n_per_m': 'k3'}]}"

typedef struct bounded {
    study_case c;
    mt_arena mem;
    mt_problem *p;
    mt_workspace *w;
    mt_proof proof;
    mt_mode_placement_bounds b;
} bounded;

static bool open_bounded(mt_test *t, const char *members, bounded *s)
{
    bool known = false;
    *s = (bounded){0};
    return CHECK_INT(t, mt_arena_init(&s->mem, 0, NULL), MT_OK) &&
           study_load(t, ROW, members, &s->c) &&
           CHECK_INT(t, mt_problem_new(s->c.study, NULL, &s->p, &s->c.err), MT_OK) &&
           CHECK_INT(t, mt_workspace_new(s->p, &s->w, &s->c.err), MT_OK) &&
           CHECK_INT(t, mt_proof_init(&s->proof, &s->p->whole, &s->mem, &s->c.err), MT_OK) &&
           CHECK_INT(t,
                     mt_mode_placement_bounds_make(&s->p->whole, &s->proof, WORK, &s->mem,
                                                   &s->b, &known, &s->c.err),
                     MT_OK) &&
           CHECK(t, known);
}

static void close_bounded(bounded *s)
{
    mt_proof_free(&s->proof);
    mt_workspace_delete(s->w);
    mt_problem_delete(s->p);
    mt_arena_free(&s->mem);
    study_free(&s->c);
}

/* A design about the original, so far away at most, within the bounds. */
static void draw(mt_random *r, const mt_subproblem *c, double *at)
{
    const double far = exp(mt_random_in(r, -4.0, 0.5));
    for (int i = 0; i < c->p->n; i++) {
        const double size = MT_HAS(c->p->scale[i]) ? c->upper_t[i] - c->lower_t[i] : 1.0;
        const double x = c->origin_t[i] + (far * size * mt_random_in(r, -1.0, 1.0));
        at[i] = fmin(fmax(x, c->lower_t[i]), c->upper_t[i]);
    }
}

static void least_changes__are_below_those_of_designs(mt_test *t)
{
    static const struct {
        const char *name;
        const char *variables;
        const char *more;
    } rows[] = {
        {"springs",
         "{'parameter': 'k1', 'lower': 300, 'upper': 2700},"
         "{'parameter': 'k2', 'lower': 200, 'upper': 1500},"
         "{'parameter': 'k3', 'lower': 200, 'upper': 2000}",
         ""},
        {"springs and masses, weights",
         "{'parameter': 'k1', 'lower': 300, 'upper': 2700, 'weight': 4},"
         "{'parameter': 'm1', 'lower': 0.5, 'upper': 2, 'weight': 0.3},"
         "{'parameter': 'k3', 'lower': 200, 'upper': 2000},"
         "{'parameter': 'm2', 'lower': 1, 'upper': 3}",
         ""},
        {"a linear measure, the original out of the bounds",
         "{'parameter': 'k1', 'lower': 1000, 'upper': 2700, 'scale': 500},"
         "{'parameter': 'k2', 'lower': 200, 'upper': 1500},"
         "{'parameter': 'm2', 'lower': 1, 'upper': 3}",
         ""},
        {"one spring, a limit", "{'parameter': 'k2', 'lower': 100, 'upper': 2500}",
         ", {'type': 'frequency', 'mode': 1, 'at_least_hz': 1.9}"},
    };
    mt_random r = mt_random_seed(11);
    for (int k = 0; k < MT_COUNT(rows); k++) {
        bounded s;
        char members[1024];
        int avoidance = 0;
        mt_test_row(t, "%s", rows[k].name);
        (void)snprintf(members, sizeof members,
                       "'variables': [%s], 'goals': [{'type': 'avoid', 'bands_hz': [[1.9, 2.1],"
                       "[4.2, 4.5], [6.1, 6.6]]}%s]",
                       rows[k].variables, rows[k].more);
        if (open_bounded(t, members, &s)) {
            const mt_subproblem *const c = &s.p->whole;
            mt_mode_placement_candidates list;
            double rest = 0.0;
            double at[8];
            int below[3];
            CHECK_INT(
                t, mt_mode_placement_bounds_list(&s.b, LISTED, &s.mem, &list, &rest, &s.c.err),
                MT_OK);
            CHECK(t, rest == HUGE_VAL && list.n > 0);
            for (int i = 1; i < list.n; i++) {
                CHECK(t, list.least[i - 1] <= list.least[i]);
            }
            for (int i = 0; i < SAMPLES; i++) {
                double violation = 0.0;
                draw(&r, c, at);
                CHECK_INT(t, mt_mode_placement_assignment(s.w, at, below, &violation, &s.c.err),
                          MT_OK);
                if (!(violation <= 0.0)) {
                    continue;
                }
                avoidance++;
                const double change = mt_subproblem_change(c, at);
                const int place = mt_certify_index_of(list.below, list.n, below, 3);
                const double lowest = s.w->views[0].analysis->modes.lambda[0];
                if (rows[k].more[0] == '\0' || study_hz(lowest) >= LIMIT) {
                    CHECK(t, place < list.n && list.least[place] <= change * (1.0 + SAME));
                }
            }
            CHECK(t, avoidance > SAMPLES / 20);
            /* and they say something: not all are next to the original */
            CHECK(t, list.least[list.n - 1] > 0.01 || list.n < 4);
        }
        close_bounded(&s);
    }
}

static void short_list__says_what_the_rest_takes(mt_test *t)
{
    bounded s;
    if (open_bounded(t,
                     "'variables': [{'parameter': 'k1', 'lower': 300, 'upper': 2700},"
                     "{'parameter': 'k2', 'lower': 200, 'upper': 1500},"
                     "{'parameter': 'k3', 'lower': 200, 'upper': 2000}],"
                     "'goals': [{'type': 'avoid', 'bands_hz': [[1.9, 2.1], [4.2, 4.5],"
                     " [6.1, 6.6]]}]",
                     &s)) {
        mt_mode_placement_candidates all;
        double rest = 0.0;
        CHECK_INT(t, mt_mode_placement_bounds_list(&s.b, LISTED, &s.mem, &all, &rest, &s.c.err),
                  MT_OK);
        for (int most = 0; most < all.n; most++) {
            mt_mode_placement_candidates few;
            CHECK_INT(t,
                      mt_mode_placement_bounds_list(&s.b, most, &s.mem, &few, &rest, &s.c.err),
                      MT_OK);
            CHECK(t, few.n <= most);
            CHECK(t, rest == all.least[few.n]);
            CHECK(t, few.n == 0 || few.least[few.n - 1] < rest);
        }
    }
    close_bounded(&s);
}

#define SPRINGS                                                       \
    "'variables': [{'parameter': 'k1', 'lower': 300, 'upper': 2700}," \
    "{'parameter': 'k2', 'lower': 200, 'upper': 1500},"               \
    "{'parameter': 'k3', 'lower': 200, 'upper': 2000}],"

static void estimate__of_all_modes_alike_has_a_closed_form(mt_test *t)
{
    static const double PART = 0.01;        /* of the frequencies, by which they have to rise */
    static const double DIFFERENCES = 2e-3; /* slopes by differences, thirty sweeps */
    double hz[3] = {0.0};
    bounded s;
    if (open_bounded(t, SPRINGS "'goals': [{'type': 'avoid', 'bands_hz': [[1.9, 2.1]]}]", &s)) {
        int below[1];
        double violation = 0.0;
        CHECK_INT(
            t,
            mt_mode_placement_assignment(s.w, s.p->whole.origin_t, below, &violation, &s.c.err),
            MT_OK);
        for (int j = 0; j < 3; j++) {
            hz[j] = study_hz(s.w->views[0].analysis->modes.lambda[j]);
        }
    }
    close_bounded(&s);
    char members[1024];
    (void)snprintf(members, sizeof members,
                   SPRINGS "'goals': [{'type': 'avoid', 'bands_hz': [[%.17g, %.17g],"
                           "[%.17g, %.17g], [%.17g, %.17g]]}]",
                   hz[0] * (1.0 - PART), hz[0] * exp(PART), hz[1] * (1.0 - PART),
                   hz[1] * exp(PART), hz[2] * (1.0 - PART), hz[2] * exp(PART));
    if (CHECK(t, hz[0] > 0.0) && open_bounded(t, members, &s)) {
        static const struct {
            const char *name;
            int below[3];
        } rows[] = {{"all above", {0, 1, 2}}, {"all below", {1, 2, 3}}};
        mt_mode_placement_candidates list;
        double rest = 0.0;
        CHECK_INT(t,
                  mt_mode_placement_bounds_list(&s.b, LISTED, &s.mem, &list, &rest, &s.c.err),
                  MT_OK);
        for (int k = 0; k < MT_COUNT(rows); k++) {
            const double rise = 2.0 * PART;
            const double down = 2.0 * log(1.0 - PART);
            const double each = k == 0 ? rise * rise : down * down;
            const double want = 0.5 * 3.0 * each;
            const int place = mt_certify_index_of(list.below, list.n, rows[k].below, 3);
            const double got = place < list.n ? list.estimate[place] : nan("");
            mt_test_row(t, "%s", rows[k].name);
            CHECK(t, fabs(got - want) <= DIFFERENCES * want);
        }
    }
    close_bounded(&s);
}

MT_TEST_MAIN(MT_TEST(estimate__of_all_modes_alike_has_a_closed_form),
             MT_TEST(least_changes__are_below_those_of_designs),
             MT_TEST(short_list__says_what_the_rest_takes))
