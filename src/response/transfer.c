/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One frequency. With q = D^-1 beta and the adjoint D a = sigma^T (D is symmetric):
 *     H = sigma q + rest,      dH/dw = sigma' q + sigma q' + rest',   D q' = beta' - D' q,
 *     error of H by an error dD of D: a^T dD q.
 * D as the sum of its terms is off by a few roundings of |g| + w |c| + w^2 |m|, entry by entry,
 * which its factor does not make worse (the rows are scaled to a diagonal of terms of size 1,
 * and the solution is refined once). An eigenvalue that is off by e_j is an error e_j on the
 * diagonal, and the modes that belong to such eigenvalues are turned into each other as by
 * errors of sqrt(e_j e_k) beside it.
 */
#include "response/transfer.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "linalg/ldl.h"

/* Roundings that an entry of D, or a sum of products, is off by. */
static const double ROUNDINGS = 8.0;

/* One frequency at work. */
typedef struct work {
    const mt_transfer *t;
    double w;
    double complex power[MT_FORCED_POWERS];  /* s^p */
    double complex dpower[MT_FORCED_POWERS]; /* its derivative with respect to w */
    double complex *d;                       /* n x n scaled factor of D, or [n] D */
    double complex *whole;                   /* n x n: D itself; NULL: diagonal */
    double *scale;                           /* [n] rows and columns of the factor */
    mt_complex_ldl factor;
    bool *resonant; /* [n] diagonal: D_j is 0, to rounding */
    bool any_resonant;
    double complex *q;  /* n x n_in */
    double complex *dq; /* the same; NULL */
    double complex *a;  /* n x n_out; NULL */
} work;

static void set_powers(work *k)
{
    double complex p = 1.0;
    double complex dp = 0.0;
    for (int i = 0; i < MT_FORCED_POWERS; i++) {
        k->power[i] = p;
        k->dpower[i] = dp;
        dp = mt_complex(0.0, (double)(i + 1)) * p;
        p = mt_complex(0.0, k->w) * p;
    }
}

/* Sum of the terms' sizes in entry (i, j). */
static double terms_of(const work *k, ptrdiff_t at)
{
    const mt_transfer *const t = k->t;
    const double c = t->c == NULL ? 0.0 : fabs(t->c[at]);
    return fabs(creal(t->g[at])) + fabs(cimag(t->g[at])) + (k->w * c) +
           (k->w * k->w * fabs(t->m[at]));
}

static double complex entry_of(const work *k, ptrdiff_t at)
{
    const mt_transfer *const t = k->t;
    const double c = t->c == NULL ? 0.0 : t->c[at];
    return t->g[at] - (k->w * k->w * t->m[at]) + mt_complex(0.0, k->w * c);
}

/* dD/dw. */
static double complex entry_slope(const work *k, ptrdiff_t at)
{
    const mt_transfer *const t = k->t;
    return (-2.0 * k->w * t->m[at]) + mt_complex(0.0, t->c == NULL ? 0.0 : t->c[at]);
}

static mt_status factor_dynamic_stiffness(work *k, mt_arena *mem, mt_err *err)
{
    const ptrdiff_t n = k->t->n;
    k->d = mt_arena_alloc(mem, (size_t)n * (k->t->diagonal ? 1 : (size_t)n), sizeof *k->d);
    k->scale = mt_arena_f64(mem, (size_t)n, 1);
    k->resonant = mt_arena_alloc(mem, (size_t)n, sizeof *k->resonant);
    MT_TRY(mt_arena_check(mem, err));
    if (k->t->diagonal) {
        for (ptrdiff_t j = 0; j < n; j++) {
            const double own = k->t->error == NULL ? 0.0 : k->t->error[j];
            k->d[j] = entry_of(k, j);
            k->resonant[j] = cabs(k->d[j]) <= own + (ROUNDINGS * DBL_EPSILON * terms_of(k, j));
            k->any_resonant = k->any_resonant || k->resonant[j];
        }
        return MT_OK;
    }
    k->whole = mt_arena_alloc(mem, (size_t)(n * n), sizeof *k->whole);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t j = 0; j < n; j++) {
        const double size = terms_of(k, j + (j * n));
        k->scale[j] = size > 0.0 ? 1.0 / sqrt(size) : 1.0;
    }
    for (ptrdiff_t j = 0; j < n; j++) {
        for (ptrdiff_t i = j; i < n; i++) {
            const double complex own = entry_of(k, i + (j * n));
            k->whole[i + (j * n)] = own;
            k->whole[j + (i * n)] = own;
            k->d[i + (j * n)] = k->scale[i] * k->scale[j] * own;
        }
    }
    return mt_complex_factor((int)n, k->d, mem, &k->factor, err);
}

