/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Rows that keep a repeated mode together, in closed form. A mass of 1 kg in a plane, held by
 * springs k_i in the directions n_i at 0, 60 and 120 degrees, K = sum k_i n_i n_i^T, has both
 * frequencies at omega = 1 where all k_i are 2/3. With its whole plane as the cluster the rows
 * are the entries of B = sign (g K - 1) / 2 in some orthonormal basis, those off the diagonal
 * times sqrt 2, so that their sums of products are those of matrices whatever the basis:
 *
 *     rows . rows           = |g K - 1|^2 / 4
 *     rows . drows/dln k_j  = g k_j n_j^T (g K - 1) n_j / 4
 *     drows/dln k_j . drows/dln k_l = g^2 k_j k_l (n_j . n_l)^2 / 4.
 *
 * g is what the springs are multiplied with at the worst corner of their tolerances.
 */
#include "problem/problem.h"
#include "problem/workspace.h"
#include "search/search_repeated_eigenvalues.h"
#include "study_fixture.h"

enum { SPRINGS = 3, TEXT = 1024 };

#define SPRING(name, x, y)                                                                   \
    "{'name': 's" name "', 'type': 'axial', 'bodies': ['ground', 'm'], 'at': [['" x "', '" y \
    "', 0], [0, 0, 0]], 'stiffness_n_per_m': 'k" name "'}"
#define MODEL                                                                                  \
    "{'format': 'modetune-model/1', 'dimension': 3, 'parameters': {'ka': 1, 'kb': 3, 'kc': "   \
    "5}, 'bodies': [{'name': 'm', 'mass_kg': 1, 'centre': [0, 0, 0]}], 'springs': [" SPRING(   \
        "a", "1",                                                                              \
        "0") "," SPRING("b", "0.5",                                                            \
                        "sqrt(0.75)") "," SPRING("c", "-0.5",                                  \
                                                 "sqrt(0.75)") ", {'name': 'across', 'type': " \
                                                               "'axial', 'bodies': "           \
                                                               "['ground', 'm'], 'at': [[0, "  \
                                                               "0, 1], "                       \
                                                               "[0, 0, 0]], "                  \
                                                               "'stiffness_n_per_m': 100}]}"
#define LIMIT "{'type': 'limit', 'expression': 'ka + kb', 'at_least': 0.1, %s}"

static const double NEAR = 0.02;      /* relative: modes that count as one cluster */
static const double ROUNDING = 1e-12; /* of entries of about 1 */
static const double TOL_FREQUENCY = 1e-6;

typedef struct asked {
    study_case c;
    mt_problem *p;
    mt_workspace *w;
    mt_arena mem;
    double t[SPRINGS];
} asked;

static bool ask(mt_test *t, asked *a, const char *spring, const char *goals, double k)
{
    char text[2 * TEXT];
    mt_err err = {.text = ""};
    *a = (asked){.p = NULL};
    (void)snprintf(text, sizeof text,
                   "'variables': [{'parameter': 'ka', 'lower': 0.01, 'upper': 20%s},"
                   "{'parameter': 'kb', 'lower': 0.01, 'upper': 20%s}, {'parameter': 'kc', "
                   "'lower': 0.01, 'upper': 20%s}], 'goals': [%s]",
                   spring, spring, spring, goals);
    if (!CHECK_INT(t, mt_arena_init(&a->mem, 0, NULL), MT_OK) ||
        !study_load(t, MODEL, text, &a->c) ||
        !CHECK_INT(t, mt_problem_new(a->c.study, NULL, &a->p, &err), MT_OK) ||
        !CHECK_INT(t, mt_workspace_new(a->p, &a->w, &err), MT_OK)) {
        (void)fprintf(stderr, "%s\n", err.text);
        return false;
    }
    for (int i = 0; i < SPRINGS; i++) {
        a->t[i] = mt_problem_t(a->p, i, k);
    }
    return true;
}

