/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Every gap assignment is a search of its own. Where configurations are positions of one drive,
 * the best design of an assignment is followed from position to position (motion.h); where a
 * mode crosses an edge on the way, the position of the worst crossing becomes one more
 * configuration that has to keep the assignment, and the search begins again from there (a
 * cutting plane: what it removes crosses). A few rounds end it, as each begins next to its
 * answer; a design that still crosses then is no design of that assignment.
 */
#include "search/gaps.h"

#include <math.h>
#include <string.h>

#include "base/workers.h"
#include "nlp/merit.h"
#include "problem/goal_avoid.h"
#include "problem/objective.h"
#include "problem/robust_cut.h"
#include "search/motion.h"
#include "search/search.h"

/* What the search of one candidate left behind, in its own memory. */
typedef struct slot {
    mt_arena mem;
    mt_nlp_result found;
    int n_t;
    mt_gap_solution held; /* what holds the best solution between positions */
    double *aims; /* [n_aims] of the best solution, where there is one and several objectives */
    mt_status rc;
    long evals; /* of all rounds */
    long begun; /* of those before the last one, whose steps count */
    int starts;
    int n_cuts;
    mt_cut *cuts; /* [CUTS_MOST], owned */
    mt_posed_cuts posed;
    mt_robust_cuts corners;
    bool carried; /* searched before the proof */
} slot;

typedef struct job {
    mt_workspace *const *workers;
    const mt_case *c; /* without an assignment */
    const mt_problem *p;
    const mt_gap_candidates *candidates;
    slot *slots;
    mt_nlp_options options;
    const int *hint_below; /* [n_bands] assignment of c->hint; NULL: none */
    int most;              /* so many candidates are searched: the budget has no more */
} job;

enum { STARTS_PER_CANDIDATE = 24, SOLUTIONS_PER_CANDIDATE = 4, NEAREST = 6 };
/* Rounds of cuts, and starts of the later ones, which begin next to their answer. */
/* Of the evaluations that are left, one in so many for what is searched before the proof. */
enum { FIRST_PART = 4 };
enum { CUT_ROUNDS = 12, CUTS_MOST = 32, CUT_STARTS = 6 };

/* The caller's design where it is of this kind, else the one that the candidate comes with;
 * NULL: none. */
static const double *hint_of(const job *j, int k)
{
    const size_t size = (size_t)j->p->n_bands * sizeof(int);
    const int *const below = j->candidates->below + ((ptrdiff_t)k * j->p->n_bands);
    if (j->hint_below != NULL && memcmp(below, j->hint_below, size) == 0) {
        return j->c->hint;
    }
    const double *const at =
        j->candidates->at == NULL ? NULL : j->candidates->at + ((ptrdiff_t)k * j->p->n);
    return at == NULL || j->p->n == 0 || isnan(at[0]) ? NULL : at;
}

/* The objectives in order, each with those before it held (search.h). */
static mt_status search_in_order(mt_workspace *w, slot *s, mt_err *err)
{
    int stage = 0;
    mt_err why = {0};
    mt_nlp_values v;
    MT_TRY(mt_search_designs(&w, 1, &s->mem, &s->found, &stage, &why, err));
    if (s->found.n_solutions == 0 || s->found.compromise || s->found.stop == MT_STOP_USER) {
        return MT_OK;
    }
    /* all of them at the best solution, by which the candidates are ranked */
    s->aims = mt_arena_f64(&s->mem, (size_t)w->c->n_aims, 1);
    MT_TRY(mt_arena_check(&s->mem, err));
    MT_TRY(mt_case_values_init(w->c, &s->mem, &v, err));
    MT_TRY(mt_workspace_eval(w, s->found.solutions[0].t, false, &v, err));
    s->evals++;
    for (int k = 0; k < w->c->n_aims; k++) {
        s->aims[k] = mt_aim_value(w, k, NULL);
    }
    s->found.solutions[0].f = s->aims[w->c->n_aims - 1];
    return MT_OK;
}

/* Where the motion of a family comes nearer than `room`, one more cut for each way between two
 * positions: *added of them. */
