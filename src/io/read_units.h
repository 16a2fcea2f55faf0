/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_READ_UNITS_H
#define IO_READ_UNITS_H

#include "io/reader.h"

/*
 * Numbers in units other than SI. A bare number (of JSON) is in the unit that applies at its
 * place; an expression (a string) is in SI, so an expression there that looks like a bare
 * number, or has one among its terms, is refused with the correct form.
 */
/* The units that "units" of a model or a study may name. */
enum { MT_LENGTH_NAMES = 5, MT_ANGLE_NAMES = 2, MT_SPEED_NAMES = 2 };
extern const char *const mt_length_names[MT_LENGTH_NAMES];
extern const char *const mt_angle_names[MT_ANGLE_NAMES];
extern const char *const mt_speed_names[MT_SPEED_NAMES];
/* Read "units" of a model or a study by its table, in the order of mt_dimension: the unit of
 * each dimension, NULL where none is given. */
void mt_read_units(mt_reader *r, mt_addr value, const mt_key_table *table,
                   const mt_unit *units[MT_DIMENSION_COUNT]);
/* As mt_reader_expr, with a bare number in this unit (NULL: SI). */
bool mt_reader_expr_in(mt_reader *r, mt_addr value, const mt_unit *unit, mt_expr *out);
/* Compare the dimension of an expression, given as text at the value, with that of this unit,
 * which applies to bare numbers there; a mismatch is noted. No check where the unit is NULL or
 * SI, or for bare numbers. */
void mt_reader_check_kind(mt_reader *r, mt_addr value, const mt_expr *e, const mt_unit *unit);

#endif
