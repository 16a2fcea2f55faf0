/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune response: how forces and a moving ground shake a mechanism. */
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "cli/cli.h"
#include "cli/shipped.h"
#include "cli/vibrated.h"
#include "report/table.h"
#include "response/response.h"
#include "vibration/profile_response.h"

/* The response of one configuration with all that its output needs. */
typedef struct response_view {
    const char *configuration;
    const mt_loaded_model *s;
    const mt_response *r;
    const mt_curve *curve;
    mt_curve_options opt; /* options of the tracing */
    bool direct;
    const mt_pole_sum *sums;     /* [pairs] of --poles; NULL: not requested, or not available */
    const char *no_sums;         /* reason for no sums; NULL */
    const mt_profiled *profiled; /* --vibration; NULL */
    int n;                       /* of --sensitivity */
    const int *parameter;        /* [n] */
    const double *value;         /* [n] */
    /* n_extremes x n: change of |H| in per cent, for one per cent more */
    const double *percent;
} response_view;

static const mt_port *response_input_of(const response_view *v, int pair);
static const mt_port *response_output_of(const response_view *v, int pair);

/* What a profile of vibration does to the outputs of a response, in words and numbers. */

enum { DIGITS = 5, UNIT_TEXT = 64 };

static const double TWO_PI = 6.283185307179586477;

static mt_vibrated row_of(const response_view *v, int pair)
{
    const mt_port *const to = response_output_of(v, pair);
    return (mt_vibrated){.profile = v->profiled->v,
                         .response = &v->profiled->answers[pair],
                         .is_acceleration =
                             to->kind == MT_PORT_SENSOR && to->motion == 2 && !to->turns,
                         .unit = to->unit};
}

/* Columns that identify the pair, before its values. */
static void pair_columns(const response_view *v, mt_table *t)
{
    if (v->r->ports.n_in > 1) {
        mt_table_column(t, "input", "input", MT_ALIGN_LEFT);
    }
    mt_table_column(t, "output", "output", MT_ALIGN_LEFT);
}

static void pair_cells(const response_view *v, int pair, mt_table *t)
{
    if (v->r->ports.n_in > 1) {
        mt_table_text(t, response_input_of(v, pair)->name);
    }
    mt_table_text(t, response_output_of(v, pair)->name);
}

static void print_rows(const response_view *v, mt_text *out)
{
    mt_table t = mt_table_default();
    pair_columns(v, &t);
    mt_vibrated_columns(&t);
    for (int p = 0; p < v->profiled->n_pairs; p++) {
        const mt_vibrated row = row_of(v, p);
        pair_cells(v, p, &t);
        mt_vibrated_row(&t, &row);
    }
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_text_add(out, "\n");
    mt_table_free(&t);
}

static void print_tones(const response_view *v, mt_text *out)
{
    mt_table t = mt_table_default();
    pair_columns(v, &t);
    mt_vibrated_tone_columns(&t);
    for (int p = 0; p < v->profiled->n_pairs; p++) {
        const mt_vibrated row = row_of(v, p);
        for (int i = 0; i < v->profiled->v->n_tones; i++) {
            pair_cells(v, p, &t);
            mt_vibrated_tone_row(&t, &row, i);
        }
    }
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_text_add(out, v->profiled->no_sums == NULL
                         ? "  Each is the largest within its range, proven up to that part of "
                           "it.\n\n"
                         : "\n");
    mt_table_free(&t);
}

/* The vibration mode whose pole this is: the one with the nearest frequency; 0: none. */
static int mode_of(const response_view *v, double complex pole)
{
    const mt_modes *const modes = v->r->modes;
    const double hz = cabs(pole) / TWO_PI;
    int best = 0;
    double least = HUGE_VAL;
    for (int i = 1; i <= mt_modal_vibrations(modes); i++) {
        const double off = fabs(mt_modal_hz(modes, mt_modal_flexible(modes, i)) - hz);
        best = off < least ? i : best;
        least = fmin(off, least);
    }
    return best;
}

/* Print the reason for a pair without a value; *said: the pole named last, so that pairs with
 * the same pole are reported once. */
static void print_end(const response_view *v, int pair, int *said, mt_text *out)
{
    const mt_vibration_response *const a = &v->profiled->answers[pair];
    if (a->end == MT_FORCED_FINITE || a->pole < 0 || a->pole == *said) {
        return;
    }
    const double complex pole = v->profiled->poles[a->pole];
    const int mode = mode_of(v, pole);
    const char *const name =
        mode > 0 ? mt_mode_name(v->s, v->r->sys->configuration, mode) : NULL;
    *said = a->pole;
    mt_text_addf(out, "  Vibration mode %d%s%s%s, %.6g Hz, ", mode, name == NULL ? "" : " \"",
                 name == NULL ? "" : name, name == NULL ? "" : "\"", cabs(pole) / TWO_PI);
    mt_text_add(out, a->end == MT_FORCED_INFINITE
                         ? "has no damping, and the profile acts there: what it shakes is "
                           "infinite.\n"
                         : "grows by itself: there is no steady response.\n");
}

/* Print the vibration of each output under the profile, with its notes. */
static void response_vibration_print(const response_view *v, mt_text *out)
{
    const mt_vibration *const p = v->profiled->v;
    const char *const axis = mt_vibrated_axis(p);
    int said = -1;
    mt_text_addf(out, "  Under %s%s%s", mt_vibrated_name(p), axis == NULL ? "" : ", along ",
                 axis == NULL ? "" : axis);
    if (p->n_random > 0) {
        mt_text_addf(out, " (%.5g g RMS)", mt_vibration_rms(p) / MT_STANDARD_GRAVITY);
    }
    mt_text_add(out, "; ");
    mt_vibrated_rule(p, out);
    mt_text_add(out, ":\n");
    print_rows(v, out);
    for (int k = 0; k < v->profiled->n_pairs; k++) {
        print_end(v, k, &said, out);
    }
    mt_text_add(out, said >= 0 ? "\n" : "");
    if (p->n_tones > 0) {
        print_tones(v, out);
    }
    if (v->profiled->no_sums != NULL) {
        mt_text_addf(out,
                     "  %s. The numbers are therefore by quadrature: errors are estimates, and "
                     "of tones nothing is proven.\n\n",
                     v->profiled->no_sums);
    }
    mt_vibrated_marks(p, out);
}

/* The density at a frequency, or NaN where it is infinite. */
static double density_at(const response_view *v, int pair, int point)
{
    const ptrdiff_t at = pair + ((ptrdiff_t)point * v->profiled->n_pairs);
    const double psd =
        mt_profiled_psd(v->profiled, pair, v->curve->w[point] / TWO_PI, v->curve->h[at]);
    return isfinite(psd) ? psd : nan("");
}

static void density_unit(const response_view *v, int pair, char unit[UNIT_TEXT])
{
    (void)mt_snprintf(unit, UNIT_TEXT, "(%s)^2/Hz", response_output_of(v, pair)->unit);
}

/* The columns, and the cells for one frequency of the curve. */
static void response_vibration_columns(mt_table *t)
{
    mt_table_column(t, "psd", "psd", MT_ALIGN_POINT);
    mt_table_column(t, "psd unit", "psd_unit", MT_ALIGN_LEFT);
}

