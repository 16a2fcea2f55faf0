/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Checks whether redundant equations stay redundant as an input changes. The derivatives of
 * rows of unit length are compared with the sums of their own terms: a derivative that should
 * vanish is rounding of them, also through the position's derivative; any other is of their
 * size.
 */
#include "mechanics/independence.h"

#include "mechanics/linear_priv.h"

#include <math.h>
#include <string.h>

#include "mechanics/redundant.h"
#include "mechanics/tangent.h"

static const double VANISHES = 1e-8;
/* Rounding, of what is made of terms of size 1: an entry of w (largest 1) below this does not
 * tell an equation that takes part from one that does not. */
static const double TAKES_PART = 1e-13;

/* Length of row j of A. in scaled coordinates, with the row of A scaled to unit length. */
static double row_length(const mt_elimination *e, const mt_linear_tangent *t, int j)
{
    double squares = 0.0;
    for (ptrdiff_t k = 0; k < e->nq; k++) {
        const double entry = e->dr[j] * t->a[j + (k * e->m)] * e->dc[k];
        squares += entry * entry;
    }
    return sqrt(squares);
}

/* row[nq] = sum_j w_j dr_j A._j; returns the sum of the lengths of its terms in scaled
 * coordinates, each at least the rounding of w. */
static double combine(const mt_linear *lin, const mt_linear_tangent *t, const double *w,
                      double *row)
{
    const mt_elimination *const e = &lin->e;
    double terms = 0.0;
    memset(row, 0, (size_t)e->nq * sizeof *row);
    for (int j = 0; j < e->m; j++) {
        for (ptrdiff_t k = 0; k < e->nq; k++) {
            row[k] += w[j] * e->dr[j] * t->a[j + (k * e->m)];
        }
        terms += fmax(fabs(w[j]), TAKES_PART / VANISHES) * row_length(e, t, j);
    }
    return terms;
}

typedef struct left {
    double *w;   /* [m] */
    double *row; /* [nq] */
    double *out; /* [n] */
} left;

static mt_status left_init(left *l, const mt_linear *lin, mt_arena *mem, mt_err *err)
{
    l->w = mt_arena_f64(mem, (size_t)lin->m, 1);
    l->row = mt_arena_f64(mem, (size_t)lin->sys->nq, 1);
    l->out = mt_arena_f64(mem, (size_t)lin->n, 1);
    return mt_arena_check(mem, err);
}

static bool can_change(const mt_linear *lin, int p)
{
    return mt_linear_redundant(lin) > 0 && lin->tangent != NULL && lin->tangent[p].moves;
}

/*
 * A gap's derivative is a sum of motions of points that the input moves; those that cancel at
 * once (both bodies' point is drawn elsewhere) are not among its terms, but in A., which turns
 * with the arms: arms grow by up to |A.| model lengths. Nor is the motion itself known beyond
 * its rounding, in whatever direction it is not.
 */
static bool opens(const mt_linear *lin, const mt_linear_tangent *t, const double *w)
{
    double terms = fmax(t->terms, TAKES_PART / VANISHES * t->motion);
    for (int j = 0; j < lin->m; j++) {
        const double arms = lin->sys->length_m * row_length(&lin->e, t, j);
        terms = fmax(terms, TAKES_PART / VANISHES * arms);
    }
    for (int i = 0; i < lin->m; i++) {
        const double part = fabs(w[i] * lin->e.dr[i] * t->c[i]);
        if (part > VANISHES * terms) {
            return true;
        }
    }
    return false;
}

mt_status mt_linear_independence(mt_linear *lin, int p, mt_arena *mem, mt_independence *out,
                                 mt_err *err)
{
    *out = (mt_independence){.opens = false};
    if (mt_linear_redundant(lin) > 0) {
        MT_TRY(mt_tangent_complete(lin, err));
    }
    if (!can_change(lin, p)) {
        return MT_OK;
    }
    const mt_linear_tangent *const t = &lin->tangent[p];
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    left l;
    MT_TRY(left_init(&l, lin, &lin->scratch, err));
    for (int k = 0; k < mt_linear_redundant(lin) && !out->opens; k++) {
        MT_TRY(mt_eliminate_left_null(&lin->e, k, l.w, &lin->scratch, err));
        const double terms = combine(lin, t, l.w, l.row);
        mt_eliminate_project(&lin->e, l.row, l.out);
        const bool blocks = mt_norm2(lin->n, l.out) > VANISHES * terms;
        out->opens = opens(lin, t, l.w);
        if (out->opens || (blocks && !out->blocks)) {
            MT_TRY(mt_name_joints(lin->sys, lin->m, l.w, mem, &out->joints, err));
        }
        out->blocks = out->blocks || blocks;
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

mt_status mt_linear_blocked(mt_linear *lin, int p, int cols, const double *y, bool *blocked,
                            mt_err *err)
{
    memset(blocked, 0, (size_t)cols * sizeof *blocked);
    if (mt_linear_redundant(lin) > 0) {
        MT_TRY(mt_tangent_complete(lin, err));
    }
    if (!can_change(lin, p)) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    left l;
    MT_TRY(left_init(&l, lin, &lin->scratch, err));
    for (int k = 0; k < mt_linear_redundant(lin); k++) {
        MT_TRY(mt_eliminate_left_null(&lin->e, k, l.w, &lin->scratch, err));
        const double terms = combine(lin, &lin->tangent[p], l.w, l.row);
        mt_eliminate_project(&lin->e, l.row, l.out);
        for (int c = 0; c < cols; c++) {
            const double *const motion = y + ((ptrdiff_t)c * lin->n);
            const double part = fabs(mt_dot(lin->n, l.out, motion));
            blocked[c] = blocked[c] || part > VANISHES * terms * mt_norm2(lin->n, motion);
        }
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}
