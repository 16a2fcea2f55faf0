/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modetune/study.h"

#include <stdatomic.h>
#include <stddef.h>

int mt_wish_at(void *wish)
{
    /* the int of a caller who sees to it, or whose language does, that it is written at once */
    return wish == NULL ? MT_WISH_NONE : atomic_load((atomic_int *)wish);
}
