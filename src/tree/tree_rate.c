/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The quotient of a motion, and what rounding makes of it, to first order.
 *     The energy is |x|^2 by the choice of coordinates, the mass v^T M v a sum of positive
 * terms. An error e_i of the motion of body i beyond its edge (a rounding of X v_before + N z,
 * or of N itself) moves all that hangs on it, and changes the mass by 2 P_i^T e_i, P_i the
 * momentum of the body and of all beyond it: no more than that is lost where large motions
 * cancel on the way, and no less. The rest: the terms of v^T M v, and what cancelled in the
 * strains of an edge when its coordinates were made. Under load they are made by elimination of
 * K, exact for a K that differs from it by roundings of what was summed in each body.
 */
#include "tree/tree_priv.h"

#include <float.h>
#include <math.h>

#include "linalg/dense.h"

enum { MOST = MT_TREE_MOTION };

/* Roundings of a step of the elimination; of a sum over an edge; of its columns, made by
 * reflections and rotations; of the strains they were made from; and of v^T M v. */
static const double SETTLED_ULPS = 4.0;
static const double STEP_ULPS = 4.0;
static const double COLUMN_ULPS = 16.0;
static const double STRAIN_ULPS = 8.0;
static const double MASS_ULPS = 16.0;

/* v += |X_i| |p|. */
static void add_transport(const mt_tree *t, int i, const double *p, double *v)
{
    const double *const a = t->arm + ((ptrdiff_t)3 * i);
    for (int k = 0; k < t->s; k++) {
        v[k] += fabs(p[k]);
    }
    if (t->s == 3) {
        v[0] += fabs(p[2] * a[1]);
        v[1] += fabs(p[2] * a[0]);
        return;
    }
    const double *const w = p + 3;
    v[0] += fabs(w[1] * a[2]) + fabs(w[2] * a[1]);
    v[1] += fabs(w[2] * a[0]) + fabs(w[0] * a[2]);
    v[2] += fabs(w[0] * a[1]) + fabs(w[1] * a[0]);
}

/* Column c of the edge times z: sizes of its entries, and of the whole, in lengths. */
static void add_column_size(const mt_tree *t, int i, const double *column, double z,
                            double *terms, double *whole)
{
    double square = 0.0;
    for (int k = 0; k < t->s; k++) {
        const double unit = mt_tree_freedom(t, k) >= 3 ? t->length[i] : 1.0;
        terms[k] += fabs(column[k] * z);
        square += column[k] * unit * column[k] * unit;
    }
    *whole += fabs(z) * sqrt(square);
}

/* |P_i|^T |e_i|, in roundings. */
static double error_of(const mt_tree *t, int i, const double *x, const double *r,
                       const double *v, const double *f)
{
    const double *const own = v + ((ptrdiff_t)t->s * i);
    const double *const other = t->before[i] < 0 ? NULL : v + ((ptrdiff_t)t->s * t->before[i]);
    const double *column = mt_tree_basis(t, i);
    double terms[MOST] = {0.0};
    double whole = 0.0;
    double turned = COLUMN_ULPS * t->condition[i];
    for (int c = mt_tree_first(t, i); c < mt_tree_first(t, i + 1); c++, column += t->s) {
        add_column_size(t, i, column, x[c], terms, &whole);
    }
    for (int c = t->free_dof_at[i]; c < t->free_dof_at[i + 1] && t->scaled == NULL; c++) {
        add_column_size(t, i, column, r == NULL ? 0.0 : r[c], terms, &whole);
        column += t->s;
    }
    if (other != NULL) {
        add_transport(t, i, other, terms);
    }
    if (other != NULL && t->transport != NULL) { /* X' = X less what follows the load */
        double along[MOST];
        mt_tree_carry(t, i, other, along);
        for (int k = 0; k < t->s; k++) {
            const double unit = mt_tree_freedom(t, k) >= 3 ? t->length[i] : 1.0;
            whole += fabs(own[k] - along[k]) * unit;
        }
    }
    double sum = 0.0;
    for (int k = 0; k < t->s; k++) {
        const double unit = mt_tree_freedom(t, k) >= 3 ? 1.0 / t->length[i] : 1.0;
        sum += fabs(f[k + ((ptrdiff_t)t->s * i)]) *
               ((STEP_ULPS * terms[k]) + (turned * whole * unit));
    }
    return sum;
}

/* u^T A v, s x s, and the sum of the sizes of its terms. */
static double form(int s, const double *a, const double *u, const double *v, double *size)
{
    double sum = 0.0;
    for (int c = 0; c < s; c++) {
        for (int r = 0; r < s; r++) {
            const double term = u[r] * a[r + (c * s)] * v[c];
            sum += term;
            *size += fabs(term);
        }
    }
    return sum;
}

/* Sum of u^T settled u, u the magnitudes of each body's motion plus those of its motion
 * relative to the parent. */
static double settled_by(const mt_tree *t, const double *v)
{
    const ptrdiff_t square = (ptrdiff_t)t->s * t->s;
    double sum = 0.0;
    for (int i = 0; i < t->n; i++) {
        const double *const own = v + ((ptrdiff_t)t->s * i);
        double along[MOST] = {0.0};
        double u[MOST];
        double size = 0.0;
        if (t->before[i] >= 0) {
            mt_tree_carry(t, i, v + ((ptrdiff_t)t->s * t->before[i]), along);
        }
        for (int k = 0; k < t->s; k++) {
            u[k] = fabs(own[k]) + fabs(own[k] - along[k]);
        }
        sum += form(t->s, t->settled + (square * i), u, u, &size);
    }
    return sum;
}

/* Cancellation in the strains of a motion of this energy, in roundings. */
static double lost_by(const mt_tree *t, const double *x, double energy)
{
    double sum = 0.0;
    double most = 0.0;
    for (int k = 0; k < t->y_at[t->n]; k++) {
        most = fmax(most, t->lost[k]);
        sum += t->scaled == NULL ? t->lost[k] * x[k] * x[k] : 0.0;
    }
    return t->scaled == NULL ? sum : most * energy;
}

void mt_tree_rate(const mt_tree *t, const double *x, const double *r, const double *v,
                  const double *f, mt_tree_quotient *q)
{
    const ptrdiff_t square = (ptrdiff_t)t->s * t->s;
    double mass = 0.0;
    double size = 0.0;
    double error = 0.0;
    for (int i = 0; i < t->n; i++) {
        const double *const own = v + ((ptrdiff_t)t->s * i);
        mass += form(t->s, t->mass + (square * i), own, own, &size);
        if (t->shared != NULL && t->before[i] >= 0) {
            double of_pair = 0.0;
            mass += 2.0 * form(t->s, t->shared + (square * i),
                               v + ((ptrdiff_t)t->s * t->before[i]), own, &of_pair);
            size += 2.0 * of_pair;
        }
        error += error_of(t, i, x, r, v, f);
    }
    const double energy = mt_dot(t->n_x, x, x);
    const double settled = t->settled == NULL ? 0.0 : settled_by(t, v);
    const double lost = lost_by(t, x, energy + settled);
    q->lambda = energy / mass;
    q->mass = mass;
    q->noise =
        DBL_EPSILON * ((((2.0 * error) + (MASS_ULPS * size)) / mass) +
                       (((SETTLED_ULPS * settled) + (2.0 * STRAIN_ULPS * lost)) / energy));
}
