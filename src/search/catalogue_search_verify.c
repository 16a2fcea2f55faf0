/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Judge combinations of catalogue values. Where nothing else varies a combination is a design:
 * one evaluation. Else it is a study of its own, in which the bounds of the catalogues'
 * variables are closed on their values.
 */
#include <math.h>
#include <string.h>

#include "base/run.h"
#include "base/workers.h"
#include "problem/avoidance.h"
#include "problem/evaluate.h"
#include "problem/objective.h"
#include "problem/tolerance.h"
#include "problem/tolerance_cut.h"
#include "prove/certify.h"
#include "search/catalogue_search.h"
#include "search/drive_path.h"
#include "search/mode_placements.h"
#include "search/search.h"

/* Combinations in one task: long enough to pay for its start, short enough to share out
 * well. */
enum { PER_TASK = 64 };
/* Starts of the continuous search of one combination: 4 + 2 n, where the study does not say. */
enum { STARTS_BASE = 4, STARTS_PER_VARIABLE = 2 };
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

long mt_catalogue_search_verdict(const mt_catalogue_search *d)
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
    if (most > 0 && most - d->evals < mt_catalogue_search_verdict(d)) {
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
        x[d->variable[k]] = p->study->variables[d->variable[k]].catalogue[c->pick[k]];
    }
    MT_TRY(mt_catalogue_search_close(d->c, x, w, mem, out, err));
    if (out->search.starts <= 0) {
        out->search.starts = STARTS_BASE + (STARTS_PER_VARIABLE * (p->n - d->n_listed));
    }
    out->search.max_evaluations = budget > 1 ? budget - 1 : budget; /* its objectives */
    out->proof_work = fmin(out->proof_work, MT_CERTIFY_WORK);       /* there are many */
    out->hint = c->from;
    out->best_alone = true;
    out->as_found = true;
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

mt_status mt_catalogue_search_directions(mt_catalogue_search *d, const mt_combination *c,
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

static mt_status verify_mixed(void *context, int worker, int task, mt_task_path *own,
                              mt_err *err)
{
    const judging *const j = context;
    mt_workspace *const w = j->d->workers[worker];
    mt_combination *const c = &j->list[task];
    mt_task_path *const before = w->task_path;
    mt_arena mem;
    mt_subproblem closed;
    MT_TRY(mt_arena_init(&mem, 0, err));
    w->task_path = own;
    mt_status rc = close_on(j->d, c, j->budget, w, &mem, &closed, err);
    if (j->settles) {
        search_again(&closed, c->from);
    }
    rc = rc == MT_OK ? search_closed(w, &mem, c, err) : rc;
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

mt_status mt_catalogue_search_verify(mt_catalogue_search *d, int n, mt_combination *list,
                                     long budget, mt_err *err)
{
    judging j = {.d = d, .n = n, .list = list, .budget = budget};
    const mt_tasks searches = {n, verify_mixed, NULL, &j, "combinations"};
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

mt_status mt_catalogue_search_settle(mt_catalogue_search *d, int n, mt_combination *const *best,
                                     mt_err *err)
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
