/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Searches of a smooth problem: where they begin, local solves from there with their records,
 * the list of their ends, then judgement. */
#include "nlp/nlp.h"

#include <nlopt.h>

#include <gsl/gsl_qrng.h>
#include <gsl/gsl_version.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/format.h"
#include "base/workers.h"
#include "nlp/engine.h"
#include "nlp/local.h"
#include "nlp/merit.h"
#include "nlp/solution_pool.h"

/* The libraries that searches use. */

const char *mt_gsl_version(void)
{
    return gsl_version;
}

void mt_nlopt_version(char text[16])
{
    int v[3];
    nlopt_version(&v[0], &v[1], &v[2]);
    (void)mt_snprintf(text, 16, "%d.%d.%d", v[0], v[1], v[2]);
}

/*
 * Where the local searches begin: the original design, then a low-discrepancy sequence over the
 * bounds, turned by a shift modulo 1 that depends on the seed (Cranley and Patterson 1976; seed
 * 0 and 1: the sequence as it is). GSL's Sobol generator knows 40 dimensions and is silent
 * beyond; its reverse Halton knows 1229; past that, pseudo-random numbers are as good.
 *
 * The state of a generator lies in an arena: of what gsl_qrng_alloc and _free would do, only
 * the shortage of memory calls GSL's error handler, which belongs to the whole process. So
 * nothing here calls it, whatever a program has it do, and any number of threads may be here at
 * once.
 */

enum { SOBOL_MOST = 40, HALTON_MOST = 1229 };

/* splitmix64 (Steele, Lea, Flood 2014): one step, a number in [0, 1). */
static double next_uniform(uint64_t *state)
{
    *state += UINT64_C(0x9E3779B97F4A7C15);
    uint64_t z = *state;
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    z ^= z >> 31;
    return (double)(z >> 11) * 0x1p-53;
}

/* The sequence of d dimensions at its start; without a type where there is none. */
static gsl_qrng sequence(int d, mt_arena *mem)
{
    gsl_qrng q = {.dimension = (unsigned)d};
    if (d >= 1 && d <= HALTON_MOST) {
        q.type = d <= SOBOL_MOST ? gsl_qrng_sobol : gsl_qrng_reversehalton;
        q.state_size = q.type->state_size(q.dimension);
        q.state = mt_arena_alloc(mem, 1, q.state_size);
    }
    if (q.state != NULL) {
        gsl_qrng_init(&q);
    }
    return q;
}

/* The next point u[d] of the unit cube. */
static void next_point(gsl_qrng *q, uint64_t *state, int d, const double *shift, double *u)
{
    if (q->type != NULL) {
        (void)gsl_qrng_get(q, u);
    }
    for (int j = 0; j < d; j++) {
        const double x = q->type != NULL ? u[j] : next_uniform(state);
        u[j] = x + shift[j] - floor(x + shift[j]);
    }
}

double *mt_nlp_starts(const mt_nlp *nlp, unsigned long seed, int starts, mt_arena *mem)
{
    int d = 0;
    for (int j = 0; j < nlp->n; j++) {
        d += nlp->lower[j] < nlp->upper[j];
    }
    double *const t = mt_arena_f64(mem, (size_t)nlp->n, (size_t)starts);
    double *const shift = mt_arena_f64(mem, (size_t)d, 1);
    double *const u = mt_arena_f64(mem, (size_t)d, 1);
    gsl_qrng q = sequence(d, mem);
    if (mt_arena_failed(mem)) {
        return NULL;
    }
    uint64_t state = seed;
    for (int j = 0; j < d && seed > 1; j++) {
        shift[j] = next_uniform(&state);
    }
    for (int k = 0; k < starts; k++) {
        const bool hint = k == 1 && nlp->hint != NULL;
        if (k > 0 && !hint) {
            next_point(&q, &state, d, shift, u);
        }
        for (int j = 0, i = 0; j < nlp->n; j++) {
            const double width = nlp->upper[j] - nlp->lower[j];
            const bool moves = k > 0 && !hint && width > 0;
            const double at = moves  ? nlp->lower[j] + u[i++] * width
                              : hint ? nlp->hint[j]
                                     : nlp->origin[j];
            t[j + (ptrdiff_t)k * nlp->n] = mt_nlp_clamp(nlp, j, at);
        }
    }
    return t;
}

