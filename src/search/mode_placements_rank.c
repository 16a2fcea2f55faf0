/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The order of designs of different gap assignments. */
#include "nlp/merit.h"
#include "search/mode_placements.h"
#include "search/search.h"

static bool better(const mt_subproblem *c, const mt_mode_placement_solution *a,
                   const mt_mode_placement_solution *b)
{
    const mt_merit x = {a->found->feasible, a->found->squares, a->n_stages, a->stages};
    const mt_merit y = {b->found->feasible, b->found->squares, b->n_stages, b->stages};
    if (mt_merit_before(&x, &y, MT_EQUAL_FOUND) || mt_merit_before(&y, &x, MT_EQUAL_FOUND)) {
        return mt_merit_before(&x, &y, MT_EQUAL_FOUND);
    }
    const int order = mt_compare(a->found->f, b->found->f, MT_EQUAL_FOUND);
    return order < 0 || (order == 0 && mt_search_nearer(c, a->found->t, b->found->t));
}

void mt_mode_placement_rank(const mt_subproblem *c, mt_mode_placement_result *r)
{
    for (int i = 1; i < r->n_solutions; i++) {
        const mt_mode_placement_solution s = r->solutions[i];
        int k = i;
        for (; k > 0 && better(c, &s, &r->solutions[k - 1]); k--) {
            r->solutions[k] = r->solutions[k - 1];
        }
        r->solutions[k] = s;
    }
}
