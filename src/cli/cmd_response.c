/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune response: how forces and a moving ground shake a mechanism. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "cli/cli.h"
#include "cli/shipped.h"
#include "inspect/response.h"
#include "io/folder.h"
#include "report/table.h"
#include "result/write.h"

enum { DIGITS = 5 };

static const double TWO_PI = 6.283185307179586477;

/* What a profile of vibration does to the outputs of a response. */

/* Columns that identify the pair, before its values. */
static void pair_columns(const mt_response_view *v, mt_table *t)
{
    if (v->response.ports.n_in > 1) {
        mt_table_column(t, "input", "input", MT_ALIGN_LEFT);
    }
    mt_table_column(t, "output", "output", MT_ALIGN_LEFT);
}

static void pair_cells(const mt_response_view *v, int pair, mt_table *t)
{
    if (v->response.ports.n_in > 1) {
        mt_table_text(t, mt_response_view_input(v, pair)->name);
    }
    mt_table_text(t, mt_response_view_output(v, pair)->name);
}

static void print_rows(const mt_response_view *v, mt_text *out)
{
    mt_table t = mt_table_default();
    pair_columns(v, &t);
    mt_vibrated_columns(&t);
    for (int p = 0; p < v->profiled.n_pairs; p++) {
        const mt_vibrated row = mt_response_view_vibrated(v, p);
        pair_cells(v, p, &t);
        mt_vibrated_row(&t, &row);
    }
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_text_add(out, "\n");
    mt_table_free(&t);
}

static void print_tones(const mt_response_view *v, mt_text *out)
{
    mt_table t = mt_table_default();
    pair_columns(v, &t);
    mt_vibrated_tone_columns(&t);
    for (int p = 0; p < v->profiled.n_pairs; p++) {
        const mt_vibrated row = mt_response_view_vibrated(v, p);
        for (int i = 0; i < v->question->profile->n_tones; i++) {
            pair_cells(v, p, &t);
            mt_vibrated_tone_row(&t, &row, i);
        }
    }
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_text_add(out, v->profiled.no_sums == NULL
                         ? "  Each is the largest within its range, proven up to that part of "
                           "it.\n\n"
                         : "\n");
    mt_table_free(&t);
}

/* Print the reason for a pair without a value; *said: the pole named last, so that pairs with
 * the same pole are reported once. */
static void print_end(const mt_response_view *v, int pair, int *said, mt_text *out)
{
    const mt_vibration_response *const a = &v->profiled.answers[pair];
    if (a->end == MT_FORCED_FINITE || a->pole < 0 || a->pole == *said) {
        return;
    }
    const double complex pole = v->profiled.poles[a->pole];
    const int mode = mt_response_view_mode(v, pole);
    const char *const name =
        mode > 0 ? mt_mode_name(v->s, v->response.sys->configuration, mode) : NULL;
    *said = a->pole;
    mt_text_addf(out, "  Vibration mode %d%s%s%s, %.6g Hz, ", mode, name == NULL ? "" : " \"",
                 name == NULL ? "" : name, name == NULL ? "" : "\"", cabs(pole) / TWO_PI);
    mt_text_add(out, a->end == MT_FORCED_INFINITE
                         ? "has no damping, and the profile acts there: what it shakes is "
                           "infinite.\n"
                         : "grows by itself: there is no steady response.\n");
}

static void response_vibration_print(const mt_response_view *v, mt_text *out)
{
    const mt_vibration *const p = v->profiled.v;
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
    for (int k = 0; k < v->profiled.n_pairs; k++) {
        print_end(v, k, &said, out);
    }
    mt_text_add(out, said >= 0 ? "\n" : "");
    if (p->n_tones > 0) {
        print_tones(v, out);
    }
    if (v->profiled.no_sums != NULL) {
        mt_text_addf(out,
                     "  %s. The numbers are therefore by quadrature: errors are estimates, and "
                     "of tones nothing is proven.\n\n",
                     v->profiled.no_sums);
    }
    mt_vibrated_marks(p, out);
}