/*
 * The ends of local searches as a list. Many starts end at few designs, and the approach
 * (local.c) tells them apart already: Newton, most of the cost of a search, need be done
 * once for each. The most stationary end of a neighbourhood stands for it; where Newton did not
 * come to rest from there, the next one has its turn.
 */

/* An end lower than another by more, relatively, is not the same: more than tolerances buy. */
static const double LOWER = 1e-5;
/* So many ends of a neighbourhood are polished before it is given up. */
enum { TRIES = 2 };

/* Add capacity for n more ends. False: no memory. */
static bool grow_pool(mt_nlp_engine *e, mt_nlp_solution_pool *all, int n)
{
    const size_t wanted = (size_t)all->count + (size_t)n;
    mt_nlp_local *const at = mt_arena_alloc(&e->scratch, wanted, sizeof *at);
    for (int i = 0; i < all->count && at != NULL; i++) {
        at[i] = all->at[i];
    }
    all->at = at != NULL ? at : all->at;
    return at != NULL;
}

/* Largest difference of two designs orthogonal to the directions; d[n] is work. */
static double apart(int n, const double *a, const double *b, const mt_nlp_result *directions,
                    double *d)
{
    for (int j = 0; j < n; j++) {
        d[j] = a[j] - b[j];
    }
    for (int k = 0; k < directions->n_unidentifiable; k++) {
        const double *const u = directions->unidentifiable + (ptrdiff_t)k * n;
        mt_axpy(n, -mt_dot(n, u, d), u, d);
    }
    return mt_max_abs(n, d);
}

/* True where Newton from b, which is not polished, is expected to end at the same point as from
 * a. */
static bool alike(const mt_nlp_engine *e, const mt_nlp_local *a, const mt_nlp_local *b,
                  const mt_nlp_result *directions, double *d)
{
    const mt_nlp_point *const pa = mt_nlp_local_stand(a);
    const mt_nlp_point *const pb = mt_nlp_local_stand(b);
    if (mt_nlp_feasible(pb) &&
        (!mt_nlp_nearly_feasible(pa) || pb->f < pa->f - LOWER * fabs(pa->f))) {
        return false;
    }
    return apart(e->n, a->from, b->from, directions, d) <= MT_SAME_DESIGN ||
           (a->polished && apart(e->n, pa->t, b->from, directions, d) <= MT_SAME_DESIGN);
}

/* Number of feasible ends; *places: number of distinct ones. */
static int count_places(mt_nlp_engine *e, const mt_nlp_solution_pool *all, int *places)
{
    static const mt_nlp_result none = {.n_unidentifiable = 0};
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    double *const d = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
    int n = 0;
    *places = 0;
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return 0;
    }
    for (int i = 0; i < all->count; i++) {
        const bool met = mt_nlp_feasible(mt_nlp_local_stand(&all->at[i]));
        bool known = false;
        for (int k = 0; k < i && met && !known; k++) {
            known = alike(e, &all->at[k], &all->at[i], &none, d) &&
                    alike(e, &all->at[i], &all->at[k], &none, d);
        }
        n += met ? 1 : 0;
        *places += met && !known ? 1 : 0;
    }
    mt_arena_rewind(&e->scratch, mark);
    return n;
}

/*
 * True where a further end is unlikely. From n feasible ends in w places the expected number of
 * places is w (n - 1)/(n - w - 2), with a uniform prior of that number (Boender and Rinnooy
 * Kan, Math. Prog. 37, 1987, eq. 9); true where this is less than w + 1/2. One place needs
 * eight ends, two need seventeen.
 */
static bool is_settled(mt_nlp_engine *e, const mt_nlp_solution_pool *all)
{
    int w = 0;
    const int n = count_places(e, all, &w);
    return w > 0 && n > w + 2 && 2.0 * w * (n - 1) < ((2.0 * w) + 1.0) * (n - w - 2);
}

