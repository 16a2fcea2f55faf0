/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names that others have replaced still mean the same. */
#include "modetune/deprecated.h"

#include "mt_test.h"

static void deprecated__old_names_mean_the_new_ones(mt_test *t)
{
    int request = MT_WISH_FINISH;
    mt_wish asked = MT_WISH_NONE;
    mt_cause reason = MT_CAUSE_TIME_LIMIT;
    CHECK_INT(t, (int)asked, MT_STOP_REQUEST_NONE);
    CHECK_INT(t, (int)reason, MT_STOP_REASON_TIME_LIMIT);
    CHECK_INT(t, mt_wish_at(&request), MT_STOP_REQUEST_FINISH);
    CHECK_INT(t, MT_WISH_END, MT_STOP_REQUEST_END);
    CHECK_INT(t, MT_CAUSE_INTERRUPT, MT_STOP_REASON_INTERRUPT);
}

MT_TEST_MAIN(MT_TEST(deprecated__old_names_mean_the_new_ones))
