/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The search: local solves from many starts, then judgement.
 *
 *     every start:  roots by least squares     where the equalities leave no freedom
 *                   least squares, Newton      where there are residuals and bounds only
 *                   SLSQP, restoration, Newton otherwise; a saddle is left along its direction
 *                   an infeasible end is a local minimum of the squares of the violations
 *     all ends:     feasible ones only, if any; undetermined directions at the best, all ends pulled
 *                   back along them; equal ones merged; ranked; multipliers, KKT, singularity
 *
 * Nothing here depends on time, addresses or the order of memory: equal input, equal bytes.
 */
#include "tune/nlp_priv.h"

#include <math.h>
#include <string.h>

#include "base/workers.h"

enum { ROUNDS = 3, HALVINGS = 6 };
/* Ends nearer than this are one (0.1 percent in a parameter: the same design to an engineer), and nearer than the
 * root of the tolerance, which a double root smears; that is capped where tolerances are wide. */
static const double SAME = 1e-3;
static const double SAME_MOST = 1e-2;
/* Ends nearer than this are one and the same to rounding; merged ones farther apart were two roots. */
static const double IDENTICAL = 1e-5;
/* A feasible end with a KKT residual above this is no local solution, if there are better ones. */
static const double STATIONARY = 1e-6;
static const double NOT_STATIONARY = 1e-3;
/* Compromises whose squares differ by less, relatively, are equally good (their minima are known to
 * rounding, about 1e-12); a smaller objective decides where it is smaller by more than rounding. */
static const double EQUAL_SQUARES = 1e-8;
static const double SETTLED_GAIN = 1e-6;
/* Length of the first step away from a saddle. */
static const double SADDLE_STEP = 0.05;
/* Violation (in tolerances) below which an end is worth a Newton polish before a restoration. */
static const double NEARLY = 1e4;

typedef struct ends {
    mt_nlp_point **p;
    bool *merged; /* another root was merged into it */
    int count;
    int capacity;
} ends;

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

/* Objective under the constraints from p, the equalities reduced to rows. p: where it ends. Again
 * from there while it is no minimum, and never for the worse. */
