/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Least values of an objective over boxes: exact for the change (a sum of one term for each
 * variable), by intervals for masses and expressions. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "search/proof.h"

/* Sums of n terms and the logarithms in them are rounded by less than this many times n eps. */
static const double ROUNDING_ULPS = 16.0;

static double least_change(const mt_problem *p, const double *lo, const double *hi)
{
    double f = 0.0;
    for (int i = 0; i < p->n; i++) {
        const double below = p->origin_t[i] - mt_problem_t(p, i, hi[i]);
        const double above = mt_problem_t(p, i, lo[i]) - p->origin_t[i];
        const double d = fmax(fmax(below, above), 0.0);
        f += 0.5 * p->study->variables[i].weight * d * d;
    }
    return f * (1.0 - (ROUNDING_ULPS * (double)p->n * DBL_EPSILON));
}

static double least_mass(const mt_proof_cap *c, const double *lo, const double *hi)
{
    const mt_aim *const a = &c->p->aims[0];
    double f = 0.0;
    mt_program_interval(&c->p->views[0].analysis->sys->program, lo, hi, c->low, c->high);
    for (int k = 0; k < a->n_mass; k++) {
        f += c->low[a->mass[k]];
    }
    return f - (ROUNDING_ULPS * (double)a->n_mass * DBL_EPSILON * fabs(f));
}

static double least(void *context, const double *lo, const double *hi)
{
    const mt_proof_cap *const c = context;
    switch (c->p->aims[0].type) {
    case MT_OBJECTIVE_CHANGE:
        return least_change(c->p, lo, hi);
    case MT_OBJECTIVE_MASS:
        return least_mass(c, lo, hi);
    case MT_OBJECTIVE_EXPRESSION:
        mt_program_interval(&c->p->program, lo, hi, c->low, c->high);
        return c->low[c->p->aims[0].node];
    case MT_OBJECTIVE_NONE:
    case MT_OBJECTIVE_MISFIT:
    case MT_OBJECTIVE_CLEARANCE:
        break;
    }
    return -HUGE_VAL;
}

mt_status mt_proof_cap_init(mt_proof_cap *c, mt_problem *p, mt_arena *mem, mt_err *err)
{
    const mt_objective_type type = p->aims[0].type;
    const bool mass = type == MT_OBJECTIVE_MASS && p->n_views > 0;
    const int count = mass ? p->views[0].analysis->sys->program.count : p->program.count;
    *c = (mt_proof_cap){.p = p};
    c->known = type == MT_OBJECTIVE_CHANGE || mass || type == MT_OBJECTIVE_EXPRESSION;
    c->low = mt_arena_f64(mem, (size_t)count, 1);
    c->high = mt_arena_f64(mem, (size_t)count, 1);
    c->cap = (mt_certify_cap){.least = least, .context = c};
    return c->low == NULL || c->high == NULL ? mt_fail_memory(err) : MT_OK;
}
