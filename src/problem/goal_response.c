/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * "response": q = |H| at a frequency, or the largest over a band. Where two peaks are equal, as
 * at the best tuning of an absorber, that largest one has a kink. So a band is held by several
 * rows: it is divided at
 *     b_i = sqrt(w_i w_(i+1)),   w_i the undamped natural frequencies in their order,
 * and each part has its own largest value, which is smooth while its peak stays within. Where
 * it lies on an end that moves,
 *     d q = d|H| + d|H|/dw b_i d ln b_i,   d ln b_i = (d ln w_i + d ln w_(i+1)) / 2.
 * A part that the band has not gives the value at the band's end.
 */
#include <math.h>

#include "problem/configuration.h"
#include "problem/forced_response.h"
#include "problem/frequency.h"
#include "problem/goals.h"

/* Modes that parts are made of: those of the original design within the band, and so many
 * beside it that may come in; what lies beyond shares the outermost parts. */
enum { BESIDE = 3, MOST_PARTS = 24 };

static const double TWO_PI = 6.283185307179586476925;

static double lower_of(const mt_requirement *d)
{
    return TWO_PI * d->goal->response_limit->lower_hz;
}

static double upper_of(const mt_requirement *d)
{
    return TWO_PI * d->goal->response_limit->upper_hz;
}

/* Vibration modes below a frequency at the original design. */
static int below(const mt_modes *modes, double hz)
{
    int n = 0;
    for (int i = 0; i < modes->count; i++) {
        n += modes->kind[i] == MT_MODE_FLEXIBLE && mt_modal_hz(modes, i) < hz ? 1 : 0;
    }
    return n;
}

static mt_status compile_response(mt_problem *p, mt_requirement *d, mt_err *err)
{
    MT_TRY(mt_forced_response_compile(p, d, err));
    if (d->goal->response_limit->lower_hz == d->goal->response_limit->upper_hz) {
        return MT_OK;
    }
    const mt_configuration_problem *const view = &p->views[d->view];
    const mt_modes *const modes = &view->original->modes;
    const int most = mt_configuration_vibrations(view);
    const int first = below(modes, d->goal->response_limit->lower_hz) - BESIDE;
    const int last = below(modes, d->goal->response_limit->upper_hz) + BESIDE + 1;
    d->first_mode = first > 1 ? first : 1;
    const int end = last < most ? last : most;
    const int parts = end - d->first_mode + 1;
    d->n_parts = parts < 1 ? 1 : parts > MOST_PARTS ? MOST_PARTS : parts;
    return MT_OK;
}

/* Angular frequency of a vibration mode; of one at infinity infinite. */
static double omega_of(const mt_analysis *a, int index, int *pos)
{
    *pos = mt_modal_flexible(&a->modes, index);
    return *pos < 0 ? HUGE_VAL : TWO_PI * mt_modal_hz(&a->modes, *pos);
}

/* Between modes i and i + 1. */
static double between(const mt_analysis *a, int i)
{
    int pos = -1;
    const double under = omega_of(a, i, &pos);
    const double over = omega_of(a, i + 1, &pos);
    return sqrt(under) * sqrt(over);
}

/* slope += by b d ln b of the end above mode i. */
static mt_status add_end(mt_workspace *w, mt_analysis *a, int i, double by, double *slope,
                         mt_err *err)
{
    const double moved = 0.5 * by * between(a, i);
    for (int k = 0; k < 2; k++) {
        int pos = -1;
        (void)omega_of(a, i + k, &pos);
        MT_TRY(mt_problem_dln_frequency(w, a, pos, 0.0, w->dshape, err));
        mt_axpy(w->p->n, moved, w->dshape, slope);
    }
    return MT_OK;
}

/* The number that the peak is, and its slope; end: the mode below the end that it lies on; 0:
 * it lies on none. */
static mt_status evaluate_peak(mt_workspace *w, const mt_requirement *d,
                               const mt_forced_response_peak *peak, int end, double *q,
                               double *slope, mt_err *err)
{
    double omega = peak->at.omega;
    double complex weight = peak->at.direction;
    const mt_spectral_nodes one = {.n = 1, .omega = &omega, .weight = &weight};
    *q = peak->at.value;
    if (slope == NULL) {
        return MT_OK;
    }
    MT_TRY(mt_forced_response_slope(w, d, &one, 1.0, slope, err));
    if (end > 0) {
        MT_TRY(add_end(w, w->views[d->view].analysis, end, peak->by_omega, slope, err));
    }
    mt_forced_response_to_ln(w, d, *q, slope);
    return MT_OK;
}

