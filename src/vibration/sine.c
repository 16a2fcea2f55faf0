/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * F = H conj H, F' = 2 Re(H' conj H), F'' = 2 Re(H'' conj H) + 2 |H'|^2. Over an interval of
 * half width h about c, with T_2 >= |H''| there (a sum over the poles by their distance from
 * the interval),
 *     |H'| <= |H'(c)| + h T_2,   |H| <= |H(c)| + h (|H'(c)| + h T_2).
 * Intervals begin as panels, which are as narrow next to a pole as it is, and the best of their
 * centres and ends is driven to a stationary point before any is halved: of the intervals about
 * a maximum, only a few of each size then are.
 */
#include "vibration/sine.h"

#include <float.h>
#include <math.h>

/* Proven of F; of |H| half of it. */
static const double EXCESS = 1e-10;
/* Intervals that are looked at before the search is content with what it can prove. */
enum { MOST_INTERVALS = 200000 };
enum { NEWTON_STEPS = 60, LAST_STEPS = 3 };

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
static void slopes(const mt_frf *h, mt_near w, double *f)
{
    double complex jet[3];
    mt_frf_jet(h, w, jet);
    f[0] = (creal(jet[0]) * creal(jet[0])) + (cimag(jet[0]) * cimag(jet[0]));
    f[1] = 2.0 * creal(jet[1] * conj(jet[0]));
    f[2] = 2.0 * (creal(jet[2] * conj(jet[0])) + (creal(jet[1]) * creal(jet[1])) +
                  (cimag(jet[1]) * cimag(jet[1])));
}

static double bend(const mt_frf *h, const mt_panel *p)
{
    double sum = 2.0 * cabs(h->c[2]);
    for (int k = 0; k < h->n; k++) {
        const double d = p->anchor - h->re[k];
        const double off = d + p->a > 0.0 ? d + p->a : fmin(d + p->b, 0.0);
        const double distance = hypot(off, h->im[k]);
        sum += 2.0 * cabs(h->rho[k]) / (distance * distance * distance);
    }
    return sum;
}

/* No frequency of the interval has more than that. */
static double bound(const mt_frf *h, const mt_panel *p, mt_near centre)
{
    const double half = 0.5 * (p->b - p->a);
    const double t2 = bend(h, p);
    double complex jet[3];
    mt_frf_jet(h, centre, jet);
    const double h1 = cabs(jet[1]) + (half * t2);
    const double h0 = cabs(jet[0]) + (half * h1);
    const double f = cabs(jet[0]) * cabs(jet[0]);
    const double slope = fabs(2.0 * creal(jet[1] * conj(jet[0])));
    return f + (half * (slope + (half * ((t2 * h0) + (h1 * h1)))));
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
        slopes(s->h, (mt_near){in.anchor, t}, f);
        low = f[1] > 0.0 ? t : low;
        high = f[1] > 0.0 ? high : t;
        const double newton = t - (f[1] / f[2]);
        const double next =
            f[2] < 0.0 && newton >= in.a && newton <= in.b ? newton : 0.5 * (low + high);
        if (next == t) {
            break;
        }
        t = next;
        consider(s, &in, (mt_near){in.anchor, t});
    }
}

/* The top is flat, and its place by F alone known to half the digits: the last steps of
 * Newton's method, as long as F does not tell the difference. */
static void settle(search *s)
{
    static const double same = 1.0 - (16.0 * DBL_EPSILON);
    for (int step = 0; step < LAST_STEPS; step++) {
        double f[3];
        slopes(s->h, s->at, f);
        const mt_near w = {s->at.anchor, s->at.t - (f[1] / f[2])};
        const double size = cabs(mt_frf_value(s->h, w, NULL));
        if (!(f[2] < 0.0 && w.t > s->in.a && w.t < s->in.b && size * size >= same * s->f)) {
            break;
        }
        s->at = w;
    }
}

static mt_near centre_of(const mt_panel *p)
{
    return (mt_near){p->anchor, 0.5 * (p->a + p->b)};
}

/* The panels as they are: a best point to begin with. */
static void look(search *s)
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

/* One panel, halved until all of it is done. */
static void exhaust(search *s, const mt_panel *panel)
{
    mt_panel stack[MT_PANEL_DEPTH];
    int depth = 0;
    stack[depth++] = *panel;
    while (depth > 0) {
        const mt_panel p = stack[--depth];
        const mt_near centre = centre_of(&p);
        const double most = bound(s->h, &p, centre);
        const double before = s->f;
        consider(s, &p, centre);
        if (s->f > before * (1.0 + EXCESS)) {
            climb(s);
        }
        if (most <= s->f * (1.0 + EXCESS) || depth + 2 > MT_PANEL_DEPTH || s->left <= 0 ||
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
        look(&s);
        climb(&s);
        prove(&s);
        settle(&s);
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
