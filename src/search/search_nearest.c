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
 *
 * Often the continuum is one of single variables: neither the objectives nor the rows that hold
 * the optimum change with them (the stiffness of a joint that the lowest modes do not move).
 * Then all others stay where they are, and the question has no more variables than these.
 */
#include <math.h>
#include <string.h>

#include "nlp/merit.h"
#include "problem/evaluate.h"
#include "problem/objective.h"
#include "search/search.h"

/* KKT residuals of local optima. */
static const double SHOWN = 1e-6;
/* Evaluations of one search where the study sets no budget. */
enum { EVALUATIONS = 2000 };
/* From a nearly exact fit to one. */
enum { REFIT = 50 };
/* Of a budget, without which no single variable is looked for. */
enum { LEAST_LEFT = 3 };
/* What repeated modes take to be judged as a cluster, without a search from there. */
enum { JUDGEMENT = 4 };
/* A slope is none below this part of the largest of its row. */
static const double NO_SLOPE = 1e-9;
/* Misfits below this are none. */
static const double EXACT = 1e-9;
/* Modes that meet are this far apart again, as a part of a variable's bounds. */
static const double APART = 0.02;
/* Along one variable: so much of a tolerance is kept, so near the last place that does. */
static const double KEPT = 1e-3;
static const double HALVED = 1e-10;
/* Then the last objective is held within this part of its value (of 1 where that is less), the
 * first that does: so near to the optimum bounds and rows that hold it hold the design, too. */
static const double CLOSE[] = {1e-11, 1e-8};
static const double CLOSE_TOLERANCE = 0.1;

typedef struct nearest {
    mt_workspace *ws;
    const mt_subproblem *first;
    mt_subproblem held;
    mt_arena *mem;
    mt_nlp_result *out;
    long most;
    double *at;    /* [n_stages] what the objectives are held at */
    double close;  /* the last of them within this; 0: as any other one */
    bool clusters; /* a design is judged by repeated modes, too, where it only stands */
} nearest;

/* True where a total change can be minimised that is not an objective already, with objectives
 * that can be held. Not for the objective of a further coordinate; for a misfit only exact fits
 * are moved: other free directions are reported as unidentifiable. */
static bool applies(const mt_subproblem *c)
{
    for (int k = 0; k < c->n_stages; k++) {
        const mt_objective_stage *const a = &c->stages[k];
        if (a->type == MT_OBJECTIVE_CHANGE || a->ops->value == NULL ||
            mt_objective_is(a->type, MT_RESIDUALS) ||
            (mt_objective_is(a->type, MT_BANDS) && !c->clearance) ||
            (mt_objective_is(a->type, MT_SHAKES) && !c->forced_response)) {
            return false;
        }
    }
    return c->n_stages > 0;
}

/* The subproblem with the total change after its objectives. */
static mt_status add_change(nearest *n, mt_err *err)
{
    const size_t n_stages = (size_t)n->first->n_stages;
    mt_subproblem with = *n->first;
    mt_objective_stage *const stages = mt_arena_alloc(n->mem, n_stages + 1, sizeof *stages);
    n->at = mt_arena_f64(n->mem, n_stages, 1);
    MT_TRY(mt_arena_check(n->mem, err));
    memcpy(stages, n->first->stages, n_stages * sizeof *stages);
    stages[n_stages] = (mt_objective_stage){.type = MT_OBJECTIVE_CHANGE,
                                            .ops = &mt_objective_change,
                                            .size = 1.0,
                                            .node = MT_NO_NODE};
    with.stages = stages;
    with.n_stages++;
    return mt_subproblem_for_stages(&with, n->mem, &n->held, err);
}

/* True where the budget has less than `evals` left. */
static bool lacks(const nearest *n, long evals)
{
    return n->most > 0 && n->most - n->out->evals < evals;
}

/* The objectives before `stage` are held, and the workspace is set to that. */
static void hold_earlier_objectives(nearest *n, int stage)
{
    mt_subproblem *const c = &n->held;
    const int last = n->first->n_stages - 1;
    mt_objectives_hold(c, n->ws, stage, n->at);
    if (n->close > 0.0 && stage > last) { /* its row is the last one */
        c->held[last].limit = n->at[last] + (n->close * c->held[last].unit);
        c->rows.in.tol[c->rows.in.n - 1] = CLOSE_TOLERANCE * n->close;
    }
    mt_workspace_back(n->ws, c);
}

