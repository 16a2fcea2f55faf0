/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_SHAKE_H
#define STUDY_SHAKE_H

#include "study/vibration.h"

/* What of a forced vibration a goal limits. */
typedef enum mt_shake_quantity {
    MT_SHAKE_RESPONSE, /* |H|, the largest of it over a band */
    MT_SHAKE_RMS,      /* under a profile: of its random parts, */
    MT_SHAKE_SINE,     /* of its tones, */
    MT_SHAKE_PEAK,     /* of both */
    MT_SHAKE_QUANTITIES
} mt_shake_quantity;
/* "response", "rms", "sine", "peak". */
extern const char *const mt_shake_names[MT_SHAKE_QUANTITIES];

/* From where to where a mechanism shakes, and how large that may be. */
typedef struct mt_shake {
    mt_name input; /* ports (response/ports.h); of a profile by finish, where not given */
    mt_name output;
    double lower_hz; /* its band; both equal: at one frequency; NaN: all that was measured */
    double upper_hz;
    mt_name profile_name;        /* as written; s NULL: none */
    const mt_vibration *profile; /* of the study's; NULL: none, or it could not be read */
    mt_shake_quantity quantity;
    const char *unit;         /* of the numbers, from the names of the ports; "": not known */
    mt_name measurement_name; /* frequency_response: what it is compared with; s NULL: none */
    int measurement;          /* of the study's; by finish */
    bool coherence;           /* its lines weigh by it */
    mt_addr band_addr;        /* the addresses of what was not given equal the goal's */
    mt_addr at_addr;
    mt_addr quantity_addr;
} mt_shake;

/* A profile of vibration that goals name. */
typedef struct mt_study_profile {
    mt_name name;
    mt_vibration *profile; /* NULL: it could not be read, which has been noted */
} mt_study_profile;

#endif
