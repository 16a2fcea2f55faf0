/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_SHAKE_H
#define STUDY_SHAKE_H

#include "model/model.h"

/* From where to where a mechanism shakes, and what that is compared with. */
typedef struct mt_shake {
    mt_name input; /* ports (response/ports.h) */
    mt_name output;
    double lower_hz; /* band; NaN: not given */
    double upper_hz;
    mt_addr band_addr;        /* the addresses of what was not given equal the goal's */
    mt_name measurement_name; /* frequency_response: what its residuals are against */
    int measurement;          /* of the study's; by finish */
    bool coherence;           /* lines weigh by it */
} mt_shake;

#endif
