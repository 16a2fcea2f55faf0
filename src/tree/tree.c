/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A system as a tree: its edges, masses and loads, and the order of its bodies. */
#include "tree/tree.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "base/run.h"
#include "linalg/dense.h"
#include "mechanics/absolute.h"
#include "mechanics/data.h"
#include "mechanics/lagrangian.h"
#include "mechanics/rows.h"

typedef struct tree_maker {
    mt_tree *t;
    mt_data data;
    mt_placement at;
    mt_pose *pose; /* [bodies] of at */
    /* [nq] of where it has settled: the motion from there to the balance, and what is open of
     * it */
    double *left;
    double *open;
    double *round; /* [n] forces on a body and its descendants that are open by that [N] */
    bool moves;    /* not at rest, or not closed */
    char *why;
} tree_maker;

/*
 * The edge of a body to the one before it. With the rows A of its joints and f of its springs
 * over the motion of the body itself (those over the other are theirs: a measure does not
 * change when both move as one, f_p + X^T f = 0, which is checked):
 *     A N = 0,    B = rows sqrt(k) f^T N = U Sigma V^T,    F = V Sigma^-1, R = V where Sigma =
 * 0. B by one-sided Jacobi rotations: every stiffness keeps its own digits, however far they
 * lie apart between the directions of an edge. Rotations are measured by the length that makes
 * the rows' halves alike.
 */

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
static bool add_gradient_row(const tree_maker *m, int i, const mt_measure_def *def,
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

static bool collect_edge_rows(tree_maker *m, int i, bool springs, edge *e)
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

/* Basis of the edge of body i into basis[s x s]: *n_y columns N F, then *n_free_dofs columns N
 * R; sets its length, condition and lost. False, with the reason in why: not a tree. */
static bool tree_edge(tree_maker *m, int i, double *basis, int *n_y, int *n_free_dofs)
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

/* Masses of the bodies of a tree: a block of each, and one with the body before it where they
 * share some (beam elements, bars). */

enum { MOST_ROWS = 16 };

/* block (s x s) += c a b^T, halves `u` and `v` of the local freedoms. */
static void add_block(const mt_tree *t, double c, const mt_cx *a, int u, const mt_cx *b, int v,
                      double *block)
{
    for (int col = 0; col < t->s; col++) {
        const double x = c * creal(b[(6 * v) + mt_tree_freedom(t, col)]);
        for (int row = 0; row < t->s; row++) {
            block[row + (t->s * col)] += x * creal(a[(6 * u) + mt_tree_freedom(t, row)]);
        }
    }
}

/* Set rotations of point masses to 0: they are not freedoms. */
static void clear_point_mass_rotations(const mt_system *sys, const mt_term *term, mt_cx *rows)
{
    for (int r = 0; r < term->count; r++) {
        for (int k = 0; k < MT_LOCAL; k++) {
            const int body = term->body[k / 6];
            if (body == MT_GROUND || sys->bodies[body].dof[k % 6] < 0) {
                rows[k + (MT_LOCAL * r)] = 0.0;
            }
        }
    }
}

static void add_mass_term(tree_maker *m, const mt_term *term, double c, const mt_cx *rows)
{
    mt_tree *const t = m->t;
    const ptrdiff_t square = (ptrdiff_t)t->s * t->s;
    const bool same = term->body[0] == term->body[1];
    for (int r = 0; r < (term->pair ? 1 : term->count); r++) {
        const mt_cx *const a = rows + ((ptrdiff_t)MT_LOCAL * r);
        const mt_cx *const b = term->pair ? a + MT_LOCAL : a;
        for (int side = 0; side < (same ? 1 : 2); side++) {
            if (term->body[side] == MT_GROUND) {
                continue;
            }
            double *const own = t->mass + (square * t->place[term->body[side]]);
            add_block(t, 0.5 * c, a, side, b, side, own);
            add_block(t, 0.5 * c, b, side, a, side, own);
        }
        if (same || term->body[0] == MT_GROUND || term->body[1] == MT_GROUND) {
            continue;
        }
        const int first = t->place[term->body[0]];
        const int second = t->place[term->body[1]];
        const int before = t->before[second] == first ? 0 : 1; /* side of the body before */
        double *const shared = t->shared + (square * (before == 0 ? second : first));
        add_block(t, c, a, before, a, 1 - before, shared); /* no pair is of two bodies */
    }
}

/* Set the masses of all bodies; *is_tree false: not a tree, with the reason in why. Fails:
 * MT_E_MEMORY. */
static mt_status tree_masses(tree_maker *m, mt_arena *mem, bool *is_tree, mt_err *err)
{
    mt_tree *const t = m->t;
    const mt_system *const sys = t->sys;
    mt_cx rows[MOST_ROWS * MT_LOCAL];
    for (int i = 0; i < sys->n_inertias && t->shared == NULL; i++) {
        if (sys->inertias[i].body[0] != sys->inertias[i].body[1]) {
            t->shared = mt_arena_f64(mem, (size_t)t->n * (size_t)t->s, (size_t)t->s);
            MT_TRY(mt_arena_check(mem, err));
        }
    }
    for (int i = 0; i < sys->n_inertias; i++) {
        const mt_term term = mt_term_of_inertia(sys, i);
        const double c = m->data.value[term.coefficient];
        if (c < 0.0 && !term.pair) {
            (void)mt_snprintf(m->why, MT_TREE_WHY, "a mass of \"%s\" is negative",
                              sys->bodies[term.body[0]].name);
            *is_tree = false;
            return MT_OK;
        }
        if (c != 0.0) {
            mt_term_rows(&m->data, MT_TERM_MASS, &term, m->pose, rows);
            clear_point_mass_rotations(sys, &term, rows);
            add_mass_term(m, &term, c, rows);
        }
    }
    return MT_OK;
}

/*
 * Loads on a tree that is drawn at rest. With g the gradient of the potential V, body by body,
 * the forces of a body and of all that hangs on it balance in the directions that its edge
 * leaves free, and the joints of the edge hold the rest:
 *     N_i^T G_i = 0,    A_i^T lambda_i = -G_i,    G_before += X_i^T G_i.
 * The geometric stiffness is that of V and of lambda times the equations: blocks of the same
 * bodies as the masses have.
 */

/* Forces that do not balance, relative to all those that meet there: beyond rounding, the
 * drawing is not at rest. */
static const double NOT_AT_REST = 1e-11;
/* What Newton's method leaves unbalanced, in what rounding of the positions may be of it. */
static const double ROOM = 8.0;

typedef struct loading {
    tree_maker *m;
    double *g; /* s x n: G */
} loading;

static double local_component(const mt_tree *t, const mt_cx *local, int side, int k)
{
    return creal(local[(6 * side) + mt_tree_freedom(t, k)]);
}

static bool is_free(const mt_tree *t, int body, int k)
{
    return body != MT_GROUND && t->sys->bodies[body].dof[mt_tree_freedom(t, k)] >= 0;
}

/* += c times the Hessian of a measure of two bodies (MT_GROUND: the ground); false where both
 * are bodies of no edge. */
static bool add_curvature(const tree_maker *m, const int body[2], double c, const mt_jet *jet)
{
    mt_tree *const t = m->t;
    const ptrdiff_t square = (ptrdiff_t)t->s * t->s;
    for (int side = 0; side < 2; side++) {
        const int at = body[side] == MT_GROUND ? -1 : t->place[body[side]];
        for (int k = 0; k < t->s * t->s && at >= 0; k++) {
            const int row = k % t->s;
            const int col = k / t->s;
            if (is_free(t, body[side], row) && is_free(t, body[side], col)) {
                t->geometric_stiffness[k + (square * at)] +=
                    c * local_component(t,
                                        jet->h + ((ptrdiff_t)MT_LOCAL *
                                                  ((6 * side) + mt_tree_freedom(t, col))),
                                        side, row);
            }
        }
    }
    if (body[0] == MT_GROUND || body[1] == MT_GROUND) {
        return true;
    }
    const int first = t->before[t->place[body[1]]] == t->place[body[0]] ? 0 : 1;
    const int at = t->place[body[1 - first]];
    if (t->before[at] != t->place[body[first]]) {
        return false;
    }
    for (int k = 0; k < t->s * t->s; k++) {
        const int row = k % t->s;
        const int col = k / t->s;
        if (is_free(t, body[first], row) && is_free(t, body[1 - first], col)) {
            t->geometric_stiffness_shared[k + (square * at)] +=
                c * local_component(t,
                                    jet->h + ((ptrdiff_t)MT_LOCAL *
                                              ((6 * (1 - first)) + mt_tree_freedom(t, col))),
                                    first, row);
        }
    }
    return true;
}

/* A force that a potential -c times the measure makes. */
static bool add_force(void *context, const int body[2], double c, double noise,
                      const mt_jet *jet)
{
    const loading *const l = context;
    const mt_tree *const t = l->m->t;
    for (int side = 0; side < 2; side++) {
        const int at = body[side] == MT_GROUND ? -1 : t->place[body[side]];
        for (int k = 0; k < t->s && at >= 0; k++) {
            if (is_free(t, body[side], k)) {
                const double f = c * local_component(t, jet->g, side, k);
                l->g[k + ((ptrdiff_t)t->s * at)] += f;
                const double g = fabs(local_component(t, jet->g, side, k));
                const double arm = mt_tree_freedom(t, k) >= 3 ? t->sys->length_m : 1.0;
                l->m->t->force[at] += fabs(f) / arm;
                l->m->round[at] += noise * g / arm;
            }
        }
    }
    return add_curvature(l->m, body, c, jet);
}

/* True where G_i is balanced along the free motions of the edge. */
static bool is_at_rest(const loading *l, int i)
{
    const mt_tree *const t = l->m->t;
    const double *const g = l->g + ((ptrdiff_t)t->s * i);
    const ptrdiff_t first = t->y_at[i] + t->free_dof_at[i];
    const ptrdiff_t end = t->y_at[i + 1] + t->free_dof_at[i + 1];
    for (ptrdiff_t c = first; c < end; c++) {
        const double *const b = t->basis + (t->s * c);
        double power = 0.0;
        double most = 0.0;
        for (int k = 0; k < t->s; k++) {
            power += b[k] * g[k];
            most =
                fmax(most, fabs(b[k]) * (mt_tree_freedom(t, k) >= 3 ? t->sys->length_m : 1.0));
        }
        const double most_force = most * l->m->t->force[i];
        if (!(fabs(power) <= (NOT_AT_REST * most_force) + (ROOM * most * l->m->round[i]))) {
            (void)mt_snprintf(l->m->why, MT_TREE_WHY,
                              t->settled_at == NULL
                                  ? "\"%s\" is not drawn at rest under its load"
                                  : "forces on \"%s\" cancel beyond rounding where it has "
                                    "settled",
                              t->sys->bodies[t->body[i]].name);
            l->m->moves = true;
            return false;
        }
        if (power != 0.0 && t->settled_at != NULL) {
            l->m->t->unbalanced = fmax(l->m->t->unbalanced, fabs(power) / most_force);
        }
    }
    return true;
}

mt_status mt_tree_hold(const mt_tree *t, int c, const double *row, mt_tree_held *h, mt_err *err)
{
    const double length = t->sys->length_m;
    h->c = c;
    for (int i = 0; i < c; i++) {
        for (int k = 0; k < t->s; k++) {
            h->row[k + (i * t->s)] =
                row[k + (i * t->s)] / (mt_tree_freedom(t, k) >= 3 ? length : 1.0);
        }
        h->scale[i] = 1.0 / mt_norm2(t->s, h->row + ((ptrdiff_t)i * t->s));
    }
    for (int i = 0; i < c; i++) {
        for (int j = 0; j < c; j++) {
            h->gram[i + (j * c)] =
                h->scale[i] * h->scale[j] *
                mt_dot(t->s, h->row + ((ptrdiff_t)i * t->s), h->row + ((ptrdiff_t)j * t->s));
        }
    }
    return c == 0 ? MT_OK : mt_cholesky(c, h->gram, NULL, err);
}

void mt_tree_multipliers(const mt_tree *t, const mt_tree_held *h, const double *g,
                         double *lambda)
{
    const double length = t->sys->length_m;
    for (int i = 0; i < h->c; i++) {
        lambda[i] = 0.0;
        for (int k = 0; k < t->s; k++) {
            lambda[i] -= h->scale[i] * h->row[k + (i * t->s)] * g[k] /
                         (mt_tree_freedom(t, k) >= 3 ? length : 1.0);
        }
        for (int j = 0; j < i; j++) { /* L^-1 */
            lambda[i] -= h->gram[i + (j * h->c)] * lambda[j];
        }
        lambda[i] /= h->gram[i + (i * h->c)];
    }
    for (int i = h->c - 1; i >= 0; i--) { /* L^-T */
        for (int j = i + 1; j < h->c; j++) {
            lambda[i] -= h->gram[j + (i * h->c)] * lambda[j];
        }
        lambda[i] /= h->gram[i + (i * h->c)];
    }
    for (int i = 0; i < h->c; i++) {
        lambda[i] *= h->scale[i];
    }
}

/* Multipliers of the joints of edge i that balance G_i: adds their curvature, and adds G_i to
 * the parent's G. */
static mt_status balance_edge_joints(const loading *l, int i, mt_err *err)
{
    const tree_maker *const m = l->m;
    const mt_tree *const t = m->t;
    const mt_system *const sys = t->sys;
    double row[MOST * MOST];
    double lambda[MOST] = {0.0};
    mt_tree_held held;
    mt_jet jet[MOST];
    int c = 0;
    const double *const g = l->g + ((ptrdiff_t)t->s * i);
    for (int k = t->first_constraint[i]; k >= 0; k = t->next_constraint[k], c++) {
        const mt_measure_def *const def = &sys->measures[sys->constraints[k].measure[0]];
        const mt_measure_data measure = mt_data_measure(&m->data, def);
        const int side = def->body[1] == t->body[i] ? 1 : 0;
        mt_measure_eval(&measure, mt_pose_of(m->pose, def->body[0]),
                        mt_pose_of(m->pose, def->body[1]), true, NULL, &jet[c]);
        for (int r = 0; r < t->s; r++) {
            row[r + (c * t->s)] =
                is_free(t, t->body[i], r) ? local_component(t, jet[c].g, side, r) : 0.0;
        }
    }
    MT_TRY(mt_tree_hold(t, c, row, &held, err));
    mt_tree_multipliers(t, &held, g, lambda);
    c = 0;
    for (int k = t->first_constraint[i]; k >= 0; k = t->next_constraint[k], c++) {
        const mt_measure_def *const def = &sys->measures[sys->constraints[k].measure[0]];
        t->held[k] = lambda[c];
        (void)add_curvature(m, def->body, lambda[c], &jet[c]);
    }
    if (t->before[i] >= 0) {
        mt_tree_carry_back(t, i, g, l->g + ((ptrdiff_t)t->s * t->before[i]));
        l->m->t->force[t->before[i]] += l->m->t->force[i];
        l->m->round[t->before[i]] += l->m->round[i];
    }
    return MT_OK;
}

/* The motion from where it has settled to the balance; sets how large it is. */
static mt_status find_balance(tree_maker *m, mt_arena *scratch, mt_err *err)
{
    mt_tree *const t = m->t;
    const mt_system *const sys = t->sys;
    m->left = mt_arena_f64(scratch, (size_t)sys->nq, 1);
    m->open = mt_arena_f64(scratch, (size_t)sys->nq, 1);
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(mt_position_balance(t->settled_at, &m->data, m->left, m->open, scratch, err));
    for (int b = 0; b < sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            const int dof = sys->bodies[b].dof[k];
            const double unit = k < 3 ? sys->length_m : 1.0;
            t->astray = dof < 0 ? t->astray : fmax(t->astray, fabs(m->left[dof]) / unit);
        }
    }
    return MT_OK;
}

