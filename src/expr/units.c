/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * value = number * numerator / denominator, in this order: of decimal units and of rpm a single
 * product, or division, of the number as written, which rounds once; of inches and feet 254 and
 * 3048 times a number of up to 41 bits is exact. Numerators of pounds have no bit to spare:
 * the product is p + e and the quotient q is corrected by its remainder, (p - q d + e)/d, so
 * that all of it rounds once. The inverse, value * denominator / numerator, rounds as often, so
 * that it may miss the number that was written in its last place: mt_unit_written looks for one
 * of up to 15 digits, then at its neighbours.
 */
#include "expr/units.h"

#include <math.h>
#include <string.h>

#include "base/base.h"
#include "base/digits.h"
#include "expr/unit_list.h"

#define PI  3.14159265358979323846
#define DEG (PI / 180.0)

#define CONVERTED(name, si, dimension, up, down) {name, NULL, si, dimension, up, down},
static const mt_unit units[] = {
    {"m", NULL, "m", MT_LENGTH, 1.0, 1.0},
    {"mm", "mm", "m", MT_LENGTH, 1.0, 1000.0},
    {"cm", "cm", "m", MT_LENGTH, 1.0, 100.0},
    {"in", "inch", "m", MT_LENGTH, 254.0, 10000.0},
    {"ft", "ft", "m", MT_LENGTH, 3048.0, 10000.0},
    {"rad", NULL, "rad", MT_ANGLE, 1.0, 1.0},
    {"deg", "deg", "rad", MT_ANGLE, DEG, 1.0},
    {"Hz", NULL, "Hz", MT_SPEED, 1.0, 1.0},
    {"rpm", "rpm", "Hz", MT_SPEED, 1.0, 60.0},
    MT_UNIT_LIST(CONVERTED){"g", NULL, "m/s^2", MT_OTHER, 980665.0, 100000.0},
};

const mt_unit *mt_units(int *n)
{
    *n = MT_COUNT(units);
    return units;
}

const mt_unit *mt_unit_find_of(const char *name, const char *si)
{
    for (int i = 0; i < MT_COUNT(units); i++) {
        if (strcmp(units[i].name, name) == 0 && (si == NULL || strcmp(units[i].si, si) == 0)) {
            return &units[i];
        }
    }
    return NULL;
}

const mt_unit *mt_unit_find(const char *name)
{
    return mt_unit_find_of(name, NULL);
}

#define NAME(id, name, text, si) name,
#define TEXT(id, name, text, si) text,
#define SI(id, name, text, si)   si,

const char *mt_dimension_name(mt_dimension dimension)
{
    static const char *const names[] = {MT_DIMENSION_LIST(NAME)};
    return names[dimension];
}

const char *mt_dimension_text(mt_dimension dimension)
{
    static const char *const texts[] = {MT_DIMENSION_LIST(TEXT)};
    return texts[dimension];
}

const char *mt_dimension_si(mt_dimension dimension)
{
    static const char *const names[] = {MT_DIMENSION_LIST(SI)};
    return names[dimension];
}

bool mt_unit_is_si(const mt_unit *unit)
{
    return strcmp(unit->name, unit->si) == 0;
}

bool mt_unit_is_common(const mt_unit *unit)
{
    return unit->constant != NULL || mt_unit_is_si(unit);
}

const char *mt_unit_name(const mt_unit *unit, const char *si)
{
    return unit == NULL ? si : unit->name;
}

double mt_unit_factor(const mt_unit *unit)
{
    return unit->numerator / unit->denominator;
}

double mt_unit_display(const mt_unit *unit)
{
    return unit == NULL ? nan("") : mt_unit_factor(unit);
}

/* x a / b. */
static double scaled(const mt_unit *unit, double x, double a, double b)
{
    const double p = x * a;
    const double q = p / b;
    const double rest = fma(-q, b, p) + fma(x, a, -p);
    return mt_unit_is_common(unit) || !isfinite(rest) ? q : q + rest / b;
}

double mt_unit_to_si(const mt_unit *unit, double number)
{
    return unit == NULL ? number : scaled(unit, number, unit->numerator, unit->denominator);
}

double mt_unit_from_si(const mt_unit *unit, double value)
{
    return unit == NULL ? value : scaled(unit, value, unit->denominator, unit->numerator);
}

double mt_unit_written(const mt_unit *unit, double value)
{
    enum { NEAR = 2 };
    const double number = mt_unit_from_si(unit, value);
    if (unit == NULL || !isfinite(number)) {
        return number;
    }
    const double few = mt_few_digits(number);
    if (mt_unit_to_si(unit, few) == value) {
        return few;
    }
    double best = number;
    double low = number;
    double high = number;
    for (int i = 0; i < NEAR; i++) {
        low = nextafter(low, -HUGE_VAL);
        high = nextafter(high, HUGE_VAL);
        const double near[] = {low, high};
        for (int k = 0; k < MT_COUNT(near); k++) {
            const double miss = fabs(mt_unit_to_si(unit, near[k]) - value);
            best = miss < fabs(mt_unit_to_si(unit, best) - value) ? near[k] : best;
        }
    }
    return best;
}
