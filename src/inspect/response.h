/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef INSPECT_RESPONSE_H
#define INSPECT_RESPONSE_H

#include <complex.h>

#include "analysis/lowest.h"
#include "environment/vibration.h"
#include "inspect/loaded_model.h"
#include "io/write_json.h"
#include "response/response.h"
#include "vibration/profile_response.h"

/* A profile of vibration, and what it does to a response: of `profile`, too. */

const char *mt_vibrated_axis(const mt_vibration *v); /* "z"; NULL: any */
const char *mt_vibrated_name(const mt_vibration *v); /* its name, or its path */

/* The vibration of a response under a profile, for tables and JSON. Quantities other
 * than accelerations have no values in g. */
typedef struct mt_vibrated {
    const mt_vibration *profile;
    const mt_vibration_response *response;
    bool is_acceleration; /* [m/s^2], else in `unit` */
    const char *unit;     /* "m", "N" */
} mt_vibrated;

/* One tone of it. */
typedef struct mt_vibrated_tone {
    const char *tone;
    mt_forced_end end;
    double frequency_hz;
    double peak;
    double excess_at_most;
    bool at_edge;
} mt_vibrated_tone;

/* Its members as a record has them. */
typedef struct mt_vibrated_values {
    mt_forced_end end;
    const char *unit;
    double rms;
    double rms_error_at_most;
    double sine;
    double peak;
    bool in_g;
    double rms_g;
    double sine_g;
    double peak_g;
    mt_vibrated_tone *tones;
    int n_tones;
} mt_vibrated_values;
extern const mt_record mt_vibrated_tone_record;
mt_status mt_vibrated_values_of(const mt_vibrated *v, mt_arena *mem, mt_vibrated_values *out,
                                mt_err *err);

/* The members of a record THIS with an mt_vibrated_values m. */
/* NOLINTBEGIN(bugprone-macro-parentheses): members of a struct */
#define MT_VIBRATED_FIELDS(m)                                                                \
    MT_F_ENUM("end", m.end, mt_forced_end, mt_forced_end_names,                              \
              "Why there is no finite number: an undamped mode within the profile, or an "   \
              "unstable one; \"finite\": there is one."),                                    \
        MT_F_TEXT("unit", m.unit, "Unit of rms, sine and peak."),                            \
        MT_F_NUMBER_OR_NULL("rms", m.rms,                                                    \
                            "RMS under the random parts, in the unit that `unit` names."),   \
        MT_F_NUMBER_OR_NULL("rms_error_at_most", m.rms_error_at_most,                        \
                            "Bound of its error, in the same unit."),                        \
        MT_F_NUMBER_OR_NULL("sine", m.sine, "Peak under the tones, in the same unit."),      \
        MT_F_NUMBER_OR_NULL("peak", m.peak,                                                  \
                            "Peak by the rule that combines both, in the same unit."),       \
        MT_F_NUMBER_OR_NULL("rms_g", m.rms_g, "rms of an acceleration.", MT_F_WHEN(m.in_g)), \
        MT_F_NUMBER_OR_NULL("sine_g", m.sine_g, "sine of an acceleration.",                  \
                            MT_F_WHEN(m.in_g)),                                              \
        MT_F_NUMBER_OR_NULL("peak_g", m.peak_g, "peak of an acceleration.",                  \
                            MT_F_WHEN(m.in_g)),                                              \
        MT_F_LIST("tones", m.tones, m.n_tones, mt_vibrated_tone, mt_vibrated_tone_record,    \
                  "The tones, each where it shakes most.", .flat = true)

/* The rule and the marks of a profile. */
typedef struct mt_combine_row {
    double sigma;
    mt_vibration_sum tones;
} mt_combine_row;
typedef struct mt_rule_row {
    mt_combine_row combine;
    const char **marks;
    int n_marks;
} mt_rule_row;
extern const mt_record mt_combine_record;
mt_rule_row mt_rule_row_of(const mt_vibration *v);

