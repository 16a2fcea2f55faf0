/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Derivatives of the reduced matrices, a dash being the derivative that tangent.c fills. The
 * basis of the freedoms moves too: A Z = 0 gives, with the choice that Z' has no part along Z,
 *     Z' = -A^+ A' Z,        K_r' y = Z^T (K' phi + K z') + Z'^T K phi,    phi = Z y,
 *         z' = Z' y = -A^+ A' phi,
 * and Z'^T w = -Z^T A'^T (A^+)^T w, where (A^+)^T w are the multipliers that balance w. Only
 * products with vectors are formed. Any other choice of Z' changes y' but no physical result
 * (phi' = Z y' + Z' y).
 */
#include "mechanics/products.h"

#include "mechanics/linear_priv.h"

#include <string.h>

#include "mechanics/tangent.h"

/* f . phi for a row given over local freedoms. */
static double row_dot(const mt_system *sys, const mt_term *t, const double *row,
                      const double *phi)
{
    double s = 0.0;
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(sys, t->body, k);
        s += dof >= 0 ? row[k] * phi[dof] : 0.0;
    }
    return s;
}

static void row_axpy(const mt_system *sys, const mt_term *t, double alpha, const double *row,
                     double *out)
{
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(sys, t->body, k);
        if (dof >= 0) {
            out[dof] += alpha * row[k];
        }
    }
}

/* A row that the joints block, r = Z^T f = 0, has no part in a derivative: (r r^T)' = r' r^T +
 * r r'^T = 0. */
static bool is_blocked(const mt_linear *lin, int kind, int row, const mt_term *t)
{
    return lin->blocked[kind][row] && !t->pair;
}

/* out += K phi (kind STIFFNESS) or M phi (MASS), full coordinates, without the geometric
 * part. */
static void full_product(const mt_linear *lin, int kind, const double *phi, double *out)
{
    const mt_term_list *const list = &lin->list[kind];
    for (int i = 0; i < list->n_rows; i++) {
        const mt_term *const t = &list->terms[list->row_term[i]];
        if (is_blocked(lin, kind, i, t)) {
            continue;
        }
        const int other = t->pair ? (2 * t->first) + 1 - i : i; /* the partner of a pair */
        const double c = lin->value[t->coefficient] * (t->pair ? 0.5 : 1.0);
        const double s =
            row_dot(lin->sys, t, lin->rows[kind] + ((ptrdiff_t)other * MT_LOCAL), phi);
        row_axpy(lin->sys, t, c * s, lin->rows[kind] + ((ptrdiff_t)i * MT_LOCAL), out);
    }
}

/* out += K' phi at fixed phi. */
static void full_product_derivative(const mt_linear *lin, int kind, int p, const double *phi,
                                    double *out)
{
    const mt_term_list *const list = &lin->list[kind];
    const mt_linear_tangent *const tangent = &lin->tangent[p];
    for (int i = 0; i < list->n_rows; i++) {
        const mt_term *const t = &list->terms[list->row_term[i]];
        if (is_blocked(lin, kind, i, t)) {
            continue;
        }
        const int other = t->pair ? (2 * t->first) + 1 - i : i;
        const double half = t->pair ? 0.5 : 1.0;
        const double c = lin->value[t->coefficient] * half;
        const double dc =
            lin->grad[((ptrdiff_t)t->coefficient * lin->sys->n_inputs) + p] * half;
        if (dc == 0.0 && tangent->still[kind][i] && tangent->still[kind][other]) {
            continue;
        }
        const double *const row = lin->rows[kind] + ((ptrdiff_t)i * MT_LOCAL);
        const double *const row_o = lin->rows[kind] + ((ptrdiff_t)other * MT_LOCAL);
        const double s = row_dot(lin->sys, t, row_o, phi);
        const double ds =
            row_dot(lin->sys, t, tangent->rows[kind] + ((ptrdiff_t)other * MT_LOCAL), phi);
        row_axpy(lin->sys, t, (dc * s) + (c * ds), row, out);
        row_axpy(lin->sys, t, c * s, tangent->rows[kind] + ((ptrdiff_t)i * MT_LOCAL), out);
    }
}

