/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The k-th allocation fails, for every k: whatever runs out of memory says so, and nothing
 * leaks. The two files of src/base that touch the heap are compiled into this test with an
 * allocator of its own; that works under every sanitizer, which interposing malloc in the whole
 * program would not.
 */
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/base.h"
#include "base/diagnostics.h"
#include "support/mt_test.h"

static long fail_after; /* allocations that still succeed; negative: all */
static long live_blocks;

static void *counted_realloc(void *p, size_t size)
{
    if (fail_after == 0) {
        return NULL;
    }
    fail_after -= fail_after > 0;
    void *const q = realloc(p, size);
    live_blocks += p == NULL && q != NULL;
    return q;
}

static void *counted_malloc(size_t size)
{
    return counted_realloc(NULL, size);
}

static void counted_free(void *p)
{
    live_blocks -= p != NULL;
    free(p);
}

#define malloc  counted_malloc
#define realloc counted_realloc
#define free    counted_free
#include "base/arena.c" /* NOLINT(bugprone-suspicious-include) */
#include "base/text.c"  /* NOLINT(bugprone-suspicious-include) */
#undef malloc
#undef realloc
#undef free

static mt_status use_arena(mt_err *err)
{
    mt_arena a;
    mt_status rc = mt_arena_init(&a, 256, err);
    if (rc != MT_OK) {
        return rc;
    }
    int capacity = 0;
    int *items = NULL;
    for (int i = 0; i < 500; i++) {
        int *const grown = mt_arena_grow(&a, items, i, &capacity, sizeof *items);
        if (grown == NULL) {
            rc = mt_arena_check(&a, err);
            goto done;
        }
        items = grown;
        items[i] = i;
    }
    (void)mt_arena_f64(&a, 20, 20);
    (void)mt_arena_printf(&a, "%300d", 1);
    (void)mt_arena_strdup(&a, "name");
    rc = mt_arena_check(&a, err);
done:
    mt_arena_free(&a);
    return rc;
}

static mt_status use_text(mt_err *err)
{
    mt_text text = {0};
    for (int i = 0; i < 200; i++) {
        mt_text_addf(&text, "%d;", i);
        mt_text_add(&text, "a line of text\n");
    }
    const mt_status rc = text.failed ? mt_fail_memory(err) : MT_OK;
    mt_text_free(&text);
    return rc;
}

static mt_status use_diags(mt_err *err)
{
    mt_arena a;
    MT_TRY(mt_arena_init(&a, 128, err));
    mt_diags d = mt_diags_default(&a);
    for (int i = 0; i < 40; i++) {
        mt_diag_error(&d, i, "problem %d", i);
    }
    /* all are counted, whether or not there was memory to keep them */
    mt_status rc = d.errors == 40 ? MT_OK : MT_E_INTERNAL;
    if (mt_arena_failed(&a)) {
        rc = mt_arena_check(&a, err);
    } else if (d.count != 40) {
        rc = MT_E_INTERNAL;
    }
    mt_arena_free(&a);
    return rc;
}

static void memory__every_failing_allocation_is_reported_and_nothing_leaks(mt_test *t)
{
    static const struct {
        const char *name;
        mt_status (*use)(mt_err *err);
        long least; /* allocations that it makes at least, so that the loop means something */
    } rows[] = {
        {"arena", use_arena, 4},
        {"text", use_text, 3},
        {"diags", use_diags, 4},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        for (long nth = 0;; nth++) {
            mt_test_row(t, "%s, allocation %ld fails", rows[i].name, nth);
            mt_err err = {.code = MT_OK};
            fail_after = nth;
            const mt_status rc = rows[i].use(&err);
            CHECK_INT(t, live_blocks, 0);
            if (rc == MT_OK) {
                CHECK(t, nth >= rows[i].least);
                break;
            }
            CHECK_INT(t, rc, MT_E_MEMORY);
            CHECK_STR(t, err.text, "out of memory");
        }
    }
    fail_after = -1;
}

static void memory__a_loop_that_has_run_once_allocates_nothing_more(mt_test *t)
{
    mt_arena a;
    fail_after = -1;
    REQUIRE(t, mt_arena_init(&a, 512, NULL) == MT_OK);
    const mt_arena_mark mark = mt_arena_get_mark(&a);
    for (int round = 0; round < 4; round++) {
        mt_test_row(t, "round %d", round);
        bool all = true;
        for (size_t n = 1; n < 3000; n = 2 * n + 7) {
            all = all && mt_arena_f64(&a, n, 1) != NULL;
        }
        CHECK(t, all);
        mt_arena_rewind(&a, mark);
        fail_after = 0; /* from now on every allocation would fail */
    }
    fail_after = -1;
    mt_arena_free(&a);
    CHECK_INT(t, live_blocks, 0);
}

MT_TEST_MAIN(MT_TEST(memory__every_failing_allocation_is_reported_and_nothing_leaks),
             MT_TEST(memory__a_loop_that_has_run_once_allocates_nothing_more))