/* True where all ends are as good as the first. */
static bool are_equally_good(const mt_nlp_solution_pool *all)
{
    bool equal = all->count > 0;
    const double f = all->count > 0 ? mt_nlp_local_stand(&all->at[0])->f : nan("");
    for (int i = 0; i < all->count && equal; i++) {
        equal = fabs(mt_nlp_local_stand(&all->at[i])->f - f) <= LOWER * fabs(f);
    }
    return equal;
}

/* True where all starts so far lead to one feasible design. */
static bool all_agree(mt_nlp_engine *e, const mt_nlp_solution_pool *all)
{
    int places = 0;
    return count_places(e, all, &places) == all->starts &&
           (places == 1 || (e->opt.any_best && are_equally_good(all)));
}

/* True where the end is at one that converged, or where Newton failed repeatedly: it does not
 * count as another end. */
static bool is_known_end(const mt_nlp_engine *e, mt_nlp_solution_pool *all, mt_nlp_local *one,
                         const mt_nlp_result *directions, double *d)
{
    int tries = 0;
    for (int k = 0; k < all->count && !one->polished; k++) {
        mt_nlp_local *const known = &all->at[k];
        if (known->polished && alike(e, known, one, directions, d)) {
            tries++;
            if (mt_nlp_came_to_rest(known) || tries == TRIES) {
                known->hits += one->hits;
                known->start = one->start < known->start ? one->start : known->start;
                return true;
            }
        }
    }
    return false;
}

/* Ends to polish next, chosen[all->count], one of each neighbourhood; ends at one that is
 * already polished are dropped. Returns their number. */
static int choose_next(mt_nlp_engine *e, mt_nlp_solution_pool *all,
                       const mt_nlp_result *directions, mt_nlp_local **chosen)
{
    double *const d = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
    int left = 0;
    int n = 0;
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return 0;
    }
    for (int i = 0; i < all->count; i++) {
        all->at[i].hits =
            is_known_end(e, all, &all->at[i], directions, d) ? 0 : all->at[i].hits;
    }
    for (int i = 0; i < all->count; i++) {
        if (all->at[i].hits > 0) {
            all->at[left++] = all->at[i];
        }
    }
    all->count = left;
    for (int i = 0; i < all->count; i++) { /* by insertion, the most stationary first */
        mt_nlp_local *const one = &all->at[i];
        int at = one->polished ? -1 : n++;
        for (; at > 0 && one->kkt < chosen[at - 1]->kkt; at--) {
            chosen[at] = chosen[at - 1];
        }
        if (at >= 0) {
            chosen[at] = one;
        }
    }
    int kept = 0;
    for (int i = 0; i < n; i++) {
        bool near = false;
        for (int k = 0; k < kept && !near; k++) {
            near = alike(e, chosen[k], chosen[i], directions, d);
        }
        if (!near) {
            chosen[kept++] = chosen[i];
        }
    }
    return kept;
}

/*
 * The search: local solves from many starts, then judgement.
 *
 *     every start:  the approach of a local search (local.c)
 *     ends:         one of each neighbourhood is polished to full accuracy
 *     judgement:    feasible ones only, if any; undetermined directions at the best, all ends
 *                   pulled back along them; equal ones merged; ranked; multipliers, KKT,
 *                   singularity
 *
 * Nothing here depends on time, addresses or the order of memory: equal input, equal bytes.
 */

enum { HALVINGS = 6 };
/* Starts between which it is asked whether more are of use. */
enum { STARTS_EACH = 8 };
/* ... and those that meet nothing feasible before it is asked whether anything is. */
enum { STARTS_ASKED = 2 };
/* So many times the first starts are made at most to meet every root twice. */
enum { ROOT_ROUNDS = 12 };

/* Evaluates the start t; where it has no value, half way to the origin, and so on. */
static bool evaluate_start(mt_nlp_engine *e, double *t, mt_nlp_point *p)
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

/* How one task ended; slots are filled by workers in any order and read in order. */
typedef struct job_slot {
    long evals;
    mt_steps steps; /* of these */
    mt_stop stop;
    mt_status fatal;
    mt_status refused;
    mt_err fatal_err;
    mt_err refused_err;
} job_slot;