/* Set the geometric stiffness of the loads, with the position in equilibrium; *is_tree false:
 * not a tree, with the reason in why. Fails: MT_E_MEMORY, MT_E_NOT_SPD. */
static mt_status tree_loads(tree_maker *m, mt_arena *mem, mt_arena *scratch, bool *is_tree,
                            mt_err *err)
{
    mt_tree *const t = m->t;
    const size_t n = (size_t)t->n;
    const size_t s = (size_t)t->s;
    t->pushed = mt_arena_f64(mem, s, n);
    t->held = mt_arena_f64(mem, (size_t)t->sys->n_constraints, 1);
    loading l = {.m = m, .g = t->pushed};
    t->force = mt_arena_f64(mem, n, 1);
    t->geometric_stiffness = mt_arena_f64(mem, n * s, s);
    t->geometric_stiffness_shared = mt_arena_f64(mem, n * s, s);
    m->round = mt_arena_f64(scratch, n, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_arena_check(scratch, err));
    if (t->settled_at == NULL) {
        *is_tree = mt_forces_each(&m->data, m->pose, add_force, &l);
    } else {
        MT_TRY(find_balance(m, scratch, err));
        *is_tree = mt_forces_at(&m->data, &m->at, m->left, m->open, add_force, &l);
    }
    if (!*is_tree) {
        (void)mt_snprintf(m->why, MT_TREE_WHY,
                          "a load acts between bodies that hang on others");
    }
    for (int i = t->n - 1; i >= 0 && *is_tree; i--) {
        *is_tree = is_at_rest(&l, i);
        if (*is_tree) {
            MT_TRY(balance_edge_joints(&l, i, err));
        }
    }
    return MT_OK;
}

