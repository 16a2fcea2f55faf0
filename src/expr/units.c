/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * value = number * numerator / denominator, in this order: for lengths in mm and cm and for
 * rpm a single division of the number as written, which rounds once; of inches and feet 254
 * and 3048 times a number of up to 41 bits is exact. The inverse, value * denominator /
 * numerator, rounds as often, so that it may miss the number that was written in its last
 * place: mt_unit_written looks at its neighbours.
 */
#include "expr/units.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/base.h"

#define PI 3.14159265358979323846

static const mt_unit units[] = {
    {"m", NULL, MT_LENGTH, 1.0, 1.0},          {"mm", "mm", MT_LENGTH, 1.0, 1000.0},
    {"cm", "cm", MT_LENGTH, 1.0, 100.0},       {"in", "inch", MT_LENGTH, 254.0, 10000.0},
    {"ft", "ft", MT_LENGTH, 3048.0, 10000.0},  {"rad", NULL, MT_ANGLE, 1.0, 1.0},
    {"deg", "deg", MT_ANGLE, PI / 180.0, 1.0}, {"Hz", NULL, MT_SPEED, 1.0, 1.0},
    {"rpm", "rpm", MT_SPEED, 1.0, 60.0},
};

const mt_unit *mt_units(int *n)
{
    *n = MT_COUNT(units);
    return units;
}

const mt_unit *mt_unit_find(const char *name)
{
    for (int i = 0; i < MT_COUNT(units); i++) {
        if (strcmp(units[i].name, name) == 0) {
            return &units[i];
        }
    }
    return NULL;
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
    return unit->constant == NULL;
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

double mt_unit_to_si(const mt_unit *unit, double number)
{
    return unit == NULL ? number : number * unit->numerator / unit->denominator;
}

double mt_unit_from_si(const mt_unit *unit, double value)
{
    return unit == NULL ? value : value * unit->denominator / unit->numerator;
}

/* The number of 15 digits, which every double keeps, next to x: an integer below 1e15 over (or
 * times) a power of ten that is exact, rounded once. NaN where the power is not exact. */
static double shortened(double x)
{
    enum { DIGITS = 15, EXACT = 22 };
    const int k = x == 0.0 ? 0 : DIGITS - 1 - (int)floor(log10(fabs(x)));
    double power = 1.0;
    if (k > EXACT || k < -EXACT) {
        return nan("");
    }
    for (int i = 0; i < abs(k); i++) {
        power *= 10.0;
    }
    return k < 0 ? round(x / power) * power : round(x * power) / power;
}

double mt_unit_written(const mt_unit *unit, double value)
{
    enum { NEAR = 2 };
    const double number = mt_unit_from_si(unit, value);
    if (unit == NULL || !isfinite(number)) {
        return number;
    }
    const double few = shortened(number);
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
