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

#include <math.h>
#include <string.h>

#include "nlp/merit.h"

/* Searches between two looks at what is left to do. */
enum { BATCH = 16 };
/* Starts of all those that may be listed and have no design so far, together, and of each at
 * least; of each that has one that is nearly listed. */
enum { STARTS_TOGETHER = 72, STARTS_LEAST = 3, STARTS_LISTED = 24 };
/* A design beyond this multiple of the last one's objective has hardly a better one beside it
 * in its assignment: the change is a root of it. */
static const double NEAR_LAST = 1.5;

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
        }
        mt_arena_free(&later.slots[i].mem);
    }
    return rc;
}

/* Searches the candidates that may be listed, feasible or not, with that many starts. */
static mt_status search_listed(mt_mode_placement_job *j, bool met, double last, int n_workers,
                               mt_arena *mem, mt_err *err)
{
    again a;
    MT_TRY(allocate_repeated_searches(j, mem, &a, err));
    for (int k = 0; k < j->searched; k++) {
        const mt_mode_placement_slot *const s = &j->slots[k];
        if (j->candidates->least[k] <= last && mt_mode_placement_is_met(s) == met &&
            (!met || first_of(s) <= NEAR_LAST * last)) {
            add_candidate(j, k, nearest(j, k), &a);
        }
    }
    a.skip = 1;
    const int share = a.n > 0 ? STARTS_TOGETHER / a.n : 0;
    const int least = share > STARTS_LEAST ? share : STARTS_LEAST;
    const int starts = met ? STARTS_LISTED : least;
    return search_again(j, &a, starts, n_workers, mem, err);
}

mt_status mt_mode_placement_search_best(mt_mode_placement_job *j, int n_workers, int asked,
                                        mt_arena *mem, double *last, mt_err *err)
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
        j->from = j->searched;
        rc = search_candidates(j, left < BATCH ? left : BATCH, n_workers, err);
        j->searched += left < BATCH ? left : BATCH;
        *last = last_of(j, asked);
    }
    j->options.starts = starts;
    j->options.no_compromise = false;
    j->few = false;
    j->from = 0;
    MT_TRY(rc);
    for (int met = 0; met < 2 && few && *last < HUGE_VAL; met++) {
        MT_TRY(search_listed(j, met == 1, *last, n_workers, mem, err));
        *last = last_of(j, asked);
    }
    return MT_OK;
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
