/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A response as text, JSON and CSV. */
#include <math.h>

#include "base/format.h"
#include "cli/response.h"

enum { DIGITS = 5, HZ_DIGITS = 7, HEADING_TEXT = 160 };

static const double TWO_PI = 6.283185307179586477;

/* NaN where there is no value. */
static double magnitude(double complex h)
{
    const double size = cabs(h);
    return isfinite(size) ? size : nan("");
}

const mt_port *mt_response_input_of(const mt_response_view *v, int pair)
{
    return &v->r->ports.in[pair / v->r->ports.n_out];
}

const mt_port *mt_response_output_of(const mt_response_view *v, int pair)
{
    return &v->r->ports.out[pair % v->r->ports.n_out];
}

static int pairs_of(const mt_response_view *v)
{
    return v->r->ports.n_in * v->r->ports.n_out;
}

static double complex value_at(const mt_response_view *v, int pair, int point)
{
    return v->curve->h[pair + ((ptrdiff_t)point * pairs_of(v))];
}

static double error_at(const mt_response_view *v, int pair, int point)
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

static void write_pair_unit(const mt_response_view *v, int pair, char unit[HEADING_TEXT])
{
    (void)mt_snprintf(unit, HEADING_TEXT, "%s per %s", mt_response_output_of(v, pair)->unit,
                      mt_response_input_of(v, pair)->unit);
}

static double percent_of(const mt_response_view *v, int e, int k)
{
    return v->percent[e + ((ptrdiff_t)k * v->curve->n_extremes)];
}

static const char *parameter_of(const mt_response_view *v, int k)
{
    return v->s->model->parameters[v->parameter[k]].name.s;
}

