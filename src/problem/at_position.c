/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "problem/at_position.h"

#include <string.h>

/* The configuration's mechanism at the cut's position, with the configuration's queries and
 * port pairs. */
static mt_configuration_problem view_of(const mt_problem *p, const mt_cut *cut,
                                        const mt_configuration_problem *like)
{
    return (mt_configuration_problem){.configuration =
                                          p->families[cut->drive_positions].configuration,
                                      .original = cut->original,
                                      .n_rigid = cut->original->n_rigid,
                                      .n_most = cut->original->n_most,
                                      .ask = like->ask,
                                      .n_pairs = like->n_pairs,
                                      .pairs = like->pairs};
}

mt_status mt_at_position_add(mt_subproblem *c, int n_cuts, const mt_cut *cuts, mt_arena *mem,
                             mt_err *err)
{
    const mt_problem *const p = c->p;
    const int n_before = c->n_views;
    if (n_cuts == 0) {
        return MT_OK;
    }
    const size_t n_own = (size_t)p->n_requirements;
    const size_t n_views = (size_t)n_before + (size_t)n_cuts;
    mt_configuration_problem *const views = mt_arena_alloc(mem, n_views, sizeof *views);
    mt_requirement *const all = mt_arena_alloc(mem, n_own + (size_t)n_cuts, sizeof *all);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(views, c->views, (size_t)n_before * sizeof *views);
    memcpy(all, p->requirements, n_own * sizeof *all);
    for (int i = 0; i < n_cuts; i++) {
        if (cuts[i].requirement < 0) {
            continue;
        }
        const mt_requirement *const d = &p->requirements[cuts[i].requirement];
        mt_requirement *const here = &all[c->n_requirements];
        views[c->n_views] = view_of(p, &cuts[i], &p->views[d->view]);
        *here = *d;
        here->index = c->n_requirements++;
        here->view = c->n_views++;
    }
    c->views = views;
    c->requirements = all;
    return MT_OK;
}
