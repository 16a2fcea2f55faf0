/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Universal files: datasets between lines "-1", the first line of each its number. Of them 58,
 * functions at nodal degrees of freedom, and 164, units, are read; others are skipped. Columns
 * of the records of dataset 58, from 0, as its description has them:
 *     6   I5 function; 31 response entity; 41 I10 node, 51 I4 direction; 56 reference entity;
 *         66 I10 node, 76 I4 direction
 *     7   3I10: type of data, number of values, even frequencies; 3E13.5: first frequency, step
 *     8   abscissa, 9 numerator, 10 denominator of the ordinate, 11 z axis:
 *         I10 what is measured, 3I5 exponents, 47 unit
 *     12  the values
 * What follows the number 58 in binary (58b): byte order, kind of floating point numbers,
 * number of lines of text, number of bytes.
 */
#include "measurement/read_uff.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/format.h"
#include "base/text.h"
#include "expr/units.h"
#include "io/universal.h"

/*
 * Units of measured responses. A universal file says them three times over, and seldom all of
 * them: codes tell what the numerator and the denominator measure, labels of 20 characters name
 * their units (of the numerator alone, or of the whole ratio, "(m/s^2)/N"), dataset 164 has the
 * file's units of length and force. A label that is a unit of what the code says gives the
 * factor; without labels dataset 164 does, else numbers are in SI. What contradicts is told.
 */

/* The units of a response in a universal file. */
typedef struct labels_of_units {
    int numerator; /* codes of the measured quantities */
    int denominator;
    bool turns[2]; /* true where rotational: numerator, denominator */
    const char *numerator_unit;
    const char *denominator_unit;
    double length; /* units of length of the file per metre, by dataset 164; NaN: no dataset */
    double force;
} labels_of_units;

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
static void guess(const labels_of_units *l, const quantity **top, const quantity **bottom)
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
static double factor_of_file(const labels_of_units *l, const quantity *q)
{
    return isfinite(l->length) ? 1.0 / (pow(l->length, q->length) * pow(l->force, q->force))
                               : 1.0;
}

/* The factor of the labels, of missing ones that of the file; NaN where they are not such
 * units, with the reason in r. */
static double factor_of_labels(mt_measuring *m, const labels_of_units *l, const quantity *top,
                               const quantity *bottom, mt_measured_response *r)
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

/* Set the quantities of a response and the factor of its numbers to SI: from the labels of its
 * units, from dataset 164, or SI; NaN where they are not known or contradict each other. */
static void set_quantities(mt_measuring *m, const labels_of_units *l, mt_measured_response *r)
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

/* Datasets. */

enum { TEXTS = 5, VALUES_MOST = 100000000, UNIT_TEXT = 48 };
enum { COMPLEX_SINGLE = 5, COMPLEX_DOUBLE = 6, REAL_SINGLE = 2, REAL_DOUBLE = 4 };
enum { UNKNOWN = 0, GENERAL = 1, FREQUENCY = 18 };
enum { LITTLE_ENDIAN_BYTES = 1, BIG_ENDIAN_BYTES = 2, IEEE = 2 };

/* One line of text: a record. */
typedef struct record {
    char *text; /* ends with a NUL */
    int length;
    int line;
} record;

typedef struct reading {
    mt_measuring *m;
    double length; /* so many of the file's are a metre, by dataset 164; NaN: it has none */
    double force;
    int functions; /* datasets 58 so far */
    int opened;    /* line where the present dataset begins */
} reading;

typedef struct header {
    int function;
    int type;
    int count;
    bool even;
    double first_hz;
    double step_hz;
    mt_measured_freedom response;
    mt_measured_freedom reference;
    int numerator;
    int denominator;
    char numerator_unit[UNIT_TEXT];
    char denominator_unit[UNIT_TEXT];
    record data; /* record 7 */
    bool binary;
    bool big;
    int bytes; /* of binary data, as told; 0: not */
} header;

