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
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/base.h"
#include "base/format.h"
#include "base/number.h"

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

/*
 * Recursive descent over a text that is made plain before (superscripts, dots and micros of
 * UTF-8 and of Latin-1 become ^2, * and u):
 *     product = power { [ * | . | - | / ] power }
 *     power   = ( symbol | number | "(" product ")" ) [ [ ^ | ** ] exponent ]
 * An exponent without a sign of its own may stand directly behind a symbol, "s2".
 */

enum { PLAIN_TEXT = 96, DEPTH_MOST = 8, POWER_MOST = 9 };

typedef struct symbol {
    const char *names; /* between blanks */
    double factor;
    int power[MT_BASES];
    bool prefixed; /* by SI's prefixes, too: its first name */
} symbol;
#define POUND  0.45359237
#define INCH   0.0254
#define FOOT   0.3048
#define G      9.80665
#define WEIGHT (POUND * G)

static const symbol symbols[] = {
    {" m meter meters metre metres ", 1.0, {1, 0, 0, 0}, true},
    {" in inch inches IN ", INCH, {1, 0, 0, 0}, false},
    {" ft foot feet FT ", FOOT, {1, 0, 0, 0}, false},
    {" kg ", 1.0, {0, 1, 0, 0}, false},
    {" t tonne tonnes ", 1e3, {0, 1, 0, 0}, false},
    {" oz ", POUND / 16.0, {0, 1, 0, 0}, false},
    {" slug slugs ", WEIGHT / FOOT, {0, 1, 0, 0}, false},
    {" s sec secs second seconds SEC ", 1.0, {0, 0, 1, 0}, true},
    {" min ", 60.0, {0, 0, 1, 0}, false},
    {" h hr ", 3600.0, {0, 0, 1, 0}, false},
    {" Hz hz ", 1.0, {0, 0, -1, 0}, true},
    {" rad radian radians ", 1.0, {0, 0, 0, 1}, true},
    {" deg degree degrees ", PI / 180.0, {0, 0, 0, 1}, false},
    {" N newton newtons Newton Newtons ", 1.0, {1, 1, -2, 0}, true},
    {" daN ", 10.0, {1, 1, -2, 0}, false},
    {" lbf LBF ", WEIGHT, {1, 1, -2, 0}, false},
    {" kip kips klbf ", 1e3 * WEIGHT, {1, 1, -2, 0}, false},
    {" kgf kp ", G, {1, 1, -2, 0}, false},
    {" dyn ", 1e-5, {1, 1, -2, 0}, false},
    {" Nm ", 1.0, {2, 1, -2, 0}, false},
    {" Nmm ", 1e-3, {2, 1, -2, 0}, false},
    {" kNm ", 1e3, {2, 1, -2, 0}, false},
    {" Pa pascal ", 1.0, {-1, 1, -2, 0}, true},
    {" bar ", 1e5, {-1, 1, -2, 0}, false},
    {" psi ", WEIGHT / (INCH * INCH), {-1, 1, -2, 0}, false},
    {" ksi ", 1e3 * WEIGHT / (INCH * INCH), {-1, 1, -2, 0}, false},
    {" J joule ", 1.0, {2, 1, -2, 0}, true},
    {" W watt ", 1.0, {2, 1, -3, 0}, true},
    {" gn g0 G Gs gs g's g' ", G, {1, 0, -2, 0}, false},
};
static const symbol gram = {" g ", 1e-3, {0, 1, 0, 0}, true};
static const symbol acceleration = {" g ", G, {1, 0, -2, 0}, true};
static const symbol pound = {" lb lbs LB ", POUND, {0, 1, 0, 0}, false};
static const symbol pound_force = {" lb lbs LB ", WEIGHT, {1, 1, -2, 0}, false};

typedef struct reader {
    const char *at;
    mt_unit_reading reading;
    int depth;
} reader;

static bool has_name(const symbol *s, const char *word, size_t n)
{
    for (const char *at = s->names; (at = strchr(at, ' ')) != NULL && at[1] != '\0';) {
        at++;
        const size_t length = strcspn(at, " ");
        if (length == n && memcmp(at, word, n) == 0) {
            return true;
        }
    }
    return false;
}

