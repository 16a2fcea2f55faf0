/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Reduced rows r = Z^T f, and which of their entries are nothing but rounding.
 *
 * A spring that acts against what the joints block has r = 0. What is computed instead is
 * rounding, and no size of r by itself can tell: a short r may be a real, small lever. The
 * error is known, though: with bounds dz of the basis (carried through its elimination) and df
 * of the row,
 *     |dr_c| <= sum_k |f_k| dz_kc + df_k |z_kc|.
 * An entry below that is exactly 0: each is judged against the terms that it is the sum of,
 * before they cancel.
 */
#include "mechanics/reduce.h"

#include "mechanics/linear_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "mechanics/local.h"

/* Relative rounding of an entry of a row; coordinates far from the origin lose as many digits
 * more in the arms. */
static const double ROW_ULPS = 4.0;

/* The largest coordinate, at least the model length [m]. */
static double extent_of(const mt_linear *lin)
{
    double extent = lin->sys->length_m;
    for (int b = 0; b < lin->sys->n_bodies; b++) {
        for (int k = 0; k < 3; k++) {
            extent = fmax(extent, fabs(creal(lin->position.at.pose[b].x[k])));
        }
    }
    return extent;
}

/* Diagonal of M over all states. */
static void diagonal_mass(const mt_linear *lin, double *mass)
{
    const mt_term_list *const list = &lin->list[MT_TERM_MASS];
    for (int i = 0; i < list->n_rows; i++) {
        const mt_term *const t = &list->terms[list->row_term[i]];
        const int other = t->pair ? (2 * t->first) + 1 - i : i;
        const double *const a = lin->rows[MT_TERM_MASS] + ((ptrdiff_t)i * MT_LOCAL);
        const double *const b = lin->rows[MT_TERM_MASS] + ((ptrdiff_t)other * MT_LOCAL);
        const double c = lin->value[t->coefficient] * (t->pair ? 0.5 : 1.0);
        for (int k = 0; k < MT_LOCAL; k++) {
            const int dof = mt_local_dof(lin->sys, t->body, k);
            if (dof >= 0) {
                mass[dof] += c * a[k] * b[k];
            }
        }
    }
}

mt_status mt_reduce_basis(mt_linear *lin, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const mass = mt_arena_f64(&lin->scratch, (size_t)lin->sys->nq, 1);
    lin->e.n = lin->sys->nq - lin->e.qr.rank; /* idle spins may have been left out of it */
    lin->n = lin->e.n;
    lin->e.z = mt_arena_f64(&lin->reduced_mem, (size_t)lin->sys->nq, (size_t)lin->n);
    lin->z_error = mt_arena_f64(&lin->reduced_mem, (size_t)lin->sys->nq, (size_t)lin->n);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    MT_TRY(mt_arena_check(&lin->reduced_mem, err));
    diagonal_mass(lin, mass);
    MT_TRY(mt_eliminate_local(lin->a, mass, extent_of(lin), &lin->scratch, &lin->e,
                              lin->z_error, err));
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

/* Rounding errors of the entries of a row over local freedoms. */
static void row_error(const double row[MT_LOCAL], double extent, double error[MT_LOCAL])
{
    double most = 0.0; /* of the translations: what an arm stands on */
    for (int k = 0; k < MT_LOCAL; k++) {
        most = k % 6 < 3 && fabs(row[k]) > most ? fabs(row[k]) : most;
    }
    for (int k = 0; k < MT_LOCAL; k++) {
        const double arm = k % 6 < 3 ? 0.0 : most * extent;
        error[k] = ROW_ULPS * DBL_EPSILON * (fabs(row[k]) + arm);
    }
}

/* Rounding errors of the entries of the rows over the states. */
static mt_status row_errors(mt_linear *lin, int kind, double extent, mt_err *err)
{
    const mt_term_list *const list = &lin->list[kind];
    double *at =
        mt_arena_f64(&lin->reduced_mem, (size_t)lin->full[kind].start[list->n_rows], 1);
    lin->full_error[kind] = at;
    MT_TRY(mt_arena_check(&lin->reduced_mem, err));
    for (int i = 0; i < list->n_rows; i++) {
        const int *const body = list->terms[list->row_term[i]].body;
        const double *const row = lin->rows[kind] + ((ptrdiff_t)i * MT_LOCAL);
        double error[MT_LOCAL];
        row_error(row, extent, error);
        for (int k = 0; k < MT_LOCAL; k++) {
            if (row[k] != 0.0 && mt_local_dof(lin->sys, body, k) >= 0) {
                *at++ = error[k];
            }
        }
    }
    return MT_OK;
}

/* out[n] = Z^T row, error[n] its bound. */
static void project_row(const mt_linear *lin, int kind, size_t row, double *out, double *error)
{
    const mt_rows *const rows = &lin->full[kind];
    const ptrdiff_t nq = lin->sys->nq;
    for (int k = rows->start[row]; k < rows->start[row + 1]; k++) {
        const double value = rows->value[k];
        const double df = lin->full_error[kind][k];
        for (int c = 0; c < lin->n; c++) {
            const ptrdiff_t at = rows->index[k] + (c * nq);
            out[c] += value * lin->e.z[at];
            error[c] += (fabs(value) * lin->z_error[at]) + (df * fabs(lin->e.z[at]));
        }
    }
}

static mt_status reduce_rows(mt_linear *lin, int kind, mt_err *err)
{
    const mt_term_list *const list = &lin->list[kind];
    const size_t n = (size_t)lin->n;
    const size_t rows = (size_t)list->n_rows;
    const bool kept = kind == MT_TERM_STIFFNESS;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const error =
        mt_arena_f64(kept ? &lin->reduced_mem : &lin->scratch, n, kept ? rows : 1);
    lin->reduced[kind] = mt_arena_f64(&lin->reduced_mem, n, rows);
    MT_TRY(mt_arena_check(kept ? &lin->reduced_mem : &lin->scratch, err));
    MT_TRY(mt_arena_check(&lin->reduced_mem, err));
    for (size_t i = 0; i < rows; i++) {
        double *const out = lin->reduced[kind] + (i * n);
        double *const bound = error + (kept ? i * n : 0);
        memset(bound, 0, n * sizeof *bound);
        project_row(lin, kind, i, out, bound);
        for (size_t c = 0; c < n; c++) {
            out[c] = fabs(out[c]) <= bound[c] ? 0.0 : out[c];
        }
    }
    mt_rows_of_columns(lin->n, list->n_rows, lin->reduced[kind], &lin->reduced_mem,
                       &lin->entries[kind]);
    MT_TRY(mt_arena_check(&lin->reduced_mem, err));
    if (kept) {
        lin->noise = error;
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

mt_status mt_reduce_rows(mt_linear *lin, mt_err *err)
{
    const double extent = extent_of(lin);
    for (int kind = 0; kind < MT_TERM_KINDS; kind++) {
        MT_TRY(row_errors(lin, kind, extent, err));
        MT_TRY(reduce_rows(lin, kind, err));
    }
    return MT_OK;
}
