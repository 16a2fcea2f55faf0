/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ENVIRONMENT_AIRCRAFT_H
#define ENVIRONMENT_AIRCRAFT_H

#include "base/diagnostics.h"
#include "base/document.h"
#include "io/options.h"
#include "io/reader.h"

/* A catalogue of rotors: plain records, read by io. Each value names its source and says
 * whether the value was confirmed there. */
typedef struct mt_aircraft_value {
    double value;     /* Hz, or the number of blades */
    const char *text; /* "258 rpm", "4": as the catalogue gives it */
    bool confirmed;   /* confirmed in a public document: its source */
    const char *source;
} mt_aircraft_value;

enum { MT_MAX_BLADES = 20 };

typedef struct mt_aircraft_rotor {
    mt_aircraft_value speed;
    mt_aircraft_value blades;
} mt_aircraft_rotor;

typedef struct mt_aircraft {
    mt_name name;
    mt_aircraft_rotor main_rotor;
    bool has_tail; /* a tail rotor */
    mt_aircraft_rotor tail_rotor;
} mt_aircraft;

typedef struct mt_aircraft_list {
    int n;
    mt_aircraft *items;
    const char *sha256; /* of the file, hexadecimal */
} mt_aircraft_list;

/* The aircraft of that name; NULL where the catalogue has none. */
const mt_aircraft *mt_aircraft_find(const mt_aircraft_list *list, const char *name);

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
