/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ENVIRONMENT_READ_AIRCRAFT_H
#define ENVIRONMENT_READ_AIRCRAFT_H

#include "base/diagnostics.h"
#include "environment/aircraft.h"
#include "io/options.h"
#include "io/reader.h"

/**
 * Read and check a catalogue of aircraft (format "modetune-aircraft/1").
 * @param[in]  mem  owns the records; not freed on failure
 * Fails and messages as for mt_model_load.
 */
mt_status mt_aircraft_load(const char *path, const mt_io_options *opt, mt_arena *mem,
                           mt_aircraft_list *out, mt_diagnostics *messages, mt_err *err);

/* Name of the catalogue built into the program, and the options that read it; text must live as
 * long as the options. */
extern const char mt_aircraft_own_name[];
mt_io_options mt_aircraft_own(mt_file_text *text);

/* The key tables of a catalogue of aircraft, for the test that compares them with the JSON
 * Schema; *n is their number. */
const mt_key_table *const *mt_aircraft_key_tables(int *n);

#endif
