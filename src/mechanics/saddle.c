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

#include "linalg/dense.h"

/* Pivots below these are none, and the dense way decides. Least squares have the squares of A's
 * singular values as pivots: that is 1e-6 of a row, and eliminate.c calls 1e-9 dependent. A
 * freedom without stiffness has rounding of what the joints hold, 1e-13, and off its
 * equilibrium more: no step along it means anything. A slender beam of many elements has as
 * little, and steps that shrink all the same. */
static const double NO_PIVOT[] = {
    [MT_SADDLE_LEAST_SQUARES] = 1e-12, [MT_SADDLE_REGULAR] = 1e-9, [MT_SADDLE_SOFT] = 1e-15};
/* Open rows beside those that the order makes, for pivots that are put off. */
enum { ROOM = 24 };

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
        if (value != l->h) {
            memcpy(value, l->h, e->count * sizeof *value);
        }
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

/*
 * With S = [H A^T; A 0] of all m equations, (x_t, y_t) = S^-1 (t, 0) and (x_d, y_d) = S^-1 (0,
 * e_d), p = t . x_d = e_d . y_t:
 *     (x, y) = S^-1 (f, b) - tau (x_t, y_t),       tau   = (e_d . y of S^-1 (f, b)) / p
 * has no multiplier of the drive, and transposed
 *     (x, y) = S^-1 (f, b) + alpha (x_d, y_d),     alpha = (pull - t . x of S^-1 (f, b)) / p.
 * Both are S^-1 and a matrix of rank one with the norm |(x_t, y_t)| |(x_d, y_d)| / |p|, and
 * rows and columns of tau with |(x_d, y_d)| / |p| and |(x_t, y_t)| / |p|, t of length 1.
 */

/* |(x, y)| in the scaled coordinates of the factor. */
static double scaled_length(const mt_saddle *s, const double *x, const double *y)
{
    const mt_layout *const o = s->sys->layout;
    double square = 0.0;
    for (int j = 0; j < s->sys->nq; j++) {
        const double part = x[j] / s->d[o->state[j]];
        square += part * part;
    }
    for (int i = 0; i < s->m; i++) {
        const double part = y[i] / s->d[o->equation[i]] / s->scale;
        square += part * part;
    }
    return sqrt(square);
}

mt_status mt_border_init(const mt_saddle *s, const double *along, double most, mt_arena *mem,
                         mt_border *out, bool *sure, mt_err *err)
{
    const mt_layout *const o = s->sys->layout;
    const int nq = s->sys->nq;
    const size_t m = (size_t)s->m;
    const int drive = s->m - 1;
    double unit = 0.0;
    *out = (mt_border){.s = *s, .along = along};
    out->x_along = mt_arena_f64(mem, (size_t)nq, 1);
    out->y_along = mt_arena_f64(mem, m, 1);
    out->x_drive = mt_arena_f64(mem, (size_t)nq, 1);
    out->y_drive = mt_arena_f64(mem, m, 1);
    double *const unit_drive = mt_arena_f64(mem, m, 1);
    MT_TRY(mt_arena_check(mem, err));
    unit_drive[drive] = 1.0;
    MT_TRY(mt_saddle_solve(s, along, NULL, out->x_along, out->y_along, mem, err));
    MT_TRY(mt_saddle_solve(s, NULL, unit_drive, out->x_drive, out->y_drive, mem, err));
    out->pivot = mt_dot(nq, along, out->x_drive);
    for (int j = 0; j < nq; j++) {
        unit = hypot(unit, along[j] * s->d[o->state[j]]);
    }
    *sure = unit > 0.0 && fabs(out->pivot) > 0.0;
    if (!*sure) {
        return MT_OK;
    }
    /* of a t of length 1, and of an equation of the length that the factor gives it */
    const double row = s->d[o->equation[drive]];
    const double by_force = scaled_length(s, out->x_along, out->y_along) * s->scale / unit;
    const double by_drive = scaled_length(s, out->x_drive, out->y_drive) / row;
    const double pivot = fabs(out->pivot) / unit / row;
    const double norm = fmax(fmax(by_force, by_drive), by_force * by_drive) / pivot;
    *sure = norm <= most;
    return MT_OK;
}

mt_status mt_border_solve(const mt_border *border, const double *f, const double *b, double *x,
                          double *y, double *tau, mt_arena *scratch, mt_err *err)
{
    const mt_saddle *const s = &border->s;
    MT_TRY(mt_saddle_solve(s, f, b, x, y, scratch, err));
    *tau = y[s->m - 1] / border->pivot;
    mt_axpy(s->sys->nq, -*tau, border->x_along, x);
    mt_axpy(s->m - 1, -*tau, border->y_along, y);
    y[s->m - 1] = 0.0;
    return MT_OK;
}

mt_status mt_border_adjoint(const mt_border *border, const double *f, const double *b,
                            double pull, double *x, double *y, mt_arena *scratch, mt_err *err)
{
    const mt_saddle *const s = &border->s;
    MT_TRY(mt_saddle_solve(s, f, b, x, y, scratch, err));
    const double alpha = (pull - mt_dot(s->sys->nq, border->along, x)) / border->pivot;
    mt_axpy(s->sys->nq, alpha, border->x_drive, x);
    mt_axpy(s->m, alpha, border->y_drive, y);
    return MT_OK;
}