typedef enum job_task { BEGIN, APPROACH, FINISH } job_task;

/* The same done with n local searches. */
typedef struct start_job {
    mt_nlp_engine *e; /* the search's own; not changed while workers run */
    job_task task;
    mt_nlp_local **at; /* [n] */
    double *t;         /* n x n, the starts where they begin */
    job_slot *slots;   /* [n] */
    int n;
    int from;        /* the first one that is done now */
    long budget;     /* of all of them */
    mt_steps *steps; /* of the whole search */
    atomic_int abort;
    mt_progress *progress; /* of first values */
    bool told;             /* there */
} start_job;

static mt_status run_task(void *context, int worker, int k, mt_task_path *own, mt_err *err)
{
    (void)own;
    start_job *const job = context;
    const mt_nlp_engine *const all = job->e;
    k += job->from;
    job_slot *const slot = &job->slots[k];
    mt_nlp_local *const s = job->at[k];
    mt_nlp nlp = *all->nlp;
    mt_nlp_options opt = all->opt;
    mt_nlp_engine e;
    nlp.context = nlp.contexts != NULL ? nlp.contexts[worker] : nlp.context;
    mt_progress_done(job->progress, job->told);
    opt.max_evals = (job->budget / job->n) + (k < job->budget % job->n ? 1 : 0); /* even */
    if (opt.max_evals <= 0) {
        slot->stop = MT_STOP_MAX_EVALS;
        return MT_OK;
    }
    MT_TRY(mt_nlp_engine_init(&e, &nlp, &opt, err));
    e.err = &slot->fatal_err;
    e.evals = slot->evals;
    e.steps = &slot->steps;
    e.abort = &job->abort;
    e.df_scale = all->df_scale;
    e.impossible = all->impossible;
    if (job->task == BEGIN) {
        s->begun = evaluate_start(&e, job->t + (ptrdiff_t)k * e.n, s->p);
    } else if (s->begun && e.n_free > 0) {
        (job->task == APPROACH ? mt_nlp_local_approach : mt_nlp_local_finish)(&e, s);
    }
    (void)mt_nlp_has_room(&e, &e.scratch); /* whoever left something out for want of it */
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

/* Adds up the evaluations of the tasks and of before, and their stops; the first failure in
 * order is returned. */
static void sum_evaluations(mt_nlp_engine *e, const start_job *job, long before)
{
    e->evals = before;
    for (int k = 0; k < job->n; k++) {
        const job_slot *const s = &job->slots[k];
        e->evals += s->evals;
        e->stop = s->stop == MT_STOP_USER || e->stop == MT_STOP_DONE ? s->stop : e->stop;
        if (s->fatal != MT_OK && e->fatal == MT_OK) {
            (void)mt_nlp_ok(e, mt_fail(e->err, s->fatal, "%s", s->fatal_err.text));
        }
        if (s->refused != MT_OK && e->refused == MT_OK) {
            e->refused = s->refused;
            e->refused_err = s->refused_err;
        }
    }
    e->ended = e->ended || e->stop == MT_STOP_USER;
}

static job_slot *new_slots(int n, mt_arena *mem)
{
    job_slot *const slots = mt_arena_alloc(mem, (size_t)n, sizeof *slots);
    for (int k = 0; k < n && slots != NULL; k++) {
        slots[k].steps = mt_steps_new(MT_STEPS_OF_TASK, mem);
    }
    return slots;
}

/* Steps as if the tasks had run one after the other. */
static void note_steps(const start_job *job, long before)
{
    for (int k = 0; k < job->n; k++) {
        mt_steps_append(job->steps, &job->slots[k].steps, before, 0, 0);
        before += job->slots[k].evals;
    }
}

/*
 * A local search as a record: the designs where it stands, and what it knows about them.
 * Values and slopes there are evaluated anew.
 */

/* Writes or reads the values that do not follow from the design alone, and those that check the
 * others. */
static void serialize_point(const mt_nlp_engine *e, mt_nlp_point *p, mt_serializer *serializer)
{
    mt_serializer_numbers(serializer, (size_t)e->n, p->t);
    mt_serializer_numbers(serializer, 1, &p->f);
    mt_serializer_numbers(serializer, 1, &p->violation);
    mt_serializer_numbers(serializer, 1, &p->squares);
    mt_serializer_numbers(serializer, 1, &p->kkt);
    mt_serializer_int(serializer, &p->n_loose, 0, INT_MAX);
    mt_serializer_flag(serializer, &p->isolated);
}

/* Evaluates everything else at the design of p; false where the values differ. */
static bool evaluate_again(mt_nlp_engine *e, mt_nlp_point *p, mt_nlp_point *at)
{
    const bool same = mt_nlp_evaluate(e, p->t, true, at) && at->f == p->f &&
                      at->violation == p->violation && at->squares == p->squares &&
                      memcmp(at->t, p->t, (size_t)e->n * sizeof *p->t) == 0;
    at->kkt = p->kkt;
    at->n_loose = p->n_loose;
    at->isolated = p->isolated;
    return same;
}

static void serialize_state(const mt_nlp_engine *e, mt_nlp_local *s, mt_serializer *serializer)
{
    int stage = (int)s->stage;
    mt_serializer_int(serializer, &stage, MT_NLP_OBJECTIVE, MT_NLP_SQUARES);
    s->stage = (mt_nlp_stage)stage;
    mt_serializer_int(serializer, &s->n_rows, 0, e->nlp->n_eq);
    for (int i = 0; i < s->n_rows; i++) {
        mt_serializer_int(serializer, &s->rows[i], 0, e->nlp->n_eq - 1);
    }
    mt_serializer_flag(serializer, &s->restored);
    mt_serializer_flag(serializer, &s->abandoned);
    mt_serializer_flag(serializer, &s->curve);
    mt_serializer_flag(serializer, &s->polished);
    mt_serializer_numbers(serializer, (size_t)e->n, s->from);
    mt_serializer_numbers(serializer, 1, &s->kkt);
}

static bool read_local(mt_nlp_engine *e, mt_nlp_local *s, mt_serializer *serializer)
{
    mt_nlp_local got = mt_nlp_local_new(e, &e->scratch);
    mt_nlp_point *const p = mt_nlp_point_new(e, &e->scratch);
    mt_nlp_point *const last = mt_nlp_point_new(e, &e->scratch);
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return false;
    }
    serialize_state(e, &got, serializer);
    serialize_point(e, got.p, serializer);
    bool same = true;
    if (got.stage == MT_NLP_OBJECTIVE) {
        serialize_point(e, got.last, serializer);
        same = mt_serializer_is_read(serializer) && evaluate_again(e, got.last, last);
    }
    if (!same || !mt_serializer_is_read(serializer) || !evaluate_again(e, got.p, p)) {
        return false;
    }
    mt_nlp_point_copy(e, s->p, p);
    if (got.stage == MT_NLP_OBJECTIVE) {
        mt_nlp_point_copy(e, s->last, last);
    }
    memcpy(s->rows, got.rows, (size_t)got.n_rows * sizeof *s->rows);
    memcpy(s->from, got.from, (size_t)e->n * sizeof *s->from);
    s->stage = got.stage;
    s->n_rows = got.n_rows;
    s->restored = got.restored;
    s->abandoned = got.abandoned;
    s->curve = got.curve;
    s->polished = got.polished;
    s->kkt = got.kkt;
    return true;
}