static void response_vibration_cells(const response_view *v, int pair, int point, mt_table *t)
{
    char unit[UNIT_TEXT];
    density_unit(v, pair, unit);
    mt_table_number(t, density_at(v, pair, point), DIGITS);
    mt_table_text(t, unit);
}

/* A response as text, JSON and CSV. */

enum { HZ_DIGITS = 7, HEADING_TEXT = 160 };

/* NaN where there is no value. */
static double magnitude(double complex h)
{
    const double size = cabs(h);
    return isfinite(size) ? size : nan("");
}

static const mt_port *response_input_of(const response_view *v, int pair)
{
    return &v->r->ports.in[pair / v->r->ports.n_out];
}

static const mt_port *response_output_of(const response_view *v, int pair)
{
    return &v->r->ports.out[pair % v->r->ports.n_out];
}

static int pairs_of(const response_view *v)
{
    return v->r->ports.n_in * v->r->ports.n_out;
}

static double complex value_at(const response_view *v, int pair, int point)
{
    return v->curve->h[pair + ((ptrdiff_t)point * pairs_of(v))];
}

static double error_at(const response_view *v, int pair, int point)
{
    const double error = v->curve->error[pair + ((ptrdiff_t)point * pairs_of(v))];
    return isfinite(error) ? error : nan("");
}

/* An extreme with rounding set to 0. */
static double complex extreme_of(const mt_extreme *e)
{
    return e->infinite ? nan("") : (cabs(e->h) > e->error ? e->h : 0.0);
}

static const char *extreme_kind_name(const mt_extreme *e)
{
    return e->infinite        ? "resonance"
           : e->peak          ? "peak"
           : e->antiresonance ? "antiresonance"
                              : "minimum";
}

static void write_pair_unit(const response_view *v, int pair, char unit[HEADING_TEXT])
{
    (void)mt_snprintf(unit, HEADING_TEXT, "%s per %s", response_output_of(v, pair)->unit,
                      response_input_of(v, pair)->unit);
}

static double percent_of(const response_view *v, int e, int k)
{
    return v->percent[e + ((ptrdiff_t)k * v->curve->n_extremes)];
}

static const char *parameter_of(const response_view *v, int k)
{
    return v->s->model->parameters[v->parameter[k]].name.s;
}

/* What one parameter does to an extreme. */
typedef struct magnitude_slope_row {
    const char *parameter;
    double value;
    double per_percent;
} magnitude_slope_row;

#define THIS magnitude_slope_row
static const mt_field magnitude_slope_fields[] = {
    MT_F_TEXT("parameter", parameter, "Its name."),
    MT_F_NUMBER("value", value, "Its value in this configuration, in SI."),
    MT_F_NUMBER_OR_NULL("magnitude_per_percent", per_percent,
                        "Change of the magnitude for one per cent more of it; null: the "
                        "magnitude is 0 or infinite. In the unit of the response."),
};
static const mt_record magnitude_slope_record = MT_F_RECORD_OF(
    magnitude_slope_fields, "sensitivity", "What one parameter does to the magnitude.");
#undef THIS

static const char *const extreme_kinds[] = {"peak", "resonance", "antiresonance", "minimum"};

/* A peak, a resonance or an antiresonance. */
typedef struct extreme_row {
    const char *input;
    const char *output;
    const char *kind;
    double hz;
    double magnitude;
    const char *unit;
    double phase_deg;
    bool with_slopes;
    magnitude_slope_row *slopes;
    int n_slopes;
} extreme_row;

#define THIS extreme_row
static const mt_field extreme_fields[] = {
    MT_F_UNWRITTEN_TEXT(input), /* JSON has them around the list */
    MT_F_UNWRITTEN_TEXT(output),
    MT_F_CHOICE(
        "kind", kind, extreme_kinds,
        "\"resonance\": of a mode that nothing damps, where the magnitude is infinite."),
    MT_F_NUMBER("frequency_hz", hz, "Where it is."),
    MT_F_NUMBER_OR_NULL("magnitude", magnitude,
                        "Magnitude of the response, in its unit; null: infinite."),
    MT_F_UNWRITTEN_TEXT(unit),
    MT_F_NUMBER_OR_NULL("phase_deg", phase_deg, "Phase of the output against the input."),
    MT_F_LIST("sensitivities", slopes, n_slopes, magnitude_slope_row, magnitude_slope_record,
              "With --sensitivity: one of each parameter.", MT_F_WHEN(with_slopes),
              .flat = true),
};
static const mt_record extreme_record =
    MT_F_RECORD_OF(extreme_fields, "extreme", "A peak, or a minimum.");
static const mt_record_column extreme_columns[] = {
    MT_R_COLUMN(input, "input", 0, MT_IN_TEXT),
    MT_R_COLUMN(output, "output", 0, MT_IN_TEXT),
    MT_R_COLUMN(kind, "kind", 0, MT_IN_TEXT),
    MT_R_COLUMN(hz, "frequency [Hz]", HZ_DIGITS, MT_IN_TEXT),
    MT_R_COLUMN(magnitude, "magnitude", DIGITS, MT_IN_TEXT),
    MT_R_COLUMN(unit, "unit", 0, MT_IN_TEXT),
    MT_R_COLUMN(phase_deg, "phase [deg]", DIGITS, MT_IN_TEXT),
};
static const mt_record_table extreme_rows = MT_R_TABLE_OF(extreme_record, extreme_columns);
#undef THIS

static extreme_row extreme_row_of(const response_view *v, int e, char unit[HEADING_TEXT])
{
    const mt_extreme *const x = &v->curve->extremes[e];
    write_pair_unit(v, x->pair, unit);
    return (extreme_row){
        .input = response_input_of(v, x->pair)->name,
        .output = response_output_of(v, x->pair)->name,
        .kind = extreme_kind_name(x),
        .hz = x->w / TWO_PI,
        .magnitude = magnitude(extreme_of(x)),
        .unit = unit,
        .phase_deg = mt_phase_deg(extreme_of(x)),
    };
}

static void print_extremes(const response_view *v, mt_text *out)
{
    mt_table t = mt_table_default();
    mt_table_record_columns(&t, &extreme_rows, MT_IN_TEXT);
    for (int k = 0; k < v->n; k++) {
        char heading[HEADING_TEXT];
        (void)mt_snprintf(heading, sizeof heading, "by 1 %% of %s", parameter_of(v, k));
        mt_table_column(&t, heading, heading, MT_ALIGN_POINT);
    }
    for (int e = 0; e < v->curve->n_extremes; e++) {
        char unit[HEADING_TEXT];
        const extreme_row row = extreme_row_of(v, e, unit);
        mt_table_record_row(&t, &extreme_rows, MT_IN_TEXT, &row);
        for (int k = 0; k < v->n; k++) {
            mt_table_change(&t, percent_of(v, e, k), DIGITS);
        }
    }
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
}

