/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_READ_MEASUREMENT_PRIV_H
#define IO_READ_MEASUREMENT_PRIV_H

#include "io/read_measurement.h"

/* A text that is read from its start to its end. Its bytes are ours: texts of it end where a
 * separator was. */
typedef struct mt_measuring {
    const char *path;
    char *begin;
    char *at;
    char *end; /* a NUL stands there */
    char *start_of_line;
    int line; /* of `at`, from 1 */
    mt_arena *mem;
    mt_measurement *out;
    mt_diagnostics *messages; /* NULL */
    mt_err *err;
} mt_measuring;

/* MT_E_INPUT, told with its place. */
mt_status mt_measuring_refuse(mt_measuring *m, int line, int column, const char *fmt, ...)
    MT_PRINTF(4, 5);
/* Over the end of a line (a line feed, a carriage return, or both), if `at` is one. */
bool mt_measuring_newline(mt_measuring *m);
/* The column of `at`, from 1. */
int mt_measuring_column(const mt_measuring *m);
/* A decimal number and nothing else ("1.5", "-2e-3", Fortran's "1D+02"), finite. */
bool mt_measuring_number(const char *text, size_t length, double *out);
/* One more line of a response; 0 Hz is left out. Fails: MT_E_INPUT (frequencies do not ascend,
 * are negative), told at the place; a shortage is the arena's. */
mt_status mt_measuring_add(mt_measuring *m, mt_measured_response *r,
                           const mt_measured_line *line, int column);
/* One more response; NULL: out of memory. */
mt_measured_response *mt_measuring_response(mt_measuring *m);

/* What a universal file says of the units of a response. */
typedef struct mt_measured_labels {
    int numerator; /* codes of what is measured */
    int denominator;
    bool turns[2]; /* it is about an axis: numerator, denominator */
    const char *numerator_unit;
    const char *denominator_unit;
    double length; /* so many of the file's are a metre, by dataset 164; NaN: it has none */
    double force;
} mt_measured_labels;
/* What a response measures and what its numbers are multiplied by: by the labels of its units,
 * by dataset 164, or of SI; NaN where they are not known or contradict each other. */
void mt_measuring_units(mt_measuring *m, const mt_measured_labels *labels,
                        mt_measured_response *r);

mt_status mt_read_measurement_csv(mt_measuring *m);
mt_status mt_read_measurement_uff(mt_measuring *m);

#endif
