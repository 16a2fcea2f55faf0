/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "mass": f = sum of the masses of the items named, those of the first configuration that a
 * goal names. */
#include <float.h>
#include <math.h>

#include "base/text.h"
#include "problem/objective.h"

static bool counted(const mt_objective *o, const char *name)
{
    for (int i = 0; i < o->of.count; i++) {
        if (mt_text_matches(o->of.items[i].s, name)) {
            return true;
        }
    }
    return o->of.count == 0;
}

static mt_status compile_mass_objective(mt_problem *p, mt_objective_stage *a,
                                        const mt_node *nodes, mt_err *err)
{
    int view = 0;
    (void)nodes;
    if (p->n_views == 0) {
        MT_TRY(mt_problem_add_configuration(p, 0, &view, err));
    }
    const mt_system *const sys = p->views[view].original->sys;
    a->mass = mt_arena_alloc(&p->mem, (size_t)sys->n_items, sizeof *a->mass);
    MT_TRY(mt_arena_check(&p->mem, err));
    for (int i = 0; i < sys->n_items; i++) {
        if (sys->items[i].mass != MT_NO_NODE && counted(a->objective, sys->items[i].name)) {
            a->mass[a->n_mass++] = sys->items[i].mass;
        }
    }
    if (a->n_mass == 0) {
        return mt_fail(err, MT_E_INPUT,
                       "objective \"mass\": nothing that is meant is part of configuration "
                       "\"%s\", the first that a goal names",
                       mt_analysis_configuration(p->views[view].original));
    }
    return MT_OK;
}

static double evaluate_mass(const mt_workspace *w, const mt_objective_stage *a,
                            double *gradient)
{
    const mt_linear *const lin = w->views[0].analysis->lin;
    double f = 0.0;
    for (int k = 0; k < a->n_mass; k++) {
        f += mt_linear_value(lin, a->mass[k]);
        for (int i = 0; i < w->p->n && gradient != NULL; i++) {
            gradient[i] += mt_workspace_dx_dt(w, i) * mt_linear_slope(lin, a->mass[k], i);
        }
    }
    return f;
}

static double least(const mt_problem *p, const mt_objective_stage *a, const double *lo,
                    const double *hi, double *low, double *high)
{
    double f = 0.0;
    mt_program_interval(&p->views[0].original->sys->program, lo, hi, low, high);
    for (int k = 0; k < a->n_mass; k++) {
        f += low[a->mass[k]];
    }
    return f - (MT_OBJECTIVE_ULPS * (double)a->n_mass * DBL_EPSILON * fabs(f));
}

static const char *mass_price(const mt_price *q, mt_arena *mem)
{
    return q->first && fabs(q->df) > q->score
               ? NULL
               : mt_arena_printf(mem, "the mass by %.3g kg", q->df);
}

static const char *hardly(const mt_price *q, mt_arena *mem)
{
    return !q->first || !(q->df > q->score)
               ? NULL
               : mt_arena_printf(mem, "1 %% of it is worth more than the whole mass");
}

const mt_objective_ops mt_objective_mass = {.compile = compile_mass_objective,
                                            .value = evaluate_mass,
                                            .least = least,
                                            .price = mass_price,
                                            .hardly = hardly};
