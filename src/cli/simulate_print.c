/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A motion as text, JSON and CSV. */
#include <math.h>

#include "base/format.h"
#include "cli/simulate.h"
#include "report/table.h"

enum { DIGITS = 6, HEADING = 300 };
/* Lines of a table on paper; of more, evenly spaced ones are printed. */
enum { LINES_MOST = 41 };
/* The mean periods of a gauge are told where they differ by less than this part. */
static const double REGULAR = 0.05;
/* A steady amplitude is told where the sum of harmonics leaves less than this of it. */
static const double STEADY = 0.05;
/* Harmonics below this part of the first are left out on paper. */
static const double WEAK = 1e-4;
enum { TONES_SHOWN = 4 };

/* Value of an output at a sample. */
static double seen(const mt_sim_view *v, int output, int sample)
{
    const mt_sim_output *const o = &v->request->outputs[output];
    const double *const of[] = {v->r->value, v->r->speed, v->r->acceleration};
    return of[o->what][o->gauge + ((ptrdiff_t)sample * v->r->n_gauges)];
}

static const char *motion_output_unit(const mt_sim_output *o)
{
    static const char *const units[2][3] = {{"m", "m/s", "m/s^2"}, {"rad", "rad/s", "rad/s^2"}};
    return units[o->angle ? 1 : 0][o->what];
}

/* "grip.x_m_per_s2" */
static void member_of(const mt_sim_view *v, const mt_sim_output *o, char text[HEADING])
{
    static const char *const units[2][3] = {{"m", "m_per_s", "m_per_s2"},
                                            {"rad", "rad_per_s", "rad_per_s2"}};
    (void)mt_snprintf(text, HEADING, "%s_%s", v->readings[o->gauge].name,
                      units[o->angle ? 1 : 0][o->what]);
}

static void make_motion_columns(const mt_sim_view *v, bool csv, mt_table *t)
{
    char heading[HEADING];
    char member[HEADING];
    mt_table_column(t, "time [s]", "time_s", MT_ALIGN_POINT);
    for (int k = 0; k < v->request->n_outputs; k++) {
        const mt_sim_output *const o = &v->request->outputs[k];
        (void)mt_snprintf(heading, sizeof heading, "%s [%s]", o->port, motion_output_unit(o));
        member_of(v, o, member);
        mt_table_column(t, heading, member, MT_ALIGN_POINT);
    }
    if (csv) {
        mt_table_column(t, "kinetic energy", "kinetic_j", MT_ALIGN_POINT);
        mt_table_column(t, "potential energy", "potential_j", MT_ALIGN_POINT);
        mt_table_column(t, "work", "work_j", MT_ALIGN_POINT);
    }
}

static void row(const mt_sim_view *v, int i, bool csv, mt_table *t)
{
    mt_table_number(t, v->r->t[i], DIGITS);
    for (int k = 0; k < v->request->n_outputs; k++) {
        mt_table_number(t, seen(v, k, i), DIGITS);
    }
    if (csv) {
        mt_table_number(t, v->r->kinetic[i], DIGITS);
        mt_table_number(t, v->r->potential[i], DIGITS);
        mt_table_number(t, v->r->work[i], DIGITS);
    }
}

void mt_simulate_csv(const mt_sim_view *v, mt_text *out)
{
    mt_table t = mt_table_default();
    make_motion_columns(v, true, &t);
    for (int i = 0; i < v->r->n; i++) {
        row(v, i, true, &t);
    }
    mt_table_csv(&t, out);
    mt_table_free(&t);
}

static void write_ring(const mt_sim_reading *g, mt_text *out)
{
    const char *const unit = g->angle ? "rad" : "m";
    if (g->ring.periods > 0 && g->ring.spread < REGULAR) {
        mt_text_addf(out,
                     "  %s turns with %.9g Hz (%d period%s, alike to %.1e), first swing %.6g "
                     "%s either way",
                     g->name, g->ring.hz, g->ring.periods, g->ring.periods == 1 ? "" : "s",
                     g->ring.spread, g->ring.amplitude, unit);
        if (isfinite(g->ring.damping)) {
            mt_text_addf(out, ", damping ratio %.3g", g->ring.damping);
        }
        mt_text_add(out, ".\n");
    }
    if (g->tones.n > 0) {
        mt_text_addf(out, "  Tones of %s (%.1e of it left over):", g->name, g->tones.residual);
        for (int k = 0; k < g->tones.n && k < TONES_SHOWN; k++) {
            const mt_tone *const tone = &g->tones.tone[k];
            mt_text_addf(out, "%s %.9g Hz with %.4g %s, damping ratio %.3g", k == 0 ? "" : ";",
                         tone->hz, tone->amplitude, unit, tone->damping);
        }
        mt_text_add(out, ".\n");
    }
}

