/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a profile of vibration does to the outputs of a response, in words and numbers. */
#include <math.h>

#include "base/format.h"
#include "cli/response.h"
#include "cli/vibrated.h"

enum { DIGITS = 5, UNIT_TEXT = 64 };

static const double TWO_PI = 6.283185307179586477;

static mt_vibrated row_of(const mt_response_view *v, int pair)
{
    const mt_port *const to = mt_response_output_of(v, pair);
    return (mt_vibrated){.profile = v->profiled->v,
                         .response = &v->profiled->answers[pair],
                         .is_acceleration =
                             to->kind == MT_PORT_SENSOR && to->motion == 2 && !to->turns,
                         .unit = to->unit};
}

/* Columns that identify the pair, before its values. */
static void pair_columns(const mt_response_view *v, mt_table *t)
{
    if (v->r->ports.n_in > 1) {
        mt_table_column(t, "input", "input", MT_ALIGN_LEFT);
    }
    mt_table_column(t, "output", "output", MT_ALIGN_LEFT);
}

static void pair_cells(const mt_response_view *v, int pair, mt_table *t)
{
    if (v->r->ports.n_in > 1) {
        mt_table_text(t, mt_response_input_of(v, pair)->name);
    }
    mt_table_text(t, mt_response_output_of(v, pair)->name);
}

static void print_rows(const mt_response_view *v, mt_text *out)
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

static void print_tones(const mt_response_view *v, mt_text *out)
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
static int mode_of(const mt_response_view *v, double complex pole)
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
static void print_end(const mt_response_view *v, int pair, int *said, mt_text *out)
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

void mt_response_vibration_print(const mt_response_view *v, mt_text *out)
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

void mt_response_vibration_json(const mt_response_view *v, mt_json_writer *w)
{
    const mt_vibration *const p = v->profiled->v;
    mt_json_open(w, "profile", '{');
    mt_json_put_string(w, "file", p->path);
    mt_json_put_string(w, "name", p->name);
    mt_json_put_string(w, "axis", mt_vibrated_axis(p));
    mt_json_put_number(w, "rms_m_per_s2", mt_vibration_rms(p));
    mt_vibrated_rule_json(w, p);
    mt_json_close(w);
    mt_json_put_string(w, "vibration_method",
                       v->profiled->no_sums == NULL ? "poles" : "quadrature");
}

/* The density at a frequency, or NaN where it is infinite. */
static double density_at(const mt_response_view *v, int pair, int point)
{
    const ptrdiff_t at = pair + ((ptrdiff_t)point * v->profiled->n_pairs);
    const double psd =
        mt_profiled_psd(v->profiled, pair, v->curve->w[point] / TWO_PI, v->curve->h[at]);
    return isfinite(psd) ? psd : nan("");
}

static void density_unit(const mt_response_view *v, int pair, char unit[UNIT_TEXT])
{
    (void)mt_snprintf(unit, UNIT_TEXT, "(%s)^2/Hz", mt_response_output_of(v, pair)->unit);
}

void mt_response_vibration_json_pair(const mt_response_view *v, int pair, mt_json_writer *w)
{
    const mt_vibrated row = row_of(v, pair);
    const mt_vibration_response *const a = row.response;
    char unit[UNIT_TEXT];
    density_unit(v, pair, unit);
    mt_json_open(w, "vibration", '{');
    mt_vibrated_json(w, &row);
    if (a->end != MT_FORCED_FINITE && a->pole >= 0) {
        mt_json_put_integer(w, "by_mode", mode_of(v, v->profiled->poles[a->pole]));
    }
    mt_json_close(w);
    mt_json_put_string(w, "psd_unit", unit);
    mt_json_open_flat(w, "psd", '[');
    for (int i = 0; i < v->curve->n; i++) {
        mt_json_put_number(w, NULL, density_at(v, pair, i));
    }
    mt_json_close(w);
}

void mt_response_vibration_columns(mt_table *t)
{
    mt_table_column(t, "psd", "psd", MT_ALIGN_POINT);
    mt_table_column(t, "psd unit", "psd_unit", MT_ALIGN_LEFT);
}

void mt_response_vibration_cells(const mt_response_view *v, int pair, int point, mt_table *t)
{
    char unit[UNIT_TEXT];
    density_unit(v, pair, unit);
    mt_table_number(t, density_at(v, pair, point), DIGITS);
    mt_table_text(t, unit);
}
