/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The recursions. Rigid motion along with the body before it, a the arm between the centres:
 *     dx = dx_p + theta_p x a,  theta = theta_p (a point mass: 0);  back, of forces:
 *     force_p += force,  moment_p += moment + a x force.
 *
 * The count: K - tau M is a sum over bodies of v^T H v, H = -tau (mass), of -tau v_p^T C v and
 * of |y|^2. From the leaves on, with B = [N F, N R], D = diag(I, 0), z = (y, r):
 *     Delta = D + B^T H B,   W = B^T (H X + C^T),
 *     H_p += X^T H X + C X + X^T C^T - W^T Delta^-1 W:
 * what is left when z takes its stationary value. The signs of the pivots of all Delta are
 * those of the eigenvalues.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "tree/tree.h"

enum { MOST = MT_TREE_MOTION, SQUARE = MOST * MOST };

/* A pivot below this part of the terms that it is the sum of may have its sign from rounding.
 * */
static const double DOUBTFUL = 1e-10;

/* v := X_i p, X the rigid motion with the parent. */
static void tree_carry(const mt_tree *t, int i, const double *p, double *v)
{
    const double *const a = t->arm + ((ptrdiff_t)3 * i);
    const double turns = t->point[i] ? 0.0 : 1.0;
    if (t->s == 3) {
        v[0] = p[0] - (p[2] * a[1]);
        v[1] = p[1] + (p[2] * a[0]);
        v[2] = turns * p[2];
        return;
    }
    const double *const w = p + 3;
    v[0] = p[0] + ((w[1] * a[2]) - (w[2] * a[1]));
    v[1] = p[1] + ((w[2] * a[0]) - (w[0] * a[2]));
    v[2] = p[2] + ((w[0] * a[1]) - (w[1] * a[0]));
    for (int k = 0; k < 3; k++) {
        v[3 + k] = turns * w[k];
    }
}

void mt_tree_carry_back(const mt_tree *t, int i, const double *f, double *p)
{
    const double *const a = t->arm + ((ptrdiff_t)3 * i);
    const double turns = t->point[i] ? 0.0 : 1.0;
    if (t->s == 3) {
        p[0] += f[0];
        p[1] += f[1];
        p[2] += (turns * f[2]) + ((a[0] * f[1]) - (a[1] * f[0]));
        return;
    }
    for (int k = 0; k < 3; k++) {
        p[k] += f[k];
    }
    p[3] += (turns * f[3]) + ((a[1] * f[2]) - (a[2] * f[1]));
    p[4] += (turns * f[4]) + ((a[2] * f[0]) - (a[0] * f[2]));
    p[5] += (turns * f[5]) + ((a[0] * f[1]) - (a[1] * f[0]));
}

static inline void add_product_of(int s, const double *a, bool transposed, const double *v,
                                  double *f)
{
    for (int c = 0; c < s; c++) {
        for (int r = 0; r < s; r++) {
            f[r] += a[transposed ? c + (r * s) : r + (c * s)] * v[c];
        }
    }
}

/* f += A v, or A^T v, s x s: each order a loop of its own, which is half of all work here. */
static inline void add_matrix_vector(int s, const double *a, bool transposed, const double *v,
                                     double *f)
{
    if (s == 3) {
        add_product_of(3, a, transposed, v, f);
    } else {
        add_product_of(MOST, a, transposed, v, f);
    }
}

/* h (s x s) := geometric stiffness - tau mass of body i; NULL: without that term. */
static void block(const mt_tree *t, const double *mass, const double *geometric_stiffness,
                  double tau, int i, double *h)
{
    const ptrdiff_t square = (ptrdiff_t)t->s * t->s;
    for (int k = 0; k < square; k++) {
        h[k] = (geometric_stiffness == NULL ? 0.0 : geometric_stiffness[k + (square * i)]) -
               (mass == NULL ? 0.0 : tau * mass[k + (square * i)]);
    }
}

void mt_tree_motion(const mt_tree *t, const double *x, const double *r, double *v)
{
    const int s = t->s;
    const ptrdiff_t square = (ptrdiff_t)s * s;
    const bool rigid = r != NULL && t->n_rigid > 0;
    for (int i = 0; i < t->n; i++) {
        double *const own = v + ((ptrdiff_t)s * i);
        const double *const other = t->before[i] < 0 ? NULL : v + ((ptrdiff_t)s * t->before[i]);
        const double *b = mt_tree_basis(t, i);
        for (int k = 0; k < s; k++) {
            own[k] = 0.0;
        }
        if (other != NULL && t->transport != NULL) {
            add_matrix_vector(s, t->transport + (square * i), false, other, own);
        } else if (other != NULL) {
            tree_carry(t, i, other, own);
        }
        for (int c = mt_tree_first(t, i); c < mt_tree_first(t, i + 1); c++, b += s) {
            for (int k = 0; k < s; k++) {
                own[k] += b[k] * x[c];
            }
        }
        for (int c = t->free_dof_at[i]; c < t->free_dof_at[i + 1] && rigid; c++, b += s) {
            for (int k = 0; k < s; k++) {
                own[k] += b[k] * r[c];
            }
        }
    }
}

