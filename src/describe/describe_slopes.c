/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Slopes of the values of goals over the variables, at a design that has been described. */
#include <math.h>
#include <string.h>

#include "describe/describe.h"
#include "problem/configuration.h"
#include "problem/evaluate.h"
#include "problem/goals.h"
#include "problem/requirement.h"

static bool is_same_name(const char *a, const char *b)
{
    return a == NULL || b == NULL ? a == b : strcmp(a, b) == 0;
}

/* Derivatives of a frequency, computed with it: NULL where its mode repeats. */
static double *of_frequency(const mt_recommendation *rec, const mt_result_goal *g)
{
    for (int i = 0; i < rec->n_frequencies; i++) {
        const mt_result_frequency *const f = &rec->frequencies[i];
        const bool mode = g->name != NULL ? is_same_name(f->name, g->name) : f->mode == g->mode;
        if (mode && is_same_name(f->configuration, g->configuration)) {
            return f->repeated ? NULL : f->sensitivity;
        }
    }
    return NULL;
}

/* Derivatives of another value, from its slope over t. */
static mt_status of_value(mt_workspace *fresh, const mt_requirement *d, mt_result *result,
                          mt_result_goal *g, mt_err *err)
{
    const int n = fresh->p->n;
    int pos = -1;
    double q = nan("");
    const bool modal = mt_requirement_is_modal(d);
    if (d->view >= 0) {
        mt_configuration_work *const view = &fresh->views[d->view];
        mt_configuration_query_all(view);
        view->ask.vectors = true;
        MT_TRY(mt_configuration_solve(fresh, view, true, err));
        MT_TRY(modal ? mt_configuration_position(fresh, view, d->mode, d->named, &pos, err)
                     : MT_OK);
        if (modal && pos < 0) {
            return MT_OK;
        }
    }
    MT_TRY(d->ops->value(fresh, d, pos, &q, fresh->slope, err));
    double *const slopes = mt_arena_f64(&result->mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < n; i++) {
        /* slopes of logarithms are those of ln q */
        slopes[i] = (d->measure == MT_MEASURE_RATIO ? q : 1.0) * fresh->slope[i] /
                    mt_workspace_dx_dt(fresh, i);
    }
    g->sensitivity = slopes;
    return MT_OK;
}

mt_status mt_describe_slopes(mt_workspace *fresh, const mt_design *design, mt_result *result,
                             mt_recommendation *rec, mt_err *err)
{
    bool placed = false;
    for (int i = 0; i < fresh->p->n_requirements; i++) {
        const mt_requirement *const d = &fresh->p->requirements[i];
        mt_result_goal *const g = &rec->goals[i];
        mt_err own = {.code = MT_OK};
        mt_status rc = MT_OK;
        if (d->quantity == MT_QUANTITY_FREQUENCY) {
            g->sensitivity = of_frequency(rec, g);
        } else if (d->ops->value != NULL && isfinite(g->value)) {
            rc = placed ? MT_OK : mt_workspace_place(fresh, design->t, true, &own);
            placed = true;
            rc = rc == MT_OK ? of_value(fresh, d, result, g, &own) : rc;
        }
        MT_TRY(mt_pass_final(rc, &own, err)); /* else it has none */
    }
    return MT_OK;
}
