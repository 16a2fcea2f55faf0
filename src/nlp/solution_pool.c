/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ends of local searches: what is recorded of each, what they leave open, how many roots they
 * are, and what they are worth. */
#include "nlp/solution_pool.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "nlp/kkt.h"
#include "nlp/lsq.h"
#include "nlp/merit.h"
#include "nlp/near_null_directions.h"
#include "nlp/polish.h"

/* From a point to the record of a solution: bounds met, multipliers, KKT residual. No
 * evaluation. */

/* A variable this near to its bound, relative to the width, is on it. */
static const double ON_BOUND = 1e-8;
/* A multiplier takes part in a dependence of the gradients where its coefficient exceeds
 * this. */
static const double DEPENDENT = 1e-6;

/* Multipliers of linearly dependent gradients are not unique: NaN. */
static mt_status mark_dependent(mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_active *a,
                                mt_arena *mem)
{
    double *const col = mt_arena_f64(mem, (size_t)a->n_free, 1);
    double *const x = mt_arena_f64(mem, (size_t)a->k, 1);
    MT_TRY(mt_arena_check(mem, e->err));
    for (int d = a->qr.rank; d < a->k; d++) {
        const int i = a->qr.perm[d];
        for (int j = 0; j < a->n_free; j++) {
            col[j] = mt_nlp_row_slope(e, p, a->row[i], a->free[j]) / a->scale[i];
        }
        MT_TRY(mt_qr_solve(&a->qr, 1, col, x, mem, e->err));
        a->lambda[i] = nan("");
        for (int c = 0; c < a->k; c++) {
            if (fabs(x[c]) > DEPENDENT) {
                a->lambda[c] = nan("");
            }
        }
    }
    return MT_OK;
}

static void put_multipliers(const mt_nlp_engine *e, const mt_nlp_active *a,
                            mt_nlp_solution *out)
{
    const mt_nlp *const q = e->nlp;
    for (int i = 0; i < a->k; i++) {
        const int in = a->row[i] - q->n_eq;
        if (in < 0) {
            out->mult_eq[a->row[i]] = a->lambda[i];
        } else {
            out->mult_in[in < q->n_in ? in : q->next_of[in - q->n_in]] += a->lambda[i];
        }
    }
    for (int j = 0; j < e->n; j++) {
        out->mult_bound[j] = out->bound[j] != 0 ? a->z[j] : 0;
    }
}

static void no_multipliers(const mt_nlp_engine *e, mt_nlp_solution *out)
{
    for (int i = 0; i < e->nlp->n_eq; i++) {
        out->mult_eq[i] = nan("");
    }
    for (int i = 0; i < e->nlp->n_in; i++) {
        out->mult_in[i] = nan("");
    }
    for (int j = 0; j < e->n; j++) {
        out->mult_bound[j] = nan("");
    }
}

/* Part of the residual z orthogonal to the unidentifiable directions; z is overwritten. */
static double determined_part(const mt_nlp_engine *e, const mt_nlp_result *all,
                              mt_nlp_active *a)
{
    double whole = 0;
    double rest = 0;
    for (int i = 0; i < a->n_free; i++) {
        whole += a->z[a->free[i]] * a->z[a->free[i]];
    }
    for (int k = 0; k < all->n_unidentifiable; k++) {
        const double *const u = all->unidentifiable + ((ptrdiff_t)k * e->n);
        double along = 0;
        for (int i = 0; i < a->n_free; i++) {
            along += u[a->free[i]] * a->z[a->free[i]];
        }
        for (int i = 0; i < a->n_free; i++) {
            a->z[a->free[i]] -= along * u[a->free[i]];
        }
    }
    for (int i = 0; i < a->n_free; i++) {
        rest += a->z[a->free[i]] * a->z[a->free[i]];
    }
    return whole > 0 ? sqrt(rest / whole) : 1;
}

/* Fill the record of a solution from a point (copies; no evaluation). kkt excludes the part of
 * the residual along the unidentifiable directions of `all`, which were not searched. False:
 * memory or linear algebra, as mt_nlp_ok. */