/* A response as text and CSV. */

enum { HZ_DIGITS = 7, HEADING_TEXT = 160 };

#define THIS mt_extreme_row
static const mt_record_column extreme_columns[] = {
    MT_R_COLUMN(input, "input", 0, MT_IN_TEXT),
    MT_R_COLUMN(output, "output", 0, MT_IN_TEXT),
    MT_R_COLUMN(kind, "kind", 0, MT_IN_TEXT),
    MT_R_COLUMN(hz, "frequency [Hz]", HZ_DIGITS, MT_IN_TEXT),
    MT_R_COLUMN(magnitude, "magnitude", DIGITS, MT_IN_TEXT),
    MT_R_COLUMN(unit, "unit", 0, MT_IN_TEXT),
    MT_R_COLUMN(phase_deg, "phase [deg]", DIGITS, MT_IN_TEXT),
};
static const mt_record_table extreme_rows = MT_R_TABLE_OF(mt_extreme_record, extreme_columns);
#undef THIS

static void print_extremes(const mt_response_view *v, mt_text *out)
{
    mt_table t = mt_table_default();
    mt_table_record_columns(&t, &extreme_rows, MT_IN_TEXT);
    for (int k = 0; k < v->n; k++) {
        char heading[HEADING_TEXT];
        (void)mt_snprintf(heading, sizeof heading, "by 1 %% of %s",
                          mt_response_view_parameter(v, k));
        mt_table_column(&t, heading, heading, MT_ALIGN_POINT);
    }
    for (int e = 0; e < v->curve.n_extremes; e++) {
        char unit[MT_RESPONSE_UNIT];
        const mt_extreme_row row = mt_extreme_row_of(v, e, unit);
        mt_table_record_row(&t, &extreme_rows, MT_IN_TEXT, &row);
        for (int k = 0; k < v->n; k++) {
            mt_table_change(&t, v->percent[e + ((ptrdiff_t)k * v->curve.n_extremes)], DIGITS);
        }
    }
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
}

/* Print the frequencies of the grid only; the other points are for drawings. */
static void print_grid(const mt_response_view *v, mt_text *out)
{
    mt_table t = mt_table_default();
    int at = 0;
    mt_table_column(&t, "frequency [Hz]", "frequency_hz", MT_ALIGN_POINT);
    for (int p = 0; p < mt_response_view_pairs(v); p++) {
        char heading[HEADING_TEXT];
        char unit[MT_RESPONSE_UNIT];
        mt_response_view_unit(v, p, unit);
        (void)mt_snprintf(
            heading, sizeof heading, "%s%s%s [%s]", mt_response_view_output(v, p)->name,
            v->response.ports.n_in > 1 ? " by " : "",
            v->response.ports.n_in > 1 ? mt_response_view_input(v, p)->name : "", unit);
        mt_table_column(&t, heading, heading, MT_ALIGN_POINT);
        mt_table_column(&t, "phase [deg]", "phase_deg", MT_ALIGN_POINT);
    }
    for (int i = 0; i < v->curve.n && at < v->opt.points; i++) {
        if (v->curve.w[i] < mt_curve_grid(&v->opt, at)) {
            continue;
        }
        at++;
        mt_table_number(&t, v->curve.w[i] / TWO_PI, HZ_DIGITS);
        for (int p = 0; p < mt_response_view_pairs(v); p++) {
            mt_table_number(&t, mt_response_magnitude(mt_response_view_value(v, p, i)), DIGITS);
            mt_table_number(&t, mt_phase_deg(mt_response_view_value(v, p, i)), DIGITS);
        }
    }
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
}