/* Write or read the state of a search. Values and slopes are evaluated
 * again at the designs that are read, and the record is accepted only where they equal those it
 * was written with. False: refused, and s is unchanged. */
static bool serialize_local(mt_nlp_engine *e, mt_nlp_local *s, mt_serializer *serializer)
{
    bool begun = s->begun;
    mt_serializer_flag(serializer, &begun);
    if (!serializer->reads) {
        serialize_state(e, s, serializer);
        serialize_point(e, s->p, serializer);
        if (s->stage == MT_NLP_OBJECTIVE) {
            serialize_point(e, s->last, serializer);
        }
        return !serializer->failed;
    }
    /* what is evaluated here was counted when the record was made */
    const mt_nlp_engine before = *e;
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    e->opt.max_evals = LONG_MAX;
    const bool same = !serializer->failed && begun == s->begun && read_local(e, s, serializer);
    mt_arena_rewind(&e->scratch, mark);
    e->opt.max_evals = before.opt.max_evals;
    e->evals = before.evals;
    e->refused = before.refused;
    e->refused_err = before.refused_err;
    serializer->failed = !same;
    return same;
}

/* Writes or reads a task: its evaluations and the state of its local search. */
static void serialize_task(void *context, int k, mt_serializer *serializer)
{
    start_job *const job = context;
    k += job->from;
    job_slot *const slot = &job->slots[k];
    job_slot got = *slot;
    int stop = (int)slot->stop;
    int refused = (int)slot->refused;
    const char *text = slot->refused_err.text;
    mt_arena *const mem = &job->e->scratch; /* while it is written: of nobody's use */
    serializer->failed = !serializer->reads && atomic_load(&job->abort) != 0;
    mt_serializer_long(serializer, &got.evals, 0, LONG_MAX);
    mt_serializer_int(serializer, &stop, MT_STOP_DONE, MT_STOP_MAX_EVALS);
    mt_serializer_int(serializer, &refused, MT_OK, MT_STATUS_COUNT - 1);
    mt_serializer_text(serializer, &text, mem);
    got.steps = serializer->reads ? mt_steps_new(MT_STEPS_OF_TASK, mem) : slot->steps;
    serializer->failed = serializer->failed || got.steps.at == NULL;
    mt_steps_serialize(&got.steps, serializer);
    if (!serialize_local(job->e, job->at[k], serializer) || !serializer->reads) {
        return;
    }
    got.stop = (mt_stop)stop;
    got.refused = (mt_status)refused;
    if (refused != MT_OK) {
        (void)mt_fail(&got.refused_err, got.refused, "%s", text == NULL ? "" : text);
    }
    *slot = got;
}

