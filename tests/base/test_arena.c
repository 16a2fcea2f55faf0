/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <limits.h>
#include <string.h>

#include "base/arena.h"
#include "support/mt_test.h"

#if defined(__SANITIZE_ADDRESS__)
#    define WITH_ASAN 1
#elif defined(__has_feature)
#    if __has_feature(address_sanitizer)
#        define WITH_ASAN 1
#    endif
#endif
#ifdef WITH_ASAN
#    include <sanitizer/asan_interface.h>
#    define POISONED(p) (__asan_address_is_poisoned(p) != 0)
#else
#    define POISONED(p) ((void)(p), true) /* seen by nobody: nothing to test */
#endif

static bool all_zero(const void *p, size_t n)
{
    const unsigned char *const byte = p;
    for (size_t i = 0; i < n; i++) {
        if (byte[i] != 0) {
            return false;
        }
    }
    return true;
}

static void arena__memory_is_aligned_zeroed_and_apart(mt_test *t)
{
    static const size_t sizes[] = {1, 7, 64, 65, 1000, 4096, 20000, 3};
    unsigned char *got[MT_COUNT(sizes)];
    mt_arena a;
    REQUIRE(t, mt_arena_init(&a, 4096, NULL) == MT_OK);
    for (int i = 0; i < MT_COUNT(sizes); i++) {
        mt_test_row(t, "%zu bytes", sizes[i]);
        got[i] = mt_arena_alloc(&a, sizes[i], 1);
        CHECK(t, got[i] != NULL);
        if (got[i] != NULL) {
            CHECK(t, (uintptr_t)got[i] % MT_ALIGN == 0);
            CHECK(t, all_zero(got[i], sizes[i]));
            memset(got[i], 0x40 + i, sizes[i]);
        }
    }
    for (int i = 0; i < MT_COUNT(sizes) && got[i] != NULL; i++) {
        mt_test_row(t, "%zu bytes are still theirs", sizes[i]);
        CHECK_INT(t, got[i][0], 0x40 + i);
        CHECK_INT(t, got[i][sizes[i] - 1], 0x40 + i);
    }
    mt_arena_free(&a);
}

/* Requests that no arena can meet. */
enum { N_TOO_LARGE = 7 };
static const void *too_large(mt_arena *a, int i)
{
    switch (i) {
    case 0:
        return mt_arena_alloc(a, SIZE_MAX, 1);
    case 1:
        return mt_arena_alloc(a, SIZE_MAX / 2, 3);
    case 2:
        return mt_arena_alloc(a, 2, SIZE_MAX / 2 + 1); /* the product wraps to 0 */
    case 3:
        return mt_arena_f64(a, SIZE_MAX / 8, 9);
    case 4:
        return mt_arena_f64(a, SIZE_MAX / 2 + 1, 2); /* m * n wraps to 0 */
    case 5:
        return mt_arena_int(a, SIZE_MAX / 2);
    default:
        return mt_arena_strndup(a, "", SIZE_MAX);
    }
}

static void arena__products_that_wrap_give_null(mt_test *t)
{
    mt_arena a;
    REQUIRE(t, mt_arena_init(&a, 0, NULL) == MT_OK);
    for (int i = 0; i < N_TOO_LARGE; i++) {
        mt_test_row(t, "request %d", i);
        CHECK(t, too_large(&a, i) == NULL);
        CHECK_INT(t, mt_arena_check(&a, NULL), MT_E_MEMORY);
        mt_arena_clear(&a);
    }
    CHECK_INT(t, a.used, 0);
    mt_arena_free(&a);
}

static void arena__after_a_request_that_failed_every_one_fails(mt_test *t)
{
    mt_arena a;
    mt_err err = {.code = MT_OK};
    REQUIRE(t, mt_arena_init(&a, 0, NULL) == MT_OK);
    const mt_arena_mark mark = mt_arena_get_mark(&a);
    for (int i = 0; i < N_TOO_LARGE; i++) {
        mt_test_row(t, "request %d", i);
        int capacity = 8;
        int items[8] = {0};
        CHECK_INT(t, mt_arena_check(&a, &err), MT_OK);
        CHECK(t, too_large(&a, i) == NULL);
        CHECK(t, mt_arena_failed(&a));
        CHECK(t, mt_arena_alloc(&a, 1, 1) == NULL && mt_arena_f64(&a, 1, 1) == NULL);
        CHECK(t, mt_arena_int(&a, 1) == NULL && mt_arena_strdup(&a, NULL) == NULL);
        CHECK(t, mt_arena_strndup(&a, NULL, 1) == NULL);
        CHECK(t, mt_arena_printf(&a, "%d", 1) == NULL);
        CHECK(t, mt_arena_grow(&a, items, 1, &capacity, sizeof *items) == NULL);
        CHECK_INT(t, capacity, 8);
        CHECK_INT(t, a.used, 0);
        CHECK_INT(t, mt_arena_check(&a, &err), MT_E_MEMORY);
        CHECK_STR(t, err.text, "out of memory");
        mt_arena_rewind(&a, mark);
    }
    mt_arena_free(&a);
}

