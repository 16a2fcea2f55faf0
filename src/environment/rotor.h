/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ENVIRONMENT_ROTOR_H
#define ENVIRONMENT_ROTOR_H

#include "environment/aircraft.h"
#include "environment/bands.h"

/* Checks of a rotor (study/bands.h), for every file that has one, and what it takes from a
 * catalogue. */

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
/* A warning about suspicious factors of the speed of a rotor or a machine (whose: "rotor's"),
 * plausible from `least` on; in mem. NULL: none. */
const char *mt_rotor_warning_range(double lower, double upper, double least, const char *whose,
                                   mt_arena *mem);
/* Note a range of speeds that does not ascend. */
void mt_rotor_check_range(const mt_rotor *rotor, mt_diags *diags);

/* Note and return true where n exceeds a thousand, as each is compared with all others. what:
 * "harmonics". */
bool mt_rotor_too_many(mt_diags *diags, int n, mt_addr addr, const char *what);

#endif
