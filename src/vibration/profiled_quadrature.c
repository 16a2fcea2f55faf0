/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The poles tell where a response is smooth, its values are those of mt_transfer_at:
 *     RMS^2 = sum over panels of integral |H|^2 G df,
 * each panel by Gauss's rule as a whole (I) and as two halves (J): J is taken, |I - J| is what
 * I is wrong by, and J by far less. Poles without damping are not walked around: where one
 * resonates there is no number, and where none does nothing is to be seen of it.
 */
#include "vibration/profiled_priv.h"

#include <float.h>
#include <math.h>

static const double TWO_PI = 6.28318530717958647693;
/* The grid of a tone's range that its curve begins with. */
enum { TONE_POINTS = 9 };

typedef struct work {
    mt_response *r;
    mt_profiled *out;
    mt_gauss gauss;
    mt_frf h; /* of the poles that are damped; no residues */
    mt_sample at;
    double *square; /* [pairs] */
    double *bound;  /* [pairs] */
    double *whole;  /* [pairs] of one panel */
    double *halves; /* [pairs] */
} work;

static void note_end(work *k, int pair, mt_forced_end end, int pole)
{
    mt_vibration_response *const to = &k->out->answers[pair];
    if (end > to->end) {
        to->end = end;
        to->pole = pole;
    }
}

/* Note pairs that resonate at undamped poles within a range. */
static mt_status note_resonances(work *k, double lower, double upper, mt_err *err)
{
    int growing = -1;
    if (mt_frf_judge(&k->h, lower, upper, &growing) == MT_FORCED_UNSTABLE) {
        for (int p = 0; p < k->out->n_pairs; p++) {
            note_end(k, p, MT_FORCED_UNSTABLE, growing);
        }
    }
    for (int i = 0; i < k->out->n_poles; i++) {
        const double w = cimag(k->out->poles[i]);
        bool damped = false;
        for (int j = 0; j < k->h.n; j++) {
            damped = damped || k->h.index[j] == i;
        }
        if (damped || !(w > 0.0 && w >= lower && w <= upper)) {
            continue;
        }
        MT_TRY(mt_transfer_at(k->r->chosen, w, &k->at, &k->r->mem, err));
        for (int p = 0; p < k->out->n_pairs; p++) {
            if (!isfinite(creal(k->at.h[p]))) {
                note_end(k, p, MT_FORCED_INFINITE, i);
            }
        }
    }
    return MT_OK;
}

/* to[pairs] += integral of |H|^2 G over a panel, [rad/s]; rounding into the bound, where it is
 * asked for. */
static mt_status add_gauss(work *k, const mt_psd *g, const mt_panel *on, double *to,
                           bool rounding, mt_err *err)
{
    const double half = 0.5 * (on->b - on->a);
    for (int i = 0; i < MT_GAUSS_NODES; i++) {
        const double w = on->anchor + (on->a + (half * (1.0 + k->gauss.node[i])));
        const double weight = half * k->gauss.weight[i] * mt_psd_at(g, w / TWO_PI);
        MT_TRY(mt_transfer_at(k->r->chosen, w, &k->at, &k->r->mem, err));
        for (int p = 0; p < k->out->n_pairs; p++) {
            const double size = cabs(k->at.h[p]);
            to[p] += weight * size * size;
            k->bound[p] += rounding ? 2.0 * weight * size * k->at.error[p] : 0.0;
        }
    }
    return MT_OK;
}

static mt_status add_panel(work *k, const mt_psd *g, const mt_panel *on, mt_err *err)
{
    const double middle = 0.5 * (on->a + on->b);
    const mt_panel left = {on->anchor, on->a, middle};
    const mt_panel right = {on->anchor, middle, on->b};
    for (int p = 0; p < k->out->n_pairs; p++) {
        k->whole[p] = 0.0;
        k->halves[p] = 0.0;
    }
    MT_TRY(mt_interrupt_check(k->r->sys->run->interrupt, err));
    MT_TRY(add_gauss(k, g, on, k->whole, false, err));
    MT_TRY(add_gauss(k, g, &left, k->halves, true, err));
    MT_TRY(add_gauss(k, g, &right, k->halves, true, err));
    for (int p = 0; p < k->out->n_pairs; p++) {
        k->square[p] += k->halves[p];
        k->bound[p] += fabs(k->whole[p] - k->halves[p]) + (DBL_EPSILON * k->halves[p]);
    }
    return MT_OK;
}

static mt_status add_random(work *k, const mt_psd *g, mt_err *err)
{
    MT_TRY(note_resonances(k, TWO_PI * g->hz[0], TWO_PI * g->hz[g->n - 1], err));
    for (int i = 0; i + 1 < g->n; i++) {
        const double lower = TWO_PI * g->hz[i];
        const double upper = TWO_PI * g->hz[i + 1];
        mt_panels walk;
        mt_panel on;
        if (!(upper > lower)) {
            continue;
        }
        mt_panels_begin(&walk, &k->h, lower, upper, mt_psd_exponent(g, i));
        while (mt_panels_next(&walk, &on)) {
            MT_TRY(add_panel(k, g, &on, err));
        }
        for (int p = 0; p < k->out->n_pairs && walk.narrow; p++) {
            k->bound[p] = HUGE_VAL;
        }
    }
    return MT_OK;
}

