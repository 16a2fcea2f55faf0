/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_FILON_H
#define SIMULATE_FILON_H

/*
 * Integrals of waves times polynomials (Filon quadrature): with l_j Lagrange's polynomials
 * through Chebyshev points c_j of [0, 1], the ends among them,
 *     int_0^(c_i) cos(x (c_i - s)) l_j(s) ds, and the same of sin and of sin/x,
 * for any x >= 0.
 */
enum { MT_FILON_DEGREE = 8, MT_FILON_POINTS = MT_FILON_DEGREE + 1, MT_FILON_GAUSS = 48 };

/* The part that does not depend on x. */
typedef struct mt_filon {
    double point[MT_FILON_POINTS];
    double node[MT_FILON_GAUSS];
    double gauss[MT_FILON_GAUSS];
    double basis[MT_FILON_POINTS * MT_FILON_GAUSS * MT_FILON_POINTS]; /* l_j at c_i node_g */
    /* number k of l_j at point i: [k][i + j POINTS] */
    double derivative[MT_FILON_POINTS][MT_FILON_POINTS * MT_FILON_POINTS];
    double last[MT_FILON_POINTS]; /* the coefficient of the highest Chebyshev polynomial */
} mt_filon;

/* The integrals for one x: entry i + j POINTS belongs to l_j and c_i. */
typedef struct mt_filon_weights {
    double x;
    double c[MT_FILON_POINTS]; /* cos x c_i */
    double s[MT_FILON_POINTS];
    double nc[MT_FILON_POINTS * MT_FILON_POINTS];
    double ns[MT_FILON_POINTS * MT_FILON_POINTS];
    double nd[MT_FILON_POINTS * MT_FILON_POINTS]; /* with sin/x */
} mt_filon_weights;

void mt_filon_make(mt_filon *q);
/* Compute the weights for x; returns at once where w->x is x (a new w has x NaN). Errors: some
 * 1e-14. */
void mt_filon_weigh(const mt_filon *q, double x, mt_filon_weights *w);
/* sin(x c)/x, x >= 0. */
double mt_filon_sine_over(double x, double c);

#endif
