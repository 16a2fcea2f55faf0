/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Densities and RMS of responses: panels of a range, integrals in closed form and over panels,
 * and their derivatives. */
#include "vibration/spectral.h"

#include <float.h>
#include <math.h>

/*
 * An interval of frequencies cut into panels on which a response is smooth. A panel with centre
 * c and half width h has Bernstein ellipses: foci at its ends, semi-axes (r +- 1/r) h / 2. A
 * function that is analytic within the ellipse r and at most M there is integrated by Gauss's
 * rule with n nodes to
 *     |error| <= (64/15) M h r^(-2 n) / (1 - r^(-2))     (Trefethen, SIAM Review 50, 2008)
 * Panels are halved until all poles, their conjugates and, for powers of w, 0 lie outside the
 * ellipse PANEL_CLEAR; bounds are taken on PANEL_INNER. The ends of a panel are stored as
 * distances from the nearest pole (or end of the interval), so that the distance from a pole
 * has all its digits for any narrow resonance.
 */
#define PANEL_CLEAR 3.0
#define PANEL_INNER 2.5

#define TWO_PI 6.28318530717958647693

/* A segment of a density: G = (w / lower)^exponent from lower to upper [rad/s]. */
typedef struct spectral_segment {
    double lower;
    double upper;
    double exponent;
} spectral_segment;

/* An integral over a segment with the bound of its error. */
typedef struct spectral_sum {
    double value;
    double bound;
} spectral_sum;

static double spectral_ulps(const mt_frf *h);

/* Panels. */

static const double PI = 3.14159265358979323846;
/* w^b: the ends of a panel differ by at most this factor, and w^b by exp of the other. */
static const double MOST_RATIO = 2.0;
static const double MOST_GROWTH = 4.0;
/* Newton's method on the Legendre polynomial ends at rounding after so many steps. */
enum { NEWTON_STEPS = 6 };

