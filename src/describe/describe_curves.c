/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Responses that the study asks for, of a design: from an analysis made anew there, all poles
 * and all modes in it. */
#include <complex.h>
#include <float.h>
#include <math.h>

#include "describe/describe.h"
#include "response/response.h"

static const double TWO_PI = 6.283185307179586477;
static const double HALF_TURN_DEG = 180.0;
/* Of a pole's size: what rounding may leave of a damping that is 0. */
static const double UNDAMPED_ULPS = 64.0;

/* Points that all curves have, of which the picture then takes what it needs. */
enum { GRID = 100, MOST = 400 };

/* Degrees in (-180, 180]; NaN of 0 and where there is no value. */
static double phase_deg(double complex h)
{
    const double size = cabs(h);
    return isfinite(size) && size > 0.0 ? carg(h) / (0.5 * TWO_PI) * HALF_TURN_DEG : nan("");
}

/* Does a motion grow by itself? Poles of negative frequency are mirror images of others. */
static bool is_unstable(const mt_response *r)
{
    bool grows = r->a->modes.n_unstable > 0;
    for (int k = 0; k < r->n_poles; k++) {
        const double complex s = r->poles[k];
        grows = grows || (cimag(s) >= 0.0 && creal(s) > UNDAMPED_ULPS * DBL_EPSILON * cabs(s));
    }
    return grows;
}

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
        .phase_deg = phase_deg(h),
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
        to->phase_deg[i] = phase_deg(c->h[kept[i]]);
        to->n_hz = to->n_magnitude = to->n_phase = i + 1;
    }
    for (int e = 0; e < c->n_extremes && rc == MT_OK; e++) {
        out->extremes[out->n_extremes++] = extreme_of(r, &c->extremes[e]);
    }
    mt_arena_free(&scratch);
    return rc;
}

static mt_status trace(mt_analysis *a, const mt_study_response *asked, mt_arena *mem,
                       mt_design_curve *out, mt_err *err)
{
    mt_response r = {.a = NULL};
    mt_curve curve;
    const mt_response_request request = {
        .n_in = 1, .inputs = &asked->input.s, .n_out = 1, .outputs = &asked->output.s};
    const mt_curve_options opt = {.from = TWO_PI * asked->lower_hz,
                                  .to = TWO_PI * asked->upper_hz,
                                  .points = GRID,
                                  .log = true};
    mt_status rc = mt_response_open(a, &request, &r, err);
    if (rc == MT_OK && is_unstable(&r)) {
        out->trouble = "a motion grows by itself here: there is no stationary response";
    } else if (rc == MT_OK) {
        rc = mt_response_curve(&r, &opt, &curve, err);
        rc = rc == MT_OK ? put_curve(&r, &curve, mem, out, err) : rc;
    }
    mt_response_free(&r);
    return rc;
}

/* Of the response at `x`; where there is none that is said. */
static mt_status describe(const mt_workspace *fresh, const mt_study_response *asked,
                          mt_arena *mem, mt_design_curve *out, mt_err *err)
{
    const mt_problem *const p = fresh->p;
    mt_analysis *a = NULL;
    mt_err why = {.code = MT_OK};
    mt_status rc = mt_analysis_new(p->study->model, asked->configuration, p->n, p->inputs,
                                   fresh->x, &a, &why);
    rc = rc == MT_OK ? trace(a, asked, mem, out, &why) : rc;
    mt_analysis_delete(a);
    MT_TRY(mt_pass_final(rc, &why, err));
    if (rc != MT_OK) {
        out->trouble = mt_arena_strdup(mem, why.text);
        out->n_extremes = 0;
        out->drawn = (mt_curve_points){.n_hz = 0};
    }
    return mt_arena_check(mem, err);
}

mt_status mt_describe_curves(const mt_workspace *fresh, mt_result *result,
                             mt_recommendation *rec, mt_err *err)
{
    const mt_study *const study = fresh->p->study;
    rec->curves = mt_arena_alloc(&result->mem, (size_t)result->n_curves, sizeof *rec->curves);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < result->n_curves; i++) {
        mt_design_curve *const out = &rec->curves[rec->n_curves++];
        *out = (mt_design_curve){.pointer = result->curves[i].pointer,
                                 .configuration = result->curves[i].configuration};
        MT_TRY(describe(fresh, &study->responses[i], &result->mem, out, err));
    }
    return MT_OK;
}

/* Ports in full, and what the numbers are in: of the original design, as everywhere. */
static mt_status put_ports(const mt_problem *p, const mt_study_response *asked, mt_arena *mem,
                           mt_result_curve *out, mt_err *err)
{
    mt_system *sys = NULL;
    mt_port in;
    mt_port to;
    mt_status rc = mt_system_new(p->study->model, asked->configuration, p->n, p->inputs,
                                 p->original, &sys, err);
    rc = rc == MT_OK ? mt_port_input(sys, asked->input.s, mem, &in, err) : rc;
    rc = rc == MT_OK ? mt_port_output(sys, asked->output.s, mem, &to, err) : rc;
    if (rc == MT_OK) {
        out->input = mt_arena_strdup(mem, in.name);
        out->output = mt_arena_strdup(mem, to.name);
        out->unit = mt_arena_printf(mem, "%s per %s", to.unit, in.unit);
        rc = mt_arena_check(mem, err);
    }
    mt_system_delete(sys);
    return rc;
}

mt_status mt_describe_asked_curves(const mt_problem *p, mt_result *result, mt_err *err)
{
    const mt_study *const study = p->study;
    if (study->examined) {
        return MT_OK; /* a point of a trade study */
    }
    result->curves =
        mt_arena_alloc(&result->mem, (size_t)study->n_responses, sizeof *result->curves);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < study->n_responses; i++) {
        const mt_study_response *const r = &study->responses[i];
        mt_result_curve *const out = &result->curves[i];
        *out = (mt_result_curve){.pointer = mt_arena_printf(&result->mem, "/responses/%d", i),
                                 .configuration =
                                     study->model->configurations[r->configuration].name.s,
                                 .lower_hz = r->lower_hz,
                                 .upper_hz = r->upper_hz,
                                 .description = r->description,
                                 .source = r->source};
        MT_TRY(put_ports(p, r, &result->mem, out, err));
        result->n_curves++;
    }
    return mt_arena_check(&result->mem, err);
}
