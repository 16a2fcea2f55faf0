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

/* Of a public function: MT_E_USAGE with its name and the argument's where that is NULL. */
mt_status mt_check_argument(const void *argument, const char *function, const char *name,
                            mt_err *err);
#define MT_NOT_NULL(argument, err) \
    MT_TRY(mt_check_argument((argument), __func__, #argument, (err)))

/* True where this failure ends the work, instead of telling something about what was tried (a
 * design without an equilibrium). Memory that is out must never be taken for an answer. */
static inline bool mt_is_final(mt_status rc)
{
    return rc == MT_E_MEMORY || rc == MT_E_INTERNAL;
}
/* What the end of one try, with its own text, means for the work: the failure where it is
 * final, else MT_OK. */
static inline mt_status mt_pass_final(mt_status rc, const mt_err *own, mt_err *err)
{
    return mt_is_final(rc) ? mt_fail(err, rc, "%s", own->text) : MT_OK;
}

/* A function whose divisions by zero are meant as IEEE 754 has them (x / 0 is infinite, 0 / 0
 * NaN), because those who use the quotient look whether it is finite. */
#if defined(__GNUC__) || defined(__clang__)
#    define MT_DIVIDES_BY_ZERO __attribute__((no_sanitize("float-divide-by-zero")))
#else
#    define MT_DIVIDES_BY_ZERO
#endif

#define MT_COUNT(array) ((int)(sizeof(array) / sizeof((array)[0])))

#endif
