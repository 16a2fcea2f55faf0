/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Where the optimum is flat every design of a continuum is optimal, and a local search ends
 * anywhere in it. The design that stands for them answers one more question,
 *
 *     minimise 1/2 sum w_i (t_i - t_i(original))^2   with f_k <= f_k* + what it is held in,
 *
 * whose answer does not depend on where the search ended. It is put twice: with f_k held as any
 * objective that comes before another, which leaves a way along the continuum, then closely,
 * where rows and bounds that hold the optimum hold the answer, too. There the multipliers and
 * the KKT residual are those of the objective. Where it is curved across the continuum it has a
 * residual even so near; then the objective from there comes back to the optimum.
 */
#include <math.h>
#include <string.h>

#include "nlp/merit.h"
#include "problem/objective.h"
#include "search/search.h"

/* KKT residuals of local optima. */
static const double SHOWN = 1e-6;
/* Evaluations of one search where the study sets no budget. */
enum { EVALUATIONS = 2000 };
/* Then the last objective is held within this part of its value (of 1 where that is less), the
 * first that does: so near to the optimum bounds and rows that hold it hold the design, too. */
static const double CLOSE[] = {1e-11, 1e-8};
static const double CLOSE_TOLERANCE = 0.1;

typedef struct nearest {
    mt_workspace *ws;
    const mt_case *first;
    mt_case held;
    mt_arena *mem;
    mt_nlp_result *out;
    long most;
    double *at;   /* [n_aims] what the objectives are held at */
    double close; /* the last of them within this; 0: as any other one */
} nearest;

/* True where there is a change to be made least that is no objective already, with objectives
 * that can be held. A coordinate of the search has its objective, which elsewhere is looked up
 * afterwards; what a misfit leaves open is told as undetermined. */
static bool applies(const mt_case *c)
{
    for (int k = 0; k < c->n_aims; k++) {
        const mt_aim *const a = &c->aims[k];
        if (a->type == MT_OBJECTIVE_CHANGE || a->ops->value == NULL ||
            mt_objective_is(a->type, MT_RESIDUALS) ||
            (mt_objective_is(a->type, MT_BANDS) && !c->clearance) ||
            (mt_objective_is(a->type, MT_SHAKES) && !c->shaken)) {
            return false;
        }
    }
    return c->n_aims > 0;
}

/* The case with the change behind its objectives. */
static mt_status add_change(nearest *n, mt_err *err)
{
    const size_t n_aims = (size_t)n->first->n_aims;
    mt_case with = *n->first;
    mt_aim *const aims = mt_arena_alloc(n->mem, n_aims + 1, sizeof *aims);
    n->at = mt_arena_f64(n->mem, n_aims, 1);
    MT_TRY(mt_arena_check(n->mem, err));
    memcpy(aims, n->first->aims, n_aims * sizeof *aims);
    aims[n_aims] = (mt_aim){.type = MT_OBJECTIVE_CHANGE,
                            .ops = &mt_objective_change,
                            .size = 1.0,
                            .node = MT_NO_NODE};
    with.aims = aims;
    with.n_aims++;
    return mt_case_for_stages(&with, n->mem, &n->held, err);
}

/* The objectives before `stage` are held, and the workspace is set to that. */
static void hold(nearest *n, int stage)
{
    mt_case *const c = &n->held;
    c->stage = stage;
    for (int k = 0; k < stage; k++) {
        mt_aim_hold(c, n->ws, k, n->at[k]);
        if (n->close > 0.0 && k + 1 == n->first->n_aims) {
            c->held[k].limit = n->at[k] + (n->close * c->held[k].unit);
            c->in_tol[c->n_in + k] = CLOSE_TOLERANCE * n->close;
        }
    }
    mt_workspace_back(n->ws, c);
}

/* One objective from a design with those before it held: *end, NULL where it finds none. With
 * one evaluation: that design itself, with its multipliers. */
static mt_status minimise(nearest *n, int stage, long most, const double *from,
                          mt_nlp_solution **end, mt_err *err)
{
    const mt_case *const c = &n->held;
    mt_nlp_result next = {0};
    const long left = n->most > 0 ? n->most - n->out->evals : most;
    const long budget = left < most ? left : most;
    *end = NULL;
    if (budget <= 0) {
        n->out->stop = MT_STOP_MAX_EVALS;
        return MT_OK;
    }
    hold(n, stage);
    mt_nlp_options opt = mt_nlp_options_default();
    opt.seed = c->search.seed;
    opt.starts = 1;
    opt.max_evals = budget;
    opt.least_change = c->aims[stage].type == MT_OBJECTIVE_CHANGE;
    mt_nlp nlp = mt_workspace_nlp(n->ws);
    nlp.origin = from;
    nlp.hint = NULL;
    mt_err own = {.code = MT_OK};
    mt_status rc = mt_workspace_solve(n->ws, &nlp, &opt, n->mem, &next, &own);
    if (rc == MT_OK && most > 1) {
        rc = mt_search_repeated(n->ws, budget, n->mem, &next, &own);
    }
    n->out->evals += next.evals;
    if (next.stop == MT_STOP_MAX_EVALS && (most == 1 || n->most <= 0)) {
        next.stop = MT_STOP_DONE; /* the budget of the study is not spent */
    }
    n->out->stop = next.stop > n->out->stop ? next.stop : n->out->stop;
    if (mt_is_final(rc) || rc == MT_E_USAGE) {
        return mt_fail(err, rc, "%s", own.text);
    }
    if (rc == MT_OK && next.stop == MT_STOP_DONE && next.n_solutions > 0 && !next.compromise) {
        *end = next.solutions;
    }
    return MT_OK;
}

