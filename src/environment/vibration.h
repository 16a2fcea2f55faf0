/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ENVIRONMENT_VIBRATION_H
#define ENVIRONMENT_VIBRATION_H

#include "modetune/profile.h"

#include "environment/aircraft.h"
#include "environment/bands.h"
#include "environment/psd.h"

/*
 * A profile of vibration: the acceleration of a base. It has random parts, whose densities add
 * up, and tones, each a sine of a frequency anywhere within a range; both together are sine on
 * random. SI; levels are also kept in g, as files give them.
 */
#define MT_STANDARD_GRAVITY 9.80665 /* m/s^2 to 1 g */

/* The origin of a number; assumed numbers are marked wherever they are used. */
typedef struct mt_vibration_origin {
    mt_origin origin;
    const char *source; /* NULL: none given */
} mt_vibration_origin;

/* A breakpoint as given: with a level, or with the slope of the segment to its neighbour. */
typedef struct mt_vibration_point {
    double hz;
    double level;    /* NaN: from the slope */
    double slope_db; /* [dB/octave], NaN: not given */
    mt_addr addr;
    mt_addr hz_addr;
} mt_vibration_point;

typedef struct mt_vibration_random {
    int n_points;
    mt_vibration_point *points;
    bool in_g;            /* levels are in g^2/Hz, else in (m/s^2)^2/Hz */
    double published_rms; /* RMS of the random part that the source prints [m/s^2], NaN: none */
    mt_vibration_origin origin;
    mt_addr addr;
    mt_psd psd;      /* [(m/s^2)^2/Hz], by mt_vibration_finish */
    double *level_g; /* [psd.n] the same in g^2/Hz */
    double rms;      /* RMS of the input itself [m/s^2] */
} mt_vibration_random;

/* A tone as given. */
typedef struct mt_vibration_source {
    bool has_rotor; /* each of its harmonics is a tone; else lower_hz to upper_hz is one */
    mt_rotor rotor;
    double lower_hz;
    double upper_hz;
    double level; /* amplitude, in the unit given */
    bool in_g;
    mt_vibration_origin origin;
    mt_addr addr;
} mt_vibration_source;

typedef struct mt_vibration_tone {
    const char *label; /* "4P of UH-60", "17.2 Hz", "16.3 to 18.1 Hz" */
    double lower_hz;
    double upper_hz;
    double level;   /* amplitude [m/s^2] */
    double level_g; /* the same in g */
    int source;     /* index of its source */
} mt_vibration_tone;

/* The rule that combines peaks of tones: their sum, the largest, the root of the sum of
 * squares. */
typedef enum mt_vibration_sum {
    MT_TONES_SUM,
    MT_TONES_LARGEST,
    MT_TONES_ROOT
} mt_vibration_sum;
enum { MT_TONES_RULES = 3 };
/* "sum", "largest", "root_sum_square", in the order of mt_vibration_sum. */
extern const char *const mt_vibration_sum_names[MT_TONES_RULES];

struct mt_vibration {
    mt_arena mem;
    const char *path;
    const char *sha256;
    const char *name; /* NULL: none */
    const char *description;
    const char *source;
    int axis; /* 0, 1, 2: x, y, z; MT_ABSENT: any */
    /* name of the catalogue read: relative to the profile's folder, or the program's name of
     * its own; NULL: none */
    const char *aircraft_name;
    mt_aircraft_list aircraft;
    int n_random;
    mt_vibration_random *random;
    int n_sources;
    mt_vibration_source *sources;
    /* the combined peak: sigma RMS + the peaks of the tones by this rule */
    double sigma; /* default 3 */
    mt_vibration_sum rule;
    /* by mt_vibration_finish */
    int n_tones;
    mt_vibration_tone *tones;
    int n_marks;
    const char **marks; /* sentences about values that are assumed or not confirmed */
};

/* A profile with every member at its default. Fails: MT_E_MEMORY. */
mt_status mt_vibration_new(mt_vibration **out, mt_err *err);

/* Check all numbers and note every problem, look up aircraft, resolve slopes into levels, make
 * tones and marks. Parts with errors are left empty; a shortage is remembered by the arena. */
void mt_vibration_finish(mt_vibration *v, mt_diags *diags);

/* Sum of the densities of all random parts at a frequency [(m/s^2)^2/Hz]. */
double mt_vibration_density(const mt_vibration *v, double hz);
/* The lowest and highest frequency of the random parts, the tones, or both [Hz]. */
void mt_vibration_range(const mt_vibration *v, bool random, bool tones, double hz[2]);

#endif
