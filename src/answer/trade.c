/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The front of a trade study, and the objectives that it compares. */
#include "answer/trade.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "answer/solve.h"
#include "base/format.h"
#include "base/workers.h"
#include "describe/describe.h"
#include "model/values.h"
#include "nlp/merit.h"
#include "problem/avoidance.h"
#include "problem/drive_positions.h"
#include "problem/evaluate.h"
#include "problem/objective.h"
#include "problem/tolerance.h"
#include "search/catalogue_search.h"

/* What the front compares, less is better; NaN: does not take part. */
typedef struct pair {
    double f[2];
} pair;

enum { POINTER_TEXT = 32 };
static const double PERCENT = 100.0;

/* The largest part that a design's forced vibrations have of the study's own limits, whichever
 * the point has [%]; NaN where one is not known. */
static double largest_part(const mt_study *study, const mt_recommendation *r)
{
    double most = 0.0;
    for (int g = 0; g < study->n_goals; g++) {
        char pointer[POINTER_TEXT];
        (void)mt_snprintf(pointer, sizeof pointer, "/goals/%d", g);
        for (int i = 0; i < r->n_responses && mt_goal_is_limit(&study->goals[g]); i++) {
            const mt_result_response *const found = &r->responses[i];
            const double part = PERCENT * found->value / study->goals[g].at_most;
            const bool own = strcmp(found->pointer, pointer) == 0;
            most = own && !(part <= most) ? part : most;
        }
    }
    return most;
}

/* An objective of the front at a design, as people see it; NaN: not known. */
static double shown_value(const mt_study *study, mt_objective_type type,
                          const mt_recommendation *r)
{
    const bool is_first = study->n_objectives > 0 && study->objectives[0].type == type;
    if (type == MT_OBJECTIVE_CHANGE) {
        return r->change;
    }
    if (mt_objective_is(type, MT_RESIDUALS)) {
        return r->misfit;
    }
    if (mt_objective_is(type, MT_BANDS)) {
        return r->clearance_percent;
    }
    if (mt_objective_is(type, MT_SHAKES) && !is_first) {
        return largest_part(study, r);
    }
    return is_first ? r->score : nan("");
}

/* The same, signed so that less is better; NaN where the design does not meet the goals. */
static double front_value(const mt_study *study, mt_objective_type type,
                          const mt_recommendation *r)
{
    if (r == NULL || !r->feasible) {
        return nan("");
    }
    const double value = shown_value(study, type, r);
    return mt_objective_is(type, MT_BANDS) ? -value : value;
}

/* a is as good as b in both and better in one, by more than the searches' rounding. */
static bool dominates(const pair *p, const pair *q)
{
    const double *const a = p->f;
    const double *const b = q->f;
    const int first = mt_compare(a[0], b[0], MT_EQUAL_FOUND);
    const int second = mt_compare(a[1], b[1], MT_EQUAL_FOUND);
    return MT_HAS(a[0] + a[1]) && first <= 0 && second <= 0 && first + second < 0;
}

/* Two points have the same in both. */
static bool ties(const pair *p, const pair *q)
{
    const double *const a = p->f;
    const double *const b = q->f;
    return MT_HAS(a[0] + a[1]) && MT_HAS(b[0] + b[1]) &&
           mt_compare(a[0], b[0], MT_EQUAL_JUDGED) == 0 &&
           mt_compare(a[1], b[1], MT_EQUAL_JUDGED) == 0;
}

/* Marks the points that no other dominates in both objectives. Values within search accuracy
 * are equal, which is not transitive: of two equal points a third may dominate one alone; that
 * one is then on the front too. */
static void mark_pareto_points(int n, const pair *front, mt_trade_point *points)
{
    for (int k = 0; k < n; k++) {
        bool beaten = !MT_HAS(front[k].f[0]) || !MT_HAS(front[k].f[1]);
        for (int i = 0; i < n; i++) {
            beaten = beaten || dominates(&front[i], &front[k]);
        }
        points[k].pareto = !beaten;
    }
    for (int k = 0; k < n; k++) {
        for (int i = 0; i < n && points[k].pareto; i++) {
            points[i].pareto = points[i].pareto || ties(&front[k], &front[i]);
        }
    }
}

static bool has_objective(const mt_recommendation *r, const char *name)
{
    for (int i = 0; i < r->n_objectives; i++) {
        if (strcmp(r->objectives[i].text, name) == 0) {
            return true;
        }
    }
    return false;
}

/* Objectives of the front that are none of the study's stand behind these at every point. A
 * clearance is a member of its own. */
static mt_status add_objectives(const mt_study *study, const mt_recommendation *baseline,
                                mt_recommendation *best, mt_arena *mem, mt_err *err)
{
    const mt_trade *const asked = &study->trade;
    bool moved = false; /* each point has another original design */
    const size_t n = (size_t)best->n_objectives;
    mt_design_objective *const all =
        mt_arena_alloc(mem, n + (size_t)asked->n_objectives, sizeof *all);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < asked->n_vary; i++) {
        moved = moved || asked->vary[i].kind == MT_VARY_PARAMETER;
    }
    if (n > 0) {
        memcpy(all, best->objectives, n * sizeof *all);
    }
    best->objectives = all;
    for (int i = 0; i < asked->n_objectives; i++) {
        const mt_objective_type type = asked->objectives[i];
        const mt_objective_kind *const kind = mt_objective_kind_of(type);
        if (mt_objective_is(type, MT_BANDS) || has_objective(best, kind->name)) {
            continue;
        }
        all[best->n_objectives++] = (mt_design_objective){
            .text = kind->name,
            .unit = kind->unit,
            .original = moved ? nan("") : shown_value(study, type, baseline),
            .recommended = shown_value(study, type, best)};
    }
    return MT_OK;
}

