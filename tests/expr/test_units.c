/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Units, and what expressions measure. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "expr/kind.h"
#include "expr/units.h"
#include "support/mt_test.h"

enum { N_UNITS = 152 };

static void units__are_what_they_are_worth(mt_test *t)
{
    static const struct {
        const char *unit;
        double number;
        double value; /* the double next to the exact one */
    } rows[] = {
        {"m", 0.17, 0.17},
        {"mm", 170.0, 0.17},
        {"mm", 29.1, 0.0291},
        {"cm", 29.0, 0.29},
        {"in", 1.0, 0.0254},
        {"in", 6.5, 0.1651},
        {"ft", 3.0, 0.9144},
        {"rad", 0.3, 0.3},
        {"deg", 180.0, 3.14159265358979323846},
        {"Hz", 4.3, 4.3},
        {"rpm", 258.0, 4.3},
        {"rpm", 1.0, 1.0 / 60.0},
        {"mm", 0.0, 0.0},
        {"mm", -3.0, -0.003},
        {"deg", 90.0, 1.57079632679489661923},
        {"g", 182.5, 0.1825},
        {"t", 1.2, 1200.0},
        {"lb", 7.0, 3.17514659},
        {"slug", 2.0, 29.187805874412728},
        {"kg mm^2", 120.0, 1.2e-4},
        {"g cm^2", 120.0, 1.2e-5},
        {"N/mm", 240.0, 240000.0},
        {"kN/m", 0.7, 700.0},
        {"MPa", 0.3, 3e5},
        {"GPa", 71.7, 7.17e10},
        {"N mm/rad", 220000.0, 220.0},
        {"N m/deg", 3.0, 171.88733853924697},
        {"lbf", 3.0, 13.3446648457815},
        {"kip", 1.0, 4448.2216152605},
        {"psi", 1.0, 6894.757293168362},
        {"lbf in", 100.0, 11.29848290276167},
        {"lb/in^3", 0.1, 2767.9904710203123},
        {"%", 2.0, 0.02},
        {"N s/mm", 0.3, 300.0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const mt_unit *const u = mt_unit_find(rows[i].unit);
        mt_test_row(t, "%g %s", rows[i].number, rows[i].unit);
        if (!CHECK(t, u != NULL)) {
            continue;
        }
        CHECK(t, mt_unit_to_si(u, rows[i].number) == rows[i].value);
        CHECK(t, mt_unit_written(u, rows[i].value) == rows[i].number);
    }
    mt_test_row(t, "others");
    CHECK(t, mt_unit_find("inch") == NULL && mt_unit_find("kg") == NULL);
    CHECK(t, mt_unit_to_si(mt_unit_find_of("g", "m/s^2"), 2.0) == 19.6133);
    CHECK(t, mt_unit_to_si(mt_unit_find_of("g", "kg"), 2.0) == 0.002);
    CHECK(t, mt_unit_find_of("g", "m") == NULL);
    CHECK(t, mt_unit_to_si(NULL, 0.1) == 0.1 && mt_unit_written(NULL, 0.1) == 0.1);
    CHECK(t, isnan(mt_unit_written(mt_unit_find("mm"), nan(""))));
    CHECK(t, isinf(mt_unit_written(mt_unit_find("mm"), HUGE_VAL)));
}

/* Over all magnitudes, a number that is written reads as the value, or as one next to it. */
static void units__are_read_back(mt_test *t)
{
    int n = 0;
    const mt_unit *const units = mt_units(&n);
    for (int i = 0; i < n; i++) {
        mt_test_row(t, "%s", units[i].name);
        double x = 1.0;
        int exact = 0;
        int all = 0;
        for (int e = -300; e <= 300; e += 3) {
            for (int k = 0; k < 40; k++) {
                x = fmod(x * 16807.0 + 0.618, 2147483647.0);
                const double value = ldexp(1.0 + x / 2147483648.0, e);
                const double back = mt_unit_to_si(&units[i], mt_unit_written(&units[i], value));
                CHECK(t, fabs(back - value) <= nextafter(value, HUGE_VAL) - value);
                exact += back == value;
                all++;
            }
        }
        CHECK(t, exact > all * 3 / 4);
        CHECK(t, units[i].constant == NULL || mt_expr_reserved(units[i].constant));
        CHECK(t, units[i].constant == NULL || mt_unit_is_common(&units[i]));
    }
}

/* What is written with up to 15 digits, of any magnitude, is found again from its value. */
static void units__give_numbers_back(mt_test *t)
{
    int n = 0;
    const mt_unit *const units = mt_units(&n);
    CHECK_INT(t, n, N_UNITS);
    for (int i = 0; i < n; i++) {
        mt_test_row(t, "%s %s", units[i].name, units[i].si);
        double x = 1.0;
        for (int digits = 1; digits <= 15; digits++) {
            for (int k = 0; k < 40; k++) {
                char text[40];
                x = fmod(x * 16807.0 + 0.618, 2147483647.0);
                const double any = (1.0 + 9.0 * x / 2147483648.0) * pow(10.0, k - 20);
                (void)mt_snprintf(text, sizeof text, "%.*e", digits - 1, any);
                const double number = strtod(text, NULL);
                CHECK(t,
                      mt_unit_written(&units[i], mt_unit_to_si(&units[i], number)) == number);
            }
        }
        for (int k = 0; k < i; k++) {
            CHECK(t, strcmp(units[i].name, units[k].name) != 0 ||
                         strcmp(units[i].si, units[k].si) != 0);
        }
    }
}

/* What the table says of a unit follows from its name, read as a text. */
static void units__are_worth_what_their_names_say(mt_test *t)
{
    int n = 0;
    int read = 0;
    const mt_unit *const units = mt_units(&n);
    for (int i = 0; i < n; i++) {
        const mt_unit *const u = &units[i];
        mt_unit_worth is;
        mt_unit_worth si;
        mt_test_row(t, "%s", u->name);
        const bool earth = strcmp(u->si, "m/s^2") == 0;
        if (mt_unit_read(u->name, earth ? MT_READ_ACCELERATIONS : MT_READ_MASSES, &is)) {
            CHECK(t, mt_unit_read(u->si, MT_READ_MASSES, &si));
            CHECK(t, mt_unit_same_powers(&is, &si, true));
            CHECK(t, mt_unit_same_factor(is.factor / si.factor, mt_unit_factor(u)));
            read++;
        }
    }
    CHECK_INT(t, read, N_UNITS - 3); /* all but rpm, Msi and % */
}

static void units__are_read_as_people_write_them(mt_test *t)
{
    static const struct {
        const char *text;
        const char *same; /* NULL: it is none */
        mt_unit_reading reading;
    } rows[] = {
        {"Nmm/rad", "N mm/rad", MT_READ_MASSES},
        {"N*mm / rad", "N mm/rad", MT_READ_MASSES},
        {"N\xC2\xB7mm/rad", "N mm/rad", MT_READ_MASSES},
        {"N\xB7m", "N m", MT_READ_MASSES},
        {"kgm2", "kg m^2", MT_READ_MASSES},
        {"kg*m\xC2\xB2", "kg m^2", MT_READ_MASSES},
        {"kg m\xB2", "kg m^2", MT_READ_MASSES},
        {"kg/m**3", "kg/m^3", MT_READ_MASSES},
        {"m s\xE2\x81\xBB\xC2\xB2", "m/s^2", MT_READ_MASSES},
        {"m s^-2", "m/s^2", MT_READ_MASSES},
        {"m s^(-2)", "m/s^2", MT_READ_MASSES},
        {"m/s/s", "m/s^2", MT_READ_MASSES},
        {"m/sec2", "m/s^2", MT_READ_MASSES},
        {"(m/s^2)/N", "1/kg", MT_READ_MASSES},
        {"m/(N*s^2)", "1/kg", MT_READ_MASSES},
        {"(1/N)*(m/s\xB2)", "1/kg", MT_READ_MASSES},
        {"10^3 N", "kN", MT_READ_MASSES},
        {"\xC2\xB5m", "um", MT_READ_MASSES},
        {"lbf-in", "lbf in", MT_READ_MASSES},
        {"lb/in", "lbf/in", MT_READ_FORCES},
        {"g", "9806650 um/s^2", MT_READ_ACCELERATIONS},
        {"mg/N", "980665 um/s^2/kN/10^-1", MT_READ_ACCELERATIONS},
        {"gn/lb", "g/lbf", MT_READ_BOTH},
        {"g", "1000 mg", MT_READ_MASSES},
        {"", NULL, MT_READ_MASSES},
        {"NONE", NULL, MT_READ_MASSES},
        {"furlong", NULL, MT_READ_MASSES},
        {"mmm", NULL, MT_READ_MASSES},
        {"m//s", NULL, MT_READ_MASSES},
        {"(m/s", NULL, MT_READ_MASSES},
        {"m/s)", NULL, MT_READ_MASSES},
        {"m^", NULL, MT_READ_MASSES},
        {"m^10", NULL, MT_READ_MASSES},
        {"m/0", NULL, MT_READ_MASSES},
        {"((((((((((m))))))))))", NULL, MT_READ_MASSES},
        {"dB", NULL, MT_READ_MASSES},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_unit_worth is;
        mt_unit_worth same;
        mt_test_row(t, "%s", rows[i].text);
        const bool good = mt_unit_read(rows[i].text, rows[i].reading, &is);
        CHECK(t, good == (rows[i].same != NULL));
        if (good &&
            CHECK(t, mt_unit_read(rows[i].same,
                                  rows[i].reading == MT_READ_BOTH ? MT_READ_ACCELERATIONS
                                                                  : MT_READ_MASSES,
                                  &same))) {
            CHECK(t, mt_unit_same_powers(&is, &same, true));
            CHECK(t, mt_unit_same_factor(is.factor, same.factor));
        }
    }
}

/* L in m, a in rad, n in Hz, k in N/m, q a number. */
static const char *const NAMES[] = {"L", "a", "n", "k", "q"};
static const mt_kind KINDS[] = {MT_KIND_LENGTH, MT_KIND_ANGLE, MT_KIND_SPEED, MT_KIND_UNKNOWN,
                                MT_KIND_NUMBER};

static int lookup(const void *context, const char *name, size_t length)
{
    (void)context;
    for (int i = 0; i < MT_COUNT(NAMES); i++) {
        if (length == 1 && name[0] == NAMES[i][0]) {
            return i;
        }
    }
    return -1;
}

static mt_kind kind_of(const void *context, int parameter)
{
    (void)context;
    return KINDS[parameter];
}

static void kinds__follow_from_their_parts(mt_test *t)
{
    static const struct {
        const char *text;
        mt_kind kind;
        bool mixed;
        double bare; /* infinite: not looked at */
    } rows[] = {
        {"50", MT_KIND_NUMBER, false, 50.0},
        {"-(2*25)", MT_KIND_NUMBER, false, -50.0},
        {"0", MT_KIND_ZERO, false, 0.0},
        {"3-3", MT_KIND_ZERO, false, 0.0},
        {"pi/2", MT_KIND_PI, false, 1.57079632679489661923},
        {"5*mm", MT_KIND_LENGTH, false, HUGE_VAL},
        {"5*inch/ft", MT_KIND_NUMBER, false, HUGE_VAL},
        {"10*deg", MT_KIND_ANGLE, false, HUGE_VAL},
        {"258*rpm", MT_KIND_SPEED, false, HUGE_VAL},
        {"L", MT_KIND_LENGTH, false, HUGE_VAL},
        {"L + 50", MT_KIND_LENGTH, true, 50.0},
        {"50 - L", MT_KIND_LENGTH, true, 50.0},
        {"-((3 + L))", MT_KIND_LENGTH, true, 3.0},
        {"2*(L + 50)/q", MT_KIND_LENGTH, true, 50.0},
        {"min(L, 7)", MT_KIND_LENGTH, true, 7.0},
        {"max(0, L)", MT_KIND_LENGTH, false, HUGE_VAL},
        {"hypot(L, 3*mm)", MT_KIND_LENGTH, false, HUGE_VAL},
        {"hypot(3, 4)", MT_KIND_NUMBER, false, 5.0},
        {"L + 10*deg", MT_KIND_UNKNOWN, true, HUGE_VAL},
        {"L + q", MT_KIND_LENGTH, true, HUGE_VAL},
        {"L*a", MT_KIND_LENGTH, false, HUGE_VAL},
        {"L*L", MT_KIND_AREA, false, HUGE_VAL},
        {"sqrt(L^2 + (2*L)^2)", MT_KIND_LENGTH, false, HUGE_VAL},
        {"sqrt(L^2 + 9)", MT_KIND_LENGTH, true, 9.0},
        {"L^3", MT_KIND_UNKNOWN, false, HUGE_VAL},
        {"L*L/L", MT_KIND_LENGTH, false, HUGE_VAL},
        {"50*cos(a)", MT_KIND_NUMBER, false, HUGE_VAL},
        {"k/L + 3", MT_KIND_UNKNOWN, true, 3.0},
        {"k*(1 + L/L)", MT_KIND_UNKNOWN, false, HUGE_VAL},
        {"atan2(L, 2*L)", MT_KIND_ANGLE, false, HUGE_VAL},
        {"a + pi/2", MT_KIND_ANGLE, false, HUGE_VAL},
        {"a + 0.1", MT_KIND_ANGLE, true, 0.1},
        {"abs(n - 3)", MT_KIND_SPEED, true, 3.0},
        {"cbrt(8)", MT_KIND_NUMBER, false, 2.0},
        {"2^3", MT_KIND_NUMBER, false, 8.0},
    };
    mt_arena mem;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_expr e = {0};
        mt_test_row(t, "%s", rows[i].text);
        if (!CHECK_INT(
                t,
                mt_expr_parse(rows[i].text, &(mt_expr_scope){.lookup = lookup}, &mem, &e, NULL),
                MT_OK)) {
            continue;
        }
        const mt_kind_found f = mt_expr_kind(&e, kind_of, NULL);
        CHECK_INT(t, f.mixed, rows[i].mixed);
        if (!(rows[i].mixed && rows[i].kind == MT_KIND_UNKNOWN)) {
            CHECK_INT(t, (int)f.kind, (int)rows[i].kind);
        }
        CHECK(t, isinf(rows[i].bare) || f.bare == rows[i].bare);
    }
    mt_arena_free(&mem);
}