/* Runs tasks [from, to). First values are not stored; searches are. */
static void run_part(mt_nlp_engine *e, start_job *job, job_task task, int from, int to,
                     long before)
{
    mt_task_path *const place = e->nlp->task_path;
    const bool first = task == BEGIN;
    const mt_tasks tasks = {to - from, run_task, serialize_task, job,
                            task == FINISH ? "ends of searches" : "starts"};
    job->task = task;
    job->from = from;
    job->progress = place != NULL && first ? place->progress : NULL;
    job->told = mt_progress_begin(job->progress, "first values", to - from);
    mt_err own = {.code = MT_OK};
    const mt_status rc = mt_workers_run(e->nlp->n_workers, first ? NULL : place, &tasks, &own);
    mt_progress_end(job->progress, job->told);
    sum_evaluations(e, job, before); /* a task's own failure before "left to other parts" */
    if (rc != MT_OK && e->fatal == MT_OK) {
        (void)mt_nlp_ok(e, mt_fail(e->err, rc, "%s", own.text));
    }
}

static void run_job(mt_nlp_engine *e, start_job *job, job_task task, long before)
{
    run_part(e, job, task, 0, job->n, before);
}

/* True where no feasible point exists, by the caller's proof, which runs where none of the
 * first `n` searches found one. */
static bool is_impossible(mt_nlp_engine *e, const start_job *job, int n)
{
    bool none = e->fatal == MT_OK && e->stop == MT_STOP_DONE;
    for (int k = 0; k < n && none; k++) {
        const mt_nlp_local *const s = job->at[k];
        none = !s->begun || (!mt_nlp_feasible(s->p) && !mt_nlp_feasible(s->last));
    }
    if (!none) {
        return false;
    }
    none = false;
    return mt_nlp_ok(e, e->opt.prove_none(e->opt.prove_context, &none, e->err)) && none;
}

/* Approaches from all starts; where it is proven that no feasible point exists, from the first
 * ones alone. Returns their number. */
