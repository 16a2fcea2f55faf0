/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Partial fractions. With H*(z) = conj H(conj z), on the real axis |H|^2 = H H*; H has the
 * poles p_k, H* their conjugates, and at both together, with the polynomial P = c_0 + c_1 w +
 * c_2 w^2 of H,
 *     |H|^2 = sum_k |rho_k|^2 / |w - p_k|^2
 *             + 2 Re sum_k rho_k R_k / (w - p_k)
 *             + |P|^2 + 2 Re sum_k rho_k (conj c_1 + conj c_2 (w + p_k)),
 *     R_k = P*(p_k) + sum_{j != k} conj rho_j / (p_k - conj p_j).
 * The first sum holds the resonances, and all of it is positive: narrow ones, in the band or
 * far from it, lose nothing. Against w^b (w in units of the segment's lower end):
 *     J(p) = integral w^b / (w - p) dw,      S(p) = integral w^b / |w - p|^2 dw = Im J / Im p.
 * With b = 0, of w - p from u to v: J = ln(v / u), and S is the angle between u and v over
 * Im p. Else the segment is cut into pieces on which w^b is smooth. Gauss's rule takes J and S
 * as they are where p is far from the piece, and next to p
 *     J = p^b ln(v / u) + integral (w^b - p^b) / (w - p) dw,
 * whose integrand is as smooth as w^b: p^b (exp(b ln(1 + x)) - 1) / (p x), x = (w - p) / p.
 */
#include "vibration/spectral_priv.h"

#include <float.h>
#include <math.h>

static const double ULPS_OF_A_QUOTIENT = 4.0;

/* J, S and the sizes of what was summed up for them. */
typedef struct kernel {
    double complex j;
    double j_size;
    double s;
    double s_size;
} kernel;

/* ln(1 + z), exact to rounding for small z, off the negative axis below -1. */
static double complex log_of_1_and(double complex z)
{
    const double x = creal(z);
    const double y = cimag(z);
    const double square = (x * (2.0 + x)) + (y * y); /* |1 + z|^2 - 1 */
    return mt_frf_complex(fabs(square) < 0.5 ? 0.5 * log1p(square) : log(hypot(1.0 + x, y)),
                          atan2(y, 1.0 + x));
}

/* exp(z) - 1, exact to rounding for small z. */
static double complex exp_less_1(double complex z)
{
    const double half = sin(0.5 * cimag(z));
    return mt_frf_complex((expm1(creal(z)) * cos(cimag(z))) - (2.0 * half * half),
                          exp(creal(z)) * sin(cimag(z)));
}

static double complex quotient(double complex a, double complex b)
{
    return mt_frf_ratio(a, b);
}

/* ln(v / u) and the angle between u and v over Im p; w from u + p to v + p. */
static kernel of_logarithm(const mt_frf *h, int k, double lower, double upper)
{
    const double complex u = mt_frf_from_pole(h, k, (mt_near){lower, 0.0});
    const double complex v = mt_frf_from_pole(h, k, (mt_near){upper, 0.0});
    const double width = upper - lower;
    const double damps = fabs(h->im[k]);
    const double along = (creal(u) * creal(v)) + (damps * damps);
    const double complex j = log_of_1_and(quotient(width, u));
    const double s = damps > 0.0 ? atan2(damps * width, along) / damps : width / along;
    return (kernel){.j = j, .j_size = cabs(j), .s = s, .s_size = s};
}

/* A piece of a segment: Gauss's rule there, with w^b at the nodes. */
typedef struct piece {
    double lower;
    double upper;
    double unit; /* w^b is (w / unit)^b */
    double exponent;
    double omega[MT_GAUSS_NODES];
    double weight[MT_GAUSS_NODES]; /* times w^b */
} piece;

static void far_from(const mt_frf *h, int k, const piece *on, kernel *sum)
{
    for (int i = 0; i < MT_GAUSS_NODES; i++) {
        const double complex d = mt_frf_from_pole(h, k, (mt_near){on->omega[i], 0.0});
        const double complex j = quotient(on->weight[i], d);
        const double s = on->weight[i] / ((creal(d) * creal(d)) + (cimag(d) * cimag(d)));
        sum->j += j;
        sum->j_size += cabs(j);
        sum->s += s;
        sum->s_size += s;
    }
}

static void next_to(const mt_frf *h, int k, const piece *on, const mt_gauss *g, kernel *sum)
{
    const double complex p = mt_frf_complex(h->re[k], h->im[k]);
    const double b = on->exponent;
    const double complex power = cexp(b * clog(quotient(p, on->unit)));
    const kernel l = of_logarithm(h, k, on->lower, on->upper);
    const double half = 0.5 * (on->upper - on->lower);
    double complex j = power * l.j;
    double size = cabs(j);
    for (int i = 0; i < MT_GAUSS_NODES; i++) {
        const double complex d = mt_frf_from_pole(h, k, (mt_near){on->omega[i], 0.0});
        const double complex more = exp_less_1(b * log_of_1_and(quotient(d, p)));
        const double complex term = half * g->weight[i] * power * quotient(more, d);
        j += term;
        size += cabs(term);
    }
    sum->j += j;
    sum->j_size += size;
    /* without damping there is no S this way: the bound says so */
    sum->s += h->im[k] != 0.0 ? cimag(j) / h->im[k] : 0.0;
    sum->s_size += h->im[k] != 0.0 ? size / fabs(h->im[k]) : HUGE_VAL;
}

static void cut(piece *on, const mt_gauss *g, const mt_spectral_segment *all, double from,
                double to)
{
    const double half = 0.5 * (to - from);
    *on = (piece){.lower = from, .upper = to, .unit = all->lower, .exponent = all->exponent};
    for (int i = 0; i < MT_GAUSS_NODES; i++) {
        on->omega[i] = from + (half * (1.0 + g->node[i]));
        on->weight[i] = half * g->weight[i] *
                        exp(on->exponent * mt_psd_log_ratio(all->lower, on->omega[i]));
    }
}

/* Pieces of equal quotients: at most 2 each, w^b within a factor of exp(2). */
static int count_pieces(const mt_spectral_segment *segment)
{
    static const double most_growth = 2.0;
    const double l = mt_psd_log_ratio(segment->lower, segment->upper);
    const double n = fmax(l / log(2.0), l * fabs(segment->exponent) / most_growth);
    return 1 + (int)fmin(n, 1e6);
}

typedef struct total {
    double value;
    double size; /* of all that was added, times units in the last place */
} total;

static void add_pole(const mt_spectral *r, int k, const kernel *f, double ulps, total *t)
{
    const mt_frf *const h = &r->h;
    const double square =
        (creal(h->rho[k]) * creal(h->rho[k])) + (cimag(h->rho[k]) * cimag(h->rho[k]));
    t->value += square * f->s;
    t->size += square * f->s_size * ulps;
    t->value += 2.0 * creal(h->rho[k] * r->rest[k] * f->j);
    t->size += 2.0 * cabs(h->rho[k]) * r->rest_size[k] * f->j_size * ulps;
}

/* The polynomial part, q_0 + ... + q_4 w^4. */
static void add_polynomial(const mt_spectral *r, const mt_spectral_segment *segment,
                           double ulps, total *t)
{
    enum { TERMS = 5 };
    const mt_frf *const h = &r->h;
    const double complex *const c = h->c;
    const double l = mt_psd_log_ratio(segment->lower, segment->upper);
    double q[TERMS] = {0.0};
    double size[TERMS] = {0.0};
    double power = segment->lower;
    for (int i = 0; i < MT_COUNT(h->c); i++) {
        for (int j = 0; j < MT_COUNT(h->c); j++) {
            q[i + j] += creal(c[i] * conj(c[j]));
            size[i + j] += cabs(c[i]) * cabs(c[j]);
        }
    }
    for (int k = 0; k < h->n; k++) {
        const double complex p = mt_frf_complex(h->re[k], h->im[k]);
        q[0] += 2.0 * creal(h->rho[k] * (conj(c[1]) + (conj(c[2]) * p)));
        size[0] += 2.0 * cabs(h->rho[k]) * (cabs(c[1]) + (cabs(c[2]) * cabs(p)));
        q[1] += 2.0 * creal(h->rho[k] * conj(c[2]));
        size[1] += 2.0 * cabs(h->rho[k]) * cabs(c[2]);
    }
    for (int m = 0; m < TERMS; m++) {
        const double integral = power * mt_psd_power_integral(segment->exponent + m + 1.0, l);
        t->value += q[m] * integral;
        t->size += size[m] * integral * ulps;
        power *= segment->lower;
    }
}

mt_spectral_sum mt_spectral_closed(const mt_spectral *r, const mt_spectral_segment *segment)
{
    const mt_gauss *const g = &r->gauss;
    const mt_frf *const h = &r->h;
    /* (w / lower)^b has b times the error of w / lower */
    const double ulps = mt_spectral_ulps(h) + (ULPS_OF_A_QUOTIENT * fabs(segment->exponent));
    total t = {0.0, 0.0};
    add_polynomial(r, segment, ulps, &t);
    if (segment->exponent == 0.0) {
        for (int k = 0; k < h->n; k++) {
            const kernel f = of_logarithm(h, k, segment->lower, segment->upper);
            add_pole(r, k, &f, ulps, &t);
        }
        return (mt_spectral_sum){t.value, t.size * DBL_EPSILON};
    }
    const int n = count_pieces(segment);
    const double l = mt_psd_log_ratio(segment->lower, segment->upper);
    double from = segment->lower;
    for (int i = 0; i < n; i++) {
        piece on;
        const double to = i + 1 == n ? segment->upper : segment->lower * exp(l * (i + 1) / n);
        const mt_panel panel = {from, 0.0, to - from};
        cut(&on, g, segment, from, to);
        for (int k = 0; k < h->n; k++) {
            kernel f = {.j = 0.0};
            if (mt_panels_clears(h, k, &panel, MT_PANEL_CLEAR)) {
                far_from(h, k, &on, &f);
            } else {
                next_to(h, k, &on, g, &f);
            }
            add_pole(r, k, &f, ulps, &t);
        }
        from = to;
    }
    const double bound = t.size * DBL_EPSILON;
    return (mt_spectral_sum){t.value, bound == bound ? bound : HUGE_VAL};
}
