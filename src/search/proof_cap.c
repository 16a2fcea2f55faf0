/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Least values of the first objective over boxes. */
#include <math.h>

#include "problem/objective.h"
#include "search/proof.h"

static double least_cap_value(void *context, const double *lo, const double *hi)
{
    const mt_proof_cap *const c = context;
    const mt_objective_stage *const a = &c->p->stages[0];
    return c->known ? a->ops->least(c->p, a, lo, hi, c->low, c->high) / a->size : -HUGE_VAL;
}

mt_status mt_proof_cap_init(mt_proof_cap *c, const mt_problem *p, mt_arena *mem, mt_err *err)
{
    const int own = p->program.count;
    const int system = p->n_views > 0 ? p->views[0].original->sys->program.count : 0;
    const size_t count = (size_t)(own > system ? own : system);
    *c = (mt_proof_cap){.p = p,
                        .known = p->stages[0].ops->least != NULL,
                        .low = mt_arena_f64(mem, count, 1),
                        .high = mt_arena_f64(mem, count, 1),
                        .cap = {.least = least_cap_value, .context = c}};
    return mt_arena_check(mem, err);
}