/* Checks whether a system is a tree, and orders its bodies: breadth first from the ground, then
 * from the first body of each part that nothing connects to it. */

enum { FREE = -2 }; /* what a body hangs on that hangs on nothing */

/* A gap below this times the model length is rounding of the drawing's own numbers. */
static const double DRAWN_CLOSED = 1e-13;

/* What ties two bodies: a constraint, a spring, a mass that they share. */
typedef enum tie_kind { TIE_JOINT, TIE_SPRING, TIE_MASS } tie_kind;
typedef struct tie {
    tie_kind kind;
    int which;
    int body[2]; /* MT_GROUND: the ground */
} tie;

typedef struct order {
    const mt_system *sys;
    const double *value;
    int n_ties;
    tie *ties;
    int *first; /* [bodies + 2] of each body's ties in `list`; the ground is the last body */
    int *list;  /* [2 n_ties] */
    int *above; /* [bodies] body that it hangs on, MT_GROUND or FREE */
    int *place; /* [bodies] in the order; -1: not there yet */
} order;

static void add_tie(order *o, tie_kind kind, int which, const int body[2])
{
    o->ties[o->n_ties++] = (tie){kind, which, {body[0], body[1]}};
}

static bool acts(const order *o, int spring)
{
    const mt_spring_def *const s = &o->sys->springs[spring];
    return !s->damper &&
           (o->value[s->stiffness] != 0.0 || s->free != MT_NO_NODE || s->preload != MT_NO_NODE);
}