static void forget(asked *a)
{
    mt_workspace_delete(a->w);
    mt_problem_delete(a->p);
    study_free(&a->c);
    mt_arena_free(&a->mem);
}

static const struct {
    const char *name;
    const char *spring; /* of its variable */
    const char *goal;
    double sign;
    double corner; /* what springs are multiplied with there */
} kinds[] = {
    {"at least", "", "{'type': 'frequency', 'mode': 1, 'at_least_hz': '1/(2*pi)'}", 1.0, 1.0},
    {"at most", "", "{'type': 'frequency', 'mode': 2, 'at_most_hz': '1/(2*pi)'}", -1.0, 1.0},
    {"the lower one's target", "", "{'type': 'frequency', 'mode': 1, 'target_hz': '1/(2*pi)'}",
     1.0, 1.0},
    {"the higher one's target", "", "{'type': 'frequency', 'mode': 2, 'target_hz': '1/(2*pi)'}",
     -1.0, 1.0},
    {"at least, at the softest", ", 'tolerance_percent': 10",
     "{'type': 'frequency', 'mode': 1, 'at_least_hz': '1/(2*pi)'}", 1.0, 0.9},
    {"at most, at the stiffest", ", 'tolerance_percent': 10",
     "{'type': 'frequency', 'mode': 2, 'at_most_hz': '1/(2*pi)'}", -1.0, 1.1},
};

/* n_j . n_l, squared: 1, else cos(60 degrees)^2. */
static double cosine2(int j, int l)
{
    return j == l ? 1.0 : 0.25;
}

/* n_j^T (g K - 1) n_j, and |g K - 1|^2 = g^2 sum k_i k_j (n_i . n_j)^2 - 2 g sum k + 2. */
static double strain(const double *k, double g, int j)
{
    double sum = -1.0;
    for (int i = 0; i < SPRINGS; i++) {
        sum += g * k[i] * cosine2(i, j);
    }
    return sum;
}

static double squares(const double *k, double g)
{
    double sum = 2.0;
    for (int i = 0; i < SPRINGS; i++) {
        sum -= 2.0 * g * k[i];
        for (int j = 0; j < SPRINGS; j++) {
            sum += g * g * k[i] * k[j] * cosine2(i, j);
        }
    }
    return sum;
}

/* The block's rows of the problem r, evaluated at springs k. */
static void check_rows(mt_test *t, asked *a, mt_repeated_eigenvalues *r, int kind,
                       const double *k)
{
    const mt_nlp nlp = mt_repeated_eigenvalues_nlp(r);
    const mt_repeated_eigenvalues_block *const b = &r->blocks[0];
    const double g = kinds[kind].corner;
    mt_nlp_values v = {.f = 0.0};
    mt_err err = {.text = ""};
    double at[SPRINGS];
    v.eq = mt_arena_f64(&a->mem, (size_t)nlp.n_eq, 1);
    v.deq = mt_arena_f64(&a->mem, (size_t)nlp.n_eq, SPRINGS);
    v.in = mt_arena_f64(&a->mem, (size_t)nlp.n_in, 1);
    v.din = mt_arena_f64(&a->mem, (size_t)nlp.n_in, SPRINGS);
    v.df = mt_arena_f64(&a->mem, SPRINGS, 1);
    for (int j = 0; j < SPRINGS; j++) {
        at[j] = mt_problem_t(a->p, j, k[j]);
    }
    REQUIRE(t, mt_arena_check(&a->mem, &err) == MT_OK);
    REQUIRE(t, nlp.eval(nlp.context, at, true, &v, &err) == MT_OK);
    double rows = 0.0;
    for (int i = 0; i < b->n_rows; i++) {
        rows += v.eq[b->first + i] * v.eq[b->first + i];
    }
    CHECK_NEAR_ABS(t, rows, 0.25 * squares(k, g), ROUNDING);
    for (int j = 0; j < SPRINGS; j++) {
        double along = 0.0;
        for (int i = 0; i < b->n_rows; i++) {
            along += v.eq[b->first + i] * v.deq[b->first + i + (j * nlp.n_eq)];
        }
        CHECK_NEAR_ABS(t, along, 0.25 * g * k[j] * strain(k, g, j), ROUNDING);
        for (int l = 0; l < SPRINGS; l++) {
            double product = 0.0;
            for (int i = 0; i < b->n_rows; i++) {
                product +=
                    v.deq[b->first + i + (j * nlp.n_eq)] * v.deq[b->first + i + (l * nlp.n_eq)];
            }
            CHECK_NEAR_ABS(t, product, 0.25 * g * g * k[j] * k[l] * cosine2(j, l), ROUNDING);
        }
    }
    double trace = 0.0;
    for (int i = 0; i < b->r; i++) {
        trace += b->b[i + (i * b->r)];
    }
    CHECK_NEAR_ABS(t, trace, 0.5 * kinds[kind].sign * (g * (k[0] + k[1] + k[2]) - 2.0),
                   ROUNDING);
}