static int approach_all(mt_nlp_engine *e, start_job *job, long before)
{
    const bool asks = e->opt.prove_none != NULL && e->opt.starts > STARTS_EACH;
    const int first = asks && job->n > STARTS_ASKED ? STARTS_ASKED : job->n;
    run_part(e, job, APPROACH, 0, first, before);
    if (asks) {
        e->impossible = is_impossible(e, job, first);
        e->opt.prove_none = NULL; /* it is asked once */
    }
    const bool less = asks && e->impossible && job->n > STARTS_EACH;
    const int n = less ? STARTS_EACH : job->n;
    if (first < n && e->fatal == MT_OK && e->stop != MT_STOP_USER) {
        run_part(e, job, APPROACH, first, n, before);
    }
    return n;
}

/* Approaches from starts all->starts ... all->starts + n - 1, and appends their ends. The scale
 * of the objective comes from the first ones. */
static bool add_starts(mt_nlp_engine *e, mt_nlp_solution_pool *all, int n, mt_steps *steps)
{
    mt_arena *const mem = &e->scratch;
    const long before = e->evals;
    start_job job = {.e = e, .n = n, .budget = e->opt.max_evals - before, .steps = steps};
    double *const t = mt_nlp_starts(e->nlp, e->opt.seed, all->starts + n, mem);
    job.slots = new_slots(n, mem);
    job.at = mt_arena_alloc(mem, (size_t)n, sizeof(mt_nlp_local *));
    const bool grown = grow_pool(e, all, n);
    if (!mt_nlp_has_room(e, mem) || !grown) {
        return false;
    }
    mt_nlp_local *const first = all->at + all->count;
    for (int k = 0; k < n; k++) {
        first[k] = mt_nlp_local_new(e, mem);
        job.at[k] = &first[k];
    }
    if (!mt_nlp_has_room(e, mem)) {
        return false;
    }
    job.t = t + (ptrdiff_t)all->starts * e->n;
    run_job(e, &job, BEGIN, before);
    for (int k = 0; k < n && all->starts == e->opt.skip; k++) {
        e->df_scale = fmax(e->df_scale, first[k].begun ? mt_norm2(e->n, first[k].p->df) : 0.0);
    }
    if (e->fatal == MT_OK && e->stop != MT_STOP_USER) {
        n = approach_all(e, &job, before);
    }
    note_steps(&job, before);
    for (int k = 0; k < n; k++) {
        first[k].start = all->starts + k;
        if (first[k].begun) {
            all->at[all->count++] = first[k];
        }
    }
    all->starts += n;
    return e->fatal == MT_OK;
}

/*
 * Newton from the best end, where the undetermined directions are sought: ends that differ by
 * them only are one. Then from one end of each neighbourhood, until all that are left came to
 * rest or had their turn.
 */
static void finish_pool(mt_nlp_engine *e, mt_nlp_solution_pool *all, mt_steps *steps,
                        mt_arena *mem, mt_nlp_result *out)
{
    mt_nlp_local **const chosen =
        mt_arena_alloc(&e->scratch, (size_t)all->count, sizeof(mt_nlp_local *));
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return;
    }
    int n = 0;
    for (int k = 0; k < all->count && e->n_free > 0; k++) {
        if (!all->at[k].polished && (n == 0 || mt_nlp_better(all->at[k].p, chosen[0]->p))) {
            chosen[0] = &all->at[k];
            n = 1;
        }
    }
    while (n > 0 && !e->ended) {
        const long before = e->evals;
        start_job job = {.e = e, .n = n, .at = chosen, .steps = steps};
        job.budget = e->opt.max_evals - before;
        job.slots = new_slots(n, &e->scratch);
        if (!mt_nlp_has_room(e, &e->scratch)) {
            return;
        }
        run_job(e, &job, FINISH, before);
        note_steps(&job, before);
        for (int k = 0; k < n; k++) {
            chosen[k]->polished = true;
        }
        if (all->directed == NULL && mt_nlp_came_to_rest(chosen[0])) {
            all->directed = chosen[0]->p;
            if (!mt_nlp_unidentifiable(e, all->directed, mem, out)) {
                return;
            }
        }
        n = choose_next(e, all, out, chosen);
    }
}

