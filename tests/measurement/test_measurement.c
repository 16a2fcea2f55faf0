/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measured frequency responses as they are read: tables and universal files. */
#define _XOPEN_SOURCE 700 /* NOLINT(cert-dcl37-c,cert-dcl51-cpp): mkdtemp */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/options.h"
#include "measurement/read.h"
#include "mt_test.h"

enum { TEXT = 8192 };

typedef struct loaded {
    mt_arena mem;
    mt_measurement m;
    mt_diagnostics said;
    mt_err err;
    mt_status rc;
} loaded;

static void load_text(const char *text, loaded *out)
{
    const mt_file_text file = {.path = "frf", .text = text};
    const mt_io_options opt = {.files = {.given = &file, .n = 1, .only = true}};
    char sha256[MT_SHA256_TEXT];
    *out = (loaded){.rc = MT_OK};
    out->rc =
        mt_measurement_load("frf", &opt, &out->mem, &out->m, sha256, &out->said, &out->err);
}

static void unload(loaded *l)
{
    mt_diagnostics_free(&l->said);
    mt_arena_free(&l->mem);
}

/* 10 Hz: 1 - 2i; 20 Hz: -0.5 + 0.25i */
static void check_two(mt_test *t, const loaded *l, double tol)
{
    if (!CHECK_INT(t, l->rc, MT_OK) || !CHECK_INT(t, l->m.n_responses, 1) ||
        !CHECK_INT(t, l->m.responses[0].n_lines, 2)) {
        (void)fprintf(stderr, "%s\n", l->err.text);
        return;
    }
    const mt_measured_line *const lines = l->m.responses[0].lines;
    CHECK(t, lines[0].frequency_hz == 10.0 && lines[1].frequency_hz == 20.0);
    CHECK_NEAR(t, lines[0].re, 1.0, tol);
    CHECK_NEAR(t, lines[0].im, -2.0, tol);
    CHECK_NEAR(t, lines[1].re, -0.5, tol);
    CHECK_NEAR(t, lines[1].im, 0.25, tol);
}

