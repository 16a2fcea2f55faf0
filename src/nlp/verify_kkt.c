/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What the ends of the local solves are worth:
 *
 *     feasible ones only, if any; undetermined directions at the best, all ends pulled back
 *         along them; equal ones merged; ranked;
 *     multipliers, KKT residual, singularity. Compromises are settled: the least objective
 *         among equally good ones.
 */
#include "nlp/verify_kkt.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nlp/merit.h"
#include "nlp/near_null_directions.h"
#include "nlp/polish.h"
#include "nlp/report.h"
#include "nlp/unidentifiable_directions.h"

/* Ends nearer than this are one and the same to rounding; merged ones farther apart were two
 * roots. */
static const double IDENTICAL = 1e-5;
/* A feasible end with a KKT residual above this is no local solution, if there are better
 * ones. */
static const double STATIONARY = 1e-6;
static const double NOT_STATIONARY = 1e-3;
/* Compromises whose squares differ by less, relatively, are equally good (their minima are
 * known to rounding, about 1e-12); a smaller objective decides where it is smaller by more than
 * rounding. */
static const double EQUAL_SQUARES = 1e-8;
static const double SETTLED_GAIN = 1e-6;
/* A variable nearer to a mark than this, in widths of its bounds, stands there but for rounding
 * of the search. */
static const double ON_MARK = 1e-12;
/* A compromise knows a variable that no requirement feels to the root of rounding only, as its
 * change counts by its square: nearer to the original than this it is tried there, and stays
 * where the squares are the same to IDLE of their size. */
static const double NEARLY_ON_MARK = 1e-3;
static const double IDLE = 1e-12;
/* Ends of a search that was ended. */
enum { ENDED_MOST = 1000 };
/* Violation, in tolerances, that counts as none, and as no more than it was. */
static const double STILL_MET = 1e-4;

static void swap(mt_nlp_solution_pool *all, int i, int k)
{
    const mt_nlp_local one = all->at[i];
    all->at[i] = all->at[k];
    all->at[k] = one;
}

/*
 * Number of roots that no start found, from f1 found by one start and f2 found by two (Chao
 * 1984, in the form that does not divide by zero): f1 (f1 - 1) / (2 (f2 + 1)), a lower bound of
 * the expectation.
 */
static void count_roots(const mt_nlp_engine *e, const mt_nlp_solution_pool *all,
                        mt_nlp_result *out)
{
    int f2 = 0;
    bool isolated = mt_nlp_seeks_roots(e) && all->count > 0 && !out->compromise;
    for (int i = 0; i < all->count; i++) {
        out->n_once += all->at[i].hits == 1;
        f2 += all->at[i].hits == 2;
        isolated = isolated && !all->at[i].curve;
    }
    out->n_found = all->count;
    out->missing = isolated ? 0.5 * out->n_once * (out->n_once - 1) / (f2 + 1.0) : nan("");
}

typedef struct ranked {
    mt_nlp_local end;
    int at; /* its place before */
} ranked;

static int compare_ranked(const void *a, const void *b)
{
    const ranked *const x = a;
    const ranked *const y = b;
    return mt_nlp_better(x->end.p, y->end.p)   ? -1
           : mt_nlp_better(y->end.p, x->end.p) ? 1
                                               : (x->at > y->at) - (x->at < y->at);
}

/* Sorts, best first; ties keep the order of the starts. Of a search that was ended, where
 * thousands of starts may only have values, the best are kept. */
static void rank_points(mt_nlp_engine *e, mt_nlp_solution_pool *all)
{
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    ranked *const list = mt_arena_alloc(&e->scratch, (size_t)all->count, sizeof *list);
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return;
    }
    for (int i = 0; i < all->count; i++) {
        list[i] = (ranked){all->at[i], i};
    }
    if (all->count > 1) {
        qsort(list, (size_t)all->count, sizeof *list, compare_ranked);
    }
    all->count = e->ended && all->count > ENDED_MOST ? ENDED_MOST : all->count;
    for (int i = 0; i < all->count; i++) {
        all->at[i] = list[i].end;
    }
    mt_arena_rewind(&e->scratch, mark);
}

/* Ranked compromises: among equally good ones the objective decides. */
static void rank_equals(mt_nlp_solution_pool *all)
{
    for (int first = 0; first < all->count;) {
        const double most = all->at[first].p->squares * (1 + EQUAL_SQUARES);
        int i = first + 1;
        for (; i < all->count && all->at[i].p->squares <= most; i++) {
            for (int k = i; k > first && all->at[k].p->f < all->at[k - 1].p->f; k--) {
                swap(all, k, k - 1);
            }
        }
        first = i;
    }
}

/* True where a and b are equally good to the accuracy of a search. */
static bool is_equal(const mt_nlp_point *a, const mt_nlp_point *b)
{
    const bool feasible = mt_nlp_feasible(a);
    return feasible == mt_nlp_feasible(b) && mt_compare(a->f, b->f, MT_EQUAL_FOUND) == 0 &&
           (feasible || fabs(a->squares - b->squares) <= EQUAL_SQUARES * b->squares);
}