static double within(const mt_requirement *d, double omega)
{
    return fmin(fmax(omega, lower_of(d)), upper_of(d));
}

static mt_status part(mt_workspace *w, const mt_requirement *d, int k, double *q, double *slope,
                      mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    const int under = k > 0 ? d->first_mode + k - 1 : 0; /* the modes below its ends */
    const int over = k + 1 < d->n_parts ? d->first_mode + k : 0;
    const double from = under > 0 ? within(d, between(a, under)) : lower_of(d);
    const double to = over > 0 ? within(d, between(a, over)) : upper_of(d);
    mt_forced_response_peak peak;
    if (!mt_modal_indexed(&a->modes)) {
        return mt_fail(err, MT_E_DOMAIN, "configuration \"%s\" is unstable",
                       mt_analysis_configuration(a));
    }
    MT_TRY(mt_forced_response_find(w, d, from, to, &peak, err));
    if (peak.at.end != MT_FORCED_FINITE) {
        *q = HUGE_VAL;
        return mt_forced_response_lead(w, d, from, to, slope, err);
    }
    const bool inside = peak.at.omega > lower_of(d) && peak.at.omega < upper_of(d);
    const int end = !inside                 ? 0
                    : peak.at.omega == from ? under
                    : peak.at.omega == to   ? over
                                            : 0;
    return evaluate_peak(w, d, &peak, end, q, slope, err);
}

static mt_status evaluate_response(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                                   double *slope, mt_err *err)
{
    mt_forced_response_peak peak;
    (void)pos;
    MT_TRY(mt_forced_response_find(w, d, lower_of(d), upper_of(d), &peak, err));
    if (peak.at.end != MT_FORCED_FINITE) {
        *q = HUGE_VAL;
        return mt_forced_response_lead(w, d, lower_of(d), upper_of(d), slope, err);
    }
    return evaluate_peak(w, d, &peak, 0, q, slope, err);
}

static mt_status find_response_peak(mt_workspace *w, const mt_requirement *d,
                                    mt_forced_response_value *out, mt_err *err)
{
    mt_forced_response_peak peak;
    MT_TRY(mt_forced_response_find(w, d, lower_of(d), upper_of(d), &peak, err));
    out->end = peak.at.end;
    out->proven = peak.proven;
    out->lower_hz = d->goal->response_limit->lower_hz;
    out->upper_hz = d->goal->response_limit->upper_hz;
    if (out->end == MT_FORCED_FINITE) {
        out->value = peak.at.value;
        out->error = peak.at.value * peak.at.excess;
        out->omega = peak.at.omega;
        out->at_edge = peak.at.at_edge;
    }
    return MT_OK;
}

static const char *response_subject(const mt_requirement *d, const char *what, mt_arena *mem)
{
    const mt_response_limit *const s = d->goal->response_limit;
    return s->lower_hz == s->upper_hz
               ? mt_arena_printf(mem, "%s: response of %s to %s at %.10g Hz", what, s->output.s,
                                 s->input.s, s->lower_hz)
               : mt_arena_printf(mem, "%s: response of %s to %s from %.10g to %.10g Hz", what,
                                 s->output.s, s->input.s, s->lower_hz, s->upper_hz);
}

const mt_goal_ops mt_goal_response = {.quantity = MT_QUANTITY_OTHER,
                                      .needs_vectors = true,
                                      .compile = compile_response,
                                      .value = evaluate_response,
                                      .part = part,
                                      .look = find_response_peak,
                                      .subject = response_subject,
                                      .equals = "at"};

/*
 * "vibration": q = what a profile does to a response: the RMS of its random parts, the peaks of
 * its tones, each the largest over its range and together by the profile's rule, or both:
 * q = by_rms RMS + by_sine tones.
 */
static double by_rms(const mt_response_limit *s)
{
    return s->quantity == MT_RESPONSE_LIMIT_RMS    ? 1.0
           : s->quantity == MT_RESPONSE_LIMIT_PEAK ? s->profile->sigma
                                                   : 0.0;
}

static double by_sine(const mt_response_limit *s)
{
    return s->quantity == MT_RESPONSE_LIMIT_RMS ? 0.0 : 1.0;
}

static double limited_quantity(const mt_response_limit *s, const mt_vibration_response *r)
{
    return s->quantity == MT_RESPONSE_LIMIT_RMS    ? r->rms
           : s->quantity == MT_RESPONSE_LIMIT_SINE ? r->sine
                                                   : r->peak;
}

