/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Best first. A study asks for so many designs of least change; an assignment whose designs all
 * change more than the last of these needs no search. Bounds (mode_placements_bounds.h) are far
 * below what most assignments take, and most that are searched have no design or a bad one:
 * each begins with one start, at the original, and those that may be listed have more, of which
 * the next is the nearest design that is known. What is searched follows from what came before
 * in whole batches, so that any number of workers searches the same.
 */
#include "search/mode_placements_priv.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nlp/merit.h"

/* Searches between two looks at what is left to do. */
enum { BATCH = 16 };
/* Starts of all those that may be listed and have no design so far, together, and of each at
 * least; no more of these than MISSED_MOST, those of the least estimates. Starts of each that
 * is listed, and of all those that are nearly listed together. */
enum {
    STARTS_TOGETHER = 72,
    STARTS_LEAST = 3,
    MISSED_MOST = 48,
    STARTS_LISTED = 24,
    STARTS_NEAR = 240
};
/* A design beyond this multiple of the last one's objective has hardly a better one beside it
 * in its assignment: the change is a root of it. */
static const double NEAR_LAST = 1.5;
/* Where bounds cannot close the list, a placement whose estimate is beyond this multiple of the
 * last one's objective (twice the change) is left out: estimates are seldom above half as much
 * again as what is found. */
static const double FAR_FROM_LAST = 4.0;

/* First objective of a feasible slot. */
static double first_of(const mt_mode_placement_slot *s)
{
    return s->stages != NULL ? s->stages[0] : s->found.solutions[0].f;
}

/* Number of feasible slots with at most this first objective. */
static int count_up_to(const mt_mode_placement_job *j, double most)
{
    int n = 0;
    for (int k = 0; k < j->searched; k++) {
        n += mt_mode_placement_is_met(&j->slots[k]) && first_of(&j->slots[k]) <= most ? 1 : 0;
    }
    return n;
}

/* The `asked`-th smallest first objective; HUGE_VAL where fewer are feasible. */
static double last_of(const mt_mode_placement_job *j, int asked)
{
    double last = HUGE_VAL;
    for (int k = 0; k < j->searched; k++) {
        const double f =
            mt_mode_placement_is_met(&j->slots[k]) ? first_of(&j->slots[k]) : HUGE_VAL;
        last = f < last && count_up_to(j, f) >= asked ? f : last;
    }
    return last;
}

static mt_status search_candidates(mt_mode_placement_job *j, int n, int n_workers, mt_err *err)
{
    const mt_tasks tasks = {n, mt_mode_placement_search_candidate, NULL, j, "mode placements"};
    return mt_workers_run(n_workers, j->workers[0]->task_path, &tasks, err);
}

static int distance(const int *a, const int *b, int n)
{
    int sum = 0;
    for (int i = 0; i < n; i++) {
        sum += a[i] > b[i] ? a[i] - b[i] : b[i] - a[i];
    }
    return sum;
}

/* The design of the nearest feasible candidate, of equally near ones the least; NULL: none. */
static const double *nearest(const mt_mode_placement_job *j, int k)
{
    const int m = j->p->n_bands;
    const int *const own = j->candidates->below + ((ptrdiff_t)k * m);
    int best = -1;
    int least = 0;
    for (int i = 0; i < j->searched; i++) {
        if (i == k || !mt_mode_placement_is_met(&j->slots[i])) {
            continue;
        }
        const int d = distance(own, j->candidates->below + ((ptrdiff_t)i * m), m);
        if (best < 0 || d < least ||
            (d == least && first_of(&j->slots[i]) < first_of(&j->slots[best]))) {
            best = i;
            least = d;
        }
    }
    return best < 0 ? NULL : j->slots[best].found.solutions[0].t;
}

/* True where the later search of the same candidate is the better one. */
static bool is_better(const mt_mode_placement_job *j, const mt_mode_placement_slot *later,
                      const mt_mode_placement_slot *before)
{
    if (later->found.n_solutions == 0 || before->found.n_solutions == 0) {
        return before->found.n_solutions == 0 && later->found.n_solutions > 0;
    }
    const mt_nlp_solution *const a = &later->found.solutions[0];
    const mt_nlp_solution *const b = &before->found.solutions[0];
    const double *const x = later->stages != NULL ? later->stages : &a->f;
    const double *const y = before->stages != NULL ? before->stages : &b->f;
    const int n = later->stages != NULL && before->stages != NULL ? j->c->n_stages : 1;
    const mt_merit first = {a->feasible, a->squares, n, x};
    const mt_merit second = {b->feasible, b->squares, n, y};
    return mt_merit_before(&first, &second, MT_EQUAL_FOUND);
}