/* r := b - D x, n x cols. */
static void residual_of_solution(const work *k, int cols, const double complex *b,
                                 const double complex *x, double complex *r)
{
    const ptrdiff_t n = k->t->n;
    memcpy(r, b, (size_t)n * (size_t)cols * sizeof *r);
    for (ptrdiff_t j = 0; j < n; j++) {
        for (ptrdiff_t i = 0; i < n; i++) {
            for (ptrdiff_t c = 0; c < cols; c++) {
                r[i + (c * n)] -= mt_times(k->whole[i + (j * n)], x[j + (c * n)]);
            }
        }
    }
}

/* x := solution of D x = b by the factor; x and b may be the same array. */
static mt_status back(const work *k, int cols, const double complex *b, double complex *x,
                      mt_err *err)
{
    const ptrdiff_t n = k->t->n;
    for (ptrdiff_t at = 0; at < n * cols; at++) {
        x[at] = b[at] * k->scale[at % n];
    }
    MT_TRY(mt_complex_solve(&k->factor, cols, x, err));
    for (ptrdiff_t at = 0; at < n * cols; at++) {
        x[at] *= k->scale[at % n];
    }
    return MT_OK;
}

/* b := D^-1 b, n x cols; resonant coordinates are left at 0. */
static mt_status solve_dynamic_stiffness(const work *k, int cols, double complex *b,
                                         mt_arena *mem, mt_err *err)
{
    const ptrdiff_t n = k->t->n;
    const size_t size = (size_t)n * (size_t)cols;
    if (k->t->diagonal) {
        for (ptrdiff_t at = 0; at < n * cols; at++) {
            b[at] = k->resonant[at % n] ? 0.0 : b[at] / k->d[at % n];
        }
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    double complex *const x = mt_arena_alloc(mem, size, sizeof *x);
    double complex *const r = mt_arena_alloc(mem, size, sizeof *r);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(back(k, cols, b, x, err));
    residual_of_solution(k, cols, b, x, r);
    MT_TRY(back(k, cols, r, r, err));
    for (size_t at = 0; at < size; at++) {
        b[at] = x[at] + r[at];
    }
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

/* out += sum_p factor_p x_p, of n entries. */
static void sum_powers(ptrdiff_t n, const double complex *factor_p,
                       const double complex *const *x, double complex *out)
{
    for (int p = 0; p < MT_FORCED_POWERS; p++) {
        for (ptrdiff_t at = 0; at < n && x[p] != NULL && factor_p[p] != 0.0; at++) {
            out[at] += factor_p[p] * x[p][at];
        }
    }
}

/* x := beta' - D' q, which equals D q'. */
static void slope_side(const work *k, double complex *x)
{
    const ptrdiff_t n = k->t->n;
    sum_powers(n * k->t->n_in, k->dpower, k->t->beta, x);
    for (ptrdiff_t c = 0; c < k->t->n_in; c++) {
        for (ptrdiff_t j = 0; j < n; j++) {
            const double complex q = k->q[j + (c * n)];
            for (ptrdiff_t i = k->t->diagonal ? j : 0; i < (k->t->diagonal ? j + 1 : n); i++) {
                const ptrdiff_t at = k->t->diagonal ? j : i + (j * n);
                x[i + (c * n)] -= entry_slope(k, at) * q;
            }
        }
    }
}

static mt_status solutions(work *k, bool slope, bool adjoint, mt_arena *mem, mt_err *err)
{
    const ptrdiff_t n = k->t->n;
    const int n_in = k->t->n_in;
    const int n_out = k->t->n_out;
    const size_t in = (size_t)n * (size_t)n_in;
    k->q = mt_arena_alloc(mem, in, sizeof *k->q);
    k->dq = slope ? mt_arena_alloc(mem, in, sizeof *k->dq) : NULL;
    k->a = adjoint ? mt_arena_alloc(mem, (size_t)n * (size_t)n_out, sizeof *k->a) : NULL;
    MT_TRY(mt_arena_check(mem, err));
    sum_powers(n * n_in, k->power, k->t->beta, k->q);
    MT_TRY(solve_dynamic_stiffness(k, n_in, k->q, mem, err));
    if (slope) {
        slope_side(k, k->dq);
        MT_TRY(solve_dynamic_stiffness(k, n_in, k->dq, mem, err));
    }
    for (int p = 0; p < MT_FORCED_POWERS && adjoint; p++) {
        for (ptrdiff_t j = 0; j < n && k->t->sigma[p] != NULL; j++) {
            for (ptrdiff_t o = 0; o < n_out; o++) {
                k->a[j + (o * n)] += k->power[p] * k->t->sigma[p][o + (j * n_out)];
            }
        }
    }
    return adjoint ? solve_dynamic_stiffness(k, n_out, k->a, mem, err) : MT_OK;
}

/* y := sigma q, one column. Written out: half of sigma is usually 0, and C's complex product
 * tests for infinities. */
static void sense(const mt_transfer *t, int p, const double complex *q, double complex *y)
{
    const ptrdiff_t n_out = t->n_out;
    double *const to = (double *)y;
    memset(y, 0, (size_t)n_out * sizeof *y);
    for (ptrdiff_t j = 0; j < t->n; j++) {
        const double *const row = (const double *)(t->sigma[p] + (j * n_out));
        const double re = creal(q[j]);
        const double im = cimag(q[j]);
        for (ptrdiff_t o = 0; o < n_out; o++) {
            to[2 * o] += row[2 * o] * re;
            to[(2 * o) + 1] += row[2 * o] * im;
        }
        for (ptrdiff_t o = 0; o < n_out && !t->real[p]; o++) {
            to[2 * o] -= row[(2 * o) + 1] * im;
            to[(2 * o) + 1] += row[(2 * o) + 1] * re;
        }
    }
}

static void add_scaled(ptrdiff_t n, double complex f, const double complex *x,
                       double complex *out)
{
    for (ptrdiff_t i = 0; i < n; i++) {
        out[i] += f * x[i];
    }
}

static void add_rest(const work *k, const mt_sample *out)
{
    const ptrdiff_t size = (ptrdiff_t)k->t->n_in * k->t->n_out;
    const double complex s = mt_complex(0.0, k->w);
    for (int at = 0; at < MT_REST_POWERS; at++) {
        const int power = at + MT_REST_LOWEST;
        if (k->t->rest[at] == NULL) {
            continue;
        }
        double complex f = 1.0;
        for (int i = 0; i < abs(power); i++) {
            f = power > 0 ? f * s : f / s;
        }
        add_scaled(size, f, k->t->rest[at], out->h);
        if (out->dh != NULL) {
            add_scaled(size, ((double)power / k->w) * f, k->t->rest[at], out->dh);
        }
    }
}

static mt_status put_together(const work *k, const mt_sample *out, mt_arena *mem, mt_err *err)
{
    const ptrdiff_t n = k->t->n;
    const ptrdiff_t n_out = k->t->n_out;
    const size_t size = (size_t)k->t->n_in * (size_t)n_out;
    double complex *const y = mt_arena_alloc(mem, (size_t)n_out, sizeof *y);
    MT_TRY(mt_arena_check(mem, err));
    memset(out->h, 0, size * sizeof *out->h);
    if (out->dh != NULL) {
        memset(out->dh, 0, size * sizeof *out->dh);
    }
    for (ptrdiff_t i = 0; i < k->t->n_in; i++) {
        for (int p = 0; p < MT_FORCED_POWERS; p++) {
            if (k->t->sigma[p] == NULL) {
                continue;
            }
            sense(k->t, p, k->q + (i * n), y);
            add_scaled(n_out, k->power[p], y, out->h + (i * n_out));
            if (out->dh != NULL) {
                add_scaled(n_out, k->dpower[p], y, out->dh + (i * n_out));
                sense(k->t, p, k->dq + (i * n), y);
                add_scaled(n_out, k->power[p], y, out->dh + (i * n_out));
            }
        }
    }
    add_rest(k, out);
    return MT_OK;
}

/* Terms of the sums over coordinates: |a|^T |D terms| |q|, and by eigenvalues' errors. */
static double error_of(const work *k, ptrdiff_t o, ptrdiff_t i)
{
    const ptrdiff_t n = k->t->n;
    const double complex *const a = k->a + (o * n);
    const double complex *const q = k->q + (i * n);
    double sum = 0.0;
    double left = 0.0;
    double right = 0.0;
    for (ptrdiff_t j = 0; j < n; j++) {
        const double root = k->t->error == NULL ? 0.0 : sqrt(k->t->error[j]);
        const double size = cabs(q[j]);
        left += root * cabs(a[j]);
        right += root * size;
        for (ptrdiff_t r = k->t->diagonal ? j : 0; r < (k->t->diagonal ? j + 1 : n); r++) {
            sum += cabs(a[r]) * terms_of(k, k->t->diagonal ? j : r + (j * n)) * size;
        }
    }
    return (ROUNDINGS * DBL_EPSILON * sum) + (left * right);
}

/* |A^p g| m^p (|g| where whole) of a force. */
static double left_of_part(const work *k, const mt_left_part *own, double power, double m,
                           bool whole)
{
    return pow(k->w, power) * (whole ? own->size : own->open * pow(m, own->order));
}

/* The same of local damping along the motion x. */
static double left_of_sides(const work *k, const double complex *x, double m, bool whole)
{
    const mt_left_out *const l = k->t->left;
    const ptrdiff_t n = k->t->n;
    double sum = 0.0;
    for (ptrdiff_t d = 0; d < l->n_side; d++) {
        double complex motion = 0.0;
        for (ptrdiff_t j = 0; j < n; j++) {
            motion += l->row[j + (d * n)] * x[j];
        }
        const double force = hypot(l->structural[d], k->w * l->damping[d]) * cabs(motion);
        const mt_left_part *const s = &l->side[d];
        sum += force * left_of_part(k, s, 0.0, m, whole);
    }
    return sum;
}

/* Rounding error of one force times x. */
static double noise_of(const work *k, const mt_left_part *own, double power,
                       const double complex *x)
{
    double sum = 0.0;
    for (ptrdiff_t j = 0; j < k->t->n; j++) {
        const double root = k->t->left->root[j];
        sum += cabs(x[j]) * (root > 0.0 ? own->noise * root : own->loose);
    }
    return pow(k->w, power) * sum;
}

/* Error bound of what is left out (mt_left_out). */
static double left_error(const work *k, ptrdiff_t o, ptrdiff_t i)
{
    const mt_left_out *const l = k->t->left;
    if (l == NULL) {
        return 0.0;
    }
    const double complex *const a = k->a + (o * k->t->n);
    const double complex *const x = k->q + (i * k->t->n);
    const double lossy = (k->w * l->beta) + l->loss;
    const double m = (k->w * hypot(k->w, l->alpha)) + (l->shift * hypot(1.0, lossy));
    const double lambda = l->lambda + l->shift;
    const double q = 1.0 - (m / lambda);
    if (!(q > 0.0)) {
        return HUGE_VAL;
    }
    const double turn =
        1.0 + (((lossy * (1.0 + (l->shift / lambda))) + (k->w * l->alpha / lambda)) / q);
    double sum = noise_of(k, &l->in[i], l->in_power[i], a);
    for (int p = 0; p < l->n_out; p++) {
        sum += l->out_of[p] == o ? noise_of(k, &l->out[p], l->out_power[p], x) : 0.0;
    }
    for (int whole = 0; whole < (l->ratio > 0.0 ? 2 : 1); whole++) {
        const double factor =
            whole == 0 ? turn * turn / q : 4.0 * l->ratio * k->w / sqrt(l->lambda) / (q * q);
        const double in = left_of_part(k, &l->in[i], l->in_power[i], m, whole == 1) +
                          left_of_sides(k, x, m, whole == 1);
        double out = left_of_sides(k, a, m, whole == 1);
        for (int p = 0; p < l->n_out; p++) {
            out += l->out_of[p] == o
                       ? left_of_part(k, &l->out[p], l->out_power[p], m, whole == 1)
                       : 0.0;
        }
        sum += factor * in * out;
        sum += whole == 1 ? k->w * l->out_rate[o] * in / q : 0.0;
    }
    return sum;
}

static void fill_errors(const work *k, const mt_sample *out)
{
    const ptrdiff_t n_out = k->t->n_out;
    for (ptrdiff_t i = 0; i < k->t->n_in; i++) {
        for (ptrdiff_t o = 0; o < n_out; o++) {
            double rest = 0.0;
            for (int p = 0; p < MT_REST_POWERS; p++) {
                if (k->t->rest[p] != NULL) {
                    rest += cabs(k->t->rest[p][o + (i * n_out)]) *
                            pow(k->w, (double)(p + MT_REST_LOWEST));
                }
            }
            out->error[o + (i * n_out)] =
                error_of(k, o, i) + left_error(k, o, i) + (ROUNDINGS * DBL_EPSILON * rest);
        }
    }
}

static void set_infinite(const mt_sample *out, ptrdiff_t at)
{
    out->h[at] = (double complex)HUGE_VAL;
    if (out->dh != NULL) {
        out->dh[at] = (double complex)HUGE_VAL;
    }
    if (out->error != NULL) {
        out->error[at] = HUGE_VAL;
    }
}

/* Marks the entries in which a resonant coordinate takes part. */
static void mark_resonant(const work *k, const mt_sample *out)
{
    const ptrdiff_t n = k->t->n;
    const ptrdiff_t n_out = k->t->n_out;
    for (ptrdiff_t j = 0; j < n && k->any_resonant; j++) {
        for (ptrdiff_t at = 0; at < n_out * k->t->n_in && k->resonant[j]; at++) {
            bool driven = false;
            bool seen = false;
            for (int p = 0; p < MT_FORCED_POWERS; p++) {
                driven = driven || (k->t->beta[p] != NULL &&
                                    k->t->beta[p][j + ((at / n_out) * n)] != 0.0);
                seen = seen || (k->t->sigma[p] != NULL &&
                                k->t->sigma[p][(at % n_out) + (j * n_out)] != 0.0);
            }
            if (driven && seen) {
                set_infinite(out, at);
            }
        }
    }
}

/* Marks all entries as without a value. */
static void all_infinite(const mt_transfer *t, const mt_sample *out)
{
    for (ptrdiff_t at = 0; at < (ptrdiff_t)t->n_in * t->n_out; at++) {
        set_infinite(out, at);
    }
}

static mt_status sample_transfer(const mt_transfer *t, double w, const mt_sample *out,
                                 mt_arena *scratch, mt_err *err)
{
    work k = {.t = t, .w = w};
    set_powers(&k);
    MT_TRY(factor_dynamic_stiffness(&k, scratch, err));
    if (k.factor.singular) {
        all_infinite(t, out);
        return MT_OK;
    }
    MT_TRY(solutions(&k, out->dh != NULL, out->error != NULL, scratch, err));
    MT_TRY(put_together(&k, out, scratch, err));
    if (out->error != NULL) {
        fill_errors(&k, out);
    }
    mark_resonant(&k, out);
    return MT_OK;
}

mt_status mt_transfer_at(const mt_transfer *t, double w, const mt_sample *out,
                         mt_arena *scratch, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = sample_transfer(t, w, out, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

mt_status mt_transfer_solve(const mt_transfer *t, double w, double complex *q,
                            double complex *a, double complex *h, bool *singular,
                            mt_arena *scratch, mt_err *err)
{
    work k = {.t = t, .w = w};
    mt_sample value = {.h = NULL};
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    value.h = h;
    set_powers(&k);
    MT_TRY(factor_dynamic_stiffness(&k, scratch, err));
    *singular = k.factor.singular || k.any_resonant;
    if (k.factor.singular && h != NULL) {
        all_infinite(t, &value);
    }
    if (!k.factor.singular) {
        MT_TRY(solutions(&k, false, true, scratch, err));
        memcpy(q, k.q, (size_t)t->n * (size_t)t->n_in * sizeof *q);
        memcpy(a, k.a, (size_t)t->n * (size_t)t->n_out * sizeof *a);
    }
    if (!k.factor.singular && h != NULL) {
        MT_TRY(put_together(&k, &value, scratch, err));
        mark_resonant(&k, &value);
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

/* Real numbers (and imaginary parts, or NULL), as complex ones; NULL where there are none. */
static const double complex *complex_of_parts(size_t n, const double *re, const double *im,
                                              mt_arena *mem)
{
    double complex *const out =
        re == NULL && im == NULL ? NULL : mt_arena_alloc(mem, n, sizeof *out);
    for (size_t i = 0; out != NULL && i < n; i++) {
        out[i] = mt_complex(re == NULL ? 0.0 : re[i], im == NULL ? 0.0 : im[i]);
    }
    return out;
}

static double complex *transposed(int n, int n_out, const double *re, const double *im,
                                  mt_arena *mem)
{
    double complex *const out =
        re == NULL && im == NULL ? NULL
                                 : mt_arena_alloc(mem, (size_t)n * (size_t)n_out, sizeof *out);
    for (ptrdiff_t o = 0; out != NULL && o < n_out; o++) {
        for (ptrdiff_t j = 0; j < n; j++) {
            const ptrdiff_t at = j + (o * n);
            out[o + (j * n_out)] =
                mt_complex(re == NULL ? 0.0 : re[at], im == NULL ? 0.0 : im[at]);
        }
    }
    return out;
}

mt_status mt_transfer_direct(const mt_forced *f, mt_arena *mem, mt_transfer *out, mt_err *err)
{
    const size_t n = (size_t)f->n;
    const size_t pairs = (size_t)f->n_in * (size_t)f->n_out;
    *out = (mt_transfer){.n = f->n, .n_in = f->n_in, .n_out = f->n_out, .m = f->m, .c = f->c};
    out->g = complex_of_parts(n * n, f->k, f->h, mem);
    for (int p = 0; p < MT_FORCED_POWERS; p++) {
        const double *const s_im = p == 0 ? f->s_im : NULL;
        out->beta[p] = complex_of_parts(n * (size_t)f->n_in, f->b[p], NULL, mem);
        out->sigma[p] = transposed(f->n, f->n_out, f->s[p], s_im, mem);
        out->real[p] = s_im == NULL;
        out->rest[p - MT_REST_LOWEST] =
            complex_of_parts(pairs, f->d[p], p == 0 ? f->d_im : NULL, mem);
    }
    for (int p = 0; p < 2; p++) {
        out->rest[-1 - p - MT_REST_LOWEST] = complex_of_parts(pairs, f->e[p], NULL, mem);
    }
    return mt_arena_check(mem, err);
}
