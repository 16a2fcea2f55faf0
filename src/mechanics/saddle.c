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
 * e_d), columns for each trimmed spring t and its drive d, P = x_d^T t = e_d^T y_t:
 *     (x, y) = S^-1 (f, b) - (x_t, y_t) tau,       P tau = e_d . y of S^-1 (f, b)
 * has no multipliers of these drives, and transposed
 *     (x, y) = S^-1 (f, b) + (x_d, y_d) alpha,     P^T alpha = pull - t . x of S^-1 (f, b).
 * Both are S^-1 and a matrix with a norm of at most |(x_t, y_t)| |P^-1| |(x_d, y_d)|, and rows
 * and columns of tau with |P^-1| |(x_d, y_d)| and |(x_t, y_t)| |P^-1|, each t of length 1.
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

/* x := P^-1 x, or P^-T x. */
static mt_status divide_by_pivot(const mt_border *border, bool transposed, double *x,
                                 mt_arena *scratch, mt_err *err)
{
    const ptrdiff_t n = border->n;
    if (n == 1) {
        x[0] /= border->pivot[0];
        return MT_OK;
    }
    double *const p = mt_arena_f64(scratch, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(scratch, err));
    for (ptrdiff_t i = 0; i < n; i++) {
        for (ptrdiff_t j = 0; j < n; j++) {
            p[i + (j * n)] = border->pivot[transposed ? j + (i * n) : i + (j * n)];
        }
    }
    return mt_lu_solve((int)n, p, 1, x, NULL, scratch, err);
}

/* |P^-1|_F, rows and columns in units of 1 / row and 1 / unit; not finite where P is singular.
 * */
static mt_status pivot_inverse_norm(const mt_border *border, const double *unit,
                                    const double *row, double *norm, mt_arena *scratch,
                                    mt_err *err)
{
    const ptrdiff_t n = border->n;
    double squares = 0.0;
    double *const column = mt_arena_f64(scratch, (size_t)n, 1);
    MT_TRY(mt_arena_check(scratch, err));
    for (ptrdiff_t j = 0; j < n; j++) {
        memset(column, 0, (size_t)n * sizeof *column);
        column[j] = 1.0;
        const mt_status rc = divide_by_pivot(border, false, column, scratch, NULL);
        if (rc == MT_E_MEMORY) {
            return mt_fail_memory(err);
        }
        for (ptrdiff_t i = 0; i < n; i++) {
            const double part = rc == MT_OK ? column[i] * unit[i] * row[j] : HUGE_VAL;
            squares += part * part;
        }
    }
    *norm = sqrt(squares);
    return MT_OK;
}

/* The solutions for t and for the drives' equations, and P. */
static mt_status solve_border(mt_border *out, mt_arena *mem, mt_err *err)
{
    const mt_saddle *const s = &out->s;
    const ptrdiff_t nq = s->sys->nq;
    const ptrdiff_t m = s->m;
    const ptrdiff_t n = out->n;
    out->x_along = mt_arena_f64(mem, (size_t)nq, (size_t)n);
    out->y_along = mt_arena_f64(mem, (size_t)m, (size_t)n);
    out->x_drive = mt_arena_f64(mem, (size_t)nq, (size_t)n);
    out->y_drive = mt_arena_f64(mem, (size_t)m, (size_t)n);
    out->pivot = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const unit_drive = mt_arena_f64(mem, (size_t)m, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t d = 0; d < n; d++) {
        const ptrdiff_t drive = m - n + d;
        unit_drive[drive] = 1.0;
        MT_TRY(mt_saddle_solve(s, out->along + (d * nq), NULL, out->x_along + (d * nq),
                               out->y_along + (d * m), mem, err));
        MT_TRY(mt_saddle_solve(s, NULL, unit_drive, out->x_drive + (d * nq),
                               out->y_drive + (d * m), mem, err));
        unit_drive[drive] = 0.0;
    }
    for (ptrdiff_t i = 0; i < n; i++) {
        for (ptrdiff_t j = 0; j < n; j++) {
            out->pivot[i + (j * n)] =
                mt_dot((int)nq, out->along + (j * nq), out->x_drive + (i * nq));
        }
    }
    return MT_OK;
}

