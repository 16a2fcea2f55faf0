/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Branch and bound over catalogues that have continuous variables beside them. A box holds
 * values of each catalogue from one to another and all values of the other variables. It is
 * done with where
 *     no design of it has an objective below that of the best one found: least(box) >= cap, or
 *     none has one and meets the goals: a short certificate (prove/certify.h) over the box, in
 *     which catalogues are open between their ends and thinned out as they are halved.
 * What is not done with is halved, until a box is one combination, which is searched like any
 * other. Boxes of the least bound come first. A design that a certificate meets on its way, and
 * that is better, has its combination searched from there at once: the cap falls.
 *
 * Over values of a catalogue that shapes the geometry no modes are enclosed: those are halved
 * first, unseen, until each box has one geometry (catalogue_search_proofs.h).
 *
 * So each combination is excluded, by proof, or searched, by samples in its continuous
 * variables. Boxes are looked at in rounds of a fixed number, with one cap for all of a round:
 * nothing depends on the workers.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/run.h"
#include "base/workers.h"
#include "problem/objective.h"
#include "search/catalogue_search.h"
#include "search/catalogue_search_proofs.h"

enum {
    ROUND = 32, /* boxes */
    SEARCHED_MOST =
        1000,            /* combinations; MT_CATALOGUE_SEARCH_MOST_MIXED without certificates */
    LOOKED_MOST = 20000, /* boxes */
    LEAST_BUDGET = 20    /* evaluations of each combination, where there is a budget */
};
/* What the certificate of a box may cost, in boxes of its own (with some factorisations each);
 * that of a single combination saves a search, and may cost more. */
static const double LOOK = 50.0;
static const double LOOK_SINGLE = 4000.0;
/* First objectives that differ by less are equal where others decide between them, as in
 * catalogue_search_prove.c. */
static const double EQUAL = 1e-9;

typedef struct box {
    int *first; /* [n_listed] index in each catalogue */
    int *last;
    double combinations;
    double least; /* no objective in it is less */
    int number;   /* in the order that they are made in */
} box;

typedef struct branching {
    mt_catalogue_search *d;
    bool enclosed; /* certificates can be had, and have not spent their budget */
    mt_catalogue_search_proofs *proofs; /* [n_workers] */
    mt_proof_cap *caps;                 /* [n_workers] */
    double cap;                         /* of the round */
    double *lower;                      /* [n_workers x n] a worker's box */
    double *upper;
    box *open;
    int n_open;
    int capacity;
    int made;
    double work;    /* of all looks, as certificates count it */
    box now[ROUND]; /* of the round */
    mt_catalogue_search_look looks[ROUND];
    int n_now;
    mt_combination *fresh; /* [2 ROUND] to be searched */
    int n_fresh;
    mt_combination **all;
    int n;
    int n_capacity;
} branching;

/* Values of a box, the others within their bounds. */
static void bound(const mt_catalogue_search *d, const box *b, double *lower, double *upper)
{
    for (int i = 0; i < d->p->n; i++) {
        lower[i] = d->c->lower[i];
        upper[i] = d->c->upper[i];
    }
    for (int k = 0; k < d->n_listed; k++) {
        const int i = d->variable[k];
        lower[i] = d->p->study->variables[i].catalogue[b->first[k]];
        upper[i] = d->p->study->variables[i].catalogue[b->last[k]];
    }
}

static mt_status certify(const branching *v, int worker, const box *b,
                         mt_catalogue_search_look *out, mt_arena *mem, mt_err *err)
{
    const ptrdiff_t at = (ptrdiff_t)worker * v->d->p->n;
    const mt_certify_cap *const cap = v->cap < HUGE_VAL ? &v->caps[worker].cap : NULL;
    bound(v->d, b, v->lower + at, v->upper + at);
    return mt_catalogue_search_look_at(&v->proofs[worker], v->lower + at, v->upper + at, cap,
                                       b->combinations > 1.0 ? LOOK : LOOK_SINGLE, mem, out,
                                       err);
}