static void print_extremes(const mt_response_view *v, mt_text *out)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "input", "input", MT_ALIGN_LEFT);
    mt_table_column(&t, "output", "output", MT_ALIGN_LEFT);
    mt_table_column(&t, "kind", "kind", MT_ALIGN_LEFT);
    mt_table_column(&t, "frequency [Hz]", "frequency_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "magnitude", "magnitude", MT_ALIGN_POINT);
    mt_table_column(&t, "unit", "unit", MT_ALIGN_LEFT);
    mt_table_column(&t, "phase [deg]", "phase_deg", MT_ALIGN_POINT);
    for (int k = 0; k < v->n; k++) {
        char heading[HEADING_TEXT];
        (void)mt_snprintf(heading, sizeof heading, "by 1 %% of %s", parameter_of(v, k));
        mt_table_column(&t, heading, heading, MT_ALIGN_POINT);
    }
    for (int e = 0; e < v->curve->n_extremes; e++) {
        const mt_extreme *const x = &v->curve->extremes[e];
        char unit[HEADING_TEXT];
        write_pair_unit(v, x->pair, unit);
        mt_table_text(&t, mt_response_input_of(v, x->pair)->name);
        mt_table_text(&t, mt_response_output_of(v, x->pair)->name);
        mt_table_text(&t, extreme_kind_name(x));
        mt_table_number(&t, x->w / TWO_PI, HZ_DIGITS);
        mt_table_number(&t, magnitude(extreme_of(x)), DIGITS);
        mt_table_text(&t, unit);
        mt_table_number(&t, mt_phase_deg(extreme_of(x)), DIGITS);
        for (int k = 0; k < v->n; k++) {
            mt_table_change(&t, percent_of(v, e, k), DIGITS);
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
    for (int p = 0; p < pairs_of(v); p++) {
        char heading[HEADING_TEXT];
        char unit[HEADING_TEXT];
        write_pair_unit(v, p, unit);
        (void)mt_snprintf(heading, sizeof heading, "%s%s%s [%s]",
                          mt_response_output_of(v, p)->name, v->r->ports.n_in > 1 ? " by " : "",
                          v->r->ports.n_in > 1 ? mt_response_input_of(v, p)->name : "", unit);
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
static double mean_error(const mt_response_view *v)
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

static void print_method(const mt_response_view *v, mt_text *out)
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

void mt_response_print(const mt_response_view *v, mt_text *out)
{
    bool infinite = false;
    for (int e = 0; e < v->curve->n_extremes; e++) {
        infinite = infinite || v->curve->extremes[e].infinite;
    }
    mt_text_addf(out, "%s: response to %s%s, %.6g to %.6g Hz\n", v->configuration,
                 v->r->ports.in[0].name, v->r->ports.n_in > 1 ? ", ..." : "",
                 v->opt.from / TWO_PI, v->opt.to / TWO_PI);
    if (v->profiled != NULL) {
        mt_response_vibration_print(v, out);
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

static void json_ports(mt_json_writer *w, const char *member, int n, const mt_port *ports)
{
    mt_json_open(w, member, '[');
    for (int i = 0; i < n; i++) {
        mt_json_open_flat(w, NULL, '{');
        mt_json_put_string(w, "name", ports[i].name);
        mt_json_put_string(w, "unit", ports[i].unit);
        mt_json_close(w);
    }
    mt_json_close(w);
}

static void json_extreme(const mt_response_view *v, int e, mt_json_writer *w)
{
    const mt_extreme *const x = &v->curve->extremes[e];
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "kind", extreme_kind_name(x));
    mt_json_put_number(w, "frequency_hz", x->w / TWO_PI);
    mt_json_put_number(w, "magnitude", magnitude(extreme_of(x)));
    mt_json_put_number(w, "phase_deg", mt_phase_deg(extreme_of(x)));
    if (v->n > 0) {
        mt_json_open(w, "sensitivities", '[');
        for (int k = 0; k < v->n; k++) {
            mt_json_open_flat(w, NULL, '{');
            mt_json_put_string(w, "parameter", parameter_of(v, k));
            mt_json_put_number(w, "value", v->value[k]);
            mt_json_put_number(w, "magnitude_per_percent", percent_of(v, e, k));
            mt_json_close(w);
        }
        mt_json_close(w);
    }
    mt_json_close(w);
}

static void json_series(const mt_response_view *v, int pair, const char *member, int what,
                        mt_json_writer *w)
{
    mt_json_open_flat(w, member, '[');
    for (int i = 0; i < v->curve->n; i++) {
        const double complex h = value_at(v, pair, i);
        const bool has = isfinite(cabs(h));
        mt_json_put_number(w, NULL,
                           what == 2   ? error_at(v, pair, i)
                           : !has      ? nan("")
                           : what == 0 ? creal(h)
                                       : cimag(h));
    }
    mt_json_close(w);
}

static void json_complex(mt_json_writer *w, const char *re, const char *im, double complex z)
{
    mt_json_put_number(w, re, creal(z));
    mt_json_put_number(w, im, cimag(z));
}

/* Write the poles where requested. */
static void json_poles(const mt_response_view *v, int pair, mt_json_writer *w)
{
    if (v->no_sums != NULL) {
        mt_json_put_null(w, "poles");
        mt_json_put_string(w, "no_poles", v->no_sums);
    }
    if (v->sums == NULL) {
        return;
    }
    const mt_pole_sum *const sum = &v->sums[pair];
    mt_json_open(w, "poles", '[');
    for (int k = 0; k < sum->n; k++) {
        mt_json_open_flat(w, NULL, '{');
        json_complex(w, "re", "im", sum->s[k]);
        json_complex(w, "residue_re", "residue_im", sum->residue[k]);
        mt_json_close(w);
    }
    mt_json_close(w);
    mt_json_open(w, "polynomial", '[');
    for (int k = 0; k < 3; k++) {
        mt_json_open_flat(w, NULL, '{');
        json_complex(w, "re", "im", sum->d[k]);
        mt_json_close(w);
    }
    mt_json_close(w);
}

static void json_pair(const mt_response_view *v, int pair, mt_json_writer *w)
{
    char unit[HEADING_TEXT];
    write_pair_unit(v, pair, unit);
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "input", mt_response_input_of(v, pair)->name);
    mt_json_put_string(w, "output", mt_response_output_of(v, pair)->name);
    mt_json_put_string(w, "unit", unit);
    mt_json_open(w, "extremes", '[');
    for (int e = 0; e < v->curve->n_extremes; e++) {
        if (v->curve->extremes[e].pair == pair) {
            json_extreme(v, e, w);
        }
    }
    mt_json_close(w);
    json_poles(v, pair, w);
    json_series(v, pair, "re", 0, w);
    json_series(v, pair, "im", 1, w);
    json_series(v, pair, "error", 2, w);
    if (v->profiled != NULL) {
        mt_response_vibration_json_pair(v, pair, w);
    }
    mt_json_close(w);
}

void mt_response_json(const mt_response_view *v, mt_json_writer *w)
{
    const mt_basis *const b = &v->r->basis;
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "configuration", v->configuration);
    mt_json_put_string(w, "method", v->direct ? "direct" : "modes");
    const bool lowest = v->r->a == NULL;
    mt_json_put_integer(w, "modes", lowest ? v->r->modes->count : b->n_modes);
    mt_json_put_integer(w, "modes_left_out",
                        lowest ? v->r->modes->all - v->r->modes->count : b->n_left);
    if (lowest) {
        mt_json_put_integer(w, "shapes_of_others", v->r->shapes);
    }
    mt_json_put_bool(w, "coupled", !b->t.diagonal);
    mt_json_put_bool(w, "complete", v->curve->complete);
    if (v->profiled != NULL) {
        mt_response_vibration_json(v, w);
    }
    json_ports(w, "inputs", v->r->ports.n_in, v->r->ports.in);
    json_ports(w, "outputs", v->r->ports.n_out, v->r->ports.out);
    mt_json_open_flat(w, "frequencies_hz", '[');
    for (int i = 0; i < v->curve->n; i++) {
        mt_json_put_number(w, NULL, v->curve->w[i] / TWO_PI);
    }
    mt_json_close(w);
    mt_json_open(w, "responses", '[');
    for (int p = 0; p < pairs_of(v); p++) {
        json_pair(v, p, w);
    }
    mt_json_close(w);
    mt_json_close(w);
}

mt_table mt_response_csv_table(bool psd)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "configuration", "configuration", MT_ALIGN_LEFT);
    mt_table_column(&t, "input", "input", MT_ALIGN_LEFT);
    mt_table_column(&t, "output", "output", MT_ALIGN_LEFT);
    mt_table_column(&t, "frequency [Hz]", "frequency_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "re", "re", MT_ALIGN_POINT);
    mt_table_column(&t, "im", "im", MT_ALIGN_POINT);
    mt_table_column(&t, "magnitude", "magnitude", MT_ALIGN_POINT);
    mt_table_column(&t, "phase [deg]", "phase_deg", MT_ALIGN_POINT);
    mt_table_column(&t, "error", "error", MT_ALIGN_POINT);
    mt_table_column(&t, "unit", "unit", MT_ALIGN_LEFT);
    if (psd) {
        mt_response_vibration_columns(&t);
    }
    return t;
}

void mt_response_csv_rows(const mt_response_view *v, mt_table *t)
{
    for (int p = 0; p < pairs_of(v); p++) {
        char unit[HEADING_TEXT];
        write_pair_unit(v, p, unit);
        for (int i = 0; i < v->curve->n; i++) {
            const double complex h = value_at(v, p, i);
            const bool has = isfinite(cabs(h));
            mt_table_text(t, v->configuration);
            mt_table_text(t, mt_response_input_of(v, p)->name);
            mt_table_text(t, mt_response_output_of(v, p)->name);
            mt_table_number(t, v->curve->w[i] / TWO_PI, HZ_DIGITS);
            mt_table_number(t, has ? creal(h) : nan(""), DIGITS);
            mt_table_number(t, has ? cimag(h) : nan(""), DIGITS);
            mt_table_number(t, magnitude(h), DIGITS);
            mt_table_number(t, mt_phase_deg(h), DIGITS);
            mt_table_number(t, error_at(v, p, i), DIGITS);
            mt_table_text(t, unit);
            if (v->profiled != NULL) {
                mt_response_vibration_cells(v, p, i, t);
            }
        }
    }
}