/* An optimum is as good as s, and nearer. */
static bool is_better(const nearest *n, const mt_nlp_solution *end, const mt_nlp_solution *s)
{
    const double most = mt_case_change(n->first, s->t);
    return end->feasible && end->kkt <= SHOWN &&
           mt_compare(end->f, s->f, MT_EQUAL_FOUND) <= 0 &&
           mt_compare(mt_case_change(n->first, end->t), most, MT_EQUAL_FOUND) <= 0;
}

/* The design of least change next to the optimum of s, from `from`: *end, where it is one. */
static mt_status settle(nearest *n, const double *from, const mt_nlp_solution *s,
                        mt_nlp_solution **end, mt_err *err)
{
    const int n_aims = n->first->n_aims;
    mt_nlp_solution *at = NULL;
    *end = NULL;
    MT_TRY(minimise(n, n_aims, EVALUATIONS, from, &at, err));
    if (at != NULL) {
        MT_TRY(minimise(n, n_aims - 1, 1, at->t, end, err));
    }
    if (at != NULL && *end != NULL && !is_better(n, *end, s)) {
        MT_TRY(minimise(n, n_aims - 1, EVALUATIONS, at->t, end, err));
    }
    *end = *end != NULL && is_better(n, *end, s) ? *end : NULL;
    return MT_OK;
}

/* Solution s; f: its objectives. */
static mt_status move(nearest *n, double *f, const double *limit, mt_nlp_solution *s,
                      mt_err *err)
{
    const int n_aims = n->first->n_aims;
    mt_nlp_solution *near = NULL;
    mt_nlp_solution *end = NULL;
    for (int k = 0; k < n_aims; k++) {
        n->at[k] = k + 1 < n_aims && limit != NULL ? limit[k] : f[k];
    }
    n->close = 0.0;
    MT_TRY(minimise(n, n_aims, EVALUATIONS, s->t, &near, err));
    for (int k = 0; k < MT_COUNT(CLOSE) && near != NULL && end == NULL; k++) {
        n->close = CLOSE[k];
        MT_TRY(settle(n, near->t, s, &end, err));
    }
    if (end == NULL) {
        return MT_OK; /* it stands as it is */
    }
    const mt_nlp_solution old = *s;
    *s = *end;
    s->singular = s->singular || old.singular;
    s->continuum = old.continuum ||
                   (n->first->below == NULL && !mt_search_same(n->first->p->n, s->t, old.t));
    s->flat = true;
    s->start = old.start;
    s->hits = old.hits;
    f[n_aims - 1] = s->f;
    return MT_OK;
}

/* By the objective, of equal ones the nearest first. */
static void sort(const mt_case *c, mt_nlp_result *out)
{
    for (int i = 1; i < out->n_solutions; i++) {
        const mt_nlp_solution s = out->solutions[i];
        int k = i;
        for (; k > 0; k--) {
            const mt_nlp_solution *const other = &out->solutions[k - 1];
            const int order = mt_compare(s.f, other->f, MT_EQUAL_FOUND);
            if (order > 0 || (order == 0 && !mt_search_nearer(c, s.t, other->t))) {
                break;
            }
            out->solutions[k] = *other;
        }
        out->solutions[k] = s;
    }
}

/* Those that have become one count once. */
static void merge(const mt_case *c, mt_nlp_result *out)
{
    int kept = 0;
    for (int i = 0; i < out->n_solutions; i++) {
        const mt_nlp_solution s = out->solutions[i];
        int twin = 0;
        while (twin < kept && !mt_search_same(c->p->n, out->solutions[twin].t, s.t)) {
            twin++;
        }
        if (twin < kept) {
            out->solutions[twin].hits += s.hits;
            out->solutions[twin].continuum = out->solutions[twin].continuum || s.continuum;
        } else {
            out->solutions[kept++] = s;
        }
    }
    if (kept == out->n_solutions) {
        return;
    }
    out->n_solutions = kept;
    out->n_found = kept; /* of those not kept nobody knows */
    out->n_once = 0;
    for (int i = 0; i < kept; i++) {
        out->n_once += out->solutions[i].hits == 1;
    }
    out->missing = nan("");
}

mt_status mt_search_nearest(mt_workspace *ws, long most, double *f, const double *limit,
                            mt_arena *mem, mt_nlp_result *out, mt_err *err)
{
    nearest n = {.ws = ws, .first = ws->c, .mem = mem, .out = out, .most = most};
    const int n_aims = n.first->n_aims;
    bool any = false;
    for (int i = 0; i < out->n_solutions; i++) {
        any = any || (out->solutions[i].flat && out->solutions[i].kkt <= SHOWN);
    }
    if (!any || !applies(n.first) || out->compromise || out->stop != MT_STOP_DONE) {
        return MT_OK;
    }
    MT_TRY(add_change(&n, err));
    mt_status rc = MT_OK;
    for (int i = 0; i < out->n_solutions && n.out->stop == MT_STOP_DONE && rc == MT_OK; i++) {
        mt_nlp_solution *const s = &out->solutions[i];
        const ptrdiff_t row = (ptrdiff_t)i * n_aims;
        double own = s->f;
        if (s->flat && s->feasible && s->kkt <= SHOWN) {
            rc = move(&n, f != NULL ? f + row : &own, limit != NULL ? limit + row : NULL, s,
                      err);
        }
    }
    mt_workspace_back(ws, n.first);
    if (n_aims == 1) {
        sort(n.first, out);
        merge(n.first, out);
    }
    return rc;
}