static bool nlp_report(mt_nlp_engine *e, const mt_nlp_point *p, const mt_nlp_result *all,
                       mt_arena *mem, mt_nlp_solution *out)
{
    const mt_nlp *const q = e->nlp;
    *out = (mt_nlp_solution){.f = p->f,
                             .violation = p->violation,
                             .squares = p->squares,
                             .feasible = mt_nlp_feasible(p)};
    out->t = mt_arena_f64(mem, (size_t)e->n, 1);
    out->bound = mt_arena_int(mem, (size_t)e->n);
    out->mult_bound = mt_arena_f64(mem, (size_t)e->n, 1);
    out->mult_eq = mt_arena_f64(mem, (size_t)q->n_eq, 1);
    out->mult_in = mt_arena_f64(mem, (size_t)q->n_in, 1);
    if (!mt_nlp_has_room(e, mem)) {
        return false;
    }
    memcpy(out->t, p->t, (size_t)e->n * sizeof *out->t);
    for (int j = 0; j < e->n; j++) {
        const double near = ON_BOUND * (q->upper[j] - q->lower[j]);
        out->bound[j] = p->t[j] <= q->lower[j] + near ? -1 : p->t[j] >= q->upper[j] - near;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    mt_nlp_active a;
    const mt_nlp_stage stage = out->feasible ? MT_NLP_OBJECTIVE : MT_NLP_SQUARES;
    bool ok = mt_nlp_active_set(e, p, stage, &e->scratch, &a);
    if (ok && out->feasible) {
        ok = mt_nlp_ok(e, mark_dependent(e, p, &a, &e->scratch));
        put_multipliers(e, &a, out);
    } else {
        no_multipliers(e, out);
    }
    if (ok) {
        const bool isolated = out->feasible && a.n_free > 0 && q->n_eq >= a.n_free;
        out->kkt =
            isolated && a.qr.rank == a.n_free ? nan("") : a.kkt * determined_part(e, all, &a);
    }
    mt_arena_rewind(&e->scratch, mark);
    return ok;
}

/*
 * Directions of t-space that the problem does not see. Candidates come from the Jacobian at the
 * solution, rows divided by tolerances, columns multiplied by the widths of the bounds, so that
 * an entry is the change, in tolerances, of crossing the bounds: first single variables (an
 * engineer reads those), then the small right singular vectors of the remaining columns. A
 * Jacobian is a statement about one point, so every candidate d is confirmed by evaluating
 * across the bounds: a double root, whose Jacobian is singular too, fails there. The longest
 * way across the box along d is
 *
 *     L = min_j (upper_j - lower_j) / |d_j|,
 *
 * and through a corner there may be none at all: nothing would change because nothing moves. A
 * solution without room along d (a millionth of L; rounding is no room) stands where it does by
 * its bounds, and d is none. Else d is followed from the solution and, since its room may be
 * short, from points with at least L/4 either way: the solution, the origin and the middle,
 * each moved that far inside.
 */

/* Residuals are dimensionless (ln of ratios, differences of unit vectors); they carry no
 * tolerance: the usual one of a frequency, a relative 1e-6, is used. The same for an objective,
 * relative to its size. */
static const double RESIDUAL_TOL = 1e-6;
static const double F_TOL_REL = 1e-6;
/* Linear change (in tolerances) of crossing the bounds up to which a direction is a candidate:
 * more than 1, since the middle decides, not the slope at one end. */
static const double CANDIDATE = 4;
/* A candidate is left out when so little of it is new beside those already found. */
static const double NEW_PART = 0.1;
/* Entries of a direction below this are rounding of the singular vectors. */
static const double ENTRY_NOISE = 1e-9;
/* Marks from one end of the crossing to the other, ends included. */
enum { MARKS = 3 };
/* Points to cross from: the solution where it stands; it, the origin and the middle of the
 * bounds, moved inside. */
enum { BASES = 4 };
/* Room either way that a crossing needs, in units of the longest way across the box. */
static const double ROOM = 0.25;
/* ... and that the solution itself must have, both ways together. */
static const double ROOM_LEAST = 1e-6;
/* Violation, in tolerances, that needs no correction. */
static const double RESTORED = 1e-3;

typedef struct crossing {
    mt_nlp_engine *e;
    int m;      /* rows: residuals or objective, equalities, inequalities */
    bool use_f; /* the objective counts */
    double f_tol;
    mt_nlp_point *from;
    mt_nlp_point *at;
    double *t;
    double *base;
} crossing;

static double row_tol(const crossing *x, int i)
{
    const mt_nlp *const q = x->e->nlp;
    if (i < q->n_res) {
        return RESIDUAL_TOL;
    }
    i -= q->n_res;
    if (i < q->n_eq) {
        return q->eq_tol[i];
    }
    return i - q->n_eq < q->n_in ? q->in_tol[i - q->n_eq] : x->f_tol;
}

static double row_value(const crossing *x, const mt_nlp_point *p, int i)
{
    const mt_nlp *const q = x->e->nlp;
    if (i < q->n_res) {
        return p->r[i];
    }
    i -= q->n_res;
    if (i < q->n_eq) {
        return p->eq[i];
    }
    return i - q->n_eq < q->n_in ? p->in[i - q->n_eq] : p->f;
}

static double row_slope(const crossing *x, const mt_nlp_point *p, int i, int j)
{
    const mt_nlp *const q = x->e->nlp;
    if (i < q->n_res) {
        return p->dr[i + (ptrdiff_t)j * q->n_res];
    }
    i -= q->n_res;
    return i < q->n_eq + q->n_in ? mt_nlp_row_slope(x->e, p, i, j) : p->df[j];
}

/* Includes the objective where there are no residuals and it is not the total change. */
static void weigh_objective(crossing *x, const mt_nlp_point *p)
{
    const mt_nlp *const q = x->e->nlp;
    double size = fabs(p->f);
    for (int j = 0; j < x->e->n; j++) {
        size += fabs(p->df[j]) * (q->upper[j] - q->lower[j]);
    }
    x->use_f = q->n_res == 0 && !x->e->opt.least_change && size > 0;
    x->f_tol = F_TOL_REL * size;
    x->m = q->n_res + q->n_eq + q->n_in + x->use_f;
}

/* The s for which from + s d is within the bounds: s[0] <= 0 <= s[1]. */
static void range_along(const mt_nlp_engine *e, const double *from, const double *d,
                        double s[2])
{
    s[0] = -HUGE_VAL;
    s[1] = HUGE_VAL;
    for (int j = 0; j < e->n; j++) {
        if (fabs(d[j]) <= ENTRY_NOISE) {
            continue;
        }
        const double a = (e->nlp->lower[j] - from[j]) / d[j];
        const double b = (e->nlp->upper[j] - from[j]) / d[j];
        s[0] = fmax(s[0], fmin(a, b));
        s[1] = fmin(s[1], fmax(a, b));
    }
}

/* The longest way across the bounds along d. */
static double longest_way(const mt_nlp_engine *e, const double *d)
{
    double longest = HUGE_VAL;
    for (int j = 0; j < e->n; j++) {
        if (fabs(d[j]) > ENTRY_NOISE) {
            longest = fmin(longest, (e->nlp->upper[j] - e->nlp->lower[j]) / fabs(d[j]));
        }
    }
    return longest;
}

static bool has_room(const mt_nlp_engine *e, const double *t, const double *d)
{
    double s[2];
    range_along(e, t, d, s);
    return s[1] - s[0] > ROOM_LEAST * longest_way(e, d);
}

/* t := base moved inside the bounds until d has its room either way. */
static void move_inside_bounds(const mt_nlp_engine *e, const double *base, const double *d,
                               double *t)
{
    const double longest = longest_way(e, d);
    for (int j = 0; j < e->n; j++) {
        const double room = fabs(d[j]) > ENTRY_NOISE ? ROOM * longest * fabs(d[j]) : 0;
        t[j] = fmin(fmax(base[j], e->nlp->lower[j] + room), e->nlp->upper[j] - room);
    }
}

/* Greatest change, in tolerances, along x->from + s d over all s within the bounds; infinity
 * where a point has no value. */
static double effect(crossing *x, const double *d)
{
    mt_nlp_engine *const e = x->e;
    double s[2];
    range_along(e, x->from->t, d, s);
    double most = 0;
    for (int k = 0; k < MARKS; k++) {
        const double sk = s[0] + (s[1] - s[0]) * k / (MARKS - 1);
        for (int j = 0; j < e->n; j++) {
            x->t[j] = x->from->t[j] + (fabs(d[j]) > ENTRY_NOISE ? sk * d[j] : 0);
        }
        if (!mt_nlp_evaluate(e, x->t, false, x->at)) {
            return HUGE_VAL;
        }
        for (int i = 0; i < x->m; i++) {
            const double change = row_value(x, x->at, i) - row_value(x, x->from, i);
            most = fmax(most, fabs(change) / row_tol(x, i));
        }
    }
    return most;
}

/* Makes d orthonormal to those found; false where little of it remains. */
static bool make_new(const mt_nlp_engine *e, const mt_nlp_result *out, double *d)
{
    const double before = mt_norm2(e->n, d);
    for (int pass = 0; pass < 2; pass++) { /* twice is enough (Kahan) */
        for (int k = 0; k < out->n_unidentifiable; k++) {
            const double *const u = out->unidentifiable + (ptrdiff_t)k * e->n;
            mt_axpy(e->n, -mt_dot(e->n, u, d), u, d);
        }
    }
    const double norm = mt_norm2(e->n, d);
    if (!(norm > NEW_PART * before)) {
        return false;
    }
    double sign = 0;
    double most = 0;
    for (int j = 0; j < e->n; j++) {
        if (fabs(d[j]) > most * (1 + ENTRY_NOISE)) {
            most = fabs(d[j]);
            sign = d[j] > 0 ? 1 : -1;
        }
    }
    for (int j = 0; j < e->n; j++) {
        d[j] = fabs(d[j]) > ENTRY_NOISE * norm ? sign * d[j] / norm : 0;
    }
    return true;
}

/* Try the direction in column n_unidentifiable of out: confirmed from all bases. */
static void confirm(crossing *x, const mt_nlp_point *solution, mt_nlp_result *out)
{
    mt_nlp_engine *const e = x->e;
    double *const d = out->unidentifiable + (ptrdiff_t)out->n_unidentifiable * e->n;
    if (!make_new(e, out, d) || !has_room(e, solution->t, d)) {
        return;
    }
    double most = 0;
    for (int k = 0; k < BASES && most < 1; k++) {
        for (int j = 0; j < e->n; j++) {
            x->base[j] = k < 2    ? solution->t[j]
                         : k == 2 ? e->origin[j]
                                  : 0.5 * (e->nlp->lower[j] + e->nlp->upper[j]);
        }
        if (k == 0) {
            memcpy(x->t, x->base, (size_t)e->n * sizeof *x->t);
        } else {
            move_inside_bounds(e, x->base, d, x->t);
        }
        if (mt_nlp_evaluate(e, x->t, false, x->from)) {
            most = fmax(most, effect(x, d));
        } else if (k < 2) { /* elsewhere the problem may have no value: the solution alone */
            most = HUGE_VAL;
        }
    }
    if (most < 1 && !e->ended) {
        out->unidentifiable_effect[out->n_unidentifiable++] = most;
    }
}

/* Scaled Jacobian of the columns that are not yet undetermined; single variables are tried
 * here. */
static int single_variables(crossing *x, const mt_nlp_point *p, mt_nlp_result *out, double *A,
                            int *column)
{
    const mt_nlp *const q = x->e->nlp;
    const int rows = x->m > x->e->n ? x->m : x->e->n;
    int k = 0;
    for (int j = 0; j < x->e->n; j++) {
        if (x->e->held[j]) {
            continue;
        }
        double *const col = A + (ptrdiff_t)k * rows;
        double most = 0;
        memset(col, 0, (size_t)rows * sizeof *col);
        for (int i = 0; i < x->m; i++) {
            col[i] = row_slope(x, p, i, j) * (q->upper[j] - q->lower[j]) / row_tol(x, i);
            most = fmax(most, fabs(col[i]));
        }
        const int before = out->n_unidentifiable;
        if (most <= CANDIDATE) {
            double *const d = out->unidentifiable + (ptrdiff_t)before * x->e->n;
            memset(d, 0, (size_t)x->e->n * sizeof *d);
            d[j] = 1;
            confirm(x, p, out);
        }
        if (out->n_unidentifiable == before) {
            column[k++] = j;
        }
    }
    return k;
}

/*
 * Basis of the space V V^T of singular vectors whose values are rounding: only the space is
 * determined, not the vectors. Method: pivoted Cholesky: the variable with the largest part in
 * the space (the first of equal ones), its projection, and the same for the remainder. v: m
 * columns of k, orthonormal; on return that basis. w[k], g[m]: work.
 */
static void choose_basis(int k, int m, double *v, double *w, double *g, double *basis)
{
    for (int r = 0; r < m; r++) {
        double most = 0.0;
        int pivot = 0;
        for (int i = 0; i < k; i++) {
            double own = 0.0;
            for (int c = 0; c < m; c++) {
                own += v[i + (ptrdiff_t)c * k] * v[i + (ptrdiff_t)c * k];
            }
            if (mt_exceeds(own, most)) {
                most = own;
                pivot = i;
            }
        }
        for (int c = 0; c < m; c++) {
            g[c] = v[pivot + (ptrdiff_t)c * k];
        }
        mt_gemv(false, k, m, 1.0 / sqrt(most), v, k, g, 0.0, w);
        for (int c = 0; c < m; c++) {
            mt_axpy(k, -mt_dot(k, w, v + (ptrdiff_t)c * k), w, v + (ptrdiff_t)c * k);
        }
        memcpy(basis + (ptrdiff_t)r * k, w, (size_t)k * sizeof *basis);
    }
}

/* Small right singular vectors of A (columns of `column`), weakest first. */
static mt_status combinations(crossing *x, const mt_nlp_point *p, mt_nlp_result *out, double *A,
                              const int *column, int k)
{
    mt_nlp_engine *const e = x->e;
    const int rows = x->m > e->n ? x->m : e->n;
    mt_arena *const mem = &e->scratch;
    double *const s = mt_arena_f64(mem, (size_t)k, 1);
    double *const u = mt_arena_f64(mem, (size_t)rows, (size_t)k);
    double *const vt = mt_arena_f64(mem, (size_t)k, (size_t)k);
    double *const v = mt_arena_f64(mem, (size_t)k, (size_t)k);
    double *const basis = mt_arena_f64(mem, (size_t)k, (size_t)k);
    double *const w = mt_arena_f64(mem, (size_t)k, 2);
    MT_TRY(mt_arena_check(mem, e->err));
    MT_TRY(mt_svd(rows, k, A, s, u, vt, mem, e->err));
    /* a singular value is the change for a unit vector; it knows rounding of the largest */
    const double rounding = 16 * DBL_EPSILON * (double)rows * s[0];
    const double small = fmax(CANDIDATE, rounding);
    int n = 0; /* vectors v, of which the first `lost` are known as a space only */
    int lost = 0;
    for (int c = k - 1; c >= 0 && s[c] <= small; c--) {
        for (int i = 0; i < k; i++) {
            v[i + (ptrdiff_t)n * k] = vt[c + (ptrdiff_t)i * k];
        }
        n++;
        lost += s[c] <= rounding;
    }
    choose_basis(k, lost, v, w, w + k, basis);
    memcpy(v, basis, (size_t)k * (size_t)lost * sizeof *v);
    for (int c = 0; c < n && !e->ended; c++) {
        double *const d = out->unidentifiable + (ptrdiff_t)out->n_unidentifiable * e->n;
        memset(d, 0, (size_t)e->n * sizeof *d);
        for (int i = 0; i < k; i++) {
            const int j = column[i];
            d[j] = v[i + (ptrdiff_t)c * k] * (e->nlp->upper[j] - e->nlp->lower[j]);
        }
        confirm(x, p, out);
    }
    return MT_OK;
}

static bool find_directions(mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_result *out)
{
    mt_arena *const mem = &e->scratch;
    crossing x = {.e = e};
    weigh_objective(&x, p);
    const int rows = x.m > e->n ? x.m : e->n;
    double *const A = mt_arena_f64(mem, (size_t)rows, (size_t)e->n);
    int *const column = mt_arena_int(mem, (size_t)e->n);
    x.from = mt_nlp_point_new(e, mem);
    x.at = mt_nlp_point_new(e, mem);
    x.t = mt_arena_f64(mem, (size_t)e->n, 1);
    x.base = mt_arena_f64(mem, (size_t)e->n, 1);
    if (!mt_nlp_has_room(e, mem)) {
        return false;
    }
    const int k = single_variables(&x, p, out, A, column);
    return k == 0 || mt_nlp_ok(e, combinations(&x, p, out, A, column, k));
}

bool mt_nlp_unidentifiable(mt_nlp_engine *e, const mt_nlp_point *p, mt_arena *mem,
                           mt_nlp_result *out)
{
    /* one column more than there can be directions: a candidate is made in place */
    out->unidentifiable = mt_arena_f64(mem, (size_t)e->n, (size_t)e->n + 1);
    out->unidentifiable_effect = mt_arena_f64(mem, (size_t)e->n, 1);
    if (!mt_nlp_has_room(e, mem)) {
        return false;
    }
    out->n_unidentifiable = 0;
    if (e->ended) {
        return true;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    const bool ok = find_directions(e, p, out);
    mt_arena_rewind(&e->scratch, mark);
    return ok;
}

/* Remove directions along which the bounds leave p, the reported solution, no way to move. */
static void nlp_drop_roomless(const mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_result *out)
{
    const size_t n = (size_t)e->n;
    int kept = 0;
    for (int k = 0; k < out->n_unidentifiable; k++) {
        const double *const d = out->unidentifiable + (size_t)k * n;
        if (has_room(e, p->t, d)) {
            memmove(out->unidentifiable + (size_t)kept * n, d, n * sizeof *d);
            out->unidentifiable_effect[kept++] = out->unidentifiable_effect[k];
        }
    }
    out->n_unidentifiable = kept;
}

/* True where variable j alone is one of the directions. */
static bool is_single(const mt_nlp_engine *e, const mt_nlp_result *u, int j)
{
    for (int k = 0; k < u->n_unidentifiable; k++) {
        if (u->unidentifiable[j + (ptrdiff_t)k * e->n] == 1) {
            return true;
        }
    }
    return false;
}

/* True where a point is as good as before: requirements met, the objective unchanged within
 * tolerance, still a local solution. A compromise may be worse by the sum of the tolerances,
 * which is what the directions may change by definition. */
static bool as_good(const mt_nlp_engine *e, const mt_nlp_point *after,
                    const mt_nlp_point *before)
{
    const mt_nlp *const q = e->nlp;
    if (!mt_nlp_feasible(before)) {
        const double tol = hypot(mt_norm2(q->n_eq, q->eq_tol), mt_norm2(q->n_in, q->in_tol));
        return sqrt(after->squares) <= sqrt(before->squares) + tol;
    }
    const double misfit = sqrt(2 * before->f) + RESIDUAL_TOL * sqrt(q->n_res);
    const double f_most =
        q->n_res > 0 ? 0.5 * misfit * misfit : before->f + F_TOL_REL * fabs(before->f);
    const bool stationary = after->kkt <= fmax(before->kkt, MT_STATIONARY);
    return mt_nlp_feasible(after) && after->f <= f_most && stationary;
}

/* t := p pulled back to the origin along the directions, as far as the bounds let it; single
 * variables exactly. True: it differs. */
static bool pulled(const mt_nlp_engine *e, const mt_nlp_result *u, const mt_nlp_point *p,
                   double *off, double *t)
{
    for (int j = 0; j < e->n; j++) {
        t[j] = p->t[j];
        off[j] = p->t[j] - e->origin[j];
    }
    for (int k = 0; k < u->n_unidentifiable; k++) {
        const double *const uk = u->unidentifiable + (ptrdiff_t)k * e->n;
        double s[2];
        range_along(e, t, uk, s);
        mt_axpy(e->n, fmin(fmax(-mt_dot(e->n, uk, off), fmin(s[0], 0)), fmax(s[1], 0)), uk, t);
    }
    bool moves = false;
    for (int j = 0; j < e->n; j++) {
        t[j] = is_single(e, u, j) ? e->origin[j] : t[j];
        moves = moves || t[j] != p->t[j];
    }
    return moves;
}

/* Effects below a tolerance may add up: meets the requirements exactly again, at least
 * objective, with the single variables fixed. */
static void restore_requirements(mt_nlp_engine *e, const mt_nlp_result *u, bool feasible,
                                 mt_nlp_point *p)
{
    /* a root: no freedom to minimise in */
    const bool isolated = feasible && !(p->kkt < HUGE_VAL);
    bool *const held = mt_arena_alloc(&e->scratch, (size_t)e->n, sizeof *held);
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return;
    }
    memcpy(held, e->held, (size_t)e->n * sizeof *held);
    for (int j = 0; j < e->n; j++) {
        e->held[j] = held[j] || is_single(e, u, j);
    }
    if (p->violation > RESTORED) {
        mt_nlp_least_squares(e, MT_NLP_SQUARES, p);
    }
    if (!isolated && mt_nlp_feasible(p) == feasible) {
        const mt_nlp_stage stage = feasible ? MT_NLP_OBJECTIVE : MT_NLP_SQUARES;
        mt_nlp_polish(e, stage, p, NULL);
    }
    memcpy(e->held, held, (size_t)e->n * sizeof *held);
}

/* Move p to the origin along the unidentifiable directions where requirements, objective and
 * stationarity stay as good. */
static void nlp_pull_back(mt_nlp_engine *e, const mt_nlp_result *unidentifiable,
                          mt_nlp_point *p)
{
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    mt_nlp_point *const to = mt_nlp_point_new(e, &e->scratch);
    double *const t = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
    double *const off = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
    if (mt_nlp_has_room(e, &e->scratch) && pulled(e, unidentifiable, p, off, t) &&
        mt_nlp_evaluate(e, t, true, to)) {
        to->kkt = p->kkt;
        restore_requirements(e, unidentifiable, mt_nlp_feasible(p), to);
        to->n_loose = p->n_loose; /* with these directions among them */
        if (as_good(e, to, p)) {
            mt_nlp_point_copy(e, p, to);
        }
    }
    mt_arena_rewind(&e->scratch, mark);
}

/* How many roots were met. */

/* Ends are one that are nearer than the root of the tolerance, which a double root smears; that
 * is capped where tolerances are wide. */
static const double SAME_MOST = 1e-2;
/* Distance below which two ends are one. nlp_seeks_roots: true where the problem asks for
 * isolated roots. */
static double nlp_same_distance(const mt_nlp_engine *e)
{
    return fmax(MT_SAME_DESIGN, fmin(sqrt(e->eq_tol), SAME_MOST));
}

static bool nlp_seeks_roots(const mt_nlp_engine *e)
{
    return e->nlp->n_eq >= e->n_free && e->n_free > 0;
}

int mt_nlp_roots(mt_nlp_engine *e, const mt_nlp_solution_pool *all, int *once)
{
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    /* a later end is the same */
    int *const twin = mt_arena_int(&e->scratch, (size_t)all->count);
    int roots = 0;
    *once = 0;
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return 0;
    }
    for (int i = 0; i < all->count && nlp_seeks_roots(e); i++) {
        const mt_nlp_point *const p = all->at[i].p;
        if (mt_nlp_feasible(p) && all->at[i].curve) {
            roots = 0;
            *once = 0;
            break;
        }
        if (!mt_nlp_feasible(p) || twin[i] != 0) {
            continue;
        }
        int hits = 1;
        for (int k = i + 1; k < all->count; k++) {
            if (mt_nlp_feasible(all->at[k].p) &&
                mt_nlp_distance(e, p, all->at[k].p) <= nlp_same_distance(e)) {
                twin[k] = 1;
                hits++;
            }
        }
        roots++;
        *once += hits == 1;
    }
    mt_arena_rewind(&e->scratch, mark);
    return roots;
}

