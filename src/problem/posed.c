/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "problem/posed.h"

#include <string.h>

#include "problem/demand.h"

/* The view's mechanism at the cut's position, asked and shaken as the view is. */
static mt_view view_of(const mt_problem *p, const mt_cut *cut, const mt_view *like)
{
    return (mt_view){.configuration = p->families[cut->family].configuration,
                     .original = cut->original,
                     .n_rigid = cut->original->n_rigid,
                     .n_most = cut->original->n_most,
                     .ask = like->ask,
                     .n_pairs = like->n_pairs,
                     .pairs = like->pairs};
}

mt_status mt_posed_lay_out(mt_case *c, int n_cuts, const mt_cut *cuts, mt_arena *mem,
                           mt_err *err)
{
    const mt_problem *const p = c->p;
    const int n_before = c->n_views;
    c->n_posed = 0;
    c->posed = NULL;
    if (n_cuts == 0) {
        return MT_OK;
    }
    const size_t n_views = (size_t)n_before + (size_t)n_cuts;
    mt_view *const views = mt_arena_alloc(mem, n_views, sizeof *views);
    mt_demand *const posed = mt_arena_alloc(mem, (size_t)n_cuts, sizeof *posed);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(views, c->views, (size_t)n_before * sizeof *views);
    for (int i = 0; i < n_cuts; i++) {
        if (cuts[i].demand < 0) {
            continue;
        }
        const mt_demand *const d = &p->demands[cuts[i].demand];
        mt_demand *const here = &posed[c->n_posed++];
        views[c->n_views] = view_of(p, &cuts[i], &p->views[d->view]);
        *here = *d;
        here->view = c->n_views++;
        here->row_in = c->n_in;
        c->n_in += d->n_in;
    }
    c->views = views;
    c->posed = posed;
    return MT_OK;
}

mt_status mt_posed_eval(mt_workspace *w, bool with_gradient, mt_nlp_values *out, mt_err *err)
{
    for (int i = 0; i < w->c->n_posed; i++) {
        const mt_demand *const d = &w->c->posed[i];
        MT_TRY(mt_err_in(err, mt_demand_eval(w, d, with_gradient, out, NULL, err), "/goals/%d",
                         d->goal_index));
    }
    return MT_OK;
}
