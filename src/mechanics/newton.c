/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Newton with multipliers. At a position q with constraints c, Jacobian A, freedoms Z (A Z =
 * 0):
 *     lambda  = least-squares solution of A^T lambda = -g
 *     v       = -A^+ c                                    back to the constraints
 *     H       = Hessian of V + lambda c
 *     Z^T H Z eta = -Z^T (g + H v)                        towards equilibrium
 *     q      <- q (+) (v + Z eta).
 * No basis Z is needed for that where the equations are regular: with r = g + A^T lambda
 *     [ I A^T; A 0 ] [r; -lambda] = [g; 0],      [ H A^T; A 0 ] [v + Z eta; .] = [-r; -c]
 * (I in scaled coordinates), which stay sparse (saddle.h). After a short step lambda is what
 * the second made of it: the first is solved where there is no such step.
 * Freedoms without stiffness (singular values of Z^T H Z below NO_STIFFNESS of H itself in
 * scaled coordinates) take no step; the residual test then decides whether something still
 * pushes along them. With `trim` the forces tau of some springs are unknown and the rows (a_d,
 * c_d) of as many drives are their equations, all at once:
 *     [Z^T H Z   Z^T t] [eta]   [-Z^T (g + H v)  ]
 *     [a_d Z       0  ] [tau] = [-(c_d + a_d v)  ],  a column, a row for each.
 */
#include "mechanics/newton.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/run.h"
#include "mechanics/eliminate.h"
#include "mechanics/singular.h"

/* ...and the unbalanced force below this fraction of the forces (rounding of their sum is ~ n
 * eps). */
static const double FORCE_DONE = 1e-11;
/* A drawing has some six digits: nearer than this is at the drawn position [model lengths,
 * rad]. */
static const double DRAWN = 1e-6;
/* Rounding of the largest single spring force, summed over many springs and projected, stays
 * below this many times itself. */
static const double NOISE_ROOM = 32.0;

/* Singular values of the reduced Hessian below this fraction of the largest stiffness, be it
 * one that the joints hold, belong to freedoms without stiffness: rounding leaves about n eps ~
 * 1e-14 of them, and a real stiffness may be 1e12 times softer than its neighbour. */
static const double NO_STIFFNESS = 1e-13;
/* Of the inverse of the sparse equations, in scaled units. The first is that of a singular
 * value of A of 1e-4, far above what singular.c looks at; the other a thousandth of
 * 1/NO_STIFFNESS, for what the estimate of the norm and sums over many freedoms may be off. */
static const double FAR_FROM_DEPENDENT = 1e8;
static const double FIRM = 1e10;
/* Gaps up to here are rounding of the drawing [model lengths], and so is what is unbalanced up
 * to this many eps of the forces on a body: their products with arms, and their sum. */
static const double CLOSED = 64.0 * DBL_EPSILON;
static const double FORCE_ULPS = 4.0;
/* A step downhill that is longer than it may be by no more than this is shortened as a whole.
 * */
static const double LITTLE_LONGER = 2.0;
/* A multiplication of the sparse factors, in a loop over a short row, against one in a matrix
 * product. */
static const double SPARSE_SLOWER = 4.0;

/* True where the sparse factors (saddle.h) are cheaper than the dense method (eliminate.h). */
static bool saddle_pays(const mt_system *sys)
{
    const double nq = sys->nq;
    const double m = fmin(sys->n_constraints, sys->nq);
    const double n = nq - m;
    /* pivoted QR, basis, reduced Hessian, its singular values */
    const double dense =
        (2.0 * m * m * nq) + (4.0 * nq * n * m) + (2.0 * nq * nq * n) + (30.0 * n * n * n);
    return SPARSE_SLOWER * 2.0 * sys->layout->work <= dense;
}

/* *below: the norm of the inverse, in scaled units, is safely below `most`. */
static mt_status saddle_below(const mt_saddle *s, double most, mt_arena *scratch, bool *below,
                              mt_err *err)
{
    double norm = 0.0;
    MT_TRY(mt_ldl_inverse_norm(&s->f, scratch, &norm, err));
    *below = norm <= most;
    return MT_OK;
}

/* Switch to rows and a sparse Hessian; a shortage is the arena's. */
static void want_rows(mt_lagrangian *l, const mt_system *sys, mt_arena *mem)
{
    l->layout = sys->layout;
    l->row = mt_arena_alloc(mem, (size_t)sys->n_constraints, sizeof *l->row);
    l->h = mt_arena_f64(mem, sys->layout->envelope.count, 1);
}

mt_status mt_newton_work_init(mt_newton_work *w, const mt_newton_problem *p, mt_arena *mem,
                              mt_err *err)
{
    const mt_system *const sys = p->data->sys;
    const size_t nq = (size_t)sys->nq;
    const size_t m = (size_t)sys->n_constraints;
    *w = (mt_newton_work){.p = p, .sys = sys};
    w->g = mt_arena_f64(mem, nq, 1);
    w->c = mt_arena_f64(mem, m, 1);
    w->trim = mt_arena_f64(mem, nq, (size_t)sys->n_trims);
    if (saddle_pays(sys)) {
        w->sparse = (mt_lagrangian){.g = w->g, .c = w->c, .trim = w->trim};
        want_rows(&w->sparse, sys, mem);
        w->least = mt_arena_f64(mem, sys->layout->envelope.count, 1);
        w->turn = mt_arena_f64(mem, m, 1);
    } else {
        MT_TRY(mt_newton_dense(w, mem, err));
    }
    w->lambda_cx = mt_arena_alloc(mem, m, sizeof *w->lambda_cx);
    w->lambda = mt_arena_f64(mem, m, 1);
    w->v = mt_arena_f64(mem, nq, 1);
    w->step = mt_arena_f64(mem, nq, 1);
    w->reduced = mt_arena_f64(mem, nq + (size_t)sys->n_trims, 1);
    return mt_arena_check(mem, err);
}

mt_status mt_newton_dense(mt_newton_work *w, mt_arena *mem, mt_err *err)
{
    if (w->h != NULL) {
        return MT_OK;
    }
    if (w->p->sparse) {
        return mt_fail(err, MT_E_EQUILIBRIUM, "equations that are not regular beyond doubt");
    }
    const size_t nq = (size_t)w->sys->nq;
    w->a = mt_arena_f64(mem, (size_t)w->sys->n_constraints, nq);
    w->h = mt_arena_f64(mem, nq, nq);
    w->l = (mt_lagrangian){.g = w->g, .c = w->c, .trim = w->trim, .a = w->a, .h = w->h};
    w->l.push = mt_arena_f64(mem, (size_t)w->sys->n_bodies, 1);
    return mt_arena_check(mem, err);
}

/* Largest violation of the constraints at a position, in model lengths. */
static double newton_gap_at(mt_newton_work *w, const mt_placement *at)
{
    mt_constraint_values(w->p->data, at, w->p->m, w->c);
    return mt_newton_gap_of(w);
}

/* Set the scales of residuals: the anchor's own unit is a displacement of one model length. */
static void set_residual_scales(mt_newton_work *w, const mt_lagrangian *l, double unbalanced)
{
    const bool anchor = w->p->energy == MT_ENERGY_ANCHOR;
    const double force = anchor ? w->sys->length_m : l->force_scale;
    const double scale = force > 0.0 ? force : 1.0;
    w->gap = mt_newton_gap_of(w);
    w->residual = unbalanced / scale;
    w->noise = l->force_noise / scale;
}

static void load_multipliers(mt_newton_work *w)
{
    for (int i = 0; i < w->p->m; i++) {
        w->lambda_cx[i] = w->lambda[i];
    }
}

void mt_newton_evaluate(mt_newton_work *w, const mt_placement *at, bool hessian)
{
    const int m = w->p->m;
    w->l.trim_force = w->tau;
    load_multipliers(w);
    mt_lagrangian_eval(w->p->data, w->p->energy, w->p->drawn, at, m, w->lambda_cx,
                       hessian ? MT_CURVATURE_FULL : MT_CURVATURE_NONE, &w->l);
}

int mt_newton_trims(const mt_newton_problem *p)
{
    return p->trim ? p->data->sys->n_trims : 0;
}

