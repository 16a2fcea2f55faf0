/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The same question where variables come from catalogues. Without continuous variables every
 * combination is a design, and all are looked at: a move is possible where its rows, and
 * nothing else, are in the way, and it has to go as far as they say. That is exact. With
 * continuous variables the combinations that came nearest are closed on their values and
 * searched as in relaxation.c.
 */
#include <math.h>
#include <string.h>

#include "base/workers.h"
#include "problem/evaluate.h"
#include "problem/frequency.h"
#include "search/catalogue_search.h"
#include "search/relaxation.h"

/* Combinations in one task; combinations that came nearest which are looked at where there are
 * continuous variables. */
enum { PER_TASK = 256, NEAREST = 4 };

typedef struct enumeration {
    mt_workspace *const *workers;
    mt_nlp_values *values; /* [n_workers] */
    int total;
    mt_moves *tasks; /* [n_tasks] the least of each among a task's combinations */
    bool *stopped;   /* [n_tasks] */
} enumeration;

/* Coordinates of combination k: the last catalogue varies fastest. */
static void set_combination(const mt_problem *p, int k, double *t)
{
    int left = k;
    for (int i = p->n - 1; i >= 0; i--) {
        const mt_variable *const v = &p->study->variables[i];
        t[i] = mt_problem_t(p, i, v->catalogue[left % v->n_catalogue]);
        left /= v->n_catalogue;
    }
}

/* Frequency to which the edge of a band must move for the modes inside it to be outside; 0
 * where none is inside. NaN: unstable, or undecided. */
static double let_through(const mt_band *band, const mt_modes *modes, bool upper)
{
    double hz = mt_modal_indexed(modes) ? 0.0 : nan("");
    for (int i = 0; i < modes->count; i++) {
        const double f = modes->kind[i] == MT_MODE_FLEXIBLE ? mt_modal_hz(modes, i) : 0.0;
        if (f > band->lower_hz && f < band->upper_hz && MT_HAS(hz)) {
            /* the modes inside then lie above the upper edge, or below the lower one */
            hz = upper ? (hz > 0.0 ? fmin(hz, f) : f) : fmax(hz, f);
        }
    }
    return hz;
}

static const mt_modes *modes_of(const mt_workspace *w, int avoidance)
{
    return &w->views[w->c->avoidances[avoidance].view].analysis->modes;
}

/* Bands with a mode inside (beyond the tolerance), but the move's own. */
static bool other_bands_hold(const mt_workspace *w, const mt_move *m)
{
    for (int i = 0; i < w->c->n_avoidances; i++) {
        const mt_avoidance *const c = &w->c->avoidances[i];
        const int own = m->kind == MT_MOVE_EDGE && m->avoidance == i ? m->band : -1;
        mt_mode_band_pair p = mt_mode_band_pairs_all(modes_of(w, i), &c->bands);
        while (mt_mode_band_pairs_next(&p)) {
            if (p.b != own && mt_band_margin(p.band, p.hz, p.hz) < -c->tolerance) {
                return false;
            }
        }
        if (!mt_modal_indexed(p.modes)) {
            return false;
        }
    }
    return true;
}

/* Where the move's number has to be at the design just evaluated; NaN where that is not
 * enough. */
static double needed(const mt_workspace *w, const mt_move *m, const mt_nlp_values *v)
{
    const double rows = mt_relaxation_value(w, m, v);
    if (!MT_HAS(rows) || !other_bands_hold(w, m)) {
        return nan("");
    }
    if (m->kind != MT_MOVE_EDGE) {
        return rows;
    }
    if (w->c->tolerance_box != NULL) {
        return nan(""); /* the modes at hand are not those of the worst corner */
    }
    const mt_band *const band = &w->c->avoidances[m->avoidance].bands.items[m->band];
    const double f = let_through(band, modes_of(w, m->avoidance), m->upper);
    return f > 0.0 ? f : nan("");
}

static void record_needed_moves(const mt_workspace *w, const mt_nlp_values *v, mt_moves *moves)
{
    const double change = mt_subproblem_change(w->c, w->t);
    for (int k = 0; k < moves->n; k++) {
        mt_move *const m = &moves->items[k];
        const double to = needed(w, m, v);
        const double size = mt_relaxation_size(w->p, m, to);
        if (size > 0.0 && mt_relaxation_is_less(m, size, change)) {
            mt_relaxation_keep(m, size, change, to, w->x, w->p->n);
        }
    }
}

static mt_status look_at_some(void *context, int worker, int task, mt_task_path *place,
                              mt_err *err)
{
    (void)place;
    const enumeration *const e = context;
    mt_workspace *const w = e->workers[worker];
    const int end = (task + 1) * PER_TASK < e->total ? (task + 1) * PER_TASK : e->total;
    mt_nlp_values *const v = &e->values[worker];
    for (int k = task * PER_TASK; k < end && !e->stopped[task]; k++) {
        mt_err own = {0};
        set_combination(w->p, k, w->work);
        const mt_status rc = mt_workspace_eval(w, w->work, false, v, &own);
        if (mt_is_final(rc)) {
            return mt_fail(err, rc, "%s", own.text);
        }
        e->stopped[task] = rc == MT_E_INTERRUPTED;
        if (rc == MT_OK) {
            record_needed_moves(w, v, &e->tasks[task]);
        }
    }
    return MT_OK;
}

