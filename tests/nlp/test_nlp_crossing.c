/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Ends where rows change places: the eigenvalues c -+ r, r = hypot(u, v), of
 *
 *     [c + u, v; v, c - u] positive semidefinite,
 *
 * the lower as a row, the other as what follows from it. An objective whose slopes along u and
 * v are less than that along c has its minimum at the tip of the cone, where the row has no
 * slope and Newton's method no sense.
 */
#include "nlp_problem.h"

/* Evaluations of a search on average: 114; where Newton is tried three times, 159. */
enum { CALLS_MOST = 135 };
enum { N = 3, CASES = 200 };

static double uniform(unsigned long *state)
{
    *state = (*state * 6364136223846793005UL) + 1442695040888963407UL;
    return (double)(*state >> 11) / 9007199254740992.0;
}

/* t = c, x, y; u, v are x, y bent. target: slopes of f along x and y, bend. */
static void cone(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    const double bend = c->target[2];
    const double u = t[1] + bend * t[2] * t[2];
    const double v = t[2] + bend * t[0] * t[0];
    const double r = hypot(u, v);
    const double du = r > 0 ? u / r : 1;
    const double dv = r > 0 ? v / r : 0;
    const double dr[N] = {dv * 2 * bend * t[0], du, (du * 2 * bend * t[2]) + dv};
    out->f = 1 + t[0] + (c->target[0] * t[1]) + (c->target[1] * t[2]);
    out->df[0] = 1;
    out->df[1] = c->target[0];
    out->df[2] = c->target[1];
    out->in[0] = t[0] - r;
    for (int j = 0; j < N; j++) {
        out->din[j] = (j == 0) - dr[j];
        if (out->next != NULL) {
            out->dnext[j] = (j == 0) + dr[j];
        }
    }
    if (out->next != NULL) {
        out->next[0] = t[0] + r;
    }
}

/* The tip is found, and is not sought again and again. */
static void nlp_crossing__a_tip_is_left_alone(mt_test *t)
{
    static const int next_of[] = {0};
    static nlp_case c;
    unsigned long state = 11;
    long calls = 0;
    for (int k = 0; k < CASES; k++) {
        case_begin(&c, N, cone, -1, 1);
        c.nlp.n_in = 1;
        c.nlp.n_next = 1;
        c.nlp.next_of = next_of;
        for (int j = 0; j < N; j++) {
            c.origin[j] = (0.8 * uniform(&state)) - 0.4;
            c.target[j] = (0.8 * uniform(&state)) - 0.4;
        }
        mt_nlp_options opt = mt_nlp_options_default();
        opt.starts = 1;
        opt.least_change = false;
        mt_test_row(t, "case %d", k);
        REQUIRE(t, case_solve(&c, &opt) == MT_OK);
        REQUIRE(t, c.result.n_solutions > 0);
        CHECK_NEAR(t, c.result.solutions[0].f, 1, 1e-5);
        calls += c.calls;
        mt_arena_free(&c.mem);
        memset(&c.mem, 0, sizeof c.mem);
    }
    CHECK(t, calls <= (long)CASES * CALLS_MOST);
}

MT_TEST_MAIN(MT_TEST(nlp_crossing__a_tip_is_left_alone))
