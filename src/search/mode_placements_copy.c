/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <string.h>

#include "problem/avoidance.h"
#include "search/mode_placements.h"

mt_status mt_mode_placement_copy(const mt_subproblem *c, const int *below,
                                 const mt_nlp_solution *from, mt_arena *mem,
                                 const mt_nlp_solution **out, mt_err *err)
{
    const mt_problem *const p = c->p;
    const size_t n_eq = (size_t)c->rows.eq.n;
    size_t n_in = (size_t)c->rows.in.n;
    mt_row row;
    for (int i = 0; mt_avoidance_row_at(c, below, i, &row); i++) {
        n_in++;
    }
    const size_t n = (size_t)p->n + 1;
    mt_nlp_solution *const s = mt_arena_alloc(mem, 1, sizeof *s);
    double *const t = mt_arena_f64(mem, n, 1);
    int *const bound = mt_arena_int(mem, n);
    double *const mult = mt_arena_f64(mem, n, 1);
    double *const mult_eq = mt_arena_f64(mem, n_eq, 1);
    double *const mult_in = mt_arena_f64(mem, n_in, 1);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(t, from->t, (size_t)p->n * sizeof *t);
    memcpy(bound, from->bound, (size_t)p->n * sizeof *bound);
    memcpy(mult, from->mult_bound, (size_t)p->n * sizeof *mult);
    if (n_eq > 0) {
        memcpy(mult_eq, from->mult_eq, n_eq * sizeof *mult_eq);
    }
    if (n_in > 0) {
        memcpy(mult_in, from->mult_in, n_in * sizeof *mult_in);
    }
    *s = *from;
    s->t = t;
    s->bound = bound;
    s->mult_bound = mult;
    s->mult_eq = mult_eq;
    s->mult_in = mult_in;
    *out = s;
    return MT_OK;
}

mt_status mt_mode_placement_copy_held(mt_arena *mem, mt_mode_placement_solution *s, mt_err *err)
{
    mt_mode_placement_held *const held = mt_arena_alloc(mem, (size_t)s->n_held, sizeof *held);
    MT_TRY(mt_arena_check(mem, err));
    if (s->n_held > 0) {
        memcpy(held, s->held, (size_t)s->n_held * sizeof *held);
    }
    s->held = held;
    return MT_OK;
}

mt_status mt_mode_placement_hold(const mt_subproblem *c, const mt_cut *cuts,
                                 const mt_nlp_solution *s, mt_arena *mem,
                                 mt_mode_placement_solution *out, mt_err *err)
{
    const mt_row_span bands = c->rows.of_kind[MT_ROW_BAND];
    mt_mode_placement_held *const held = mt_arena_alloc(mem, (size_t)bands.n, sizeof *held);
    MT_TRY(mt_arena_check(mem, err));
    out->held = held;
    out->n_held = 0;
    for (int i = bands.first; i < bands.first + bands.n && s->mult_in != NULL; i++) {
        const mt_row *const row = &c->rows.in.rows[i];
        /* cuts come behind the problem's own */
        const int k = row->avoidance - c->p->n_avoidances;
        const double multiplier = s->mult_in[i];
        if (k >= 0 && multiplier > 0.0) {
            held[out->n_held++] = (mt_mode_placement_held){
                .drive_positions = cuts[k].drive_positions,
                .position = cuts[k].position,
                .mode = row->mode,
                .above = row->sense == MT_AT_LEAST,
                .band = c->avoidances[row->avoidance].bands.items[row->band].label,
                .multiplier = multiplier};
        }
    }
    return MT_OK;
}
