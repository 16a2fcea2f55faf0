/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Allocations are counted and fail when they are told to, wherever they can be seen at all. */
#include <stdlib.h>
#include <string.h>

#include "mt_alloc.h"
#include "mt_test.h"

static void alloc__blocks_are_counted(mt_test *t)
{
    if (!mt_alloc_works()) {
        CHECK(t, !mt_alloc_works()); /* and stays so */
        /* elsewhere all tests of shortages would look at nothing */
        CHECK(t, getenv("MT_INSTRUMENTED") != NULL || getenv("MT_TEST_LAUNCHED") != NULL);
        return;
    }
    const long live = mt_alloc_live();
    const long count = mt_alloc_count();
    void *blocks[4] = {malloc(8), calloc(2, 8), aligned_alloc(64, 64), strdup("text")};
    CHECK_INT(t, mt_alloc_live(), live + 4);
    void *const grown = realloc(blocks[0], 1000);
    CHECK_INT(t, mt_alloc_live(), live + 4);
    CHECK_INT(t, mt_alloc_count(), count + 5);
    blocks[0] = grown != NULL ? grown : blocks[0];
    for (int i = 0; i < 4; i++) {
        free(blocks[i]);
    }
    free(NULL);
    CHECK_INT(t, mt_alloc_live(), live);
}

static void alloc__the_nth_fails(mt_test *t)
{
    if (!mt_alloc_works()) {
        mt_alloc_fail_after(0);
        void *const block = malloc(8);
        mt_alloc_fail_after(-1);
        CHECK(t, block != NULL);
        free(block);
        return;
    }
    mt_alloc_fail_after(1);
    void *blocks[4] = {malloc(8), malloc(8), calloc(1, 8), strdup("made inside the C library")};
    mt_alloc_fail_after(-1);
    void *const after = malloc(8);
    CHECK(t, blocks[0] != NULL && after != NULL);
    CHECK(t, blocks[1] == NULL && blocks[2] == NULL && blocks[3] == NULL);
    for (int i = 0; i < 4; i++) {
        free(blocks[i]);
    }
    free(after);
}

MT_TEST_MAIN(MT_TEST(alloc__blocks_are_counted), MT_TEST(alloc__the_nth_fails))
