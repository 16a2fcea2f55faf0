/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vibration/spectral_priv.h"

#include <float.h>
#include <math.h>

/* A closed form whose bound is below this part of its value needs no second opinion. */
static const double CLOSED_ENOUGH = 1e-11;
/* What rounding takes of one term: a quotient or product of complex numbers and the weight. */
static const double ULPS_OF_A_TERM = 8.0;
/* On the inner ellipse of a panel w^b is at most this times what it is at the nodes: the
 * ellipse goes beyond the panel by 0.45 of its half width, which is at most 2 / |b| of its
 * begin. */
static const double GROWTH = 4.0;

double mt_spectral_ulps(const mt_frf *h)
{
    return (double)h->n + ULPS_OF_A_TERM;
}

/* R_k of spectral_closed.c. */
static void find_rest(mt_spectral *r)
{
    const mt_frf *const h = &r->h;
    for (int k = 0; k < h->n; k++) {
        const double complex p = mt_frf_complex(h->re[k], h->im[k]);
        r->rest[k] = conj(h->c[0]) + (p * (conj(h->c[1]) + (p * conj(h->c[2]))));
        r->rest_size[k] =
            cabs(h->c[0]) + (cabs(p) * (cabs(h->c[1]) + (cabs(p) * cabs(h->c[2]))));
        for (int j = 0; j < h->n; j++) {
            const double complex gap = mt_frf_complex(h->re[k] - h->re[j], h->im[k] + h->im[j]);
            if (j == k) {
                continue;
            }
            if (cabs(gap) == 0.0) { /* no simple poles: panels know what to do */
                r->rest_size[k] = HUGE_VAL;
                continue;
            }
            const double complex term = mt_frf_ratio(conj(h->rho[j]), gap);
            r->rest[k] += term;
            r->rest_size[k] += cabs(term);
        }
    }
}

mt_status mt_spectral_init(mt_spectral *r, const mt_pole_sum *sum, mt_arena *mem, mt_err *err)
{
    *r = (mt_spectral){.sum = sum};
    MT_TRY(mt_frf_init(&r->h, sum, mem, err));
    r->rest = mt_arena_alloc(mem, (size_t)r->h.n, sizeof *r->rest);
    r->rest_size = mt_arena_f64(mem, (size_t)r->h.n, 1);
    MT_TRY(mt_arena_check(mem, err));
    find_rest(r);
    mt_panels_gauss(&r->gauss);
    return MT_OK;
}

double mt_spectral_psd(const mt_spectral *r, const mt_psd *input, double hz)
{
    const double g = mt_psd_at(input, hz);
    if (!(g > 0.0)) {
        return 0.0;
    }
    int pole = 0;
    if (mt_frf_judge(&r->h, MT_TWO_PI * hz, MT_TWO_PI * hz, &pole) == MT_FORCED_INFINITE) {
        return HUGE_VAL;
    }
    const double size = cabs(mt_frf_value(&r->h, (mt_near){MT_TWO_PI * hz, 0.0}, NULL));
    return size * size * g;
}

mt_spectral_segment mt_spectral_segment_of(const mt_psd *input, int i)
{
    return (mt_spectral_segment){.lower = MT_TWO_PI * input->hz[i],
                                 .upper = MT_TWO_PI * input->hz[i + 1],
                                 .exponent = mt_psd_exponent(input, i)};
}

double mt_spectral_power(const mt_spectral_segment *segment, mt_near w)
{
    const double omega = w.anchor + w.t;
    return segment->exponent == 0.0
               ? 1.0
               : exp(segment->exponent * mt_psd_log_ratio(segment->lower, omega));
}