/* Print the frequencies of the grid only; the other points are for drawings. */
static void print_grid(const response_view *v, mt_text *out)
{
    mt_table t = mt_table_default();
    int at = 0;
    mt_table_column(&t, "frequency [Hz]", "frequency_hz", MT_ALIGN_POINT);
    for (int p = 0; p < pairs_of(v); p++) {
        char heading[HEADING_TEXT];
        char unit[HEADING_TEXT];
        write_pair_unit(v, p, unit);
        (void)mt_snprintf(heading, sizeof heading, "%s%s%s [%s]",
                          response_output_of(v, p)->name, v->r->ports.n_in > 1 ? " by " : "",
                          v->r->ports.n_in > 1 ? response_input_of(v, p)->name : "", unit);
        mt_table_column(&t, heading, heading, MT_ALIGN_POINT);
        mt_table_column(&t, "phase [deg]", "phase_deg", MT_ALIGN_POINT);
    }
    for (int i = 0; i < v->curve->n && at < v->opt.points; i++) {
        if (v->curve->w[i] < mt_curve_grid(&v->opt, at)) {
            continue;
        }
        at++;
        mt_table_number(&t, v->curve->w[i] / TWO_PI, HZ_DIGITS);
        for (int p = 0; p < pairs_of(v); p++) {
            mt_table_number(&t, magnitude(value_at(v, p, i)), DIGITS);
            mt_table_number(&t, mt_phase_deg(value_at(v, p, i)), DIGITS);
        }
    }
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
}

/* Geometric mean of the errors' parts of their values, up to the next power of 10. */
static double mean_error(const response_view *v)
{
    double sum = 0.0;
    int n = 0;
    for (int p = 0; p < pairs_of(v); p++) {
        for (int i = 0; i < v->curve->n; i++) {
            const double error = error_at(v, p, i);
            const double value = magnitude(value_at(v, p, i));
            if (error > 0.0 && value > 0.0 && isfinite(error / value)) {
                sum += log(error) - log(value);
                n++;
            }
        }
    }
    return n > 0 ? pow(10.0, ceil(sum / n / log(10.0))) : 0.0;
}

static void print_method(const response_view *v, mt_text *out)
{
    const mt_basis *const b = &v->r->basis;
    if (v->direct) {
        mt_text_add(out, "  Directly: a factor of the dynamic stiffness at every frequency.");
    } else if (v->r->a == NULL) {
        mt_text_addf(out, "  By the %d lowest of %d modes and %d shapes of the others%s.",
                     v->r->modes->count, v->r->modes->all, v->r->shapes,
                     b->t.diagonal ? "" : ", coupled by their damping");
    } else {
        mt_text_addf(out, "  By %d of %d modes%s.", b->n_modes, b->n_modes + b->n_left,
                     b->t.diagonal ? "" : ", coupled by their damping");
    }
    mt_text_addf(
        out, " %d frequencies, %d of them of the grid; %s below %.0e of a value on average.\n",
        v->curve->n, v->opt.points,
        v->r->a == NULL ? "rounding and what is left out are" : "rounding is", mean_error(v));
    if (!v->direct && b->n_left > 0) {
        mt_text_addf(out,
                     "  %d modes from %.5g Hz on follow statically: near and above that the "
                     "response is wrong.\n",
                     b->n_left, sqrt(fmax(b->lowest_left, 0.0)) / TWO_PI);
    }
    if (!v->curve->complete) {
        mt_text_add(out, "  Not all peaks are shown as fine as asked for: that takes too many "
                         "frequencies.\n");
    }
}

static void print_poles(const response_view *v, mt_text *out)
{
    if (v->no_sums != NULL) {
        mt_text_addf(out, "  %s.\n", v->no_sums);
    }
    if (v->sums == NULL) {
        return;
    }
    mt_table t = mt_table_default();
    mt_table_column(&t, "pole: re [1/s]", "re", MT_ALIGN_POINT);
    mt_table_column(&t, "im [rad/s]", "im", MT_ALIGN_POINT);
    for (int k = 0; k < v->sums->n; k++) {
        mt_table_number(&t, creal(v->sums->s[k]), HZ_DIGITS);
        mt_table_number(&t, cimag(v->sums->s[k]), HZ_DIGITS);
    }
    mt_text_add(out, "\n");
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
}

static void response_print(const response_view *v, mt_text *out)
{
    bool infinite = false;
    for (int e = 0; e < v->curve->n_extremes; e++) {
        infinite = infinite || v->curve->extremes[e].infinite;
    }
    mt_text_addf(out, "%s: response to %s%s, %.6g to %.6g Hz\n", v->configuration,
                 v->r->ports.in[0].name, v->r->ports.n_in > 1 ? ", ..." : "",
                 v->opt.from / TWO_PI, v->opt.to / TWO_PI);
    if (v->profiled != NULL) {
        response_vibration_print(v, out);
    }
    if (v->curve->n_extremes > 0) {
        print_extremes(v, out);
        mt_text_add(out, "\n");
    }
    if (v->profiled == NULL) {
        print_grid(v, out);
    }
    print_poles(v, out);
    print_method(v, out);
    if (infinite) {
        mt_text_add(out,
                    "  Resonances that nothing damps have no magnitude: it is infinite.\n");
    }
    mt_text_add(out, "\n");
}

#define THIS mt_port
static const mt_field port_fields[] = {
    MT_F_TEXT("name", name, "Its full name."),
    MT_F_TEXT("unit", unit, "Its unit."),
};
static const mt_record port_record = MT_F_RECORD_OF(port_fields, "port", "An input or output.");
#undef THIS

typedef struct complex_row {
    double re;
    double im;
} complex_row;

#define THIS complex_row
static const mt_field complex_fields[] = {
    MT_F_NUMBER("re", re, "Real part, in the unit of the response times s^k for (i omega)^k."),
    MT_F_NUMBER("im", im, "Imaginary part, in the same unit."),
};
static const mt_record complex_record =
    MT_F_RECORD_OF(complex_fields, "coefficient", "A complex coefficient.");
#undef THIS

typedef struct pole_row {
    complex_row pole;
    complex_row residue;
} pole_row;

#define THIS pole_row
static const mt_field pole_fields[] = {
    MT_F_NUMBER("re", pole.re, "Real part of the pole [1/s]."),
    MT_F_NUMBER("im", pole.im, "Imaginary part of the pole [rad/s]."),
    MT_F_NUMBER("residue_re", residue.re,
                "Real part of its residue, in the unit of the response times rad/s."),
    MT_F_NUMBER("residue_im", residue.im,
                "Imaginary part of its residue, in the unit of the response times rad/s."),
};
static const mt_record pole_record =
    MT_F_RECORD_OF(pole_fields, "pole", "A pole of the response with its residue.");
#undef THIS

/* What the profile does to the output of a response. */
typedef struct vibration_row {
    mt_vibrated_values vibrated;
    bool with_mode;
    int by_mode;
} vibration_row;

#define THIS vibration_row
static const mt_field vibration_fields[] = {
    MT_VIBRATED_FIELDS(vibrated),
    MT_F_COUNT("by_mode", by_mode, 0,
               "Vibration mode for which there is no finite number; 0: none is near.",
               MT_F_WHEN(with_mode)),
};
static const mt_record vibration_record =
    MT_F_RECORD_OF(vibration_fields, NULL, "What the profile does to the output.");
