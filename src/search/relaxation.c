/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The search for one move. In the coordinates t of the study, with one more, s:
 *     minimise 1/2 s^2   subject to   in_i(t) + s >= 0 (i: rows of the moved number),
 *         eq_i(t) - s = 0,   all other rows as they are;
 * for a bound there is no s: its variable may leave it, and 1/2 (t_j - bound)^2 beyond it is
 * minimised. That says how far, s*, but seldom where: two limits that meet on one frequency
 * leave all designs of that frequency. So once more, from the design that was found and from
 * the original one,
 *     minimise the change 1/2 sum w_i (t_i - t_i(original))^2
 *         subject to the same rows with s = s* + SLACK (the bound beyond by as much),
 * where the slack gives the designs that are left an interior, and their least change one
 * place.
 */
#include "search/relaxation.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/workers.h"
#include "problem/evaluate.h"
#include "problem/tolerance_cut.h"
#include "search/drive_path.h"
#include "search/infeasible_presolve.h"
#include "search/mode_placements.h"

/* Local searches of one move in one assignment, those that are enough where they end at one
 * design (from the original, from what came nearest, and from afar), and what each may cost. */
enum { STARTS = 6, AGREE = 3, EVALUATIONS = 200, ASSIGNMENTS = 6 };
/* Where the study sets a budget: what a search of one move needs at least of it. */
enum { BUDGET_LEAST = 2 * EVALUATIONS };
/* A move smaller than this is none: then a design exists without it, and the search has missed
 * it. */
static const double LEAST = 1e-9;
/* Rounds of cuts of the tolerances, which end where a move that is needed is greater than the
 * one found by no more than rows are kept to. */
enum { ROUNDS = 8 };
static const double ENOUGH = MT_DEFAULT_TOLERANCE_PERCENT / 100.0;
/* Searches for the least change, and the part of a budget that is kept for them. */
enum { STARTS_CHANGE = 2, PART_CHANGE = 4 };
/* Far above what a move is known to (its square root is by how much a design that is the only
 * one moves), and below a digit that is shown of a number, and what rows are kept to. */
static const double SLACK = 1e-7;

typedef struct relaxed {
    mt_workspace *w;
    const mt_move *move;
    double bound_t; /* of a bound that is moved */
    bool settled;   /* how far is known: the change is minimised */
} relaxed;

typedef struct task_result {
    mt_arena mem;
    long evals;
    int starts;
    bool stopped;
} task_result;

typedef struct job {
    mt_workspace *const *workers;
    const mt_subproblem *c;
    mt_moves *moves;
    const double *near;
    mt_near_misses misses;
    mt_mode_placement_candidates assignments; /* to look into for moves of no bound */
    long budget;                              /* evaluations of each move */
    task_result *results;
} job;

/* 1/2 (distance beyond the old bound)^2. */
static void beyond_bound(const relaxed *r, const double *t, bool with_gradient,
                         mt_nlp_values *out)
{
    const int j = r->move->variable;
    const double d =
        r->move->upper ? fmax(t[j] - r->bound_t, 0.0) : fmin(t[j] - r->bound_t, 0.0);
    out->f = 0.5 * d * d;
    if (with_gradient) {
        memset(out->df, 0, (size_t)r->w->p->n * sizeof *out->df);
        out->df[j] = d;
    }
}

static void relaxation_rows(const relaxed *r, double s, bool with_gradient, mt_nlp_values *out)
{
    const mt_row_table *const rows = &r->w->c->rows;
    const ptrdiff_t n = r->w->p->n;
    const int n_in = rows->in.n;
    const int n_eq = rows->eq.n;
    if (!r->settled) {
        out->f = 0.5 * s * s;
    }
    if (with_gradient && !r->settled) {
        memset(out->df, 0, (size_t)n * sizeof *out->df);
    }
    if (with_gradient) {
        out->df[n] = r->settled ? 0.0 : s;
        memset(out->din + (n * n_in), 0, (size_t)n_in * sizeof *out->din);
        memset(out->deq + (n * n_eq), 0, (size_t)n_eq * sizeof *out->deq);
    }
    for (int i = 0; i < n_in; i++) {
        if (mt_relaxation_is_row(r->move, &rows->in.rows[i])) {
            out->in[i] += s;
            if (with_gradient) {
                out->din[i + (n * n_in)] = 1.0;
            }
        }
    }
    for (int i = 0; i < n_eq; i++) {
        if (mt_relaxation_is_row(r->move, &rows->eq.rows[i])) {
            out->eq[i] -= s;
            if (with_gradient) {
                out->deq[i + (n * n_eq)] = -1.0;
            }
        }
    }
}

