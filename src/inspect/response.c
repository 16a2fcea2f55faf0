/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How forces, a moving ground and a profile of vibration shake a configuration, as records. */
#include "inspect/response.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/analysis.h"
#include "base/format.h"
#include "result/write.h"

static const double TWO_PI = 6.283185307179586477;

/* A profile of vibration. */

double mt_vibrated_in_g(const mt_vibrated *v, double value)
{
    return v->is_acceleration ? value / MT_STANDARD_GRAVITY : nan("");
}

const char *mt_vibrated_unit(const mt_vibrated *v)
{
    return v->is_acceleration ? "m/s^2" : v->unit;
}

#define THIS mt_vibrated_tone
static const mt_field tone_fields[] = {
    MT_F_TEXT("tone", tone, "Its name."),
    MT_F_ENUM("end", end, mt_forced_end, mt_forced_end_names,
              "Why there is no finite number; \"finite\": there is one."),
    MT_F_NUMBER_OR_NULL("frequency_hz", frequency_hz,
                        "Where in its range the response is largest."),
    MT_F_NUMBER_OR_NULL("peak", peak, "Peak there, in the unit of the response."),
    MT_F_NUMBER_OR_NULL("excess_at_most", excess_at_most,
                        "Part of the peak by which it may be larger elsewhere in the range."),
    MT_F_FLAG("at_edge", at_edge, "It is largest at an end of the range."),
};
const mt_record mt_vibrated_tone_record =
    MT_F_RECORD_OF(tone_fields, "vibrated_tone", "The response to one tone.");
#undef THIS

#define THIS mt_combine_row
static const mt_field combine_fields[] = {
    MT_F_NUMBER("sigma", sigma, "Peak of the random parts, in their RMS."),
    MT_F_ENUM("tones", tones, mt_vibration_sum, mt_vibration_sum_names,
              "How the peaks of the tones add up."),
};
const mt_record mt_combine_record =
    MT_F_RECORD_OF(combine_fields, NULL, "How the peak follows from the parts.");
#undef THIS

mt_rule_row mt_rule_row_of(const mt_vibration *v)
{
    return (mt_rule_row){.combine = {.sigma = v->sigma, .tones = v->rule},
                         .marks = v->marks,
                         .n_marks = v->n_marks};
}

mt_status mt_vibrated_values_of(const mt_vibrated *v, mt_arena *mem, mt_vibrated_values *out,
                                mt_err *err)
{
    const mt_vibration_response *const r = v->response;
    *out = (mt_vibrated_values){
        .end = r->end,
        .unit = mt_vibrated_unit(v),
        .rms = r->rms,
        .rms_error_at_most = r->rms_bound,
        .sine = r->sine,
        .peak = r->peak,
        .in_g = v->is_acceleration,
        .rms_g = mt_vibrated_in_g(v, r->rms),
        .sine_g = mt_vibrated_in_g(v, r->sine),
        .peak_g = mt_vibrated_in_g(v, r->peak),
        .tones = mt_arena_alloc(mem, (size_t)r->n_tones, sizeof *out->tones),
    };
    for (int i = 0; i < r->n_tones && out->tones != NULL; i++) {
        const mt_sine_peak *const p = &r->tones[i];
        out->tones[out->n_tones++] = (mt_vibrated_tone){
            .tone = v->profile->tones[i].label,
            .end = p->end,
            .frequency_hz = p->omega / TWO_PI,
            .peak = mt_vibration_respond_tone(v->profile, r, i),
            .excess_at_most = p->excess,
            .at_edge = p->at_edge,
        };
    }
    return mt_arena_check(mem, err);
}

const char *mt_vibrated_axis(const mt_vibration *v)
{
    static const char *const names[] = {"x", "y", "z"};
    return v->axis == MT_ABSENT ? NULL : names[v->axis];
}

const char *mt_vibrated_name(const mt_vibration *v)
{
    return v->name == NULL ? v->path : v->name;
}

/* Records. */

double mt_response_magnitude(double complex h)
{
    const double size = cabs(h);
    return isfinite(size) ? size : nan("");
}

const mt_port *mt_response_view_input(const mt_response_view *v, int pair)
{
    return &v->response.ports.in[pair / v->response.ports.n_out];
}

const mt_port *mt_response_view_output(const mt_response_view *v, int pair)
{
    return &v->response.ports.out[pair % v->response.ports.n_out];
}

int mt_response_view_pairs(const mt_response_view *v)
{
    return v->response.ports.n_in * v->response.ports.n_out;
}

double complex mt_response_view_value(const mt_response_view *v, int pair, int point)
{
    return v->curve.h[pair + ((ptrdiff_t)point * mt_response_view_pairs(v))];
}