/* Ranked and merged: orders ties of the first by a rule that rounding does not affect. */
static void order_equals(const mt_nlp_engine *e, mt_nlp_solution_pool *all)
{
    for (int first = 0, end = 0; first < all->count; first = end) {
        const mt_nlp_point *const best = all->at[first].p;
        for (end = first + 1; end < all->count && is_equal(all->at[end].p, best); end++) {
            for (int k = end; k > first && mt_is_nearer(e->n, e->origin, e->nlp->change_weight,
                                                        all->at[k].p->t, all->at[k - 1].p->t);
                 k--) {
                swap(all, k, k - 1);
            }
        }
    }
}

/* Drop infeasible ends where one is feasible, and those that are no local minima. Ranked. */
static void drop_useless(mt_nlp_solution_pool *all)
{
    const bool any = all->count > 0 && mt_nlp_feasible(all->at[0].p);
    bool stationary = false;
    for (int i = 0; i < all->count; i++) {
        const bool counts = any == mt_nlp_feasible(all->at[i].p);
        stationary = stationary || (counts && all->at[i].p->kkt <= STATIONARY);
    }
    int kept = 0;
    for (int i = 0; i < all->count; i++) {
        mt_nlp_point *const p = all->at[i].p;
        const bool useless =
            any && (!mt_nlp_feasible(p) || (i > 0 && stationary && p->kkt > NOT_STATIONARY &&
                                            p->kkt < HUGE_VAL)); /* roots have no residual */
        if (!useless) {
            swap(all, kept++, i);
        }
    }
    all->count = kept;
}

/* Merge equal ends into the better one. Ranked. */
static void merge_equal_ends(const mt_nlp_engine *e, mt_nlp_solution_pool *all)
{
    const double same = mt_nlp_same_distance(e);
    int kept = 0;
    for (int i = 0; i < all->count; i++) {
        int twin = -1;
        for (int k = 0; k < kept && twin < 0; k++) {
            twin = mt_nlp_distance(e, all->at[k].p, all->at[i].p) <= same ? k : -1;
        }
        if (twin < 0) {
            swap(all, kept++, i);
            continue;
        }
        mt_nlp_local *const one = &all->at[twin];
        const mt_nlp_local *const end = &all->at[i];
        one->merged = one->merged || mt_nlp_distance(e, one->p, end->p) > IDENTICAL;
        one->hits += end->hits;
        one->start = end->start < one->start ? end->start : one->start;
    }
    all->count = kept;
}

/*
 * Many designs may be equally far from the requirements (except where squares increase on all
 * sides): the one of least objective is wanted. With the constraints shifted to the values at
 * the compromise, that is a feasible problem.
 */
static void lower_objective_at_compromise(mt_nlp_engine *e, mt_nlp_point *p)
{
    const mt_nlp *const q = e->nlp;
    mt_arena *const mem = &e->scratch;
    mt_nlp_local s = mt_nlp_local_new(e, mem);
    double *const eq = mt_arena_f64(mem, (size_t)q->n_eq, 1);
    double *const in = mt_arena_f64(mem, (size_t)q->n_in, 1);
    if (!mt_nlp_has_room(e, mem)) {
        return;
    }
    mt_nlp_point *const to = s.p;
    memcpy(eq, p->eq, (size_t)q->n_eq * sizeof *eq);
    for (int i = 0; i < q->n_in; i++) {
        in[i] = fmin(p->in[i], 0);
    }
    e->eq_shift = eq;
    e->in_shift = in;
    mt_nlp_near_null_directions w;
    const bool minimised = mt_nlp_evaluate(e, p->t, true, to) &&
                           mt_nlp_near_null_directions_at(e, to, mem, &w) && w.curve &&
                           w.n_rows < e->n_free;
    if (minimised) {
        s.n_rows = w.n_rows;
        s.rows = w.rows;
        mt_nlp_minimise(e, &s);
    }
    e->eq_shift = NULL;
    e->in_shift = NULL;
    if (!minimised || !mt_nlp_evaluate(e, to->t, true, to)) {
        return;
    }
    if (!(to->f < p->f - SETTLED_GAIN * fabs(p->f))) {
        return;
    }
    mt_nlp_polish(e, MT_NLP_SQUARES, to, NULL); /* back from within the tolerances */
    if (to->squares <= p->squares * (1 + EQUAL_SQUARES)) {
        mt_nlp_point_copy(e, p, to);
    }
}

/* Variables within rounding of a mark (the original, a bound) are put on it: "0", not
 * "1.1e-08". */
static void put_on_marks(mt_nlp_engine *e, mt_nlp_point *p)
{
    const mt_nlp *const q = e->nlp;
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    mt_nlp_point *const to = mt_nlp_point_new(e, &e->scratch);
    bool moved = false;
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return;
    }
    mt_nlp_point_copy(e, to, p);
    for (int j = 0; j < e->n; j++) {
        const double marks[] = {e->origin[j], q->lower[j], q->upper[j]};
        for (int k = 0; k < MT_COUNT(marks); k++) {
            const double off = fabs(to->t[j] - marks[k]);
            if (off > 0.0 && off <= ON_MARK * (q->upper[j] - q->lower[j])) {
                to->t[j] = marks[k];
                moved = true;
            }
        }
    }
    if (moved && mt_nlp_evaluate(e, to->t, true, to) &&
        to->violation <= p->violation + STILL_MET &&
        (mt_nlp_feasible(to) || !mt_nlp_feasible(p))) {
        to->kkt = p->kkt;
        to->n_loose = p->n_loose;
        mt_nlp_point_copy(e, p, to);
    }
    mt_arena_rewind(&e->scratch, mark);
}

