/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_BASE_H
#define BASE_BASE_H

#include "modetune/status.h"

#include <stdbool.h>
#include <stddef.h>

/* Return the status of a failing call at once. Banned once a function owns a resource (use goto
 * done). */
#define MT_TRY(call)                        \
    do {                                    \
        const mt_status mt_try_rc = (call); \
        if (mt_try_rc != MT_OK) {           \
            return mt_try_rc;               \
        }                                   \
    } while (0)

/* For public functions: MT_E_USAGE with the names of the function and the argument where the
 * argument is NULL. */
mt_status mt_check_argument(const void *argument, const char *function, const char *name,
                            mt_err *err);
#define MT_NOT_NULL(argument, err) \
    MT_TRY(mt_check_argument((argument), __func__, #argument, (err)))

/* True where this failure ends the work. Other failures are results of one trial (a design
 * without an equilibrium). A lack of memory must never be taken for a result. */
static inline bool mt_is_final(mt_status rc)
{
    return rc == MT_E_MEMORY || rc == MT_E_INTERNAL;
}
/* The status of the work after a trial that ended with rc and its own text: rc where it is
 * final, otherwise MT_OK. */
static inline mt_status mt_pass_final(mt_status rc, const mt_err *own, mt_err *err)
{
    return mt_is_final(rc) ? mt_fail(err, rc, "%s", own->text) : MT_OK;
}

/* Marks a function that divides by zero on purpose, by the rules of IEEE 754 (x / 0 is
 * infinite, 0 / 0 NaN); its callers check whether the quotient is finite. */
#if defined(__GNUC__) || defined(__clang__)
#    define MT_DIVIDES_BY_ZERO __attribute__((no_sanitize("float-divide-by-zero")))
#else
#    define MT_DIVIDES_BY_ZERO
#endif

#define MT_COUNT(array) ((int)(sizeof(array) / sizeof((array)[0])))

#endif
