/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The edge of a body to the one before it. With the rows A of its joints and f of its springs
 * over the motion of the body itself (those over the other are theirs: a measure does not
 * change when both move as one, f_p + X^T f = 0, which is checked):
 *     A N = 0,    B = rows sqrt(k) f^T N = U Sigma V^T,    F = V Sigma^-1, R = V where Sigma =
 * 0. B by one-sided Jacobi rotations: every stiffness keeps its own digits, however far they
 * lie apart between the directions of an edge. Rotations are measured by the length that makes
 * the rows' halves alike.
 */
#include "tree/tree_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "linalg/dense.h"
#include "mechanics/rows.h"

enum { MOST = MT_TREE_MOTION, SQUARE = MOST * MOST, ROWS = MT_TREE_EDGE_ROWS, SWEEPS = 40 };

/* Of a measure that changes though both its bodies move as one. */
static const double NOT_RELATIVE = 1e-9;
/* What is left of an equation of unit length is no more than rounding, or clearly one more. */
static const double DEPENDENT = 1e-12;
static const double INDEPENDENT = 1e-7;
/* Likewise of the stiffnesses' square roots. */
static const double NO_STIFFNESS = 1e-13;
static const double A_STIFFNESS = 1e-10;
/* Rounding of an entry of B, in units of its terms. */
static const double ROW_ULPS = 16.0;

typedef struct edge {
    int n;                            /* rows */
    double row[(ROWS + MOST) * MOST]; /* row i from s i on, over the motion of the body */
    double weight[ROWS];              /* sqrt(k); 1 */
    double size[ROWS];                /* of springs: of the terms of a strain of unit motion */
} edge;

/* Add a measure's gradient as a row of the edge; false where it is not a measure of two bodies'
 * relative position. */
static bool add_gradient_row(const mt_tree_maker *m, int i, const mt_measure_def *def,
                             double weight, edge *e)
{
    const mt_tree *const t = m->t;
    const mt_measure_data measure = mt_data_measure(&m->data, def);
    mt_jet jet;
    mt_measure_eval(&measure, mt_pose_of(m->pose, def->body[0]),
                    mt_pose_of(m->pose, def->body[1]), false, NULL, &jet);
    const int side = def->body[1] == t->body[i] ? 1 : 0;
    double *const row = e->row + ((ptrdiff_t)t->s * e->n);
    double left[MOST] = {0.0};
    double size = 0.0;
    for (int k = 0; k < t->s; k++) {
        const int local = mt_tree_freedom(t, k);
        const bool free = t->sys->bodies[t->body[i]].dof[local] >= 0;
        row[k] = free ? creal(jet.g[(6 * side) + local]) : 0.0;
    }
    e->weight[e->n++] = weight;
    if (t->before[i] < 0) {
        return true;
    }
    mt_tree_carry_back(t, i, row, left);
    const double *const a = t->arm + ((ptrdiff_t)3 * i);
    const double reach = fmax(fmax(fabs(a[0]), fabs(a[1])), fabs(a[2]));
    for (int k = 0; k < t->s; k++) {
        size = fmax(size, fabs(row[k]) * fmax(1.0, reach));
    }
    for (int k = 0; k < t->s; k++) {
        const int local = mt_tree_freedom(t, k);
        const bool free = t->sys->bodies[t->body[t->before[i]]].dof[local] >= 0;
        const double own = free ? creal(jet.g[(6 * (1 - side)) + local]) : -left[k];
        size = fmax(size, fabs(own));
        left[k] += own;
    }
    for (int k = 0; k < t->s; k++) {
        if (!(fabs(left[k]) <= NOT_RELATIVE * size)) {
            return false;
        }
    }
    return true;
}

/* The length that scales rotations to translations. */
static double rotation_length(const mt_tree *t, const edge *e)
{
    double half[2] = {0.0, 0.0};
    for (int r = 0; r < e->n; r++) {
        for (int k = 0; k < t->s; k++) {
            const int turn = mt_tree_freedom(t, k) >= 3 ? 1 : 0;
            half[turn] = fmax(half[turn], fabs(e->row[k + (t->s * r)]));
        }
    }
    return half[0] > 0.0 && half[1] > 0.0 ? half[1] / half[0] : t->sys->length_m;
}

static void scale_rows(const mt_tree *t, double length, edge *e)
{
    for (int r = 0; r < e->n; r++) {
        for (int k = 0; k < t->s; k++) {
            e->row[k + (t->s * r)] /= mt_tree_freedom(t, k) >= 3 ? length : 1.0;
        }
    }
}

/* x := x - 2 u (u^T x), of length s. */
static void reflect(int s, const double *u, double *x)
{
    double sum = 0.0;
    for (int k = 0; k < s; k++) {
        sum += u[k] * x[k];
    }
    for (int k = 0; k < s; k++) {
        x[k] -= 2.0 * sum * u[k];
    }
}

/* Each row of unit length, or 0. */
static void normalise(int s, edge *e)
{
    for (int r = 0; r < e->n; r++) {
        double *const row = e->row + ((ptrdiff_t)s * r);
        const double norm = mt_norm2(s, row);
        for (int k = 0; k < s && norm > 0.0; k++) {
            row[k] /= norm;
        }
    }
}