/* Variables of a compromise that no requirement feels have their original value exactly. */
static void put_idle_back(mt_nlp_engine *e, mt_nlp_point *p)
{
    const mt_nlp *const q = e->nlp;
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    mt_nlp_point *const to = mt_nlp_point_new(e, &e->scratch);
    double *const t = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
    for (int j = 0; j < e->n && mt_nlp_has_room(e, &e->scratch) && !e->ended; j++) {
        const double off = fabs(p->t[j] - e->origin[j]);
        if (off == 0.0 || off > NEARLY_ON_MARK * (q->upper[j] - q->lower[j])) {
            continue;
        }
        memcpy(t, p->t, (size_t)e->n * sizeof *t);
        t[j] = e->origin[j];
        if (mt_nlp_evaluate(e, t, true, to) && !mt_nlp_feasible(to) && to->f <= p->f &&
            to->squares <= p->squares * (1 + IDLE) &&
            to->violation <= p->violation * (1 + IDLE)) {
            to->kkt = p->kkt;
            to->n_loose = p->n_loose;
            mt_nlp_point_copy(e, p, to);
        }
    }
    mt_arena_rewind(&e->scratch, mark);
}

/* True for a double root; between two merged roots the Jacobian changes its sign. */
static bool is_singular(mt_nlp_engine *e, const mt_nlp_point *p, bool merged)
{
    const bool roots = e->nlp->n_eq >= e->n_free && e->n_free > 0;
    if (!mt_nlp_feasible(p) || e->ended || (merged && roots)) {
        return mt_nlp_feasible(p) && merged && roots;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    mt_nlp_near_null_directions w = {0};
    (void)mt_nlp_near_null_directions_at(e, p, &e->scratch, &w);
    mt_arena_rewind(&e->scratch, mark);
    return w.singular;
}

/* Undetermined directions of one variable, which stands at the origin for them. */
static int single_directions(const mt_nlp_engine *e, const mt_nlp_result *out)
{
    int n = 0;
    for (int k = 0; k < out->n_unidentifiable; k++) {
        const double *const d = out->unidentifiable + ((ptrdiff_t)k * e->n);
        n += mt_max_abs(e->n, d) == 1.0;
    }
    return n;
}

void mt_nlp_verify_kkt(mt_nlp_engine *e, mt_nlp_solution_pool *all, mt_arena *mem,
                       mt_nlp_result *out)
{
    rank_points(e, all);
    drop_useless(all);
    out->compromise = all->count > 0 && !mt_nlp_feasible(all->at[0].p);
    const bool unused = out->compromise && e->opt.no_compromise;
    if (all->count > 0 && !unused && all->at[0].p != all->directed &&
        !mt_nlp_unidentifiable(e, all->at[0].p, mem, out)) {
        return;
    }
    for (int i = 0; i < all->count && out->n_unidentifiable > 0; i++) {
        mt_nlp_pull_back(e, out, all->at[i].p);
    }
    rank_points(e, all);
    merge_equal_ends(e, all);
    if (out->compromise && !unused && e->n_free > 0) {
        const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
        for (int i = 0; i < all->count && !e->ended; i++) {
            if (!all->at[i].p->isolated) {
                lower_objective_at_compromise(e, all->at[i].p);
            }
            mt_arena_rewind(&e->scratch, mark);
        }
        rank_points(e, all);
        merge_equal_ends(e, all);
        rank_equals(all);
    }
    if (!e->ended) {
        order_equals(e, all);
    }
    if (all->count > 0) {
        mt_nlp_drop_roomless(e, all->at[0].p, out);
    }
    for (int i = 0; i < all->count && !e->ended; i++) {
        put_on_marks(e, all->at[i].p);
        if (out->compromise && !unused) {
            put_idle_back(e, all->at[i].p);
        }
    }
    count_roots(e, all, out);
    const int count = all->count < e->opt.max_solutions ? all->count : e->opt.max_solutions;
    out->solutions = mt_arena_alloc(mem, (size_t)count, sizeof *out->solutions);
    if (!mt_nlp_has_room(e, mem)) {
        return;
    }
    for (int i = 0; i < count && mt_nlp_report(e, all->at[i].p, out, mem, &out->solutions[i]);
         i++) {
        out->solutions[i].singular = is_singular(e, all->at[i].p, all->at[i].merged);
        out->solutions[i].n_loose = all->at[i].p->n_loose;
        out->solutions[i].flat = all->at[i].p->n_loose > single_directions(e, out);
        out->solutions[i].start = all->at[i].start;
        out->solutions[i].hits = all->at[i].hits;
        out->n_solutions = i + 1;
    }
}
