/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * "clearance": f = -ln(1 + least clearance of any mode from any band). In the search of one gap
 * assignment that is the last coordinate, which every row of a band has to exceed
 * (goal_avoid.c); elsewhere mt_avoidances_margin looks it up among the modes.
 */
#include <math.h>

#include "problem/objective.h"

static const double PERCENT = 100.0;

static double evaluate_clearance(const mt_workspace *w, const mt_objective_stage *a,
                                 double *gradient)
{
    (void)a;
    if (w->c->clearance && gradient != NULL) {
        gradient[w->p->n] = -1.0;
    }
    return w->c->clearance ? -w->t[w->p->n] : 0.0;
}

static double shown(double f)
{
    return PERCENT * expm1(-f);
}

static const char *clearance_price(const mt_price *q, mt_arena *mem)
{
    return mt_arena_printf(mem, "the least clearance by %.3g percentage points",
                           (PERCENT + q->score) * q->df);
}

const mt_objective_ops mt_objective_clearance = {
    .value = evaluate_clearance, .shown = shown, .price = clearance_price};
