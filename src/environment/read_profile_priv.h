/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ENVIRONMENT_READ_PROFILE_PRIV_H
#define ENVIRONMENT_READ_PROFILE_PRIV_H

#include "environment/read_profile.h"

/* Shared by the files read_profile*.c. */
typedef struct mt_read_profile {
    mt_reader r;
    mt_vibration *v;
    mt_io_options files;
    mt_diagnostics *others; /* diagnostics of the catalogue of aircraft */
    mt_status failed;       /* reason of failing to read the catalogue */
    mt_err why;
} mt_read_profile;

#define MT_PROFILE_ENUM(id, ...) id,
#define MT_PROFILE_KEY(id, label, kind, must, row, ...) \
    {.name = (label),                                   \
     .type = MT_KEY_##kind,                             \
     .required = (must),                                \
     .possible = MT_POSSIBLE_##row,                     \
     .says = __VA_ARGS__},
#define MT_PROFILE_TABLE(id, object, KEYS, ...)               \
    static const mt_key id##_LIST[] = {KEYS(MT_PROFILE_KEY)}; \
    static const mt_key_table id##_TABLE = {                  \
        .what = (object), .keys = id##_LIST, .n = MT_COUNT(id##_LIST), __VA_ARGS__}

extern const mt_key_table mt_profile_rotor_keys;
extern const mt_key_table mt_profile_tail_keys;

/* A plain number; NaN where absent or wrong (noted). */
double mt_read_profile_number(mt_reader *r, mt_addr value);
/* [lower, upper]; false where absent, or wrong (noted). */
bool mt_read_profile_pair(mt_reader *r, mt_addr value, double *lower, double *upper);
/* The one of two members, neighbours in the table, that an object has; MT_ABSENT where both or
 * none (noted). */
int mt_read_profile_one_of(mt_reader *r, mt_addr object, const mt_key_table *table, int first);
/* Read a rotor. MT_NO_ADDR: one without members. */
void mt_read_profile_rotor(mt_reader *r, mt_addr value, mt_rotor *rotor);
/* Read the catalogue where a tone needs one or the profile names one. */
void mt_read_profile_aircraft(mt_read_profile *p, mt_addr value);

#endif