/* Frequency range of the parts of the profile that count [Hz]. */
static void range_of(const mt_response_limit *s, double hz[2])
{
    mt_vibration_range(s->profile, by_rms(s) > 0.0, by_sine(s) > 0.0, hz);
}

static bool is_finite(const mt_response_limit *s, const mt_vibration_response *r)
{
    return isfinite(limited_quantity(s, r));
}

static mt_status evaluate_vibration(mt_workspace *w, const mt_requirement *d, int pos,
                                    double *q, double *slope, mt_err *err)
{
    const mt_response_limit *const s = d->goal->response_limit;
    bool proven = false;
    mt_vibration_response r;
    mt_spectral_nodes nodes = {.n = 0};
    (void)pos;
    MT_TRY(mt_forced_response_respond(w, d, &r, &proven, err));
    *q = limited_quantity(s, &r);
    if (!is_finite(s, &r)) {
        double hz[2];
        range_of(s, hz);
        *q = HUGE_VAL;
        return mt_forced_response_lead(w, d, TWO_PI * hz[0], TWO_PI * hz[1], slope, err);
    }
    if (slope == NULL) {
        return MT_OK;
    }
    MT_TRY(mt_forced_response_nodes(w, d, &r, by_rms(s), by_sine(s), &nodes, err));
    MT_TRY(mt_forced_response_slope(w, d, &nodes, 1.0, slope, err));
    mt_forced_response_to_ln(w, d, *q, slope);
    return MT_OK;
}

/* The tone with the largest response. */
static int worst_tone(const mt_response_limit *s, const mt_vibration_response *r)
{
    int best = 0;
    for (int i = 1; i < r->n_tones; i++) {
        const double own = mt_vibration_respond_tone(s->profile, r, i);
        best = own > mt_vibration_respond_tone(s->profile, r, best) ? i : best;
    }
    return best;
}

static void look_at_tones(const mt_response_limit *s, const mt_vibration_response *r,
                          mt_forced_response_value *out)
{
    double excess = 0.0;
    for (int i = 0; i < r->n_tones; i++) {
        excess = fmax(excess, r->tones[i].excess);
    }
    out->error += by_sine(s) * r->sine * excess;
    if (s->quantity == MT_RESPONSE_LIMIT_SINE) {
        const int worst = worst_tone(s, r);
        out->omega = r->tones[worst].omega;
        out->at_edge = r->tones[worst].at_edge;
        out->lower_hz = s->profile->tones[worst].lower_hz;
        out->upper_hz = s->profile->tones[worst].upper_hz;
    }
}

static mt_status find_vibration_peak(mt_workspace *w, const mt_requirement *d,
                                     mt_forced_response_value *out, mt_err *err)
{
    const mt_response_limit *const s = d->goal->response_limit;
    bool proven = false;
    mt_vibration_response r;
    mt_forced_response_peak peak;
    double hz[2];
    MT_TRY(mt_forced_response_respond(w, d, &r, &proven, err));
    range_of(s, hz);
    out->lower_hz = hz[0];
    out->upper_hz = hz[1];
    out->proven = proven;
    out->end = r.end;
    if (!is_finite(s, &r)) {
        return MT_OK;
    }
    out->end = MT_FORCED_FINITE;
    out->value = limited_quantity(s, &r);
    out->error = by_rms(s) > 0.0 ? by_rms(s) * r.rms_bound : 0.0;
    look_at_tones(s, &r, out);
    if (s->quantity != MT_RESPONSE_LIMIT_SINE) {
        MT_TRY(mt_forced_response_find(w, d, TWO_PI * out->lower_hz, TWO_PI * out->upper_hz,
                                       &peak, err));
        out->omega = peak.at.omega;
        out->at_edge = peak.at.at_edge;
    }
    return MT_OK;
}

static const char *vibration_subject(const mt_requirement *d, const char *what, mt_arena *mem)
{
    static const char *const words[MT_RESPONSE_LIMIT_QUANTITIES] = {"response", "RMS", "tones",
                                                                    "peak"};
    const mt_response_limit *const s = d->goal->response_limit;
    return mt_arena_printf(
        mem, "%s: %s of %s under %s along %s", what, words[s->quantity], s->output.s,
        s->profile->name != NULL ? s->profile->name : s->profile_name.s, s->input.s);
}

const mt_goal_ops mt_goal_vibration = {.quantity = MT_QUANTITY_OTHER,
                                       .needs_vectors = true,
                                       .compile = mt_forced_response_compile,
                                       .value = evaluate_vibration,
                                       .look = find_vibration_peak,
                                       .subject = vibration_subject,
                                       .equals = "at"};