/* Fixed geometry: the sum over terms whose coefficient depends on p, in reduced coordinates.
 * Returns whether any does. */
static bool coefficient_products(const mt_linear *lin, int kind, int p, int cols,
                                 const double *y, double *out)
{
    const mt_term_list *const list = &lin->list[kind];
    const int n = lin->n;
    bool any = false;
    memset(out, 0, (size_t)n * (size_t)cols * sizeof *out);
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        if (!t->varies) {
            continue;
        }
        const double dc = lin->grad[((ptrdiff_t)t->coefficient * lin->sys->n_inputs) + p];
        if (dc == 0.0) {
            continue;
        }
        any = true;
        for (int r = 0; r < t->count; r++) {
            const int other = t->pair ? t->first + 1 - r : t->first + r;
            const double *const a = lin->reduced[kind] + ((ptrdiff_t)(t->first + r) * n);
            const double *const b = lin->reduced[kind] + ((ptrdiff_t)other * n);
            for (int c = 0; c < cols; c++) {
                const double s =
                    dc * (t->pair ? 0.5 : 1.0) * mt_dot(n, b, y + ((ptrdiff_t)c * n));
                mt_axpy(n, s, a, out + ((ptrdiff_t)c * n));
            }
        }
    }
    return any;
}

typedef struct moving {
    double *phi;
    double *z; /* Z' y */
    double *kphi;
    double *w;
    double *lambda;
    double *b;
} moving;

static mt_status moving_init(moving *v, const mt_linear *lin, mt_arena *scratch, mt_err *err)
{
    const size_t nq = (size_t)lin->sys->nq;
    v->phi = mt_arena_f64(scratch, nq, 1);
    v->z = mt_arena_f64(scratch, nq, 1);
    v->kphi = mt_arena_f64(scratch, nq, 1);
    v->w = mt_arena_f64(scratch, nq, 1);
    v->lambda = mt_arena_f64(scratch, (size_t)lin->m, 1);
    v->b = mt_arena_f64(scratch, (size_t)lin->m, 1);
    return mt_arena_check(scratch, err);
}

/* phi = Z y, z = Z' y. */
static mt_status moving_shape(mt_linear *lin, const mt_linear_tangent *t, const double *y,
                              moving *v, mt_err *err)
{
    mt_eliminate_expand(&lin->e, y, v->phi);
    mt_gemv(false, lin->m, lin->sys->nq, -1.0, t->a, lin->m, v->phi, 0.0, v->b);
    return mt_eliminate_particular(&lin->e, v->b, v->z, &lin->scratch, err);
}

static mt_status moving_product(mt_linear *lin, int kind, int p, moving *v, double *out,
                                mt_err *err)
{
    const int nq = lin->sys->nq;
    const mt_linear_tangent *const t = &lin->tangent[p];
    const bool geometric = kind == MT_TERM_STIFFNESS && lin->kg != NULL;
    memset(v->w, 0, (size_t)nq * sizeof *v->w);
    full_product_derivative(lin, kind, p, v->phi, v->w);
    if (geometric) {
        mt_gemv(false, nq, nq, 1.0, t->kg, nq, v->phi, 1.0, v->w);
    }
    if (lin->m > 0) { /* without constraints the basis stands still */
        memset(v->kphi, 0, (size_t)nq * sizeof *v->kphi);
        full_product(lin, kind, v->phi, v->kphi);
        full_product(lin, kind, v->z, v->w);
        if (geometric) {
            mt_gemv(false, nq, nq, 1.0, lin->kg, nq, v->phi, 1.0, v->kphi);
            mt_gemv(false, nq, nq, 1.0, lin->kg, nq, v->z, 1.0, v->w);
        }
        MT_TRY(mt_eliminate_multipliers(&lin->e, v->kphi, v->lambda, &lin->scratch, err));
        mt_gemv(true, lin->m, nq, -1.0, t->a, lin->m, v->lambda, 1.0, v->w);
    }
    mt_eliminate_project(&lin->e, v->w, out);
    return MT_OK;
}