/* Minimises one objective from a design with those before it held: *end, NULL where none is
 * found. With one evaluation: that design itself, with its multipliers. */
static mt_status minimise(nearest *n, int stage, long most, const double *from,
                          mt_nlp_solution **end, mt_err *err)
{
    const mt_subproblem *const c = &n->held;
    mt_nlp_result next = {0};
    const long left = n->most > 0 ? n->most - n->out->evals : most;
    const long budget = left < most ? left : most;
    *end = NULL;
    if (budget <= 0) {
        n->out->stop = MT_STOP_MAX_EVALS;
        return MT_OK;
    }
    hold_earlier_objectives(n, stage);
    mt_nlp_options opt = mt_nlp_options_default();
    opt.seed = c->search.seed;
    opt.starts = 1;
    opt.max_evals = budget;
    opt.least_change = c->stages[stage].type == MT_OBJECTIVE_CHANGE;
    mt_nlp nlp = mt_workspace_nlp(n->ws);
    nlp.origin = from;
    nlp.hint = NULL;
    mt_err own = {.code = MT_OK};
    mt_status rc = mt_workspace_solve(n->ws, &nlp, &opt, n->mem, &next, &own);
    if (rc == MT_OK && (most > 1 || n->clusters)) {
        const long judged = most > 1 ? budget : next.evals + JUDGEMENT;
        rc = mt_search_repeated_eigenvalues(n->ws, judged, n->mem, &next, &own);
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
    const double most = mt_subproblem_change(n->first, s->t);
    return end->feasible && end->kkt <= SHOWN &&
           mt_compare(end->f, s->f, MT_EQUAL_FOUND) <= 0 &&
           mt_compare(mt_subproblem_change(n->first, end->t), most, MT_EQUAL_FOUND) <= 0;
}

/* The design of least total change near the optimum s, from `from`: *end, where it is one. */
static mt_status find_nearest_design(nearest *n, const double *from, const mt_nlp_solution *s,
                                     mt_nlp_solution **end, mt_err *err)
{
    const int n_stages = n->first->n_stages;
    mt_nlp_solution *at = NULL;
    *end = NULL;
    MT_TRY(minimise(n, n_stages, EVALUATIONS, from, &at, err));
    if (at != NULL) {
        MT_TRY(minimise(n, n_stages - 1, 1, at->t, end, err));
    }
    if (at != NULL && *end != NULL && !is_better(n, *end, s)) {
        MT_TRY(minimise(n, n_stages - 1, EVALUATIONS, at->t, end, err));
    }
    *end = *end != NULL && is_better(n, *end, s) ? *end : NULL;
    return MT_OK;
}

/* Rows of slopes: m x n column-major, or a gradient (m = 1). idle[j] stays where the row has no
 * slope along t_j. */
static void keep_idle(int m, int n, int row, const double *slopes, bool *idle)
{
    double most = 0.0;
    for (int j = 0; j < n; j++) {
        most = fmax(most, fabs(slopes[row + ((ptrdiff_t)j * m)]));
    }
    for (int j = 0; j < n; j++) {
        idle[j] = idle[j] && fabs(slopes[row + ((ptrdiff_t)j * m)]) <= NO_SLOPE * most;
    }
}

/* idle[n_t]: free variables that affect neither the objectives at s nor its active rows;
 * *n_idle: their number. */
static mt_status find_idle(nearest *n, const mt_nlp_solution *s, bool *idle, int *n_idle,
                           mt_err *err)
{
    mt_workspace *const w = n->ws;
    const mt_subproblem *const c = n->first;
    mt_nlp_values v;
    *n_idle = 0;
    mt_workspace_back(w, c);
    double *const slope = mt_arena_f64(n->mem, (size_t)c->n_t, 1);
    MT_TRY(mt_arena_check(n->mem, err));
    MT_TRY(mt_subproblem_values_init(c, n->mem, &v, err));
    n->out->evals++;
    MT_TRY(mt_workspace_eval(w, s->t, true, &v, err));
    for (int j = 0; j < c->n_t; j++) {
        idle[j] = c->n_t == c->p->n && c->lower_t[j] < c->upper_t[j];
    }
    for (int k = 0; k < c->n_stages; k++) {
        (void)mt_objective_stage_value(w, k, slope);
        keep_idle(1, c->n_t, 0, slope, idle);
    }
    const int n_eq = c->rows.eq.n;
    const int n_in = c->rows.in.n;
    for (int i = 0; i < n_eq; i++) {
        keep_idle(n_eq, c->n_t, i, v.deq, idle);
    }
    double most = 0.0;
    for (int i = 0; i < n_in; i++) {
        most = fmax(most, fabs(s->mult_in[i]));
    }
    for (int i = 0; i < n_in; i++) {
        if (!(fabs(s->mult_in[i]) <=
              NO_SLOPE * most)) { /* NaN: one of several that may hold it */
            keep_idle(n_in, c->n_t, i, v.din, idle);
        }
    }
    for (int j = 0; j < c->n_t; j++) {
        *n_idle += idle[j] ? 1 : 0;
    }
    return MT_OK;
}

/* The bounds of the subproblem fixed at t, except for the open variables. */
static mt_status close_rest(nearest *n, const double *t, const bool *open, mt_err *err)
{
    mt_subproblem *const c = &n->held;
    const size_t n_t = (size_t)c->n_t;
    double *const bounds = mt_arena_f64(n->mem, 5, n_t);
    MT_TRY(mt_arena_check(n->mem, err));
    double *const x = bounds + (4 * n_t);
    mt_subproblem_x(c, t, x);
    for (size_t j = 0; j < n_t; j++) {
        bounds[j] = open[j] ? c->lower[j] : x[j];
        bounds[n_t + j] = open[j] ? c->upper[j] : x[j];
        bounds[(2 * n_t) + j] = open[j] ? c->lower_t[j] : t[j];
        bounds[(3 * n_t) + j] = open[j] ? c->upper_t[j] : t[j];
    }
    c->lower = bounds;
    c->upper = bounds + n_t;
    c->lower_t = bounds + (2 * n_t);
    c->upper_t = bounds + (3 * n_t);
    return MT_OK;
}

/* *held: only idle variables are free at s. Tested by the objective's own search with those
 * fixed, which begins and ends at s and knows its curvature. Idle variables are moved away from
 * the original, where modes may meet and rows have no slopes. */
static mt_status is_rest_held(nearest *n, const mt_nlp_solution *s, const bool *idle,
                              bool *held, mt_err *err)
{
    const size_t n_t = (size_t)n->first->n_t;
    const mt_subproblem whole = n->held;
    mt_nlp_solution *end = NULL;
    bool *const rest = mt_arena_alloc(n->mem, n_t, sizeof *rest);
    double *const t = mt_arena_f64(n->mem, n_t, 1);
    MT_TRY(mt_arena_check(n->mem, err));
    for (size_t j = 0; j < n_t; j++) {
        const double lower = whole.lower_t[j];
        const double upper = whole.upper_t[j];
        const double way = (s->t[j] < whole.origin_t[j] ? -APART : APART) * (upper - lower);
        rest[j] = !idle[j];
        t[j] = idle[j] ? fmin(fmax(s->t[j] + way, lower), upper) : s->t[j];
    }
    MT_TRY(close_rest(n, t, rest, err));
    const mt_status rc = minimise(n, n->first->n_stages - 1, EVALUATIONS, t, &end, err);
    n->held = whole;
    *held = rc == MT_OK && end != NULL && end->feasible && end->kkt <= SHOWN &&
            end->n_loose == 0 && mt_search_same((int)n_t, end->t, t);
    return rc;
}

/* True where a design satisfies what s satisfies, within the part of the tolerances that
 * comparisons of designs allow, and its last objective is that of s. */
static mt_status keeps(nearest *n, const double *t, double f, mt_nlp_values *v, bool *kept,
                       mt_err *err)
{
    const mt_subproblem *const c = n->first;
    mt_err own = {.code = MT_OK};
    n->out->evals++;
    const mt_status rc = mt_workspace_eval(n->ws, t, false, v, &own);
    *kept = false;
    if (rc == MT_OK) {
        const mt_missed m = mt_subproblem_missed(c, v);
        *kept = m.violation <= KEPT && mt_compare(v->f, f, MT_EQUAL_FOUND) <= 0;
    }
    return mt_pass_final(rc, &own, err);
}

/* Moves t (initially s) along t_j to the original value, or as near as the rows allow, by
 * halving: rows have no slopes where modes meet. */
static mt_status approach(nearest *n, int j, double f, double *t, mt_err *err)
{
    const mt_subproblem *const c = n->first;
    mt_nlp_values v;
    const double origin = fmin(fmax(c->origin_t[j], c->lower_t[j]), c->upper_t[j]);
    double good = t[j];
    double bad = origin;
    bool kept = false;
    mt_workspace_back(n->ws, c);
    MT_TRY(mt_subproblem_values_init(c, n->mem, &v, err));
    t[j] = origin;
    MT_TRY(keeps(n, t, f, &v, &kept, err));
    good = kept ? origin : good;
    while (fabs(good - bad) > HALVED && !lacks(n, 2)) {
        t[j] = 0.5 * (good + bad);
        MT_TRY(keeps(n, t, f, &v, &kept, err));
        good = kept ? t[j] : good;
        bad = kept ? bad : t[j];
    }
    t[j] = good;
    return MT_OK;
}

/* Where only single variables are free at s: moves along these alone. */
static mt_status along_idle(nearest *n, const mt_nlp_solution *s, mt_nlp_solution **end,
                            mt_err *err)
{
    const int n_stages = n->first->n_stages;
    const int n_t = n->first->n_t;
    const mt_subproblem whole = n->held;
    mt_nlp_solution *at = NULL;
    int n_idle = 0;
    bool *const idle = mt_arena_alloc(n->mem, (size_t)n_t, sizeof *idle);
    double *const t = mt_arena_f64(n->mem, (size_t)n_t, 1);
    MT_TRY(mt_arena_check(n->mem, err));
    if (lacks(n, LEAST_LEFT)) {
        return MT_OK;
    }
    MT_TRY(find_idle(n, s, idle, &n_idle, err));
    bool all = n_idle > 0 && n_idle >= s->n_loose;
    if (n_idle > 0 && !all) {
        MT_TRY(is_rest_held(n, s, idle, &all, err));
    }
    if (!all) {
        return MT_OK;
    }
    memcpy(t, s->t, (size_t)n_t * sizeof *t);
    if (n_idle == 1) {
        int j = 0;
        while (!idle[j]) {
            j++;
        }
        MT_TRY(approach(n, j, s->f, t, err));
    } else {
        MT_TRY(close_rest(n, s->t, idle, err));
        const mt_status rc = minimise(n, n_stages, EVALUATIONS, s->t, &at, err);
        n->held = whole;
        MT_TRY(rc);
        if (at == NULL) {
            return MT_OK;
        }
        memcpy(t, at->t, (size_t)n_t * sizeof *t);
    }
    n->close = CLOSE[0];
    n->clusters = true; /* where one more mode has come to the limit */
    const mt_status rc = minimise(n, n_stages - 1, 1, t, end, err);
    n->clusters = false;
    *end = *end != NULL && is_better(n, *end, s) ? *end : NULL;
    return rc;
}

/* Replaces the design of s by `end`, keeping how s was found. */
static void put_nearer(mt_nlp_solution *s, const mt_nlp_solution *end)
{
    const mt_nlp_solution old = *s;
    *s = *end;
    s->singular = s->singular || old.singular;
    s->continuum = old.continuum;
    s->start = old.start;
    s->hits = old.hits;
}

/* Solution s; f: its objectives. */
static mt_status move_to_nearest(nearest *n, double *f, const double *limit, mt_nlp_solution *s,
                                 mt_err *err)
{
    const int n_stages = n->first->n_stages;
    mt_nlp_solution *near = NULL;
    mt_nlp_solution *end = NULL;
    for (int k = 0; k < n_stages; k++) {
        n->at[k] = k + 1 < n_stages && limit != NULL ? limit[k] : f[k];
    }
    n->close = 0.0;
    MT_TRY(along_idle(n, s, &end, err));
    n->close = 0.0;
    if (end == NULL) {
        MT_TRY(minimise(n, n_stages, EVALUATIONS, s->t, &near, err));
    }
    for (int k = 0; k < MT_COUNT(CLOSE) && near != NULL && end == NULL; k++) {
        n->close = CLOSE[k];
        MT_TRY(find_nearest_design(n, near->t, s, &end, err));
    }
    if (end == NULL) {
        return MT_OK; /* it stands as it is */
    }
    const bool moved = !mt_search_same(n->first->p->n, end->t, s->t);
    put_nearer(s, end);
    s->continuum = s->continuum || (n->first->below == NULL && moved);
    s->flat = true;
    f[n_stages - 1] = s->f;
    return MT_OK;
}

/* The residuals are met exactly by more than one design: fewer than variables. */
static bool is_open_fit(const mt_subproblem *c)
{
    return c->n_stages == 1 && mt_objective_is(c->stages[0].type, MT_RESIDUALS) &&
           c->rows.eq.n == 0 && c->rows.res.n < c->n_t;
}

static bool is_exact(const mt_nlp_solution *s)
{
    return s->feasible && s->f <= 0.5 * EXACT * EXACT;
}

/* For an exact fit s: the exact fit of least total change near it. */
static mt_status move_fit(nearest *n, mt_nlp_solution *s, mt_err *err)
{
    mt_nlp_solution *near = NULL;
    mt_nlp_solution *end = NULL;
    mt_nlp_values v;
    if (lacks(n, 2)) {
        n->out->stop = MT_STOP_MAX_EVALS;
        return MT_OK;
    }
    n->close = 0.0;
    n->at[0] = s->f;
    mt_workspace_back(n->ws, n->first);
    MT_TRY(mt_subproblem_values_init(n->first, n->mem, &v, err));
    n->out->evals++;
    MT_TRY(mt_workspace_eval(n->ws, s->t, false, &v, err)); /* the residuals it is held at */
    MT_TRY(minimise(n, 1, EVALUATIONS, s->t, &near, err));
    if (near != NULL) {
        MT_TRY(minimise(n, 0, REFIT, near->t, &end, err)); /* from within what it was held in */
    }
    if (end == NULL || !is_exact(end) ||
        mt_compare(mt_subproblem_change(n->first, end->t), mt_subproblem_change(n->first, s->t),
                   MT_EQUAL_FOUND) > 0) {
        return MT_OK; /* it stands as it is */
    }
    /* no misfit is less: what is left of slopes is rounding, to the scale of its search */
    end->kkt = s->kkt;
    put_nearer(s, end);
    return MT_OK;
}

/* By the objective, of equal ones the nearest first. */
static void sort(const mt_subproblem *c, mt_nlp_result *out)
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
static void merge_duplicate_solutions(const mt_subproblem *c, mt_nlp_result *out)
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
    const int n_stages = n.first->n_stages;
    const bool fits = is_open_fit(n.first);
    bool any = false;
    for (int i = 0; i < out->n_solutions; i++) {
        const mt_nlp_solution *const s = &out->solutions[i];
        any = any || (fits ? is_exact(s) : s->flat && s->kkt <= SHOWN);
    }
    if (!any || n.first->as_found || !(fits || applies(n.first)) || out->compromise ||
        out->stop != MT_STOP_DONE) {
        return MT_OK;
    }
    MT_TRY(add_change(&n, err));
    mt_status rc = MT_OK;
    for (int i = 0; i < out->n_solutions && n.out->stop == MT_STOP_DONE && rc == MT_OK; i++) {
        mt_nlp_solution *const s = &out->solutions[i];
        const ptrdiff_t row = (ptrdiff_t)i * n_stages;
        double own = s->f;
        if (fits && is_exact(s)) {
            rc = move_fit(&n, s, err);
        } else if (!fits && s->flat && s->feasible && s->kkt <= SHOWN) {
            rc = move_to_nearest(&n, f != NULL ? f + row : &own,
                                 limit != NULL ? limit + row : NULL, s, err);
        }
    }
    mt_workspace_back(ws, n.first);
    if (n_stages == 1) {
        sort(n.first, out);
        merge_duplicate_solutions(n.first, out);
    }
    return rc;
}