static mt_status unfinished(const reading *u)
{
    return mt_measuring_refuse(u->m, u->opened, 1,
                               "the dataset that begins here does not end: a line \"-1\" is "
                               "missing");
}

static bool next_record(const reading *u, record *out)
{
    mt_measuring *const m = u->m;
    if (m->at >= m->end) {
        return false;
    }
    *out = (record){.text = m->at, .line = m->line};
    while (m->at < m->end && *m->at != '\n' && *m->at != '\r') {
        m->at++;
    }
    char *const end = m->at;
    out->length = (int)(end - out->text);
    (void)mt_measuring_newline(m);
    *end = '\0';
    return true;
}

static bool is_delimiter(const char *s)
{
    s += strspn(s, " \t");
    return s[0] == '-' && s[1] == '1' && s[2 + strspn(s + 2, " \t")] == '\0';
}

/* True where the line of `at`, from there on, is a delimiter. `at` is not changed. */
static bool at_delimiter(const mt_measuring *m)
{
    const char *s = m->at + strspn(m->at, " \t"); /* a NUL ends the text */
    if (s[0] != '-' || s[1] != '1') {
        return false;
    }
    s += 2 + strspn(s + 2, " \t");
    return s >= m->end || *s == '\n' || *s == '\r';
}

/* The blank-trimmed field of a record. */
static const char *field_of(const record *r, int from, int width, int *length)
{
    int a = from < r->length ? from : r->length;
    int b = from + width < r->length ? from + width : r->length;
    while (a < b && (r->text[a] == ' ' || r->text[a] == '\t')) {
        a++;
    }
    while (b > a && (r->text[b - 1] == ' ' || r->text[b - 1] == '\t')) {
        b--;
    }
    *length = b - a;
    return r->text + a;
}

static mt_status decimal(const reading *u, const record *r, int from, int width, double *out)
{
    int length = 0;
    const char *const s = field_of(r, from, width, &length);
    *out = 0.0;
    if (length == 0 || mt_measuring_number(s, (size_t)length, out)) {
        return MT_OK;
    }
    return mt_measuring_refuse(u->m, r->line, (int)(s - r->text) + 1,
                               "\"%.*s\" is not a finite number (columns %d to %d)", length, s,
                               from + 1, from + width);
}

static mt_status integer(const reading *u, const record *r, int from, int width, int *out)
{
    double value = 0.0;
    MT_TRY(decimal(u, r, from, width, &value));
    *out = 0;
    if (!(fabs(value) < 2147483647.0) || value != floor(value)) {
        return mt_measuring_refuse(u->m, r->line, from + 1,
                                   "%.10g is not a whole number (columns %d to %d)", value,
                                   from + 1, from + width);
    }
    *out = (int)value;
    return MT_OK;
}

/* Copy a label by columns, which are characters where it is UTF-8. */
static void text_of(const record *r, int from, int width, char out[UNIT_TEXT])
{
    int length = 0;
    for (int i = 0; i < r->length && i < from + width; i++) {
        const size_t more = mt_utf8_length(r->text + i, (size_t)(r->length - i));
        const int extra = more > 1 ? (int)more - 1 : 0;
        from += i < from ? extra : 0;
        width += i < from ? 0 : extra;
        i += extra;
    }
    const char *const s = field_of(r, from, width < UNIT_TEXT ? width : UNIT_TEXT - 1, &length);
    memcpy(out, s, (size_t)length); /* Latin-1 stays what it is */
    out[length] = '\0';
}

static mt_status read_freedoms(const reading *u, const record *r, header *h)
{
    MT_TRY(integer(u, r, 0, 5, &h->function));
    MT_TRY(integer(u, r, 41, 10, &h->response.node));
    MT_TRY(integer(u, r, 51, 4, &h->response.direction));
    MT_TRY(integer(u, r, 66, 10, &h->reference.node));
    MT_TRY(integer(u, r, 76, 4, &h->reference.direction));
    const int a = h->response.direction;
    const int b = h->reference.direction;
    return a >= -6 && a <= 6 && b >= -6 && b <= 6
               ? MT_OK
               : mt_measuring_refuse(u->m, r->line, 52,
                                     "directions are from -6 to 6, not %d and %d", a, b);
}

