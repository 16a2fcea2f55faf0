/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The box of designs whose vibration modes a study counts alike. */
#include "study/study_priv.h"

#include <math.h>

static void widen_box_bounds(mt_count_box *box, int at, double x)
{
    if (isfinite(x)) {
        box->lower[at] = fmin(box->lower[at], x);
        box->upper[at] = fmax(box->upper[at], x);
    }
}

/* Index of a parameter in the box, added where missing. */
static int box_parameter_index(mt_count_box *box, const mt_study *s, int parameter)
{
    for (int i = 0; i < box->n; i++) {
        if (box->parameter[i] == parameter) {
            return i;
        }
    }
    const double original = s->original[parameter];
    box->parameter[box->n] = parameter;
    box->lower[box->n] = original;
    box->upper[box->n] = original;
    box->at[box->n] = original;
    return box->n++;
}

static void add_variable(mt_count_box *box, const mt_study *s, const mt_variable *v)
{
    const int at = box_parameter_index(box, s, v->parameter);
    const double part = MT_HAS(v->tolerance_percent) ? v->tolerance_percent / 100.0 : 0.0;
    const double ends[2] = {v->lower, v->upper};
    for (int k = 0; k < 2; k++) {
        widen_box_bounds(box, at, ends[k] * (1.0 - part));
        widen_box_bounds(box, at, ends[k] * (1.0 + part));
    }
}

void mt_study_fill_counted(mt_study_check *c)
{
    mt_study *const s = c->study;
    const size_t room = (size_t)s->n_variables + MT_MAX_VARY + 1;
    mt_count_box *const box = &s->counted;
    *box = (mt_count_box){.parameter = mt_arena_int(&s->mem, room),
                          .lower = mt_arena_f64(&s->mem, room, 1),
                          .upper = mt_arena_f64(&s->mem, room, 1),
                          .at = mt_arena_f64(&s->mem, room, 1)};
    if (mt_arena_failed(&s->mem)) {
        return;
    }
    for (int i = 0; i < s->n_variables && s->original != NULL; i++) {
        if (s->variables[i].parameter != MT_ABSENT) {
            add_variable(box, s, &s->variables[i]);
        }
    }
    for (int k = 0; k < s->trade.n_vary && s->original != NULL; k++) {
        const mt_vary *const v = &s->trade.vary[k];
        const bool bound = v->kind == MT_VARY_BOUND && v->variable != MT_ABSENT;
        const int parameter = bound ? s->variables[v->variable].parameter
                              : v->kind == MT_VARY_PARAMETER ? v->parameter
                                                             : MT_ABSENT;
        for (int i = 0; i < v->n_values && parameter != MT_ABSENT; i++) {
            widen_box_bounds(box, box_parameter_index(box, s, parameter), v->values[i]);
        }
    }
}