#undef THIS

/* The response of one output to one input. */
typedef struct response_row {
    const char *input;
    const char *output;
    const char *unit;
    extreme_row *extremes;
    int n_extremes;
    bool with_poles;
    pole_row *poles;
    int n_poles;
    bool with_no_poles;
    const char *no_poles;
    bool with_polynomial;
    complex_row *polynomial;
    int n_polynomial;
    double *re;
    double *im;
    double *error;
    double *psd;
    int n;
    bool with_vibration;
    vibration_row vibration;
    const char *psd_unit;
} response_row;

#define THIS response_row
static const mt_field response_fields[] = {
    MT_F_TEXT("input", input, "What shakes."),
    MT_F_TEXT("output", output, "What is seen."),
    MT_F_TEXT("unit", unit, "Unit of the response: that of the output per that of the input."),
    MT_F_LIST("extremes", extremes, n_extremes, extreme_row, extreme_record,
              "Peaks and minima within the range."),
    MT_F_LIST_OR_NULL(
        "poles", poles, n_poles, pole_row, pole_record,
        "With --poles: the response is the sum of residue / (i omega - pole) over "
        "the poles and their conjugates, and of a polynomial; null: there is no "
        "such sum.",
        MT_F_WHEN(with_poles), .flat = true),
    MT_F_TEXT("no_poles", no_poles, "Why there is none.", MT_F_WHEN(with_no_poles)),
    MT_F_LIST("polynomial", polynomial, n_polynomial, complex_row, complex_record,
              "Its coefficients of (i omega)^0, ^1 and ^2.", MT_F_WHEN(with_polynomial),
              .flat = true),
    MT_F_NUMBERS("re", re, n,
                 "Real part at each frequency, in the unit that `unit` names; null: infinite, "
                 "or not a number."),
    MT_F_NUMBERS("im", im, n, "Imaginary part at each frequency, in the same unit."),
    MT_F_NUMBERS("error", error, n, "Bound of the error at each frequency, in the same unit."),
    MT_F_RECORD("vibration", vibration, vibration_row, vibration_record,
                "With --vibration: what the profile does to the output.",
                MT_F_WHEN(with_vibration)),
    MT_F_TEXT("psd_unit", psd_unit, "Unit of the density.", MT_F_WHEN(with_vibration)),
    MT_F_NUMBERS("psd", psd, n,
                 "Power spectral density of the output at each frequency, in the unit that "
                 "`psd_unit` names.",
                 MT_F_WHEN(with_vibration)),
};
static const mt_record response_record =
    MT_F_RECORD_OF(response_fields, "response", "The response of one output to one input.");
#undef THIS

typedef struct profile_row {
    const char *file;
    const char *name;
    const char *axis;
    double rms_m_per_s2;
    mt_rule_row rule;
} profile_row;

#define THIS profile_row
static const char *const axes[] = {"x", "y", "z"};
static const mt_field profile_fields[] = {
    MT_F_TEXT("file", file, "Its path."),
    MT_F_TEXT_OR_NULL("name", name, "Its name."),
    MT_F_CHOICE_OR_NULL("axis", axis, axes, "Along which it shakes; null: any."),
    MT_F_NUMBER("rms_m_per_s2", rms_m_per_s2, "Overall RMS of its random parts."),
    MT_RULE_FIELDS(rule),
};
static const mt_record profile_record =
    MT_F_RECORD_OF(profile_fields, NULL, "The profile of vibration.");
#undef THIS

/* One configuration, answered. */
typedef struct configuration_row {
    const char *configuration;
    const char *method;
    int modes;
    int modes_left_out;
    bool with_shapes;
    int shapes_of_others;
    bool coupled;
    bool complete;
    bool with_profile;
    profile_row profile;
    const char *vibration_method;
    mt_port *inputs;
    int n_inputs;
    mt_port *outputs;
    int n_outputs;
    double *frequencies_hz;
    int n_frequencies;
    response_row *responses;
    int n_responses;
} configuration_row;

#define THIS configuration_row
static const char *const methods[] = {"direct", "modes"};
static const char *const vibration_methods[] = {"poles", "quadrature"};
static const mt_field configuration_fields[] = {
    MT_F_TEXT("configuration", configuration, "Its name."),
    MT_F_CHOICE(
        "method", method, methods,
        "\"direct\": a factor of the dynamic stiffness at every frequency; \"modes\": by "
        "modes."),
    MT_F_COUNT("modes", modes, 0, "Number of modes that it is made of."),
    MT_F_COUNT("modes_left_out", modes_left_out, 0, "Number of the others."),
    MT_F_COUNT("shapes_of_others", shapes_of_others, 0,
               "Of a large mechanism: number of shapes that stand for the others.",
               MT_F_WHEN(with_shapes)),
    MT_F_FLAG("coupled", coupled, "Damping couples the modes."),
    MT_F_FLAG("complete", complete, "All peaks are as fine as asked for."),
    MT_F_RECORD("profile", profile, profile_row, profile_record,
                "With --vibration: the profile.", MT_F_WHEN(with_profile)),
    MT_F_CHOICE(
        "vibration_method", vibration_method, vibration_methods,
        "\"poles\": its integrals are exact; \"quadrature\": errors are estimates, and of "
        "tones nothing is proven.",
        MT_F_WHEN(with_profile)),
    MT_F_LIST("inputs", inputs, n_inputs, mt_port, port_record, "What shakes.", .flat = true),
    MT_F_LIST("outputs", outputs, n_outputs, mt_port, port_record, "What is seen.",
              .flat = true),
    MT_F_NUMBERS("frequencies_hz", frequencies_hz, n_frequencies,
                 "The frequencies: of the grid, and between them where a curve bends."),
    MT_F_LIST(
        "responses", responses, n_responses, response_row, response_record,
        "One of each input and output: all outputs of the first input, then of the next."),
};
static const mt_record configuration_record =
    MT_F_RECORD_OF(configuration_fields, "configuration", "A configuration, answered.");
#undef THIS

static complex_row complex_row_of(double complex z)
{
    return (complex_row){.re = creal(z), .im = cimag(z)};
}

/* An extreme with what the parameters do to it; a shortage is remembered by mem. */
static extreme_row extreme_row_in(const response_view *v, int e, const char *unit,
                                  mt_arena *mem)
{
    char own[HEADING_TEXT];
    extreme_row row = extreme_row_of(v, e, own);
    row.unit = unit;
    row.with_slopes = v->n > 0;
    row.slopes = mt_arena_alloc(mem, (size_t)v->n, sizeof *row.slopes);
    for (; row.slopes != NULL && row.n_slopes < v->n; row.n_slopes++) {
        const int k = row.n_slopes;
        row.slopes[k] = (magnitude_slope_row){.parameter = parameter_of(v, k),
                                              .value = v->value[k],
                                              .per_percent = percent_of(v, e, k)};
    }
    return row;
}