/* trade.c: marks the points of out that no other dominates, and adds to every point the
 * objectives of the front that the study does not have. best[n_points]: the best design of each
 * (copied in out) or NULL; baseline: the original. Fails: MT_E_MEMORY. */
static mt_status trade_front(const mt_study *study, const mt_recommendation *const *best,
                             const mt_recommendation *baseline, mt_arena *mem,
                             mt_trade_result *out, mt_err *err)
{
    const mt_trade *const asked = &study->trade;
    pair *const front = mt_arena_alloc(mem, (size_t)out->n_points, sizeof *front);
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < out->n_points; k++) {
        for (int i = 0; i < asked->n_objectives; i++) {
            front[k].f[i] = front_value(study, asked->objectives[i], best[k]);
        }
        if (best[k] != NULL) {
            MT_TRY(add_objectives(study, baseline, &out->points[k].best, mem, err));
        }
    }
    if (asked->n_objectives == 2) {
        mark_pareto_points(out->n_points, front, out->points);
    }
    return MT_OK;
}

/* The study of one point of a trade study: a shallow copy with its numbers put in. */

static void *copied(mt_arena *mem, const void *items, int n, size_t size)
{
    void *const copy = mt_arena_alloc(mem, (size_t)n, size);
    if (copy != NULL && n > 0) {
        memcpy(copy, items, (size_t)n * size);
    }
    return copy;
}

/* A model with another value of a parameter; variables start from the values that follow. */
static mt_status put_parameter(mt_study *s, int parameter, double value, mt_arena *mem,
                               mt_err *err)
{
    mt_model *const model = copied(mem, s->model, 1, sizeof *model);
    mt_number *const nums =
        copied(mem, s->model->nums, s->model->n_nums, sizeof *s->model->nums);
    s->original = mt_arena_f64(mem, (size_t)s->model->n_parameters, 1);
    MT_TRY(mt_arena_check(mem, err));
    mt_number *const number = &nums[model->parameters[parameter].value];
    MT_TRY(mt_expr_number(value, mem, &number->expr, err));
    model->nums = nums;
    s->model = model;
    MT_TRY(mt_model_original_values(model, mem, s->original, NULL, err));
    for (int i = 0; i < s->n_variables; i++) {
        s->variables[i].original = s->original[s->variables[i].parameter];
    }
    return MT_OK;
}

static mt_status set_varied_number(mt_study *s, const mt_vary *v, double value, mt_arena *mem,
                                   mt_err *err)
{
    switch (v->kind) {
    case MT_VARY_BOUND: {
        mt_variable *const variable = &s->variables[v->variable];
        *(v->upper ? &variable->upper : &variable->lower) = value;
        return MT_OK;
    }
    case MT_VARY_GOAL: {
        mt_goal *const g = &s->goals[v->goal];
        if (v->slot != MT_SLOT_MARGIN) {
            g->number[v->slot] = value;
            return MT_OK;
        }
        mt_avoid *const avoid = copied(mem, g->avoid, 1, sizeof *avoid);
        MT_TRY(mt_arena_check(mem, err));
        g->avoid = avoid;
        return mt_bands_make(&avoid->source, value, mem, &avoid->bands, err);
    }
    case MT_VARY_PARAMETER:
        return put_parameter(s, v->parameter, value, mem, err);
    }
    return mt_fail(err, MT_E_INTERNAL, "a trade study varies nothing");
}

/* trade.c: the study of one point, with values[n_vary]. Unchanged parts are borrowed,
 * changed ones are in mem. Fails: MT_E_MEMORY, MT_E_DOMAIN (a parameter without a value). */
static mt_status trade_study(const mt_study *study, const double *values, mt_arena *mem,
                             mt_study *out, mt_err *err)
{
    *out = *study;
    out->trade.n_vary = 0;
    out->n_published = 0;
    out->n_warnings = 0;
    out->examined = true;
    out->weight_sensitivity.factor = nan("");
    out->recommendations = 1;
    out->search.settles = study->search.starts <= 0;
    out->variables =
        copied(mem, study->variables, study->n_variables, sizeof *study->variables);
    out->goals = copied(mem, study->goals, study->n_goals, sizeof *study->goals);
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < study->trade.n_vary; k++) {
        MT_TRY(set_varied_number(out, &study->trade.vary[k], values[k], mem, err));
    }
    return MT_OK;
}

/* Whether a neighbour's best design is a better start than all that a point was searched from.
 * One local search tells, at a small part of the cost of the point. */

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

/* trade.c; *better: a local search from x[n_variables], with about `most` evaluations at
 * most, finds a better design of w's point than best_x (NULL: any feasible one). w is set to
 * the whole subproblem, and to it again afterwards. */
