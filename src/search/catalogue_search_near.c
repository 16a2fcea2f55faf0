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

/* The two rows that a choice is rounded to, and where its t stands between them, 0 to 1. */
typedef struct rounding {
    int low;
    int high;
    double part;
} rounding;

/* The last value whose coordinate is at most t (the first where none is), and the next. */
static rounding bracket_value(const mt_catalogue_search *d, const mt_choice *own, double t)
{
    const int i = own->first;
    int at = 0;
    while (at + 1 < own->n_rows && mt_problem_t(d->p, i, own->value[at + 1]) <= t) {
        at++;
    }
    rounding r = {at, at, 0.0};
    if (at + 1 < own->n_rows) {
        const double low = mt_problem_t(d->p, i, own->value[at]);
        const double high = mt_problem_t(d->p, i, own->value[at + 1]);
        r.high = at + 1;
        r.part = fmin(fmax((t - low) / (high - low), 0.0), 1.0);
    }
    return r;
}

/* Distance of a row from t[own->n], each variable in parts of what its catalogue spans. */
static double row_distance(const mt_catalogue_search *d, const mt_choice *own, int row,
                           const double *t)
{
    const double *const value = mt_choice_row(own, row);
    double sum = 0.0;
    for (int j = 0; j < own->n; j++) {
        const int i = own->first + j;
        const mt_variable *const v = &d->p->study->variables[i];
        const double span = mt_problem_t(d->p, i, v->catalogue[v->n_catalogue - 1]) -
                            mt_problem_t(d->p, i, v->catalogue[0]);
        const double away = mt_problem_t(d->p, i, value[j]) - t[j];
        sum += span > 0.0 ? (away / span) * (away / span) : 0.0;
    }
    return sqrt(sum);
}

/* The nearest row and the second nearest, the first of equal ones. */
static rounding bracket_row(const mt_catalogue_search *d, const mt_choice *own, const double *t)
{
    rounding r = {0, 0, 0.0};
    double nearest = HUGE_VAL;
    double second = HUGE_VAL;
    for (int i = 0; i < own->n_rows; i++) {
        const double here = row_distance(d, own, i, t);
        if (here < nearest) {
            r.high = nearest < HUGE_VAL ? r.low : i;
            second = nearest;
            r.low = i;
            nearest = here;
        } else if (here < second) {
            second = here;
            r.high = i;
        }
    }
    r.part = second > 0.0 && second < HUGE_VAL ? nearest / (nearest + second) : 0.0;
    return r;
}

static rounding bracket(const mt_catalogue_search *d, int k, const double *t)
{
    const mt_choice *const own = &d->choice[k];
    return own->n == 1 ? bracket_value(d, own, t[own->first])
                       : bracket_row(d, own, t + own->first);
}

/* The choices whose t lies nearest to the middle of two rows: open[most]. */
static void choose_undecided(int n, const rounding *to, int most, int *open)
{
    for (int b = 0; b < most; b++) {
        double least = HUGE_VAL;
        for (int k = 0; k < n; k++) {
            bool taken = false;
            for (int c = 0; c < b; c++) {
                taken = taken || open[c] == k;
            }
            if (!taken && fabs(to[k].part - 0.5) < least) {
                least = fabs(to[k].part - 0.5);
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
    rounding *const to = mt_arena_alloc(d->mem, (size_t)n, sizeof *to);
    int *const pick = mt_arena_int(d->mem, (size_t)n);
    int *const open = mt_arena_int(d->mem, (size_t)most);
    MT_TRY(mt_arena_check(d->mem, err));
    for (int k = 0; k < n; k++) {
        to[k] = bracket(d, k, t);
    }
    choose_undecided(n, to, both, open);
    for (int way = 0; way < 1 << both; way++) {
        for (int k = 0; k < n; k++) {
            pick[k] = to[k].part > 0.5 ? to[k].high : to[k].low;
        }
        for (int b = 0; b < both; b++) {
            const rounding *const r = &to[open[b]];
            pick[open[b]] = ((way >> b) & 1) != 0 ? r->high : r->low;
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

/* The choice that sets the i-th of the discrete variables. */
static int choice_of(const mt_catalogue_search *d, int i, int *column)
{
    int k = 0;
    while (i >= d->choice[k].n) {
        i -= d->choice[k++].n;
    }
    *column = i;
    return k;
}

/* The row nearest to `row` among those in which this column is less (by -1) or greater;
 * MT_ABSENT: there is none. */
static int next_row(const mt_catalogue_search *d, const mt_choice *own, int column, int by,
                    int row)
{
    double t[MT_MAX_ROW_VARIABLES];
    const double *const from = mt_choice_row(own, row);
    int best = MT_ABSENT;
    double least = HUGE_VAL;
    for (int j = 0; j < own->n; j++) {
        t[j] = mt_problem_t(d->p, own->first + j, from[j]);
    }
    for (int i = 0; i < own->n_rows; i++) {
        const double change = mt_choice_row(own, i)[column] - from[column];
        const double here = change * by > 0.0 ? row_distance(d, own, i, t) : HUGE_VAL;
        if (here < least) {
            least = here;
            best = i;
        }
    }
    return best;
}

/* Step the choice of the i-th discrete variable to a neighbour along that variable; false at
 * an end of its catalogue. *k: the choice. */
static bool step_catalogue_value(const walk *w, int i, int by, int *pick, int *k)
{
    int column = 0;
    *k = choice_of(w->d, i, &column);
    const mt_choice *const own = &w->d->choice[*k];
    const int to = own->n == 1 ? pick[*k] + by : next_row(w->d, own, column, by, pick[*k]);
    if (to < 0 || to >= own->n_rows) {
        return false;
    }
    pick[*k] = to;
    return true;
}

static void propose_neighbours(walk *w, const mt_combination *c, int *pick)
{
    const int n = w->d->n_set;
    const size_t size = (size_t)w->d->n_listed * sizeof *pick;
    const bool pairs = !w->d->mixed && n <= PAIRS_OF_AT_MOST;
    for (int way = 0; way < 2 * n; way++) {
        int k = 0;
        memcpy(pick, c->pick, size);
        if (!step_catalogue_value(w, way / 2, way % 2 == 0 ? -1 : 1, pick, &k)) {
            continue;
        }
        propose(w, pick);
        for (int other = 0; other < way - (way % 2) && pairs; other++) {
            const int column = other / 2;
            int before[2] = {choice_of(w->d, column, &(int){0}), 0};
            before[1] = pick[before[0]];
            if (step_catalogue_value(w, column, other % 2 == 0 ? -1 : 1, pick, &k)) {
                propose(w, pick);
            }
            pick[before[0]] = before[1];
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
    const int size = d->n_set;
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
