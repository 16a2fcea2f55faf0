/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Branch and bound over catalogues: enclosures of each geometry, with and without continuous
 * variables. */
#include "search/catalogue_search_prove.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/run.h"
#include "base/workers.h"
#include "problem/drive_positions.h"
#include "problem/objective.h"
#include "search/catalogue_search.h"
#include "search/mode_placements.h"

/* Enclosures of each geometry. */

/* A box beside its factorisations, in multiplications, as in certify.c. */
static const double BOX = 500.0;

mt_status mt_catalogue_search_proofs_init(mt_catalogue_search_proofs *s, const mt_subproblem *c,
                                          mt_arena *mem, mt_err *err)
{
    bool *shapes = NULL;
    int n = 0;
    *s = (mt_catalogue_search_proofs){.c = c};
    s->shaping = mt_arena_int(mem, (size_t)c->p->n);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_proof_shaping(c, mem, &shapes, &n, err));
    for (int i = 0; i < c->p->n; i++) {
        if (shapes[i] && c->p->study->variables[i].n_catalogue > 0) {
            s->shaping[s->n_shaping++] = i;
        }
    }
    return MT_OK;
}

static void drop(mt_catalogue_search_proofs *s, int slot)
{
    mt_proof_free(&s->proof[slot]);
    mt_arena_free(&s->mem[slot]);
    s->proof[slot] = (mt_proof){.possible = false};
}

void mt_catalogue_search_proofs_free(mt_catalogue_search_proofs *s)
{
    for (int i = 0; i < MT_CATALOGUE_SEARCH_PROOFS_KEPT; i++) {
        drop(s, i);
    }
}

/* True where variable i is a catalogue that shapes the geometry. */
static bool catalogue_search_shapes(const mt_catalogue_search_proofs *s, int i)
{
    for (int k = 0; k < s->n_shaping; k++) {
        if (s->shaping[k] == i) {
            return true;
        }
    }
    return false;
}

/* True where a choice sets a variable that shapes the geometry. */
static bool choice_shapes(const mt_catalogue_search_proofs *s, const mt_choice *choice)
{
    bool shapes = false;
    for (int i = 0; i < choice->n; i++) {
        shapes = shapes || catalogue_search_shapes(s, choice->first + i);
    }
    return shapes;
}

/* Number of geometries that the catalogues give. catalogue_search_geometry: bounds of the
 * relaxed problem for geometry `which`: lower[n], upper[n]. */
static double catalogue_search_geometries(const mt_catalogue_search_proofs *s)
{
    const mt_problem *const p = s->c->p;
    double n = 1.0;
    for (int k = 0; k < p->n_choices; k++) {
        n *= choice_shapes(s, &p->choices[k]) ? (double)p->choices[k].n_rows : 1.0;
    }
    return n;
}

static void catalogue_search_geometry(const mt_catalogue_search_proofs *s, int which,
                                      double *lower, double *upper)
{
    for (int i = 0; i < s->c->p->n; i++) {
        lower[i] = s->c->lower[i];
        upper[i] = s->c->upper[i];
    }
    for (int k = 0; k < s->c->p->n_choices; k++) {
        const mt_choice *const own = &s->c->p->choices[k];
        if (choice_shapes(s, own)) {
            const double *const row = mt_choice_row(own, which % own->n_rows);
            memcpy(lower + own->first, row, (size_t)own->n * sizeof *lower);
            memcpy(upper + own->first, row, (size_t)own->n * sizeof *upper);
            which /= own->n_rows;
        }
    }
}

/* True where the proof in the slot is of the geometry of the box. */
static bool is_of(const mt_catalogue_search_proofs *s, int slot, const double *lower)
{
    for (int k = 0; k < s->n_shaping; k++) {
        if (s->proof[slot].lower[s->shaping[k]] != lower[s->shaping[k]]) {
            return false;
        }
    }
    return true;
}

/* Restrict variables with a catalogue to its values instead of the interval it spans. Arrays in
 * mem. */
