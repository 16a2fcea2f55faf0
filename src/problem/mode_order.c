/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Modes are sorted: f_k at least a limit means f_(k+1) at least it, too. Such rows requirement
 * nothing, but f_k has a kink where modes cross, and of a slope that is that of one mode here
 * and of another there a search learns little. With the rows of the modes that come next, where
 * they do not touch each other (those of different symmetry), all rows are smooth.
 */
#include "problem/mode_order.h"

#include <math.h>

#include "problem/goal_frequency.h"
#include "problem/requirement.h"
#include "problem/tolerance.h"

/* One of them. */
typedef struct mt_mode_order {
    int view;
    int corner; /* of the tolerances; -1: the design itself */
    double limit_hz;
    double sign;
    int mode; /* vibration index */
} mt_mode_order;

/* Appends the rows implied by row `row` to the n present, unless list is NULL; returns their
 * number. */
static int add_implied_orders(const mt_subproblem *c, const mt_mode_order *what, int row,
                              mt_mode_order *list, int *next_of, int n)
{
    const int most = mt_configuration_vibrations(&c->views[what->view]);
    const int step = what->sign > 0.0 ? 1 : -1;
    int more = 0;
    for (; more < MT_MODE_ORDER_MOST; more++) {
        const int mode = what->mode + ((more + 1) * step);
        if (mode < 1 || mode > most || !(what->limit_hz > 0.0)) {
            break;
        }
        if (list != NULL) {
            list[n + more] = *what;
            list[n + more].mode = mode;
            next_of[n + more] = row;
        }
    }
    return more;
}

/* Writes all such rows to list and next_of, unless NULL; returns their number. */
static int list_all(const mt_subproblem *c, mt_mode_order *list, int *next_of)
{
    const mt_problem *const p = c->p;
    int n = 0;
    for (int i = 0; i < p->n_requirements; i++) {
        const mt_requirement *const d = &p->requirements[i];
        int row = d->row_in;
        for (int k = 0; k < 2 && d->row_in >= 0 && mt_requirement_is_frequency(d); k++) {
            const mt_mode_order what = {.view = d->view,
                                        .corner = -1,
                                        .limit_hz =
                                            k == 0 ? d->goal->at_least : d->goal->at_most,
                                        .sign = k == 0 ? 1.0 : -1.0,
                                        .mode = d->mode};
            if (MT_HAS(what.limit_hz)) {
                n += mt_tolerance_at_corner(c, row)
                         ? 0
                         : add_implied_orders(c, &what, row, list, next_of, n);
                row++;
            }
        }
    }
    for (int k = 0; c->tolerance_box != NULL && k < c->tolerance_box->n_rows; k++) {
        const mt_tolerance_row *const row = &c->tolerance_box->rows[k];
        if (row->requirement >= 0 &&
            mt_requirement_is_frequency(&p->requirements[row->requirement])) {
            const mt_mode_order what = {.view = p->requirements[row->requirement].view,
                                        .corner = row->corner,
                                        .limit_hz = mt_tolerance_limit_hz(c, row),
                                        .sign = row->side == MT_LOWEST ? 1.0 : -1.0,
                                        .mode = p->requirements[row->requirement].mode};
            n += add_implied_orders(c, &what, row->row, list, next_of, n);
        }
    }
    return n;
}

mt_status mt_mode_order_init(mt_subproblem *c, mt_arena *mem, mt_err *err)
{
    c->n_next = list_all(c, NULL, NULL);
    mt_mode_order *const next = mt_arena_alloc(mem, (size_t)c->n_next, sizeof *next);
    int *const next_of = mt_arena_int(mem, (size_t)c->n_next);
    MT_TRY(mt_arena_check(mem, err));
    (void)list_all(c, next, next_of);
    c->next = next;
    c->next_of = next_of;
    return MT_OK;
}

mt_status mt_mode_order_eval(mt_workspace *w, bool with_gradient, mt_nlp_values *out,
                             mt_err *err)
{
    const mt_subproblem *const c = w->c;
    const int n = w->p->n;
    for (int k = 0; out->next != NULL && k < c->n_next; k++) {
        const mt_mode_order *const s = &c->next[k];
        const mt_configuration_work *const view = &w->views[s->view];
        mt_analysis *const a = s->corner < 0 ? view->analysis : view->corners[s->corner];
        const double *const factor =
            s->corner < 0 ? NULL : c->tolerance_box->views[s->view].corners[s->corner].factor;
        const int pos = mt_modal_flexible(&a->modes, s->mode);
        const double floor_hz = MT_FREQUENCY_FLOOR * s->limit_hz;
        out->next[k] = s->sign * mt_problem_ln_ratio(&a->modes, pos, s->limit_hz, floor_hz);
        if (!with_gradient) {
            continue;
        }
        MT_TRY(mt_problem_dln_frequency(w, a, pos, floor_hz, w->dshape, err));
        for (int i = 0; i < c->n_t; i++) {
            const double part = i < n && factor != NULL ? factor[i] : 1.0;
            out->dnext[k + ((ptrdiff_t)i * c->n_next)] =
                i < n ? s->sign * part * w->dshape[i] : 0.0;
        }
    }
    return MT_OK;
}
