/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sums over poles: of coordinates that nothing couples, and of all others by their
 * eigenproblem. */
#include "response/poles.h"

#include <complex.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "linalg/ldl.h"
#include "modal/damped.h"

/* Work of mt_response_poles. */
typedef struct poles {
    const mt_basis *b;
    mt_arena *mem;
    ptrdiff_t n;     /* coordinates */
    ptrdiff_t pairs; /* n_in n_out */
    int *coupled;    /* [n_coupled] coordinates */
    int n_coupled;
    int count; /* poles so far */
    double complex *s;
    double complex *residue; /* pairs x most, one column per pole */
    double complex *d;       /* pairs x 3 */
    /* of the coupled coordinates */
    int order;
    int *x_of; /* [n] row of coordinate i's displacement; -1: none */
    int *v_of; /* [n] row of its velocity (displacement where it has no mass); -1: none */
    double *omega;
} poles;

static mt_status poles_refuse(const char *why, mt_err *err);
static double poles_damping(const poles *k, ptrdiff_t i, ptrdiff_t j);

/*
 * D^-1 = E_1/s + E_2/s^2 + ... of the coupled coordinates, from D E = 1: of the rows with mass
 *     E_m = [m = 2] - C E_{m-1} - G E_{m-2},
 * then of the others, whose damping among themselves is mu,
 *     mu E_m = [m = 1] - C E_m - G E_{m-1}.
 */

enum { EXPANSION = 4 };

/* E_m; NULL below 1. */
static double complex *order_of(const poles *k, double complex *e, int m)
{
    return m < 1 ? NULL : e + ((m - 1) * k->n * k->n);
}

/* - (a row of C or G) . column, the rows without mass of C left out where `moving`. */
static double complex minus_row(const poles *k, ptrdiff_t i, bool of_c, bool moving,
                                const double complex *column)
{
    double complex sum = 0.0;
    for (int d = 0; d < k->n_coupled && column != NULL; d++) {
        const ptrdiff_t j = k->coupled[d];
        if (of_c && !(moving && j >= k->b->n_modes)) {
            sum -= poles_damping(k, i, j) * column[j];
        } else if (!of_c) {
            sum -= k->b->g[i + (j * k->n)] * column[j];
        }
    }
    return sum;
}

static const double complex *column_of(const poles *k, const double complex *e,
                                       ptrdiff_t column)
{
    return e == NULL ? NULL : e + (column * k->n);
}

static void fill_column(const poles *k, double complex *e, int m, ptrdiff_t column)
{
    double complex *const now = order_of(k, e, m) + (column * k->n);
    const double complex *const before = column_of(k, order_of(k, e, m - 1), column);
    const double complex *const first = column_of(k, order_of(k, e, m - 2), column);
    for (int a = 0; a < k->n_coupled; a++) {
        const ptrdiff_t i = k->coupled[a];
        if (i < k->b->n_modes) {
            now[i] = (i == column && m == 2 ? 1.0 : 0.0) +
                     minus_row(k, i, true, false, before) +
                     minus_row(k, i, false, false, first);
        }
    }
    for (int a = 0; a < k->n_coupled; a++) {
        const ptrdiff_t i = k->coupled[a];
        if (i >= k->b->n_modes) {
            const double complex sum = (i == column && m == 1 ? 1.0 : 0.0) +
                                       minus_row(k, i, true, true, now) +
                                       minus_row(k, i, false, false, before);
            now[i] = sum / poles_damping(k, i, i);
        }
    }
}

/* sigma_p E beta_q of one pair. */
static double complex sigma_e_beta_of_pair(const poles *k, int p, int q, ptrdiff_t at,
                                           const double complex *e)
{
    const mt_transfer *const t = &k->b->t;
    const ptrdiff_t o = at % t->n_out;
    const ptrdiff_t i = at / t->n_out;
    double complex sum = 0.0;
    for (int a = 0; a < k->n_coupled; a++) {
        for (int c = 0; c < k->n_coupled; c++) {
            const ptrdiff_t row = k->coupled[a];
            const ptrdiff_t col = k->coupled[c];
            sum += t->sigma[p][o + (row * t->n_out)] * e[row + (col * k->n)] *
                   t->beta[q][col + (i * k->n)];
        }
    }
    return sum;
}

