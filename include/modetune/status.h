/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODETUNE_STATUS_H
#define MODETUNE_STATUS_H

#include "modetune/export.h"

#include <stdarg.h>

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Arguments, of all functions of the library. A pointer must not be NULL unless its comment
 * says what NULL means; a number must be what its comment says. A call that is given something
 * else changes nothing, and
 *   - one that returns a status fails with MT_E_USAGE, err naming the argument;
 *   - one that answers with a text, a number or a count answers as for what is not there: NULL,
 *     NaN, 0.
 * Functions that delete accept NULL, and err may be NULL everywhere. A failure leaves NULL in
 * an out argument that would own something. What no call can check is the caller's promise:
 * that an object is alive (deleted once, not used after), and that an array is as long as said.
 */

/* One list makes the enum, its names and its texts. A search that ends without meeting its
 * goals is not a failure: outcomes have their own types. */
#define MT_STATUS_LIST(X)                                                   \
    X(MT_OK, "success")                                                     \
    X(MT_E_USAGE, "wrong use of the command line or of a function")         \
    X(MT_E_INPUT, "an input file or value is wrong")                        \
    X(MT_E_NOT_SPD, "a matrix that must be positive definite is not")       \
    X(MT_E_SINGULAR, "a matrix that must be regular is singular")           \
    X(MT_E_ASSEMBLY, "the mechanism cannot be assembled")                   \
    X(MT_E_EQUILIBRIUM, "no equilibrium was found")                         \
    X(MT_E_MASSLESS, "a freedom has neither mass nor stiffness")            \
    X(MT_E_NO_CONVERGENCE, "an iteration did not converge")                 \
    X(MT_E_DOMAIN, "an expression has no finite value at these parameters") \
    X(MT_E_SYSTEM, "the operating system refused (file, disk)")             \
    X(MT_E_MEMORY, "out of memory")                                         \
    X(MT_E_INTERRUPTED, "interrupted")                                      \
    X(MT_E_INTERNAL, "internal error, please report")                       \
    X(MT_E_DEAD_CENTRE, "joints depend on each other in this very position")

#define MT_STATUS_ENUM(name, text) name,
typedef enum mt_status { MT_STATUS_LIST(MT_STATUS_ENUM) MT_STATUS_COUNT } mt_status;
#undef MT_STATUS_ENUM

/* What a caller wants of long work that is under way (mt_solve_options). */
typedef enum mt_stop_request {
    MT_STOP_REQUEST_NONE,   /* go on */
    MT_STOP_REQUEST_FINISH, /* end the search, make what was found ready */
    MT_STOP_REQUEST_END     /* at once, also where what was found is being made ready */
} mt_stop_request;

/* Why he wants it to end, which the answer says. At a time limit the best design that was found
 * is analysed anew, however late. */
typedef enum mt_stop_reason {
    MT_STOP_REASON_INTERRUPT,
    MT_STOP_REASON_TIME_LIMIT
} mt_stop_reason;

enum { MT_ERR_TEXT_SIZE = 1024 };

/* The caller's record of a failure: fixed size, no heap, NULL allowed wherever a `mt_err *` is
 * asked for. */
typedef struct mt_err {
    mt_status code;
    char text[MT_ERR_TEXT_SIZE];
} mt_err;

#if defined(__GNUC__) || defined(__clang__)
#    define MT_PRINTF(fmt, args) __attribute__((format(printf, fmt, args)))
#else
#    define MT_PRINTF(fmt, args)
#endif

/* The general text of a status ("an input file or value is wrong"); never NULL. */
MT_API const char *mt_status_text(mt_status code);
/* The name of a status ("MT_E_INPUT"); never NULL. */
MT_API const char *mt_status_name(mt_status code);
/* Set err (when not NULL) to code and the formatted text; longer text is cut at a character
 * boundary. fmt NULL: the general text of the code. Returns code. */
MT_API mt_status mt_fail(mt_err *err, mt_status code, const char *fmt, ...) MT_PRINTF(3, 4);
/* Put "context: " before the text that is already in err (context formatted); nothing where rc
 * is MT_OK, or fmt NULL. Returns rc unchanged. */
MT_API mt_status mt_err_in(mt_err *err, mt_status rc, const char *fmt, ...) MT_PRINTF(3, 4);

#ifdef __cplusplus
}
#endif

#endif