static mt_status examine_box(void *context, int worker, int task, mt_task_path *own,
                             mt_err *err)
{
    (void)own;
    branching *const v = context;
    mt_arena mem = {0};
    mt_status rc = mt_arena_init(&mem, 0, err);
    if (rc == MT_OK) {
        rc = certify(v, worker, &v->now[task], &v->looks[task], &mem, err);
    }
    mt_arena_free(&mem);
    return rc;
}

static void serialize_look(void *context, int task, mt_serializer *serializer)
{
    branching *const v = context;
    mt_catalogue_search_look_serialize(v->d->c, &v->looks[task], serializer);
}

/* Tests whether a proof is possible for the geometry of an evaluated combination; it is then
 * possible for others too. */
static mt_status probe(branching *v, mt_err *err)
{
    const mt_catalogue_search *const d = v->d;
    const size_t n = (size_t)d->n_listed;
    mt_proof *proof = NULL;
    box one = {.first = mt_arena_int(d->mem, n), .last = NULL};
    MT_TRY(mt_arena_check(d->mem, err));
    if (v->n > 0) {
        memcpy(one.first, v->all[0]->pick, n * sizeof *one.first);
    }
    one.last = one.first;
    bound(d, &one, v->lower, v->upper);
    for (int i = 0; i < d->p->n; i++) {
        const bool shapes = mt_catalogue_search_shapes(&v->proofs[0], i);
        v->lower[i] = shapes ? v->lower[i] : d->c->lower[i];
        v->upper[i] = shapes ? v->upper[i] : d->c->upper[i];
    }
    MT_TRY(mt_catalogue_search_proof_of(&v->proofs[0], v->lower, v->upper, &proof, err));
    v->enclosed = proof != NULL;
    return MT_OK;
}

static mt_status start_branching(branching *v, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    const size_t n_workers = (size_t)d->n_workers;
    v->proofs = mt_arena_alloc(d->mem, n_workers, sizeof *v->proofs);
    v->caps = mt_arena_alloc(d->mem, n_workers, sizeof *v->caps);
    v->lower = mt_arena_f64(d->mem, (size_t)d->p->n, n_workers);
    v->upper = mt_arena_f64(d->mem, (size_t)d->p->n, n_workers);
    double *const x = mt_arena_f64(d->mem, (size_t)d->p->n, ROUND);
    MT_TRY(mt_arena_check(d->mem, err));
    for (int i = 0; i < ROUND; i++) {
        v->looks[i].x = x + ((ptrdiff_t)i * d->p->n);
    }
    for (int i = 0; i < d->n_workers; i++) {
        MT_TRY(mt_catalogue_search_proofs_init(&v->proofs[i], d->c, d->mem, err));
        MT_TRY(mt_proof_cap_init(&v->caps[i], d->p, d->mem, err));
    }
    return probe(v, err);
}

static void end(const branching *v)
{
    for (int i = 0; i < v->d->n_workers && v->proofs != NULL; i++) {
        mt_catalogue_search_proofs_free(&v->proofs[i]);
    }
}

/* Adds a box with the ranges of b except for catalogue k (-1: all are b's). */
static mt_status push_box(branching *v, const box *b, int k, int first, int last, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    const size_t n = (size_t)d->n_listed;
    const mt_proof_cap *const cap = &v->caps[0];
    box made = {.first = mt_arena_int(d->mem, n),
                .last = mt_arena_int(d->mem, n),
                .combinations = 1.0,
                .number = v->made++};
    box *const grown = mt_arena_grow(d->mem, v->open, v->n_open, &v->capacity, sizeof *v->open);
    MT_TRY(mt_arena_check(d->mem, err));
    for (int i = 0; i < d->n_listed; i++) {
        made.first[i] = i == k ? first : b->first[i];
        made.last[i] = i == k ? last : b->last[i];
        made.combinations *= (double)(made.last[i] - made.first[i]) + 1.0;
    }
    bound(d, &made, v->lower, v->upper);
    made.least = cap->cap.least(cap->cap.context, v->lower, v->upper);
    v->open = grown;
    v->open[v->n_open++] = made;
    return MT_OK;
}

