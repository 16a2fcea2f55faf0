/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Integrals and responses in long double, by another rule than src/vibration has: double
 * exponential quadrature over intervals that are cut by hand. */
#ifndef VIBRATION_REFERENCE_H
#define VIBRATION_REFERENCE_H

#include <complex.h>
#include <math.h>
#include <stdbool.h>

#include "environment/vibration.h"
#include "response/poles.h"

#define REF_I  ((double complex)I)
#define REF_PI 3.14159265358979323846264338327950288L

/* Of x = from + d, d with all its digits. */
typedef long double ref_function(const void *ctx, long double from, long double d);

enum { REF_RULE = 130, REF_PLACES = (2 * REF_RULE) + 1 };

/* Of Takahasi and Mori's rule on an interval of half width 1: how far its places are from the
 * nearer end, and its weights. */
typedef struct ref_rule {
    bool made;
    long double rest[REF_PLACES];
    long double weight[REF_PLACES];
} ref_rule;

static inline const ref_rule *ref_rule_made(void)
{
    static ref_rule rule;
    const long double step = 1.0L / 32.0L;
    for (int i = 0; i < REF_PLACES && !rule.made; i++) {
        const long double t = step * (long double)(i - REF_RULE);
        const long double u = 0.5L * REF_PI * sinhl(t);
        /* 1 - |tanh u| */
        rule.rest[i] = 2.0L / (1.0L + expl(2.0L * fabsl(u)));
        rule.weight[i] = step * 0.5L * REF_PI * coshl(t) / (coshl(u) * coshl(u));
    }
    rule.made = true;
    return &rule;
}

/* On [a, b]: the integrand at a + d and b - d, d kept as it is. */
static inline long double ref_integral(ref_function *f, const void *ctx, long double a,
                                       long double b)
{
    const ref_rule *const rule = ref_rule_made();
    const long double half = 0.5L * (b - a);
    long double sum = 0.0L;
    for (int i = 0; i < REF_PLACES; i++) {
        const bool low = i < REF_RULE;
        const long double d = half * (low ? rule->rest[i] : -rule->rest[i]);
        const long double weight = half * rule->weight[i];
        if (weight > 0.0L && d != 0.0L) {
            sum += weight * f(ctx, low ? a : b, d);
        }
    }
    return sum;
}

/* H(from + d) of a pole sum, term by term. */
static inline long double complex ref_response(const mt_pole_sum *h, long double from,
                                               long double d)
{
    const long double complex i = (long double complex)I;
    const long double complex iw = (from + d) * i;
    long double complex sum = (long double complex)h->d[0] +
                              (iw * (long double complex)h->d[1]) +
                              (iw * iw * (long double complex)h->d[2]);
    for (int k = 0; k < h->n; k++) {
        const long double apart = (from - (long double)cimag(h->s[k])) + d;
        sum += (long double complex)h->residue[k] / ((apart * i) - (long double)creal(h->s[k]));
    }
    return sum;
}

/* |H(w)|. */
static inline double ref_size(const mt_pole_sum *h, double w)
{
    return (double)cabsl(ref_response(h, (long double)w, 0.0L));
}

/* Of a density log G = log_level + slope (log w - log_w). */
typedef struct ref_segment {
    const mt_pole_sum *h;
    long double log_w;
    long double log_level;
    long double slope;
} ref_segment;

static inline ref_segment ref_segment_of(const mt_pole_sum *h, const mt_psd *g, int i)
{
    const long double f[] = {(long double)g->hz[i], (long double)g->hz[i + 1]};
    const long double level[] = {(long double)g->level[i], (long double)g->level[i + 1]};
    return (ref_segment){.h = h,
                         .log_w = logl(2.0L * REF_PI * f[0]),
                         .log_level = logl(level[0]),
                         .slope = logl(level[1] / level[0]) / logl(f[1] / f[0])};
}

static inline long double ref_density(const void *ctx, long double from, long double d)
{
    const ref_segment *const s = ctx;
    const long double complex h = ref_response(s->h, from, d);
    const long double size = (creall(h) * creall(h)) + (cimagl(h) * cimagl(h));
    return size * expl(s->log_level + (s->slope * (logl(from + d) - s->log_w)));
}

