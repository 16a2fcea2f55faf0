/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Searches where variables take values of catalogues: a design, what it leaves open, and the
 * search of all combinations. */
#include "search/catalogue_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/run.h"
#include "base/workers.h"
#include "problem/avoidance.h"
#include "problem/drive_positions.h"
#include "problem/evaluate.h"
#include "problem/objective.h"
#include "problem/tolerance.h"
#include "problem/tolerance_cut.h"
#include "prove/certify.h"
#include "search/catalogue_search_prove.h"
#include "search/drive_path.h"
#include "search/mode_placements.h"
#include "search/search.h"

/*
 * Judge combinations of catalogue values. Where nothing else varies a combination is a design:
 * one evaluation. Else it is a study of its own, in which the bounds of the catalogues'
 * variables are closed on their values.
 */

/* Combinations in one task: long enough to pay for its start, short enough to share out
 * well. */
enum { PER_TASK = 64 };
/* Starts of the continuous search of one combination: 4 + 2 n, where the study does not say. */
enum { STARTS_BASE = 4, STARTS_PER_VARIABLE = 2 };
/* ... and so many where these all end at one feasible design. */
enum { STARTS_AGREE = 4 };
/* Of one whose design is known: the original and that. */
enum { KNOWN_STARTS = 2 };
/* So many that miss a limit between the positions are enough to let the others stand as what
 * they are at these: each takes some ten to some hundred analyses. */
enum { BROKEN_MOST = 200 };

typedef struct judging {
    mt_catalogue_search *d;
    int n;
    mt_combination *list;
    long budget;
    bool settles; /* of equal designs of a combination it ends with the nearest */
    bool finds;   /* its cuts are kept for the combinations that follow */
    int first;    /* of the list, for the first task */
} judging;

mt_status mt_catalogue_search_alloc(const mt_catalogue_search *d, int n, mt_combination **out,
                                    mt_err *err)
{
    const size_t n_t = (size_t)d->p->n + 1;
    const size_t n_stages = (size_t)d->p->n_stages;
    const size_t n_pick = (size_t)d->n_listed;
    mt_combination *const list = mt_arena_alloc(d->mem, (size_t)n, sizeof *list);
    int *const pick = mt_arena_int(d->mem, (size_t)n * n_pick);
    double *const t = mt_arena_f64(d->mem, n_t, (size_t)n);
    double *const f = mt_arena_f64(d->mem, n_stages, (size_t)n);
    *out = list;
    MT_TRY(mt_arena_check(d->mem, err));
    for (int i = 0; i < n; i++) {
        list[i] = (mt_combination){.pick = pick + ((size_t)i * n_pick),
                                   .t = t + ((size_t)i * n_t),
                                   .f = f + ((size_t)i * n_stages),
                                   .missed = {nan(""), HUGE_VAL},
                                   .kkt = nan("")};
    }
    return MT_OK;
}

bool mt_catalogue_search_before(const mt_catalogue_search *d, const mt_combination *a,
                                const mt_combination *b)
{
    const int n = d->p->n_stages;
    const mt_merit x = {a->feasible, a->missed.squares, n, a->f};
    const mt_merit y = {b->feasible, b->missed.squares, n, b->f};
    return mt_merit_before(&x, &y, MT_EQUAL_JUDGED);
}

/* Margins of all modes to all bands; the objective "clearance" is minus the least of them. */
static void verify_bands(const mt_workspace *w, mt_combination *c)
{
    double room = HUGE_VAL;
    double tied = HUGE_VAL;
    for (int i = 0; i < w->c->n_avoidances; i++) {
        const mt_avoidance *const avoidance = &w->c->avoidances[i];
        const double here = mt_avoidance_margin(w, avoidance);
        mt_miss(&c->missed, mt_short_of(here), avoidance->tolerance);
        room = fmin(room, here);
    }
    for (int i = 0; i < w->c->n_bands; i++) { /* one drive, one number of modes below a band */
        int below = 0;
        if (w->c->tie[i] == i) {
            const double here = mt_tie_margin(w, i, &below);
            tied = !(here >= tied) ? here : tied;
        }
    }
    if (mt_drive_positions_any(w->p) && !(tied >= room)) {
        mt_miss(&c->missed, mt_short_of(tied), w->c->avoidances[0].tolerance);
        room = tied;
    }
    for (int k = 0; k < w->c->n_stages; k++) {
        if (mt_objective_is(w->c->stages[k].type, MT_BANDS)) {
            c->f[k] = -room;
        }
    }
}

static mt_status verify_design(const mt_catalogue_search *d, int worker, mt_combination *c,
                               mt_err *err)
{
    mt_workspace *const w = d->workers[worker];
    mt_nlp_values *const v = &d->values[worker];
    mt_err own = {0};
    c->evals = 1;
    const mt_status rc = mt_workspace_eval_uncounted(w, c->t, false, v, &own);
    if (rc != MT_OK) {
        c->stop = rc == MT_E_INTERRUPTED ? MT_STOP_USER : MT_STOP_DONE;
        c->judged = rc != MT_E_INTERRUPTED;
        return mt_pass_final(rc, &own, err);
    }
    c->judged = true;
    for (int k = 0; k < w->c->n_stages; k++) {
        c->f[k] = mt_objective_stage_value(w, k, NULL);
    }
    c->missed = mt_subproblem_missed(w->c, v);
    verify_bands(w, c);
    c->feasible = mt_is_held(c->missed.violation);
    return MT_OK;
}

/* Follows the drives of design c, whose configurations have been solved with w. */
static mt_status follow_combination_drives(mt_workspace *w, mt_combination *c, mt_arena *mem,
                                           mt_err *err)
{
    int *const below = mt_arena_int(mem, (size_t)w->c->n_bands);
    MT_TRY(mt_arena_check(mem, err));
    double room = mt_ties_margin(w, below);
    for (int i = 0; i < w->p->n_families; i++) {
        mt_drive_path m = {.room = 0.0};
        if (!w->p->families[i].banded) {
            continue;
        }
        MT_TRY(mt_drive_path_follow(w, i, below, mem, &m, err));
        c->evals += m.positions;
        if (m.end == MT_MOTION_UNSTABLE || m.room < -m.tolerance) {
            mt_miss(&c->missed, m.end == MT_MOTION_UNSTABLE ? nan("") : -m.room, m.tolerance);
            c->feasible = false;
        }
        room = fmin(room, m.room);
    }
    for (int k = 0; k < w->c->n_stages; k++) {
        if (mt_objective_is(w->c->stages[k].type, MT_BANDS)) {
            c->f[k] = fmax(c->f[k], -room);
        }
    }
    return MT_OK;
}

/* Limits between the positions of drives that goals name. */
static mt_status verify_positions(mt_catalogue_search *d, mt_combination *c, mt_arena *mem,
                                  mt_err *err)
{
    mt_at_position_cuts cuts = {.n = 0};
    MT_TRY(mt_search_verify_positions(d->workers[0], c->t, true, mem, &cuts, err));
    c->evals += cuts.evals;
    c->broken = !cuts.holds;
    c->feasible = c->feasible && cuts.holds;
    d->n_broken += c->broken ? 1 : 0;
    return MT_OK;
}

