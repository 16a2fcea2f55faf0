/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ENVIRONMENT_VIBRATION_H
#define ENVIRONMENT_VIBRATION_H

#include "modetune/profile.h"

#include "environment/aircraft.h"
#include "environment/rotor.h"
#include "io/options.h"
#include "io/reader.h"

/*
 * A profile of vibration: the acceleration of a base. It has random parts, whose densities add
 * up, and tones, each a sine of a frequency anywhere within a range; both together are sine on
 * random. SI; levels are also kept in g, as files give them.
 */
#define MT_STANDARD_GRAVITY 9.80665 /* m/s^2 to 1 g */

/*
 * A one-sided power spectral density by its breakpoints: G(f) = G_i (f / f_i)^b between
 * breakpoints i and i + 1, a straight line in log-log scales of b 10 log10(2) dB per octave;
 * 0 below the first and above the last. Two breakpoints at one frequency are a step.
 */
typedef struct mt_psd {
    int n;         /* at least 2 */
    double *hz;    /* [n] above 0, ascending, at most two the same, the ends not */
    double *level; /* [n] above 0 [unit of the input^2/Hz] */
} mt_psd;

/* ln(b / a) of numbers above 0, exact to rounding next to 1. */
double mt_psd_log_ratio(double a, double b);
/* The exponent b of segment i, 0 <= i < n - 1; 0 of a step. */
double mt_psd_exponent(const mt_psd *psd, int i);
/* Slope of segment i [dB/octave]. */
double mt_psd_slope_db(const mt_psd *psd, int i);
/* G(f); the larger level at a step. */
double mt_psd_at(const mt_psd *psd, double hz);
/* Integral of (f / f_1)^(e - 1) df / f_1 from f_1 to f_2, l = ln(f_2 / f_1). */
double mt_psd_power_integral(double e, double l);
/* Integral of G df between two frequencies, in closed form [unit of the input^2]. */
double mt_psd_area(const mt_psd *psd, double from_hz, double to_hz);
/* Integral of G df over all frequencies [unit of the input^2]. */
double mt_psd_mean_square(const mt_psd *psd);

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
} mt_vibration_point;

typedef struct mt_vibration_random {
    int n_points;
    mt_vibration_point *points;
    bool in_g;            /* levels are in g^2/Hz, else in (m/s^2)^2/Hz */
    double published_rms; /* RMS of the random part that the source prints [m/s^2], NaN: none */
    mt_vibration_origin origin;
    mt_addr addr;
    mt_psd psd;      /* [(m/s^2)^2/Hz], made when it is read */
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
    /* made when it is read */
    int n_tones;
    mt_vibration_tone *tones;
    int n_marks;
    const char **marks; /* sentences about values that are assumed or not confirmed */
};

/**
 * Read and check a profile of vibration (format "modetune-profile/1") and the catalogue of
 * aircraft of its rotors: the one that it names, else aircraft.json in its folder, else the one
 * built into the program.
 * @param[out] out  mt_vibration_delete; NULL on failure
 * Fails and messages as for mt_study_load.
 */
mt_status mt_vibration_load(const char *path, const mt_io_options *opt, mt_vibration **out,
                            mt_diagnostics *messages, mt_err *err);
/* As mt_vibration_load, of a profile that another file names: it must lie within opt->root. */
mt_status mt_vibration_load_within(const char *path, const mt_io_options *opt,
                                   mt_vibration **out, mt_diagnostics *messages, mt_err *err);

/* The key tables of a profile, for the test that compares them with the JSON Schema; *n is
 * their number. */
const mt_key_table *const *mt_profile_key_tables(int *n);
/* The types that members of a profile share; *n is their number. */
const mt_schema_type *mt_profile_types(int *n);

/* Sum of the densities of all random parts at a frequency [(m/s^2)^2/Hz]. */
double mt_vibration_density(const mt_vibration *v, double hz);
/* The lowest and highest frequency of the random parts, the tones, or both [Hz]. */
void mt_vibration_range(const mt_vibration *v, bool random, bool tones, double hz[2]);

#endif