static void fill_poles(const response_view *v, int pair, mt_arena *mem, response_row *out)
{
    out->with_poles = v->no_sums != NULL || v->sums != NULL;
    out->with_no_poles = v->no_sums != NULL;
    out->no_poles = v->no_sums;
    out->with_polynomial = v->sums != NULL;
    if (v->sums == NULL) {
        return;
    }
    const mt_pole_sum *const sum = &v->sums[pair];
    out->poles = mt_arena_alloc(mem, (size_t)sum->n + 1, sizeof *out->poles);
    out->polynomial = mt_arena_alloc(mem, MT_COUNT(sum->d), sizeof *out->polynomial);
    for (int k = 0; k < sum->n && out->poles != NULL; k++) {
        out->poles[out->n_poles++] =
            (pole_row){complex_row_of(sum->s[k]), complex_row_of(sum->residue[k])};
    }
    for (int k = 0; k < MT_COUNT(sum->d) && out->polynomial != NULL; k++) {
        out->polynomial[out->n_polynomial++] = complex_row_of(sum->d[k]);
    }
}

static void fill_curves(const response_view *v, int pair, response_row *out)
{
    for (int i = 0; i < v->curve->n; i++) {
        const double complex h = value_at(v, pair, i);
        const bool has = isfinite(cabs(h));
        out->re[i] = has ? creal(h) : nan("");
        out->im[i] = has ? cimag(h) : nan("");
        out->error[i] = error_at(v, pair, i);
        if (out->with_vibration) {
            out->psd[i] = density_at(v, pair, i);
        }
    }
}

static mt_status fill_vibration(const response_view *v, int pair, mt_arena *mem,
                                response_row *out, mt_err *err)
{
    const mt_vibrated row = row_of(v, pair);
    const mt_vibration_response *const a = row.response;
    char unit[UNIT_TEXT];
    density_unit(v, pair, unit);
    out->psd_unit = mt_arena_strdup(mem, unit);
    out->vibration.with_mode = a->end != MT_FORCED_FINITE && a->pole >= 0;
    if (out->vibration.with_mode) {
        out->vibration.by_mode = mode_of(v, v->profiled->poles[a->pole]);
    }
    return mt_vibrated_values_of(&row, mem, &out->vibration.vibrated, err);
}

static mt_status response_row_of(const response_view *v, int pair, mt_arena *mem,
                                 response_row *out, mt_err *err)
{
    const size_t n = (size_t)v->curve->n;
    char unit[HEADING_TEXT];
    write_pair_unit(v, pair, unit);
    *out = (response_row){
        .input = response_input_of(v, pair)->name,
        .output = response_output_of(v, pair)->name,
        .unit = mt_arena_strdup(mem, unit),
        .extremes = mt_arena_alloc(mem, (size_t)v->curve->n_extremes, sizeof *out->extremes),
        .re = mt_arena_f64(mem, n, 1),
        .im = mt_arena_f64(mem, n, 1),
        .error = mt_arena_f64(mem, n, 1),
        .psd = v->profiled == NULL ? NULL : mt_arena_f64(mem, n, 1),
        .n = v->curve->n,
        .with_vibration = v->profiled != NULL,
    };
    MT_TRY(mt_arena_check(mem, err));
    for (int e = 0; e < v->curve->n_extremes; e++) {
        if (v->curve->extremes[e].pair == pair) {
            out->extremes[out->n_extremes++] = extreme_row_in(v, e, out->unit, mem);
        }
    }
    fill_poles(v, pair, mem, out);
    fill_curves(v, pair, out);
    if (out->with_vibration) {
        MT_TRY(fill_vibration(v, pair, mem, out, err));
    }
    return mt_arena_check(mem, err);
}

static profile_row profile_row_of(const response_view *v)
{
    const mt_vibration *const p = v->profiled->v;
    return (profile_row){.file = p->path,
                         .name = p->name,
                         .axis = mt_vibrated_axis(p),
                         .rms_m_per_s2 = mt_vibration_rms(p),
                         .rule = mt_rule_row_of(p)};
}

static mt_status configuration_row_of(const response_view *v, mt_arena *mem,
                                      configuration_row *out, mt_err *err)
{
    const mt_basis *const b = &v->r->basis;
    const bool lowest = v->r->a == NULL;
    *out = (configuration_row){
        .configuration = v->configuration,
        .method = v->direct ? "direct" : "modes",
        .modes = lowest ? v->r->modes->count : b->n_modes,
        .modes_left_out = lowest ? v->r->modes->all - v->r->modes->count : b->n_left,
        .with_shapes = lowest,
        .shapes_of_others = v->r->shapes,
        .coupled = !b->t.diagonal,
        .complete = v->curve->complete,
        .with_profile = v->profiled != NULL,
        .inputs = v->r->ports.in,
        .n_inputs = v->r->ports.n_in,
        .outputs = v->r->ports.out,
        .n_outputs = v->r->ports.n_out,
        .frequencies_hz = mt_arena_f64(mem, (size_t)v->curve->n, 1),
        .responses = mt_arena_alloc(mem, (size_t)pairs_of(v), sizeof *out->responses),
    };
    MT_TRY(mt_arena_check(mem, err));
    if (out->with_profile) {
        out->profile = profile_row_of(v);
        out->vibration_method = v->profiled->no_sums == NULL ? "poles" : "quadrature";
    }
    for (; out->n_frequencies < v->curve->n; out->n_frequencies++) {
        out->frequencies_hz[out->n_frequencies] = v->curve->w[out->n_frequencies] / TWO_PI;
    }
    for (; out->n_responses < pairs_of(v); out->n_responses++) {
        MT_TRY(
            response_row_of(v, out->n_responses, mem, &out->responses[out->n_responses], err));
    }
    return MT_OK;
}

static mt_status response_json(const response_view *v, mt_arena *mem, mt_json_writer *w,
                               mt_err *err)
{
    configuration_row row;
    MT_TRY(configuration_row_of(v, mem, &row, err));
    mt_record_put_object(w, NULL, &configuration_record, &row, 0, NULL);
    return MT_OK;
}

/* A point of a curve, a row of CSV; JSON has the curves as lists. */
typedef struct point_row {
    const char *configuration;
    const char *input;
    const char *output;
    double hz;
    double re;
    double im;
    double magnitude;
    double phase_deg;
    double error;
    const char *unit;
} point_row;

#define THIS point_row
static const mt_field point_fields[] = {
    MT_F_TEXT("configuration", configuration, "Configuration."),
    MT_F_TEXT("input", input, "What shakes."),
    MT_F_TEXT("output", output, "What is seen."),
    MT_F_NUMBER("frequency_hz", hz, "Frequency."),
    MT_F_NUMBER_OR_NULL("re", re, "Real part of the response."),
    MT_F_NUMBER_OR_NULL("im", im, "Imaginary part of the response."),
    MT_F_NUMBER_OR_NULL("magnitude", magnitude, "Magnitude of the response."),
    MT_F_NUMBER_OR_NULL("phase_deg", phase_deg, "Phase of the output against the input."),
    MT_F_NUMBER_OR_NULL("error", error, "Bound of the error of the response."),
    MT_F_TEXT("unit", unit, "Unit of the response."),
};
static const mt_record point_record = MT_F_RECORD_OF(point_fields, NULL, NULL);
static const mt_record_column point_columns[] = {
    MT_R_COLUMN(configuration, "configuration", 0, MT_IN_CSV),
    MT_R_COLUMN(input, "input", 0, MT_IN_CSV),
    MT_R_COLUMN(output, "output", 0, MT_IN_CSV),
    MT_R_COLUMN(hz, "frequency [Hz]", HZ_DIGITS, MT_IN_CSV),
    MT_R_COLUMN(re, "re", DIGITS, MT_IN_CSV),
    MT_R_COLUMN(im, "im", DIGITS, MT_IN_CSV),
    MT_R_COLUMN(magnitude, "magnitude", DIGITS, MT_IN_CSV),
    MT_R_COLUMN(phase_deg, "phase [deg]", DIGITS, MT_IN_CSV),
    MT_R_COLUMN(error, "error", DIGITS, MT_IN_CSV),
    MT_R_COLUMN(unit, "unit", 0, MT_IN_CSV),
};
static const mt_record_table point_rows = MT_R_TABLE_OF(point_record, point_columns);
#undef THIS