static mt_status add_cuts(slot *s, const mt_problem *p, int family, const mt_motion *m,
                          double room, int *added, mt_err *err)
{
    for (int i = 0; i < m->n_ways && p->families[family].fixed; i++) {
        if (m->way_room[i] < room - m->tolerance && MT_HAS(m->way_at[i]) &&
            s->n_cuts < CUTS_MOST) {
            MT_TRY(mt_cut_init(p, family, m->way_at[i], &s->cuts[s->n_cuts], err));
            s->n_cuts++;
            (*added)++;
        }
    }
    return MT_OK;
}

/* Follow the best design, which has been evaluated, over the range of motion. *added: cuts to
 * search again with; with none a design that crosses is refused. *room: down to the least on
 * the way. */
static mt_status follow_best(slot *s, mt_workspace *w, bool last, int *added, double *room,
                             mt_err *err)
{
    mt_nlp_solution *const best = &s->found.solutions[0];
    const double wanted = w->c->clearance ? best->t[w->p->n] : 0.0;
    double short_of = 0.0;
    double tolerance = 1.0;
    *added = 0;
    for (int i = 0; i < w->p->n_families; i++) {
        mt_motion m = {.room = 0.0};
        if (!w->p->families[i].banded) {
            continue;
        }
        MT_TRY(mt_motion_follow(w, i, w->c->below, &s->mem, &m, err));
        s->evals += m.positions;
        *room = fmin(*room, m.room);
        MT_TRY(last ? MT_OK : add_cuts(s, w->p, i, &m, wanted, added, err));
        if (m.end == MT_MOTION_UNSTABLE || m.room < -m.tolerance) {
            const double here = m.end == MT_MOTION_UNSTABLE ? 1.0 : -m.room;
            tolerance = here > short_of && m.tolerance > 0.0 ? m.tolerance : tolerance;
            short_of = fmax(short_of, here);
        }
    }
    if (*added == 0 && short_of > 0.0) {
        mt_gap_refuse(best, short_of, tolerance);
    }
    return MT_OK;
}

/* What is asked of a search is z within the tolerance of a band, and that differs from kind to
 * kind: the best design is ranked by what it has. */
static void tell_clearance(slot *s, double room, int n_aims)
{
    if (n_aims == 1) {
        s->found.solutions[0].f = -room;
    } else if (s->aims != NULL) {
        s->aims[0] = -room;
    }
}

/* The best design over the range of motion and over its tolerances; *again: with one more cut
 * at least. */
static mt_status judge_best(slot *s, mt_workspace *w, bool last, bool *again, mt_err *err)
{
    mt_nlp_solution *const best = &s->found.solutions[0];
    mt_nlp_values v;
    int added = 0;
    bool worse = false;
    double room = HUGE_VAL;
    if (best->feasible && (w->c->clearance || mt_family_any(w->p))) {
        MT_TRY(mt_case_values_init(w->c, &s->mem, &v, err));
        MT_TRY(mt_workspace_eval(w, best->t, false, &v, err));
        s->evals++;
        room = mt_clears_room(w);
    }
    if (best->feasible && mt_family_any(w->p)) {
        MT_TRY(follow_best(s, w, last, &added, &room, err));
    }
    if (best->feasible && mt_search_has_positions(w->c)) {
        MT_TRY(mt_search_judge_positions(w, best->t, last, &s->mem, &s->posed, err));
        s->evals += s->posed.evals;
        added += s->posed.added;
    }
    if (best->feasible && mt_robust_is_sampled(w->c)) {
        MT_TRY(mt_search_judge(w, last, &s->mem, &s->corners, best, &worse, err));
        s->evals++;
        /* the worst within the tolerances, where they were looked at for it */
        room = fmin(room, s->corners.band_room);
    }
    if (best->feasible && w->c->clearance && isfinite(room)) {
        tell_clearance(s, room, w->c->n_aims);
    }
    *again = added > 0 || worse;
    return MT_OK;
}

/* Is there something left of a candidate's share for one more round? */
static bool has_round(const job *j, long evals)
{
    const long most = j->options.max_evals;
    return most <= 0 || most - evals >= mt_gap_judgement(j->c) + MT_GAP_SEARCH_LEAST;
}

/* One search of candidate k with the cuts so far, from `from` (NULL: no hint). *again: a cut
 * was added. */
