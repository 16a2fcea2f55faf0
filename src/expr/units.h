/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_UNITS_H
#define EXPR_UNITS_H

#include <stdbool.h>
#include <stddef.h>

/*
 * Units of numbers in files. Readers convert to SI at once. Lengths, angles and speeds may have
 * other units everywhere, also by constants in expressions; the units of MT_UNIT_LIST only as
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

/*
 * Units of parameters that are not constants of expressions, because parameters may be called t
 * or g: name, SI unit, dimension, numerator, denominator. They follow from lb = 0.45359237 kg,
 * in = 0.0254 m, ft = 12 in, g = 9.80665 m/s^2, lbf = lb g, kip = 1000 lbf, slug = lbf s^2/ft,
 * all exact (NIST SP 811), as fractions in lowest terms of exact doubles; DEG, a degree in rad,
 * is not exact.
 */
#define MT_UNIT_LIST(X)                                                      \
    X("mg", "kg", MT_OTHER, 1.0, 1e6)                                        \
    X("g", "kg", MT_OTHER, 1.0, 1000.0)                                      \
    X("t", "kg", MT_OTHER, 1000.0, 1.0)                                      \
    X("oz", "kg", MT_OTHER, 45359237.0, 16e8)                                \
    X("lb", "kg", MT_OTHER, 45359237.0, 1e8)                                 \
    X("slug", "kg", MT_OTHER, 8896443230521.0, 6096e8)                       \
    X("lbf s^2/in", "kg", MT_OTHER, 8896443230521.0, 508e8)                  \
    X("g/mm", "kg/m", MT_OTHER, 1.0, 1.0)                                    \
    X("g/m", "kg/m", MT_OTHER, 1.0, 1000.0)                                  \
    X("kg/mm", "kg/m", MT_OTHER, 1000.0, 1.0)                                \
    X("lb/in", "kg/m", MT_OTHER, 45359237.0, 254e4)                          \
    X("lb/ft", "kg/m", MT_OTHER, 45359237.0, 3048e4)                         \
    X("g/m^2", "kg/m^2", MT_OTHER, 1.0, 1000.0)                              \
    X("g/cm^2", "kg/m^2", MT_OTHER, 10.0, 1.0)                               \
    X("kg/mm^2", "kg/m^2", MT_OTHER, 1e6, 1.0)                               \
    X("lb/ft^2", "kg/m^2", MT_OTHER, 45359237.0, 9290304.0)                  \
    X("g/cm^3", "kg/m^3", MT_OTHER, 1000.0, 1.0)                             \
    X("kg/dm^3", "kg/m^3", MT_OTHER, 1000.0, 1.0)                            \
    X("t/m^3", "kg/m^3", MT_OTHER, 1000.0, 1.0)                              \
    X("g/mm^3", "kg/m^3", MT_OTHER, 1e6, 1.0)                                \
    X("kg/cm^3", "kg/m^3", MT_OTHER, 1e6, 1.0)                               \
    X("kg/mm^3", "kg/m^3", MT_OTHER, 1e9, 1.0)                               \
    X("t/mm^3", "kg/m^3", MT_OTHER, 1e12, 1.0)                               \
    X("lb/in^3", "kg/m^3", MT_OTHER, 56699046250.0, 2048383.0)               \
    X("lb/ft^3", "kg/m^3", MT_OTHER, 28349523125.0, 1769802912.0)            \
    X("slug/ft^3", "kg/m^3", MT_OTHER, 5560277019075625.0, 10788718551552.0) \
    X("g mm", "kg m", MT_OTHER, 1.0, 1e6)                                    \
    X("g cm", "kg m", MT_OTHER, 1.0, 1e5)                                    \
    X("g m", "kg m", MT_OTHER, 1.0, 1000.0)                                  \
    X("kg mm", "kg m", MT_OTHER, 1.0, 1000.0)                                \
    X("kg cm", "kg m", MT_OTHER, 1.0, 100.0)                                 \
    X("lb in", "kg m", MT_OTHER, 5760623099.0, 5e11)                         \
    X("lb ft", "kg m", MT_OTHER, 17281869297.0, 125e9)                       \
    X("g mm^2", "kg m^2", MT_OTHER, 1.0, 1e9)                                \
    X("g cm^2", "kg m^2", MT_OTHER, 1.0, 1e7)                                \
    X("kg mm^2", "kg m^2", MT_OTHER, 1.0, 1e6)                               \
    X("kg cm^2", "kg m^2", MT_OTHER, 1.0, 1e4)                               \
    X("t mm^2", "kg m^2", MT_OTHER, 1.0, 1000.0)                             \
    X("t m^2", "kg m^2", MT_OTHER, 1000.0, 1.0)                              \
    X("lb in^2", "kg m^2", MT_OTHER, 731599133573.0, 25e14)                  \
    X("lb ft^2", "kg m^2", MT_OTHER, 6584392202157.0, 15625e10)              \
    X("slug ft^2", "kg m^2", MT_OTHER, 3389544870828501.0, 25e14)            \
    X("lbf in s^2", "kg m^2", MT_OTHER, 1129848290276167.0, 1e16)            \
    X("um", "m", MT_LENGTH, 1.0, 1e6)                                        \
    X("km", "m", MT_LENGTH, 1000.0, 1.0)                                     \
    X("mm^2", "m^2", MT_OTHER, 1.0, 1e6)                                     \
    X("cm^2", "m^2", MT_OTHER, 1.0, 1e4)                                     \
    X("in^2", "m^2", MT_OTHER, 16129.0, 25e6)                                \
    X("ft^2", "m^2", MT_OTHER, 145161.0, 1562500.0)                          \
    X("mm^3", "m^3", MT_OTHER, 1.0, 1e9)                                     \
    X("cm^3", "m^3", MT_OTHER, 1.0, 1e6)                                     \
    X("in^3", "m^3", MT_OTHER, 2048383.0, 125e9)                             \
    X("ft^3", "m^3", MT_OTHER, 55306341.0, 1953125000.0)                     \
    X("mm^4", "m^4", MT_OTHER, 1.0, 1e12)                                    \
    X("cm^4", "m^4", MT_OTHER, 1.0, 1e8)                                     \
    X("in^4", "m^4", MT_OTHER, 260144641.0, 625e12)                          \
    X("ft^4", "m^4", MT_OTHER, 21071715921.0, 244140625e4)                   \
    X("ms", "s", MT_OTHER, 1.0, 1000.0)                                      \
    X("min", "s", MT_OTHER, 60.0, 1.0)                                       \
    X("kHz", "Hz", MT_SPEED, 1000.0, 1.0)                                    \
    X("mrad", "rad", MT_ANGLE, 1.0, 1000.0)                                  \
    X("mm/s", "m/s", MT_OTHER, 1.0, 1000.0)                                  \
    X("in/s", "m/s", MT_OTHER, 127.0, 5000.0)                                \
    X("ft/s", "m/s", MT_OTHER, 381.0, 1250.0)                                \
    X("km/h", "m/s", MT_OTHER, 5.0, 18.0)                                    \
    X("mm/s^2", "m/s^2", MT_OTHER, 1.0, 1000.0)                              \
    X("in/s^2", "m/s^2", MT_OTHER, 127.0, 5000.0)                            \
    X("ft/s^2", "m/s^2", MT_OTHER, 381.0, 1250.0)                            \
    X("mN", "N", MT_OTHER, 1.0, 1000.0)                                      \
    X("daN", "N", MT_OTHER, 10.0, 1.0)                                       \
    X("kN", "N", MT_OTHER, 1000.0, 1.0)                                      \
    X("MN", "N", MT_OTHER, 1e6, 1.0)                                         \
    X("lbf", "N", MT_OTHER, 8896443230521.0, 2e12)                           \
    X("kip", "N", MT_OTHER, 8896443230521.0, 2e9)                            \
    X("kgf", "N", MT_OTHER, 196133.0, 2e4)                                   \
    X("N/cm", "N/m", MT_OTHER, 100.0, 1.0)                                   \
    X("N/mm", "N/m", MT_OTHER, 1000.0, 1.0)                                  \
    X("N/um", "N/m", MT_OTHER, 1e6, 1.0)                                     \
    X("kN/m", "N/m", MT_OTHER, 1000.0, 1.0)                                  \
    X("kN/mm", "N/m", MT_OTHER, 1e6, 1.0)                                    \
    X("MN/m", "N/m", MT_OTHER, 1e6, 1.0)                                     \
    X("lbf/in", "N/m", MT_OTHER, 8896443230521.0, 508e8)                     \
    X("lbf/ft", "N/m", MT_OTHER, 8896443230521.0, 6096e8)                    \
    X("kip/in", "N/m", MT_OTHER, 8896443230521.0, 508e5)                     \
    X("kip/ft", "N/m", MT_OTHER, 8896443230521.0, 6096e5)                    \
    X("kPa", "Pa", MT_OTHER, 1000.0, 1.0)                                    \
    X("MPa", "Pa", MT_OTHER, 1e6, 1.0)                                       \
    X("GPa", "Pa", MT_OTHER, 1e9, 1.0)                                       \
    X("bar", "Pa", MT_OTHER, 1e5, 1.0)                                       \
    X("psi", "Pa", MT_OTHER, 8896443230521.0, 129032e4)                      \
    X("ksi", "Pa", MT_OTHER, 8896443230521.0, 1290320.0)                     \
    X("Msi", "Pa", MT_OTHER, 222411080763025.0, 32258.0)                     \
    X("N/mm^2", "N/m^2", MT_OTHER, 1e6, 1.0)                                 \
    X("kN/mm^2", "N/m^2", MT_OTHER, 1e9, 1.0)                                \
    X("kN/m^2", "N/m^2", MT_OTHER, 1000.0, 1.0)                              \
    X("lbf/in^2", "N/m^2", MT_OTHER, 8896443230521.0, 129032e4)              \
    X("lbf/ft^2", "N/m^2", MT_OTHER, 8896443230521.0, 18580608e4)            \
    X("N mm", "N m", MT_OTHER, 1.0, 1000.0)                                  \
    X("N cm", "N m", MT_OTHER, 1.0, 100.0)                                   \
    X("kN m", "N m", MT_OTHER, 1000.0, 1.0)                                  \
    X("kN mm", "N m", MT_OTHER, 1.0, 1.0)                                    \
    X("lbf in", "N m", MT_OTHER, 1129848290276167.0, 1e16)                   \
    X("lbf ft", "N m", MT_OTHER, 3389544870828501.0, 25e14)                  \
    X("N mm^2", "N m^2", MT_OTHER, 1.0, 1e6)                                 \
    X("kN m^2", "N m^2", MT_OTHER, 1000.0, 1.0)                              \
    X("kN mm^2", "N m^2", MT_OTHER, 1.0, 1000.0)                             \
    X("N mm/rad", "N m/rad", MT_OTHER, 1.0, 1000.0)                          \
    X("N cm/rad", "N m/rad", MT_OTHER, 1.0, 100.0)                           \
    X("kN m/rad", "N m/rad", MT_OTHER, 1000.0, 1.0)                          \
    X("kN mm/rad", "N m/rad", MT_OTHER, 1.0, 1.0)                            \
    X("MN m/rad", "N m/rad", MT_OTHER, 1e6, 1.0)                             \
    X("N m/mrad", "N m/rad", MT_OTHER, 1000.0, 1.0)                          \
    X("lbf in/rad", "N m/rad", MT_OTHER, 1129848290276167.0, 1e16)           \
    X("lbf ft/rad", "N m/rad", MT_OTHER, 3389544870828501.0, 25e14)          \
    X("N m/deg", "N m/rad", MT_OTHER, 1.0, DEG)                              \
    X("N mm/deg", "N m/rad", MT_OTHER, 1.0, 1000.0 * DEG)                    \
    X("kN m/deg", "N m/rad", MT_OTHER, 1000.0, DEG)                          \
    X("lbf in/deg", "N m/rad", MT_OTHER, 1129848290276167.0, 1e16 * DEG)     \
    X("lbf ft/deg", "N m/rad", MT_OTHER, 3389544870828501.0, 25e14 * DEG)    \
    X("N s/mm", "N s/m", MT_OTHER, 1000.0, 1.0)                              \
    X("kN s/m", "N s/m", MT_OTHER, 1000.0, 1.0)                              \
    X("kN s/mm", "N s/m", MT_OTHER, 1e6, 1.0)                                \
    X("lbf s/in", "N s/m", MT_OTHER, 8896443230521.0, 508e8)                 \
    X("lbf s/ft", "N s/m", MT_OTHER, 8896443230521.0, 6096e8)                \
    X("N mm s/rad", "N m s/rad", MT_OTHER, 1.0, 1000.0)                      \
    X("kN m s/rad", "N m s/rad", MT_OTHER, 1000.0, 1.0)                      \
    X("lbf in s/rad", "N m s/rad", MT_OTHER, 1129848290276167.0, 1e16)       \
    X("lbf ft s/rad", "N m s/rad", MT_OTHER, 3389544870828501.0, 25e14)      \
    X("N m s/deg", "N m s/rad", MT_OTHER, 1.0, DEG)                          \
    X("N mm s/deg", "N m s/rad", MT_OTHER, 1.0, 1000.0 * DEG)                \
    X("deg/s", "rad/s", MT_OTHER, DEG, 1.0)                                  \
    X("mm/rad", "m/rad", MT_OTHER, 1.0, 1000.0)                              \
    X("cm/rad", "m/rad", MT_OTHER, 1.0, 100.0)                               \
    X("in/rad", "m/rad", MT_OTHER, 127.0, 5000.0)                            \
    X("mm/deg", "m/rad", MT_OTHER, 1.0, 1000.0 * DEG)                        \
    X("rad/mm", "rad/m", MT_OTHER, 1000.0, 1.0)                              \
    X("deg/m", "rad/m", MT_OTHER, DEG, 1.0)                                  \
    X("deg/mm", "rad/m", MT_OTHER, 1000.0 * DEG, 1.0)                        \
    X("mJ", "J", MT_OTHER, 1.0, 1000.0)                                      \
    X("kJ", "J", MT_OTHER, 1000.0, 1.0)                                      \
    X("kW", "W", MT_OTHER, 1000.0, 1.0)                                      \
    X("%", "1", MT_OTHER, 1.0, 100.0)