/* As written, or behind one of SI's prefixes, by which the factor is multiplied. */
static bool is_symbol(const symbol *s, const char *word, size_t n, double *factor)
{
    static const struct {
        char letter;
        double factor;
    } prefixes[] = {{'n', 1e-9}, {'u', 1e-6}, {'m', 1e-3}, {'c', 1e-2},
                    {'d', 1e-1}, {'k', 1e3},  {'M', 1e6},  {'G', 1e9}};
    *factor = s->factor;
    if (has_name(s, word, n)) {
        return true;
    }
    const size_t first = strcspn(s->names + 1, " ");
    if (!s->prefixed || n != first + 1 || memcmp(word + 1, s->names + 1, first) != 0) {
        return false;
    }
    for (int i = 0; i < MT_COUNT(prefixes); i++) {
        if (prefixes[i].letter == word[0]) {
            *factor *= prefixes[i].factor;
            return true;
        }
    }
    return false;
}

static bool find_symbol(const reader *r, const char *word, size_t n, mt_unit_worth *out)
{
    const bool weights = r->reading == MT_READ_FORCES || r->reading == MT_READ_BOTH;
    const bool earth = r->reading == MT_READ_ACCELERATIONS || r->reading == MT_READ_BOTH;
    const symbol *const own[] = {earth ? &acceleration : &gram,
                                 weights ? &pound_force : &pound};
    for (int i = 0; i < MT_COUNT(symbols) + MT_COUNT(own); i++) {
        const symbol *const s =
            i < MT_COUNT(symbols) ? &symbols[i] : own[i - MT_COUNT(symbols)];
        if (is_symbol(s, word, n, &out->factor)) {
            memcpy(out->power, s->power, sizeof out->power);
            return true;
        }
    }
    return false;
}

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '\'';
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static void skip_blanks(reader *r)
{
    r->at += strspn(r->at, " \t");
}

static mt_unit_worth raised(const mt_unit_worth *a, int power)
{
    mt_unit_worth out = {.factor = pow(a->factor, (double)power)};
    for (int k = 0; k < MT_BASES; k++) {
        out.power[k] = a->power[k] * power;
    }
    return out;
}

static mt_unit_worth product_of(const mt_unit_worth *a, const mt_unit_worth *b)
{
    mt_unit_worth out = {.factor = a->factor * b->factor};
    for (int k = 0; k < MT_BASES; k++) {
        out.power[k] = a->power[k] + b->power[k];
    }
    return out;
}

static mt_unit_worth quotient_of(const mt_unit_worth *a, const mt_unit_worth *b)
{
    const mt_unit_worth below = raised(b, -1);
    return product_of(a, &below);
}

/* Read a word; only "g0" has a digit that is not an exponent. Of two readings of different
 * dimension, as for "kgm", the first is taken. */
static bool read_word(reader *r, mt_unit_worth *out)
{
    const char *const word = r->at;
    size_t n = 0;
    while (is_letter(word[n])) {
        n++;
    }
    n += n == 1 && word[0] == 'g' && word[1] == '0' ? 1 : 0;
    for (size_t first = n; first > 0; first--) {
        mt_unit_worth rest;
        if (find_symbol(r, word, first, out) &&
            (first == n || (find_symbol(r, word + first, n - first, &rest) &&
                            !mt_unit_same_powers(out, &rest, true)))) {
            r->at += first;
            return true;
        }
    }
    return false;
}

/* A whole one: "1", "1000". */
static bool read_number(reader *r, mt_unit_worth *out)
{
    *out = (mt_unit_worth){0};
    while (is_digit(*r->at)) {
        out->factor = 10.0 * out->factor + (double)(*r->at - '0');
        r->at++;
    }
    return out->factor > 0.0;
}

/* None: 1. */
static bool read_exponent(reader *r, bool directly, int *power)
{
    const char *s = r->at;
    *power = 1;
    const bool said = s[0] == '^' || (s[0] == '*' && s[1] == '*');
    s += !said ? 0 : s[0] == '^' ? 1 : 2;
    const bool bracket = said && *s == '(';
    s += bracket ? 1 : 0;
    const bool sign = *s == '-' || *s == '+';
    const bool minus = *s == '-';
    s += sign ? 1 : 0;
    if (!is_digit(*s)) {
        return !said;
    }
    if (!said && (!directly || (sign && !is_digit(s[0])))) {
        return true;
    }
    *power = (minus ? -1 : 1) * (*s - '0');
    s++;
    s += bracket && *s == ')' ? 1 : 0;
    r->at = s;
    return !is_digit(*s) && abs(*power) <= POWER_MOST;
}

