/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How the search came to its designs. */
#include <math.h>

#include "describe/describe.h"
#include "nlp/merit.h"
#include "problem/objective.h"

static double finite_or_none(double x)
{
    return isfinite(x) ? x : nan("");
}

mt_status mt_describe_history(const mt_problem *p, const mt_nlp_result *found, int stage,
                              mt_result *result, mt_err *err)
{
    mt_result_run *const run = &result->run;
    mt_steps steps = found->steps;
    if (found->n_solutions > 0) {
        const mt_nlp_solution *const s = &found->solutions[0];
        const mt_step end = {found->evals, stage, 0, s->f, s->violation, s->squares};
        mt_steps_settle(&steps, &end);
    }
    run->history = mt_arena_alloc(&result->mem, (size_t)steps.n, sizeof *run->history);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < steps.n; i++) {
        const mt_step *const s = &steps.at[i];
        const bool none = p->n_stages == 0;
        run->history[run->n_history++] = (mt_result_step){
            .objective = s->stage + 1,
            .round = s->round + 1,
            .evaluations = s->evals,
            .value = none
                         ? nan("")
                         : finite_or_none(mt_objective_stage_shown(&p->stages[s->stage], s->f)),
            .violation = finite_or_none(s->violation),
            .feasible = mt_is_held(s->violation),
        };
    }
    return MT_OK;
}