static mt_status push_all(branching *v, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    box whole = {.first = mt_arena_int(d->mem, (size_t)d->n_listed),
                 .last = mt_arena_int(d->mem, (size_t)d->n_listed)};
    MT_TRY(mt_arena_check(d->mem, err));
    for (int k = 0; k < d->n_listed; k++) {
        whole.last[k] = d->p->study->variables[d->variable[k]].n_catalogue - 1;
    }
    return push_box(v, &whole, -1, 0, 0, err);
}

/* Halves a box at the catalogue of which it has the greatest share; at those that shape the
 * geometry first, where proofs are possible. */
static mt_status halve(branching *v, const box *b, mt_err *err)
{
    const mt_catalogue_search *const d = v->d;
    int widest = 0;
    double most = -1.0;
    for (int k = 0; k < d->n_listed; k++) {
        const int values = d->p->study->variables[d->variable[k]].n_catalogue;
        const int beyond = b->last[k] - b->first[k];
        const bool first =
            v->enclosed && mt_catalogue_search_shapes(&v->proofs[0], d->variable[k]);
        const double share = ((double)beyond / (double)values) + (first ? 1.0 : 0.0);
        if (beyond > 0 && share > most) {
            most = share;
            widest = k;
        }
    }
    const int middle = b->first[widest] + ((b->last[widest] - b->first[widest]) / 2);
    MT_TRY(push_box(v, b, widest, b->first[widest], middle, err));
    return push_box(v, b, widest, middle + 1, b->last[widest], err);
}

static const mt_combination *best_branched_combination(const branching *v)
{
    const mt_combination *best = NULL;
    for (int i = 0; i < v->n; i++) {
        const mt_combination *const c = v->all[i];
        if (c->judged && c->feasible &&
            (best == NULL || mt_catalogue_search_before(v->d, c, best))) {
            best = c;
        }
    }
    return best;
}

/* The known combination with these values; NULL: none. */
static mt_combination *find_known_combination(const branching *v, const int *pick)
{
    const size_t size = (size_t)v->d->n_listed * sizeof *pick;
    for (int i = 0; i < v->n; i++) {
        if (memcmp(v->all[i]->pick, pick, size) == 0) {
            return v->all[i];
        }
    }
    return NULL;
}

/* Bound of the first objective for wanted designs: better than the best one by more than
 * searches differ, or equal where other objectives follow. Infinite without a best one. */
static double cap_of(const branching *v)
{
    const mt_combination *const best = best_branched_combination(v);
    if (best == NULL) {
        return HUGE_VAL;
    }
    const double f = best->f[0];
    return v->d->p->n_stages > 1 ? f + (EQUAL * fabs(f)) : f - (MT_EQUAL_FOUND * fabs(f));
}

static int by_bound(const void *a, const void *b)
{
    const box *const x = a;
    const box *const y = b;
    if (x->least != y->least) {
        return x->least < y->least ? 1 : -1; /* the next one last */
    }
    return x->number < y->number ? 1 : -1;
}

/* Selects the boxes of the next round, and drops those that cannot be better. */
static void select_boxes(branching *v, double cap)
{
    int kept = 0;
    for (int i = 0; i < v->n_open; i++) {
        if (v->open[i].least < cap) {
            v->open[kept++] = v->open[i];
        }
    }
    v->n_open = kept;
    qsort(v->open, (size_t)v->n_open, sizeof *v->open, by_bound);
    v->n_now = 0;
    while (v->n_now < ROUND && v->n_open > 0) {
        mt_catalogue_search_look *const l = &v->looks[v->n_now];
        *l = (mt_catalogue_search_look){.x = l->x};
        v->now[v->n_now++] = v->open[--v->n_open];
    }
}