static mt_status search_round(const job *j, mt_workspace *w, slot *s, int k, int round,
                              const double *from, bool *again, mt_err *why)
{
    const int *const below = j->candidates->below + ((ptrdiff_t)k * j->p->n_bands);
    mt_nlp_options options = j->options;
    mt_case c;
    *again = false;
    mt_case held = *j->c;
    if (options.max_evals > 0) {
        const long left = options.max_evals - s->evals - mt_gap_judgement(j->c);
        options.max_evals = left > 1 ? left : 1;
        held.search.max_evaluations = options.max_evals;
    }
    if (s->corners.n > 0) {
        MT_TRY(mt_robust_add_cuts(j->c, &s->corners, &s->mem, &held.robust, why));
    }
    mt_cut *cuts = NULL;
    MT_TRY(mt_posed_cuts_behind(&s->posed, s->n_cuts, s->cuts, &s->mem, &cuts, why));
    MT_TRY(mt_case_in_gap(&held, below, s->n_cuts + s->posed.n, cuts, w, &s->mem, &c, why));
    options.starts =
        round > 1 && options.starts > CUT_STARTS ? (int)CUT_STARTS : options.starts;
    c.starts = options.starts;
    s->n_t = c.n_t;
    double *const hint = mt_arena_f64(&s->mem, (size_t)c.n_t, 1);
    MT_TRY(mt_arena_check(&s->mem, why));
    if (from != NULL) {
        memcpy(hint, from, (size_t)j->p->n * sizeof *hint);
    }
    c.hint = from != NULL ? hint : NULL;
    const mt_nlp nlp = mt_workspace_nlp(w);
    mt_status rc = c.n_aims > 1
                       ? search_in_order(w, s, why)
                       : mt_workspace_solve(w, &nlp, &options, &s->mem, &s->found, why);
    if (rc == MT_OK && c.n_aims == 1) {
        rc = mt_search_repeated(w, options.max_evals, &s->mem, &s->found, why);
    }
    if (rc == MT_OK) {
        mt_gap_judge_clearance(&c, &s->found);
    }
    if (rc == MT_OK && c.n_aims == 1) {
        rc = mt_search_nearest(w, options.max_evals, NULL, NULL, &s->mem, &s->found, why);
    }
    s->begun = s->evals;
    s->evals += s->found.evals;
    s->starts += s->found.starts;
    if (rc == MT_OK && s->found.n_solutions > 0) {
        rc = mt_gap_hold(&c, s->cuts, &s->found.solutions[0], &s->mem, &s->held, why);
    }
    if (rc == MT_OK && s->found.n_solutions > 0 && s->found.stop != MT_STOP_USER) {
        const long judged = s->evals + mt_gap_judgement(j->c); /* at most */
        const bool last = round + 1 == CUT_ROUNDS || !has_round(j, judged);
        rc = judge_best(s, w, last, again, why);
    }
    return rc;
}

static bool is_met(const slot *s)
{
    return s->found.n_solutions > 0 && s->found.solutions[0].feasible;
}

/* A candidate without a value anywhere is no failure of the study: it has no solution. */
static mt_status search_candidate(void *context, int worker, int k, mt_scope *own, mt_err *err)
{
    job *const j = context;
    slot *const s = &j->slots[k];
    mt_workspace *const w = j->workers[worker];
    mt_scope *const before = w->scope;
    mt_err why = {0};
    bool again = true;
    if (s->carried || k >= j->most || mt_interrupted(j->p->study->model->interrupt)) {
        s->found.stop = !s->carried && k >= j->most ? MT_STOP_MAX_EVALS : s->found.stop;
        return MT_OK;
    }
    MT_TRY(mt_arena_init(&s->mem, 0, err));
    s->cuts = mt_arena_alloc(&s->mem, CUTS_MOST, sizeof *s->cuts);
    MT_TRY(mt_arena_check(&s->mem, err));
    w->scope = own;
    for (int round = 0; again && round < CUT_ROUNDS; round++) {
        const bool known = round > 0 && s->found.n_solutions > 0;
        s->rc = search_round(j, w, s, k, round, known ? s->found.solutions[0].t : hint_of(j, k),
                             &again, &why);
    }
    if (s->rc != MT_OK) { /* perhaps on the way from position to position: nothing is known */
        s->found.n_solutions = 0;
        s->found.stop = s->rc == MT_E_INTERRUPTED ? MT_STOP_USER : s->found.stop;
    }
    w->scope = before;
    mt_workspace_back(w, j->c); /* the candidate's case goes, and its cuts */
    if (is_met(s)) {
        mt_workspace_judged(w, s->aims != NULL ? s->aims[0] : s->found.solutions[0].f);
    }
    for (int i = 0; i < s->n_cuts; i++) {
        mt_cut_free(&s->cuts[i]);
    }
    mt_posed_cuts_free(&s->posed);
    const bool fatal = mt_is_final(s->rc);
    return fatal ? mt_fail(err, s->rc, "%s", why.text) : MT_OK;
}