static mt_status read_form(const reading *u, const record *r, header *h)
{
    int even = 0;
    MT_TRY(integer(u, r, 0, 10, &h->type));
    MT_TRY(integer(u, r, 10, 10, &h->count));
    MT_TRY(integer(u, r, 20, 10, &even));
    MT_TRY(decimal(u, r, 30, 13, &h->first_hz));
    MT_TRY(decimal(u, r, 43, 13, &h->step_hz));
    h->even = even == 1;
    h->data = *r;
    if (even != 0 && even != 1) {
        return mt_measuring_refuse(u->m, r->line, 21,
                                   "the spacing of frequencies is 0 (uneven) or 1 (even), not "
                                   "%d",
                                   even);
    }
    if (h->type != REAL_SINGLE && h->type != REAL_DOUBLE && h->type != COMPLEX_SINGLE &&
        h->type != COMPLEX_DOUBLE) {
        return mt_measuring_refuse(u->m, r->line, 1, "the type of data is 2, 4, 5 or 6, not %d",
                                   h->type);
    }
    return h->count >= 0 && h->count <= VALUES_MOST
               ? MT_OK
               : mt_measuring_refuse(u->m, r->line, 11,
                                     "the number of values must be from 0 to %d", VALUES_MOST);
}

/* True where the unit is Hz, or not known to be another one. */
static bool is_hertz(const char *unit)
{
    static const char *const turns[] = {"rpm", "RPM", "cpm", "CPM", "1/min", "orders"};
    mt_unit_worth is;
    for (int i = 0; i < MT_COUNT(turns); i++) {
        if (strcmp(unit, turns[i]) == 0) {
            return false;
        }
    }
    return !mt_unit_read(unit, MT_READ_MASSES, &is) ||
           (is.factor == 1.0 && is.power[MT_BASE_RAD] == 0);
}

static mt_status read_axes(const reading *u, const record axes[4], header *h)
{
    int abscissa = 0;
    char unit[UNIT_TEXT];
    MT_TRY(integer(u, &axes[0], 0, 10, &abscissa));
    MT_TRY(integer(u, &axes[1], 0, 10, &h->numerator));
    MT_TRY(integer(u, &axes[2], 0, 10, &h->denominator));
    text_of(&axes[0], 47, 20, unit);
    text_of(&axes[1], 47, 20, h->numerator_unit);
    text_of(&axes[2], 47, 20, h->denominator_unit);
    const bool response =
        h->function == MT_FUNCTION_RESPONSE || h->function == MT_FUNCTION_TRANSMISSIBILITY;
    if (response && abscissa != FREQUENCY && abscissa != UNKNOWN && abscissa != GENERAL) {
        return mt_measuring_refuse(u->m, axes[0].line, 1,
                                   "a frequency response is over frequency (18), not over %d",
                                   abscissa);
    }
    return response && !is_hertz(unit)
               ? mt_measuring_refuse(u->m, axes[0].line, 48,
                                     "frequencies must be in Hz, not in %s", unit)
               : MT_OK;
}

static mt_status read_header(const reading *u, header *h)
{
    record r[TEXTS + 6];
    for (int i = 0; i < MT_COUNT(r); i++) {
        if (!next_record(u, &r[i])) {
            return unfinished(u);
        }
        if (i >= TEXTS && is_delimiter(r[i].text)) {
            return mt_measuring_refuse(u->m, r[i].line, 1,
                                       "dataset 58 has 11 lines before its values, not %d", i);
        }
    }
    MT_TRY(read_freedoms(u, &r[TEXTS], h));
    MT_TRY(read_form(u, &r[TEXTS + 1], h));
    return read_axes(u, &r[TEXTS + 2], h);
}