/* Adds the combination to those searched next, unless it was searched; from the design x (NULL:
 * no start) in any case. */
static mt_status propose(branching *v, const int *pick, const double *x, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    const size_t size = (size_t)d->n_listed * sizeof *pick;
    const mt_combination *const before = find_known_combination(v, pick);
    bool there = before != NULL && before->judged && x == NULL;
    for (int i = 0; i < v->n_fresh; i++) {
        there = there || memcmp(v->fresh[i].pick, pick, size) == 0;
    }
    if (there) {
        return MT_OK;
    }
    mt_combination *const c = &v->fresh[v->n_fresh++];
    memcpy(c->pick, pick, size);
    mt_catalogue_search_set(d, c);
    if (x != NULL) {
        double *const from = mt_arena_f64(d->mem, (size_t)d->p->n + 1, 1);
        MT_TRY(mt_arena_check(d->mem, err));
        for (int i = 0; i < d->p->n; i++) {
            from[i] = mt_problem_t(d->p, i, x[i]);
        }
        c->from = from;
    }
    return MT_OK;
}

/* The combination of a design, which is in the box. */
static void pick_of(const mt_catalogue_search *d, const box *b, const double *x, int *pick)
{
    for (int k = 0; k < d->n_listed; k++) {
        const double *const values = d->p->study->variables[d->variable[k]].catalogue;
        pick[k] = b->first[k];
        while (pick[k] < b->last[k] && values[pick[k]] < x[d->variable[k]]) {
            pick[k]++;
        }
    }
}

/* Applies the results of a round: boxes are excluded, halved, or searched. */
static mt_status follow_up(branching *v, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    int *const pick = mt_arena_int(d->mem, (size_t)d->n_listed);
    v->n_fresh = 0;
    MT_TRY(mt_catalogue_search_alloc(d, 2 * ROUND, &v->fresh, err));
    for (int i = 0; i < v->n_now; i++) {
        const box *const b = &v->now[i];
        const mt_catalogue_search_look *const l = &v->looks[i];
        if (l->excluded) {
            continue;
        }
        if (l->met) {
            pick_of(d, b, l->x, pick);
            MT_TRY(propose(v, pick, l->x, err));
        }
        if (b->combinations > 1.0) {
            MT_TRY(halve(v, b, err));
        } else {
            MT_TRY(propose(v, b->first, NULL, err));
        }
    }
    return MT_OK;
}

/* Adds a searched combination to the others, or replaces its earlier record. */
static mt_status add_searched_combination(branching *v, mt_combination *c, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    mt_combination *const before = find_known_combination(v, c->pick);
    if (before != NULL) {
        const bool better =
            c->judged && (!before->judged || mt_catalogue_search_before(d, c, before));
        if (better) {
            *before = *c;
        }
        return MT_OK;
    }
    mt_combination **const grown =
        mt_arena_grow(d->mem, v->all, v->n, &v->n_capacity, sizeof(mt_combination *));
    MT_TRY(mt_arena_check(d->mem, err));
    v->all = grown;
    v->all[v->n++] = c;
    return MT_OK;
}

static mt_status search_fresh(branching *v, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    const long most = d->c->search.max_evaluations;
    const long left = most - d->evals;
    int n = v->n_fresh;
    if (most > 0 && left / LEAST_BUDGET < n) {
        n = left > 0 ? (int)(left / LEAST_BUDGET) : 0;
    }
    if (n > 0) {
        MT_TRY(mt_catalogue_search_verify(d, n, v->fresh, most > 0 ? left / n : 0, err));
    }
    for (int i = 0; i < n; i++) {
        MT_TRY(add_searched_combination(v, &v->fresh[i], err));
    }
    if (n < v->n_fresh && d->stop != MT_STOP_USER) {
        d->stop = MT_STOP_MAX_EVALS;
    }
    return MT_OK;
}