/* One design for each assignment: its best. Its other local optima come after (see rank). */
static mt_status keep_solutions(const mt_problem *p, const job *j, mt_arena *mem,
                                mt_gap_result *out, mt_err *err)
{
    const int n = j->candidates->n;
    out->solutions = mt_arena_alloc(mem, (size_t)n, sizeof *out->solutions);
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < n; k++) {
        out->n_feasible += is_met(&j->slots[k]) ? 1 : 0;
    }
    out->compromise = out->n_feasible == 0;
    for (int k = 0; k < n; k++) {
        const mt_nlp_result *const found = &j->slots[k].found;
        if (found->n_solutions > 0 && found->solutions[0].feasible != out->compromise) {
            out->solutions[out->n_solutions++] =
                (mt_gap_solution){.found = &found->solutions[0],
                                  .below = j->candidates->below + ((ptrdiff_t)k * p->n_bands),
                                  .held = j->slots[k].held.held,
                                  .n_held = j->slots[k].held.n_held,
                                  .candidate = k,
                                  .aims = j->slots[k].aims,
                                  .n_aims = j->slots[k].aims == NULL ? 0 : j->c->n_aims};
        }
    }
    return MT_OK;
}

/* Of the best solution's search, without the coordinate of the clearance. */
static mt_status keep_undetermined(const mt_problem *p, const slot *s, mt_arena *mem,
                                   mt_gap_result *out, mt_err *err)
{
    const size_t count = (size_t)s->found.n_undetermined;
    out->undetermined = mt_arena_f64(mem, (size_t)p->n, count);
    out->undetermined_effect = mt_arena_f64(mem, count, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (size_t k = 0; k < count; k++) {
        memcpy(out->undetermined + (k * (size_t)p->n),
               s->found.undetermined + (k * (size_t)s->n_t), (size_t)p->n * sizeof(double));
        out->undetermined_effect[k] = s->found.undetermined_effect[k];
    }
    out->n_undetermined = (int)count;
    return MT_OK;
}

/* As if the candidates had been searched one after the other. What a later objective came to
 * says something next to the others as they are there, so of the best candidate alone. */
static mt_status keep_steps(const job *j, mt_arena *mem, mt_gap_result *out, mt_err *err)
{
    const int best = out->n_solutions > 0 ? out->solutions[0].candidate : -1;
    long evals = out->evals;
    out->steps = mt_steps_new(MT_STEPS_MOST, mem);
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < j->candidates->n; k++) {
        const slot *const s = &j->slots[k];
        for (int i = 0; i < s->found.steps.n; i++) {
            mt_step one = s->found.steps.at[i];
            one.evals += evals + s->begun;
            if (one.stage == 0 && j->c->clearance) {
                mt_gap_refuse_step(j->c, &one);
            }
            if (one.stage == 0 || k == best) {
                mt_steps_add(&out->steps, &one);
            }
        }
        evals += s->evals;
    }
    return MT_OK;
}