/* How many rows carry a multiplier: with trim all but those of trimmed drives. */
static int rows(const mt_newton_work *w)
{
    return w->p->m - mt_newton_trims(w->p);
}

/* Elimination of those rows. */
static mt_status eliminate_rows(const mt_newton_work *w, mt_arena *mem, mt_elimination *e,
                                mt_err *err)
{
    const int m = rows(w);
    if (m == w->p->m) {
        return mt_eliminate(w->sys, m, w->a, mem, e, err);
    }
    double *const a = mt_arena_f64(mem, (size_t)m, (size_t)w->sys->nq);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t j = 0; j < w->sys->nq; j++) {
        memcpy(a + (j * m), w->a + (j * w->p->m), (size_t)m * sizeof *a);
    }
    return mt_eliminate(w->sys, m, a, mem, e, err);
}

double mt_newton_scaled_norm(const mt_newton_work *w, const double *dq)
{
    double s = 0.0;
    for (int b = 0; b < w->sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            const int dof = w->sys->bodies[b].dof[k];
            if (dof >= 0) {
                const double x = fabs(dq[dof]) * (k < 3 ? 1.0 / w->sys->length_m : 1.0);
                s = !(x <= s) ? x : s; /* NaN is kept */
            }
        }
    }
    return s;
}

double mt_newton_gap_of(const mt_newton_work *w)
{
    double gap = 0.0;
    for (int i = 0; i < w->p->m; i++) {
        const mt_measure_kind kind = w->sys->measures[w->sys->constraints[i].measure[0]].kind;
        const bool length = kind == MT_MEASURE_PLANE || kind == MT_MEASURE_DISTANCE;
        const double c = fabs(w->c[i]) / (length ? w->sys->length_m : 1.0);
        gap = !(c <= gap) ? c : gap;
    }
    return gap;
}

/* Z^T H Z, n x n with leading dimension ld. */
static mt_status newton_reduce_hessian(const mt_newton_work *w, const mt_elimination *e,
                                       double *k, int ld, mt_arena *mem, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    double *const hz = mt_arena_f64(mem, (size_t)e->nq, (size_t)e->n);
    MT_TRY(mt_arena_check(mem, err));
    mt_gemm(false, false, e->nq, e->n, e->nq, 1.0, w->h, e->nq, e->z, e->nq, 0.0, hz, e->nq);
    mt_gemm(true, false, e->n, e->n, e->nq, 1.0, e->z, e->nq, hz, e->nq, 0.0, k, ld);
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

/* Length of a row in the elimination's coordinates, in which angles and displacements have
 * equal weight; 1 for an empty row. */
static double row_length(const mt_elimination *e, const double *row, ptrdiff_t step)
{
    double length = 0.0;
    for (ptrdiff_t j = 0; j < e->nq; j++) {
        length = hypot(length, row[j * step] * e->dc[j]);
    }
    return length > 0.0 ? length : 1.0;
}

/* Units that keep the border of the size of the rest: of a trimmed drive's row, and of the
 * column of its spring's force. */
typedef struct border_scale {
    double row[MT_DRIVES_MOST];
    double column[MT_DRIVES_MOST];
} border_scale;

/* Rows of trimmed drives and columns of their springs' forces. */
static void border(const mt_newton_work *w, const mt_elimination *e, const border_scale *scale,
                   double *k)
{
    const int n = e->n;
    const int m = rows(w);
    const int trims = mt_newton_trims(w->p);
    const ptrdiff_t order = n + trims;
    for (int d = 0; d < trims; d++) {
        const double *const along = w->trim + ((ptrdiff_t)d * e->nq);
        const ptrdiff_t at = n + d;
        for (int c = 0; c < n; c++) {
            const double *const zc = e->z + ((ptrdiff_t)c * e->nq);
            double row = 0.0;
            for (int j = 0; j < e->nq; j++) {
                row += w->a[(m + d) + ((ptrdiff_t)j * w->p->m)] * zc[j];
            }
            k[at + (c * order)] = scale->row[d] * row;
            k[c + (at * order)] = scale->column[d] * mt_dot(e->nq, zc, along);
        }
        for (ptrdiff_t c = n; c < order; c++) {
            k[at + (c * order)] = 0.0;
        }
    }
}

/* Largest entry of the Hessian in the elimination's coordinates, in which Z has orthonormal
 * columns. */
static double stiffness_scale(const mt_newton_work *w, const mt_elimination *e)
{
    double most = 0.0;
    for (ptrdiff_t j = 0; j < e->nq; j++) {
        for (ptrdiff_t i = 0; i < e->nq; i++) {
            most = fmax(most, fabs(e->dc[i] * w->h[i + (j * e->nq)] * e->dc[j]));
        }
    }
    return most;
}

/* inverse := k^-1 where no singular value can be below `tolerance` of the largest: the
 * Frobenius norms of both bound their ratio, and rounding leaves less than half of the
 * inverse's. */
static mt_status invert_regular(int n, const double *k, double tolerance, double *inverse,
                                bool *regular, mt_arena *mem, mt_err *err)
{
    static const double ROUNDED = 2.0;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const ptrdiff_t entries = (ptrdiff_t)n * n;
    double *const copy = mt_arena_f64(mem, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(mem, err));
    *regular = false;
    if (!mt_all_finite(entries, k)) {
        mt_arena_rewind(mem, mark);
        return MT_OK;
    }
    memcpy(copy, k, (size_t)entries * sizeof *copy);
    memset(inverse, 0, (size_t)entries * sizeof *inverse);
    for (ptrdiff_t i = 0; i < n; i++) {
        inverse[i + (i * n)] = 1.0;
    }
    const mt_status rc = mt_lu_solve(n, copy, n, inverse, NULL, mem, NULL);
    if (rc == MT_OK) {
        const double norms = mt_norm2((int)entries, k) * mt_norm2((int)entries, inverse);
        *regular = norms * tolerance * ROUNDED < 1.0;
    }
    mt_arena_rewind(mem, mark);
    return rc == MT_E_MEMORY ? mt_fail_memory(err) : MT_OK;
}

mt_status mt_newton_invert(mt_newton_work *w, const mt_elimination *e, mt_arena *mem,
                           double **inverse, mt_err *err)
{
    const int trims = mt_newton_trims(w->p);
    const int order = e->n + trims;
    int rank = 0;
    border_scale scale;
    double *const k = mt_arena_f64(mem, (size_t)order, (size_t)order);
    *inverse = mt_arena_f64(mem, (size_t)order, (size_t)order);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(newton_reduce_hessian(w, e, k, order, mem, err));
    const double noise = NO_STIFFNESS * stiffness_scale(w, e);
    if (trims > 0) {
        const double most = mt_max_abs((ptrdiff_t)order * order, k);
        const double stiffness = most > 0.0 ? most : 1.0;
        for (ptrdiff_t d = 0; d < trims; d++) {
            scale.row[d] = stiffness / row_length(e, w->a + rows(w) + d, w->p->m);
            scale.column[d] = stiffness / row_length(e, w->trim + (d * e->nq), 1);
        }
        border(w, e, &scale, k);
    }
    const double most = mt_max_abs((ptrdiff_t)order * order, k);
    const double tolerance = fmax(NO_STIFFNESS, most > 0.0 ? noise / most : 0.0);
    bool regular = false;
    MT_TRY(invert_regular(order, k, tolerance, *inverse, &regular, mem, err));
    if (regular) {
        rank = order;
    } else {
        MT_TRY(mt_pinv(order, order, k, tolerance, *inverse, &rank, mem, err));
    }
    w->null_freedoms = order - rank;
    for (ptrdiff_t d = 0; d < trims; d++) { /* undone: the inverse's rows belong to the columns
                                               of what was inverted */
        for (ptrdiff_t c = 0; c < order; c++) {
            (*inverse)[e->n + d + (c * order)] *= scale.column[d];
            (*inverse)[c + ((e->n + d) * order)] *= scale.row[d];
        }
    }
    return MT_OK;
}

/* *falls: Z^T H Z of the w->h last evaluated has eigenvalues below 0 by more than rounding, and
 * the part of the motion `way`[nq] along their vectors exceeds the precision of a drawing.
 * w->step is then set to that part, reversed. */
/* Z has orthonormal columns in the elimination's coordinates. */
static mt_status newton_falls(mt_newton_work *w, const mt_elimination *e, const double *way,
                              bool *falls, mt_arena *mem, mt_err *err)
{
    const int n = e->n;
    double *const k = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const values = mt_arena_f64(mem, (size_t)n, 1);
    double *const scaled = mt_arena_f64(mem, (size_t)e->nq, 1);
    double *const y = mt_arena_f64(mem, (size_t)n, 1);
    double *const down = mt_arena_f64(mem, (size_t)n, 1);
    *falls = false;
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(newton_reduce_hessian(w, e, k, n, mem, err));
    MT_TRY(mt_eig_sym(n, k, values, true, mem, err));
    for (int j = 0; j < e->nq; j++) {
        scaled[j] = way[j] / e->dc[j] / e->dc[j]; /* the square may leave the range */
    }
    mt_eliminate_project(e, scaled, y);
    const double noise = NO_STIFFNESS * stiffness_scale(w, e);
    for (int i = 0; i < n && values[i] < -noise; i++) {
        const double *const v = k + ((ptrdiff_t)i * n);
        mt_axpy(n, -mt_dot(n, v, y), v, down);
    }
    *falls = mt_norm2(n, down) > DRAWN * w->sys->length_m;
    if (*falls) {
        mt_eliminate_expand(e, down, w->step);
    }
    return MT_OK;
}

/* True where the last dense evaluation, with its elimination, is in equilibrium: closed, and
 * unbalanced forces below rounding of the forces on each body, whatever its stiffness. */
static bool newton_at_rest(mt_newton_work *w, const mt_elimination *e)
{
    const mt_system *const sys = w->sys;
    bool rest = w->gap <= CLOSED;
    mt_eliminate_project(e, w->g, w->reduced);
    for (int i = 0; i < e->n && rest; i++) {
        const double *const z = e->z + ((ptrdiff_t)i * e->nq);
        double terms = 0.0;
        for (int b = 0; b < sys->n_bodies; b++) {
            for (int k = 0; k < 6; k++) {
                const int dof = sys->bodies[b].dof[k];
                const double arm = k < 3 ? 1.0 : sys->length_m;
                terms += dof >= 0 ? arm * w->l.push[b] * fabs(z[dof]) : 0.0;
            }
        }
        rest = fabs(w->reduced[i]) <= FORCE_ULPS * DBL_EPSILON * terms;
    }
    return rest;
}

/* out[nq] = g + A^T lambda. Unlike Z^T g, forces cancel where they act, not in a sum over all
 * freedoms, whose rounding would move soft freedoms. */
static void find_unbalanced(const mt_newton_work *w, double *out)
{
    for (int j = 0; j < w->sys->nq; j++) {
        const double *const column = w->a + ((ptrdiff_t)j * w->p->m);
        out[j] = w->g[j] + mt_dot(w->p->m, column, w->lambda);
    }
}

/* Multipliers, then gradient, Hessian and residual with them. */
static mt_status evaluate_with_multipliers(mt_newton_work *w, const mt_placement *at,
                                           mt_arena *mem, mt_elimination *e, mt_err *err)
{
    memset(w->lambda, 0, (size_t)w->p->m * sizeof *w->lambda);
    w->l.trim_force = w->tau;
    mt_lagrangian_eval(w->p->data, w->p->energy, w->p->drawn, at, w->p->m, NULL,
                       w->elastic ? MT_CURVATURE_ELASTIC : MT_CURVATURE_FULL, &w->l);
    MT_TRY(eliminate_rows(w, mem, e, err));
    for (int j = 0; j < w->sys->nq; j++) {
        w->v[j] = -w->g[j];
    }
    MT_TRY(mt_eliminate_multipliers(e, w->v, w->lambda, mem, err));
    if (!w->elastic) {
        load_multipliers(w);
        mt_lagrangian_curve(w->p->data, at, w->p->m, w->lambda_cx, &w->l);
    }
    find_unbalanced(w, w->v);
    mt_eliminate_project(e, w->v, w->reduced);
    set_residual_scales(w, &w->l, mt_max_abs(e->n, w->reduced));
    return MT_OK;
}

/* g + A^T lambda into w->reduced [nq]; returns its largest entry, moments over the model
 * length. */
static double unbalanced(mt_newton_work *w)
{
    double most = 0.0;
    memcpy(w->reduced, w->g, (size_t)w->sys->nq * sizeof *w->reduced);
    mt_lagrangian_pull(&w->sparse, w->p->m, w->lambda, w->reduced);
    for (int b = 0; b < w->sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            const int dof = w->sys->bodies[b].dof[k];
            if (dof >= 0) {
                const double scale = k < 3 ? 1.0 : 1.0 / w->sys->length_m;
                const double force = fabs(scale * w->reduced[dof]);
                most = !(force <= most) ? force : most; /* NaN is kept */
            }
        }
    }
    return most;
}

