/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * With E = x^T (K + s M) x, what the roundings delta of the strains of x make of it is at most
 * (sum k delta^2)^(1/2) in the norm E^(1/2) (sparse.c); what x leaves open of the constraints
 * their forces pay for.
 */
#include "modal/sparse_priv.h"

#include <float.h>
#include <math.h>

#include "linalg/dense.h"

/* Of everything else in a solution. */
static const double OTHER_ULPS = 64.0;

struct mt_sparse_solver {
    mt_sparse_problem p;
    mt_sparse s;
    mt_arena *mem;
};

/* The factor with a shift, from the least stiffness of constraints on. */
static mt_status factor_with_shift(mt_sparse_solver *o, double shift, bool *sound, mt_err *err)
{
    const int tries = mt_sparse_tries(&o->p);
    *sound = false;
    for (int i = 0; i < tries && !*sound; i++) {
        const mt_arena_mark mark = mt_arena_get_mark(o->mem);
        o->s = mt_sparse_try(&o->p, i, o->mem);
        MT_TRY(mt_sparse_prepare(&o->s, err));
        MT_TRY(mt_sparse_factor(&o->s, shift, sound, err));
        if (!*sound) {
            mt_arena_rewind(o->mem, mark);
        }
    }
    return MT_OK;
}

mt_status mt_sparse_solver_new(const mt_sparse_problem *p, bool held, double lambda,
                               mt_arena *mem, mt_sparse_solver **out, mt_err *err)
{
    mt_sparse_solver *const o = mt_arena_alloc(mem, 1, sizeof *o);
    bool sound = false;
    *out = NULL;
    MT_TRY(mt_arena_check(mem, err));
    *o = (mt_sparse_solver){.p = *p, .mem = mem};
    if (held) {
        MT_TRY(factor_with_shift(o, 0.0, &sound, err));
    }
    if (!sound) {
        MT_TRY(factor_with_shift(o, lambda, &sound, err));
    }
    *out = sound ? o : NULL;
    return MT_OK;
}

double mt_sparse_solver_shift(const mt_sparse_solver *o)
{
    return o->s.shift;
}

void mt_sparse_solver_mass(mt_sparse_solver *o, const double *x, double *y)
{
    mt_sparse_metric(&o->s, x, y);
}

void mt_sparse_solver_stiffness(mt_sparse_solver *o, const double *x, double *y)
{
    mt_sparse_metric(&o->s, x, y);
    for (int j = 0; j < o->p.n; j++) {
        y[j] *= -o->s.shift;
    }
    mt_sparse_subtract(&o->s, x, y);
    for (int j = 0; j < o->p.n; j++) {
        y[j] = -y[j];
    }
}

mt_status mt_sparse_solver_solve(mt_sparse_solver *o, const double *f, double *x, double *noise,
                                 mt_err *err)
{
    mt_sparse *const s = &o->s;
    const mt_sparse_problem *const p = &o->p;
    double k_noise = 0.0;
    double m_noise = 0.0;
    MT_TRY(mt_sparse_solve(s, 1, f, MT_SPARSE_SOLVED, x, err));
    if (noise == NULL) {
        return MT_OK;
    }
    const double size = sqrt(fmax(mt_dot(p->n, x, f), 0.0));
    double other = mt_sparse_load_noise(s, x);
    (void)mt_sparse_energy(&p->k, x, &k_noise);
    (void)mt_sparse_energy(&p->m, x, &m_noise);
    for (int r = 0; r < p->a.n_rows; r++) {
        other += fabs(s->mu[r] * mt_rows_dot(&p->a, r, x));
    }
    *noise = sqrt(k_noise + (s->shift * m_noise)) + (OTHER_ULPS * DBL_EPSILON * size) +
             (size > 0.0 ? other / size : 0.0);
    return MT_OK;
}
