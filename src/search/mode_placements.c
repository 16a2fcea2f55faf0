/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gap assignments: which are worth a search, which are searched first, and what came of
 * them. */
#include "search/mode_placements.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/run.h"
#include "base/workers.h"
#include "nlp/merit.h"
#include "nlp/nlp.h"
#include "problem/avoidance.h"
#include "problem/configuration.h"
#include "problem/drive_positions.h"
#include "problem/evaluate.h"
#include "problem/tolerance_cut.h"
#include "search/drive_path.h"
#include "search/mode_placements_bounds.h"
#include "search/mode_placements_search.h"
#include "search/proof.h"
#include "search/search.h"

/* Solutions of a search, kept beyond it. */

/* A copy in mem of a solution with placement below[n_bands],
 * independent of its search's memory. Fails: MT_E_MEMORY. */
static mt_status mode_placement_copy(const mt_subproblem *c, const int *below,
                                     const mt_nlp_solution *from, mt_arena *mem,
                                     const mt_nlp_solution **out, mt_err *err)
{
    const mt_problem *const p = c->p;
    const size_t n_eq = (size_t)c->rows.eq.n;
    size_t n_in = (size_t)c->rows.in.n;
    mt_row row;
    mt_avoidance_rows rows = {.c = c, .below = below};
    while (mt_avoidance_next_row(&rows, &row)) {
        n_in++;
    }
    const size_t n = (size_t)p->n + 1;
    mt_nlp_solution *const s = mt_arena_alloc(mem, 1, sizeof *s);
    double *const t = mt_arena_f64(mem, n, 1);
    int *const bound = mt_arena_int(mem, n);
    double *const mult = mt_arena_f64(mem, n, 1);
    double *const mult_eq = mt_arena_f64(mem, n_eq, 1);
    double *const mult_in = mt_arena_f64(mem, n_in, 1);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(t, from->t, (size_t)p->n * sizeof *t);
    memcpy(bound, from->bound, (size_t)p->n * sizeof *bound);
    memcpy(mult, from->mult_bound, (size_t)p->n * sizeof *mult);
    if (n_eq > 0) {
        memcpy(mult_eq, from->mult_eq, n_eq * sizeof *mult_eq);
    }
    if (n_in > 0) {
        memcpy(mult_in, from->mult_in, n_in * sizeof *mult_in);
    }
    *s = *from;
    s->t = t;
    s->bound = bound;
    s->mult_bound = mult;
    s->mult_eq = mult_eq;
    s->mult_in = mult_in;
    *out = s;
    return MT_OK;
}

/* Copies s->held to mem. Fails: MT_E_MEMORY. */
static mt_status mode_placement_copy_held(mt_arena *mem, mt_mode_placement_solution *s,
                                          mt_err *err)
{
    mt_mode_placement_held *const held = mt_arena_alloc(mem, (size_t)s->n_held, sizeof *held);
    MT_TRY(mt_arena_check(mem, err));
    if (s->n_held > 0) {
        memcpy(held, s->held, (size_t)s->n_held * sizeof *held);
    }
    s->held = held;
    return MT_OK;
}

/*
 * Which gap assignments are worth a search, first and in all. Where the modes can be
 * enclosed (proof.h), branch and bound over the bounds finds every assignment that some
 * design has, with such a design, and proves that there is no other. Elsewhere, sampled:
 * designs spread over the bounds; each says how many modes lie below the middle of each
 * band, and its assignment becomes a candidate. A design clear of all bands has the same
 * assignment as the samples around it, so a kind of design is only missed where it is
 * smaller than the samples are apart. That is labelled as sampled. What stands in the way of
 * an enclosure may be held at samples, each proven in the other variables (proof.h).
 */

enum {
    SAMPLES_PER_VARIABLE = 256,
    SAMPLES_MOST = 4096,
    /* after a part of them, when each assignment that was met has been met so often: one that
     * was not is much rarer than the rarest that was */
    SAMPLES_PART = 5,
    MET_OFTEN = 8,
    CANDIDATES_MOST = 256,
    SAMPLES_FIRST = 32,
    EVALUATIONS_LEAST = 30 /* of a candidate's search, or it is not worth one */
};
/* Of a proof before the first search: tens of milliseconds. Most are settled by then, and what
 * is hopeless is told at once. A quarter of it, where candidates come best first. */
static const double FIRST_WORK = 2e8;
static const double BEST_FIRST_WORK = 5e7;
/* Of a smaller budget, so that the proof after it has more. */
static const double FIRST_SHARE = 0.04;
/* The rest of it is spent later, where no more than this share of the designs is undecided. */
static const double NEARLY_SETTLED = 0.5;

/* Of what a proof has a design for: less than of any sample. */
static const double KNOWN = -HUGE_VAL;

typedef struct sampled {
    int *below;
    double violation;
    int met;          /* so many samples have it */
    const double *at; /* [n] a design of a slice; NULL */
} sampled;

static int compare_below(const int *a, const int *b, int n)
{
    for (int i = 0; i < n; i++) {
        if (a[i] != b[i]) {
            return a[i] < b[i] ? -1 : 1;
        }
    }
    return 0;
}