/* Geometric mean of the errors' parts of their values, up to the next power of 10. */
static double mean_error(const mt_response_view *v)
{
    double sum = 0.0;
    int n = 0;
    for (int p = 0; p < mt_response_view_pairs(v); p++) {
        for (int i = 0; i < v->curve.n; i++) {
            const double error = mt_response_view_error(v, p, i);
            const double value = mt_response_magnitude(mt_response_view_value(v, p, i));
            if (error > 0.0 && value > 0.0 && isfinite(error / value)) {
                sum += log(error) - log(value);
                n++;
            }
        }
    }
    return n > 0 ? pow(10.0, ceil(sum / n / log(10.0))) : 0.0;
}

static void print_method(const mt_response_view *v, mt_text *out)
{
    const mt_basis *const b = &v->response.basis;
    if (v->question->direct) {
        mt_text_add(out, "  Directly: a factor of the dynamic stiffness at every frequency.");
    } else if (v->response.a == NULL) {
        mt_text_addf(out, "  By the %d lowest of %d modes and %d shapes of the others%s.",
                     v->response.modes->count, v->response.modes->all, v->response.shapes,
                     b->t.diagonal ? "" : ", coupled by their damping");
    } else {
        mt_text_addf(out, "  By %d of %d modes%s.", b->n_modes, b->n_modes + b->n_left,
                     b->t.diagonal ? "" : ", coupled by their damping");
    }
    mt_text_addf(
        out, " %d frequencies, %d of them of the grid; %s below %.0e of a value on average.\n",
        v->curve.n, v->opt.points,
        v->response.a == NULL ? "rounding and what is left out are" : "rounding is",
        mean_error(v));
    if (!v->question->direct && b->n_left > 0) {
        mt_text_addf(out,
                     "  %d modes from %.5g Hz on follow statically: near and above that the "
                     "response is wrong.\n",
                     b->n_left, sqrt(fmax(b->lowest_left, 0.0)) / TWO_PI);
    }
    if (!v->curve.complete) {
        mt_text_add(out, "  Not all peaks are shown as fine as asked for: that takes too many "
                         "frequencies.\n");
    }
}

static void print_poles(const mt_response_view *v, mt_text *out)
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

/* The state space. */

static void print_state_space(const mt_state_space_row *s, mt_text *out)
{
    mt_text_addf(out, "\n  State space: %d states of %d mode%s", s->n_states, s->modes,
                 s->modes == 1 ? "" : "s");
    if (s->residual_shapes > 0) {
        mt_text_addf(out, " and %d residual shape%s, for what the other modes do at rest",
                     s->residual_shapes, s->residual_shapes == 1 ? "" : "s");
    }
    mt_text_add(out, ".\n");
    if (s->compared > 0) {
        mt_text_addf(out,
                     "  It differs from the response of all modes by at most %.2g %% at %d "
                     "frequencies from %.6g to %.6g Hz\n  (in percent of the magnitude, or of "
                     "its median where that is more).\n",
                     s->largest_difference_percent, s->compared, s->from_hz, s->to_hz);
    }
    if (s->viscous_for_loss_factors) {
        mt_text_add(out,
                    "  Loss factors stand as the viscous damping that takes as much energy "
                    "from each mode at its own frequency.\n");
    }
}

/* A, B above C, D, with the names of states and ports. */
static void state_space_csv(const mt_state_space_row *s, mt_text *out)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "row", "row", MT_ALIGN_LEFT);
    for (int i = 0; i < s->n_states + s->n_inputs; i++) {
        const char *const name =
            i < s->n_states ? s->states[i] : s->inputs[i - s->n_states].name;
        mt_table_column(&t, name, name, MT_ALIGN_RIGHT);
    }
    for (int i = 0; i < s->n_states + s->n_outputs; i++) {
        const bool state = i < s->n_states;
        const mt_matrix_row *const left = state ? &s->a[i] : &s->c[i - s->n_states];
        const mt_matrix_row *const right = state ? &s->b[i] : &s->d[i - s->n_states];
        mt_table_text(&t, state ? s->states[i] : s->outputs[i - s->n_states].name);
        for (ptrdiff_t k = 0; k < left->n; k++) {
            mt_table_number(&t, left->value[k * left->step], 17);
        }
        for (ptrdiff_t k = 0; k < right->n; k++) {
            mt_table_number(&t, right->value[k * right->step], 17);
        }
    }
    mt_table_csv(&t, out);
    mt_table_free(&t);
}

