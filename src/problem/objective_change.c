/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "change": f = 1/2 sum w_i (t_i - t_i(original))^2, of which each term is least at the end of
 * a box that is nearer to the original. */
#include <float.h>
#include <math.h>

#include "problem/objective.h"

static double evaluate_change(const mt_workspace *w, const mt_objective_stage *a,
                              double *gradient)
{
    double f = 0.0;
    (void)a;
    for (int i = 0; i < w->p->n; i++) {
        const double weight = w->p->study->variables[i].weight;
        const double d = w->t[i] - w->c->origin_t[i];
        f += 0.5 * weight * d * d;
        if (gradient != NULL) {
            gradient[i] = weight * d;
        }
    }
    return f;
}

/* Distance of a box from the original in coordinate i, less the rounding of its two logarithms
 * or quotients: near the original their difference has few digits. */
static double apart(const mt_problem *p, int i, double lo, double hi)
{
    const double origin = p->whole.origin_t[i];
    const double low = mt_problem_t(p, i, lo);
    const double high = mt_problem_t(p, i, hi);
    const double d = origin > high ? origin - high : low - origin;
    const double size = fmax(fabs(origin), fmax(fabs(low), fabs(high)));
    return fmax(d - (MT_OBJECTIVE_ULPS * DBL_EPSILON * size), 0.0);
}

static double least(
    const mt_problem *p, const mt_objective_stage *a, const double *lo, const double *hi,
    double *low,  /* NOLINT(readability-non-const-parameter): others write there */
    double *high) /* NOLINT(readability-non-const-parameter) */
{
    double f = 0.0;
    (void)a;
    (void)low;
    (void)high;
    for (int i = 0; i < p->n; i++) {
        const double d = apart(p, i, lo[i], hi[i]);
        f += 0.5 * p->study->variables[i].weight * d * d;
    }
    return f * (1.0 - (MT_OBJECTIVE_ULPS * (double)p->n * DBL_EPSILON));
}

/* dc = df / c, within a sixth of c - sqrt(c^2 - 2 df) up to a quarter of c^2. */
static const char *change_price(const mt_price *q, mt_arena *mem)
{
    return !(q->change > 0.0) || fabs(q->df) > 0.25 * q->change * q->change
               ? NULL
               : mt_arena_printf(mem, "the total change by %.3g %%",
                                 100.0 * q->df / (q->change * q->change));
}

/* At the optimum c u = mult g + ..., u of unit length: with the other rows held, the slope of
 * the requirement by the variables is at most c / mult. */
static const char *hardly(const mt_price *q, mt_arena *mem)
{
    return !(q->change > 0.0) || !(q->df > q->change)
               ? NULL
               : mt_arena_printf(mem, "moving it by 1 %% takes a total change of %.2g or more",
                                 q->df / q->change);
}

const mt_objective_ops mt_objective_change = {
    .value = evaluate_change, .least = least, .price = change_price, .hardly = hardly};
