/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_KIND_H
#define EXPR_KIND_H

#include <stddef.h>

#include "expr/expr.h"
#include "expr/units.h"

/*
 * Physical kind of an expression, for lengths, angles and speeds. In a file with units other
 * than SI, expressions are still in SI, so a bare number added to a length is suspicious: "L +
 * 50" adds 50 m, "L + 50*mm" adds 50 mm. Products and quotients by numbers keep the kind, sums
 * and the like have the kind of their parts; any other combination is unknown and not checked.
 */
typedef enum mt_kind {
    MT_KIND_NUMBER, /* from numbers without a unit */
    MT_KIND_ZERO,   /* 0, which is 0 in every unit */
    MT_KIND_PI,     /* a number or an angle */
    MT_KIND_LENGTH,
    MT_KIND_AREA, /* length times length; its square root is a length */
    MT_KIND_ANGLE,
    MT_KIND_SPEED,
    MT_KIND_UNKNOWN
} mt_kind;

mt_kind mt_kind_of_dimension(mt_dimension dimension);

/* The kind of a parameter. */
typedef mt_kind (*mt_kind_lookup)(const void *context, int parameter);

typedef struct mt_kind_found {
    mt_kind kind;
    /* terms of different kinds are added, subtracted or compared: a number with a length or an
     * unknown kind, an angle with a length */
    bool mixed;
    /* the number in question: a term, or the whole expression; NaN: it depends on parameters */
    double bare;
} mt_kind_found;

/* O(length of the expression). */
mt_kind_found mt_expr_kind(const mt_expr *e, mt_kind_lookup lookup, const void *context);
/* Message that a number in SI is suspicious where numbers are in `unit`, which is not SI;
 * `what`: what is in SI ("expressions"). Suggests the form with a unit ("14*mm" for 0.014 m: a
 * value below 1 is taken as SI). */
void mt_kind_bare_text(double number, const mt_unit *unit, const char *what, char *out,
                       size_t size);
/*
 * Message that an expression is suspicious where numbers are in `unit` ("50 is 50 m here ...:
 * write \"50*mm\""), in out[size]. False without a message: it is plausible, or the unit is
 * NULL or SI, where a bare number has no other meaning.
 */
bool mt_kind_complaint(const mt_expr *e, const mt_unit *unit, mt_kind_lookup lookup,
                       const void *context, char *out, size_t size);
enum { MT_KIND_TEXT = 256 }; /* size for every message */

/* Finds the unit of a parameter; false: none given. */
typedef bool (*mt_measures_lookup)(const void *context, int parameter, mt_unit_worth *out);

/*
 * Dimension of an expression from the units of its parameters and constants: powers of m, kg, s
 * (rad is ignored). False where it is not determined: a parameter has no unit, a number may be
 * a quantity (an arm of 0.05; whole numbers up to 12 are factors), or nothing has a unit.
 * O(length).
 */
bool mt_expr_measures(const mt_expr *e, mt_measures_lookup lookup, const void *context,
                      mt_unit_worth *out);

#endif