bool mt_nlp_came_to_rest(const mt_nlp_local *s)
{
    return s->polished && s->p->kkt <= MT_STATIONARY;
}

/*
 * What the ends of the local solves are worth:
 *
 *     feasible ones only, if any; undetermined directions at the best, all ends pulled back
 *         along them; equal ones merged; ranked;
 *     multipliers, KKT residual, singularity. Compromises are settled: the least objective
 *         among equally good ones.
 */

/* Ends nearer than this are one and the same to rounding; merged ones farther apart were two
 * roots. */
static const double IDENTICAL = 1e-5;
static const double NOT_STATIONARY = 1e-3;
/* Compromises whose squares differ by less, relatively, are equally good (their minima are
 * known to rounding, about 1e-12); a smaller objective decides where it is smaller by more than
 * rounding. */
static const double EQUAL_SQUARES = 1e-8;
static const double SETTLED_GAIN = 1e-6;
/* A variable nearer to a mark than this, in widths of its bounds, stands there but for rounding
 * of the search. */
static const double ON_MARK = 1e-12;
/* A compromise knows a variable that no requirement feels to the root of rounding only, as its
 * change counts by its square: nearer to the original than this it is tried there, and stays
 * where the squares are the same to IDLE of their size. */
static const double NEARLY_ON_MARK = 1e-3;
static const double IDLE = 1e-12;
/* Ends of a search that was ended. */
enum { ENDED_MOST = 1000 };
/* Violation, in tolerances, that counts as none, and as no more than it was. */
static const double STILL_MET = 1e-4;