static void write_steady(const mt_sim_view *v, const mt_sim_reading *g, mt_text *out)
{
    if (g->steady.periods == 0 || !(g->steady.residual < STEADY)) {
        return;
    }
    mt_text_addf(out, "  %s in the last %d period%s (%.1e of it left over):", g->name,
                 g->steady.periods, g->steady.periods == 1 ? "" : "s", g->steady.residual);
    for (int h = 0; h < MT_HARMONICS; h++) {
        if (h == 0 || g->steady.amplitude[h] > WEAK * g->steady.amplitude[0]) {
            mt_text_addf(out, "%s %.6g %s at %.6g Hz, phase %.4g rad", h == 0 ? "" : ";",
                         g->steady.amplitude[h], g->angle ? "rad" : "m",
                         (h + 1) * v->request->steady_hz, g->steady.phase[h]);
        }
    }
    mt_text_add(out, ".\n");
}

/* How the motion was found, and how well. */
static void write_method(const mt_sim_view *v, mt_text *out)
{
    const mt_sim_result *const r = v->r;
    switch (r->method) {
    case MT_SIM_INTEGRATED:
    case MT_SIM_METHODS:
        if (r->stiff_steps > 0) {
            mt_text_addf(
                out,
                "  Stiff springs: in %ld steps their fast vibrations are solved beforehand.\n",
                r->stiff_steps);
        }
        mt_text_addf(out,
                     "  %ld steps (%ld more rejected), %ld evaluations, tolerance %.1e.\n\n",
                     r->steps, r->rejected, r->evaluations, v->request->opt.tolerance);
        return;
    case MT_SIM_EXACT:
        mt_text_addf(
            out, "  Exact: the equations are linear%s; %ld steps by the matrix exponential.\n",
            v->free ? " and nothing pushes" : ", the inputs are sines and polynomials of time",
            r->steps);
        break;
    case MT_SIM_FITTED:
        mt_text_addf(out,
                     "  The equations are linear: %ld steps by the matrix exponential, with "
                     "inputs as polynomials\n  in each of them, which miss at most %.1e of "
                     "their largest value.\n",
                     r->steps, r->fit.input_error);
        break;
    }
    mt_text_addf(
        out,
        "  Put into the whole equations of motion at %d samples it leaves at most %.1e "
        "of their largest force.\n\n",
        r->fit.checks, r->fit.residual);
}

void mt_simulate_print(const mt_sim_view *v, mt_text *out)
{
    const mt_sim_result *const r = v->r;
    mt_table t = mt_table_default();
    const int every = ((r->n - 1) / (LINES_MOST - 1)) + ((r->n - 1) % (LINES_MOST - 1) != 0);
    make_motion_columns(v, false, &t);
    for (int i = 0; i < r->n; i++) {
        if (every == 0 || i % every == 0 || i + 1 == r->n) {
            row(v, i, false, &t);
        }
    }
    mt_text_addf(out, "%s\n", v->configuration);
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
    for (int g = 0; g < r->n_gauges; g++) {
        if (v->free) {
            write_ring(&v->readings[g], out);
        }
        write_steady(v, &v->readings[g], out);
    }
    if (v->request->forced_response.v != NULL) {
        mt_sim_forced_response_print(&v->request->forced_response, out);
    }
    mt_text_addf(out, "  Energy: up to %.4g J, balanced to %.1e J.\n", r->energy_scale_j,
                 r->energy_error_j);
    if (v->sys->n_constraints > 0) {
        mt_text_addf(out, "  Joints: at most %.1e m of drift in a step, %.1e m left of it.\n",
                     r->gap_m, r->left_m);
    }
    write_method(v, out);
}

static void json_list(mt_json_writer *w, const char *name, int n, const double *x)
{
    mt_json_open_flat(w, name, '[');
    for (int i = 0; i < n; i++) {
        mt_json_put_number(w, NULL, x[i]);
    }
    mt_json_close(w);
}