/* The members of a record THIS with an mt_rule_row m. */
#define MT_RULE_FIELDS(m)                                                \
    MT_F_RECORD("combine", m.combine, mt_combine_row, mt_combine_record, \
                "How the peak follows from the parts."),                 \
        MT_F_TEXTS("marks", m.marks, m.n_marks,                          \
                   "What is assumed or unconfirmed in the profile.")
/* NOLINTEND(bugprone-macro-parentheses) */

/* In g, where it is an acceleration; else NaN. */
double mt_vibrated_in_g(const mt_vibrated *v, double value);
const char *mt_vibrated_unit(const mt_vibrated *v);

/* How forces, a moving ground and a profile of vibration shake one configuration: what
 * `response` tells, as records. */

/* State space: the mechanism between the ports as x' = A x + B u, y = C x + D u. */

/* A row of a matrix. */
typedef struct mt_matrix_row {
    double *value;
    int n;
    int step; /* from one to the next */
} mt_matrix_row;

typedef struct mt_state_space_row {
    int modes;
    int residual_shapes;
    const char **states;
    int n_states;
    mt_port *inputs;
    int n_inputs;
    mt_port *outputs;
    int n_outputs;
    mt_matrix_row *a; /* [n_states] */
    mt_matrix_row *b;
    mt_matrix_row *c; /* [n_outputs] */
    mt_matrix_row *d;
    bool viscous_for_loss_factors;
    double from_hz; /* where it was compared */
    double to_hz;
    int compared;
    double largest_difference_percent; /* NaN: nowhere compared */
} mt_state_space_row;

extern const mt_record mt_state_space_record;

typedef struct mt_response_question {
    int n_inputs;
    const char *const *inputs; /* [n_inputs] what shakes; none: a profile */
    int n_outputs;
    const char *const *outputs; /* [n_outputs] what is seen; none: all sensors */
    const char *from; /* [Hz] or an expression; NULL: chosen by the modes, or the profile */
    const char *to;
    int points; /* of the grid; 0: 50 */
    bool log;
    int keep; /* the lowest modes that are taken; 0: all */
    bool direct;
    bool poles;
    bool state_space;
    const char *parameters;      /* "A,B", whose influence is told; NULL: of none */
    const mt_vibration *profile; /* NULL: none */
} mt_response_question;

/* Fails where nothing shakes: MT_E_USAGE. */
mt_status mt_response_question_admit(const mt_response_question *q, mt_err *err);

/* The response of one configuration. */
typedef struct mt_response_view {
    const mt_response_question *question;
    const char *configuration;
    mt_loaded_model *s;
    int c;
    mt_analysis *a; /* NULL: of the lowest modes */
    mt_lowest *l;   /* NULL: of all of them */
    const mt_modes *modes;
    mt_response_request request;
    mt_response response;
    mt_curve_options opt; /* options of the tracing */
    mt_curve curve;
    const mt_pole_sum *sums; /* [pairs] of poles; NULL: not requested, or not available */
    const char *no_sums;     /* reason for no sums; NULL */
    mt_profiled profiled;    /* with a profile */
    int n;                   /* parameters */
    const int *parameter;    /* [n] */
    const double *value;     /* [n] */
    /* n_extremes x n: change of |H| in per cent, for one per cent more */
    const double *percent;
    mt_state_space_row space; /* where it is asked for */
} mt_response_view;

/* Answer for configuration c. v zeroed before; mt_response_view_free in any case; s and the
 * question must outlive v. Fails: MT_E_USAGE (a name, a number, a range, too many bodies),
 * MT_E_EQUILIBRIUM (a mode is unstable, undecided or negatively damped), as an analysis of the
 * configuration. */
mt_status mt_response_view_take(mt_loaded_model *s, int c, const mt_response_question *question,
                                mt_response_view *v, mt_err *err);
void mt_response_view_free(mt_response_view *v);
/* Write all of it as JSON. Fails: MT_E_MEMORY. */
mt_status mt_response_put(mt_response_view *v, mt_json_writer *w, mt_err *err);

