/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_POSSIBLE_H
#define MODEL_POSSIBLE_H

#include <stdbool.h>

/*
 * What the number of a member can be. The readers' tables of members name a row for each member
 * that holds numbers; what stands outside least .. most is impossible (an error at its place),
 * outside low .. high implausible (a warning, by its name). What a number can be beside others
 * is judged by the function that the row names.
 */
typedef enum mt_possible_id {
    MT_POSSIBLE_NONE, /* no number */
    MT_POSSIBLE_ANY,  /* every finite number */
    MT_POSSIBLE_NOT_NEGATIVE,
    MT_POSSIBLE_POSITIVE,
    MT_POSSIBLE_NONZERO,
    MT_POSSIBLE_PART, /* of a whole: 0 to 1 */
    MT_POSSIBLE_MODULUS,
    MT_POSSIBLE_DENSITY,
    MT_POSSIBLE_THICKNESS,
    MT_POSSIBLE_POISSON,
    MT_POSSIBLE_LOSS,
    MT_POSSIBLE_RATIO,
    MT_POSSIBLE_ANGLE,   /* of a drive */
    MT_POSSIBLE_STROKE,  /* of a drive */
    MT_POSSIBLE_INNER,   /* diameter of a tube */
    MT_POSSIBLE_INERTIA, /* moments, tensors */
    MT_POSSIBLE_MATRIX,  /* of a bushing */
    MT_POSSIBLE_POINT,   /* coordinates of what a joint or spring holds */
    MT_POSSIBLE_AXIS,
    MT_POSSIBLE_GRAVITY,
    MT_POSSIBLE_WHOLE,   /* a whole number: its limits are those of mt_reader_count */
    MT_POSSIBLE_STUDY,   /* of a study, beside its model and other members */
    MT_POSSIBLE_PROFILE, /* of a profile of vibration or a catalogue of aircraft */
    MT_POSSIBLE_COUNT
} mt_possible_id;

typedef struct mt_possible {
    double least;
    double most;
    double low;
    double high;
    const char *impossible; /* "must not be negative"; NULL: nothing is by itself */
    const char *warning;    /* its name; NULL: nothing is implausible by itself */
    const char *below;      /* "below 10 kg/m^3, ..." */
    const char *beyond;
    const char *with; /* the function that judges it beside others; NULL: none */
    bool above;       /* `least` itself is impossible */
    bool at_high;     /* `high` itself is implausible */
} mt_possible;

extern const mt_possible mt_possible_of[MT_POSSIBLE_COUNT];

#endif
