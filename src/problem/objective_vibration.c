/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * "vibration": f = the largest of ln(value / limit) over all goals of forced vibration that are
 * limited from above. In a search that is the last coordinate less MT_FORCED_RESPONSE_SHIFT,
 * which every row of these goals has to stay below (requirement.c): a minimax is smooth so.
 * Elsewhere it is looked up.
 */
#include <math.h>

#include "problem/objective.h"
#include "problem/requirement.h"

static const double PERCENT = 100.0;

static double evaluate_worst_vibration(const mt_workspace *w, const mt_objective_stage *a,
                                       double *gradient)
{
    (void)a;
    if (gradient != NULL && w->c->forced_response) {
        gradient[w->p->n] = 1.0;
    }
    return mt_forced_response_given(w) ? w->t[w->p->n] - MT_FORCED_RESPONSE_SHIFT : w->worst;
}

static double shown(double f)
{
    return PERCENT * exp(f);
}

static const char *vibration_price(const mt_price *q, mt_arena *mem)
{
    return mt_arena_printf(mem, "the largest part of a limit by %.3g percentage points",
                           q->score * q->df);
}

const mt_objective_ops mt_objective_vibration = {
    .value = evaluate_worst_vibration, .shown = shown, .price = vibration_price};
