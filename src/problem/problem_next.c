/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Modes are sorted: f_k at least a limit means f_(k+1) at least it, too. Such rows demand
 * nothing, but f_k has a kink where modes cross, and of a slope that is that of one mode here
 * and of another there a search learns little. With the rows of the modes that come next, where
 * they do not touch each other (those of different symmetry), all rows are smooth.
 */
#include <math.h>

#include "problem/robust.h"

enum { NEXT_MOST = 5 };

/* One of them. */
typedef struct mt_next {
    mt_analysis *analysis; /* of a view, or of a corner */
    const double *factor;  /* [n] of that corner; NULL: the design itself */
    double limit_hz;
    double sign;
    int mode; /* vibration index */
} mt_next;

static void add(mt_problem *p, const mt_next *what, int view, int row)
{
    const int most = mt_view_vibrations(&p->views[view]);
    const int step = what->sign > 0.0 ? 1 : -1;
    for (int i = 1; i <= NEXT_MOST; i++) {
        const int mode = what->mode + (i * step);
        if (mode < 1 || mode > most || !(what->limit_hz > 0.0)) {
            return;
        }
        if (p->next != NULL) {
            p->next[p->n_next] = *what;
            p->next[p->n_next].mode = mode;
            p->next_of[p->n_next] = row;
        }
        p->n_next++;
    }
}

static void add_demand(mt_problem *p, const mt_demand *d)
{
    const mt_goal *const g = d->goal;
    int row = d->row_in;
    for (int k = 0; k < 2 && d->row_in >= 0 && mt_demand_is_frequency(d); k++) {
        const mt_next what = {.analysis = p->views[d->view].analysis,
                              .limit_hz = k == 0 ? g->at_least : g->at_most,
                              .sign = k == 0 ? 1.0 : -1.0,
                              .mode = d->mode};
        if (MT_HAS(what.limit_hz)) {
            if (!mt_robust_at_corner(p, row)) {
                add(p, &what, d->view, row);
            }
            row++;
        }
    }
}

static void add_corners(mt_problem *p)
{
    for (int k = 0; p->robust != NULL && k < p->robust->n_rows; k++) {
        const mt_robust_row *const row = &p->robust->rows[k];
        if (row->demand >= 0 && mt_demand_is_frequency(&p->demands[row->demand])) {
            const mt_demand *const d = &p->demands[row->demand];
            const mt_corner *const c = &p->robust->views[d->view].corners[row->corner];
            const mt_next what = {.analysis = c->analysis,
                                  .factor = c->factor,
                                  .limit_hz = mt_robust_limit_hz(p, row),
                                  .sign = row->side == MT_LOWEST ? 1.0 : -1.0,
                                  .mode = d->mode};
            add(p, &what, d->view, row->row);
        }
    }
}

mt_status mt_next_init(mt_problem *p, mt_err *err)
{
    for (int pass = 0; pass < 2; pass++) { /* counted, then kept */
        p->n_next = 0;
        for (int i = 0; i < p->n_demands; i++) {
            add_demand(p, &p->demands[i]);
        }
        add_corners(p);
        if (pass == 0) {
            p->next = mt_arena_alloc(&p->mem, (size_t)p->n_next, sizeof *p->next);
            p->next_of = mt_arena_int(&p->mem, (size_t)p->n_next);
            if (p->next == NULL || p->next_of == NULL) {
                return mt_fail_memory(err);
            }
        }
    }
    return MT_OK;
}

mt_status mt_next_eval(mt_problem *p, bool with_gradient, mt_nlp_values *out, mt_err *err)
{
    for (int k = 0; out->next != NULL && k < p->n_next; k++) {
        const mt_next *const s = &p->next[k];
        const int pos = mt_modal_flexible(&s->analysis->modes, s->mode);
        const double floor_hz = MT_FREQUENCY_FLOOR * s->limit_hz;
        out->next[k] =
            s->sign * mt_problem_ln_ratio(&s->analysis->modes, pos, s->limit_hz, floor_hz);
        if (!with_gradient) {
            continue;
        }
        MT_TRY(mt_problem_dln_frequency(p, s->analysis, pos, floor_hz, p->dshape, err));
        for (int i = 0; i < p->n_t; i++) {
            const double part = i < p->n && s->factor != NULL ? s->factor[i] : 1.0;
            out->dnext[k + ((ptrdiff_t)i * p->n_next)] =
                i < p->n ? s->sign * part * p->dshape[i] : 0.0;
        }
    }
    return MT_OK;
}
