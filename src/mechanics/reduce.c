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

/* Relative rounding of an entry of a row. */
static const double ROW_ULPS = 4.0;

double mt_reduce_extent(const mt_linear *lin)
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
    lin->z_error = mt_arena_f64(&lin->geometry, (size_t)lin->sys->nq, (size_t)lin->n);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    MT_TRY(mt_arena_check(&lin->geometry, err));
    diagonal_mass(lin, mass);
    MT_TRY(mt_eliminate_local(lin->a, mass, mt_reduce_extent(lin), &lin->scratch, &lin->e,
                              lin->z_error, err));
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

void mt_reduce_row_error(const double row[MT_LOCAL], double extent, double error[MT_LOCAL])
{
    double most = 0.0; /* of the translations: what an arm stands on */
    for (int k = 0; k < MT_LOCAL; k++) {
        most = k % 6 < 3 && fabs(row[k]) > most ? fabs(row[k]) : most;
    }
    for (int k = 0; k < MT_LOCAL; k++) {
        const double arm = k % 6 < 3 ? 0.0 : most * extent;
        error[k] = row[k] == 0.0 ? 0.0 : ROW_ULPS * DBL_EPSILON * (fabs(row[k]) + arm);
    }
}

/* out[n] = Z^T row, error[n] its bound. */
static void project(const mt_linear *lin, const mt_term *t, const double *row, double extent,
                    double *out, double *error)
{
    const ptrdiff_t nq = lin->sys->nq;
    double df[MT_LOCAL];
    mt_reduce_row_error(row, extent, df);
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = row[k] == 0.0 ? -1 : mt_local_dof(lin->sys, t->body, k);
        if (dof < 0) {
            continue;
        }
        for (int c = 0; c < lin->n; c++) {
            const ptrdiff_t at = dof + (c * nq);
            out[c] += row[k] * lin->e.z[at];
            error[c] += (fabs(row[k]) * lin->z_error[at]) + (df[k] * fabs(lin->e.z[at]));
        }
    }
}

static void list_entries(size_t n, size_t rows, const double *dense, size_t count,
                         mt_arena *mem, mt_rows *out)
{
    mt_rows_begin(out, (int)rows, count, mem);
    for (size_t i = 0; i < rows && !mt_arena_failed(mem); i++) {
        for (size_t c = 0; c < n; c++) {
            if (dense[c + (i * n)] != 0.0) {
                mt_rows_push(out, (int)i, (int)c, dense[c + (i * n)]);
            }
        }
        mt_rows_end(out, (int)i);
    }
}

static mt_status reduce_rows(mt_linear *lin, int kind, double extent, mt_err *err)
{
    const mt_term_list *const list = &lin->list[kind];
    const size_t n = (size_t)lin->n;
    const size_t rows = (size_t)list->n_rows;
    const bool kept = kind == MT_TERM_STIFFNESS;
    size_t entries = 0;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const error =
        mt_arena_f64(kept ? &lin->geometry : &lin->scratch, n, kept ? rows : 1);
    lin->reduced[kind] = mt_arena_f64(&lin->geometry, n, rows);
    MT_TRY(mt_arena_check(kept ? &lin->geometry : &lin->scratch, err));
    MT_TRY(mt_arena_check(&lin->geometry, err));
    for (size_t i = 0; i < rows; i++) {
        double *const out = lin->reduced[kind] + (i * n);
        double *const bound = error + (kept ? i * n : 0);
        memset(bound, 0, n * sizeof *bound);
        project(lin, &list->terms[list->row_term[i]], lin->rows[kind] + (i * MT_LOCAL), extent,
                out, bound);
        for (size_t c = 0; c < n; c++) {
            out[c] = fabs(out[c]) <= bound[c] ? 0.0 : out[c];
            entries += out[c] != 0.0 ? 1 : 0;
        }
    }
    list_entries(n, rows, lin->reduced[kind], entries, &lin->geometry, &lin->entries[kind]);
    MT_TRY(mt_arena_check(&lin->geometry, err));
    if (kept) {
        lin->noise = error;
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

mt_status mt_reduce_rows(mt_linear *lin, mt_err *err)
{
    const double extent = mt_reduce_extent(lin);
    for (int kind = 0; kind < MT_TERM_KINDS; kind++) {
        MT_TRY(reduce_rows(lin, kind, extent, err));
    }
    return MT_OK;
}
