/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Doubts are found under the same promise as everything else: no leak, no crash, whichever
 * allocation fails. What they say is tested by tests/cli/test_doubts.py. */
#include <unistd.h>

#include "answer/examine.h"
#include "answer/warnings.h"
#include "mt_refusals.h"
#include "study/read.h"

typedef struct examined {
    const char *name;
    int *found;
} examined;

static mt_status examine(mt_test *t, const void *context)
{
    const examined *const e = context;
    mt_err err = {.text = ""};
    mt_study *study = NULL;
    mt_arena mem = {0};
    mt_status rc = mt_study_load(e->name, NULL, &study, NULL, &err);
    rc = rc == MT_OK ? mt_arena_init(&mem, 0, &err) : rc;
    if (rc == MT_OK) {
        mt_warning_list list = mt_warning_list_default(&mem);
        rc = mt_study_examine(study, NULL, HUGE_VAL, &list, &err);
        *e->found = list.n;
    }
    (void)t;
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
        int found = -1;
        const examined e = {rows[i].name, &found};
        mt_refuse_each(t, e.name, examine, &e, MT_OK);
        CHECK_INT(t, found, rows[i].found);
    }
}

MT_TEST_MAIN(MT_TEST(doubts__every_failing_allocation_is_survived))