/* psd: with the columns of --vibration. */
static mt_table response_csv_table(bool psd)
{
    mt_table t = mt_table_default();
    mt_table_record_columns(&t, &point_rows, MT_IN_CSV);
    if (psd) {
        response_vibration_columns(&t);
    }
    return t;
}

static void response_csv_rows(const response_view *v, mt_table *t)
{
    for (int p = 0; p < pairs_of(v); p++) {
        char unit[HEADING_TEXT];
        write_pair_unit(v, p, unit);
        for (int i = 0; i < v->curve->n; i++) {
            const double complex h = value_at(v, p, i);
            const bool has = isfinite(cabs(h));
            const point_row row = {
                .configuration = v->configuration,
                .input = response_input_of(v, p)->name,
                .output = response_output_of(v, p)->name,
                .hz = v->curve->w[i] / TWO_PI,
                .re = has ? creal(h) : nan(""),
                .im = has ? cimag(h) : nan(""),
                .magnitude = magnitude(h),
                .phase_deg = mt_phase_deg(h),
                .error = error_at(v, p, i),
                .unit = unit,
            };
            mt_table_record_row(t, &point_rows, MT_IN_CSV, &row);
            if (v->profiled != NULL) {
                response_vibration_cells(v, p, i, t);
            }
        }
    }
}

/* The command. */

enum { DEFAULT_POINTS = 50, DEFAULT_MODES = 6 };
static const double PER_CENT = 0.01;
/* The range that is looked at by default, in parts of its vibration modes' frequencies. */
static const double BELOW_FIRST = 0.25;
static const double ABOVE_LAST = 2.0;
/* How many modes of a large mechanism are found at first, and at most, and how far they have to
 * go above the range. */
enum { WHY_SIZE = MT_LOWEST_WHY + 100 };
enum { FIRST_MODES = 24, MOST_MODES = 400 };
static const double ABOVE_RANGE = 2.0;
/* Where those that are left out have a damping ratio, which nothing but modes shows in full:
 * how far above, in how many modes at most. */
enum { MOST_WITH_RATIO = 100 };
static const double ABOVE_WITH_RATIO = 20.0;

/* One configuration at work. */
typedef struct job {
    const mt_args *args;
    const mt_vibration *profile; /* --vibration; NULL */
    mt_loaded_model *s;
    int c;
    mt_analysis *a; /* NULL: of the lowest modes */
    mt_lowest *l;   /* NULL: of all of them */
    const mt_modes *modes;
    mt_response_request request;
    mt_response r;
    mt_profiled profiled;
    mt_curve curve;
    response_view v;
} job;

static mt_response_request request_of(const mt_args *args)
{
    return (mt_response_request){.n_in = args->all[MT_OPT_INPUT].n,
                                 .inputs = args->all[MT_OPT_INPUT].value,
                                 .n_out = args->all[MT_OPT_MEASURE].n,
                                 .outputs = args->all[MT_OPT_MEASURE].value,
                                 .direct = args->given[MT_OPT_DIRECT],
                                 .modes = args->keep};
}

/* `part` of the frequency of vibration mode `index` [Hz]; NaN where there is none. */
static double by_mode(const job *j, int index, double part)
{
    const int at = mt_modal_flexible(j->modes, index);
    return at < 0 ? nan("") : part * mt_modal_hz(j->modes, at);
}

/* An end of the range: of its option, or the default [Hz]. */
static mt_status range_end(job *j, int option, double hz, double *w, mt_err *err)
{
    const char *const name = mt_options[option].name;
    const char *const text = j->args->value[option];
    if (text != NULL) {
        MT_TRY(mt_loaded_model_number(j->s, name, NULL, text, strlen(text), &hz, err));
    }
    if (!(hz > 0.0 && isfinite(TWO_PI * hz))) {
        return text == NULL ? mt_fail(err, MT_E_USAGE,
                                      "there is no vibration mode from which to choose "
                                      "frequencies: give --%s",
                                      name)
                            : mt_fail(err, MT_E_USAGE, "--%s: %s is not a frequency above 0",
                                      name, text);
    }
    *w = TWO_PI * hz;
    return MT_OK;
}

static mt_status choose_range(job *j, mt_err *err)
{
    const int count = mt_modal_vibrations(j->modes);
    const int last = count < DEFAULT_MODES ? count : DEFAULT_MODES;
    mt_curve_options *const opt = &j->v.opt;
    *opt = (mt_curve_options){.points = j->args->points > 0 ? j->args->points : DEFAULT_POINTS,
                              .log = j->args->given[MT_OPT_LOG]};
    double hz[2] = {by_mode(j, 1, BELOW_FIRST), by_mode(j, last, ABOVE_LAST)};
    if (j->profile != NULL) {
        mt_vibration_range(j->profile, true, true, hz);
        hz[1] = hz[1] > hz[0] ? hz[1] : ABOVE_LAST * hz[1]; /* one tone */
    }
    MT_TRY(range_end(j, MT_OPT_FROM, hz[0], &opt->from, err));
    MT_TRY(range_end(j, MT_OPT_TO, hz[1], &opt->to, err));
    if (!(opt->to > opt->from)) {
        return mt_fail(err, MT_E_USAGE, "--to: %g Hz is not above --from, %g Hz",
                       opt->to / TWO_PI, opt->from / TWO_PI);
    }
    return opt->points < 2 ? mt_fail(err, MT_E_USAGE, "--points: a grid has at least 2 points")
                           : MT_OK;
}

/* Inputs of --set, and the parameter among them: its place in *slot. */
static mt_status inputs_with(const job *j, int parameter, mt_arena *mem, int *n, int **inputs,
                             double **at, int *slot, mt_err *err)
{
    const size_t room = (size_t)j->s->n_inputs + 1;
    *inputs = mt_arena_int(mem, room);
    *at = mt_arena_f64(mem, room, 1);
    MT_TRY(mt_arena_check(mem, err));
    *n = j->s->n_inputs;
    *slot = *n;
    for (int i = 0; i < *n; i++) {
        (*inputs)[i] = j->s->inputs[i];
        (*at)[i] = j->s->at[i];
        *slot = (*inputs)[i] == parameter ? i : *slot;
    }
    if (*slot == *n) {
        (*inputs)[*n] = parameter;
        (*at)[*n] = j->s->values[parameter];
        (*n)++;
    }
    return MT_OK;
}

