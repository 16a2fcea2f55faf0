/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sparse rows against the same rows written out. */
#include "linalg/dense.h"
#include "support/mt_random.h"
#include "support/mt_test.h"

enum { N = 9, ROWS = 12, ROUNDS = 50 };

static mt_arena mem;

typedef struct sample {
    double dense[ROWS][N];
    mt_rows rows;
} sample;

/* Some rows are empty, one is full. */
static void draw(mt_random *g, sample *s)
{
    mt_rows_begin(&s->rows, ROWS, (size_t)ROWS * N, &mem);
    for (int i = 0; i < ROWS; i++) {
        const double filled = i == 0 ? 1.0 : (i % 4 == 3 ? 0.0 : 0.4);
        for (int k = 0; k < N; k++) {
            const bool there = mt_random_in(g, 0.0, 1.0) < filled;
            s->dense[i][k] = there ? mt_random_in(g, 0.5, 2.0) : 0.0;
            if (there) {
                mt_rows_push(&s->rows, i, k, s->dense[i][k]);
            }
        }
        mt_rows_end(&s->rows, i);
    }
}

static void rows__are_what_they_are_written_out(mt_test *t)
{
    mt_random g = mt_random_seed(11);
    for (int round = 0; round < ROUNDS; round++) {
        sample s;
        double x[N];
        mt_arena_clear(&mem);
        draw(&g, &s);
        for (int k = 0; k < N; k++) {
            x[k] = mt_random_in(&g, -1.0, 1.0);
        }
        for (int i = 0; i < ROWS; i++) {
            double sum = 0.0;
            double y[N] = {0.0};
            bool empty = true;
            mt_test_row(t, "round %d, row %d", round, i);
            mt_rows_axpy(&s.rows, i, -3.0, y);
            for (int k = 0; k < N; k++) {
                sum += s.dense[i][k] * x[k];
                empty = empty && s.dense[i][k] == 0.0;
                CHECK_NEAR(t, y[k], -3.0 * s.dense[i][k], 0.0);
            }
            CHECK_NEAR_ABS(t, mt_rows_dot(&s.rows, i, x), sum, 1e-14);
            CHECK_INT(t, mt_rows_empty(&s.rows, i), empty);
        }
    }
}

/* c (a b^T + b a^T)/2, and nothing above the diagonal. */
static void rows__add_their_products_below_the_diagonal(mt_test *t)
{
    mt_random g = mt_random_seed(12);
    for (int round = 0; round < ROUNDS; round++) {
        sample s;
        mt_arena_clear(&mem);
        draw(&g, &s);
        for (int i = 0; i < ROWS; i++) {
            const int other = (i + round) % ROWS;
            const double *const a = s.dense[i];
            const double *const b = s.dense[other];
            double square[N * N] = {0.0};
            double pair[N * N] = {0.0};
            mt_test_row(t, "round %d, rows %d and %d", round, i, other);
            mt_rows_square(&s.rows, i, 1.5, N, square);
            mt_rows_pair(&s.rows, i, other, 1.5, N, pair);
            for (int k = 0; k < N * N; k++) {
                const int row = k % N;
                const int col = k / N;
                const double low = row >= col ? 1.5 : 0.0;
                CHECK_NEAR_ABS(t, square[k], low * a[row] * a[col], 1e-14);
                CHECK_NEAR_ABS(t, pair[k], 0.5 * low * ((a[row] * b[col]) + (b[row] * a[col])),
                               1e-14);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(rows__are_what_they_are_written_out),
        MT_TEST(rows__add_their_products_below_the_diagonal),
    };
    const int failed = mt_arena_init(&mem, 0, NULL) != MT_OK
                           ? 1
                           : cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
    mt_arena_free(&mem);
    return failed != 0;
}