mt_status mt_mode_placement_assignment(mt_workspace *w, const double *t, int *below,
                                       double *violation, mt_err *err)
{
    mt_subproblem_x(w->c, t, w->x);
    *violation = 0.0;
    for (int i = 0; i < w->c->n_avoidances; i++) {
        const mt_avoidance *const c = &w->c->avoidances[i];
        mt_analysis *const a = w->views[c->view].analysis;
        mt_analysis_options opt = {.accuracy = 0.0};
        mt_err own = {0};
        mt_avoidances_query(&w->p->whole, c->view, &opt.shapes);
        const mt_status rc = mt_analysis_solve(a, w->x, &opt, &own);
        if (rc != MT_OK) {
            *violation = nan("");
            return mt_pass_final(rc, &own, err);
        }
        const double v = mt_short_of(mt_avoidance_find_modes(c, &a->modes, below + c->first));
        *violation = !(v <= *violation) ? v : *violation;
    }
    return MT_OK;
}

/* Insert into the sorted list, keeping the least violation of equal ones. at: a design t[n] to
 * start from, which stays; NULL: none. */
static void insert(const mt_problem *p, sampled *list, int *n, const int *below,
                   double violation, const double *at_t)
{
    int at = 0;
    while (at < *n && compare_below(list[at].below, below, p->n_bands) < 0) {
        at++;
    }
    if (at < *n && compare_below(list[at].below, below, p->n_bands) == 0) {
        list[at].violation = fmin(list[at].violation, violation);
        list[at].met++;
        return;
    }
    int victim = *n; /* where the list is full, the least promising makes room */
    if (*n == CANDIDATES_MOST) {
        victim = 0;
        for (int i = 1; i < *n; i++) {
            victim = list[i].violation > list[victim].violation ? i : victim;
        }
        if (list[victim].violation <= violation) {
            return;
        }
    } else {
        (*n)++;
    }
    const sampled fresh = {list[victim].below, violation, 1, at_t};
    if (victim < at) {
        at--;
        memmove(&list[victim], &list[victim + 1], (size_t)(at - victim) * sizeof *list);
    } else {
        memmove(&list[at + 1], &list[at], (size_t)(victim - at) * sizeof *list);
    }
    list[at] = fresh;
    memcpy(list[at].below, below, (size_t)p->n_bands * sizeof *below);
}

/* True where avoidance goal i is tied to an earlier one. */
static bool tied_before(const mt_problem *p, int i)
{
    for (int b = 0; b < p->avoidances[i].bands.n; b++) {
        if (p->tie[p->avoidances[i].first + b] < p->avoidances[i].first) {
            return true;
        }
    }
    return false;
}

/* Bands of avoidance goal i and of those tied to it, each set of tied bands once. */
static int count_ties(const mt_problem *p, int i)
{
    const int drive_positions = mt_drive_positions_of(p, p->avoidances[i].view);
    int m = 0;
    for (int c = i; c < p->n_avoidances; c++) {
        const bool own =
            c == i || (drive_positions >= 0 && tied_before(p, c) &&
                       mt_drive_positions_of(p, p->avoidances[c].view) == drive_positions);
        for (int b = 0; own && b < p->avoidances[c].bands.n; b++) {
            const int band = p->avoidances[c].first + b;
            m += p->tie[band] == band ? 1 : 0;
        }
    }
    return m;
}

double mt_mode_placement_count_possible(const mt_problem *p)
{
    double all = 1.0;
    for (int i = 0; i < p->n_avoidances; i++) {
        const int n = mt_configuration_vibrations(&p->views[p->avoidances[i].view]);
        const int m = tied_before(p, i) ? 0 : count_ties(p, i);
        for (int k = 1; k <= m; k++) {
            all *= (double)(n + k) / (double)k;
        }
    }
    return round(all);
}

/* Keeps the `most` placements of least violation, in order; the others are not needed again. */
static int keep_nearest(const sampled *list, int n, int most, bool *kept)
{
    int count = 0;
    for (int i = 0; i < n; i++) {
        int ahead = 0;
        for (int k = 0; k < n; k++) {
            const bool less = list[k].violation < list[i].violation;
            ahead += less || (k < i && list[k].violation == list[i].violation) ? 1 : 0;
        }
        kept[i] = ahead < most;
        count += kept[i] ? 1 : 0;
    }
    return count;
}

/* A sample whose counts differ between two positions of one drive is no placement; the
 * neighbouring placements have the least and the greatest of these counts throughout. */
static void insert_agreeing(const mt_workspace *w, sampled *list, int *n, const int *below,
                            double violation, int *work)
{
    const mt_problem *const p = w->p;
    const size_t size = (size_t)p->n_bands * sizeof *below;
    if (mt_ties_agree(p, below)) {
        insert(p, list, n, below, violation, NULL);
        return;
    }
    for (int most = 0; most < 2; most++) {
        memcpy(work, below, size);
        mt_ties_settle(p, most == 1, work);
        insert(p, list, n, work, mt_ties_violation(w, work), NULL);
    }
}

static int least_of(int a, long b)
{
    return b < a ? (int)b : a;
}

/* Rows of the placements kept, and the starts of their searches. */
static mt_status keep_placements(const mt_problem *p, const sampled *list, const bool *kept,
                                 mt_arena *mem, mt_mode_placement_candidates *out, mt_err *err)
{
    const size_t row = (size_t)p->n_bands;
    const size_t n = (size_t)p->n;
    out->below = mt_arena_int(mem, (size_t)out->n * row);
    out->at = mt_arena_f64(mem, n, (size_t)out->n);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0, k = 0; k < out->n; i++) {
        if (!kept[i]) {
            continue;
        }
        memcpy(out->below + ((size_t)k * row), list[i].below, row * sizeof *out->below);
        for (size_t j = 0; j < n; j++) {
            out->at[((size_t)k * n) + j] = list[i].at == NULL ? nan("") : list[i].at[j];
        }
        k++;
    }
    return MT_OK;
}