/* For the force on body i and its descendants: entries of x and r (NULL), and the force passed
 * to the parent. */
static inline void hand_back(const mt_tree *t, int i, double *f, double *x, double *r)
{
    const int s = t->s;
    const int p = t->before[i];
    double *const own = f + ((ptrdiff_t)s * i);
    double *const other = p < 0 ? NULL : f + ((ptrdiff_t)s * p);
    const double *b = mt_tree_basis(t, i);
    for (int c = mt_tree_first(t, i); c < mt_tree_first(t, i + 1); c++, b += s) {
        x[c] = 0.0;
        for (int k = 0; k < s; k++) {
            x[c] += b[k] * own[k];
        }
    }
    for (int c = t->free_dof_at[i]; c < t->free_dof_at[i + 1] && r != NULL; c++, b += s) {
        r[c] = 0.0;
        for (int k = 0; k < s; k++) {
            r[c] += b[k] * own[k];
        }
    }
    if (p >= 0 && t->transport != NULL) {
        add_matrix_vector(s, t->transport + ((ptrdiff_t)s * s * i), true, own, other);
    } else if (p >= 0) {
        mt_tree_carry_back(t, i, own, other);
    }
}

void mt_tree_momentum(const mt_tree *t, const double *v, double *f, double *x, double *r)
{
    const int s = t->s;
    const ptrdiff_t square = (ptrdiff_t)s * s;
    const bool rigid = r != NULL && t->n_rigid > 0;
    memset(f, 0, (size_t)t->n * (size_t)s * sizeof *f);
    for (int i = t->n - 1; i >= 0; i--) {
        const int p = t->before[i];
        double *const own = f + ((ptrdiff_t)s * i);
        double *const other = p < 0 ? NULL : f + ((ptrdiff_t)s * p);
        add_matrix_vector(s, t->mass + (square * i), false, v + ((ptrdiff_t)s * i), own);
        if (t->shared != NULL && p >= 0) {
            add_matrix_vector(s, t->shared + (square * i), true, v + ((ptrdiff_t)s * p), own);
            add_matrix_vector(s, t->shared + (square * i), false, v + ((ptrdiff_t)s * i),
                              other);
        }
        hand_back(t, i, f, x, rigid ? r : NULL);
    }
}

void mt_tree_gather(const mt_tree *t, double *f, double *x, double *r)
{
    for (int i = t->n - 1; i >= 0; i--) {
        hand_back(t, i, f, x, t->n_rigid > 0 ? r : NULL);
    }
}

void mt_tree_push(const mt_tree *t, const double *force, double *f)
{
    memset(f, 0, (size_t)t->n * (size_t)t->s * sizeof *f);
    for (int i = 0; i < t->n; i++) {
        const int *const dof = t->sys->bodies[t->body[i]].dof;
        for (int k = 0; k < t->s; k++) {
            const int q = dof[mt_tree_freedom(t, k)];
            f[k + ((ptrdiff_t)t->s * i)] = q >= 0 ? force[q] : 0.0;
        }
    }
}

void mt_tree_within(const mt_tree *t, const double *x, const double *r, const double *v,
                    double *w)
{
    const int s = t->s;
    for (int i = 0; i < t->n; i++) {
        double *const own = w + ((ptrdiff_t)s * i);
        if (t->transport != NULL) {
            double along[MOST] = {0.0};
            if (t->before[i] >= 0) {
                tree_carry(t, i, v + ((ptrdiff_t)s * t->before[i]), along);
            }
            for (int k = 0; k < s; k++) {
                own[k] = v[k + ((ptrdiff_t)s * i)] - along[k];
            }
            continue;
        }
        const double *b = mt_tree_basis(t, i);
        memset(own, 0, (size_t)s * sizeof *own);
        for (int c = t->y_at[i]; c < t->y_at[i + 1]; c++, b += s) {
            mt_axpy(s, x[c], b, own);
        }
        for (int c = t->free_dof_at[i]; c < t->free_dof_at[i + 1]; c++, b += s) {
            mt_axpy(s, r[c], b, own);
        }
    }
}