mt_status mt_linear_products(mt_linear *lin, int p, int cols, const double *y, double *dky,
                             double *dmy, bool *dm_zero, mt_err *err)
{
    if (lin->tangent == NULL || !lin->tangent[p].moves) {
        (void)coefficient_products(lin, MT_TERM_STIFFNESS, p, cols, y, dky);
        const bool any = coefficient_products(lin, MT_TERM_MASS, p, cols, y, dmy);
        if (dm_zero != NULL) {
            *dm_zero = !any;
        }
        return MT_OK;
    }
    moving v;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    MT_TRY(moving_init(&v, lin, &lin->scratch, err));
    for (int c = 0; c < cols; c++) {
        const ptrdiff_t at = (ptrdiff_t)c * lin->n;
        MT_TRY(moving_shape(lin, &lin->tangent[p], y + at, &v, err));
        MT_TRY(moving_product(lin, MT_TERM_STIFFNESS, p, &v, dky + at, err));
        MT_TRY(moving_product(lin, MT_TERM_MASS, p, &v, dmy + at, err));
    }
    mt_arena_rewind(&lin->scratch, mark);
    if (dm_zero != NULL) {
        *dm_zero = false;
    }
    return MT_OK;
}

mt_status mt_linear_sense(mt_linear *lin, int ns, const int *channel, int cols, const double *y,
                          double *s, mt_err *err)
{
    const mt_term_list *const list = &lin->list[MT_TERM_CHANNEL];
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const phi = mt_arena_f64(&lin->scratch, (size_t)lin->sys->nq, 1);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    for (int c = 0; c < cols; c++) {
        mt_eliminate_expand(&lin->e, y + ((ptrdiff_t)c * lin->n), phi);
        for (int i = 0; i < ns; i++) {
            const mt_term *const t = &list->terms[channel[i]];
            const double *const row =
                lin->rows[MT_TERM_CHANNEL] + ((ptrdiff_t)t->first * MT_LOCAL);
            const bool still = lin->blocked[MT_TERM_CHANNEL][t->first];
            s[i + ((ptrdiff_t)c * ns)] = still ? 0.0 : row_dot(lin->sys, t, row, phi);
        }
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

/* Shapes and their derivative, both as mt_linear_sense takes them. */
/* NOLINTNEXTLINE(readability-function-size) */
mt_status mt_linear_sense_derivative(mt_linear *lin, int p, int ns, const int *channel,
                                     int cols, const double *y, const double *dy, double *ds,
                                     mt_err *err)
{
    if (lin->tangent == NULL || !lin->tangent[p].moves) {
        return mt_linear_sense(lin, ns, channel, cols, dy, ds, err);
    }
    const mt_term_list *const list = &lin->list[MT_TERM_CHANNEL];
    const mt_linear_tangent *const tangent = &lin->tangent[p];
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    moving v;
    MT_TRY(moving_init(&v, lin, &lin->scratch, err));
    for (int c = 0; c < cols; c++) {
        MT_TRY(moving_shape(lin, tangent, y + ((ptrdiff_t)c * lin->n), &v, err));
        mt_gemv(false, lin->sys->nq, lin->n, 1.0, lin->e.z, lin->sys->nq,
                dy + ((ptrdiff_t)c * lin->n), 1.0, v.z); /* phi' */
        for (int i = 0; i < ns; i++) {
            const mt_term *const t = &list->terms[channel[i]];
            const ptrdiff_t at = (ptrdiff_t)t->first * MT_LOCAL;
            ds[i + ((ptrdiff_t)c * ns)] =
                row_dot(lin->sys, t, tangent->rows[MT_TERM_CHANNEL] + at, v.phi) +
                row_dot(lin->sys, t, lin->rows[MT_TERM_CHANNEL] + at, v.z);
        }
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

mt_status mt_linear_mass_product(mt_linear *lin, const double *y, double *w, mt_err *err)
{
    const size_t nq = (size_t)lin->sys->nq;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const phi = mt_arena_f64(&lin->scratch, nq, 1);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    mt_linear_expand(lin, 1, y, phi);
    memset(w, 0, nq * sizeof *w);
    full_product(lin, MT_TERM_MASS, phi, w);
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}