mt_status mt_newton_least_squares(mt_newton_work *w, bool apart, mt_arena *mem,
                                  mt_saddle *least, bool *sure, mt_err *err)
{
    w->factors++;
    MT_TRY(mt_saddle_factor(w->sys, rows(w), &w->sparse, MT_SADDLE_LEAST_SQUARES, w->least, mem,
                            least, err));
    *sure = least->whole;
    return *sure && apart ? saddle_below(least, FAR_FROM_DEPENDENT, mem, sure, err) : MT_OK;
}

/* w->step, w->turn and how much *more the trimmed springs push, of w->reduced and w->turn;
 * *sure: the border of such springs leaves the equations regular. */
static mt_status solve_sparse(mt_newton_work *w, mt_newton_solver *solver, mt_trim_forces *more,
                              bool *sure, mt_arena *mem, mt_err *err)
{
    const mt_saddle *const s = &solver->saddle;
    if (mt_newton_trims(w->p) == 0) {
        return mt_saddle_solve(s, w->reduced, w->turn, w->step, w->turn, mem, err);
    }
    MT_TRY(mt_border_init(s, w->trim, FIRM, mem, &solver->border, sure, err));
    return *sure ? mt_border_solve(&solver->border, w->reduced, w->turn, w->step, w->turn,
                                   more->of, mem, err)
                 : MT_OK;
}

/* Jets that are kept where an equilibrium is looked for, or found; NULL: none. */
static mt_jets *kept_jets(const mt_newton_work *w, bool first)
{
    mt_newton_start *const start = w->p->data->start;
    const bool keeps = start != NULL && w->p->energy == MT_ENERGY_PHYSICAL && !w->p->sparse;
    return !keeps ? NULL : first ? &start->jets : &start->end;
}

static bool same_row(const mt_sparse_row *a, const mt_sparse_row *b)
{
    bool same = a->n == b->n;
    for (int k = 0; k < a->n && same; k++) {
        same = a->dof[k] == b->dof[k] && a->a[k] == b->a[k];
    }
    return same;
}

/* mt_newton_least_squares where a stage begins, in the memory of start: the factor is that of
 * an earlier design where the rows are the same. */
static mt_status least_squares_at_start(mt_newton_work *w, bool apart, mt_newton_start *start,
                                        mt_err *err)
{
    const int m = rows(w);
    bool same = start->rows == m && start->apart == apart;
    for (int i = 0; i < m && same; i++) {
        same = same_row(&start->row[i], &w->sparse.row[i]);
    }
    if (same) {
        w->factors++;
        return MT_OK;
    }
    start->rows = -1;
    mt_arena_clear(&start->mem);
    start->row = mt_arena_alloc(&start->mem, (size_t)m, sizeof *start->row);
    MT_TRY(mt_arena_check(&start->mem, err));
    memcpy(start->row, w->sparse.row, (size_t)m * sizeof *start->row);
    MT_TRY(mt_newton_least_squares(w, apart, &start->mem, &start->least, &start->sure, err));
    start->rows = m;
    start->apart = apart;
    return MT_OK;
}

