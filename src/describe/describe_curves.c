/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Responses of a design that its result shows: each from an analysis made anew there, with all
 * modes. */
#include <complex.h>
#include <math.h>
#include <string.h>

#include "describe/describe.h"
#include "problem/configuration.h"
#include "response/response.h"
#include "vibration/profile_response.h"

static const double TWO_PI = 6.283185307179586477;

/* Points that all curves have, of which the picture then takes what it needs. */
enum { GRID = 100, MOST = 400 };

/* The pole that is nearest to i w; NaN: there is none. */
static double complex nearest_pole(const mt_response *r, double w)
{
    double complex nearest = nan("");
    double least = HUGE_VAL;
    for (int k = 0; k < r->n_poles; k++) {
        const double complex s = r->poles[k];
        const double distance = hypot(creal(s), cimag(s) - w);
        if (cimag(s) > 0.0 && distance < least) {
            least = distance;
            nearest = s;
        }
    }
    return nearest;
}

static mt_result_extreme extreme_of(const mt_response *r, const mt_extreme *e)
{
    /* what rounding leaves of 0 is 0 */
    const double complex h = !e->infinite && cabs(e->h) > e->error ? e->h : 0.0;
    const double complex s = e->peak ? nearest_pole(r, e->w) : nan("");
    return (mt_result_extreme){
        .kind = e->infinite        ? "resonance"
                : e->peak          ? "peak"
                : e->antiresonance ? "antiresonance"
                                   : "minimum",
        .hz = e->w / TWO_PI,
        .magnitude = e->infinite ? nan("") : cabs(h),
        .phase_deg = mt_phase_deg(h),
        .natural_hz = cabs(s) / TWO_PI,
        .damping_ratio = -creal(s) / cabs(s),
    };
}

static mt_status put_curve(const mt_response *r, const mt_curve *c, mt_arena *mem,
                           mt_design_curve *out, mt_err *err)
{
    int n = 0;
    int *kept = NULL;
    mt_arena scratch;
    MT_TRY(mt_arena_init(&scratch, 0, err));
    mt_status rc = mt_curve_thin(c, 0, 1, MOST, &scratch, &n, &kept, err);
    mt_curve_points *const to = &out->drawn;
    to->hz = mt_arena_f64(mem, (size_t)n, 1);
    to->magnitude = mt_arena_f64(mem, (size_t)n, 1);
    to->phase_deg = mt_arena_f64(mem, (size_t)n, 1);
    out->extremes = mt_arena_alloc(mem, (size_t)c->n_extremes, sizeof *out->extremes);
    rc = rc == MT_OK ? mt_arena_check(mem, err) : rc;
    for (int i = 0; i < n && rc == MT_OK; i++) {
        to->hz[i] = c->w[kept[i]] / TWO_PI;
        to->magnitude[i] = cabs(c->h[kept[i]]);
        to->phase_deg[i] = mt_phase_deg(c->h[kept[i]]);
        to->n_hz = to->n_magnitude = to->n_phase = i + 1;
    }
    for (int e = 0; e < c->n_extremes && rc == MT_OK; e++) {
        out->extremes[out->n_extremes++] = extreme_of(r, &c->extremes[e]);
    }
    mt_arena_free(&scratch);
    return rc;
}

/* The response to the whole profile, proven where it is a sum over poles. */
static mt_status response_limit(mt_response *r, const mt_vibration *v, mt_arena *mem,
                                mt_design_curve *out, mt_err *err)
{
    mt_profiled all;
    MT_TRY(mt_profiled_find(r, v, &all, err));
    const mt_vibration_response found = all.answers[0];
    mt_result_forced_response *const to = mt_arena_alloc(mem, 1, sizeof *to);
    mt_result_forced_response_tone *const tones =
        mt_arena_alloc(mem, (size_t)v->n_tones, sizeof *tones);
    MT_TRY(mt_arena_check(mem, err));
    *to = (mt_result_forced_response){.end = mt_forced_end_name(found.end),
                                      .proven = all.no_sums == NULL,
                                      .rms = found.rms,
                                      .rms_error_at_most = found.rms_bound,
                                      .sine = found.sine,
                                      .peak = found.peak,
                                      .n_tones = v->n_tones,
                                      .tones = tones};
    for (int i = 0; i < v->n_tones; i++) {
        const mt_sine_peak *const t = &found.tones[i];
        tones[i] =
            (mt_result_forced_response_tone){.label = v->tones[i].label,
                                             .hz = t->omega / TWO_PI,
                                             .peak = mt_vibration_respond_tone(v, &found, i),
                                             .excess_at_most = t->excess,
                                             .at_edge = t->at_edge};
    }
    out->vibration = to;
    return MT_OK;
}

