/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Descent on the energy along the constraints: the reduced Hessian with the signs of its
 * eigenvalues made positive gives a direction that leads downhill, the step is halved until the
 * energy, evaluated back on the constraints, is lower. It ends near a stable equilibrium, or in
 * a saddle where symmetry leads into it; Newton finishes.
 */
#include "mechanics/newton_descent.h"

#include <math.h>
#include <string.h>

enum { DESCENT_LIMIT = 400, HALVINGS = 30, RESTORE_LIMIT = 20 };
/* First step out of a saddle [model lengths, rad]. */
static const double OUT = 0.1;

/* Back to the constraints by least-norm steps. */
static mt_status restore_constraints(mt_newton_work *w, mt_placement *at, mt_arena *mem,
                                     mt_err *err)
{
    for (int it = 0; it < RESTORE_LIMIT; it++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        mt_elimination e;
        mt_newton_evaluate(w, at, false);
        if (mt_newton_gap_of(w) <= MT_STEP_DONE) {
            return MT_OK;
        }
        double *const minus_c = mt_arena_f64(mem, (size_t)w->p->m, 1);
        MT_TRY(mt_arena_check(mem, err));
        for (int i = 0; i < w->p->m; i++) {
            minus_c[i] = -w->c[i];
        }
        MT_TRY(mt_eliminate(w->sys, w->p->m, w->a, mem, &e, err));
        MT_TRY(mt_eliminate_particular(&e, minus_c, w->step, mem, err));
        w->moved = mt_newton_scaled_norm(w, w->step);
        mt_newton_take_step(w, at, MT_STEP_LIMIT);
        mt_arena_rewind(mem, mark);
    }
    return mt_fail(err, MT_E_ASSEMBLY, "the joints do not stay closed");
}

/* One direction: eigenvalues of the reduced Hessian made positive, freedoms without stiffness
 * given the softest stiffness that keeps the step short. */
static mt_status direction_of(mt_newton_work *w, const mt_elimination *e, mt_arena *mem,
                              mt_err *err)
{
    const int n = e->n;
    double *const k = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const values = mt_arena_f64(mem, (size_t)n, 1);
    double *const eta = mt_arena_f64(mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_newton_reduce_hessian(w, e, k, n, mem, err));
    mt_eliminate_project(e, w->g, w->reduced);
    const double soft = mt_norm2(n, w->reduced) / (MT_STEP_LIMIT * w->sys->length_m);
    MT_TRY(mt_eig_sym(n, k, values, true, mem, err));
    for (int i = 0; i < n; i++) {
        const double *const vec = k + ((ptrdiff_t)i * n);
        mt_axpy(n, -mt_dot(n, vec, w->reduced) / fmax(fabs(values[i]), soft), vec, eta);
    }
    mt_eliminate_expand(e, eta, w->step);
    w->moved = mt_newton_scaled_norm(w, w->step);
    return MT_OK;
}

/* Halve the step until the energy is lower; *lower: it is, otherwise the poses are restored. */
static mt_status search_line(mt_newton_work *w, mt_placement *at, double *energy, bool *lower,
                             mt_arena *mem, mt_err *err)
{
    const size_t nq = (size_t)w->sys->nq;
    const size_t n = (size_t)w->sys->n_bodies;
    const double full = w->moved;
    double length = fmin(full, MT_STEP_LIMIT);
    double *const direction = mt_arena_f64(mem, nq, 1);
    mt_pose *const kept = mt_arena_alloc(mem, n, sizeof *kept);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(direction, w->step, nq * sizeof *direction);
    memcpy(kept, at->pose, n * sizeof *kept);
    *lower = false;
    for (int half = 0; half < HALVINGS && !*lower; half++) {
        memcpy(at->pose, kept, n * sizeof *kept);
        memcpy(w->step, direction, nq * sizeof *direction);
        w->moved = full;
        mt_newton_take_step(w, at, length);
        const mt_status rc = restore_constraints(w, at, mem, NULL);
        if (rc == MT_OK) {
            const double now = mt_energy_value(w->p->data, at, w->tau);
            *lower = now < *energy;
            *energy = *lower ? now : *energy;
        } else if (rc != MT_E_ASSEMBLY && rc != MT_E_DOMAIN) {
            return mt_fail_memory(err);
        }
        length *= 0.5;
    }
    if (*lower) {
        mt_newton_follow(w, at);
    } else {
        memcpy(at->pose, kept, n * sizeof *kept);
    }
    return MT_OK;
}

mt_status mt_newton_leave_saddle(mt_newton_work *w, mt_placement *at, bool *lower,
                                 mt_arena *mem, mt_err *err)
{
    const int nq = w->sys->nq;
    double *const out = mt_arena_f64(mem, (size_t)nq, 1);
    MT_TRY(mt_newton_dense(w, mem, err));
    double energy = mt_energy_value(w->p->data, at, w->tau);
    *lower = false;
    MT_TRY(mt_arena_check(mem, err));
    const double size = mt_newton_scaled_norm(w, w->step);
    mt_axpy(nq, size > 0.0 ? OUT / size : 0.0, w->step, out);
    for (int side = 0; side < 2 && !*lower; side++) {
        memcpy(w->step, out, (size_t)nq * sizeof *out);
        w->moved = OUT;
        MT_TRY(search_line(w, at, &energy, lower, mem, err));
        for (int j = 0; j < nq; j++) {
            out[j] = -out[j];
        }
    }
    return MT_OK;
}

mt_status mt_newton_descend(mt_newton_work *w, mt_placement *at, mt_arena *mem, mt_err *err)
{
    MT_TRY(mt_newton_dense(w, mem, err));
    MT_TRY(restore_constraints(w, at, mem, err));
    double energy = mt_energy_value(w->p->data, at, w->tau);
    bool lower = true;
    for (int it = 0; it < DESCENT_LIMIT && lower; it++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        const double tau = w->tau;
        mt_newton_solver solver;
        MT_TRY(mt_newton_linearise(w, at, mem, &solver, err));
        w->tau = tau; /* the force of the trimmed spring stands while the energy is compared */
        lower = w->residual > MT_FORCE_DONE + (MT_NOISE_ROOM * w->noise);
        if (lower) { /* not lower: as low as rounding lets us see, Newton decides */
            MT_TRY(direction_of(w, &solver.e, mem, err));
            MT_TRY(search_line(w, at, &energy, &lower, mem, err));
        }
        mt_arena_rewind(mem, mark);
    }
    return MT_OK;
}
