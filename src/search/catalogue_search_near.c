/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Too many combinations to try: search as if every catalogue were an interval, round what comes
 * out in all ways that its most undecided variables allow, then step from the best to
 * neighbouring values (one variable, or two at a time) while that helps. Nothing is proven by
 * this.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "search/catalogue_search.h"
#include "search/mode_placements.h"
#include "search/search.h"

enum {
    RELAXED_MOST = 8,    /* designs of the relaxed problem that are rounded */
    UNDECIDED = 6,       /* variables rounded both ways: 2^6 roundings of each */
    UNDECIDED_MIXED = 4, /* fewer where every rounding is a search of its own */
    ROUNDS = 100,        /* of steps to neighbours */
    ROUNDS_MIXED = 12,
    PAIRS_OF_AT_MOST = 12, /* variables: beyond, steps change one of them at a time */
    VISITED_MOST = 20000
};

typedef struct walk {
    mt_catalogue_search *d;
    mt_combination **all; /* [VISITED_MOST] */
    int n;
    mt_combination *fresh; /* to be judged next; their entries end up in all */
    int n_fresh;
    int room;
} walk;

static bool is_visited(const walk *w, const int *pick)
{
    const size_t size = (size_t)w->d->n_listed * sizeof *pick;
    for (int i = 0; i < w->n; i++) {
        if (memcmp(w->all[i]->pick, pick, size) == 0) {
            return true;
        }
    }
    for (int i = 0; i < w->n_fresh; i++) {
        if (memcmp(w->fresh[i].pick, pick, size) == 0) {
            return true;
        }
    }
    return false;
}

static mt_status allocate_neighbours(walk *w, int room, mt_err *err)
{
    w->n_fresh = 0;
    w->room = room < VISITED_MOST - w->n ? room : VISITED_MOST - w->n;
    return mt_catalogue_search_alloc(w->d, w->room, &w->fresh, err);
}

static void propose(walk *w, const int *pick)
{
    if (w->n_fresh < w->room && !is_visited(w, pick)) {
        mt_combination *const c = &w->fresh[w->n_fresh++];
        memcpy(c->pick, pick, (size_t)w->d->n_listed * sizeof *pick);
        mt_catalogue_search_set(w->d, c);
    }
}

/* The budget is checked before each round and shared out evenly. */
static mt_status verify_proposed_neighbours(walk *w, mt_err *err)
{
    mt_catalogue_search *const d = w->d;
    const long most = d->c->search.max_evaluations;
    const long left = most - d->evals;
    if (most > 0 && left < w->n_fresh) {
        w->n_fresh = left > 0 && !d->mixed ? (int)left : 0;
        d->stop = d->stop == MT_STOP_USER ? MT_STOP_USER : MT_STOP_MAX_EVALS;
    }
    if (w->n_fresh == 0) {
        return MT_OK;
    }
    MT_TRY(mt_catalogue_search_verify(d, w->n_fresh, w->fresh, most > 0 ? left / w->n_fresh : 0,
                                      err));
    for (int i = 0; i < w->n_fresh; i++) {
        w->all[w->n++] = &w->fresh[i];
    }
    w->n_fresh = 0;
    return MT_OK;
}

/* Index of the last value whose coordinate is at most t (0 where none is), and the position of
 * t between it and the next, 0 to 1. */
static int bracket(const mt_catalogue_search *d, int k, double t, double *part)
{
    const int i = d->variable[k];
    const mt_variable *const v = &d->p->study->variables[i];
    int at = 0;
    while (at + 1 < v->n_catalogue && mt_problem_t(d->p, i, v->catalogue[at + 1]) <= t) {
        at++;
    }
    *part = 0.0;
    if (at + 1 < v->n_catalogue) {
        const double low = mt_problem_t(d->p, i, v->catalogue[at]);
        const double high = mt_problem_t(d->p, i, v->catalogue[at + 1]);
        *part = fmin(fmax((t - low) / (high - low), 0.0), 1.0);
    }
    return at;
}

/* The variables whose t lies nearest to the middle of two values: open[most]. */
static void choose_undecided(int n, const double *part, int most, int *open)
{
    for (int b = 0; b < most; b++) {
        double least = HUGE_VAL;
        for (int k = 0; k < n; k++) {
            bool taken = false;
            for (int c = 0; c < b; c++) {
                taken = taken || open[c] == k;
            }
            if (!taken && fabs(part[k] - 0.5) < least) {
                least = fabs(part[k] - 0.5);
                open[b] = k;
            }
        }
    }
}