static void swap(mt_nlp_solution_pool *all, int i, int k)
{
    const mt_nlp_local one = all->at[i];
    all->at[i] = all->at[k];
    all->at[k] = one;
}

/*
 * Number of roots that no start found, from f1 found by one start and f2 found by two (Chao
 * 1984, in the form that does not divide by zero): f1 (f1 - 1) / (2 (f2 + 1)), a lower bound of
 * the expectation.
 */
static void count_roots(const mt_nlp_engine *e, const mt_nlp_solution_pool *all,
                        mt_nlp_result *out)
{
    int f2 = 0;
    bool isolated = nlp_seeks_roots(e) && all->count > 0 && !out->compromise;
    for (int i = 0; i < all->count; i++) {
        out->n_once += all->at[i].hits == 1;
        f2 += all->at[i].hits == 2;
        isolated = isolated && !all->at[i].curve;
    }
    out->n_found = all->count;
    out->missing = isolated ? 0.5 * out->n_once * (out->n_once - 1) / (f2 + 1.0) : nan("");
}

typedef struct ranked {
    mt_nlp_local end;
    int at; /* its place before */
} ranked;

static int compare_ranked(const void *a, const void *b)
{
    const ranked *const x = a;
    const ranked *const y = b;
    return mt_nlp_better(x->end.p, y->end.p)   ? -1
           : mt_nlp_better(y->end.p, x->end.p) ? 1
                                               : (x->at > y->at) - (x->at < y->at);
}

