/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Units of measured responses. A universal file says them three times over, and seldom all of
 * them: codes tell what the numerator and the denominator measure, labels of 20 characters name
 * their units (of the numerator alone, or of the whole ratio, "(m/s^2)/N"), dataset 164 has the
 * file's units of length and force. A label that is a unit of what the code says gives the
 * factor; without labels dataset 164 does, else numbers are in SI. What contradicts is told.
 */
#include "measurement/read_priv.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "expr/units.h"

enum { DISPLACEMENT = 8, REACTION = 9, VELOCITY = 11, ACCELERATION = 12, FORCE = 13 };

/* What a port has: its unit in SI, and powers of the file's lengths and forces in it. */
typedef struct quantity {
    const char *si;
    const char *text;
    int length;
    int force;
} quantity;

static const quantity quantities[] = {
    {"m/s^2", "an acceleration", 1, 0},
    {"m/s", "a velocity", 1, 0},
    {"m", "a displacement", 1, 0},
    {"rad/s^2", "an angular acceleration", 0, 0},
    {"rad/s", "an angular velocity", 0, 0},
    {"rad", "an angle", 0, 0},
    {"N", "a force", 0, 1},
    {"N m", "a moment", 1, 1},
};

static const quantity *find_quantity(const char *si)
{
    for (int i = 0; i < MT_COUNT(quantities); i++) {
        if (strcmp(quantities[i].si, si) == 0) {
            return &quantities[i];
        }
    }
    return NULL;
}

/* Quantity of a code; NULL: not given, or not a quantity of a port. */
static const quantity *quantity_of_code(int code, bool turns)
{
    return code == FORCE || code == REACTION ? find_quantity(turns ? "N m" : "N")
           : code == DISPLACEMENT            ? find_quantity(turns ? "rad" : "m")
           : code == VELOCITY                ? find_quantity(turns ? "rad/s" : "m/s")
           : code == ACCELERATION            ? find_quantity(turns ? "rad/s^2" : "m/s^2")
                                             : NULL;
}

static bool is_none(const char *label)
{
    static const char *const none[] = {"", "NONE", "none", "None", "-", "--", "N/A", "n/a"};
    for (int i = 0; i < MT_COUNT(none); i++) {
        if (strcmp(label, none[i]) == 0) {
            return true;
        }
    }
    return false;
}

/* True where the label is a unit of top/bottom (bottom NULL: of top), in any notation; *factor:
 * its factor to SI. */
static bool is_unit_of(const char *label, const quantity *top, const quantity *bottom,
                       double *factor)
{
    mt_unit_worth is;
    mt_unit_worth of;
    char ratio[32];
    (void)mt_snprintf(ratio, sizeof ratio, bottom == NULL ? "%s" : "(%s)/(%s)", top->si,
                      bottom == NULL ? "" : bottom->si);
    if (!mt_unit_read(ratio, MT_READ_MASSES, &of)) {
        return false;
    }
    /* g is seldom a gram in a test, and a lb seldom a mass */
    for (int reading = MT_READINGS - 1; reading >= 0; reading--) {
        if (mt_unit_read(label, (mt_unit_reading)reading, &is) &&
            mt_unit_same_powers(&is, &of, false)) {
            *factor = is.factor / of.factor;
            return true;
        }
    }
    return false;
}

static bool is_unit(const char *label)
{
    mt_unit_worth is;
    return mt_unit_read(label, MT_READ_MASSES, &is);
}

/* Guess the measured quantities from the labels alone. */
static void guess(const mt_measured_labels *l, const quantity **top, const quantity **bottom)
{
    double factor = 1.0;
    const bool whole = is_none(l->denominator_unit);
    for (int i = 0; i < MT_COUNT(quantities); i++) {
        for (int k = 0; k < MT_COUNT(quantities); k++) {
            const quantity *const a = &quantities[i];
            const quantity *const b = &quantities[k];
            const bool fits = whole ? i != k && is_unit_of(l->numerator_unit, a, b, &factor)
                                    : is_unit_of(l->numerator_unit, a, NULL, &factor) &&
                                          is_unit_of(l->denominator_unit, b, NULL, &factor);
            if (fits && (*top == NULL || *top == a) && (*bottom == NULL || *bottom == b)) {
                *top = a;
                *bottom = b;
                return;
            }
        }
    }
}

/* Set the factor to unknown because of this unit of the file. */
static void set_unknown_unit(mt_measuring *m, mt_measured_response *r, const char *label,
                             const char *against)
{
    r->si = nan("");
    r->foreign = mt_arena_strdup(m->mem, label);
    r->against = against;
}

/* Factor from the file's own units to SI: 1 without a dataset 164. */
static double factor_of_file(const mt_measured_labels *l, const quantity *q)
{
    return isfinite(l->length) ? 1.0 / (pow(l->length, q->length) * pow(l->force, q->force))
                               : 1.0;
}

/* The factor of the labels, of missing ones that of the file; NaN where they are not such
 * units, with the reason in r. */
static double factor_of_labels(mt_measuring *m, const mt_measured_labels *l,
                               const quantity *top, const quantity *bottom,
                               mt_measured_response *r)
{
    double up = factor_of_file(l, top);
    double down = factor_of_file(l, bottom);
    const bool has_top = !is_none(l->numerator_unit);
    const bool has_bottom = !is_none(l->denominator_unit);
    if (has_bottom && !is_unit_of(l->denominator_unit, bottom, NULL, &down)) {
        set_unknown_unit(m, r, l->denominator_unit,
                         is_unit(l->denominator_unit) ? bottom->text : NULL);
        return nan("");
    }
    if (!has_top || is_unit_of(l->numerator_unit, top, NULL, &up)) {
        return up / down;
    }
    if (is_unit_of(l->numerator_unit, top, bottom, &up)) {
        return up;
    }
    set_unknown_unit(m, r, l->numerator_unit, is_unit(l->numerator_unit) ? top->text : NULL);
    return nan("");
}

/* The factor is one of g, mg, ..., which no unit of length gives. */
static bool is_gravity(double factor)
{
    const double decades = log10(factor / 9.80665);
    return mt_unit_same_factor(pow(10.0, decades - round(decades)), 1.0);
}

void mt_measuring_units(mt_measuring *m, const mt_measured_labels *l, mt_measured_response *r)
{
    const quantity *top = quantity_of_code(l->numerator, l->turns[0]);
    const quantity *bottom = quantity_of_code(l->denominator, l->turns[1]);
    const bool named = isfinite(l->length);
    const bool labelled = !is_none(l->numerator_unit) || !is_none(l->denominator_unit);
    const char *const first =
        is_none(l->numerator_unit) ? l->denominator_unit : l->numerator_unit;
    if (labelled && (top == NULL || bottom == NULL)) {
        guess(l, &top, &bottom);
    }
    if (top == NULL || bottom == NULL) {
        const bool metric = !named || (l->length == 1.0 && l->force == 1.0);
        r->si = metric ? r->si : nan("");
        if (labelled) {
            set_unknown_unit(m, r, first, NULL);
        }
        return;
    }
    r->unit = mt_arena_printf(m->mem, "%s per %s", top->si, bottom->si);
    const double file = factor_of_file(l, top) / factor_of_file(l, bottom);
    const double label = labelled ? factor_of_labels(m, l, top, bottom, r) : file;
    const bool known = isfinite(label);
    if (named && known && is_gravity(label / file)) {
        set_unknown_unit(m, r, first, "other units by dataset 164");
    } else if (named && r->against == NULL) {
        r->si = file;
    } else {
        r->si = label;
    }
}