static mt_status collect(const mt_problem *p, const job *j, mt_arena *mem, mt_gap_result *out,
                         mt_err *err)
{
    MT_TRY(keep_solutions(p, j, mem, out, err));
    mt_gap_rank(j->c, out);
    MT_TRY(keep_steps(j, mem, out, err));
    if (out->n_solutions > 0) {
        MT_TRY(keep_undetermined(p, &j->slots[out->solutions[0].candidate], mem, out, err));
    }
    for (int i = 0; i < out->n_solutions; i++) {
        MT_TRY(mt_gap_copy(j->c, out->solutions[i].below, out->solutions[i].found, mem,
                           &out->solutions[i].found, err));
        MT_TRY(mt_gap_copy_held(mem, &out->solutions[i], err));
        out->solutions[i].aims = NULL; /* the slots' memory goes */
        out->stage = out->solutions[i].n_aims > 0 ? j->c->n_aims - 1 : 0;
    }
    for (int k = 0; k < j->candidates->n; k++) {
        const mt_nlp_result *const found = &j->slots[k].found;
        out->evals += j->slots[k].evals;
        out->starts += j->slots[k].starts;
        out->stop = found->stop > out->stop ? found->stop : out->stop;
    }
    return MT_OK;
}

/* Where the proof's budget ended but left a list of open assignments, and the search met them
 * all, nothing is open any more. */
static bool is_settled(const job *j)
{
    bool met = j->candidates->all;
    for (int k = 0; k < j->candidates->n && met; k++) {
        met = is_met(&j->slots[k]);
    }
    return met;
}

/* Of a part of what is left. */
static void share_out(job *j, long spent, int part)
{
    const long left = (j->c->search.max_evaluations - spent) / part;
    j->most = mt_gap_affordable(j->c, j->candidates->n, left);
    j->options.max_evals = mt_gap_share(j->c, j->most, left);
}

static mt_status claim_slots(job *j, mt_arena *mem, mt_err *err)
{
    j->slots = mt_arena_alloc(mem, (size_t)j->candidates->n, sizeof *j->slots);
    return mt_arena_check(mem, err);
}

static void free_slots(const job *j)
{
    for (int k = 0; j->slots != NULL && k < j->candidates->n; k++) {
        mt_arena_free(&j->slots[k].mem);
    }
}

/* Assignments that were met first and are not listed (the proof ended before it came to them)
 * come after those that are. */
static mt_status list_met(const job *first, mt_gap_candidates *c, mt_arena *mem, mt_err *err)
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
        if (is_met(&first->slots[k]) && mt_certify_place(c->below, c->n, own, m) == c->n) {
            memcpy(c->below + ((ptrdiff_t)c->n * m), own, row * sizeof *own);
            c->n++;
        }
    }
    return MT_OK;
}

/* What was searched first is not searched again, unless it was missed and the proof knows a
 * design. */
static void carry(const job *first, job *j, long *evals)
{
    const int m = j->p->n_bands;
    for (int k = 0; k < first->candidates->n; k++) {
        slot *const s = &first->slots[k];
        const int *const own = first->candidates->below + ((ptrdiff_t)k * m);
        const int at = mt_certify_place(j->candidates->below, j->candidates->n, own, m);
        if (at < j->candidates->n && (is_met(s) || at >= j->candidates->n_proven)) {
            j->slots[at] = *s;
            j->slots[at].carried = true;
            s->mem = (mt_arena){0};
        } else {
            *evals += s->evals;
        }
    }
}

/* All candidates, of which the first ones have been searched. */
static mt_status search_rest(const job *first, job *j, long spent, int n_workers, mt_arena *mem,
                             mt_gap_result *out, mt_err *err)
{
    MT_TRY(claim_slots(j, mem, err));
    out->evals = first->candidates->evals + j->candidates->evals;
    carry(first, j, &out->evals);
    share_out(j, spent + j->candidates->evals, 1);
    const mt_tasks tasks = {j->candidates->n, search_candidate, NULL, j, "mode placements"};
    MT_TRY(mt_workers_run(n_workers, j->workers[0]->scope, &tasks, err));
    MT_TRY(collect(j->p, j, mem, out, err));
    out->proven = out->proven || is_settled(j);
    return MT_OK;
}

/* What was found before the proof, for who asks for it. */
static mt_status tell_early(const job *first, const mt_gap_early *early, mt_arena *mem,
                            const mt_gap_result *out, mt_err *err)
{
    mt_gap_result now = *out;
    bool met = false;
    for (int k = 0; early != NULL && k < first->candidates->n; k++) {
        met = met || is_met(&first->slots[k]);
    }
    if (!met || mt_interrupted(first->p->study->model->interrupt)) {
        return MT_OK;
    }
    now.n_candidates = first->candidates->n;
    now.n_possible = first->candidates->possible;
    now.reason = "not begun";
    now.evals = first->candidates->evals;
    MT_TRY(collect(first->p, first, mem, &now, err));
    return early->tell(early->context, &now, err);
}

