/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

#include "linalg/dense.h"
#include "support/mt_random.h"
#include "support/mt_test.h"

/* Few sizes, so that many entries are as large as the largest, of either sign. */
static void linalg__the_first_of_the_largest_entries_is_found(mt_test *t)
{
    enum { MOST = 70, TRIALS = 3000 };
    mt_random g = mt_random_seed(71);
    for (int trial = 0; trial < TRIALS; trial++) {
        double x[MOST];
        const int n = 1 + mt_random_int(&g, MOST);
        const int sizes = 1 + mt_random_int(&g, 20);
        int first = 0;
        mt_test_row(t, "trial %d, n = %d", trial, n);
        for (int i = 0; i < n; i++) {
            const double size = mt_random_int(&g, sizes);
            x[i] = mt_random_int(&g, 2) == 0 ? size : -size;
            first = fabs(x[i]) > fabs(x[first]) ? i : first;
        }
        CHECK_INT(t, mt_max_index(n, x), first);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(linalg__the_first_of_the_largest_entries_is_found)};
    return cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
}
