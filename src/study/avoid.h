/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_AVOID_H
#define STUDY_AVOID_H

#include "environment/bands.h"
#include "io/members.h"

/* The bands that modes avoid, and how the search treats them. */
typedef struct mt_avoid {
    mt_bands_source source;
    /* number of modes on each side of a band that have constraints of their own, so that
     * neighbours which exchange their order are seen */
    int cluster;
    mt_bands bands; /* of the source; by finish */
} mt_avoid;

extern const mt_key_table mt_study_rotor_keys;
extern const mt_key_table mt_study_tail_keys;
extern const mt_key_table mt_study_machine_keys;
extern const mt_key_table mt_study_gear_keys;

struct mt_goal;
struct mt_study_check;
struct mt_study_reader;
/* Read the catalogue of aircraft: the one named, else, where a goal needs one, that in the
 * model's folder, else the one built into the program. Call it after the goals. */
void mt_read_study_aircraft(struct mt_study_reader *s, mt_addr value);
/* Look up rotors in the catalogue, check the numbers and make the bands. */
void mt_study_check_avoid(struct mt_study_check *c, struct mt_goal *goal);

#endif