/* True where a combination is verified beyond the named positions. */
static bool is_followed(const mt_catalogue_search *d)
{
    return !d->mixed && (mt_drive_positions_any(d->p) || mt_tolerance_is_sampled(d->c) ||
                         mt_search_has_positions(d->c));
}

/* The worst within the tolerances of the design at c, where corners are samples. */
static mt_status verify_tolerances(mt_workspace *w, mt_combination *c, mt_arena *mem,
                                   mt_err *err)
{
    mt_tolerance_cuts cuts = {.n = 0};
    MT_TRY(mt_tolerance_verify(w, c->t, mem, &cuts, err));
    c->evals += 1 + mt_subproblem_worth(w->c, cuts.solutions);
    if (!mt_is_met(cuts.missed.violation, 1.0)) {
        const double more = cuts.missed.violation;
        c->missed.squares += cuts.missed.squares;
        c->missed.violation = c->missed.violation > more ? c->missed.violation : more;
        c->feasible = false;
    }
    for (int k = 0; k < w->c->n_stages; k++) {
        if (mt_objective_is(w->c->stages[k].type, MT_BANDS)) {
            c->f[k] = fmax(c->f[k], -cuts.band_margin);
        }
    }
    return MT_OK;
}

/* Largest number of evaluations of mt_catalogue_search_follow for one combination; 0: none, or
 * no limit. */
static long catalogue_search_verdict(const mt_catalogue_search *d)
{
    const long more = (mt_tolerance_is_sampled(d->c) ? 1 + d->c->search.judged_as : 0) +
                      (mt_search_has_positions(d->c) ? 1 : 0);
    return is_followed(d) ? 1 + more + mt_drive_path_most(d->c) : 0;
}

mt_status mt_catalogue_search_follow(mt_catalogue_search *d, mt_combination *c, mt_err *err)
{
    mt_workspace *const w = d->workers[0];
    mt_arena mem;
    mt_err own = {0};
    const bool sampled = mt_tolerance_is_sampled(w->c);
    if (!is_followed(d) || !c->feasible || c->followed) {
        return MT_OK;
    }
    const long most = d->c->search.max_evaluations;
    if (most > 0 && most - d->evals < catalogue_search_verdict(d)) {
        d->stop = d->stop == MT_STOP_USER ? MT_STOP_USER : MT_STOP_MAX_EVALS;
        c->feasible = false; /* not known */
        c->judged = false;
        return MT_OK;
    }
    c->followed = true;
    MT_TRY(mt_arena_init(&mem, 0, err));
    mt_status rc = mt_workspace_eval(w, c->t, false, &d->values[0], &own);
    rc = rc == MT_OK && mt_drive_positions_any(w->p)
             ? follow_combination_drives(w, c, &mem, &own)
             : rc;
    rc = rc == MT_OK && sampled ? verify_tolerances(w, c, &mem, &own) : rc;
    const bool over_positions = c->feasible && d->n_broken < BROKEN_MOST;
    rc = rc == MT_OK && over_positions && mt_search_has_positions(w->c)
             ? verify_positions(d, c, &mem, &own)
             : rc;
    mt_arena_free(&mem);
    if (rc == MT_E_INTERRUPTED) {
        d->stop = MT_STOP_USER;
        c->feasible = false; /* not known */
        c->judged = false;
        return MT_OK;
    }
    d->evals += c->evals; /* of which one, counted before, stands for the evaluation here */
    c->feasible = c->feasible && rc == MT_OK;
    if (c->feasible) {
        mt_workspace_judged(w, c->f[0]);
    }
    return mt_pass_final(rc, &own, err);
}

static mt_status verify_designs(void *context, int worker, int task, mt_task_path *own,
                                mt_err *err)
{
    (void)own;
    const judging *const j = context;
    const int end = (task + 1) * PER_TASK < j->n ? (task + 1) * PER_TASK : j->n;
    for (int i = task * PER_TASK; i < end; i++) {
        MT_TRY(verify_design(j->d, worker, &j->list[i], err));
    }
    return MT_OK;
}

mt_status mt_catalogue_search_close(const mt_subproblem *whole, const double *x,
                                    mt_workspace *w, mt_arena *mem, mt_subproblem *out,
                                    mt_err *err)
{
    const mt_problem *const p = whole->p;
    MT_TRY(mt_subproblem_copy(whole, mem, out, err));
    for (int i = 0; i < p->n; i++) {
        if (p->study->variables[i].n_catalogue > 0) {
            mt_subproblem_bound(out, i, x[i], x[i]);
        }
    }
    return mt_subproblem_lay_out(out, NULL, 0, NULL, w, mem, err);
}

/* The subproblem with c's catalogue values; w is set to it. */
static mt_status close_on(const mt_catalogue_search *d, const mt_combination *c, long budget,
                          mt_workspace *w, mt_arena *mem, mt_subproblem *out, mt_err *err)
{
    const mt_problem *const p = d->p;
    double *const x = mt_arena_f64(mem, (size_t)p->n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < d->n_listed; k++) {
        const mt_choice *const own = &d->choice[k];
        memcpy(x + own->first, mt_choice_row(own, c->pick[k]), (size_t)own->n * sizeof *x);
    }
    MT_TRY(mt_catalogue_search_close(d->c, x, w, mem, out, err));
    if (out->search.starts <= 0) {
        out->search.starts = STARTS_BASE + (STARTS_PER_VARIABLE * (p->n - d->n_set));
        out->search.agree = out->rows.eq.n < p->n - d->n_set ? STARTS_AGREE : 0;
    }
    out->search.max_evaluations = budget > 1 ? budget - 1 : budget; /* its objectives */
    out->proof_work = fmin(out->proof_work, MT_CERTIFY_WORK);       /* there are many */
    out->hint = c->from;
    out->best_alone = true;
    out->as_found = true;
    out->cuts_known = d->cuts;
    return MT_OK;
}

/* The subproblem of a combination with a known design: from there, to the nearest of equally
 * good ones. */
static void search_again(mt_subproblem *closed, const double *known)
{
    closed->hint = known;
    closed->search.starts = KNOWN_STARTS;
    closed->as_found = false;
}

/* All objectives at the design found, by one more evaluation. */
static mt_status evaluate_aims(mt_workspace *w, const mt_nlp_solution *s, bool placements,
                               mt_arena *mem, mt_combination *c, mt_err *err)
{
    mt_nlp_values v;
    MT_TRY(mt_subproblem_values_init(w->c, mem, &v, err));
    MT_TRY(mt_workspace_eval(w, c->t, false, &v, err));
    c->evals++;
    for (int k = 0; k < w->c->n_stages; k++) {
        const bool clearance = mt_objective_is(w->c->stages[k].type, MT_BANDS);
        c->f[k] =
            k == 0 && placements && clearance ? s->f : mt_objective_stage_value(w, k, NULL);
    }
    return MT_OK;
}