void mt_panels_gauss(mt_gauss *g)
{
    const int n = MT_GAUSS_NODES;
    for (int i = 0; i < n / 2; i++) {
        double x = cos(PI * (i + 0.75) / (n + 0.5)); /* the root is next to it */
        double slope = 1.0;
        for (int step = 0; step < NEWTON_STEPS; step++) {
            double p = 1.0;
            double before = 0.0;
            for (int k = 0; k < n; k++) {
                const double next = (((2 * k) + 1) * x * p - (k * before)) / (k + 1);
                before = p;
                p = next;
            }
            slope = n * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        g->node[i] = -x;
        g->node[n - 1 - i] = x;
        g->weight[i] = 2.0 / ((1.0 - x * x) * slope * slope);
        g->weight[n - 1 - i] = g->weight[i];
    }
}

/* True where the pole lies outside the ellipse `clear` of the panel. */
static bool panels_clears(const mt_frf *h, int k, const mt_panel *panel, double clear)
{
    const double d = panel->anchor - h->re[k];
    const double sum = hypot(d + panel->a, h->im[k]) + hypot(d + panel->b, h->im[k]);
    return sum >= (clear + (1.0 / clear)) * 0.5 * (panel->b - panel->a);
}

static bool is_smooth(const mt_panels *p, const mt_panel *panel)
{
    const double begin = panel->anchor + panel->a;
    const double width = panel->b - panel->a;
    if (p->exponent != 0.0 && (width > (MOST_RATIO - 1.0) * begin ||
                               width * fabs(p->exponent) > MOST_GROWTH * begin)) {
        return false;
    }
    for (int k = 0; k < p->h->n; k++) {
        if (!panels_clears(p->h, k, panel, PANEL_CLEAR)) {
            return false;
        }
    }
    return true;
}

/* The next frequency of a pole above `at`, or the interval's end. */
static double next_anchor(const mt_panels *p, double at)
{
    double next = p->upper;
    for (int k = 0; k < p->h->n; k++) {
        const double re = p->h->re[k];
        next = re > at && re < next ? re : next;
    }
    return next;
}

void mt_panels_begin(mt_panels *p, const mt_frf *h, double lower, double upper, double exponent)
{
    *p = (mt_panels){.h = h, .upper = upper, .exponent = exponent, .at = lower};
    p->next = next_anchor(p, lower);
    p->depth = 1;
    p->stack[0] = (mt_panel){lower, 0.0, 0.5 * (p->next - lower)};
    p->right = true;
}

/* Put the half that follows on the empty stack; false: there is none. */
static bool push_next_half(mt_panels *p)
{
    if (!p->right) {
        if (!(p->next < p->upper)) {
            return false;
        }
        p->at = p->next;
        p->next = next_anchor(p, p->at);
    }
    const double half = 0.5 * (p->next - p->at);
    p->stack[0] = p->right ? (mt_panel){p->next, -half, 0.0} : (mt_panel){p->at, 0.0, half};
    p->right = !p->right;
    p->depth = 1;
    return true;
}

bool mt_panels_next(mt_panels *p, mt_panel *out)
{
    while (p->depth > 0 || push_next_half(p)) {
        const mt_panel panel = p->stack[--p->depth];
        if (is_smooth(p, &panel)) {
            *out = panel;
            return true;
        }
        const double middle = 0.5 * (panel.a + panel.b);
        if (p->depth + 2 > MT_PANEL_DEPTH || !(panel.a < middle && middle < panel.b)) {
            p->narrow = true;
            return false;
        }
        p->stack[p->depth++] = (mt_panel){panel.anchor, middle, panel.b};
        p->stack[p->depth++] = (mt_panel){panel.anchor, panel.a, middle};
    }
    return false;
}

/* A bound of |H| on the ellipse PANEL_INNER of a panel whose ellipse PANEL_CLEAR contains
 * no pole. */
static double panels_bound(const mt_frf *h, const mt_panel *panel)
{
    const double half = 0.5 * (panel->b - panel->a);
    const double centre = 0.5 * (panel->a + panel->b);
    const double axis = 0.5 * (PANEL_INNER + (1.0 / PANEL_INNER)) * half;
    /* confocal ellipses are nearest to each other where their long axes end */
    const double gap = (0.5 * (PANEL_CLEAR + (1.0 / PANEL_CLEAR)) * half) - axis;
    const double most = panel->anchor + centre + axis;
    double sum = cabs(h->c[0]) + (most * (cabs(h->c[1]) + (most * cabs(h->c[2]))));
    for (int k = 0; k < h->n; k++) {
        const double distance = hypot((panel->anchor - h->re[k]) + centre, h->im[k]);
        sum += cabs(h->rho[k]) / fmax(gap, distance - axis);
    }
    return sum;
}

/* The truncation error of Gauss's rule divided by M h, see above. */
static double panels_truncation(void)
{
    const double inverse = 1.0 / PANEL_INNER;
    const double square = inverse * inverse;
    return 64.0 / 15.0 * pow(square, MT_GAUSS_NODES) / (1.0 - square);
}

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

static void cut(piece *on, const mt_gauss *g, const spectral_segment *all, double from,
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
static int count_pieces(const spectral_segment *segment)
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
static void add_polynomial(const mt_spectral *r, const spectral_segment *segment, double ulps,
                           total *t)
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

/* Integral of |H|^2 (w / lower)^exponent dw in closed form, see above. Where the
 * closed form cannot be used, the bound is infinite. */
static spectral_sum spectral_closed(const mt_spectral *r, const spectral_segment *segment)
{
    const mt_gauss *const g = &r->gauss;
    const mt_frf *const h = &r->h;
    /* (w / lower)^b has b times the error of w / lower */
    const double ulps = spectral_ulps(h) + (ULPS_OF_A_QUOTIENT * fabs(segment->exponent));
    total t = {0.0, 0.0};
    add_polynomial(r, segment, ulps, &t);
    if (segment->exponent == 0.0) {
        for (int k = 0; k < h->n; k++) {
            const kernel f = of_logarithm(h, k, segment->lower, segment->upper);
            add_pole(r, k, &f, ulps, &t);
        }
        return (spectral_sum){t.value, t.size * DBL_EPSILON};
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
            if (panels_clears(h, k, &panel, PANEL_CLEAR)) {
                far_from(h, k, &on, &f);
            } else {
                next_to(h, k, &on, g, &f);
            }
            add_pole(r, k, &f, ulps, &t);
        }
        from = to;
    }
    const double bound = t.size * DBL_EPSILON;
    return (spectral_sum){t.value, bound == bound ? bound : HUGE_VAL};
}

/* The density and the RMS, by the method with the smaller bound. */

/* A closed form whose bound is below this part of its value needs no second opinion. */
static const double CLOSED_ENOUGH = 1e-11;
/* What rounding takes of one term: a quotient or product of complex numbers and the weight. */
static const double ULPS_OF_A_TERM = 8.0;
/* On the inner ellipse of a panel w^b is at most this times what it is at the nodes: the
 * ellipse goes beyond the panel by 0.45 of its half width, which is at most 2 / |b| of its
 * begin. */
static const double GROWTH = 4.0;

/* Bound of the rounding error of a sum over all poles, in units in the last place. */
static double spectral_ulps(const mt_frf *h)
{
    return (double)h->n + ULPS_OF_A_TERM;
}

/* R_k of the partial fractions. */
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
    if (mt_frf_judge(&r->h, TWO_PI * hz, TWO_PI * hz, &pole) == MT_FORCED_INFINITE) {
        return HUGE_VAL;
    }
    const double size = cabs(mt_frf_value(&r->h, (mt_near){TWO_PI * hz, 0.0}, NULL));
    return size * size * g;
}

