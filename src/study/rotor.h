/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_ROTOR_H
#define STUDY_ROTOR_H

#include "study/aircraft.h"
#include "study/bands.h"

/* What is checked of a rotor (study/bands.h) wherever a file has one, and what it takes from a
 * catalogue. */

/* A value that nobody has read in a document. */
typedef struct mt_rotor_warning {
    const char *what; /* "rotor speed", "tail rotor's number of blades" */
    const mt_aircraft_value *value;
} mt_rotor_warning;
enum { MT_ROTOR_WARNINGS = 4 };

/* Speeds and blades of the aircraft. */
void mt_rotor_take(mt_rotor *rotor, const mt_aircraft *aircraft);
/* Those of them that the harmonics use and that are not confirmed, in out; returns how many. */
int mt_rotor_warnings(const mt_rotor *rotor, const mt_aircraft *aircraft,
                      mt_rotor_warning out[MT_ROTOR_WARNINGS]);
/* Harmonics given twice, or of what is not known; aircraft NULL: the rotor is as given. */
void mt_rotor_check_harmonics(const mt_rotor *rotor, const mt_aircraft *aircraft,
                              mt_diags *diags);
/* A rotor turns at 0.9 to 1.1 of its nominal speed, between idle and overspeed at 0.5 to 1.3;
 * [95, 105] is per cent. */
#define MT_ROTOR_LEAST_SPEED 0.5
/* An engine idles at a tenth of its nominal speed. */
#define MT_MACHINE_LEAST_SPEED 0.05
/* What is hardly meant of factors of the speed of a rotor or a machine ("rotor's"), which is
 * plausible from `least` on; in mem. NULL: nothing. */
const char *mt_rotor_warning_range(double lower, double upper, double least, const char *whose,
                                   mt_arena *mem);
/* The range of speeds is ascending. */
void mt_rotor_check_range(const mt_rotor *rotor, mt_diags *diags);

/* More than a thousand of something are refused: each is compared with all others. what:
 * "harmonics". */
bool mt_rotor_too_many(mt_diags *diags, int n, mt_addr addr, const char *what);

#endif