void mt_tree_transport(const mt_tree *t, double lambda, const double *v, double *f)
{
    const int s = t->s;
    memset(f, 0, (size_t)t->n * (size_t)s * sizeof *f);
    for (int i = t->n - 1; i >= 0; i--) {
        const int p = t->before[i];
        const double *const shape = v + ((ptrdiff_t)s * i);
        double *const own = f + ((ptrdiff_t)s * i);
        double h[SQUARE];
        block(t, t->mass, t->geometric_stiffness, lambda, i, h);
        add_matrix_vector(s, h, false, shape, own);
        if (p < 0) {
            continue;
        }
        if (t->shared != NULL || t->geometric_stiffness_shared != NULL) {
            block(t, t->shared, t->geometric_stiffness_shared, lambda, i, h);
            add_matrix_vector(s, h, true, v + ((ptrdiff_t)s * p), own);
            add_matrix_vector(s, h, false, shape, f + ((ptrdiff_t)s * p));
        }
        mt_tree_carry_back(t, i, own, f + ((ptrdiff_t)s * p));
    }
}

/* From the kinetic energy of a motion of 1 along x. */
double mt_tree_mass(const mt_tree *t)
{
    const ptrdiff_t square = (ptrdiff_t)t->s * t->s;
    double mass = 0.0;
    for (int i = 0; i < t->n; i++) {
        mass += t->mass[square * i] + (t->shared == NULL ? 0.0 : 2.0 * t->shared[square * i]);
    }
    return mass;
}

/* X_i, s x s. */
static void carry_matrix(const mt_tree *t, int i, double *x)
{
    for (int c = 0; c < t->s; c++) {
        double unit[MOST] = {0.0};
        unit[c] = 1.0;
        tree_carry(t, i, unit, x + ((ptrdiff_t)c * t->s));
    }
}

/* out (m x n) := op(A) B, A of inner size k. */
static void small_matrix_product(bool transposed, int m, int n, int k, const double *a,
                                 const double *b, double *out)
{
    for (int c = 0; c < n; c++) {
        for (int r = 0; r < m; r++) {
            double sum = 0.0;
            for (int l = 0; l < k; l++) {
                sum += a[transposed ? l + (r * k) : r + (l * m)] * b[l + (c * k)];
            }
            out[r + (c * m)] = sum;
        }
    }
}

/* L D L^T = delta in place (d x d, lower); counts negative pivots; size: of the terms on the
 * diagonal. *least: of a pivot as a part of the terms that it is the sum of. */
static void pivots(int d, double *delta, const double *size, int *below, double *least)
{
    for (int j = 0; j < d; j++) {
        double most = size[j];
        for (int k = 0; k < j; k++) {
            const double taken = delta[j + (k * d)] * delta[j + (k * d)] * delta[k + (k * d)];
            delta[j + (j * d)] -= taken;
            most = fmax(most, fabs(taken));
        }
        *below += delta[j + (j * d)] < 0.0 ? 1 : 0;
        const double part = fabs(delta[j + (j * d)]) / most;
        *least = part >= *least ? *least : (part >= 0.0 ? part : 0.0);
        if (delta[j + (j * d)] == 0.0) {
            delta[j + (j * d)] = 1.0; /* anything: the count is void */
        }
        const double pivot = delta[j + (j * d)];
        for (int i = j + 1; i < d; i++) {
            for (int k = 0; k < j; k++) {
                delta[i + (j * d)] -=
                    delta[i + (k * d)] * delta[j + (k * d)] * delta[k + (k * d)];
            }
            delta[i + (j * d)] /= pivot;
        }
    }
}

/* w (d x s) := L^-1 w. */
static void forward(int d, int s, const double *l, double *w)
{
    for (int c = 0; c < s; c++) {
        for (int j = 0; j < d; j++) {
            for (int k = 0; k < j; k++) {
                w[j + (c * d)] -= l[j + (k * d)] * w[k + (c * d)];
            }
        }
    }
}

/* What the elimination of one body leaves: Delta = L D L^T, w = L^-1 W, X. */
typedef struct eliminated {
    int d;
    double delta[SQUARE];
    double w[SQUARE];
    double x[SQUARE];
} eliminated;

/* other (s x s) += add - W^T Delta^-1 W; sizes (NULL: not wanted) += sums of magnitudes of the
 * terms. */