/* The number that begins at `at`: Fortran's fields may touch, where the next one has a sign. */
static mt_status next_value(const reading *u, int which, int count, double *out, int *column)
{
    mt_measuring *const m = u->m;
    for (;;) {
        while (m->at < m->end && (*m->at == ' ' || *m->at == '\t')) {
            m->at++;
        }
        if (m->at >= m->end) {
            return unfinished(u);
        }
        if (!mt_measuring_newline(m)) {
            break;
        }
    }
    const char *const s = m->at;
    *column = mt_measuring_column(m);
    if (at_delimiter(m) && (size_t)(*column - 1) == strspn(m->start_of_line, " \t")) {
        return mt_measuring_refuse(m, m->line, 1, "the dataset ends after %d of %d numbers",
                                   which, count);
    }
    while (m->at < m->end && strchr(" \t\r\n", *m->at) == NULL) {
        const bool sign = *m->at == '-' || *m->at == '+';
        if (sign && m->at > s && strchr("eEdD", m->at[-1]) == NULL) {
            break;
        }
        m->at++;
    }
    const int length = (int)(m->at - s);
    return mt_measuring_number(s, (size_t)length, out)
               ? MT_OK
               : mt_measuring_refuse(m, m->line, *column, "\"%.*s\" is not a finite number",
                                     length < 40 ? length : 40, s);
}

static uint64_t bytes_at(const char *s, int size, bool big)
{
    uint64_t bits = 0;
    for (int i = 0; i < size; i++) {
        const int at = big ? i : size - 1 - i;
        bits = bits << 8 | (unsigned char)s[at];
    }
    return bits;
}