static bool read_product(reader *r, mt_unit_worth *out);

static bool read_power(reader *r, mt_unit_worth *out)
{
    int power = 1;
    skip_blanks(r);
    const bool word = is_letter(*r->at);
    bool good = false;
    if (word) {
        good = read_word(r, out);
    } else if (is_digit(*r->at)) {
        good = read_number(r, out);
    } else if (*r->at == '(' && r->depth < DEPTH_MOST) {
        r->at++;
        r->depth++;
        good = read_product(r, out) && *r->at == ')';
        r->depth--;
        r->at += good ? 1 : 0;
    }
    good = good && read_exponent(r, word, &power);
    *out = good ? raised(out, power) : *out;
    return good;
}

static bool read_product(reader *r, mt_unit_worth *out)
{
    *out = (mt_unit_worth){.factor = 1.0};
    bool divides = false;
    for (;;) {
        mt_unit_worth next = {0};
        if (!read_power(r, &next)) {
            return false;
        }
        *out = divides ? quotient_of(out, &next) : product_of(out, &next);
        skip_blanks(r);
        if (*r->at == '\0' || *r->at == ')') {
            return true;
        }
        divides = *r->at == '/';
        r->at += strchr("/*.-", *r->at) != NULL ? 1 : 0;
    }
}

/* The signs beyond ASCII, in UTF-8 and in Latin-1, longer ones first. */
static const struct {
    const char *bytes;
    const char *plain;
} signs[] = {
    {"\xE2\x81\xBB\xC2\xB9", "^-1"},
    {"\xE2\x81\xBB\xC2\xB2", "^-2"},
    {"\xE2\x81\xBB\xC2\xB3", "^-3"},
    {"\xE2\x81\xBB\xE2\x81\xB4", "^-4"},
    {"\xE2\x8B\x85", "*"},
    {"\xE2\x88\x99", "*"},
    {"\xE2\x81\xB4", "^4"},
    {"\xC2\xB9", "^1"},
    {"\xC2\xB2", "^2"},
    {"\xC2\xB3", "^3"},
    {"\xC2\xB7", "*"},
    {"\xC2\xB5", "u"},
    {"\xCE\xBC", "u"},
    {"\xC2\xB0", "deg"},
    {"\xC3\x97", "*"},
    {"\xC2\xA0", " "},
    {"\xB9", "^1"},
    {"\xB2", "^2"},
    {"\xB3", "^3"},
    {"\xB7", "*"},
    {"\xB5", "u"},
    {"\xB0", "deg"},
    {"\xD7", "*"},
    {"\xA0", " "},
};

static bool make_plain(const char *text, char out[PLAIN_TEXT])
{
    enum { LONGEST = 4 };
    size_t n = 0;
    while (*text != '\0' && n + LONGEST < PLAIN_TEXT) {
        const size_t before = n;
        for (int i = 0; i < MT_COUNT(signs) && n == before; i++) {
            if (strncmp(text, signs[i].bytes, strlen(signs[i].bytes)) == 0) {
                text += strlen(signs[i].bytes);
                memcpy(out + n, signs[i].plain, strlen(signs[i].plain));
                n += strlen(signs[i].plain);
            }
        }
        if (n == before) {
            out[n++] = *text++;
        }
    }
    out[n] = '\0';
    return *text == '\0';
}

bool mt_unit_read(const char *text, mt_unit_reading reading, mt_unit_worth *out)
{
    char plain[PLAIN_TEXT];
    reader r = {.at = plain, .reading = reading};
    *out = (mt_unit_worth){0};
    return make_plain(text, plain) && read_product(&r, out) && *r.at == '\0' &&
           out->factor > 0.0 && isfinite(out->factor);
}

bool mt_unit_same_powers(const mt_unit_worth *a, const mt_unit_worth *b, bool radians)
{
    const int n = radians ? MT_BASES : MT_BASE_RAD;
    return memcmp(a->power, b->power, (size_t)n * sizeof *a->power) == 0;
}

bool mt_unit_same_factor(double a, double b)
{
    static const double ROUNDING = 1e-12; /* of a few products of decimal fractions */
    return fabs(a - b) <= ROUNDING * fabs(b);
}
