/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Whether a solution is a double root, or a point on a curve of solutions. Both have weak
 * directions v, |C v| <= sqrt(tolerance) in every active constraint C t = 0: a step of
 * sqrt(tolerance) along v is not seen. More of them than there are variables without a
 * constraint decide nothing yet: step h = 10 sqrt(tolerance) along v and go back to the
 * constraints (least squares, steps of least norm).
 *
 *     stays away:                     a curve of solutions
 *     returns, and |C v| grew with h: a double root (the constraints are quadratic along v)
 *     returns, and |C v| as before:   a simple root, weakly determined
 */
#include "nlp/near_null_directions.h"

#include <math.h>
#include <string.h>

#include "nlp/kkt.h"
#include "nlp/lsq.h"

enum { PROBES_MOST = 8 };
static const double PROBE_STEPS = 10;  /* h in units of sqrt(tolerance), a mark well above it */
static const double PROBE_MOST = 0.05; /* and at most this (t is a logarithm: 5 percent) */
static const double GROWTH = 3;        /* of |C v| along v that means quadratic */
/* gradients of two equalities are one below this angle */
static const double ROWS_RANK_TOL = 1e-6;

/* max over the active rows of |C_i v| / sqrt(tol_i) at p. */
static double slope_along(const mt_nlp_engine *e, const mt_nlp_point *p, const mt_nlp_active *a,
                          const double *v)
{
    double most = 0;
    for (int i = 0; i < a->k; i++) {
        double s = 0;
        for (int j = 0; j < a->n_free; j++) {
            s += mt_nlp_row_slope(e, p, a->row[i], a->free[j]) * v[j];
        }
        most = fmax(most, fabs(s) / sqrt(mt_nlp_row_tol(e, a->row[i])));
    }
    return most;
}

/* All right singular vectors of the active rows (row j of vt, nf x nf, by descending value). */
static double *right_vectors(mt_nlp_engine *e, const mt_nlp_point *p, const mt_nlp_active *a,
                             mt_arena *mem)
{
    const int nf = a->n_free;
    const int m = a->k > nf ? a->k : nf; /* padded with zero rows, so that vt is complete */
    double *const c = mt_arena_f64(mem, (size_t)m, (size_t)nf);
    double *const s = mt_arena_f64(mem, (size_t)nf, 1);
    double *const u = mt_arena_f64(mem, (size_t)m, (size_t)nf);
    double *const vt = mt_arena_f64(mem, (size_t)nf, (size_t)nf);
    if (!mt_nlp_has_room(e, mem)) {
        return NULL;
    }
    for (int j = 0; j < nf; j++) {
        for (int i = 0; i < a->k; i++) {
            c[i + (ptrdiff_t)j * m] = mt_nlp_row_slope(e, p, a->row[i], a->free[j]) /
                                      sqrt(mt_nlp_row_tol(e, a->row[i]));
        }
    }
    return mt_nlp_ok(e, mt_svd(m, nf, c, s, u, vt, mem, e->err)) ? vt : NULL;
}

/* Steps along v and returns to the constraints. */
static void probe(mt_nlp_engine *e, const mt_nlp_point *p, const mt_nlp_active *a, double *v,
                  mt_nlp_near_null_directions *w)
{
    double tol = 0;
    for (int i = 0; i < a->k; i++) {
        tol = fmax(tol, mt_nlp_row_tol(e, a->row[i]));
    }
    const double h = fmin(PROBE_STEPS * sqrt(tol), PROBE_MOST);
    mt_nlp_point *const x = mt_nlp_point_new(e, &e->scratch);
    double *const t = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return;
    }
    const double before = slope_along(e, p, a, v);
    memcpy(t, p->t, (size_t)e->n * sizeof *t);
    double moved = 0;
    for (int sign = 1; sign >= -1 && moved < 0.5 * h; sign -= 2) { /* away from the bounds */
        moved = 0;
        for (int i = 0; i < a->n_free; i++) {
            const int j = a->free[i];
            t[j] = mt_nlp_clamp(e->nlp, j, p->t[j] + sign * h * v[i]);
            moved += (t[j] - p->t[j]) * (t[j] - p->t[j]);
        }
        moved = sqrt(moved);
    }
    if (!mt_nlp_evaluate(e, t, true, x)) {
        return;
    }
    const bool quadratic = slope_along(e, x, a, v) > GROWTH * before;
    mt_nlp_least_squares(e, MT_NLP_SQUARES, x);
    double away = 0;
    for (int j = 0; j < e->n; j++) {
        away += (x->t[j] - p->t[j]) * (x->t[j] - p->t[j]);
    }
    const bool stays = sqrt(away) > 0.5 * moved;
    w->curve = w->curve || (stays && mt_nlp_feasible(x));
    w->singular = w->singular || (!stays && quadratic);
}

