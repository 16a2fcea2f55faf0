/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "answer/trade.h"

#include "answer/solve_priv.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "base/workers.h"
#include "describe/describe.h"
#include "nlp/merit.h"
#include "search/catalogue_search.h"

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

/* Points that are compiled at a time, beside a row of the grid: each has about a quarter of a
 * megabyte, or what its model needs. */
enum { BLOCK = 64 };
/* Evaluations beside one local search that asks whether a neighbour knows better; and without
 * which a point is not searched again. */
enum { LOOKS = 3, WARM_LEAST = 30 };
enum { WAYS = 4 }; /* neighbours of a point */

typedef struct trade {
    const mt_study *study;
    const mt_run *run; /* of all points */
    int n;
    int size[MT_MAX_VARY]; /* values of each quantity; 1 where there is none */
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
    MT_TRY(mt_trade_study(t->study, p->values, &p->mem, study, err));
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

static mt_status solve_cold(void *context, int worker, int task, mt_task_path *own, mt_err *err)
{
    const trade *const t = context;
    const int k = t->from + task;
    point *const p = &t->points[k];
    (void)worker;
    if (stopped(t)) {
        return MT_OK;
    }
    mt_status rc = compile_trade_point(t, p, err);
    rc = rc == MT_OK ? answer(p, NULL, own, &p->first, err) : rc;
    note_work_counters(p, 1);
    if (rc != MT_OK || !t->warm) {
        forget(p);
    }
    return told(t, k, rc, err);
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
        found = tried[k] != NULL;
        for (int i = 0; i < p->q->p->n && found; i++) {
            found = fabs(tried[k][i] - x[i]) <= ROUNDING * fabs(x[i]);
        }
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
        const int other = neighbour(t, k, way);
        const double *const x = other < 0 ? NULL : t->points[other].near;
        bool gain = false;
        const long left = mt_question_left(p->q) - LOOKS;
        if (x == NULL || stopped(t) || left < WARM_LEAST || is_tried(p, way, tried, x)) {
            continue;
        }
        tried[way] = x;
        mt_interrupt_enter(&p->q->interrupt, MT_PHASE_SEARCH, false);
        p->q->spent.phase = MT_PHASE_SEARCH;
        MT_TRY(mt_trade_improves(w, x, best_x, &gain, left, err));
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
    (void)worker;
    if (stopped(t) || p->first == NULL) {
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
static void serialize_point(const trade *t, int task, bool warm, mt_serializer *serializer)
{
    point *const p = &t->points[t->from + task];
    mt_result **const r = warm ? &p->again : &p->first;
    const long before[] = {p->evaluations, p->multiplications, p->solutions};
    mt_serializer_long(serializer, &p->evaluations, 0, LONG_MAX);
    mt_serializer_long(serializer, &p->multiplications, 0, LONG_MAX);
    mt_serializer_long(serializer, &p->solutions, 0, LONG_MAX);
    serialize_result(t, r, serializer);
    serializer->failed = serializer->failed || (!warm && *r == NULL);
    if (serializer->reads && !mt_serializer_is_read(serializer)) {
        mt_result_delete(*r);
        *r = NULL;
        p->evaluations = before[0];
        p->multiplications = before[1];
        p->solutions = before[2];
    } else if (serializer->reads && warm) {
        forget(p);
    }
}

static void serialize_cold(void *context, int task, mt_serializer *serializer)
{
    serialize_point(context, task, false, serializer);
}

static void serialize_warm(void *context, int task, mt_serializer *serializer)
{
    serialize_point(context, task, true, serializer);
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

static mt_status allocate_trade_points(trade *t, mt_err *err)
{
    const mt_trade *const asked = &t->study->trade;
    t->n = 1;
    for (int i = 0; i < MT_MAX_VARY; i++) {
        t->size[i] = i < asked->n_vary ? asked->vary[i].n_values : 1;
        t->n *= t->size[i];
    }
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
    return mt_trade_front(t->study, t->best, &result->baseline, t->kept, t->out, err);
}

/* Answers all points, then again each whose neighbours are known, except for other parts of the
 * work. */
static mt_status solve_all(trade *t, int threads, const mt_task_path *task_path, mt_err *err)
{
    mt_task_path first = mt_task_path_enter(task_path, "first");
    mt_task_path again = mt_task_path_enter(task_path, "again");
    mt_status part = MT_OK;
    int ready = 0;
    for (int known = 0; known < t->n;) {
        const int to = t->n - known > BLOCK ? known + BLOCK : t->n;
        t->from = known;
        const mt_tasks cold = {to - known, solve_cold, serialize_cold, t, "points"};
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