/* Dense, by columns (Boisvert, Pozo and Remington, NISTIR 5935, 1996). */
static void matrix_market(const mt_matrix_row *rows, int m, int n, mt_text *out)
{
    char number[MT_JSON_NUMBER_SIZE];
    mt_text_addf(out, "%%%%MatrixMarket matrix array real general\n%d %d\n", m, n);
    for (ptrdiff_t j = 0; j < n; j++) {
        for (int i = 0; i < m; i++) {
            mt_text_addf(out, "%s\n",
                         mt_json_format_number(rows[i].value[j * rows[i].step], number));
        }
    }
}

static bool ends_with(const char *text, const char *end)
{
    const size_t n = strlen(text);
    const size_t m = strlen(end);
    return n > m && strcmp(text + n - m, end) == 0;
}

enum { MOST_FILES = 4 };

/* The texts of the file, or files, by the ending of its name. Returns how many. */
static int state_space_texts(const mt_state_space_row *s, const char *path,
                             mt_text text[MOST_FILES])
{
    const struct {
        const mt_matrix_row *rows;
        int m;
        int n;
    } matrix[MOST_FILES] = {{s->a, s->n_states, s->n_states},
                            {s->b, s->n_states, s->n_inputs},
                            {s->c, s->n_outputs, s->n_states},
                            {s->d, s->n_outputs, s->n_inputs}};
    if (ends_with(path, ".json")) {
        mt_json_writer w = mt_json_writer_default(text);
        mt_record_put_object(&w, NULL, &mt_state_space_record, s, 0, NULL);
        text->failed = !mt_json_done(&w) || text->failed;
        return 1;
    }
    if (ends_with(path, ".csv")) {
        state_space_csv(s, text);
        return 1;
    }
    for (int i = 0; i < MOST_FILES; i++) {
        matrix_market(matrix[i].rows, matrix[i].m, matrix[i].n, &text[i]);
    }
    return MOST_FILES;
}

/* A state space is of one configuration, in one of three forms. */
static mt_status admit_state_space(const mt_args *args, const mt_loaded_model *s, mt_err *err)
{
    const char *const path = args->value[MT_OPT_STATE_SPACE];
    if (path == NULL) {
        return MT_OK;
    }
    if (s->n_configurations != 1) {
        return mt_fail(
            err, MT_E_USAGE,
            "--state-space: it is of one configuration, and the model has %d: choose "
            "one by -c",
            s->n_configurations);
    }
    if (strlen(mt_text_base_name(path)) + 2 >= MT_FOLDER_NAME) {
        return mt_fail(err, MT_E_USAGE, "--state-space: the name \"%s\" is too long",
                       mt_text_base_name(path));
    }
    return ends_with(path, ".json") || ends_with(path, ".csv") || ends_with(path, ".mtx")
               ? MT_OK
               : mt_fail(err, MT_E_USAGE,
                         "--state-space: the name of the file ends with .json, .csv or .mtx, "
                         "which says its form");
}

/* Writes the file, or files, all or none. */
static mt_status save_state_space(const mt_response_view *v, const mt_args *args, mt_err *err)
{
    const char *const path = args->value[MT_OPT_STATE_SPACE];
    const char *const name = mt_text_base_name(path);
    const int stem = (int)strlen(name) - (int)strlen(".mtx");
    mt_text text[MOST_FILES] = {{.s = NULL}};
    char names[MOST_FILES][MT_FOLDER_NAME];
    mt_folder_file files[MOST_FILES];
    char *const folder = mt_file_folder(path);
    const int n = state_space_texts(&v->space, path, text);
    bool failed = folder == NULL;
    for (int i = 0; i < n; i++) {
        failed = failed || text[i].failed;
        if (n == 1) {
            (void)mt_snprintf(names[i], sizeof names[i], "%s", name);
        } else {
            (void)mt_snprintf(names[i], sizeof names[i], "%.*s_%c.mtx", stem, name, 'A' + i);
        }
        files[i] = (mt_folder_file){names[i], text[i].s, text[i].length};
    }
    const mt_status rc =
        failed ? mt_fail_memory(err) : mt_folder_replace(folder, files, n, err);
    if (rc == MT_OK) {
        mt_terminal_talk(args->given[MT_OPT_QUIET], "%s: state space written to %s%s",
                         v->configuration, path, n == 1 ? "" : " (_A, _B, _C, _D)");
    }
    for (int i = 0; i < MOST_FILES; i++) {
        mt_text_free(&text[i]);
    }
    free(folder);
    return rc;
}