static mt_status trade_improves(mt_workspace *w, const double *x, const double *best_x,
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

/* Points in their order, on all workers; what is kept of each. */

typedef struct point {
    double values[MT_MAX_VARY];
    mt_arena mem; /* of its study; while the question is there */
    mt_question
        *q; /* owned; answered once, or from better starts, too; NULL: not begun, or done
                     * with */
    mt_result *first;   /* of the first pass; owned, until it is told */
    mt_result *again;   /* of the second, where a neighbour knew better; likewise, or NULL */
    const double *near; /* [n_variables] the design that meets all goals which the first pass
                         * found: what neighbours start from; NULL: none */
    long evaluations;
    long multiplications;
    long solutions; /* modal ones */
} point;

/* Points that are answered at a time, beside a row of the grid, where each is a task: each is
 * kept compiled, in about a quarter of a megabyte, or what its model needs. Tiles that are
 * answered at a time: of their points the answers alone are kept. */
enum { BLOCK = 75, TILES = 16 };
/* Evaluations beside one local search that asks whether a neighbour knows better; and without
 * which a point is not searched again. */
enum { LOOKS = 3, WARM_LEAST = 30 };
enum { WAYS = 4 }; /* neighbours of a point */
/* Size of a tile of the grid, which one worker answers line by line, each point from what is
 * known of the one before it and of the one in the line before: as many lines, and as many
 * points of each, where that leaves so many tiles, or fewer. */
enum { LINES_MOST = 5, STRETCH_MOST = 10, TILES_LEAST = 32 };

typedef struct trade {
    const mt_study *study;
    const mt_run *run; /* of all points */
    int n;
    int size[MT_MAX_VARY]; /* values of each quantity; 1 where there is none */
    int line;              /* points of a line, in which the last quantity varies */
    int stretch;           /* points of a line of a tile */
    int lines;             /* lines of a tile */
    int from;              /* point of the first task */
    int told;              /* points whose answers the result has; of others it is not known */
    mt_trade_result *out;
    const mt_recommendation **best; /* [n] of those that are told; NULL: there is none */
    mt_arena *mem;                  /* while it is answered */
    mt_arena *kept;                 /* of the result */
    bool warm; /* a combination of catalogue values is reached from any start: no second pass */
    point *points;
} trade;

static bool stopped(const trade *t)
{
    return mt_interrupted(t->run->interrupt);
}

static const mt_recommendation *best_recommendation(const mt_result *r)
{
    return r != NULL && r->n_recommendations > 0 ? &r->recommendations[0] : NULL;
}

static const mt_result *answer_of(const point *p)
{
    return p->again != NULL ? p->again : p->first;
}

/* Unit in which the values of a parameter, a bound or a goal are shown; NULL: SI. */
static const mt_unit *unit_of_varied(const mt_study *study, const mt_vary *v)
{
    if (v->kind == MT_VARY_PARAMETER) {
        return mt_study_unit(study, v->parameter);
    }
    if (v->kind == MT_VARY_BOUND) {
        return study->variables[v->variable].shown;
    }
    return v->slot == MT_SLOT_MARGIN
               ? NULL
               : mt_study_requirement_unit(study, &study->goals[v->goal].expression);
}

/* "upper bound of L = 170 mm" */
static const char *value_text(const trade *t, int k, int i, mt_arena *mem)
{
    const mt_vary *const v = &t->study->trade.vary[i];
    const mt_unit *const shown = unit_of_varied(t->study, v);
    return mt_arena_printf(mem, "%s = %.6g%s%s", v->text,
                           mt_unit_from_si(shown, t->points[k].values[i]),
                           shown == NULL ? "" : " ", mt_unit_name(shown, ""));
}

static const char *point_text(const trade *t, int k, mt_arena *mem)
{
    const char *const first = value_text(t, k, 0, mem);
    if (t->study->trade.n_vary == 1 || first == NULL) {
        return first;
    }
    const char *const second = value_text(t, k, 1, mem);
    return second == NULL ? NULL : mt_arena_printf(mem, "%s, %s", first, second);
}

/* Status of point k: MT_OK where it was interrupted, else the error with the point's name. */
static mt_status told(const trade *t, int k, mt_status rc, mt_err *err)
{
    if (rc == MT_OK || rc == MT_E_INTERRUPTED) {
        return MT_OK;
    }
    mt_arena mem;
    MT_TRY(mt_arena_init(&mem, 0, err));
    const char *const where = point_text(t, k, &mem);
    rc = mt_err_in(err, rc, "/trade: %s", where == NULL ? "?" : where);
    mt_arena_free(&mem);
    return rc;
}

/* The study of point k, compiled. */
static mt_status compile_trade_point(const trade *t, point *p, mt_err *err)
{
    static const mt_solve_options opt = {.size = sizeof opt};
    MT_TRY(mt_arena_init(&p->mem, 0, err));
    p->q = mt_arena_alloc(&p->mem, 1, sizeof *p->q);
    mt_study *const study = mt_arena_alloc(&p->mem, 1, sizeof *study);
    MT_TRY(mt_arena_check(&p->mem, err));
    MT_TRY(trade_study(t->study, p->values, &p->mem, study, err));
    return mt_question_init(p->q, study, t->run, &opt, err);
}

static void forget(point *p)
{
    if (p->q != NULL) {
        mt_question_free(p->q);
    }
    p->q = NULL;
    mt_arena_free(&p->mem);
}

/* Answer it, from hint[n_variables] too where that is not NULL. */
static mt_status answer(point *p, const double *hint, const mt_task_path *own, mt_result **out,
                        mt_err *err)
{
    const mt_solve_options opt = {.size = sizeof opt, .threads = 1, .hint = hint};
    return mt_question_answer(p->q, &opt, own, NULL, out, err);
}

/* Adds (sign 1) or subtracts (sign -1) the work of the point's question. */
static void note_work_counters(point *p, int sign)
{
    if (p->q != NULL) {
        const mt_work_counters *const s = &p->q->spent;
        p->evaluations += sign * (mt_work_counters_of(s, MT_WORK_DESIGNS) +
                                  mt_work_counters_of(s, MT_WORK_POSITIONS));
        p->multiplications += sign * mt_work_counters_of(s, MT_WORK_MULTIPLICATIONS);
        p->solutions += sign * mt_work_counters_of(s, MT_WORK_MODAL);
    }
}

/* The recommended values of a design, in mem; NULL without one. */
static mt_status values_of(const mt_recommendation *r, mt_arena *mem, const double **x,
                           mt_err *err)
{
    *x = NULL;
    if (r == NULL) {
        return MT_OK;
    }
    double *const values = mt_arena_f64(mem, (size_t)r->n_parameters, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < r->n_parameters; i++) {
        values[i] = r->parameters[i].recommended;
    }
    *x = values;
    return MT_OK;
}

/* Points of the tile that begins at point k: lines [row, row_end), places [at, end) in each. */
typedef struct tile {
    int row;
    int row_end;
    int at;
    int end;
} tile;

static tile tile_at(const trade *t, int k)
{
    const int n_lines = t->n / t->line;
    const tile of = {.row = k / t->line, .at = k % t->line};
    const int row_end = of.row + t->lines;
    const int end = of.at + t->stretch;
    return (tile){of.row, row_end < n_lines ? row_end : n_lines, of.at,
                  end < t->line ? end : t->line};
}

/* Tiles that share their lines. */
static int tiles_of_lines(const trade *t)
{
    return (t->line + t->stretch - 1) / t->stretch;
}

/* First point of task `task` of those from t->from on, which begins a line of tiles. */
static int tile_of(const trade *t, int task)
{
    const int each = tiles_of_lines(t);
    return t->from + (task / each * t->lines * t->line) + (task % each * t->stretch);
}

/* Point of which point k uses what is known: the one before it (axis 1) or in the line before
 * it (axis 0) in the same tile; -1: there is none. */
static int before_in_tile(const trade *t, int k, int axis)
{
    const bool inner =
        axis == 1 ? (k % t->line) % t->stretch > 0 : (k / t->line) % t->lines > 0;
    return !inner ? -1 : axis == 1 ? k - 1 : k - t->line;
}

/* Number that varies along an axis of a grid of lines: 1 along a line. */
static const mt_vary *varied(const trade *t, int axis)
{
    return &t->study->trade.vary[axis == 1 ? t->study->trade.n_vary - 1 : 0];
}

/* True where designs of point k are designs of the point before it along an axis: what varies
 * between them only takes designs away. */
static bool only_takes_away(const trade *t, int before, int k, int axis)
{
    const mt_vary *const v = varied(t, axis);
    const int i = axis == 1 ? t->study->trade.n_vary - 1 : 0;
    const double from = t->points[before].values[i];
    const double to = t->points[k].values[i];
    switch (v->kind) {
    case MT_VARY_BOUND:
        return v->upper ? to <= from : to >= from;
    case MT_VARY_GOAL:
        return v->slot == MT_SLOT_AT_LEAST  ? to >= from
               : v->slot == MT_SLOT_AT_MOST ? to <= from
                                            : false;
    case MT_VARY_PARAMETER:
        break;
    }
    return false;
}

/* Point k. near, hint[n_variables]: what is known of it from k - 1; NULL: nothing. moves: gets
 * its relaxations, in mem. */
static mt_status solve_point(const trade *t, int k, const mt_neighbour *near,
                             const double *hint, mt_moves *moves, mt_arena *mem,
                             mt_task_path *own, mt_err *err)
{
    point *const p = &t->points[k];
    mt_status rc = compile_trade_point(t, p, err);
    if (rc == MT_OK) {
        p->q->neighbour = near;
        p->q->moves = moves;
        p->q->moves_mem = mem;
        rc = answer(p, hint, own, &p->first, err);
        p->q->neighbour = NULL;
        p->q->moves = NULL;
    }
    note_work_counters(p, 1);
    if (rc != MT_OK || !t->warm || t->lines * t->stretch > 1) {
        forget(p);
    }
    return told(t, k, rc, err);
}

/* Point k of a tile, from what is known of those before it. moves: of each place of the line,
 * its last point's so far. */
static mt_status solve_in_tile(const trade *t, int k, mt_moves *moves, mt_arena *mem,
                               mt_task_path *own, mt_err *err)
{
    mt_moves known[MT_MAX_VARY] = {{0}};
    mt_moves_known chain[MT_MAX_VARY];
    const mt_result *from = NULL;
    mt_neighbour near = {0};
    for (int axis = 1; axis >= 0; axis--) {
        const int before = before_in_tile(t, k, axis);
        const mt_result *const last = before >= 0 ? t->points[before].first : NULL;
        const bool none = last != NULL && last->status == MT_RESULT_INFEASIBLE;
        if (best_recommendation(last) == NULL) {
            continue;
        }
        const bool looser = only_takes_away(t, before, k, axis);
        near.impossible = near.impossible || (none && looser);
        known[axis] = moves[before % t->line];
        chain[axis] = (mt_moves_known){&known[axis], varied(t, axis), looser, near.known};
        near.known = &chain[axis];
        from = from != NULL ? from : last;
    }
    near.alone = from != NULL && from->run.distinct_designs <= 1;
    const double *x = NULL;
    moves[k % t->line] = (mt_moves){0};
    MT_TRY(values_of(best_recommendation(from), mem, &x, err));
    return solve_point(t, k, x != NULL ? &near : NULL, x, &moves[k % t->line], mem, own, err);
}

static mt_status solve_cold(void *context, int worker, int task, mt_task_path *own, mt_err *err)
{
    const trade *const t = context;
    const tile of = tile_at(t, tile_of(t, task));
    mt_arena mem;
    (void)worker;
    MT_TRY(mt_arena_init(&mem, 0, err));
    mt_moves *const moves = mt_arena_alloc(&mem, (size_t)t->line, sizeof *moves);
    mt_status rc = mt_arena_check(&mem, err);
    for (int row = of.row; row < of.row_end; row++) {
        for (int at = of.at; at < of.end && rc == MT_OK && !stopped(t); at++) {
            rc = solve_in_tile(t, (row * t->line) + at, moves, &mem, own, err);
        }
    }
    mt_arena_free(&mem);
    return rc;
}

/* Neighbour `way` (0 to 3) of point k on the grid, -1 where there is none. */
static int neighbour(const trade *t, int k, int way)
{
    const int axis = way / 2;
    const int step = way % 2 == 0 ? -1 : 1;
    const int stride = axis == 0 ? t->size[1] : 1;
    const int at = axis == 0 ? k / t->size[1] : k % t->size[1];
    return at + step >= 0 && at + step < t->size[axis] ? k + (step * stride) : -1;
}

/* True where two designs differ by at most `part` of each value, and of the range between its
 * bounds where variables are given. */
static bool are_alike(int n, const mt_variable *of, const double *x, const double *y,
                      double part)
{
    bool alike = true;
    for (int i = 0; i < n && alike; i++) {
        const double size = fabs(y[i]);
        const double range = of != NULL ? of[i].upper - of[i].lower : size;
        alike = fabs(x[i] - y[i]) <= part * fmin(size, range);
    }
    return alike;
}

/* A search from a design as near to the point's own best as this ends there: valleys of
 * different optima lie farther apart. */
static const double LEADS_BACK = 0.01;

/* Best design of neighbour `way` of point k in the first pass; NULL where there is none, k was
 * searched from it, or it leads back to k's own. */
static const double *neighbour_design(const trade *t, int k, int way)
{
    const int other = neighbour(t, k, way);
    const int left = before_in_tile(t, k, 1);
    const int begun = left >= 0 ? left : before_in_tile(t, k, 0);
    const double *const x = other < 0 || other == begun ? NULL : t->points[other].near;
    const double *const own = t->points[k].near;
    const mt_study *const s = t->study;
    const bool back =
        x != NULL && own != NULL && are_alike(s->n_variables, s->variables, x, own, LEADS_BACK);
    return back ? NULL : x;
}

/* True where a is the better answer of one point, by more than searches differ. Among feasible
 * designs the first objective decides. */
static bool better(const mt_study *study, const mt_result *a, const mt_result *b)
{
    const mt_recommendation *const x = best_recommendation(a);
    const mt_recommendation *const y = best_recommendation(b);
    if (x == NULL || y == NULL) {
        return y == NULL && x != NULL;
    }
    if (x->feasible && y->feasible &&
        mt_describe_keeps_between(x) != mt_describe_keeps_between(y)) {
        return mt_describe_keeps_between(x);
    }
    const bool most =
        study->n_objectives > 0 && mt_objective_is(study->objectives[0].type, MT_MAXIMISED);
    const double f = most ? -x->score : x->score;
    const double g = most ? -y->score : y->score;
    return mt_merit_before(&(mt_merit){.feasible = x->feasible, .n = 1, .f = &f},
                           &(mt_merit){.feasible = y->feasible, .n = 1, .f = &g},
                           MT_EQUAL_FOUND);
}

/* True where a design equals an earlier one within rounding. */
static bool is_tried(const point *p, int n, const double *const tried[WAYS], const double *x)
{
    static const double ROUNDING = 1e-10;
    bool found = false;
    for (int k = 0; k < n && !found; k++) {
        found = tried[k] != NULL && are_alike(p->q->p->n, NULL, tried[k], x, ROUNDING);
    }
    return found;
}

/* From the neighbours' designs of the first pass, which are no longer changed: any order gives
 * the same. */
static mt_status try_neighbours(const trade *t, int k, mt_workspace *w, const mt_task_path *own,
                                mt_arena *mem, mt_err *err)
{
    point *const p = &t->points[k];
    const mt_recommendation *const best = best_recommendation(p->first);
    const double *best_x = NULL;
    const double *tried[WAYS] = {NULL};
    MT_TRY(values_of(best != NULL && best->feasible ? best : NULL, mem, &best_x, err));
    for (int way = 0; way < WAYS; way++) {
        const double *const x = neighbour_design(t, k, way);
        bool gain = false;
        const long left = mt_question_left(p->q) - LOOKS;
        if (x == NULL || stopped(t) || left < WARM_LEAST || is_tried(p, way, tried, x)) {
            continue;
        }
        tried[way] = x;
        mt_question_enter_search(p->q);
        MT_TRY(trade_improves(w, x, best_x, &gain, left, err));
        if (!gain || mt_question_left(p->q) < WARM_LEAST) {
            continue;
        }
        mt_result *fresh = NULL;
        MT_TRY(answer(p, x, own, &fresh, err));
        if (better(p->q->study, fresh, answer_of(p))) {
            mt_result_delete(p->again);
            p->again = fresh;
            MT_TRY(values_of(best_recommendation(fresh), mem, &best_x, err));
        } else {
            mt_result_delete(fresh);
        }
    }
    return MT_OK;
}

static mt_status solve_warm(void *context, int worker, int task, mt_task_path *own, mt_err *err)
{
    const trade *const t = context;
    const int k = t->from + task;
    point *const p = &t->points[k];
    mt_workspace *w = NULL;
    mt_arena mem;
    bool any = false;
    (void)worker;
    for (int way = 0; way < WAYS; way++) {
        any = any || neighbour_design(t, k, way) != NULL;
    }
    if (stopped(t) || p->first == NULL || !any) {
        forget(p);
        return MT_OK;
    }
    MT_TRY(mt_arena_init(&mem, 0, err));
    const bool known = p->q == NULL; /* its record was read */
    mt_status rc = known ? compile_trade_point(t, p, err) : MT_OK;
    if (known && rc == MT_OK) { /* a budget is of both passes */
        mt_work_counters_note(&p->q->spent, MT_WORK_DESIGNS, p->evaluations);
        mt_work_counters_note(&p->q->spent, MT_WORK_MULTIPLICATIONS, p->multiplications);
        mt_work_counters_note(&p->q->spent, MT_WORK_MODAL, p->solutions);
    }
    note_work_counters(p, -1); /* of the first pass: it is noted already */
    rc = rc == MT_OK ? mt_workspace_new(p->q->p, &w, err) : rc;
    rc = rc == MT_OK ? try_neighbours(t, k, w, own, &mem, err) : rc;
    mt_workspace_delete(w);
    mt_arena_free(&mem);
    note_work_counters(p, 1);
    forget(p);
    return told(t, k, rc, err);
}

/* Writes or reads the part of an answer that the front, the neighbours and the result use. */
static void serialize_answer(const trade *t, mt_result *r, mt_serializer *serializer)
{
    const int n = t->study->n_variables;
    int status = (int)r->status;
    mt_serializer_int(serializer, &status, 0, MT_RESULT_STATUS_COUNT - 1);
    mt_serializer_text(serializer, &r->status_text, &r->mem);
    r->status = (mt_result_status)status;
    int best = r->n_recommendations > 0 ? 1 : 0;
    mt_serializer_int(serializer, &best, 0, 1);
    if (serializer->reads && best > 0 && !serializer->failed) {
        r->recommendations = mt_arena_alloc(&r->mem, 1, sizeof *r->recommendations);
        serializer->failed = r->recommendations == NULL;
    }
    if (best > 0 && !serializer->failed) {
        mt_record_serialize(&mt_design_record, &r->recommendations[0], n, serializer, &r->mem);
        serializer->failed = serializer->failed || r->recommendations[0].n_parameters != n;
        r->n_recommendations = serializer->reads ? 1 : r->n_recommendations;
    }
}

/* Writes or reads an answer, which may be NULL. */
static void serialize_result(const trade *t, mt_result **r, mt_serializer *serializer)
{
    bool there = *r != NULL;
    mt_serializer_flag(serializer, &there);
    if (there && serializer->reads) {
        serializer->failed = serializer->failed || mt_result_new(r, NULL) != MT_OK;
    }
    if (*r != NULL && !serializer->failed) {
        serialize_answer(t, *r, serializer);
    }
}

/* Writes or reads one pass of a point: its answer, and the point's work so far. */
static void serialize_point(const trade *t, int k, bool warm, mt_serializer *serializer)
{
    point *const p = &t->points[k];
    mt_result **const r = warm ? &p->again : &p->first;
    mt_serializer_long(serializer, &p->evaluations, 0, LONG_MAX);
    mt_serializer_long(serializer, &p->multiplications, 0, LONG_MAX);
    mt_serializer_long(serializer, &p->solutions, 0, LONG_MAX);
    serialize_result(t, r, serializer);
    serializer->failed = serializer->failed || (!warm && *r == NULL);
}

static void serialize_cold(void *context, int task, mt_serializer *serializer)
{
    const trade *const t = context;
    const tile of = tile_at(t, tile_of(t, task));
    const int width = of.end - of.at;
    const int n = (of.row_end - of.row) * width;
    for (int i = 0; i < n && !serializer->failed; i++) {
        const int k = ((of.row + (i / width)) * t->line) + of.at + (i % width);
        serialize_point(t, k, false, serializer);
    }
    for (int i = 0; i < n && serializer->reads && !mt_serializer_is_read(serializer); i++) {
        const int k = ((of.row + (i / width)) * t->line) + of.at + (i % width);
        point *const p = &t->points[k];
        mt_result_delete(p->first);
        *p = (point){.values = {p->values[0], p->values[1]}};
    }
}

static void serialize_warm(void *context, int task, mt_serializer *serializer)
{
    const trade *const t = context;
    point *const p = &t->points[t->from + task];
    const long before[] = {p->evaluations, p->multiplications, p->solutions};
    serialize_point(t, t->from + task, true, serializer);
    if (serializer->reads && !mt_serializer_is_read(serializer)) {
        mt_result_delete(p->again);
        p->again = NULL;
        p->evaluations = before[0];
        p->multiplications = before[1];
        p->solutions = before[2];
    } else if (serializer->reads) {
        forget(p);
    }
}

/* The unit of what varies; NULL: it has none. */
static const char *unit_of(const mt_study *study, const mt_vary *v)
{
    if (v->kind == MT_VARY_PARAMETER) {
        return study->model->parameters[v->parameter].unit;
    }
    if (v->kind == MT_VARY_BOUND) {
        return study->model->parameters[study->variables[v->variable].parameter].unit;
    }
    const char *const unit = mt_study_goal_unit(study, &study->goals[v->goal]);
    return v->slot == MT_SLOT_MARGIN ? "%" : unit[0] != '\0' ? unit : NULL;
}

static mt_status describe_what(const trade *t, mt_arena *mem, mt_trade_result *out, mt_err *err)
{
    const mt_trade *const asked = &t->study->trade;
    out->n_vary = asked->n_vary;
    out->vary = mt_arena_alloc(mem, (size_t)asked->n_vary, sizeof *out->vary);
    out->n_objectives = asked->n_objectives;
    out->objectives = mt_arena_alloc(mem, (size_t)asked->n_objectives + 1, sizeof(char *));
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < asked->n_vary; i++) {
        const char *const unit = unit_of(t->study, &asked->vary[i]);
        const mt_unit *const shown = unit_of_varied(t->study, &asked->vary[i]);
        out->vary[i] = (mt_trade_vary){.text = mt_arena_strdup(mem, asked->vary[i].text),
                                       .pointer = mt_arena_printf(mem, "/trade/vary/%d", i),
                                       .unit = unit == NULL ? NULL : mt_arena_strdup(mem, unit),
                                       .display_unit = mt_unit_name(shown, NULL),
                                       .display_factor = mt_unit_display(shown)};
    }
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < asked->n_objectives; i++) {
        out->objectives[i] = mt_objective_kind_of(asked->objectives[i])->name;
    }
    return MT_OK;
}