static mt_status enumerate(mt_workspace *const *workers, int n_workers, int total,
                           mt_arena *mem, mt_moves *out, mt_err *err)
{
    const int n_tasks = (total + PER_TASK - 1) / PER_TASK;
    enumeration e = {.workers = workers, .total = total};
    const size_t n = (size_t)workers[0]->p->n;
    const size_t n_moves = (size_t)out->n;
    e.values = mt_arena_alloc(mem, (size_t)n_workers, sizeof *e.values);
    e.tasks = mt_arena_alloc(mem, (size_t)n_tasks, sizeof *e.tasks);
    e.stopped = mt_arena_alloc(mem, (size_t)n_tasks, sizeof *e.stopped);
    double *const x = mt_arena_f64(mem, n * n_moves, (size_t)n_tasks); /* the tasks' designs */
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < n_workers; i++) {
        MT_TRY(mt_subproblem_values_init(workers[i]->c, mem, &e.values[i], err));
    }
    /* each task's own list of moves */
    for (int i = 0; i < n_tasks; i++) {
        mt_moves *const own = &e.tasks[i];
        *own = *out;
        own->items = mt_arena_alloc(mem, n_moves, sizeof *own->items);
        MT_TRY(mt_arena_check(mem, err));
        memcpy(own->items, out->items, n_moves * sizeof *own->items);
        for (size_t k = 0; k < n_moves; k++) {
            own->items[k].x = x + ((((size_t)i * n_moves) + k) * n);
        }
    }
    const mt_tasks tasks = {n_tasks, look_at_some, NULL, &e, "lots of combinations"};
    MT_TRY(mt_workers_run(n_workers, workers[0]->task_path, &tasks, err));
    for (int i = 0; i < n_tasks; i++) {
        out->stopped = out->stopped || e.stopped[i];
        mt_relaxation_merge(out, &e.tasks[i], workers[0]->p->n);
    }
    out->evals += total;
    return MT_OK;
}

/* With the catalogues closed on the values of design s. */
static mt_status relaxation_near(mt_workspace *const *workers, int n_workers,
                                 const mt_nlp_solution *s, long spent, mt_arena *mem,
                                 mt_moves *out, mt_err *err)
{
    const mt_subproblem *const whole = workers[0]->c;
    mt_subproblem closed;
    mt_moves found = {0};
    mt_nlp_solution near = *s;
    const mt_nlp_result from = {.n_solutions = 1, .solutions = &near, .evals = spent};
    double *const x = mt_arena_f64(mem, (size_t)whole->p->n, 1);
    MT_TRY(mt_arena_check(mem, err));
    mt_subproblem_x(whole, s->t, x);
    mt_status rc = mt_catalogue_search_close(whole, x, workers[0], mem, &closed, err);
    for (int i = 1; i < n_workers && rc == MT_OK; i++) {
        rc = mt_workspace_use(workers[i], &closed, err);
    }
    rc = rc == MT_OK ? mt_relaxation_solve(workers, n_workers, &from, NULL, mem, &found, err)
                     : rc;
    for (int i = 0; i < n_workers; i++) {
        mt_workspace_back(workers[i], whole);
    }
    if (rc == MT_OK) {
        mt_relaxation_merge(out, &found, whole->p->n);
        out->evals += found.evals;
        out->starts += found.starts;
        out->stopped = out->stopped || found.stopped;
        out->short_of_budget = out->short_of_budget || found.short_of_budget;
    }
    return rc;
}

mt_status mt_relaxation_catalogue(mt_workspace *const *workers, int n_workers,
                                  const mt_nlp_result *search, mt_arena *mem, mt_moves *out,
                                  mt_err *err)
{
    const mt_problem *const p = workers[0]->p;
    const long most = workers[0]->c->search.max_evaluations;
    double total = 1.0;
    bool mixed = false;
    for (int i = 0; i < p->n; i++) {
        const int n = p->study->variables[i].n_catalogue;
        mixed = mixed || n == 0;
        total *= n > 0 ? (double)n : 1.0;
    }
    MT_TRY(mt_relaxation_moves(workers[0]->c, mem, out, err));
    if (mixed) {
        const int n = search->n_solutions < NEAREST ? search->n_solutions : NEAREST;
        for (int i = 0; i < n && !out->stopped; i++) {
            MT_TRY(relaxation_near(workers, n_workers, &search->solutions[i],
                                   search->evals + out->evals, mem, out, err));
        }
    } else {
        out->short_of_budget = total > (double)MT_CATALOGUE_SEARCH_MOST ||
                               (most > 0 && total > (double)(most - search->evals));
        if (!out->short_of_budget) {
            MT_TRY(enumerate(workers, n_workers, (int)total, mem, out, err));
        }
    }
    mt_relaxation_rank(out);
    return MT_OK;
}