/* True where every placement met, except those of sampled geometries, was met often. */
static bool all_met_often(const sampled *list, int n)
{
    bool often = n > 0;
    for (int i = 0; i < n; i++) {
        often = often && (list[i].met >= MET_OFTEN || list[i].violation == KNOWN);
    }
    return often;
}

/* Placements of n designs spread over the bounds, and those of sampled geometries, at most
 * `most`. Under a budget of evaluations half of it is for samples and half for the searches of
 * the nearest. */
static mt_status sample_placements(mt_workspace *w, int n, int most, long spent,
                                   const mt_sampled_bounds *sampled_bounds, mt_arena *mem,
                                   mt_mode_placement_candidates *out, mt_err *err)
{
    const mt_problem *const p = w->p;
    const long most_evals = w->c->search.max_evaluations;
    const long left = (most_evals - spent) / 2;
    const long half = most_evals <= 0 ? 0 : left > 1 ? left : 1;
    mt_nlp nlp = mt_workspace_nlp(w);
    nlp.n = p->n;
    n = half > 0 ? least_of(n, half) : n;
    most = half > 0 ? least_of(most, 1 + (half / EVALUATIONS_LEAST)) : most;
    sampled *const list = mt_arena_alloc(mem, CANDIDATES_MOST, sizeof *list);
    int *const below = mt_arena_int(mem, (size_t)p->n_bands);
    int *const work = mt_arena_int(mem, (size_t)p->n_bands);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < CANDIDATES_MOST; i++) {
        list[i].below = mt_arena_int(mem, (size_t)p->n_bands);
        MT_TRY(mt_arena_check(mem, err));
    }
    for (int k = 0; k < sampled_bounds->n_found; k++) {
        insert(p, list, &out->n, sampled_bounds->found + ((ptrdiff_t)k * p->n_bands), KNOWN,
               sampled_bounds->at + ((ptrdiff_t)k * p->n));
    }
    const double *const t = mt_nlp_starts(&nlp, w->c->search.seed, n, mem);
    mt_status rc = mt_arena_check(mem, err);
    bool enough = false; /* nothing comes nearer than a design that is clear */
    for (int k = 0; rc == MT_OK && k < n && !enough; k++) {
        double violation = 0.0;
        if (mt_interrupted(p->run->interrupt)) {
            break;
        }
        rc = mt_mode_placement_assignment(w, t + ((ptrdiff_t)k * p->n), below, &violation, err);
        if (rc == MT_OK && MT_HAS(violation)) {
            insert_agreeing(w, list, &out->n, below, violation, work);
            enough = most == 1 && violation <= 0.0 && mt_ties_agree(p, below);
        }
        enough = enough || (k + 1 >= n / SAMPLES_PART && k + 1 >= SAMPLES_PER_VARIABLE &&
                            all_met_often(list, out->n));
        out->evals++;
        mt_work_counters_note(p->run->work, MT_WORK_DESIGNS, 1);
        mt_problem_note_modal(p, w->c->n_avoidances);
    }
    MT_TRY(rc);
    bool kept[CANDIDATES_MOST] = {false};
    const int n_found = out->n;
    out->n = keep_nearest(list, n_found, most, kept);
    return keep_placements(p, list, kept, mem, out, err);
}

/* Placements that branch and bound found feasible, each with a design, and those left open when
 * its budget ended. */
static mt_status keep_proven(const mt_problem *p, const mt_certify_search *found, mt_arena *mem,
                             mt_mode_placement_candidates *out, mt_err *err)
{
    const size_t row = (size_t)p->n_bands;
    const int n = found->n_found + found->n_open;
    out->below = mt_arena_int(mem, (size_t)n * row);
    out->at = mt_arena_f64(mem, (size_t)p->n, (size_t)n);
    MT_TRY(mt_arena_check(mem, err));
    if (found->n_found > 0) {
        memcpy(out->below, found->found, (size_t)found->n_found * row * sizeof *out->below);
    }
    if (found->n_open > 0) {
        memcpy(out->below + ((ptrdiff_t)found->n_found * p->n_bands), found->open,
               (size_t)found->n_open * row * sizeof *out->below);
    }
    for (int k = 0; k < n; k++) {
        for (int i = 0; i < p->n; i++) {
            const double x =
                k < found->n_found ? found->at[i + ((ptrdiff_t)k * p->n)] : p->original[i];
            out->at[i + ((ptrdiff_t)k * p->n)] = mt_problem_t(p, i, x);
        }
    }
    out->n = n;
    out->n_proven = found->n_found;
    out->proven = found->proven;
    out->boxes = found->boxes;
    out->undecided = found->undecided;
    out->all = !found->more && !found->stopped;
    out->reason =
        found->proven
            ? NULL
            : mt_arena_printf(mem,
                              "the budget of the proof ended after %ld boxes, with %.3g %% "
                              "of the designs within the bounds undecided",
                              found->boxes, 100.0 * found->undecided);
    return mt_arena_check(mem, err);
}

/* Result of the proof with this much work. */
static mt_status prove(const mt_workspace *w, mt_proof *proof, double work, mt_arena *mem,
                       mt_mode_placement_candidates *out, mt_err *err)
{
    mt_certify_search found = {0};
    MT_TRY(mt_proof_query(proof, work, mem, &found, err));
    return keep_proven(w->p, &found, mem, out, err);
}

