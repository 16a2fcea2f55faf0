/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MEASUREMENT_READ_PRIV_H
#define MEASUREMENT_READ_PRIV_H

#include "measurement/read.h"

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

/* The units of a response in a universal file. */
typedef struct mt_measured_labels {
    int numerator; /* codes of the measured quantities */
    int denominator;
    bool turns[2]; /* true where rotational: numerator, denominator */
    const char *numerator_unit;
    const char *denominator_unit;
    double length; /* units of length of the file per metre, by dataset 164; NaN: no dataset */
    double force;
} mt_measured_labels;
/* Set the quantities of a response and the factor of its numbers to SI: from the labels of its
 * units, from dataset 164, or SI; NaN where they are not known or contradict each other. */
void mt_measuring_units(mt_measuring *m, const mt_measured_labels *labels,
                        mt_measured_response *r);

mt_status mt_read_measurement_csv(mt_measuring *m);
mt_status mt_read_measurement_uff(mt_measuring *m);

#endif
