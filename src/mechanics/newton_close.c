/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Back to the constraints by the smallest steps, and nothing else: with c and A at q
 *     v = -A^+ c,      q <- q (+) v,
 * which converges quadratically where A has full rank. The end is next to the start to first
 * order, and no multiplier, no curvature and no second factor is needed: a third of the work of
 * a step of newton_step.c.
 */
#include <float.h>
#include <math.h>

#include "mechanics/newton_step.h"

/* Beside a regular position the second step is rounding already. */
enum { CLOSE_LIMIT = 8 };
/* Each step leaves at most this part of the gap: towards a dead centre it leaves a quarter. */
static const double CONTRACTION = 0.1;
/* A gap of that many eps is none, model lengths. */
static const double NO_GAP = 8.0;

/* Evaluate w->c and the Jacobian for a step. */
static mt_status evaluate_constraints(mt_newton_work *w, const mt_placement *at, bool dense,
                                      mt_arena *mem, mt_err *err)
{
    if (dense) {
        MT_TRY(mt_newton_dense(w, mem, err));
    }
    mt_lagrangian_eval(w->p->data, MT_ENERGY_NONE, NULL, at, w->p->m, NULL, MT_CURVATURE_NONE,
                       dense ? &w->l : &w->sparse);
    return MT_OK;
}

/* w->step := -A^+ c. Sparse, *sure: no equation depends on others; dense, where some do: the
 * step of the independent ones, which closes all where they agree. */
static mt_status step_back(mt_newton_work *w, bool dense, mt_arena *mem, bool *sure,
                           mt_err *err)
{
    for (int i = 0; i < w->p->m; i++) {
        w->turn[i] = -w->c[i];
    }
    if (dense) {
        mt_elimination e;
        *sure = true;
        MT_TRY(mt_eliminate_factor(w->sys, w->p->m, w->a, mem, &e, err));
        return mt_eliminate_particular(&e, w->turn, w->step, mem, err);
    }
    mt_saddle least;
    MT_TRY(mt_newton_least_squares(w, false, mem, &least, sure, err));
    return *sure ? mt_saddle_solve(&least, NULL, w->turn, w->step, NULL, mem, err) : MT_OK;
}

mt_status mt_newton_close(const mt_newton_problem *problem, double enough, mt_placement *at,
                          int *iterations, bool *closed, mt_arena *mem, mt_err *err)
{
    mt_newton_work w;
    double before = HUGE_VAL;
    *closed = false;
    MT_TRY(mt_newton_work_init(&w, problem, mem, err));
    bool dense = w.least == NULL;
    w.turn = mt_arena_f64(mem, (size_t)problem->m, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(evaluate_constraints(&w, at, dense, mem, err));
    for (int it = 0; it < CLOSE_LIMIT; it++) {
        const double gap = mt_newton_gap_of(&w);
        const bool shrinks = gap <= CONTRACTION * before;
        *closed = gap <= fmax(enough, NO_GAP * DBL_EPSILON) ||
                  (gap <= MT_STEP_DONE && before <= MT_STEP_DONE && !shrinks);
        if (*closed || !(shrinks || gap <= MT_STEP_DONE)) {
            return MT_OK;
        }
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        bool sure = false;
        MT_TRY(step_back(&w, dense, mem, &sure, err));
        mt_arena_rewind(mem, mark);
        if (!sure) {
            dense = true;
            MT_TRY(evaluate_constraints(&w, at, dense, mem, err));
            MT_TRY(step_back(&w, dense, mem, &sure, err));
        }
        ++*iterations;
        w.moved = mt_newton_scaled_norm(&w, w.step);
        if (!(w.moved <= MT_STEP_LIMIT)) {
            return MT_OK;
        }
        mt_newton_take_step(&w, at, MT_STEP_LIMIT);
        MT_TRY(evaluate_constraints(&w, at, dense, mem, err));
        before = gap;
    }
    return MT_OK;
}