static void json_outputs(const mt_sim_view *v, mt_json_writer *w)
{
    mt_json_open(w, "outputs", '[');
    for (int k = 0; k < v->request->n_outputs; k++) {
        const mt_sim_output *const o = &v->request->outputs[k];
        mt_json_open(w, NULL, '{');
        mt_json_put_string(w, "port", o->port);
        mt_json_put_string(w, "unit", motion_output_unit(o));
        mt_json_open_flat(w, "values", '[');
        for (int i = 0; i < v->r->n; i++) {
            mt_json_put_number(w, NULL, seen(v, k, i));
        }
        mt_json_close(w);
        mt_json_close(w);
    }
    mt_json_close(w);
}

static void json_free(const mt_sim_reading *g, mt_json_writer *w)
{
    mt_json_open(w, "turnings", '{');
    mt_json_put_integer(w, "periods", g->ring.periods);
    mt_json_put_number(w, "frequency_hz", g->ring.hz);
    mt_json_put_number(w, "spread", g->ring.spread);
    mt_json_put_number(w, "amplitude", g->ring.amplitude);
    mt_json_put_number(w, "damping_ratio", g->ring.damping);
    mt_json_close(w);
    mt_json_open(w, "tones", '[');
    for (int k = 0; k < g->tones.n; k++) {
        mt_json_open_flat(w, NULL, '{');
        mt_json_put_number(w, "frequency_hz", g->tones.tone[k].hz);
        mt_json_put_number(w, "damping_ratio", g->tones.tone[k].damping);
        mt_json_put_number(w, "amplitude", g->tones.tone[k].amplitude);
        mt_json_put_number(w, "phase_rad", g->tones.tone[k].phase);
        mt_json_close(w);
    }
    mt_json_close(w);
    mt_json_put_number(w, "tones_residual", g->tones.residual);
}

static void json_steady(const mt_sim_view *v, const mt_sim_reading *g, mt_json_writer *w)
{
    mt_json_open(w, "steady", '{');
    mt_json_put_integer(w, "periods", g->steady.periods);
    mt_json_put_number(w, "frequency_hz", v->request->steady_hz);
    mt_json_put_number(w, "mean", g->steady.mean);
    json_list(w, "amplitudes", MT_HARMONICS, g->steady.amplitude);
    json_list(w, "phases_rad", MT_HARMONICS, g->steady.phase);
    mt_json_put_number(w, "residual", g->steady.residual);
    mt_json_close(w);
}

static void json_readings(const mt_sim_view *v, mt_json_writer *w)
{
    mt_json_open(w, "readings", '[');
    for (int i = 0; i < v->r->n_gauges; i++) {
        const mt_sim_reading *const g = &v->readings[i];
        mt_json_open(w, NULL, '{');
        mt_json_put_string(w, "port", g->name);
        mt_json_put_string(w, "unit", g->angle ? "rad" : "m");
        if (v->free) {
            json_free(g, w);
        }
        if (v->request->steady_hz > 0.0) {
            json_steady(v, g, w);
        }
        mt_json_close(w);
    }
    mt_json_close(w);
}

void mt_simulate_json(const mt_sim_view *v, mt_json_writer *w)
{
    const mt_sim_result *const r = v->r;
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "configuration", v->configuration);
    mt_json_put_bool(w, "complete", r->stop == MT_SIM_DONE);
    mt_json_put_string(w, "method", mt_sim_method_name(r->method));
    mt_json_put_number(w, "tolerance", v->request->opt.tolerance);
    if (v->request->forced_response.v != NULL) {
        mt_sim_forced_response_json(&v->request->forced_response, w);
    }
    json_list(w, "time_s", r->n, r->t);
    json_outputs(v, w);
    json_list(w, "kinetic_j", r->n, r->kinetic);
    json_list(w, "potential_j", r->n, r->potential);
    json_list(w, "work_j", r->n, r->work);
    mt_json_put_number(w, "energy_scale_j", r->energy_scale_j);
    mt_json_put_number(w, "energy_error_j", r->energy_error_j);
    mt_json_put_number(w, "joint_drift_m", r->gap_m);
    mt_json_put_number(w, "joint_gap_m", r->left_m);
    mt_json_put_integer(w, "steps", r->steps);
    mt_json_put_integer(w, "stiff_steps", r->stiff_steps);
    mt_json_put_integer(w, "rejected_steps", r->rejected);
    mt_json_put_integer(w, "evaluations", r->evaluations);
    if (r->method != MT_SIM_INTEGRATED) {
        mt_json_put_number(w, "equations_residual", r->fit.residual);
        mt_json_put_number(w, "input_error", r->fit.input_error);
    }
    json_readings(v, w);
    mt_json_close(w);
}
