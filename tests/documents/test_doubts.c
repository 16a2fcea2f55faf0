/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Doubts are found under the same promise as everything else: no leak, no crash, whichever
 * allocation fails. What they say is tested by tests/cli/test_doubts.py. */
#include <unistd.h>

#include "answer/examine.h"
#include "answer/warnings.h"
#include "mt_alloc.h"
#include "mt_test.h"
#include "study/read.h"

static mt_status examine(const char *name, int *found)
{
    mt_err err = {.text = ""};
    mt_study *study = NULL;
    mt_arena mem = {0};
    mt_status rc = mt_study_load(name, NULL, &study, NULL, &err);
    rc = rc == MT_OK ? mt_arena_init(&mem, 0, &err) : rc;
    if (rc == MT_OK) {
        mt_warning_list list = mt_warning_list_default(&mem);
        rc = mt_study_examine(study, NULL, HUGE_VAL, &list, &err);
        *found = list.n;
    }
    mt_arena_free(&mem);
    mt_study_delete(study);
    return rc;
}

static void doubts__every_failing_allocation_is_survived(mt_test *t)
{
    static const struct {
        const char *name;
        int found;
    } rows[] = {
        {"six_masses_bands.json", 0},
        {"inceptor_stick.json", 2} /* it floats, and bends about one axis */
    };
    REQUIRE(t, chdir(MT_TEST_SOURCE_DIR "/studies") == 0);
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_status rc = MT_E_MEMORY;
        int found = -1;
        for (long nth = 0; rc == MT_E_MEMORY && mt_alloc_works(); nth++) {
            const long before = mt_alloc_live();
            mt_test_row(t, "%s, allocation %ld", rows[i].name, nth);
            mt_alloc_fail_after(nth);
            rc = examine(rows[i].name, &found);
            mt_alloc_fail_after(-1);
            CHECK(t, rc == MT_OK || rc == MT_E_MEMORY);
            CHECK_INT(t, mt_alloc_live(), before);
        }
        CHECK(t, rc == MT_OK || !mt_alloc_works());
        CHECK(t, found == rows[i].found || !mt_alloc_works());
    }
}

MT_TEST_MAIN(MT_TEST(doubts__every_failing_allocation_is_survived))
