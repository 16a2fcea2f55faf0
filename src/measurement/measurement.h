/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MEASUREMENT_MEASUREMENT_H
#define MEASUREMENT_MEASUREMENT_H

#include "base/diagnostics.h"
#include "base/document.h"

/* The functions of universal files that are frequency responses. */
enum { MT_FUNCTION_RESPONSE = 4, MT_FUNCTION_TRANSMISSIBILITY = 5 };

/* A measured response at one frequency: output per input. */
typedef struct mt_measured_line {
    double frequency_hz;
    double re;
    double im;
    double coherence; /* from 0 to 1; NaN: not known */
    int line;         /* of the file, from 1 */
} mt_measured_line;

/* A node of a test and a direction there: 1 2 3 along x y z, 4 5 6 about them, negative against
 * them; 0: a scalar, or not given. */
typedef struct mt_measured_freedom {
    int node;
    int direction;
} mt_measured_freedom;

/* One response of a file, of an output to an input. What the file does not give is NULL. */
typedef struct mt_measured_response {
    const char *configuration;
    const char *input;
    const char *output;
    const char *unit; /* "m/s^2 per N" */
    int dataset;      /* of a universal file: the position of its dataset 58, from 1; else 0 */
    int function;     /* its function type; a frequency response has lines */
    mt_measured_freedom response;
    mt_measured_freedom reference;
    /* factor from the file's unit to SI; NaN: not known */
    double si;
    /* the unit whose factor is not known; NULL: the file does not say what is measured */
    const char *foreign;
    /* the quantity that the file names and that `foreign` is no unit of; NULL */
    const char *against;
    double scale;                        /* by finish: lines times scale are in SI */
    MT_LIST_OF(mt_measured_line, lines); /* ascending */
} mt_measured_response;

/* The measured frequency responses of one file. */
typedef struct mt_measurement {
    mt_name name;
    mt_name path;  /* as written */
    double factor; /* numbers of the file times factor are in SI; NaN: by the file's units */
    int dataset;   /* 0: not given */
    mt_name response_name; /* "12+Z"; s NULL: not given */
    mt_name reference_name;
    MT_LIST_OF(mt_measured_response, responses);
    bool read; /* the file was read */
    mt_addr addr;
} mt_measurement;

/* A measurement with every optional member at "not given". */
mt_measurement mt_measurement_default(mt_name name, mt_addr addr);
/* Reads "12+Z", "12Z+", "3-RX", "7" (a scalar) as a node and a direction; false: it is none. */
bool mt_measured_freedom_parse(const char *text, mt_measured_freedom *out);
/* True for a response of a table, and of a universal file where its function type is a
 * frequency response. */
bool mt_measured_is_response(const mt_measured_response *r);
/* The contents of a file: "dataset 3: 12+Z by 1+Z; ...". In mem, which remembers a shortage. */
const char *mt_measured_list_text(const mt_measurement *m, mt_arena *mem);

/* The state of reading a text from start to end. The reader owns the bytes and ends texts in
 * place at separators. */
typedef struct mt_measuring {
    const char *path;
    char *begin;
    char *at;
    char *end; /* points at a NUL */
    char *start_of_line;
    int line; /* of `at`, from 1 */
    mt_arena *mem;
    mt_measurement *out;
    mt_diagnostics *messages; /* NULL */
    mt_err *err;
} mt_measuring;

/* Report MT_E_INPUT with its place. */
mt_status mt_measuring_refuse(mt_measuring *m, int line, int column, const char *fmt, ...)
    MT_PRINTF(4, 5);
/* Skip the end of a line (a line feed, a carriage return, or both); false where `at` is not
 * one. */
bool mt_measuring_newline(mt_measuring *m);
/* The column of `at`, from 1. */
int mt_measuring_column(const mt_measuring *m);
/* Read a text that is a finite decimal number and nothing else ("1.5", "-2e-3", Fortran's
 * "1D+02"). */
bool mt_measuring_number(const char *text, size_t length, double *out);
/* Add a line to a response; 0 Hz is left out. Fails: MT_E_INPUT at the place (frequencies do
 * not ascend, are negative); the arena remembers a shortage. */
mt_status mt_measuring_add(mt_measuring *m, mt_measured_response *r,
                           const mt_measured_line *line, int column);
/* Add a response; NULL: out of memory. */
mt_measured_response *mt_measuring_response(mt_measuring *m);

#endif