static mt_status use_catalogues(mt_proof *proof, const mt_problem *p, mt_arena *mem,
                                mt_err *err)
{
    int *const count = mt_arena_int(mem, (size_t)p->n);
    const double **const values = mt_arena_alloc(mem, (size_t)p->n, sizeof(double *));
    mt_certify_rows *const rows = mt_arena_alloc(mem, (size_t)p->n_choices, sizeof *rows);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < p->n; i++) {
        count[i] = p->study->variables[i].n_catalogue;
        values[i] = p->study->variables[i].catalogue;
    }
    proof->question.n_catalogue = count;
    proof->question.catalogue = values;
    proof->question.rows = rows;
    for (int k = 0; k < p->n_choices; k++) {
        const mt_choice *const own = &p->choices[k];
        if (own->n > 1) {
            rows[proof->question.n_rows++] =
                (mt_certify_rows){own->first, own->n, own->n_rows, own->value};
        }
    }
    return MT_OK;
}

static mt_status make_geometry_proof(mt_catalogue_search_proofs *s, int slot,
                                     const double *lower, mt_err *err)
{
    mt_subproblem held;
    mt_proof *const proof = &s->proof[slot];
    mt_arena *const mem = &s->mem[slot];
    drop(s, slot);
    MT_TRY(mt_arena_init(mem, 0, err));
    MT_TRY(mt_subproblem_copy(s->c, mem, &held, err));
    for (int k = 0; k < s->n_shaping; k++) {
        const int i = s->shaping[k];
        held.lower[i] = lower[i];
        held.upper[i] = lower[i];
    }
    MT_TRY(mt_proof_init(proof, &held, mem, err));
    return use_catalogues(proof, s->c->p, mem, err);
}

/* The proof with its bounds set to lower <= x <= upper [n], valid until the next call; NULL:
 * not possible. Fails: as mt_proof_init. */
static mt_status catalogue_search_proof_of(mt_catalogue_search_proofs *s, const double *lower,
                                           const double *upper, mt_proof **out, mt_err *err)
{
    const size_t size = (size_t)s->c->p->n * sizeof *lower;
    const int kept =
        s->n < MT_CATALOGUE_SEARCH_PROOFS_KEPT ? s->n : MT_CATALOGUE_SEARCH_PROOFS_KEPT;
    bool one = true;
    int slot = 0;
    *out = NULL;
    for (int k = 0; k < s->n_shaping; k++) {
        one = one && lower[s->shaping[k]] == upper[s->shaping[k]];
    }
    if (!one) {
        return MT_OK;
    }
    while (slot < kept && !is_of(s, slot, lower)) {
        slot++;
    }
    if (slot == kept) {
        slot = s->n % MT_CATALOGUE_SEARCH_PROOFS_KEPT;
        MT_TRY(make_geometry_proof(s, slot, lower, err));
        s->n++;
    }
    if (s->proof[slot].possible) {
        *out = &s->proof[slot];
        memcpy((*out)->lower, lower, size);
        memcpy((*out)->upper, upper, size);
    }
    return MT_OK;
}

mt_status mt_catalogue_search_look_at(mt_catalogue_search_proofs *s, const double *lower,
                                      const double *upper, const mt_certify_cap *cap,
                                      double boxes, mt_arena *mem,
                                      mt_catalogue_search_look *out, mt_err *err)
{
    mt_proof *proof = NULL;
    mt_certify_search found = {0};
    MT_TRY(catalogue_search_proof_of(s, lower, upper, &proof, err));
    if (proof == NULL) {
        return MT_OK;
    }
    double unit = BOX;
    for (int i = 0; i < proof->question.n_views; i++) {
        const double order = proof->views[i]->n;
        unit += order * order * order;
        proof->views[i]->operations = 0.0;
    }
    proof->spent = NULL; /* noted box by box */
    proof->question.progress = NULL;
    proof->question.any = true;
    proof->question.cap = cap;
    proof->question.max_work = unit * boxes;
    MT_TRY(mt_certify_assignments(&proof->question, 0, NULL, mem, &found, err));
    out->met = found.n_found > 0;
    out->excluded = !out->met && found.proven;
    if (out->met) {
        memcpy(out->x, found.at, (size_t)s->c->p->n * sizeof *out->x);
    }
    double multiplications = 0.0;
    for (int i = 0; i < proof->question.n_views; i++) {
        multiplications += proof->views[i]->operations;
    }
    out->multiplications = (long)multiplications;
    out->work = (long)found.work;
    return MT_OK;
}

