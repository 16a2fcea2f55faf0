/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vibration/respond.h"

#include <complex.h>
#include <math.h>

static const double TWO_PI = 6.28318530717958647693;

static void note_end(mt_vibration_response *out, mt_forced_end end, int pole)
{
    if (end > out->end) {
        out->end = end;
        out->pole = pole;
    }
}

/* Error of the mean square by the rounding of the poles. The resonance of a pole re + i im, |H|
 * = |rho| / |w - p|, contributes |rho|^2 G / (2 im) where the density is G: next to an undamped
 * pole all of it may be wrong. */
static double pole_rounding(const mt_psd *psd, const mt_spectral *of)
{
    const mt_frf *const h = &of->h;
    double sum = 0.0;
    for (int k = 0; k < h->n; k++) {
        const double im = fabs(h->im[k]);
        if (h->re[k] <= 0.0 || im == 0.0 || h->index[k] < of->sum->first_coupled) {
            continue;
        }
        const double size = cabs(h->rho[k]);
        sum += size * size * mt_psd_at(psd, h->re[k] / TWO_PI) / (2.0 * im) *
               (of->sum->rounding / im);
    }
    return sum;
}

static void add_random(const mt_vibration *v, const mt_spectral *of, mt_vibration_response *out)
{
    double square = 0.0;
    double bound = 0.0;
    for (int i = 0; i < v->n_random; i++) {
        const mt_spectral_answer a = mt_spectral_rms(of, &v->random[i].psd, MT_SPECTRAL_BEST);
        note_end(out, a.end, a.pole);
        square += a.rms * a.rms;
        /* of sqrt(sum a_i^2), by each a_i at most 1 */
        bound += a.bound + mt_spectral_root_bound(pole_rounding(&v->random[i].psd, of), a.rms);
    }
    out->rms = sqrt(square);
    out->rms_bound = bound;
}

double mt_vibration_respond_tone(const mt_vibration *v, const mt_vibration_response *r, int i)
{
    return v->tones[i].level * r->tones[i].value;
}

static int largest_tone(const mt_vibration *v, const mt_vibration_response *r)
{
    int best = 0;
    for (int i = 1; i < r->n_tones; i++) {
        const bool more =
            mt_vibration_respond_tone(v, r, i) > mt_vibration_respond_tone(v, r, best);
        best = more ? i : best;
    }
    return best;
}

/* NaN of any tone is NaN of all. */
static double combine(const mt_vibration *v, const mt_vibration_response *r)
{
    double sum = 0.0;
    double square = 0.0;
    for (int i = 0; i < r->n_tones; i++) {
        const double a = mt_vibration_respond_tone(v, r, i);
        sum += a;
        square += a * a;
    }
    switch (v->rule) {
    case MT_TONES_SUM:
        break;
    case MT_TONES_LARGEST:
        return sum == sum && r->n_tones > 0
                   ? mt_vibration_respond_tone(v, r, largest_tone(v, r))
                   : sum;
    case MT_TONES_ROOT:
        return sqrt(square);
    }
    return sum;
}

void mt_vibration_respond_combine(const mt_vibration *v, mt_vibration_response *r)
{
    r->sine = combine(v, r);
    r->peak = (v->sigma * r->rms) + r->sine;
}

mt_status mt_vibration_respond(const mt_vibration *v, const mt_pole_sum *h, mt_arena *mem,
                               mt_vibration_response *out, mt_err *err)
{
    mt_spectral of;
    *out = (mt_vibration_response){.end = MT_FORCED_FINITE, .pole = -1, .n_tones = v->n_tones};
    MT_TRY(mt_spectral_init(&of, h, mem, err));
    out->tones = mt_arena_alloc(mem, (size_t)v->n_tones, sizeof *out->tones);
    MT_TRY(mt_arena_check(mem, err));
    add_random(v, &of, out);
    for (int i = 0; i < v->n_tones; i++) {
        out->tones[i] = mt_sine_peak_find(&of.h, TWO_PI * v->tones[i].lower_hz,
                                          TWO_PI * v->tones[i].upper_hz);
        note_end(out, out->tones[i].end, out->tones[i].pole);
    }
    mt_vibration_respond_combine(v, out);
    return MT_OK;
}

double mt_vibration_respond_psd(const mt_vibration *v, const mt_spectral *h, double hz)
{
    double sum = 0.0;
    for (int i = 0; i < v->n_random; i++) {
        sum += mt_spectral_psd(h, &v->random[i].psd, hz);
    }
    return sum;
}

/* Derivative of the peak by the amplitude of tone i. */
static double by_tone(const mt_vibration *v, const mt_vibration_response *r, int i)
{
    switch (v->rule) {
    case MT_TONES_SUM:
        break;
    case MT_TONES_LARGEST:
        return i == largest_tone(v, r) ? 1.0 : 0.0;
    case MT_TONES_ROOT:
        return r->sine > 0.0 ? mt_vibration_respond_tone(v, r, i) / r->sine : 0.0;
    }
    return 1.0;
}