static void repeated_rows__are_the_matrices_of_the_cluster(mt_test *t)
{
    static const double factors[][SPRINGS] = {
        {1.0, 1.0, 1.0}, {1.01, 1.0, 0.98}, {0.9, 1.2, 1.1}, {1.1, 1.1, 1.1}};
    for (int i = 0; i < MT_COUNT(kinds); i++) {
        asked a;
        mt_repeated_eigenvalues r;
        mt_err err = {.text = ""};
        const double k0 = 2.0 / 3.0 / kinds[i].corner;
        mt_test_row(t, "%s", kinds[i].name);
        if (ask(t, &a, kinds[i].spring, kinds[i].goal, k0) &&
            CHECK_INT(t, mt_repeated_eigenvalues_find(a.w, a.t, NEAR, &a.mem, &r, &err),
                      MT_OK) &&
            CHECK(t, r.n_blocks == 1 && r.blocks[0].r == 2 && r.n_rows == 3)) {
            for (int f = 0; f < MT_COUNT(factors); f++) {
                double k[SPRINGS];
                mt_test_row(t, "%s, design %d", kinds[i].name, f);
                for (int j = 0; j < SPRINGS; j++) {
                    k[j] = k0 * factors[f][j];
                }
                check_rows(t, &a, &r, i, k);
            }
        }
        forget(&a);
    }
}

/* What is found has to keep the study's rows: those of the cluster are kept to half of the
 * least that any row is. */
static void repeated_rows__are_kept_to_half_of_the_least_tolerance(mt_test *t)
{
    static const struct {
        const char *limit; /* tolerances of the goal beside */
        double least;
    } rows[] = {{"'tolerance_percent': 1e-6", 1e-8}, {"'tolerance_percent': 1", 1e-6}};
    for (int i = 0; i < 4 * MT_COUNT(rows); i++) {
        asked a;
        mt_repeated_eigenvalues r;
        mt_err err = {.text = ""};
        char goals[TEXT];
        const double least = rows[i / 4].least;
        (void)snprintf(goals, sizeof goals, "%s, " LIMIT, kinds[i % 4].goal, rows[i / 4].limit);
        mt_test_row(t, "%s, %s", kinds[i % 4].name, rows[i / 4].limit);
        if (ask(t, &a, "", goals, 2.0 / 3.0) &&
            CHECK_INT(t, mt_repeated_eigenvalues_find(a.w, a.t, NEAR, &a.mem, &r, &err),
                      MT_OK)) {
            for (int k = 0; k < r.n_kept; k++) {
                CHECK_NEAR(t, r.eq_tol[k], TOL_FREQUENCY, ROUNDING);
            }
            for (int k = 0; k < r.n_rows; k++) {
                CHECK_NEAR(t, r.eq_tol[r.n_kept + k], 0.5 * least, ROUNDING);
            }
        }
        forget(&a);
    }
}

MT_TEST_MAIN(MT_TEST(repeated_rows__are_the_matrices_of_the_cluster),
             MT_TEST(repeated_rows__are_kept_to_half_of_the_least_tolerance))
