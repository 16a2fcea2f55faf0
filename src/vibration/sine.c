/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * F = H conj H has, about the centre c of an interval of half width h, Taylor's coefficients
 * f_k = sum_i a_i conj a_(k-i) of those of H, a_j = sum rho (-1)^j / (c - p)^(j + 1), and on it
 *     F <= f_0 + max (f_1 t + f_2 t^2) + sum_{k=3}^{m-1} |f_k| h^k + R h^m,
 *     R = sum_i A_i A_(m-i),   |H^(j) / j!| <= A_j = sum |rho| / distance^(j + 1),
 * with the distances of the poles from the interval. About a maximum the parabola leaves an
 * error of h^3, and where F is flat (an all-pass) one of h^m: few intervals are needed for
 * either. Intervals begin as panels, which are as narrow next to a pole as it is, and the best
 * of their centres and ends is driven to a stationary point before any is halved.
 */
#include "vibration/sine.h"

#include <float.h>
#include <math.h>

/* Proven of F; of |H| half of it. */
static const double EXCESS = 1e-10;
/* Intervals that are looked at before the search is content with what it can prove. */
enum { MOST_INTERVALS = 200000 };
enum { NEWTON_STEPS = 60, LAST_STEPS = 3, ORDER = 8 };
/* What rounding takes of one term of a sum. */
static const double ULPS = 8.0;

typedef struct search {
    const mt_frf *h;
    double lower;
    double upper;
    double f; /* best |H|^2 */
    mt_near at;
    mt_panel in;   /* the panel that it was found in */
    double proven; /* no interval that is done has more */
    int left;      /* of MOST_INTERVALS */
} search;

/* F, F' and F''. */
static void squared_gain_jet(const mt_frf *h, mt_near w, double *f)
{
    double complex jet[3];
    mt_frf_jet(h, w, jet);
    f[0] = (creal(jet[0]) * creal(jet[0])) + (cimag(jet[0]) * cimag(jet[0]));
    f[1] = 2.0 * creal(jet[1] * conj(jet[0]));
    f[2] = 2.0 * (creal(jet[2] * conj(jet[0])) + (creal(jet[1]) * creal(jet[1])) +
                  (cimag(jet[1]) * cimag(jet[1])));
}

/* Taylor's coefficients of H, and what rounding may take of each (times units in the last
 * place); sizes of the coefficients anywhere on the interval. */
typedef struct series {
    double complex a[ORDER];
    double rounding[ORDER];
    double size[ORDER + 1];
} series;

static void expand_about(const mt_frf *h, const mt_panel *p, mt_near centre, series *s)
{
    const double omega = centre.anchor + centre.t;
    const double most = p->anchor + p->b;
    *s = (series){.a = {0.0, h->c[1] + (2.0 * omega * h->c[2]), h->c[2]},
                  .size = {cabs(h->c[0]) + (most * (cabs(h->c[1]) + (most * cabs(h->c[2])))),
                           cabs(h->c[1]) + (2.0 * most * cabs(h->c[2])), cabs(h->c[2])}};
    s->a[0] = mt_frf_value(h, centre, &s->rounding[0]);
    for (int k = 0; k < h->n; k++) {
        const double d = p->anchor - h->re[k];
        const double off = d + p->a > 0.0 ? d + p->a : fmin(d + p->b, 0.0);
        const double near = 1.0 / hypot(off, h->im[k]);
        const double complex inverse = mt_frf_ratio(-1.0, mt_frf_from_pole(h, k, centre));
        double complex term = -mt_frf_times(h->rho[k], inverse);
        double size = cabs(h->rho[k]) * near;
        s->size[0] += size;
        for (int j = 1; j <= ORDER; j++) {
            size *= near;
            s->size[j] += size;
            if (j < ORDER) {
                term = mt_frf_times(term, inverse);
                s->a[j] += term;
            }
        }
    }
    for (int j = 1; j < ORDER; j++) {
        s->rounding[j] = s->size[j];
    }
}

/* The largest of f_1 t + f_2 t^2 for |t| <= h. */
static double parabola(double f1, double f2, double h)
{
    const double slope = fabs(f1);
    return f2 < 0.0 && slope <= -2.0 * f2 * h ? slope * slope / (-4.0 * f2)
                                              : h * (slope + (h * f2));
}

/* Upper bound of F over the interval. *floor: its part from rounding of F at the centre, which
 * halving does not reduce. */
static double bound(const mt_frf *h, const mt_panel *p, mt_near centre, double *floor)
{
    const double half = 0.5 * (p->b - p->a);
    double f[ORDER] = {0.0};
    double rest = 0.0;     /* coefficients from the third on, and the remainder */
    double rounding = 0.0; /* in units in the last place */
    double power = 1.0;    /* of half */
    series s;
    expand_about(h, p, centre, &s);
    for (int k = 0; k <= ORDER; k++) {
        double most = 0.0;
        for (int i = 0; i <= k; i++) {
            if (k < ORDER) {
                f[k] += creal(s.a[i] * conj(s.a[k - i]));
                rounding += 2.0 * power * cabs(s.a[i]) * s.rounding[k - i];
            }
            most += s.size[i] * s.size[k - i];
        }
        rest += k < 3 ? 0.0 : power * (k < ORDER ? fabs(f[k]) : most);
        power *= half;
    }
    const double unit = DBL_EPSILON * (ULPS + (double)h->n);
    const double off = unit * s.rounding[0];
    *floor = off * ((2.0 * cabs(s.a[0])) + off);
    return f[0] + parabola(f[1], f[2], half) + rest + (unit * rounding);
}

