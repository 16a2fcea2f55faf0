/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ENVIRONMENT_ROTOR_H
#define ENVIRONMENT_ROTOR_H

#include "base/document.h"
#include "environment/aircraft.h"
#include "io/reader.h"

/* Rotors and their harmonics: how every file that has one reads and checks it, and what it
 * takes from a catalogue. */

/* A harmonic as written: "4P", "nP", "2nP" of the main rotor, "1T", "nT" of the tail rotor. n
 * (or N) is the number of blades. */
typedef struct mt_harmonic {
    int multiple;     /* the number in front, 1 where there is none */
    bool blade_count; /* times the number of blades */
    bool tail;        /* of the tail rotor */
    const char *text;
    mt_addr addr;
} mt_harmonic;

enum { MT_MAX_MULTIPLE = 999 };

/**
 * Read "[number][n]P" or "...T": a number from 1 to MT_MAX_MULTIPLE without leading zeros, n or
 * N, or both. Sets all but addr; text is not copied. Returns false (out is zeroed) for anything
 * else.
 */
bool mt_harmonic_parse(const char *text, mt_harmonic *out);

/* Numbers that are not given are NaN, counts 0. */
typedef struct mt_rotor {
    /* of the catalogue, which gives speeds and blades; s NULL: the file gives them */
    mt_name aircraft;
    const char *name; /* in labels; NULL: the aircraft's, else "rotor" */
    double speed_hz;
    int blades;
    bool has_tail; /* the file gives a tail rotor */
    double tail_speed_hz;
    int tail_blades;
    int n_harmonics;
    mt_harmonic *harmonics;
    /* speeds from range_lower * speed to range_upper * speed; default 1 and 1 */
    double range_lower;
    double range_upper;
    double margin_percent; /* default: that of the list of bands */
    mt_addr addr;
} mt_rotor;

/* A rotor with every optional member at "not given" or its default, all addresses at addr. */
mt_rotor mt_rotor_default(mt_addr addr);
/* Frequency of a harmonic at the nominal speed [Hz]; NaN where its speed or its number of
 * blades is not given. */
double mt_rotor_harmonic_hz(const mt_rotor *rotor, const mt_harmonic *harmonic);

/* Read the harmonics ("4P", "nT") of a rotor of a study or a profile; invalid ones are
 * noted. */
void mt_read_harmonics(mt_reader *r, mt_addr list, mt_rotor *rotor);

/* A value of the catalogue that is not confirmed in a document. */
typedef struct mt_rotor_warning {
    const char *what; /* "rotor speed", "tail rotor's number of blades" */
    const mt_aircraft_value *value;
} mt_rotor_warning;
enum { MT_ROTOR_WARNINGS = 4 };

/* Set the rotor's speeds and blades from the aircraft. */
void mt_rotor_take(mt_rotor *rotor, const mt_aircraft *aircraft);
/* The values that the harmonics use and that are not confirmed, in out; returns their
 * number. */
int mt_rotor_warnings(const mt_rotor *rotor, const mt_aircraft *aircraft,
                      mt_rotor_warning out[MT_ROTOR_WARNINGS]);
/* Note harmonics that are given twice or whose speed or blades are not known; aircraft NULL:
 * the rotor is as given. */
void mt_rotor_check_harmonics(const mt_rotor *rotor, const mt_aircraft *aircraft,
                              mt_diags *diags);
/* Least plausible factor of a rotor's speed. A rotor turns at 0.9 to 1.1 of its nominal speed,
 * between idle and overspeed at 0.5 to 1.3; [95, 105] is in percent and suspicious. */
#define MT_ROTOR_LEAST_SPEED 0.5
/* Least plausible factor of a machine's speed: an engine idles at a tenth of its nominal
 * speed. */
#define MT_MACHINE_LEAST_SPEED 0.05
/* Warn at addr of suspicious factors of the nominal speed of a rotor or a machine (whose:
 * "rotor's"), plausible from `least` on. */
void mt_read_warning_range(mt_reader *r, double lower, double upper, double least,
                           const char *whose, mt_addr addr);
/* Note a range of speeds that does not ascend. */
void mt_rotor_check_range(const mt_rotor *rotor, mt_diags *diags);

/* Note and return true where n exceeds a thousand, as each is compared with all others. what:
 * "harmonics". */
bool mt_rotor_too_many(mt_diags *diags, int n, mt_addr addr, const char *what);

#endif
