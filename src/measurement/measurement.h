/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MEASUREMENT_MEASUREMENT_H
#define MEASUREMENT_MEASUREMENT_H

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

#endif
