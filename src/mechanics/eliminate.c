/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/eliminate.h"

#include <math.h>

/* Relative size below which a diagonal entry of R counts as zero: rounding leaves about nq eps
 * ~ 1e-14, real mechanisms next to a singular position 1e-6 and more; the gap is reported
 * (qr.kept, qr.dropped). */
static const double RANK_TOLERANCE = 1e-9;

mt_status mt_eliminate_factor(const mt_system *sys, int m, const double *a, mt_arena *mem,
                              mt_elimination *out, mt_err *err)
{
    const int nq = sys->nq;
    double *const at = mt_arena_f64(mem, (size_t)nq, (size_t)m);
    *out = (mt_elimination){.m = m, .nq = nq};
    out->dr = mt_arena_f64(mem, (size_t)m, 1);
    out->dc = mt_arena_f64(mem, (size_t)nq, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int b = 0; b < sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            if (sys->bodies[b].dof[k] >= 0) {
                out->dc[sys->bodies[b].dof[k]] = k < 3 ? 1.0 : 1.0 / sys->length_m;
            }
        }
    }
    for (int i = 0; i < m; i++) {
        double *const row = at + ((ptrdiff_t)i * nq);
        for (int j = 0; j < nq; j++) {
            row[j] = a[i + ((ptrdiff_t)j * m)] * out->dc[j];
        }
        const double norm = mt_norm2(nq, row);
        out->dr[i] = norm > 0.0 ? 1.0 / norm : 1.0;
        for (int j = 0; j < nq; j++) {
            row[j] *= out->dr[i];
        }
    }
    MT_TRY(mt_qr_factor(nq, m, at, nq, RANK_TOLERANCE, mem, &out->qr, err));
    out->n = nq - out->qr.rank;
    return MT_OK;
}

mt_status mt_eliminate_basis(mt_elimination *e, mt_arena *scratch, mt_err *err)
{
    MT_TRY(mt_qr_q(&e->qr, e->qr.rank, e->z, scratch, err));
    for (int c = 0; c < e->n; c++) {
        for (int j = 0; j < e->nq; j++) {
            e->z[j + ((ptrdiff_t)c * e->nq)] *= e->dc[j];
        }
    }
    return MT_OK;
}

mt_status mt_eliminate(const mt_system *sys, int m, const double *a, mt_arena *mem,
                       mt_elimination *out, mt_err *err)
{
    MT_TRY(mt_eliminate_factor(sys, m, a, mem, out, err));
    out->z = mt_arena_f64(mem, (size_t)out->nq, (size_t)out->n);
    MT_TRY(mt_arena_check(mem, err));
    return mt_eliminate_basis(out, mem, err);
}

mt_status mt_eliminate_particular(const mt_elimination *e, const double *b, double *v,
                                  mt_arena *scratch, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const scaled = mt_arena_f64(scratch, (size_t)e->m, 1);
    MT_TRY(mt_arena_check(scratch, err));
    for (int i = 0; i < e->m; i++) {
        scaled[i] = e->dr[i] * b[i];
    }
    MT_TRY(mt_qr_solve_transposed(&e->qr, 1, scaled, v, scratch, err));
    for (int j = 0; j < e->nq; j++) {
        v[j] *= e->dc[j];
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

mt_status mt_eliminate_multipliers(const mt_elimination *e, const double *g, double *lambda,
                                   mt_arena *scratch, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const scaled = mt_arena_f64(scratch, (size_t)e->nq, 1);
    MT_TRY(mt_arena_check(scratch, err));
    for (int j = 0; j < e->nq; j++) {
        scaled[j] = e->dc[j] * g[j];
    }
    MT_TRY(mt_qr_solve(&e->qr, 1, scaled, lambda, scratch, err));
    for (int i = 0; i < e->m; i++) {
        lambda[i] *= e->dr[i];
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

void mt_eliminate_project(const mt_elimination *e, const double *g, double *out)
{
    mt_gemv(true, e->nq, e->n, 1.0, e->z, e->nq, g, 0.0, out);
}

void mt_eliminate_expand(const mt_elimination *e, const double *y, double *out)
{
    mt_gemv(false, e->nq, e->n, 1.0, e->z, e->nq, y, 0.0, out);
}

/* Column rank + k of A_s^T P is a combination of the first rank columns: R11 x = R12(:, k), so
 * (x, -1) is the null vector. */
mt_status mt_eliminate_left_null(const mt_elimination *e, int k, double *w, mt_arena *scratch,
                                 mt_err *err)
{
    return mt_eliminate_left_vector(e, e->qr.rank, k, w, scratch, err);
}

mt_status mt_eliminate_left_vector(const mt_elimination *e, int rank, int k, double *w,
                                   mt_arena *scratch, mt_err *err)
{
    const double *const r = e->qr.qr;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const x = mt_arena_f64(scratch, (size_t)rank, 1);
    MT_TRY(mt_arena_check(scratch, err));
    for (int i = rank - 1; i >= 0; i--) {
        double s = r[i + ((ptrdiff_t)(rank + k) * e->nq)];
        for (int j = i + 1; j < rank; j++) {
            s -= r[i + ((ptrdiff_t)j * e->nq)] * x[j];
        }
        x[i] = s / r[i + ((ptrdiff_t)i * e->nq)];
    }
    double largest = 1.0;
    for (int i = 0; i < e->m; i++) {
        w[i] = 0.0;
    }
    for (int i = 0; i < rank; i++) {
        w[e->qr.perm[i]] = x[i];
        largest = fmax(largest, fabs(x[i]));
    }
    w[e->qr.perm[rank + k]] = -1.0;
    for (int i = 0; i < e->m; i++) {
        w[i] /= largest;
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}