static mt_status search_closed(mt_workspace *w, mt_arena *mem, mt_combination *c, mt_err *err)
{
    mt_nlp_result plain = {0};
    mt_mode_placement_result placements = {0};
    mt_err why = {0};
    int stage = 0;
    const bool bands = w->p->n_avoidances > 0;
    MT_TRY(bands ? mt_mode_placements_solve(&w, 1, NULL, mem, &placements, err)
                 : mt_search_over_tolerances(&w, 1, mem, &plain, &stage, NULL, &why, err));
    const int n = bands ? placements.n_solutions : plain.n_solutions;
    c->evals = bands ? placements.evals : plain.evals;
    c->starts = bands ? placements.starts : plain.starts;
    c->stop = bands ? placements.stop : plain.stop;
    c->judged = c->stop != MT_STOP_USER;
    if (n == 0) {
        return MT_OK;
    }
    const mt_nlp_solution *const best =
        bands ? placements.solutions[0].found : &plain.solutions[0];
    memcpy(c->t, best->t, (size_t)w->p->n * sizeof *c->t);
    c->missed = (mt_missed){best->violation, best->squares};
    c->kkt = best->kkt;
    c->singular = best->singular;
    c->feasible = best->feasible;
    c->flat = best->flat;
    const mt_status rc = evaluate_aims(w, best, bands, mem, c, &why);
    if (rc != MT_OK) {
        c->feasible = false;
        c->missed.squares = HUGE_VAL;
    }
    return mt_pass_final(rc, &why, err);
}

/* Search the continuous variables of c once more for their
 * unidentifiable directions (c is unchanged); out->unidentifiable in mem. */
static mt_status catalogue_search_directions(mt_catalogue_search *d, const mt_combination *c,
                                             mt_arena *mem, mt_nlp_result *out, mt_err *err)
{
    mt_workspace *const w = d->workers[0];
    mt_subproblem closed;
    mt_mode_placement_result placements = {0};
    mt_err why = {0};
    int stage = 0;
    *out = (mt_nlp_result){.n_unidentifiable = 0};
    const long most = d->c->search.max_evaluations;
    mt_status rc = close_on(d, c, most > 0 ? most - d->evals : 0, w, mem, &closed, err);
    search_again(&closed, c->t);
    const bool bands = d->p->n_avoidances > 0;
    if (rc == MT_OK) {
        rc = bands ? mt_mode_placements_solve(&w, 1, NULL, mem, &placements, err)
                   : mt_search_over_tolerances(&w, 1, mem, out, &stage, NULL, &why, err);
    }
    if (bands) {
        *out = (mt_nlp_result){.evals = placements.evals,
                               .n_unidentifiable = placements.n_unidentifiable,
                               .unidentifiable = placements.unidentifiable,
                               .unidentifiable_effect = placements.unidentifiable_effect};
    }
    mt_workspace_back(w, d->c);
    return rc;
}

/* A copy of cuts in the search's memory, for the combinations that follow. */
static mt_status keep_cuts(mt_catalogue_search *d, const mt_tolerance_cuts *from, mt_err *err)
{
    const size_t n = (size_t)d->p->n;
    mt_tolerance_cuts *const cuts = mt_arena_alloc(d->mem, 1, sizeof *cuts);
    mt_tolerance_cut *const items = mt_arena_alloc(d->mem, (size_t)from->n, sizeof *items);
    double *const factors = mt_arena_f64(d->mem, n, (size_t)from->n);
    MT_TRY(mt_arena_check(d->mem, err));
    for (int i = 0; i < from->n; i++) {
        double *const factor = factors + ((size_t)i * n);
        memcpy(factor, from->items[i].factor, n * sizeof *factor);
        items[i] = from->items[i];
        items[i].factor = factor;
    }
    *cuts = (mt_tolerance_cuts){.n = from->n, .items = items};
    d->cuts = cuts;
    return MT_OK;
}

static mt_status verify_mixed(void *context, int worker, int task, mt_task_path *own,
                              mt_err *err)
{
    const judging *const j = context;
    mt_workspace *const w = j->d->workers[worker];
    mt_combination *const c = &j->list[j->first + task];
    mt_task_path *const before = w->task_path;
    mt_tolerance_cuts found = {.n = 0};
    mt_arena mem;
    mt_subproblem closed;
    MT_TRY(mt_arena_init(&mem, 0, err));
    w->task_path = own;
    mt_status rc = close_on(j->d, c, j->budget, w, &mem, &closed, err);
    if (j->settles) {
        search_again(&closed, c->from);
    }
    closed.cuts_found = j->finds ? &found : NULL;
    rc = rc == MT_OK ? search_closed(w, &mem, c, err) : rc;
    rc = rc == MT_OK && found.n > 0 ? keep_cuts(j->d, &found, err) : rc;
    w->task_path = before;
    mt_workspace_back(w, j->d->c);
    mt_arena_free(&mem);
    if (rc == MT_E_INTERRUPTED) {
        c->stop = MT_STOP_USER;
        c->judged = false;
        return MT_OK;
    }
    return rc;
}

/* Writes or reads the evaluated combinations of a task, where there are no continuous
 * variables. */
static void serialize_designs(void *context, int task, mt_serializer *serializer)
{
    const judging *const j = context;
    const int end = (task + 1) * PER_TASK < j->n ? (task + 1) * PER_TASK : j->n;
    for (int i = task * PER_TASK; i < end; i++) {
        mt_combination *const c = &j->list[i];
        mt_serializer_numbers(serializer, (size_t)j->d->p->n_stages, c->f);
        mt_serializer_numbers(serializer, 1, &c->missed.violation);
        mt_serializer_numbers(serializer, 1, &c->missed.squares);
        mt_serializer_long(serializer, &c->evals, 0, 1);
        mt_serializer_flag(serializer, &c->judged);
        mt_serializer_flag(serializer, &c->feasible);
        serializer->failed =
            serializer->failed || (c->feasible && !mt_is_held(c->missed.violation));
    }
    for (int i = task * PER_TASK;
         i < end && serializer->reads && !mt_serializer_is_read(serializer); i++) {
        mt_combination *const c = &j->list[i]; /* as if nothing had been read */
        memset(c->f, 0, (size_t)j->d->p->n_stages * sizeof *c->f);
        c->missed = (mt_missed){nan(""), HUGE_VAL};
        c->evals = 0;
        c->judged = false;
        c->feasible = false;
    }
}

/* In the order of the list; from position to position what may rank is followed later. */
static void note_step(mt_catalogue_search *d, const mt_combination *c)
{
    const mt_step one = {.evals = d->evals,
                         .f = c->f[0],
                         .violation = c->missed.violation,
                         .squares = c->missed.squares};
    if (c->judged && MT_HAS(c->missed.violation)) {
        mt_steps_add(&d->steps, &one);
    }
}

/* The first combination is searched for the corners of its tolerances that matter, by every
 * part of the work: all others begin with these. */
static mt_status search_first_alone(judging *j, mt_err *err)
{
    mt_catalogue_search *const d = j->d;
    const bool wanted = d->mixed && d->p->n_avoidances == 0 && !d->has_cuts && j->n > 0 &&
                        d->c->search.max_evaluations <= 0 && mt_tolerance_is_sampled(d->c);
    if (!wanted) {
        return MT_OK;
    }
    mt_task_path own = mt_task_path_enter(d->workers[0]->task_path, "first");
    own.inner = true;
    d->has_cuts = true;
    j->finds = true;
    const mt_status rc = verify_mixed(j, 0, 0, &own, err);
    j->finds = false;
    j->first = 1;
    return rc;
}

