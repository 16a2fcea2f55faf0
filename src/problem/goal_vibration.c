/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "vibration": q = what a profile does to a response: the RMS of its random parts, the peaks of
 * its tones, each the largest over its range and together by the profile's rule, or both. */
#include <math.h>

#include "problem/forced_response.h"
#include "problem/goal.h"

static const double TWO_PI = 6.283185307179586476925;

/* q = by_rms RMS + by_sine tones. */
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