static void collect_ties(order *o)
{
    const mt_system *const sys = o->sys;
    for (int i = 0; i < sys->n_constraints; i++) {
        add_tie(o, TIE_JOINT, i, sys->measures[sys->constraints[i].measure[0]].body);
    }
    for (int i = 0; i < sys->n_springs; i++) {
        if (acts(o, i)) {
            add_tie(o, TIE_SPRING, i, sys->measures[sys->springs[i].measure[0]].body);
        }
    }
    for (int i = 0; i < sys->n_inertias; i++) {
        const int *const body = sys->inertias[i].body;
        if (body[0] != body[1] && body[0] != MT_GROUND && body[1] != MT_GROUND) {
            add_tie(o, TIE_MASS, i, body);
        }
    }
}

/* Each body's ties, by counting. */
static void sort_ties(order *o)
{
    const int nb = o->sys->n_bodies;
    for (int i = 0; i < 2 * o->n_ties; i++) {
        const int b = o->ties[i / 2].body[i % 2];
        o->first[(b == MT_GROUND ? nb : b) + 1]++;
    }
    for (int b = 0; b <= nb; b++) {
        o->first[b + 1] += o->first[b];
    }
    for (int i = (2 * o->n_ties) - 1; i >= 0; i--) { /* each list ends up in order */
        const int b = o->ties[i / 2].body[i % 2];
        o->list[--o->first[(b == MT_GROUND ? nb : b) + 1]] = i / 2;
    }
    for (int b = 0; b <= nb; b++) { /* the starts stand one too far */
        o->first[b] = o->first[b + 1];
    }
    o->first[nb + 1] = 2 * o->n_ties;
}