double mt_response_view_error(const mt_response_view *v, int pair, int point)
{
    const double error = v->curve.error[pair + ((ptrdiff_t)point * mt_response_view_pairs(v))];
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

void mt_response_view_unit(const mt_response_view *v, int pair, char unit[MT_RESPONSE_UNIT])
{
    (void)mt_snprintf(unit, MT_RESPONSE_UNIT, "%s per %s",
                      mt_response_view_output(v, pair)->unit,
                      mt_response_view_input(v, pair)->unit);
}

const char *mt_response_view_parameter(const mt_response_view *v, int k)
{
    return v->s->model->parameters[v->parameter[k]].name.s;
}

#define THIS mt_magnitude_slope_row
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

#define THIS mt_extreme_row
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
    MT_F_LIST("sensitivities", slopes, n_slopes, mt_magnitude_slope_row, magnitude_slope_record,
              "With --sensitivity: one of each parameter.", MT_F_WHEN(with_slopes),
              .flat = true),
};
const mt_record mt_extreme_record =
    MT_F_RECORD_OF(extreme_fields, "extreme", "A peak, or a minimum.");
#undef THIS

mt_extreme_row mt_extreme_row_of(const mt_response_view *v, int e, char unit[MT_RESPONSE_UNIT])
{
    const mt_extreme *const x = &v->curve.extremes[e];
    mt_response_view_unit(v, x->pair, unit);
    return (mt_extreme_row){
        .input = mt_response_view_input(v, x->pair)->name,
        .output = mt_response_view_output(v, x->pair)->name,
        .kind = extreme_kind_name(x),
        .hz = x->w / TWO_PI,
        .magnitude = mt_response_magnitude(extreme_of(x)),
        .unit = unit,
        .phase_deg = mt_phase_deg(extreme_of(x)),
    };
}

double mt_response_view_density(const mt_response_view *v, int pair, int point)
{
    const ptrdiff_t at = pair + ((ptrdiff_t)point * v->profiled.n_pairs);
    const double psd =
        mt_profiled_psd(&v->profiled, pair, v->curve.w[point] / TWO_PI, v->curve.h[at]);
    return isfinite(psd) ? psd : nan("");
}

void mt_response_view_density_unit(const mt_response_view *v, int pair,
                                   char unit[MT_RESPONSE_UNIT])
{
    (void)mt_snprintf(unit, MT_RESPONSE_UNIT, "(%s)^2/Hz",
                      mt_response_view_output(v, pair)->unit);
}

mt_vibrated mt_response_view_vibrated(const mt_response_view *v, int pair)
{
    const mt_port *const to = mt_response_view_output(v, pair);
    return (mt_vibrated){.profile = v->profiled.v,
                         .response = &v->profiled.answers[pair],
                         .is_acceleration =
                             to->kind == MT_PORT_SENSOR && to->motion == 2 && !to->turns,
                         .unit = to->unit};
}

