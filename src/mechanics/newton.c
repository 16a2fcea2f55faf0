/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One stage of the position analysis from start to verdict: plain Newton (newton_step.c); where that does not converge under the physical energy, descent first. */
#include "mechanics/newton_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "mechanics/singular.h"

enum { NEWTON_LIMIT = 60, WHERE_SIZE = 300 };
/* Rounding of the largest single spring force, summed over many springs and projected, stays below this many times itself. */
static const double NOISE_ROOM = 32.0;

static mt_status keep(const mt_newton_work *w, const mt_elimination *e, double *inverse,
                      mt_arena *mem, mt_state *report, mt_stage *stage, mt_err *err)
{
    const size_t nq = (size_t)w->sys->nq;
    const size_t m = (size_t)w->p->m;
    stage->active = true;
    stage->m = w->p->m;
    stage->e = *e;
    stage->order = e->n + (w->p->trim ? 1 : 0);
    stage->inverse = inverse;
    stage->null_freedoms = w->null_freedoms;
    stage->lambda = mt_arena_f64(mem, m, 1);
    stage->h = mt_arena_f64(mem, nq, nq);
    stage->a = mt_arena_f64(mem, m, nq);
    stage->trim = mt_arena_f64(mem, nq, 1);
    if (stage->lambda == NULL || stage->h == NULL || stage->a == NULL || stage->trim == NULL) {
        return mt_fail_memory(err);
    }
    memcpy(stage->lambda, w->lambda, m * sizeof *stage->lambda);
    memcpy(stage->h, w->h, nq * nq * sizeof *stage->h);
    memcpy(stage->a, w->a, m * nq * sizeof *stage->a);
    memcpy(stage->trim, w->trim, nq * sizeof *stage->trim);
    if (w->p->energy == MT_ENERGY_PHYSICAL) {
        report->residual = w->residual;
        report->trim_force = w->tau;
    }
    return MT_OK;
}

/* Plain Newton from the present position; *done tells whether it converged. */
static mt_status iterate(mt_newton_work *w, mt_pose *poses, mt_arena *mem, mt_state *report,
                         mt_stage *stage, bool *done, mt_err *err)
{
    double previous = HUGE_VAL;
    double unbalanced = HUGE_VAL;
    *done = false;
    for (int it = 0; it < NEWTON_LIMIT; it++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        mt_elimination e;
        double *inverse = NULL;
        const double tau = w->tau;
        MT_TRY(mt_newton_linearise(w, poses, mem, &e, &inverse, err));
        if (it == 0 && w->p->energy == MT_ENERGY_PHYSICAL && w->gap <= MT_STEP_DONE) {
            MT_TRY(
                mt_singular_refuse(w->p->data, poses, &e, mem, err)); /* several ways lead on */
        }
        report->iterations++;
        /* stop where the step is rounding: small, and no longer shrinking or negligible */
        const bool small = w->moved <= MT_STEP_DONE &&
                           (w->moved >= 0.25 * previous || w->moved <= 8.0 * DBL_EPSILON);
        if (small && w->gap <= MT_STEP_DONE) {
            if (w->residual <= MT_FORCE_DONE + (NOISE_ROOM * w->noise)) {
                w->tau = tau;
                *done = true;
                return keep(w, &e, inverse, mem, report, stage, err);
            }
            if (!w->p->trim || w->residual >= 0.25 * unbalanced) {
                return MT_OK; /* something pushes along a freedom without stiffness */
            }                 /* else the force of the trimmed spring is still settling */
        }
        previous = w->moved;
        unbalanced = w->residual;
        mt_newton_take_step(w, poses, MT_STEP_LIMIT);
        mt_arena_rewind(mem, mark);
        if (!(w->moved < HUGE_VAL)) {
            return MT_OK;
        }
    }
    return MT_OK;
}

/* A position that is not a number ends the iteration, not the analysis: the start may be bad. */
static mt_status attempt(mt_newton_work *w, mt_pose *poses, mt_arena *mem, mt_state *report,
                         mt_stage *stage, bool *done, mt_err *err)
{
    const mt_status rc = iterate(w, poses, mem, report, stage, done, err);
    return rc == MT_E_DOMAIN || rc == MT_E_NO_CONVERGENCE ? MT_OK : rc;
}

static mt_status refuse(mt_newton_work *w, const mt_pose *poses, mt_arena *mem,
                        const mt_state *report, mt_err *err)
{
    mt_elimination e;
    double *inverse = NULL;
    memset(w->lambda, 0, (size_t)w->p->m * sizeof *w->lambda);
    mt_newton_evaluate(w, poses, false);
    MT_TRY(mt_eliminate(w->sys, w->p->m, w->a, mem, &e, err));
    if (!(mt_newton_gap_of(w) <= MT_STEP_DONE)) {
        return mt_newton_open_loop(w->p, poses, &e, mem, err);
    }
    MT_TRY(mt_newton_linearise(w, poses, mem, &e, &inverse, err));
    char where[WHERE_SIZE];
    mt_eliminate_project(&e, w->g, w->reduced);
    mt_position_name_motion(w->sys, &e, w->reduced, where, sizeof where);
    return mt_fail(err, MT_E_EQUILIBRIUM,
                   "no equilibrium found after %d iterations: %.3g of the forces at work stay "
                   "unbalanced on %s (free to move under load?)",
                   report->iterations, w->residual, where);
}

mt_status mt_newton_solve(const mt_newton_problem *problem, mt_pose *poses, mt_arena *mem,
                          mt_state *report, mt_stage *stage, mt_err *err)
{
    mt_newton_work w;
    bool done = false;
    const size_t n = (size_t)problem->data->sys->n_bodies;
    MT_TRY(mt_newton_work_init(&w, problem, mem, err));
    mt_pose *const start = mt_arena_alloc(mem, n, sizeof *start);
    if (start == NULL) {
        return mt_fail_memory(err);
    }
    memcpy(start, poses, n * sizeof *start);
    MT_TRY(attempt(&w, poses, mem, report, stage, &done, err));
    if (!done && problem->energy == MT_ENERGY_PHYSICAL) {
        memcpy(poses, start, n * sizeof *start);
        w.tau = 0.0;
        MT_TRY(mt_newton_descend(&w, poses, mem, err));
        MT_TRY(attempt(&w, poses, mem, report, stage, &done, err));
    }
    return done ? MT_OK : refuse(&w, poses, mem, report, err);
}

mt_status mt_newton_gap(const mt_newton_problem *problem, const mt_pose *poses, mt_arena *mem,
                        double *gap_m, mt_err *err)
{
    mt_newton_work w;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    MT_TRY(mt_newton_work_init(&w, problem, mem, err));
    mt_newton_evaluate(&w, poses, false);
    *gap_m = mt_newton_gap_of(&w) * w.sys->length_m;
    mt_arena_rewind(mem, mark);
    return MT_OK;
}
