/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_MEASUREMENT_H
#define STUDY_MEASUREMENT_H

#include "model/model.h"

/* Kinds of functions of universal files that are frequency responses. */
enum { MT_FUNCTION_RESPONSE = 4, MT_FUNCTION_TRANSMISSIBILITY = 5 };

/* A measured response at one frequency: output per input. */
typedef struct mt_measured_line {
    double frequency_hz;
    double re;
    double im;
    double coherence; /* from 0 to 1; NaN: not known */
    int line;         /* of the file, from 1 */
} mt_measured_line;

/* A node of a test and a direction there: 1 2 3 along x y z, 4 5 6 about them, below 0 against
 * them; 0: a scalar, or nothing is said. */
typedef struct mt_measured_freedom {
    int node;
    int direction;
} mt_measured_freedom;

/* One response of a file, of an output to an input. What the file does not say is NULL. */
typedef struct mt_measured_response {
    const char *configuration;
    const char *input;
    const char *output;
    const char *unit; /* "m/s^2 per N" */
    int dataset;      /* of a universal file: which of its datasets 58, from 1; else 0 */
    int function;     /* its kind of function; a frequency response has lines */
    mt_measured_freedom response;
    mt_measured_freedom reference;
    /* what numbers are multiplied by to be SI; NaN where that is not known, because of */
    double si;
    const char *foreign; /* this unit; NULL: the file does not say what is measured */
    const char *against; /* what the file says besides, that this unit is none of; NULL */
    double scale;        /* by finish: the lines times this are in SI */
    MT_LIST_OF(mt_measured_line, lines); /* ascending */
} mt_measured_response;

/* Measured frequency responses: what one file has. */
typedef struct mt_measurement {
    mt_name name;
    mt_name path;  /* as written */
    double factor; /* numbers of the file times this are SI; NaN: as the file says */
    mt_addr factor_addr;
    int dataset; /* 0: not said */
    mt_addr dataset_addr;
    mt_name response_name; /* "12+Z"; s NULL: not said */
    mt_name reference_name;
    MT_LIST_OF(mt_measured_response, responses);
    bool read; /* the file could be */
    mt_addr addr;
} mt_measurement;

/* What is not said is left out. */
mt_measurement mt_measurement_default(mt_name name, mt_addr addr);
/* "12+Z", "12Z+", "3-RX", "7" (a scalar) read as a node and a direction; false: it is none. */
bool mt_measured_freedom_parse(const char *text, mt_measured_freedom *out);
/* Of a table always, of a universal file by its kind of function. */
bool mt_measured_is_response(const mt_measured_response *r);
/* What a file has: "dataset 3: 12+Z by 1+Z; ...". In mem, which remembers a shortage. */
const char *mt_measured_list_text(const mt_measurement *m, mt_arena *mem);

#endif