static void tell_loop(const order *o, const tie *e, char *why)
{
    const mt_system *const sys = o->sys;
    const char *const name = e->kind == TIE_JOINT
                                 ? sys->joints[sys->constraints[e->which].joint].name
                             : e->kind == TIE_SPRING ? sys->springs[e->which].name
                                                     : NULL;
    if (name == NULL) {
        (void)mt_snprintf(why, MT_TREE_WHY, "a mass that two bodies share is part of a loop");
    } else {
        (void)mt_snprintf(why, MT_TREE_WHY, "%s \"%s\" is part of a loop",
                          e->kind == TIE_JOINT ? "joint" : "spring", name);
    }
}

/* Visit all bodies connected to body b (MT_GROUND: the ground); false where a connection closes
 * a loop. */
static bool visit_connected(order *o, mt_tree *t, int b, char *why)
{
    const int at = b == MT_GROUND ? o->sys->n_bodies : b;
    for (int i = o->first[at]; i < o->first[at + 1]; i++) {
        const tie *const e = &o->ties[o->list[i]];
        const int other = e->body[0] == b ? e->body[1] : e->body[0];
        const bool back = b != MT_GROUND && o->above[b] == other;
        if (back || (other != MT_GROUND && o->place[other] >= 0 && o->above[other] == b)) {
            continue; /* one more tie of an edge that there is */
        }
        if (other == MT_GROUND || o->place[other] >= 0) {
            tell_loop(o, e, why);
            return false;
        }
        o->above[other] = b;
        o->place[other] = t->n;
        t->before[t->n] = b == MT_GROUND ? -1 : o->place[b];
        t->body[t->n++] = other;
    }
    return true;
}

