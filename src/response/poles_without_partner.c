/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A coordinate that is tied to no other: N(s) over s^2 + c s + g, or over c s + g where it has
 * no mass, N = sigma beta. With poles s_1, s_2
 *     N/((s - s_1)(s - s_2)) = sum_k N(s_k)/(s_k - s_other)/(s - s_k) + quotient.
 */
#include "response/poles_priv.h"

#include <math.h>
#include <string.h>

/* Two poles nearer than this part of their size cancel more digits than the sum is good to. */
static const double APART = 1e-6;
enum { DEGREES = 5 };
static const char CUBE[] = "the response grows with the cube of the frequency";

mt_status mt_poles_refuse(const char *why, mt_err *err)
{
    return mt_fail(err, MT_E_SINGULAR, "There is no sum of poles: %s", why);
}

double mt_poles_damping(const mt_poles *k, ptrdiff_t i, ptrdiff_t j)
{
    return k->b->c == NULL ? 0.0 : k->b->c[i + (j * k->n)];
}

/* Coefficients of sigma_oj(s) beta_ji(s). */
static void numerator(const mt_poles *k, ptrdiff_t j, ptrdiff_t o, ptrdiff_t i,
                      double complex *out)
{
    const mt_transfer *const t = &k->b->t;
    memset(out, 0, DEGREES * sizeof *out);
    for (int p = 0; p < MT_FORCED_POWERS; p++) {
        for (int q = 0; q < MT_FORCED_POWERS && t->sigma[p] != NULL; q++) {
            if (t->beta[q] != NULL) {
                out[p + q] += t->sigma[p][o + (j * t->n_out)] * t->beta[q][j + (i * k->n)];
            }
        }
    }
}

static double complex polynomial_value(const double complex *poly, double complex s)
{
    double complex sum = 0.0;
    for (int m = DEGREES - 1; m >= 0; m--) {
        sum = (sum * s) + poly[m];
    }
    return sum;
}

void mt_poles_roots(double c, double complex g, double complex s[2])
{
    const double complex square = (0.25 * c * c) - g;
    double complex root = csqrt(square);
    if (fabs(cimag(root)) > fabs(creal(root))) {
        root = mt_complex(cimag(square) / (2.0 * cimag(root)), cimag(root));
    }
    s[0] = (-0.5 * c) - root;
    s[1] = (-0.5 * c) + root;
    if (cabs(s[1]) < 0.5 * cabs(root) && s[0] != 0.0) {
        s[1] = g / s[0];
    }
}

static void add_quotient(mt_poles *k, ptrdiff_t at, const double complex *q)
{
    for (int m = 0; m < 3; m++) {
        k->d[at + (m * k->pairs)] += q[m];
    }
}

/* N(s)/(c (s - s_0)): synthetic division. */
static mt_status massless(mt_poles *k, ptrdiff_t j, mt_err *err)
{
    const ptrdiff_t n_out = k->b->t.n_out;
    const double c = mt_poles_damping(k, j, j);
    const double complex s = -k->b->g[j + (j * k->n)] / c;
    for (ptrdiff_t at = 0; at < k->pairs; at++) {
        double complex p[DEGREES];
        numerator(k, j, at % n_out, at / n_out, p);
        for (int m = DEGREES - 2; m >= 0; m--) {
            p[m] += s * p[m + 1];
        }
        if (p[DEGREES - 1] != 0.0) {
            return mt_poles_refuse(CUBE, err);
        }
        const double complex q[3] = {p[1] / c, p[2] / c, p[3] / c};
        k->residue[at + (k->count * k->pairs)] = p[0] / c;
        add_quotient(k, at, q);
    }
    k->s[k->count++] = s;
    return MT_OK;
}

/* N(s)/s^2: a pole at 0 where N has a linear term, none where it has neither. */
static mt_status free_motion(mt_poles *k, ptrdiff_t j, mt_err *err)
{
    const ptrdiff_t n_out = k->b->t.n_out;
    bool any = false;
    for (ptrdiff_t at = 0; at < k->pairs; at++) {
        double complex p[DEGREES];
        numerator(k, j, at % n_out, at / n_out, p);
        if (p[0] != 0.0) {
            return mt_poles_refuse("a motion without stiffness and damping grows without "
                                   "bound, like 1/s^2",
                                   err);
        }
        k->residue[at + (k->count * k->pairs)] = p[1];
        any = any || p[1] != 0.0;
        add_quotient(k, at, p + 2);
    }
    k->count += any ? 1 : 0; /* s = 0 */
    return MT_OK;
}

mt_status mt_poles_without_partner(mt_poles *k, ptrdiff_t j, mt_err *err)
{
    const ptrdiff_t n_out = k->b->t.n_out;
    const double c = mt_poles_damping(k, j, j);
    const double complex g = k->b->g[j + (j * k->n)];
    if (j >= k->b->n_modes) {
        return massless(k, j, err);
    }
    if (g == 0.0 && c == 0.0) {
        return free_motion(k, j, err);
    }
    double complex *const s = k->s + k->count;
    mt_poles_roots(c, g, s);
    if (cabs(s[1] - s[0]) <= APART * cabs(s[0])) {
        return mt_poles_refuse("a mode is critically damped", err);
    }
    for (ptrdiff_t at = 0; at < k->pairs; at++) {
        double complex p[DEGREES];
        numerator(k, j, at % n_out, at / n_out, p);
        for (int r = 0; r < 2; r++) {
            k->residue[at + ((k->count + r) * k->pairs)] =
                polynomial_value(p, s[r]) / (s[r] - s[1 - r]);
        }
        double complex q[3] = {0.0, 0.0, p[4]};
        q[1] = p[3] - (c * q[2]);
        q[0] = p[2] - (c * q[1]) - (g * q[2]);
        add_quotient(k, at, q);
    }
    k->count += 2;
    return MT_OK;
}