/* Independent equalities, by pivoted QR of their gradients (unit length) on the variables not
 * held. */
static mt_status independent_rows(mt_nlp_engine *e, const mt_nlp_point *p, mt_arena *mem,
                                  mt_nlp_near_null_directions *w)
{
    const int n_eq = e->nlp->n_eq;
    double *const ct = mt_arena_f64(mem, (size_t)e->n, (size_t)n_eq);
    bool *const kept = mt_arena_alloc(mem, (size_t)n_eq, sizeof *kept);
    w->rows = mt_arena_int(mem, (size_t)n_eq);
    MT_TRY(mt_arena_check(mem, e->err));
    for (int i = 0; i < n_eq; i++) {
        double *const col = ct + (ptrdiff_t)i * e->n;
        for (int j = 0; j < e->n; j++) {
            col[j] = e->held[j] ? 0 : mt_nlp_row_slope(e, p, i, j);
        }
        const double norm = mt_norm2(e->n, col);
        for (int j = 0; j < e->n && norm > 0; j++) {
            col[j] /= norm;
        }
    }
    mt_qr qr;
    MT_TRY(mt_qr_factor(e->n, n_eq, ct, e->n, ROWS_RANK_TOL, mem, &qr, e->err));
    for (int i = 0; i < qr.rank; i++) {
        kept[qr.perm[i]] = true;
    }
    for (int i = 0; i < n_eq; i++) {
        if (kept[i]) {
            w->rows[w->n_rows++] = i;
        }
    }
    return MT_OK;
}

bool mt_nlp_near_null_directions_at(mt_nlp_engine *e, const mt_nlp_point *p, mt_arena *mem,
                                    mt_nlp_near_null_directions *w)
{
    *w = (mt_nlp_near_null_directions){0};
    mt_nlp_active a;
    if ((e->n > 0 && !mt_nlp_ok(e, independent_rows(e, p, mem, w))) ||
        !mt_nlp_active_set(e, p, MT_NLP_OBJECTIVE, &e->scratch, &a)) {
        return false;
    }
    if (a.k == 0 || a.n_free == 0) {
        w->curve = a.n_free > 0;
        return true;
    }
    double *const vt = right_vectors(e, p, &a, &e->scratch);
    double *const v = mt_arena_f64(&e->scratch, (size_t)a.n_free, (size_t)a.n_free);
    if (vt == NULL || !mt_nlp_has_room(e, &e->scratch)) {
        return false;
    }
    int weak = 0;
    for (int d = a.n_free - 1; d >= 0; d--) { /* weakest first */
        double *const vd = v + (ptrdiff_t)weak * a.n_free;
        for (int j = 0; j < a.n_free; j++) {
            vd[j] = vt[d + (ptrdiff_t)j * a.n_free];
        }
        weak += slope_along(e, p, &a, vd) <= 1;
    }
    const int expected = a.n_free > a.k ? a.n_free - a.k : 0;
    w->curve = expected > 0;
    for (int d = 0; d < weak && d < PROBES_MOST && weak > expected && !e->ended; d++) {
        probe(e, p, &a, v + (ptrdiff_t)d * a.n_free, w);
    }
    return true;
}