static bool find_order(order *o, mt_tree *t, char *why)
{
    int done = 0;
    if (!visit_connected(o, t, MT_GROUND, why)) {
        return false;
    }
    for (int root = 0; root < o->sys->n_bodies || done < t->n;) {
        if (done < t->n) {
            if (!visit_connected(o, t, t->body[done++], why)) {
                return false;
            }
        } else if (o->place[root++] < 0) {
            o->above[root - 1] = FREE;
            o->place[root - 1] = t->n;
            t->before[t->n] = -1;
            t->body[t->n++] = root - 1;
        }
    }
    return true;
}

/* The edges' own constraints and springs, as lists in order. */
static void list_edges(mt_tree *t, const order *o)
{
    memset(t->first_constraint, 0xFF, (size_t)t->n * sizeof(int)); /* -1 */
    memset(t->first_spring, 0xFF, (size_t)t->n * sizeof(int));
    for (int i = o->n_ties - 1; i >= 0; i--) {
        const tie *const e = &o->ties[i];
        const int a = e->body[0];
        const int b = e->body[1];
        const int owner = o->place[b != MT_GROUND && o->above[b] == a ? b : a];
        if (e->kind == TIE_JOINT) {
            t->next_constraint[e->which] = t->first_constraint[owner];
            t->first_constraint[owner] = e->which;
        } else if (e->kind == TIE_SPRING) {
            t->next_spring[e->which] = t->first_spring[owner];
            t->first_spring[owner] = e->which;
        }
    }
}

static mt_status order_bodies(tree_maker *m, mt_arena *mem, mt_arena *scratch, bool *is_tree,
                              mt_err *err)
{
    mt_tree *const t = m->t;
    const mt_system *const sys = t->sys;
    const size_t nb = (size_t)sys->n_bodies;
    const size_t most =
        (size_t)sys->n_constraints + (size_t)sys->n_springs + (size_t)sys->n_inertias;
    order o = {.sys = sys, .value = m->data.value};
    o.ties = mt_arena_alloc(scratch, most, sizeof *o.ties);
    o.first = mt_arena_int(scratch, nb + 2);
    o.list = mt_arena_int(scratch, 2 * most);
    o.above = mt_arena_int(scratch, nb);
    t->place = mt_arena_int(mem, nb);
    t->first_constraint = mt_arena_int(mem, nb);
    t->first_spring = mt_arena_int(mem, nb);
    t->next_constraint = mt_arena_int(mem, (size_t)sys->n_constraints);
    t->next_spring = mt_arena_int(mem, (size_t)sys->n_springs);
    o.place = t->place;
    t->body = mt_arena_int(mem, nb);
    t->before = mt_arena_int(mem, nb);
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(mt_arena_check(mem, err));
    memset(o.place, 0xFF, nb * sizeof *o.place); /* -1 */
    collect_ties(&o);
    sort_ties(&o);
    *is_tree = find_order(&o, t, m->why);
    if (*is_tree) {
        list_edges(t, &o);
    }
    return MT_OK;
}