/* Of two searches of one candidate the better one, with the work of both. */
static void merge_candidate_searches(const mt_mode_placement_job *j,
                                     mt_mode_placement_slot *kept,
                                     mt_mode_placement_slot *later)
{
    const long evals = kept->evals + later->evals;
    const int starts = kept->starts + later->starts;
    if (is_better(j, later, kept)) {
        const long before = kept->evals;
        mt_arena_free(&kept->mem);
        *kept = *later;
        kept->begun += before;
    } else {
        mt_arena_free(&later->mem);
    }
    later->mem = (mt_arena){.first = NULL};
    kept->evals = evals;
    kept->starts = starts;
}

/* Candidates that are searched once more. */
typedef struct again {
    int n;
    int *place; /* [n] among all */
    int skip;   /* starts that they have had already */
    mt_mode_placement_candidates rows;
} again;

static mt_status allocate_repeated_searches(const mt_mode_placement_job *j, mt_arena *mem,
                                            again *a, mt_err *err)
{
    const size_t n = (size_t)j->searched;
    *a = (again){.place = mt_arena_int(mem, n)};
    a->rows.below = mt_arena_int(mem, n * (size_t)j->p->n_bands);
    a->rows.at = mt_arena_f64(mem, (size_t)j->p->n, n);
    return mt_arena_check(mem, err);
}

/* Candidate k, from `at` (NULL: from nowhere in particular). */
static void add_candidate(const mt_mode_placement_job *j, int k, const double *at, again *a)
{
    const size_t m = (size_t)j->p->n_bands;
    const size_t n = (size_t)j->p->n;
    double *const to = a->rows.at + ((size_t)a->n * n);
    memcpy(a->rows.below + ((size_t)a->n * m), j->candidates->below + ((size_t)k * m),
           m * sizeof *a->rows.below);
    for (size_t i = 0; i < n; i++) {
        to[i] = at != NULL ? at[i] : nan("");
    }
    a->place[a->n++] = k;
    a->rows.n = a->n;
}

static mt_status search_again(mt_mode_placement_job *j, again *a, int starts, int n_workers,
                              mt_arena *mem, mt_err *err)
{
    mt_mode_placement_job later = *j;
    later.candidates = &a->rows;
    later.from = 0;
    later.most = a->n;
    later.options.starts = starts < j->options.starts ? starts : j->options.starts;
    later.options.skip = a->skip;
    later.options.no_compromise = later.options.starts < j->options.starts;
    later.few = later.options.starts < j->options.starts;
    later.slots = mt_arena_alloc(mem, (size_t)a->n, sizeof *later.slots);
    MT_TRY(mt_arena_check(mem, err));
    const mt_status rc = a->n > 0 ? search_candidates(&later, a->n, n_workers, err) : MT_OK;
    for (int i = 0; i < a->n; i++) {
        if (rc == MT_OK) {
            merge_candidate_searches(j, &j->slots[a->place[i]], &later.slots[i]);
            j->slots[a->place[i]].carried = false;
        }
        mt_arena_free(&later.slots[i].mem);
    }
    return rc;
}

/* Starts of each of n, of so many together. */
static int share_starts(int together, int n)
{
    const int share = n > 0 ? together / n : 0;
    return share < STARTS_LEAST ? STARTS_LEAST : share < STARTS_LISTED ? share : STARTS_LISTED;
}

static int compare_estimates(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return x < y ? -1 : x > y ? 1 : 0;
}

/* True where candidate k has no design and may be listed. */
static bool is_missed(const mt_mode_placement_job *j, int k, double last)
{
    return j->candidates->least[k] <= last && !mt_mode_placement_is_met(&j->slots[k]) &&
           !j->slots[k].carried;
}

/* The estimate up to which those without a design are searched again. */
static mt_status find_missed_limit(const mt_mode_placement_job *j, double last, mt_arena *mem,
                                   double *limit, mt_err *err)
{
    double *const list = mt_arena_f64(mem, (size_t)j->searched, 1);
    int n = 0;
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < j->searched; k++) {
        if (is_missed(j, k, last)) {
            list[n++] = j->candidates->estimate[k];
        }
    }
    *limit = HUGE_VAL;
    if (n > MISSED_MOST) {
        qsort(list, (size_t)n, sizeof *list, compare_estimates);
        *limit = list[MISSED_MOST - 1];
    }
    return MT_OK;
}

/* Searches once more those that may be listed and have no design. */
static mt_status search_missed(mt_mode_placement_job *j, double last, int n_workers,
                               mt_arena *mem, mt_err *err)
{
    again a;
    double limit = HUGE_VAL;
    MT_TRY(allocate_repeated_searches(j, mem, &a, err));
    MT_TRY(find_missed_limit(j, last, mem, &limit, err));
    for (int k = 0; k < j->searched; k++) {
        if (is_missed(j, k, last) && j->candidates->estimate[k] <= limit) {
            add_candidate(j, k, nearest(j, k), &a);
        }
    }
    a.skip = 1;
    return search_again(j, &a, share_starts(STARTS_TOGETHER, a.n), n_workers, mem, err);
}

