/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Limits between the positions of a drive that a goal names: where a design
 * misses one most within a way between two of them, that position is one more row of the limit
 * (problem/posed.h), for all designs.
 */
#include <math.h>

#include "nlp/merit.h"
#include "search/motion_limit.h"
#include "search/search.h"

enum { CUTS_MOST = 32 };

/* Positions nearer than this part of the range are one. */
static const double SAME = 1e-7;

/* Of the objective "vibration" limits are a scale, and asked for where they are given. */
static bool is_asked(const mt_problem *p, int demand)
{
    return p->demands[demand].row_in >= 0 && mt_family_limits_first(p, &p->demands[demand]);
}

bool mt_search_has_positions(const mt_case *c)
{
    for (int i = 0; i < c->p->n_demands; i++) {
        if (is_asked(c->p, i)) {
            return true;
        }
    }
    return false;
}

static bool is_known(const mt_posed_cuts *cuts, int demand, double at, double near)
{
    for (int i = 0; i < cuts->n; i++) {
        if (cuts->items[i].demand == demand && fabs(cuts->items[i].position - at) <= near) {
            return true;
        }
    }
    return false;
}

static mt_status add(const mt_problem *p, int demand, const mt_limit_motion *m,
                     mt_posed_cuts *cuts, mt_err *err)
{
    const int family = mt_family_of(p, p->demands[demand].view);
    const double near = SAME * (m->to - m->from);
    for (int i = 0; i < m->n_ways && p->families[family].fixed; i++) {
        if (mt_is_met(m->way_off[i], p->demands[demand].tolerance) || !MT_HAS(m->way_at[i]) ||
            cuts->n == CUTS_MOST || is_known(cuts, demand, m->way_at[i], near)) {
            continue;
        }
        mt_cut *const cut = &cuts->items[cuts->n];
        MT_TRY(mt_cut_init(p, family, m->way_at[i], cut, err));
        cut->demand = demand;
        cuts->n++;
        cuts->added++;
    }
    return MT_OK;
}

mt_status mt_search_judge_positions(mt_workspace *w, const double *t, bool last, mt_arena *mem,
                                    mt_posed_cuts *cuts, mt_err *err)
{
    mt_nlp_values v;
    cuts->added = 0;
    cuts->holds = true;
    cuts->evals = 1;
    if (cuts->items == NULL) {
        cuts->items = mt_arena_alloc(mem, CUTS_MOST, sizeof *cuts->items);
    }
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_case_values_init(w->c, mem, &v, err));
    MT_TRY(mt_workspace_eval(w, t, false, &v, err));
    for (int i = 0; i < w->p->n_demands; i++) {
        mt_limit_motion m;
        if (!is_asked(w->p, i)) {
            continue;
        }
        MT_TRY(mt_motion_limit(w, &w->p->demands[i], mem, &m, err));
        cuts->evals += m.positions;
        if (m.end == MT_MOTION_NONE) {
            continue;
        }
        cuts->holds =
            cuts->holds && m.why == NULL && mt_is_met(m.off, w->p->demands[i].tolerance);
        MT_TRY(last ? MT_OK : add(w->p, i, &m, cuts, err));
    }
    return MT_OK;
}

mt_status mt_posed_cuts_behind(const mt_posed_cuts *cuts, int n, const mt_cut *first,
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

void mt_posed_cuts_free(mt_posed_cuts *cuts)
{
    for (int i = 0; i < cuts->n; i++) {
        mt_cut_free(&cuts->items[i]);
    }
    cuts->n = 0;
}
