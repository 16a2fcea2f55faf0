/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Ring-down. Of x = A exp(-zeta w t) cos(w_d t + phi), w_d = w sqrt(1 - zeta^2), the turnings
 * follow each other after pi/w_d, and so do the swings between them become less by the factor
 * exp(-d), d = pi zeta/sqrt(1 - zeta^2), whatever the level that it swings about:
 *     zeta = d/sqrt(pi^2 + d^2).
 */
#include "simulate/reading.h"

#include <math.h>

#include "linalg/dense.h"

static const double PI = 3.14159265358979323846;

static double swing(const mt_turnings *t, int i)
{
    return fabs(t->at[i + 1].value - t->at[i].value);
}

static double damping_of(const mt_turnings *t)
{
    const int swings = t->n - 1;
    const double first = swings > 1 ? swing(t, 0) : 0.0;
    const double last = swings > 1 ? swing(t, swings - 1) : 0.0;
    if (!(first > 0.0) || !(last > 0.0)) {
        return nan("");
    }
    const double d = log(first / last) / (swings - 1);
    return d / hypot(PI, d);
}

mt_ring mt_ring_read(const mt_turnings *t)
{
    mt_ring r = {.hz = nan(""), .spread = nan(""), .amplitude = nan("")};
    double before = 0.0;
    double first = 0.0;
    double shortest = HUGE_VAL;
    double longest = 0.0;
    bool any = false;
    for (int i = 0; i < t->n; i++) {
        if (!t->at[i].highest) {
            continue;
        }
        if (any) {
            r.periods++;
            shortest = fmin(shortest, t->at[i].t - before);
            longest = fmax(longest, t->at[i].t - before);
        }
        first = any ? first : t->at[i].t;
        before = t->at[i].t;
        any = true;
    }
    if (r.periods > 0) {
        r.hz = r.periods / (before - first);
        r.spread = (longest - shortest) * r.hz;
    }
    r.amplitude = t->n > 1 ? 0.5 * swing(t, 0) : nan("");
    r.damping = damping_of(t);
    return r;
}

/* Columns 1, sin and cos of each harmonic. */
static void fill_harmonic_columns(int rows, const double *t, double w, double *a)
{
    for (ptrdiff_t i = 0; i < rows; i++) {
        a[i] = 1.0;
        for (ptrdiff_t h = 1; h <= MT_HARMONICS; h++) {
            a[i + ((2 * h - 1) * rows)] = sin((double)h * w * t[i]);
            a[i + (2 * h * rows)] = cos((double)h * w * t[i]);
        }
    }
}

static void write_steady_state(int rows, const double *a, const double *b, const double *x,
                               mt_steady *out)
{
    double largest = 0.0;
    out->mean = x[0];
    for (int h = 0; h < MT_HARMONICS; h++) {
        const double *const pair = x + 1 + ((ptrdiff_t)2 * h);
        out->amplitude[h] = hypot(pair[0], pair[1]);
        out->phase[h] = atan2(pair[1], pair[0]);
        largest = fmax(largest, out->amplitude[h]);
    }
    out->residual = 0.0;
    for (ptrdiff_t i = 0; i < rows; i++) {
        double r = -b[i];
        for (ptrdiff_t k = 0; k < 1 + (2 * MT_HARMONICS); k++) {
            r += a[i + (k * rows)] * x[k];
        }
        out->residual = fmax(out->residual, fabs(r));
    }
    out->residual /= largest > 0.0 ? largest : 1.0;
}

/* The last samples, of so many seconds. */
static mt_samples last_of(const mt_samples *s, double length)
{
    int first = s->n;
    while (first > 0 && s->t[s->n - 1] - s->t[first - 1] < length) {
        first--;
    }
    return (mt_samples){.n = s->n - first,
                        .stride = s->stride,
                        .t = s->t + first,
                        .x = s->x + ((ptrdiff_t)first * s->stride)};
}

/* *done false: the samples do not tell the harmonics apart. */
static mt_status fit(const mt_samples *s, double hz, bool *done, mt_arena *mem, mt_steady *out,
                     mt_err *err)
{
    /* rank of the columns */
    static const double DEPENDENT = 1e-9;
    const int columns = (2 * MT_HARMONICS) + 1;
    double *const a = mt_arena_f64(mem, (size_t)s->n, (size_t)columns);
    double *const b = mt_arena_f64(mem, (size_t)s->n, 1);
    double *const by = mt_arena_f64(mem, (size_t)columns, 1);
    mt_qr qr;
    MT_TRY(mt_arena_check(mem, err));
    fill_harmonic_columns(s->n, s->t, 2.0 * PI * hz, a);
    for (ptrdiff_t i = 0; i < s->n; i++) {
        b[i] = s->x[i * s->stride];
    }
    MT_TRY(mt_qr_factor(s->n, columns, a, s->n, DEPENDENT, mem, &qr, err));
    *done = qr.rank == columns;
    if (*done) {
        MT_TRY(mt_qr_solve(&qr, 1, b, by, mem, err));
        write_steady_state(s->n, a, b, by, out);
    }
    return MT_OK;
}

mt_status mt_steady_read(const mt_samples *s, double hz, int periods, mt_arena *scratch,
                         mt_steady *out, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    *out = (mt_steady){.periods = 0};
    const double length = s->n > 0 ? s->t[s->n - 1] - s->t[0] : 0.0;
    const int whole = (int)fmin(floor(length * hz), (double)periods);
    if (whole < 1) {
        return MT_OK;
    }
    const mt_samples last = last_of(s, whole / hz);
    bool done = false;
    if (last.n > 2 * MT_HARMONICS) {
        MT_TRY(fit(&last, hz, &done, scratch, out, err));
    }
    out->periods = done ? whole : 0;
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}