static const mt_sampled_bounds no_sampled_bounds = {.n = 0};

/*
 * Candidates to search before a proof. Where a small part of the proof's work settles the
 * question, the result is `all` (proven) and `first` is empty; else `first` has the placements
 * met, or the one that a few samples come nearest to. A quarter of that part where candidates
 * come best first. proof: of w's subproblem.
 */
static mt_status mode_placement_candidates_first(mt_workspace *w, mt_proof *proof,
                                                 bool best_first, mt_arena *mem,
                                                 mt_mode_placement_candidates *all,
                                                 mt_mode_placement_candidates *first,
                                                 mt_err *err)
{
    *all = (mt_mode_placement_candidates){.possible = mt_mode_placement_count_possible(w->p)};
    *first = (mt_mode_placement_candidates){.possible = all->possible};
    if (proof->possible) {
        const double first_work = best_first ? BEST_FIRST_WORK : FIRST_WORK;
        const double most = fmin(first_work, FIRST_SHARE * w->c->proof_work);
        MT_TRY(prove(w, proof, most, mem, all, err));
    }
    if (all->proven) {
        return MT_OK;
    }
    *first = *all;
    first->n = all->n_proven;
    return first->n > 0
               ? MT_OK
               : sample_placements(w, SAMPLES_FIRST, 1, 0, &no_sampled_bounds, mem, first, err);
}

/* Continue the proof a little where it is nearly settled, once the requested designs are
 * known. */
static mt_status mode_placement_candidates_settle(mt_workspace *w, mt_proof *proof,
                                                  mt_arena *mem,
                                                  mt_mode_placement_candidates *all,
                                                  mt_err *err)
{
    return all->undecided <= NEARLY_SETTLED
               ? prove(w, proof, FIRST_WORK - BEST_FIRST_WORK, mem, all, err)
               : MT_OK;
}

/* Use the designs that `met` has for rows of c as starts of their searches. */
static void mode_placement_candidates_start(const mt_mode_placement_candidates *met,
                                            const mt_problem *p,
                                            mt_mode_placement_candidates *c)
{
    for (int k = 0; k < met->n && met->at != NULL; k++) {
        const int *const own = met->below + ((ptrdiff_t)k * p->n_bands);
        const int at = mt_certify_index_of(c->below, c->n, own, p->n_bands);
        if (at < c->n) {
            memcpy(c->at + ((ptrdiff_t)at * p->n), met->at + ((ptrdiff_t)k * p->n),
                   (size_t)p->n * sizeof *c->at);
        }
    }
}

/* Candidates with the subproblem's whole proof budget; spent: evaluations so far. */
static mt_status mode_placement_candidates_find(mt_workspace *w, mt_proof *proof, long spent,
                                                mt_arena *mem,
                                                mt_mode_placement_candidates *out, mt_err *err)
{
    *out = (mt_mode_placement_candidates){.possible = mt_mode_placement_count_possible(w->p)};
    if (proof->possible) {
        MT_TRY(prove(w, proof, w->c->proof_work, mem, out, err)); /* all that is left */
    }
    if (proof->possible && (out->proven || out->n > 0)) {
        return MT_OK;
    }
    const int wanted = SAMPLES_PER_VARIABLE * (w->p->n + 1);
    mt_sampled_bounds sampled_bounds = no_sampled_bounds;
    MT_TRY(proof->possible ? MT_OK : mt_sampled_bounds_search(w, mem, &sampled_bounds, err));
    out->reason =
        sampled_bounds.n == 0
            ? mt_arena_strdup(mem, proof->reason)
            : mt_arena_printf(mem,
                              "%s; at %d of %d samples of the geometry, held fixed, "
                              "all other placements are proven infeasible",
                              proof->reason, sampled_bounds.n_settled, sampled_bounds.n);
    return sample_placements(w, wanted < SAMPLES_MOST ? wanted : SAMPLES_MOST, CANDIDATES_MOST,
                             spent, &sampled_bounds, mem, out, err);
}

mt_status mt_mode_placement_candidates_near(mt_workspace *w, int most, long spent,
                                            mt_arena *mem, mt_mode_placement_candidates *out,
                                            mt_err *err)
{
    *out = (mt_mode_placement_candidates){.possible = mt_mode_placement_count_possible(w->p)};
    return sample_placements(w, MT_GAP_SAMPLES_NEAR, most, spent, &no_sampled_bounds, mem, out,
                             err);
}

/*
 * Best first. A study asks for so many designs of least change; an assignment whose designs all
 * change more than the last of these needs no search. Bounds (mode_placements_bounds.h) are far
 * below what most assignments take, and most that are searched have no design or a bad one:
 * each begins with one start, at the original, and those that may be listed have more, of which
 * the next is the nearest design that is known. What is searched follows from what came before
 * in whole batches, so that any number of workers searches the same.
 */

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

/*
 * Search the candidates, sorted by ascending lower bound, while one of
 * them may still be among the `asked` best designs: each from one start first, those that may
 * be listed from more. Where others, of lower bound `rest`, may be listed too, those of large
 * estimates are left out. Sets job->searched and fills the job's slots; *last: the objective
 * (change) below which a design would be listed, HUGE_VAL where the list is not full. Fails: as
 * the searches.
 */
