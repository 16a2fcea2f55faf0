/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/base.h"

mt_status mt_check_argument(const void *argument, const char *function, const char *name,
                            mt_err *err)
{
    return argument != NULL ? MT_OK
                            : mt_fail(err, MT_E_USAGE, "%s: %s is NULL", function, name);
}
