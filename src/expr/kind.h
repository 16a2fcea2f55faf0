/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_KIND_H
#define EXPR_KIND_H

#include <stddef.h>

#include "expr/expr.h"
#include "expr/units.h"

/*
 * What an expression measures, as far as lengths, angles and speeds go: where numbers may be in
 * other units than SI, an expression (which is always in SI) must not hold a number that looks
 * like one of those. "L + 50" is 50 m longer than L, "50" is 50 m: they are told from
 * "L + 50*mm". Products and quotients by numbers keep the kind, sums and the like have that of
 * their parts, anything else is not known and not judged.
 */
typedef enum mt_kind {
    MT_KIND_NUMBER, /* made of numbers without a unit */
    MT_KIND_ZERO,   /* 0, which is 0 in every unit */
    MT_KIND_PI,     /* a number, and an angle */
    MT_KIND_LENGTH,
    MT_KIND_AREA, /* a length times a length: the root of one is a length */
    MT_KIND_ANGLE,
    MT_KIND_SPEED,
    MT_KIND_UNKNOWN
} mt_kind;

mt_kind mt_kind_of_dimension(mt_dimension dimension);

/* The kind of a parameter. */
typedef mt_kind (*mt_kind_lookup)(const void *context, int parameter);

typedef struct mt_kind_found {
    mt_kind kind;
    /* something is added to, subtracted from or compared with what is of another kind: a number
     * with a length, a number with what is not known, an angle with a length */
    bool mixed;
    /* the number that is mixed in, or that all of it is; NaN: it follows parameters */
    double bare;
} mt_kind_found;

/* O(length of the expression). */
mt_kind_found mt_expr_kind(const mt_expr *e, mt_kind_lookup lookup, const void *context);
/* Why a number cannot be meant in an expression where numbers are in this unit, which is not of
 * SI: what it is, since these are, and how that is written ("14*mm" of 0.014 m: below 1, it
 * looks like SI). */
void mt_kind_bare_text(double number, const mt_unit *unit, const char *what, char *out,
                       size_t size);
/*
 * Why an expression cannot be meant where numbers are in this unit ("50 is 50 m here ...: write
 * \"50*mm\""), in out[size]. False, and nothing written: it can be, or the unit is NULL or SI,
 * where a number alone has no other meaning.
 */
bool mt_kind_complaint(const mt_expr *e, const mt_unit *unit, mt_kind_lookup lookup,
                       const void *context, char *out, size_t size);
enum { MT_KIND_TEXT = 256 }; /* size that holds every complaint */

#endif