static mt_status mode_placement_search_best(mt_mode_placement_job *j, int n_workers, int asked,
                                            double rest, mt_arena *mem, double *last,
                                            mt_err *err)
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

/* Search again, from the designs in `known` (its first n_proven rows), those candidates that
 * have no feasible design yet. */
static mt_status mode_placement_search_known(mt_mode_placement_job *j, int n_workers,
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

/*
 * Every gap assignment is a search of its own (mode_placements_search.c); here it is decided
 * which ones are searched, and what came of them is put together.
 */

enum { STARTS_PER_CANDIDATE = 24, SOLUTIONS_PER_CANDIDATE = 4, NEAREST = 6 };
/* Of the evaluations that are left, one in so many for what is searched before the proof. */
enum { FIRST_PART = 4 };
/* Candidates that are put in the order of their least changes, at most, and the work that this
 * may take, in multiplications. */
enum { LISTED_MOST = 512 };
static const double BOUND_WORK = 5e7;
static const double BOUND_SHARE = 0.1; /* of the proof's budget */

static bool is_ranked_before(const mt_subproblem *c, const mt_mode_placement_solution *a,
                             const mt_mode_placement_solution *b)
{
    const mt_merit x = {a->found->feasible, a->found->squares, a->n_stages, a->stages};
    const mt_merit y = {b->found->feasible, b->found->squares, b->n_stages, b->stages};
    if (mt_merit_before(&x, &y, MT_EQUAL_FOUND) || mt_merit_before(&y, &x, MT_EQUAL_FOUND)) {
        return mt_merit_before(&x, &y, MT_EQUAL_FOUND);
    }
    const int order = mt_compare(a->found->f, b->found->f, MT_EQUAL_FOUND);
    return order < 0 || (order == 0 && mt_search_nearer(c, a->found->t, b->found->t));
}

/* Sorts, best first. Stable: equal ones keep the order of the placements. */
static void rank_placements(const mt_subproblem *c, mt_mode_placement_result *r)
{
    for (int i = 1; i < r->n_solutions; i++) {
        const mt_mode_placement_solution s = r->solutions[i];
        int k = i;
        for (; k > 0 && is_ranked_before(c, &s, &r->solutions[k - 1]); k--) {
            r->solutions[k] = r->solutions[k - 1];
        }
        r->solutions[k] = s;
    }
}

/*
 * A budget is shared out evenly, and before anything is begun: parts of a run agree on it,
 * whatever each of them takes. A candidate has a search and at least one judgement of what that
 * finds; where there is not that much for all, the first ones have it.
 */
long mt_mode_placement_verdict(const mt_subproblem *c)
{
    return (c->n_stages > 1 ? 1 : 0) + (mt_search_has_positions(c) ? 1 : 0) +
           (c->clearance || mt_drive_positions_any(c->p) ? 1 : 0) +
           (mt_tolerance_is_sampled(c) ? 1 + c->search.judged_as : 0) + mt_drive_path_most(c);
}

/* Number of n candidates to search: at least one; all without a budget. */
static int count_affordable(const mt_subproblem *c, int n, long left)
{
    const long most = left / (mt_mode_placement_verdict(c) + MT_GAP_SEARCH_LEAST);
    return c->search.max_evaluations <= 0 || most >= n ? n : most > 1 ? (int)most : 1;
}

/* Evaluations for each of n candidates; 0: no limit. */
static long share_evaluations(const mt_subproblem *c, int n, long left)
{
    const long share = left / (n > 0 ? n : 1);
    return c->search.max_evaluations <= 0 ? 0 : share > 1 ? share : 1;
}

/* One design for each placement, its best; its other local optima follow (see rank). */
static mt_status keep_solutions(const mt_problem *p, const mt_mode_placement_job *j,
                                mt_arena *mem, mt_mode_placement_result *out, mt_err *err)
{
    const int n = j->candidates->n;
    out->solutions = mt_arena_alloc(mem, (size_t)n, sizeof *out->solutions);
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < n; k++) {
        out->n_feasible += mt_mode_placement_is_met(&j->slots[k]) ? 1 : 0;
    }
    out->compromise = out->n_feasible == 0;
    for (int k = 0; k < n; k++) {
        const mt_nlp_result *const found = &j->slots[k].found;
        if (found->n_solutions > 0 && found->solutions[0].feasible != out->compromise) {
            out->solutions[out->n_solutions++] = (mt_mode_placement_solution){
                .found = &found->solutions[0],
                .below = j->candidates->below + ((ptrdiff_t)k * p->n_bands),
                .held = j->slots[k].held.held,
                .n_held = j->slots[k].held.n_held,
                .candidate = k,
                .stages = j->slots[k].stages,
                .n_stages = j->slots[k].stages == NULL ? 0 : j->c->n_stages};
        }
    }
    return MT_OK;
}

