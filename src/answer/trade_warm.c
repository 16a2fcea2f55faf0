/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Is a neighbour's best design a better start than all that a point was searched from? One
 * local search tells, at a small part of the cost of the point. */
#include <math.h>

#include "answer/trade.h"
#include "nlp/merit.h"
#include "problem/family.h"
#include "search/discrete.h"

enum { LOCAL_EVALUATIONS = 500 };

typedef struct warm {
    const mt_study *study;
    mt_arena mem;
    mt_reference_cache references;
    mt_problem *p;      /* plain */
    mt_problem *in_gap; /* with the assignment of x, where there are bands; else NULL */
} warm;

static void to_t(const mt_problem *p, const double *x, double *t)
{
    for (int i = 0; i < p->n; i++) {
        t[i] = fmin(fmax(mt_problem_t(p, i, x[i]), p->lower_t[i]), p->upper_t[i]);
    }
}

/* The first objective at t as the search sees it. */
static mt_status objective_at(warm *w, const double *t, double *f, mt_err *err)
{
    mt_problem *const p = w->p;
    mt_nlp_values v;
    MT_TRY(mt_problem_values_init(p, &w->mem, &v, err));
    MT_TRY(mt_problem_eval(p, t, false, &v, err));
    *f = mt_aim_value(p, 0, NULL);
    if (mt_objective_is(p->aims[0].type, MT_BANDS)) {
        *f = -mt_clears_room(p);
    }
    return MT_OK;
}

/* The kind of design that t is. */
static mt_status open_gap(warm *w, const double *t, mt_err *err)
{
    const mt_problem *const p = w->p;
    int *const below = mt_arena_int(&w->mem, (size_t)p->n_bands);
    double f = 0.0;
    if (below == NULL) {
        return mt_fail_memory(err);
    }
    MT_TRY(objective_at(w, t, &f, err));
    for (int i = 0; i < p->n_clears; i++) {
        const mt_clear *const c = &p->clears[i];
        (void)mt_clear_violation(c, &p->views[c->view].analysis->modes, below + c->first, NULL);
    }
    if (!mt_ties_agree(p, below)) {
        return mt_fail(err, MT_E_DOMAIN, "a mode crosses a band between two positions");
    }
    return mt_problem_new_in_gap(w->study, &w->references, below, &w->in_gap, err);
}

static mt_status compare(warm *w, const double *x, const double *best_x, bool *better,
                         long *evaluations, mt_err *err)
{
    double *const t = mt_arena_f64(&w->mem, (size_t)w->p->n + 1, 1);
    double *const best_t = mt_arena_f64(&w->mem, (size_t)w->p->n + 1, 1);
    double best_f = HUGE_VAL;
    mt_nlp_options opt = mt_nlp_options_default();
    mt_nlp_result found = {0};
    if (t == NULL || best_t == NULL) {
        return mt_fail_memory(err);
    }
    to_t(w->p, x, t);
    if (best_x != NULL) {
        to_t(w->p, best_x, best_t);
        MT_TRY(objective_at(w, best_t, &best_f, err));
    }
    if (w->p->n_clears > 0) {
        MT_TRY(open_gap(w, t, err));
    }
    mt_nlp nlp = mt_problem_nlp(w->in_gap != NULL ? w->in_gap : w->p);
    nlp.origin = t; /* its last entry, where there is a clearance, is 0: on the edges */
    opt.starts = 1;
    opt.max_evals = LOCAL_EVALUATIONS;
    MT_TRY(mt_nlp_solve(&nlp, &opt, &w->mem, &found, err));
    *evaluations += found.evals;
    if (found.n_solutions > 0 && found.solutions[0].feasible) {
        *better =
            best_x == NULL || mt_compare(found.solutions[0].f, best_f, MT_EQUAL_FOUND) < 0;
    }
    return MT_OK;
}

mt_status mt_trade_improves(const mt_study *study, const double *x, const double *best_x,
                            bool *better, long *evaluations, mt_err *err)
{
    warm w = {.study = study};
    mt_err why = {0};
    *better = false;
    mt_status rc = mt_arena_init(&w.mem, 0, &why);
    rc = rc == MT_OK ? mt_reference_cache_init(&w.references, study, &w.mem, &why) : rc;
    rc = rc == MT_OK ? mt_problem_new(study, &w.references, &w.p, &why) : rc;
    rc = rc == MT_OK ? compare(&w, x, best_x, better, evaluations, &why) : rc;
    mt_problem_delete(w.in_gap);
    mt_problem_delete(w.p);
    mt_reference_cache_free(&w.references);
    mt_arena_free(&w.mem);
    /* a start without a value is no better start, and no failure */
    const bool ends = mt_is_final(rc);
    return ends ? mt_fail(err, rc, "%s", why.text) : MT_OK;
}