/* The first starts, or fewer where these are enough. False: no further ones. */
static bool make_starts(mt_nlp_engine *e, mt_nlp_solution_pool *all, int first, mt_steps *steps)
{
    bool more = true;
    for (int left = first; left > 0 && more;) {
        const int agree = all->starts == 0 ? e->opt.agree : 0;
        const bool second = e->opt.agree > 0 && all->starts == e->opt.agree;
        const int each = second ? STARTS_EACH - e->opt.agree : STARTS_EACH;
        const int batch = agree > 0 ? agree : e->opt.settles ? each : left;
        const int now = batch < left ? batch : left;
        more = add_starts(e, all, now, steps);
        const bool enough = e->impossible || (agree > 0 && all_agree(e, all)) ||
                            (e->opt.settles && more && is_settled(e, all));
        left = enough ? 0 : left - now;
    }
    return more;
}

/*
 * The starts asked for; where the equalities settle everything and there is more than one root,
 * as many again each time, within the budget, until every root was met twice (what was met once
 * stands for as much that was not met at all: Good and Turing) and the last starts brought no
 * new one.
 */
static void all_starts(mt_nlp_engine *e, mt_nlp_solution_pool *all, mt_steps *steps,
                       mt_nlp_result *out)
{
    e->opt.skip = e->n_free > 0 && e->opt.skip < e->opt.starts ? e->opt.skip : 0;
    const int first = e->n_free > 0 ? e->opt.starts - e->opt.skip : 1;
    all->starts = e->opt.skip;
    bool more = make_starts(e, all, first, steps) && e->open_starts;
    int before = 1;
    while (more && e->stop == MT_STOP_DONE && all->starts < ROOT_ROUNDS * first) {
        const int left = ROOT_ROUNDS * first - all->starts;
        int once = 0;
        const int roots = mt_nlp_roots(e, all, &once);
        if (once == 0 && roots <= before) {
            break;
        }
        before = roots;
        more = add_starts(e, all, all->starts < left ? all->starts : left, steps);
    }
    out->starts = all->starts - e->opt.skip;
}

/* True where all ends are one design. */
static bool are_one(const mt_nlp_engine *e, const mt_nlp_solution_pool *all)
{
    bool one = all->count > 0;
    for (int k = 1; k < all->count && one; k++) {
        one = mt_nlp_distance(e, all->at[0].p, all->at[k].p) <= MT_SAME_DESIGN;
    }
    return one;
}

/* The other starts, where nothing is feasible and the first did not all end at one
 * compromise. */
static void make_rest(mt_nlp_engine *e, mt_nlp_solution_pool *all, mt_steps *steps,
                      mt_arena *mem, mt_nlp_result *out)
{
    const int left = e->opt.starts - all->starts;
    if (e->impossible && !are_one(e, all) && left > 0 && e->stop == MT_STOP_DONE &&
        add_starts(e, all, left, steps)) {
        finish_pool(e, all, steps, mem, out);
        out->starts = all->starts - e->opt.skip;
    }
}

mt_nlp_options mt_nlp_options_default(void)
{
    return (mt_nlp_options){.seed = 1, .least_change = true};
}

mt_status mt_nlp_solve(const mt_nlp *nlp, const mt_nlp_options *opt, mt_arena *mem,
                       mt_nlp_result *out, mt_err *err)
{
    mt_nlp_engine e;
    *out = (mt_nlp_result){.stop = MT_STOP_DONE};
    MT_TRY(mt_nlp_engine_init(&e, nlp, opt, err));
    mt_nlp_solution_pool all = {0};
    out->steps = mt_steps_new(MT_STEPS_MOST, mem);
    (void)mt_nlp_has_room(&e, mem);
    all_starts(&e, &all, &out->steps, out);
    finish_pool(&e, &all, &out->steps, mem, out);
    make_rest(&e, &all, &out->steps, mem, out);
    mt_nlp_verify_kkt(&e, &all, mem, out);
    (void)mt_nlp_has_room(&e, &e.scratch);
    out->evals = e.evals;
    out->stop = e.stop;
    out->impossible = e.impossible;
    mt_status rc = e.fatal;
    if (rc == MT_OK && all.count == 0 && e.stop == MT_STOP_DONE && e.refused != MT_OK) {
        rc = mt_fail(err, e.refused, "no start of the search has a value: %s",
                     e.refused_err.text);
    }
    mt_nlp_engine_free(&e);
    return rc;
}
