/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_BASE_H
#define BASE_BASE_H

#include "modetune/status.h"

#include <stddef.h>

/* Return the status of a failing call at once. Banned once a function owns a resource (use goto done). */
#define MT_TRY(call)                        \
    do {                                    \
        const mt_status mt_try_rc = (call); \
        if (mt_try_rc != MT_OK) {           \
            return mt_try_rc;               \
        }                                   \
    } while (0)

#define MT_COUNT(array) ((int)(sizeof(array) / sizeof((array)[0])))

#endif
