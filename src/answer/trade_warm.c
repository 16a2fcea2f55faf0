/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether a neighbour's best design is a better start than all that a point was searched from.
 * One local search tells, at a small part of the cost of the point. */
#include <math.h>

#include "answer/trade.h"
#include "nlp/merit.h"
#include "problem/avoidance.h"
#include "problem/drive_positions.h"
#include "problem/evaluate.h"
#include "problem/objective.h"
#include "problem/tolerance.h"
#include "search/catalogue_search.h"

enum { LOCAL_EVALUATIONS = 500 };

static void to_t(const mt_subproblem *c, const double *x, double *t)
{
    for (int i = 0; i < c->p->n; i++) {
        t[i] = fmin(fmax(mt_problem_t(c->p, i, x[i]), c->lower_t[i]), c->upper_t[i]);
    }
    t[c->p->n] = 0.0;
}

/* The first objective at t as the search sees it. */
static mt_status objective_at(mt_workspace *w, const double *t, mt_arena *mem, double *f,
                              mt_err *err)
{
    const mt_subproblem *const c = w->c;
    mt_nlp_values v;
    MT_TRY(mt_subproblem_values_init(c, mem, &v, err));
    MT_TRY(mt_workspace_eval(w, t, false, &v, err));
    *f = mt_objective_stage_value(w, 0, NULL);
    if (mt_objective_is(c->stages[0].type, MT_BANDS)) {
        *f = -mt_avoidances_margin(w);
    }
    return MT_OK;
}

/* Opens the subproblem with the mode placement of t. */
static mt_status open_gap(mt_workspace *w, const double *t, mt_arena *mem, mt_subproblem *out,
                          mt_err *err)
{
    const mt_problem *const p = w->p;
    int *const below = mt_arena_int(mem, (size_t)p->n_bands);
    double f = 0.0;
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(objective_at(w, t, mem, &f, err));
    for (int i = 0; i < p->n_avoidances; i++) {
        const mt_avoidance *const c = &p->avoidances[i];
        (void)mt_avoidance_find_modes(c, &w->views[c->view].analysis->modes, below + c->first);
    }
    if (!mt_ties_agree(p, below)) {
        return mt_fail(err, MT_E_DOMAIN, "a mode crosses a band between two positions");
    }
    return mt_subproblem_in_placement(&p->whole, below, 0, NULL, w, mem, out, err);
}

static mt_status compare_designs(mt_workspace *w, const double *x, const double *best_x,
                                 mt_arena *mem, bool *better, long most, mt_err *err)
{
    const mt_problem *const p = w->p;
    double *const t = mt_arena_f64(mem, (size_t)p->n + 1, 1);
    double *const best_t = mt_arena_f64(mem, (size_t)p->n + 1, 1);
    double best_f = HUGE_VAL;
    mt_nlp_options opt = mt_nlp_options_default();
    mt_nlp_result found = {0};
    mt_subproblem in_gap;
    MT_TRY(mt_arena_check(mem, err));
    to_t(&p->whole, x, t);
    if (best_x != NULL) {
        to_t(&p->whole, best_x, best_t);
        MT_TRY(objective_at(w, best_t, mem, &best_f, err));
    }
    mt_status rc = p->n_avoidances > 0 ? open_gap(w, t, mem, &in_gap, err) : MT_OK;
    if (rc == MT_OK) {
        mt_nlp nlp = mt_workspace_nlp(w);
        t[p->n] = w->c->origin_t[p->n]; /* of a clearance 0: on the edges */
        nlp.origin = t;
        opt.starts = 1;
        opt.max_evals = most < LOCAL_EVALUATIONS ? most : LOCAL_EVALUATIONS;
        rc = mt_workspace_solve(w, &nlp, &opt, mem, &found, err);
    }
    mt_workspace_back(w, &p->whole);
    MT_TRY(rc);
    if (found.n_solutions > 0 && found.solutions[0].feasible) {
        *better =
            best_x == NULL || mt_compare(found.solutions[0].f, best_f, MT_EQUAL_FOUND) < 0;
    }
    return MT_OK;
}

mt_status mt_trade_improves(mt_workspace *w, const double *x, const double *best_x,
                            bool *better, long most, mt_err *err)
{
    mt_arena mem;
    mt_err why = {0};
    *better = false;
    MT_TRY(mt_arena_init(&mem, 0, err));
    const mt_status rc = compare_designs(w, x, best_x, &mem, better, most, &why);
    mt_arena_free(&mem);
    /* a start without a value is no better start, and no failure */
    return mt_pass_final(rc, &why, err);
}