static mt_status evaluate_relaxed(void *context, const double *t, bool with_gradient,
                                  mt_nlp_values *out, mt_err *err)
{
    const relaxed *const r = context;
    MT_TRY(mt_workspace_eval_uncounted(r->w, t, with_gradient, out, err));
    if (r->move->kind != MT_MOVE_BOUND) {
        relaxation_rows(r, t[r->w->p->n], with_gradient, out);
    } else if (!r->settled) {
        beyond_bound(r, t, with_gradient, out);
    }
    return MT_OK;
}

/* A design found with the move: what a workspace made anew says of it. */
typedef struct answer {
    mt_arena *mem;
    const double *near;     /* [n] where the search begins; NULL: nowhere */
    double *x;              /* [n] */
    double value;           /* that the number must have there; NaN: it does not do */
    long evals;             /* of its confirmations */
    mt_tolerance_cuts cuts; /* so far */
} answer;

/* The number that the move needs at the design t, over its tolerances, too. */
static mt_status confirm(mt_workspace *w, const mt_move *m, const double *t, answer *a,
                         mt_err *err)
{
    mt_nlp_values v;
    mt_err own = {0};
    MT_TRY(mt_subproblem_values_init(w->c, a->mem, &v, err));
    mt_status rc = mt_workspace_eval(w, t, false, &v, &own);
    a->evals++;
    rc = rc == MT_OK ? mt_tolerance_lower(w, &v, a->mem, &a->cuts, &own) : rc;
    if (rc != MT_OK) {
        return mt_pass_final(rc, &own, err);
    }
    a->value = mt_relaxation_value(w, m, &v);
    memcpy(a->x, w->x, (size_t)w->p->n * sizeof *a->x);
    /* The design has to hold between the positions of its drives, too. An edge is moved in one
     * position only, which says nothing of the others. */
    if (mt_drive_positions_any(w->p) && w->c->below != NULL) {
        bool kept = m->kind != MT_MOVE_EDGE;
        MT_TRY(kept ? mt_drive_path_kept(w, w->c->below, a->mem, &kept, &a->evals, err)
                    : MT_OK);
        a->value = kept ? a->value : nan("");
    }
    return MT_OK;
}

/* Keeps the design t of a move of that size where it precedes the one found and a new workspace
 * confirms it. *again: the move does not suffice for the worst within the tolerances, and a cut
 * was added. */
static mt_status keep_confirmed_move(const mt_subproblem *c, mt_move *m, double size,
                                     const double *t, answer *a, bool *again, mt_err *err)
{
    mt_workspace *fresh = NULL;
    const double change = mt_subproblem_change(c, t);
    a->value = nan("");
    a->cuts.added = 0;
    *again = false;
    if (!mt_relaxation_is_less(m, size, change)) {
        return MT_OK;
    }
    MT_TRY(mt_workspace_new(c->p, &fresh, err));
    mt_status rc = mt_workspace_use(fresh, c, err);
    rc = rc == MT_OK ? confirm(fresh, m, t, a, err) : rc;
    mt_workspace_delete(fresh);
    MT_TRY(rc);
    if (mt_tolerance_is_sampled(c)) {
        const double needed =
            MT_HAS(a->value) ? mt_relaxation_size(c->p, m, a->value) : HUGE_VAL;
        *again = a->cuts.added > 0 && !(needed <= size + ENOUGH);
        size = needed > size + SLACK ? needed : size;
    }
    if (MT_HAS(a->value) && mt_relaxation_is_less(m, size, change)) {
        mt_relaxation_keep(m, size, change, a->value, a->x, c->p->n);
    }
    return MT_OK;
}