/* Add to d the polynomial part that the sum over the poles of the coupled coordinates lacks. */
static mt_status poles_add_polynomials(poles *k, mt_err *err)
{
    const mt_transfer *const t = &k->b->t;
    const ptrdiff_t size = k->n * k->n;
    double complex *const e = mt_arena_alloc(k->mem, (size_t)size * EXPANSION, sizeof *e);
    MT_TRY(mt_arena_check(k->mem, err));
    for (int m = 1; m <= EXPANSION; m++) {
        for (int a = 0; a < k->n_coupled; a++) {
            fill_column(k, e, m, k->coupled[a]);
        }
    }
    for (int at = 0; at < MT_FORCED_POWERS * MT_FORCED_POWERS; at++) {
        const int p = at % MT_FORCED_POWERS;
        const int q = at / MT_FORCED_POWERS;
        for (int m = 0; m < p + q && t->sigma[p] != NULL && t->beta[q] != NULL; m++) {
            for (ptrdiff_t pair = 0; pair < k->pairs; pair++) {
                const double complex add =
                    sigma_e_beta_of_pair(k, p, q, pair, e + ((p + q - m - 1) * size));
                if (m >= 3 && add != 0.0) {
                    return poles_refuse("the response grows with the cube of the frequency",
                                        err);
                }
                if (m < 3) {
                    k->d[pair + (m * k->pairs)] += add;
                }
            }
        }
    }
    return MT_OK;
}

/*
 * A coordinate that is tied to no other: N(s) over s^2 + c s + g, or over c s + g where it has
 * no mass, N = sigma beta. With poles s_1, s_2
 *     N/((s - s_1)(s - s_2)) = sum_k N(s_k)/(s_k - s_other)/(s - s_k) + quotient.
 */

/* Two poles nearer than this part of their size cancel more digits than the sum is good to. */
static const double APART = 1e-6;
enum { DEGREES = 5 };
static const char CUBE[] = "the response grows with the cube of the frequency";

static mt_status poles_refuse(const char *why, mt_err *err)
{
    return mt_fail(err, MT_E_SINGULAR, "There is no sum of poles: %s", why);
}

static double poles_damping(const poles *k, ptrdiff_t i, ptrdiff_t j)
{
    return k->b->c == NULL ? 0.0 : k->b->c[i + (j * k->n)];
}

