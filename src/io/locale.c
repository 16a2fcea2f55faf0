/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/locale.h"

#include <locale.h>

#include "base/arena.h"

mt_status mt_locale_plain(mt_status (*f)(void *context, mt_err *err), void *context,
                          mt_err *err)
{
    const locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (c == (locale_t)0) {
        return mt_fail_memory(err);
    }
    const locale_t own = uselocale(c);
    const mt_status rc = f(context, err);
    (void)uselocale(own);
    freelocale(c);
    return rc;
}