int mt_response_view_mode(const mt_response_view *v, double complex pole)
{
    const mt_modes *const modes = v->response.modes;
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

#define THIS mt_port
static const mt_field port_fields[] = {
    MT_F_TEXT("name", name, "Its full name."),
    MT_F_TEXT("unit", unit, "Its unit."),
};
static const mt_record port_record = MT_F_RECORD_OF(port_fields, "port", "An input or output.");
#undef THIS

/* Frequencies at which it is compared, in equal ratios; the last one is `to`. */
enum { COMPARED = 200 };

#define THIS mt_matrix_row
static const mt_field matrix_fields[] = {
    MT_F_NUMBERS(NULL, value, n, "A row of the matrix, in SI.", MT_F_EVERY(step)),
};
static const mt_record matrix_record = MT_F_BARE_RECORD_OF(matrix_fields);
#undef THIS

#define THIS mt_state_space_row
static const mt_field state_space_fields[] = {
    MT_F_COUNT("modes", modes, 0, "Modes that are kept, rigid-body modes included."),
    MT_F_COUNT("residual_shapes", residual_shapes, 0,
               "Shapes for what the other modes do at rest, each with a frequency of its own."),
    MT_F_TEXTS("states", states, n_states,
               "Names of the states: amplitude [m sqrt(kg)] and rate of each mode and residual "
               "shape, amplitudes of directions without mass, integrals of inputs."),
    MT_F_LIST("inputs", inputs, n_inputs, mt_port, port_record,
              "Of the columns of B and D, one each, with its unit.", .flat = true),
    MT_F_LIST("outputs", outputs, n_outputs, mt_port, port_record,
              "Of the rows of C and D, one each, with its unit.", .flat = true),
    MT_F_LIST("A", a, n_states, mt_matrix_row, matrix_record,
              "Rows of A in x' = A x + B u, in SI."),
    MT_F_LIST("B", b, n_states, mt_matrix_row, matrix_record, "Rows of B, in SI."),
    MT_F_LIST("C", c, n_outputs, mt_matrix_row, matrix_record,
              "Rows of C in y = C x + D u, in SI."),
    MT_F_LIST("D", d, n_outputs, mt_matrix_row, matrix_record, "Rows of D, in SI."),
    MT_F_FLAG("viscous_for_loss_factors", viscous_for_loss_factors,
              "Loss factors stand as the viscous damping that takes as much energy from each "
              "mode at its own frequency; a loss factor itself has no state space."),
    MT_F_NUMBER("from_hz", from_hz, "Lowest frequency at which it was compared."),
    MT_F_NUMBER("to_hz", to_hz, "Highest frequency at which it was compared."),
    MT_F_COUNT("compared", compared, 0,
               "Number of these frequencies, in equal ratios; those at which an undamped mode "
               "resonates in all responses do not count."),
    MT_F_NUMBER(
        "largest_difference_percent", largest_difference_percent,
        "Largest difference there from the response of all modes, in percent of the response's "
        "magnitude, or of its median over these frequencies where that is more."),
};
const mt_record mt_state_space_record =
    MT_F_RECORD_OF(state_space_fields, "state_space",
                   "The mechanism between the ports as x' = A x + B u, y = C x + D u.");
#undef THIS

#define THIS mt_complex_row
static const mt_field complex_fields[] = {
    MT_F_NUMBER("re", re, "Real part, in the unit of the response times s^k for (i omega)^k."),
    MT_F_NUMBER("im", im, "Imaginary part, in the same unit."),
};
static const mt_record complex_record =
    MT_F_RECORD_OF(complex_fields, "coefficient", "A complex coefficient.");
#undef THIS

#define THIS mt_pole_row
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

#define THIS mt_vibration_row
static const mt_field vibration_fields[] = {
    MT_VIBRATED_FIELDS(vibrated),
    MT_F_COUNT("by_mode", by_mode, 0,
               "Vibration mode for which there is no finite number; 0: none is near.",
               MT_F_WHEN(with_mode)),
};
static const mt_record vibration_record =
    MT_F_RECORD_OF(vibration_fields, NULL, "What the profile does to the output.");
#undef THIS

#define THIS mt_response_row
static const mt_field response_fields[] = {
    MT_F_TEXT("input", input, "What shakes."),
    MT_F_TEXT("output", output, "What is seen."),
    MT_F_TEXT("unit", unit, "Unit of the response: that of the output per that of the input."),
    MT_F_LIST("extremes", extremes, n_extremes, mt_extreme_row, mt_extreme_record,
              "Peaks and minima within the range."),
    MT_F_LIST_OR_NULL(
        "poles", poles, n_poles, mt_pole_row, pole_record,
        "With --poles: the response is the sum of residue / (i omega - pole) over "
        "the poles and their conjugates, and of a polynomial; null: there is no "
        "such sum.",
        MT_F_WHEN(with_poles), .flat = true),
    MT_F_TEXT("no_poles", no_poles, "Why there is none.", MT_F_WHEN(with_no_poles)),
    MT_F_LIST("polynomial", polynomial, n_polynomial, mt_complex_row, complex_record,
              "Its coefficients of (i omega)^0, ^1 and ^2.", MT_F_WHEN(with_polynomial),
              .flat = true),
    MT_F_NUMBERS("re", re, n,
                 "Real part at each frequency, in the unit that `unit` names; null: infinite, "
                 "or not a number."),
    MT_F_NUMBERS("im", im, n, "Imaginary part at each frequency, in the same unit."),
    MT_F_NUMBERS("error", error, n, "Bound of the error at each frequency, in the same unit."),
    MT_F_RECORD("vibration", vibration, mt_vibration_row, vibration_record,
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

#define THIS mt_shaking_row
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

#define THIS mt_answered_response_row
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
    MT_F_RECORD("profile", profile, mt_shaking_row, profile_record,
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
        "responses", responses, n_responses, mt_response_row, response_record,
        "One of each input and output: all outputs of the first input, then of the next."),
    MT_F_RECORD(
        "state_space", space, mt_state_space_row, mt_state_space_record,
        "With --state-space: the mechanism between the ports as matrices, also what the "
        "file has.",
        MT_F_WHEN(with_space)),
};
const mt_record mt_answered_response_record =
    MT_F_RECORD_OF(configuration_fields, "configuration", "A configuration, answered.");
#undef THIS

static mt_complex_row complex_row_of(double complex z)
{
    return (mt_complex_row){.re = creal(z), .im = cimag(z)};
}

static double percent_of(const mt_response_view *v, int e, int k)
{
    return v->percent[e + ((ptrdiff_t)k * v->curve.n_extremes)];
}

/* An extreme with what the parameters do to it; a shortage is remembered by mem. */
static mt_extreme_row extreme_row_in(const mt_response_view *v, int e, const char *unit,
                                     mt_arena *mem)
{
    char own[MT_RESPONSE_UNIT];
    mt_extreme_row row = mt_extreme_row_of(v, e, own);
    row.unit = unit;
    row.with_slopes = v->n > 0;
    row.slopes = mt_arena_alloc(mem, (size_t)v->n, sizeof *row.slopes);
    for (; row.slopes != NULL && row.n_slopes < v->n; row.n_slopes++) {
        const int k = row.n_slopes;
        row.slopes[k] = (mt_magnitude_slope_row){.parameter = mt_response_view_parameter(v, k),
                                                 .value = v->value[k],
                                                 .per_percent = percent_of(v, e, k)};
    }
    return row;
}

static void fill_poles(const mt_response_view *v, int pair, mt_arena *mem, mt_response_row *out)
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
            (mt_pole_row){complex_row_of(sum->s[k]), complex_row_of(sum->residue[k])};
    }
    for (int k = 0; k < MT_COUNT(sum->d) && out->polynomial != NULL; k++) {
        out->polynomial[out->n_polynomial++] = complex_row_of(sum->d[k]);
    }
}