mt_status mt_catalogue_search_verify(mt_catalogue_search *d, int n, mt_combination *list,
                                     long budget, mt_err *err)
{
    judging j = {.d = d, .n = n, .list = list, .budget = budget};
    MT_TRY(search_first_alone(&j, err));
    const mt_tasks searches = {n - j.first, verify_mixed, NULL, &j, "combinations"};
    const mt_tasks designs = {(n + PER_TASK - 1) / PER_TASK, verify_designs, serialize_designs,
                              &j, "lots of combinations"};
    MT_TRY(mt_workers_run(d->n_workers, d->workers[0]->task_path,
                          d->mixed ? &searches : &designs, err));
    long n_designs = 0; /* those on record among them; what is mixed counts where it searches */
    for (int i = 0; i < n; i++) {
        n_designs += d->mixed ? 0 : list[i].evals;
        d->evals += list[i].evals;
        note_step(d, &list[i]);
        d->starts += list[i].starts;
        d->stop = list[i].stop > d->stop ? list[i].stop : d->stop;
    }
    mt_workspace_note_designs(d->workers[0], n_designs);
    return MT_OK;
}

/* The search of a combination once more took another way, as a budget may make it do. */
static bool is_worse(const mt_catalogue_search *d, const mt_combination *again,
                     const mt_combination *before)
{
    const mt_merit x = {before->feasible, before->missed.squares, d->p->n_stages, before->f};
    const mt_merit y = {again->feasible, again->missed.squares, d->p->n_stages, again->f};
    return !again->judged || !again->feasible || mt_merit_before(&x, &y, MT_EQUAL_FOUND);
}

/* Search those of best[n] that are flat once more for the design
 * nearest to the original; before, any of the equally good designs was enough and takes less
 * time. Only where mixed. */
static mt_status catalogue_search_settle(mt_catalogue_search *d, int n,
                                         mt_combination *const *best, mt_err *err)
{
    const long most = d->c->search.max_evaluations;
    judging j = {.d = d, .settles = true};
    int *const of = mt_arena_int(d->mem, (size_t)n);
    long evals = 0;
    MT_TRY(mt_arena_check(d->mem, err));
    for (int i = 0; i < n; i++) {
        if (best[i]->flat && best[i]->feasible && best[i]->judged) {
            of[j.n++] = i;
            evals = best[i]->evals > evals ? best[i]->evals : evals;
        }
    }
    if (j.n == 0 || d->stop == MT_STOP_USER) {
        return MT_OK;
    }
    j.budget = most > 0 ? (most - d->evals) / j.n : 0;
    if (most > 0 && j.budget <= evals) {
        return MT_OK; /* not even what was searched could be searched again */
    }
    MT_TRY(mt_catalogue_search_alloc(d, j.n, &j.list, err));
    for (int i = 0; i < j.n; i++) {
        memcpy(j.list[i].pick, best[of[i]]->pick, (size_t)d->n_listed * sizeof(int));
        j.list[i].from = best[of[i]]->t;
        mt_catalogue_search_set(d, &j.list[i]);
    }
    const mt_tasks searches = {j.n, verify_mixed, NULL, &j, "nearest of equal designs"};
    MT_TRY(mt_workers_run(d->n_workers, d->workers[0]->task_path, &searches, err));
    for (int i = 0; i < j.n; i++) {
        d->evals += j.list[i].evals;
        d->starts += j.list[i].starts;
        d->stop = j.list[i].stop == MT_STOP_USER ? MT_STOP_USER : d->stop;
        if (!is_worse(d, &j.list[i], best[of[i]])) {
            *best[of[i]] = j.list[i];
        }
    }
    return MT_OK;
}

/*
 * Directions that the goals do not settle, where there are catalogues. A catalogue is one where
 * each of its values in turn, all else as it is in the best combination, changes no goal by its
 * tolerance (and no objective but the change, which always asks for the value nearest to the
 * original).
 */

/* Residuals and objectives carry no tolerance: relative to their size, as elsewhere (nlp.h). */
static const double VALUE_TOL = 1e-6;
/* Evaluations without which the search of a best combination is not begun once more. */
enum { SEARCH_LEAST = 50 };

typedef struct crossing {
    mt_catalogue_search *d;
    mt_nlp_values v;
    int rows;
    double *at; /* [rows] rows in tolerances at the best combination */
    double *now;
    int *below;   /* [2 x bands] assignments at both */
    double *t;    /* [n + 1] */
    mt_status rc; /* what ends the comparison */
    mt_err err;
} crossing;

/* Rows divided by their tolerances at x->t; false where a goal has no value. */
static bool evaluate_crossing_rows(crossing *x, double *rows, int *below)
{
    mt_workspace *const w = x->d->workers[0];
    int n = 0;
    if (x->rc != MT_OK) {
        return false;
    }
    const mt_status rc = mt_workspace_eval(w, x->t, false, &x->v, &x->err);
    bool known = rc == MT_OK;
    x->rc = mt_is_final(rc) ? rc : MT_OK;
    x->d->evals++;
    for (int i = 0; i < w->c->rows.eq.n && known; i++) {
        rows[n++] = x->v.eq[i] / w->c->rows.eq.tol[i];
    }
    for (int i = 0; i < w->c->rows.in.n && known; i++) {
        rows[n++] = x->v.in[i] / w->c->rows.in.tol[i];
    }
    for (int i = 0; i < w->c->rows.res.n && known; i++) {
        rows[n++] = w->r[i] / VALUE_TOL;
    }
    for (int k = 0; k < w->c->n_stages && known; k++) {
        const mt_objective_type type = w->c->stages[k].type;
        const bool counts =
            mt_objective_is(type, MT_AMOUNT) || mt_objective_is(type, MT_SHAKES);
        rows[n++] = counts ? mt_objective_stage_value(w, k, NULL) / VALUE_TOL : 0.0;
    }
    for (int i = 0; i < w->c->n_avoidances && known; i++) {
        const mt_avoidance *const c = &w->c->avoidances[i];
        const mt_modes *const modes = &w->views[c->view].analysis->modes;
        known = MT_HAS(mt_avoidance_find_modes(c, modes, below + c->first));
        rows[n++] = mt_avoidance_margin(w, c) / c->tolerance;
    }
    return known;
}

/* The size that makes an objective's change relative; 1 for the other rows. */
static double size_of(const crossing *x, int row)
{
    const mt_problem *const p = x->d->p;
    const int first = x->d->c->rows.eq.n + x->d->c->rows.in.n + x->d->c->rows.res.n;
    const bool stage = row >= first && row < first + p->n_stages;
    return stage ? fmax(fabs(x->at[row]) * VALUE_TOL, VALUE_TOL) : 1.0;
}

/* Greatest change of any row, in tolerances, over all values of a choice; infinite where a
 * mode placement changes or a value does not exist. */
