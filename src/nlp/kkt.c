/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What holds a point in place. With g the gradient of the aim and C the gradients (rows) of the
 * equalities and active inequalities, on the free variables F,
 *
 *     g_F = C_F^T lambda + z_F,   z_F = 0 at a KKT point (Karush 1939, Kuhn and Tucker 1951),
 *
 * lambda by least squares from a pivoted QR of C_F^T with unit columns, so that its rank does
 * not depend on the scale of a constraint. lambda >= 0 on inequalities; the multipliers z of
 * the bounds are >= 0 at lower and <= 0 at upper ones. A candidate whose multiplier has the
 * wrong sign is not active: the worst is dropped, one at a time, until all are right.
 */
#include "nlp/kkt.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Candidates: within this distance (relative to the width) of a bound ... */
static const double BOUND_NEAR = 1e-8;
/* ... or an inequality of at most this value (or ten tolerances): SLSQP stops about so far
 * away. */
static const double IN_NEAR = 1e-6;
static const double IN_NEAR_TOLS = 10;
/* Rank of the unit columns: double precision halves its digits where the Jacobian turns
 * singular. */
static const double RANK_TOL = 1e-8;
/* Slopes that differ by less, relatively, are the same. */
static const double TWIN = 1e-9;
/* A wrong sign below this part of the gradient is rounding. */
static const double SIGN_TOL = 1e-9;
/* Gradients below this part of the largest one met are not told from zero by their
 * direction. */
static const double GRADIENT_FLOOR = 1e-3;

double mt_nlp_row_slope(const mt_nlp_engine *e, const mt_nlp_point *p, int i, int j)
{
    const mt_nlp *const q = e->nlp;
    const int in = i - q->n_eq;
    return in < 0         ? p->deq[i + (ptrdiff_t)j * q->n_eq]
           : in < q->n_in ? p->din[in + (ptrdiff_t)j * q->n_in]
                          : p->dnext[in - q->n_in + (ptrdiff_t)j * q->n_next];
}

double mt_nlp_row_value(const mt_nlp_engine *e, const mt_nlp_point *p, int i)
{
    const mt_nlp *const q = e->nlp;
    const int in = i - q->n_eq;
    return in < 0 ? p->eq[i] : in < q->n_in ? p->in[in] : p->next[in - q->n_in];
}

double mt_nlp_row_tol(const mt_nlp_engine *e, int i)
{
    const mt_nlp *const q = e->nlp;
    const int in = i - q->n_eq;
    return in < 0         ? q->eq_tol[i]
           : in < q->n_in ? q->in_tol[in]
                          : q->in_tol[q->next_of[in - q->n_in]];
}

/* True where a row among those before it has the same slopes. Of modes that stay together by
 * symmetry one is enough. */
static bool is_twin(const mt_nlp_engine *e, const mt_nlp_point *p, const mt_nlp_active *a,
                    int row)
{
    for (int i = 0; i < a->k; i++) {
        double apart = 0;
        double size = 0;
        for (int j = 0; j < e->n && a->row[i] >= e->nlp->n_eq; j++) {
            const double own = mt_nlp_row_slope(e, p, row, j);
            apart = fmax(apart, fabs(own - mt_nlp_row_slope(e, p, a->row[i], j)));
            size = fmax(size, fabs(own));
        }
        if (a->row[i] >= e->nlp->n_eq && apart <= TWIN * size) {
            return true;
        }
    }
    return false;
}

static void candidates(const mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_stage stage,
                       mt_nlp_active *a)
{
    const mt_nlp *const q = e->nlp;
    for (int j = 0; j < e->n; j++) {
        const double near = BOUND_NEAR * (q->upper[j] - q->lower[j]);
        if (!e->held[j]) {
            a->side[j] = p->t[j] <= q->lower[j] + near   ? -1
                         : p->t[j] >= q->upper[j] - near ? 1
                                                         : 0;
        }
    }
    for (int i = 0; i < q->n_eq && stage == MT_NLP_OBJECTIVE; i++) {
        a->row[a->k++] = i;
    }
    for (int i = q->n_eq; i < q->n_eq + q->n_in + q->n_next && stage == MT_NLP_OBJECTIVE; i++) {
        const double near = fmax(IN_NEAR, IN_NEAR_TOLS * mt_nlp_row_tol(e, i));
        if (mt_nlp_row_value(e, p, i) <= near &&
            (i < q->n_eq + q->n_in || !is_twin(e, p, a, i))) {
            a->row[a->k++] = i;
        }
    }
}

