/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The search: local solves from many starts, then judgement.
 *
 *     every start:  roots by least squares     where the equalities leave no freedom
 *                   least squares, Newton      where there are residuals and bounds only
 *                   SLSQP, restoration, Newton otherwise; a saddle is left along its direction
 *                   an infeasible end is a local minimum of the squares of the violations
 *     all ends:
 *         feasible ones only, if any; undetermined directions at the best, all ends pulled
 *                   back along them; equal ones merged; ranked; multipliers, KKT, singularity
 *
 * Nothing here depends on time, addresses or the order of memory: equal input, equal bytes.
 */
#include "nlp/nlp_priv.h"

#include <math.h>
#include <string.h>

#include "base/workers.h"

enum { ROUNDS = 3, HALVINGS = 6 };
/* So many times the first starts are made at most to meet every root twice. */
enum { ROOT_ROUNDS = 12 };
/* KKT residuals below this are local solutions. */
static const double STATIONARY = 1e-6;
/* Length of the first step away from a saddle. */
static const double SADDLE_STEP = 0.05;
/* Violation (in tolerances) below which an end is worth a Newton polish before a
 * restoration. */
static const double NEARLY = 1e4;

/* Newton from `last`, where SLSQP ended, if that serves better than from p, the best it met. */
static void polish_both(mt_nlp_engine *e, mt_nlp_point *p, mt_nlp_point *last, double *saddle)
{
    if (last->violation <= NEARLY) {
        mt_nlp_polish(e, MT_NLP_OBJECTIVE, last, saddle);
        if (mt_nlp_feasible(last) && (last->kkt <= STATIONARY || !mt_nlp_feasible(p))) {
            mt_nlp_point_copy(e, p, last);
            return;
        }
    }
    if (mt_nlp_feasible(p)) {
        mt_nlp_polish(e, MT_NLP_OBJECTIVE, p, saddle);
    }
}

/* Move p a little along `saddle`; false where there is none, or no value there. */
static bool step_off(mt_nlp_engine *e, const double *saddle, mt_nlp_point *p)
{
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    const double most = mt_max_abs(e->n, saddle);
    mt_nlp_point *const to = most > 0 ? mt_nlp_point_new(e, &e->scratch) : NULL;
    bool moved = false;
    if (to != NULL) {
        mt_nlp_point_copy(e, to, p);
        mt_axpy(e->n, SADDLE_STEP / most, saddle, to->t);
        moved = mt_nlp_evaluate(e, to->t, true, to);
        if (moved) {
            mt_nlp_point_copy(e, p, to);
        }
    }
    mt_arena_rewind(&e->scratch, mark);
    return moved;
}

/* SLSQP from p, then Newton; an infeasible end is restored first, if it can be. */
static void minimise_once(mt_nlp_engine *e, int n_rows, const int *rows, mt_nlp_point *p,
                          double *saddle)
{
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    mt_nlp_point *const last = mt_nlp_point_new(e, &e->scratch);
    memset(saddle, 0, (size_t)e->n * sizeof *saddle);
    if (last != NULL) {
        mt_nlp_slsqp(e, n_rows, rows, p, last);
        polish_both(e, p, last, saddle);
        if (!mt_nlp_feasible(p)) {
            mt_nlp_least_squares(e, MT_NLP_SQUARES, p);
            if (mt_nlp_feasible(p)) {
                mt_nlp_polish(e, MT_NLP_OBJECTIVE, p, saddle);
            }
        }
    }
    mt_arena_rewind(&e->scratch, mark);
}

void mt_nlp_minimise(mt_nlp_engine *e, int n_rows, const int *rows, mt_nlp_point *p)
{
    mt_nlp_point *const before = mt_nlp_point_new(e, &e->scratch);
    double *const saddle = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
    if (saddle == NULL || before == NULL) {
        mt_nlp_end(e, mt_fail_memory(e->err));
        return;
    }
    for (int round = 0; round < ROUNDS && !e->ended; round++) {
        minimise_once(e, n_rows, rows, p, saddle);
        if (round > 0 && !mt_nlp_better(p, before)) { /* the same again would end there again */
            mt_nlp_point_copy(e, p, before);
            return;
        }
        mt_nlp_point_copy(e, before, p);
        const bool last = round + 1 == ROUNDS || !mt_nlp_feasible(p);
        if (last || (!step_off(e, saddle, p) && p->kkt <= STATIONARY)) {
            return;
        }
    }
    mt_nlp_point_copy(e, p, before); /* the search ended on the way */
}

/* Equalities settle everything: roots. Where they turn out dependent, the objective decides. */
static void find_root(mt_nlp_engine *e, mt_nlp_point *p)
{
    mt_nlp_least_squares(e, MT_NLP_SQUARES, p);
    if (!mt_nlp_feasible(p) || e->ended) {
        return;
    }
    mt_nlp_weakness w;
    if (!mt_nlp_weakness_at(e, p, &e->scratch, &w)) {
        return;
    }
    if (w.curve && w.n_rows < e->n_free) {
        mt_nlp_minimise(e, w.n_rows, w.rows, p);
    }
    p->curve = w.curve;
}