static const mt_vibration *profile_of(const mt_study *study, const mt_result_curve *asked)
{
    for (int i = 0; i < study->n_profiles && asked->profile != NULL; i++) {
        if (strcmp(study->profiles[i].name.s, asked->profile->file) == 0) {
            return study->profiles[i].profile;
        }
    }
    return NULL;
}

/* G |H|^2 at the points that are drawn. */
static mt_status put_psd(const mt_vibration *v, mt_arena *mem, mt_curve_points *to, mt_err *err)
{
    to->psd = mt_arena_f64(mem, (size_t)to->n_hz, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < to->n_hz && v->n_random > 0; i++) {
        const double level = mt_vibration_density(v, to->hz[i]);
        to->psd[to->n_psd++] =
            level > 0.0 ? level * to->magnitude[i] * to->magnitude[i] : nan("");
    }
    return MT_OK;
}

static mt_status trace(mt_analysis *a, const mt_result_curve *asked, const mt_vibration *v,
                       mt_arena *mem, mt_design_curve *out, mt_err *err)
{
    mt_response r = {.a = NULL};
    mt_curve curve;
    const mt_response_request request = {
        .n_in = 1, .inputs = &asked->input, .n_out = 1, .outputs = &asked->output};
    const mt_curve_options opt = {.from = TWO_PI * asked->lower_hz,
                                  .to = TWO_PI * asked->upper_hz,
                                  .points = GRID,
                                  .log = true};
    mt_status rc = mt_response_open(a, &request, &r, err);
    if (rc == MT_OK && r.growing >= 0) {
        out->trouble = "unstable: a motion grows by itself, so there is no steady response";
    } else if (rc == MT_OK) {
        rc = mt_response_curve(&r, &opt, &curve, err);
        rc = rc == MT_OK ? put_curve(&r, &curve, mem, out, err) : rc;
        rc = rc == MT_OK && v != NULL ? put_psd(v, mem, &out->drawn, err) : rc;
        rc = rc == MT_OK && v != NULL ? response_limit(&r, v, mem, out, err) : rc;
    }
    mt_response_free(&r);
    return rc;
}

/* Describe a curve, or the reason for none. */
static mt_status describe_curve(const mt_workspace *fresh, const mt_result_curve *asked,
                                mt_arena *mem, mt_design_curve *out, mt_err *err)
{
    const mt_problem *const p = fresh->p;
    const mt_model *const model = p->study->model;
    const int configuration = mt_model_find_configuration(model, asked->configuration);
    mt_analysis *a = NULL;
    mt_err why = {.code = MT_OK};
    const mt_system_def def = mt_problem_system(p, configuration, fresh->x);
    mt_status rc = mt_analysis_new_of(&def, 0, &a, &why);
    rc = rc == MT_OK ? trace(a, asked, profile_of(p->study, asked), mem, out, &why) : rc;
    mt_analysis_delete(a);
    MT_TRY(mt_pass_final(rc, &why, err));
    if (rc != MT_OK) {
        *out = (mt_design_curve){.trouble = mt_arena_strdup(mem, why.text)};
    }
    return mt_arena_check(mem, err);
}

mt_status mt_describe_curves(const mt_workspace *fresh, mt_result *result,
                             mt_recommendation *rec, mt_err *err)
{
    rec->curves = mt_arena_alloc(&result->mem, (size_t)result->n_curves, sizeof *rec->curves);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < result->n_curves; i++) {
        mt_design_curve *const out = &rec->curves[rec->n_curves++];
        *out = (mt_design_curve){.trouble = NULL};
        MT_TRY(describe_curve(fresh, &result->curves[i], &result->mem, out, err));
        out->pointer = result->curves[i].pointer;
        out->configuration = result->curves[i].configuration;
    }
    return MT_OK;
}
