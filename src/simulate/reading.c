/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Ring-down. Of x = A exp(-zeta w t) cos(w_d t + phi), w_d = w sqrt(1 - zeta^2), the turnings
 * follow each other after pi/w_d, and so do the swings between them become less by the factor
 * exp(-d), d = pi zeta/sqrt(1 - zeta^2), whatever the level that it swings about:
 *     zeta = d/sqrt(pi^2 + d^2).
 */
#include "simulate/reading.h"

#include <float.h>
#include <math.h>
#include <string.h>

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
    static const double RANK = 1e-9;
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
    MT_TRY(mt_qr_factor(s->n, columns, a, s->n, RANK, mem, &qr, err));
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

/*
 * With x_i = sum_k c_k z_k^i the matrix Y_ij = x_(i+j), n - l rows and l + 1 columns, has the
 * rank of the number of exponentials, and a right singular basis V of that rank whose rows obey
 *     (rows 1..l of V) = (rows 0..l-1 of V) S,   S with the eigenvalues z_k.
 * The singular values are those of R, Y = Q R. Then the c_k are least squares over the record,
 * z_k = exp((-zeta w + 2 pi i hz) dt); one that does not vibrate and has |z| = 1 is the mean.
 */

enum { SAMPLES_MOST = 2000, COLUMNS_MOST = 96, COLUMNS_LEAST = 2, POLES_MOST = 40 };
/* Singular values below this times the largest are what integration and rounding left. */
static const double NOISE = 1e-9;
/* Columns of the least squares that depend on others to this part. */
static const double DEPENDENT = 1e-13;
/* Weaker ones are not told. */
static const double WEAK = 1e-3;
/* A pole that turns by less than this per sample [rad] is the mean, or a drift. */
static const double STILL = 1e-7;

typedef struct record {
    int n;
    int l;
    double *x; /* [n] */
    int poles;
    double *re; /* [poles] ln z: decay and turn per sample */
    double *im;
} record;

/* y: n - l rows. */
static void hankel(const record *r, double *y)
{
    const ptrdiff_t rows = r->n - r->l;
    for (ptrdiff_t j = 0; j <= r->l; j++) {
        for (ptrdiff_t i = 0; i < rows; i++) {
            y[i + (j * rows)] = r->x[i + j];
        }
    }
}

/* Right singular vectors of Y, as rows: vt (l + 1 square); *rank: how many count. */
static mt_status basis(const record *r, double *vt, int *rank, mt_arena *mem, mt_err *err)
{
    const int columns = r->l + 1;
    const int rows = r->n - r->l;
    double *const y = mt_arena_f64(mem, (size_t)rows, (size_t)columns);
    double *const tri = mt_arena_f64(mem, (size_t)columns, (size_t)columns);
    double *const s = mt_arena_f64(mem, (size_t)columns, 1);
    mt_qr qr;
    MT_TRY(mt_arena_check(mem, err));
    hankel(r, y);
    MT_TRY(mt_qr_factor(rows, columns, y, rows, 0.0, mem, &qr, err));
    for (ptrdiff_t j = 0; j < columns; j++) {
        for (ptrdiff_t i = 0; i <= j; i++) {
            tri[i + ((ptrdiff_t)qr.perm[j] * columns)] = qr.qr[i + (j * rows)];
        }
    }
    MT_TRY(mt_svd(columns, columns, tri, s, NULL, vt, mem, err));
    *rank = 0;
    while (*rank < columns && *rank < POLES_MOST && 2 * *rank < columns &&
           s[*rank] > NOISE * s[0]) {
        ++*rank;
    }
    return MT_OK;
}

static mt_status find_poles(record *r, mt_arena *mem, mt_err *err)
{
    const int columns = r->l + 1;
    double *const vt = mt_arena_f64(mem, (size_t)columns, (size_t)columns);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(basis(r, vt, &r->poles, mem, err));
    const int k = r->poles;
    double *const first = mt_arena_f64(mem, (size_t)r->l, (size_t)k);
    double *const next = mt_arena_f64(mem, (size_t)r->l, (size_t)k);
    double *const shift = mt_arena_f64(mem, (size_t)k, (size_t)k);
    r->re = mt_arena_f64(mem, (size_t)k, 1);
    r->im = mt_arena_f64(mem, (size_t)k, 1);
    mt_qr qr;
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t p = 0; p < k; p++) {
        for (ptrdiff_t i = 0; i < r->l; i++) {
            first[i + (p * r->l)] = vt[p + (i * columns)];
            next[i + (p * r->l)] = vt[p + ((i + 1) * columns)];
        }
    }
    MT_TRY(mt_qr_factor(r->l, k, first, r->l, 0.0, mem, &qr, err));
    MT_TRY(mt_qr_solve(&qr, k, next, shift, mem, err));
    MT_TRY(mt_eig_general(k, shift, r->re, r->im, NULL, mem, err));
    for (int p = 0; p < k; p++) {
        const double re = r->re[p];
        const double im = r->im[p];
        r->re[p] = log(fmax(hypot(re, im), DBL_MIN));
        r->im[p] = atan2(im, re);
    }
    return MT_OK;
}