static void response_print(const mt_response_view *v, mt_text *out)
{
    bool infinite = false;
    for (int e = 0; e < v->curve.n_extremes; e++) {
        infinite = infinite || v->curve.extremes[e].infinite;
    }
    mt_text_addf(out, "%s: response to %s%s, %.6g to %.6g Hz\n", v->configuration,
                 v->response.ports.in[0].name, v->response.ports.n_in > 1 ? ", ..." : "",
                 v->opt.from / TWO_PI, v->opt.to / TWO_PI);
    if (v->question->profile != NULL) {
        response_vibration_print(v, out);
    }
    if (v->curve.n_extremes > 0) {
        print_extremes(v, out);
        mt_text_add(out, "\n");
    }
    if (v->question->profile == NULL) {
        print_grid(v, out);
    }
    print_poles(v, out);
    print_method(v, out);
    if (v->question->state_space) {
        print_state_space(&v->space, out);
    }
    if (infinite) {
        mt_text_add(out,
                    "  Resonances that nothing damps have no magnitude: it is infinite.\n");
    }
    mt_text_add(out, "\n");
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
    double psd;
    const char *psd_unit;
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
    MT_F_NUMBER_OR_NULL("psd", psd, "Density of the output."),
    MT_F_TEXT_OR_NULL("psd_unit", psd_unit, "Unit of the density."),
};
static const mt_record point_record = MT_F_RECORD_OF(point_fields, NULL, NULL);
enum { IN_PSD = MT_IN_OWN }; /* with --vibration */
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
    MT_R_COLUMN(psd, "psd", DIGITS, IN_PSD),
    MT_R_COLUMN(psd_unit, "psd unit", 0, IN_PSD),
};
static const mt_record_table point_rows = MT_R_TABLE_OF(point_record, point_columns);
#undef THIS

static unsigned point_places(bool psd)
{
    return MT_IN_CSV | (psd ? (unsigned)IN_PSD : 0U);
}

static mt_table response_csv_table(bool psd)
{
    mt_table t = mt_table_default();
    mt_table_record_columns(&t, &point_rows, point_places(psd));
    return t;
}

static void response_csv_rows(const mt_response_view *v, mt_table *t)
{
    const bool psd = v->question->profile != NULL;
    for (int p = 0; p < mt_response_view_pairs(v); p++) {
        char unit[MT_RESPONSE_UNIT];
        char psd_unit[MT_RESPONSE_UNIT];
        mt_response_view_unit(v, p, unit);
        mt_response_view_density_unit(v, p, psd_unit);
        for (int i = 0; i < v->curve.n; i++) {
            const double complex h = mt_response_view_value(v, p, i);
            const bool has = isfinite(cabs(h));
            const point_row row = {
                .configuration = v->configuration,
                .input = mt_response_view_input(v, p)->name,
                .output = mt_response_view_output(v, p)->name,
                .hz = v->curve.w[i] / TWO_PI,
                .re = has ? creal(h) : nan(""),
                .im = has ? cimag(h) : nan(""),
                .magnitude = mt_response_magnitude(h),
                .phase_deg = mt_phase_deg(h),
                .error = mt_response_view_error(v, p, i),
                .unit = unit,
                .psd = psd ? mt_response_view_density(v, p, i) : nan(""),
                .psd_unit = psd_unit,
            };
            mt_table_record_row(t, &point_rows, point_places(psd), &row);
        }
    }
}