void mt_catalogue_search_look_serialize(const mt_subproblem *c, mt_catalogue_search_look *look,
                                        mt_serializer *serializer)
{
    const int n = c->p->n;
    mt_serializer_flag(serializer, &look->excluded);
    mt_serializer_flag(serializer, &look->met);
    mt_serializer_long(serializer, &look->work, 0, LONG_MAX);
    mt_serializer_long(serializer, &look->multiplications, 0, LONG_MAX);
    mt_serializer_numbers(serializer, (size_t)n, look->x);
    serializer->failed = serializer->failed || (look->excluded && look->met);
    for (int i = 0; i < n && look->met; i++) {
        const bool within = look->x[i] >= c->lower[i] && look->x[i] <= c->upper[i];
        serializer->failed = serializer->failed || !within;
    }
    if (serializer->reads &&
        !mt_serializer_is_read(serializer)) { /* as if nothing had been read */
        memset(look->x, 0, (size_t)n * sizeof *look->x);
        *look = (mt_catalogue_search_look){.x = look->x};
    }
}

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
 * first, unseen, until each box has one geometry.
 *
 * So each combination is excluded, by proof, or searched, by samples in its continuous
 * variables. Boxes are looked at in rounds of a fixed number, with one cap for all of a round:
 * nothing depends on the workers.
 */

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

/* To the next row of a box that may bound it: of ascending values only the ends do. */
static int row_step(const mt_choice *choice, const box *b, int k)
{
    const int whole = b->last[k] - b->first[k];
    return choice->n == 1 && whole > 0 ? whole : 1;
}

