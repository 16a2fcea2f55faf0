/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_READ_AIRCRAFT_H
#define IO_READ_AIRCRAFT_H

#include "base/diagnostics.h"
#include "io/options.h"
#include "io/reader.h"
#include "study/aircraft.h"

/**
 * Read and check a catalogue of aircraft (format "modetune-aircraft/1").
 * @param[in]  mem  owns the records; not freed on failure
 * Fails and messages as for mt_model_load.
 */
mt_status mt_aircraft_load(const char *path, const mt_io_options *opt, mt_arena *mem,
                           mt_aircraft_list *out, mt_diagnostics *messages, mt_err *err);

/* What the catalogue that is part of the program is called, and the options that read it from
 * there; text has to live as long. */
extern const char mt_aircraft_own_name[];
mt_io_options mt_aircraft_own(mt_file_text *text);

/* The tables of keys of a catalogue of aircraft, for the test that holds them to the JSON
 * Schema; *n their number. */
const mt_key_table *const *mt_aircraft_key_tables(int *n);

#endif