static void hand_on(int s, const eliminated *e, const double *add, double *other, double *sizes)
{
    const int d = e->d;
    for (int c = 0; c < s; c++) {
        for (int r = 0; r < s; r++) {
            double taken = 0.0;
            double size = fabs(add[r + (c * s)]);
            for (int k = 0; k < d; k++) {
                const double term =
                    e->w[k + (r * d)] * e->w[k + (c * d)] / e->delta[k + (k * d)];
                taken += term;
                size += fabs(term);
            }
            other[r + (c * s)] += add[r + (c * s)] - taken;
            if (sizes != NULL) {
                sizes[r + (c * s)] += size;
            }
        }
    }
}

/* Rounding that the forces on body i may cause in the stiffness of column k of its basis, at
 * least. */
static double load_of(const mt_tree *t, int i, int k)
{
    const double *const b = t->basis + ((ptrdiff_t)t->s * (t->y_at[i] + t->free_dof_at[i] + k));
    const double length = t->sys->length_m;
    double most = 0.0;
    for (int r = 0; r < t->s; r++) {
        most = fmax(most, fabs(b[r]) / (mt_tree_freedom(t, r) >= 3 ? 1.0 : length));
    }
    return t->force == NULL ? 0.0 : t->force[i] * length * most * most;
}

/* Eliminate body i, whose H is complete, and add the Schur complement to its parent. sizes:
 * sums of magnitudes of the terms of each H (NULL: not wanted). */
static void eliminate_body(const mt_tree *t, int i, double tau, double *h, double *sizes,
                           int *below, double *least, eliminated *e)
{
    const int s = t->s;
    const ptrdiff_t square = (ptrdiff_t)s * s;
    const int n_y = t->y_at[i + 1] - t->y_at[i];
    const int d = n_y + t->free_dof_at[i + 1] - t->free_dof_at[i];
    const double *const own = h + (square * i);
    const double *const basis = t->basis + ((ptrdiff_t)s * (t->y_at[i] + t->free_dof_at[i]));
    double hb[SQUARE];
    double size[MOST];
    e->d = d;
    small_matrix_product(false, s, d, s, own, basis, hb);
    small_matrix_product(true, d, d, s, basis, hb, e->delta);
    for (int k = 0; k < d; k++) {
        size[k] = fmax(fabs(e->delta[k + (k * d)]), k < n_y ? 1.0 : load_of(t, i, k));
        e->delta[k + (k * d)] += k < n_y ? 1.0 : 0.0;
    }
    pivots(d, e->delta, size, below, least);
    if (t->before[i] < 0) {
        return;
    }
    double g[SQUARE] = {0.0}; /* H X + C^T */
    double add[SQUARE] = {0.0};
    carry_matrix(t, i, e->x);
    small_matrix_product(false, s, s, s, own, e->x, g);
    small_matrix_product(true, s, s, s, e->x, g, add);
    if (t->shared != NULL || t->geometric_stiffness_shared != NULL) {
        double c[SQUARE] = {0.0};
        double cx[SQUARE] = {0.0};
        block(t, t->shared, t->geometric_stiffness_shared, tau, i, c);
        small_matrix_product(false, s, s, s, c, e->x, cx);
        for (int k = 0; k < s; k++) {
            for (int l = 0; l < s; l++) {
                g[k + (l * s)] += c[l + (k * s)];
                add[k + (l * s)] += cx[k + (l * s)] + cx[l + (k * s)];
            }
        }
    }
    small_matrix_product(true, d, s, s, basis, g, e->w);
    forward(d, s, e->delta, e->w);
    const ptrdiff_t other = square * t->before[i];
    hand_on(s, e, add, h + other, sizes == NULL ? NULL : sizes + other);
}

/* H = K_g - tau M, body by body, in scratch. */
static double *blocks(const mt_tree *t, double tau, mt_arena *scratch)
{
    const ptrdiff_t square = (ptrdiff_t)t->s * t->s;
    double *const h = mt_arena_f64(scratch, (size_t)t->n, (size_t)square);
    for (int i = 0; i < t->n && h != NULL; i++) {
        block(t, t->mass, t->geometric_stiffness, tau, i, h + (square * i));
    }
    return h;
}

