/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The front of a trade study, and the objectives that it compares. */
#include <math.h>
#include <string.h>

#include "answer/trade.h"
#include "base/format.h"
#include "nlp/merit.h"

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

mt_status mt_trade_front(const mt_study *study, const mt_recommendation *const *best,
                         const mt_recommendation *baseline, mt_arena *mem, mt_trade_result *out,
                         mt_err *err)
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
