/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_READ_UNITS_H
#define IO_READ_UNITS_H

#include "io/reader.h"

/*
 * Numbers in other units than SI. A bare number (of JSON) is in the unit that holds where it
 * stands; an expression (a string) is in SI, so one there that looks like a bare number, or
 * has one among its terms, is refused with what to write.
 */
extern const mt_key_table mt_units_keys;

/* "units" of a model or a study: the unit of each dimension, NULL where it says none. */
void mt_read_units(mt_reader *r, mt_addr value, const mt_unit *units[MT_DIMENSION_COUNT]);
/* As mt_reader_expr, a bare number in this unit (NULL: SI). */
bool mt_reader_expr_in(mt_reader *r, mt_addr value, const mt_unit *unit, mt_expr *out);
/* An expression, given as text at the value, where numbers are in this unit: what it measures
 * is held against that; noted where it cannot be meant. Nothing is where the unit is NULL or of
 * SI, and of bare numbers. */
void mt_reader_check_kind(mt_reader *r, mt_addr value, const mt_expr *e, const mt_unit *unit);

#endif