/* True where points may begin from others. A budget is of each point: what it spends follows
 * from nothing but its own question. With bands a point is a search of each mode placement,
 * which another's design hardly helps. */
static bool may_begin_from_others(const trade *t)
{
    const mt_search *const search = &t->study->search;
    return t->warm && !mt_study_has_bands(t->study) && search->starts <= 0 &&
           search->max_evaluations <= 0 && search->max_modal_solutions <= 0;
}

static int limited(int n, int most)
{
    return n < 1 ? 1 : n < most ? n : most;
}

static mt_status allocate_trade_points(trade *t, mt_err *err)
{
    const mt_trade *const asked = &t->study->trade;
    t->n = 1;
    for (int i = 0; i < MT_MAX_VARY; i++) {
        t->size[i] = i < asked->n_vary ? asked->vary[i].n_values : 1;
        t->n *= t->size[i];
    }
    const int share = may_begin_from_others(t) ? t->n / TILES_LEAST : 1;
    t->line = t->size[asked->n_vary - 1];
    t->lines = asked->n_vary > 1 ? limited((int)sqrt((double)share), LINES_MOST) : 1;
    t->stretch = limited(share / t->lines, STRETCH_MOST);
    t->points = mt_arena_alloc(t->mem, (size_t)t->n, sizeof *t->points);
    t->best = mt_arena_alloc(t->mem, (size_t)t->n, sizeof(const mt_recommendation *));
    t->out = mt_arena_alloc(t->kept, 1, sizeof *t->out);
    MT_TRY(mt_arena_check(t->mem, err));
    MT_TRY(mt_arena_check(t->kept, err));
    *t->out = (mt_trade_result){.n_points = t->n};
    t->out->points = mt_arena_alloc(t->kept, (size_t)t->n, sizeof *t->out->points);
    MT_TRY(mt_arena_check(t->kept, err));
    for (int k = 0; k < t->n; k++) {
        const int at[MT_MAX_VARY] = {k / t->size[1], k % t->size[1]};
        t->points[k] = (point){.first = NULL};
        for (int i = 0; i < asked->n_vary && i < MT_MAX_VARY; i++) {
            t->points[k].values[i] = asked->vary[i].values[at[i]];
        }
    }
    return describe_what(t, t->kept, t->out, err);
}