enum { REF_CUTS = 4096, REF_POWERS = 24 };

typedef struct ref_cuts {
    int n;
    long double at[REF_CUTS];
} ref_cuts;

/* Put in its place, where it lies between the first and the last. */
static inline void ref_cut(ref_cuts *c, long double x)
{
    int i = c->n;
    if (c->n >= REF_CUTS || !(x > c->at[0] && x < c->at[c->n - 1])) {
        return;
    }
    for (; c->at[i - 1] > x; i--) {
        c->at[i] = c->at[i - 1];
    }
    c->at[i] = x;
    c->n++;
}

/* At octaves, at every resonance, and at 4^j times its half width on both sides. */
static inline void ref_cut_all(ref_cuts *c, const mt_pole_sum *h, long double lower,
                               long double upper)
{
    *c = (ref_cuts){.n = 2, .at = {lower, upper}};
    const int octaves = (int)log2l(upper / lower);
    for (int i = 1; i <= octaves; i++) {
        ref_cut(c, ldexpl(lower, i));
    }
    for (int k = 0; k < h->n; k++) {
        const long double centre = (long double)cimag(h->s[k]);
        ref_cut(c, centre);
        for (int j = 0; j < REF_POWERS; j++) {
            const long double width = ldexpl(fabsl((long double)creal(h->s[k])), 2 * j);
            ref_cut(c, centre - width);
            ref_cut(c, centre + width);
        }
    }
}

static inline long double ref_end(double hz, bool rounded)
{
    return rounded ? (long double)(6.28318530717958647693 * hz)
                   : 2.0L * REF_PI * (long double)hz;
}

/* Integral of |H|^2 G df; `rounded`: ends are 2 pi f as a double has it. */
static inline long double ref_mean_square(const mt_pole_sum *h, const mt_psd *g, bool rounded)
{
    static ref_cuts cuts;
    long double total = 0.0L;
    for (int i = 0; i + 1 < g->n; i++) {
        if (g->hz[i] < g->hz[i + 1]) { /* no jump */
            const ref_segment s = ref_segment_of(h, g, i);
            ref_cut_all(&cuts, h, ref_end(g->hz[i], rounded), ref_end(g->hz[i + 1], rounded));
            for (int k = 0; k + 1 < cuts.n; k++) {
                if (cuts.at[k] < cuts.at[k + 1]) {
                    total += ref_integral(ref_density, &s, cuts.at[k], cuts.at[k + 1]);
                }
            }
        }
    }
    return total / (2.0L * REF_PI);
}

/* Poles and residues of one mass on spring and dashpot, natural frequency w [rad/s]. The
 * response of: */
typedef enum ref_kind {
    REF_RELATIVE, /* relative displacement to base acceleration, -1/(w^2 - ...) */
    REF_ABSOLUTE, /* absolute acceleration to base acceleration */
    REF_FORCE     /* displacement to force per mass */
} ref_kind;

static inline mt_pole_sum ref_one_mass(double w, double zeta, ref_kind kind,
                                       double complex s[2], double complex r[2])
{
    const double complex root = zeta < 1.0 ? sqrt(1.0 - (zeta * zeta)) * REF_I
                                           : (double complex)sqrt((zeta * zeta) - 1.0);
    s[0] = w * (-zeta + root);
    s[1] = w * (-zeta - root);
    for (int k = 0; k < 2; k++) {
        const double complex gap = s[k] - s[1 - k];
        r[k] = (kind == REF_ABSOLUTE ? (w * w) + (2.0 * zeta * w * s[k])
                                     : (double complex)(kind == REF_FORCE ? 1.0 : -1.0)) /
               gap;
    }
    if (zeta < 1.0) { /* exactly so, as of a real system */
        s[1] = conj(s[0]);
        r[1] = conj(r[0]);
    }
    return (mt_pole_sum){.n = 2, .s = s, .residue = r};
}

#endif
