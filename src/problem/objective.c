/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Objectives of any kind, and how those that come first are held while the next one is
 * searched. */
#include "problem/objective.h"

#include <math.h>

/* An objective is held within this part of its value (of its size, where it is below that). */
static const double HELD = 1e-6;
/* The same for the objectives that are half a square, of the root where it is below 1: a change
 * or a misfit of 1e-6 is none to an engineer. */
static const double HELD_ROOT = 1e-6;
/* A held objective may leave its limit by this part of what it was given above its optimum: the
 * optimum itself stays well inside. */
static const double HELD_TOLERANCE = 0.01;

#define OPS(id, name, ...) &mt_objective_##name,
static const mt_objective_ops *const OPERATIONS[] = {MT_OBJECTIVE_LIST(OPS)};

const mt_objective_ops *mt_objective_ops_of(mt_objective_type type)
{
    return OPERATIONS[type];
}

const mt_objective_ops mt_objective_none = {.value = NULL};

double mt_objective_stage_value(const mt_workspace *w, int k, double *gradient)
{
    const mt_objective_stage *const a = &w->c->stages[k];
    for (int i = 0; i < w->c->n_t && gradient != NULL; i++) {
        gradient[i] = 0.0;
    }
    const double f = a->ops->value == NULL ? 0.0 : a->ops->value(w, a, gradient);
    for (int i = 0; i < w->c->n_t && gradient != NULL; i++) {
        gradient[i] /= a->size;
    }
    return f / a->size;
}

double mt_objective_stage_root(const mt_objective_stage *a, double f)
{
    return mt_objective_is(a->type, MT_HALF_SQUARE) ? sqrt(2.0 * (f < 0.0 ? 0.0 : f)) : f;
}

double mt_objective_stage_shown(const mt_objective_stage *a, double f)
{
    return a->ops->shown != NULL ? a->ops->shown(f) : mt_objective_stage_root(a, f * a->size);
}

/* Row of `in` that holds objective k: a misfit among those before it has none. */
static int held_row(const mt_subproblem *c, int k)
{
    int row = c->n_in;
    for (int i = 0; i < k; i++) {
        row += mt_objective_is(c->stages[i].type, MT_RESIDUALS) ? 0 : 1;
    }
    return row;
}

void mt_objective_stage_hold(mt_subproblem *c, const mt_workspace *w, int k, double f)
{
    mt_held *const held = &c->held[k];
    const double root = sqrt(2.0 * fmax(f, 0.0));
    if (mt_objective_is(c->stages[k].type, MT_RESIDUALS)) {
        for (int i = 0; i < c->p->n_res; i++) {
            c->r_held[i] = w->r[i];
            c->eq_tol[c->p->n_eq + i] = HELD_ROOT * fmax(root, 1.0);
        }
        return;
    }
    if (mt_objective_is(c->stages[k].type, MT_HALF_SQUARE)) {
        const double most = root + (HELD_ROOT * fmax(root, 1.0));
        held->limit = 0.5 * most * most;
        held->unit = held->limit;
    } else {
        held->unit = fmax(fabs(f), 1.0);
        held->limit = f + (HELD * held->unit);
    }
    c->in_tol[held_row(c, k)] = HELD_TOLERANCE * (held->limit - f) / held->unit;
}

/* r - r_held = 0 */
static void hold_misfit(const mt_workspace *w, bool with_gradient, mt_nlp_values *out)
{
    const mt_problem *const p = w->p;
    const ptrdiff_t rows = mt_subproblem_rows_eq(w->c);
    for (int i = 0; i < p->n_res; i++) {
        const ptrdiff_t row = p->n_eq + i;
        out->eq[row] = w->r[i] - w->c->r_held[i];
        for (int j = 0; j < w->c->n_t && with_gradient; j++) {
            out->deq[row + (j * rows)] = j < p->n ? w->dr[i + ((ptrdiff_t)j * p->n_res)] : 0.0;
        }
    }
}

void mt_objective_stage_hold_rows(mt_workspace *w, bool with_gradient, mt_nlp_values *out)
{
    const mt_subproblem *const c = w->c;
    const ptrdiff_t rows = mt_subproblem_rows_in(c);
    for (int k = 0; k < c->stage; k++) {
        const mt_held *const held = &c->held[k];
        if (mt_objective_is(c->stages[k].type, MT_RESIDUALS)) {
            hold_misfit(w, with_gradient, out);
            continue;
        }
        const ptrdiff_t row = held_row(c, k);
        out->in[row] =
            (held->limit - mt_objective_stage_value(w, k, with_gradient ? w->work : NULL)) /
            held->unit;
        for (int j = 0; j < c->n_t && with_gradient; j++) {
            out->din[row + (j * rows)] = -w->work[j] / held->unit;
        }
    }
}