/* Stores the best designs of points [from, to) as starts for their neighbours. */
static mt_status note_near(trade *t, int from, int to, mt_err *err)
{
    for (int k = from; k < to; k++) {
        const mt_recommendation *const r = best_recommendation(t->points[k].first);
        if (r != NULL && r->feasible) {
            MT_TRY(values_of(r, t->mem, &t->points[k].near, err));
        }
    }
    return MT_OK;
}

/* Takes the final answer of the next point into the result, with warnings about the point
 * before. */
static mt_status report_point(trade *t, const char *unanswered, mt_err *err)
{
    const int k = t->told;
    point *const p = &t->points[k];
    const mt_result *const r = answer_of(p);
    const mt_trade_point *const before = k > 0 ? &t->out->points[k - 1] : NULL;
    mt_trade_point *const told = &t->out->points[k];
    const char *const status =
        r != NULL && r->status_text != NULL ? r->status_text : unanswered;
    const bool same = before != NULL && strcmp(before->status_text, status) == 0;
    *told = (mt_trade_point){.n_values = t->study->trade.n_vary,
                             .values = mt_arena_f64(t->kept, MT_MAX_VARY, 1),
                             .status = r != NULL ? r->status : MT_RESULT_INTERRUPTED,
                             .status_text =
                                 same ? before->status_text : mt_arena_strdup(t->kept, status),
                             .best = mt_recommendation_default()};
    MT_TRY(mt_arena_check(t->kept, err));
    memcpy(told->values, p->values, sizeof p->values);
    if (best_recommendation(r) != NULL) {
        t->best[k] = &told->best;
        MT_TRY(mt_recommendation_copy(best_recommendation(r),
                                      before != NULL ? &before->best : NULL, t->kept,
                                      &told->best, err));
    }
    mt_result_delete(p->first);
    mt_result_delete(p->again);
    p->first = NULL;
    p->again = NULL;
    t->told++;
    return MT_OK;
}