/* Index of the longest row from `rank` on, over its entries from `rank` on; -1: none. */
static int longest_row(int s, const edge *e, int rank, double *length)
{
    int best = -1;
    *length = 0.0;
    for (int r = rank; r < e->n; r++) {
        const double norm = mt_norm2(s - rank, e->row + ((ptrdiff_t)s * r) + rank);
        if (norm > *length) {
            *length = norm;
            best = r;
        }
    }
    return best;
}

/* Bring row `best` to the place `rank`, and reflect it, and those behind it, onto axis `rank`
 * along u[s]. */
static void reflect_row_onto_axis(int s, int rank, int best, double length, edge *e, double *u)
{
    double *const a = e->row + ((ptrdiff_t)s * rank);
    double *const b = e->row + ((ptrdiff_t)s * best);
    for (int k = 0; k < s; k++) {
        const double x = a[k];
        a[k] = b[k];
        b[k] = x;
        u[k] = k < rank ? 0.0 : a[k];
    }
    u[rank] += copysign(length, u[rank]);
    const double norm = mt_norm2(s, u);
    for (int k = rank; k < s; k++) {
        u[k] /= norm;
    }
    for (int r = rank; r < e->n; r++) {
        reflect(s, u, e->row + ((ptrdiff_t)s * r));
    }
}

/* The null space of the rows: Householder QR of A^T, the longest row first. null (s x s), *d
 * its columns. *least: length of the last row that was used. False where the rank is
 * uncertain. */
static bool null_space(int s, edge *e, double *null, int *d, double *least)
{
    double u[SQUARE];
    int rank = 0;
    *least = 1.0;
    normalise(s, e);
    for (; rank < s; rank++) {
        double length = 0.0;
        const int best = longest_row(s, e, rank, &length);
        if (best < 0 || length <= DEPENDENT) {
            break;
        }
        if (length < INDEPENDENT) {
            return false;
        }
        *least = fmin(*least, length);
        reflect_row_onto_axis(s, rank, best, length, e, u + ((ptrdiff_t)s * rank));
    }
    *d = s - rank;
    for (int c = 0; c < *d; c++) {
        double *const x = null + ((ptrdiff_t)s * c);
        memset(x, 0, (size_t)s * sizeof *x);
        x[rank + c] = 1.0;
        for (int k = rank - 1; k >= 0; k--) {
            reflect(s, u + ((ptrdiff_t)s * k), x);
        }
    }
    return true;
}

/* b (ROWS x d) := weight f^T N, with rounding set to 0; fills e->size. */
static void stiffness_rows(const mt_tree *t, edge *e, const double *null, int d, double *b)
{
    for (int r = 0; r < e->n; r++) {
        e->size[r] = e->weight[r] * mt_norm2(t->s, e->row + ((ptrdiff_t)t->s * r));
        for (int c = 0; c < d; c++) {
            double sum = 0.0;
            double size = 0.0;
            for (int k = 0; k < t->s; k++) {
                const double term = e->row[k + (t->s * r)] * null[k + (t->s * c)];
                sum += term;
                size += fabs(e->row[k + (t->s * r)]);
            }
            b[r + (c * ROWS)] =
                fabs(sum) <= ROW_ULPS * DBL_EPSILON * size ? 0.0 : e->weight[r] * sum;
        }
    }
}

static double column_dot(int n, const double *b, int p, int q)
{
    double sum = 0.0;
    for (int r = 0; r < n; r++) {
        sum += b[r + (p * ROWS)] * b[r + (q * ROWS)];
    }
    return sum;
}

static void rotate_two_columns(int n, int stride, double c, double s, int p, int q, double *x)
{
    for (int r = 0; r < n; r++) {
        const double xp = x[r + (p * stride)];
        const double xq = x[r + (q * stride)];
        x[r + (p * stride)] = (c * xp) - (s * xq);
        x[r + (q * stride)] = (s * xp) + (c * xq);
    }
}

/* Make the columns of b orthogonal, and null := null V. */
static void jacobi(const mt_tree *t, int n, int d, double *b, double *null)
{
    bool changed = true;
    for (int sweep = 0; sweep < SWEEPS && changed; sweep++) {
        changed = false;
        for (int p = 0; p < d; p++) {
            for (int q = p + 1; q < d; q++) {
                const double alpha = column_dot(n, b, p, p);
                const double beta = column_dot(n, b, q, q);
                const double gamma = column_dot(n, b, p, q);
                if (!(fabs(gamma) > DBL_EPSILON * sqrt(alpha) * sqrt(beta))) {
                    continue;
                }
                const double zeta = (beta - alpha) / (2.0 * gamma);
                const double tangent = copysign(1.0, zeta) / (fabs(zeta) + hypot(1.0, zeta));
                const double c = 1.0 / hypot(1.0, tangent);
                rotate_two_columns(n, ROWS, c, c * tangent, p, q, b);
                rotate_two_columns(t->s, t->s, c, c * tangent, p, q, null);
                changed = true;
            }
        }
    }
}