static mt_nlp nlp_of(relaxed *r, mt_subproblem *c, const double *near, double *hint)
{
    const mt_move *const m = r->move;
    const int n = c->p->n;
    mt_nlp nlp = mt_workspace_nlp(r->w);
    nlp.eval = evaluate_relaxed;
    nlp.n_next = 0; /* they follow from rows that may be moved */
    nlp.context = r;
    nlp.hint = NULL;
    if (near != NULL) {
        memcpy(hint, near, (size_t)n * sizeof *hint);
        nlp.hint = hint;
    }
    if (m->kind == MT_MOVE_BOUND) {
        r->bound_t = mt_problem_t(c->p, m->variable, m->from);
        return nlp;
    }
    /* a case keeps room for one more coordinate */
    nlp.n = n + 1;
    c->lower_t[n] = m->target ? -MT_RELAXATION_MOST : 0.0;
    c->upper_t[n] = MT_RELAXATION_MOST;
    c->origin_t[n] = 0.0;
    hint[n] = 0.5 * MT_RELAXATION_MOST;
    return nlp;
}

/* Evaluations left for the move, without those of its confirmations and of following drives. */
static long left_of(const job *j, const mt_subproblem *c, const task_result *out,
                    const answer *a)
{
    return j->budget - out->evals - a->evals - (2 * (1 + mt_drive_path_most(c)));
}

/* nlp and opt: of the search for how far. */
static mt_status solve_move_size(mt_workspace *w, const mt_nlp *nlp, const mt_nlp_options *opt,
                                 task_result *out, mt_nlp_result *found, mt_err *err)
{
    mt_err why = {0};
    const mt_status own = mt_workspace_solve(w, nlp, opt, &out->mem, found, &why);
    out->evals += found->evals;
    out->starts += found->starts;
    out->stopped = out->stopped || found->stop == MT_STOP_USER;
    if (own != MT_OK) {
        found->n_solutions = 0;
    }
    return mt_pass_final(own, &why, err);
}

/* Searches the least total change with the move found; *to: its end, NULL: none found or no
 * budget. one: all searches ended at one design, so the slack allows only designs around it. */
static mt_status search_least_change(mt_nlp nlp, mt_nlp_options opt, const double *found,
                                     bool one, long left, task_result *out, const double **to,
                                     mt_err *err)
{
    relaxed *const r = nlp.context;
    const int k = r->move->kind == MT_MOVE_BOUND ? r->move->variable : nlp.n - 1;
    const bool down = r->move->kind == MT_MOVE_BOUND ? !r->move->upper : found[k] < 0.0;
    const double most = found[k] + (down ? -SLACK : SLACK);
    const size_t size = (size_t)nlp.n * sizeof *found;
    double *const lower = mt_arena_f64(&out->mem, (size_t)nlp.n, 1);
    double *const upper = mt_arena_f64(&out->mem, (size_t)nlp.n, 1);
    mt_nlp_result least = {0};
    *to = NULL;
    MT_TRY(mt_arena_check(&out->mem, err));
    if (left <= 0 || out->stopped) {
        return MT_OK;
    }
    memcpy(lower, nlp.lower, size);
    memcpy(upper, nlp.upper, size);
    lower[k] = r->move->kind == MT_MOVE_BOUND && !down ? lower[k] : fmax(most, lower[k]);
    upper[k] = r->move->kind == MT_MOVE_BOUND && down ? upper[k] : fmin(most, upper[k]);
    nlp.lower = lower;
    nlp.upper = upper;
    nlp.hint = found;
    opt.starts = STARTS_CHANGE;
    opt.skip = one ? STARTS_CHANGE - 1 : 0;
    opt.agree = 0;
    opt.max_evals =
        left < (long)STARTS_CHANGE * EVALUATIONS ? left : (long)STARTS_CHANGE * EVALUATIONS;
    r->settled = true;
    MT_TRY(solve_move_size(r->w, &nlp, &opt, out, &least, err));
    *to = least.n_solutions > 0 && least.solutions[0].feasible ? least.solutions[0].t : NULL;
    return MT_OK;
}