static spectral_segment spectral_segment_of(const mt_psd *input, int i)
{
    return (spectral_segment){.lower = TWO_PI * input->hz[i],
                              .upper = TWO_PI * input->hz[i + 1],
                              .exponent = mt_psd_exponent(input, i)};
}

/* G at a frequency of the segment. */
static double spectral_power(const spectral_segment *segment, mt_near w)
{
    const double omega = w.anchor + w.t;
    return segment->exponent == 0.0
               ? 1.0
               : exp(segment->exponent * mt_psd_log_ratio(segment->lower, omega));
}

/* The same over panels. */
static spectral_sum over_panels(const mt_spectral *r, const spectral_segment *segment)
{
    const mt_gauss *const g = &r->gauss;
    const mt_frf *const h = &r->h;
    const double truncation = panels_truncation();
    const double ulps = spectral_ulps(h);
    const double grows = 1.0 + fabs(segment->exponent);
    spectral_sum sum = {0.0, 0.0};
    double rounding = 0.0;
    mt_panels walk;
    mt_panel on;
    mt_panels_begin(&walk, h, segment->lower, segment->upper, segment->exponent);
    while (mt_panels_next(&walk, &on)) {
        const double half = 0.5 * (on.b - on.a);
        double most = 0.0; /* of w^b at the nodes */
        for (int i = 0; i < MT_GAUSS_NODES; i++) {
            const mt_near w = {on.anchor, on.a + (half * (1.0 + g->node[i]))};
            const double weight = half * g->weight[i] * spectral_power(segment, w);
            double size = 0.0;
            const double value = cabs(mt_frf_value(h, w, &size));
            sum.value += weight * value * value;
            rounding +=
                weight * value * ((2.0 * ulps * size) + (grows * ULPS_OF_A_TERM * value));
            most = fmax(most, weight / (half * g->weight[i]));
        }
        const double bound = panels_bound(h, &on);
        sum.bound += truncation * half * most * (segment->exponent == 0.0 ? 1.0 : GROWTH) *
                     bound * bound;
    }
    sum.bound = walk.narrow ? HUGE_VAL : sum.bound + (DBL_EPSILON * rounding);
    return sum;
}

/* Error by the rounding of 2 pi f at the ends of the segment: significant next to narrow
 * resonances only. */
static double at_ends(const mt_spectral *r, const spectral_segment *segment)
{
    const double ends[] = {segment->lower, segment->upper};
    double sum = 0.0;
    for (int i = 0; i < MT_COUNT(ends); i++) {
        const mt_near w = {ends[i], 0.0};
        const double size = cabs(mt_frf_value(&r->h, w, NULL));
        sum += ends[i] * size * size * spectral_power(segment, w);
    }
    return DBL_EPSILON * sum;
}

static spectral_sum best(const mt_spectral *r, const spectral_segment *segment,
                         mt_spectral_method way, bool *closed)
{
    *closed = way != MT_SPECTRAL_PANELS;
    spectral_sum a = {.bound = HUGE_VAL};
    if (way != MT_SPECTRAL_PANELS) {
        a = spectral_closed(r, segment);
        if (way == MT_SPECTRAL_CLOSED || a.bound <= CLOSED_ENOUGH * a.value) {
            return a;
        }
    }
    const spectral_sum b = over_panels(r, segment);
    *closed = a.bound < b.bound;
    return *closed ? a : b;
}