mt_status mt_tree_count(const mt_tree *t, double tau, mt_arena *scratch, int *below,
                        bool *certain, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const h = blocks(t, tau, scratch);
    eliminated e = {.d = 0};
    MT_TRY(mt_arena_check(scratch, err));
    double least = 1.0;
    *below = 0;
    for (int i = t->n - 1; i >= 0; i--) {
        eliminate_body(t, i, tau, h, NULL, below, &least, &e);
    }
    *certain = least > DOUBTFUL;
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

/*
 * K is the sum of x^T x, x = D^1/2 (L^T z + D^-1 w v_before): so
 *     z = L^-T (D^-1/2 x - D^-1 w v_before),    N' = B L^-T D^-1/2,    X' = X - B L^-T D^-1 w.
 */
static void store_eliminated_body(mt_tree *t, int i, const eliminated *e)
{
    const int s = t->s;
    const int d = e->d;
    const ptrdiff_t first = (ptrdiff_t)s * (t->y_at[i] + t->free_dof_at[i]);
    double *const scaled = t->scaled + first;
    double *const transport = t->transport + ((ptrdiff_t)s * s * i);
    memcpy(scaled, t->basis + first, (size_t)(s * d) * sizeof *scaled);
    for (int j = 0; j < d; j++) { /* B L^-T */
        for (int k = 0; k < j; k++) {
            for (int r = 0; r < s; r++) {
                scaled[r + (j * s)] -= scaled[r + (k * s)] * e->delta[j + (k * d)];
            }
        }
    }
    if (t->before[i] >= 0) {
        memcpy(transport, e->x, (size_t)(s * s) * sizeof *transport);
        for (int c = 0; c < s; c++) {
            for (int j = 0; j < d; j++) {
                const double share = e->w[j + (c * d)] / e->delta[j + (j * d)];
                for (int r = 0; r < s; r++) {
                    transport[r + (c * s)] -= scaled[r + (j * s)] * share;
                }
            }
        }
    }
    for (int j = 0; j < d; j++) {
        for (int r = 0; r < s; r++) {
            scaled[r + (j * s)] /= sqrt(e->delta[j + (j * d)]);
        }
    }
}

mt_status mt_tree_factor(mt_tree *t, mt_arena *scratch, bool *positive, mt_err *err)
{
    const ptrdiff_t size = (ptrdiff_t)t->n * t->s * t->s;
    double *const h = blocks(t, 0.0, scratch);
    int below = 0;
    MT_TRY(mt_arena_check(scratch, err));
    for (ptrdiff_t k = 0; k < size; k++) {
        t->settled[k] = fabs(h[k]);
    }
    *positive = true;
    for (int i = t->n - 1; i >= 0 && *positive; i--) {
        eliminated e = {.d = 0};
        double least = 1.0;
        eliminate_body(t, i, 0.0, h, t->settled, &below, &least, &e);
        *positive = least > DOUBTFUL && below == 0;
        if (*positive) {
            store_eliminated_body(t, i, &e);
        }
    }
    return MT_OK;
}

void mt_tree_states(const mt_tree *t, const double *v, double *phi)
{
    for (int i = 0; i < t->n; i++) {
        const int *const dof = t->sys->bodies[t->body[i]].dof;
        for (int k = 0; k < t->s; k++) {
            const int q = dof[mt_tree_freedom(t, k)];
            if (q >= 0) {
                phi[q] = v[k + ((ptrdiff_t)t->s * i)];
            }
        }
    }
}

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
        tree_carry(t, i, other, along);
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
            tree_carry(t, i, v + ((ptrdiff_t)t->s * t->before[i]), along);
        }
        for (int k = 0; k < t->s; k++) {
            u[k] = fabs(own[k]) + fabs(own[k] - along[k]);
        }
        sum += form(t->s, t->settled + (square * i), u, u, &size);
    }
    return sum;
}

/*
 * Of a place that is off its equilibrium by `astray`: arms and forces turn with it, so masses
 * and the loads' stiffness change by as much of the sum of their terms, and the latter by what
 * is unbalanced as well; to first order, with room for the terms of a square.
 */
static const double TURNED = 4.0;

static double astray_by(const mt_tree *t, const double *v, double mass_size, double mass,
                        double energy)
{
    const ptrdiff_t square = (ptrdiff_t)t->s * t->s;
    double size = 0.0;
    for (int i = 0; i < t->n && t->settled_at != NULL; i++) {
        const double *const own = v + ((ptrdiff_t)t->s * i);
        (void)form(t->s, t->geometric_stiffness + (square * i), own, own, &size);
        if (t->before[i] >= 0) {
            double of_pair = 0.0;
            (void)form(t->s, t->geometric_stiffness_shared + (square * i),
                       v + ((ptrdiff_t)t->s * t->before[i]), own, &of_pair);
            size += 2.0 * of_pair;
        }
    }
    return (TURNED * t->astray * ((mass_size / mass) + (size / energy))) +
           (t->unbalanced * size / energy);
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
    q->noise += t->settled_at == NULL ? 0.0 : astray_by(t, v, size, mass, energy);
}