/* What happened to the arena before a rewind: a failure ends with it only if it was told and
 * the mark is older. */
static void arena__a_rewind_loses_no_failure_that_was_not_told(mt_test *t)
{
    static const struct {
        const char *name;
        bool before; /* a request failed before the mark was taken */
        bool after;
        bool told;
        bool failed; /* after the rewind */
    } rows[] = {
        {"nothing failed", false, false, false, false},
        {"nothing failed, and was asked", false, false, true, false},
        {"failed since the mark", false, true, false, true},
        {"failed since the mark, told", false, true, true, false},
        {"failed before the mark", true, false, false, true},
        {"failed before the mark, told", true, false, true, true},
        {"failed before and since", true, true, true, true},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_arena a;
        mt_test_row(t, "%s", rows[i].name);
        REQUIRE(t, mt_arena_init(&a, 0, NULL) == MT_OK);
        if (rows[i].before) {
            mt_arena_fail(&a);
        }
        const mt_arena_mark mark = mt_arena_get_mark(&a);
        if (rows[i].after) {
            mt_arena_fail(&a);
        }
        if (rows[i].told) {
            (void)mt_arena_check(&a, NULL);
        }
        CHECK_INT(t, mt_arena_failed(&a), rows[i].before || rows[i].after);
        mt_arena_rewind(&a, mark);
        CHECK_INT(t, mt_arena_failed(&a), rows[i].failed);
        CHECK_INT(t, mt_arena_alloc(&a, 1, 1) == NULL, rows[i].failed);
        (void)mt_arena_check(&a, NULL);
        mt_arena_clear(&a);
        CHECK(t, !mt_arena_failed(&a));
        mt_arena_free(&a);
        CHECK(t, mt_arena_alloc(&a, 1, 1) != NULL);
        mt_arena_free(&a);
    }
}

static void arena__zero_products_give_pointers_of_their_own(mt_test *t)
{
    mt_arena a;
    REQUIRE(t, mt_arena_init(&a, 0, NULL) == MT_OK);
    const void *const p = mt_arena_alloc(&a, 0, 8);
    const void *const q = mt_arena_f64(&a, 5, 0);
    CHECK(t, p != NULL && q != NULL && p != q);
    mt_arena_free(&a);
}

/* A loop that allocates across several blocks, run again after a rewind. */
static void *fill(mt_arena *a)
{
    (void)mt_arena_alloc(a, 900, 1);
    (void)mt_arena_alloc(a, 5000, 1);
    (void)mt_arena_alloc(a, 100, 1);
    unsigned char *const last = mt_arena_alloc(a, 600, 1);
    memset(last, 0xFF, 600);
    return last;
}

static void arena__rewind_gives_the_same_memory_again_zeroed(mt_test *t)
{
    mt_arena a;
    REQUIRE(t, mt_arena_init(&a, 1024, NULL) == MT_OK);
    (void)mt_arena_alloc(&a, 10, 1);
    const mt_arena_mark mark = mt_arena_get_mark(&a);
    const void *const first = fill(&a);
    const size_t used = a.used;
    for (int round = 0; round < 3; round++) {
        mt_test_row(t, "round %d", round);
        mt_arena_rewind(&a, mark);
        CHECK_INT(t, a.used, MT_ALIGN);
        CHECK(t, fill(&a) == first);
        CHECK_INT(t, a.used, used);
        CHECK_INT(t, a.peak, used);
    }
    mt_arena_rewind(&a, mark);
    (void)mt_arena_alloc(&a, 900, 1);
    (void)mt_arena_alloc(&a, 5000, 1);
    (void)mt_arena_alloc(&a, 100, 1);
    CHECK(t, all_zero(mt_arena_alloc(&a, 600, 1), 600));
    mt_arena_free(&a);
}

static void arena__works_from_all_zero_and_frees_twice(mt_test *t)
{
    mt_arena a = {0};
    mt_arena_free(&a);
    const mt_arena_mark empty = mt_arena_get_mark(&a);
    const char *const p = mt_arena_strdup(&a, "text");
    CHECK_STR(t, p, "text");
    mt_arena_rewind(&a, empty);
    CHECK(t, mt_arena_strdup(&a, "other") == p);
    mt_arena_free(&a);
    mt_arena_free(&a);
    CHECK(t, a.first == NULL);
}