static void descend(mt_nlp_engine *e, const int *all_rows, mt_nlp_point *p)
{
    const mt_nlp *const q = e->nlp;
    if (q->n_eq >= e->n_free) {
        find_root(e, p);
    } else if (q->n_res > 0 && q->n_eq == 0 && q->n_in == 0) {
        mt_nlp_least_squares(e, MT_NLP_RESIDUALS, p);
        mt_nlp_polish(e, MT_NLP_RESIDUALS, p, NULL);
    } else {
        mt_nlp_minimise(e, q->n_eq, all_rows, p);
    }
}

/* Local search from p, which has values. An infeasible end that is a saddle of the squares is
 * left. */
static void local_search(mt_nlp_engine *e, const int *all_rows, mt_nlp_point *p)
{
    mt_nlp_point *const before = mt_nlp_point_new(e, &e->scratch);
    double *const saddle = mt_nlp_f64(e, &e->scratch, (size_t)e->n, 1);
    for (int round = 0; before != NULL && saddle != NULL && round < ROUNDS; round++) {
        descend(e, all_rows, p);
        if (!mt_nlp_feasible(p)) {
            mt_nlp_polish(e, MT_NLP_SQUARES, p, saddle);
        }
        if (round > 0 && mt_nlp_better(before, p)) {
            mt_nlp_point_copy(e, p, before);
        }
        mt_nlp_point_copy(e, before, p);
        const bool last = round + 1 == ROUNDS || mt_nlp_feasible(p) || e->ended;
        if (last || !step_off(e, saddle, p)) {
            return;
        }
    }
}

/* Values at the start t, or half way to the origin, and so on. */
static bool begin(mt_nlp_engine *e, double *t, mt_nlp_point *p)
{
    for (int k = 0; k <= HALVINGS && !e->ended; k++) {
        if (mt_nlp_evaluate(e, t, true, p)) {
            return true;
        }
        for (int j = 0; j < e->n; j++) {
            t[j] = 0.5 * (t[j] + e->origin[j]);
        }
    }
    return false;
}

/* What one start left behind; slots are filled by workers in any order and read in order. */
typedef struct start_slot {
    mt_nlp_point *p;
    bool begun;
    long evals;
    mt_stop stop;
    mt_status fatal;
    mt_status refused;
    mt_err fatal_err;
    mt_err refused_err;
} start_slot;

typedef struct start_job {
    mt_nlp_engine *e; /* the search's own; read only while workers run */
    double *t;        /* n x starts */
    start_slot *slots;
    const int *rows;
    int first; /* of the sequence */
    int n;
    long budget; /* of these starts */
    bool search; /* false: only evaluate the starts */
    atomic_int abort;
} start_job;

/* The budget of start k: an even share. */
static long share(const start_job *job, int k)
{
    return (job->budget / job->n) + (k < job->budget % job->n ? 1 : 0);
}

static mt_status run_start(void *context, int worker, int k, mt_err *err)
{
    start_job *const job = context;
    const mt_nlp_engine *const all = job->e;
    start_slot *const slot = &job->slots[k];
    mt_nlp nlp = *all->nlp;
    mt_nlp_options opt = all->opt;
    mt_nlp_engine e;
    nlp.context = nlp.contexts != NULL ? nlp.contexts[worker] : nlp.context;
    opt.max_evals = share(job, k);
    if (opt.max_evals <= 0) {
        slot->stop = MT_STOP_MAX_EVALS;
        return MT_OK;
    }
    MT_TRY(mt_nlp_engine_init(&e, &nlp, &opt, err));
    e.err = &slot->fatal_err;
    e.evals = slot->evals;
    e.abort = &job->abort;
    e.df_scale = all->df_scale;
    if (!job->search) {
        slot->begun = begin(&e, job->t + (ptrdiff_t)k * e.n, slot->p);
    } else if (slot->begun && e.n_free > 0) {
        local_search(&e, job->rows, slot->p);
    }
    slot->p->start = job->first + k;
    slot->evals = e.evals;
    slot->stop = e.stop != MT_STOP_DONE ? e.stop : slot->stop;
    slot->fatal = e.fatal;
    if (slot->refused == MT_OK && e.refused != MT_OK) {
        slot->refused = e.refused;
        slot->refused_err = e.refused_err;
    }
    if (e.fatal != MT_OK || e.stop == MT_STOP_USER) {
        atomic_store(&job->abort, 1);
    }
    mt_nlp_engine_free(&e);
    return MT_OK;
}

/* Add up what the starts used, beside what was used before, and how they ended; the first
 * failure in order counts. */