/* Values of a box, the others within their bounds. */
static void bound(const mt_catalogue_search *d, const box *b, double *lower, double *upper)
{
    for (int i = 0; i < d->p->n; i++) {
        lower[i] = d->c->lower[i];
        upper[i] = d->c->upper[i];
    }
    for (int k = 0; k < d->n_listed; k++) {
        const mt_choice *const own = &d->choice[k];
        for (int j = 0; j < own->n; j++) {
            lower[own->first + j] = HUGE_VAL;
            upper[own->first + j] = -HUGE_VAL;
        }
        for (int row = b->first[k]; row <= b->last[k]; row += row_step(own, b, k)) {
            for (int j = 0; j < own->n; j++) {
                const int i = own->first + j;
                lower[i] = fmin(lower[i], mt_choice_row(own, row)[j]);
                upper[i] = fmax(upper[i], mt_choice_row(own, row)[j]);
            }
        }
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
        const bool shapes = catalogue_search_shapes(&v->proofs[0], i);
        v->lower[i] = shapes ? v->lower[i] : d->c->lower[i];
        v->upper[i] = shapes ? v->upper[i] : d->c->upper[i];
    }
    MT_TRY(catalogue_search_proof_of(&v->proofs[0], v->lower, v->upper, &proof, err));
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
        whole.last[k] = d->choice[k].n_rows - 1;
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
        const int values = d->choice[k].n_rows;
        const int beyond = b->last[k] - b->first[k];
        const bool first = v->enclosed && choice_shapes(&v->proofs[0], &d->choice[k]);
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

/* The combination of a design that a certificate met. Its rows may be others than those of the
 * box, which lie between the same values. */
static void pick_of(const mt_catalogue_search *d, const box *b, const double *x, int *pick)
{
    for (int k = 0; k < d->n_listed; k++) {
        const int row = mt_choice_find(&d->choice[k], x);
        pick[k] = row == MT_ABSENT ? b->first[k] : row;
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

/*
 * Branch and bound over catalogues, with continuous variables beside them or not. A box holds
 * values of each catalogue from one to another, and its enclosure is that of the interval
 * between them, so whatever is excluded is excluded for every combination in it; halving leaves
 * the gaps between values out, and a box of single values is a combination. First: which gap
 * assignments can be met; their designs are judged like any other combination. Then, with the
 * objective of the best as a cap: whether there is a better one. What is found moves the cap,
 * until nothing is left, which proves the best to be the best, or an effort is spent. Where
 * catalogues shape the geometry each of their combinations is asked by itself, if they are not
 * too many.
 */

enum {
    ROUNDS = 40, /* of a better design found and the cap moved */
    GEOMETRIES_MOST = 64
};
/* What one question may take of the budget of all. */
static const double PART = 0.2;
/* With continuous variables what is proven is that no design is better by more than this, or
 * else by more than the second. */
static const double WITHIN[] = {1e-2, 1e-1};

/* What all geometries say. */
typedef struct outcome {
    bool proven;
    bool stopped;
    int n_found;
} outcome;

typedef struct prover {
    mt_catalogue_search *d;
    mt_catalogue_search_report *report;
    mt_catalogue_search_proofs proofs;
    int n_geometries;
    double *lower; /* [n] of one of them */
    double *upper;
    double left; /* of the budget, in multiplications */
    mt_proof_cap cap;
    bool capped; /* only better designs are asked for */
    bool covers; /* no goal is left out of the question */
    int n_kinds; /* gap assignments that were found */
    int *kinds;  /* [n_kinds x n_bands] */
    int cap_kinds;
    mt_combination **all;
    int n;
    int capacity;
} prover;

/* The best so far, over its range of motion too; NULL: none is feasible. */
static mt_status find_best_combination(const prover *v, const mt_combination **out, mt_err *err)
{
    mt_combination *best = NULL;
    do {
        best = NULL;
        for (int i = 0; i < v->n; i++) {
            mt_combination *const c = v->all[i];
            if (c->judged && c->feasible &&
                (best == NULL || mt_catalogue_search_before(v->d, c, best))) {
                best = c;
            }
        }
        if (best != NULL) {
            MT_TRY(mt_catalogue_search_follow(v->d, best, err));
        }
    } while (best != NULL && !best->feasible);
    *out = best;
    return MT_OK;
}

/* The combination of x; appended to the list where it is not in it. */
static mt_status combination_at(prover *v, const double *x, mt_combination **out, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    mt_combination *c = NULL;
    MT_TRY(mt_catalogue_search_alloc(d, 1, &c, err));
    for (int k = 0; k < d->n_listed; k++) {
        const int row = mt_choice_find(&d->choice[k], x);
        c->pick[k] = row == MT_ABSENT ? 0 : row;
    }
    const size_t size = (size_t)d->n_listed * sizeof *c->pick;
    for (int i = 0; i < v->n; i++) {
        if (memcmp(v->all[i]->pick, c->pick, size) == 0) {
            *out = v->all[i];
            return MT_OK;
        }
    }
    mt_combination **const grown =
        mt_arena_grow(d->mem, v->all, v->n, &v->capacity, sizeof(mt_combination *));
    MT_TRY(mt_arena_check(d->mem, err));
    mt_catalogue_search_set(d, c);
    v->all = grown;
    v->all[v->n++] = c;
    *out = c;
    return MT_OK;
}

/* Evaluates the combination of a design that the proof found: alone, or searched from that
 * design. */
static mt_status evaluate_proof_design(prover *v, const double *x, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    mt_combination *c = NULL;
    const long most = d->c->search.max_evaluations;
    const long left = most - d->evals;
    MT_TRY(combination_at(v, x, &c, err));
    if (c == NULL) {
        return mt_fail_memory(err);
    }
    if (c->judged && (c->feasible || !d->mixed)) {
        return MT_OK;
    }
    if (most > 0 && left <= 0) {
        d->stop = d->stop == MT_STOP_USER ? MT_STOP_USER : MT_STOP_MAX_EVALS;
        return MT_OK;
    }
    double *const from = mt_arena_f64(d->mem, (size_t)d->p->n + 1, 1);
    MT_TRY(mt_arena_check(d->mem, err));
    for (int i = 0; i < d->p->n; i++) {
        from[i] = mt_problem_t(d->p, i, x[i]);
    }
    c->from = from;
    return mt_catalogue_search_verify(d, 1, c, most > 0 ? left : 0, err);
}

/* The proof of a geometry; NULL: there is none. */
static mt_status proof_of(prover *v, int geometry, mt_proof **out, mt_err *err)
{
    catalogue_search_geometry(&v->proofs, geometry, v->lower, v->upper);
    MT_TRY(catalogue_search_proof_of(&v->proofs, v->lower, v->upper, out, err));
    if (*out != NULL) {
        (*out)->left = v->left;
        (*out)->question.cap = v->capped ? &v->cap.cap : NULL;
        v->covers = v->covers && (*out)->covers;
    }
    return MT_OK;
}

/* Mode placements that one geometry has and none before it had. */
static mt_status note_kinds(prover *v, const mt_certify_search *found, mt_err *err)
{
    const int m = v->d->p->n_bands;
    for (int k = 0; k < found->n_found; k++) {
        const int *const row = found->found + ((ptrdiff_t)k * m);
        if (mt_certify_index_of(v->kinds, v->n_kinds, row, m) < v->n_kinds) {
            continue;
        }
        int *const grown = mt_arena_grow(v->d->mem, v->kinds, v->n_kinds, &v->cap_kinds,
                                         ((size_t)m + 1) * sizeof *grown);
        MT_TRY(mt_arena_check(v->d->mem, err));
        v->kinds = grown;
        memcpy(v->kinds + ((ptrdiff_t)v->n_kinds * m), row, (size_t)m * sizeof *row);
        v->n_kinds++;
    }
    return MT_OK;
}

/* Runs the proof of each geometry with its share of `most`, and evaluates the designs found. */
static mt_status run_geometry_proofs(prover *v, outcome *out, mt_err *err)
{
    double most = fmin(PART * v->d->c->proof_work, v->left);
    *out = (outcome){.proven = true};
    for (int g = 0; g < v->n_geometries && !out->stopped; g++) {
        mt_certify_search found = {0};
        mt_proof *proof = NULL;
        MT_TRY(proof_of(v, g, &proof, err));
        out->proven = out->proven && proof != NULL;
        if (proof == NULL) {
            continue;
        }
        const double before = v->left;
        MT_TRY(mt_proof_query(proof, most / (double)(v->n_geometries - g), v->d->mem, &found,
                              err));
        v->left = proof->left;
        most -= before - v->left;
        out->proven = out->proven && found.proven;
        out->stopped = found.stopped;
        out->n_found += found.n_found;
        v->report->boxes += found.boxes;
        MT_TRY(note_kinds(v, &found, err));
        for (int k = 0; k < found.n_found && v->d->stop != MT_STOP_USER; k++) {
            MT_TRY(evaluate_proof_design(v, found.at + ((ptrdiff_t)k * v->d->p->n), err));
        }
    }
    out->proven = out->proven && !out->stopped;
    return MT_OK;
}

/* Below this value of the first objective a design is better than f by more than the share. */
static double better_by_share(const mt_problem *p, double f, double share)
{
    /* f is half the square of the change */
    const bool squares = mt_objective_is(p->stages[0].type, MT_HALF_SQUARE);
    return squares ? f * (1.0 - share) * (1.0 - share) : f - (share * fabs(f));
}

/* Proves that the best is within a share of its objective of the optimum; a better design that
 * is found replaces it. */
static mt_status improve(prover *v, double share, mt_err *err)
{
    for (int round = 0; round < ROUNDS; round++) {
        const mt_combination *best = NULL;
        MT_TRY(find_best_combination(v, &best, err));
        if (best == NULL) { /* interrupted on the way from position to position */
            return MT_OK;
        }
        const double f = best->f[0];
        outcome found = {0};
        v->cap.cap.below = better_by_share(v->d->p, f, share);
        v->capped = true;
        MT_TRY(run_geometry_proofs(v, &found, err));
        if (found.proven && found.n_found == 0) {
            v->report->best_within = share;
            return MT_OK;
        }
        v->report->cut = v->report->cut || (!found.proven && !found.stopped);
        MT_TRY(find_best_combination(v, &best, err));
        if (best == NULL || !(best->f[0] < f) || v->d->stop == MT_STOP_USER) {
            return MT_OK;
        }
    }
    return MT_OK;
}

static mt_status prove(prover *v, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    mt_catalogue_search_report *const report = v->report;
    outcome found = {0};
    v->left = d->c->proof_work;
    v->covers = true;
    MT_TRY(mt_proof_cap_init(&v->cap, d->p, d->mem, err));
    MT_TRY(run_geometry_proofs(v, &found, err));
    report->n_kinds = v->n_kinds;
    const mt_combination *best = NULL;
    MT_TRY(find_best_combination(v, &best, err));
    report->complete = v->covers && !mt_drive_positions_any(d->p);
    report->n_possible = mt_mode_placement_count_possible(d->p);
    report->settled = found.proven && (found.n_found > 0 || best == NULL);
    if (best == NULL || !v->cap.known) {
        return MT_OK;
    }
    MT_TRY(improve(v, d->mixed ? WITHIN[0] : EQUAL, err));
    if (d->mixed && isnan(report->best_within) && d->stop != MT_STOP_USER) {
        MT_TRY(improve(v, WITHIN[1], err));
    }
    return MT_OK;
}

/* Reason why the whole question cannot be proven. */
static mt_status give_reason(const prover *v, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    mt_proof whole;
    const mt_status rc = mt_proof_init(&whole, d->c, d->mem, err);
    v->report->reason = mt_arena_strdup(d->mem, whole.reason);
    mt_proof_free(&whole);
    return rc == MT_OK ? mt_arena_check(d->mem, err) : rc;
}

/* One proof for each geometry, where these are not too many; 0 geometries, and the reason,
 * where no proof is possible. */
static mt_status start_geometry_proofs(prover *v, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    mt_proof *first = NULL;
    v->lower = mt_arena_f64(d->mem, (size_t)d->p->n, 1);
    v->upper = mt_arena_f64(d->mem, (size_t)d->p->n, 1);
    MT_TRY(mt_arena_check(d->mem, err));
    MT_TRY(mt_catalogue_search_proofs_init(&v->proofs, d->c, d->mem, err));
    const double n = catalogue_search_geometries(&v->proofs);
    if (n <= (double)GEOMETRIES_MOST) {
        MT_TRY(proof_of(v, 0, &first, err));
    }
    v->n_geometries = first != NULL ? (int)n : 0;
    return v->n_geometries > 0 ? MT_OK : give_reason(v, err);
}

mt_status mt_catalogue_search_prove(mt_catalogue_search *d, mt_combination ***all, int *n,
                                    mt_catalogue_search_report *report, mt_err *err)
{
    prover v = {.d = d, .report = report, .all = *all, .n = *n, .capacity = *n};
    report->asked = true;
    mt_status rc = start_geometry_proofs(&v, err);
    if (rc == MT_OK && v.n_geometries > 0) {
        rc = prove(&v, err);
    }
    mt_catalogue_search_proofs_free(&v.proofs);
    *all = v.all;
    *n = v.n;
    return rc;
}
