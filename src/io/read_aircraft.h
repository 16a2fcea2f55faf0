/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_READ_AIRCRAFT_H
#define IO_READ_AIRCRAFT_H

#include "io/io.h"
#include "io/reader.h"

/* The tables of keys of a catalogue of aircraft, for the test that holds them to the JSON
 * Schema; *n their number. */
const mt_key_table *const *mt_aircraft_key_tables(int *n);

#endif
