/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/equilibrium_rounding.h"

#include "mechanics/linear_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "mechanics/newton_tangent.h"
#include "mechanics/products.h"

/* Roundings in a measure, and in the sum of the forces on a body. */
static const double ULPS = 4.0;

struct mt_equilibrium_rounding {
    mt_linear *lin;
    int m;             /* equations of the equilibrium; of the linearised system lin->m */
    double *pull;      /* [nq] */
    double *across;    /* [m] */
    double *mu;        /* [m] */
    double *x;         /* [nq] */
    double *y;         /* [m] */
    double *energy;    /* [n_pieces] e = phi^T H phi */
    double *bent;      /* [n_pieces][MT_LOCAL] H phi */
    double *roundness; /* [m] n of the joints */
};

mt_status mt_equilibrium_rounding_new(mt_linear *lin, mt_equilibrium_rounding **out,
                                      mt_err *err)
{
    mt_arena *const mem = &lin->scratch;
    *out = NULL;
    if (lin->pieces == NULL) {
        return MT_OK;
    }
    const size_t nq = (size_t)lin->sys->nq;
    const size_t m = (size_t)lin->sys->n_constraints;
    mt_equilibrium_rounding *const r = mt_arena_alloc(mem, 1, sizeof *r);
    MT_TRY(mt_arena_check(mem, err));
    r->lin = lin;
    r->m = lin->sys->n_constraints;
    r->pull = mt_arena_f64(mem, nq, 1);
    r->across = mt_arena_f64(mem, m, 1);
    r->mu = mt_arena_f64(mem, m, 1);
    r->x = mt_arena_f64(mem, nq, 1);
    r->y = mt_arena_f64(mem, m, 1);
    r->energy = mt_arena_f64(mem, (size_t)lin->n_pieces, 1);
    r->bent = mt_arena_f64(mem, (size_t)lin->n_pieces, MT_LOCAL);
    r->roundness = mt_arena_f64(mem, m, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < lin->n_pieces; i++) {
        const mt_piece *const p = &lin->pieces[i];
        if (p->equation >= 0) {
            r->roundness[p->equation] += fabs(p->factor) * p->roundness;
        }
    }
    *out = r;
    return MT_OK;
}

/* bent, energies and mu, A^T mu = (K - lambda M) phi; the sparse equations of the equilibrium,
 * where they are factored, have it with x = 0. */
static mt_status joint_forces(mt_equilibrium_rounding *r, double lambda, const double *phi,
                              mt_err *err)
{
    mt_linear *const lin = r->lin;
    const mt_newton_solver *const solver = &lin->position.equilibrium.solver;
    memset(r->pull, 0, (size_t)lin->sys->nq * sizeof *r->pull);
    mt_linear_rows_product(lin, lambda, phi, r->pull);
    for (int i = 0; i < lin->n_pieces; i++) {
        const mt_piece *const p = &lin->pieces[i];
        double *const bent = r->bent + ((ptrdiff_t)i * MT_LOCAL);
        r->energy[i] = mt_piece_bend(p, phi, bent);
        mt_piece_add(p, lin->kg != NULL ? p->force : 0.0, bent, r->pull);
    }
    return solver->sparse
               ? mt_saddle_solve(&solver->saddle, r->pull, NULL, NULL, r->mu, &lin->scratch,
                                 err)
               : mt_eliminate_multipliers(&lin->e, r->pull, r->mu, &lin->scratch, err);
}

/* Compute pull and across; returns the coefficient of the trimmed spring's force. */
static double sum_piece_forces(mt_equilibrium_rounding *r, const double *phi)
{
    const mt_linear *const lin = r->lin;
    double trim = 0.0;
    memset(r->pull, 0, (size_t)lin->sys->nq * sizeof *r->pull);
    memset(r->across, 0, (size_t)r->m * sizeof *r->across);
    for (int i = 0; i < lin->n_pieces; i++) {
        const mt_piece *const p = &lin->pieces[i];
        const mt_piece *const other = p + p->partner;
        const double *const bent = r->bent + ((ptrdiff_t)i * MT_LOCAL);
        if (p->equation >= 0) {
            r->across[p->equation] += p->factor * r->energy[i];
            mt_piece_add(p, p->equation < lin->m ? -2.0 * p->factor * r->mu[p->equation] : 0.0,
                         bent, r->pull);
            continue;
        }
        mt_piece_add(p, 2.0 * p->stiffness * mt_piece_work(other, phi), bent, r->pull);
        if (p->trimmed) {
            trim += r->energy[i];
        } else {
            mt_piece_add(other, p->stiffness * r->energy[i], other->g, r->pull);
        }
    }
    return trim;
}

mt_status mt_equilibrium_rounding_of(mt_equilibrium_rounding *r, double lambda,
                                     const double *phi, double *noise, mt_err *err)
{
    mt_linear *const lin = r->lin;
    const mt_system *const sys = lin->sys;
    double sum = 0.0;
    MT_TRY(joint_forces(r, lambda, phi, err));
    const double trim = sum_piece_forces(r, phi);
    MT_TRY(mt_newton_adjoint(&lin->position.equilibrium, r->pull, r->across, trim, r->x, r->y,
                             &lin->scratch, err));
    for (int i = 0; i < lin->n_pieces; i++) {
        const mt_piece *const p = &lin->pieces[i];
        const double way = fabs(r->energy[i] - mt_piece_work(p, r->x));
        if (p->equation < 0 && !p->trimmed) {
            sum += way *
                   ((fabs(p->stiffness) * p[p->partner].roundness) + (DBL_EPSILON * p->size));
        }
    }
    for (int i = 0; i < r->m; i++) {
        sum += fabs(r->y[i]) * r->roundness[i];
    }
    for (int b = 0; b < sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            const int dof = sys->bodies[b].dof[k];
            const double arm = k < 3 ? 1.0 : sys->length_m;
            sum += dof >= 0 ? DBL_EPSILON * lin->push[b] * arm * fabs(r->x[dof]) : 0.0;
        }
    }
    *noise = ULPS * sum;
    return MT_OK;
}