/* w->lambda by least squares, and what they leave unbalanced. */
static mt_status find_multipliers(mt_newton_work *w, bool first, mt_arena *mem, bool *sure,
                                  mt_err *err)
{
    const int m = w->p->m;
    mt_newton_start *const start = first && !w->p->sparse ? w->p->data->start : NULL;
    mt_saddle least;
    if (start != NULL) {
        MT_TRY(least_squares_at_start(w, true, start, err));
        least = start->least;
        *sure = start->sure;
    } else {
        MT_TRY(mt_newton_least_squares(w, first && !w->p->sparse, mem, &least, sure, err));
    }
    if (!*sure) {
        return MT_OK;
    }
    memset(w->lambda, 0, (size_t)m * sizeof *w->lambda);
    MT_TRY(mt_saddle_solve(&least, w->g, NULL, NULL, w->lambda, mem, err));
    for (int i = 0; i < m; i++) {
        w->lambda[i] = -w->lambda[i];
    }
    set_residual_scales(w, &w->sparse, unbalanced(w));
    return MT_OK;
}

/* The forces of the trimmed springs, where they are unknown, change by more[n_trims]. */
static void push_more(mt_newton_work *w, const double *more)
{
    mt_axpy(mt_newton_trims(w->p), 1.0, more, w->tau.of);
}

/* The same sparse. *sure: the equations are regular by a margin, and the step is not much
 * longer than allowed; otherwise the results are void. first: the margin also excludes
 * dependent equations next to this position, and Z^T H Z is positive definite. */
static mt_status newton_linearise_sparse(mt_newton_work *w, const mt_placement *at, bool first,
                                         mt_arena *mem, mt_newton_solver *solver, bool *sure,
                                         mt_err *err)
{
    const mt_newton_problem *const p = w->p;
    const int nq = w->sys->nq;
    *solver = (mt_newton_solver){.sparse = true};
    MT_TRY(mt_interrupt_check(w->sys->run->interrupt, err));
    w->sparse.jets = kept_jets(w, first);
    w->sparse.trim_force = w->tau;
    mt_lagrangian_eval(p->data, p->energy, p->drawn, at, p->m, NULL,
                       w->elastic ? MT_CURVATURE_ELASTIC : MT_CURVATURE_FULL, &w->sparse);
    const bool followed = w->followed;
    w->followed = false;
    *sure = true;
    if (followed) {
        mt_axpy(p->m, 1.0, w->turn, w->lambda);
    } else {
        MT_TRY(find_multipliers(w, first, mem, sure, err));
    }
    if (!*sure) {
        return MT_OK;
    }
    if (!w->elastic) {
        load_multipliers(w);
        mt_lagrangian_curve(p->data, at, p->m, w->lambda_cx, &w->sparse);
    }
    w->factors++;
    MT_TRY(mt_saddle_factor(w->sys, p->m, &w->sparse,
                            p->sparse ? MT_SADDLE_SOFT : MT_SADDLE_REGULAR, w->sparse.h, mem,
                            &solver->saddle, err));
    *sure = solver->saddle.whole && (!first || mt_saddle_convex(&solver->saddle));
    if (!*sure) {
        return MT_OK;
    }
    if (followed) {
        set_residual_scales(w, &w->sparse, unbalanced(w));
    }
    for (int j = 0; j < nq; j++) {
        w->reduced[j] = -w->reduced[j];
    }
    for (int i = 0; i < p->m; i++) {
        w->turn[i] = -w->c[i];
    }
    mt_trim_forces more = {{0.0}};
    MT_TRY(solve_sparse(w, solver, &more, sure, mem, err));
    if (!*sure) {
        return MT_OK;
    }
    w->moved = mt_newton_scaled_norm(w, w->step);
    w->null_freedoms = 0;
    const bool convex = mt_saddle_convex(&solver->saddle);
    /* (with nothing to compare, one that is too long is shortened as a whole) */
    *sure = w->moved <= (convex ? LITTLE_LONGER : 1.0) * MT_STEP_LIMIT ||
            (p->sparse && w->moved < HUGE_VAL);
    if (*sure) {
        push_more(w, more.of);
    }
    return MT_OK;
}

mt_status mt_newton_is_firm(const mt_saddle *saddle, mt_arena *scratch, bool *firm, mt_err *err)
{
    return saddle_below(saddle, FIRM, scratch, firm, err);
}

/*
 * Shorten a step that is too long in each eigenvector of Z^T H Z by itself: motions with almost
 * no stiffness (a rod's spin between ball joints, which has none at an equilibrium, but off it
 * some, as large as the unbalanced force) go as far as a step may, and the others their full
 * way. Shortened as a whole such a step would get nowhere.
 */