static void fill_curves(const mt_response_view *v, int pair, mt_response_row *out)
{
    for (int i = 0; i < v->curve.n; i++) {
        const double complex h = mt_response_view_value(v, pair, i);
        const bool has = isfinite(cabs(h));
        out->re[i] = has ? creal(h) : nan("");
        out->im[i] = has ? cimag(h) : nan("");
        out->error[i] = mt_response_view_error(v, pair, i);
        if (out->with_vibration) {
            out->psd[i] = mt_response_view_density(v, pair, i);
        }
    }
}

static mt_status fill_vibration(const mt_response_view *v, int pair, mt_arena *mem,
                                mt_response_row *out, mt_err *err)
{
    const mt_vibrated row = mt_response_view_vibrated(v, pair);
    const mt_vibration_response *const a = row.response;
    char unit[MT_RESPONSE_UNIT];
    mt_response_view_density_unit(v, pair, unit);
    out->psd_unit = mt_arena_strdup(mem, unit);
    out->vibration.with_mode = a->end != MT_FORCED_FINITE && a->pole >= 0;
    if (out->vibration.with_mode) {
        out->vibration.by_mode = mt_response_view_mode(v, v->profiled.poles[a->pole]);
    }
    return mt_vibrated_values_of(&row, mem, &out->vibration.vibrated, err);
}

