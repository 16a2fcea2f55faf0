/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ENVIRONMENT_AIRCRAFT_H
#define ENVIRONMENT_AIRCRAFT_H

#include "base/document.h"

/* A catalogue of rotors: plain records, read by io. Each value names its source and says
 * whether the value was confirmed there. */
typedef struct mt_aircraft_value {
    double value;     /* Hz, or the number of blades */
    const char *text; /* "258 rpm", "4": as the catalogue gives it */
    bool confirmed;   /* confirmed in a public document: its source */
    const char *source;
} mt_aircraft_value;

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
/* The nearest name of the catalogue, for "did you mean"; NULL: none is near. Scratch in mem. */
const char *mt_aircraft_nearest(const mt_aircraft_list *list, const char *name, mt_arena *mem);

#endif