/* RMS of all random parts: their mean squares add up. */
static mt_status find_rms(work *k, mt_err *err)
{
    const mt_vibration *const v = k->out->v;
    for (int i = 0; i < v->n_random; i++) {
        MT_TRY(add_random(k, &v->random[i].psd, err));
    }
    for (int p = 0; p < k->out->n_pairs; p++) {
        mt_vibration_response *const to = &k->out->answers[p];
        const double bound = k->bound[p] / TWO_PI;
        const bool has = to->end == MT_FORCED_FINITE;
        to->rms = has ? sqrt(k->square[p] / TWO_PI) : nan("");
        to->rms_bound = has ? mt_spectral_root_bound(bound, to->rms) : nan("");
    }
    return MT_OK;
}

/* The largest value of each pair's curve within the range of tone i. */
static mt_status find_tone(work *k, int i, mt_err *err)
{
    const mt_vibration_tone *const tone = &k->out->v->tones[i];
    const double lower = TWO_PI * tone->lower_hz;
    const double upper = TWO_PI * tone->upper_hz;
    const mt_curve_options opt = {.from = lower, .to = upper, .points = TONE_POINTS};
    mt_curve curve = {.n = 1, .h = k->at.h, .w = (double[]){lower}};
    MT_TRY(note_resonances(k, lower, upper, err));
    if (upper > lower) {
        MT_TRY(mt_response_curve(k->r, &opt, &curve, err));
    } else {
        MT_TRY(mt_transfer_at(k->r->chosen, lower, &k->at, &k->r->mem, err));
    }
    for (ptrdiff_t p = 0; p < k->out->n_pairs; p++) {
        const mt_forced_end end = k->out->answers[p].end;
        mt_sine_peak *const peak = &k->out->answers[p].tones[i];
        *peak = (mt_sine_peak){.end = end, .pole = k->out->answers[p].pole, .excess = nan("")};
        for (ptrdiff_t at = 0; at < curve.n; at++) {
            const double size = cabs(curve.h[p + (at * k->out->n_pairs)]);
            if (at == 0 || size > peak->value) {
                peak->value = size;
                peak->omega = curve.w[at];
                peak->at_edge = at == 0 || at + 1 == curve.n;
            }
        }
        peak->value = end == MT_FORCED_FINITE ? peak->value : nan("");
        peak->omega = end == MT_FORCED_FINITE ? peak->omega : nan("");
    }
    return MT_OK;
}

static mt_status make_quadrature_work(work *k, mt_err *err)
{
    mt_arena *const mem = &k->r->mem;
    const size_t pairs = (size_t)k->out->n_pairs;
    const size_t poles = (size_t)k->r->n_poles;
    double complex *const none = mt_arena_alloc(mem, poles, sizeof *none);
    k->at = (mt_sample){.h = mt_arena_alloc(mem, pairs, sizeof *k->at.h),
                        .error = mt_arena_f64(mem, pairs, 1)};
    k->square = mt_arena_f64(mem, pairs, 1);
    k->bound = mt_arena_f64(mem, pairs, 1);
    k->whole = mt_arena_f64(mem, pairs, 1);
    k->halves = mt_arena_f64(mem, pairs, 1);
    MT_TRY(mt_arena_check(mem, err));
    k->out->n_poles = k->r->n_poles;
    k->out->poles = k->r->poles;
    const mt_pole_sum sum = {.n = k->r->n_poles,
                             .s = k->r->poles,
                             .residue = none,
                             .judged = true,
                             .growing = k->r->growing};
    MT_TRY(mt_frf_init(&k->h, &sum, mem, err));
    mt_panels_gauss(&k->gauss);
    for (size_t p = 0; p < pairs; p++) {
        const int n = k->out->v->n_tones;
        mt_vibration_response *const to = &k->out->answers[p];
        *to = (mt_vibration_response){.end = MT_FORCED_FINITE, .pole = -1, .n_tones = n};
        to->tones = mt_arena_alloc(mem, (size_t)n, sizeof *to->tones);
    }
    return mt_arena_check(mem, err);
}

mt_status mt_profiled_quadrature(mt_response *r, mt_profiled *out, mt_err *err)
{
    work k = {.r = r, .out = out};
    MT_TRY(make_quadrature_work(&k, err));
    MT_TRY(find_rms(&k, err));
    for (int i = 0; i < out->v->n_tones; i++) {
        MT_TRY(find_tone(&k, i, err));
    }
    for (int p = 0; p < out->n_pairs; p++) {
        mt_vibration_respond_combine(out->v, &out->answers[p]);
    }
    return MT_OK;
}
