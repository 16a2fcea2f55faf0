/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Roots s of (s^2 M + s C + K + i H) y = 0 and their derivatives: with symmetric matrices y is
 * its own left eigenvector, so y^T times the derivative of the equation leaves
 *     ds (y^T (2 s M + C) y) = -y^T (s^2 dM + s dC + dK + i dH) y.
 */
#include "analysis/damping_priv.h"

#include <math.h>

#include "linalg/dense.h"
#include "mechanics/products.h"

typedef struct mt_damping_work work;

mt_status mt_analysis_damped(mt_analysis *a, const mt_damped_modes **out, mt_err *err)
{
    MT_TRY(mt_analysis_damping(a, NULL, NULL, NULL, err));
    work *const w = a->damping;
    if (!w->solved) {
        const mt_reduced r = mt_linear_reduced(a->lin);
        const mt_damped_problem p = {
            .n = r.n, .k = r.k, .c = w->c, .h = w->h, .mass = &a->mass, .modes = &a->modes};
        MT_TRY(mt_modal_damped(&p, &a->damping_mem, &w->damped, err));
        w->solved = true;
    }
    *out = &w->damped;
    return MT_OK;
}

int mt_damped_oscillating(const mt_damped_modes *d, int index)
{
    int at = -1;
    int seen = 0;
    for (int i = 0; i < d->count; i++) {
        if (d->kind[i] == MT_DAMPED_UNSTABLE || d->kind[i] == MT_DAMPED_UNDECIDED) {
            return -1;
        }
        seen += d->kind[i] == MT_DAMPED_OSCILLATING ? 1 : 0;
        at = at < 0 && seen == index ? i : at;
    }
    return at;
}

mt_status mt_analysis_damped_of(mt_analysis *a, int pos, int *out, mt_err *err)
{
    const mt_damped_modes *d = NULL;
    const mt_reduced r = mt_linear_reduced(a->lin);
    double best = -1.0;
    *out = -1;
    MT_TRY(mt_analysis_damped(a, &d, err));
    const mt_arena_mark mark = mt_arena_get_mark(&a->damping_mem);
    double *const m_phi = mt_arena_f64(&a->damping_mem, (size_t)r.n, 1);
    double *const m_y = mt_arena_f64(&a->damping_mem, (size_t)r.n, 1);
    mt_status rc = mt_arena_check(&a->damping_mem, err);
    if (rc == MT_OK) {
        mt_symm(r.n, 1, r.m, mt_modal_shape(&a->modes, pos), m_phi);
    }
    for (int i = 0; i < d->count && rc == MT_OK; i++) {
        double share = 0.0;
        double whole = 0.0;
        for (int part = 0; part < 2; part++) {
            const double *const y = (part == 0 ? d->y_re : d->y_im) + ((ptrdiff_t)i * r.n);
            const double along = mt_dot(r.n, m_phi, y);
            mt_symm(r.n, 1, r.m, y, m_y);
            share += along * along;
            whole += mt_dot(r.n, y, m_y);
        }
        if (d->kind[i] == MT_DAMPED_OSCILLATING && whole > 0.0 && share / whole > best) {
            best = share / whole;
            *out = i;
        }
    }
    mt_arena_rewind(&a->damping_mem, mark);
    return rc;
}

/* y^T A y of the columns (Re y, Im y) and of the products ay of A with them. */
static double complex form(int n, const double *y, const double *ay)
{
    const double rr = mt_dot(n, y, ay);
    const double ii = mt_dot(n, y + n, ay + n);
    const double ri = mt_dot(n, y, ay + n) + mt_dot(n, y + n, ay);
    return mt_complex(rr - ii, ri);
}

/* Roots nearer than this many of their own roundings are one: residuals of a few n eps, and the
 * square root that a defective pair makes of them, lie below. */
static const double REPEATED = 1e-6;

static bool is_repeated(const mt_damped_modes *d, int i)
{
    const double size = hypot(d->re[i], d->im[i]);
    for (int k = 0; k < d->count; k++) {
        if (k != i && d->kind[k] != MT_DAMPED_RIGID_BODY &&
            hypot(d->re[k] - d->re[i], d->im[k] - d->im[i]) <= REPEATED * size) {
            return true;
        }
    }
    return !(size > 0.0);
}

/* y^T (2 s M + C) y. */
static double complex denominator(const mt_analysis *a, const work *w, const double *y,
                                  double complex s, double *ay)
{
    const mt_reduced r = mt_linear_reduced(a->lin);
    mt_symm(r.n, 2, r.m, y, ay);
    const double complex m = form(r.n, y, ay);
    mt_symm(r.n, 2, w->c, y, ay);
    return (2.0 * s * m) + form(r.n, y, ay);
}

static mt_status slopes_of_pole(mt_analysis *a, const work *w, int i, double *dre, double *dim,
                                mt_err *err)
{
    const int n = w->n;
    const size_t size = (size_t)n;
    const double complex s = mt_complex(w->damped.re[i], w->damped.im[i]);
    double *const y = mt_arena_f64(&a->damping_mem, size, 2);
    double *const one = mt_arena_f64(&a->damping_mem, size, 2);
    double *const two = mt_arena_f64(&a->damping_mem, size, 2);
    MT_TRY(mt_arena_check(&a->damping_mem, err));
    mt_axpy(n, 1.0, w->damped.y_re + ((ptrdiff_t)i * n), y);
    mt_axpy(n, 1.0, w->damped.y_im + ((ptrdiff_t)i * n), y + n);
    const double complex below = denominator(a, w, y, s, one);
    for (int p = 0; p < a->sys->n_inputs; p++) {
        MT_TRY(mt_linear_products(a->lin, p, 2, y, one, two, err));
        double complex above = form(n, y, one) + (s * s * form(n, y, two));
        MT_TRY(mt_analysis_damping_products(a, p, 2, y, one, two, err));
        above += (s * form(n, y, one)) + (mt_complex(0.0, 1.0) * form(n, y, two));
        const double complex ds = -above / below;
        dre[p] = creal(ds);
        dim[p] = w->damped.im[i] > 0.0 ? cimag(ds) : 0.0; /* a real root stays real */
    }
    return MT_OK;
}

mt_status mt_analysis_dpole(mt_analysis *a, int i, double *dre, double *dim, bool *repeated,
                            mt_err *err)
{
    const mt_damped_modes *d = NULL;
    MT_TRY(mt_analysis_damped(a, &d, err));
    const bool many = d->kind[i] == MT_DAMPED_RIGID_BODY || d->kind[i] == MT_DAMPED_UNDECIDED ||
                      is_repeated(d, i);
    if (repeated != NULL) {
        *repeated = many;
    }
    if (many) {
        for (int p = 0; p < a->sys->n_inputs; p++) {
            dre[p] = nan("");
            dim[p] = nan("");
        }
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&a->damping_mem);
    const mt_status rc = slopes_of_pole(a, a->damping, i, dre, dim, err);
    mt_arena_rewind(&a->damping_mem, mark);
    return rc;
}