/* What one parameter does to an extreme. */
typedef struct mt_magnitude_slope_row {
    const char *parameter;
    double value;
    double per_percent;
} mt_magnitude_slope_row;

/* A peak, a resonance or an antiresonance. */
typedef struct mt_extreme_row {
    const char *input;
    const char *output;
    const char *kind;
    double hz;
    double magnitude;
    const char *unit;
    double phase_deg;
    bool with_slopes;
    mt_magnitude_slope_row *slopes;
    int n_slopes;
} mt_extreme_row;

extern const mt_record mt_extreme_record;
enum { MT_RESPONSE_UNIT = 160 };
/* Without what parameters do to it. */
mt_extreme_row mt_extreme_row_of(const mt_response_view *v, int e, char unit[MT_RESPONSE_UNIT]);

/* Coefficients and poles. */
typedef struct mt_complex_row {
    double re;
    double im;
} mt_complex_row;

typedef struct mt_pole_row {
    mt_complex_row pole;
    mt_complex_row residue;
} mt_pole_row;

/* What the profile does to the output of a response. */
typedef struct mt_vibration_row {
    mt_vibrated_values vibrated;
    bool with_mode;
    int by_mode;
} mt_vibration_row;

/* The response of one output to one input. */
typedef struct mt_response_row {
    const char *input;
    const char *output;
    const char *unit;
    mt_extreme_row *extremes;
    int n_extremes;
    bool with_poles;
    mt_pole_row *poles;
    int n_poles;
    bool with_no_poles;
    const char *no_poles;
    bool with_polynomial;
    mt_complex_row *polynomial;
    int n_polynomial;
    double *re;
    double *im;
    double *error;
    double *psd;
    int n;
    bool with_vibration;
    mt_vibration_row vibration;
    const char *psd_unit;
} mt_response_row;

typedef struct mt_shaking_row {
    const char *file;
    const char *name;
    const char *axis;
    double rms_m_per_s2;
    mt_rule_row rule;
} mt_shaking_row;

/* One configuration, answered. */
typedef struct mt_answered_response_row {
    const char *configuration;
    const char *method;
    int modes;
    int modes_left_out;
    bool with_shapes;
    int shapes_of_others;
    bool coupled;
    bool complete;
    bool with_profile;
    mt_shaking_row profile;
    const char *vibration_method;
    mt_port *inputs;
    int n_inputs;
    mt_port *outputs;
    int n_outputs;
    double *frequencies_hz;
    int n_frequencies;
    mt_response_row *responses;
    int n_responses;
    bool with_space;
    mt_state_space_row space;
} mt_answered_response_row;

extern const mt_record mt_answered_response_record;

/* A pair is an output of an input: all outputs of the first input, then of the next. */
int mt_response_view_pairs(const mt_response_view *v);
const mt_port *mt_response_view_input(const mt_response_view *v, int pair);
const mt_port *mt_response_view_output(const mt_response_view *v, int pair);
double complex mt_response_view_value(const mt_response_view *v, int pair, int point);
double mt_response_view_error(const mt_response_view *v, int pair, int point);
/* Unit of the response, and of a density with a profile. */
void mt_response_view_unit(const mt_response_view *v, int pair, char unit[MT_RESPONSE_UNIT]);
void mt_response_view_density_unit(const mt_response_view *v, int pair,
                                   char unit[MT_RESPONSE_UNIT]);
/* The density at a frequency, or NaN where it is infinite. */
double mt_response_view_density(const mt_response_view *v, int pair, int point);
/* What the profile does to the output. */
mt_vibrated mt_response_view_vibrated(const mt_response_view *v, int pair);
/* The vibration mode whose pole this is: the one with the nearest frequency; 0: none. */
int mt_response_view_mode(const mt_response_view *v, double complex pole);
const char *mt_response_view_parameter(const mt_response_view *v, int k);
/* NaN where there is no value. */
double mt_response_magnitude(double complex h);

#endif