mt_status mt_border_init(const mt_saddle *s, const double *along, double most, mt_arena *mem,
                         mt_border *out, bool *sure, mt_err *err)
{
    const mt_layout *const o = s->sys->layout;
    const ptrdiff_t nq = s->sys->nq;
    const ptrdiff_t m = s->m;
    double unit[MT_DRIVES_MOST] = {0.0}; /* |t|, of which it is one with length 1 */
    double row[MT_DRIVES_MOST]; /* of an equation, of the length that the factor gives it */
    double by_force = 0.0;
    double by_drive = 0.0;
    double inverse = 0.0;
    *out = (mt_border){.s = *s, .n = s->sys->n_trims, .along = along};
    MT_TRY(solve_border(out, mem, err));
    *sure = true;
    for (ptrdiff_t d = 0; d < out->n && *sure; d++) {
        for (ptrdiff_t j = 0; j < nq; j++) {
            unit[d] = hypot(unit[d], along[j + (d * nq)] * s->d[o->state[j]]);
        }
        row[d] = s->d[o->equation[m - out->n + d]];
        *sure = unit[d] > 0.0 && (out->n > 1 || fabs(out->pivot[0]) > 0.0);
    }
    if (!*sure) {
        return MT_OK;
    }
    for (ptrdiff_t d = 0; d < out->n; d++) {
        const double force =
            scaled_length(s, out->x_along + (d * nq), out->y_along + (d * m)) * s->scale;
        const double drive =
            scaled_length(s, out->x_drive + (d * nq), out->y_drive + (d * m)) / row[d];
        by_force = hypot(by_force, force / unit[d]);
        by_drive = hypot(by_drive, drive);
    }
    MT_TRY(pivot_inverse_norm(out, unit, row, &inverse, mem, err));
    const double norm = fmax(fmax(by_force, by_drive), by_force * by_drive) * inverse;
    *sure = norm <= most;
    return MT_OK;
}

mt_status mt_border_solve(const mt_border *border, const double *f, const double *b, double *x,
                          double *y, double *tau, mt_arena *scratch, mt_err *err)
{
    const mt_saddle *const s = &border->s;
    const ptrdiff_t nq = s->sys->nq;
    const ptrdiff_t m = s->m;
    const ptrdiff_t rest = m - border->n;
    MT_TRY(mt_saddle_solve(s, f, b, x, y, scratch, err));
    memcpy(tau, y + rest, (size_t)border->n * sizeof *tau);
    MT_TRY(divide_by_pivot(border, false, tau, scratch, err));
    for (ptrdiff_t d = 0; d < border->n; d++) {
        mt_axpy((int)nq, -tau[d], border->x_along + (d * nq), x);
        mt_axpy((int)rest, -tau[d], border->y_along + (d * m), y);
    }
    memset(y + rest, 0, (size_t)border->n * sizeof *y);
    return MT_OK;
}

mt_status mt_border_adjoint(const mt_border *border, const double *f, const double *b,
                            const double *pull, double *x, double *y, mt_arena *scratch,
                            mt_err *err)
{
    const mt_saddle *const s = &border->s;
    const ptrdiff_t nq = s->sys->nq;
    double alpha[MT_DRIVES_MOST];
    MT_TRY(mt_saddle_solve(s, f, b, x, y, scratch, err));
    for (ptrdiff_t d = 0; d < border->n; d++) {
        alpha[d] = pull[d] - mt_dot((int)nq, border->along + (d * nq), x);
    }
    MT_TRY(divide_by_pivot(border, true, alpha, scratch, err));
    for (ptrdiff_t d = 0; d < border->n; d++) {
        mt_axpy((int)nq, alpha[d], border->x_drive + (d * nq), x);
        mt_axpy(s->m, alpha[d], border->y_drive + ((ptrdiff_t)s->m * d), y);
    }
    return MT_OK;
}