/* Designs before proofs: what little work meets is searched, then the proof says what else
 * there is to search. */
static mt_status search_and_prove(job *first, job *j, int n_workers, const mt_gap_early *early,
                                  mt_proof *proof, mt_arena *mem, mt_gap_result *out,
                                  mt_err *err)
{
    mt_workspace *const w = j->workers[0];
    mt_gap_candidates *const begin = mt_arena_alloc(mem, 1, sizeof *begin);
    mt_gap_candidates *const all = mt_arena_alloc(mem, 1, sizeof *all);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_gap_candidates_first(w, proof, mem, all, begin, err));
    first->candidates = begin;
    j->candidates = all;
    if (begin->n > 0) {
        MT_TRY(claim_slots(first, mem, err));
        share_out(first, begin->evals, FIRST_PART);
        const mt_tasks tasks = {begin->n, search_candidate, NULL, first, "mode placements"};
        MT_TRY(mt_workers_run(n_workers, w->scope, &tasks, err));
    }
    /* what they were given, not what they took: parts of a run agree on the rest */
    const long spent = begin->evals + (first->options.max_evals * first->most);
    MT_TRY(all->proven ? MT_OK : tell_early(first, early, mem, out, err));
    if (!all->proven && mt_interrupted(j->p->study->model->interrupt)) {
        *all = *begin;
        all->evals = 0; /* counted with the first */
        all->reason = "interrupted before it";
    } else if (!all->proven) {
        MT_TRY(mt_gap_candidates_find(w, proof, spent, mem, all, err));
        MT_TRY(list_met(first, all, mem, err));
    }
    out->n_candidates = all->n;
    out->n_possible = all->possible;
    out->proven = all->proven;
    out->reason = all->reason;
    out->boxes = all->boxes;
    if (all->proven && all->n == 0) { /* then the nearest designs are wanted */
        MT_TRY(mt_gap_candidates_near(w, NEAREST, spent, mem, all, err));
    }
    return search_rest(first, j, spent, n_workers, mem, out, err);
}

mt_status mt_gaps_solve(mt_workspace *const *workers, int n_workers, const mt_gap_early *early,
                        mt_arena *mem, mt_gap_result *out, mt_err *err)
{
    mt_workspace *const w = workers[0];
    const mt_case *const c = w->c;
    const mt_problem *const p = w->p;
    static const mt_gap_candidates none = {0};
    mt_proof proof;
    job j = {.workers = workers,
             .c = c,
             .p = p,
             .candidates = &none,
             .options = mt_nlp_options_default()};
    *out = (mt_gap_result){
        .stop = MT_STOP_DONE, .tolerances = c->robust != NULL, .motion = mt_family_any(p)};
    for (int i = 0; i < p->n_clears; i++) {
        out->driven = out->driven || p->views[p->clears[i].view].original->sys->driven;
    }
    j.options.seed = c->search.seed;
    j.options.starts = c->search.starts > 0 ? c->search.starts : STARTS_PER_CANDIDATE + p->n;
    j.options.max_solutions = SOLUTIONS_PER_CANDIDATE;
    j.options.least_change = c->aims[0].type == MT_OBJECTIVE_CHANGE;
    if (c->hint != NULL) {
        int *const below = mt_arena_int(mem, (size_t)p->n_bands);
        double violation = 0.0;
        MT_TRY(mt_arena_check(mem, err));
        MT_TRY(mt_gap_assignment(w, c->hint, below, &violation, err));
        j.hint_below = MT_HAS(violation) ? below : NULL;
    }
    job first = j;
    mt_status rc = mt_proof_init(&proof, c, mem, err);
    rc = rc == MT_OK ? search_and_prove(&first, &j, n_workers, early, &proof, mem, out, err)
                     : rc;
    free_slots(&first);
    free_slots(&j);
    mt_proof_free(&proof);
    return rc;
}