static double effect_of(crossing *x, const mt_choice *choice, const double *best)
{
    const mt_problem *const p = x->d->p;
    const size_t size = (size_t)choice->n * sizeof *x->t;
    double most = 0.0;
    for (int k = 0; k < choice->n_rows && most < 1.0; k++) {
        const double *const row = mt_choice_row(choice, k);
        for (int i = 0; i < choice->n; i++) {
            x->t[choice->first + i] = mt_problem_t(p, choice->first + i, row[i]);
        }
        if (!evaluate_crossing_rows(x, x->now, x->below + p->n_bands) ||
            memcmp(x->below, x->below + p->n_bands, (size_t)p->n_bands * sizeof(int)) != 0) {
            most = HUGE_VAL;
        }
        for (int r = 0; r < x->rows && most < 1.0; r++) {
            most = fmax(most, fabs(x->now[r] - x->at[r]) / size_of(x, r));
        }
    }
    memcpy(x->t + choice->first, best + choice->first, size);
    return most;
}

static mt_status cross(crossing *x, const double *best, const mt_nlp_result *continuous,
                       mt_nlp_result *out, mt_err *err)
{
    const size_t n = (size_t)x->d->p->n;
    const size_t room = (size_t)x->d->n_listed + (size_t)continuous->n_unidentifiable;
    out->unidentifiable = mt_arena_f64(x->d->mem, n, room);
    out->unidentifiable_effect = mt_arena_f64(x->d->mem, room, 1);
    MT_TRY(mt_arena_check(x->d->mem, err));
    const bool known = evaluate_crossing_rows(x, x->at, x->below);
    for (int k = 0; k < x->d->n_listed && known; k++) {
        const mt_choice *const own = &x->d->choice[k];
        const double effect = own->n_rows > 1 ? effect_of(x, own, best) : HUGE_VAL;
        if (effect < 1.0) {
            double *const way =
                out->unidentifiable + ((size_t)out->n_unidentifiable * n) + own->first;
            for (int i = 0; i < own->n; i++) {
                way[i] = 1.0 / sqrt((double)own->n);
            }
            out->unidentifiable_effect[out->n_unidentifiable++] = effect;
        }
    }
    if (x->rc != MT_OK) {
        return mt_fail(err, x->rc, "%s", x->err.text);
    }
    for (int k = 0; k < continuous->n_unidentifiable; k++) {
        memcpy(out->unidentifiable + ((size_t)out->n_unidentifiable * n),
               continuous->unidentifiable + ((size_t)k * n), n * sizeof(double));
        out->unidentifiable_effect[out->n_unidentifiable++] =
            continuous->unidentifiable_effect[k];
    }
    return MT_OK;
}

/* Evaluations that they take at most: every value of each catalogue, and a search. */
static long questions(const mt_catalogue_search *d)
{
    long n = d->mixed ? SEARCH_LEAST : 1;
    for (int k = 0; k < d->n_listed; k++) {
        n += d->choice[k].n_rows;
    }
    return n;
}

/* Unidentifiable directions at the best combination, into
 * out: single catalogues of which any value serves, and directions of the continuous variables
 * with the catalogues fixed. Searches that combination once more where mixed. */
static mt_status catalogue_search_unidentifiable(mt_catalogue_search *d,
                                                 const mt_combination *best, mt_nlp_result *out,
                                                 mt_err *err)
{
    crossing x = {.d = d};
    const long most = d->c->search.max_evaluations;
    if (most > 0 && most - d->evals < questions(d)) {
        out->stop = out->stop == MT_STOP_USER ? MT_STOP_USER : MT_STOP_MAX_EVALS;
        return MT_OK;
    }
    mt_nlp_result continuous = {0};
    const mt_problem *const p = d->p;
    x.rows =
        d->c->rows.eq.n + d->c->rows.in.n + d->c->rows.res.n + p->n_stages + p->n_avoidances;
    x.at = mt_arena_f64(d->mem, (size_t)x.rows, 1);
    x.now = mt_arena_f64(d->mem, (size_t)x.rows, 1);
    x.below = mt_arena_int(d->mem, 2 * (size_t)p->n_bands + 1);
    x.t = mt_arena_f64(d->mem, (size_t)p->n + 1, 1);
    MT_TRY(mt_arena_check(d->mem, err));
    MT_TRY(mt_subproblem_values_init(d->c, d->mem, &x.v, err));
    memcpy(x.t, best->t, (size_t)p->n * sizeof *x.t);
    if (d->mixed) {
        MT_TRY(catalogue_search_directions(d, best, d->mem, &continuous, err));
        d->evals += continuous.evals;
    }
    MT_TRY(cross(&x, best->t, &continuous, out, err));
    out->evals = d->evals;
    return MT_OK;
}

/* The search: every combination where they are few, else by proof or from near designs. */

/* Designs that are kept for alternatives, where the study does not ask for more. */
enum { KEPT = 16 };

bool mt_study_has_catalogues(const mt_study *study)
{
    for (int i = 0; i < study->n_variables; i++) {
        if (study->variables[i].n_catalogue > 0) {
            return true;
        }
    }
    return false;
}

static mt_status list_catalogue_variables(mt_catalogue_search *d, mt_err *err)
{
    const mt_problem *const p = d->p;
    d->values = mt_arena_alloc(d->mem, (size_t)d->n_workers, sizeof *d->values);
    d->steps = mt_steps_new(MT_STEPS_MOST, d->mem);
    MT_TRY(mt_arena_check(d->mem, err));
    d->n_listed = p->n_choices;
    d->choice = p->choices;
    for (int k = 0; k < d->n_listed; k++) {
        d->n_set += d->choice[k].n;
    }
    d->mixed = d->n_set < p->n;
    for (int i = 0; i < d->n_workers && !d->mixed; i++) {
        MT_TRY(mt_subproblem_values_init(d->c, d->mem, &d->values[i], err));
    }
    return MT_OK;
}

void mt_catalogue_search_set(const mt_catalogue_search *d, mt_combination *c)
{
    const mt_problem *const p = d->p;
    double change = 0.0;
    for (int k = 0; k < d->n_listed; k++) {
        const mt_choice *const own = &d->choice[k];
        const double *const row = mt_choice_row(own, c->pick[k]);
        for (int j = 0; j < own->n; j++) {
            const int i = own->first + j;
            const double t = mt_problem_t(p, i, row[j]);
            const double away = t - d->c->origin_t[i];
            c->t[i] = t;
            change += 0.5 * p->study->variables[i].weight * away * away;
        }
    }
    c->change = change;
}

/* The best of some combinations. */
typedef struct ranking_of_combinations {
    int most;
    int n;
    mt_combination **best; /* [most] */
} ranking_of_combinations;

/* Ranks list[n] among those of r, by insertion, so that equal ones keep their order. What would
 * be among them is followed over its motion first. */
static mt_status rank_combinations(mt_catalogue_search *d, mt_combination *const *list, int n,
                                   ranking_of_combinations *r, mt_err *err)
{
    for (int i = 0; i < n; i++) {
        if (r->n < r->most || mt_catalogue_search_before(d, list[i], r->best[r->n - 1])) {
            MT_TRY(mt_catalogue_search_follow(d, list[i], err));
        }
        if (!list[i]->judged || !MT_HAS(list[i]->missed.violation)) {
            continue;
        }
        int at = r->n < r->most ? r->n++ : r->most;
        for (; at > 0 && mt_catalogue_search_before(d, list[i], r->best[at - 1]); at--) {
            if (at < r->most) {
                r->best[at] = r->best[at - 1];
            }
        }
        if (at < r->most) {
            r->best[at] = list[i];
        }
    }
    return MT_OK;
}

