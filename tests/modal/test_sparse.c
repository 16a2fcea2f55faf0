/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Sparse problems, of matrices alone: which equations follow from others. A row of masses, each
 * tied to the one before it: n rigid ties are about pi/n from dependent ones, and independent.
 * And free beams, masses in a row with a spring against each second difference: of 600 the
 * lowest mode is 1e-10 of the highest, of 6,000 1e-14.
 */
#include <math.h>

#include "modal/sparse.h"
#include "mt_test.h"

static const double MASS = 3.0;
static const double STIFFNESS = 20.0;

/* n masses, the first on a spring, and a free one, on a spring of its own; all ties, and the
 * first `again` of them once more. */
static mt_status row_of(int n, int again, mt_arena *mem, mt_sparse_problem *p)
{
    const int all = n + 1;
    const int ties = n - 1 + again;
    double *const m = mt_arena_f64(mem, (size_t)all, 1);
    double *const k = mt_arena_f64(mem, 2, 1);
    double *const unit = mt_arena_f64(mem, (size_t)all, 1);
    int *const part = mt_arena_int(mem, (size_t)all);
    *p = (mt_sparse_problem){.n = all, .count = 2, .part = part, .unit = unit};
    mt_rows_begin(&p->k.row, 2, 2, mem);
    mt_rows_begin(&p->m.row, all, (size_t)all, mem);
    mt_rows_begin(&p->a, ties, 2 * (size_t)ties, mem);
    MT_TRY(mt_arena_check(mem, NULL));
    p->k.c = k;
    p->m.c = m;
    for (int i = 0; i < 2; i++) {
        k[i] = STIFFNESS;
        mt_rows_push(&p->k.row, i, i * n, 1.0);
        mt_rows_end(&p->k.row, i);
    }
    for (int j = 0; j < all; j++) {
        m[j] = MASS;
        unit[j] = 1.0;
        part[j] = j;
        mt_rows_push(&p->m.row, j, j, 1.0);
        mt_rows_end(&p->m.row, j);
    }
    for (int r = 0; r < ties; r++) {
        const int i = r < n - 1 ? r : r - (n - 1);
        mt_rows_push(&p->a, r, i, -1.0);
        mt_rows_push(&p->a, r, i + 1, 1.0);
        mt_rows_end(&p->a, r);
    }
    return MT_OK;
}

static void check_row(mt_test *t, int n, int again)
{
    mt_arena mem = {0};
    mt_sparse_problem p;
    mt_lowest_modes found = {.below = 0};
    double *mu = NULL;
    bool answered = false;
    char why[MT_SPARSE_WHY] = "";
    if (CHECK_INT(t, mt_arena_init(&mem, 0, NULL), MT_OK) &&
        CHECK_INT(t, row_of(n, again, &mem, &p), MT_OK) &&
        CHECK_INT(t, mt_modal_sparse(&p, &mem, &found, &mu, &answered, why, NULL), MT_OK) &&
        CHECK(t, answered) && CHECK_INT(t, found.modes.n, 2) &&
        CHECK_INT(t, found.modes.count, 2)) {
        const double lambda[] = {STIFFNESS / (n * MASS), STIFFNESS / MASS};
        for (int i = 0; i < 2; i++) {
            CHECK_NEAR_ABS(t, found.modes.lambda[i], lambda[i],
                           found.modes.error[i] + (1e-15 * lambda[i]));
            CHECK(t, found.modes.error[i] <= 1e-9 * lambda[i]);
        }
    }
    mt_arena_free(&mem);
}

static void sparse__ties_of_any_row_are_independent(mt_test *t)
{
    static const int length[] = {10, 3000, 100000};
    for (int i = 0; i < MT_COUNT(length); i++) {
        mt_test_row(t, "%d masses", length[i]);
        check_row(t, length[i], 0);
    }
}

static void sparse__ties_that_are_there_twice_are_counted_once(mt_test *t)
{
    static const int length[] = {10, 3000, 100000};
    for (int i = 0; i < MT_COUNT(length); i++) {
        mt_test_row(t, "%d masses", length[i]);
        check_row(t, length[i], length[i] / 2);
    }
}

/* A free beam of n equal masses and unit second differences. */
static mt_status free_beam(int n, mt_arena *mem, mt_sparse_problem *p)
{
    double *const one = mt_arena_f64(mem, (size_t)n, 1);
    int *const part = mt_arena_int(mem, (size_t)n);
    *p = (mt_sparse_problem){.n = n, .count = 4, .part = part, .unit = one};
    mt_rows_begin(&p->k.row, n - 2, 3 * (size_t)n, mem);
    mt_rows_begin(&p->m.row, n, (size_t)n, mem);
    mt_rows_begin(&p->a, 0, 0, mem);
    MT_TRY(mt_arena_check(mem, NULL));
    p->k.c = one;
    p->m.c = one;
    for (int j = 0; j < n; j++) {
        one[j] = 1.0;
        part[j] = j;
        mt_rows_push(&p->m.row, j, j, 1.0);
        mt_rows_end(&p->m.row, j);
    }
    for (int r = 0; r < n - 2; r++) {
        mt_rows_push(&p->k.row, r, r, 1.0);
        mt_rows_push(&p->k.row, r, r + 1, -2.0);
        mt_rows_push(&p->k.row, r, r + 2, 1.0);
        mt_rows_end(&p->k.row, r);
    }
    return MT_OK;
}

/* cosh x cos x = 1 at FREE: omega^2 = (FREE/l)^4 EI/m. */
static const double FREE = 4.730040744862704;

static void sparse__free_beams_bend_however_fine_they_are(mt_test *t)
{
    static const int length[] = {600, 2000, 6000};
    for (int i = 0; i < MT_COUNT(length); i++) {
        mt_arena mem = {0};
        mt_sparse_problem p;
        mt_lowest_modes found = {.below = 0};
        double *mu = NULL;
        bool answered = false;
        char why[MT_SPARSE_WHY] = "";
        const double n = length[i];
        mt_test_row(t, "%d masses", length[i]);
        if (CHECK_INT(t, mt_arena_init(&mem, 0, NULL), MT_OK) &&
            CHECK_INT(t, free_beam(length[i], &mem, &p), MT_OK)) {
            CHECK_INT(t, mt_modal_sparse(&p, &mem, &found, &mu, &answered, why, NULL), MT_OK);
            const bool is = CHECK(t, answered) && CHECK_INT(t, found.modes.n_rigid, 2);
            const double closed = pow(FREE / n, 4.0);
            CHECK_NEAR_ABS(t, is ? found.modes.lambda[2] : 0.0, closed, 20.0 / n / n * closed);
            CHECK(t, is && found.modes.error[2] <= 1e-6 * closed);
        }
        mt_arena_free(&mem);
    }
}

MT_TEST_MAIN(MT_TEST(sparse__ties_of_any_row_are_independent),
             MT_TEST(sparse__ties_that_are_there_twice_are_counted_once),
             MT_TEST(sparse__free_beams_bend_however_fine_they_are))
