/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <string.h>

#include "problem/goal_avoid.h"
#include "search/gaps.h"

mt_status mt_gap_copy(const mt_case *c, const int *below, const mt_nlp_solution *from,
                      mt_arena *mem, const mt_nlp_solution **out, mt_err *err)
{
    const mt_problem *const p = c->p;
    const size_t n_eq = (size_t)p->n_eq;
    const size_t n_in = (size_t)c->n_in + (size_t)mt_clear_row_count(c, below);
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
