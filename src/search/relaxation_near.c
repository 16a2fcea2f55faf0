/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Which moves can help, from the nearest misses. A miss is a stationary point of what the goals
 * fall short by; a row that it does not press against has no multiplier there, and the same
 * point stays stationary, and short of the same goals, however far that row is moved. So a move
 * is worth a search in an assignment only where the miss that is known there presses against
 * its number.
 */
#include <string.h>

#include "problem/evaluate.h"
#include "problem/tolerance_cut.h"
#include "search/relaxation.h"

/* A row this far from its limit (0.1 %, as misfits are measured) is not pressed against. */
static const double SLACK = 1e-3;

static bool presses_row(const mt_subproblem *c, const mt_move *m, const mt_nlp_values *v)
{
    for (int i = 0; i < c->rows.eq.n; i++) {
        if (mt_relaxation_is_row(m, &c->rows.eq.rows[i])) {
            return true;
        }
    }
    for (int i = 0; i < c->rows.in.n; i++) {
        if (mt_relaxation_is_row(m, &c->rows.in.rows[i]) && !(v->in[i] > SLACK)) {
            return true;
        }
    }
    return false;
}

static bool presses(const mt_subproblem *c, const mt_move *m, const double *t,
                    const mt_nlp_values *v)
{
    if (m->kind != MT_MOVE_BOUND) {
        return presses_row(c, m, v);
    }
    const int i = m->variable;
    return m->upper ? c->upper_t[i] - t[i] <= SLACK : t[i] - c->lower_t[i] <= SLACK;
}

/* At one miss; all moves are worth it where nothing can be said. */
static mt_status find_pressing_moves(mt_workspace *w, const mt_mode_placement_solution *s,
                                     const mt_moves *moves, mt_arena *mem, mt_near_miss *out,
                                     mt_err *err)
{
    const mt_subproblem *const plain = w->c;
    mt_subproblem c;
    mt_nlp_values v;
    mt_err own = {0};
    out->below = s->below;
    out->t = s->found->t;
    out->presses = mt_arena_alloc(mem, (size_t)moves->n, sizeof *out->presses);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_subproblem_in_placement(plain, s->below, 0, NULL, w, mem, &c, err));
    mt_status rc = mt_subproblem_values_init(&c, mem, &v, &own);
    rc = rc == MT_OK ? mt_workspace_eval(w, out->t, false, &v, &own) : rc;
    for (int k = 0; k < moves->n; k++) {
        out->presses[k] = rc != MT_OK || presses(&c, &moves->items[k], out->t, &v);
    }
    mt_workspace_back(w, plain);
    return mt_pass_final(rc, &own, err);
}

mt_status mt_relaxation_misses(mt_workspace *w, const mt_mode_placement_result *placements,
                               const mt_moves *moves, mt_arena *mem, mt_near_misses *out,
                               mt_err *err)
{
    *out = (mt_near_misses){.n_bands = w->c->n_bands};
    /* of an interrupted search they may be anywhere; of worst corners the rows are not here */
    if (placements == NULL || placements->stop != MT_STOP_DONE ||
        mt_tolerance_is_sampled(w->c)) {
        return MT_OK;
    }
    out->items = mt_arena_alloc(mem, (size_t)placements->n_solutions, sizeof *out->items);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < placements->n_solutions; i++) {
        MT_TRY(find_pressing_moves(w, &placements->solutions[i], moves, mem,
                                   &out->items[out->n], err));
        out->n++;
    }
    return MT_OK;
}

const mt_near_miss *mt_relaxation_miss(const mt_near_misses *misses, const int *below)
{
    const size_t row = (size_t)misses->n_bands * sizeof *below;
    for (int i = 0; i < misses->n; i++) {
        if (memcmp(misses->items[i].below, below, row) == 0) {
            return &misses->items[i];
        }
    }
    return NULL;
}
