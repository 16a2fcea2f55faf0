/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Items are found by their keys, in whatever order they come, after few comparisons. */
#include <limits.h>
#include <math.h>
#include <stdint.h>

#include "base/sorted.h"
#include "mt_test.h"

enum { MOST = 20000 };

typedef struct keys {
    int key[MOST];
    long *compared;
} keys;

static int compare(const void *context, const void *key, int i)
{
    const keys *const k = context;
    const int x = *(const int *)key;
    (*k->compared)++;
    return (x > k->key[i]) - (x < k->key[i]);
}

/* An order in which keys come. */
typedef enum order { RISING, FALLING, OUTSIDE_IN, ALIKE_BITS, RANDOM, ORDERS } order;

static int key_of(order o, int i, int n)
{
    switch (o) {
    case RISING:
        return i;
    case FALLING:
        return n - i;
    case OUTSIDE_IN:
        return i % 2 == 0 ? i : INT_MAX - i;
    case ALIKE_BITS:
        return (int)((unsigned)i << 16U);
    case RANDOM:
    case ORDERS:
        break;
    }
    return (int)((unsigned)i * 2654435761U >> 1U); /* odd: each once */
}

static void sorted__finds_each_in_few_comparisons(mt_test *t)
{
    static const char *const names[ORDERS] = {"rising", "falling", "outside in",
                                              "alike in their low bits", "at random"};
    static keys k;
    long compared = 0;
    k.compared = &compared;
    for (int o = 0; o < ORDERS; o++) {
        for (int n = 1; n <= MOST; n = n < 40 ? n + 1 : 5 * n) {
            mt_arena mem = {.first = NULL};
            mt_sorted s = {.n = 0};
            long added = 0;
            bool right = true;
            mt_test_row(t, "%d keys %s", n, names[o]);
            for (int i = 0; i < n; i++) {
                const int key = key_of((order)o, i, n);
                right =
                    right && (o == ALIKE_BITS || mt_sorted_find(&s, compare, &k, &key) == -1);
                if (mt_sorted_find(&s, compare, &k, &key) == -1) {
                    k.key[s.n] = key;
                    right = right && mt_sorted_add(&s, &mem, compare, &k, &key);
                    added++;
                }
            }
            CHECK(t, right && s.n == added);
            const double deepest = 2 * log2(n + 1.0);
            for (int i = 0; i < s.n; i++) {
                compared = 0;
                right = right && mt_sorted_find(&s, compare, &k, &k.key[i]) == i &&
                        (double)compared <= deepest &&
                        mt_sorted_put(&s, &mem, compare, &k, &k.key[i]) == i;
            }
            CHECK(t, right && s.n == added);
            mt_arena_free(&mem);
        }
    }
}

static void sorted__without_memory_stays_as_it_was(mt_test *t)
{
    static keys k;
    long compared = 0;
    k.compared = &compared;
    mt_arena mem = {.first = NULL};
    mt_sorted s = {.n = 0};
    for (int i = 0; i < 32; i++) {
        k.key[i] = i;
        CHECK(t, mt_sorted_add(&s, &mem, compare, &k, &i));
    }
    mt_arena_fail(&mem);
    const int next = 32;
    CHECK(t, !mt_sorted_add(&s, &mem, compare, &k, &next));
    CHECK_INT(t, mt_sorted_put(&s, &mem, compare, &k, &next), MT_SORTED_FULL);
    CHECK_INT(t, s.n, 32);
    for (int i = 0; i < 32; i++) {
        CHECK_INT(t, mt_sorted_find(&s, compare, &k, &i), i);
    }
    CHECK_INT(t, mt_sorted_find(&s, compare, &k, &next), -1);
    mt_arena_free(&mem);
}

MT_TEST_MAIN(MT_TEST(sorted__finds_each_in_few_comparisons),
             MT_TEST(sorted__without_memory_stays_as_it_was))