static mt_status shorten(mt_newton_work *w, const mt_elimination *e, double *eta, mt_arena *mem,
                         mt_err *err)
{
    const ptrdiff_t n = e->n;
    const double most = MT_STEP_LIMIT * w->sys->length_m; /* Z is orthonormal in lengths */
    double *const k = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const values = mt_arena_f64(mem, (size_t)n, 1);
    double *const kept = mt_arena_f64(mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(newton_reduce_hessian(w, e, k, e->n, mem, err));
    MT_TRY(mt_eig_sym(e->n, k, values, true, mem, err));
    for (ptrdiff_t i = 0; i < n; i++) {
        const double *const v = k + (i * n);
        const double part = mt_dot(e->n, v, eta);
        mt_axpy(e->n, fmax(fmin(part, most), -most), v, kept);
    }
    memcpy(eta, kept, (size_t)n * sizeof *eta);
    return MT_OK;
}

/* Multipliers, Hessian, elimination, inverse, and the step v + Z eta (unlimited) at a position;
 * tau is updated. */
static mt_status newton_linearise(mt_newton_work *w, const mt_placement *at, mt_arena *mem,
                                  mt_newton_solver *solver, mt_err *err)
{
    const int nq = w->sys->nq;
    mt_elimination *const e = &solver->e;
    *solver = (mt_newton_solver){.sparse = false};
    MT_TRY(mt_interrupt_check(w->sys->run->interrupt, err));
    w->factors += 2;
    MT_TRY(evaluate_with_multipliers(w, at, mem, e, err));
    MT_TRY(mt_newton_invert(w, e, mem, &solver->inverse, err));
    double *const minus_c = mt_arena_f64(mem, (size_t)w->p->m, 1);
    double *const hv = mt_arena_f64(mem, (size_t)nq, 1);
    const int trims = mt_newton_trims(w->p);
    const int order = e->n + trims;
    double *const eta = mt_arena_f64(mem, (size_t)order + 1, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < w->p->m; i++) {
        minus_c[i] = -w->c[i];
    }
    MT_TRY(mt_eliminate_particular(e, minus_c, w->v, mem, err));
    find_unbalanced(w, hv);
    mt_gemv(false, nq, nq, 1.0, w->h, nq, w->v, 1.0, hv);
    mt_eliminate_project(e, hv, w->reduced);
    for (int i = 0; i < e->n; i++) {
        w->reduced[i] = -w->reduced[i];
    }
    for (ptrdiff_t d = 0; d < trims; d++) {
        const ptrdiff_t own = rows(w) + d;
        double row = w->c[own];
        for (int j = 0; j < nq; j++) {
            row += w->a[own + ((ptrdiff_t)j * w->p->m)] * w->v[j];
        }
        w->reduced[e->n + d] = -row;
    }
    mt_gemv(false, order, order, 1.0, solver->inverse, order, w->reduced, 0.0, eta);
    mt_eliminate_expand(e, eta, w->step);
    mt_axpy(nq, 1.0, w->v, w->step);
    w->moved = mt_newton_scaled_norm(w, w->step);
    if (trims == 0 && w->moved > MT_STEP_LIMIT && w->moved < HUGE_VAL) {
        MT_TRY(shorten(w, e, eta, mem, err));
        mt_eliminate_expand(e, eta, w->step);
        mt_axpy(nq, 1.0, w->v, w->step);
        w->moved = mt_newton_scaled_norm(w, w->step);
    }
    push_more(w, eta + e->n);
    return MT_OK;
}

/* Physical energy: update the whole turns of angles after a step (springs wind up); other
 * energies keep those of the drive. */
static void newton_follow(const mt_newton_work *w, mt_placement *at)
{
    if (w->p->energy == MT_ENERGY_PHYSICAL) {
        mt_data_turns(w->p->data, at);
    }
}

void mt_newton_take_step(mt_newton_work *w, mt_placement *at, double limit)
{
    const double factor = w->moved > limit ? limit / w->moved : 1.0;
    for (int j = 0; j < w->sys->nq; j++) {
        w->step[j] *= factor;
    }
    mt_poses_move(w->sys, at->pose, w->step);
}

/*
 * Descent on the energy along the constraints: the reduced Hessian with the signs of its
 * eigenvalues made positive gives a direction that leads downhill, the step is halved until the
 * energy, evaluated back on the constraints, is lower. It ends near a stable equilibrium, or in
 * a saddle where symmetry leads into it; Newton finishes.
 */

enum { DESCENT_LIMIT = 400, HALVINGS = 30, RESTORE_LIMIT = 20 };
/* First step out of a saddle [model lengths, rad]. */
static const double OUT = 0.1;

/* Back to the constraints by least-norm steps. */
static mt_status restore_constraints(mt_newton_work *w, mt_placement *at, mt_arena *mem,
                                     mt_err *err)
{
    for (int it = 0; it < RESTORE_LIMIT; it++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        mt_elimination e;
        mt_newton_evaluate(w, at, false);
        if (mt_newton_gap_of(w) <= MT_STEP_DONE) {
            return MT_OK;
        }
        double *const minus_c = mt_arena_f64(mem, (size_t)w->p->m, 1);
        MT_TRY(mt_arena_check(mem, err));
        for (int i = 0; i < w->p->m; i++) {
            minus_c[i] = -w->c[i];
        }
        MT_TRY(mt_eliminate(w->sys, w->p->m, w->a, mem, &e, err));
        MT_TRY(mt_eliminate_particular(&e, minus_c, w->step, mem, err));
        w->moved = mt_newton_scaled_norm(w, w->step);
        mt_newton_take_step(w, at, MT_STEP_LIMIT);
        mt_arena_rewind(mem, mark);
    }
    return mt_fail(err, MT_E_ASSEMBLY, "the joints do not stay closed");
}

/* One direction: eigenvalues of the reduced Hessian made positive, freedoms without stiffness
 * given the softest stiffness that keeps the step short. */
static mt_status direction_of(mt_newton_work *w, const mt_elimination *e, mt_arena *mem,
                              mt_err *err)
{
    const int n = e->n;
    double *const k = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const values = mt_arena_f64(mem, (size_t)n, 1);
    double *const eta = mt_arena_f64(mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(newton_reduce_hessian(w, e, k, n, mem, err));
    mt_eliminate_project(e, w->g, w->reduced);
    const double soft = mt_norm2(n, w->reduced) / (MT_STEP_LIMIT * w->sys->length_m);
    MT_TRY(mt_eig_sym(n, k, values, true, mem, err));
    for (int i = 0; i < n; i++) {
        const double *const vec = k + ((ptrdiff_t)i * n);
        mt_axpy(n, -mt_dot(n, vec, w->reduced) / fmax(fabs(values[i]), soft), vec, eta);
    }
    mt_eliminate_expand(e, eta, w->step);
    w->moved = mt_newton_scaled_norm(w, w->step);
    return MT_OK;
}

/* Halve the step until the energy is lower; *lower: it is, otherwise the poses are restored. */
static mt_status search_line(mt_newton_work *w, mt_placement *at, double *energy, bool *lower,
                             mt_arena *mem, mt_err *err)
{
    const size_t nq = (size_t)w->sys->nq;
    const size_t n = (size_t)w->sys->n_bodies;
    const double full = w->moved;
    double length = fmin(full, MT_STEP_LIMIT);
    double *const direction = mt_arena_f64(mem, nq, 1);
    mt_pose *const kept = mt_arena_alloc(mem, n, sizeof *kept);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(direction, w->step, nq * sizeof *direction);
    memcpy(kept, at->pose, n * sizeof *kept);
    *lower = false;
    for (int half = 0; half < HALVINGS && !*lower; half++) {
        memcpy(at->pose, kept, n * sizeof *kept);
        memcpy(w->step, direction, nq * sizeof *direction);
        w->moved = full;
        mt_newton_take_step(w, at, length);
        const mt_status rc = restore_constraints(w, at, mem, NULL);
        if (rc == MT_OK) {
            const double now = mt_energy_value(w->p->data, at, &w->tau, NULL);
            *lower = now < *energy;
            *energy = *lower ? now : *energy;
        } else if (rc != MT_E_ASSEMBLY && rc != MT_E_DOMAIN) {
            return mt_fail_memory(err);
        }
        length *= 0.5;
    }
    if (*lower) {
        newton_follow(w, at);
    } else {
        memcpy(at->pose, kept, n * sizeof *kept);
    }
    return MT_OK;
}

/* Move from a stationary point along w->step, or against it, to a lower energy; *lower: found
 * one. */
static mt_status newton_leave_saddle(mt_newton_work *w, mt_placement *at, bool *lower,
                                     mt_arena *mem, mt_err *err)
{
    const int nq = w->sys->nq;
    double *const out = mt_arena_f64(mem, (size_t)nq, 1);
    MT_TRY(mt_newton_dense(w, mem, err));
    double energy = mt_energy_value(w->p->data, at, &w->tau, NULL);
    *lower = false;
    MT_TRY(mt_arena_check(mem, err));
    const double size = mt_newton_scaled_norm(w, w->step);
    mt_axpy(nq, size > 0.0 ? OUT / size : 0.0, w->step, out);
    for (int side = 0; side < 2 && !*lower; side++) {
        memcpy(w->step, out, (size_t)nq * sizeof *out);
        w->moved = OUT;
        MT_TRY(search_line(w, at, &energy, lower, mem, err));
        for (int j = 0; j < nq; j++) {
            out[j] = -out[j];
        }
    }
    return MT_OK;
}

/* Energy descent along the constraints, as far as rounding of the energy allows. */
static mt_status newton_descend(mt_newton_work *w, mt_placement *at, mt_arena *mem, mt_err *err)
{
    MT_TRY(mt_newton_dense(w, mem, err));
    MT_TRY(restore_constraints(w, at, mem, err));
    double energy = mt_energy_value(w->p->data, at, &w->tau, NULL);
    bool lower = true;
    for (int it = 0; it < DESCENT_LIMIT && lower; it++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        const mt_trim_forces tau = w->tau;
        mt_newton_solver solver;
        MT_TRY(newton_linearise(w, at, mem, &solver, err));
        w->tau = tau; /* the forces of trimmed springs stand while the energy is compared */
        lower = w->residual > FORCE_DONE + (NOISE_ROOM * w->noise);
        if (lower) { /* not lower: as low as rounding lets us see, Newton decides */
            MT_TRY(direction_of(w, &solver.e, mem, err));
            MT_TRY(search_line(w, at, &energy, &lower, mem, err));
        }
        mt_arena_rewind(mem, mark);
    }
    return MT_OK;
}

/*
 * One stage of the position analysis from start to verdict. Plain Newton finds
 * any stationary point of the energy, a saddle as well as a minimum. Where a drive has brought
 * the mechanism beside a trimmed equilibrium the way back begins with the elastic stiffness
 * alone: what the way has strained pushes with forces that are gone at its end, and their
 * geometric stiffness leads astray. What is drawn in
 * equilibrium, to the rounding of its forces, stays there, stable or not, and though a step
 * against what hardly holds it would lead far. Else it settles: where Newton does not converge,
 * ends uphill, or in a saddle that the drawing lies beside (its distance has a part along
 * directions of negative curvature), the energy is followed downhill from the drawing and out
 * of such saddles, and Newton finishes. A saddle that the drawing lies straight above (a column
 * beyond its buckling load, compressed along its axis) is an equilibrium that does not say
 * which way it falls: it stands, and is told as unstable.
 */

enum { NEWTON_LIMIT = 60, WHERE_SIZE = 300 };
/* Saddles that the way downhill may lead into. */
enum { SADDLES = 12 };
/* Energies differ by rounding below this part of them. */
static const double ENERGY_ROUNDING = 1e-12;
/* Entries of a left null vector (largest 1) above this belong to the dependent set. */
static const double IN_THE_SET = 1e-6;

/* Store the last step, w->step and that of the trimmed springs' forces, tau before, and the
 * change of the multipliers: with r = g + A^T lambda + t trim + H step unbalanced, A^T lambda'
 * = -r. */
static mt_status keep_step(const mt_newton_work *w, const mt_newton_solver *solver,
                           const mt_trim_forces *tau, mt_arena *mem, mt_newton_residual *left,
                           mt_err *err)
{
    const int nq = w->sys->nq;
    const int m = w->p->m;
    const int trims = mt_newton_trims(w->p);
    for (int d = 0; d < trims; d++) {
        left->trim.of[d] = w->tau.of[d] - tau->of[d];
    }
    left->q = mt_arena_f64(mem, (size_t)nq, 1);
    left->lambda = mt_arena_f64(mem, (size_t)m, 1);
    double *const r = mt_arena_f64(mem, (size_t)nq, 1);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(left->q, w->step, (size_t)nq * sizeof *left->q);
    if (solver->sparse) {
        memcpy(left->lambda, w->turn, (size_t)m * sizeof *left->lambda);
        return MT_OK;
    }
    for (ptrdiff_t j = 0; j < nq; j++) {
        r[j] = -w->g[j];
        for (ptrdiff_t d = 0; d < trims; d++) {
            r[j] -= left->trim.of[d] * w->trim[j + (d * nq)];
        }
        r[j] -= mt_dot(m, w->a + (j * m), w->lambda);
    }
    mt_gemv(false, nq, nq, -1.0, w->h, nq, w->step, 1.0, r);
    return mt_eliminate_multipliers(&solver->e, r, left->lambda, mem, err);
}

/* tau: of the trimmed springs, before the last step. */
static mt_status keep_solution(mt_newton_work *w, const mt_newton_solver *solver,
                               const mt_trim_forces *tau, mt_arena *mem, mt_stage *stage,
                               mt_err *err)
{
    const size_t trims = (size_t)w->sys->n_trims;
    MT_TRY(keep_step(w, solver, tau, mem, &stage->left, err));
    w->tau = *tau;
    const size_t nq = (size_t)w->sys->nq;
    const size_t m = (size_t)w->p->m;
    stage->active = true;
    stage->m = w->p->m;
    stage->solver = *solver;
    stage->null_freedoms = w->null_freedoms;
    stage->lambda = mt_arena_f64(mem, m, 1);
    stage->h = solver->sparse ? NULL : mt_arena_f64(mem, nq, nq);
    stage->a = solver->sparse ? NULL : mt_arena_f64(mem, m, nq);
    stage->trim = mt_arena_f64(mem, nq, trims);
    stage->d_lambda = mt_arena_f64(mem, m, 1);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(stage->lambda, w->lambda, m * sizeof *stage->lambda);
    memcpy(stage->trim, w->trim, nq * trims * sizeof *stage->trim);
    stage->solver.border.along = solver->border.along == NULL ? NULL : stage->trim;
    if (!solver->sparse) {
        memcpy(stage->h, w->h, nq * nq * sizeof *stage->h);
        memcpy(stage->a, w->a, m * nq * sizeof *stage->a);
    }
    stage->residual = w->residual;
    stage->trim_force = w->tau;
    return MT_OK;
}

/* True where a plain Newton iteration ends: the step is rounding, no longer shrinking or
 * negligible, and the constraints are closed. */
static bool rests(const mt_newton_work *w, double previous)
{
    const bool small = w->moved <= MT_STEP_DONE &&
                       (w->moved >= 0.25 * previous || w->moved <= 8.0 * DBL_EPSILON);
    return small && w->gap <= MT_STEP_DONE;
}

static bool balanced(const mt_newton_work *w)
{
    return w->residual <= FORCE_DONE + (NOISE_ROOM * w->noise);
}

/*
 * The equations at a position, sparse where they are safely regular, otherwise dense. first: of
 * the stage; the dense method then checks for several continuations, and *falls: energy
 * decreases elsewhere.
 */
static mt_status linearise(mt_newton_work *w, const mt_placement *at, bool first, mt_arena *mem,
                           mt_newton_solver *solver, bool *falls, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const mt_trim_forces tau = w->tau;
    bool sure = false;
    if (w->least != NULL) {
        const bool physical = w->p->energy == MT_ENERGY_PHYSICAL;
        MT_TRY(newton_linearise_sparse(w, at, first && physical, mem, solver, &sure, err));
        if (sure && !w->p->sparse && w->gap <= MT_STEP_DONE &&
            balanced(w)) { /* the step is rounding, or none */
            MT_TRY(mt_newton_is_firm(&solver->saddle, mem, &sure, err));
        }
    }
    if (sure) {
        return MT_OK;
    }
    mt_arena_rewind(mem, mark);
    w->tau = tau;
    MT_TRY(mt_newton_dense(w, mem, err));
    MT_TRY(newton_linearise(w, at, mem, solver, err));
    if (!first || w->gap > MT_STEP_DONE) {
        return MT_OK;
    }
    if (w->p->energy == MT_ENERGY_PHYSICAL) {
        MT_TRY(mt_singular_refuse(w->p->data, at, &solver->e, mem, err));
    }
    if (w->watch && w->moved > DRAWN && !balanced(w)) {
        MT_TRY(newton_falls(w, &solver->e, w->step, falls, mem, err));
    }
    return MT_OK;
}

/* Steps that are longer than this are of the elastic stiffness alone [model lengths]. */
static const double NEAR = 1e-3;

/* True where the step that was found with the elastic stiffness alone is to be taken;
 * w->elastic: the next one is of that kind, too. Freedoms that only forces hold have no part in
 * it. */
static bool use_elastic(mt_newton_work *w, double previous)
{
    const bool shrinks = w->moved <= 0.5 * previous;
    w->elastic = shrinks && w->moved > NEAR;
    return shrinks;
}

/* The error of multipliers that a Newton step updates is of second order in the step, as is
 * that of a least-squares fit at its end. After longer steps they are fitted
 * [model lengths]. */
static const double FOLLOWS = 1e-2;

/* Set the step to zero where a stage begins in equilibrium, however weakly held. */
static void stay_at_rest(mt_newton_work *w, const mt_newton_solver *solver)
{
    if (w->watch && !solver->sparse && newton_at_rest(w, &solver->e)) {
        memset(w->step, 0, (size_t)w->sys->nq * sizeof *w->step);
        w->moved = 0.0;
    }
}

/* Take the computed step and update the multipliers. */
static void move_by_newton_step(mt_newton_work *w, mt_placement *at,
                                const mt_newton_solver *solver)
{
    w->followed = solver->sparse && w->moved <= FOLLOWS;
    mt_newton_take_step(w, at, MT_STEP_LIMIT);
    newton_follow(w, at);
}

/*
 * Beside the solution, steps with the factor of an earlier position: each leaves about as large
 * a part of the error as the matrices have changed by since, and takes neither Hessian nor
 * factor. They end where the next one would be rounding, or where they do not shrink as
 * they should, and the equations are linearised there: what is kept is never of an earlier
 * position.
 */

/* Steps up to here change the matrices so little that two or three more are rounding; after
 * one that is shorter than the other Newton's next is rounding [model lengths]. */
static const double BESIDE = 1e-4;
static const double NEXT_TO = 1e-8;
/* Each leaves at most this part of the last one. */
static const double SHRINKS = 1e-2;
/* A step that is shorter is rounding: half of what rests() calls so. */
static const double ROUNDING = 4.0 * DBL_EPSILON;
enum { CHORDS_MOST = 4 };

/* w->step, w->turn and *more, as newton_linearise_sparse, with an earlier factor and what the
 * forces are now. */
static mt_status step_with_earlier_factor(mt_newton_work *w, const mt_placement *at,
                                          mt_newton_solver *solver, mt_trim_forces *more,
                                          mt_arena *mem, mt_err *err)
{
    const mt_newton_problem *const p = w->p;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    MT_TRY(mt_interrupt_check(w->sys->run->interrupt, err));
    w->sparse.jets = NULL;
    w->sparse.trim_force = w->tau;
    mt_lagrangian_eval(p->data, p->energy, p->drawn, at, p->m, NULL, MT_CURVATURE_NONE,
                       &w->sparse);
    (void)unbalanced(w);
    for (int j = 0; j < w->sys->nq; j++) {
        w->reduced[j] = -w->reduced[j];
    }
    for (int i = 0; i < p->m; i++) {
        w->turn[i] = -w->c[i];
    }
    MT_TRY(mt_newton_trims(p) > 0 ? mt_border_solve(&solver->border, w->reduced, w->turn,
                                                    w->step, w->turn, more->of, mem, err)
                                  : mt_saddle_solve(&solver->saddle, w->reduced, w->turn,
                                                    w->step, w->turn, mem, err));
    w->moved = mt_newton_scaled_norm(w, w->step);
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

/* After a step that has been taken: more of them, with its factor. NULL: not with it, as it
 * knows nothing of the forces. */
static mt_status go_on_with_factor(mt_newton_work *w, mt_placement *at,
                                   mt_newton_solver *solver, mt_arena *mem, mt_stage *stage,
                                   mt_err *err)
{
    const bool beside = w->moved <= BESIDE && w->moved > NEXT_TO;
    double before = w->moved;
    for (int i = 0; i < CHORDS_MOST && solver != NULL && w->followed && beside; i++) {
        mt_trim_forces more = {{0.0}};
        mt_axpy(w->p->m, 1.0, w->turn, w->lambda); /* of the step before */
        MT_TRY(step_with_earlier_factor(w, at, solver, &more, mem, err));
        stage->iterations++;
        if (!(w->moved <= SHRINKS * before)) { /* not taken: linearised here */
            w->moved = before;
            memset(w->turn, 0, (size_t)w->p->m * sizeof *w->turn);
            return MT_OK;
        }
        push_more(w, more.of);
        mt_newton_take_step(w, at, MT_STEP_LIMIT);
        newton_follow(w, at);
        if (w->moved * (w->moved / before) <= ROUNDING) {
            return MT_OK;
        }
        before = w->moved;
    }
    return MT_OK;
}

/* Take the step that was found with the elastic stiffness alone, or leave it; returns how long
 * it was. tau: of the trimmed springs, before. */
static double move_elastically(mt_newton_work *w, mt_placement *at,
                               const mt_newton_solver *solver, const mt_trim_forces *tau,
                               double previous)
{
    if (!use_elastic(w, previous)) {
        w->tau = *tau;
        return HUGE_VAL;
    }
    const double moved = w->moved;
    move_by_newton_step(w, at, solver);
    return moved;
}

/* Plain Newton from the present position; *done: converged. */
static mt_status iterate_newton(mt_newton_work *w, mt_placement *at, mt_arena *mem,
                                mt_stage *stage, bool *done, mt_err *err)
{
    double previous = HUGE_VAL;
    double unbalanced = HUGE_VAL;
    *done = false;
    w->followed = false;
    w->elastic = w->p->trim && w->p->energy == MT_ENERGY_PHYSICAL;
    for (int it = 0; it < NEWTON_LIMIT; it++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        const bool dense = w->h != NULL;
        mt_newton_solver solver;
        const mt_trim_forces tau = w->tau;
        const bool followed = w->followed;
        bool falls = false;
        MT_TRY(linearise(w, at, it == 0, mem, &solver, &falls, err));
        stage->iterations++;
        if (falls) {
            return MT_OK;
        }
        if (it == 0) {
            stay_at_rest(w, &solver);
        }
        if (w->elastic) {
            previous = move_elastically(w, at, &solver, &tau, previous);
            continue;
        }
        const bool rest = rests(w, previous);
        if (rest && balanced(w)) {
            const mt_status rc = keep_solution(w, &solver, &tau, mem, stage, err);
            *done = rc == MT_OK;
            return rc;
        }
        if (rest && followed && solver.sparse) {
            w->tau = tau; /* what is unbalanced may be the multipliers' own error */
            mt_arena_rewind(mem, mark);
            continue;
        }
        if (rest && (!w->p->trim || w->residual >= 0.25 * unbalanced)) {
            return MT_OK; /* something pushes along a freedom without stiffness */
        }                 /* else the forces of trimmed springs are still settling */
        unbalanced = w->residual;
        move_by_newton_step(w, at, &solver);
        MT_TRY(go_on_with_factor(w, at, followed ? &solver : NULL, mem, stage, err));
        previous = w->moved;
        if (dense == (w->h != NULL)) { /* else there is room for dense matrices from here on */
            mt_arena_rewind(mem, mark);
        }
        if (!(w->moved < HUGE_VAL)) {
            return MT_OK;
        }
    }
    return MT_OK;
}

/* A position that is not a number ends the iteration, not the analysis: the start may be
 * bad. */
static mt_status attempt(mt_newton_work *w, mt_placement *at, mt_arena *mem, mt_stage *stage,
                         bool *done, mt_err *err)
{
    const mt_status rc = iterate_newton(w, at, mem, stage, done, err);
    return rc == MT_E_DOMAIN || rc == MT_E_NO_CONVERGENCE ? MT_OK : rc;
}

/* Name joints: those in the left null vectors of A along which the gap lies (they contradict
 * each other), otherwise the one with the largest gap. */
static mt_status say_open(const mt_newton_work *w, const mt_elimination *e, mt_arena *mem,
                          mt_err *err)
{
    int worst = 0;
    double gap = 0.0;
    for (int i = 0; i < w->p->m; i++) {
        if (!(fabs(w->c[i]) <= gap)) {
            gap = fabs(w->c[i]);
            worst = i;
        }
    }
    const mt_constraint_def *const c = &w->sys->constraints[worst];
    const mt_measure_kind kind = w->sys->measures[c->measure[0]].kind;
    const bool length = kind == MT_MEASURE_PLANE || kind == MT_MEASURE_DISTANCE;
    const char *const unit = length ? "m" : "(cosine or rad)";
    double *const null = mt_arena_f64(mem, (size_t)w->p->m, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < e->m - e->qr.rank; k++) {
        MT_TRY(mt_eliminate_left_null(e, k, null, mem, err));
        if (fabs(null[worst]) > IN_THE_SET) {
            mt_joint_names names;
            MT_TRY(mt_name_joints(w->sys, w->p->m, null, mem, &names, err));
            return mt_fail(err, MT_E_ASSEMBLY,
                           "joints %s contradict each other: a gap of %.6g %s is left",
                           names.text, gap, unit);
        }
    }
    return mt_fail(err, MT_E_ASSEMBLY,
                   "the mechanism cannot be assembled: joint \"%s\" stays open by %.6g %s",
                   w->sys->joints[c->joint].name, gap, unit);
}

/* at: where the search ended; closed, where the stage began closed. */
static mt_status refuse_not_converged(mt_newton_work *w, const mt_placement *at, bool closed,
                                      mt_arena *mem, const mt_stage *stage, mt_err *err)
{
    mt_elimination e;
    mt_newton_solver solver;
    MT_TRY(mt_newton_dense(w, mem, err));
    memset(w->lambda, 0, (size_t)w->p->m * sizeof *w->lambda);
    mt_newton_evaluate(w, at, false);
    MT_TRY(mt_eliminate(w->sys, w->p->m, w->a, mem, &e, err));
    if (!closed && !(mt_newton_gap_of(w) <= MT_STEP_DONE)) {
        return say_open(w, &e, mem, err);
    }
    MT_TRY(newton_linearise(w, at, mem, &solver, err));
    char where[WHERE_SIZE];
    if (!isfinite(w->residual)) {
        return mt_fail(err, MT_E_EQUILIBRIUM,
                       "no equilibrium found after %d iterations: the forces at work grow "
                       "beyond all numbers",
                       stage->iterations);
    }
    mt_eliminate_project(&solver.e, w->g, w->reduced);
    mt_name_motion(w->sys, &solver.e, w->reduced, where, sizeof where);
    return mt_fail(err, MT_E_EQUILIBRIUM,
                   "no equilibrium found after %d iterations: %.3g of the forces at work stay "
                   "unbalanced on %s (free to move under load?)",
                   stage->iterations, w->residual, where);
}

/* What is kept of the better of two ends. */
typedef struct ending {
    bool done;
    bool saddle;
    double energy;
    double before; /* the energy where the stage began */
} ending;

/* end->saddle: the stationary point last evaluated is, with the drives held, a saddle from
 * which the way from the start leads down. That direction is stored in w->step. */
static mt_status check_for_saddle(mt_newton_work *w, const mt_placement *start,
                                  const mt_placement *at, const mt_stage *stage, ending *end,
                                  mt_arena *mem, mt_err *err)
{
    mt_elimination held;
    mt_newton_solver solver = stage->solver;
    const mt_elimination *e = &solver.e;
    end->saddle = false;
    if (!end->done) {
        return MT_OK;
    }
    end->energy = mt_energy_value(w->p->data, at, &w->tau, kept_jets(w, false));
    if (solver.sparse && mt_saddle_convex(&solver.saddle)) {
        return MT_OK;
    }
    double *const way = mt_arena_f64(mem, (size_t)w->sys->nq, 1);
    MT_TRY(mt_arena_check(mem, err));
    if (solver.sparse) {
        const mt_trim_forces tau = w->tau;
        MT_TRY(mt_newton_dense(w, mem, err));
        MT_TRY(newton_linearise(w, at, mem, &solver, err));
        w->tau = tau;
    }
    if (w->p->trim) {
        MT_TRY(mt_eliminate(w->sys, w->p->m, w->a, mem, &held, err));
        e = &held;
    }
    mt_poses_increment(w->sys, start->pose, at->pose, way);
    return newton_falls(w, e, way, &end->saddle, mem, err);
}

static mt_status copy_placement(const mt_newton_work *w, const mt_placement *at,
                                mt_placement *out, mt_arena *mem, mt_err *err)
{
    MT_TRY(mt_placement_init(out, w->sys, mem, err));
    mt_placement_copy(w->sys, at, out);
    return MT_OK;
}

/* Descend from `at`, and leave every saddle on the way. */
static mt_status descend_to_minimum(mt_newton_work *w, const mt_placement *start,
                                    mt_placement *at, mt_arena *mem, mt_stage *stage,
                                    ending *end, mt_err *err)
{
    bool on = true;
    mt_placement low;
    MT_TRY(mt_placement_init(&low, w->sys, mem, err));
    for (int i = 0; i < SADDLES && on; i++) {
        MT_TRY(newton_descend(w, at, mem, err));
        mt_placement_copy(w->sys, at, &low);
        MT_TRY(attempt(w, at, mem, stage, &end->done, err));
        MT_TRY(check_for_saddle(w, start, at, stage, end, mem, err));
        on = end->saddle;
        if (on) {
            MT_TRY(newton_leave_saddle(w, at, &on, mem, err));
        }
    }
    if (!end->done) {
        mt_placement_copy(w->sys, &low, at);
    }
    return MT_OK;
}

/* With trim: the stationary point with the joints locked is where the trimmed one begins. */
static mt_status lock_first(const mt_newton_work *w, mt_placement *at, mt_arena *mem,
                            mt_stage *stage, mt_err *err)
{
    mt_newton_problem locked = *w->p;
    mt_stage other = {.iterations = stage->iterations};
    mt_placement before;
    locked.trim = false;
    MT_TRY(copy_placement(w, at, &before, mem, err));
    const mt_status rc = mt_newton_solve(&locked, at, mem, &other, NULL);
    stage->iterations = other.iterations;
    if (rc != MT_OK) {
        mt_placement_copy(w->sys, &before, at);
    }
    return rc == MT_E_MEMORY ? mt_fail_memory(err) : MT_OK;
}

/* After plain Newton of a physical stage ended as `end`: accept its result, or descend from the
 * start. */
static mt_status accept_or_descend(mt_newton_work *w, const mt_placement *start,
                                   mt_placement *at, mt_arena *mem, mt_stage *stage,
                                   ending *end, mt_err *err)
{
    MT_TRY(check_for_saddle(w, start, at, stage, end, mem, err));
    const double rounding = ENERGY_ROUNDING * (fabs(end->before) + fabs(end->energy));
    const bool uphill = !w->p->trim && end->done && end->energy > end->before + rounding;
    const bool settled = !end->saddle && !uphill;
    if (end->done && (settled || mt_poses_distance(w->sys, start->pose, at->pose) <= DRAWN)) {
        return MT_OK;
    }
    const mt_stage first_stage = *stage;
    const bool found = end->done;
    mt_placement first;
    MT_TRY(copy_placement(w, at, &first, mem, err));
    w->watch = false;
    mt_placement_copy(w->sys, start, at);
    w->tau = (mt_trim_forces){{0.0}};
    if (w->p->trim && found) {
        MT_TRY(lock_first(w, at, mem, stage, err));
        MT_TRY(attempt(w, at, mem, stage, &end->done, err));
    } else {
        MT_TRY(descend_to_minimum(w, start, at, mem, stage, end, err));
    }
    if (found && !end->done) { /* nothing lower holds it: the saddle stands, told as unstable */
        end->done = true;
        *stage = first_stage;
        mt_placement_copy(w->sys, &first, at);
    }
    return MT_OK;
}

mt_status mt_newton_solve(const mt_newton_problem *problem, mt_placement *at, mt_arena *mem,
                          mt_stage *stage, mt_err *err)
{
    mt_newton_work w;
    ending end = {.done = false};
    mt_placement start;
    MT_TRY(mt_newton_work_init(&w, problem, mem, err));
    w.sparse.rest = problem->rest;
    MT_TRY(copy_placement(&w, at, &start, mem, err));
    const bool closed = newton_gap_at(&w, at) <= MT_STEP_DONE;
    end.before = mt_energy_value(problem->data, at, NULL, kept_jets(&w, true));
    w.watch = problem->energy == MT_ENERGY_PHYSICAL && !problem->trim;
    MT_TRY(attempt(&w, at, mem, stage, &end.done, err));
    if (problem->energy == MT_ENERGY_PHYSICAL) {
        MT_TRY(accept_or_descend(&w, &start, at, mem, stage, &end, err));
    }
    stage->factors += w.factors;
    return end.done ? MT_OK : refuse_not_converged(&w, at, closed, mem, stage, err);
}

mt_status mt_newton_gap(const mt_newton_problem *problem, const mt_placement *at, mt_arena *mem,
                        double *gap_m, mt_err *err)
{
    const mt_system *const sys = problem->data->sys;
    mt_newton_work w = {.p = problem, .sys = sys};
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    w.c = mt_arena_f64(mem, (size_t)sys->n_constraints, 1);
    MT_TRY(mt_arena_check(mem, err));
    *gap_m = newton_gap_at(&w, at) * sys->length_m;
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

mt_status mt_newton_adjoint(const mt_stage *stage, const double *pull, const double *across,
                            const double *pull_trim, double *x, double *y, mt_arena *scratch,
                            mt_err *err)
{
    const mt_newton_solver *const solver = &stage->solver;
    if (solver->sparse) {
        return solver->border.along != NULL
                   ? mt_border_adjoint(&solver->border, pull, across, pull_trim, x, y, scratch,
                                       err)
                   : mt_saddle_solve(&solver->saddle, pull, across, x, y, scratch, err);
    }
    const mt_elimination *const e = &stage->solver.e;
    const ptrdiff_t nq = e->nq;
    const int m = stage->m;
    const int order = e->n + (m - e->m);
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const r = mt_arena_f64(scratch, (size_t)nq, 1);
    double *const eta = mt_arena_f64(scratch, (size_t)order + 1, 1);
    double *const b = mt_arena_f64(scratch, (size_t)order + 1, 1);
    double *const way = mt_arena_f64(scratch, (size_t)nq, 1);
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(mt_eliminate_particular(e, across, x, scratch, err));
    memcpy(r, pull, (size_t)nq * sizeof *r);
    mt_gemv(true, e->nq, e->nq, -1.0, stage->h, e->nq, x, 1.0, r);
    mt_eliminate_project(e, r, b);
    for (ptrdiff_t t = 0; t < m - e->m; t++) {
        b[e->n + t] = pull_trim[t] - mt_dot(e->nq, stage->trim + (t * nq), x);
    }
    mt_gemv(true, order, order, 1.0, stage->solver.inverse, order, b, 0.0, eta);
    mt_eliminate_expand(e, eta, way);
    mt_axpy(e->nq, 1.0, way, x);
    mt_gemv(true, e->nq, e->nq, -1.0, stage->h, e->nq, way, 1.0, r);
    for (int i = e->m; i < m; i++) { /* those of the trimmed drives */
        y[i] = eta[e->n + (i - e->m)];
        for (ptrdiff_t j = 0; j < nq; j++) {
            r[j] -= stage->a[i + (j * m)] * y[i];
        }
    }
    MT_TRY(mt_eliminate_multipliers(e, r, y, scratch, err));
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}
