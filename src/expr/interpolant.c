/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * With chords m_k = (y_{k+1} - y_k) / h_k, h_k = x_{k+1} - x_k, the slope at an inner point is
 *   s_k = (sgn m_{k-1} + sgn m_k) min(|m_{k-1}|, |m_k|, |p_k| / 2),
 *   p_k = (m_{k-1} h_k + m_k h_{k-1}) / (h_{k-1} + h_k),
 * 0 at an extreme, and at most twice the smaller chord, for which a cubic between two points is
 * monotone. Its coefficients:
 *   c_k = (3 m_k - 2 s_k - s_{k+1}) / h_k,   d_k = (s_k + s_{k+1} - 2 m_k) / h_k^2.
 * What rounding makes of them may leave the points' range, or turn a slope, by roundings:
 * values are cut there to the range of both points, slopes to the sign of the chord.
 */
#include "expr/interpolant.h"

#include <float.h>
#include <math.h>

static double sign_of(double a)
{
    return (double)((a > 0.0) - (a < 0.0));
}

static double inner_slope(double before, double after, double h_before, double h_after)
{
    const double sum = h_before + h_after;
    const double p = (before * (h_after / sum)) + (after * (h_before / sum));
    const double least = fmin(fmin(fabs(before), fabs(after)), 0.5 * fabs(p));
    return (sign_of(before) + sign_of(after)) * least;
}

mt_status mt_interpolant_init(mt_interpolant *curve, const char *name, int n, const double *x,
                              const double *y, mt_arena *mem, mt_err *err)
{
    double *const s = mt_arena_f64(mem, (size_t)n, 1);
    double *const c = mt_arena_f64(mem, (size_t)n, 1);
    double *const d = mt_arena_f64(mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(mem, err));
    double before = 0.0;
    for (int k = 0; k + 1 < n; k++) {
        const double h = x[k + 1] - x[k];
        const double m = (y[k + 1] - y[k]) / h;
        s[k] = k == 0 ? m : inner_slope(before, m, x[k] - x[k - 1], h);
        c[k] = m; /* for now */
        before = m;
    }
    s[n - 1] = before;
    for (int k = 0; k + 1 < n; k++) {
        const double h = x[k + 1] - x[k];
        const double m = c[k];
        c[k] = ((3.0 * m) - (2.0 * s[k]) - s[k + 1]) / h;
        d[k] = (s[k] + s[k + 1] - (2.0 * m)) / h / h;
        if (!isfinite(m) || !isfinite(c[k]) || !isfinite(d[k])) {
            return mt_fail(err, MT_E_INPUT, "between x = %g and %g the curve is too steep",
                           x[k], x[k + 1]);
        }
    }
    *curve = (mt_interpolant){name, n, x, y, s, c, d};
    return MT_OK;
}

/* x, or the end of the curve that it is but for rounding: 9*mm is a neighbour of 9 mm. */
static double at_end(const mt_interpolant *curve, double x)
{
    static const double ROUNDED = 4.0 * DBL_EPSILON;
    if (curve->n < 2) {
        return x;
    }
    const double low = curve->x[0];
    const double high = curve->x[curve->n - 1];
    const double more = ROUNDED * fmax(fabs(low), fabs(high));
    const bool is_low = x < low && x >= low - more;
    const bool is_high = x > high && x <= high + more;
    return is_low ? low : is_high ? high : x;
}