/* Coefficients of sigma_oj(s) beta_ji(s). */
static void numerator(const poles *k, ptrdiff_t j, ptrdiff_t o, ptrdiff_t i,
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

/* s[2]: both roots of s^2 + c s + g. The small real part of a lightly damped pair keeps its
 * relative accuracy: that of the discriminant's root is computed from its imaginary part. */
static void poles_roots(double c, double complex g, double complex s[2])
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

static void add_quotient(poles *k, ptrdiff_t at, const double complex *q)
{
    for (int m = 0; m < 3; m++) {
        k->d[at + (m * k->pairs)] += q[m];
    }
}

/* N(s)/(c (s - s_0)): synthetic division. */
static mt_status massless(poles *k, ptrdiff_t j, mt_err *err)
{
    const ptrdiff_t n_out = k->b->t.n_out;
    const double c = poles_damping(k, j, j);
    const double complex s = -k->b->g[j + (j * k->n)] / c;
    for (ptrdiff_t at = 0; at < k->pairs; at++) {
        double complex p[DEGREES];
        numerator(k, j, at % n_out, at / n_out, p);
        for (int m = DEGREES - 2; m >= 0; m--) {
            p[m] += s * p[m + 1];
        }
        if (p[DEGREES - 1] != 0.0) {
            return poles_refuse(CUBE, err);
        }
        const double complex q[3] = {p[1] / c, p[2] / c, p[3] / c};
        k->residue[at + (k->count * k->pairs)] = p[0] / c;
        add_quotient(k, at, q);
    }
    k->s[k->count++] = s;
    return MT_OK;
}

/* N(s)/s^2: a pole at 0 where N has a linear term, none where it has neither. */
static mt_status free_motion(poles *k, ptrdiff_t j, mt_err *err)
{
    const ptrdiff_t n_out = k->b->t.n_out;
    bool any = false;
    for (ptrdiff_t at = 0; at < k->pairs; at++) {
        double complex p[DEGREES];
        numerator(k, j, at % n_out, at / n_out, p);
        if (p[0] != 0.0) {
            return poles_refuse("a motion without stiffness and damping grows without "
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

/* Add the poles of coordinate j, which is coupled to no other. */
static mt_status poles_without_partner(poles *k, ptrdiff_t j, mt_err *err)
{
    const ptrdiff_t n_out = k->b->t.n_out;
    const double c = poles_damping(k, j, j);
    const double complex g = k->b->g[j + (j * k->n)];
    if (j >= k->b->n_modes) {
        return massless(k, j, err);
    }
    if (g == 0.0 && c == 0.0) {
        return free_motion(k, j, err);
    }
    double complex *const s = k->s + k->count;
    poles_roots(c, g, s);
    if (cabs(s[1] - s[0]) <= APART * cabs(s[0])) {
        return poles_refuse("a mode is critically damped", err);
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

/*
 * A coordinate that nothing couples to others has N(s)/(s^2 + c s + g), N = sigma beta: two
 * poles and the quotient of polynomials. For the others, with D(s) = s^2 M + s C + G in the
 * coordinates of the basis,
 *     D(s_k) y_k = 0,    D^-1 = sum_k y_k y_k^T / (y_k^T (2 s_k M + C) y_k) / (s - s_k),
 * where D is symmetric (also complex). The s_k are eigenvalues of the states (x = Omega a, v =
 * a', b), b the damped directions without mass, c_b = diag(mu):
 *     x' = Omega v,     b' = -mu^-1 (C_bv v + G_ba Omega^-1 x + G_bb b),
 *     v' = -G_aa Omega^-1 x - C_vv v - C_vb b' - G_ab b.
 * A rigid-body mode that is damped has no x: its s = 0 is split off, y = e, with 1/mu of it.
 * Polynomials come from D^-1 = E_1/s + E_2/s^2 + ..., D E = 1:
 *     s^P/(s - s_k), summed:  sum_{m < P} s^m E_{P - m}.
 */

/* What the sum may differ by from a direct solve, of the largest of them. */
static const double AGREEMENT = 1e-9;
/* A pole with less damping than this is looked at from so far beside it: on it, how far it is
 * from w decides all digits. */
static const double SHARP = 1e-6;
static const double BESIDE = 1e-3;

/* True where coordinates i and j are coupled. */
static bool is_tied(const poles *k, ptrdiff_t i, ptrdiff_t j)
{
    return poles_damping(k, i, j) != 0.0 || k->b->g[i + (j * k->n)] != 0.0 ||
           poles_damping(k, j, i) != 0.0;
}

static bool is_rigid(const poles *k, ptrdiff_t j)
{
    return j < k->b->n_modes && k->omega[j] == 0.0;
}

/* Indices of the states of the coupled coordinates. */
static mt_status place_states(poles *k, mt_err *err)
{
    k->x_of = mt_arena_int(k->mem, (size_t)k->n);
    k->v_of = mt_arena_int(k->mem, (size_t)k->n);
    k->omega = mt_arena_f64(k->mem, (size_t)k->n, 1);
    MT_TRY(mt_arena_check(k->mem, err));
    for (int a = 0; a < k->n_coupled; a++) {
        const int j = k->coupled[a];
        k->x_of[j] = -1;
        k->omega[j] = j < k->b->n_modes ? sqrt(fabs(k->b->lambda[j])) : 0.0;
        if (k->omega[j] > 0.0) {
            k->x_of[j] = k->order++;
        }
        k->v_of[j] = k->order++;
    }
    return MT_OK;
}

/* Adds `scale` times the row of coordinate i of the state matrix, of M q'' + C q' + G q = 0
 * without the part of the rates of b, to row `to`. */
static void add_states_row(const poles *k, ptrdiff_t i, double complex scale, ptrdiff_t to,
                           double complex *a)
{
    for (int e = 0; e < k->n_coupled; e++) {
        const ptrdiff_t j = k->coupled[e];
        const double complex g = k->b->g[i + (j * k->n)];
        if (j >= k->b->n_modes) {
            a[to + ((ptrdiff_t)k->v_of[j] * k->order)] += scale * g;
            continue;
        }
        a[to + ((ptrdiff_t)k->v_of[j] * k->order)] += scale * poles_damping(k, i, j);
        if (k->x_of[j] >= 0) {
            a[to + ((ptrdiff_t)k->x_of[j] * k->order)] += scale * g / k->omega[j];
        }
    }
}

static void assemble_states_matrix(const poles *k, double complex *a)
{
    for (int e = 0; e < k->n_coupled; e++) {
        const ptrdiff_t j = k->coupled[e];
        const ptrdiff_t v = k->v_of[j];
        if (j >= k->b->n_modes) {
            add_states_row(k, j, -1.0 / poles_damping(k, j, j), v, a);
            continue;
        }
        if (k->x_of[j] >= 0) {
            a[k->x_of[j] + (v * k->order)] = k->omega[j];
        }
        add_states_row(k, j, -1.0, v, a);
        for (int d = 0; d < k->n_coupled; d++) {
            const ptrdiff_t b = k->coupled[d];
            if (b >= k->b->n_modes) {
                add_states_row(k, b, poles_damping(k, j, b) / poles_damping(k, b, b), v, a);
            }
        }
    }
}

/* Eigenpairs; a real matrix as one, so that pairs are conjugate to the bit. */
static mt_status eigenpairs(const poles *k, double complex *w, double complex *v, mt_err *err)
{
    const size_t n = (size_t)k->order;
    double complex *const a = mt_arena_alloc(k->mem, n * n, sizeof *a);
    double *const re = mt_arena_f64(k->mem, n, n);
    double *const vr = mt_arena_f64(k->mem, n, n);
    double *const wr = mt_arena_f64(k->mem, n, 2);
    MT_TRY(mt_arena_check(k->mem, err));
    assemble_states_matrix(k, a);
    bool real = true;
    for (size_t i = 0; i < n * n; i++) {
        real = real && cimag(a[i]) == 0.0;
        re[i] = creal(a[i]);
    }
    if (!real) {
        return mt_eig_complex(k->order, a, w, v, k->mem, err);
    }
    MT_TRY(mt_eig_general(k->order, re, wr, wr + n, vr, k->mem, err));
    for (size_t j = 0; j < n; j++) {
        const double im = wr[n + j];
        const size_t first = im < 0.0 ? j - 1 : j;
        w[j] = mt_complex(wr[j], im);
        for (size_t i = 0; i < n; i++) {
            const double y_im = im == 0.0 ? 0.0 : vr[i + ((first + 1) * n)];
            v[i + (j * n)] = mt_complex(vr[i + (first * n)], im < 0.0 ? -y_im : y_im);
        }
    }
    return MT_OK;
}

/* y in the coordinates of the basis from states z, times s: (v, s b). */
static void coordinates(const poles *k, double complex s, const double complex *z,
                        double complex *y)
{
    memset(y, 0, (size_t)k->n * sizeof *y);
    for (int e = 0; e < k->n_coupled; e++) {
        const int j = k->coupled[e];
        y[j] = j < k->b->n_modes ? z[k->v_of[j]] : s * z[k->v_of[j]];
    }
}

/* y^T (2 s M + C) y. */
static double complex normaliser(const poles *k, double complex s, const double complex *y)
{
    double complex sum = 0.0;
    for (int e = 0; e < k->n_coupled; e++) {
        const ptrdiff_t i = k->coupled[e];
        sum += i < k->b->n_modes ? 2.0 * s * y[i] * y[i] : 0.0;
        for (int d = 0; d < k->n_coupled; d++) {
            const ptrdiff_t j = k->coupled[d];
            sum += y[i] * poles_damping(k, i, j) * y[j];
        }
    }
    return sum;
}

/* The pole s with y y^T/normal. */
static void add_pole(poles *k, double complex s, double complex normal, const double complex *y)
{
    const mt_transfer *const t = &k->b->t;
    double complex *const to = k->residue + (k->count * k->pairs);
    for (ptrdiff_t at = 0; at < k->pairs; at++) {
        const ptrdiff_t o = at % t->n_out;
        const ptrdiff_t i = at / t->n_out;
        double complex left = 0.0;
        double complex right = 0.0;
        double complex power = 1.0;
        for (int p = 0; p < MT_FORCED_POWERS; p++) {
            for (ptrdiff_t j = 0; j < k->n; j++) {
                left +=
                    t->sigma[p] == NULL ? 0.0 : power * t->sigma[p][o + (j * t->n_out)] * y[j];
                right += t->beta[p] == NULL ? 0.0 : power * t->beta[p][j + (i * k->n)] * y[j];
            }
            power *= s;
        }
        to[at] = left * right / normal;
    }
    k->s[k->count++] = s;
}

static mt_status coupled(poles *k, mt_err *err)
{
    MT_TRY(place_states(k, err));
    const size_t n = (size_t)k->order;
    double complex *const w = mt_arena_alloc(k->mem, n, sizeof *w);
    double complex *const v = mt_arena_alloc(k->mem, n * n, sizeof *v);
    double complex *const y = mt_arena_alloc(k->mem, (size_t)k->n, sizeof *y);
    MT_TRY(mt_arena_check(k->mem, err));
    MT_TRY(eigenpairs(k, w, v, err));
    for (ptrdiff_t a = 0; a < (ptrdiff_t)n; a++) {
        coordinates(k, w[a], v + (a * (ptrdiff_t)n), y);
        add_pole(k, w[a], normaliser(k, w[a], y), y);
    }
    memset(y, 0, (size_t)k->n * sizeof *y);
    for (int e = 0; e < k->n_coupled; e++) {
        const ptrdiff_t j = k->coupled[e];
        if (is_rigid(k, j)) {
            y[j] = 1.0;
            add_pole(k, 0.0, poles_damping(k, j, j), y);
            y[j] = 0.0;
        }
    }
    return poles_add_polynomials(k, err);
}

static mt_status add_rest(poles *k, mt_err *err)
{
    const mt_transfer *const t = &k->b->t;
    for (int at = 0; at < MT_REST_POWERS; at++) {
        const int power = at + MT_REST_LOWEST;
        bool any = false;
        for (ptrdiff_t pair = 0; pair < k->pairs && t->rest[at] != NULL; pair++) {
            const double complex add = t->rest[at][pair];
            any = any || add != 0.0;
            if (power >= 0 && power < 3) {
                k->d[pair + (power * k->pairs)] += add;
            } else if (power == -1) {
                k->residue[pair + (k->count * k->pairs)] = add;
            }
        }
        if (any && power == -1) {
            k->s[k->count++] = 0.0;
        } else if (any && (power < -1 || power > 2)) {
            return poles_refuse(power < 0
                                    ? "the ground's own motion grows without bound, like 1/s^2"
                                    : "the response grows with the cube of the frequency",
                                err);
        }
    }
    return MT_OK;
}

/* first: of the coupled ones. */
static void hand_out(const poles *k, int first, mt_pole_sum *out, double complex *residue)
{
    /* of an eigenvalue, beside the largest */
    static const double ULPS = 8.0;
    double largest = 0.0;
    for (int i = first; i < k->count; i++) {
        largest = fmax(largest, cabs(k->s[i]));
    }
    for (ptrdiff_t pair = 0; pair < k->pairs; pair++) {
        double complex *const own = residue + (pair * k->count);
        for (int a = 0; a < k->count; a++) {
            own[a] = k->residue[pair + (a * k->pairs)];
        }
        out[pair] = (mt_pole_sum){.n = k->count,
                                  .s = k->s,
                                  .residue = own,
                                  .first_coupled = first,
                                  .rounding = ULPS * DBL_EPSILON * largest};
        for (int m = 0; m < 3; m++) {
            out[pair].d[m] = k->d[pair + (m * k->pairs)];
        }
    }
}

/* Refuses a sum that deviates from direct solves at the frequencies of all poles. */
static mt_status verify(const poles *k, const mt_pole_sum *sum, mt_err *err)
{
    const mt_sample got = {.h = mt_arena_alloc(k->mem, (size_t)k->pairs, sizeof *got.h)};
    double *const largest = mt_arena_f64(k->mem, (size_t)k->pairs, 2);
    MT_TRY(mt_arena_check(k->mem, err));
    double *const worst = largest + k->pairs;
    for (int a = 0; a < k->count; a++) {
        const bool sharp = fabs(creal(k->s[a])) <= SHARP * cabs(k->s[a]);
        const double w = cabs(k->s[a]) * (sharp ? 1.0 + BESIDE : 1.0);
        if (!(w > 0.0) || cimag(k->s[a]) < 0.0) {
            continue;
        }
        MT_TRY(mt_transfer_at(&k->b->t, w, &got, k->mem, err));
        for (ptrdiff_t p = 0; p < k->pairs; p++) {
            const double off = cabs(got.h[p] - mt_pole_sum_at(&sum[p], w));
            largest[p] = fmax(largest[p], cabs(got.h[p]));
            worst[p] = off <= worst[p] ? worst[p] : off;
        }
    }
    bool agree = true;
    for (ptrdiff_t p = 0; p < k->pairs; p++) {
        agree = agree && worst[p] <= AGREEMENT * largest[p];
    }
    return agree ? MT_OK : poles_refuse("damping turns two modes into nearly one", err);
}

/* Largest number of poles. */
static size_t most_of(const poles *k)
{
    return (2 * (size_t)k->n) + 2;
}

/* Room for poles, and which coordinates are tied to others: the first n_coupled, the others
 * behind them. */
static mt_status begin_poles(poles *k, mt_err *err)
{
    int alone_at = (int)k->n;
    k->coupled = mt_arena_int(k->mem, (size_t)k->n);
    k->s = mt_arena_alloc(k->mem, most_of(k), sizeof *k->s);
    MT_TRY(mt_arena_check(k->mem, err));
    for (ptrdiff_t j = 0; j < k->n; j++) {
        bool tied = false;
        for (ptrdiff_t i = 0; i < k->n; i++) {
            tied = tied || (i != j && is_tied(k, i, j));
        }
        k->coupled[tied ? k->n_coupled++ : --alone_at] = (int)j;
    }
    return MT_OK;
}

static mt_status find_pole_sum(poles *k, mt_pole_sum *out, mt_err *err)
{
    const size_t pairs = (size_t)k->pairs;
    MT_TRY(begin_poles(k, err));
    k->residue = mt_arena_alloc(k->mem, most_of(k) * pairs, sizeof *k->residue);
    k->d = mt_arena_alloc(k->mem, 3 * pairs, sizeof *k->d);
    MT_TRY(mt_arena_check(k->mem, err));
    for (ptrdiff_t j = k->n - 1; j >= k->n_coupled; j--) {
        MT_TRY(poles_without_partner(k, k->coupled[j], err));
    }
    const int first = k->count;
    if (k->n_coupled > 0) {
        MT_TRY(coupled(k, err));
    }
    MT_TRY(add_rest(k, err));
    double complex *const residue =
        mt_arena_alloc(k->mem, pairs * (size_t)k->count, sizeof *residue);
    MT_TRY(mt_arena_check(k->mem, err));
    hand_out(k, first, out, residue);
    return k->n_coupled > 0 ? verify(k, out, err) : MT_OK;
}

mt_status mt_response_poles(const mt_basis *basis, mt_arena *mem, mt_pole_sum *out, mt_err *err)
{
    poles k = {.b = basis,
               .mem = mem,
               .n = basis->t.n,
               .pairs = (ptrdiff_t)basis->t.n_in * basis->t.n_out};
    return find_pole_sum(&k, out, err);
}

mt_status mt_response_pole_list(const mt_basis *basis, mt_arena *mem, int *n,
                                double complex **s, mt_err *err)
{
    poles k = {.b = basis, .mem = mem, .n = basis->t.n};
    MT_TRY(begin_poles(&k, err));
    for (ptrdiff_t a = k.n - 1; a >= k.n_coupled; a--) {
        const ptrdiff_t j = k.coupled[a];
        const double complex g = basis->g[j + (j * k.n)];
        if (j >= basis->n_modes) {
            k.s[k.count++] = -g / poles_damping(&k, j, j);
        } else if (g != 0.0) {
            poles_roots(poles_damping(&k, j, j), g, k.s + k.count);
            k.count += 2;
        }
    }
    if (k.n_coupled > 0) {
        MT_TRY(place_states(&k, err));
        double complex *const v =
            mt_arena_alloc(mem, (size_t)k.order * (size_t)k.order, sizeof *v);
        MT_TRY(mt_arena_check(mem, err));
        MT_TRY(eigenpairs(&k, k.s + k.count, v, err));
        k.count += k.order;
    }
    *n = k.count;
    *s = k.s;
    return MT_OK;
}

int mt_pole_sum_growing(const mt_pole_sum *p)
{
    return p->judged ? p->growing : mt_modal_growing_pole(p->n, p->s, 0.0);
}

double complex mt_pole_sum_at(const mt_pole_sum *p, double w)
{
    const double complex s = mt_complex(0.0, w);
    double complex sum = p->d[0] + (s * (p->d[1] + (s * p->d[2])));
    for (int k = 0; k < p->n; k++) {
        sum += p->residue[k] / (s - p->s[k]);
    }
    return sum;
}
