/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Reduced rows r = Z^T f, and which of their entries are nothing but rounding.
 *
 * A spring that acts against what the joints block has r = 0: its row is a combination of the constraints, f = A^T mu, where mu are the reactions to a unit of its force. What
 * is computed instead is rounding, and no size of r by itself can tell: a short r may be a real, small lever. The error is known, though. To first order a perturbation dA of
 * the constraints turns the basis by dZ = -A^+ dA Z, so that
 *     dr = df^T Z - mu^T dA Z,       |dr_c| <= delta |z_c| (|f| + sum_i |mu_i| |a_i|),
 * delta being the relative rounding of rows and constraints, all lengths taken in the coordinates of the elimination (rotations as arcs at the model length). An entry below that is
 * exactly 0: it is the row's length before the projection, with what the joints carry of it, that an entry is judged against.
 */
#include "mechanics/reduce.h"

#include <float.h>
#include <math.h>

/* delta = ROW_ULPS nq eps (extent / model length): products, sums and the factorisation leave a few eps each; coordinates far from the origin lose that many digits in every arm. */
static const double ROW_ULPS = 16.0;

static double rounding_of_rows(const mt_linear *lin)
{
    const mt_system *const sys = lin->sys;
    double extent = sys->length_m;
    for (int b = 0; b < sys->n_bodies; b++) {
        for (int k = 0; k < 3; k++) {
            extent = fmax(extent, fabs(creal(lin->position.pose[b].x[k])));
        }
    }
    return ROW_ULPS * (double)sys->nq * DBL_EPSILON * extent / sys->length_m;
}

/* |z_c| of all columns in scaled coordinates. */
static void column_lengths(const mt_elimination *e, double *length)
{
    for (int c = 0; c < e->n; c++) {
        const double *const z = e->z + ((ptrdiff_t)c * e->nq);
        double sum = 0.0;
        for (int j = 0; j < e->nq; j++) {
            const double x = z[j] / e->dc[j];
            sum += x * x;
        }
        length[c] = sqrt(sum);
    }
}

/* sum_i |mu_i| |a_i|, mu the reactions to the row f [nq]. Equilibrated constraints have length 1. */
static mt_status reactions(mt_linear *lin, const double *f, double *sum, mt_err *err)
{
    const mt_elimination *const e = &lin->e;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const mu = mt_arena_f64(&lin->scratch, (size_t)e->m, 1);
    if (mu == NULL) {
        return mt_fail_memory(err);
    }
    MT_TRY(mt_eliminate_multipliers(e, f, mu, &lin->scratch, err));
    *sum = 0.0;
    for (int i = 0; i < e->m; i++) {
        *sum += fabs(mu[i]) / e->dr[i];
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

/* Reactions are asked for where what the joints leave of a row is below this part of it: elsewhere they are of its size, and delta has room for that. Of springs the error itself is
 * wanted; of the others, which are many, only whether anything is left. */
static const double SMALL_PART = 0.03;
static const double NEXT_TO_NOTHING = 1e-6;

typedef struct reducer {
    mt_linear *lin;
    double delta;
    double *length; /* [n] of columns */
    double *full;   /* [nq] one row */
} reducer;

/* out[n] = Z^T full, what is rounding made 0; *blocked: all of it. noise (may be NULL): bounds of the entries' errors. */
static mt_status reduce_row(const reducer *r, double *out, double *noise, bool *blocked,
                            mt_err *err)
{
    const mt_elimination *const e = &r->lin->e;
    double own = 0.0; /* |f| */
    double part = 0.0;
    double reaction = 0.0;
    for (int j = 0; j < e->nq; j++) {
        own = hypot(own, r->full[j] * e->dc[j]);
    }
    for (int c = 0; c < e->n; c++) {
        part = hypot(part, out[c] / r->length[c]);
    }
    if (part > 0.0 && part < (noise != NULL ? SMALL_PART : NEXT_TO_NOTHING) * own) {
        MT_TRY(reactions(r->lin, r->full, &reaction, err));
    }
    *blocked = true;
    for (int c = 0; c < e->n; c++) {
        const double error = out[c] == 0.0 ? 0.0 : r->delta * r->length[c] * (own + reaction);
        out[c] = fabs(out[c]) <= error ? 0.0 : out[c];
        *blocked = *blocked && out[c] == 0.0;
        if (noise != NULL) {
            noise[c] = error;
        }
    }
    return MT_OK;
}

static mt_status reduce_rows(const reducer *r, int kind, mt_err *err)
{
    mt_linear *const lin = r->lin;
    const mt_term_list *const list = &lin->list[kind];
    const ptrdiff_t nq = lin->sys->nq;
    lin->reduced[kind] = mt_arena_f64(&lin->geometry, (size_t)lin->n, (size_t)list->n_rows);
    double *const noise =
        kind == MT_TERM_STIFFNESS
            ? mt_arena_f64(&lin->geometry, (size_t)lin->n, (size_t)list->n_rows)
            : NULL;
    lin->noise = noise != NULL ? noise : lin->noise;
    lin->blocked[kind] =
        mt_arena_alloc(&lin->geometry, (size_t)list->n_rows, sizeof *lin->blocked[kind]);
    if (lin->reduced[kind] == NULL || lin->blocked[kind] == NULL ||
        (kind == MT_TERM_STIFFNESS && noise == NULL)) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < list->n_rows; i++) {
        const mt_term *const t = &list->terms[list->row_term[i]];
        const double *const row = lin->rows[kind] + ((ptrdiff_t)i * MT_LOCAL);
        double *const out = lin->reduced[kind] + ((ptrdiff_t)i * lin->n);
        for (int k = 0; k < MT_LOCAL; k++) {
            const int dof = mt_local_dof(lin->sys, t->body, k);
            if (dof < 0 || row[k] == 0.0) {
                continue;
            }
            r->full[dof] += row[k];
            for (int c = 0; c < lin->n; c++) {
                out[c] += row[k] * lin->e.z[dof + (c * nq)];
            }
        }
        MT_TRY(reduce_row(r, out, noise != NULL ? noise + ((ptrdiff_t)i * lin->n) : NULL,
                          &lin->blocked[kind][i], err));
        for (int k = 0; k < MT_LOCAL; k++) {
            const int dof = mt_local_dof(lin->sys, t->body, k);
            if (dof >= 0) {
                r->full[dof] = 0.0;
            }
        }
    }
    return MT_OK;
}

mt_status mt_reduce_rows(mt_linear *lin, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    reducer r = {.lin = lin, .delta = rounding_of_rows(lin)};
    r.length = mt_arena_f64(&lin->scratch, (size_t)lin->n, 1);
    r.full = mt_arena_f64(&lin->scratch, (size_t)lin->sys->nq, 1);
    if (r.length == NULL || r.full == NULL) {
        return mt_fail_memory(err);
    }
    column_lengths(&lin->e, r.length);
    for (int kind = 0; kind < MT_TERM_KINDS; kind++) {
        MT_TRY(reduce_rows(&r, kind, err));
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}
