/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * In scaled coordinates, with D_c, D_r as in eliminate.h and k the largest entry of D_c H D_c,
 *     [ D_c H D_c / k   (D_r A D_c)^T ] [ D_c^-1 x   ]   [ D_c f / k ]
 *     [ D_r A D_c             0       ] [ D_r^-1 y/k ] = [ D_r b     ].
 * Where A has full rank it has as many negative eigenvalues as A has rows, and one more for
 * each negative eigenvalue of Z^T H Z (Gould, Math. Program. 32 (1985) 90-99). The block of its
 * inverse that belongs to x is Z (Z^T H Z)^-1 Z^T, Z orthonormal: no norm of Z^T H Z's inverse
 * is above that of the whole. Equations that are not in force are rows of their own, -1 on the
 * diagonal.
 */
#include "mechanics/saddle.h"

#include <math.h>
#include <string.h>

/* Pivots below these are none, and the dense way decides. Least squares have the squares of A's
 * singular values as pivots: that is 1e-6 of a row, and eliminate.c calls 1e-9 dependent. A
 * freedom without stiffness has rounding of what the joints hold, 1e-13, and off its
 * equilibrium more: no step along it means anything. A slender beam of many elements has as
 * little, and steps that shrink all the same. */
static const double NO_PIVOT[] = {
    [MT_SADDLE_LEAST_SQUARES] = 1e-12, [MT_SADDLE_REGULAR] = 1e-9, [MT_SADDLE_SOFT] = 1e-15};
/* Open rows beside those that the order makes, for pivots that are put off. */
enum { ROOM = 24 };
/* A multiplication here, in a loop over a short row, against one in a matrix product. */
static const double SLOWER = 4.0;

bool mt_saddle_pays(const mt_system *sys)
{
    const double nq = sys->nq;
    const double m = fmin(sys->n_constraints, sys->nq);
    const double n = nq - m;
    /* pivoted QR, basis, reduced Hessian, its singular values */
    const double dense =
        (2.0 * m * m * nq) + (4.0 * nq * n * m) + (2.0 * nq * nq * n) + (30.0 * n * n * n);
    return SLOWER * 2.0 * sys->layout->work <= dense;
}

/* A state's scale by its own stiffness, where it has some: then a beam's turns weigh as its
 * displacements do, however short its elements are, and nothing need wait for a partner. */
static void scale_softly(const mt_saddle *s, const double *h)
{
    const mt_envelope *const e = &s->sys->layout->envelope;
    for (int j = 0; j < s->sys->nq; j++) {
        const int p = s->sys->layout->state[j];
        const double own = h[e->row[p] + p];
        s->d[p] = own > 0.0 && own < HUGE_VAL ? 1.0 / sqrt(own) : s->d[p];
    }
}

/* d[places]: D_c for states, D_r for equations. */
static void find_scales(const mt_saddle *s, const mt_lagrangian *l, mt_saddle_kind kind)
{
    const mt_system *const sys = s->sys;
    const mt_layout *const o = sys->layout;
    for (int b = 0; b < sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            const int dof = sys->bodies[b].dof[k];
            if (dof >= 0) {
                s->d[o->state[dof]] = k < 3 ? 1.0 : 1.0 / sys->length_m;
            }
        }
    }
    if (kind == MT_SADDLE_SOFT) {
        scale_softly(s, l->h);
    }
    for (int i = 0; i < sys->n_constraints; i++) {
        double length = 0.0;
        for (int k = 0; i < s->m && k < l->row[i].n; k++) {
            length = hypot(length, l->row[i].a[k] * s->d[o->state[l->row[i].dof[k]]]);
        }
        s->d[o->equation[i]] = length > 0.0 ? 1.0 / length : 1.0;
    }
}

/* D_c H D_c / k; returns k. */
static double scale_hessian(const mt_envelope *e, const double *d, double *value)
{
    double most = 0.0;
    for (int i = 0; i < e->n; i++) {
        for (int j = e->first[i]; j <= i; j++) {
            value[e->row[i] + j] *= d[i] * d[j];
            most = fmax(most, fabs(value[e->row[i] + j]));
        }
    }
    for (size_t i = 0; i < e->count && most > 0.0; i++) {
        value[i] /= most;
    }
    return most > 0.0 ? most : 1.0;
}

mt_status mt_saddle_factor(const mt_system *sys, int m, const mt_lagrangian *l,
                           mt_saddle_kind kind, double *value, mt_arena *mem, mt_saddle *out,
                           mt_err *err)
{
    const mt_layout *const o = sys->layout;
    const mt_envelope *const e = &o->envelope;
    *out = (mt_saddle){.sys = sys, .m = m, .scale = 1.0};
    out->d = mt_arena_f64(mem, (size_t)e->n, 1);
    MT_TRY(mt_arena_check(mem, err));
    find_scales(out, l, kind);
    if (kind == MT_SADDLE_LEAST_SQUARES) {
        memset(value, 0, e->count * sizeof *value);
        for (int j = 0; j < sys->nq; j++) {
            value[e->row[o->state[j]] + o->state[j]] = 1.0;
        }
    } else {
        memmove(value, l->h, e->count * sizeof *value);
        out->scale = scale_hessian(e, out->d, value);
    }
    for (int i = 0; i < sys->n_constraints; i++) {
        const int p = o->equation[i];
        for (int k = 0; i < m && k < l->row[i].n; k++) {
            const int q = o->state[l->row[i].dof[k]];
            value[e->row[p > q ? p : q] + (p > q ? q : p)] =
                out->d[p] * l->row[i].a[k] * out->d[q];
        }
        value[e->row[p] + p] = i < m ? 0.0 : -1.0;
    }
    MT_TRY(mt_ldl_factor(e, value, NO_PIVOT[kind], (2 * e->front) + ROOM, mem, &out->f, err));
    out->whole = out->f.whole && out->f.rank == out->f.n;
    return MT_OK;
}

mt_status mt_saddle_solve(const mt_saddle *s, const double *f, const double *b, double *x,
                          double *y, mt_arena *scratch, mt_err *err)
{
    const mt_layout *const o = s->sys->layout;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const z = mt_arena_f64(scratch, (size_t)o->envelope.n, 1);
    MT_TRY(mt_arena_check(scratch, err));
    for (int j = 0; j < s->sys->nq && f != NULL; j++) {
        z[o->state[j]] = s->d[o->state[j]] * f[j] / s->scale;
    }
    for (int i = 0; i < s->m && b != NULL; i++) {
        z[o->equation[i]] = s->d[o->equation[i]] * b[i];
    }
    mt_ldl_solve(&s->f, z);
    for (int j = 0; j < s->sys->nq && x != NULL; j++) {
        x[j] = s->d[o->state[j]] * z[o->state[j]];
    }
    for (int i = 0; i < s->m && y != NULL; i++) {
        y[i] = s->scale * s->d[o->equation[i]] * z[o->equation[i]];
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

bool mt_saddle_convex(const mt_saddle *s)
{
    return s->f.negative == s->sys->n_constraints;
}

mt_status mt_saddle_below(const mt_saddle *s, double most, mt_arena *scratch, bool *below,
                          mt_err *err)
{
    double norm = 0.0;
    MT_TRY(mt_ldl_inverse_norm(&s->f, scratch, &norm, err));
    *below = norm <= most;
    return MT_OK;
}
