/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modetune/study.h"

#include <stdatomic.h>
#include <stddef.h>

int mt_stop_request_at(void *request)
{
    /* the int of a caller who sees to it, or whose language does, that it is written at once */
    return request == NULL ? MT_STOP_REQUEST_NONE : atomic_load((atomic_int *)request);
}