static void measurement__tables_of_every_spelling_are_one(mt_test *t)
{
    static const struct {
        const char *name;
        const char *text;
    } rows[] = {
        {"plain", "frequency_hz,real,imag\n10,1,-2\n20,-0.5,0.25\n"},
        {"no end of line", "frequency_hz,real,imag\n10,1,-2\n20,-0.5,0.25"},
        {"other names, other order", "IM;Re;Frequency_Hz\r\n-2;1;10\r\n0.25;-0.5;20\r\n"},
        {"decimal commas", "frequency_hz;real;imag\n10,0;1;-2\n2e1;-0,5;,25\n"},
        {"tabs", "frequency_hz\treal\timag\n10\t1\t-2\n20\t-.5\t+0.25\n"},
        {"mark, comments, blanks",
         "\xef\xbb\xbf# a hammer\n\n frequency_hz , real , imag \n10 ,1 , -2\n  # here\n"
         "20,-0.5,25e-2\n\n"},
        {"quotes", "\"frequency_hz\",real,\"imag\"\n\"10\" ,1,-2\n20,\"-0.5\",0.25\n"},
        {"a quoted separator, a quoted end of line",
         "note,frequency_hz,real,imag\n\"a,\"\"b\"\"\nc\",10,1,-2\n,20,-0.5,0.25\n"},
        {"0 Hz is left out", "frequency_hz,real,imag\n0,7,0\n10,1,-2\n20,-0.5,0.25\n"},
        {"old ends of lines", "frequency_hz,real,imag\r10,1,-2\r20,-0.5,0.25\r"},
        {"magnitude and phase",
         "frequency_hz,magnitude,phase_deg\n10,2.23606797749979,-63.43494882292201\n"
         "20,0.5590169943749475,153.434948822922\n"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        loaded l;
        mt_test_row(t, "%s", rows[i].name);
        load_text(rows[i].text, &l);
        check_two(t, &l, 1e-14);
        unload(&l);
    }
}

static void measurement__tables_say_what_they_are_of(mt_test *t)
{
    loaded l;
    load_text("configuration,input,output,unit,frequency_hz,real,imag,coherence\n"
              "a,f,x,m per N,10,1,-2,0.5\na,f,x,m per N,20,-0.5,0.25,1\n"
              "a,f,y,m per N,5,1,1,0\n",
              &l);
    if (CHECK_INT(t, l.rc, MT_OK) && CHECK_INT(t, l.m.n_responses, 2)) {
        const mt_measured_response *const r = &l.m.responses[1];
        CHECK_STR(t, r->configuration, "a");
        CHECK_STR(t, r->input, "f");
        CHECK_STR(t, r->output, "y");
        CHECK_STR(t, r->unit, "m per N");
        CHECK_INT(t, r->lines[0].line, 4);
        CHECK(t, l.m.responses[0].lines[0].coherence == 0.5);
    }
    unload(&l);
}

static void measurement__wrong_files_are_told_with_their_place(mt_test *t)
{
    static const struct {
        const char *name;
        const char *text;
        int line;
        int column;
        const char *says;
    } rows[] = {
        {"empty", "", 1, 1, "empty"},
        {"comments alone", "# x\n", 2, 1, "empty"},
        {"no names", "10,1,2\n20,1,2\n", 1, 1, "\"frequency_hz\""},
        {"a name misspelt", "frequncy_hz,real,imag\n", 1, 1, "is it \"frequncy_hz\"?"},
        {"no imaginary part", "frequency_hz,real\n1,1\n", 1, 1, "\"imag\", which goes"},
        {"no phase", "frequency_hz,magnitude\n1,1\n", 1, 1, "\"phase_deg\", which goes"},
        {"neither", "frequency_hz,x\n1,1\n", 1, 1, "\"real\" (with"},
        {"a name twice", "frequency_hz,real,imag,real\n1,1,1,1\n", 1, 24, "twice"},
        {"names alone", "frequency_hz,real,imag\n", 2, 1, "no lines"},
        {"too few fields", "frequency_hz,real,imag\n1,1\n", 2, 1, "2 fields"},
        {"too many fields", "frequency_hz,real,imag\n1,1,1,\n", 2, 1, "4 fields"},
        {"no number", "frequency_hz,real,imag\n1,x,1\n", 2, 3, "\"real\" (x)"},
        {"nan", "frequency_hz,real,imag\n1,1,nan\n", 2, 5, "not a finite number"},
        {"inf", "frequency_hz,real,imag\n1,inf,1\n", 2, 3, "not a finite number"},
        {"too large", "frequency_hz,real,imag\n1,1e999,1\n", 2, 3, "not a finite number"},
        {"hexadecimal", "frequency_hz,real,imag\n0x10,1,1\n", 2, 1, "not a finite number"},
        {"no value", "frequency_hz,real,imag\n1,,1\n", 2, 3, "no value"},
        {"descending", "frequency_hz,real,imag\n2,1,1\n1,1,1\n", 3, 1, "ascend"},
        {"twice", "frequency_hz,real,imag\n2,1,1\n2,1,1\n", 3, 1, "ascend"},
        {"negative", "frequency_hz,real,imag\n-2,1,1\n", 2, 1, "below 0"},
        {"a coherence above 1", "frequency_hz,real,imag,coherence\n2,1,1,1.5\n", 2, 7,
         "from 0 to 1"},
        {"a magnitude below 0", "frequency_hz,magnitude,phase_deg\n2,-1,1\n", 2, 3, "below 0"},
        {"an open quote", "frequency_hz,real,imag\n\"2,1,1\n", 2, 1, "not closed"},
        {"a quote within", "frequency_hz,real,imag\n2\"2,1,1\n", 2, 2, "in the midst"},
        {"behind a quote", "frequency_hz,real,imag\n\"2\"2,1,1\n", 2, 4, "closing quote"},
        {"no dataset", "    -1\n    15\n    -1\n", 1, 1, "no dataset 58"},
        {"an open dataset", "    -1\n    15\n", 1, 1, "does not end"},
        {"between datasets", "    -1\n    15\n    -1\nx\n", 4, 1, "begins with"},
        {"no header", "    -1\n    58\na\nb\nc\nd\ne\n    -1\n", 8, 1, "11 lines"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        loaded l;
        char place[64];
        mt_test_row(t, "%s", rows[i].name);
        load_text(rows[i].text, &l);
        CHECK_INT(t, l.rc, MT_E_INPUT);
        (void)snprintf(place, sizeof place, "frf:%d:%d: ", rows[i].line, rows[i].column);
        CHECK(t, strncmp(l.err.text, place, strlen(place)) == 0);
        CHECK(t, strstr(l.err.text, rows[i].says) != NULL);
        if (t->failures > 0) {
            (void)fprintf(stderr, "%s: %s\n", rows[i].name, l.err.text);
        }
        CHECK_INT(t, l.said.count, 1);
        unload(&l);
    }
}

/* A universal file with a response of two lines, in one of its forms. */
static void universal(char text[TEXT], int type, int even, const char *axes, const char *values)
{
    (void)snprintf(text, TEXT,
                   "    -1\n    58\nNONE\nNONE\nNONE\nNONE\nNONE\n"
                   "%5d%10d%5d%10d %-10s%10d%4d %-10s%10d%4d\n"
                   "%10d%10d%10d%13.5e%13.5e%13.5e\n"
                   "        18    0    0    0 Frequency            Hz                  \n"
                   "%s"
                   "         0    0    0    0 NONE                 NONE                \n"
                   "%s    -1\n",
                   4, 0, 0, 0, "NONE", 12, -3, "NONE", 1, 3, type, 2, even, even ? 10.0 : 0.0,
                   even ? 10.0 : 0.0, 0.0, axes, values);
}

static const char ACCELERANCE[] =
    "        12    0    0    0 Acceleration         m/s^2               \n"
    "        13    0    0    0 Excitation           N                   \n";

static void measurement__universal_files_of_every_form_are_one(mt_test *t)
{
    static const struct {
        const char *name;
        int type;
        int even;
        const char *values;
    } rows[] = {
        {"single, even", 5, 1, " -1.00000E+00  2.00000E+00  5.00000E-01 -2.50000E-01\n"},
        {"single, uneven", 5, 0,
         "  1.00000E+01 -1.00000E+00  2.00000E+00  2.00000E+01  5.00000E-01 -2.50000E-01\n"},
        {"double, even", 6, 1,
         " -1.000000000000E+00  2.000000000000E+00  5.000000000000E-01 -2.500000000000E-01\n"},
        {"double, uneven", 6, 0,
         "  1.00000E+01 -1.000000000000E+00  2.000000000000E+00\n"
         "  2.00000E+01  5.000000000000E-01 -2.500000000000E-01\n"},
        {"fields that touch", 5, 1, "-1.00000E+00+2.00000E+00 5.0000D-001-2.50000D-001\n"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        char text[TEXT];
        loaded l;
        mt_test_row(t, "%s", rows[i].name);
        universal(text, rows[i].type, rows[i].even, ACCELERANCE, rows[i].values);
        load_text(text, &l);
        check_two(t, &l, 1e-15); /* the response points against z: signs turn */
        if (l.m.n_responses == 1) {
            CHECK_STR(t, l.m.responses[0].unit, "m/s^2 per N");
            CHECK_INT(t, l.m.responses[0].response.node, 12);
            CHECK(t, l.m.responses[0].si == 1.0);
        }
        unload(&l);
    }
}

static void measurement__universal_units_are_turned_or_told(mt_test *t)
{
    static const char values[] = " -1.00000E+00  2.00000E+00  5.00000E-01 -2.50000E-01\n";
    static const char millimetres[] =
        "    -1\n   164\n         5mm (milli-newton)           2\n"
        "  1.0000000000000000D+03  1.0000000000000000D+03  1.0000000000000000D+00\n"
        "  2.7315000000000000D+02\n    -1\n";
    char text[TEXT];
    char both[2 * TEXT];
    loaded l;
    universal(text, 5, 1, ACCELERANCE, values);
    (void)snprintf(both, sizeof both, "%s%s", millimetres, text);
    load_text(both, &l);
    check_two(t, &l, 1e-15);
    CHECK(t, l.m.n_responses == 1 && l.m.responses[0].si == 1.0); /* mm/s^2 per mN */
    unload(&l);
    universal(text, 5, 1,
              "         8    0    0    0 Displacement         mm                  \n"
              "        13    0    0    0 Moment               N                   \n",
              values);
    load_text(text, &l);
    CHECK(t, l.m.n_responses == 1 && l.m.responses[0].si == 0.001);
    CHECK(t, l.m.n_responses == 1 && strcmp(l.m.responses[0].unit, "m per N") == 0);
    unload(&l);
    (void)snprintf(both, sizeof both, "%s%s", millimetres, text);
    load_text(both, &l);
    CHECK(t, l.m.n_responses == 1 && l.m.responses[0].si == 1.0);
    unload(&l);
}

/* Labels as test software writes them, over codes of an acceleration (12) and a force (13). */
static void measurement__labels_of_units_are_understood(mt_test *t)
{
    static const char values[] = " -1.00000E+00  2.00000E+00  5.00000E-01 -2.50000E-01\n";
    static const double LBF = 0.45359237 * 9.80665;
    static const struct {
        int code; /* of the numerator; 0: not said */
        const char *top;
        const char *bottom;
        double si;           /* NaN: refused */
        const char *against; /* what is told then; NULL: the unit is not known */
    } rows[] = {
        {12, "m/s^2", "N", 1.0, NULL},
        {12, "m/s^2/N", "", 1.0, NULL},
        {12, "(m/s^2)/N", "NONE", 1.0, NULL},
        {12, "m/s2/N", "", 1.0, NULL},
        {12, "(m/s\xB2)/N", "", 1.0, NULL},
        {12, "(1/N)*(m/s\xB2)", "", 1.0, NULL},
        {12, "(m/s\xC2\xB2)/N", "", 1.0, NULL},
        {12, "m\xC2\xB7s\xE2\x81\xBB\xC2\xB2/N", "", 1.0, NULL},
        {12, "m/(N*s^2)", "", 1.0, NULL},
        {12, "1/kg", "", 1.0, NULL},
        {12, "(m/s^2)/N", "N", 1.0, NULL},
        {12, "m/sec^2", "N", 1.0, NULL},
        {12, "m/s/s", "N", 1.0, NULL},
        {12, "m/s**2", "Newton", 1.0, NULL},
        {12, "", "", 1.0, NULL},
        {12, "NONE", "NONE", 1.0, NULL},
        {12, "m/s^2", "", 1.0, NULL},
        {12, "g", "N", 9.80665, NULL},
        {12, "g/N", "", 9.80665, NULL},
        {12, "gn/N", "", 9.80665, NULL},
        {12, "G/N", "", 9.80665, NULL},
        {12, "mg/N", "", 9.80665e-3, NULL},
        {12, "g/lbf", "", 9.80665 / LBF, NULL},
        {12, "g", "lb", 9.80665 / LBF, NULL},
        {12, "in/s^2", "lbf", 0.0254 / LBF, NULL},
        {12, "mm/s^2/N", "", 1e-3, NULL},
        {12, "mm/s^2", "kN", 1e-6, NULL},
        {12, "N", "N", (double)NAN, "an acceleration"},
        {12, "m", "N", (double)NAN, "an acceleration"},
        {12, "m/s^2", "m", (double)NAN, "a force"},
        {12, "m/s", "", (double)NAN, "an acceleration"},
        {12, "furlong", "N", (double)NAN, NULL},
        {12, "m/s^2", "EU", (double)NAN, NULL},
        {12, "V", "N", (double)NAN, NULL},
        {11, "mm/s", "N", 1e-3, NULL},
        {11, "g", "N", (double)NAN, "a velocity"},
        {8, "um/N", "", 1e-6, NULL},
        {8, "\xB5m", "N", 1e-6, NULL},
        {8, "\xC2\xB5m", "N", 1e-6, NULL},
        {0, "g/N", "", 9.80665, NULL},
        {0, "mm", "N", 1e-3, NULL},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        char axes[256];
        char text[TEXT];
        loaded l;
        mt_test_row(t, "%d: %s over \"%s\"", rows[i].code, rows[i].top, rows[i].bottom);
        (void)snprintf(axes, sizeof axes,
                       "%10d    0    0    0 %-20s %-20s\n%10d    0    0    0 %-20s %-20s\n",
                       rows[i].code, "", rows[i].top, rows[i].code == 0 ? 0 : 13, "",
                       rows[i].bottom);
        universal(text, 5, 1, axes, values);
        load_text(text, &l);
        if (CHECK_INT(t, l.rc, MT_OK) && CHECK_INT(t, l.m.n_responses, 1)) {
            const mt_measured_response *const r = &l.m.responses[0];
            if (isnan(rows[i].si)) {
                CHECK(t, isnan(r->si));
                CHECK(t, r->foreign != NULL);
                CHECK(t, (r->against == NULL) == (rows[i].against == NULL));
                CHECK(t, rows[i].against == NULL || r->against == NULL ||
                             strcmp(r->against, rows[i].against) == 0);
            } else {
                CHECK_NEAR(t, r->si / rows[i].si, 1.0, 1e-14);
                CHECK(t, rows[i].code != 0 || r->unit != NULL);
            }
        }
        unload(&l);
    }
}

static void measurement__filled_last_lines_are_read(mt_test *t)
{
    static const char *const fillings[] = {
        " -1.0E+00  2.0E+00  5.0E-01 -2.5E-01  0.00000E+00  0.00000E+00\n",
        " -1.0E+00  2.0E+00\n  5.0E-01 -2.5E-01  0.00000E+00  0.00000E+00\n",
        " -1.0E+00  2.0E+00  5.0E-01 -2.5E-01  7.00000E+00   \n\n",
    };
    for (int i = 0; i < MT_COUNT(fillings); i++) {
        char text[TEXT];
        loaded l;
        mt_test_row(t, "%d", i);
        universal(text, 5, 1, ACCELERANCE, fillings[i]);
        load_text(text, &l);
        check_two(t, &l, 1e-15);
        unload(&l);
    }
}

/* What is there is told where a frequency response is not. */
static void measurement__contents_are_told(mt_test *t)
{
    static const struct {
        const char *text;
        const char *says;
    } rows[] = {
        {"    -1\n    15\n  1 0 0 11 0. 0. 0.\n  2 0 0 11 0. 0. 0.\n    -1\n"
         "    -1\n    55\nN\nN\nN\nN\nN\n         1         2         2         8\n    -1\n",
         "no dataset 58; it holds: 1 mode shape (dataset 55), 2 nodes (dataset 15); no "
         "frequency "
         "response"},
        {"    -1\r\n  2411\r\n 1 1 1 11\r\n 0. 0. 0.\r\n    -1\r\n    -1\r\n   164\r\n 1 SI\r\n"
         "  1.0000000000000000D+00  1.0000000000000000D+00  1.0D+00\r\n 273.\r\n    -1\r\n",
         "1 node (dataset 2411), 1 set of units (dataset 164); no"},
        {"    -1\n   757\nx\n    -1\n", "1 other dataset"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        loaded l;
        mt_test_row(t, "%d", i);
        load_text(rows[i].text, &l);
        CHECK_INT(t, l.rc, MT_E_INPUT);
        if (!CHECK(t, strstr(l.err.text, rows[i].says) != NULL)) {
            (void)fprintf(stderr, "%s\n", l.err.text);
        }
        unload(&l);
    }
    static const struct {
        int function;
        const char *says;
    } kinds[] = {{2, "no frequency response; it holds: 1 power spectrum (dataset 58)"},
                 {1, "1 time history (dataset 58)"},
                 {9, "1 power spectral density (dataset 58)"},
                 {99, "1 function of another kind (dataset 58)"}};
    for (int i = 0; i < MT_COUNT(kinds); i++) {
        char text[TEXT];
        char number[8];
        loaded l;
        mt_test_row(t, "function %d", kinds[i].function);
        universal(text, 5, 1, ACCELERANCE, " 1. 2. 3. 4.\n");
        (void)snprintf(number, sizeof number, "%5d", kinds[i].function);
        memcpy(strstr(text, "    4"), number, 5);
        load_text(text, &l);
        CHECK_INT(t, l.rc, MT_E_INPUT);
        if (!CHECK(t, strstr(l.err.text, kinds[i].says) != NULL)) {
            (void)fprintf(stderr, "%s\n", l.err.text);
        }
        unload(&l);
    }
}

static void measurement__wrong_universal_files_are_told(mt_test *t)
{
    static const struct {
        const char *name;
        int type;
        int even;
        const char *values;
        const char *says;
    } rows[] = {
        {"no phase", 2, 1, " 1.0 2.0\n", "frf:9:1: a frequency response is complex"},
        {"too few", 5, 1, " 1.0 2.0 3.0\n", "frf:15:1: the dataset ends after 3 of 4"},
        {"one to a line, -1 ends it", 5, 1, "-1\r\n2\r\n",
         "frf:14:1: the dataset ends after 0 of 4"},
        {"too many", 5, 1, " 1.0 2.0 3.0 4.0\n 5.0\n", "frf:15:1: values are followed by"},
        {"no number", 5, 1, " 1.0 2.0 3.0 NaN\n", "frf:14:14: \"NaN\" is not a finite"},
        {"another type", 7, 1, " 1.0 2.0 3.0 NaN\n", "frf:9:1: the type of data"},
        {"descending", 5, 0, " 2.0 1.0 1.0 1.0 1.0 1.0\n", "frf:14:14: frequencies must asc"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        char text[TEXT];
        loaded l;
        mt_test_row(t, "%s", rows[i].name);
        universal(text, rows[i].type, rows[i].even, ACCELERANCE, rows[i].values);
        load_text(text, &l);
        CHECK_INT(t, l.rc, MT_E_INPUT);
        if (!CHECK(t, strncmp(l.err.text, rows[i].says, strlen(rows[i].says)) == 0)) {
            (void)fprintf(stderr, "%s\n", l.err.text);
        }
        unload(&l);
    }
}

static void measurement__no_beginning_of_a_file_is_read_beyond(mt_test *t)
{
    char text[TEXT];
    char part[TEXT];
    universal(text, 6, 0, ACCELERANCE,
              "  1.00000E+01 -1.000000000000E+00  2.000000000000E+00\n"
              "  2.00000E+01  5.000000000000E-01 -2.500000000000E-01\n");
    for (size_t n = 0; n < strlen(text); n++) {
        loaded l;
        memcpy(part, text, n);
        part[n] = '\0';
        load_text(part, &l);
        mt_test_row(t, "%zu bytes", n);
        CHECK(t, l.rc == MT_E_INPUT || n + 1 == strlen(text));
        unload(&l);
    }
}

static void put_binary(FILE *f, double value, int size, bool big)
{
    const float single = (float)value;
    unsigned char bytes[8];
    memcpy(bytes, size == 4 ? (const void *)&single : (const void *)&value, (size_t)size);
    for (int i = 0; i < size; i++) { /* this machine is little endian, as all that are tested */
        (void)fputc(bytes[big ? size - 1 - i : i], f);
    }
}

static void write_binary(const char *path, int type, int even, bool big)
{
    static const double values[] = {10.0, -1.0, 2.0, 20.0, 0.5, -0.25};
    char text[TEXT];
    const int size = type == 5 ? 4 : 8;
    FILE *const f = fopen(path, "wb");
    universal(text, type, even, ACCELERANCE, "");
    char *const number = strstr(text, "    58\n");
    char *const end = strstr(number + 7, "    -1\n");
    if (f == NULL) {
        return;
    }
    (void)fprintf(f, "    -1\n    58b%6d%6d%12d%12d%6d%6d%12d%12d\n", big ? 2 : 1, 2, 11,
                  size * (even ? 4 : 6), 0, 0, 0, 0);
    (void)fwrite(number + 7, 1, (size_t)(end - number - 7), f);
    for (int i = 0; i < MT_COUNT(values); i++) {
        if (!even || i % 3 != 0) {
            put_binary(f, values[i], size, big);
        }
    }
    (void)fputs("    -1\n", f);
    (void)fclose(f);
}

static void measurement__binary_is_as_text(mt_test *t)
{
    char folder[] = "/tmp/modetune_frf_XXXXXX";
    char path[64];
    REQUIRE(t, mkdtemp(folder) != NULL);
    (void)snprintf(path, sizeof path, "%s/a.uff", folder);
    for (int i = 0; i < 8; i++) {
        const mt_io_options opt = {0};
        char sha256[MT_SHA256_TEXT];
        loaded l = {.rc = MT_OK};
        mt_test_row(t, "type %d, %s, %s", i & 1 ? 6 : 5, i & 2 ? "even" : "uneven",
                    i & 4 ? "big endian" : "little endian");
        write_binary(path, i & 1 ? 6 : 5, i & 2 ? 1 : 0, (i & 4) != 0);
        l.rc = mt_measurement_load(path, &opt, &l.mem, &l.m, sha256, &l.said, &l.err);
        check_two(t, &l, 1e-15);
        unload(&l);
    }
    (void)unlink(path);
    (void)rmdir(folder);
}

static void measurement__freedoms_are_read(mt_test *t)
{
    static const struct {
        const char *text;
        int node;
        int direction; /* -99: none */
    } rows[] = {{"12+Z", 12, 3}, {"12Z+", 12, 3},   {"12z", 12, 3},   {"3-RX", 3, -4},
                {"3RX-", 3, -4}, {"7", 7, 0},       {"", 0, -99},     {"Z", 0, -99},
                {"12Q", 0, -99}, {"12+Z+", 0, -99}, {"12Z ", 0, -99}, {"99999999999X", 0, -99},
                {"12+", 0, -99}, {"12R", 0, -99}};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_measured_freedom f;
        mt_test_row(t, "\"%s\"", rows[i].text);
        const bool ok = mt_measured_freedom_parse(rows[i].text, &f);
        CHECK(t, ok == (rows[i].direction != -99));
        CHECK(t, !ok || (f.node == rows[i].node && f.direction == rows[i].direction));
    }
}

MT_TEST_MAIN(MT_TEST(measurement__tables_of_every_spelling_are_one),
             MT_TEST(measurement__tables_say_what_they_are_of),
             MT_TEST(measurement__wrong_files_are_told_with_their_place),
             MT_TEST(measurement__universal_files_of_every_form_are_one),
             MT_TEST(measurement__universal_units_are_turned_or_told),
             MT_TEST(measurement__labels_of_units_are_understood),
             MT_TEST(measurement__filled_last_lines_are_read),
             MT_TEST(measurement__contents_are_told),
             MT_TEST(measurement__wrong_universal_files_are_told),
             MT_TEST(measurement__no_beginning_of_a_file_is_read_beyond),
             MT_TEST(measurement__binary_is_as_text), MT_TEST(measurement__freedoms_are_read))