mt_status mt_vibration_respond_slopes(const mt_vibration *v, const mt_pole_sum *h,
                                      const mt_vibration_response *r, mt_arena *mem,
                                      double complex *by_s, double complex *by_residue,
                                      double complex *by_d, mt_err *err)
{
    mt_spectral of;
    double complex *const part = mt_arena_alloc(mem, 2 * (size_t)h->n, sizeof *part);
    MT_TRY(mt_spectral_init(&of, h, mem, err));
    for (int k = 0; k < h->n; k++) {
        by_s[k] = 0.0;
        by_residue[k] = 0.0;
    }
    for (int j = 0; j < MT_COUNT(h->d); j++) {
        by_d[j] = 0.0;
    }
    for (int i = 0; i < v->n_random && r->rms > 0.0; i++) {
        const mt_psd *const g = &v->random[i].psd;
        double complex part_d[MT_COUNT(h->d)];
        const double share = v->sigma * mt_spectral_rms(&of, g, MT_SPECTRAL_BEST).rms / r->rms;
        mt_spectral_slopes(&of, g, part, part + h->n, part_d);
        for (int k = 0; k < h->n; k++) {
            by_s[k] += share * part[k];
            by_residue[k] += share * part[h->n + k];
        }
        for (int j = 0; j < MT_COUNT(h->d); j++) {
            by_d[j] += share * part_d[j];
        }
    }
    for (int i = 0; i < r->n_tones; i++) {
        const double share = v->tones[i].level * by_tone(v, r, i);
        mt_frf_pull(&of.h, (mt_near){r->tones[i].omega, 0.0}, share * r->tones[i].direction,
                    by_s, by_residue, by_d);
    }
    return MT_OK;
}

/* Append the nodes of random part i. */
static mt_status add_nodes(const mt_spectral *of, const mt_psd *g, double share, mt_arena *mem,
                           mt_spectral_nodes *out, mt_err *err)
{
    mt_spectral_nodes part;
    MT_TRY(mt_spectral_slope_nodes(of, g, mem, &part, err));
    const size_t n = (size_t)out->n + (size_t)part.n;
    double *const omega = mt_arena_f64(mem, n, 1);
    double complex *const weight = mt_arena_alloc(mem, n, sizeof *weight);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < out->n; i++) {
        omega[i] = out->omega[i];
        weight[i] = out->weight[i];
    }
    for (int i = 0; i < part.n; i++) {
        omega[out->n + i] = part.omega[i];
        weight[out->n + i] = share * part.weight[i];
    }
    *out = (mt_spectral_nodes){.n = (int)n, .omega = omega, .weight = weight};
    return MT_OK;
}

mt_status mt_vibration_respond_tone_nodes(const mt_vibration *v, const mt_vibration_response *r,
                                          double by_sine, mt_arena *mem, mt_spectral_nodes *out,
                                          mt_err *err)
{
    out->n = by_sine != 0.0 ? r->n_tones : 0;
    out->omega = mt_arena_f64(mem, (size_t)out->n, 1);
    out->weight = mt_arena_alloc(mem, (size_t)out->n, sizeof *out->weight);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < out->n; i++) {
        out->omega[i] = r->tones[i].omega;
        out->weight[i] = by_sine * v->tones[i].level * by_tone(v, r, i) * r->tones[i].direction;
    }
    return MT_OK;
}

mt_status mt_vibration_respond_nodes(const mt_vibration *v, const mt_pole_sum *h,
                                     const mt_vibration_response *r, double by_rms,
                                     double by_sine, mt_arena *mem, mt_spectral_nodes *out,
                                     mt_err *err)
{
    mt_spectral of;
    MT_TRY(mt_vibration_respond_tone_nodes(v, r, by_sine, mem, out, err));
    MT_TRY(mt_spectral_init(&of, h, mem, err));
    for (int i = 0; i < v->n_random && by_rms != 0.0 && r->rms > 0.0; i++) {
        const mt_psd *const g = &v->random[i].psd;
        const double rms = mt_spectral_rms(&of, g, MT_SPECTRAL_BEST).rms;
        MT_TRY(add_nodes(&of, g, by_rms * rms / r->rms, mem, out, err));
    }
    return MT_OK;
}

mt_pole_sum mt_vibration_respond_one_mass(double hz, double damping_ratio, double complex s[2],
                                          double complex residue[2])
{
    const double w = TWO_PI * hz;
    const double damped = w * sqrt((1.0 - damping_ratio) * (1.0 + damping_ratio));
    s[0] = mt_frf_complex(-damping_ratio * w, damped);
    s[1] = conj(s[0]);
    /* (w^2 + 2 zeta w s) / (s - conj s) */
    residue[0] = mt_frf_ratio((w * w) + (2.0 * damping_ratio * w * s[0]),
                              mt_frf_complex(0.0, 2.0 * damped));
    residue[1] = conj(residue[0]);
    return (mt_pole_sum){.n = 2, .s = s, .residue = residue};
}
