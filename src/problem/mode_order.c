/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Modes are sorted: f_k at least a limit means f_(k+1) at least it, too. Such rows require
 * nothing, but f_k has a kink where modes cross, and of a slope that is that of one mode here
 * and of another there a search learns little. With the rows of the modes that come next, where
 * they do not touch each other (those of different symmetry), all rows are smooth.
 */
#include "problem/mode_order.h"

#include <math.h>

#include "problem/goal_frequency.h"
#include "problem/requirement.h"
#include "problem/tolerance.h"

/* Appends the rows that row `at` of `in` implies. */
static mt_status append_implied(const mt_row_layout *l, int at, mt_err *err)
{
    mt_row_table *const rows = &l->c->rows;
    mt_row next = rows->in.rows[at];
    const int mode = next.mode;
    const int most = mt_configuration_vibrations(&l->c->views[next.view]);
    const int step = next.sense == MT_AT_LEAST ? 1 : -1;
    next.kind = MT_ROW_ORDER;
    next.implied_by = at;
    for (int k = 1; k <= MT_MODE_ORDER_MOST; k++) {
        next.mode = mode + (k * step);
        if (next.mode < 1 || next.mode > most || !(next.limit > 0.0)) {
            break;
        }
        MT_TRY(mt_rows_append(&rows->next, &next, l->mem, err));
    }
    return MT_OK;
}

/* True where a row limits a frequency of a requirement, at the design or at a corner. */
static bool implies(const mt_subproblem *c, const mt_row *row, bool at_corner)
{
    const bool own = row->kind == MT_ROW_GOAL || row->kind == MT_ROW_CORNER;
    return own && row->requirement >= 0 && (row->corner >= 0) == at_corner &&
           mt_requirement_is_frequency(&c->requirements[row->requirement]);
}

/* Those of the design itself, then those at corners. */
static mt_status lay_out_order(const mt_row_layout *l, mt_err *err)
{
    mt_row_table *const rows = &l->c->rows;
    for (int i = 0; i < 2 * rows->in.n; i++) {
        const int at = i % rows->in.n;
        MT_TRY(implies(l->c, &rows->in.rows[at], i >= rows->in.n) ? append_implied(l, at, err)
                                                                  : MT_OK);
    }
    rows->next_of = mt_arena_int(l->mem, (size_t)rows->next.n);
    MT_TRY(mt_arena_check(l->mem, err));
    for (int i = 0; i < rows->next.n; i++) {
        rows->next_of[i] = rows->next.rows[i].implied_by;
    }
    return MT_OK;
}

static mt_status eval_order(mt_workspace *w, bool with_gradient, mt_nlp_values *out,
                            mt_err *err)
{
    const mt_subproblem *const c = w->c;
    const int n = w->p->n;
    const int rows = c->rows.next.n;
    for (int k = 0; out->next != NULL && k < rows; k++) {
        const mt_row *const row = &c->rows.next.rows[k];
        const mt_configuration_work *const view = &w->views[row->view];
        mt_analysis *const a = row->corner < 0 ? view->analysis : view->corners[row->corner];
        const double *const factor =
            row->corner < 0 ? NULL
                            : c->tolerance_box->views[row->view].corners[row->corner].factor;
        const int pos = mt_modal_flexible(&a->modes, row->mode);
        const double floor_hz = MT_FREQUENCY_FLOOR * row->limit;
        const double sign = mt_row_sign(row);
        out->next[k] = sign * mt_problem_ln_ratio(&a->modes, pos, row->limit, floor_hz);
        if (!with_gradient) {
            continue;
        }
        MT_TRY(mt_problem_dln_frequency(w, a, pos, floor_hz, w->dshape, err));
        for (int i = 0; i < c->n_t; i++) {
            const double part = i < n && factor != NULL ? factor[i] : 1.0;
            out->dnext[k + ((ptrdiff_t)i * rows)] = i < n ? sign * part * w->dshape[i] : 0.0;
        }
    }
    return MT_OK;
}

const mt_row_ops mt_rows_order = {.lay_out = lay_out_order, .eval = eval_order};