static void kinds__complaints_say_what_to_write(mt_test *t)
{
    static const struct {
        const char *text;
        const char *unit;
        const char *said; /* NULL: nothing */
    } rows[] = {
        {"50", "mm", "50 is 50 m here, as expressions are in SI units: write \"50*mm\""},
        {"50", "in", "write \"50*inch\""},
        {"0.014", "mm",
         "0.014 is 0.014 m here, as expressions are in SI units: write 0.014 m "
         "as \"14*mm\""},
        {"L + 0.014", "cm", "write 0.014 m as \"1.4*cm\""},
        {"240", "N/mm", "240 N/mm is written \"240000\""},
        {"k + 5", "N/mm", "5 N/mm is written \"5000\""},
        {"2*k", "N/mm", NULL},
        {"q", "N/mm", "multiply by 1000"},
        {"0.1", "g", "0.1 is 0.1 kg here"},
        {"2", "%", "2 is 2 here, as expressions are in SI units: 2 % is written \"0.02\""},
        {"q/3", "%", NULL},
        {"50", "m", NULL},
        {"0", "mm", NULL},
        {"L/2 - 3*cm", "mm", NULL},
        {"k/3", "mm", NULL},
        {"k + 3", "mm", "write \"3*mm\""},
        {"q", "ft", "multiply by ft"},
        {"a", "mm", "this is an angle, where a length belongs"},
        {"L*L", "mm", "this is an area, where a length belongs"},
        {"L + 1*rpm", "mm", "adds or compares what has different units"},
        {"pi", "deg", NULL},
        {"pi", "rpm", "write \"3.141592654*rpm\""},
        {"0.1", "deg", "0.1 is 0.1 rad here"},
        {"n", "rpm", NULL},
        {"L", "rpm", "this is a length, where a speed belongs"},
    };
    mt_arena mem;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_expr e = {0};
        char said[MT_KIND_TEXT] = "";
        mt_test_row(t, "%s in %s", rows[i].text, rows[i].unit);
        if (!CHECK_INT(
                t,
                mt_expr_parse(rows[i].text, &(mt_expr_scope){.lookup = lookup}, &mem, &e, NULL),
                MT_OK)) {
            continue;
        }
        const bool any =
            mt_kind_complaint(&e, mt_unit_find(rows[i].unit), kind_of, NULL, said, sizeof said);
        CHECK(t, any == (rows[i].said != NULL));
        CHECK(t, rows[i].said == NULL || strstr(said, rows[i].said) != NULL);
    }
    mt_test_row(t, "SI");
    mt_expr e = {0};
    CHECK_INT(t, mt_expr_parse("50", NULL, &mem, &e, NULL), MT_OK);
    CHECK(t, !mt_kind_complaint(&e, NULL, kind_of, NULL, NULL, 0));
    mt_arena_free(&mem);
}