/* Of the best solution's search, without the coordinate of the clearance. */
static mt_status keep_unidentifiable(const mt_problem *p, const mt_mode_placement_slot *s,
                                     mt_arena *mem, mt_mode_placement_result *out, mt_err *err)
{
    const size_t count = (size_t)s->found.n_unidentifiable;
    out->unidentifiable = mt_arena_f64(mem, (size_t)p->n, count);
    out->unidentifiable_effect = mt_arena_f64(mem, count, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (size_t k = 0; k < count; k++) {
        memcpy(out->unidentifiable + (k * (size_t)p->n),
               s->found.unidentifiable + (k * (size_t)s->n_t), (size_t)p->n * sizeof(double));
        out->unidentifiable_effect[k] = s->found.unidentifiable_effect[k];
    }
    out->n_unidentifiable = (int)count;
    return MT_OK;
}

/* Steps in the order of the candidates. A later objective is comparable only between the best
 * designs, so its steps come from the best candidate alone. */
static mt_status keep_steps(const mt_mode_placement_job *j, mt_arena *mem,
                            mt_mode_placement_result *out, mt_err *err)
{
    const int best = out->n_solutions > 0 ? out->solutions[0].candidate : -1;
    long evals = out->evals;
    out->steps = mt_steps_new(MT_STEPS_MOST, mem);
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < j->candidates->n; k++) {
        const mt_mode_placement_slot *const s = &j->slots[k];
        for (int i = 0; i < s->found.steps.n; i++) {
            mt_step one = s->found.steps.at[i];
            one.evals += evals + s->begun;
            if (one.stage == 0 && j->c->clearance) {
                mt_mode_placement_refuse_step(j->c, &one);
            }
            if (one.stage == 0 || k == best) {
                mt_steps_add(&out->steps, &one);
            }
        }
        evals += s->evals;
    }
    return MT_OK;
}

static mt_status collect_placement_result(const mt_problem *p, const mt_mode_placement_job *j,
                                          mt_arena *mem, mt_mode_placement_result *out,
                                          mt_err *err)
{
    MT_TRY(keep_solutions(p, j, mem, out, err));
    rank_placements(j->c, out);
    MT_TRY(keep_steps(j, mem, out, err));
    if (out->n_solutions > 0) {
        MT_TRY(keep_unidentifiable(p, &j->slots[out->solutions[0].candidate], mem, out, err));
    }
    for (int i = 0; i < out->n_solutions; i++) {
        MT_TRY(mode_placement_copy(j->c, out->solutions[i].below, out->solutions[i].found, mem,
                                   &out->solutions[i].found, err));
        MT_TRY(mode_placement_copy_held(mem, &out->solutions[i], err));
        out->solutions[i].stages = NULL; /* the slots' memory goes */
        out->stage = out->solutions[i].n_stages > 0 ? j->c->n_stages - 1 : 0;
    }
    for (int k = 0; k < j->candidates->n; k++) {
        const mt_nlp_result *const found = &j->slots[k].found;
        out->evals += j->slots[k].evals;
        out->starts += j->slots[k].starts;
        out->stop = found->stop > out->stop ? found->stop : out->stop;
    }
    return MT_OK;
}

/* Where the proof's budget ended with a list of open placements and the search met all of them,
 * nothing is open. */
static bool is_settled(const mt_mode_placement_job *j)
{
    bool met = j->candidates->all;
    for (int k = 0; k < j->candidates->n && met; k++) {
        met = mt_mode_placement_is_met(&j->slots[k]);
    }
    return met;
}

/* Shares 1/part of the remaining evaluations among the candidates. */
static void share_out(mt_mode_placement_job *j, long spent, int part)
{
    const long left = (j->c->search.max_evaluations - spent) / part;
    j->most = count_affordable(j->c, j->candidates->n, left);
    j->options.max_evals = share_evaluations(j->c, j->most, left);
}

static mt_status claim_slots(mt_mode_placement_job *j, mt_arena *mem, mt_err *err)
{
    j->slots = mt_arena_alloc(mem, (size_t)j->candidates->n, sizeof *j->slots);
    return mt_arena_check(mem, err);
}

static void free_slots(const mt_mode_placement_job *j)
{
    for (int k = 0; j->slots != NULL && k < j->candidates->n; k++) {
        mt_arena_free(&j->slots[k].mem);
    }
}

/* Placements that were met first and are not listed (the proof ended before them) are
 * appended. */
static mt_status list_met(const mt_mode_placement_job *first, mt_mode_placement_candidates *c,
                          mt_arena *mem, mt_err *err)
{
    const int m = first->p->n_bands;
    const size_t row = (size_t)m;
    int *const below = mt_arena_int(mem, (size_t)(c->n + first->candidates->n) * row);
    MT_TRY(mt_arena_check(mem, err));
    if (c->n > 0) {
        memcpy(below, c->below, (size_t)c->n * row * sizeof *below);
    }
    c->below = below;
    for (int k = 0; k < first->candidates->n; k++) {
        const int *const own = first->candidates->below + ((ptrdiff_t)k * m);
        if (mt_mode_placement_is_met(&first->slots[k]) &&
            mt_certify_index_of(c->below, c->n, own, m) == c->n) {
            memcpy(c->below + ((ptrdiff_t)c->n * m), own, row * sizeof *own);
            c->n++;
        }
    }
    return MT_OK;
}

/* What was searched first is not searched again, unless it was missed and the proof knows a
 * design. */
static void carry(const mt_mode_placement_job *first, mt_mode_placement_job *j, long *evals)
{
    const int m = j->p->n_bands;
    for (int k = 0; k < first->candidates->n; k++) {
        mt_mode_placement_slot *const s = &first->slots[k];
        const int *const own = first->candidates->below + ((ptrdiff_t)k * m);
        const int at = mt_certify_index_of(j->candidates->below, j->candidates->n, own, m);
        if (at < j->candidates->n &&
            (mt_mode_placement_is_met(s) || at >= j->candidates->n_proven)) {
            j->slots[at] = *s;
            j->slots[at].carried = true;
            s->mem = (mt_arena){0};
        } else {
            *evals += s->evals;
        }
    }
}

