/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

#include "linalg/dense.h"
#include "support/mt_random.h"
#include "support/mt_test.h"

enum { MOST = 6 };

static mt_arena mem;

static const double *scores;
static int rows;
static int columns;

/* Best sum over all one-to-one pairings of rows from..rows-1, by trying every column and (m >
 * n) leaving the row out. */
static double brute(int from, unsigned taken)
{
    if (from == rows) {
        int paired = 0;
        for (int j = 0; j < columns; j++) {
            paired += (taken >> j) & 1U ? 1 : 0;
        }
        const int most = rows < columns ? rows : columns;
        return paired == most ? 0.0 : -HUGE_VAL;
    }
    double best = rows > columns ? brute(from + 1, taken) : -HUGE_VAL;
    for (int j = 0; j < columns; j++) {
        if (!((taken >> j) & 1U)) {
            best = fmax(best, scores[from + j * rows] + brute(from + 1, taken | (1U << j)));
        }
    }
    return best;
}

/* Sum of a pairing; NaN where it is not one to one. */
static double total(const int *pair)
{
    unsigned taken = 0;
    int paired = 0;
    double sum = 0.0;
    for (int i = 0; i < rows; i++) {
        if (pair[i] < 0) {
            continue;
        }
        if (pair[i] >= columns || ((taken >> pair[i]) & 1U)) {
            return nan("");
        }
        taken |= 1U << pair[i];
        sum += scores[i + pair[i] * rows];
        paired++;
    }
    return paired == (rows < columns ? rows : columns) ? sum : nan("");
}

static void assign__equals_brute_force(mt_test *t)
{
    mt_random g = mt_random_seed(11);
    for (int trial = 0; trial < 600; trial++) {
        double score[MOST * MOST];
        int pair[MOST];
        rows = 1 + mt_random_int(&g, MOST);
        columns = 1 + mt_random_int(&g, MOST);
        const bool ties = trial % 3 == 0;
        for (int k = 0; k < rows * columns; k++) {
            score[k] = ties ? mt_random_int(&g, 3) : mt_random_in(&g, -1.0, 1.0);
        }
        scores = score;
        mt_test_row(t, "trial %d, %d x %d", trial, rows, columns);
        CHECK_INT(t, mt_assign(rows, columns, score, pair, &mem, NULL), MT_OK);
        CHECK_NEAR_ABS(t, total(pair), brute(0, 0), 1e-14 * MOST);
    }
    CHECK_INT(t, mem.used, 0);
}

static void assign__scores_that_are_not_numbers_make_no_pair(mt_test *t)
{
    const double nil = nan("");
    int pair[3];
    /* the greedy choice 0-0 would force 1 onto NaN; the fewest missing scores win */
    const double avoid[4] = {10.0, 1.0, 1.0, nil};
    CHECK_INT(t, mt_assign(2, 2, avoid, pair, &mem, NULL), MT_OK);
    CHECK_INT(t, pair[0], 1);
    CHECK_INT(t, pair[1], 0);
    const double row[6] = {0.5, nil, 0.1, 0.7, nil, 0.9}; /* row 1 has nothing: 3 x 2 */
    CHECK_INT(t, mt_assign(3, 2, row, pair, &mem, NULL), MT_OK);
    CHECK_INT(t, pair[0], 0);
    CHECK_INT(t, pair[1], -1);
    CHECK_INT(t, pair[2], 1);
    const double none[2] = {nil, -HUGE_VAL};
    CHECK_INT(t, mt_assign(1, 2, none, pair, &mem, NULL), MT_OK);
    CHECK_INT(t, pair[0], -1);
    CHECK_INT(t, mt_assign(2, 0, none, pair, &mem, NULL), MT_OK);
    CHECK_INT(t, pair[0], -1);
    CHECK_INT(t, pair[1], -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(assign__equals_brute_force),
        MT_TEST(assign__scores_that_are_not_numbers_make_no_pair),
    };
    const int failed = mt_arena_init(&mem, 0, NULL) != MT_OK
                           ? 1
                           : cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
    mt_arena_free(&mem);
    return failed != 0;
}
