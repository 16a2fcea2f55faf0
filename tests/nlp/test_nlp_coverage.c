/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Roots that are hard to meet: the search goes on until every root was met twice, or says how
 * many may be missing. */
#include "nlp_problem.h"

/* eq_j = (t_j + 0.9) (t_j - 0.5): 2^n roots; Newton's basins of t_j meet at -0.2, 0.4 : 0.6 of
 * the bounds -1 to 1. */
enum { PAIRS = 4, ROOTS = 16, FEW = 24 };

static void pairs(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    const int n = c->nlp.n;
    out->f = 0;
    memset(out->deq, 0, (size_t)n * (size_t)n * sizeof *out->deq);
    for (int j = 0; j < n; j++) {
        out->f += 0.5 * t[j] * t[j];
        out->df[j] = t[j];
        out->eq[j] = (t[j] + 0.9) * (t[j] - 0.5);
        out->deq[j + j * n] = 2 * t[j] + 0.4;
    }
}

static void nlp_coverage__every_root_is_met_twice(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, PAIRS, pairs, -1, 1);
    c.nlp.n_eq = PAIRS;
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    CHECK_INT(t, c.result.n_found, ROOTS);
    CHECK_INT(t, c.result.n_solutions, ROOTS);
    CHECK_INT(t, c.result.n_once, 0);
    CHECK(t, c.result.missing == 0);
    CHECK(t, c.result.starts > FEW);
    int hits = 0;
    for (int i = 0; i < c.result.n_solutions; i++) {
        CHECK(t, c.result.solutions[i].hits >= 2);
        hits += c.result.solutions[i].hits;
    }
    CHECK(t, hits <= c.result.starts);
    mt_arena_free(&c.mem);
}

/* So many starts were asked for, and no more are made; what they leave is estimated. */
static void nlp_coverage__what_is_missing_is_estimated(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, PAIRS, pairs, -1, 1);
    c.nlp.n_eq = PAIRS;
    mt_nlp_options opt = mt_nlp_options_default();
    opt.starts = FEW;
    REQUIRE(t, case_solve(&c, &opt) == MT_OK);
    CHECK_INT(t, c.result.starts, FEW);
    CHECK(t, c.result.n_found < ROOTS && c.result.n_once > 1);
    int twice = 0;
    for (int i = 0; i < c.result.n_solutions; i++) {
        twice += c.result.solutions[i].hits == 2;
    }
    const double f1 = c.result.n_once;
    CHECK_NEAR(t, c.result.missing, f1 * (f1 - 1) / (2.0 * (twice + 1)), 1e-15);
    mt_arena_free(&c.mem);
}

/* A spent budget ends it, and the roots met once are told. */
static void nlp_coverage__a_spent_budget_ends_it(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, PAIRS, pairs, -1, 1);
    c.nlp.n_eq = PAIRS;
    mt_nlp_options opt = mt_nlp_options_default();
    REQUIRE(t, case_solve(&c, &opt) == MT_OK);
    const long all = c.result.evals;
    opt.max_evals = all / 2;
    REQUIRE(t, case_solve(&c, &opt) == MT_OK);
    CHECK(t, c.result.evals <= all / 2);
    CHECK(t, c.result.n_once > 0 && c.result.n_found > 0);
    mt_arena_free(&c.mem);
}

static void nlp_coverage__any_number_of_workers_finds_the_same(mt_test *t)
{
    enum { WORKERS = 3 };
    static nlp_case c[2];
    void *contexts[WORKERS];
    for (int k = 0; k < 2; k++) {
        case_begin(&c[k], PAIRS, pairs, -1, 1);
        c[k].nlp.n_eq = PAIRS;
        for (int i = 0; i < WORKERS; i++) {
            contexts[i] = &c[k]; /* it is only read */
        }
        c[k].nlp.n_workers = k == 0 ? 1 : WORKERS;
        c[k].nlp.contexts = contexts;
        const mt_nlp_options opt = mt_nlp_options_default();
        REQUIRE(t, case_solve(&c[k], &opt) == MT_OK);
    }
    REQUIRE(t, c[0].result.n_solutions == c[1].result.n_solutions);
    CHECK_INT(t, c[0].result.starts, c[1].result.starts);
    for (int i = 0; i < c[0].result.n_solutions; i++) {
        const mt_nlp_solution *const a = &c[0].result.solutions[i];
        const mt_nlp_solution *const b = &c[1].result.solutions[i];
        CHECK(t, same_bytes(a->t, b->t, PAIRS * sizeof *a->t) && a->hits == b->hits);
    }
    mt_arena_free(&c[0].mem);
    mt_arena_free(&c[1].mem);
}

/* t_0 = t_1, twice: a curve of roots, each met once by its start. No number of starts would
 * meet one twice. */
static void diagonal(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    (void)c;
    out->f = 0;
    for (int j = 0; j < 2; j++) {
        out->df[j] = 0;
        out->eq[j] = t[0] - t[1];
        out->deq[j] = 1;
        out->deq[2 + j] = -1;
    }
}

static void nlp_coverage__a_curve_of_roots_is_not_counted(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 2, diagonal, -1, 1);
    c.nlp.n_eq = 2;
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    CHECK_INT(t, c.result.starts, 16);
    CHECK(t, !(c.result.missing >= 0));
    mt_arena_free(&c.mem);
}

/* In every variable two wells of unequal depth, or one: 2^n minima, or one. */
static void wells(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    out->f = 0;
    for (int j = 0; j < c->nlp.n; j++) {
        const double depth = c->target[0];
        const double p = (t[j] * t[j]) - depth;
        out->f += (p * p) + (0.01 * t[j]);
        out->df[j] = (4 * p * t[j]) + 0.01;
    }
}

/* Starts end with one place met eight times, with two met seventeen times; eight take more than
 * were asked for. A design is not lost by it. */
static void nlp_coverage__starts_end_where_little_is_left(mt_test *t)
{
    enum { ASKED = 40 };
    static const struct {
        int n;
        double depth;
        int places;
        int starts;
    } rows[] = {{2, -0.1, 1, 8}, {1, 0.25, 2, 24}, {3, 0.25, 8, ASKED}};
    for (int k = 0; k < MT_COUNT(rows); k++) {
        mt_nlp_options opt = {.seed = 1, .starts = ASKED};
        nlp_case c = {0};
        mt_test_row(t, "%d minima", rows[k].places);
        case_begin(&c, rows[k].n, wells, -1, 1);
        c.target[0] = rows[k].depth;
        REQUIRE(t, case_solve(&c, &opt) == MT_OK);
        CHECK_INT(t, c.result.starts, ASKED);
        CHECK_INT(t, c.result.n_found, rows[k].places);
        const double best = c.result.solutions[0].f;
        opt.settles = true;
        REQUIRE(t, case_solve(&c, &opt) == MT_OK);
        CHECK_INT(t, c.result.starts, rows[k].starts);
        CHECK_INT(t, c.result.n_found, rows[k].places);
        CHECK_NEAR(t, c.result.solutions[0].f, best, 1e-12);
        mt_arena_free(&c.mem);
    }
}

MT_TEST_MAIN(MT_TEST(nlp_coverage__starts_end_where_little_is_left),
             MT_TEST(nlp_coverage__every_root_is_met_twice),
             MT_TEST(nlp_coverage__what_is_missing_is_estimated),
             MT_TEST(nlp_coverage__a_spent_budget_ends_it),
             MT_TEST(nlp_coverage__any_number_of_workers_finds_the_same),
             MT_TEST(nlp_coverage__a_curve_of_roots_is_not_counted))