/* One search in subproblem c, to which w is set. */
static mt_status search_once(const job *j, mt_subproblem *c, mt_workspace *w, mt_move *m,
                             task_result *out, answer *a, bool *again, mt_err *err)
{
    relaxed r = {.w = w, .move = m};
    mt_nlp_result found = {0};
    mt_nlp_options opt = mt_nlp_options_default();
    opt.seed = c->search.seed;
    opt.starts = STARTS;
    const long most = (long)STARTS * EVALUATIONS;
    long left = left_of(j, c, out, a);
    left -= left / PART_CHANGE;
    *again = false;
    if (left <= 0) {
        return MT_OK;
    }
    opt.max_evals = left < most ? left : most;
    opt.agree = AGREE;
    opt.max_solutions = 1;
    opt.least_change = false;
    double *const hint = mt_arena_f64(&out->mem, (size_t)c->p->n + 1, 1);
    MT_TRY(mt_arena_check(&out->mem, err));
    const mt_nlp nlp = nlp_of(&r, c, a->near, hint);
    MT_TRY(solve_move_size(w, &nlp, &opt, out, &found, err));
    if (found.n_solutions == 0) {
        return MT_OK;
    }
    const mt_nlp_solution *const s = &found.solutions[0];
    const double size = sqrt(2.0 * s->f);
    if (!(size > LEAST) || !s->feasible || !mt_relaxation_is_less(m, size, 0.0)) {
        return MT_OK;
    }
    const double *least = NULL;
    a->value = nan("");
    const bool one = found.starts == AGREE && s->hits == AGREE;
    MT_TRY(search_least_change(nlp, opt, s->t, one, left_of(j, c, out, a), out, &least, err));
    MT_TRY(least != NULL ? keep_confirmed_move(c, m, size, least, a, again, err) : MT_OK);
    return MT_HAS(a->value) || *again ? MT_OK
                                      : keep_confirmed_move(c, m, size, s->t, a, again, err);
}

/* Search in subproblem c, to which w is set; afterwards in that with cuts, to which w is then
 * set. */
static mt_status search_in(const job *j, mt_subproblem *c, mt_workspace *w, mt_move *m,
                           const double *near, task_result *out, mt_err *err)
{
    mt_arena *const mem = &out->mem;
    answer a = {.mem = mem, .near = near, .x = mt_arena_f64(mem, (size_t)c->p->n, 1)};
    bool again = true;
    MT_TRY(mt_arena_check(mem, err));
    mt_status rc = search_once(j, c, w, m, out, &a, &again, err);
    for (int round = 1; again && round < ROUNDS && rc == MT_OK; round++) {
        mt_subproblem *const held = mt_arena_alloc(mem, 1, sizeof *held);
        MT_TRY(mt_arena_check(mem, err));
        MT_TRY(mt_subproblem_copy(c, mem, held, err));
        MT_TRY(mt_tolerance_add_cuts(c, &a.cuts, mem, &held->tolerance_box, err));
        MT_TRY(mt_subproblem_lay_out(held, c->below, 0, NULL, w, mem, err));
        rc = search_once(j, held, w, m, out, &a, &again, err);
    }
    out->evals += a.evals;
    return rc;
}

/* With bands: search in each placement that samples come nearest to, except where the move
 * cannot help the known miss. (A bound at which no miss stands may still open a way: in five of
 * 56 random studies with an answer it does.) Samples within the study's own bounds are the same
 * for all moves. */
static mt_status search_placements(const job *j, const mt_subproblem *plain, mt_workspace *w,
                                   int move, task_result *out, mt_err *err)
{
    mt_move *const m = &j->moves->items[move];
    mt_mode_placement_candidates near = j->assignments;
    mt_status rc = MT_OK;
    if (m->kind == MT_MOVE_BOUND) {
        rc = mt_mode_placement_candidates_near(w, ASSIGNMENTS, 0, &out->mem, &near, err);
        out->evals += near.evals;
    }
    for (int k = 0; k < near.n && rc == MT_OK && !out->stopped; k++) {
        mt_subproblem c;
        const int *const below = near.below + ((ptrdiff_t)k * plain->n_bands);
        const mt_near_miss *const miss = mt_relaxation_miss(&j->misses, below);
        if (miss != NULL && !miss->presses[move] && m->kind != MT_MOVE_BOUND) {
            continue;
        }
        rc = mt_subproblem_in_placement(plain, below, 0, NULL, w, &out->mem, &c, err);
        rc = rc == MT_OK ? search_in(j, &c, w, m, miss != NULL ? miss->t : j->near, out, err)
                         : rc;
        mt_workspace_back(w, plain);
    }
    return rc;
}

/* True where a short proof shows that no such move makes a design feasible, in its subproblem
 * c. For a bound only the range between the old and the new one is examined. */
