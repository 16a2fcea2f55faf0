/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESULT_CURVES_H
#define RESULT_CURVES_H

#include "result/record.h"

/* Frequency responses of a result (result.h): which are shown, and what they are at a design.
 * NaN: not applicable. */

/* Digits that files keep of a curve: frequencies next to a narrow peak differ late; what is
 * drawn needs no more than that. */
enum { MT_CURVE_HZ_DIGITS = 8, MT_CURVE_DIGITS = 6 };

/* |H| and its phase at as many frequencies as a picture needs, where it is finite and not 0; in
 * between both are straight over log frequency, the magnitude in its logarithm. */
typedef struct mt_curve_points {
    int n_hz; /* the same number of each; files may say otherwise */
    double *hz;
    int n_magnitude;
    double *magnitude;
    int n_phase;
    double *phase_deg;
    int n_psd;   /* of the output under the curve's profile; none without */
    double *psd; /* [output_unit^2/Hz] NaN: the profile has nothing there */
} mt_curve_points;

/* What a goal asks of a response between two frequencies, which may be equal. */
typedef struct mt_result_limit {
    const char *pointer; /* "/goals/0" */
    double lower_hz;
    double upper_hz;
    double target; /* NaN: not asked for; likewise */
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

/* What the ground accelerates like. */
typedef struct mt_result_profile {
    const char *file; /* as the study names it */
    const char *name; /* NULL: it has none */
    double rms;       /* [m/s^2] of its random parts */
    double sigma;     /* a peak is sigma rms and the tones, */
    const char *rule; /* "sum" | "largest" | "root_sum_square" of them */
    int n_densities;  /* which add up */
    mt_result_density *densities;
    int n_tones;
    mt_result_tone *tones;
} mt_result_profile;

/* A response that is shown of every design. */
typedef struct mt_result_curve {
    const char *pointer; /* of what asks for it, "/responses/0" */
    const char *configuration;
    const char *input; /* ports, in full */
    const char *output;
    const char *unit; /* of its magnitude: "m/s^2 per m/s^2" */
    const char *output_unit;
    double lower_hz;
    double upper_hz;
    const char *description; /* may be NULL */
    const char *source;      /* may be NULL */
    int n_limits;            /* of goals about the same ports */
    mt_result_limit *limits;
    mt_result_profile *profile; /* NULL: none */
    mt_curve_points measured;   /* that a goal compares it with; none: no points */
} mt_result_curve;

/* A maximum or minimum of |H| over frequency. */
typedef struct mt_result_extreme {
    const char *kind; /* "peak" | "resonance" (infinite) | "antiresonance" | "minimum" */
    double hz;
    double magnitude;     /* NaN: infinite */
    double phase_deg;     /* of it, (-180, 180]; NaN: it has none */
    double natural_hz;    /* of a peak: size and damping ratio of the pole s nearest to i w, */
    double damping_ratio; /* |s|/(2 pi) and -Re s/|s|; NaN of others */
} mt_result_extreme;

/* The response to a tone of a profile. */
typedef struct mt_result_forced_response_tone {
    const char *label;
    double hz;   /* of its range, where the response is the largest; NaN: it has no number */
    double peak; /* amplitude [output_unit] */
    double excess_at_most; /* part of the peak, proven; NaN: not proven */
    bool at_edge;          /* of the range */
} mt_result_forced_response_tone;

/* What a curve's profile does at one design, all of the profile, whatever is shown. */
typedef struct mt_result_forced_response {
    const char *end; /* "finite" | "infinite" | "unstable": numbers are NaN where not finite */
    bool proven;     /* false: by quadrature, errors are estimates */
    double rms;      /* of the random parts [output_unit] */
    double rms_error_at_most;
    double sine; /* of the tones by the profile's rule */
    double peak; /* sigma rms + sine */
    int n_tones;
    mt_result_forced_response_tone *tones;
} mt_result_forced_response;

/* A response of result.curves at one design. */
typedef struct mt_design_curve {
    const char *pointer; /* pointer and configuration as there */
    const char *configuration;
    const char *trouble; /* why there is no curve; NULL: there is */
    mt_curve_points drawn;
    int n_extremes;
    mt_result_extreme *extremes;          /* by ascending frequency, all of the band */
    mt_result_forced_response *vibration; /* NULL: no profile, or no curve (trouble says) */
} mt_design_curve;

extern const mt_record mt_curve_record;        /* mt_result_curve */
extern const mt_record mt_design_curve_record; /* mt_design_curve */

#endif