/* Sorts, best first; ties keep the order of the starts. Of a search that was ended, where
 * thousands of starts may only have values, the best are kept. */
static void rank_points(mt_nlp_engine *e, mt_nlp_solution_pool *all)
{
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    ranked *const list = mt_arena_alloc(&e->scratch, (size_t)all->count, sizeof *list);
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return;
    }
    for (int i = 0; i < all->count; i++) {
        list[i] = (ranked){all->at[i], i};
    }
    if (all->count > 1) {
        qsort(list, (size_t)all->count, sizeof *list, compare_ranked);
    }
    all->count = e->ended && all->count > ENDED_MOST ? ENDED_MOST : all->count;
    for (int i = 0; i < all->count; i++) {
        all->at[i] = list[i].end;
    }
    mt_arena_rewind(&e->scratch, mark);
}

/* Ranked compromises: among equally good ones the objective decides. */
static void rank_equals(mt_nlp_solution_pool *all)
{
    for (int first = 0; first < all->count;) {
        const double most = all->at[first].p->squares * (1 + EQUAL_SQUARES);
        int i = first + 1;
        for (; i < all->count && all->at[i].p->squares <= most; i++) {
            for (int k = i; k > first && all->at[k].p->f < all->at[k - 1].p->f; k--) {
                swap(all, k, k - 1);
            }
        }
        first = i;
    }
}

