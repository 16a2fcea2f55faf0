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

/* Appends the rows that hold an objective; a misfit is held at the residuals of w. */
static void hold(mt_subproblem *c, const mt_workspace *w, int k, double f)
{
    mt_held *const held = &c->held[k];
    const double root = sqrt(2.0 * fmax(f, 0.0));
    const bool misfit = mt_objective_is(c->stages[k].type, MT_RESIDUALS);
    mt_row_block *const block = misfit ? &c->rows.eq : &c->rows.in;
    mt_row row = mt_row_init(MT_ROW_HELD, misfit ? MT_EQUAL : MT_AT_MOST);
    row.objective = k;
    if (misfit) {
        row.tolerance = HELD_ROOT * fmax(root, 1.0);
    } else if (mt_objective_is(c->stages[k].type, MT_HALF_SQUARE)) {
        const double most = root + (HELD_ROOT * fmax(root, 1.0));
        held->limit = 0.5 * most * most;
        held->unit = held->limit;
        row.tolerance = HELD_TOLERANCE * (held->limit - f) / held->unit;
    } else {
        held->unit = fmax(fabs(f), 1.0);
        held->limit = f + (HELD * held->unit);
        row.tolerance = HELD_TOLERANCE * (held->limit - f) / held->unit;
    }
    for (int i = 0; i < (misfit ? c->rows.res.n : 1); i++) {
        row.part = i;
        if (misfit) {
            c->r_held[i] = w->r[i];
        }
        block->tol[block->n] = row.tolerance;
        block->rows[block->n++] = row;
    }
}

static void drop_held(mt_row_block *block)
{
    while (block->n > 0 && block->rows[block->n - 1].kind == MT_ROW_HELD) {
        block->n--;
    }
}

void mt_objectives_hold(mt_subproblem *c, const mt_workspace *w, int stage, const double *f)
{
    drop_held(&c->rows.eq);
    drop_held(&c->rows.in);
    c->stage = stage;
    for (int k = 0; k < stage; k++) {
        hold(c, w, k, f[k]);
    }
}

static void eval_held_residual(const mt_workspace *w, int at, bool with_gradient,
                               mt_nlp_values *out)
{
    const mt_row_table *const rows = &w->c->rows;
    const int i = rows->eq.rows[at].part;
    out->eq[at] = w->r[i] - w->c->r_held[i];
    for (int j = 0; j < w->c->n_t && with_gradient; j++) {
        out->deq[at + ((ptrdiff_t)j * rows->eq.n)] =
            j < w->p->n ? w->dr[i + ((ptrdiff_t)j * rows->res.n)] : 0.0;
    }
}

static void eval_held_value(mt_workspace *w, int at, bool with_gradient, mt_nlp_values *out)
{
    const mt_subproblem *const c = w->c;
    const int k = c->rows.in.rows[at].objective;
    const mt_held *const held = &c->held[k];
    out->in[at] =
        (held->limit - mt_objective_stage_value(w, k, with_gradient ? w->work : NULL)) /
        held->unit;
    for (int j = 0; j < c->n_t && with_gradient; j++) {
        out->din[at + ((ptrdiff_t)j * c->rows.in.n)] = -w->work[j] / held->unit;
    }
}

static mt_status eval_held(mt_workspace *w, bool with_gradient, mt_nlp_values *out, mt_err *err)
{
    const mt_row_table *const rows = &w->c->rows;
    (void)err;
    for (int i = rows->eq.n - 1; i >= 0 && rows->eq.rows[i].kind == MT_ROW_HELD; i--) {
        eval_held_residual(w, i, with_gradient, out);
    }
    for (int i = rows->in.n - 1; i >= 0 && rows->in.rows[i].kind == MT_ROW_HELD; i--) {
        eval_held_value(w, i, with_gradient, out);
    }
    return MT_OK;
}

const mt_row_ops mt_rows_held = {.eval = eval_held}; /* mt_objectives_hold appends them */