static void minimise(mt_nlp_engine *e, int n_rows, const int *rows, mt_nlp_point *p)
{
    mt_nlp_point *const before = mt_nlp_point_new(e, &e->scratch);
    double *const saddle = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
    if (saddle == NULL || before == NULL) {
        mt_nlp_end(e, mt_fail_memory(e->err));
        return;
    }
    for (int round = 0; round < ROUNDS && !e->ended; round++) {
        minimise_once(e, n_rows, rows, p, saddle);
        if (round > 0 && mt_nlp_better(before, p)) {
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
    if (mt_nlp_weakness_at(e, p, &e->scratch, &w) && w.curve && w.n_rows < e->n_free) {
        minimise(e, w.n_rows, w.rows, p);
    }
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
        minimise(e, q->n_eq, all_rows, p);
    }
}

/* Local search from p, which has values. An infeasible end that is a saddle of the squares is left. */
static void local_search(mt_nlp_engine *e, const int *all_rows, mt_nlp_point *p)
{
    mt_nlp_point *const before = mt_nlp_point_new(e, &e->scratch);
    double *const saddle = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
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

static bool allocate_ends(mt_nlp_engine *e, ends *all)
{
    all->p = mt_arena_alloc(&e->scratch, (size_t)all->capacity, sizeof(mt_nlp_point *));
    all->merged = mt_arena_alloc(&e->scratch, (size_t)all->capacity, sizeof *all->merged);
    bool ok = all->p != NULL && all->merged != NULL;
    for (int i = 0; ok && i < all->capacity; i++) {
        all->p[i] = mt_nlp_point_new(e, &e->scratch);
        ok = all->p[i] != NULL;
    }
    if (!ok) {
        mt_nlp_end(e, mt_fail_memory(e->err));
    }
    return ok;
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
    int n;
    bool search; /* false: only evaluate the starts */
    atomic_int abort;
} start_job;

/* The budget of start k: an even share. */
static long share(const mt_nlp_engine *e, int k, int starts)
{
    const long most = e->opt.max_evals;
    return (most / starts) + (k < most % starts ? 1 : 0);
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
    opt.max_evals = share(all, k, job->n);
    if (opt.max_evals <= 0) {
        slot->stop = MT_STOP_MAX_EVALS;
        return MT_OK;
    }
    MT_TRY(mt_nlp_engine_init(&e, &nlp, &opt, &slot->fatal_err));
    e.evals = slot->evals;
    e.abort = &job->abort;
    e.df_scale = all->df_scale;
    if (!job->search) {
        slot->begun = begin(&e, job->t + (ptrdiff_t)k * e.n, slot->p);
    } else if (slot->begun && e.n_free > 0) {
        local_search(&e, job->rows, slot->p);
    }
    slot->p->start = k;
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
    (void)err;
    return MT_OK;
}

/* Add up what the starts used and how they ended; the first failure in order counts. */
static void collect(mt_nlp_engine *e, const start_slot *slots, int n)
{
    e->evals = 0;
    for (int k = 0; k < n; k++) {
        const start_slot *const s = &slots[k];
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

static void all_starts(mt_nlp_engine *e, ends *all, mt_nlp_result *out)
{
    mt_arena *const mem = &e->scratch;
    const int n = all->capacity;
    int *const rows = mt_arena_int(mem, (size_t)e->nlp->n_eq);
    start_job job = {.e = e, .rows = rows, .n = n};
    job.t = mt_nlp_starts(e, n, mem);
    job.slots = mt_arena_alloc(mem, (size_t)n, sizeof *job.slots);
    if (job.t == NULL || rows == NULL || job.slots == NULL) {
        mt_nlp_end(e, mt_fail_memory(e->err));
        return;
    }
    for (int i = 0; i < e->nlp->n_eq; i++) {
        rows[i] = i;
    }
    for (int k = 0; k < n; k++) {
        job.slots[k].p = all->p[k];
    }
    out->starts = n;
    for (int pass = 0; pass < 2 && e->fatal == MT_OK && e->stop != MT_STOP_USER; pass++) {
        job.search = pass == 1;
        const mt_status rc = mt_workers_run(e->nlp->n_workers, n, run_start, &job, e->err);
        if (rc != MT_OK) {
            mt_nlp_end(e, rc);
        }
        collect(e, job.slots, n);
        for (int k = 0; k < n && pass == 0; k++) {
            const double norm = job.slots[k].begun ? mt_norm2(e->n, all->p[k]->df) : 0.0;
            e->df_scale = fmax(e->df_scale, norm);
        }
    }
    for (int k = 0; k < n; k++) {
        if (job.slots[k].begun) {
            mt_nlp_point_swap(&all->p[all->count++], &all->p[k]);
        }
    }
}

/* Insertion sort, stable: what is equal keeps the order of the starts. */
static void rank(ends *all)
{
    for (int i = 1; i < all->count; i++) {
        mt_nlp_point *const p = all->p[i];
        const bool merged = all->merged[i];
        int k = i;
        for (; k > 0 && mt_nlp_better(p, all->p[k - 1]); k--) {
            all->p[k] = all->p[k - 1];
            all->merged[k] = all->merged[k - 1];
        }
        all->p[k] = p;
        all->merged[k] = merged;
    }
}

/* Ranked compromises: among equally good ones the objective decides. */
static void rank_equals(ends *all)
{
    for (int first = 0; first < all->count;) {
        const double most = all->p[first]->squares * (1 + EQUAL_SQUARES);
        int i = first + 1;
        for (; i < all->count && all->p[i]->squares <= most; i++) {
            for (int k = i; k > first && all->p[k]->f < all->p[k - 1]->f; k--) {
                mt_nlp_point_swap(&all->p[k], &all->p[k - 1]);
            }
        }
        first = i;
    }
}

/* Drop infeasible ends where one is feasible, and those that are no local minima. Ranked. */
static void drop_useless(ends *all)
{
    const bool any = all->count > 0 && mt_nlp_feasible(all->p[0]);
    bool stationary = false;
    for (int i = 0; i < all->count; i++) {
        const bool counts = any == mt_nlp_feasible(all->p[i]);
        stationary = stationary || (counts && all->p[i]->kkt <= STATIONARY);
    }
    int kept = 0;
    for (int i = 0; i < all->count; i++) {
        mt_nlp_point *const p = all->p[i];
        const bool useless =
            any && (!mt_nlp_feasible(p) || (i > 0 && stationary && p->kkt > NOT_STATIONARY &&
                                            p->kkt < HUGE_VAL)); /* roots have no residual */
        if (!useless) {
            mt_nlp_point_swap(&all->p[kept++], &all->p[i]);
        }
    }
    all->count = kept;
}

/* Merge equal ends into the better one. Ranked. */
static void merge(const mt_nlp_engine *e, ends *all)
{
    const double same = fmax(SAME, fmin(sqrt(e->eq_tol), SAME_MOST));
    int kept = 0;
    for (int i = 0; i < all->count; i++) {
        int twin = -1;
        for (int k = 0; k < kept && twin < 0; k++) {
            twin = mt_nlp_distance(e, all->p[k], all->p[i]) <= same ? k : -1;
        }
        if (twin < 0) {
            mt_nlp_point_swap(&all->p[kept++], &all->p[i]);
        } else if (mt_nlp_distance(e, all->p[twin], all->p[i]) > IDENTICAL) {
            all->merged[twin] = true;
        }
        if (twin >= 0 && all->p[i]->start < all->p[twin]->start) {
            all->p[twin]->start = all->p[i]->start;
        }
    }
    all->count = kept;
}

/*
 * Many designs may be equally far from the demands: then the one of least objective is wanted. With
 * the constraints moved to what the compromise reaches, that is a feasible problem.
 */
static void settle(mt_nlp_engine *e, mt_nlp_point *p)
{
    const mt_nlp *const q = e->nlp;
    mt_arena *const mem = &e->scratch;
    mt_nlp_point *const to = mt_nlp_point_new(e, mem);
    double *const eq = mt_arena_f64(mem, (size_t)q->n_eq, 1);
    double *const in = mt_arena_f64(mem, (size_t)q->n_in, 1);
    if (to == NULL || eq == NULL || in == NULL) {
        mt_nlp_end(e, mt_fail_memory(e->err));
        return;
    }
    memcpy(eq, p->eq, (size_t)q->n_eq * sizeof *eq);
    for (int i = 0; i < q->n_in; i++) {
        in[i] = fmin(p->in[i], 0);
    }
    e->eq_shift = eq;
    e->in_shift = in;
    mt_nlp_weakness w;
    const bool minimised = mt_nlp_evaluate(e, p->t, true, to) &&
                           mt_nlp_weakness_at(e, to, mem, &w) && w.curve &&
                           w.n_rows < e->n_free;
    if (minimised) {
        minimise(e, w.n_rows, w.rows, to);
    }
    e->eq_shift = NULL;
    e->in_shift = NULL;
    if (!minimised || !mt_nlp_evaluate(e, to->t, true, to)) {
        return;
    }
    if (!(to->f < p->f - SETTLED_GAIN * fabs(p->f))) {
        return;
    }
    to->start = p->start;
    mt_nlp_polish(e, MT_NLP_SQUARES, to, NULL); /* back from within the tolerances */
    if (to->squares <= p->squares * (1 + EQUAL_SQUARES)) {
        mt_nlp_point_copy(e, p, to);
    }
}

static void settle_all(mt_nlp_engine *e, ends *all)
{
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    for (int i = 0; i < all->count && !e->ended; i++) {
        settle(e, all->p[i]);
        mt_arena_rewind(&e->scratch, mark);
    }
}

/* A double root; of two roots that were merged the Jacobian changes its sign in between. */
static bool is_singular(mt_nlp_engine *e, const mt_nlp_point *p, bool merged)
{
    const bool roots = e->nlp->n_eq >= e->n_free && e->n_free > 0;
    if (!mt_nlp_feasible(p) || e->ended || (merged && roots)) {
        return mt_nlp_feasible(p) && merged && roots;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    mt_nlp_weakness w = {0};
    (void)mt_nlp_weakness_at(e, p, &e->scratch, &w);
    mt_arena_rewind(&e->scratch, mark);
    return w.singular;
}

static void judge(mt_nlp_engine *e, ends *all, mt_arena *mem, mt_nlp_result *out)
{
    rank(all);
    drop_useless(all);
    out->compromise = all->count > 0 && !mt_nlp_feasible(all->p[0]);
    if (all->count > 0 && !mt_nlp_undetermined(e, all->p[0], mem, out)) {
        return;
    }
    for (int i = 0; i < all->count && out->n_undetermined > 0; i++) {
        mt_nlp_pull_back(e, out, all->p[i]);
    }
    rank(all);
    merge(e, all);
    if (out->compromise && e->n_free > 0) {
        settle_all(e, all);
        rank(all);
        merge(e, all);
        rank_equals(all);
    }
    const int count = all->count < e->opt.max_solutions ? all->count : e->opt.max_solutions;
    out->solutions = mt_arena_alloc(mem, (size_t)count, sizeof *out->solutions);
    if (out->solutions == NULL) {
        mt_nlp_end(e, mt_fail_memory(e->err));
        return;
    }
    for (int i = 0; i < count && mt_nlp_report(e, all->p[i], mem, &out->solutions[i]); i++) {
        out->solutions[i].singular = is_singular(e, all->p[i], all->merged[i]);
        out->n_solutions = i + 1;
    }
}

static mt_status finish(mt_nlp_engine *e, const ends *all, mt_nlp_result *out)
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
    ends all = {.capacity = e.n_free > 0 ? e.opt.starts : 1};
    if (allocate_ends(&e, &all)) {
        all_starts(&e, &all, out);
        judge(&e, &all, mem, out);
    }
    const mt_status rc = finish(&e, &all, out);
    mt_nlp_engine_free(&e);
    return rc;
}