/*
 * All combinations, best first. Each has a lower bound of the first objective, over all values
 * of its continuous variables (problem/objective.h); they are judged in the order of these, and
 * the search ends where the next one's is above the last design of the list that is asked for.
 * Where continuous variables remain, a combination is a search of many evaluations: before it
 * comes a short certificate (catalogue_search_prove.h) with the last design of the list as a
 * cap. What it excludes has no design that could be listed, or none at all, and is not
 * searched; a design that it meets is one more start. Without any design that meets all goals
 * the nearest misses are wanted, and what was excluded is searched, too.
 *
 * A batch has one cap: nothing depends on the workers. Under a budget of evaluations, which is
 * shared out before anything is begun, all are judged in the order of their change.
 */
/* Combinations between two looks at what is left to do: enough for any number of workers, few
 * enough to stop in time. Fixed, so that results do not depend on the workers. */
enum { BATCH = 4096, BATCH_MIXED = 16 };
/* Of a budget, what each combination of a batch may use at least. */
enum { LEAST_BUDGET = 20 };
/* Work of the certificate of a combination, in boxes: less than its search takes. */
static const double LOOK = 200.0;
/* ... and of all of them together, of the budget of proofs. */
static const double PART = 0.2;
/* First objectives that differ by less are equal where others decide between them. */
static const double EQUAL = 1e-9;

typedef struct enumeration {
    mt_catalogue_search *d;
    ranking_of_combinations *ranking;
    mt_catalogue_search_report *report;
    int n;
    mt_combination *list;               /* [n] by ascending bound */
    int asked;                          /* designs of the list */
    bool looks;                         /* certificates come before searches */
    double last;                        /* objective of the last design asked for; HUGE_VAL */
    double work;                        /* of all looks, as certificates count it */
    mt_proof_cap *caps;                 /* [n_workers] */
    mt_catalogue_search_proofs *proofs; /* [n_workers] */
    double *bounds;                     /* [2 n x n_workers] */
    int first;                          /* combination of the first look */
    mt_catalogue_search_look at[BATCH_MIXED];
} enumeration;

/* All combinations, the last variable fastest. */
static mt_status list_all(enumeration *e, mt_err *err)
{
    const mt_catalogue_search *const d = e->d;
    MT_TRY(mt_catalogue_search_alloc(d, e->n, &e->list, err));
    for (int i = 0; i < e->n; i++) {
        int rest = i;
        for (int k = d->n_listed - 1; k >= 0; k--) {
            const int values = d->choice[k].n_rows;
            e->list[i].pick[k] = rest % values;
            rest /= values;
        }
        mt_catalogue_search_set(d, &e->list[i]);
    }
    return MT_OK;
}

/* The bounds lower[n], upper[n] of the combination's designs. */
static void find_bounds(const mt_catalogue_search *d, const mt_combination *c, double *lower,
                        double *upper)
{
    for (int i = 0; i < d->p->n; i++) {
        lower[i] = d->c->lower[i];
        upper[i] = d->c->upper[i];
    }
    for (int k = 0; k < d->n_listed; k++) {
        const mt_choice *const own = &d->choice[k];
        const size_t size = (size_t)own->n * sizeof *lower;
        memcpy(lower + own->first, mt_choice_row(own, c->pick[k]), size);
        memcpy(upper + own->first, mt_choice_row(own, c->pick[k]), size);
    }
}

/* Lower bounds of the first objective; of the change of catalogue values alone it is itself. */
static void bound_all(enumeration *e)
{
    const mt_catalogue_search *const d = e->d;
    const mt_certify_cap *const cap = &e->caps[0].cap;
    const bool change = d->p->stages[0].type == MT_OBJECTIVE_CHANGE;
    const bool known = e->caps[0].known && d->c->search.max_evaluations <= 0;
    double *const lower = e->bounds;
    double *const upper = e->bounds + d->p->n;
    e->report->by_change = change;
    for (int i = 0; i < e->n; i++) {
        mt_combination *const c = &e->list[i];
        c->least = change ? c->change : -HUGE_VAL;
        if (known && (d->mixed || !change)) {
            find_bounds(d, c, lower, upper);
            c->least = fmax(c->least, cap->least(cap->context, lower, upper));
        }
    }
}

/* By the change of their catalogue values, then by the order of the list (pick is in one array
 * in that order). */
static int by_change(const mt_combination *x, const mt_combination *y)
{
    if (x->change != y->change) {
        return x->change < y->change ? -1 : 1;
    }
    return x->pick < y->pick ? -1 : x->pick > y->pick ? 1 : 0;
}

static int by_bound(const void *a, const void *b)
{
    const mt_combination *const x = a;
    const mt_combination *const y = b;
    if (x->least != y->least) {
        return x->least < y->least ? -1 : 1;
    }
    return by_change(x, y);
}

/* The order in which equal designs are listed. */
static int by_place(const void *a, const void *b)
{
    const mt_combination *const *const x = a;
    const mt_combination *const *const y = b;
    return by_change(*x, *y);
}

static mt_status begin(enumeration *e, mt_err *err)
{
    mt_catalogue_search *const d = e->d;
    const size_t n = (size_t)d->p->n;
    const size_t n_workers = (size_t)d->n_workers;
    e->caps = mt_arena_alloc(d->mem, n_workers, sizeof *e->caps);
    e->bounds = mt_arena_f64(d->mem, 2 * n, n_workers);
    MT_TRY(mt_arena_check(d->mem, err));
    for (size_t i = 0; i < n_workers; i++) {
        MT_TRY(mt_proof_cap_init(&e->caps[i], d->p, d->mem, err));
    }
    MT_TRY(list_all(e, err));
    bound_all(e);
    qsort(e->list, (size_t)e->n, sizeof *e->list, by_bound);
    e->looks = d->mixed && d->c->search.max_evaluations <= 0;
    if (!e->looks) {
        return MT_OK;
    }
    double *const x = mt_arena_f64(d->mem, n, BATCH_MIXED);
    e->proofs = mt_arena_alloc(d->mem, n_workers, sizeof *e->proofs);
    MT_TRY(mt_arena_check(d->mem, err));
    for (size_t i = 0; i < BATCH_MIXED; i++) {
        e->at[i].x = x + (i * n);
    }
    for (size_t i = 0; i < n_workers; i++) {
        MT_TRY(mt_catalogue_search_proofs_init(&e->proofs[i], d->c, d->mem, err));
    }
    return MT_OK;
}

/* No design with a first objective above this one is listed. */
static double cap_of(const enumeration *e)
{
    return e->last + (EQUAL * fabs(e->last));
}