/* Searches once more those whose first objective is up to `most`; `skip` starts they had.
 * together: starts of all; *starts: those that each has had now. */
static mt_status search_near(mt_mode_placement_job *j, double most, int skip, int together,
                             int n_workers, mt_arena *mem, int *starts, mt_err *err)
{
    again a;
    MT_TRY(allocate_repeated_searches(j, mem, &a, err));
    for (int k = 0; k < j->searched; k++) {
        const mt_mode_placement_slot *const s = &j->slots[k];
        if (mt_mode_placement_is_met(s) && first_of(s) <= most) {
            add_candidate(j, k, nearest(j, k), &a);
        }
    }
    a.skip = skip;
    *starts = share_starts(together, a.n);
    return search_again(j, &a, *starts, n_workers, mem, err);
}

/* Searches once more what may be listed, where each has had one start. */
static mt_status search_listed(mt_mode_placement_job *j, int asked, int n_workers,
                               mt_arena *mem, double *last, mt_err *err)
{
    int starts = 0;
    MT_TRY(search_missed(j, *last, n_workers, mem, err));
    *last = last_of(j, asked);
    MT_TRY(search_near(j, NEAR_LAST * *last, 1, STARTS_NEAR, n_workers, mem, &starts, err));
    *last = last_of(j, asked);
    if (starts < STARTS_LISTED) {
        MT_TRY(search_near(j, *last, starts, INT_MAX, n_workers, mem, &starts, err));
        *last = last_of(j, asked);
    }
    return MT_OK;
}

/* Leaves those of the next n out whose estimate is above `most`. */
static void leave_out(mt_mode_placement_job *j, int n, double most)
{
    for (int k = j->from; k < j->from + n; k++) {
        j->slots[k].carried = j->candidates->estimate[k] > most;
    }
}

/* Searches what was left out and may be listed, where that is all that may be. */
static mt_status search_left_out(mt_mode_placement_job *j, double last, int n_workers,
                                 mt_arena *mem, mt_err *err)
{
    again a;
    MT_TRY(allocate_repeated_searches(j, mem, &a, err));
    for (int k = 0; k < j->searched; k++) {
        if (mt_mode_placement_is_left_out(j, k) && j->candidates->least[k] <= last) {
            add_candidate(j, k, NULL, &a);
        }
    }
    return search_again(j, &a, 1, n_workers, mem, err);
}

mt_status mt_mode_placement_search_best(mt_mode_placement_job *j, int n_workers, int asked,
                                        double rest, mt_arena *mem, double *last, mt_err *err)
{
    const int starts = j->options.starts;
    const int n = j->candidates->n;
    mt_interrupt *const interrupt = j->p->run->interrupt;
    const bool few = starts > 1;
    *last = HUGE_VAL;
    j->most = n;
    j->options.starts = few ? 1 : starts;
    j->options.no_compromise = few;
    j->few = few;
    mt_status rc = MT_OK;
    while (rc == MT_OK && j->searched < n && !mt_interrupted(interrupt) &&
           j->candidates->least[j->searched] <= *last) {
        const int left = n - j->searched;
        const int batch = left < BATCH ? left : BATCH;
        j->from = j->searched;
        leave_out(j, batch, rest <= *last ? FAR_FROM_LAST * *last : HUGE_VAL);
        rc = search_candidates(j, batch, n_workers, err);
        j->searched += batch;
        *last = last_of(j, asked);
    }
    j->options.starts = starts;
    j->options.no_compromise = false;
    j->few = false;
    j->from = 0;
    MT_TRY(rc);
    if (rest > *last) {
        MT_TRY(search_left_out(j, *last, n_workers, mem, err));
        *last = last_of(j, asked);
    }
    return few && *last < HUGE_VAL ? search_listed(j, asked, n_workers, mem, last, err) : MT_OK;
}

mt_status mt_mode_placement_search_known(mt_mode_placement_job *j, int n_workers,
                                         const mt_mode_placement_candidates *known,
                                         mt_arena *mem, mt_err *err)
{
    const int m = j->p->n_bands;
    again a;
    MT_TRY(allocate_repeated_searches(j, mem, &a, err));
    for (int k = 0; k < j->searched; k++) {
        const int *const own = j->candidates->below + ((ptrdiff_t)k * m);
        const int at = mt_certify_index_of(known->below, known->n_proven, own, m);
        if (!mt_mode_placement_is_met(&j->slots[k]) && at < known->n_proven) {
            add_candidate(j, k, known->at + ((ptrdiff_t)at * j->p->n), &a);
        }
    }
    return search_again(j, &a, j->options.starts, n_workers, mem, err);
}