/* All candidates, of which the first ones have been searched. */
static mt_status search_rest(const mt_mode_placement_job *first, mt_mode_placement_job *j,
                             long spent, int n_workers, mt_arena *mem,
                             mt_mode_placement_result *out, mt_err *err)
{
    MT_TRY(claim_slots(j, mem, err));
    out->evals = first->candidates->evals + j->candidates->evals;
    carry(first, j, &out->evals);
    share_out(j, spent + j->candidates->evals, 1);
    const mt_tasks tasks = {j->candidates->n, mt_mode_placement_search_candidate, NULL, j,
                            "mode placements"};
    MT_TRY(mt_workers_run(n_workers, j->workers[0]->task_path, &tasks, err));
    MT_TRY(collect_placement_result(j->p, j, mem, out, err));
    out->proven = out->proven || is_settled(j);
    return MT_OK;
}

/* Passes what was found before the proof to the callback. */
static mt_status report_incumbent(const mt_mode_placement_job *first,
                                  const mt_mode_placement_incumbent *incumbent, mt_arena *mem,
                                  const mt_mode_placement_result *out, mt_err *err)
{
    mt_mode_placement_result now = *out;
    bool met = false;
    for (int k = 0; incumbent != NULL && k < first->candidates->n; k++) {
        met = met || mt_mode_placement_is_met(&first->slots[k]);
    }
    if (!met || mt_interrupted(first->p->run->interrupt)) {
        return MT_OK;
    }
    now.n_candidates = first->candidates->n;
    now.n_searched = first->candidates->n;
    now.n_possible = first->candidates->possible;
    now.reason = "not begun";
    now.evals = first->candidates->evals;
    MT_TRY(collect_placement_result(first->p, first, mem, &now, err));
    return incumbent->tell(incumbent->context, &now, err);
}

/* Copies the proof's statements about the whole to out. */
static void note_proof(const mt_mode_placement_candidates *all, mt_mode_placement_result *out)
{
    out->n_candidates = all->n;
    out->n_possible = all->possible;
    out->proven = all->proven;
    out->reason = all->reason;
    out->boxes = all->boxes;
}

/* End with a full list or an interrupt: results of the searched candidates, and the proof's
 * statements about these and all others. */
static mt_status end_full(mt_mode_placement_job *first, double last, double rest, mt_arena *mem,
                          const mt_mode_placement_candidates *all,
                          mt_mode_placement_result *out, mt_err *err)
{
    const mt_mode_placement_candidates *const c = first->candidates;
    note_proof(all, out);
    out->rest = rest;
    for (int k = 0; k < c->n; k++) {
        const bool left_out = mt_mode_placement_is_left_out(first, k);
        out->rest = left_out ? fmin(out->rest, c->least[k]) : out->rest;
        out->n_searched += left_out ? 0 : 1;
    }
    out->n_candidates = all->proven ? all->n : out->n_searched;
    out->bounded = out->rest >= last;
    out->ended = true;
    return collect_placement_result(first->p, first, mem, out, err);
}

/* Candidates by ascending lower bound: those of the proof where it settled, else all that the
 * bounds allow, with the designs known to `begin`. *rest: lower bound of all others. */
static mt_status order(const mt_mode_placement_job *first,
                       const mt_mode_placement_bounds *bounds,
                       const mt_mode_placement_candidates *all,
                       const mt_mode_placement_candidates *begin,
                       mt_mode_placement_candidates *out, double *rest, mt_arena *mem,
                       mt_err *err)
{
    *rest = HUGE_VAL;
    if (all->proven) {
        *out = *all;
        return mt_mode_placement_bounds_sort(bounds, out, mem, err);
    }
    MT_TRY(mt_mode_placement_bounds_list(bounds, LISTED_MOST, mem, out, rest, err));
    out->possible = all->possible;
    out->evals = begin->evals;
    mode_placement_candidates_start(begin, first->p, out);
    return MT_OK;
}

/* Where the list is not full: each placement met so far is searched before the proof, from its
 * design, and those the proof leaves after it. */
static mt_status keep_met(mt_mode_placement_job *first, mt_mode_placement_candidates *begin,
                          mt_arena *mem, mt_err *err)
{
    const size_t row = (size_t)first->p->n_bands;
    const size_t n = (size_t)first->p->n;
    int *const below = mt_arena_int(mem, row * (size_t)begin->n);
    double *const at = mt_arena_f64(mem, n, (size_t)begin->n);
    int met = 0;
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < begin->n; k++) {
        const mt_mode_placement_slot *const s = &first->slots[k];
        begin->evals += s->evals;
        if (mt_mode_placement_is_met(s)) {
            memcpy(below + ((size_t)met * row), begin->below + ((size_t)k * row),
                   row * sizeof *below);
            memcpy(at + ((size_t)met * n), s->found.solutions[0].t, n * sizeof *at);
            met++;
        }
    }
    free_slots(first);
    first->slots = NULL;
    begin->n = met;
    begin->below = below;
    begin->at = at;
    begin->least = NULL;
    return MT_OK;
}