static void consider(search *s, const mt_panel *in, mt_near w)
{
    const double size = cabs(mt_frf_value(s->h, w, NULL));
    if (size * size > s->f) {
        s->f = size * size;
        s->at = w;
        s->in = *in;
    }
}

/* Newton's method for F' = 0 between neighbours of the best point, or halving. */
static void climb(search *s)
{
    const mt_panel in = s->in;
    double low = in.a;
    double high = in.b;
    double t = s->at.t;
    for (int step = 0; step < NEWTON_STEPS && low < high; step++) {
        double f[3];
        squared_gain_jet(s->h, (mt_near){in.anchor, t}, f);
        low = f[1] > 0.0 ? t : low;
        high = f[1] > 0.0 ? high : t;
        const double newton = f[2] < 0.0 ? t - (f[1] / f[2]) : HUGE_VAL;
        const double next = newton >= in.a && newton <= in.b ? newton : 0.5 * (low + high);
        if (next == t) {
            break;
        }
        t = next;
        consider(s, &in, (mt_near){in.anchor, t});
    }
}

/* Refine the place of the maximum, which F alone gives to half the digits: last steps of
 * Newton's method, while F does not decrease. */
static void refine_maximum(search *s)
{
    static const double same = 1.0 - (16.0 * DBL_EPSILON);
    for (int step = 0; step < LAST_STEPS; step++) {
        double f[3];
        squared_gain_jet(s->h, s->at, f);
        if (!(f[2] < 0.0)) {
            break;
        }
        const mt_near w = {s->at.anchor, s->at.t - (f[1] / f[2])};
        const double size = cabs(mt_frf_value(s->h, w, NULL));
        if (!(w.t > s->in.a && w.t < s->in.b && size * size >= same * s->f)) {
            break;
        }
        s->at = w;
    }
}

static mt_near centre_of(const mt_panel *p)
{
    return (mt_near){p->anchor, 0.5 * (p->a + p->b)};
}

/* Find a first best point from the ends and centres of the panels. */
static void find_first_maximum(search *s)
{
    mt_panels walk;
    mt_panel p;
    mt_panels_begin(&walk, s->h, s->lower, s->upper, 0.0);
    while (mt_panels_next(&walk, &p)) {
        const double before = s->f;
        consider(s, &p, (mt_near){p.anchor, p.a});
        consider(s, &p, (mt_near){p.anchor, p.b});
        consider(s, &p, centre_of(&p));
        if (s->f > before) {
            climb(s);
        }
    }
}

/* Halve one panel until all its parts are finished. */
static void exhaust(search *s, const mt_panel *panel)
{
    mt_panel stack[MT_PANEL_DEPTH];
    int depth = 0;
    stack[depth++] = *panel;
    while (depth > 0) {
        const mt_panel p = stack[--depth];
        const mt_near centre = centre_of(&p);
        double floor = 0.0;
        const double most = bound(s->h, &p, centre, &floor);
        const double before = s->f;
        consider(s, &p, centre);
        if (s->f > before * (1.0 + EXCESS)) {
            climb(s);
        }
        /* what rounding takes is not proven away by halving: the rest need not be smaller */
        const double may = (s->f * (1.0 + EXCESS)) + (2.0 * floor);
        if (most <= may || depth + 2 > MT_PANEL_DEPTH || s->left <= 0 ||
            !(p.a < centre.t && centre.t < p.b)) {
            s->proven = fmax(s->proven, most);
            continue;
        }
        s->left--;
        stack[depth++] = (mt_panel){p.anchor, centre.t, p.b};
        stack[depth++] = (mt_panel){p.anchor, p.a, centre.t};
    }
}

static void prove(search *s)
{
    mt_panels walk;
    mt_panel p;
    mt_panels_begin(&walk, s->h, s->lower, s->upper, 0.0);
    while (mt_panels_next(&walk, &p)) {
        exhaust(s, &p);
    }
    s->proven = walk.narrow ? HUGE_VAL : s->proven;
}

mt_sine_peak mt_sine_peak_find(const mt_frf *h, double lower, double upper)
{
    mt_sine_peak peak = {.value = nan(""), .omega = nan(""), .excess = nan(""), .pole = -1};
    search s = {.h = h, .lower = lower, .upper = upper, .f = -1.0, .left = MOST_INTERVALS};
    peak.end = mt_frf_judge(h, lower, upper, &peak.pole);
    if (peak.end != MT_FORCED_FINITE) {
        return peak;
    }
    const mt_panel all = {lower, 0.0, upper - lower};
    consider(&s, &all, (mt_near){lower, 0.0});
    if (upper > lower) {
        find_first_maximum(&s);
        climb(&s);
        prove(&s);
        refine_maximum(&s);
    } else {
        s.proven = s.f;
    }
    const double complex value = mt_frf_value(h, s.at, NULL);
    peak.value = cabs(value);
    peak.omega = fmin(fmax(s.at.anchor + s.at.t, lower), upper);
    peak.direction = peak.value > 0.0 ? conj(value) / peak.value : 0.0;
    peak.excess = s.f > 0.0 ? sqrt(fmax(s.proven / s.f, 1.0)) - 1.0 : 0.0;
    peak.at_edge = upper > lower && (peak.omega == lower || peak.omega == upper);
    return peak;
}