/* True where a and b are equally good to the accuracy of a search. */
static bool is_equal(const mt_nlp_point *a, const mt_nlp_point *b)
{
    const bool feasible = mt_nlp_feasible(a);
    return feasible == mt_nlp_feasible(b) && mt_compare(a->f, b->f, MT_EQUAL_FOUND) == 0 &&
           (feasible || fabs(a->squares - b->squares) <= EQUAL_SQUARES * b->squares);
}

/* Ranked and merged: orders ties of the first by a rule that rounding does not affect. */
static void order_equals(const mt_nlp_engine *e, mt_nlp_solution_pool *all)
{
    for (int first = 0, end = 0; first < all->count; first = end) {
        const mt_nlp_point *const best = all->at[first].p;
        for (end = first + 1; end < all->count && is_equal(all->at[end].p, best); end++) {
            for (int k = end; k > first && mt_is_nearer(e->n, e->origin, e->nlp->change_weight,
                                                        all->at[k].p->t, all->at[k - 1].p->t);
                 k--) {
                swap(all, k, k - 1);
            }
        }
    }
}

/* Drop infeasible ends where one is feasible, and those that are no local minima. Ranked. */
static void drop_useless(mt_nlp_solution_pool *all)
{
    const bool any = all->count > 0 && mt_nlp_feasible(all->at[0].p);
    bool stationary = false;
    for (int i = 0; i < all->count; i++) {
        const bool counts = any == mt_nlp_feasible(all->at[i].p);
        stationary = stationary || (counts && all->at[i].p->kkt <= MT_STATIONARY);
    }
    int kept = 0;
    for (int i = 0; i < all->count; i++) {
        mt_nlp_point *const p = all->at[i].p;
        const bool useless =
            any && (!mt_nlp_feasible(p) || (i > 0 && stationary && p->kkt > NOT_STATIONARY &&
                                            p->kkt < HUGE_VAL)); /* roots have no residual */
        if (!useless) {
            swap(all, kept++, i);
        }
    }
    all->count = kept;
}

