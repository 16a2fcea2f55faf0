/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LIBRARY_REFUSALS_H
#define LIBRARY_REFUSALS_H

#include "modetune/status.h"

#include "mt_alloc.h"
#include "mt_test.h"

/* `use` bears that each of its allocations is refused in turn, and leaves none behind. */
static inline void bears_refusals(mt_test *t, mt_status (*use)(void))
{
    CHECK_INT(t, use(), MT_OK); /* libraries claim what they keep */
    for (long nth = 0; mt_alloc_works(); nth++) {
        const long before = mt_alloc_live();
        mt_test_row(t, "allocation %ld", nth);
        mt_alloc_fail_after(nth);
        const mt_status rc = use();
        mt_alloc_fail_after(-1);
        CHECK(t, rc == MT_OK || rc == MT_E_MEMORY);
        CHECK_INT(t, mt_alloc_live(), before);
        if (rc == MT_OK) {
            CHECK(t, nth > 10);
            break;
        }
    }
}

#endif