static mt_status report_points(trade *t, int to, mt_err *err)
{
    const char *const unanswered =
        mt_interrupt_reason(t->run->interrupt) == MT_STOP_REASON_TIME_LIMIT
            ? "Not answered: the time limit came first."
            : "Interrupted before it was answered.";
    while (t->told < to && t->out->points != NULL) {
        MT_TRY(report_point(t, unanswered, err));
    }
    return MT_OK;
}

static mt_status report_trade(trade *t, mt_result *result, mt_err *err)
{
    MT_TRY(report_points(t, t->n, err));
    for (int k = 0; k < t->n; k++) {
        const point *const p = &t->points[k];
        result->run.spent.trade += p->evaluations;
        result->run.spent.multiplications += p->multiplications;
        result->run.modal_solutions += p->solutions;
    }
    result->trade = t->out;
    return trade_front(t->study, t->best, &result->baseline, t->kept, t->out, err);
}

/* Answers all points, then again each whose neighbours are known, except for other parts of the
 * work. */
static mt_status solve_all(trade *t, int threads, const mt_task_path *task_path, mt_err *err)
{
    mt_task_path first = mt_task_path_enter(task_path, "first");
    mt_task_path again = mt_task_path_enter(task_path, "again");
    mt_status part = MT_OK;
    int ready = 0;
    const bool tiles = t->lines * t->stretch > 1;
    const int each = tiles ? tiles_of_lines(t) : 1;
    const int size = tiles ? t->lines * t->line : 1; /* points of them */
    const int most = tiles ? (TILES + each - 1) / each : BLOCK;
    for (int known = 0; known < t->n;) {
        const int left = (t->n - known + size - 1) / size;
        const bool rest = left <= most;
        const int runs = rest ? left : most;
        const int to = rest ? t->n : known + (runs * size);
        t->from = known;
        const mt_tasks cold = {runs * each, solve_cold, serialize_cold, t,
                               tiles ? "stretches of points" : "points"};
        const mt_status rc = mt_workers_run(threads, &first, &cold, err);
        MT_TRY(rc == MT_E_INTERRUPTED ? MT_OK : rc);
        part = rc == MT_OK ? part : rc;
        MT_TRY(note_near(t, known, to, err));
        known = to;
        t->from = ready;
        ready = known == t->n ? known : known - t->size[1];
        if (t->warm && part == MT_OK && ready > t->from) {
            const mt_tasks warm = {ready - t->from, solve_warm, serialize_warm, t,
                                   "points again"};
            MT_TRY(mt_workers_run(threads, &again, &warm, err));
        }
        ready = ready > t->from ? ready : t->from;
        if (part == MT_OK) {
            MT_TRY(report_points(t, ready, err));
        }
    }
    return part;
}

mt_status mt_trade_solve(const mt_study *study, const mt_run *run, int threads,
                         const mt_task_path *task_path, mt_result *result, mt_err *err)
{
    trade t = {.study = study,
               .run = run,
               .warm = study->n_objectives > 0 && !mt_study_has_catalogues(study)};
    mt_arena mem;
    if (study->trade.n_vary == 0) {
        return MT_OK;
    }
    MT_TRY(mt_arena_init(&mem, 0, err));
    t.mem = &mem;
    t.kept = &result->mem;
    mt_status rc = allocate_trade_points(&t, err);
    rc = rc == MT_OK ? solve_all(&t, threads, task_path, err) : rc;
    rc = rc == MT_OK ? report_trade(&t, result, err) : rc;
    for (int k = 0; k < t.n && t.points != NULL; k++) {
        forget(&t.points[k]);
        mt_result_delete(t.points[k].first);
        mt_result_delete(t.points[k].again);
    }
    mt_arena_free(&mem);
    return rc;
}