/* One round; boxes whose combination was not searched stay open. */
static mt_status round_of(branching *v, double cap, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    const mt_tasks tasks = {v->n_now, examine_box, serialize_look, v, "boxes of combinations"};
    v->cap = cap;
    for (int i = 0; i < d->n_workers; i++) {
        v->caps[i].cap.below = cap;
    }
    if (v->enclosed) {
        MT_TRY(mt_workers_run(d->n_workers, d->workers[0]->task_path, &tasks, err));
    }
    for (int i = 0; i < v->n_now; i++) {
        v->work += (double)v->looks[i].work;
        mt_work_counters_note(d->p->run->work, MT_WORK_MULTIPLICATIONS,
                              v->looks[i].multiplications);
    }
    v->enclosed = v->enclosed && v->work < d->c->proof_work;
    MT_TRY(follow_up(v, err));
    MT_TRY(search_fresh(v, err));
    for (int i = 0; i < v->n_now; i++) {
        const box *const b = &v->now[i];
        if (b->combinations > 1.0 || v->looks[i].excluded) {
            continue;
        }
        const mt_combination *const c = find_known_combination(v, b->first);
        if (c == NULL || !c->judged) {
            MT_TRY(push_box(v, b, -1, 0, 0, err));
        }
    }
    return MT_OK;
}

/* Progress before a round: what remains open, and by how much it may be better. */
static void note_open(const branching *v, mt_catalogue_search_report *report)
{
    const mt_combination *const best = best_branched_combination(v);
    double least = HUGE_VAL;
    report->open = 0.0;
    for (int i = 0; i < v->n_open + v->n_now; i++) {
        const box *const b = i < v->n_open ? &v->open[i] : &v->now[i - v->n_open];
        report->open += b->combinations;
        least = fmin(least, b->least);
    }
    report->open_within = nan("");
    if (best != NULL && best->f[0] > 0.0 && report->open > 0.0) {
        /* half the square of the change */
        const bool squares = mt_objective_is(v->d->p->stages[0].type, MT_HALF_SQUARE);
        const double share = fmax(least, 0.0) / best->f[0];
        report->open_within = 1.0 - (squares ? sqrt(share) : share);
    }
}

static bool goes_on(const branching *v, int searched, long looked)
{
    const int most = v->enclosed ? SEARCHED_MOST : MT_CATALOGUE_SEARCH_MOST_MIXED;
    return v->n_now > 0 && v->d->stop == MT_STOP_DONE && searched < most &&
           looked < LOOKED_MOST;
}

static mt_status branch_over_boxes(branching *v, mt_catalogue_search_report *report,
                                   mt_err *err)
{
    const mt_catalogue_search *const d = v->d;
    const int before = v->n;
    long looked = 0;
    MT_TRY(start_branching(v, err));
    if (!v->caps[0].known) {
        return MT_OK; /* no combination can be told from a better one */
    }
    report->branched = true;
    MT_TRY(push_all(v, err));
    double cap = cap_of(v);
    select_boxes(v, cap);
    note_open(v, report);
    while (goes_on(v, v->n - before, looked)) {
        looked += v->n_now;
        MT_TRY(round_of(v, cap, err));
        cap = cap_of(v);
        select_boxes(v, cap);
        note_open(v, report);
    }
    report->all = report->open == 0.0 && d->stop == MT_STOP_DONE;
    return MT_OK;
}

mt_status mt_catalogue_search_branch(mt_catalogue_search *d, mt_combination ***all, int *n,
                                     mt_catalogue_search_report *report, mt_err *err)
{
    branching v = {.d = d, .all = *all, .n = *n, .n_capacity = *n};
    const mt_status rc = branch_over_boxes(&v, report, err);
    end(&v);
    *all = v.all;
    *n = v.n;
    return rc;
}