typedef struct sink {
    const mt_args *args;
    mt_response_question question;
    mt_vibration *profile; /* owned; NULL */
    mt_text *out;
    mt_json_writer w;
    mt_table table; /* CSV */
} sink;

static mt_status show_configuration_response(void *context, mt_loaded_model *s, int c,
                                             mt_cli_shown *shown, mt_err *err)
{
    (void)shown;
    sink *const to = context;
    mt_response_view v = {.question = NULL};
    mt_status rc = mt_response_view_take(s, c, &to->question, &v, err);
    if (rc == MT_OK) {
        switch (to->args->format) {
        case MT_FORMAT_JSON:
            rc = mt_response_put(&v, &to->w, err);
            break;
        case MT_FORMAT_CSV:
            response_csv_rows(&v, &to->table);
            break;
        case MT_FORMAT_HTML:  /* of report alone */
        case MT_FORMAT_SARIF: /* of check alone */
        case MT_FORMAT_TEXT:
            response_print(&v, to->out);
            mt_loaded_model_note_links(s, c, to->out);
            break;
        }
    }
    if (rc == MT_OK && v.question->state_space) {
        rc = save_state_space(&v, to->args, err);
    }
    mt_response_view_free(&v);
    return rc;
}

static mt_response_question question_of(const mt_args *args)
{
    return (mt_response_question){.n_inputs = args->all[MT_OPT_INPUT].n,
                                  .inputs = args->all[MT_OPT_INPUT].value,
                                  .n_outputs = args->all[MT_OPT_MEASURE].n,
                                  .outputs = args->all[MT_OPT_MEASURE].value,
                                  .from = args->value[MT_OPT_FROM],
                                  .to = args->value[MT_OPT_TO],
                                  .points = args->points,
                                  .log = args->given[MT_OPT_LOG],
                                  .keep = args->keep,
                                  .direct = args->given[MT_OPT_DIRECT],
                                  .poles = args->given[MT_OPT_POLES],
                                  .state_space = args->given[MT_OPT_STATE_SPACE],
                                  .parameters = args->value[MT_OPT_SENSITIVITY]};
}

/* Load the profile of --vibration; without one an input is required. */
static int load_response_profile(sink *to)
{
    const char *const name = to->args->value[MT_OPT_VIBRATION];
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    mt_status rc = MT_OK;
    if (name != NULL) {
        rc = mt_shipped_load_profile(to->args, name, &to->profile, &messages, &err);
        to->question.profile = to->profile;
        return mt_cli_loaded(rc, &messages, &err);
    }
    rc = mt_response_question_admit(&to->question, &err);
    return rc == MT_OK ? MT_EXIT_DONE : mt_cli_failed(rc, &err);
}

static int run_response(const mt_args *args, mt_text *out)
{
    mt_loaded_model s = {.model = NULL};
    sink to = {.args = args,
               .question = question_of(args),
               .out = out,
               .w = mt_json_writer_default(out),
               .table = response_csv_table(args->given[MT_OPT_VIBRATION])};
    int code =
        mt_loaded_model_load(args, args->operands[0], args->value[MT_OPT_CONFIGURATION], &s);
    code = code == MT_EXIT_DONE ? load_response_profile(&to) : code;
    if (code == MT_EXIT_DONE) {
        mt_err err = {.code = MT_OK};
        const mt_status rc = admit_state_space(args, &s, &err);
        code = rc == MT_OK ? code : mt_cli_failed(rc, &err);
    }
    if (code != MT_EXIT_DONE) {
        goto done;
    }
    code = mt_cli_each(args, &s, &to.w, show_configuration_response, &to);
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
    .answer = {&mt_answered_response_record, MT_ANSWER_CONFIGURATIONS},
    .run = run_response,
};