/* The piece that x is in; -1: none, as of a curve that could not be made. */
static int piece_at(const mt_interpolant *curve, double x)
{
    int low = 0;
    int high = curve->n - 1;
    if (high < 1 || !(curve->x[0] <= x && x <= curve->x[high])) {
        return -1;
    }
    while (high - low > 1) {
        const int middle = low + ((high - low) / 2);
        if (curve->x[middle] <= x) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

/* Range of a piece's points. */
static mt_interval range_of_points(const mt_interpolant *curve, int k)
{
    return (mt_interval){fmin(curve->y[k], curve->y[k + 1]),
                         fmax(curve->y[k], curve->y[k + 1])};
}

/* Slopes that a piece may have: of the sign of its chord. */
static mt_interval slopes_of(const mt_interpolant *curve, int k)
{
    const double rise = curve->y[k + 1] - curve->y[k];
    return (mt_interval){rise > 0.0 ? 0.0 : -DBL_MAX, rise < 0.0 ? 0.0 : DBL_MAX};
}

static double cut(double v, mt_interval to)
{
    return fmin(fmax(v, to.lo), to.hi);
}

void mt_interpolant_at(const mt_interpolant *curve, double where, double out[3])
{
    const double x = at_end(curve, where);
    const int k = piece_at(curve, x);
    if (k < 0) {
        out[0] = nan("");
        out[1] = nan("");
        out[2] = nan("");
        return;
    }
    const double t = x - curve->x[k];
    const double s = curve->s[k];
    const double c = curve->c[k];
    const double d = curve->d[k];
    out[0] = cut(curve->y[k] + (t * (s + (t * (c + (t * d))))), range_of_points(curve, k));
    out[1] = cut(s + (t * ((2.0 * c) + (t * (3.0 * d)))), slopes_of(curve, k));
    out[2] = (2.0 * c) + (6.0 * d * t);
}

/* What rounding makes of a value of this piece, and of its monotony: eight roundings of the sum
 * of its terms' sizes, counted eightfold. */
static double rounding_of(const mt_interpolant *curve, int k)
{
    enum { COUNTED = 64 };
    const double h = curve->x[k + 1] - curve->x[k];
    const double size =
        fabs(curve->y[k]) +
        (h * (fabs(curve->s[k]) + (h * (fabs(curve->c[k]) + (h * fabs(curve->d[k]))))));
    return size > 0.0 ? (COUNTED * DBL_EPSILON * size) + (COUNTED * DBL_TRUE_MIN) : 0.0;
}

/* Values of piece k within a: of a monotone one those at the ends of its part. */
static mt_interval values_within(const mt_interpolant *curve, int k, mt_interval a)
{
    const mt_interval range = range_of_points(curve, k);
    const double more = rounding_of(curve, k);
    double from[3] = {curve->y[k], 0.0, 0.0};
    double to[3] = {curve->y[k + 1], 0.0, 0.0};
    if (a.lo > curve->x[k]) {
        mt_interpolant_at(curve, a.lo, from);
    }
    if (a.hi < curve->x[k + 1]) {
        mt_interpolant_at(curve, a.hi, to);
    }
    return (mt_interval){cut(fmin(from[0], to[0]) - more, range),
                         cut(fmax(from[0], to[0]) + more, range)};
}

static mt_interval just(double a)
{
    return mt_interval_of(a, a);
}

static mt_interval slopes_within(const mt_interpolant *curve, int k, mt_interval a)
{
    const mt_interval x = {fmax(a.lo, curve->x[k]), fmin(a.hi, curve->x[k + 1])};
    const mt_interval t = mt_interval_sub(x, just(curve->x[k]));
    const mt_interval twice = mt_interval_mul(just(2.0), just(curve->c[k]));
    const mt_interval thrice = mt_interval_mul(just(3.0), just(curve->d[k]));
    const mt_interval rest = mt_interval_add(twice, mt_interval_mul(t, thrice));
    const mt_interval slope = mt_interval_add(just(curve->s[k]), mt_interval_mul(t, rest));
    const mt_interval kept = slopes_of(curve, k);
    return mt_interval_of(cut(slope.lo, kept), cut(slope.hi, kept));
}

void mt_interpolant_enclose(const mt_interpolant *curve, mt_interval of, mt_interval *values,
                            mt_interval *slopes)
{
    const mt_interval a = {at_end(curve, of.lo), at_end(curve, of.hi)};
    const int first = piece_at(curve, a.lo);
    const int last = piece_at(curve, a.hi);
    mt_interval v = mt_interval_of(-HUGE_VAL, HUGE_VAL);
    mt_interval s = v;
    for (int k = first; first >= 0 && k <= last; k++) {
        if (values != NULL) {
            const mt_interval part = values_within(curve, k, a);
            v = k == first ? part : mt_interval_hull(v, part);
        }
        if (slopes != NULL) {
            const mt_interval part = slopes_within(curve, k, a);
            s = k == first ? part : mt_interval_hull(s, part);
        }
    }
    if (values != NULL) {
        *values = v;
    }
    if (slopes != NULL) {
        *slopes = s;
    }
}
