/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MT_REFUSALS_H
#define MT_REFUSALS_H

#include "modetune/status.h"

#include "mt_alloc.h"
#include "mt_test.h"

/*
 * `use` bears that each of its allocations is refused in turn: it returns MT_E_MEMORY until
 * none is and it returns what is expected, and whatever it returns, it leaves nothing behind.
 * How many allocations it made; 0 where they cannot be refused, and it is called once.
 */
static inline long mt_refuse_each(mt_test *t, const char *name,
                                  mt_status (*use)(mt_test *t, const void *context),
                                  const void *context, mt_status expected)
{
    long nth = 0;
    if (!mt_alloc_works()) {
        mt_test_row(t, "%s", name);
        CHECK_INT(t, use(t, context), expected);
        return 0;
    }
    for (mt_status rc = MT_E_MEMORY; rc == MT_E_MEMORY; nth++) {
        const long before = mt_alloc_live();
        mt_test_row(t, "%s, allocation %ld", name, nth);
        mt_alloc_fail_after(nth);
        rc = use(t, context);
        mt_alloc_fail_after(-1);
        CHECK(t, rc == expected || rc == MT_E_MEMORY);
        CHECK_INT(t, mt_alloc_live(), before);
    }
    return nth - 1;
}

#endif
