/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * D^-1 = E_1/s + E_2/s^2 + ... of the coupled coordinates, from D E = 1: of the rows with mass
 *     E_m = [m = 2] - C E_{m-1} - G E_{m-2},
 * then of the others, whose damping among themselves is mu,
 *     mu E_m = [m = 1] - C E_m - G E_{m-1}.
 */
#include "response/poles_priv.h"

enum { EXPANSION = 4 };

/* E_m; NULL below 1. */
static double complex *order_of(const mt_poles *k, double complex *e, int m)
{
    return m < 1 ? NULL : e + ((m - 1) * k->n * k->n);
}

/* - (a row of C or G) . column, the rows without mass of C left out where `moving`. */
static double complex minus_row(const mt_poles *k, ptrdiff_t i, bool of_c, bool moving,
                                const double complex *column)
{
    double complex sum = 0.0;
    for (int d = 0; d < k->n_coupled && column != NULL; d++) {
        const ptrdiff_t j = k->coupled[d];
        if (of_c && !(moving && j >= k->b->n_modes)) {
            sum -= mt_poles_damping(k, i, j) * column[j];
        } else if (!of_c) {
            sum -= k->b->g[i + (j * k->n)] * column[j];
        }
    }
    return sum;
}

static const double complex *column_of(const mt_poles *k, const double complex *e,
                                       ptrdiff_t column)
{
    return e == NULL ? NULL : e + (column * k->n);
}

static void fill_column(const mt_poles *k, double complex *e, int m, ptrdiff_t column)
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
            now[i] = sum / mt_poles_damping(k, i, i);
        }
    }
}

/* sigma_p E beta_q of one pair. */
static double complex sigma_e_beta_of_pair(const mt_poles *k, int p, int q, ptrdiff_t at,
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

mt_status mt_poles_add_polynomials(mt_poles *k, mt_err *err)
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
                    return mt_poles_refuse("the response grows with the cube of the frequency",
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
