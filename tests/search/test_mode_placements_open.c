/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a proof's budget ends, what it left open is searched; only where a design was
 * found for all of that is the question settled. The row of six masses with springs within a
 * factor of two. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "prove/certify.h"
#include "search/mode_placements.h"
#include "study_fixture.h"
#include "support/mt_random.h"

#define SPRINGS                                                                            \
    "'variables': [{'parameter': 'x1', 'lower': -0.7, 'upper': 0.7}, {'parameter': 'x2', " \
    "'lower': -0.7, 'upper': 0.7}, {'parameter': 'x3', 'lower': -0.7, 'upper': 0.7}],"     \
    "'search': {'starts': 4},"

/* Gap assignments of the study with so much work for the proof, and so many evaluations (0: all
 * that are needed). */
static void solve(mt_test *t, const char *bands, double work, long evaluations,
                  mt_mode_placement_result *out)
{
    study_case c;
    char members[1024];
    mt_arena mem;
    mt_problem *p = NULL;
    mt_workspace *w = NULL;
    *out = (mt_mode_placement_result){0};
    (void)snprintf(members, sizeof members,
                   SPRINGS "'goals': [{'type': 'avoid', 'bands_hz': %s}]", bands);
    CHECK_INT(t, mt_arena_init(&mem, 0, NULL), MT_OK);
    if (study_load(t, "six_masses", members, &c) &&
        CHECK_INT(t, mt_problem_new(c.study, NULL, &p, &c.err), MT_OK)) {
        mt_subproblem few = p->whole;
        few.proof_work = work;
        few.search.max_evaluations = evaluations;
        CHECK_INT(t, mt_workspace_new(p, &w, &c.err), MT_OK);
        CHECK_INT(t, mt_workspace_use(w, &few, &c.err), MT_OK);
        CHECK_INT(t, mt_mode_placements_solve(&w, 1, NULL, &mem, out, &c.err), MT_OK);
        CHECK(t, out->boxes > 0);
    }
    out->solutions = NULL; /* the arena goes */
    mt_workspace_delete(w);
    mt_problem_delete(p);
    mt_arena_free(&mem);
    study_free(&c);
}

/* One band about mode 2: one box leaves both its sides open, and each has designs. */
static void open_assignments__that_are_all_met_settle_the_question(mt_test *t)
{
    mt_mode_placement_result all;
    mt_mode_placement_result few;
    static const char bands[] = "[[16.2, 16.6]]";
    solve(t, bands, MT_CERTIFY_WORK, 0, &all);
    CHECK(t, all.proven && all.n_candidates > 0);
    CHECK_INT(t, all.n_candidates, all.n_feasible);
    solve(t, bands, 1.0, 0, &few);
    CHECK(t, few.boxes < all.boxes && few.reason != NULL); /* the budget ended */
    CHECK(t, few.proven);
    CHECK_INT(t, few.n_candidates, few.n_feasible);
    CHECK_INT(t, few.n_feasible, all.n_feasible);
}

/* Four bands: little work leaves assignments open that have no design. */
static void open_assignments__without_a_design_stay_open(mt_test *t)
{
    mt_mode_placement_result all;
    mt_mode_placement_result few;
    static const char bands[] = "[[3.87, 4.73], [7.74, 9.46], [15.48, 18.92], [30.96, 37.84]]";
    solve(t, bands, MT_CERTIFY_WORK, 0, &all);
    CHECK(t, all.proven);
    CHECK_INT(t, all.n_candidates, all.n_feasible);
    solve(t, bands, 2.0, 0, &few);
    CHECK(t, few.n_candidates > few.n_feasible);
    CHECK(t, few.boxes < all.boxes && !few.proven && few.reason != NULL);
    CHECK_INT(t, few.n_feasible, all.n_feasible); /* the search finds the same kinds */
}

/* The budget of evaluations is one for all assignments: seven of them here. */
static void evaluations__are_shared_by_the_assignments(mt_test *t)
{
    static const char bands[] = "[[3.87, 4.73], [7.74, 9.46], [15.48, 18.92], [30.96, 37.84]]";
    for (long most = 50; most <= 400; most *= 2) {
        mt_mode_placement_result out;
        mt_test_row(t, "%ld evaluations", most);
        solve(t, bands, MT_CERTIFY_WORK, most, &out);
        CHECK(t, out.evals > 0 && out.evals <= most);
    }
}

/* Random bands, and proofs that end anywhere: what is claimed then is what all work proves. */
static void proofs__that_end_anywhere_claim_what_holds(mt_test *t)
{
    enum { ROWS = 12 };
    static const double MODES_HZ[] = {4.3, 8.6, 17.2, 34.4};
    mt_random r = mt_random_seed(7);
    int ended = 0;
    for (int row = 0; row < ROWS; row++) {
        char bands[256] = "";
        for (int i = 0; i < MT_COUNT(MODES_HZ); i++) {
            const double at = MODES_HZ[i] * mt_random_in(&r, 0.8, 1.2);
            const double half = at * mt_random_in(&r, 0.01, 0.1);
            const size_t length = strlen(bands);
            (void)snprintf(bands + length, sizeof bands - length, "%s[%.3f, %.3f]%s",
                           i == 0 ? "[" : ", ", at - half, at + half,
                           i + 1 == MT_COUNT(MODES_HZ) ? "]" : "");
        }
        mt_mode_placement_result all;
        mt_mode_placement_result few;
        const double work = pow(10.0, mt_random_in(&r, 0.0, 7.5));
        mt_test_row(t, "%s, %.3g multiplications", bands, work);
        solve(t, bands, MT_CERTIFY_WORK, 0, &all);
        solve(t, bands, work, 0, &few);
        CHECK(t, all.proven && few.boxes <= all.boxes);
        CHECK(t, few.n_feasible <= all.n_candidates);
        CHECK(t, few.proven ? few.n_feasible == all.n_feasible : few.reason != NULL);
        CHECK(t, !few.proven || (few.n_candidates == 0) == (all.n_candidates == 0));
        ended += few.proven ? 0 : 1;
    }
    CHECK(t, ended > 0 && ended < ROWS);
}

MT_TEST_MAIN(MT_TEST(evaluations__are_shared_by_the_assignments),
             MT_TEST(open_assignments__that_are_all_met_settle_the_question),
             MT_TEST(open_assignments__without_a_design_stay_open),
             MT_TEST(proofs__that_end_anywhere_claim_what_holds))