/* Designs before proofs: search what little work meets, then what the proof adds. */
static mt_status search_and_prove(mt_mode_placement_job *first, mt_mode_placement_job *j,
                                  int n_workers, const mt_mode_placement_incumbent *incumbent,
                                  mt_proof *proof, mt_arena *mem, mt_mode_placement_result *out,
                                  mt_err *err)
{
    mt_workspace *const w = j->workers[0];
    const int asked = j->p->study->recommendations;
    mt_mode_placement_candidates *const begin = mt_arena_alloc(mem, 1, sizeof *begin);
    mt_mode_placement_candidates *const listed = mt_arena_alloc(mem, 1, sizeof *listed);
    mt_mode_placement_candidates *const all = mt_arena_alloc(mem, 1, sizeof *all);
    double last = HUGE_VAL;
    double rest = HUGE_VAL;
    mt_mode_placement_bounds bounds;
    bool known = false;
    MT_TRY(mt_arena_check(mem, err));
    /* a budget is shared out before anything is begun */
    if (j->c->search.max_evaluations <= 0) {
        const double work = fmin(BOUND_WORK, BOUND_SHARE * proof->left);
        MT_TRY(mt_mode_placement_bounds_make(j->c, proof, work, mem, &bounds, &known, err));
    }
    MT_TRY(mode_placement_candidates_first(w, proof, known, mem, all, begin, err));
    first->candidates = begin;
    j->candidates = all;
    if (known) {
        MT_TRY(order(first, &bounds, all, begin, listed, &rest, mem, err));
    }
    if (listed->n > asked) {
        first->candidates = listed;
        MT_TRY(claim_slots(first, mem, err));
        MT_TRY(mode_placement_search_best(first, n_workers, asked, rest, mem, &last, err));
        if (last < HUGE_VAL || mt_interrupted(j->p->run->interrupt)) {
            MT_TRY(all->proven ? MT_OK
                               : mode_placement_candidates_settle(w, proof, mem, all, err));
            MT_TRY(mode_placement_search_known(first, n_workers, all, mem, err));
            return end_full(first, last, rest, mem, all, out, err);
        }
        MT_TRY(keep_met(first, listed, mem, err));
        *begin = *listed;
        begin->n = all->proven ? 0 : begin->n; /* then all of them come behind it */
        first->candidates = begin;
    }
    if (begin->n > 0) {
        MT_TRY(claim_slots(first, mem, err));
        share_out(first, begin->evals, FIRST_PART);
        const mt_tasks tasks = {begin->n, mt_mode_placement_search_candidate, NULL, first,
                                "mode placements"};
        MT_TRY(mt_workers_run(n_workers, w->task_path, &tasks, err));
    }
    /* what they were given, not what they took: parts of a run agree on the rest */
    const long spent = begin->evals + (first->options.max_evals * first->most);
    MT_TRY(all->proven ? MT_OK : report_incumbent(first, incumbent, mem, out, err));
    if (!all->proven && mt_interrupted(j->p->run->interrupt)) {
        *all = *begin;
        all->evals = 0; /* counted with the first */
        all->reason = "interrupted before it";
    } else if (!all->proven) {
        MT_TRY(mode_placement_candidates_find(w, proof, spent, mem, all, err));
        MT_TRY(list_met(first, all, mem, err));
    }
    note_proof(all, out);
    out->n_searched = all->n;
    if (all->proven && all->n == 0) { /* then the nearest designs are wanted */
        MT_TRY(mt_mode_placement_candidates_near(w, NEAREST, spent, mem, all, err));
    }
    return search_rest(first, j, spent, n_workers, mem, out, err);
}

mt_status mt_mode_placements_solve(mt_workspace *const *workers, int n_workers,
                                   const mt_mode_placement_incumbent *incumbent, mt_arena *mem,
                                   mt_mode_placement_result *out, mt_err *err)
{
    mt_workspace *const w = workers[0];
    const mt_subproblem *const c = w->c;
    const mt_problem *const p = w->p;
    static const mt_mode_placement_candidates none = {0};
    mt_proof proof;
    mt_mode_placement_job j = {.workers = workers,
                               .c = c,
                               .p = p,
                               .candidates = &none,
                               .options = mt_nlp_options_default()};
    *out = (mt_mode_placement_result){.stop = MT_STOP_DONE,
                                      .rest = HUGE_VAL,
                                      .tolerances = c->tolerance_box != NULL,
                                      .motion = mt_drive_positions_any(p)};
    for (int i = 0; i < p->n_avoidances; i++) {
        out->driven = out->driven || p->views[p->avoidances[i].view].original->sys->driven;
    }
    j.options.seed = c->search.seed;
    j.options.starts = c->search.starts > 0 ? c->search.starts : STARTS_PER_CANDIDATE + p->n;
    j.options.settles = c->search.starts <= 0;
    j.options.max_solutions = SOLUTIONS_PER_CANDIDATE;
    j.options.least_change = c->stages[0].type == MT_OBJECTIVE_CHANGE;
    if (c->hint != NULL) {
        int *const below = mt_arena_int(mem, (size_t)p->n_bands);
        double violation = 0.0;
        MT_TRY(mt_arena_check(mem, err));
        MT_TRY(mt_mode_placement_assignment(w, c->hint, below, &violation, err));
        j.hint_below = MT_HAS(violation) ? below : NULL;
    }
    mt_mode_placement_job first = j;
    mt_status rc = mt_proof_init(&proof, c, mem, err);
    rc = rc == MT_OK ? search_and_prove(&first, &j, n_workers, incumbent, &proof, mem, out, err)
                     : rc;
    free_slots(&first);
    free_slots(&j);
    mt_proof_free(&proof);
    return rc;
}