static mt_status look_at(void *context, int worker, int task, mt_task_path *own, mt_err *err)
{
    (void)own;
    enumeration *const e = context;
    const mt_catalogue_search *const d = e->d;
    const bool capped = e->last < HUGE_VAL && e->caps[worker].known;
    double *const lower = e->bounds + ((ptrdiff_t)worker * 2 * d->p->n);
    double *const upper = lower + d->p->n;
    mt_arena mem;
    MT_TRY(mt_arena_init(&mem, 0, err));
    e->caps[worker].cap.below = cap_of(e);
    find_bounds(d, &e->list[e->first + task], lower, upper);
    const mt_status rc = mt_catalogue_search_look_at(&e->proofs[worker], lower, upper,
                                                     capped ? &e->caps[worker].cap : NULL, LOOK,
                                                     &mem, &e->at[task], err);
    mt_arena_free(&mem);
    return rc;
}

static void serialize_look(void *context, int task, mt_serializer *serializer)
{
    enumeration *const e = context;
    mt_catalogue_search_look_serialize(e->d->c, &e->at[task], serializer);
}

/* The design that a certificate met, as a start. */
static mt_status start_from(const mt_catalogue_search *d, const double *x, mt_combination *c,
                            mt_err *err)
{
    double *const from = mt_arena_f64(d->mem, (size_t)d->p->n + 1, 1);
    MT_TRY(mt_arena_check(d->mem, err));
    for (int i = 0; i < d->p->n; i++) {
        from[i] = mt_problem_t(d->p, i, x[i]);
    }
    c->from = from;
    return MT_OK;
}

/* Excludes of the next *n combinations what a certificate can: those that are left come first,
 * *n of them. */
static mt_status exclude(enumeration *e, int first, int *n, mt_err *err)
{
    mt_catalogue_search *const d = e->d;
    const mt_tasks tasks = {*n, look_at, serialize_look, e, "boxes of combinations"};
    int left = 0;
    e->first = first;
    for (int i = 0; i < *n; i++) {
        e->at[i] = (mt_catalogue_search_look){.x = e->at[i].x};
    }
    MT_TRY(mt_workers_run(d->n_workers, d->workers[0]->task_path, &tasks, err));
    for (int i = 0; i < *n; i++) {
        mt_combination *const c = &e->list[first + i];
        const mt_catalogue_search_look *const look = &e->at[i];
        e->work += (double)look->work;
        mt_work_counters_note(d->p->run->work, MT_WORK_MULTIPLICATIONS, look->multiplications);
        if (look->met) {
            MT_TRY(start_from(d, look->x, c, err));
        }
        if (look->excluded) {
            e->report->excluded++;
            e->report->beyond = fmin(e->report->beyond, e->last);
            continue;
        }
        const mt_combination kept = *c;
        *c = e->list[first + left];
        e->list[first + left++] = kept;
    }
    *n = left;
    e->looks = e->work < PART * d->c->proof_work;
    return MT_OK;
}

/* Number of the next n combinations that the budget allows, besides the verification of those
 * that might rank; *share: evaluations for each, 0: no limit. */
static int affordable(const enumeration *e, int n, long *share)
{
    const mt_catalogue_search *const d = e->d;
    const long most = d->c->search.max_evaluations;
    const long kept = e->ranking->most * catalogue_search_verdict(d);
    const long left = most - d->evals - (kept < most / 2 ? kept : most / 2);
    const long least = d->mixed ? LEAST_BUDGET : 1;
    *share = 0;
    if (most <= 0) {
        return n;
    }
    n = left / least < n ? (int)(left > 0 ? left / least : 0) : n;
    *share = n > 0 ? left / n : 0;
    return n;
}

/* True where no combination from `next` on can be among the designs asked for. */
static bool is_settled(const enumeration *e, const mt_combination *next)
{
    return e->last < HUGE_VAL && next->least > cap_of(e);
}

/* Judges n combinations, and ranks them. */
static mt_status judge(enumeration *e, int first, int n, long share, mt_err *err)
{
    const ranking_of_combinations *const r = e->ranking;
    mt_combination **const all = mt_arena_alloc(e->d->mem, (size_t)n, sizeof(mt_combination *));
    MT_TRY(mt_arena_check(e->d->mem, err));
    for (int i = 0; i < n; i++) {
        all[i] = &e->list[first + i];
    }
    MT_TRY(mt_catalogue_search_verify(e->d, n, e->list + first, share, err));
    MT_TRY(rank_combinations(e->d, all, n, e->ranking, err));
    e->last = r->n >= e->asked && r->best[e->asked - 1]->feasible ? r->best[e->asked - 1]->f[0]
                                                                  : HUGE_VAL;
    return MT_OK;
}

static mt_status judge_all(enumeration *e, mt_err *err)
{
    mt_catalogue_search *const d = e->d;
    const int batch = d->mixed ? BATCH_MIXED : BATCH;
    for (int first = 0; first < e->n && d->stop != MT_STOP_USER; first += batch) {
        const int size = e->n - first < batch ? e->n - first : batch;
        long share = 0;
        int now = affordable(e, size, &share);
        const bool spent = now < size;
        if (is_settled(e, &e->list[first])) {
            e->report->beyond = fmin(e->report->beyond, e->list[first].least);
            break;
        }
        MT_TRY(e->looks ? exclude(e, first, &now, err) : MT_OK);
        MT_TRY(judge(e, first, now, share, err));
        if (spent) {
            d->stop = d->stop == MT_STOP_USER ? MT_STOP_USER : MT_STOP_MAX_EVALS;
            break;
        }
    }
    return MT_OK;
}

static int by_exclusion(const void *a, const void *b)
{
    const mt_combination *const x = a;
    const mt_combination *const y = b;
    return x->judged != y->judged ? (x->judged ? -1 : 1) : by_bound(a, b);
}

/* Searches for the nearest misses among what was excluded, where none meets all goals. */
static mt_status judge_excluded(enumeration *e, mt_err *err)
{
    const ranking_of_combinations *const r = e->ranking;
    const int excluded = e->report->excluded;
    if (excluded == 0 || (r->n > 0 && r->best[0]->feasible) || e->d->n_broken > 0) {
        return MT_OK;
    }
    qsort(e->list, (size_t)e->n, sizeof *e->list, by_exclusion);
    e->ranking->n = 0; /* what it has stands in the list */
    e->report->excluded = 0;
    e->report->beyond = HUGE_VAL;
    for (int k = 0; k < excluded && e->d->stop != MT_STOP_USER; k += BATCH_MIXED) {
        const int n = excluded - k < BATCH_MIXED ? excluded - k : BATCH_MIXED;
        MT_TRY(mt_catalogue_search_verify(e->d, n, e->list + e->n - excluded + k, 0, err));
    }
    return MT_OK;
}

static mt_status enumerate(enumeration *e, mt_combination ***all, mt_err *err)
{
    mt_catalogue_search *const d = e->d;
    MT_TRY(begin(e, err));
    MT_TRY(judge_all(e, err));
    MT_TRY(d->stop == MT_STOP_DONE ? judge_excluded(e, err) : MT_OK);
    *all = mt_arena_alloc(d->mem, (size_t)e->n, sizeof(mt_combination *));
    MT_TRY(mt_arena_check(d->mem, err));
    for (int i = 0; i < e->n; i++) {
        (*all)[i] = &e->list[i];
    }
    qsort(*all, (size_t)e->n, sizeof(mt_combination *), by_place);
    e->report->all = d->stop == MT_STOP_DONE;
    return MT_OK;
}

