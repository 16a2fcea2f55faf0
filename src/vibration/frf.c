/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A conjugate pair s, conj s with residues r, conj r is the fraction
 *     r/(i w - s) + conj r/(i w - conj s) = (2 Re(r conj s) - i w 2 Re r) / ((w - p)(w - p')),
 * p = -i s, p' = -i conj s = -conj p: the sign is that of -(i w - s)(i w - conj s).
 */
#include "vibration/frf.h"

#include <float.h>
#include <math.h>

/* Damping below so many units in the last place of a pole is none: no eigenvalue solver tells
 * it from 0. */
static const double UNDAMPED_ULPS = 4.0;

const char *const mt_forced_end_names[MT_FORCED_ENDS] = {[MT_FORCED_FINITE] = "finite",
                                                         [MT_FORCED_INFINITE] = "infinite",
                                                         [MT_FORCED_UNSTABLE] = "unstable"};

const char *mt_forced_end_name(mt_forced_end end)
{
    return mt_forced_end_names[end];
}

static bool is_finite(double complex z)
{
    return isfinite(creal(z)) && isfinite(cimag(z));
}

static bool is_zero(double complex z)
{
    return creal(z) == 0.0 && cimag(z) == 0.0;
}

static bool is_conjugate(double complex a, double complex b)
{
    return creal(a) == creal(b) && cimag(a) == -cimag(b);
}

static void append_pole(mt_frf *h, const mt_pole_sum *sum, int k)
{
    h->re[h->n] = cimag(sum->s[k]);
    h->im[h->n] = -creal(sum->s[k]);
    h->rho[h->n] = mt_frf_complex(cimag(sum->residue[k]), -creal(sum->residue[k]));
    h->index[h->n++] = k;
}

static void add_pair(mt_frf *h, const mt_pole_sum *sum, int k, int other)
{
    const double complex s = sum->s[k];
    const double complex r = sum->residue[k];
    const double a = creal(r) * creal(s);
    const double b = cimag(r) * cimag(s);
    h->slope[h->n_pairs] = 2.0 * creal(r);
    h->constant[h->n_pairs] = 2.0 * (a + b);
    h->size[h->n_pairs++] = 2.0 * (fabs(a) + fabs(b));
    append_pole(h, sum, k);
    append_pole(h, sum, other);
}

/* The pole above `k` that is its conjugate, with the conjugate residue; -1: none. */
static int partner(const mt_pole_sum *sum, const bool *used, int k)
{
    for (int i = k + 1; i < sum->n; i++) {
        if (!used[i] && is_conjugate(sum->s[i], sum->s[k]) &&
            is_conjugate(sum->residue[i], sum->residue[k])) {
            return i;
        }
    }
    return -1;
}

static void sort_in(mt_frf *h, const mt_pole_sum *sum, bool *used)
{
    for (int k = 0; k < sum->n; k++) {
        const double damps = -creal(sum->s[k]);
        used[k] = is_zero(sum->residue[k]) &&
                  !(damps > UNDAMPED_ULPS * DBL_EPSILON * cabs(sum->s[k]));
    }
    for (int k = 0; k < sum->n; k++) {
        const int other = used[k] || cimag(sum->s[k]) == 0.0 ? -1 : partner(sum, used, k);
        if (other >= 0) {
            used[k] = true;
            used[other] = true;
            /* the pole with the positive frequency first */
            add_pair(h, sum, cimag(sum->s[k]) > 0.0 ? k : other,
                     cimag(sum->s[k]) > 0.0 ? other : k);
        }
    }
    for (int k = 0; k < sum->n; k++) {
        if (!used[k]) {
            append_pole(h, sum, k);
        }
    }
}

mt_status mt_frf_init(mt_frf *h, const mt_pole_sum *sum, mt_arena *mem, mt_err *err)
{
    const size_t n = (size_t)sum->n;
    *h = (mt_frf){
        .re = mt_arena_f64(mem, n, 1),
        .im = mt_arena_f64(mem, n, 1),
        .rho = mt_arena_alloc(mem, n, sizeof *h->rho),
        .index = mt_arena_int(mem, n),
        .slope = mt_arena_f64(mem, n, 1),
        .constant = mt_arena_f64(mem, n, 1),
        .size = mt_arena_f64(mem, n, 1),
        .c = {sum->d[0], mt_frf_complex(-cimag(sum->d[1]), creal(sum->d[1])), -sum->d[2]},
        .growing = mt_pole_sum_growing(sum)};
    bool *const used = mt_arena_alloc(mem, n, sizeof *used);
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < sum->n; k++) {
        if (!is_finite(sum->s[k]) || !is_finite(sum->residue[k])) {
            return mt_fail(err, MT_E_DOMAIN, "pole %d of the response is not finite", k + 1);
        }
    }
    for (int j = 0; j < MT_COUNT(sum->d); j++) {
        if (!is_finite(sum->d[j])) {
            return mt_fail(err, MT_E_DOMAIN, "the response is not finite");
        }
    }
    sort_in(h, sum, used);
    return MT_OK;
}

double complex mt_frf_ratio(double complex a, double complex b)
{
    const double norm = (creal(b) * creal(b)) + (cimag(b) * cimag(b));
    return mt_frf_complex(((creal(a) * creal(b)) + (cimag(a) * cimag(b))) / norm,
                          ((cimag(a) * creal(b)) - (creal(a) * cimag(b))) / norm);
}

double complex mt_frf_times(double complex a, double complex b)
{
    return mt_frf_complex((creal(a) * creal(b)) - (cimag(a) * cimag(b)),
                          (creal(a) * cimag(b)) + (cimag(a) * creal(b)));
}

double complex mt_frf_from_pole(const mt_frf *h, int k, mt_near w)
{
    return mt_frf_complex((w.anchor - h->re[k]) + w.t, -h->im[k]);
}

double complex mt_frf_value(const mt_frf *h, mt_near w, double *size)
{
    const double omega = w.anchor + w.t;
    double complex sum = h->c[0] + (omega * (h->c[1] + (omega * h->c[2])));
    double sizes = size == NULL
                       ? 0.0
                       : cabs(h->c[0]) + (omega * (cabs(h->c[1]) + (omega * cabs(h->c[2]))));
    for (int i = 0; i < h->n_pairs; i++) {
        const double complex below =
            mt_frf_times(mt_frf_from_pole(h, 2 * i, w), mt_frf_from_pole(h, (2 * i) + 1, w));
        sum += mt_frf_ratio(mt_frf_complex(h->constant[i], -omega * h->slope[i]), below);
        if (size != NULL) {
            sizes += (h->size[i] + (omega * fabs(h->slope[i]))) / cabs(below);
        }
    }
    for (int k = 2 * h->n_pairs; k < h->n; k++) {
        const double complex term = mt_frf_ratio(h->rho[k], mt_frf_from_pole(h, k, w));
        sum += term;
        sizes += size == NULL ? 0.0 : cabs(term);
    }
    if (size != NULL) {
        *size = sizes;
    }
    return sum;
}

void mt_frf_jet(const mt_frf *h, mt_near w, double complex *jet)
{
    const double omega = w.anchor + w.t;
    jet[0] = mt_frf_value(h, w, NULL);
    jet[1] = h->c[1] + (2.0 * omega * h->c[2]);
    jet[2] = 2.0 * h->c[2];
    for (int k = 0; k < h->n; k++) {
        const double complex inverse = mt_frf_ratio(1.0, mt_frf_from_pole(h, k, w));
        const double complex second = mt_frf_times(mt_frf_times(h->rho[k], inverse), inverse);
        jet[1] -= second;
        jet[2] += 2.0 * mt_frf_times(second, inverse);
    }
}

mt_forced_end mt_frf_judge(const mt_frf *h, double lower, double upper, int *pole)
{
    mt_forced_end end = MT_FORCED_FINITE;
    if (h->growing >= 0) {
        *pole = h->growing;
        return MT_FORCED_UNSTABLE;
    }
    for (int k = 0; k < h->n; k++) {
        /* what does not grow, and yet is beyond the axis, is there by rounding */
        const bool undamped =
            h->im[k] <= UNDAMPED_ULPS * DBL_EPSILON * hypot(h->re[k], h->im[k]);
        if (undamped && h->re[k] >= lower && h->re[k] <= upper && end == MT_FORCED_FINITE) {
            *pole = h->index[k];
            end = MT_FORCED_INFINITE;
        }
    }
    return end;
}

void mt_frf_pull(const mt_frf *h, mt_near w, double complex weight, double complex *by_s,
                 double complex *by_residue, double complex *by_d)
{
    const double complex i_omega = mt_frf_complex(0.0, w.anchor + w.t);
    by_d[0] += weight;
    by_d[1] += weight * i_omega;
    by_d[2] += weight * i_omega * i_omega;
    for (int k = 0; k < h->n; k++) {
        const double complex d = mt_frf_from_pole(h, k, w);
        const double complex by_r = mt_frf_ratio(weight, mt_frf_complex(-cimag(d), creal(d)));
        const double complex r = mt_frf_complex(-cimag(h->rho[k]), creal(h->rho[k]));
        by_residue[h->index[k]] += by_r;
        by_s[h->index[k]] +=
            mt_frf_ratio(mt_frf_times(by_r, r), mt_frf_complex(-cimag(d), creal(d)));
    }
}
