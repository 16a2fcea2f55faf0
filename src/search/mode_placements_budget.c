/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A budget is shared out evenly, and before anything is begun: parts of a run agree on it,
 * whatever each of them takes. A candidate has a search and at least one judgement of what that
 * finds; where there is not that much for all, the first ones have it.
 */
#include "problem/tolerance_cut.h"
#include "search/drive_path.h"
#include "search/mode_placements.h"
#include "search/search.h"

long mt_mode_placement_verdict(const mt_subproblem *c)
{
    return (c->n_stages > 1 ? 1 : 0) + (mt_search_has_positions(c) ? 1 : 0) +
           (c->clearance || mt_drive_positions_any(c->p) ? 1 : 0) +
           (mt_tolerance_is_sampled(c) ? 1 + c->search.judged_as : 0) + mt_drive_path_most(c);
}

int mt_mode_placement_affordable(const mt_subproblem *c, int n, long left)
{
    const long most = left / (mt_mode_placement_verdict(c) + MT_GAP_SEARCH_LEAST);
    return c->search.max_evaluations <= 0 || most >= n ? n : most > 1 ? (int)most : 1;
}

long mt_mode_placement_share(const mt_subproblem *c, int n, long left)
{
    const long share = left / (n > 0 ? n : 1);
    return c->search.max_evaluations <= 0 ? 0 : share > 1 ? share : 1;
}