/* Judges the n combinations, best first, until no other can be among the designs asked for.
 * (*all)[n]: all of them, in the order in which equal ones are listed; sets all, excluded and
 * beyond of the report. */
static mt_status enumerate_combinations(mt_catalogue_search *d, int n,
                                        ranking_of_combinations *ranking,
                                        mt_catalogue_search_report *report,
                                        mt_combination ***all, mt_err *err)
{
    enumeration e = {.d = d,
                     .ranking = ranking,
                     .report = report,
                     .n = n,
                     .asked = d->p->study->recommendations,
                     .last = HUGE_VAL};
    const mt_status rc = enumerate(&e, all, err);
    for (int i = 0; i < d->n_workers && e.proofs != NULL; i++) {
        mt_catalogue_search_proofs_free(&e.proofs[i]);
    }
    return rc;
}

/* In the form of any other search: no multipliers, a bound only where a continuous variable
 * stands at one. */
static mt_status to_solution(const mt_catalogue_search *d, const mt_combination *c,
                             mt_nlp_solution *out, mt_err *err)
{
    const mt_problem *const p = d->p;
    const size_t n = (size_t)p->n + 1;
    *out = (mt_nlp_solution){.t = c->t,
                             .f = c->f[0],
                             .violation = c->missed.violation,
                             .squares = c->missed.squares,
                             .feasible = c->feasible,
                             .singular = c->singular,
                             .kkt = c->kkt,
                             .bound = mt_arena_int(d->mem, n),
                             .mult_eq = mt_arena_f64(d->mem, (size_t)d->c->rows.eq.n, 1),
                             .mult_in = mt_arena_f64(d->mem, (size_t)d->c->rows.in.n + 1, 1),
                             .mult_bound = mt_arena_f64(d->mem, n, 1)};
    MT_TRY(mt_arena_check(d->mem, err));
    for (int i = 0; i < d->c->rows.eq.n; i++) {
        out->mult_eq[i] = nan("");
    }
    for (int i = 0; i < d->c->rows.in.n; i++) {
        out->mult_in[i] = nan("");
    }
    for (int i = 0; i < p->n; i++) {
        const bool discrete = p->study->variables[i].n_catalogue > 0;
        out->mult_bound[i] = nan("");
        out->bound[i] = discrete                      ? 0
                        : c->t[i] == d->c->lower_t[i] ? -1
                        : c->t[i] == d->c->upper_t[i] ? 1
                                                      : 0;
    }
    return MT_OK;
}

static mt_status collect_combinations(const mt_catalogue_search *d,
                                      const ranking_of_combinations *r, mt_nlp_result *out,
                                      mt_err *err)
{
    *out = (mt_nlp_result){
        .evals = d->evals, .starts = d->starts, .stop = d->stop, .steps = d->steps};
    out->solutions = mt_arena_alloc(d->mem, (size_t)r->n, sizeof *out->solutions);
    MT_TRY(mt_arena_check(d->mem, err));
    out->compromise = r->n > 0 && !r->best[0]->feasible;
    for (int i = 0; i < r->n && r->best[i]->feasible != out->compromise; i++) {
        MT_TRY(to_solution(d, r->best[i], &out->solutions[i], err));
        out->n_solutions++;
    }
    return MT_OK;
}

/* Where none satisfies its limits between the positions, those that satisfy them at the named
 * ones count as feasible. */
static bool take_broken(const ranking_of_combinations *r, mt_combination *const *all, int n)
{
    bool any = false;
    const bool none = r->n == 0 || !r->best[0]->feasible;
    for (int i = 0; i < n && none; i++) {
        any = any || all[i]->broken;
        all[i]->feasible = all[i]->feasible || all[i]->broken;
    }
    return any;
}

/* An interrupt ends a part of the search, and what was found before it stands. */
static mt_status unless_interrupted(mt_catalogue_search *d, mt_status rc)
{
    d->stop = rc == MT_E_INTERRUPTED ? MT_STOP_USER : d->stop;
    return rc == MT_E_INTERRUPTED ? MT_OK : rc;
}

mt_status mt_catalogue_search_solve(mt_workspace *const *workers, int n_workers, mt_arena *mem,
                                    mt_nlp_result *out, mt_catalogue_search_report *report,
                                    mt_err *err)
{
    mt_catalogue_search d = {.workers = workers,
                             .n_workers = n_workers,
                             .p = workers[0]->p,
                             .c = workers[0]->c,
                             .mem = mem};
    MT_TRY(list_catalogue_variables(&d, err));
    const int asked = d.p->study->recommendations;
    ranking_of_combinations r = {.most = asked > KEPT ? asked : KEPT};
    r.best = mt_arena_alloc(mem, (size_t)r.most, sizeof(mt_combination *));
    MT_TRY(mt_arena_check(mem, err));
    double n = 1.0;
    for (int k = 0; k < d.n_listed; k++) {
        n *= (double)d.choice[k].n_rows;
    }
    mt_combination **all = NULL;
    int n_all = 0;
    *report = (mt_catalogue_search_report){
        .mixed = d.mixed, .combinations = n, .beyond = HUGE_VAL, .best_within = nan("")};
    if (n > (double)(d.mixed ? MT_CATALOGUE_SEARCH_MOST_MIXED : MT_CATALOGUE_SEARCH_MOST)) {
        MT_TRY(mt_catalogue_search_near(&d, &all, &n_all, err));
        if (d.mixed && d.stop == MT_STOP_DONE) {
            MT_TRY(unless_interrupted(
                &d, mt_catalogue_search_branch(&d, &all, &n_all, report, err)));
        }
    } else {
        n_all = (int)n;
        MT_TRY(enumerate_combinations(&d, n_all, &r, report, &all, err));
    }
    if ((d.mixed || !report->all) && d.stop != MT_STOP_USER) {
        MT_TRY(
            unless_interrupted(&d, mt_catalogue_search_prove(&d, &all, &n_all, report, err)));
    }
    if (all == NULL) {
        return mt_fail_memory(err);
    }
    r.n = 0;
    MT_TRY(rank_combinations(&d, all, n_all, &r, err));
    report->broken = take_broken(&r, all, n_all);
    if (report->broken) {
        r.n = 0;
        MT_TRY(rank_combinations(&d, all, n_all, &r, err));
    }
    MT_TRY(catalogue_search_settle(&d, r.n < asked ? r.n : asked, r.best, err));
    for (int i = 0; i < n_all; i++) {
        report->judged += all[i]->judged ? 1 : 0;
        report->feasible += all[i]->feasible ? 1 : 0;
        report->followed += all[i]->followed && all[i]->feasible ? 1 : 0;
    }
    report->beyond = isfinite(report->beyond)
                         ? mt_objective_stage_shown(&d.p->stages[0], report->beyond)
                         : report->beyond;
    report->driven = (mt_drive_positions_any(d.p) || mt_search_has_positions(d.c)) && !d.mixed;
    MT_TRY(collect_combinations(&d, &r, out, err));
    const bool known = r.n > 0 && r.best[0]->feasible && d.stop != MT_STOP_USER;
    return known ? unless_interrupted(&d,
                                      catalogue_search_unidentifiable(&d, r.best[0], out, err))
                 : MT_OK;
}