static void collect(mt_nlp_engine *e, const start_job *job, long before)
{
    e->evals = before;
    for (int k = 0; k < job->n; k++) {
        const start_slot *const s = &job->slots[k];
        e->evals += s->evals;
        e->stop = s->stop == MT_STOP_USER || e->stop == MT_STOP_DONE ? s->stop : e->stop;
        if (s->fatal != MT_OK && e->fatal == MT_OK) {
            mt_nlp_end(e, mt_fail(e->err, s->fatal, "%s", s->fatal_err.text));
        }
        if (s->refused != MT_OK && e->refused == MT_OK) {
            e->refused = s->refused;
            e->refused_err = s->refused_err;
        }
    }
    e->ended = e->ended || e->stop == MT_STOP_USER;
}

/* Evaluate the starts of a job, then search from them; the scale of the objective is the first
 * job's. */
static void run_job(mt_nlp_engine *e, start_job *job)
{
    const long before = e->evals;
    for (int pass = 0; pass < 2 && e->fatal == MT_OK && e->stop != MT_STOP_USER; pass++) {
        job->search = pass == 1;
        const mt_status rc = mt_workers_run(e->nlp->n_workers, job->n, run_start, job, e->err);
        if (rc != MT_OK) {
            mt_nlp_end(e, rc);
        }
        collect(e, job, before);
        for (int k = 0; k < job->n && pass == 0 && job->first == 0; k++) {
            const double norm = job->slots[k].begun ? mt_norm2(e->n, job->slots[k].p->df) : 0.0;
            e->df_scale = fmax(e->df_scale, norm);
        }
    }
}

/* Local solves from starts all->starts .. all->starts + n - 1; their ends are added to the
 * list. */
static bool add_starts(mt_nlp_engine *e, mt_nlp_ends *all, int n)
{
    mt_arena *const mem = &e->scratch;
    int *const rows = mt_arena_int(mem, (size_t)e->nlp->n_eq);
    start_job job = {.e = e,
                     .rows = rows,
                     .first = all->starts,
                     .n = n,
                     .budget = e->opt.max_evals - e->evals};
    double *const t = mt_nlp_starts(e, all->starts + n, mem);
    job.slots = mt_arena_alloc(mem, (size_t)n, sizeof *job.slots);
    bool ok = t != NULL && rows != NULL && job.slots != NULL && mt_nlp_ends_grow(e, all, n);
    for (int k = 0; k < n && ok; k++) {
        job.slots[k].p = mt_nlp_point_new(e, mem);
        ok = job.slots[k].p != NULL;
    }
    if (!ok) {
        mt_nlp_end(e, mt_fail_memory(e->err));
        return false;
    }
    for (int i = 0; i < e->nlp->n_eq; i++) {
        rows[i] = i;
    }
    job.t = t + (ptrdiff_t)job.first * e->n;
    run_job(e, &job);
    for (int k = 0; k < n; k++) {
        if (job.slots[k].begun) {
            all->at[all->count++] = (mt_nlp_end_point){.p = job.slots[k].p, .hits = 1};
        }
    }
    all->starts += n;
    return e->fatal == MT_OK;
}

/*
 * The starts asked for; where the equalities settle everything and there is more than one root,
 * as many again each time, within the budget, until every root was met twice (what was met once
 * stands for as much that was not met at all: Good and Turing) and the last starts brought no
 * new one.
 */
static void all_starts(mt_nlp_engine *e, mt_nlp_ends *all, mt_nlp_result *out)
{
    const int first = e->n_free > 0 ? e->opt.starts : 1;
    bool more = add_starts(e, all, first) && e->open_starts;
    int before = 1;
    while (more && e->stop == MT_STOP_DONE && all->starts < ROOT_ROUNDS * first) {
        const int left = ROOT_ROUNDS * first - all->starts;
        int once = 0;
        const int roots = mt_nlp_roots(e, all, &once);
        if (once == 0 && roots <= before) {
            break;
        }
        before = roots;
        more = add_starts(e, all, all->starts < left ? all->starts : left);
    }
    out->starts = all->starts;
}

static mt_status finish(mt_nlp_engine *e, const mt_nlp_ends *all, mt_nlp_result *out)
{
    out->evals = e->evals;
    out->stop = e->stop;
    if (e->fatal != MT_OK) {
        return e->fatal;
    }
    if (all->count == 0 && e->stop == MT_STOP_DONE && e->refused != MT_OK) {
        return mt_fail(e->err, e->refused, "no start of the search has a value: %s",
                       e->refused_err.text);
    }
    return MT_OK;
}

mt_status mt_nlp_solve(const mt_nlp *nlp, const mt_nlp_options *opt, mt_arena *mem,
                       mt_nlp_result *out, mt_err *err)
{
    mt_nlp_engine e;
    *out = (mt_nlp_result){.stop = MT_STOP_DONE};
    MT_TRY(mt_nlp_engine_init(&e, nlp, opt, err));
    mt_nlp_ends all = {0};
    all_starts(&e, &all, out);
    mt_nlp_judge(&e, &all, mem, out);
    const mt_status rc = finish(&e, &all, out);
    mt_nlp_engine_free(&e);
    return rc;
}