/* True where the system has properties that the recursions do not cover; checked before the
 * order. */
static bool has_form(const tree_maker *m)
{
    const mt_system *const sys = m->t->sys;
    if (sys->driven) {
        (void)mt_snprintf(m->why, MT_TREE_WHY, "a joint is driven");
        return false;
    }
    for (int i = 0; i < sys->n_constraints; i++) {
        if (sys->constraints[i].terms > 1) {
            (void)mt_snprintf(m->why, MT_TREE_WHY, "joint \"%s\" couples two others",
                              sys->joints[sys->constraints[i].joint].name);
            return false;
        }
    }
    for (int i = 0; i < sys->n_springs; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        const double k = s->damper ? 0.0 : m->data.value[s->stiffness];
        if (k < 0.0 || (s->measure[0] != s->measure[1] && k != 0.0)) {
            (void)mt_snprintf(m->why, MT_TREE_WHY, "spring \"%s\" %s", s->name,
                              k < 0.0 ? "has a negative stiffness" : "couples directions");
            return false;
        }
    }
    return true;
}

/* True where the joints are closed in the position. */
static bool is_closed(tree_maker *m)
{
    const mt_system *const sys = m->t->sys;
    if (sys->drawn_closed && m->t->settled_at == NULL) {
        return true;
    }
    for (int i = 0; i < sys->n_constraints; i++) {
        const mt_constraint_def *const c = &sys->constraints[i];
        const mt_measure_def *const def = &sys->measures[c->measure[0]];
        const mt_measure_data measure = mt_data_measure(&m->data, def);
        const double gap = creal(mt_measure_value(&measure, mt_pose_of(m->pose, def->body[0]),
                                                  mt_pose_of(m->pose, def->body[1]), NULL)) -
                           creal(m->data.target[i]);
        if (!(fabs(gap) <= DRAWN_CLOSED * sys->length_m)) {
            (void)mt_snprintf(m->why, MT_TREE_WHY, "joint \"%s\" is not closed %s",
                              sys->joints[c->joint].name,
                              m->t->settled_at == NULL ? "in the reference position"
                                                       : "to rounding where it has settled");
            m->moves = true;
            return false;
        }
    }
    return true;
}

static mt_status make_edges(tree_maker *m, mt_arena *mem, bool *is_tree, mt_err *err)
{
    mt_tree *const t = m->t;
    const size_t n = (size_t)t->n;
    const size_t s = (size_t)t->s;
    int *const depth = mt_arena_int(mem, n);
    t->point = mt_arena_alloc(mem, n, sizeof *t->point);
    t->y_at = mt_arena_int(mem, n + 1);
    t->free_dof_at = mt_arena_int(mem, n + 1);
    t->arm = mt_arena_f64(mem, 3, n);
    t->mass = mt_arena_f64(mem, n * s, s);
    t->basis = mt_arena_f64(mem, s, (size_t)t->sys->nq);
    t->length = mt_arena_f64(mem, n, 1);
    t->condition = mt_arena_f64(mem, n, 1);
    t->lost = mt_arena_f64(mem, (size_t)t->sys->nq, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < t->n && *is_tree; i++) {
        const mt_state_body *const body = &t->sys->bodies[t->body[i]];
        const mt_pose *const before =
            mt_pose_of(m->pose, t->before[i] < 0 ? MT_GROUND : t->body[t->before[i]]);
        int n_y = 0;
        int n_free_dofs = 0;
        t->point[i] = body->dof[MT_TREE_MOTION - 1] < 0;
        for (int k = 0; k < 3; k++) {
            t->arm[k + ((ptrdiff_t)3 * i)] =
                creal(m->pose[t->body[i]].x[k]) - creal(before->x[k]);
        }
        double basis[MT_TREE_MOTION * MT_TREE_MOTION];
        *is_tree = tree_edge(m, i, basis, &n_y, &n_free_dofs);
        memcpy(t->basis + (s * (size_t)(t->y_at[i] + t->free_dof_at[i])), basis,
               s * (size_t)(n_y + n_free_dofs) * sizeof *basis);
        t->y_at[i + 1] = t->y_at[i] + n_y;
        t->free_dof_at[i + 1] = t->free_dof_at[i] + n_free_dofs;
        depth[i] = 1 + (t->before[i] < 0 ? 0 : depth[t->before[i]]);
        t->depth = depth[i] > t->depth ? depth[i] : t->depth;
    }
    return MT_OK;
}

