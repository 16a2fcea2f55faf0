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

/*
 * Copy a public options struct, which begins with its size (modetune/read.h), into the struct
 * that this library knows: out[size] bytes including the size; 0 where `given` is shorter or
 * NULL. Fails: MT_E_USAGE with the name of the function, where the size is missing or
 * implausible, or a member unknown to this library is not 0.
 */
mt_status mt_options_take(const char *function, const void *given, size_t size, void *out,
                          mt_err *err);
#define MT_OPTIONS_TAKE(given, out, err) \
    mt_options_take(__func__, (given), sizeof *(out), (out), (err))

/* Commit and compiler that the library was built from; static texts. */
/* "v1.0.0-3-g0123456789ab", without tags "0123456789ab"; "-dirty" where files differed;
 * "unknown" where the sources were not a repository of their own. */
const char *mt_build_commit(void);
/* "GNU 12.2.0" */
const char *mt_build_compiler(void);

#endif
