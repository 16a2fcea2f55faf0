/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_RESPONSE_LIMIT_H
#define STUDY_RESPONSE_LIMIT_H

#include "environment/vibration.h"
#include "io/members.h"

/* The quantity of a forced vibration that a goal limits. */
typedef enum mt_response_limit_quantity {
    MT_RESPONSE_LIMIT_RESPONSE, /* |H|, its maximum over a band */
    MT_RESPONSE_LIMIT_RMS,      /* under a profile: RMS of its random parts, */
    MT_RESPONSE_LIMIT_SINE,     /* amplitude of its tones, */
    MT_RESPONSE_LIMIT_PEAK,     /* combined peak of both */
    MT_RESPONSE_LIMIT_QUANTITIES
} mt_response_limit_quantity;
/* "response", "rms", "sine", "peak". */
extern const char *const mt_response_limit_names[MT_RESPONSE_LIMIT_QUANTITIES];

/* Input, output, band and quantity of a forced vibration that a goal limits. */
typedef struct mt_response_limit {
    mt_name input; /* ports (response/ports.h); of a profile by finish, where not given */
    mt_name output;
    double lower_hz; /* its band; equal: one frequency; NaN: all that was measured */
    double upper_hz;
    mt_name profile_name;        /* as written; s NULL: none */
    const mt_vibration *profile; /* of the study's; NULL: none, or it could not be read */
    mt_response_limit_quantity quantity;
    const char *unit; /* of the numbers, from the names of the ports; "": not known */
    /* frequency_response: the measurement to compare with; s NULL: none */
    mt_name measurement_name;
    int measurement; /* of the study's; by finish */
    bool coherence;  /* lines are weighted by their coherence */
} mt_response_limit;

/* What of a unit load a static goal limits. */
typedef enum mt_static_quantity {
    MT_STATIC_COMPLIANCE,
    MT_STATIC_STIFFNESS
} mt_static_quantity;

/* What a goal limits of a mechanism at rest: a displacement or a force at the equilibrium, or
 * what a small unit load changes there. */
typedef struct mt_static_limit {
    mt_name output; /* response/ports.h: mt_port_at_rest */
    mt_name input;  /* s NULL: none, the equilibrium as it is */
    mt_static_quantity quantity;
    mt_name against_name; /* s NULL: none */
    int against;          /* configuration whose value is subtracted; MT_ABSENT: none */
    const char *unit;     /* of its number; "": not known */
} mt_static_limit;

/* A profile of vibration that goals name. */
typedef struct mt_study_profile {
    mt_name name;
    mt_vibration *profile; /* NULL: it could not be read, which has been noted */
} mt_study_profile;

/* A response that the result shows of every design. */
typedef struct mt_study_response {
    mt_name configuration_name;
    int configuration;
    mt_response_limit response_limit; /* ports and frequencies; a profile, where there is one */
    const char *description;
    const char *source;
    mt_addr addr;
} mt_study_response;

extern const mt_key_table mt_study_response_keys;

struct mt_goal;
struct mt_study_check;
/* Check frequencies, profile, measurement or other configuration of a goal about ports, and
 * find its unit. */
void mt_study_check_response_limit(struct mt_study_check *c, struct mt_goal *goal);
void mt_study_check_responses(struct mt_study_check *c);

#endif
