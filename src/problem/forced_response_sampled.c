/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * RMS^2 = integral |H|^2 G df = sum_j |H(w_j)|^2 g_j, the nodes w_j those of Gauss's rule for
 * ln w between any two neighbours among the points of a curve and the breakpoints of G.
 */
#include "problem/forced_response_sampled.h"

#include <math.h>

#include "vibration/profiled.h"

static const double TWO_PI = 6.283185307179586476925;

enum { CURVE_POINTS = 33, NODES = 4 };
static const double NODE[NODES] = {-0.8611363115940525752, -0.3399810435848562648,
                                   0.3399810435848562648, 0.8611363115940525752};
static const double WEIGHT[NODES] = {0.3478548451374538574, 0.6521451548625461426,
                                     0.6521451548625461426, 0.3478548451374538574};

/* The value at its omega, with all that belongs to it. */
static mt_status evaluate_sine_peak(mt_response *r, mt_sine_peak *out, double *by_omega,
                                    mt_err *err)
{
    double complex h = 0.0;
    double complex dh = 0.0;
    const mt_sample at = {.h = &h, .dh = &dh};
    MT_TRY(mt_transfer_at(r->chosen, out->omega, &at, &r->mem, err));
    if (!isfinite(creal(h))) {
        *out = (mt_sine_peak){.end = MT_FORCED_INFINITE, .pole = -1, .value = nan("")};
        return MT_OK;
    }
    out->value = cabs(h);
    out->direction = out->value > 0.0 ? conj(h) / out->value : 0.0;
    out->excess = nan("");
    *by_omega = creal(mt_frf_times(out->direction, dh));
    return MT_OK;
}

static mt_status trace(mt_response *r, double lower, double upper, mt_curve *out, mt_err *err)
{
    const mt_curve_options opt = {
        .from = lower, .to = upper, .points = CURVE_POINTS, .log = true};
    return mt_response_curve(r, &opt, out, err);
}

/* An undamped resonance within the curve, which its points need not hit; NULL: none. */
static const mt_extreme *resonance(const mt_curve *curve)
{
    for (int i = 0; i < curve->n_extremes; i++) {
        if (curve->extremes[i].infinite) {
            return &curve->extremes[i];
        }
    }
    return NULL;
}

mt_status mt_sampled_find(mt_response *r, double lower, double upper, mt_sine_peak *out,
                          double *by_omega, mt_err *err)
{
    mt_curve curve = {.n = 0};
    double most = -1.0;
    *out = (mt_sine_peak){.end = MT_FORCED_FINITE, .pole = -1, .omega = lower};
    *by_omega = 0.0;
    if (r->growing >= 0) {
        *out = (mt_sine_peak){.end = MT_FORCED_UNSTABLE, .pole = r->growing, .value = nan("")};
        return MT_OK;
    }
    if (lower < upper) {
        MT_TRY(trace(r, lower, upper, &curve, err));
    }
    if (resonance(&curve) != NULL) {
        *out = (mt_sine_peak){.end = MT_FORCED_INFINITE, .pole = -1, .value = nan("")};
        return MT_OK;
    }
    for (int i = 0; i < curve.n; i++) {
        const double size = cabs(curve.h[i]);
        if (!(size <= most)) {
            most = size;
            out->omega = curve.w[i];
        }
    }
    out->at_edge = lower < upper && (out->omega == lower || out->omega == upper);
    return evaluate_sine_peak(r, out, by_omega, err);
}

/* Appends the nodes of one random part to the n present (NULL: counts them only): g in
 * `weight`. */
static int add_nodes(const mt_curve *curve, const mt_psd *g, mt_spectral_nodes *to, int n)
{
    int i = 0;
    for (int k = 0; k + 1 < g->n; k++) {
        double from = TWO_PI * g->hz[k];
        const double end = TWO_PI * g->hz[k + 1];
        while (from < end) {
            while (i < curve->n && curve->w[i] <= from) {
                i++;
            }
            const double to_w = i < curve->n ? fmin(curve->w[i], end) : end;
            const double half = 0.5 * log(to_w / from);
            for (int j = 0; j < NODES && to != NULL; j++) {
                const double w = from * exp(half * (1.0 + NODE[j]));
                const double level =
                    g->level[k] * pow(w / (TWO_PI * g->hz[k]), mt_psd_exponent(g, k));
                to->omega[n + j] = w;
                to->weight[n + j] = half * WEIGHT[j] * w * level / TWO_PI;
            }
            n += NODES;
            from = to_w;
        }
    }
    return n;
}

/* All nodes of the random parts, g_j in their weights. */
static mt_status all_nodes(mt_response *r, const mt_vibration *v, mt_spectral_nodes *out,
                           mt_err *err)
{
    mt_curve *const curves = mt_arena_alloc(&r->mem, (size_t)v->n_random, sizeof *curves);
    int n = 0;
    MT_TRY(mt_arena_check(&r->mem, err));
    for (int i = 0; i < v->n_random; i++) {
        const mt_psd *const g = &v->random[i].psd;
        MT_TRY(trace(r, TWO_PI * g->hz[0], TWO_PI * g->hz[g->n - 1], &curves[i], err));
        n = add_nodes(&curves[i], g, NULL, n);
    }
    *out =
        (mt_spectral_nodes){.n = n,
                            .omega = mt_arena_f64(&r->mem, (size_t)n, 1),
                            .weight = mt_arena_alloc(&r->mem, (size_t)n, sizeof *out->weight)};
    MT_TRY(mt_arena_check(&r->mem, err));
    n = 0;
    for (int i = 0; i < v->n_random; i++) {
        n = add_nodes(&curves[i], &v->random[i].psd, out, n);
    }
    return MT_OK;
}

mt_status mt_sampled_respond(mt_response *r, const mt_vibration *v, mt_vibration_response *out,
                             mt_err *err)
{
    mt_profiled profiled;
    MT_TRY(mt_profiled_find(r, v, &profiled, err));
    *out = profiled.answers[0];
    for (int i = 0; i < out->n_tones && out->end == MT_FORCED_FINITE; i++) {
        double ignored = 0.0;
        MT_TRY(evaluate_sine_peak(r, &out->tones[i], &ignored, err)); /* its direction */
    }
    return MT_OK;
}

mt_status mt_sampled_nodes(mt_response *r, const mt_vibration *v,
                           const mt_vibration_response *of, double by_rms, double by_sine,
                           mt_spectral_nodes *out, mt_err *err)
{
    mt_spectral_nodes tones;
    mt_spectral_nodes random = {.n = 0};
    MT_TRY(mt_vibration_respond_tone_nodes(v, of, by_sine, &r->mem, &tones, err));
    if (by_rms != 0.0 && of->rms > 0.0) {
        MT_TRY(all_nodes(r, v, &random, err));
    }
    out->n = tones.n + random.n;
    out->omega = mt_arena_f64(&r->mem, (size_t)out->n, 1);
    out->weight = mt_arena_alloc(&r->mem, (size_t)out->n, sizeof *out->weight);
    MT_TRY(mt_arena_check(&r->mem, err));
    for (int i = 0; i < tones.n; i++) {
        out->omega[i] = tones.omega[i];
        out->weight[i] = tones.weight[i];
    }
    for (int j = 0; j < random.n; j++) {
        double complex h = 0.0;
        const mt_sample at = {.h = &h};
        MT_TRY(mt_transfer_at(r->chosen, random.omega[j], &at, &r->mem, err));
        out->omega[tones.n + j] = random.omega[j];
        out->weight[tones.n + j] = by_rms * creal(random.weight[j]) * conj(h) / of->rms;
    }
    return MT_OK;
}