static void arena__text_is_copied_and_formatted(mt_test *t)
{
    mt_arena a;
    REQUIRE(t, mt_arena_init(&a, 0, NULL) == MT_OK);
    CHECK_STR(t, mt_arena_strndup(&a, "stiffness", 5), "stiff");
    CHECK_STR(t, mt_arena_printf(&a, "%s.k%d", "beam", 3), "beam.k3");
    mt_arena_free(&a);
}

static void arena__grow_doubles_and_keeps_the_items(mt_test *t)
{
    enum { N = 1000 };
    mt_arena a;
    REQUIRE(t, mt_arena_init(&a, 0, NULL) == MT_OK);
    int *items = NULL;
    int capacity = 0;
    int moves = 0;
    for (int i = 0; i < N; i++) {
        int *const grown = mt_arena_grow(&a, items, i, &capacity, sizeof *items);
        REQUIRE(t, grown != NULL && capacity > i);
        moves += grown != items;
        items = grown;
        items[i] = 3 * i;
    }
    bool kept = true;
    for (int i = 0; i < N; i++) {
        kept = kept && items[i] == 3 * i;
    }
    CHECK(t, kept);
    CHECK(t, moves <= 8); /* 8, 16, ..., 1024 */
    capacity = INT_MAX;
    CHECK(t, mt_arena_grow(&a, items, INT_MAX, &capacity, sizeof *items) == NULL);
    CHECK_INT(t, capacity, INT_MAX);
    mt_arena_free(&a);
}

/* All bytes from p on that belong to nobody: those behind an allocation, in its zone. */
static bool poisoned(const void *p, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (!POISONED((const unsigned char *)p + i)) {
            return false;
        }
    }
    return true;
}

static void arena__bytes_that_nobody_asked_for_are_poisoned(mt_test *t)
{
    enum { LEAST = 64 };
    static const size_t sizes[][2] = {{0, 120}, {1, 1},   {7, 1},   {1, 64},
                                      {3, 24},  {5, 200}, {900, 8}, {1, 999}};
    mt_arena a;
    REQUIRE(t, mt_arena_init(&a, 1024, NULL) == MT_OK);
    const mt_arena_mark mark = mt_arena_get_mark(&a);
    for (int i = 0; i < MT_COUNT(sizes); i++) {
        mt_test_row(t, "%zu items of %zu bytes", sizes[i][0], sizes[i][1]);
        const size_t bytes = sizes[i][0] * sizes[i][1];
        const unsigned char *const p = mt_arena_alloc(&a, sizes[i][0], sizes[i][1]);
        REQUIRE(t, p != NULL);
        CHECK(t, mt_arena_alloc(&a, 64, 1) != NULL); /* the next one is not reached */
        CHECK(t, bytes == 0 || all_zero(p, bytes));
        CHECK(t, poisoned(p + bytes, sizes[i][1] > LEAST ? sizes[i][1] : LEAST));
        CHECK(t, poisoned(p - LEAST, LEAST));
        mt_arena_rewind(&a, mark);
        CHECK(t, poisoned(p, bytes + sizes[i][1]));
    }
    mt_arena_free(&a);
}

static void arena__what_has_grown_away_is_poisoned(mt_test *t)
{
    mt_arena a;
    REQUIRE(t, mt_arena_init(&a, 0, NULL) == MT_OK);
    int capacity = 0;
    int *const few = mt_arena_grow(&a, NULL, 0, &capacity, sizeof *few);
    REQUIRE(t, few != NULL);
    const int n = capacity;
    int *const more = mt_arena_grow(&a, few, n, &capacity, sizeof *more);
    REQUIRE(t, more != NULL && more != few);
    CHECK(t, poisoned(few, (size_t)n * sizeof *few));
    CHECK_INT(t, more[n], 0);
    mt_arena_free(&a);
}

MT_TEST_MAIN(MT_TEST(arena__memory_is_aligned_zeroed_and_apart),
             MT_TEST(arena__products_that_wrap_give_null),
             MT_TEST(arena__after_a_request_that_failed_every_one_fails),
             MT_TEST(arena__a_rewind_loses_no_failure_that_was_not_told),
             MT_TEST(arena__zero_products_give_pointers_of_their_own),
             MT_TEST(arena__rewind_gives_the_same_memory_again_zeroed),
             MT_TEST(arena__works_from_all_zero_and_frees_twice),
             MT_TEST(arena__text_is_copied_and_formatted),
             MT_TEST(arena__grow_doubles_and_keeps_the_items),
             MT_TEST(arena__bytes_that_nobody_asked_for_are_poisoned),
             MT_TEST(arena__what_has_grown_away_is_poisoned))