static mt_status pair_row_of(const mt_response_view *v, int pair, mt_arena *mem,
                             mt_response_row *out, mt_err *err)
{
    const size_t n = (size_t)v->curve.n;
    char unit[MT_RESPONSE_UNIT];
    mt_response_view_unit(v, pair, unit);
    *out = (mt_response_row){
        .input = mt_response_view_input(v, pair)->name,
        .output = mt_response_view_output(v, pair)->name,
        .unit = mt_arena_strdup(mem, unit),
        .extremes = mt_arena_alloc(mem, (size_t)v->curve.n_extremes, sizeof *out->extremes),
        .re = mt_arena_f64(mem, n, 1),
        .im = mt_arena_f64(mem, n, 1),
        .error = mt_arena_f64(mem, n, 1),
        .psd = v->question->profile == NULL ? NULL : mt_arena_f64(mem, n, 1),
        .n = v->curve.n,
        .with_vibration = v->question->profile != NULL,
    };
    MT_TRY(mt_arena_check(mem, err));
    for (int e = 0; e < v->curve.n_extremes; e++) {
        if (v->curve.extremes[e].pair == pair) {
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

static mt_shaking_row profile_row_of(const mt_response_view *v)
{
    const mt_vibration *const p = v->profiled.v;
    return (mt_shaking_row){.file = p->path,
                            .name = p->name,
                            .axis = mt_vibrated_axis(p),
                            .rms_m_per_s2 = mt_vibration_rms(p),
                            .rule = mt_rule_row_of(p)};
}

static mt_status answered_row_of(const mt_response_view *v, mt_arena *mem,
                                 mt_answered_response_row *out, mt_err *err)
{
    const mt_basis *const b = &v->response.basis;
    const bool lowest = v->response.a == NULL;
    *out = (mt_answered_response_row){
        .configuration = v->configuration,
        .method = v->question->direct ? "direct" : "modes",
        .modes = lowest ? v->response.modes->count : b->n_modes,
        .modes_left_out =
            lowest ? v->response.modes->all - v->response.modes->count : b->n_left,
        .with_shapes = lowest,
        .shapes_of_others = v->response.shapes,
        .coupled = !b->t.diagonal,
        .complete = v->curve.complete,
        .with_profile = v->question->profile != NULL,
        .with_space = v->question->state_space,
        .space = v->space,
        .inputs = v->response.ports.in,
        .n_inputs = v->response.ports.n_in,
        .outputs = v->response.ports.out,
        .n_outputs = v->response.ports.n_out,
        .frequencies_hz = mt_arena_f64(mem, (size_t)v->curve.n, 1),
        .responses =
            mt_arena_alloc(mem, (size_t)mt_response_view_pairs(v), sizeof *out->responses),
    };
    MT_TRY(mt_arena_check(mem, err));
    if (out->with_profile) {
        out->profile = profile_row_of(v);
        out->vibration_method = v->profiled.no_sums == NULL ? "poles" : "quadrature";
    }
    for (; out->n_frequencies < v->curve.n; out->n_frequencies++) {
        out->frequencies_hz[out->n_frequencies] = v->curve.w[out->n_frequencies] / TWO_PI;
    }
    for (; out->n_responses < mt_response_view_pairs(v); out->n_responses++) {
        MT_TRY(pair_row_of(v, out->n_responses, mem, &out->responses[out->n_responses], err));
    }
    return MT_OK;
}

mt_status mt_response_put(mt_response_view *v, mt_json_writer *w, mt_err *err)
{
    mt_answered_response_row row;
    MT_TRY(answered_row_of(v, &v->response.mem, &row, err));
    mt_record_put_object(w, NULL, &mt_answered_response_record, &row, 0, NULL);
    return MT_OK;
}

/* Answering. */

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

static mt_response_request request_of(const mt_response_question *q)
{
    return (mt_response_request){.n_in = q->n_inputs,
                                 .inputs = q->inputs,
                                 .n_out = q->n_outputs,
                                 .outputs = q->outputs,
                                 .direct = q->direct,
                                 .modes = q->keep};
}

/* `part` of the frequency of vibration mode `index` [Hz]; NaN where there is none. */
static double by_mode(const mt_response_view *v, int index, double part)
{
    const int at = mt_modal_flexible(v->modes, index);
    return at < 0 ? nan("") : part * mt_modal_hz(v->modes, at);
}

/* An end of the range: of the text, or the default [Hz]. */
static mt_status range_end(mt_response_view *v, const char *name, const char *text, double hz,
                           double *w, mt_err *err)
{
    if (text != NULL) {
        MT_TRY(mt_loaded_model_number(v->s, name, NULL, text, strlen(text), &hz, err));
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

static mt_status choose_range(mt_response_view *v, mt_err *err)
{
    const int count = mt_modal_vibrations(v->modes);
    const int last = count < DEFAULT_MODES ? count : DEFAULT_MODES;
    mt_curve_options *const opt = &v->opt;
    *opt = (mt_curve_options){.points = v->question->points > 0 ? v->question->points
                                                                : DEFAULT_POINTS,
                              .log = v->question->log};
    double hz[2] = {by_mode(v, 1, BELOW_FIRST), by_mode(v, last, ABOVE_LAST)};
    if (v->question->profile != NULL) {
        mt_vibration_range(v->question->profile, true, true, hz);
        hz[1] = hz[1] > hz[0] ? hz[1] : ABOVE_LAST * hz[1]; /* one tone */
    }
    MT_TRY(range_end(v, "from", v->question->from, hz[0], &opt->from, err));
    MT_TRY(range_end(v, "to", v->question->to, hz[1], &opt->to, err));
    if (!(opt->to > opt->from)) {
        return mt_fail(err, MT_E_USAGE, "--to: %g Hz is not above --from, %g Hz",
                       opt->to / TWO_PI, opt->from / TWO_PI);
    }
    return opt->points < 2 ? mt_fail(err, MT_E_USAGE, "--points: a grid has at least 2 points")
                           : MT_OK;
}

/* Inputs of --set, and the parameter among them: its place in *slot. */
static mt_status inputs_with(const mt_response_view *v, int parameter, mt_arena *mem, int *n,
                             int **inputs, double **at, int *slot, mt_err *err)
{
    const size_t room = (size_t)v->s->n_inputs + 1;
    *inputs = mt_arena_int(mem, room);
    *at = mt_arena_f64(mem, room, 1);
    MT_TRY(mt_arena_check(mem, err));
    *n = v->s->n_inputs;
    *slot = *n;
    for (int i = 0; i < *n; i++) {
        (*inputs)[i] = v->s->inputs[i];
        (*at)[i] = v->s->at[i];
        *slot = (*inputs)[i] == parameter ? i : *slot;
    }
    if (*slot == *n) {
        (*inputs)[*n] = parameter;
        (*at)[*n] = v->s->values[parameter];
        (*n)++;
    }
    return MT_OK;
}

/* Derivatives of |H| at its extremes by an input, equal to those at fixed frequency:
 * to[n_extremes]. */
static mt_status slopes_with(mt_response_view *v, mt_analysis *a, mt_response *r, int slot,
                             double value, double *to, mt_err *err)
{
    MT_TRY(mt_response_open(a, &v->request, r, err));
    const ptrdiff_t pairs = (ptrdiff_t)r->ports.n_in * r->ports.n_out;
    double complex *const dh =
        mt_arena_alloc(&r->mem, (size_t)(pairs * a->sys->n_inputs), sizeof *dh);
    MT_TRY(mt_arena_check(&r->mem, err));
    for (int e = 0; e < v->curve.n_extremes; e++) {
        const mt_extreme *const x = &v->curve.extremes[e];
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

static mt_status sensitivity(mt_response_view *v, int parameter, double *value, double *to,
                             mt_err *err)
{
    mt_analysis *a = NULL;
    mt_response r = {.a = NULL};
    int n = 0;
    int slot = 0;
    int *inputs = NULL;
    double *at = NULL;
    MT_TRY(inputs_with(v, parameter, &v->response.mem, &n, &inputs, &at, &slot, err));
    mt_analysis_options opt = mt_analysis_options_default();
    opt.gradient = true;
    const mt_system_def def = mt_loaded_model_system(v->s, v->c, n, inputs, at);
    mt_status rc = mt_analysis_new_of(&def, 0, &a, err);
    rc = rc == MT_OK ? mt_analysis_solve(a, at, &opt, err) : rc;
    if (rc == MT_OK) {
        *value = mt_linear_value(a->lin, a->sys->parameters[parameter]);
        rc = slopes_with(v, a, &r, slot, *value, to, err);
    }
    mt_response_free(&r);
    mt_analysis_delete(a);
    return rc;
}

static mt_status sensitivities(mt_response_view *v, mt_err *err)
{
    const char *const list = v->question->parameters;
    int *parameter = NULL;
    if (list == NULL) {
        return MT_OK;
    }
    MT_TRY(mt_loaded_model_parameters(v->s, "sensitivity", list, &v->response.mem, &v->n,
                                      &parameter, err));
    const size_t n = (size_t)v->n;
    double *const value = mt_arena_f64(&v->response.mem, n, 1);
    double *const percent = mt_arena_f64(&v->response.mem, (size_t)v->curve.n_extremes, n);
    MT_TRY(mt_arena_check(&v->response.mem, err));
    for (int k = 0; k < v->n; k++) {
        MT_TRY(sensitivity(v, parameter[k], &value[k],
                           percent + ((ptrdiff_t)k * v->curve.n_extremes), err));
    }
    v->parameter = parameter;
    v->value = value;
    v->percent = percent;
    return MT_OK;
}

/* Find the sums of poles; that there is none is part of the answer. */
static mt_status poles(mt_response_view *v, mt_err *err)
{
    if (!v->question->poles) {
        return MT_OK;
    }
    mt_err own = {.code = MT_OK};
    const size_t pairs = (size_t)v->response.ports.n_in * (size_t)v->response.ports.n_out;
    mt_pole_sum *const sums = mt_arena_alloc(&v->response.mem, pairs, sizeof *sums);
    MT_TRY(mt_arena_check(&v->response.mem, err));
    const mt_status rc = mt_response_sums(&v->response, sums, &own);
    if (rc != MT_OK && rc != MT_E_SINGULAR) {
        return mt_fail(err, rc, "%s", own.text);
    }
    v->sums = rc == MT_OK ? sums : NULL;
    v->no_sums = rc == MT_OK ? NULL : mt_arena_strdup(&v->response.mem, own.text);
    return mt_arena_check(&v->response.mem, err);
}

/* The vibration under the profile, where one is given. */
static mt_status shake(mt_response_view *v, mt_err *err)
{
    if (v->question->profile != NULL) {
        MT_TRY(mt_profiled_find(&v->response, v->question->profile, &v->profiled, err));
    }
    return MT_OK;
}

static mt_status request_ports(mt_response_view *v, const mt_system *sys, mt_err *err)
{
    v->request = request_of(v->question);
    return v->question->profile == NULL
               ? MT_OK
               : mt_profiled_ports(v->question->profile, sys, &v->s->mem, &v->request, err);
}

static mt_status open_response(mt_response_view *v, const char *why, mt_err *err)
{
    MT_TRY(mt_loaded_model_admit_dense(v->s, v->c, why, err));
    MT_TRY(mt_loaded_model_analyse(v->s, v->c, 0, &v->a, err));
    v->modes = &v->a->modes;
    MT_TRY(request_ports(v, v->a->sys, err));
    MT_TRY(mt_response_open(v->a, &v->request, &v->response, err));
    MT_TRY(mt_response_admit(&v->response, err));
    MT_TRY(shake(v, err));
    return choose_range(v, err);
}

/* True where the lowest modes may suffice. */
static bool may_be_large(const mt_response_view *v, char *why)
{
    const mt_response_question *const q = v->question;
    const char *const whole = q->direct               ? "direct"
                              : q->poles              ? "poles"
                              : q->parameters != NULL ? "sensitivity"
                              : q->keep > 0           ? "modes"
                                                      : NULL;
    if (whole != NULL) {
        (void)mt_snprintf(why, WHY_SIZE, "--%s needs all modes", whole);
        return false;
    }
    return mt_lowest_bodies(v->s->model, v->c) >= MT_LOWEST_BODIES;
}

/* The response by the lowest `count` modes; *enough: true where they reach so far above the
 * range that the omitted ones are within little more than rounding. */
static mt_status try_large(mt_response_view *v, int count, bool *is, bool *enough, char *why,
                           mt_err *err)
{
    const mt_lowest_want want = {.count = count, .shapes = true};
    mt_err own = {.code = MT_OK};
    mt_lowest_delete(v->l);
    v->l = NULL;
    const mt_system_def def =
        mt_loaded_model_system(v->s, v->c, v->s->n_inputs, v->s->inputs, v->s->at);
    const mt_status rc = mt_lowest_new(&def, want, &v->l, &own);
    if (mt_is_final(rc) || rc == MT_E_INTERRUPTED) {
        return mt_fail(err, rc, "%s", own.text);
    }
    *is = rc == MT_OK && v->l->way != MT_LOWEST_NONE;
    *enough = true;
    if (rc != MT_OK) {
        (void)mt_snprintf(why, WHY_SIZE, "its lowest modes alone: %s", own.text);
        return MT_OK;
    }
    if (!*is) {
        (void)mt_snprintf(why, WHY_SIZE,
                          "the method for large trees does not apply, because %s", v->l->why);
        return MT_OK;
    }
    v->modes = &v->l->found.modes;
    MT_TRY(request_ports(v, v->l->sys, err));
    MT_TRY(choose_range(v, err));
    const bool ratio = v->l->sys->damping.ratio != MT_NO_NODE && 2 * count <= MOST_WITH_RATIO;
    const double above = (ratio ? ABOVE_WITH_RATIO : ABOVE_RANGE) * v->opt.to;
    *enough = v->l->found.tau >= above * above || v->l->found.below == v->modes->all;
    if (!*enough) {
        return MT_OK;
    }
    mt_response_free(&v->response);
    char what[MT_LARGE_WHY] = "";
    MT_TRY(mt_response_open_large(v->l, &v->request, v->opt.to, &v->response, is, what, err));
    if (!*is) {
        (void)mt_snprintf(why, WHY_SIZE, "a response by its lowest modes: %s", what);
    }
    return MT_OK;
}

/* *is false: all modes have to be found. */
static mt_status open_large(mt_response_view *v, bool *is, char *why, mt_err *err)
{
    bool enough = false;
    *is = may_be_large(v, why);
    for (int count = FIRST_MODES; *is && !enough; count *= 2) {
        *is = count <= MOST_MODES;
        if (*is) {
            MT_TRY(try_large(v, count, is, &enough, why, err));
        } else {
            (void)mt_snprintf(why, WHY_SIZE,
                              "a response so far up needs more than its %d lowest modes",
                              count / 2);
        }
    }
    if (!*is) {
        return MT_OK;
    }
    MT_TRY(mt_response_admit(&v->response, err));
    return shake(v, err);
}

static mt_status open_either(mt_response_view *v, mt_err *err)
{
    char why[WHY_SIZE] = "a response needs all modes";
    bool is = false;
    MT_TRY(open_large(v, &is, why, err));
    if (is) {
        return MT_OK;
    }
    mt_response_free(&v->response);
    mt_lowest_delete(v->l);
    v->l = NULL;
    return open_response(v, why, err);
}

static const char **state_names(const mt_response *r, const mt_state_space *s, mt_arena *mem)
{
    const char **const name = mt_arena_alloc(mem, (size_t)s->n, sizeof *name);
    const int massive = s->modes + s->residual;
    for (int i = 0; name != NULL && i < s->n; i++) {
        const int k = i < massive ? i : i - massive;
        const char *const rate = i < massive ? "" : " rate";
        if (i < 2 * massive && k < s->modes) {
            name[i] = mt_arena_printf(mem, "mode %d%s", k + 1, rate);
        } else if (i < 2 * massive) {
            name[i] = mt_arena_printf(mem, "residual %d%s", k - s->modes + 1, rate);
        } else if (i < (2 * massive) + s->massless) {
            name[i] = mt_arena_printf(mem, "massless %d", i - (2 * massive) + 1);
        } else {
            const int of = i - (2 * massive) - s->massless;
            name[i] = mt_arena_printf(
                mem, "%s of %s", s->integral_order[of] == 1 ? "integral" : "second integral",
                r->ports.in[s->integral_of[of]].name);
        }
    }
    return name;
}

/* The m rows of a matrix by columns, of which `of` is the first. */
static mt_matrix_row *matrix_rows(mt_matrix_row of, int m, mt_arena *mem)
{
    mt_matrix_row *const row = mt_arena_alloc(mem, (size_t)m, sizeof *row);
    for (int i = 0; row != NULL && i < m; i++) {
        row[i] = of;
        row[i].value += i;
    }
    return row;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Largest difference of one pair over the frequencies compared, in parts of the response. */
static double difference_of(int n, const double *size, const double *off, double *work)
{
    int kept = 0;
    for (int i = 0; i < n; i++) {
        if (isfinite(size[i])) {
            work[kept++] = size[i];
        }
    }
    double most = 0.0;
    if (kept > 0) {
        qsort(work, (size_t)kept, sizeof *work, by_size);
    }
    for (int i = 0; i < n && kept > 0; i++) {
        const double scale = fmax(size[i], work[kept / 2]);
        if (isfinite(size[i]) && scale > 0.0) {
            const double part = off[i] / scale;
            most = part <= most ? most : part; /* NaN stays */
        }
    }
    return most;
}

/* Against one factorisation of the matrices themselves at each frequency. */
static mt_status compare(mt_response *r, const mt_state_space *s, double from, double to,
                         mt_state_space_row *out, mt_err *err)
{
    const size_t pairs = (size_t)s->n_in * (size_t)s->n_out;
    const mt_arena_mark mark = mt_arena_get_mark(&r->mem);
    double complex *const want = mt_arena_alloc(&r->mem, pairs, sizeof *want);
    double complex *const have = mt_arena_alloc(&r->mem, pairs, sizeof *have);
    double *const size = mt_arena_f64(&r->mem, COMPARED, pairs);
    double *const off = mt_arena_f64(&r->mem, COMPARED, pairs);
    double *const work = mt_arena_f64(&r->mem, COMPARED, 1);
    MT_TRY(mt_arena_check(&r->mem, err));
    for (size_t i = 0; i < COMPARED; i++) {
        const double w = from * pow(to / from, (double)i / (COMPARED - 1));
        const mt_sample sample = {.h = want};
        MT_TRY(mt_transfer_at(&r->direct, w, &sample, &r->mem, err));
        MT_TRY(mt_state_space_at(s, w, have, &r->mem, err));
        bool any = false;
        for (size_t p = 0; p < pairs; p++) {
            const bool finite = isfinite(creal(want[p]));
            size[i + (p * COMPARED)] = finite ? cabs(want[p]) : HUGE_VAL;
            off[i + (p * COMPARED)] = cabs(want[p] - have[p]);
            any = any || finite;
        }
        out->compared += any ? 1 : 0;
    }
    out->largest_difference_percent = 0.0;
    for (size_t p = 0; p < pairs; p++) {
        const double part =
            difference_of(COMPARED, size + (p * COMPARED), off + (p * COMPARED), work);
        if (!(100.0 * part <= out->largest_difference_percent)) {
            out->largest_difference_percent = 100.0 * part;
        }
    }
    mt_arena_rewind(&r->mem, mark);
    return MT_OK;
}

/* The lowest `modes` modes (0: of those up to `to`), compared between `from` and `to` [rad/s]
 * with the responses of the matrices themselves; texts and lists are in r->mem. Fails: as
 * mt_response_state_space. */
static mt_status state_space_row_of(mt_response *r, int modes, double from, double to,
                                    mt_state_space_row *out, mt_err *err)
{
    mt_state_space s;
    MT_TRY(mt_response_state_space(r, modes, to, &s, err));
    *out = (mt_state_space_row){
        .modes = s.modes,
        .residual_shapes = s.residual,
        .states = state_names(r, &s, &r->mem),
        .n_states = s.n,
        .inputs = r->ports.in,
        .n_inputs = s.n_in,
        .outputs = r->ports.out,
        .n_outputs = s.n_out,
        .a = matrix_rows((mt_matrix_row){s.a, s.n, s.n}, s.n, &r->mem),
        .b = matrix_rows((mt_matrix_row){s.b, s.n_in, s.n}, s.n, &r->mem),
        .c = matrix_rows((mt_matrix_row){s.c, s.n, s.n_out}, s.n_out, &r->mem),
        .d = matrix_rows((mt_matrix_row){s.d, s.n_in, s.n_out}, s.n_out, &r->mem),
        .viscous_for_loss_factors = s.lossy,
        .from_hz = from / TWO_PI,
        .to_hz = to / TWO_PI};
    MT_TRY(mt_arena_check(&r->mem, err));
    return compare(r, &s, from, to, out, err);
}

static mt_status compute(mt_response_view *v, mt_err *err)
{
    mt_status rc = open_either(v, err);
    rc = rc == MT_OK ? mt_response_curve(&v->response, &v->opt, &v->curve, err) : rc;
    rc = rc == MT_OK ? poles(v, err) : rc;
    rc = rc == MT_OK ? sensitivities(v, err) : rc;
    if (rc == MT_OK && v->question->state_space) {
        rc = state_space_row_of(&v->response, v->question->keep, v->opt.from, v->opt.to,
                                &v->space, err);
    }
    return mt_err_in(err, rc, "%s: configuration \"%s\"", v->s->path, v->configuration);
}

mt_status mt_response_question_admit(const mt_response_question *q, mt_err *err)
{
    return q->n_inputs > 0 || q->profile != NULL
               ? MT_OK
               : mt_fail(err, MT_E_USAGE,
                         "\"response\" needs --input, what shakes the mechanism, or "
                         "--vibration, a profile");
}

mt_status mt_response_view_take(mt_loaded_model *s, int c, const mt_response_question *question,
                                mt_response_view *v, mt_err *err)
{
    v->question = question;
    v->configuration = mt_loaded_model_configuration(s, c);
    v->s = s;
    v->c = c;
    return compute(v, err);
}

void mt_response_view_free(mt_response_view *v)
{
    mt_response_free(&v->response);
    mt_analysis_delete(v->a);
    mt_lowest_delete(v->l);
}
