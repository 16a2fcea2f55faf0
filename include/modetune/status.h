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
 * says what NULL means; a number must be within the range of its comment. A call with an
 * invalid argument changes nothing, and
 *   - one that returns a status fails with MT_E_USAGE, err naming the argument;
 *   - one that returns a text, a number or a count returns NULL, NaN or 0.
 * Functions that delete accept NULL, and err may be NULL everywhere. On failure an out argument
 * that would own an object is NULL. Not checked are the caller's guarantees: an object is alive
 * (deleted once, not used afterwards), an array has the stated length.
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

/* The request of a caller to work in progress (mt_solve_options). */
typedef enum mt_stop_request {
    MT_STOP_REQUEST_NONE,   /* go on */
    MT_STOP_REQUEST_FINISH, /* end the search, prepare the designs found */
    MT_STOP_REQUEST_END     /* end at once, also while the designs found are being prepared */
} mt_stop_request;

/* The reason of a stop, which the answer states. At a time limit the best design found is still
 * analysed again, however late. */
typedef enum mt_stop_reason {
    MT_STOP_REASON_INTERRUPT,
    MT_STOP_REASON_TIME_LIMIT
} mt_stop_reason;

enum { MT_ERR_TEXT_SIZE = 1024 };

/* The caller's record of a failure: fixed size, no heap. Every `mt_err *` may be NULL. */
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
/* Put the formatted context and ": " before the text in err; nothing where rc is MT_OK or fmt
 * NULL. Returns rc. */
MT_API mt_status mt_err_in(mt_err *err, mt_status rc, const char *fmt, ...) MT_PRINTF(3, 4);

#ifdef __cplusplus
}
#endif

#endif