/* True where the response is not finite; *a is then the answer with the reason. */
static bool is_refused(const mt_spectral *r, const mt_psd *input, mt_spectral_answer *a)
{
    *a = (mt_spectral_answer){.rms = nan(""), .bound = nan(""), .pole = -1};
    a->end =
        mt_frf_judge(&r->h, TWO_PI * input->hz[0], TWO_PI * input->hz[input->n - 1], &a->pole);
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
        const spectral_segment segment = spectral_segment_of(input, i);
        bool closed = false;
        if (!(segment.upper > segment.lower)) {
            continue;
        }
        const spectral_sum sum = best(r, &segment, way, &closed);
        square += input->level[i] * sum.value / TWO_PI;
        bound += input->level[i] * (sum.bound + at_ends(r, &segment)) / TWO_PI;
        a.n_closed += closed ? 1 : 0;
    }
    a.rms = sqrt(fmax(square, 0.0));
    a.bound = mt_spectral_root_bound(bound, a.rms);
    return a;
}

/* Derivatives of the RMS. */

/* A node of the integral that is d RMS. */
typedef struct node {
    mt_near w;
    double complex weight;
} node;

typedef struct nodes {
    const mt_spectral *r;
    const mt_psd *input;
    double rms;
    int segment;
    spectral_segment of;
    mt_panels walk;
    mt_panel on;
    int i; /* the next node of the panel */
    bool walking;
} nodes;

/* False where there is no derivative. */
static bool begin_nodes(nodes *n, const mt_spectral *r, const mt_psd *input)
{
    const mt_spectral_answer a = mt_spectral_rms(r, input, MT_SPECTRAL_BEST);
    *n = (nodes){.r = r, .input = input, .rms = a.rms, .segment = -1, .i = MT_GAUSS_NODES};
    return a.end == MT_FORCED_FINITE && a.rms > 0.0;
}

static bool next_panel(nodes *n)
{
    while (!n->walking || !mt_panels_next(&n->walk, &n->on)) {
        if (++n->segment + 1 >= n->input->n) {
            return false;
        }
        n->of = spectral_segment_of(n->input, n->segment);
        n->walking = n->of.upper > n->of.lower;
        if (n->walking) {
            mt_panels_begin(&n->walk, &n->r->h, n->of.lower, n->of.upper, n->of.exponent);
        }
    }
    n->i = 0;
    return true;
}

static bool next(nodes *n, node *out)
{
    if (n->i >= MT_GAUSS_NODES && !next_panel(n)) {
        return false;
    }
    const double half = 0.5 * (n->on.b - n->on.a);
    const mt_near w = {n->on.anchor, n->on.a + (half * (1.0 + n->r->gauss.node[n->i]))};
    const double g = n->input->level[n->segment] * spectral_power(&n->of, w);
    *out = (node){.w = w,
                  .weight = (half * n->r->gauss.weight[n->i] * g / (TWO_PI * n->rms)) *
                            conj(mt_frf_value(&n->r->h, w, NULL))};
    n->i++;
    return true;
}

mt_status mt_spectral_slope_nodes(const mt_spectral *r, const mt_psd *input, mt_arena *mem,
                                  mt_spectral_nodes *out, mt_err *err)
{
    nodes walk;
    node at;
    int room = 0;
    *out = (mt_spectral_nodes){.n = 0};
    if (!begin_nodes(&walk, r, input)) {
        return MT_OK;
    }
    const nodes again = walk;
    while (next(&walk, &at)) {
        room++;
    }
    out->omega = mt_arena_f64(mem, (size_t)room, 1);
    out->weight = mt_arena_alloc(mem, (size_t)room, sizeof *out->weight);
    MT_TRY(mt_arena_check(mem, err));
    walk = again;
    while (next(&walk, &at)) {
        out->omega[out->n] = at.w.anchor + at.w.t;
        out->weight[out->n++] = at.weight;
    }
    return MT_OK;
}

void mt_spectral_slopes(const mt_spectral *r, const mt_psd *input, double complex *by_s,
                        double complex *by_residue, double complex *by_d)
{
    const mt_frf *const h = &r->h;
    nodes walk;
    node at;
    for (int k = 0; k < r->sum->n; k++) {
        by_s[k] = 0.0;
        by_residue[k] = 0.0;
    }
    for (int j = 0; j < MT_COUNT(h->c); j++) {
        by_d[j] = 0.0;
    }
    if (!begin_nodes(&walk, r, input)) {
        return;
    }
    while (next(&walk, &at)) {
        mt_frf_pull(h, at.w, at.weight, by_s, by_residue, by_d);
    }
}
