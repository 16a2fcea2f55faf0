/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_UNITS_H
#define EXPR_UNITS_H

#include <stdbool.h>

/*
 * Units of numbers in files. Readers convert to SI at once. Lengths, angles and speeds may have
 * other units everywhere, also by constants in expressions; the units of unit_list.h only as
 * the unit of a parameter. This is the only table of them; factors are exact except for the pi
 * of a degree.
 */
#define MT_DIMENSION_LIST(X)                \
    X(MT_LENGTH, "length", "a length", "m") \
    X(MT_ANGLE, "angle", "an angle", "rad") \
    X(MT_SPEED, "speed", "a speed", "Hz")
#define MT_DIMENSION_ENUM(id, name, text, si) id,
typedef enum mt_dimension {
    MT_DIMENSION_LIST(MT_DIMENSION_ENUM) MT_DIMENSION_COUNT,
    MT_OTHER = MT_DIMENSION_COUNT /* see its SI unit */
} mt_dimension;
#undef MT_DIMENSION_ENUM

/* 1 of the unit is numerator/denominator of the SI unit. */
typedef struct mt_unit {
    const char *name;     /* in files: "mm" */
    const char *constant; /* in expressions: "mm", "inch"; NULL: none */
    const char *si;       /* "m", "N/m" */
    mt_dimension dimension;
    double numerator;
    double denominator;
} mt_unit;

/* All units: those with constants first, by dimension with the SI unit first; the acceleration
 * g last. *n their number. */
const mt_unit *mt_units(int *n);
/* The unit of this name; NULL: unknown. "g" is a gram. */
const mt_unit *mt_unit_find(const char *name);
/* The unit with this name and this SI unit: "g" with "m/s^2" is the acceleration. */
const mt_unit *mt_unit_find_of(const char *name, const char *si);
const char *mt_dimension_name(mt_dimension dimension); /* "length" */
const char *mt_dimension_text(mt_dimension dimension); /* "a length" */
const char *mt_dimension_si(mt_dimension dimension);   /* "m" */
bool mt_unit_is_si(const mt_unit *unit);
/* True where a file may declare this as the unit of all its lengths, angles or speeds. */
bool mt_unit_is_common(const mt_unit *unit);
/* Name of the unit; for NULL, which is SI, the text si (may be NULL). */
const char *mt_unit_name(const mt_unit *unit, const char *si);
/* Value of 1 of the unit in SI, as its constant in expressions. */
double mt_unit_factor(const mt_unit *unit);
/* The same for results; NaN for NULL, where values are shown unchanged. */
double mt_unit_display(const mt_unit *unit);
/* Convert a number of the unit to SI, and back; NULL is SI. One rounding where the number times
 * the numerator is exact (decimal units: always; others: numbers of a few digits; degrees: two
 * roundings): 170 mm is the double nearest to 0.17, as if written so. */
double mt_unit_to_si(const mt_unit *unit, double number);
double mt_unit_from_si(const mt_unit *unit, double value);
/* The number with the fewest digits that reads back as this value; if none does, the nearest
 * one, within a unit of the value's last place. For numbers written to files. */
double mt_unit_written(const mt_unit *unit, double value);

#endif