/* Coordinates: the springs' own where nothing loads. */
static mt_status choose_coordinates(tree_maker *m, mt_arena *mem, bool *is_tree, mt_err *err)
{
    mt_tree *const t = m->t;
    const size_t n = (size_t)t->n;
    const size_t s = (size_t)t->s;
    const int n_y = t->y_at[t->n];
    const int free_dofs = t->free_dof_at[t->n];
    t->n_x = t->geometric_stiffness == NULL ? n_y : n_y + free_dofs;
    t->n_rigid = n_y + free_dofs - t->n_x;
    if (t->n_rigid > MT_TREE_FREE_DOFS) {
        *is_tree = false;
        (void)mt_snprintf(m->why, MT_TREE_WHY,
                          "%d of its motions meet no stiffness, more than %d", t->n_rigid,
                          (int)MT_TREE_FREE_DOFS);
    }
    if (t->geometric_stiffness == NULL) {
        return MT_OK;
    }
    t->transport = mt_arena_f64(mem, n * s, s);
    t->settled = mt_arena_f64(mem, n * s, s);
    t->scaled = mt_arena_f64(mem, s, (size_t)t->n_x);
    MT_TRY(mt_arena_check(mem, err));
    mt_arena work = {.first = NULL};
    MT_TRY(mt_arena_init(&work, 0, err));
    const mt_status rc = mt_tree_factor(t, &work, is_tree, err);
    mt_arena_free(&work);
    if (rc == MT_OK && !*is_tree) {
        (void)mt_snprintf(m->why, MT_TREE_WHY,
                          "it is free to move, or not stable, under its load");
    }
    return rc;
}

static mt_status make_tree(tree_maker *m, const double *inputs, mt_arena *mem,
                           mt_arena *scratch, bool *is_tree, mt_err *err)
{
    const mt_system *const sys = m->t->sys;
    MT_TRY(mt_absolute_stand(sys, m->t->settled_at, inputs, &m->data, &m->at, scratch, err));
    m->pose = m->at.pose;
    MT_TRY(mt_interrupt_check(sys->run->interrupt, err));
    *is_tree = has_form(m) && is_closed(m);
    if (*is_tree) {
        MT_TRY(order_bodies(m, mem, scratch, is_tree, err));
    }
    MT_TRY(mt_interrupt_check(sys->run->interrupt, err));
    if (*is_tree) {
        MT_TRY(make_edges(m, mem, is_tree, err));
    }
    MT_TRY(mt_interrupt_check(sys->run->interrupt, err));
    if (*is_tree && sys->loaded) {
        MT_TRY(tree_loads(m, mem, scratch, is_tree, err));
    }
    if (*is_tree) {
        MT_TRY(tree_masses(m, mem, is_tree, err));
    }
    if (*is_tree) {
        MT_TRY(choose_coordinates(m, mem, is_tree, err));
    }
    return MT_OK;
}

mt_status mt_tree_new(const mt_system *sys, const double *inputs, const mt_state *settled,
                      mt_arena *mem, mt_tree **out, bool *moves, char why[MT_TREE_WHY],
                      mt_err *err)
{
    mt_arena scratch = {.first = NULL};
    mt_tree *const t = mt_arena_alloc(mem, 1, sizeof *t);
    tree_maker m = {.t = t, .why = why};
    bool is_tree = false;
    *out = NULL;
    *moves = false;
    why[0] = '\0';
    MT_TRY(mt_arena_check(mem, err));
    *t = (mt_tree){
        .sys = sys, .settled_at = settled, .s = sys->dimension == 2 ? 3 : MT_TREE_MOTION};
    mt_status rc = mt_arena_init(&scratch, 0, err);
    rc = rc == MT_OK ? make_tree(&m, inputs, mem, &scratch, &is_tree, err) : rc;
    mt_arena_free(&scratch);
    *moves = m.moves;
    *out = rc == MT_OK && is_tree ? t : NULL;
    return rc;
}