/* Free variables, scaled rows, their factors and the multipliers for the present candidates. */
static mt_status multipliers(mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_stage stage,
                             mt_arena *mem, mt_nlp_active *a)
{
    a->n_free = 0;
    for (int j = 0; j < e->n; j++) {
        if (!e->held[j] && a->side[j] == 0) {
            a->free[a->n_free++] = j;
        }
    }
    const int nf = a->n_free;
    double *const ct = mt_arena_f64(mem, (size_t)nf, (size_t)a->k);
    double *const gf = mt_arena_f64(mem, (size_t)nf, 1);
    MT_TRY(mt_arena_check(mem, e->err));
    for (int i = 0; i < a->k; i++) {
        double *const col = ct + (ptrdiff_t)i * nf;
        for (int j = 0; j < nf; j++) {
            col[j] = mt_nlp_row_slope(e, p, a->row[i], a->free[j]);
        }
        const double norm = mt_norm2(nf, col);
        a->scale[i] = norm > 0 ? norm : 1;
        for (int j = 0; j < nf; j++) {
            col[j] /= a->scale[i];
        }
        a->c[i] = mt_nlp_row_value(e, p, a->row[i]);
    }
    mt_nlp_gradient(e, p, stage, a->z);
    for (int j = 0; j < nf; j++) {
        gf[j] = a->z[a->free[j]];
    }
    MT_TRY(mt_qr_factor(nf, a->k, ct, nf > 0 ? nf : 1, RANK_TOL, mem, &a->qr, e->err));
    MT_TRY(mt_qr_solve(&a->qr, 1, gf, a->lambda, mem, e->err));
    for (int i = 0; i < a->k; i++) {
        a->lambda[i] /= a->scale[i];
        for (int j = 0; j < e->n; j++) {
            a->z[j] -= a->lambda[i] * mt_nlp_row_slope(e, p, a->row[i], j);
        }
    }
    return MT_OK;
}

/* Drop the candidate with the worst wrong sign; false where all are right. */
static bool drop_worst(const mt_nlp_engine *e, mt_nlp_active *a, double g_norm)
{
    double worst = -SIGN_TOL * g_norm;
    int row = -1;
    int bound = -1;
    for (int i = 0; i < a->k; i++) {
        if (a->row[i] >= e->nlp->n_eq && a->lambda[i] * a->scale[i] < worst) {
            worst = a->lambda[i] * a->scale[i];
            row = i;
        }
    }
    for (int j = 0; j < e->n; j++) {
        const double right = -a->side[j] * a->z[j]; /* >= 0 where the bound holds the point */
        if (a->side[j] != 0 && right < worst) {
            worst = right;
            bound = j;
        }
    }
    if (bound >= 0) { /* it was worse than any row */
        a->side[bound] = 0;
        return true;
    }
    if (row < 0) {
        return false;
    }
    memmove(a->row + row, a->row + row + 1, (size_t)(a->k - row - 1) * sizeof *a->row);
    a->k--;
    return true;
}

static double relative_kkt(const mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_stage stage,
                           const mt_nlp_active *a, double g_norm)
{
    double z = 0;
    for (int j = 0; j < a->n_free; j++) {
        z += a->z[a->free[j]] * a->z[a->free[j]];
    }
    double scale = fmax(g_norm, GRADIENT_FLOOR * e->df_scale);
    for (int i = 0; i < a->k; i++) {
        scale = fmax(scale, fabs(a->lambda[i]) * a->scale[i]);
    }
    if (stage ==
        MT_NLP_SQUARES) { /* its gradient is J^T c: small against |J| |c|, not itself */
        const ptrdiff_t n = e->n;
        scale =
            fmax(mt_max_abs(e->nlp->n_eq * n, p->deq), mt_max_abs(e->nlp->n_in * n, p->din)) *
            sqrt(p->squares);
    }
    return scale > 0 ? sqrt(z) / scale : 0;
}

/* |gradient of the stage's function| over the variables that are not held; g[n] is work. */
static double gradient_norm(const mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_stage stage,
                            double *g)
{
    double sum = 0;
    mt_nlp_gradient(e, p, stage, g);
    for (int j = 0; j < e->n; j++) {
        sum += e->held[j] ? 0 : g[j] * g[j];
    }
    return sqrt(sum);
}

bool mt_nlp_active_set(mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_stage stage,
                       mt_arena *mem, mt_nlp_active *a)
{
    const size_t n = (size_t)e->n;
    const size_t k = (size_t)e->nlp->n_eq + (size_t)e->nlp->n_in + (size_t)e->nlp->n_next;
    *a = (mt_nlp_active){.free = mt_arena_int(mem, n),
                         .side = mt_arena_int(mem, n),
                         .row = mt_arena_int(mem, k),
                         .scale = mt_arena_f64(mem, k, 1),
                         .lambda = mt_arena_f64(mem, k, 1),
                         .c = mt_arena_f64(mem, k, 1),
                         .z = mt_arena_f64(mem, n, 1)};
    if (!mt_nlp_has_room(e, mem)) {
        return false;
    }
    candidates(e, p, stage, a);
    const double g_norm = gradient_norm(e, p, stage, a->z);
    for (;;) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        if (!mt_nlp_ok(e, multipliers(e, p, stage, mem, a))) {
            return false;
        }
        if (!drop_worst(e, a, g_norm)) {
            break;
        }
        mt_arena_rewind(mem, mark);
    }
    a->kkt = relative_kkt(e, p, stage, a, g_norm);
    return true;
}