/* All roundings of the most undecided variables of t, the others to the nearest value. */
static mt_status propose_roundings(walk *w, const double *t, mt_err *err)
{
    const mt_catalogue_search *const d = w->d;
    const int n = d->n_listed;
    const int most = d->mixed ? UNDECIDED_MIXED : UNDECIDED;
    const int both = n < most ? n : most;
    int *const low = mt_arena_int(d->mem, (size_t)n);
    int *const pick = mt_arena_int(d->mem, (size_t)n);
    int *const open = mt_arena_int(d->mem, (size_t)most);
    double *const part = mt_arena_f64(d->mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(d->mem, err));
    for (int k = 0; k < n; k++) {
        low[k] = bracket(d, k, t[d->variable[k]], &part[k]);
    }
    choose_undecided(n, part, both, open);
    for (int way = 0; way < 1 << both; way++) {
        for (int k = 0; k < n; k++) {
            pick[k] = low[k] + (part[k] > 0.5 ? 1 : 0);
        }
        for (int b = 0; b < both; b++) {
            const int k = open[b];
            const int last = d->p->study->variables[d->variable[k]].n_catalogue - 1;
            const int up = low[k] + ((way >> b) & 1);
            pick[k] = up < last ? up : last;
        }
        propose(w, pick);
    }
    return MT_OK;
}

static mt_status round_relaxed(walk *w, mt_err *err)
{
    mt_catalogue_search *const d = w->d;
    const bool bands = d->p->n_avoidances > 0;
    const int ways = 1 << (d->mixed ? UNDECIDED_MIXED : UNDECIDED);
    mt_nlp_result plain = {0};
    mt_mode_placement_result placements = {0};
    mt_err why = {0};
    int stage = 0;
    MT_TRY(
        bands
            ? mt_mode_placements_solve(d->workers, d->n_workers, NULL, d->mem, &placements, err)
            : mt_search_designs(d->workers, d->n_workers, d->mem, &plain, &stage, &why, err));
    const int found = bands ? placements.n_solutions : plain.n_solutions;
    const int n = found < RELAXED_MOST ? found : RELAXED_MOST;
    d->evals += bands ? placements.evals : plain.evals;
    d->starts += bands ? placements.starts : plain.starts;
    d->stop = bands ? placements.stop : plain.stop;
    MT_TRY(allocate_neighbours(w, (n + 1) * ways, err));
    for (int i = 0; i < n; i++) {
        MT_TRY(propose_roundings(
            w, bands ? placements.solutions[i].found->t : plain.solutions[i].t, err));
    }
    MT_TRY(propose_roundings(w, d->c->origin_t, err));
    return verify_proposed_neighbours(w, err);
}

/* Step variable k of pick; false at an end of its catalogue. */
static bool step_catalogue_value(const walk *w, int k, int by, int *pick)
{
    const int last = w->d->p->study->variables[w->d->variable[k]].n_catalogue - 1;
    pick[k] += by;
    return pick[k] >= 0 && pick[k] <= last;
}

static void propose_neighbours(walk *w, const mt_combination *c, int *pick)
{
    const int n = w->d->n_listed;
    const size_t size = (size_t)n * sizeof *pick;
    const bool pairs = !w->d->mixed && n <= PAIRS_OF_AT_MOST;
    for (int way = 0; way < 2 * n; way++) {
        memcpy(pick, c->pick, size);
        if (!step_catalogue_value(w, way / 2, way % 2 == 0 ? -1 : 1, pick)) {
            continue;
        }
        propose(w, pick);
        for (int other = 0; other < way - (way % 2) && pairs; other++) {
            const int before = pick[other / 2];
            if (step_catalogue_value(w, other / 2, other % 2 == 0 ? -1 : 1, pick)) {
                propose(w, pick);
            }
            pick[other / 2] = before;
        }
    }
}

static const mt_combination *best_visited_combination(const walk *w)
{
    const mt_combination *best = NULL;
    for (int i = 0; i < w->n; i++) {
        const mt_combination *const c = w->all[i];
        if (c->judged && MT_HAS(c->missed.violation) &&
            (best == NULL || mt_catalogue_search_before(w->d, c, best))) {
            best = c;
        }
    }
    return best;
}

mt_status mt_catalogue_search_near(mt_catalogue_search *d, mt_combination ***list, int *n,
                                   mt_err *err)
{
    walk w = {.d = d};
    const int size = d->n_listed;
    const int rounds = d->mixed ? ROUNDS_MIXED : ROUNDS;
    int *const pick = mt_arena_int(d->mem, (size_t)size);
    w.all = mt_arena_alloc(d->mem, VISITED_MOST, sizeof(mt_combination *));
    MT_TRY(mt_arena_check(d->mem, err));
    MT_TRY(round_relaxed(&w, err));
    const mt_combination *centre = NULL;
    for (int k = 0; k < rounds && d->stop == MT_STOP_DONE; k++) {
        const mt_combination *const best = best_visited_combination(&w);
        if (best == NULL || best == centre) {
            break;
        }
        centre = best;
        MT_TRY(allocate_neighbours(&w, 2 * size * size, err));
        propose_neighbours(&w, centre, pick);
        MT_TRY(verify_proposed_neighbours(&w, err));
    }
    *list = w.all;
    *n = w.n;
    return MT_OK;
}
