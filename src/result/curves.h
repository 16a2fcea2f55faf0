/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESULT_CURVES_H
#define RESULT_CURVES_H

#include "result/record.h"

/* Frequency responses of a result (result.h): the list of those shown, and their values at a
 * design. NaN: not applicable. */

/* Significant digits of curves in files: frequencies next to a narrow peak differ in late
 * digits; drawings need no more of the values. */
enum { MT_CURVE_HZ_DIGITS = 8, MT_CURVE_DIGITS = 6 };

/* |H| and its phase at as many frequencies as a drawing needs, where |H| is finite and not 0.
 * Between them log |H| and the phase are linear in log frequency. */
typedef struct mt_curve_points {
    int n_hz; /* the three counts are equal; files may differ */
    double *hz;
    int n_magnitude;
    double *magnitude;
    int n_phase;
    double *phase_deg;
    int n_psd;   /* density of the output under the curve's profile; 0: no profile */
    double *psd; /* [output_unit^2/Hz] NaN: outside the profile */
} mt_curve_points;

/* The limits of a goal on a response between two frequencies, which may be equal. */
typedef struct mt_result_limit {
    const char *pointer; /* "/goals/0" */
    double lower_hz;
    double upper_hz;
    double target; /* NaN: no such limit; the same for at_least and at_most */
    double at_least;
    double at_most;
} mt_result_limit;

/* One-sided density of an acceleration: straight in log-log scales between breakpoints. */
typedef struct mt_result_density {
    int n_hz; /* as in mt_curve_points */
    double *hz;
    int n_level;
    double *level; /* [(m/s^2)^2/Hz] */
} mt_result_density;

typedef struct mt_result_tone {
    const char *label;
    double lower_hz;
    double upper_hz;
    double level; /* amplitude [m/s^2] */
} mt_result_tone;

/* The acceleration of the ground. */
typedef struct mt_result_profile {
    const char *file; /* file name in the study */
    const char *name; /* NULL: it has none */
    double rms;       /* [m/s^2] of its random parts */
    double sigma;     /* the peak is sigma rms plus the tones combined */
    const char *rule; /* by "sum" | "largest" | "root_sum_square" */
    int n_densities;  /* densities add up */
    mt_result_density *densities;
    int n_tones;
    mt_result_tone *tones;
} mt_result_profile;

/* A response shown for every design. */
typedef struct mt_result_curve {
    const char *pointer; /* of the goal or response that requests it, "/responses/0" */
    const char *configuration;
    const char *input; /* ports, in full */
    const char *output;
    const char *unit; /* of its magnitude: "m/s^2 per m/s^2" */
    const char *output_unit;
    double lower_hz;
    double upper_hz;
    const char *description; /* may be NULL */
    const char *source;      /* may be NULL */
    int n_limits;            /* limits by goals on the same ports */
    mt_result_limit *limits;
    mt_result_profile *profile; /* NULL: none */
    /* the measurement that a goal compares it with; no points: none */
    mt_curve_points measured;
} mt_result_curve;

/* A maximum or minimum of |H| over frequency. */
typedef struct mt_result_extreme {
    const char *kind; /* "peak" | "resonance" (infinite) | "antiresonance" | "minimum" */
    double hz;
    double magnitude;     /* NaN: infinite */
    double phase_deg;     /* phase of H, (-180, 180]; NaN: none */
    double natural_hz;    /* of a peak: frequency |s|/(2 pi) and damping ratio -Re s/|s| */
    double damping_ratio; /* of the pole s nearest to i w; NaN for other kinds */
} mt_result_extreme;

/* The response to a tone of a profile. */
typedef struct mt_result_forced_response_tone {
    const char *label;
    double hz;   /* frequency of its range with the largest response; NaN: no finite value */
    double peak; /* amplitude [output_unit] */
    double excess_at_most; /* proven bound of (maximum - peak)/peak; NaN: not proven */
    bool at_edge;          /* the peak lies at an end of the range */
} mt_result_forced_response_tone;

/* The vibration under the whole profile of a curve at one design, also outside the frequencies
 * shown. */
typedef struct mt_result_forced_response {
    const char *end; /* "finite" | "infinite" | "unstable": numbers are NaN where not finite */
    bool proven;     /* false: by quadrature, errors are estimated */
    double rms;      /* of the random parts [output_unit] */
    double rms_error_at_most;
    double sine; /* amplitude of the tones by the profile's rule */
    double peak; /* sigma rms + sine */
    int n_tones;
    mt_result_forced_response_tone *tones;
} mt_result_forced_response;

/* A response of result.curves at one design. */
typedef struct mt_design_curve {
    const char *pointer; /* pointer and configuration of the result's curve */
    const char *configuration;
    const char *trouble; /* reason for a missing curve; NULL: there is a curve */
    mt_curve_points drawn;
    int n_extremes;
    mt_result_extreme *extremes;          /* by ascending frequency, all within the band */
    mt_result_forced_response *vibration; /* NULL: no profile, or no curve (see `trouble`) */
} mt_design_curve;

extern const mt_record mt_curve_record;        /* mt_result_curve */
extern const mt_record mt_design_curve_record; /* mt_design_curve */

#endif