/* 1 of a unit is factor m^a kg^b s^c rad^d, powers in this order. */
enum { MT_BASE_M, MT_BASE_KG, MT_BASE_S, MT_BASE_RAD, MT_BASES };
typedef struct mt_unit_worth {
    double factor;
    int power[MT_BASES];
} mt_unit_worth;

/* Reading of symbols with two meanings: g is a gram or 9.80665 m/s^2, lb a mass or a force. */
typedef enum mt_unit_reading {
    MT_READ_MASSES,
    MT_READ_ACCELERATIONS, /* g */
    MT_READ_FORCES,        /* lb */
    MT_READ_BOTH,          /* g an acceleration, lb a force */
    MT_READINGS
} mt_unit_reading;

/*
 * Parse a unit as people and instruments write it: "N mm/rad", "(m/s^2)/N", "m/(N*s**2)",
 * "m/s2", "kg*mm²" (UTF-8 or Latin-1), "10^3 N", "lbf-in". Factors are adjacent, or separated
 * by a blank, *, a dot or a hyphen; a / divides by the one factor after it. Symbols of SI with
 * prefixes, and of inches and pounds. False: not a unit.
 */
bool mt_unit_read(const char *text, mt_unit_reading reading, mt_unit_worth *out);
/* True where both have the same powers; that of rad is compared where `radians` is set. */
bool mt_unit_same_powers(const mt_unit_worth *a, const mt_unit_worth *b, bool radians);
/* True where the factors are equal up to rounding. */
bool mt_unit_same_factor(double a, double b);

#endif