/* Derivatives of |H| at its extremes by an input, equal to those at fixed frequency:
 * to[n_extremes]. */
static mt_status slopes_with(job *j, mt_analysis *a, mt_response *r, int slot, double value,
                             double *to, mt_err *err)
{
    MT_TRY(mt_response_open(a, &j->request, r, err));
    const ptrdiff_t pairs = (ptrdiff_t)r->ports.n_in * r->ports.n_out;
    double complex *const dh =
        mt_arena_alloc(&r->mem, (size_t)(pairs * a->sys->n_inputs), sizeof *dh);
    MT_TRY(mt_arena_check(&r->mem, err));
    for (int e = 0; e < j->curve.n_extremes; e++) {
        const mt_extreme *const x = &j->curve.extremes[e];
        to[e] = nan("");
        if (x->infinite || !(cabs(x->h) > x->error)) { /* 0, which has no slope */
            continue;
        }
        MT_TRY(mt_response_slopes_at(r, x->w, dh, err));
        const double complex slope = dh[x->pair + (slot * pairs)];
        to[e] = PER_CENT * value * creal(conj(x->h) * slope) / cabs(x->h);
    }
    return MT_OK;
}

static mt_status sensitivity(job *j, int parameter, double *value, double *to, mt_err *err)
{
    mt_analysis *a = NULL;
    mt_response r = {.a = NULL};
    int n = 0;
    int slot = 0;
    int *inputs = NULL;
    double *at = NULL;
    MT_TRY(inputs_with(j, parameter, &j->r.mem, &n, &inputs, &at, &slot, err));
    mt_analysis_options opt = mt_analysis_options_default();
    opt.gradient = true;
    const mt_system_def def = mt_loaded_model_system(j->s, j->c, n, inputs, at);
    mt_status rc = mt_analysis_new_of(&def, 0, &a, err);
    rc = rc == MT_OK ? mt_analysis_solve(a, at, &opt, err) : rc;
    if (rc == MT_OK) {
        *value = mt_linear_value(a->lin, a->sys->parameters[parameter]);
        rc = slopes_with(j, a, &r, slot, *value, to, err);
    }
    mt_response_free(&r);
    mt_analysis_delete(a);
    return rc;
}

static mt_status sensitivities(job *j, mt_err *err)
{
    const char *const list = j->args->value[MT_OPT_SENSITIVITY];
    int *parameter = NULL;
    if (list == NULL) {
        return MT_OK;
    }
    MT_TRY(mt_loaded_model_parameters(j->s, "sensitivity", list, &j->r.mem, &j->v.n, &parameter,
                                      err));
    const size_t n = (size_t)j->v.n;
    double *const value = mt_arena_f64(&j->r.mem, n, 1);
    double *const percent = mt_arena_f64(&j->r.mem, (size_t)j->curve.n_extremes, n);
    MT_TRY(mt_arena_check(&j->r.mem, err));
    for (int k = 0; k < j->v.n; k++) {
        MT_TRY(sensitivity(j, parameter[k], &value[k],
                           percent + ((ptrdiff_t)k * j->curve.n_extremes), err));
    }
    j->v.parameter = parameter;
    j->v.value = value;
    j->v.percent = percent;
    return MT_OK;
}

/* Find the sums of poles; that there is none is part of the answer. */
static mt_status poles(job *j, mt_err *err)
{
    if (!j->args->given[MT_OPT_POLES]) {
        return MT_OK;
    }
    mt_err own = {.code = MT_OK};
    const size_t pairs = (size_t)j->r.ports.n_in * (size_t)j->r.ports.n_out;
    mt_pole_sum *const sums = mt_arena_alloc(&j->r.mem, pairs, sizeof *sums);
    MT_TRY(mt_arena_check(&j->r.mem, err));
    const mt_status rc = mt_response_sums(&j->r, sums, &own);
    if (rc != MT_OK && rc != MT_E_SINGULAR) {
        return mt_fail(err, rc, "%s", own.text);
    }
    j->v.sums = rc == MT_OK ? sums : NULL;
    j->v.no_sums = rc == MT_OK ? NULL : mt_arena_strdup(&j->r.mem, own.text);
    return mt_arena_check(&j->r.mem, err);
}

/* The vibration under the profile, where one is given. */
static mt_status shake(job *j, mt_err *err)
{
    if (j->profile != NULL) {
        MT_TRY(mt_profiled_find(&j->r, j->profile, &j->profiled, err));
        j->v.profiled = &j->profiled;
    }
    return MT_OK;
}

static mt_status request_ports(job *j, const mt_system *sys, mt_err *err)
{
    j->request = request_of(j->args);
    return j->profile == NULL
               ? MT_OK
               : mt_profiled_ports(j->profile, sys, &j->s->mem, &j->request, err);
}

static mt_status open_response(job *j, const char *why, mt_err *err)
{
    MT_TRY(mt_loaded_model_admit_dense(j->s, j->c, why, err));
    MT_TRY(mt_loaded_model_analyse(j->s, j->c, 0, &j->a, err));
    j->modes = &j->a->modes;
    MT_TRY(request_ports(j, j->a->sys, err));
    MT_TRY(mt_response_open(j->a, &j->request, &j->r, err));
    MT_TRY(mt_response_admit(&j->r, err));
    MT_TRY(shake(j, err));
    return choose_range(j, err);
}

/* True where the lowest modes may suffice. */
static bool may_be_large(const job *j, char *why)
{
    static const int WHOLE[] = {MT_OPT_DIRECT, MT_OPT_POLES, MT_OPT_SENSITIVITY, MT_OPT_KEEP};
    for (int i = 0; i < MT_COUNT(WHOLE); i++) {
        if (j->args->given[WHOLE[i]]) {
            (void)mt_snprintf(why, WHY_SIZE, "--%s needs all modes", mt_options[WHOLE[i]].name);
            return false;
        }
    }
    return mt_lowest_bodies(j->s->model, j->c) >= MT_LOWEST_BODIES;
}

/* The response by the lowest `count` modes; *enough: true where they reach so far above the
 * range that the omitted ones are within little more than rounding. */