static bool collect_edge_rows(mt_tree_maker *m, int i, bool springs, edge *e)
{
    const mt_tree *const t = m->t;
    const mt_system *const sys = t->sys;
    const int first = springs ? t->first_spring[i] : t->first_constraint[i];
    e->n = 0;
    for (int k = first; k >= 0; k = springs ? t->next_spring[k] : t->next_constraint[k]) {
        const int measure =
            springs ? sys->springs[k].measure[0] : sys->constraints[k].measure[0];
        const double weight = springs ? sqrt(m->data.value[sys->springs[k].stiffness]) : 1.0;
        const char *const name =
            springs ? sys->springs[k].name : sys->joints[sys->constraints[k].joint].name;
        if (e->n == ROWS) {
            (void)mt_snprintf(m->why, MT_TREE_WHY,
                              "more than %d springs or equations lie "
                              "between \"%s\" and what it hangs on",
                              (int)ROWS, sys->bodies[m->t->body[i]].name);
            return false;
        }
        if (!add_gradient_row(m, i, &sys->measures[measure], weight, e)) {
            (void)mt_snprintf(m->why, MT_TREE_WHY, "%s \"%s\" holds a point mass by its turn",
                              springs ? "spring" : "joint", name);
            return false;
        }
    }
    return true;
}

/* Cancellation in the energy of column c: a strain has the rounding of its terms. */
static double lost_of(const edge *e, const double *b, int c, double sigma)
{
    double sum = 0.0;
    for (int r = 0; r < e->n; r++) {
        sum += fabs(b[r + (c * ROWS)] / sigma) * (e->size[r] / sigma);
    }
    return sum;
}

/* Columns with stiffness first, each scaled by its own; false where one is uncertain.
 * lost[n_y]. */
static bool sort_columns(const mt_tree *t, const edge *e, int d, const double *b,
                         const double *null, double *basis, int *n_y, double *lost)
{
    double sigma[MOST];
    int order[MOST] = {0};
    double most = 0.0;
    int at = 0;
    for (int c = 0; c < d; c++) {
        sigma[c] = sqrt(column_dot(e->n, b, c, c));
        most = fmax(most, sigma[c]);
    }
    for (int c = 0; c < d; c++) {
        if (sigma[c] > NO_STIFFNESS * most) {
            if (sigma[c] < A_STIFFNESS * most) {
                return false;
            }
            lost[at] = lost_of(e, b, c, sigma[c]);
            order[at++] = c;
        }
    }
    *n_y = at;
    for (int c = 0; c < d; c++) {
        if (!(sigma[c] > NO_STIFFNESS * most)) {
            order[at++] = c;
        }
    }
    for (int c = 0; c < d; c++) {
        const int from = order[c];
        for (int k = 0; k < t->s; k++) {
            basis[k + (t->s * c)] = null[k + (t->s * from)] / (c < *n_y ? sigma[from] : 1.0);
        }
    }
    return true;
}

bool mt_tree_edge(mt_tree_maker *m, int i, double *basis, int *n_y, int *n_free_dofs)
{
    const mt_tree *const t = m->t;
    edge joints;
    edge springs;
    double null[SQUARE];
    double b[ROWS * MOST];
    double least = 1.0;
    int d = 0;
    if (!collect_edge_rows(m, i, false, &joints) || !collect_edge_rows(m, i, true, &springs)) {
        return false;
    }
    const double length = rotation_length(t, joints.n > 0 ? &joints : &springs);
    scale_rows(t, length, &joints);
    scale_rows(t, length, &springs);
    for (int k = 0; k < t->s && t->point[i]; k++) {
        if (mt_tree_freedom(t, k) >= 3) { /* a point mass does not turn */
            double *const row = joints.row + ((ptrdiff_t)t->s * joints.n++);
            memset(row, 0, (size_t)t->s * sizeof *row);
            row[k] = 1.0;
        }
    }
    const bool clear = null_space(t->s, &joints, null, &d, &least);
    if (clear && d > t->s - joints.n) {
        (void)mt_snprintf(m->why, MT_TREE_WHY, "joints of \"%s\" hold it twice",
                          t->sys->bodies[t->body[i]].name);
        return false;
    }
    if (clear) {
        stiffness_rows(t, &springs, null, d, b);
        jacobi(t, springs.n, d, b, null);
    }
    t->length[i] = length;
    t->condition[i] = 1.0 / least;
    if (!clear || !sort_columns(t, &springs, d, b, null, basis, n_y, t->lost + t->y_at[i])) {
        (void)mt_snprintf(m->why, MT_TREE_WHY, "what holds \"%s\" nearly fails to hold it",
                          t->sys->bodies[t->body[i]].name);
        return false;
    }
    *n_free_dofs = d - *n_y;
    for (int c = 0; c < d; c++) {
        for (int k = 0; k < t->s; k++) {
            basis[k + (t->s * c)] /= mt_tree_freedom(t, k) >= 3 ? length : 1.0;
        }
    }
    return true;
}