/* Merge equal ends into the better one. Ranked. */
static void merge_equal_ends(const mt_nlp_engine *e, mt_nlp_solution_pool *all)
{
    const double same = nlp_same_distance(e);
    int kept = 0;
    for (int i = 0; i < all->count; i++) {
        int twin = -1;
        for (int k = 0; k < kept && twin < 0; k++) {
            twin = mt_nlp_distance(e, all->at[k].p, all->at[i].p) <= same ? k : -1;
        }
        if (twin < 0) {
            swap(all, kept++, i);
            continue;
        }
        mt_nlp_local *const one = &all->at[twin];
        const mt_nlp_local *const end = &all->at[i];
        one->merged = one->merged || mt_nlp_distance(e, one->p, end->p) > IDENTICAL;
        one->hits += end->hits;
        one->start = end->start < one->start ? end->start : one->start;
    }
    all->count = kept;
}

/*
 * Many designs may be equally far from the requirements (except where squares increase on all
 * sides): the one of least objective is wanted. With the constraints shifted to the values at
 * the compromise, that is a feasible problem.
 */
static void lower_objective_at_compromise(mt_nlp_engine *e, mt_nlp_point *p)
{
    const mt_nlp *const q = e->nlp;
    mt_arena *const mem = &e->scratch;
    mt_nlp_local s = mt_nlp_local_new(e, mem);
    double *const eq = mt_arena_f64(mem, (size_t)q->n_eq, 1);
    double *const in = mt_arena_f64(mem, (size_t)q->n_in, 1);
    if (!mt_nlp_has_room(e, mem)) {
        return;
    }
    mt_nlp_point *const to = s.p;
    memcpy(eq, p->eq, (size_t)q->n_eq * sizeof *eq);
    for (int i = 0; i < q->n_in; i++) {
        in[i] = fmin(p->in[i], 0);
    }
    e->eq_shift = eq;
    e->in_shift = in;
    mt_nlp_near_null_directions w;
    const bool minimised = mt_nlp_evaluate(e, p->t, true, to) &&
                           mt_nlp_near_null_directions_at(e, to, mem, &w) && w.curve &&
                           w.n_rows < e->n_free;
    if (minimised) {
        s.n_rows = w.n_rows;
        s.rows = w.rows;
        mt_nlp_minimise(e, &s);
    }
    e->eq_shift = NULL;
    e->in_shift = NULL;
    if (!minimised || !mt_nlp_evaluate(e, to->t, true, to)) {
        return;
    }
    if (!(to->f < p->f - SETTLED_GAIN * fabs(p->f))) {
        return;
    }
    mt_nlp_polish(e, MT_NLP_SQUARES, to, NULL); /* back from within the tolerances */
    if (to->squares <= p->squares * (1 + EQUAL_SQUARES)) {
        mt_nlp_point_copy(e, p, to);
    }
}

/* Variables within rounding of a mark (the original, a bound) are put on it: "0", not
 * "1.1e-08". */