/* Number `which` of those behind the header. There are as many bytes. */
static double binary_value(const char *data, int which, const header *h)
{
    if (h->type == COMPLEX_SINGLE || h->type == REAL_SINGLE) {
        const uint32_t bits = (uint32_t)bytes_at(data + ((ptrdiff_t)which * 4), 4, h->big);
        float value = 0.0F;
        memcpy(&value, &bits, sizeof value);
        return (double)value;
    }
    const uint64_t bits = bytes_at(data + ((ptrdiff_t)which * 8), 8, h->big);
    double value = 0.0;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static int per_value(const header *h)
{
    const bool complex = h->type == COMPLEX_SINGLE || h->type == COMPLEX_DOUBLE;
    return (complex ? 2 : 1) + (h->even ? 0 : 1);
}

static ptrdiff_t bytes_of(const header *h)
{
    const ptrdiff_t size = h->type == COMPLEX_SINGLE || h->type == REAL_SINGLE ? 4 : 8;
    return h->binary ? size * h->count * per_value(h) : 0;
}

/* Bytes to skip: those of the values, or the stated number where the last block is filled
 * up. */
static ptrdiff_t bytes_to_pass(const reading *u, const header *h)
{
    const ptrdiff_t needed = bytes_of(h);
    const bool more = h->binary && h->bytes > needed && h->bytes <= u->m->end - u->m->at;
    return more ? h->bytes : needed;
}

static bool is_turn(const mt_measured_freedom *f)
{
    return f->direction > 3 || f->direction < -3;
}

static double sign_of(const header *h)
{
    return (h->response.direction < 0) != (h->reference.direction < 0) ? -1.0 : 1.0;
}

/* Numbers x[0..2] (frequency, parts) of value i. */
static mt_status read_value(const reading *u, const header *h, const char *data, int i,
                            double x[3], int *column)
{
    const int each = per_value(h);
    x[0] = h->first_hz + ((double)i * h->step_hz);
    for (int k = 0; k < each; k++) {
        const int which = (i * each) + k;
        double *const out = &x[k + (h->even ? 1 : 0)];
        if (!h->binary) {
            int own = 1;
            MT_TRY(next_value(u, which, h->count * each, out, &own));
            *column = k == 0 ? own : *column;
        } else {
            *out = binary_value(data, which, h);
            if (!isfinite(*out)) {
                return mt_measuring_refuse(u->m, h->data.line, 1,
                                           "number %d of the binary data is not finite",
                                           which + 1);
            }
        }
    }
    return MT_OK;
}

static mt_status read_values(const reading *u, const header *h, mt_measured_response *r)
{
    mt_measuring *const m = u->m;
    const char *const data = m->at;
    if (h->type != COMPLEX_SINGLE && h->type != COMPLEX_DOUBLE) {
        return mt_measuring_refuse(m, h->data.line, 1,
                                   "a frequency response is complex (5 or 6): without a phase "
                                   "it is not compared");
    }
    if (m->end - m->at < bytes_of(h)) {
        return mt_measuring_refuse(m, h->data.line, 11,
                                   "the file ends before %d values of binary data", h->count);
    }
    for (int i = 0; i < h->count; i++) {
        double x[3] = {0.0};
        int column = 1;
        MT_TRY(read_value(u, h, data, i, x, &column));
        const mt_measured_line line = {.frequency_hz = x[0],
                                       .re = sign_of(h) * x[1],
                                       .im = sign_of(h) * x[2],
                                       .coherence = nan(""),
                                       .line = h->binary ? h->data.line : m->line};
        MT_TRY(mt_measuring_add(m, r, &line, column));
    }
    m->at += bytes_to_pass(u, h);
    return MT_OK;
}

static void set_units(const reading *u, const header *h, mt_measured_response *r)
{
    const labels_of_units labels = {
        .numerator = h->numerator,
        .denominator = h->denominator,
        .turns = {is_turn(&h->response), is_turn(&h->reference)},
        .numerator_unit = h->numerator_unit,
        .denominator_unit = h->denominator_unit,
        .length = u->length,
        .force = u->force,
    };
    set_quantities(u->m, &labels, r);
}

/* "58b" has more on its line. */
static mt_status read_binary(const reading *u, const record *r, header *h)
{
    int order = 0;
    int numbers = 0;
    int lines = 0;
    h->binary = r->length > 6 && (r->text[6] == 'b' || r->text[6] == 'B');
    if (!h->binary) {
        return MT_OK;
    }
    MT_TRY(integer(u, r, 7, 6, &order));
    MT_TRY(integer(u, r, 13, 6, &numbers));
    MT_TRY(integer(u, r, 19, 12, &lines));
    MT_TRY(integer(u, r, 31, 12, &h->bytes));
    h->big = order == BIG_ENDIAN_BYTES;
    if (order != LITTLE_ENDIAN_BYTES && order != BIG_ENDIAN_BYTES) {
        return mt_measuring_refuse(u->m, r->line, 8, "the order of bytes is 1 or 2, not %d",
                                   order);
    }
    if (numbers != IEEE) {
        return mt_measuring_refuse(u->m, r->line, 14,
                                   "floating point numbers of kind %d are not read: IEEE 754 "
                                   "(2) is",
                                   numbers);
    }
    return lines == TEXTS + 6 ? MT_OK
                              : mt_measuring_refuse(u->m, r->line, 20,
                                                    "a binary dataset has 11 lines of text, "
                                                    "not %d",
                                                    lines);
}

static mt_status skip_dataset(const reading *u)
{
    record r;
    while (next_record(u, &r)) {
        if (is_delimiter(r.text)) {
            return MT_OK;
        }
    }
    return unfinished(u);
}

/* These are numbers alone, as the last line of values is filled up with. */
static bool is_filling(const record *r)
{
    const char *s = r->text + strspn(r->text, " \t");
    while (*s != '\0') {
        double value = 0.0;
        const size_t length = strcspn(s, " \t");
        if (!mt_measuring_number(s, length, &value)) {
            return false;
        }
        s += length + strspn(s + length, " \t");
    }
    return true;
}

/* Nothing but a delimiter follows the line of the last value. */
static mt_status close_dataset(const reading *u, bool binary)
{
    record r;
    bool within = !binary && u->m->at > u->m->start_of_line;
    while (next_record(u, &r)) {
        if (within && is_filling(&r)) {
            within = false;
            continue;
        }
        within = false;
        if (is_delimiter(r.text)) {
            return MT_OK;
        }
        if ((int)strspn(r.text, " \t") < r.length) {
            return mt_measuring_refuse(u->m, r.line, 1,
                                       "values are followed by a line \"-1\", not by more");
        }
    }
    return unfinished(u);
}

static mt_status read_function(reading *u, const record *number)
{
    header h = {0};
    MT_TRY(read_binary(u, number, &h));
    MT_TRY(read_header(u, &h));
    mt_measured_response *const r = mt_measuring_response(u->m);
    MT_TRY(mt_arena_check(u->m->mem, u->m->err));
    r->dataset = ++u->functions;
    r->function = h.function;
    r->response = h.response;
    r->reference = h.reference;
    if (mt_measured_is_response(r)) {
        set_units(u, &h, r);
        MT_TRY(read_values(u, &h, r));
        return close_dataset(u, h.binary);
    }
    if (!h.binary) {
        return skip_dataset(u);
    }
    if (u->m->end - u->m->at < bytes_of(&h)) {
        return unfinished(u);
    }
    u->m->at += bytes_to_pass(u, &h);
    return close_dataset(u, h.binary);
}

static mt_status read_units(reading *u)
{
    record r;
    for (int i = 0; i < 2; i++) {
        if (!next_record(u, &r)) {
            return unfinished(u);
        }
    }
    MT_TRY(decimal(u, &r, 0, 25, &u->length));
    MT_TRY(decimal(u, &r, 25, 25, &u->force));
    return u->length > 0.0 && u->force > 0.0
               ? skip_dataset(u)
               : mt_measuring_refuse(u->m, r.line, 1,
                                     "factors of units must be above 0, not %.10g and %.10g",
                                     u->length, u->force);
}

static mt_status read_dataset(reading *u)
{
    record r;
    if (!next_record(u, &r)) {
        return unfinished(u);
    }
    const char *const s = r.text + strspn(r.text, " \t");
    if (strncmp(s, "58", 2) == 0 && (s[2] < '0' || s[2] > '9')) {
        return read_function(u, &r);
    }
    if (strncmp(s, "164", 3) == 0 && (s[3] < '0' || s[3] > '9')) {
        return read_units(u);
    }
    return is_delimiter(r.text) ? MT_OK : skip_dataset(u);
}

/* Refuse a file without frequency responses, with its contents. */
static mt_status refuse_contents(const reading *u)
{
    mt_measuring *const m = u->m;
    mt_text holds = {.s = NULL};
    mt_universal_contents(m->begin, (size_t)(m->end - m->begin), &holds);
    const mt_status rc =
        holds.failed
            ? mt_fail_memory(m->err)
            : mt_measuring_refuse(m, 1, 1, "the file has no %s; it holds: %s",
                                  u->functions > 0 ? "frequency response" : "dataset 58",
                                  holds.s);
    mt_text_free(&holds);
    return rc;
}

mt_status mt_read_measurement_uff(mt_measuring *m)
{
    reading u = {.m = m, .length = nan(""), .force = nan("")};
    record r;
    for (;;) {
        u.opened = m->line;
        if (!next_record(&u, &r)) {
            break;
        }
        if (is_delimiter(r.text)) {
            MT_TRY(read_dataset(&u));
        } else if ((int)strspn(r.text, " \t") < r.length) {
            return mt_measuring_refuse(m, r.line, 1, "a dataset begins with a line \"-1\"");
        }
    }
    bool any = false;
    for (int i = 0; i < m->out->n_responses; i++) {
        any = any || mt_measured_is_response(&m->out->responses[i]);
    }
    return any ? MT_OK : refuse_contents(&u);
}