/* Sample at which the column of pole p has the size 1: the last one where it grows, as a record
 * of rounding may say, else the first. Its size at the first one then may underflow, but no
 * entry overflows. */
static int unit_sample(const record *r, int p)
{
    return r->re[p] * r->n > 1.0 ? r->n - 1 : 0;
}

/* Columns of the least squares: z^i, of a pair its real and imaginary part. dgeev has pairs
 * next to each other, the positive one first. */
static void fill_pole_columns(const record *r, double *a)
{
    for (int p = 0; p < r->poles; p++) {
        const bool second = p > 0 && r->im[p] < 0.0;
        double *const column = a + ((ptrdiff_t)p * r->n);
        const int unit = unit_sample(r, p);
        for (int i = 0; i < r->n; i++) {
            const double size = exp(r->re[p] * (i - unit));
            column[i] = size * (second ? -sin(r->im[p - 1] * i) : cos(r->im[p] * i));
        }
    }
}

static void add_tone(mt_tones *out, mt_tone tone)
{
    int at = out->n < MT_TONES_MOST ? out->n++ : MT_TONES_MOST - 1;
    if (out->tone[at].amplitude > tone.amplitude) {
        return; /* the list is full of stronger ones */
    }
    while (at > 0 && out->tone[at - 1].amplitude < tone.amplitude) {
        out->tone[at] = out->tone[at - 1];
        at--;
    }
    out->tone[at] = tone;
}

static void write_tones(const record *r, double dt, const double *a, const double *c,
                        mt_tones *out)
{
    double mean = 0.0;
    double largest = 0.0;
    for (int p = 0; p < r->poles; p++) {
        const double first = exp(-r->re[p] * unit_sample(r, p)); /* size at the first sample */
        if (fabs(r->im[p]) <= STILL) {
            mean += first * c[p];
        } else if (r->im[p] > 0.0 && p + 1 < r->poles) {
            add_tone(out, (mt_tone){.hz = r->im[p] / (2.0 * PI * dt),
                                    .damping = -r->re[p] / hypot(r->re[p], r->im[p]),
                                    .amplitude = first * hypot(c[p], c[p + 1]),
                                    .phase = atan2(c[p + 1], c[p])});
        }
    }
    out->residual = 0.0;
    for (ptrdiff_t i = 0; i < r->n; i++) {
        double left = -r->x[i];
        for (ptrdiff_t p = 0; p < r->poles; p++) {
            left += a[i + (p * r->n)] * c[p];
        }
        largest = fmax(largest, fabs(r->x[i] - mean));
        out->residual = fmax(out->residual, fabs(left));
    }
    out->residual /= largest > 0.0 ? largest : 1.0;
    while (out->n > 0 && !(out->tone[out->n - 1].amplitude > WEAK * out->tone[0].amplitude)) {
        out->n--;
    }
}

static mt_status read_record(record *r, double dt, mt_arena *mem, mt_tones *out, mt_err *err)
{
    mt_qr qr;
    MT_TRY(find_poles(r, mem, err));
    double *const a = mt_arena_f64(mem, (size_t)r->n, (size_t)r->poles);
    double *const c = mt_arena_f64(mem, (size_t)r->poles, 1);
    MT_TRY(mt_arena_check(mem, err));
    fill_pole_columns(r, a);
    MT_TRY(mt_qr_factor(r->n, r->poles, a, r->n, DEPENDENT, mem, &qr, err));
    MT_TRY(mt_qr_solve(&qr, 1, r->x, c, mem, err));
    write_tones(r, dt, a, c, out);
    return MT_OK;
}

mt_status mt_tones_read(int n, double dt_s, const double *x, int stride, mt_arena *scratch,
                        mt_tones *out, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    record r = {.n = n < SAMPLES_MOST ? n : SAMPLES_MOST};
    *out = (mt_tones){.residual = nan("")};
    if (r.n < 2 * COLUMNS_LEAST) {
        return MT_OK;
    }
    /* no more columns than rows */
    r.l = (r.n - 1) / 2 < COLUMNS_MOST ? (r.n - 1) / 2 : COLUMNS_MOST;
    r.x = mt_arena_f64(scratch, (size_t)r.n, 1);
    MT_TRY(mt_arena_check(scratch, err));
    for (ptrdiff_t i = 0; i < r.n; i++) {
        r.x[i] = x[i * stride];
    }
    if (mt_max_abs(r.n, r.x) > 0.0) {
        MT_TRY(read_record(&r, dt_s, scratch, out, err));
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}