static void put_on_marks(mt_nlp_engine *e, mt_nlp_point *p)
{
    const mt_nlp *const q = e->nlp;
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    mt_nlp_point *const to = mt_nlp_point_new(e, &e->scratch);
    bool moved = false;
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return;
    }
    mt_nlp_point_copy(e, to, p);
    for (int j = 0; j < e->n; j++) {
        const double marks[] = {e->origin[j], q->lower[j], q->upper[j]};
        for (int k = 0; k < MT_COUNT(marks); k++) {
            const double off = fabs(to->t[j] - marks[k]);
            if (off > 0.0 && off <= ON_MARK * (q->upper[j] - q->lower[j])) {
                to->t[j] = marks[k];
                moved = true;
            }
        }
    }
    if (moved && mt_nlp_evaluate(e, to->t, true, to) &&
        to->violation <= p->violation + STILL_MET &&
        (mt_nlp_feasible(to) || !mt_nlp_feasible(p))) {
        to->kkt = p->kkt;
        to->n_loose = p->n_loose;
        mt_nlp_point_copy(e, p, to);
    }
    mt_arena_rewind(&e->scratch, mark);
}

/* Variables of a compromise that no requirement feels have their original value exactly. */
static void put_idle_back(mt_nlp_engine *e, mt_nlp_point *p)
{
    const mt_nlp *const q = e->nlp;
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    mt_nlp_point *const to = mt_nlp_point_new(e, &e->scratch);
    double *const t = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
    for (int j = 0; j < e->n && mt_nlp_has_room(e, &e->scratch) && !e->ended; j++) {
        const double off = fabs(p->t[j] - e->origin[j]);
        if (off == 0.0 || off > NEARLY_ON_MARK * (q->upper[j] - q->lower[j])) {
            continue;
        }
        memcpy(t, p->t, (size_t)e->n * sizeof *t);
        t[j] = e->origin[j];
        if (mt_nlp_evaluate(e, t, true, to) && !mt_nlp_feasible(to) && to->f <= p->f &&
            to->squares <= p->squares * (1 + IDLE) &&
            to->violation <= p->violation * (1 + IDLE)) {
            to->kkt = p->kkt;
            to->n_loose = p->n_loose;
            mt_nlp_point_copy(e, p, to);
        }
    }
    mt_arena_rewind(&e->scratch, mark);
}

/* True for a double root; between two merged roots the Jacobian changes its sign. */
static bool is_singular(mt_nlp_engine *e, const mt_nlp_point *p, bool merged)
{
    const bool roots = e->nlp->n_eq >= e->n_free && e->n_free > 0;
    if (!mt_nlp_feasible(p) || e->ended || (merged && roots)) {
        return mt_nlp_feasible(p) && merged && roots;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    mt_nlp_near_null_directions w = {0};
    (void)mt_nlp_near_null_directions_at(e, p, &e->scratch, &w);
    mt_arena_rewind(&e->scratch, mark);
    return w.singular;
}

/* Undetermined directions of one variable, which stands at the origin for them. */
static int single_directions(const mt_nlp_engine *e, const mt_nlp_result *out)
{
    int n = 0;
    for (int k = 0; k < out->n_unidentifiable; k++) {
        const double *const d = out->unidentifiable + ((ptrdiff_t)k * e->n);
        n += mt_max_abs(e->n, d) == 1.0;
    }
    return n;
}

void mt_nlp_verify_kkt(mt_nlp_engine *e, mt_nlp_solution_pool *all, mt_arena *mem,
                       mt_nlp_result *out)
{
    rank_points(e, all);
    drop_useless(all);
    out->compromise = all->count > 0 && !mt_nlp_feasible(all->at[0].p);
    const bool unused = out->compromise && e->opt.no_compromise;
    if (all->count > 0 && !unused && all->at[0].p != all->directed &&
        !mt_nlp_unidentifiable(e, all->at[0].p, mem, out)) {
        return;
    }
    for (int i = 0; i < all->count && out->n_unidentifiable > 0; i++) {
        nlp_pull_back(e, out, all->at[i].p);
    }
    rank_points(e, all);
    merge_equal_ends(e, all);
    if (out->compromise && !unused && e->n_free > 0) {
        const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
        for (int i = 0; i < all->count && !e->ended; i++) {
            if (!all->at[i].p->isolated) {
                lower_objective_at_compromise(e, all->at[i].p);
            }
            mt_arena_rewind(&e->scratch, mark);
        }
        rank_points(e, all);
        merge_equal_ends(e, all);
        rank_equals(all);
    }
    if (!e->ended) {
        order_equals(e, all);
    }
    if (all->count > 0) {
        nlp_drop_roomless(e, all->at[0].p, out);
    }
    for (int i = 0; i < all->count && !e->ended; i++) {
        put_on_marks(e, all->at[i].p);
        if (out->compromise && !unused) {
            put_idle_back(e, all->at[i].p);
        }
    }
    count_roots(e, all, out);
    const int count = all->count < e->opt.max_solutions ? all->count : e->opt.max_solutions;
    out->solutions = mt_arena_alloc(mem, (size_t)count, sizeof *out->solutions);
    if (!mt_nlp_has_room(e, mem)) {
        return;
    }
    for (int i = 0; i < count && nlp_report(e, all->at[i].p, out, mem, &out->solutions[i]);
         i++) {
        out->solutions[i].singular = is_singular(e, all->at[i].p, all->at[i].merged);
        out->solutions[i].n_loose = all->at[i].p->n_loose;
        out->solutions[i].flat = all->at[i].p->n_loose > single_directions(e, out);
        out->solutions[i].start = all->at[i].start;
        out->solutions[i].hits = all->at[i].hits;
        out->n_solutions = i + 1;
    }
}
