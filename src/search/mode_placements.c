/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Every gap assignment is a search of its own (mode_placements_search.c); here it is decided
 * which ones are searched, and what came of them is put together.
 */
#include "search/mode_placements.h"

#include "search/mode_placements_priv.h"

#include <math.h>
#include <string.h>

#include "base/workers.h"
#include "nlp/merit.h"
#include "problem/drive_positions.h"
#include "problem/tolerance_cut.h"
#include "search/drive_path.h"
#include "search/mode_placements_bounds.h"
#include "search/search.h"

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
        MT_TRY(mt_mode_placement_copy(j->c, out->solutions[i].below, out->solutions[i].found,
                                      mem, &out->solutions[i].found, err));
        MT_TRY(mt_mode_placement_copy_held(mem, &out->solutions[i], err));
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
    mt_mode_placement_candidates_start(begin, first->p, out);
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
    MT_TRY(mt_mode_placement_candidates_first(w, proof, known, mem, all, begin, err));
    first->candidates = begin;
    j->candidates = all;
    if (known) {
        MT_TRY(order(first, &bounds, all, begin, listed, &rest, mem, err));
    }
    if (listed->n > asked) {
        first->candidates = listed;
        MT_TRY(claim_slots(first, mem, err));
        MT_TRY(mt_mode_placement_search_best(first, n_workers, asked, rest, mem, &last, err));
        if (last < HUGE_VAL || mt_interrupted(j->p->run->interrupt)) {
            MT_TRY(all->proven ? MT_OK
                               : mt_mode_placement_candidates_settle(w, proof, mem, all, err));
            MT_TRY(mt_mode_placement_search_known(first, n_workers, all, mem, err));
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
        MT_TRY(mt_mode_placement_candidates_find(w, proof, spent, mem, all, err));
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
