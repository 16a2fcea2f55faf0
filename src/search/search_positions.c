/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Limits between the positions of a drive that a goal names: where a design
 * misses one most within a way between two of them, that position is one more row of the limit
 * (problem/drive_positions.h), for all designs.
 */
#include <math.h>

#include "nlp/merit.h"
#include "problem/evaluate.h"
#include "search/drive_path_limit.h"
#include "search/search.h"

enum { CUTS_MOST = 32 };

/* Positions nearer than this part of the range are one. */
static const double SAME = 1e-7;

/* True where the limit is verified between positions; limits that scale the objective
 * "vibration" are not. */
static bool is_asked(const mt_problem *p, int requirement)
{
    return p->requirements[requirement].role == MT_ROLE_LIMIT &&
           mt_drive_positions_limits_first(p, &p->requirements[requirement]);
}

bool mt_search_has_positions(const mt_subproblem *c)
{
    for (int i = 0; i < c->p->n_requirements; i++) {
        if (is_asked(c->p, i)) {
            return true;
        }
    }
    return false;
}

static bool is_known_cut(const mt_at_position_cuts *cuts, int requirement, double at,
                         double near)
{
    for (int i = 0; i < cuts->n; i++) {
        if (cuts->items[i].requirement == requirement &&
            fabs(cuts->items[i].position - at) <= near) {
            return true;
        }
    }
    return false;
}

static mt_status add_position_cuts(const mt_problem *p, int requirement,
                                   const mt_limit_drive_path *m, mt_at_position_cuts *cuts,
                                   mt_err *err)
{
    const int drive_positions = mt_drive_positions_of(p, p->requirements[requirement].view);
    const double near = SAME * (m->to - m->from);
    for (int i = 0; i < m->n_ways && p->families[drive_positions].fixed; i++) {
        if (mt_is_met(m->way_off[i], p->requirements[requirement].tolerance) ||
            !MT_HAS(m->way_at[i]) || cuts->n == CUTS_MOST ||
            is_known_cut(cuts, requirement, m->way_at[i], near)) {
            continue;
        }
        mt_cut *const cut = &cuts->items[cuts->n];
        MT_TRY(mt_cut_init(p, drive_positions, m->way_at[i], cut, err));
        cut->requirement = requirement;
        cuts->n++;
        cuts->added++;
    }
    return MT_OK;
}

mt_status mt_search_verify_positions(mt_workspace *w, const double *t, bool last, mt_arena *mem,
                                     mt_at_position_cuts *cuts, mt_err *err)
{
    mt_nlp_values v;
    cuts->added = 0;
    cuts->holds = true;
    cuts->evals = 1;
    if (cuts->items == NULL) {
        cuts->items = mt_arena_alloc(mem, CUTS_MOST, sizeof *cuts->items);
    }
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_subproblem_values_init(w->c, mem, &v, err));
    MT_TRY(mt_workspace_eval(w, t, false, &v, err));
    for (int i = 0; i < w->p->n_requirements; i++) {
        mt_limit_drive_path m;
        if (!is_asked(w->p, i)) {
            continue;
        }
        MT_TRY(mt_drive_path_limit(w, &w->p->requirements[i], mem, &m, err));
        cuts->evals += m.positions;
        if (m.end == MT_MOTION_NONE) {
            continue;
        }
        cuts->holds =
            cuts->holds && m.why == NULL && mt_is_met(m.off, w->p->requirements[i].tolerance);
        MT_TRY(last ? MT_OK : add_position_cuts(w->p, i, &m, cuts, err));
    }
    return MT_OK;
}

mt_status mt_at_position_cuts_used(const mt_at_position_cuts *cuts, int n, const mt_cut *first,
                                   mt_arena *mem, mt_cut **out, mt_err *err)
{
    *out = mt_arena_alloc(mem, (size_t)n + (size_t)cuts->n, sizeof **out);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < n; i++) {
        (*out)[i] = first[i];
    }
    for (int i = 0; i < cuts->n; i++) {
        (*out)[n + i] = cuts->items[i];
    }
    return MT_OK;
}

void mt_at_position_cuts_free(mt_at_position_cuts *cuts)
{
    for (int i = 0; i < cuts->n; i++) {
        mt_cut_free(&cuts->items[i]);
    }
    cuts->n = 0;
}
