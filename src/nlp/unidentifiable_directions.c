/* SPDX-License-Identifier: GPL-3.0-or-later */
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
#include "nlp/unidentifiable_directions.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/number.h"
#include "nlp/kkt.h"
#include "nlp/lsq.h"
#include "nlp/polish.h"

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
/* KKT residuals below this belong to a local solution (as in the search). */
static const double STATIONARY = 1e-6;

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

void mt_nlp_drop_roomless(const mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_result *out)
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
    const bool stationary = after->kkt <= fmax(before->kkt, STATIONARY);
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

void mt_nlp_pull_back(mt_nlp_engine *e, const mt_nlp_result *unidentifiable, mt_nlp_point *p)
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
