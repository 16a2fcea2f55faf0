/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_UNITS_H
#define EXPR_UNITS_H

#include <stdbool.h>

/*
 * The units that files may give numbers in, beside SI, which every number is in from its reader
 * on: lengths, angles and speeds everywhere, by constants in expressions, too; others
 * (unit_list.h) as the unit of a parameter. This is the only table of them; factors are exact
 * but for the pi of a degree.
 */
#define MT_DIMENSION_LIST(X)                \
    X(MT_LENGTH, "length", "a length", "m") \
    X(MT_ANGLE, "angle", "an angle", "rad") \
    X(MT_SPEED, "speed", "a speed", "Hz")
#define MT_DIMENSION_ENUM(id, name, text, si) id,
typedef enum mt_dimension {
    MT_DIMENSION_LIST(MT_DIMENSION_ENUM) MT_DIMENSION_COUNT,
    MT_OTHER = MT_DIMENSION_COUNT /* whatever its SI unit says */
} mt_dimension;
#undef MT_DIMENSION_ENUM

/* 1 of it is numerator/denominator of the SI unit. */
typedef struct mt_unit {
    const char *name;     /* in files: "mm" */
    const char *constant; /* in expressions: "mm", "inch"; NULL: none */
    const char *si;       /* "m", "N/m" */
    mt_dimension dimension;
    double numerator;
    double denominator;
} mt_unit;

/* All units, those that have constants first, those of a dimension together, its SI unit before
 * them; last the acceleration g. *n their number. */
const mt_unit *mt_units(int *n);
/* The unit of this name; NULL: none of these. "g" is a gram. */
const mt_unit *mt_unit_find(const char *name);
/* The unit of this name and of this SI unit: "g" and "m/s^2" are the acceleration. */
const mt_unit *mt_unit_find_of(const char *name, const char *si);
const char *mt_dimension_name(mt_dimension dimension); /* "length" */
const char *mt_dimension_text(mt_dimension dimension); /* "a length" */
const char *mt_dimension_si(mt_dimension dimension);   /* "m" */
bool mt_unit_is_si(const mt_unit *unit);
/* The unit of all lengths, angles or speeds of a file may be this one. */
bool mt_unit_is_common(const mt_unit *unit);
/* Its name; of NULL, which is SI, what else it is called (may be NULL). */
const char *mt_unit_name(const mt_unit *unit, const char *si);
/* What its constant is worth: 1 of it in SI. */
double mt_unit_factor(const mt_unit *unit);
/* The same for results, NaN where values are shown as they are (NULL). */
double mt_unit_display(const mt_unit *unit);
/* A number of it in SI, and back; NULL is SI. One rounding where the number times the
 * numerator is exact (of decimal units any, of others one of a few digits; of degrees two):
 * 170 mm is the double next to 0.17, as if that had been written. */
double mt_unit_to_si(const mt_unit *unit, double number);
double mt_unit_from_si(const mt_unit *unit, double value);
/* A number that reads as this value, of as few digits as will do; where none does, the one
 * that comes nearest, which is within a unit of the value's last place. For numbers that are
 * written to files. */
double mt_unit_written(const mt_unit *unit, double value);

#endif
