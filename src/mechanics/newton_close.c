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

mt_status mt_newton_close(const mt_newton_problem *problem, double enough, mt_placement *at,
                          int *iterations, bool *closed, mt_arena *mem, mt_err *err)
{
    mt_newton_work w;
    double before = HUGE_VAL;
    *closed = false;
    MT_TRY(mt_newton_work_init(&w, problem, mem, err));
    for (int it = 0; it < CLOSE_LIMIT && w.least != NULL; it++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        mt_saddle least;
        bool sure = false;
        mt_lagrangian_eval(problem->data, problem->energy, problem->drawn, at, problem->m, NULL,
                           MT_CURVATURE_NONE, &w.sparse);
        const double gap = mt_newton_gap_of(&w);
        const bool shrinks = gap <= CONTRACTION * before;
        *closed = gap <= fmax(enough, NO_GAP * DBL_EPSILON) ||
                  (gap <= MT_STEP_DONE && before <= MT_STEP_DONE && !shrinks);
        if (*closed || !(shrinks || gap <= MT_STEP_DONE)) {
            return MT_OK;
        }
        MT_TRY(mt_newton_least_squares(&w, false, mem, &least, &sure, err));
        if (!sure) {
            return MT_OK;
        }
        for (int i = 0; i < problem->m; i++) {
            w.turn[i] = -w.c[i];
        }
        MT_TRY(mt_saddle_solve(&least, NULL, w.turn, w.step, NULL, mem, err));
        ++*iterations;
        w.moved = mt_newton_scaled_norm(&w, w.step);
        if (!(w.moved <= MT_STEP_LIMIT)) {
            return MT_OK;
        }
        mt_newton_take_step(&w, at, MT_STEP_LIMIT);
        mt_arena_rewind(mem, mark);
        before = gap;
    }
    return MT_OK;
}