/* The same over panels. */
static mt_spectral_sum over_panels(const mt_spectral *r, const mt_spectral_segment *segment)
{
    const mt_gauss *const g = &r->gauss;
    const mt_frf *const h = &r->h;
    const double truncation = mt_panels_truncation();
    const double ulps = mt_spectral_ulps(h);
    const double grows = 1.0 + fabs(segment->exponent);
    mt_spectral_sum sum = {0.0, 0.0};
    double rounding = 0.0;
    mt_panels walk;
    mt_panel on;
    mt_panels_begin(&walk, h, segment->lower, segment->upper, segment->exponent);
    while (mt_panels_next(&walk, &on)) {
        const double half = 0.5 * (on.b - on.a);
        double most = 0.0; /* of w^b at the nodes */
        for (int i = 0; i < MT_GAUSS_NODES; i++) {
            const mt_near w = {on.anchor, on.a + (half * (1.0 + g->node[i]))};
            const double weight = half * g->weight[i] * mt_spectral_power(segment, w);
            double size = 0.0;
            const double value = cabs(mt_frf_value(h, w, &size));
            sum.value += weight * value * value;
            rounding +=
                weight * value * ((2.0 * ulps * size) + (grows * ULPS_OF_A_TERM * value));
            most = fmax(most, weight / (half * g->weight[i]));
        }
        const double bound = mt_panels_bound(h, &on);
        sum.bound += truncation * half * most * (segment->exponent == 0.0 ? 1.0 : GROWTH) *
                     bound * bound;
    }
    sum.bound = walk.narrow ? HUGE_VAL : sum.bound + (DBL_EPSILON * rounding);
    return sum;
}

/* Error by the rounding of 2 pi f at the ends of the segment: significant next to narrow
 * resonances only. */
static double at_ends(const mt_spectral *r, const mt_spectral_segment *segment)
{
    const double ends[] = {segment->lower, segment->upper};
    double sum = 0.0;
    for (int i = 0; i < MT_COUNT(ends); i++) {
        const mt_near w = {ends[i], 0.0};
        const double size = cabs(mt_frf_value(&r->h, w, NULL));
        sum += ends[i] * size * size * mt_spectral_power(segment, w);
    }
    return DBL_EPSILON * sum;
}

static mt_spectral_sum best(const mt_spectral *r, const mt_spectral_segment *segment,
                            mt_spectral_method way, bool *closed)
{
    *closed = way != MT_SPECTRAL_PANELS;
    mt_spectral_sum a = {.bound = HUGE_VAL};
    if (way != MT_SPECTRAL_PANELS) {
        a = mt_spectral_closed(r, segment);
        if (way == MT_SPECTRAL_CLOSED || a.bound <= CLOSED_ENOUGH * a.value) {
            return a;
        }
    }
    const mt_spectral_sum b = over_panels(r, segment);
    *closed = a.bound < b.bound;
    return *closed ? a : b;
}

/* True where the response is not finite; *a is then the answer with the reason. */
static bool is_refused(const mt_spectral *r, const mt_psd *input, mt_spectral_answer *a)
{
    *a = (mt_spectral_answer){.rms = nan(""), .bound = nan(""), .pole = -1};
    a->end = mt_frf_judge(&r->h, MT_TWO_PI * input->hz[0], MT_TWO_PI * input->hz[input->n - 1],
                          &a->pole);
    return a->end != MT_FORCED_FINITE;
}

/* |sqrt(x + e) - sqrt(x)| <= e / sqrt(x) and <= sqrt(e) */
double mt_spectral_root_bound(double bound, double root)
{
    return fmin(sqrt(bound), root > 0.0 ? bound / root : HUGE_VAL) +
           (ULPS_OF_A_TERM * DBL_EPSILON * root);
}

mt_spectral_answer mt_spectral_rms(const mt_spectral *r, const mt_psd *input,
                                   mt_spectral_method way)
{
    mt_spectral_answer a;
    double square = 0.0;
    double bound = 0.0;
    if (is_refused(r, input, &a)) {
        return a;
    }
    for (int i = 0; i + 1 < input->n; i++) {
        const mt_spectral_segment segment = mt_spectral_segment_of(input, i);
        bool closed = false;
        if (!(segment.upper > segment.lower)) {
            continue;
        }
        const mt_spectral_sum sum = best(r, &segment, way, &closed);
        square += input->level[i] * sum.value / MT_TWO_PI;
        bound += input->level[i] * (sum.bound + at_ends(r, &segment)) / MT_TWO_PI;
        a.n_closed += closed ? 1 : 0;
    }
    a.rms = sqrt(fmax(square, 0.0));
    a.bound = mt_spectral_root_bound(bound, a.rms);
    return a;
}