static void units__of_length_multiply(mt_test *t)
{
    static const char *const good[] = {"5*mm", "5/mm", "mm*5", "5*mm^2", "(1/inch)", "L*ft"};
    static const char *const bad[] = {"mm", "5+mm", "-cm", "max(inch, 3)", "2^mm", "(ft)"};
    mt_arena mem;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    for (int i = 0; i < MT_COUNT(good); i++) {
        mt_expr e = {0};
        mt_test_row(t, "%s", good[i]);
        CHECK_INT(t, mt_expr_parse(good[i], &(mt_expr_scope){.lookup = lookup}, &mem, &e, NULL),
                  MT_OK);
    }
    for (int i = 0; i < MT_COUNT(bad); i++) {
        mt_expr e = {0};
        mt_err err = {.code = MT_OK};
        mt_test_row(t, "%s", bad[i]);
        CHECK_INT(t, mt_expr_parse(bad[i], &(mt_expr_scope){.lookup = lookup}, &mem, &e, &err),
                  MT_E_INPUT);
        CHECK(t, strstr(err.text, "is a unit: write how many of it") != NULL);
    }
    mt_arena_free(&mem);
}

MT_TEST_MAIN(MT_TEST(units__are_what_they_are_worth), MT_TEST(units__are_read_back),
             MT_TEST(units__give_numbers_back), MT_TEST(units__are_worth_what_their_names_say),
             MT_TEST(units__are_read_as_people_write_them),
             MT_TEST(kinds__follow_from_their_parts),
             MT_TEST(kinds__complaints_say_what_to_write), MT_TEST(units__of_length_multiply))