static mt_status try_large(job *j, int count, bool *is, bool *enough, char *why, mt_err *err)
{
    const mt_lowest_want want = {.count = count, .shapes = true};
    mt_err own = {.code = MT_OK};
    mt_lowest_delete(j->l);
    j->l = NULL;
    const mt_system_def def =
        mt_loaded_model_system(j->s, j->c, j->s->n_inputs, j->s->inputs, j->s->at);
    const mt_status rc = mt_lowest_new(&def, want, &j->l, &own);
    if (mt_is_final(rc) || rc == MT_E_INTERRUPTED) {
        return mt_fail(err, rc, "%s", own.text);
    }
    *is = rc == MT_OK && j->l->way != MT_LOWEST_NONE;
    *enough = true;
    if (rc != MT_OK) {
        (void)mt_snprintf(why, WHY_SIZE, "its lowest modes alone: %s", own.text);
        return MT_OK;
    }
    if (!*is) {
        (void)mt_snprintf(why, WHY_SIZE,
                          "the method for large trees does not apply, because %s", j->l->why);
        return MT_OK;
    }
    j->modes = &j->l->found.modes;
    MT_TRY(request_ports(j, j->l->sys, err));
    MT_TRY(choose_range(j, err));
    const bool ratio = j->l->sys->damping.ratio != MT_NO_NODE && 2 * count <= MOST_WITH_RATIO;
    const double above = (ratio ? ABOVE_WITH_RATIO : ABOVE_RANGE) * j->v.opt.to;
    *enough = j->l->found.tau >= above * above || j->l->found.below == j->modes->all;
    if (!*enough) {
        return MT_OK;
    }
    mt_response_free(&j->r);
    char what[MT_LARGE_WHY] = "";
    MT_TRY(mt_response_open_large(j->l, &j->request, j->v.opt.to, &j->r, is, what, err));
    if (!*is) {
        (void)mt_snprintf(why, WHY_SIZE, "a response by its lowest modes: %s", what);
    }
    return MT_OK;
}

/* *is false: all modes have to be found. */
static mt_status open_large(job *j, bool *is, char *why, mt_err *err)
{
    bool enough = false;
    *is = may_be_large(j, why);
    for (int count = FIRST_MODES; *is && !enough; count *= 2) {
        *is = count <= MOST_MODES;
        if (*is) {
            MT_TRY(try_large(j, count, is, &enough, why, err));
        } else {
            (void)mt_snprintf(why, WHY_SIZE,
                              "a response so far up needs more than its %d lowest modes",
                              count / 2);
        }
    }
    if (!*is) {
        return MT_OK;
    }
    MT_TRY(mt_response_admit(&j->r, err));
    return shake(j, err);
}

static mt_status open_either(job *j, mt_err *err)
{
    char why[WHY_SIZE] = "a response needs all modes";
    bool is = false;
    MT_TRY(open_large(j, &is, why, err));
    if (is) {
        return MT_OK;
    }
    mt_response_free(&j->r);
    mt_lowest_delete(j->l);
    j->l = NULL;
    return open_response(j, why, err);
}

static mt_status compute_response(job *j, mt_err *err)
{
    mt_status rc = open_either(j, err);
    rc = rc == MT_OK ? mt_response_curve(&j->r, &j->v.opt, &j->curve, err) : rc;
    rc = rc == MT_OK ? poles(j, err) : rc;
    rc = rc == MT_OK ? sensitivities(j, err) : rc;
    return mt_err_in(err, rc, "%s: configuration \"%s\"", j->s->path, j->v.configuration);
}

typedef struct sink {
    const mt_args *args;
    mt_vibration *profile; /* owned; NULL */
    mt_text *out;
    mt_json_writer w;
    mt_table table; /* CSV */
} sink;

static int show_configuration_response(sink *to, mt_loaded_model *s, int c)
{
    job j = {.args = to->args, .profile = to->profile, .s = s, .c = c};
    mt_err err = {.code = MT_OK};
    j.v = (response_view){.configuration = mt_loaded_model_configuration(s, c),
                          .s = s,
                          .r = &j.r,
                          .curve = &j.curve,
                          .direct = to->args->given[MT_OPT_DIRECT]};
    mt_loaded_model_warn_overridden(s, c);
    mt_status rc = compute_response(&j, &err);
    if (rc == MT_OK) {
        switch (to->args->format) {
        case MT_FORMAT_JSON:
            rc = response_json(&j.v, &j.r.mem, &to->w, &err);
            break;
        case MT_FORMAT_CSV:
            response_csv_rows(&j.v, &to->table);
            break;
        case MT_FORMAT_HTML:  /* of report alone */
        case MT_FORMAT_SARIF: /* of check alone */
        case MT_FORMAT_TEXT:
            response_print(&j.v, to->out);
            mt_loaded_model_note_links(s, c, to->out);
            break;
        }
    }
    if (rc != MT_OK && to->args->format == MT_FORMAT_JSON) {
        mt_cli_json_failed(&to->w, j.v.configuration, &err);
    }
    mt_response_free(&j.r);
    mt_analysis_delete(j.a);
    mt_lowest_delete(j.l);
    return rc == MT_OK ? MT_EXIT_DONE : mt_cli_failed(rc, &err);
}

/* Load the profile of --vibration; without one an input is required. */
static int load_response_profile(sink *to)
{
    const char *const name = to->args->value[MT_OPT_VIBRATION];
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    if (name != NULL) {
        const mt_status rc =
            mt_shipped_load_profile(to->args, name, &to->profile, &messages, &err);
        return mt_cli_loaded(rc, &messages, &err);
    }
    return to->args->all[MT_OPT_INPUT].n > 0
               ? MT_EXIT_DONE
               : mt_cli_failed(mt_fail(&err, MT_E_USAGE,
                                       "\"response\" needs --input, what shakes the "
                                       "mechanism, or --vibration, a profile"),
                               &err);
}

static int run_response(const mt_args *args, mt_text *out)
{
    mt_loaded_model s = {.model = NULL};
    sink to = {.args = args,
               .out = out,
               .w = mt_json_writer_default(out),
               .table = response_csv_table(args->given[MT_OPT_VIBRATION])};
    const bool json = args->format == MT_FORMAT_JSON;
    const bool list = json && !args->given[MT_OPT_CONFIGURATION];
    int code =
        mt_loaded_model_load(args, args->operands[0], args->value[MT_OPT_CONFIGURATION], &s);
    code = code == MT_EXIT_DONE ? load_response_profile(&to) : code;
    if (code != MT_EXIT_DONE) {
        goto done;
    }
    if (list) {
        mt_json_open(&to.w, NULL, '[');
    }
    for (int i = 0; i < s.n_configurations; i++) {
        code = mt_exit_worse(code, show_configuration_response(&to, &s, s.configurations[i]));
    }
    if (list) {
        mt_json_close(&to.w);
    }
    if (json) {
        code = mt_exit_worse(code, mt_cli_json_done(&to.w));
    }
    if (args->format == MT_FORMAT_CSV) {
        mt_table_csv(&to.table, out);
    }
done:
    mt_vibration_delete(to.profile);
    mt_table_free(&to.table);
    mt_loaded_model_free(&s);
    return code;
}

const mt_command mt_command_response = {
    .name = "response",
    .operands = "MODEL",
    .least = 1,
    .most = 1,
    .summary = "frequency response to forces and a moving ground",
    .details =
        "Prints the frequency response of each output to each input, about the equilibrium, "
        "with the model's damping: peaks and antiresonances first, then magnitude and phase "
        "over frequency. The phase is that of the output against the input, negative if the "
        "output lags. A resonance without damping has no height, which a note says.\n"
        "With --vibration it prints for each output the RMS of the response to the random "
        "parts of a profile, the largest amplitude under each tone, and the peak of both.\n"
        "A configuration that is unstable, has motions that grow, or whose stability rounding "
        "hides, is refused; so is the force of a joint that is redundant with others.",
    .answer = {&configuration_record, MT_ANSWER_CONFIGURATIONS},
    .run = run_response,
};