static mt_status is_useless(const job *j, const mt_subproblem *c, const mt_move *m,
                            mt_arena *mem, bool *useless, mt_err *err)
{
    const int i = m->variable;
    mt_subproblem beyond = *c;
    if (m->kind == MT_MOVE_BOUND) {
        MT_TRY(mt_subproblem_copy(c, mem, &beyond, err));
        mt_subproblem_bound(&beyond, i, m->upper ? j->c->upper[i] : c->lower[i],
                            m->upper ? c->upper[i] : j->c->lower[i]);
    }
    const mt_infeasible_presolve_question q = {.c = &beyond,
                                               .but = m->kind == MT_MOVE_GOAL ? m->requirement
                                                                              : -1,
                                               .bands = m->kind != MT_MOVE_EDGE,
                                               .counted = true};
    return mt_infeasible_presolve(&q, mem, useless, err);
}

static mt_status search_move(void *context, int worker, int k, mt_task_path *own, mt_err *err)
{
    const job *const j = context;
    mt_workspace *const w = j->workers[worker];
    mt_task_path *const before = w->task_path;
    mt_move *const m = &j->moves->items[k];
    task_result *const out = &j->results[k];
    mt_subproblem c;
    bool useful = false;
    MT_TRY(mt_arena_init(&out->mem, 0, err));
    w->task_path = own;
    mt_status rc = mt_relaxation_subproblem(j->c, m, w, &out->mem, &c, &useful, err);
    if (rc == MT_OK && useful) {
        bool useless = false;
        rc = is_useless(j, &c, m, &out->mem, &useless, err);
        useful = !useless;
    }
    if (rc == MT_OK && useful) {
        rc = w->p->n_avoidances > 0 ? search_placements(j, &c, w, k, out, err)
                                    : search_in(j, &c, w, m, j->near, out, err);
    }
    w->task_path = before;
    mt_workspace_back(w, j->c);
    return rc;
}

/* With bands: the nearest misses, found before any move is tried. */
static mt_status look_around(job *j, const mt_mode_placement_result *placements, mt_arena *mem,
                             mt_moves *out, mt_err *err)
{
    mt_workspace *const w = j->workers[0];
    MT_TRY(mt_relaxation_misses(w, placements, out, mem, &j->misses, err));
    MT_TRY(mt_mode_placement_candidates_near(w, ASSIGNMENTS, 0, mem, &j->assignments, err));
    out->evals += j->misses.n + j->assignments.evals;
    return MT_OK;
}

mt_status mt_relaxation_solve(mt_workspace *const *workers, int n_workers,
                              const mt_nlp_result *search,
                              const mt_mode_placement_result *placements, mt_arena *mem,
                              mt_moves *out, mt_err *err)
{
    const mt_subproblem *const c = workers[0]->c;
    MT_TRY(mt_relaxation_moves(c, mem, out, err));
    const long most = c->search.max_evaluations; /* if the study sets one: an equal share */
    const long left = most - search->evals;
    job j = {.workers = workers,
             .c = c,
             .moves = out,
             .near = search->n_solutions > 0 ? search->solutions[0].t : NULL,
             .budget = most > 0 && out->n > 0 ? left / out->n : LONG_MAX,
             .results = mt_arena_alloc(mem, (size_t)out->n, sizeof *j.results)};
    const int n = out->n;
    const int least = c->n_avoidances > 0 ? BUDGET_LEAST + MT_GAP_SAMPLES_NEAR : BUDGET_LEAST;
    MT_TRY(mt_arena_check(mem, err));
    out->short_of_budget = j.budget < least;
    if (out->short_of_budget) {
        out->n = 0;
        return MT_OK;
    }
    if (c->n_avoidances > 0) {
        MT_TRY(look_around(&j, placements, mem, out, err));
        j.budget = most > 0 ? (left - out->evals) / out->n : LONG_MAX;
    }
    const mt_tasks tasks = {n, search_move, NULL, &j, "changes of the question"};
    const mt_status rc = mt_workers_run(n_workers, workers[0]->task_path, &tasks, err);
    for (int k = 0; k < n; k++) {
        out->evals += j.results[k].evals;
        out->starts += j.results[k].starts;
        out->stopped = out->stopped || j.results[k].stopped;
        mt_arena_free(&j.results[k].mem);
    }
    mt_relaxation_rank(out);
    return rc;
}
