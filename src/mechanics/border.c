/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * With S = [H A^T; A 0] of all m equations, (x_t, y_t) = S^-1 (t, 0) and (x_d, y_d) = S^-1 (0,
 * e_d), p = t . x_d = e_d . y_t:
 *     (x, y) = S^-1 (f, b) - tau (x_t, y_t),       tau   = (e_d . y of S^-1 (f, b)) / p
 * has no multiplier of the drive, and transposed
 *     (x, y) = S^-1 (f, b) + alpha (x_d, y_d),     alpha = (pull - t . x of S^-1 (f, b)) / p.
 * Both are S^-1 and a matrix of rank one with the norm |(x_t, y_t)| |(x_d, y_d)| / |p|, and
 * rows and columns of tau with |(x_d, y_d)| / |p| and |(x_t, y_t)| / |p|, t of length 1.
 */
#include "mechanics/border.h"

#include <math.h>

#include "linalg/dense.h"

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
