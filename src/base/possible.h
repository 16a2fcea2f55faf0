/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_POSSIBLE_H
#define BASE_POSSIBLE_H

#include <stdbool.h>

/* Greatest position of a drive from the reference position: rad (159 turns), or lengths of the
 * mechanism. It is approached in steps of at most a tenth. */
enum { MT_DRIVE_REACH = 1000 };

/*
 * Ranges of the numbers of members. The readers' tables name a row for each member with
 * numbers; a value outside least .. most is impossible (an error at its location), outside low
 * .. high implausible (a warning, by its name). The function named in `with` checks the number
 * against others.
 */
typedef enum mt_possible_id {
    MT_POSSIBLE_NONE, /* not a number */
    MT_POSSIBLE_ANY,  /* every finite number */
    MT_POSSIBLE_NOT_NEGATIVE,
    MT_POSSIBLE_POSITIVE,
    MT_POSSIBLE_NONZERO,
    MT_POSSIBLE_PART, /* fraction of a whole: 0 to 1 */
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
    MT_POSSIBLE_WHOLE,        /* a whole number: its limits are those of mt_reader_count */
    MT_POSSIBLE_SHARE,        /* a required MAC or damping ratio: above 0, at most 1 */
    MT_POSSIBLE_ENERGY_SHARE, /* a share of a mode's energy [%] */
    MT_POSSIBLE_PROOF,        /* seconds of a proof */
    MT_POSSIBLE_WEIGHT_SENSITIVITY, /* factor of weights */
    MT_POSSIBLE_MET,                /* percent within which a goal is met */
    MT_POSSIBLE_TOLERANCE,          /* percent of manufacturing */
    MT_POSSIBLE_MARGIN,             /* percent around a band */
    MT_POSSIBLE_ASKED,              /* a frequency required by a goal [Hz] */
    MT_POSSIBLE_MEASURED,           /* a measured frequency [Hz] */
    MT_POSSIBLE_BAND,               /* ends of bands to avoid, or of a measurement [Hz] */
    MT_POSSIBLE_RANGE,              /* ends of a range of a response [Hz] */
    MT_POSSIBLE_LIMIT,              /* of an expression, in its unit */
    MT_POSSIBLE_BOUND,              /* of a variable, in its unit */
    MT_POSSIBLE_VALUES,             /* of a catalogue, in the unit of its variable */
    MT_POSSIBLE_RULE,               /* bounds of a catalogue's rule */
    MT_POSSIBLE_VARIED,             /* values of a trade study */
    MT_POSSIBLE_SPEED,              /* of a rotor [1/s] */
    MT_POSSIBLE_RPM,                /* of a rotor [1/min] */
    MT_POSSIBLE_MACHINE,            /* speeds of a machine [1/s] */
    MT_POSSIBLE_FACTORS,            /* of a nominal speed */
    MT_POSSIBLE_HZ,                 /* a frequency of a profile of vibration */
    MT_POSSIBLE_PSD_G,              /* [g^2/Hz] */
    MT_POSSIBLE_PSD,                /* [m^2/s^3] */
    MT_POSSIBLE_LEVEL_G,            /* [g] */
    MT_POSSIBLE_LEVEL,              /* [m/s^2] */
    MT_POSSIBLE_SLOPE,              /* [dB/octave] */
    MT_POSSIBLE_SIGMA,
    MT_POSSIBLE_COUNT
} mt_possible_id;

typedef struct mt_possible {
    double least;
    double most;
    double low;
    double high;
    const char *impossible; /* "must not be negative"; NULL: no impossible values */
    const char *warning;    /* its name; NULL: no implausible values */
    const char *below;      /* "below 10 kg/m^3, ..." */
    const char *beyond;
    const char *with; /* the function that checks it against others; NULL: none */
    bool above;       /* `least` itself is impossible */
    bool under;       /* `most` itself is impossible */
    bool at_high;     /* `high` itself is implausible */
} mt_possible;

extern const mt_possible mt_possible_of[MT_POSSIBLE_COUNT];

/* True where a value is possible by itself; true for NaN, which is unknown. */
bool mt_possible_is(const mt_possible *p, double value);
/* Reason why a possible value is implausible: `below` or `beyond`; NULL: plausible. */
const char *mt_possible_doubted(const mt_possible *p, double value);

#endif
